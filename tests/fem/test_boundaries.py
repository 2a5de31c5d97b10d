"""What holds and loads a mesh, against closed forms."""

import dataclasses
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from strikewave.base.errors import InputError
from strikewave.fem.bodies import RigidBody
from strikewave.fem.boundary import Dashpots, Held, Now, Pressed, Weight, dashpots, held_nodes
from strikewave.fem.contact import prepare_ties
from strikewave.fem.mesh import joined
from strikewave.fem.model import (
    Controls,
    CutSection,
    Driven,
    Fixed,
    Guided,
    Model,
    NonReflecting,
    Point,
    Pressure,
    Rigid,
    RigidWall,
    SurfaceContact,
    Symmetry,
    Tie,
    TimeCurve,
)
from strikewave.fem.shapes import block, cylinder, moved, turned
from strikewave.fem.solids import Elastic
from strikewave.fem.solve import solve

from .bodies import STEEL


def cube(name="cube", side=4e-3, size=1e-3):
    return block(name, (side, side, side), size, size, size)


def one(mesh, duration=20e-6, **rest):
    return Model(mesh, dict.fromkeys(mesh.names, STEEL), Controls(duration, interval=1e-6), **rest)


def test_gravity_makes_a_body_fall_by_half_g_t_squared():
    run = solve(one(cube(), gravity=(0.0, 0.0, -9.80665)))
    assert run.parts["cube"].displacement[-1, 2] == pytest.approx(-0.5 * 9.80665 * 20e-6**2, rel=1e-9)
    assert run.energy["external"][1:] == pytest.approx(run.energy["kinetic"][1:], rel=1e-9, abs=0.0)
    assert run.momentum_error < 1e-12


def test_a_rigid_part_falls_through_few_long_steps():
    """One step an interval: place and velocity are exact even so, and the balance balances from the first instant."""
    run = solve(one(cube(), gravity=(0.0, 3.0, -9.80665), rigid=(Rigid("cube"),)))
    assert not run.stopped
    assert run.steps == 20
    assert run.parts["cube"].displacement == pytest.approx(np.outer(0.5 * run.time**2, [0.0, 3.0, -9.80665]), abs=1e-18)
    assert abs(run.energy_error).max() < 1e-12
    assert run.momentum_error < 1e-12


def test_tied_bodies_fall_as_one():
    """Tied nodes weigh what they weigh: both parts fall by g t^2 / 2 without stress."""
    low, high = cube("low"), cube("high", 3e-3, 7.5e-4)
    high = moved(high, (0.0, 0.0, low.points[:, 2].max() - high.points[:, 2].min()))
    run = solve(one(joined([low, high]), gravity=(0.0, 0.0, -9.80665), ties=(Tie("high.z-", "low.z+"),)))
    for part in ("low", "high"):
        assert run.parts[part].displacement[-1, 2] == pytest.approx(-0.5 * 9.80665 * 20e-6**2, rel=1e-9)
    assert run.energy["external"][1:] == pytest.approx(run.energy["kinetic"][1:], rel=1e-9, abs=0.0)
    assert abs(run.energy_error).max() < 1e-9
    assert run.momentum_error < 1e-12


def test_pressure_on_all_sides_gives_its_negative_as_stress_and_no_motion():
    """A slow pressure p on all sides: stress -p on the axes, volume change -p/K (1e-3: the cube still swings)."""
    load = Pressure("cube.all", TimeCurve((0.0, 100e-6), (0.0, 1e6)))
    model = one(
        cube(), 100e-6, boundaries=(load,), sections=(CutSection("s", "cube", (0.0, 0.0, 1e-3), (0.0, 0.0, 1.0)),)
    )
    run = solve(model)
    assert run.sections["s"].stress[-1, :3] == pytest.approx([-1e6] * 3, rel=5e-3)
    assert abs(run.sections["s"].stress[-1, 3:]).max() < 1e3
    assert abs(run.parts["cube"].velocity).max() < 1e-9


