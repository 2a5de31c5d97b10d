"""Runs: threads, restart, time step, mass scaling, what stops them, what is refused before they begin."""

import dataclasses
import itertools
import math
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

from strikewave import fem
from strikewave.base.errors import InputError
from strikewave.fem.engine import Engine
from strikewave.fem.hexahedron import fitting, nodal_sums, part_masses
from strikewave.fem.mesh import joined
from strikewave.fem.model import (
    Controls,
    CutSection,
    Driven,
    Fixed,
    Model,
    Point,
    Pressure,
    Rigid,
    RigidWall,
    SurfaceContact,
    Symmetry,
    TimeCurve,
    control_faults,
    stays,
)
from strikewave.fem.recorder import section_elements, watched
from strikewave.fem.run import ENERGIES, balance_measure
from strikewave.fem.shapes import block, moved
from strikewave.fem.solids import Bilinear, Elastic
from strikewave.fem.solve import Checkpoint, Progress, RunOptions, _of_blow, frame_instants, solve

from .bodies import STEEL, Ball, ball_on_base, two_bars

YIELDING = Bilinear(7820.0, 211e9, 0.288, yield_strength=430e6, tangent_modulus=21e9)


def yielding_ball(**controls):
    model = ball_on_base(Ball(speed=5.0, size=4e-4), reach=15.0)
    return dataclasses.replace(
        model,
        solids={"ball": YIELDING, "base": STEEL},
        controls=dataclasses.replace(model.controls, duration=20e-6, **controls),
    )


def same(first, second):
    """All histories are equal to the last bit."""
    for name in ("time", "momentum", "impulse_given"):
        assert np.array_equal(getattr(first, name), getattr(second, name))
    for name in ("force", "impulse", "energy"):
        for key, values in getattr(first, name).items():
            assert np.array_equal(values, getattr(second, name)[key]), key
    for kind in ("parts", "points", "sections"):
        for key, history in getattr(first, kind).items():
            other = getattr(second, kind)[key]
            for field in dataclasses.fields(history):
                assert np.array_equal(getattr(history, field.name), getattr(other, field.name))
    return True


def test_threads_change_no_bit():
    assert same(*(solve(yielding_ball(threads=threads)) for threads in (1, 3)))


def killed_in_the_middle(path):
    """Run until killed; keeps its state every second instant."""
    solve(yielding_ball(), RunOptions(checkpoint=Checkpoint(path, 2), report=lambda progress: time.sleep(0.02)))


@pytest.mark.verify
def test_a_run_killed_in_the_middle_goes_on_to_the_same_bits(tmp_path):
    path = tmp_path / "restart.h5"
    words = f"import sys, pathlib; sys.path.insert(0, {str(Path(__file__).parents[1])!r}); "
    words += f"from fem.test_runs import killed_in_the_middle; killed_in_the_middle(pathlib.Path({str(path)!r}))"
    child = subprocess.Popen([sys.executable, "-c", words])
    end = time.monotonic() + 120.0
    while not path.exists() and child.poll() is None and time.monotonic() < end:
        time.sleep(0.002)
    assert child.poll() is None
    child.kill()
    child.wait()
    assert path.exists()
    model = yielding_ball()
    told = []
    resumed = solve(model, RunOptions(resume=path, report=told.append))
    assert told[0].steps > 0
    assert same(solve(model), resumed)


def test_restart_of_another_model_is_refused(tmp_path):
    path = tmp_path / "restart.h5"
    solve(yielding_ball(), RunOptions(checkpoint=Checkpoint(path, 10)))
    with pytest.raises(InputError, match="the case has changed"):
        solve(yielding_ball(hourglass=0.1), RunOptions(resume=path))
    path.write_bytes(path.read_bytes()[:5000])
    with pytest.raises(InputError, match="damaged"):
        solve(yielding_ball(), RunOptions(resume=path))
    with pytest.raises(InputError, match="run without it"):
        solve(yielding_ball(), RunOptions(resume=tmp_path / "none.h5"))


