"""Maps: regimes against known return maps, the return of the object against integration, cells, and going on."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from strikewave import load_case
from strikewave.errors import InputError
from strikewave.machines import StruckObject
from strikewave.machines.quick import quick_run
from strikewave.quantities import Range
from strikewave.studies.map import axis_of, check_plan, make_map, plan_of
from strikewave.studies.map_cells import FIELDS, PLACE, case_at, cell_of, machine_of, row_of, spread, start_worker
from strikewave.studies.map_regimes import IRREGULAR, MISSES, NO_RETURN, UNKNOWN, period_of, regime_of
from strikewave.studies.map_return import arrivals, bounce_time, flight
from strikewave.studies.map_store import NAME, Store

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


def held(spring=40e3, preload=400.0, damper=20.0, restitution=0.5, stop=200e3):
    return StruckObject(0.06, 0.399, 9e7, 200.0, spring, preload, damper, stop, restitution, 9.8)


@given(speed=st.floats(0.5, 10), spring=st.floats(2e3, 2e5), preload=st.floats(20, 2000), ratio=st.floats(0.0, 0.7))
@settings(max_examples=25)
def test_flight_against_integration(speed, spring, preload, ratio):
    """scipy's integrator, which shares nothing with the closed form; 1e-8 is what it holds at rtol 1e-11."""
    damper = 2.0 * ratio * math.sqrt(spring * 0.459)
    struck = held(spring, preload, damper)

    def rates(t, y):
        force = preload - struck.mass * struck.gravity + spring * y[0] + damper * y[1]
        return [y[1], -force / struck.mass]

    def back(t, y):
        return y[0]

    def turns(t, y):
        return y[1]

    back.terminal, back.direction = True, -1
    found = solve_ivp(rates, (0.0, 10.0), [0.0, speed], "DOP853", events=(back, turns), rtol=1e-11, atol=1e-14)
    ours = flight(struck, speed)
    assert ours.time == pytest.approx(found.t_events[0][-1], rel=1e-8)
    assert ours.speed == pytest.approx(-found.y_events[0][-1][1], rel=1e-7, abs=1e-9)
    assert ours.retreat == pytest.approx(found.y_events[1][0][0], rel=1e-8)


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


def test_object_that_creeps_back_has_no_time_of_return():
    creeping = held(damper=2.1 * math.sqrt(40e3 * 0.459))
    with pytest.raises(ValueError, match="creeps"):
        flight(creeping, 5.0)
    assert all(math.isnan(t) for t in arrivals(creeping, 5.0))


def value(unit, typed):
    return Range(unit).read(typed)


def small(points=(4, 3), train=12, case=None):
    case = load_case("li-ma-2019", ["feed.blows=3"]) if case is None else case
    x = axis_of(case, "machine.speed", (value("rad/s", "500 rpm"), value("rad/s", "900 rpm")), points[0], False)
    y = axis_of(case, "object.spring", None, points[1], True)
    return plan_of(case, (x, y), None, train)


def test_default_range_is_half_to_twice_in_the_unit_of_the_case():
    plan = small()
    assert plan.axes[1].unit == "kN/m"
    assert plan.axes[1].values == pytest.approx((20e3, 40e3, 80e3), rel=1e-12)
    assert plan.axes[0].typed(plan.axes[0].values[0]) == "500 rpm"


def test_cell_is_the_fast_run_of_its_case():
    plan = small()
    start_worker(plan)
    row = row_of(1)
    case = case_at(
        load_case("li-ma-2019", ["feed.blows=3"]), plan.axes, (plan.axes[0].values[2], plan.axes[1].values[1])
    )
    run = quick_run(machine_of(case), 12)
    peaks = run.column("rigid_peak")[:3]
    assert row[2, PLACE["cv"]] == spread(peaks) == np.std(peaks, ddof=1) / np.mean(peaks)
    assert row[2, PLACE["peak"]] == peaks.mean()
    assert row[2, PLACE["retreat"]] == run.column("retreat")[:3].max()


