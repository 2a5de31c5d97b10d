"""What bodies do between two blows: what is gone, how they rest and go back, rigid parts among them, rebound."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from strikewave.fem import _layout as layout
from strikewave.fem import solve
from strikewave.fem.bodies import way_back
from strikewave.fem.engine import Engine
from strikewave.fem.mesh import Mesh, joined
from strikewave.fem.model import (
    Controls,
    Driven,
    Fixed,
    Model,
    NonReflecting,
    Pressure,
    Rigid,
    RigidWall,
    SurfaceContact,
    Symmetry,
    TimeCurve,
)
from strikewave.fem.restart import put_back, state_of
from strikewave.fem.run import restitution, still_presses
from strikewave.fem.shapes import block, moved
from strikewave.fem.solids import Bilinear, Elastic
from strikewave.fem.solve import RunOptions, _Watch, bodies_of_engine, next_blow, quiet, settle, solve_blows

from .bodies import STEEL

SOFT = Bilinear(7820.0, 211e9, 0.288, yield_strength=200e6, tangent_modulus=2e9)
SIZE = 2e-3


def headed(solid=SOFT, speed=30.0, **fields):
    """A rod of 20 mm on a wall, whose upper 6 mm are a part of their own that shares nodes with it."""
    rod = block("rod", (2 * SIZE, 2 * SIZE, 10 * SIZE), SIZE, SIZE, SIZE)
    part = (rod.points[rod.hexahedra].mean(axis=1)[:, 2] > rod.points[:, 2].max() - 3 * SIZE).astype(np.int32)
    order = np.argsort(part, kind="stable")
    mesh = Mesh(rod.points, rod.hexahedra[order], part[order], ("rod", "head"), {"rod.z-": rod.side("rod.z-")})
    wall = RigidWall("rod.z-", (0.0, 0.0, rod.points[:, 2].min()), (0.0, 0.0, 1.0))
    hit = {"rod": (0.0, 0.0, -speed), "head": (0.0, 0.0, -speed)}
    asked = {"velocity": hit, "walls": (wall,), **fields}
    return Model(mesh, {"rod": solid, "head": STEEL}, Controls(60e-6, 0.5e-6), **asked)


def blows(model, count):
    return solve_blows(replace(model, controls=replace(model.controls, blows=count)), RunOptions(frames=2))


# --- rigid parts that share nodes with others -----------------------------------------------------------------------


def row_at_head(model, frame):
    """Mean height of the row of elements below the head."""
    mesh, places = model.mesh, model.mesh.points + frame.displacement
    level = mesh.points[mesh.nodes_of("head"), 2].min()
    top, low = (np.isclose(mesh.points[:, 2], z) for z in (level, level - SIZE))
    return places[top, 2].mean() - places[low, 2].mean()


def test_a_body_goes_back_with_its_rigid_part():
    """The row below it keeps its height; that of its own rest is 2 mm but for 2e-4 of plastic strain."""
    model = headed(rigid=(Rigid("head"),))
    first, second = blows(model, 2)
    begins = second.frames[0]
    assert first.plastic_strain["rod"][-1] > 0.02
    assert np.abs(second.parts["head"].displacement[0]).max() < 1e-12
    assert row_at_head(model, begins) == pytest.approx(SIZE, abs=5e-7)


def test_a_rigid_part_on_a_rod_that_is_held_stays_where_it_rests():
    """Its way back would stretch the rod, which yielded and is shorter now."""
    hit = {"velocity": {"head": (0.0, 0.0, -60.0)}, "walls": (), "boundaries": (Fixed("rod.z-"),)}
    model = headed(rigid=(Rigid("head"),), **hit)
    first, second = blows(model, 2)
    begins = second.frames[0]
    sunk = second.parts["head"].displacement[0]
    assert sunk[2] < -50e-6
    assert begins.displacement[model.mesh.nodes_of("head")] == pytest.approx(np.tile(sunk, (36, 1)), abs=1e-6)
    assert np.abs(begins.displacement[np.unique(model.mesh.side("rod.z-"))]).max() == 0.0
    assert row_at_head(model, begins) == pytest.approx(row_at_head(model, first.frames[-1]), rel=2e-3)
    assert second.parts["head"].velocity[0] == pytest.approx((0.0, 0.0, -60.0), abs=1e-9)
    assert -60.0 * 0.5e-6 < second.parts["head"].displacement[1, 2] - sunk[2] < 0.0


def test_pieces_of_a_part_that_nothing_joins_go_back_by_themselves():
    """One shifted, one turned: two bodies of one part, each where it began, each with its own stress turned."""
    one = block("cubes", (4e-3,) * 3, SIZE, SIZE, SIZE)
    both = joined([one, replace(moved(one, (20e-3, 0.0, 0.0)), names=("others",), sides={})])
    mesh = replace(both, part=np.zeros_like(both.part), names=("cubes",), sides={})
    engine = Engine(Model(mesh, {"cubes": STEEL}, Controls(1e-6)))
    half = len(one.points)
    turn = Rotation.from_rotvec((0.0, 0.0, np.pi / 2)).as_matrix()
    give_stress(engine, np.tile((5e6, 1e6, 0.0, 0.0, 0.0, 0.0), (engine.elements, 1)))
    engine.x[:half] += [0.0, 1e-3, 2e-3]
    engine.x[half:] = engine.x[half:] @ turn.T
    bodies = bodies_of_engine(engine)
    solve._bring_back(engine, bodies)
    assert [body.parts for body in bodies] == [("cubes",), ("cubes",)]
    assert engine.x == pytest.approx(mesh.points, abs=1e-15)
    found, _ = engine.solid.cell_values(engine.elements)
    assert found[:8, :2] == pytest.approx(np.tile((5e6, 1e6), (8, 1)))
    assert found[8:, :2] == pytest.approx(np.tile((1e6, 5e6), (8, 1)))


def test_a_pinned_rigid_part_goes_back_about_its_pin():
    """Locked in translation and about x and y, it leaves its body one turn about its own centre, of any size."""
    pin = Rigid("head", (False, False, False), (False, False, True))
    model = headed(velocity={}, walls=(), rigid=(pin,))
    engine = Engine(model)
    (body,) = bodies_of_engine(engine)
    assert body.motions.shape[1] == 1
    centre = engine.bodies[0].centre
    turn = Rotation.from_rotvec((0.0, 0.0, 1.2)).as_matrix()
    now = (engine.x - centre) @ turn.T + centre
    rotation, shift = way_back(body, engine.x, now)
    assert now @ rotation.T + shift == pytest.approx(engine.x, abs=1e-15)


def test_a_screw_about_an_axis_beside_the_centre_keeps_to_it():
    """Nodes on an edge are held: what is left is the turn about that edge, and a way back of 1.2 rad keeps them."""
    cube = block("cube", (4e-3, 4e-3, 4e-3), SIZE, SIZE, SIZE)
    model = Model(cube, {"cube": STEEL}, Controls(1e-6, 1e-6))
    engine = Engine(model)
    (body,) = bodies_of_engine(engine)
    edge = np.flatnonzero(np.isclose(cube.points[:, 0], cube.points[:, 0].min()) & np.isclose(cube.points[:, 2], 0.0))
    pole = cube.points[edge[0]]
    rows = body.modes(cube.points[edge], body.centre).reshape(-1, 6)
    values, vectors = np.linalg.eigh(rows.T @ rows)
    hinged = replace(body, motions=vectors[:, values < 1e-12])
    assert hinged.motions.shape[1] == 1
    turn = Rotation.from_rotvec((0.0, 1.2, 0.0)).as_matrix()
    rotation, shift = way_back(hinged, cube.points, (cube.points - pole) @ turn.T + pole)
    assert pole @ rotation.T + shift == pytest.approx(pole, abs=1e-15)
    assert rotation == pytest.approx(turn.T, abs=1e-12)


def test_a_turned_rigid_part_comes_to_rest_as_it_stands():
    """A rod that flies turned by half a radian is not wrung at its rigid head: no work, and nothing that moves."""
    engine = Engine(headed(velocity={}, walls=(), rigid=(Rigid("head"),)))
    turn = Rotation.from_rotvec((0.3, 0.4, 0.0)).as_matrix()
    engine.x[:] = engine.x @ turn.T
    head = engine.bodies[0]
    head.centre, head.turned = turn @ head.centre, turn
    found = next_blow(engine, 1.0)
    assert found.rest.plastic_energy == 0.0
    assert found.rest.kinetic_share < 1e-20
    assert np.abs(found.x - found.model.mesh.points).max() < 1e-15


# --- what is gone, and what is not ----------------------------------------------------------------------------------


def test_between_blows_nothing_drives_presses_or_weighs():
    """Of boundaries only what holds is left."""
    curve = TimeCurve((0.0, 1.0), (1.0, 1.0))
    loads = (Driven("rod.z-", (0.0, 0.0, 1.0), curve), Pressure("rod.z-", curve), NonReflecting("rod.z-"))
    calm = quiet(headed(gravity=(0.0, 0.0, -9.81), boundaries=(*loads, Fixed("rod.z-"))))
    assert calm.gravity == (0.0, 0.0, 0.0)
    assert calm.boundaries == (Fixed("rod.z-"),)


def test_stress_turns_with_a_body_that_goes_back():
    """Turned by 90 degrees about z in flight: what was sigma_xx on the way is sigma_yy where it began."""
    for full in ((), ("cube",)):
        engine = Engine(Model(block("cube", (4e-3,) * 3, *[SIZE] * 3), {"cube": STEEL}, Controls(1e-6, full=full)))
        turn = Rotation.from_rotvec((0.0, 0.0, np.pi / 2)).as_matrix()
        given = np.array([5e6, 1e6, 2e6, 3e6, 4e6, 6e6])
        give_stress(engine, np.tile(given, (engine.elements, 1)))
        engine.x[:] = engine.x @ turn.T
        solve._bring_back(engine, bodies_of_engine(engine))
        found, _ = engine.solid.cell_values(engine.elements)
        expected = (1e6, 5e6, 2e6, -3e6, -6e6, 4e6)  # by R s R^T: yy xx zz -xy -zx yz
        assert found == pytest.approx(np.tile(expected, (engine.elements, 1)), rel=1e-9)


def give_stress(engine, stress):
    """Give each element a stress (elements, 6), Pa: xx yy zz xy yz zx."""
    for kind in engine.solid.kinds:
        rows = kind.blocks.state.reshape(-1, kind.points, layout.STATES, layout.LANES)
        rows[:, :, :6] = stress[kind.number].transpose(0, 2, 1)[:, None]


def plate_on_base(lift=0.0, speed=4.0):
    """A striker above a base that is held; ``lift`` (m) is the gap, an overlap where it is below 0."""
    base = block("base", (8e-3, 8e-3, 4e-3), SIZE, SIZE, SIZE)
    up = block("up", (4e-3, 4e-3, 4e-3), SIZE, SIZE, SIZE)
    up = moved(up, (0.0, 0.0, base.points[:, 2].max() - up.points[:, 2].min() + lift))
    return Model(
        joined([base, up]),
        {"base": STEEL, "up": STEEL},
        Controls(30e-6, 0.5e-6),
        velocity={"up": (0.0, 0.0, -speed)},
        contacts=(SurfaceContact("up.z-", "base.z+"),),
        boundaries=(Fixed("base.z-"),),
    )


def test_an_overlap_that_was_there_before_the_first_blow_moves_nothing():
    """5 um of the mesh: what strikes begins the second blow there too, and it is let out without a force."""
    first, second = blows(plate_on_base(lift=-5e-6), 2)
    assert second.rest.overlap == pytest.approx(5e-6, abs=1e-8)
    assert second.rest.added_distance < 1e-8
    name = "up.z--base.z+"
    assert second.impulse[name][-1, 2] == pytest.approx(first.impulse[name][-1, 2], rel=1e-4)


def test_a_later_blow_from_a_file_tells_no_overlap_of_the_mesh():
    """Overlaps are those of the first blow."""
    engine = Engine(plate_on_base(lift=-5e-6))
    assert engine.overlaps
    later = {**state_of(engine), "blow": np.asarray(2)}
    put_back(engine, later)
    assert engine.overlaps == []


def test_where_nothing_is_too_deep_nothing_is_tried_twice(monkeypatch):
    """One round over the contacts, not 30."""
    engine, rounds = Engine(plate_on_base()), []
    monkeypatch.setattr(solve, "_depths", lambda engine: rounds.append(1) or {})
    assert solve._step_back(engine, bodies_of_engine(engine), {}) == 0.0
    assert len(rounds) == 1


# --- the way to rest ------------------------------------------------------------------------------------------------


def test_yield_on_the_way_to_rest_is_counted():
    """An element pulled to 280 MPa and let go: with kinematic hardening it yields below -120 MPa.

    A swing of it takes eight steps; the one in which it is seen to have passed rest carries it beyond. All reverse flow
    dp is between -120 and -280 MPa, and so its work over dp and the volume, to the half step in which it begins.
    """
    solid, side = Bilinear(1000.0, 100e9, 0.0, yield_strength=200e6, tangent_modulus=20e9, kinematic=1.0), 10e-3
    pull = Driven("cube.z+", (0.0, 0.0, 1.0), TimeCurve((0.0, 200e-6), (0.3, 0.3)))
    planes = tuple(Symmetry(f"cube.{axis}-") for axis in "xyz")
    cube = block("cube", (side,) * 3, side, side, side)
    model = Model(cube, {"cube": solid}, Controls(200e-6, 1e-6), boundaries=(*planes, pull))
    first, second = blows(model, 2)
    assert (first.blow, second.blow) == (1, 2)
    flowed = second.frames[0].plastic_strain[0] - first.frames[-1].plastic_strain[0]
    assert flowed > 1e-4
    assert 0.9 * 120e6 < second.rest.plastic_energy / (flowed * side**3) < 280e6
    before = first.energy["plastic"][-1] + second.rest.plastic_energy
    assert second.rest.plastic_before == pytest.approx(before, rel=1e-12)


def test_a_small_motion_that_has_only_begun_is_no_rest():
    """A bar stretched as sin(pi z/L) is far from rest two steps on, though it hardly moves; its swing takes 120 steps.

    It rests once that swing has been taken away, and a wave gone to and fro without another.
    """
    bar = block("bar", (SIZE, SIZE, 60 * SIZE), SIZE, SIZE, SIZE)
    engine = Engine(Model(bar, {"bar": Elastic(7820.0, 211e9, 0.0)}, Controls(1e-6)))
    height = bar.points[bar.hexahedra].mean(axis=1)[:, 2] - bar.points[:, 2].min()
    stress = np.zeros((60, 6))
    stress[:, 2] = 100e6 * np.sin(np.pi * height / (60 * SIZE))
    give_stress(engine, stress)
    engine.initialize()
    stored = float(np.sum(stress[:, 2] ** 2)) / (2.0 * 211e9) * SIZE**3
    found = settle(engine, bodies_of_engine(engine), 0.02 * stored, 10_000)
    assert found.maxima >= 1
    assert found.steps > 2 * 60
    left, _ = engine.solid.cell_values(60)
    assert np.abs(left[:, 2]).max() < 0.1 * 100e6


def test_a_body_rests_after_as_many_small_steps_as_its_longest_rise_took():
    """A slow swing that rose over 500 steps may be rising again as long; a wave goes to and fro in far fewer."""
    engine = Engine(headed(velocity={}, walls=()))
    watch = _Watch(engine, bodies_of_engine(engine), 1.0)
    crossing, rise = int(watch.longest[0]), 500
    assert crossing < rise
    for energy in np.linspace(2.0, 3.0, rise):
        assert not watch.passed(np.array([energy])).any()
    assert watch.passed(np.array([2.5])).all()
    small = 0
    while not watch.over and small < 2 * rise:
        watch.passed(np.array([0.5]))
        small += 1
    assert small == rise + 2


def test_the_watch_on_two_bodies_by_hand():
    """Half of 2 J each is small. A wave goes to and fro over the diagonal of 3 x 4 x 12 m in 13 steps, or in 26."""
    mesh = joined(
        [block("a", (3.0, 4.0, 12.0), 3.0, 4.0, 12.0), moved(block("b", (6.0, 8.0, 24.0), 6.0, 8.0, 24.0), (9.0, 0, 0))]
    )
    solids = {
        "a": SimpleNamespace(wave_speed=4.0),
        "b": SimpleNamespace(wave_speed=4.0),
        "c": SimpleNamespace(wave_speed=9.0),
    }
    engine = SimpleNamespace(x=mesh.points, model=SimpleNamespace(mesh=mesh, solids=solids), dt_next=0.51)
    bodies = [SimpleNamespace(nodes=np.arange(8 * k, 8 * k + 8), parts=("c", name)) for k, name in enumerate("ab")]
    watch = _Watch(engine, bodies, 2.0)
    assert watch.owner.tolist() == [0] * 8 + [1] * 8
    assert watch.longest.tolist() == [13, 26]  # 26 / (4 0.51) = 12.7 and 25.5
    passed = [
        watch.passed(np.array(now)).tolist() for now in ([5.0, 0.4], [8.0, 3.0], [6.0, 0.9], [1.0, 0.7], [0.5, 0.8])
    ]
    # the second falls below what counts, which is no maximum; after its own the first begins from nothing
    assert passed == [[False] * 2, [False] * 2, [True, False], [False] * 2, [False] * 2]
    assert (watch.maxima.tolist(), watch.rise.tolist(), watch.small.tolist()) == ([1, 0], [2, 5], [2, 3])
    assert watch.left.tolist() == [1.0, 0.9]
    assert watch.energy.tolist() == [0.5, 0.8]
    assert not watch.over
    for _ in range(24):
        watch.passed(np.array([0.1, 0.1]))
    assert (watch.small.tolist(), watch.over) == ([26, 27], True)
    watch.small[1] = 26
    assert not watch.over
    watch.maxima[1] = 300
    assert watch.over


@pytest.mark.parametrize(("contacts", "times"), [((SurfaceContact("up.z-", "base.z+"),), 2), ((), 1)])
def test_bodies_that_touch_come_to_rest_again_once_they_are_back(monkeypatch, contacts, times):
    """Bodies that go on to touch meet anew where they have gone back to; others have nothing to settle."""
    calls = []

    def counted(*given):
        calls.append(given[0])
        return settle(*given)

    monkeypatch.setattr(solve, "settle", counted)
    engine = Engine(replace(plate_on_base(speed=0.0), velocity={}, contacts=contacts))
    next_blow(engine, 1.0)
    assert len(calls) == times


# --- rebound --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("duration", [40e-6, 44e-6, 50e-6, 61e-6])
def test_restitution_is_that_of_the_body_whenever_the_run_ends(duration):
    """A rod of two parts that share nodes, off the wall since 30 us: its momentum is the same from then on."""
    model = headed(Elastic(7820.0, 211e9, 0.288), speed=3.0)
    (run,) = blows(replace(model, controls=Controls(duration, 0.5e-6)), 1)
    assert run.bodies == (("rod", "head"),)
    rod, head = run.parts["rod"], run.parts["head"]
    off = run.impulse["rod.z--wall"][-1, 2] / (rod.mass + head.mass) / 3.0 - 1.0
    assert restitution(run, "rod.z--wall", ("rod.z-",)) == pytest.approx(off, rel=1e-9)


def pressed_run(last, velocity=(-2.0, 0.0, 1.5, 1.25)):
    """A body before a wall: impulses of 1 in each of two intervals, then one of a share."""
    push = np.zeros((4, 3))
    push[:, 2] = (0.0, 1.0, 2.0, 2.0 + last)
    motion = np.zeros((4, 3))
    motion[:, 2] = velocity
    part = SimpleNamespace(mass=1.0, velocity=motion)
    return SimpleNamespace(time=np.arange(4.0), impulse={"a": push}, parts={"ball": part}, bodies=())


def test_restitution_is_told_at_the_end_of_the_run():
    """By the last instant, not the one before."""
    assert restitution(pressed_run(0.0), "a", ("ball.round",)) == pytest.approx(1.25 / 2.0, rel=1e-12)


def test_a_contact_presses_above_a_hundredth_of_its_peak():
    assert still_presses(pressed_run(0.011), "a")
    assert not still_presses(pressed_run(0.009), "a")
    assert restitution(pressed_run(0.011), "a", ("ball.round",)) is None


def test_a_balance_begins_with_what_moves_what_is_stored_and_what_stands_in_hourglass_modes():
    """A cube of 1 mm bent by an hourglass mode, 3 nJ stored in it, that moves with 2 m/s."""
    side = 1e-3
    cube = block("cube", (side,) * 3, side, side, side)
    engine = Engine(Model(cube, {"cube": STEEL}, Controls(1e-6), velocity={"cube": (0.0, 2.0, 0.0)}))
    x, _, z = (engine.x - engine.x.mean(axis=0)).T
    engine.x[:, 1] += 1e-3 * x * z / side
    engine.solid.kinds[0].sums[0, 0] = 3e-9
    engine.initialize()
    hourglass = engine.solid.work()[3]
    assert hourglass > 1e-9
    moving = 0.5 * STEEL.density * side**3 * 4.0
    assert engine.initial_energy == pytest.approx(moving + 3e-9 + hourglass, rel=1e-12)
    assert engine.critical < np.inf