def test_rigid_body_and_wall_go_on_to_the_same_bits(tmp_path):
    """What rigid parts and walls remember is kept too."""
    rigid = moved(block("rigid", (4e-3, 4e-3, 4e-3), 1e-3, 1e-3, 1e-3), (1e-3, 0.0, 2.001e-3))
    soft = block("soft", (4e-3, 4e-3, 2e-3), 1e-3, 1e-3, 1e-3)
    rigid = moved(rigid, (0.0, 0.0, soft.points[:, 2].max() + 1e-6 - rigid.points[:, 2].min()))
    foot = soft.points[:, 2].min()
    model = Model(
        joined([rigid, soft]),
        {"rigid": STEEL, "soft": YIELDING},
        Controls(20e-6),
        velocity={"rigid": (0.0, 0.0, -10.0)},
        rigid=(Rigid("rigid"),),
        contacts=(SurfaceContact("rigid.all", "soft.all", friction=0.2),),
        walls=(RigidWall("soft.z-", (0.0, 0.0, foot), (0.0, 0.0, 1.0), 0.1),),
    )
    path = tmp_path / "restart.h5"
    whole = solve(model, RunOptions(checkpoint=Checkpoint(path, 15)))
    assert same(whole, solve(model, RunOptions(resume=path)))
    assert abs(whole.energy_error).max() < 1e-3


def test_histories_stand_at_equal_instants():
    run = solve(two_bars(duration=10e-6))
    assert run.time == pytest.approx(np.arange(51) * 0.2e-6, abs=1e-18)


def test_impulse_is_the_momentum_that_changes_hands():
    """The impulse of the contact on the struck bar is its momentum at any instant, to the rounding error."""
    run = solve(two_bars(duration=60e-6))
    struck = run.parts["struck"]
    impulse = run.impulse["striking.z--struck.z+"]
    assert -impulse == pytest.approx(struck.mass * struck.velocity, rel=1e-9, abs=1e-12 * struck.mass * 5.0)


def test_the_integral_of_every_acceleration_is_the_change_of_velocity_where_flat_faces_meet():
    """To rounding: each front is a jump within one step. At an instant the integral is the mean of both its intervals'."""
    run = solve(two_bars(duration=30e-6))
    for body in (*run.parts.values(), *run.sections.values()):
        gained = np.trapezoid(body.acceleration, run.time, axis=0)
        assert gained == pytest.approx(body.velocity[-1] - body.velocity[0], abs=1e-9)
    struck, given = run.parts["struck"], -run.impulse["striking.z--struck.z+"]
    gained = cumulative_trapezoid(struck.acceleration, run.time, axis=0, initial=0.0)
    mean = np.diff(struck.displacement, axis=0) / np.diff(run.time)[:, None]
    assert gained[1:-1] == pytest.approx(0.5 * (mean[1:] + mean[:-1]), abs=1e-9)
    assert struck.mass * gained[-1] == pytest.approx(given[-1], rel=1e-9, abs=1e-9)


def test_mass_is_added_only_on_request_and_told():
    """One thin layer would need a step of 0.1 mm/c; with a least step it gets the mass that it lacks, and says so."""
    thin = block("bar", (4e-3, 4e-3, 4.1e-3), 1e-3, 1e-3, 1e-3)
    points = thin.points.copy()
    low = points[:, 2].min()
    levels = np.unique(points[:, 2].round(9))
    points[np.isclose(points[:, 2], levels[1]), 2] = low + 1e-4
    thin = dataclasses.replace(thin, points=points)
    model = Model(thin, {"bar": STEEL}, Controls(5e-6), velocity={"bar": (0.0, 0.0, 1.0)})
    plain = solve(model)
    scaled = solve(dataclasses.replace(model, controls=dataclasses.replace(model.controls, least_step=6e-8)))
    assert plain.added_mass == 0.0
    assert scaled.step > 5.5e-8 > 3.0 * plain.step
    assert scaled.added_mass == pytest.approx(scaled.parts["bar"].mass - plain.parts["bar"].mass)
    assert scaled.added_mass > 0.1 * plain.parts["bar"].mass