def test_pressure_on_a_bent_side_pushes_by_its_projected_area():
    """The force of a pressure on half of a round side is p times diameter times length, whatever the facets."""
    bar = cylinder("bar", 0.01, 0.01, 1e-3, 2e-3, "half")
    load = Pressure("bar.round", TimeCurve((0.0,), (1e6,)))
    run = solve(one(bar, 1e-6, boundaries=(load,)))
    push = run.parts["bar"].acceleration[0] * run.parts["bar"].mass
    # the average over the half interval in which the side begins to move: a share of 1e-6 by then
    assert push == pytest.approx([0.0, -1e6 * 0.01 * 0.01, 0.0], abs=3e-6 * 100.0)


@pytest.mark.parametrize("angle", [0.0, 0.5])
def test_symmetry_halves_a_body_that_is_struck_at_its_middle(angle):
    """Half a block with a symmetry side moves as the whole, in any direction: mean displacement and energy to 1e-9."""
    load = TimeCurve((0.0, 5e-6, 10e-6), (0.0, 5e7, 0.0))
    whole = block("body", (8e-3, 4e-3, 4e-3), 1e-3, 1e-3, 1e-3)
    half = block("body", (4e-3, 4e-3, 4e-3), 1e-3, 1e-3, 1e-3)
    low = half.points[:, 0].min()
    half = moved(half, (-low, 0.0, 0.0))
    runs = []
    for mesh, held in ((whole, ()), (half, (Symmetry("body.x-"),))):
        mesh = turned(mesh, (0.0, 1.0, 0.0), angle)
        runs.append(solve(one(mesh, boundaries=(Pressure("body.z+", load), *held))))
    first, second = (run.parts["body"].displacement for run in runs)
    axis = np.array([math.sin(angle), 0.0, math.cos(angle)])
    assert first @ axis == pytest.approx(second @ axis, rel=1e-7, abs=1e-12)
    assert runs[0].energy["internal"] == pytest.approx(2.0 * runs[1].energy["internal"], rel=1e-7, abs=1e-12)


def test_fixed_and_guided_nodes_stay_where_they_may():
    mesh = cube()
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    axis = np.array([1.0, 1.0, 0.0]) / math.sqrt(2.0)
    model = one(
        mesh,
        boundaries=(Fixed("cube.z-"), Guided("cube.z+", tuple(axis))),
        velocity={"cube": (3.0, 1.0, 2.0)},
        points=(Point("low", "cube", tuple(low)), Point("high", "cube", tuple(high))),
    )
    run = solve(model)
    assert abs(run.points["low"].displacement).max() < 1e-18
    moved_by = run.points["high"].displacement
    assert abs(moved_by - np.outer(moved_by @ axis, axis)).max() < 1e-17
    assert abs(moved_by @ axis).max() > 1e-6


def test_driven_side_follows_its_curve_and_its_work_is_in_the_balance():
    """A side driven at 1 m/s from rest: a wave of stress rho c v follows; the work is that of the driving force."""
    bar = block("bar", (2e-3, 2e-3, 0.05), 1e-3, 1e-3, 1e-3)
    held = tuple(Symmetry(f"bar.{side}") for side in ("x-", "x+", "y-", "y+"))
    driven = Driven("bar.z+", (0.0, 0.0, -1.0), TimeCurve((0.0, 2e-6), (0.0, 1.0)))
    low = bar.points[:, 2].min()
    middle = CutSection("middle", "bar", (0.0, 0.0, low + 0.025), (0.0, 0.0, 1.0))
    run = solve(one(bar, 8e-6, boundaries=(*held, driven), sections=(middle,)))
    stress = STEEL.density * STEEL.wave_speed
    assert run.sections["middle"].stress[-1, 2] == pytest.approx(-stress, rel=0.01)
    assert abs(run.energy_error).max() < 1e-8
    length = 8e-6 - 1e-6
    assert run.energy["external"][-1] == pytest.approx(stress * 4e-6 * (length - 2e-6 / 6.0 * 1.0), rel=0.03)


