"""A sensor's trace lasts as long as the pulse that it reads; one that does not is reported."""

import math

import numpy as np
import pytest

from strikewave import compare, load_case, run_case
from strikewave.analyses.machine.observe import observe
from strikewave.analyses.machine.readings import MOST_A_WINDOW, RIGID_STEP, pulse_axis
from strikewave.cases.tables.stack import SensorTable
from strikewave.sensors import Reading
from strikewave.sensors.trial import still_on

G = 9.80665

LINEAR = "contact.law=power", "contact.exponent=1", "contact.reference_depth=1 mm"
"""A linear pad: as soft as its force at 1 mm says."""
SLOW = {
    "jesd22-b111-b": ["contact.reference_force=10 kN", "machine.follow=20 ms"],
    "mil-s-901d-hammer": ["object.frame_stiffness=50 MN/m", "machine.follow=20 ms"],
    "dual-mass-amplifier": ["contact.reference_force=1 kN", "machine.follow=20 ms"],
    "endevco-tp-321": ["contact.reference_force=20 N", "machine.follow=20 ms"],
    "en-166-ball": ["contact.reference_force=2 N", "machine.follow=30 ms"],
    "iso-16063-22-dropball": ["contact.reference_force=100 N", "machine.follow=20 ms"],
    "machete-13-teeth": ["contact.reference_force=2 kN", "machine.follow=20 ms"],
    "rodgers-2009-amplifier": ["contact.reference_force=3 N", "machine.follow=20 ms"],
    "li-ma-2019": ["contact.reference_force=300 N", "feed.blows=2"],
}
"""A case of each kind of machine, made so soft that its pulse lasts longer than 1.5 ms."""
FILTERED = {"resonance": "50 kHz", "range": "5000 g", "cutoff": "10 kHz"}


def with_sensors(name, changes=(), **sensors):
    """Return a case with sensors: a name and the fields of each."""
    soft = any("reference_force" in change for change in changes)
    case = load_case(name, [*(LINEAR if soft else ()), *changes])
    contact = case.contact.model_copy(update={"yield_pressure": None} if soft else {})
    tables = tuple(SensorTable(name=key, **fields) for key, fields in sensors.items())
    return case.model_copy(update={"contact": contact, "sensor": tables})


@pytest.mark.parametrize("name", SLOW)
def test_an_ideal_sensor_reads_the_rigid_pulse_of_every_kind_of_machine(name):
    """A sample is 1e-6 off the top of a half-sine at most; an edge lies on a straight line between two samples."""
    seen = observe(with_sensors(name, SLOW[name], ideal={"recorder": "ideal"}))
    blow, reading, history = next(row for row in zip(seen.blows, seen.readings, seen.histories, strict=True) if row[1])
    pulse = reading.sensors["ideal"]
    assert blow.width > 1.5e-3
    assert not pulse.cut
    assert pulse.peak == pytest.approx(blow.rigid_peak, rel=2e-6)
    assert pulse.width == pytest.approx(blow.width, rel=1e-5)
    assert history.readings[0].time[-1] > blow.contact_time


@pytest.mark.parametrize("recorder", ["ideal", "storage", "oscilloscope"])
def test_a_resonant_filtered_sensor_reads_a_slow_pulse_whatever_records_it(recorder):
    """By 1 % of 100 g: 8 bits of 5000 g are 39 g a code, so that the oscilloscope has a range of its own."""
    sensor = FILTERED | {"recorder": recorder, "range": "150 g"}
    solution = run_case(with_sensors("iec-60068-2-27-rubber", accel=sensor))
    assert solution.readings[0].sensors["accel"].peak == pytest.approx(solution.blows[0].rigid_peak, rel=1e-2)
    assert solution.arrays["pulse_time"].values[-1] > solution.blows[0].contact_time
    assert np.isfinite(solution.arrays["pulse_acceleration"].values[0][-1])


@pytest.mark.verify
def test_rigid_pulse_and_reading_of_a_slow_blow_agree_when_compared():
    solution = run_case(with_sensors("iec-60068-2-27-rubber", accel=FILTERED))
    found = compare((solution, "rigid"), (solution, "accel"))
    assert found.agreement.rating.overall > 0.99
    assert abs(found.figures["velocity_change"].difference) < 1e-3