def test_added_mass_is_that_which_makes_the_step_long_enough():
    """Without bulk viscosity the step grows with the root of the mass: 1.5 times the step takes 2.25 times the mass."""
    cube = block("cube", (4e-3, 4e-3, 4e-3), 1e-3, 1e-3, 1e-3)
    controls = Controls(2e-6, linear_viscosity=0.0, quadratic_viscosity=0.0)
    critical = Engine(Model(cube, {"cube": STEEL}, controls)).critical
    wanted = dataclasses.replace(controls, least_step=1.5 * controls.safety * critical)
    engine = Engine(Model(cube, {"cube": STEEL}, wanted))
    assert engine.critical == pytest.approx(1.5 * critical, rel=1e-9)
    assert engine.added_mass == pytest.approx(1.25 * STEEL.density * 64e-9, rel=1e-9)


def test_no_step_is_longer_than_the_elements_allow_within_a_long_interval(monkeypatch):
    """A cube that is squashed by 30 % within one interval: its steps get shorter on the way."""
    cube = block("cube", (4e-3, 4e-3, 4e-3), 1e-3, 1e-3, 1e-3)
    press = Driven("cube.z+", (0.0, 0.0, -1.0), TimeCurve((0.0,), (300.0,)))
    steps, plain = [], Engine.step

    def step(engine):
        steps.append((engine.dt_next, 0.9 * engine.critical))
        plain(engine)

    monkeypatch.setattr(Engine, "step", step)
    run = solve(Model(cube, {"cube": STEEL}, Controls(4e-6, interval=4e-6), boundaries=(Fixed("cube.z-"), press)))
    assert not run.stopped
    assert all(taken <= (1.0 + 1e-9) * allowed for taken, allowed in steps)
    assert run.step < 0.9 * steps[0][0]


def test_a_run_ends_with_the_first_instant_that_is_not_before_its_duration():
    cube = block("cube", (2e-3, 2e-3, 2e-3), 1e-3, 1e-3, 1e-3)
    run = solve(Model(cube, {"cube": STEEL}, Controls(10e-6, interval=4.9e-6)))
    assert run.time == pytest.approx([0.0, 4.9e-6, 9.8e-6, 14.7e-6], rel=1e-12)
    assert [Controls(n * 0.3e-6, 0.1e-6).intervals for n in range(1, 400)] == [3 * n for n in range(1, 400)]


def test_contact_gain_is_the_energy_that_contacts_made():
    run = solve(two_bars(duration=2e-6))
    assert run.contact_gain < 1e-3
    count = len(run.time)
    made = {**run.energy, "contact": np.linspace(0.0, -0.1 * run.initial_energy, count)}
    assert dataclasses.replace(run, energy=made).contact_gain == pytest.approx(0.1)


def test_a_step_beyond_the_critical_one_breaks_the_energy_and_stops_the_run(monkeypatch):
    """At 1.3 times the critical step central differences grow without bound: the run stops and says where to look."""
    model = with_controls(two_bars(duration=200e-6), safety=1.0, linear_viscosity=0.0, quadratic_viscosity=0.0)
    monkeypatch.setattr(Engine, "_fitting", lambda engine, span: 1.3 * engine.critical)
    run = solve(model)
    assert "look at element" in run.stopped
    assert len(run.time) < 1001
    assert all(len(values) == len(run.time) for values in run.energy.values())


def test_a_crushed_element_stops_the_run_with_its_name():
    """A pressure far beyond the modulus crushes the cube: the run ends with the element, what was noted is there."""
    cube = block("cube", (2e-3, 2e-3, 2e-3), 1e-3, 1e-3, 1e-3)
    load = Pressure("cube.all", TimeCurve((0.0, 2e-6), (0.0, 2e13)))
    run = solve(Model(cube, {"cube": STEEL}, Controls(20e-6), boundaries=(load,)))
    assert "of cube" in run.stopped
    assert len(run.time) >= 1