def test_driven_ramp_goes_as_far_as_the_integral_of_its_speed():
    """Speeds are those at the middles of the steps: exact for a ramp, from the first step on."""
    driven = Driven("cube.z+", (0.0, 0.0, 1.0), TimeCurve((0.0, 40e-6), (0.0, 4.0)))
    mesh = cube()
    place = tuple(mesh.points[mesh.side("cube.z+")[0, 0]])
    run = solve(one(mesh, boundaries=(driven,), points=(Point("top", "cube", place),)))
    assert run.points["top"].displacement[1:, 2] == pytest.approx(0.5e5 * run.time[1:] ** 2, rel=1e-9, abs=0.0)


def test_nodes_on_two_symmetry_planes_at_60_degrees_move_along_their_edge():
    """Of a leaning block: what both planes leave is the edge, whatever their angle."""
    mesh = cube()
    points = mesh.points.copy()
    points[:, 0] += math.tan(math.pi / 6.0) * points[:, 2]
    mesh = dataclasses.replace(mesh, points=points)
    edge = np.intersect1d(mesh.side("cube.x-"), mesh.side("cube.z-"))
    point = Point("edge", "cube", tuple(points[edge[0]]))
    bounds = (Symmetry("cube.x-"), Symmetry("cube.z-"))
    run = solve(one(mesh, boundaries=bounds, points=(point,), velocity={"cube": (3.0, 1.0, 2.0)}))
    assert abs(run.points["edge"].displacement[:, [0, 2]]).max() < 1e-17
    assert abs(run.points["edge"].displacement[:, 1]).max() > 1e-6


def test_wall_with_friction_stops_a_block_after_v_squared_over_2_mu_g():
    """A flat block slides on a wall under a large gravity: v0^2 / (2 mu g), t = v0 / (mu g), to 1 %."""
    slab = block("slab", (8e-3, 8e-3, 2e-3), 1e-3, 1e-3, 1e-3)
    foot = slab.points[:, 2].min()
    gravity, friction, speed = 2e5, 0.3, 3.0
    stop = speed / (friction * gravity)
    model = Model(
        slab,
        {"slab": STEEL},
        Controls(1.4 * stop, interval=1e-6, linear_viscosity=0.06),
        velocity={"slab": (speed, 0.0, 0.0)},
        gravity=(0.0, 0.0, -gravity),
        walls=(RigidWall("slab.z-", (0.0, 0.0, foot), (0.0, 0.0, 1.0), friction),),
    )
    run = solve(model)
    slid = run.parts["slab"].displacement[-1, 0]
    assert slid == pytest.approx(speed**2 / (2.0 * friction * gravity), rel=0.01)
    assert abs(run.parts["slab"].velocity[-1, 0]) < 0.01 * speed
    assert run.energy["contact"][-1] == pytest.approx(0.5 * run.parts["slab"].mass * speed**2, rel=0.02)


def test_rigid_part_moves_and_turns_by_newton_and_euler():
    """A pressure on one half of a side: the acceleration of the mass, and the spin of the moment of inertia."""
    body = block("body", (8e-3, 4e-3, 2e-3), 1e-3, 1e-3, 1e-3)
    top = body.side("body.z+")
    right = top[body.points[top].mean(axis=1)[:, 0] > body.points[:, 0].mean()]
    body = type(body)(body.points, body.hexahedra, body.part, body.names, {**body.sides, "body.right": right})
    middle = body.points.mean(axis=0)
    tip = body.points[np.argmax(body.points[:, 0])]
    model = Model(
        body,
        {"body": STEEL},
        Controls(20e-6, interval=1e-6),
        boundaries=(Pressure("body.right", TimeCurve((0.0,), (1e6,))),),
        rigid=(Rigid("body"),),
        points=(Point("tip", "body", tuple(tip)),),
    )
    run = solve(model)
    mass = STEEL.density * 64e-9
    push = 1e6 * 16e-6
    assert run.parts["body"].displacement[-1, 2] == pytest.approx(-0.5 * push / mass * 20e-6**2, rel=1e-3)
    node = body.points[run.points["tip"].node] - middle
    masses = np.bincount(body.hexahedra.ravel(), minlength=len(body.points)) * STEEL.density * 1e-9 / 8.0
    arms = body.points - middle
    inertia = float(masses @ (arms[:, 0] ** 2 + arms[:, 2] ** 2))
    spin = push * 2e-3 / inertia
    turn = 0.5 * spin * 20e-6**2
    lag = run.points["tip"].displacement[-1, 2] - run.parts["body"].displacement[-1, 2]
    assert lag == pytest.approx(-turn * node[0], rel=2e-3)
    assert abs(run.energy_error).max() < 2e-3


