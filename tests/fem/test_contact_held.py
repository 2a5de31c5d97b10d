"""Contact of nodes that something else moves: boundaries, rigid bodies, ties; and nodes that come inside sideways."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.base.errors import InputError
from strikewave.fem._contact_kernels import add_wall
from strikewave.fem.bodies import RigidBody, surface_inverse_mass
from strikewave.fem.contact import add_contact, note_held, prepare, prepare_all, prepare_wall, searched
from strikewave.fem.engine import Engine
from strikewave.fem.mesh import joined
from strikewave.fem.model import (
    Controls,
    Driven,
    Fixed,
    Guided,
    Model,
    Rigid,
    RigidWall,
    SurfaceContact,
    Symmetry,
    Tie,
    TimeCurve,
)
from strikewave.fem.shapes import block, moved, turned
from strikewave.fem.solids import Bilinear, Elastic
from strikewave.fem.solve import solve

from . import blocks

STEEL = Elastic(7820.0, 211e9, 0.288)
LIGHT, HEAVY = Elastic(1200.0, 3e9, 0.3), Elastic(19000.0, 400e9, 0.2)
MM = 1e-3
PLATE = block("plate", (8 * MM, 8 * MM, MM), MM, MM, MM)
STRIKER = moved(block("striker", (4 * MM, 4 * MM, 4 * MM), MM, MM, MM), (0.0, 0.0, 1.01 * MM))
PAIR = SurfaceContact("plate.z+", "striker.z-")


def blow(solids, speed, duration=30e-6, parts=(PLATE, STRIKER), **more):
    """A striker that flies down on a plate at rest."""
    mesh = joined(list(parts))
    rest = {"contacts": (PAIR,), "velocity": {"striker": (0.0, 0.0, -speed)}} | more
    return Model(mesh, solids, Controls(duration, 0.5e-6), **rest)


def still(side, *direction):
    return Driven(side, direction, TimeCurve((0.0,), (0.0,)))


def directions(angle):
    """One held direction, at an angle from the z axis, and the state of its nodes."""
    rows = np.zeros((3, 3))
    rows[0] = np.sin(angle), 0.0, np.cos(angle)
    return rows


def let_go(v, nodes, held):
    """Take from velocities what is held."""
    v[nodes] -= np.einsum("ki,kj,nj->ni", held, held, v[nodes])


@given(st.floats(0.05, 1.5), st.floats(0.0, 2.0), st.integers(0, 100))
def test_a_wall_closes_the_gap_of_nodes_held_along_any_direction_at_one_rate(angle, mu, seed):
    """The force is what moves a node by s g* as the boundary lets it, m/(1 - (d.n)^2); friction at most stops it."""
    mesh, rng, held = blocks.block("a", (2, 2, 1)), np.random.default_rng(seed), directions(angle)
    wall = prepare_wall(RigidWall("a.bottom", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)), mesh)
    nodes, mass, dt = wall.touch.nodes, blocks.nodal_mass(mesh), 1e-3
    note_held(wall.touch, nodes, np.tile(held, (len(nodes), 1, 1)))
    v = rng.normal(0.0, 0.1, mesh.points.shape) - [0.0, 0.0, 1.0]
    let_go(v, nodes, held)
    coming = mesh.points[nodes] + dt * v[nodes]
    f = np.zeros_like(v)
    add_wall(wall, mesh.points, v, f, 1.0 / mass, dt)
    after = v + dt * f / mass[:, None]
    let_go(after, nodes, held)
    inside = coming[:, 2] < 0.0
    arrived = (mesh.points + dt * after)[nodes, 2]
    assert arrived[inside] == pytest.approx(0.2 * coming[inside, 2], rel=1e-9)
    if mu > 0.0:
        f[:] = 0.0
        add_wall(wall._replace(coefficient=mu), mesh.points, v, f, 1.0 / mass, dt)
        assert np.all(np.einsum("ni,ni->n", wall.touch.friction[:, :2], v[nodes, :2]) <= 0.0)
        rubbed, slide = dt * wall.touch.friction / mass[nodes, None], v[nodes] * [1.0, 1.0, 0.0]
        let_go(rubbed, np.arange(len(nodes)), held)
        taken = -np.einsum("ni,ni->n", rubbed, slide) / np.einsum("ni,ni->n", slide, slide)
        assert taken.max() <= 0.8 * (1.0 + 1e-12)


@given(st.floats(0.05, 1.5), st.floats(0.1, 1.0))
def test_a_contact_closes_the_gap_of_nodes_held_along_any_direction_at_one_rate(angle, s):
    """Node on node, both surfaces held along one direction: the gap after the step is (1 - s) g*.

    They slide by dt v beside each other: at most 2e-8 of the size of a face.
    """
    below, above = blocks.block("a", (2, 2, 1)), blocks.block("b", (2, 2, 1), origin=(0, 0, 1.0))
    mesh, held, dt = joined([below, above]), directions(angle), 1e-8
    state = prepare(SurfaceContact("a.top", "b.bottom", stiffness=s), mesh)
    nodes, mass = state.touch.nodes, blocks.nodal_mass(mesh)
    mass[: len(below.points)] *= 3.0
    note_held(state.touch, nodes, np.tile(held, (len(nodes), 1, 1)))
    v, f = np.zeros_like(mesh.points), np.zeros_like(mesh.points)
    v[len(below.points) :, 2] = -1.0
    let_go(v, nodes, held)
    add_contact(state, mesh.points, v, f, 1.0 / mass, dt)
    after = v + dt * f / mass[:, None]
    let_go(after, nodes, held)
    first, second = nodes[: state.touch.first], nodes[state.touch.first :]
    assert after[second, 2] - after[first, 2] == pytest.approx((1.0 - s) * v[second, 2], abs=1e-7)


@given(st.floats(0.02, 1.5), st.floats(0.0, 6.28), st.floats(0.1, 1.0))
def test_friction_stops_no_more_than_the_sliding_of_nodes_held_along_any_direction(angle, way, s):
    """Held almost along the normal they are heavy there and light beside it: a held body below, mu = 10."""
    below, above = blocks.block("a", (2, 2, 1)), blocks.block("b", (2, 2, 1), origin=(0, 0, 1.0))
    mesh, held, dt = joined([below, above]), directions(angle), 1e-8
    state = prepare(SurfaceContact("a.top", "b.bottom", 10.0, s), mesh)
    nodes, light = state.touch.nodes[state.touch.first :], 1.0 / blocks.nodal_mass(mesh)
    light[: len(below.points)] = 0.0
    note_held(state.touch, nodes, np.tile(held, (len(nodes), 1, 1)))
    v, f = np.zeros_like(mesh.points), np.zeros_like(mesh.points)
    v[len(below.points) :] = np.cos(way), np.sin(way), -1.0
    let_go(v, nodes, held)
    add_contact(state, mesh.points, v, f, light, dt)
    rubbed, slide = dt * state.touch.friction[state.touch.first :] * light[nodes, None], v[nodes] * [1.0, 1.0, 0.0]
    let_go(rubbed, np.arange(len(nodes)), held)
    taken = -np.einsum("ni,ni->n", rubbed, slide) / np.einsum("ni,ni->n", slide, slide)
    assert taken.max() <= s * (1.0 + 1e-6)


def test_where_nothing_touches_nodes_arrive_where_contact_foresees_them():
    """Driven, held and free nodes, under gravity and stress."""
    shove = TimeCurve((0.0, 1e-6), (0.0, 3.0))
    boundaries = (Driven("plate.z+", (1.0, 0.0, 0.0), shove), Fixed("plate.z-"), Symmetry("striker.x-"))
    model = blow({"plate": LIGHT, "striker": STEEL}, 5.0, boundaries=boundaries, gravity=(0.0, 3e5, -1e6))
    engine = Engine(model)
    state = engine.contacts[PAIR.name]
    for _ in range(5):
        engine.assemble_forces()
        assert not state.nodal.touches.any()
        engine.step()
        assert state.place == pytest.approx(engine.x[state.touch.nodes], abs=1e-16)


def test_a_block_driven_along_a_wall_is_stopped_by_it_as_a_free_one():
    """Without lateral strain, and bulk viscosity, the drive along x at the block's own speed does nothing."""
    solid, low = Elastic(7820.0, 211e9, 0.0), STRIKER.points[:, 2].min()
    wall = (RigidWall("striker.z-", (0.0, 0.0, low), (0.0, 0.0, 1.0)),)
    drive = tuple(Driven(f"striker.{side}", (1.0, 0.0, 0.0), TimeCurve((0.0,), (1.0,))) for side in ("z-", "z+"))
    forces = []
    for held in ((), drive):
        model = blow({"striker": solid}, 5.0, parts=(STRIKER,), contacts=(), walls=wall, boundaries=held)
        controls = replace(model.controls, linear_viscosity=0.0, quadratic_viscosity=0.0)
        run = solve(replace(model, controls=controls, velocity={"striker": (1.0, 0.0, -5.0)}))
        forces.append(run.force["striker.z--wall"])
    free, driven = forces
    assert free[:, 2].max() > 1e3
    assert driven == pytest.approx(free, abs=1e-9 * free.max())