def test_a_reading_that_ends_before_its_pulse_is_reported_and_given_to_no_study():
    from strikewave.analyses.machine.result import sensor_figures
    from strikewave.studies.simulation import Simulation

    short = with_sensors("iec-60068-2-27-rubber", ["machine.follow=4 ms"], accel=FILTERED)
    solution = run_case(short)
    assert solution.readings[0].sensors["accel"].cut
    assert "machine.follow" in next(notice.message for notice in solution.notices if notice.code == "sensor-cut")
    assert not sensor_figures(solution.readings)
    assert Simulation(short).number("first.sensor_peak", "accel") is None


def test_what_comes_to_rest_in_touch_is_not_called_cut():
    changes = ["machine.until=rest", "machine.longest=3 s", "contact.restitution=0.3", "solver.output_step=1 ms"]
    seen = observe(with_sensors("iec-60068-2-27-rubber", changes, accel=FILTERED))
    assert len(seen.blows) > 1
    assert seen.blows[-1].time + seen.blows[-1].contact_time == pytest.approx(seen.run.end) or seen.run.ended == "rest"
    assert not any(reading.sensors["accel"].cut for reading in seen.readings)


def test_a_reading_of_gravity_at_rest_is_not_called_cut():
    """A sensor zeroed in the fall reads 1 g once it lies: a fifth of a pulse of 5 g, and yet over."""
    time = np.arange(2000) * 1e-5
    over = Reading(time, np.where(time < 11e-3, 5.0 * G * np.sin(np.pi * time / 11e-3), G), False, False, 5.0 * G, 0.0)
    assert still_on(over)
    assert not still_on(over, at_rest=G)


def test_the_velocity_change_of_a_table_that_stays_on_its_pad_ends_with_its_pulse():
    """It lies at 1 g for as long as it is followed, and that is in no pulse: v + g T, with the swings left to it."""
    changes = [*("contact.restitution=0.05", "machine.height=4 mm", "solver.output_step=0.1 ms")]
    short, long = (
        observe(with_sensors("iec-60068-2-27-rubber", [*changes, f"machine.follow={follow} ms"])).blows[0]
        for follow in (100, 800)
    )
    speed = math.sqrt(2.0 * G * 0.004)
    assert long.velocity_change == pytest.approx(short.velocity_change, rel=1e-3)
    assert speed < long.velocity_change < 1.05 * speed + 2.0 * G * long.width


def test_a_slow_filter_that_has_not_answered_when_the_run_ends_is_reported():
    """At 100 Hz the answer to 6 ms is largest about 5 ms after the pulse: beyond 8 ms, within 30 ms."""
    for follow, cut in (("8 ms", True), ("30 ms", False)):
        sensor = FILTERED | {"cutoff": "100 Hz"}
        seen = observe(with_sensors("iec-60068-2-27-rubber", [f"machine.follow={follow}"], accel=sensor))
        assert seen.readings[0].sensors["accel"].cut is cut


def test_a_slow_filter_reads_beyond_a_short_pulse():
    """Of a 0.5 ms pulse at 200 Hz the answer comes after 2 ms: its peak needs more than 1.5 ms."""
    sensor = {"recorder": "ideal", "cutoff": "200 Hz"}
    seen = observe(with_sensors("jesd22-b111-b", ["machine.follow=20 ms"], accel=sensor))
    reading = seen.histories[0].readings[0]
    assert reading.time[int(np.argmax(reading.values))] > 1.5e-3
    assert not seen.readings[0].sensors["accel"].cut


def test_short_pulses_keep_the_finest_sampling_and_long_ones_are_bounded():
    quick = observe(with_sensors("jesd22-b111-b", ideal={"recorder": "ideal"}))
    assert np.diff(quick.histories[0].readings[0].time[:2])[0] == pytest.approx(RIGID_STEP)
    soft = ["contact.reference_force=10 N", "machine.follow=1 s", "solver.output_step=1 ms"]
    long = observe(with_sensors("jesd22-b111-b", soft, ideal={"recorder": "ideal"}))
    assert long.blows[0].contact_time > 0.1
    assert 1000 < long.histories[0].readings[0].values.size < 1.01 * MOST_A_WINDOW
    axis, _ = pulse_axis(long.run, long.blows)
    assert 1000 < axis.size < 10_000
    assert axis[-1] >= long.blows[0].contact_time