def test_rigid_part_spins_about_a_principal_axis_without_losing_energy():
    """A driven start is not needed: spin given by the velocity of none, a collision sets it turning; energy stays."""
    body = moved(block("body", (8e-3, 4e-3, 2e-3), 1e-3, 1e-3, 1e-3), (0.0, 0.0, 5e-3))
    ball = block("ball", (2e-3, 2e-3, 2e-3), 1e-3, 1e-3, 1e-3)
    low, high = body.points.min(axis=0), body.points.max(axis=0)
    ball = moved(ball, (high[0] - ball.points[:, 0].max(), 0.0, low[2] - ball.points[:, 2].max() - 1e-5))
    model = Model(
        joined([body, ball]),
        {"body": STEEL, "ball": STEEL},
        Controls(60e-6, interval=1e-6),
        velocity={"ball": (0.0, 0.0, 10.0)},
        rigid=(Rigid("body"),),
        contacts=(SurfaceContact("ball.all", "body.all"),),
    )
    run = solve(model)
    assert run.parts["body"].velocity[-1, 2] > 0.0
    assert abs(run.energy_error).max() < 0.01
    assert run.momentum_error < 1e-9


def tumbled(steps, turn=8.0):
    """Let a box tumble about its middle axis, disturbed; return orientation, that by Euler's equations, and the energy
    of its nodes over that at the start."""
    mesh = block("body", (8e-3, 4e-3, 2e-3), 2e-3, 2e-3, 2e-3)
    mass = np.bincount(mesh.hexahedra.ravel(), minlength=len(mesh.points)) * 1e-6
    body = RigidBody(mesh, Rigid("body"), mass, np.zeros(3))
    body.spin = body.inertia @ [0.1, 1.0, 0.05]
    x, v, step = mesh.points.copy(), np.zeros_like(mesh.points), turn / steps
    energies = []
    for _ in range(steps):
        f = np.zeros_like(x)
        body.add(Now(0.0, step, step, x, v, f, mass))
        v += step * f / mass[:, None]
        x += step * v
        energies.append(0.5 * mass @ np.einsum("ni,ni->n", v, v))

    def turning(_, flat):
        now = flat.reshape(3, 3)
        rate = now @ np.linalg.solve(body.inertia, now.T @ body.spin)
        return np.cross(rate, now, axisb=0, axisc=0).ravel()

    exact = solve_ivp(turning, (0.0, turn), np.eye(3).ravel(), "DOP853", rtol=1e-11, atol=1e-12).y[:, -1].reshape(3, 3)
    return body.turned, exact, np.array(energies) / (0.5 * body.spin @ np.linalg.solve(body.inertia, body.spin))


def test_a_box_tumbles_about_its_middle_axis_by_eulers_equations():
    """Unstable, so that it turns over: the orientation errs by the square of the step, the energy of the nodes too."""
    errors, drifts = [], []
    for steps in (200, 400, 800):
        turned_by, exact, energy = tumbled(steps)
        assert exact[1, 1] < 0.7 or exact[2, 2] < 0.7
        errors.append(np.abs(turned_by - exact).max())
        drifts.append(np.abs(energy - 1.0).max())
    assert errors[-1] < 1e-3
    for found in (errors, drifts):
        assert np.log2(np.array(found[:-1]) / found[1:]) == pytest.approx([2.0, 2.0], abs=0.1)


