"""Maps: regimes against known return maps, the return of the object against integration, cells, and going on."""

import dataclasses
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from strikewave import load_case
from strikewave.base.errors import InputError, IntegrationError, StrikewaveError
from strikewave.base.quantities import Range, ToleranceBand, Value
from strikewave.machines import StruckObject, blows, run_machine
from strikewave.machines.fast_run import fast_train
from strikewave.reporting.numbers import ShownUnits, showing
from strikewave.studies.axes import axis_of, case_at
from strikewave.studies.engine.pools import ProcessPool
from strikewave.studies.engine.store import RunStore
from strikewave.studies.map.cells import (
    FIELDS,
    IRREGULAR,
    MISSES,
    NO_RETURN,
    PLACE,
    REASONS,
    UNKNOWN,
    arrivals,
    bounce_time,
    cell_of,
    machine_of,
    measured,
    own_blows,
    period_of,
    regime_of,
)
from strikewave.studies.map.report import setting_table
from strikewave.studies.map.study import MapStudy, axes_of, check_plan, confirmed, in_full, make_map, plan_of
from strikewave.uncertainty.statistics import variation

ONE = np.ones(1)


def logistic(r, count=400, left_out=300):
    x, found = 0.4, []
    for _ in range(count):
        x = r * x * (1.0 - x)
        found.append([x])
    return np.array(found[left_out:])


@pytest.mark.parametrize(("r", "period"), [(2.8, 1), (3.2, 2), (3.5, 4), (3.83, 3), (4.0, 0)])
def test_logistic_map_has_the_periods_that_are_known(r, period):
    """May, Nature 261 (1976) 459: stable to r = 3, period 2 to 1 + sqrt 6, then 4; window of 3 from 1 + sqrt 8."""
    assert period_of(logistic(r), ONE) == period


def high_bounces(gamma, alpha=0.8, count=2000, last=60):
    """The ball on a vibrating table that it leaves far behind: phase and speed of each bounce.

    phi' = phi + v, v' = alpha v + gamma cos(phi'), begun near the period-1 motion with v = 2 pi.
    """
    phase, speed = math.acos(2.0 * math.pi * (1.0 - alpha) / gamma) + 1e-3, 2.0 * math.pi
    found = []
    for _ in range(count):
        phase += speed
        speed = alpha * speed + gamma * math.cos(phase)
        found.append([speed, math.remainder(phase, 2.0 * math.pi)])
    return np.array(found[-last:])


@pytest.mark.parametrize(("share", "period"), [(0.97, 1), (1.03, 2)])
def test_bouncing_ball_loses_its_period_one_where_theory_says(share, period):
    """Guckenheimer & Holmes 1983, section 2.4 (Holmes 1982): period one with v = 2 n pi is stable for
    2 n pi (1 - a) < gamma < 2 sqrt((n pi (1 - a))^2 + (1 + a)^2), where the multiplier is -1; period two follows."""
    alpha = 0.8
    limit = 2.0 * math.hypot(math.pi * (1.0 - alpha), 1.0 + alpha)
    found = high_bounces(share * limit)
    assert period_of(found, np.array([2.0 * math.pi, 1.0])) == period
    if period == 1:
        assert found[-1, 0] == pytest.approx(2.0 * math.pi, rel=1e-9)
        assert math.cos(found[-1, 1]) == pytest.approx(2.0 * math.pi * (1.0 - alpha) / (share * limit), rel=1e-9)


def test_misses_and_no_return_are_named():
    steady, none = np.ones((12, 1)), np.zeros(12, dtype=bool)
    some = none.copy()
    some[3] = True
    assert regime_of(steady, none, ONE).name == "period-1"
    assert regime_of(steady, some, ONE).code == MISSES
    assert regime_of(steady, ~none, ONE).code == NO_RETURN
    assert regime_of(steady[:2], none[:2], ONE).code == UNKNOWN
    assert regime_of(logistic(3.83), np.zeros(100, dtype=bool), ONE).name == "period-3"
    assert regime_of(logistic(4.0), np.zeros(100, dtype=bool), ONE).code == IRREGULAR