def test_nodes_driven_along_the_plate_meet_a_striker_as_guided_ones():
    """Held by speeds of zero along x and y or guided along z: the same; and no energy comes from the contact."""
    solids = {"plate": LIGHT, "striker": HEAVY}
    ways = (still("plate.z+", 1, 0, 0), still("plate.z+", 0, 1, 0)), (Guided("plate.z+", (0.0, 0.0, 1.0)),)
    driven, guided = (solve(blow(solids, 2.0, boundaries=(*way, Fixed("plate.z-")))) for way in ways)
    force = guided.force[PAIR.name]
    assert driven.force[PAIR.name] == pytest.approx(force, abs=1e-9 * np.abs(force).max())
    for run in (driven, guided):
        assert run.energy["contact"].min() >= 0.0
        assert run.momentum_error < 1e-12
        assert run.energy_error.max() < 2e-3


def test_a_driven_face_presses_a_bar_with_rho_c_area_times_speed():
    """A piston at constant speed and a bar at rest, without lateral strain.

    Source: Graff 1975, Wave Motion in Elastic Solids, sec. 2.4. The mean over 2 to 7 us levels the ringing of the mesh.
    """
    solid = Elastic(7820.0, 211e9, 0.0)
    bar = moved(block("striker", (4 * MM, 4 * MM, 40 * MM), MM, MM, MM), (0.0, 0.0, 1.0001 * MM))
    drive = tuple(Driven(f"plate.{side}", (0.0, 0.0, 1.0), TimeCurve((0.0,), (2.0,))) for side in ("z-", "z+"))
    run = solve(blow({"plate": solid, "striker": solid}, 0.0, 8e-6, (PLATE, bar), boundaries=drive))
    force = -run.force[PAIR.name][:, 2]
    assert force[4:15].mean() == pytest.approx(7820.0 * solid.wave_speed * 2.0 * (4 * MM) ** 2, rel=0.01)
    assert run.momentum_error < 1e-12