def test_a_missed_blow_counts_as_a_peak_of_zero():
    changes = ["object.spring=1 kN/m", "object.preload=30 N", "object.damper=0 N s/m", "feed.blows=6"]
    cell = cell_of(load_case("li-ma-2019", changes), 6, 0)
    assert cell[PLACE["missed"]] > 0
    assert cell[PLACE["cv"]] > 0.3


def test_two_processes_give_what_one_gives():
    plan = small()
    one, two = make_map(plan, 0.02, 1), make_map(plan, 0.02, 2)
    assert np.array_equal(one.data, two.data, equal_nan=True)


def test_stopped_map_goes_on_to_the_same_end(tmp_path):
    """Stopped after the first row is kept; what is there is not run again, and the end is the same to the bit."""
    plan, shares = small(), []

    class StoppedError(Exception):
        pass

    def stop(share):
        raise StoppedError

    with pytest.raises(StoppedError):
        make_map(plan, 0.02, 1, Store(plan, tmp_path), stop)
    kept = Store(plan, tmp_path)
    assert kept.done.tolist() == [True, False, False]
    resumed = make_map(plan, 0.02, 1, kept, shares.append)
    assert len(shares) == 2
    assert np.array_equal(resumed.data, make_map(plan, 0.02).data, equal_nan=True)


def test_rows_of_another_map_and_damaged_ones_are_refused(tmp_path):
    plan = small()
    store = Store(plan, tmp_path)
    store.keep(0, np.zeros((4, len(FIELDS))))
    with pytest.raises(InputError, match="of another"):
        Store(small(train=13), tmp_path)
    assert not Store(small(train=13), tmp_path, fresh=True).done.any()
    for damage in (b"", b"PK", (tmp_path / NAME).read_bytes()[:300]):
        (tmp_path / NAME).write_bytes(damage)
        with pytest.raises(InputError, match="damaged"):
            Store(plan, tmp_path)


def test_pickled_rows_are_never_loaded(tmp_path):
    plan = small()
    key = Store(plan, None).key
    np.savez(tmp_path / NAME, key=np.array(key), done=np.array([{}], dtype=object), data=np.zeros(1))
    with pytest.raises(InputError, match="damaged"):
        Store(plan, tmp_path)


def test_nearest_even_setting_is_the_nearest_and_keeps_the_limit_in_full():
    study = make_map(small((5, 4), 0), 0.03)
    assert study.setting is not None
    assert study.setting.cv <= 0.03
    assert study.setting.cv == pytest.approx(study.setting.cell["cv"], abs=2e-4)
    assert study.setting.distance == min(distance for distance, _ in study.even_settings())


def test_a_failed_cell_says_why():
    case = load_case("li-ma-2019", ["object.preload=5 N", "object.stop_stiffness=200 kN/m"])
    weak = case_at(case, (axis_of(case, "object.preload", None, 2, False),), (1.0,))
    cell = cell_of(weak, 3, 0)
    assert cell[PLACE["reason"]] == 1
    assert math.isnan(cell[PLACE["cv"]])


def test_document_and_dataset_carry_units_and_regimes(tmp_path):
    import xarray

    study = make_map(small(), 0.02)
    study.dataset().to_netcdf(tmp_path / "map.nc", engine="h5netcdf")
    with xarray.open_dataset(tmp_path / "map.nc", engine="h5netcdf") as data:
        assert data["stop_force"].attrs["units"] == "N"
        assert data["x"].attrs["long_name"] == "machine.speed"
        assert np.array_equal(data["cv"].values[0], study.field("cv")[0])
    document = study.document()
    assert document["units"]["object.spring"] == "N/m"
    assert sum(document["shares"].values()) == pytest.approx(1.0)
    lines = study.table().splitlines()
    assert len(lines) == 1 + 12
    assert lines[0].startswith("machine.speed [rpm],object.spring [kN/m],cv,")


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