def test_a_step_that_collapses_ends_the_run_when_it_does(tmp_path):
    """Held on its sides, 2 mm are flat after 0.5 us: the last instant is just before, and no state is left to go on from."""
    cube = block("cube", (2e-3, 2e-3, 2e-3), 1e-3, 1e-3, 1e-3)
    press = Driven("cube.z+", (0.0, 0.0, -1.0), TimeCurve((0.0,), (4000.0,)))
    held = [Symmetry(f"cube.{side}") for side in ("x-", "x+", "y-", "y+")]
    model = Model(cube, {"cube": STEEL}, Controls(40e-6, interval=20e-6), boundaries=(Fixed("cube.z-"), press, *held))
    run = solve(model, RunOptions(checkpoint=Checkpoint(tmp_path / "restart.h5", 1)))
    assert "of cube" in run.stopped
    assert len(run.time) == 2
    assert 0.499e-6 < run.time[-1] < 0.5e-6
    assert not (tmp_path / "restart.h5").exists()


WRONG = [
    (lambda m: dataclasses.replace(m, solids={"striking": STEEL}), "part struck"),
    (lambda m: dataclasses.replace(m, velocity={"strikin": (0, 0, 1)}), "strikin"),
    (lambda m: with_controls(m, duration=0.0), "duration"),
    (lambda m: with_controls(m, duration=math.nan), "duration"),
    (lambda m: with_controls(m, interval=1.0), "interval"),
    (lambda m: with_controls(m, safety=1.5), "safety"),
    (lambda m: with_controls(m, threads=0), "threads"),
    (lambda m: with_controls(m, hourglass=-1.0), "hourglass"),
    (lambda m: with_controls(m, full=("all",)), "full"),
    (lambda m: dataclasses.replace(m, contacts=(SurfaceContact("striking.z", "struck.z+"),)), "striking.z"),
    (lambda m: dataclasses.replace(m, rigid=(Rigid("nobody"),)), "nobody"),
    (lambda m: with_wall(m, (0.0, 0.0, math.nan)), "point of struck.z--wall"),
    (lambda m: with_wall(m, (0.0, 0.0, -1.0), twice=True), "wall: .*struck.z--wall twice"),
    (lambda m: dataclasses.replace(m, points=(Point("p", "struck", (0, 0, 0)),) * 2), "point: .*p twice"),
    (lambda m: dataclasses.replace(m, sections=m.sections * 2), "section: .*middle twice"),
    (lambda m: dataclasses.replace(m, rigid=(Rigid("struck"),) * 2), "rigid: .*struck twice"),
    (lambda m: dataclasses.replace(m, points=(Point("p", "struck", (0, math.nan, 0)),)), "place of point p"),
    (lambda m: dataclasses.replace(m, points=(Point("p", "nobody", (0, 0, 0)),)), "nobody"),
    (lambda m: dataclasses.replace(m, gravity=(0.0, math.nan, 0.0)), "gravity"),
    (lambda m: dataclasses.replace(m, velocity={"struck": (math.inf, 0, 0)}), "velocity of struck"),
    (lambda m: pressed(m, TimeCurve((), ())), "pressure on struck.z-.*at least one"),
    (lambda m: pressed(m, TimeCurve((0.0, 1e-6), (1.0,))), "2 times, 1 values"),
    (lambda m: pressed(m, TimeCurve((0.0, 2e-6, 1e-6), (0.0, 1.0, 2.0))), "1e-06 s after 2e-06 s.*ascend"),
    (lambda m: pressed(m, TimeCurve((0.0,), (math.nan,))), "not finite"),
    (lambda m: broken(m, "inverted"), "struck element 399.*volume -1e-09"),
    (lambda m: broken(m, "loose"), "loose|belong"),
    (lambda m: broken(m, "nan"), "point 3"),
]


def with_controls(model, **changes):
    return dataclasses.replace(model, controls=dataclasses.replace(model.controls, **changes))


def with_wall(model, point, twice=False):
    wall = RigidWall("struck.z-", point, (0.0, 0.0, 1.0))
    return dataclasses.replace(model, walls=(wall, wall)[: 1 + twice])


def pressed(model, curve):
    return dataclasses.replace(model, boundaries=(Pressure("struck.z-", curve),))