@pytest.mark.parametrize("density", [10.0, 7820.0, 78200.0])
def test_a_locked_rigid_anvil_is_as_hard_as_fixed_nodes_whatever_its_density(density):
    fixed = solve(blow({"plate": STEEL, "striker": STEEL}, 5.0, boundaries=(Fixed("plate"),)))
    anvil = Elastic(density, 211e9, 0.3)
    locked = (Rigid("plate", (False,) * 3, (False,) * 3),)
    rigid = solve(blow({"plate": anvil, "striker": STEEL}, 5.0, rigid=locked))
    force = fixed.force[PAIR.name]
    # the step is that of the striker here, of both parts there: what contact takes and the ringing differ a little
    assert rigid.force[PAIR.name][:, 2].min() == pytest.approx(force[:, 2].min(), rel=0.02)
    assert rigid.impulse[PAIR.name][-1, 2] == pytest.approx(fixed.impulse[PAIR.name][-1, 2], rel=0.02)


FREEDOMS = [
    ((True,) * 3, (True,) * 3),
    ((False, False, True), (False,) * 3),
    ((True, False, True), (False, True, True)),
]


@pytest.mark.parametrize(("moves", "turns"), FREEDOMS)
def test_nodes_in_place_of_a_rigid_body_move_no_less_than_it_and_no_more_than_they_must(moves, turns):
    """Mobilities compared under all forces on the surface: the eigenvalues of G against diag(1/m) reach 1, not more."""
    mesh = turned(block("body", (3.0, 2.0, 1.0), 1.0, 0.5, 0.5), (1.0, 2.0, 0.5), 0.7)
    mass = blocks.nodal_mass(mesh)
    body = RigidBody(mesh, Rigid("body", moves, turns), mass, np.zeros(3))
    free = surface_inverse_mass(body, mesh, "body")
    nodes = np.flatnonzero(free > 0.0)
    assert np.array_equal(nodes, np.unique(mesh.side("body.all")))
    mobility = np.zeros((3 * len(nodes), 3 * len(nodes)))
    turn = np.linalg.inv(body.inertia[np.ix_(turns, turns)])
    axes = np.eye(3)[list(turns)]
    for k, arm in enumerate(body.arms[nodes]):
        for c, force in enumerate(np.eye(3)):
            spin = axes.T @ turn @ axes @ np.cross(arm, force)
            moved_by = np.where(moves, force / body.mass, 0.0) + np.cross(spin, body.arms[nodes])
            mobility[:, 3 * k + c] = moved_by.ravel()
    root = np.sqrt(np.repeat(free[nodes], 3))
    assert np.linalg.eigvalsh(mobility / np.outer(root, root)).max() == pytest.approx(1.0, rel=1e-9)
    if not any(turns):
        assert np.sum(1.0 / free[nodes]) == pytest.approx(body.mass, rel=1e-12)