@pytest.mark.parametrize("turn", [3, 12])
def test_strikers_that_differ_repeat_after_a_turn(turn):
    """However many they are; fewer than three turns tell nothing."""
    states = np.tile(np.arange(turn, dtype=float)[:, np.newaxis], (4, 1))
    none = np.zeros(4 * turn, dtype=bool)
    assert regime_of(states, none, ONE, turn).name == f"period-{turn}"
    short = 2 * turn + 1
    assert regime_of(states[:short], none[:short], ONE, turn).code == UNKNOWN
    assert regime_of(logistic(4.0), np.zeros(100, dtype=bool), ONE, turn).code == IRREGULAR


def twelve():
    """A machine with twelve strikers, each shorter than the one before by 10 um."""
    machine = machine_of(load_case("li-ma-2019", ["machine.strikers=12", "machine.speed=250 rpm", "feed.blows=3"]))
    own = tuple(dataclasses.replace(s, reach_error=-1e-5 * k) for k, s in enumerate(machine.strikers.each))
    return dataclasses.replace(machine, strikers=dataclasses.replace(machine.strikers, each=own))


def test_twelve_strikers_with_their_own_reach_are_period_12():
    """As many turns as that takes: in 84 blows, but not in 60, of which the first half is left out."""
    machine = twelve()
    cells = [measured(fast_train(machine, length), 3, length) for length in (84, 60)]
    assert [cell[PLACE["period"]] for cell in cells] == [12, 0]
    assert cells[0][PLACE["reason"]] == 0
    assert "too short" in REASONS[int(cells[1][PLACE["reason"]])]


def held(spring=40e3, preload=400.0, damper=20.0, restitution=0.5, stop=200e3):
    return StruckObject(0.06, 0.399, 9e7, 200.0, spring, preload, damper, stop, restitution, 9.8)


@pytest.mark.parametrize("restitution", [0.1, 0.5, 0.9])
def test_bounce_against_integration(restitution):
    struck = held(restitution=restitution)

    def rates(t, y):
        return [y[1], -(struck.stop_stiffness * y[0] + struck.stop_damping * y[1]) / struck.mass]

    def pulls(t, y):
        return struck.stop_stiffness * y[0] + struck.stop_damping * y[1]

    pulls.terminal, pulls.direction = True, -1
    found = solve_ivp(rates, (0.0, 1.0), [0.0, 1.0], "DOP853", events=pulls, rtol=1e-11, atol=1e-14)
    assert bounce_time(struck) == pytest.approx(found.t[-1], rel=1e-8)
    assert -found.y[1, -1] == pytest.approx(restitution, rel=1e-8)


@pytest.mark.parametrize("damper", [20.0, 2.1 * math.sqrt(40e3 * 0.459)])
def test_arrivals_against_integration(damper):
    """Both flights, the second begun with the restitution's share of the first return, as one integrates them; the
    second damper lets the object creep back. 1e-8 is what the integrator holds at rtol 1e-11."""
    struck = held(damper=damper)

    def rates(t, y):
        force = struck.preload - struck.mass * struck.gravity + struck.spring * y[0] + struck.damper * y[1]
        return [y[1], -force / struck.mass]

    def back(t, y):
        return y[0]

    back.terminal, back.direction = True, -1

    def flown(speed):
        found = solve_ivp(rates, (0.0, 10.0), [0.0, speed], "DOP853", events=back, rtol=1e-11, atol=1e-14)
        return found.t[-1], -found.y[1, -1]

    first, speed = flown(5.0)
    second, _ = flown(struck.stop_restitution * speed)
    assert arrivals(struck, 5.0) == pytest.approx((first, first + bounce_time(struck) + second), rel=1e-8)


def test_the_object_leaves_with_the_momentum_of_the_whole_blow():
    """Its return after the last blow from its speed there in the full run, 1e-3 as blows agree; not from the pulse."""
    case = load_case("li-ma-2019", ["feed.blows=2"])
    machine = machine_of(case)
    run = run_machine(machine)
    last = blows(run)[-1]
    leaves = float(run.sample(np.array([last.time + last.contact_time])).object_speed[0])
    cell = measured(fast_train(machine), 2, 0)
    period = machine.pitch / machine.drive.turntable.speed
    assert cell[PLACE["return_ratio"]] == pytest.approx(arrivals(machine.struck, leaves)[0] / period, rel=1e-3)