def test_single_translation_of_a_rigid_part():
    """A rigid part that may only move along z takes the z share of a blow and nothing else."""
    model = one(
        cube(),
        boundaries=(Pressure("cube.z+", TimeCurve((0.0,), (1e6,))), Pressure("cube.x+", TimeCurve((0.0,), (1e6,)))),
        rigid=(Rigid("cube", (False, False, True), (False, False, False)),),
    )
    run = solve(model)
    mass = STEEL.density * 64e-9
    assert run.parts["cube"].velocity[-1] == pytest.approx([0.0, 0.0, -16.0 / mass * 20e-6], rel=1e-9)
    assert run.impulse_given[-1] == pytest.approx(run.momentum[-1], rel=1e-9, abs=1e-15)


def test_symmetry_on_a_bent_side_is_refused():
    bar = cylinder("bar", 0.01, 0.01, 2e-3, 5e-3)
    with pytest.raises(InputError, match=r"bar\.round.*flat side"):
        solve(one(bar, boundaries=(Symmetry("bar.round"),)))


def test_driving_a_held_side_is_refused():
    bounds = (Fixed("cube.z-"), Driven("cube.z-", (0.0, 0.0, 1.0), TimeCurve((0.0,), (1.0,))))
    with pytest.raises(InputError, match="not held along the direction"):
        solve(one(cube(), boundaries=bounds))


def test_section_beside_the_part_is_refused():
    with pytest.raises(InputError, match="a plane that cuts cube"):
        solve(one(cube(), sections=(CutSection("s", "cube", (0.0, 0.0, 1.0), (0.0, 0.0, 1.0)),)))


def test_stress_of_two_solids_in_one_bar_is_continuous():
    """Two parts that share nodes (as imported meshes do) carry one force: stress is equal at the end of a slow pull."""
    bar = block("bar", (2e-3, 2e-3, 0.01), 1e-3, 1e-3, 1e-3)
    middle = bar.points[bar.hexahedra].mean(axis=1)[:, 2] > bar.points[:, 2].mean()
    order = np.argsort(middle, kind="stable")
    mesh = type(bar)(
        bar.points,
        bar.hexahedra[order],
        middle[order].astype(np.int32),
        ("low", "high"),
        {"low.end": bar.side("bar.z-"), "high.end": bar.side("bar.z+")},
    )
    soft = Elastic(2780.0, 72e9, 0.0)
    z = bar.points[:, 2]
    model = Model(
        mesh,
        {"low": Elastic(7820.0, 211e9, 0.0), "high": soft},
        Controls(200e-6, interval=2e-6),
        boundaries=(Fixed("low.end"), Pressure("high.end", TimeCurve((0.0, 200e-6), (0.0, -1e6)))),
        sections=(
            CutSection("a", "low", (0.0, 0.0, z.min() + 2.5e-3), (0.0, 0.0, 1.0)),
            CutSection("b", "high", (0.0, 0.0, z.max() - 2.5e-3), (0.0, 0.0, 1.0)),
        ),
    )
    run = solve(model)
    assert run.sections["a"].stress[-1, 2] == pytest.approx(1e6, rel=0.01)
    assert run.sections["b"].stress[-1, 2] == pytest.approx(1e6, rel=0.01)


def test_a_rigid_part_that_is_held_is_refused():
    with pytest.raises(InputError, match=r"rigid cube.*held or driven.*freedoms"):
        solve(one(cube(), boundaries=(Fixed("cube.z-"),), rigid=(Rigid("cube"),)))


DRIVEN = Driven("cube.z-", (0.0, 0.0, 1.0), TimeCurve((0.0,), (1.0,)))


@pytest.mark.parametrize(
    "other",
    [
        Driven("cube.z-", (0.0, 0.0, 1.0), TimeCurve((0.0,), (2.0,))),
        Driven("cube.x-", (0.0, 0.0, 1.0), TimeCurve((0.0,), (2.0,))),
        Driven("cube.z-", (0.0, 1.0, 1.0), TimeCurve((0.0,), (0.0,))),
    ],
)
def test_driving_nodes_twice_is_refused(other):
    with pytest.raises(InputError, match=r"common nodes.*right angles"):
        solve(one(cube(), boundaries=(DRIVEN, other)))