def broken(model, how):
    mesh, points, hexahedra = model.mesh, model.mesh.points.copy(), model.mesh.hexahedra.copy()
    if how == "inverted":
        last = mesh.elements_of("struck").stop - 1
        hexahedra[last] = hexahedra[last][[4, 5, 6, 7, 0, 1, 2, 3]]
    elif how == "loose":
        points = np.vstack([points, [[9.0, 9.0, 9.0]]])
    else:
        points[3] = np.nan
    return dataclasses.replace(model, mesh=dataclasses.replace(mesh, points=points, hexahedra=hexahedra))


@pytest.mark.parametrize(("change", "words"), WRONG)
def test_what_cannot_be_run_is_named_before_the_run(change, words):
    with pytest.raises(InputError, match=words):
        solve(change(two_bars(duration=1e-6)))


def test_progress_tells_rate_and_time_left():
    told = []
    solve(two_bars(duration=40e-6), RunOptions(report=told.append))
    assert told[-1].time == pytest.approx(40e-6)
    assert told[-1].left == pytest.approx(0.0, abs=1e-6)
    assert told[-1].speed > 0.0


def test_frames_are_equally_spaced_and_end_with_the_run():
    run = solve(two_bars(duration=10e-6), RunOptions(frames=6))
    assert [frame.time for frame in run.frames] == pytest.approx(np.linspace(0.0, 10e-6, 6))


def test_mean_stress_of_a_softer_solid_is_that_of_its_elements():
    """A section's stress is the mean by volume: of a graded bar under a slow pull it is the pull."""
    bar = block("bar", (2e-3, 2e-3, 0.01), 1e-3, 1e-3, 1e-3)
    low = bar.points[:, 2].min()
    model = Model(
        bar,
        {"bar": Elastic(7820.0, 211e9, 0.0)},
        Controls(100e-6, interval=2e-6),
        boundaries=(Fixed("bar.z-"), Pressure("bar.z+", TimeCurve((0.0, 100e-6), (0.0, -1e6)))),
        sections=(CutSection("s", "bar", (0.0, 0.0, low + 5e-3), (0.0, 0.0, 1.0)),),
    )
    run = solve(model)
    assert run.sections["s"].elements == 4
    assert run.sections["s"].stress[-1, 2] == pytest.approx(1e6, rel=0.02)


def test_bodies_at_rest_stay_so_and_keep_their_balance():
    """All energy there is rounding of coordinates, of which nothing is a share: no check may fail, nothing divides."""
    at_rest = two_bars(speed=0.0, duration=2e-6)
    run = solve(at_rest)
    assert run.stopped == ""
    assert run.initial_energy == 0.0
    balance = balance_measure(run)
    assert abs(balance.energy) < 1e-6
    assert balance.hourglass < 1e-6
    engine = Engine(at_rest)
    assert engine.record() == ""
    engine.steps = 1
    nothing = dict.fromkeys(ENERGIES, 0.0)
    assert engine._broken(nothing) == ""
    assert "the energy is off" in engine._broken({**nothing, "internal": 1e-3})  # a millijoule from nowhere is none


# Parts of a run, by hand


@pytest.mark.parametrize(
    ("name", "allowed", "refused"),
    [
        ("safety", 1.0, 1.005), ("safety", 0.005, 0.0), ("hourglass", 0.5, 0.504), ("hourglass", 0.0, -0.005),
        ("linear_viscosity", 0.0, -0.005), ("quadratic_viscosity", 0.0, -0.005), ("linear_viscosity", 7.0, math.inf),
        ("least_step", 0.0, -0.005), ("threads", 1, 0), ("blows", 20, 21), ("blows", 1, 0), ("interval", 2.0, 2.004),
        ("interval", 0.005, 0.0), ("duration", 0.6, 0.0), ("duration", 1e9, math.inf),
    ],
)  # fmt: skip
def test_controls_have_ranges(name, allowed, refused):
    good = Controls(2.0, 0.5)
    assert list(control_faults(dataclasses.replace(good, **{name: allowed}))) == []
    fields = [fault.field for fault in control_faults(dataclasses.replace(good, **{name: refused}))]
    assert name in fields