def test_object_that_its_preload_does_not_hold_never_returns():
    assert all(math.isnan(t) for t in arrivals(held(preload=4.0), 5.0))


def value(unit, typed):
    return Range(unit).read(typed)


def small(points=(4, 3), train=12, case=None):
    case = load_case("li-ma-2019", ["feed.blows=3"]) if case is None else case
    x = axis_of(case, "machine.speed", (value("rad/s", "500 rpm"), value("rad/s", "900 rpm")), points[0], False)
    y = axis_of(case, "object.spring", None, points[1], True)
    return plan_of(case, (x, y), None, train)


def test_log_behind_an_axis_spaces_it_by_the_logarithm():
    case = load_case("li-ma-2019")
    x, y = axes_of(case, ("machine.speed=400..1600 rpm log", "object.spring log", None), (3, 2))
    assert [x.typed(value) for value in x.values] == ["400 rpm", "800 rpm", "1600 rpm"]
    assert (x.log, y.log) == (True, True)


def test_default_range_is_half_to_twice_in_the_unit_of_the_case():
    plan = small()
    assert plan.axes[1].unit == "kN/m"
    assert plan.axes[1].values == pytest.approx((20e3, 40e3, 80e3), rel=1e-12)
    assert plan.axes[0].typed(plan.axes[0].values[0]) == "500 rpm"


def test_cell_is_the_fast_run_of_its_case():
    plan = small()
    place = 1 * 4 + 2  # of the second row, the third cell
    (outcome,) = plan.job([plan.rows[place]])
    cell = np.array(outcome.numbers)
    at = (plan.axes[0].values[2], plan.axes[1].values[1])
    case = case_at(load_case("li-ma-2019", ["feed.blows=3"]), plan.axes, at, "a cell")
    run = fast_train(machine_of(case), 12)
    peaks = run.column("rigid_peak")[:3]
    assert cell[PLACE["cv"]] == variation(peaks) == np.std(peaks, ddof=1) / np.mean(peaks)
    assert cell[PLACE["peak"]] == peaks.mean()
    assert cell[PLACE["largest_displacement"]] == run.column("largest_displacement")[:3].max()


def test_missed_blows_are_left_out_of_the_variation_but_are_never_even():
    changes = ["object.spring=1 kN/m", "object.preload=30 N", "object.damper=0 N s/m", "feed.blows=6"]
    case = load_case("li-ma-2019", changes)
    cell, peaks = cell_of(case, 6, 0), fast_train(machine_of(case)).column("rigid_peak")
    assert cell[PLACE["missed"]] == np.isnan(peaks).sum() > 0
    struck = peaks[~np.isnan(peaks)]
    assert cell[PLACE["cv"]] == pytest.approx(np.std(struck, ddof=1) / np.mean(struck), rel=1e-12)
    plan = small(train=0, case=case)
    study = MapStudy(plan, np.tile(cell, (*plan.shape, 1)), 10.0, dict(zip(FIELDS, cell, strict=True)))
    assert not study.even_settings()


def test_hold_ends_the_own_blows_as_in_full():
    """The feed retracts 70 ms after it arrived, blows or not: those that do not come count as missed, and the machine
    is never even, nor does a full run of it with its own feed confirm it."""
    case = load_case("li-ma-2019", ["feed.blows=6", "feed.hold=70 ms"])
    machine = machine_of(case)
    full = blows(run_machine(machine, 1e-7))
    run = fast_train(machine, 12)
    assert own_blows(run, 6).stop == len(full) < 6
    cell = cell_of(case, 6, 0)
    assert cell[PLACE["missed"]] == 6 - len(full)
    with pytest.raises(StrikewaveError, match="of 6 blows came"):
        in_full(case, 6)