@pytest.mark.parametrize("density", [1.0, 100.0, 7820.0])
def test_rigid_plates_lighter_than_what_strikes_them_gain_no_energy(density):
    """Between two strikers, with friction; the lightest has 1/8000 of the mass of the layers of nodes it meets."""
    other = moved(block("other", (3 * MM, 3 * MM, 3 * MM), MM, MM, MM), (0.2 * MM, 0.1 * MM, -3.01 * MM))
    run = solve(
        blow(
            {"plate": Elastic(density, 211e9, 0.3), "striker": STEEL, "other": STEEL},
            5.0,
            parts=(PLATE, STRIKER, other),
            rigid=(Rigid("plate"),),
            velocity={"striker": (1.0, 0.0, -5.0), "other": (0.0, 0.5, 5.0)},
            contacts=(replace(PAIR, friction=0.3), SurfaceContact("plate.z-", "other.z+", 0.3)),
        )
    )
    taken = run.energy["contact"]
    assert taken.min() >= 0.0
    assert run.momentum_error < 1e-12
    assert run.energy_error.max() < 0.015
    # the strikers have bounced off each other through the plate
    assert run.parts["striker"].velocity[-1, 2] > run.parts["other"].velocity[-1, 2] - 5.0


def side_blow():
    """A heavy striker on the edge of a light plate that is tied to a base by its bottom."""
    base = moved(block("base", (12 * MM, 12 * MM, 2 * MM), 3 * MM, 3 * MM, MM), (0.0, 0.0, -2 * MM))
    striker = moved(block("striker", (2 * MM, 4 * MM, 0.9 * MM), MM, MM, 0.45 * MM), (5.01 * MM, 0.0, 0.05 * MM))
    return blow(
        {"plate": LIGHT, "striker": HEAVY, "base": LIGHT},
        5.0,
        parts=(PLATE, striker, base),
        ties=(Tie("plate.z-", "base.z+"),),
        contacts=(SurfaceContact("plate.all", "striker.x-"),),
        velocity={"striker": (-5.0, 0.0, 0.0)},
    )


def test_tied_nodes_are_met_but_not_checked_and_count_by_their_own_mass():
    wall = RigidWall("plate.all", (0.0, 0.0, -MM), (0.0, 0.0, 1.0))
    engine = Engine(replace(side_blow(), walls=(wall,)))
    assert not np.isin(engine.walls[wall.name].touch.nodes, engine.ties.nodes).any()
    state = engine.contacts["plate.all-striker.x-"]
    tied = np.isin(state.touch.nodes, engine.ties.nodes)
    assert tied.sum() == 81
    assert np.array_equal(state.checked, ~tied)
    assert engine.yielding[engine.ties.nodes] == pytest.approx(1.0 / engine.own_mass[engine.ties.nodes], rel=1e-15)


def test_a_heavy_striker_gains_nothing_from_the_tied_edge_of_a_light_plate():
    run = solve(side_blow())
    assert run.impulse["plate.all-striker.x-"][-1, 0] < 0.0
    assert run.energy["contact"].min() >= 0.0
    assert run.energy_error.max() < 5e-3
    assert run.momentum_error < 1e-12


def test_a_wall_is_not_there_for_tied_nodes():
    mesh = joined([PLATE, STRIKER])
    tied = np.unique(mesh.side("plate.z-"))
    wall = prepare_wall(RigidWall("plate.all", (0.0, 0.0, -MM), (0.0, 0.0, 1.0)), mesh, tied)
    assert np.array_equal(wall.touch.nodes, np.unique(mesh.side("plate.z+")))