@pytest.mark.parametrize(("share", "whole"), [(0.6e-9, 3), (1.5e-9, 4)])
def test_a_step_fits_its_span_a_whole_number_of_times(share, whole):
    assert fitting(10.0, 3.0) == 2.5
    assert fitting(1.0, 5.0) == 1.0
    assert fitting(6.0, 2.0 / (1.0 + share / 3.0)) == pytest.approx(6.0 / whole, rel=1e-14)
    assert Controls(3.0 + share, 1.0).intervals == whole
    assert Controls(0.2, 1.0).intervals == 1


def test_masses_of_nodes_are_shares_of_their_elements():
    low, high = block("low", (2.0, 1.0, 1.0), 1.0, 1.0, 1.0), block("high", (1.0, 1.0, 1.0), 1.0, 1.0, 1.0)
    mesh, mass = joined([low, moved(high, (0.0, 0.0, 1.0))]), np.array([8.0, 16.0, 40.0])
    sums = nodal_sums(mesh.hexahedra, mass / 8.0, 21)
    assert sorted(sums[:12].tolist()) == [1.0] * 4 + [2.0] * 4 + [3.0] * 4
    assert sums[12:].tolist() == [5.0] * 8 + [0.0]
    assert part_masses(mesh, mass, "high").tolist() == [5.0] * 8
    assert part_masses(mesh, mass, "low").sum() == 24.0


def test_frames_stand_at_equal_instants_and_the_ends():
    controls = Controls(7e-6, 0.5e-6)
    assert frame_instants(controls, 0) == []
    assert frame_instants(controls, 1) == [0]
    assert frame_instants(controls, 4) == [0, 5, 9, 14]
    assert frame_instants(controls, 99) == list(range(15))


def test_progress_over_several_blows_is_that_of_all_and_only_the_first_is_filmed():
    """The second of three blows of 4 intervals of 0.5 s: 2 s come before it."""
    seen, later = [], {2: "second writer"}
    options = RunOptions(writer="first writer", later=later.get, observer="film", report=seen.append)
    controls = Controls(1.9, 0.5, blows=3)
    first, second = (_of_blow(options, blow, controls) for blow in (1, 2))
    assert (first.writer, first.observer) == ("first writer", "film")
    assert (second.writer, second.observer) == ("second writer", None)
    second.report(Progress(0.5, 1.9, 10, 0.1, 8.0, 1.0))
    first.report(Progress(0.5, 1.9, 10, 0.1, 8.0, 1.0))
    assert [(each.time, each.duration, each.left) for each in seen] == [
        (2.5, 6.0, pytest.approx(11.2)),
        (0.5, 6.0, 88.0),
    ]
    alone = _of_blow(options, 1, dataclasses.replace(controls, blows=1))
    assert alone.report is options.report
    assert _of_blow(RunOptions(), 2, controls).report is None


def test_sides_stay_together_where_their_parts_begin_alike():
    model = dataclasses.replace(two_bars(), velocity={"striking": (0.0, 0.0, -5.0), "anvil": (0.0, 0.0, -5.0)})
    assert stays(model, ("striking.z-", "anvil"))
    assert not stays(model, ("striking.z-", "struck.z+"))
    assert not stays(model, ("anvil",))
    assert stays(model, ("struck.z-",))


def test_a_run_stops_where_a_tenth_of_its_energy_is_missing_or_its_step_has_collapsed():
    """40 J at first and 60 J from outside: 9 J may be missing, 15 J of 106 J may not; what is largest is named."""
    model = two_bars(duration=2e-6)
    engine = Engine(model)
    engine.assemble_forces()
    assert engine.record() == ""
    engine.initial_energy, engine.steps = 40.0, 3
    energies = dict.fromkeys(ENERGIES, 0.0) | {"kinetic": 70.0, "internal": 20.0, "hourglass": -30.0, "contact": 31.0}
    assert engine._broken(energies | {"external": 60.0}) == ""  # 91 of 100 J
    words = engine._broken(energies | {"external": 66.0})
    assert words.startswith("the energy is off by -14")
    assert "contact energy is largest; look at element" in words
    words = engine._broken(energies | {"external": 15.0, "plastic": 900.0, "viscous": 39.0, "contact": 12.0})
    assert words.startswith("the energy is off by +102")
    assert "viscous energy is largest" in words
    assert "the numbers end" in engine._broken(energies | {"external": 60.0, "viscous": math.nan})
    engine.steps = 0
    assert engine._broken(energies | {"external": 66.0}) == ""
    assert engine.collapse == pytest.approx(1e-3 * engine.critical, rel=1e-12)
    engine.critical = 0.999 * engine.collapse
    assert "the critical step fell to" in engine._broken(energies | {"external": 60.0})
    assert not engine.goes_on
    engine.critical = 1.001 * engine.collapse
    assert engine.goes_on