@pytest.mark.verify
def test_two_processes_give_what_one_gives():
    plan = small()
    one, two = (make_map(plan, 0.02, pool=ProcessPool(count)) for count in (1, 2))
    assert np.array_equal(one.values, two.values, equal_nan=True)


def test_stopped_map_goes_on_to_the_same_end(tmp_path):
    """Stopped after the first cells are kept; what is there is not run again, and the end is the same to the bit."""
    plan, later = small(), []

    class StoppedError(Exception):
        pass

    def stop(progress):
        raise StoppedError

    with RunStore(tmp_path / "s") as store, pytest.raises(StoppedError):
        make_map(plan, 0.02, store, advance=stop)
    with RunStore(tmp_path / "s") as store:
        kept = len(store.known())
        assert 0 < kept < 12
        resumed = make_map(plan, 0.02, store, advance=later.append)
    assert later[0].done > kept
    assert later[-1].done == later[-1].total == 12
    assert np.array_equal(resumed.values, make_map(plan, 0.02).values, equal_nan=True)


@pytest.mark.verify
def test_cells_of_another_map_are_not_taken(tmp_path):
    """Another train is another question: its cells lie in the same folder, and are run."""
    with RunStore(tmp_path / "s") as store:
        one = make_map(small(), 0.02, store)
        other = make_map(small(train=13), 0.02, store)
        assert len(store.known()) == 24
    assert np.array_equal(one.values, make_map(small(), 0.02).values, equal_nan=True)
    assert other.plan.train == 13


def test_nearest_even_setting_is_the_nearest_and_keeps_the_limit_in_full():
    study = make_map(small((5, 4), 0), 0.03)
    assert study.setting is not None
    assert study.setting.full_run.cv <= 0.03
    assert study.setting.full_run.cv == pytest.approx(study.setting.cell["cv"], abs=2e-4)
    assert study.setting.distance == min(distance for distance, *_ in study.even_settings())


def even_study(case, axes, values):
    """A map whose cells all have the same evenness, without a run."""
    cell = dict.fromkeys(FIELDS, 0.0) | values
    plan = plan_of(case, axes, None, 0)
    data = np.tile(list(cell.values()), (*plan.shape, 1))
    return MapStudy(plan, data, 0.05, cell)


def test_case_that_is_even_is_the_nearest_itself():
    """Its own blows, four with a CV of 4 % from the first, in full too: nothing is changed, not even its provenance."""
    study = make_map(small((2, 2), 0, load_case("li-ma-2019", ["feed.blows=4"])), 0.06)
    assert study.even
    assert study.setting.distance == 0.0
    assert study.setting.values == study.here
    assert study.nearest_case() == study.case


def test_settings_are_named_in_the_unit_that_was_chosen():
    """730 rpm are 76.445 rad/s: number and name change together."""
    case = load_case("li-ma-2019")
    study = even_study(
        case, [axis_of(case, path, None, 2, False) for path in ("machine.speed", "machine.engagement")], {}
    )
    assert setting_table(study, "").cells()[0] == ["machine.speed (rpm)", "730"]
    with showing(ShownUnits.read("rad/s")):
        assert setting_table(study, "").cells()[0] == ["machine.speed (rad/s)", "76.445"]
        assert study.plan.axes[0].words(study.here[0]) == "76.445 rad/s"


def test_distance_along_an_axis_from_zero_is_measured_by_its_range():
    case = load_case("li-ma-2019", ["feed.blows=3", "object.friction=0 N"])
    friction = axis_of(case, "object.friction", (value("N", "0 N"), value("N", "80 N")), 3, False)
    speed = axis_of(case, "machine.speed", None, 3, False)
    study = even_study(case, (speed, friction), {"cv": 0.01})
    steps = {values: distance for distance, values, _ in study.even_settings()}
    at = 0.5 * study.here[0]
    assert steps[at, 40.0] == pytest.approx(math.hypot(0.5, 0.5), rel=1e-12)
    assert steps[at, 80.0] == pytest.approx(math.hypot(0.5, 1.0), rel=1e-12)