def test_driving_alike_or_across_is_no_conflict():
    """Two sides with a common edge and one velocity, and a third velocity across it."""
    alike = Driven("cube.x-", (0.0, 0.0, 1.0), TimeCurve((0.0,), (1.0,)))
    across = Driven("cube.z-", (0.0, 1.0, 0.0), TimeCurve((0.0,), (3.0,)))
    mesh = cube()
    edge = np.intersect1d(mesh.side("cube.x-"), mesh.side("cube.z-"))
    point = Point("edge", "cube", tuple(mesh.points[edge[0]]))
    run = solve(one(mesh, 5e-6, boundaries=(DRIVEN, alike, across), points=(point,)))
    assert run.points["edge"].velocity[-1, 1:] == pytest.approx([3.0, 1.0], rel=1e-9)


def tied_cubes(boundaries):
    """Two cubes, one on the other, tied where they meet."""
    low, high = cube("low"), cube("high")
    high = moved(high, (0.0, 0.0, 4e-3))
    return one(joined([low, high]), 5e-6, ties=(Tie("high.z-", "low.z+"),), boundaries=boundaries)


@pytest.mark.parametrize(
    "boundary",
    [
        Fixed("high.z-"),
        Guided("high.z-", (0.0, 0.0, 1.0)),
        Symmetry("high.x-"),
        Driven("high.z-", (0.0, 0.0, 1.0), TimeCurve((0.0,), (1.0,))),
    ],
)
def test_holding_or_driving_tied_nodes_that_follow_others_is_refused(boundary):
    with pytest.raises(InputError, match="which are tied and follow another side"):
        solve(tied_cubes((boundary,)))


def test_symmetry_of_both_tied_parts_is_that_of_the_tie():
    """A half model of two tied parts: the tied nodes on the plane stay in it with what they are tied to."""
    model = tied_cubes((Symmetry("low.x-"), Symmetry("high.x-"), Pressure("high.z+", TimeCurve((0.0,), (1e8,)))))
    place = model.mesh.points[np.intersect1d(model.mesh.side("high.x-"), model.mesh.side("high.z-"))[0]]
    run = solve(dataclasses.replace(model, points=(Point("edge", "high", tuple(place)),)))
    assert abs(run.points["edge"].displacement[:, 0]).max() < 1e-17
    assert run.points["edge"].displacement[-1, 2] < -1e-8


def test_rigid_parts_that_share_nodes_are_refused():
    whole = cube("low")
    mesh = dataclasses.replace(whole, part=(np.arange(64) >= 32).astype(np.int32), names=("low", "high"), sides={})
    with pytest.raises(InputError, match=r"rigid low.*common nodes with rigid high"):
        solve(one(mesh, rigid=(Rigid("low"), Rigid("high"))))


@pytest.mark.parametrize(
    ("rest", "field"),
    [
        ({"contacts": (SurfaceContact("low.z+", "high.z-"),)}, "contact low"),
        ({"walls": (RigidWall("low.z-", (0.0, 0.0, -1.0), (0.0, 0.0, 1.0)),)}, "wall low"),
    ],
)
def test_rigid_on_rigid_is_refused(rest, field):
    model = dataclasses.replace(tied_cubes(()), ties=(), rigid=(Rigid("low"), Rigid("high")), **rest)
    with pytest.raises(InputError, match=f"{field}.*rigid on rigid.*deforms"):
        solve(model)


# One step of each, by itself


def instant(rng, count, time=0.4e-6):
    """Nodes of different masses in motion, pulled by some forces; steps of velocity and position differ."""
    x, v, f = rng.uniform(-1.0, 1.0, (3, count, 3))
    return Now(time, 3e-7, 2e-7, x, 7.0 * v, 1e6 * f, rng.uniform(0.5, 2.0, count))


def moved_by(now, before):
    """Velocities after a step under the forces now."""
    return before + now.kick * now.f / now.mass[:, None]