def test_groups_of_nodes_are_watched_in_shares_of_64():
    groups = [(np.arange(130), np.ones(130)), (np.array([7]), np.array([0.5])), (np.arange(64), np.zeros(64))]
    first, shares = watched(groups)
    assert first.tolist() == [0, 3, 4]
    assert shares.begin.tolist() == [0, 64, 128, 130, 131, 195]
    assert shares.nodes.tolist() == [*range(130), 7, *range(64)]
    assert shares.weights.sum() == 130.5


@pytest.mark.parametrize(
    ("height", "up", "layer"),
    [(1.5, 1.0, 1), (1.0, 1.0, 1), (1.0, -1.0, 0), (3.0, 2.0, 2), (3.0, -2.0, 1), (4.5, 3.0, 2)],
)
def test_a_section_cuts_the_elements_it_goes_through_or_those_it_lies_upon(height, up, layer):
    """Layers of 1, 2 and 3 m, of an element 1 m and one 3 m wide; between layers it cuts those its normal points to."""
    column = block("b", (2.0, 1.0, 3.0), 1.0, 1.0, 1.0)
    column.points[:, 2] = np.array([0.0, 1.0, 3.0, 6.0])[np.rint(column.points[:, 2]).astype(int)]
    column.points[column.points[:, 0] > 0.5, 0] = 3.0
    mesh = joined([block("a", (1.0, 1.0, 1.0), 1.0, 1.0, 1.0), column])
    elements, shares = section_elements(mesh, CutSection("s", "b", (0.0, 0.0, height), (0.0, 0.0, up)))
    middle = mesh.points[mesh.hexahedra[elements]].mean(axis=1)
    np.testing.assert_allclose(middle[:, 2], (0.5, 2.0, 4.5)[layer])
    assert elements.dtype == np.int32
    np.testing.assert_allclose(shares[np.argsort(middle[:, 0])], [0.25, 0.75], rtol=1e-13)


def test_a_run_is_observed_at_each_instant_and_reported_each_fifth_of_a_second(monkeypatch):
    """Nine instants, 0.15 s one after another: every second one is reported, and the last; the last is told apart."""
    clock = itertools.count(7.0, 0.15)
    monkeypatch.setattr("strikewave.fem.solve.clock", SimpleNamespace(perf_counter=lambda: next(clock)))
    seen, told = [], []
    observer = SimpleNamespace(observe=lambda engine, last: seen.append((engine.instant, last)), state=dict)
    cube = block("cube", (1e-3, 2e-3, 3e-3), 1e-3, 1e-3, 1e-3)
    model = Model(cube, {"cube": STEEL}, Controls(4e-6, 0.5e-6), velocity={"cube": (1.0, 0.0, 0.0)})
    run = solve(model, RunOptions(report=told.append, observer=observer))
    assert seen == [(k, k == 8) for k in range(9)]
    assert [each.time for each in told] == pytest.approx([0.5e-6, 1.5e-6, 2.5e-6, 3.5e-6, 4e-6])
    assert [each.seconds for each in told] == pytest.approx([0.3, 0.6, 0.9, 1.2, 1.35])
    assert told[-1].speed == pytest.approx(6 * run.steps / 1.35, rel=1e-9)
    assert [each.duration for each in told] == pytest.approx([4e-6] * 5)
    assert told[-1].steps == run.steps
    assert run.seconds == pytest.approx(1.5)


def test_every_public_name_of_the_room_is_where_it_is_looked_for():
    assert all(callable(getattr(fem, name)) for name in fem.__all__)