@pytest.mark.verify
def test_a_plate_squashed_between_two_strikers_gives_no_energy():
    """Nodes deep in elements that are squashed to nothing come closer to the far faces; nobody pressed them in there."""
    thin = 0.2 * MM
    plate = block("plate", (10 * MM, 10 * MM, thin), MM, MM, thin)
    one = moved(block("striker", (2 * MM,) * 3, 0.7 * MM, 0.7 * MM, 0.7 * MM), (MM, 0.5 * MM, thin + 1e-5))
    two = moved(block("other", (2 * MM,) * 3, 0.5 * MM, 0.5 * MM, 0.5 * MM), (-0.3 * MM, -0.5 * MM, -2 * MM - 1e-5))
    soft = Bilinear(7820.0, 211e9, 0.288, yield_strength=500e6, tangent_modulus=1e9)
    run = solve(
        blow(
            {"plate": soft, "striker": STEEL, "other": STEEL},
            300.0,
            20e-6,
            (plate, one, two),
            velocity={"striker": (0.0, 0.0, -300.0), "other": (0.0, 0.0, 300.0)},
            contacts=(
                SurfaceContact("plate.all", "striker.all"),
                SurfaceContact("plate.all", "other.all"),
                SurfaceContact("striker.all", "other.all"),
            ),
        )
    )
    taken = run.energy["contact"] / run.initial_energy
    assert taken.min() >= 0.0
    assert (np.maximum.accumulate(taken) - taken).max() < 0.02  # a penalty gives back a little of what it took


@given(st.floats(0.02, 0.2), st.floats(-0.5, 0.5), st.floats(0.0, 0.5))
def test_a_node_that_comes_in_beside_the_rim_is_not_thrown_out(depth, away, mu):
    """A plate of free masses that slides in from the side, below the surface of the other."""
    below, above = (
        blocks.block("a", (3, 3, 1), (1, 1, 1)),
        blocks.block("b", (2, 2, 1), (1, 1, 1), (1.2, 0.1, 1 - depth)),
    )
    mesh, count = joined([below, above]), len(below.points)
    mass, x, v = blocks.nodal_mass(mesh), mesh.points.copy(), np.zeros_like(mesh.points)
    v[count:] = -1.0, 0.0, 0.1 * away
    state, dt, begin = prepare(SurfaceContact("a.top", "b.bottom", mu), mesh), 1e-2, 0.5 * np.sum(mass[:, None] * v**2)
    for _ in range(80):
        f = np.zeros_like(x)
        again = add_contact(state, x, v, f, 1.0 / mass, dt)
        v += dt * f / mass[:, None]
        x += dt * v
        assert 0.5 * np.sum(mass[:, None] * v**2) <= begin * (1.0 + 1e-12)
        state = searched(state, x) if again else state


@pytest.mark.verify
@given(st.integers(0, 1000), st.floats(0.02, 0.4))
def test_candidates_hold_every_face_within_reach_while_bodies_fly(seed, first):
    """Speeds that change by up to a factor of 2 a step; ``first`` is the motion of the first step over the margin."""
    rng = np.random.default_rng(seed)
    mesh = joined([blocks.block("a", (3, 3, 1)), blocks.block("b", (4, 4, 1), origin=(0.1, 0.2, 1.4))])
    state = prepare(SurfaceContact("a.top", "b.bottom"), mesh)
    high, size, margin, x = state.touch.first, state.size.copy(), state.margin, mesh.points.copy()
    state, speed = searched(state, x), first * margin
    for _ in range(60):
        v = np.zeros_like(x)
        v[16 * 2 :, 2] = -speed
        again = add_contact(state, x, v, np.zeros_like(x), np.zeros(len(x)), 1.0)
        x += v
        place = x[state.touch.nodes]
        assert state.travel[0] <= max(margin, speed) * (1.0 + 1e-12)
        corners = place[state.faces]
        low, top = corners.min(axis=1) - 0.25 * size[:, None], corners.max(axis=1) + 0.25 * size[:, None]
        for n in range(len(place)) if speed <= margin else ():
            others = np.arange(state.first_faces) if n >= high else np.arange(state.first_faces, len(state.faces))
            near = others[np.all((low[others] < place[n]) & (place[n] < top[others]), axis=1)]
            assert set(near) <= set(state.candidates[state.start[n] : state.start[n + 1]])
        state = searched(state, x) if again else state
        speed = min(speed * rng.uniform(0.5, 2.0), 0.4 * margin)


@pytest.mark.parametrize(
    "second", [("striker.z-", "plate.z+"), ("plate.z+", "striker.z-"), ("striker.all", "plate.all")]
)
def test_faces_that_meet_in_two_contacts_are_refused(second):
    mesh = joined([PLATE, STRIKER])
    with pytest.raises(InputError, match=r"faces that meet already in plate\.z\+-striker\.z-.*leave one"):
        prepare_all([PAIR, SurfaceContact(*second)], mesh)
    others = [PAIR, SurfaceContact("plate.z-", "striker.z-"), SurfaceContact("striker.z+", "plate.z+")]
    assert list(prepare_all(others, mesh)) == [contact.name for contact in others]