def test_a_pressure_pushes_the_corners_of_bent_faces_by_its_integral_over_them(rng):
    """-p times the integral of N (x_xi x x_eta), which two Gauss points a direction give exactly."""
    now, faces = instant(rng, 12), np.array([[3, 5, 8, 11], [5, 2, 9, 8]])
    before = now.f.copy()
    pressed = Pressed(faces, TimeCurve((0.0, 1e-6), (2.0, 12.0)))
    pressed.add(now)
    expected = np.zeros((12, 3))
    for xi in (-(3.0**-0.5), 3.0**-0.5):
        for eta in (-(3.0**-0.5), 3.0**-0.5):
            shape = 0.25 * np.array(
                [(1 - xi) * (1 - eta), (1 + xi) * (1 - eta), (1 + xi) * (1 + eta), (1 - xi) * (1 + eta)]
            )
            by_xi, by_eta = 0.25 * np.array([[eta - 1, 1 - eta, 1 + eta, -1 - eta], [xi - 1, -1 - xi, 1 + xi, 1 - xi]])
            for face in faces:
                area = np.cross(by_xi @ now.x[face], by_eta @ now.x[face])
                expected[face] -= 6.0 * np.outer(shape, area)
    assert pressed.nodes.tolist() == [2, 3, 5, 8, 9, 11]
    np.testing.assert_allclose(pressed.force, expected[pressed.nodes], rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(now.f - before, expected, rtol=1e-8, atol=1e-9)


def test_dashpots_act_on_the_mean_of_the_velocities_before_and_after(rng):
    """F = -C (v + v_new) / 2 with v_new = v + dt (f + F) / m, and again once the step has changed."""
    now, nodes = instant(rng, 9), np.array([1, 4, 7])
    root = rng.uniform(-1.0, 1.0, (3, 3, 3))
    matrix = 1e6 * np.einsum("nij,nkj->nik", root, root)
    quiet = Dashpots(nodes, matrix)
    for kick in (3e-7, 8e-7):
        now.kick, now.f = kick, 1e6 * rng.uniform(-1.0, 1.0, (9, 3))
        quiet.add(now)
        after = moved_by(now, now.v)
        expected = -0.5 * np.einsum("nij,nj->ni", matrix, (now.v + after)[nodes])
        np.testing.assert_allclose(quiet.force, expected, rtol=1e-10)


def test_a_quiet_side_has_rho_c_p_across_and_rho_c_s_along_by_its_area():
    """A slanted side of six faces: the sum over its nodes; nodes that are not free have none."""
    mesh = turned(block("a", (0.6, 0.4, 0.5), 0.2, 0.2, 0.5), (1.0, 2.0, -1.0), 0.7)
    mesh = joined([mesh, block("b", (1.0, 1.0, 1.0), 1.0, 1.0, 1.0)])
    other = Elastic(2700.0, 70e9, 0.2)
    free = np.ones(len(mesh.points), bool)
    found = dashpots(mesh, [NonReflecting("a.z+")], {"a": STEEL, "b": other}, free)
    corners = mesh.points[mesh.side("a.z+")][0]
    normal = np.cross(corners[1] - corners[0], corners[3] - corners[0])
    normal /= np.linalg.norm(normal)
    across, along = (math.sqrt(STEEL.density * modulus) for modulus in (STEEL.wave_modulus, STEEL.shear_modulus))
    expected = 0.24 * (across * np.outer(normal, normal) + along * (np.eye(3) - np.outer(normal, normal)))
    np.testing.assert_allclose(found.matrix.sum(axis=0), expected, rtol=1e-12, atol=1e-9 * across)
    assert found.nodes.tolist() == np.unique(mesh.side("a.z+")).tolist()
    shares = np.sort(np.einsum("nii->n", found.matrix)) / np.trace(expected)
    np.testing.assert_allclose(shares, [1 / 24] * 4 + [1 / 12] * 6 + [1 / 6] * 2, rtol=1e-12)
    free[found.nodes[:3]] = False
    assert (
        dashpots(mesh, [NonReflecting("a.z+")], {"a": STEEL, "b": other}, free).nodes.tolist()
        == found.nodes[3:].tolist()
    )


def test_held_nodes_have_their_speed_along_what_is_held_and_what_it_takes_is_booked(rng):
    """One direction, two, and three, the speed of the middle of the step to come; later forces are taken up too."""
    now, nodes = instant(rng, 8), np.array([6, 2, 3])
    basis = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    directions = np.stack([np.where(np.arange(3)[:, None] < count, basis, 0.0) for count in (1, 2, 3)])
    hold = Held(nodes, directions, TimeCurve((0.0, 1e-6), (1.0, 5.0)))
    before, alone = now.v.copy(), now.f.copy()
    hold.add(now)
    now.f[nodes] += 2e5
    hold.add_rest(now)
    after = moved_by(now, before)
    held = np.einsum("nkc,nc->nk", directions, after[nodes])
    np.testing.assert_allclose(held[[0, 1, 1, 2, 2, 2], [0, 0, 1, 0, 1, 2]], 1.0 + 4e6 * 0.5e-6, rtol=1e-12)
    alone[nodes] += 2e5
    free = before + now.kick * alone / now.mass[:, None]
    np.testing.assert_allclose((after - free)[nodes[0]] @ basis[1:].T, 0.0, atol=1e-12)
    np.testing.assert_allclose((after - free)[nodes[1]] @ basis[2], 0.0, atol=1e-12)
    np.testing.assert_allclose(hold.force, (now.f - alone)[nodes], rtol=1e-9)
    work, *impulse = hold.done(after, now.kick)
    assert work == pytest.approx(now.kick * np.sum(hold.force * 0.5 * (before + after)[nodes]), rel=1e-13)
    np.testing.assert_allclose(impulse, now.kick * hold.force.sum(axis=0), rtol=1e-13)
    np.testing.assert_allclose(hold.now(), [np.sum(hold.force * before[nodes]), *hold.force.sum(axis=0)], rtol=1e-13)


def test_weight_is_mass_times_gravity_at_each_node(rng):
    now = instant(rng, 5)
    before, weight = now.f.copy(), Weight(now.mass, (0.0, 3.0, -9.81))
    weight.add(now)
    np.testing.assert_allclose(now.f - before, np.outer(now.mass, [0.0, 3.0, -9.81]), atol=1e-9)


@pytest.mark.parametrize(("angle", "count"), [(0.7e-6, 2), (1.5e-6, 3)])
def test_directions_less_than_a_millionth_apart_are_one(angle, count):
    """Guided along two axes: each holds what lies across; held along, driven, and driven twice alike."""
    mesh, axis = cube(), (math.sin(angle), 0.0, math.cos(angle))
    guides = [Guided("cube.z-", (0.0, 0.0, 1.0)), Guided("cube.z-", axis)]
    held = held_nodes(mesh, guides, prepare_ties((), mesh))
    assert (np.linalg.norm(held.directions, axis=2) > 0.5).sum(axis=1).tolist() == [count] * 25
    floor, push = Symmetry("cube.z-"), TimeCurve((0.0,), (1.0,))
    across = Driven("cube.z-", (math.cos(angle), 0.0, math.sin(angle)), push)
    twice = (Driven("cube.z-", (0.0, 0.0, 1.0), TimeCurve((0.0,), (2.0,))), across)
    for boundaries in ((floor, across), twice):
        model = one(mesh, 1e-6, boundaries=boundaries)
        if count == 2:
            solve(model)
        else:
            with pytest.raises(InputError, match="driven"):
                solve(model)


@pytest.mark.parametrize(("lean", "flat"), [(1.2e-3, True), (1.75e-3, False)])
def test_a_side_is_flat_where_its_normals_differ_by_less_than_a_millionth(lean, flat):
    """Two halves that lean to either side: 1 - cos is 0.7e-6, or 1.5e-6."""
    mesh = block("a", (2.0, 1.0, 1.0), 1.0, 1.0, 1.0)
    ridge = np.isclose(mesh.points[:, 0], 0.0) & (mesh.points[:, 2] > 0.5)
    mesh.points[ridge, 2] += math.tan(lean)
    ties = prepare_ties((), mesh)
    if flat:
        held = held_nodes(mesh, [Symmetry("a.z+")], ties)
        np.testing.assert_allclose(held.directions[:, 0], np.tile([0.0, 0.0, 1.0], (6, 1)), atol=1e-12)
    else:
        with pytest.raises(InputError, match="a flat side"):
            held_nodes(mesh, [Symmetry("a.z+")], ties)
