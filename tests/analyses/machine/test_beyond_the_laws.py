"""Inputs beyond what laws hold for are named, and traces that are shorter than the pulse that a sensor reads."""

import math

import numpy as np
import pytest

from strikewave import compare, load_case, run_case
from strikewave.analyses.machine.blow_histories import MOST_A_WINDOW, RIGID_STEP, pulse_axis
from strikewave.analyses.machine.build import release
from strikewave.analyses.machine.observe import observe
from strikewave.cases.files import bundled_cases
from strikewave.cases.tables.stack import SensorTable
from strikewave.sensors import SensorReading
from strikewave.sensors.trial import still_on

CODES = {
    *("contact-longer-than-face", "nose-heavy", "spot-wider-than-face", "indentation-large", "approach-fast"),
    *("slowest-approach", "struck-while-fed", "first-blow-moving", "anvil-light", "rope-slack", "gas-not-ideal"),
    *("bodies-heavier-above", "no-gain", "gain-of-gaps", "contacts-overlap", "ball-mass"),
    *("faster-than-wave", "material-far", "not-reached", "strain-large"),
}
ROTARY, BALL, TABLE, ARM = "li-ma-2019", "iso-16063-22-dropball", "jesd22-b111-b", "machete-13-teeth"
ELASTIC = "contact.yield_pressure=900 GPa"
"""More than anything bears: the contact of a case that yields stays elastic, also on rubber, which has no hardness."""
GUN, LINE, DUAL = "en-166-ball", "rodgers-2009-amplifier", "dual-mass-amplifier"


def warned(name, *changes):
    """Return the notices of this file that a case raises, by their codes; of a rotary machine with one blow."""
    if load_case(name).feed is not None:
        changes = (*changes, "feed.blows=1")
    return {notice.code: notice for notice in run_case(load_case(name, changes)).notices if notice.code in CODES}


@pytest.mark.parametrize(
    ("name", "changes", "code", "words"),
    [
        (ROTARY, ["striker.contact_length=40 m"], "contact-longer-than-face", "striker.contact_length"),
        (ROTARY, ["striker.contact_length=40 m"], "nose-heavy", "more than the striker (1\xa0kg)"),
        (BALL, ["contact.law=palmgren", "striker.contact_length=1 m"], "contact-longer-than-face", "object.nose_mass"),
        (ROTARY, ["contact.slowest_approach=50 m/s"], "slowest-approach", "of 1 of 1 blows"),
        (ROTARY, ["feed.arrival=0.02"], "struck-while-fed", "feed.arrival"),
        (ROTARY, ["feed.stroke_time=200 ms"], "struck-while-fed", "short of its place"),
        (ROTARY, ["feed.stroke_time=5 ms"], "first-blow-moving", "feed.stroke_time"),
        (BALL, ["striker.mass=2 kg"], "ball-mass", "18.25\xa0mm radius (striker.nose_radius) of 45 steel"),
        (BALL, ["striker.nose_radius=36.5 mm"], "ball-mass", "has 1.599\xa0kg, not 0.2\xa0kg (striker.mass)"),
        (BALL, ["striker.material=rubber", ELASTIC], "ball-mass", "of rubber (striker.material)"),
        (BALL, ["striker.material=rubber", ELASTIC], "spot-wider-than-face", "object.nose_mass"),
        (BALL, ["striker.material=rubber", ELASTIC], "indentation-large", "of the radius"),
        (GUN, ["machine.speed=900 m/s"], "approach-fast", "rho v^2/2 > Y"),
        (GUN, ["machine.speed=900 m/s"], "approach-fast", "machine.speed = 900 m/s"),
        (GUN, ["machine.speed=9000 m/s"], "faster-than-wave", "machine.speed = 9000 m/s"),
        pytest.param(
            *("li-ma-2019-fig13", ["stack.layer.upper.modulus=211 kPa"], "not-reached", "tap sensor"),
            marks=pytest.mark.verify,
        ),
        (TABLE, ["striker.mass=1 kg"], "anvil-light", "striker.mount_stiffness"),
        (ARM, ["machine.mass=3 kg", "machine.centre=0.4 m", "machine.drum=2 m"], "rope-slack", "machine.drum"),
        (LINE, ["striker.mass=0.1 kg"], "bodies-heavier-above", "striker (0.1 kg) than third"),
        (LINE, ["object.mass=1 kg"], "no-gain", "does not amplify"),
        (LINE, ["machine.height=1 um"], "gain-of-gaps", "8 mm"),
        (LINE, ["machine.gap=10 um"], "contacts-overlap", "machine.gap"),
        (DUAL, ["object.mass=400 kg", "object.nose_mass=30 kg"], "no-gain", "does not amplify"),
    ],
)
def test_what_is_beyond_a_law_is_named_with_what_to_do(name, changes, code, words):
    found = warned(name, *changes)
    assert code in found, sorted(found)
    assert words in found[code].message


KNOWN = {
    "li-ma-2019-fig5": {"contact-longer-than-face"},
    "li-ma-2019-fig13": {"contact-longer-than-face"},
    "endevco-tp-321": {"indentation-large"},
    "en-166-ball": {"indentation-large"},
}
"""The built-in cases that reach beyond a law: a face of 30 mm under a nose of 40 mm, both assumed; an edge of 1 mm; a ball
at 45 m/s that dents its target by a tenth of its radius."""


def of_stacks(name):
    """Whether a case is the slow kind: it stands among the longer checks."""
    return pytest.param(name, marks=pytest.mark.verify) if load_case(name).stack.layer else name


@pytest.mark.parametrize("name", [of_stacks(name) for name in bundled_cases() if load_case(name).command == "run"])
def test_built_in_machines_lie_within_their_laws_but_for_what_is_known(name):
    assert set(warned(name)) == KNOWN.get(name, set())


def test_a_machete_lighter_than_its_arm_is_refused():
    with pytest.raises(ValueError, match=r"machine.inertia.*at least"):
        release(load_case(ARM, ["machine.mass=30 kg", "machine.centre=0.4 m"]))


def test_a_recorder_slower_than_the_pulse_is_told_what_it_needs():
    """Worst loss of a half-sine's peak by samples half an interval off, 1 - cos(pi/(2 n))."""
    for rate, words in (
        ("40 kHz", "may be 1.9 % low"),
        ("25 kHz", "may be 4.9 % low"),
        ("1 kHz", "80 % of the pulses"),
    ):
        solution = run_case(load_case(ROTARY, [f"recorder.sampling_rate={rate}", "feed.blows=1"]))
        (message,) = [notice.message for notice in solution.notices if notice.code == "recorder-rate"]
        assert words in message


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
    from strikewave.analyses.machine.result import sensor_results
    from strikewave.studies.simulation import Simulation

    short = with_sensors("iec-60068-2-27-rubber", ["machine.follow=4 ms"], accel=FILTERED)
    solution = run_case(short)
    assert solution.readings[0].sensors["accel"].cut
    assert "machine.follow" in next(notice.message for notice in solution.notices if notice.code == "sensor-cut")
    assert not sensor_results(solution.readings)
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
    over = SensorReading(
        time, np.where(time < 11e-3, 5.0 * G * np.sin(np.pi * time / 11e-3), G), False, False, 5.0 * G, 0.0
    )
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