def test_settings_that_full_runs_refuse_say_why(monkeypatch):
    """Where the full run has another CV, or fails, that is told, and is not the same as that nothing was even."""
    case = load_case("li-ma-2019", ["feed.blows=3"])
    study = even_study(case, small().axes, {"cv": 0.01})
    told = iter([0.3, IntegrationError("it broke"), 0.2, 0.25, 0.4])

    def full(case, count):
        found = next(told)
        if isinstance(found, Exception):
            raise found
        return found, 1.0

    monkeypatch.setattr("strikewave.studies.map.study.in_full", full)
    setting, refused = confirmed(study)
    assert setting is None
    assert len(refused) == 5
    assert tuple(refused[0].settings.values()) == study.here
    assert "CV of 30 %" in refused[0].why
    assert "it broke" in refused[1].why


def test_nearest_case_keeps_the_tolerances_of_what_it_changes():
    case = load_case("li-ma-2019", ["feed.blows=3"])
    speed = case.machine.speed.model_copy(update={"tolerance": ToleranceBand(typed="2 %", size=0.02, relative=True)})
    case = case.with_values({"machine.speed": speed})
    study = even_study(case, small(case=case).axes, {"cv": 0.01})
    changed = study.case_of((60.0, 30e3))
    assert changed.machine.speed.tolerance.typed == "2 %"
    assert changed.machine.speed.si == 60.0


def test_a_failed_cell_says_why():
    case = load_case("li-ma-2019", ["object.preload=5 N", "object.stop_stiffness=200 kN/m"])
    weak = case_at(case, (axis_of(case, "object.preload", None, 2, False),), (1.0,), "weak")
    cell = cell_of(weak, 3, 0)
    assert cell[PLACE["reason"]] == 1
    assert math.isnan(cell[PLACE["cv"]])


def test_document_and_dataset_carry_units_and_regimes(tmp_path):
    import xarray

    study = make_map(small(), 0.02)
    study.data.to_netcdf(tmp_path / "map.nc", engine="h5netcdf")
    with xarray.open_dataset(tmp_path / "map.nc", engine="h5netcdf") as data:
        assert data["stop_force"].attrs["units"] == "N"
        assert data["x"].attrs["long_name"] == "machine.speed"
        assert np.array_equal(data["cv"].values[0], study.field("cv")[0])
    document = study.document()
    assert document["units"]["object.spring"] == "N/m"
    assert sum(document["shares"].values()) == pytest.approx(1.0)
    lines = study.tables()["map.csv"].splitlines()
    assert len(lines) == 1 + 12
    assert lines[0].startswith("machine.speed [rpm],object.spring [kN/m],cv [1],")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda case: axis_of(case, "machine.sped", None, 5, False), "did you mean"),
        (
            lambda case: axis_of(case, "machine.speed", (value("rad/s", "9 rpm"), value("rad/s", "9 rpm")), 5, False),
            "lies above",
        ),
        (lambda case: check_plan(small((2000, 3)), 1), "2 to 1000 points"),
        (lambda case: check_plan(small((1, 3)), 1), "2 to 1000 points"),
        (lambda case: check_plan(small((1000, 900), 900), 2), "hours at most"),
        (lambda case: check_plan(small(train=5), 1), "12 to 1000"),
    ],
)
def test_wrong_inputs_are_refused_in_words(change, words):
    with pytest.raises(InputError, match=words):
        change(load_case("li-ma-2019"))


@pytest.mark.verify
def test_a_map_that_ends_before_the_case_says_so():
    """Nearest even setting at the end of the range on the side of the case: nothing between was looked at."""
    case = load_case("li-ma-2019")

    def codes(low, high):
        speed = (
            Value(si=low * math.pi / 30.0, typed=f"{low} rpm"),
            Value(si=high * math.pi / 30.0, typed=f"{high} rpm"),
        )
        axes = axis_of(case, "machine.speed", speed, 3, False), axis_of(case, "object.spring", None, 5, False)
        notices = make_map(plan_of(case, axes, train=0), 0.02).notices
        return [notice.code for notice in notices if notice.code != "checks-not-made"]

    assert codes(800, 900) == ["range-end"]
    assert codes(700, 800) == []
