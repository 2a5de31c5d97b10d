"""Sensors where they sit: what a reading is read for, by hand, and what is told of it."""

import math

import numpy as np
import pytest

from strikewave.sensors import Gasket, Mounting, Recorder, Sensor, SensorReading
from strikewave.sensors import trial as module
from strikewave.sensors.trial import (
    FULL_SCALE,
    NOISE,
    RANGE,
    RECORDER,
    RESONANCE,
    TAKES,
    SensorChannel,
    SensorPulse,
    channel_notices,
    lowest_resonance,
    sensor_pulse,
    sensor_sources,
    settling_time,
    shortest_period,
    still_on,
    try_sensor,
)
from strikewave.signal.filters import low_pass
from strikewave.signal.oscillators import interpolate
from strikewave.signal.pulse import Pulse, measure_pulse

BUFFER = Mounting((Gasket(1100.0, 10e6, 1e-4, 2e-3, 0.3),), 5e-3)


def channel(sensor=None, recorder=None):
    return SensorChannel(sensor or Sensor(), None, recorder or Recorder())


def reading(values, step=0.5, clipped=False):
    values = np.array(values, dtype=float)
    return SensorReading(step * np.arange(values.size), values, False, clipped, 0.0, 0.0)


def test_the_shortest_period_is_that_of_the_highest_resonance_or_of_200_khz_through_a_buffer():
    slow, fast, buffered = (channel(s) for s in (Sensor(resonance=1e4), Sensor(resonance=4e5), Sensor(mounting=BUFFER)))
    assert shortest_period([slow, channel(), fast]) == pytest.approx(2.5e-6, rel=1e-15)
    assert shortest_period([slow, buffered]) == pytest.approx(5e-6, rel=1e-15)
    assert shortest_period([fast, buffered]) == pytest.approx(2.5e-6, rel=1e-15)
    assert shortest_period([channel()]) == shortest_period([]) == math.inf


def test_the_filter_of_a_recorder_has_answered_a_blow_when_it_has_settled():
    """To a step of four poles: within a hundredth of it from then on, and not yet at half that time.

    Of its largest answer to an impulse 1.33 % are left, to the digits printed.
    """
    step, cutoff = 1e-7, 20e3
    answer = np.abs(1.0 - low_pass(np.ones(4000), step, cutoff, 4))
    kick = np.abs(np.diff(answer))
    settled = settling_time(channel(recorder=Recorder(cutoff=cutoff)))
    assert settled == pytest.approx(2.0 / cutoff, rel=1e-15)
    place = round(settled / step)
    assert answer[place:].max() < 0.01 < answer[place // 2 :].max()
    assert kick[place:].max() / kick.max() == pytest.approx(0.0133, abs=5e-5)


PULSE = [0.0, 40.0, 100.0, 40.0, *[30.0] * 92, 30.0, 30.0, 15.0, -15.0]
"""A hundred samples, of which the last two, 2 %, ring about zero."""


@pytest.mark.parametrize(
    ("values", "at_rest", "on"),
    [
        (PULSE, 0.0, False),
        ([*PULSE[:-2], 30.0, 30.0], 0.0, True),
        ([*PULSE[:-2], 30.0, 30.0], 29.0, False),  # at rest it reads that
        ([0.0, 100.0, 50.0, 5.0], 0.0, False),  # few samples: the last one
        ([0.0, 100.0, 50.0, 9.9], 0.0, False),
        ([0.0, 100.0, 50.0, 10.1], 0.0, True),
        ([0.0, -100.0, -9.9], 0.0, False),
        ([0.0, -100.0, -20.0], 0.0, True),
        ([0.0, -100.0, -20.0], -19.0, False),
        ([50.0, 0.0, 100.0, 50.0], 0.0, False),  # as it began
        ([0.05, 0.1, 0.0101], 5.0, True),
        ([0.0, 100.0, 50.0], -50.0, True),
        ([], 0.0, False),
    ],
)
def test_a_reading_is_still_on_where_it_ends_a_tenth_of_its_peak_from_every_level(values, at_rest, on):
    assert still_on(reading(values), at_rest) is on


def test_sources_are_those_of_the_models_that_take_part():
    plain = channel(Sensor("plain"))
    assert sensor_sources([]) == sensor_sources([plain, plain]) == []
    assert sensor_sources([plain, channel(Sensor(resonance=1e5))]) == ["smallwood-1981", "van-loan-1978"]
    assert sensor_sources([plain, channel(Sensor(mounting=BUFFER))])[2:] == ["patera-1984", "emmerich-korn-1987"]


@pytest.mark.parametrize(
    ("values", "peak", "width"),
    [
        ([0.0, 100.0, 0.0], 100.0, 0.9),  # 0.9 of a step to either side
        ([0.0, 0.0, 2e-3, 0.0], 2e-3, 0.9),
        ([0.0, 100.0, 0.0, -300.0], -300.0, 0.9),
        ([-1.0, -2.0, -1.0], -2.0, math.nan),
        ([1.0, 3.0], 3.0, math.nan),
        ([7.0], 7.0, math.nan),
        ([], math.nan, math.nan),
    ],
)
def test_a_reading_has_its_largest_value_and_its_width_at_a_tenth(values, peak, width):
    found = sensor_pulse(reading(values))
    assert (found.peak, found.width) == pytest.approx((peak, width), rel=1e-14, nan_ok=True)
    assert not found.clipped
    assert sensor_pulse(reading([0.0, 1.0, 0.0], clipped=True)).clipped
    later = sensor_pulse(reading(values)._replace(time=7.0 + reading(values).time))
    assert (later.peak, later.width) == pytest.approx((peak, width), rel=1e-12, nan_ok=True)


def test_notices_tell_what_clips_what_is_missed_and_what_is_heavy():
    one, two = SensorPulse(5.0, 1.0, True), SensorPulse(math.nan, math.nan, False)
    cut = channel(Sensor("cut", range=8.0), Recorder(sampling_rate=2e3))
    free = channel(Sensor("free", mounting=Mounting((), 0.021, 1e6)))
    light = channel(Sensor("light", mounting=Mounting((), 0.019, 1e6)))
    calm = SensorPulse(5.0, 1.0, False)
    pulses = [
        {"cut": one, "free": calm, "light": calm},
        {"cut": two, "free": one, "light": calm},
        {"cut": two, "free": calm, "light": calm},
    ]
    found = channel_notices([cut, free, light], pulses, 1.0)
    told = [(notice.code, notice.value, notice.limit) for notice in found]
    assert told == [
        ("sensor-clipped", 1.0, 8.0),
        ("recorder-slow", 2e3, 0.0),
        ("sensor-clipped", 1.0, 0.0),  # by its recorder: it has no range
        ("heavy-sensor", 0.021, 0.02),
    ]
    assert "clips in 1 of 3 pulses" in found[0].message
    assert "no sample in 2 of 3 pulses" in found[1].message
    assert channel_notices([light], [{"light": calm}], 2.0) == ()


STEP, BEGIN, LONG = 1e-6, 300, 1e-4
"""A half-sine of 100 samples: it begins after 0.3 ms."""


def half_sine(peak=1e4, duration=LONG, size=1200):
    u = STEP * (np.arange(size) - BEGIN) / duration
    return np.where((u > 0.0) & (u < 1.0), peak * np.sin(np.pi * u), 0.0)


def response(time, duration, resonance, quality):
    """w^2 times the stretch of a damped oscillator whose base moves by a half-sine of one: a textbook's, in complex form.

    Particular solution Im(e^{i d t} / (1 - r^2 + 2 i z r)), r = d/w, and the free one that begins from rest; after the
    half-sine the same begins again, added, a half period later.
    """
    w, z, drive = 2.0 * math.pi * resonance, 0.5 / quality, math.pi / duration
    damped, r = w * math.sqrt(1.0 - z * z), drive / w

    def from_rest(t):
        H = 1.0 / (1.0 - r * r + 2j * z * r)
        x0, v0 = H.imag, (1j * drive * H).imag
        free = np.exp(-z * w * t) * (x0 * np.cos(damped * t) + (v0 + z * w * x0) / damped * np.sin(damped * t))
        return np.where(t > 0.0, (H * np.exp(1j * drive * t)).imag - free, 0.0)

    return from_rest(time) + from_rest(time - duration)


@pytest.mark.parametrize(("resonance", "quality"), [(80e3, 30.0), (40e3, 10.0), (15e3, 5.0), (4e3, 30.0)])
def test_a_half_sine_on_one_resonance_is_its_closed_form(resonance, quality):
    trial = try_sensor(Sensor(resonance=resonance, quality=quality, range=1e5), Recorder(), half_sine(), STEP, BEGIN)
    time = np.linspace(0.0, 9e-4, 90_001)
    exact = response(time, LONG, resonance, quality)
    motion = np.where(time < LONG, np.sin(np.pi * time / LONG), 0.0)
    # interpolated half-sines round the corner at either end over a sample: 1e-3 of the peak at the fastest resonance
    assert trial.peak == pytest.approx(1e4, rel=1e-4)
    assert trial.peak_left == pytest.approx(exact.max(), abs=2e-3)
    assert trial.range_used == pytest.approx(0.1 * np.abs(exact).max(), rel=3e-3)
    assert trial.ringing == pytest.approx(np.abs(exact - motion).max(), abs=3e-3)
    top = int(np.argmax(exact))
    above = exact > 0.1 * exact[top]
    first = top - int(np.argmin(above[top::-1])) + 1
    last = top + int(np.argmin(above[top:]))
    assert trial.width_left * LONG * 0.936231 == pytest.approx((last - first) * 1e-8, rel=3e-3)


def test_clipping_is_exact_at_the_range_and_lasts_as_long_as_the_half_sine_is_above_it():
    values = half_sine()
    trial = try_sensor(Sensor(range=0.8e4), Recorder(), values, STEP, BEGIN)
    assert trial.verdict == RANGE
    assert trial.peak_left * trial.peak == pytest.approx(0.8e4, rel=1e-12)
    assert trial.range_used == pytest.approx(1.25, rel=1e-4)
    # of new samples 1/16 us apart, one to either side
    assert trial.time_clipped == pytest.approx(LONG * (1.0 - 2.0 * math.asin(0.8) / math.pi), abs=0.13e-6)
    below, above = (try_sensor(Sensor(range=x * 1e4), Recorder(), values, STEP, BEGIN) for x in (1.001, 0.999))
    assert (below.verdict, above.verdict) == (TAKES, RANGE)
    assert below.time_clipped == 0.0 < above.time_clipped


@pytest.mark.parametrize(
    ("sensor", "recorder", "duration", "verdict"),
    [
        (Sensor(resonance=350e3), Recorder(), LONG, TAKES),
        (Sensor(resonance=20e3), Recorder(), LONG, RESONANCE),
        (Sensor(resonance=80e3, range=1.02e4), Recorder(), LONG, RANGE),  # by its own overshoot
        (Sensor(), Recorder(sampling_rate=100e3, cutoff=20e3), 1e-3 * 0.3, TAKES),
        (Sensor(), Recorder(sampling_rate=100e3, cutoff=20e3), 30e-6, RECORDER),
        (Sensor(), Recorder(sampling_rate=2e3), LONG, RECORDER),  # hardly a sample in it
        (Sensor(range=1e5), Recorder(full_scale=5e3), LONG, FULL_SCALE),
        (Sensor(mounting=Mounting((Gasket(1100.0, 10e6, 1e-4, 2e-3, 0.3),), 5e-3)), Recorder(), LONG, RESONANCE),
    ],
)
def test_the_verdict_names_what_spoils_the_blow(sensor, recorder, duration, verdict):
    assert try_sensor(sensor, recorder, half_sine(duration=duration), STEP, BEGIN).verdict == verdict


def test_a_recorder_is_judged_by_the_worst_place_of_its_instants():
    """Ten instants in a half-sine, half an interval off its top: a parabola takes most of that back."""
    plain = try_sensor(Sensor(), Recorder(sampling_rate=30e3), half_sine(), STEP, BEGIN)
    u = (np.arange(40) + np.array([[0.0], [0.25], [0.5], [0.75]])) / 30e3 - BEGIN * STEP
    kept = np.where((u > 0.0) & (u < LONG), np.sin(np.pi * u / LONG), 0.0)
    seen = [measure_pulse(row, 1.0 / 30e3) for row in kept]
    peak = max((one.peak for one in seen), key=lambda share: abs(share - 1.0))
    width = max((one.width / (0.936231 * LONG) for one in seen), key=lambda share: abs(share - 1.0))
    # interpolated half-sines round the corner at either end over a sample: 1e-3 of the peak
    assert plain.peak_left == pytest.approx(peak, abs=1e-3)
    assert plain.width_left == pytest.approx(width, abs=5e-3)


def test_noise_that_drives_a_resonance_is_not_taken_for_the_blow():
    values = half_sine(duration=3e-4, size=2000) + 300.0 * np.random.default_rng(1).normal(size=2000)
    trial = try_sensor(Sensor(resonance=300e3, quality=100.0), Recorder(), values, STEP, BEGIN)
    assert trial.noise_ringing > 0.05
    assert trial.verdict == NOISE


def test_the_lowest_resonance_is_that_of_the_mounting_where_it_is_lower():
    soft = Mounting((Gasket(1.0, 4e6 * math.pi**2, 1e-4, 1e-3),), 1e-2)  # a mass on a spring, 3.16 kHz
    assert lowest_resonance(Sensor(mounting=soft, resonance=80e3)) == pytest.approx(math.sqrt(1e7), rel=1e-3)
    assert math.isinf(lowest_resonance(Sensor()))


def test_a_recorder_that_overshoots_at_some_of_its_instants_cannot_take_a_blow():
    """Its low-pass of fourth order makes 6 % more of a flat top; sampled slowly, at some places of its first instant."""
    u = STEP * (np.arange(1200) - BEGIN)
    blow = 1e4 * np.clip(np.minimum(u / 1e-5, (LONG - u) / 1e-5), 0.0, 1.0)
    for rate in (math.inf, 2e5):
        found = try_sensor(Sensor(range=1e5), Recorder(cutoff=50e3, sampling_rate=rate), blow, STEP, BEGIN)
        assert found.peak_left == pytest.approx(1.06, abs=0.015)
        assert found.verdict == RECORDER


def test_a_blow_that_falls_between_the_instants_of_a_recorder_is_not_read():
    found = try_sensor(Sensor(range=1e5), Recorder(sampling_rate=4e3, full_scale=1e5), half_sine(size=430), STEP, BEGIN)
    assert found.peak_left == 0.0
    assert math.isnan(found.width_left)
    assert found.verdict == RECORDER


def test_a_shifted_zero_uses_up_the_range_and_leaves_the_pulse():
    held, beyond = (
        try_sensor(Sensor(range=r, zero_shift=2e3), Recorder(), half_sine(), STEP, BEGIN) for r in (1.3e4, 1.1e4)
    )
    assert (held.verdict, beyond.verdict) == (TAKES, RANGE)
    assert held.range_used == pytest.approx(12.0 / 13.0, rel=1e-4)
    assert (held.peak_left, held.width_left) == pytest.approx((1.0, 1.0), rel=1e-9)
    assert held.ringing + held.noise_ringing == pytest.approx(0.0, abs=1e-15)
    assert held.time_clipped == 0.0
    # above 0.9 of the peak
    assert beyond.time_clipped == pytest.approx(LONG * (1.0 - 2.0 * math.asin(0.9) / math.pi), abs=0.13e-6)
    assert beyond.peak_left == pytest.approx(0.9, rel=1e-4)


def test_noise_is_what_comes_before_the_foot_alone():
    """A step of 60 before it departs by as much, 0.6 % of the peak, and a fifth of it; the blow itself rings far more."""
    values = half_sine()
    values[100:BEGIN] += 60.0
    found = try_sensor(Sensor(resonance=30e3, quality=1e6, range=1e5), Recorder(), values, STEP, BEGIN)
    assert found.noise_ringing == pytest.approx(6e-3, rel=0.4)
    assert found.ringing > 0.1
    assert try_sensor(Sensor(resonance=30e3), Recorder(), half_sine(), STEP, 0).noise_ringing < 1e-9


def test_a_blow_that_begins_at_once_has_no_noise_before_it():
    """The first sample alone, where both are at rest; at the next one a soft mounting already lags."""
    values = half_sine()[BEGIN:]
    assert try_sensor(Sensor(resonance=2e3), Recorder(), values, STEP, 0).noise_ringing < 1e-4
    assert try_sensor(Sensor(resonance=2e3), Recorder(), values, STEP, 1).noise_ringing > 1e-3


@pytest.mark.parametrize("full_scale", [9.0e3, 9.9e3])
def test_a_recorder_that_clips_at_some_of_its_instants_has_too_small_a_scale(full_scale):
    """Instants 0.3 of the half-sine apart: at its top some stand at sin 90 deg, others at sin 76 deg or lower."""
    recorder = Recorder(sampling_rate=1.0 / (0.3 * LONG), full_scale=full_scale)
    assert try_sensor(Sensor(range=1e5), recorder, half_sine(), STEP, BEGIN).verdict == FULL_SCALE


@pytest.mark.parametrize("share", [0.5, 0.502, 0.51])
def test_a_filter_above_all_that_the_dense_motion_holds_is_none(share):
    recorder = Recorder(cutoff=share * 16.0 / STEP)
    found = try_sensor(Sensor(range=1e5), recorder, half_sine(), STEP, BEGIN)
    assert (found.peak_left, found.width_left) == pytest.approx((1.0, 1.0), rel=1e-12)


@pytest.mark.parametrize(
    ("peak", "width", "close"),
    [
        *((1.0 + x, 1.0, True) for x in (0.049, -0.049)),
        *((1.0 + x, 1.0, False) for x in (0.051, -0.051)),
        *((1.0, 1.0 + x, True) for x in (0.049, -0.049)),
        *((1.0, 1.0 + x, False) for x in (0.051, -0.051)),
        (1.0, math.nan, True),
        (math.nan, 1.0, False),
    ],
)
def test_five_percent_of_peak_and_width_are_tolerated(peak, width, close):
    assert module._close(peak, width) is close


def test_the_share_farthest_from_one_counts_and_a_width_that_is_not_known_last(monkeypatch):
    assert module._farthest([1.006, 0.993, 1.002], 0.0) == 0.993
    assert module._farthest([1.006, 0.9951, 1.002], 0.0) == 1.006
    assert math.isnan(module._farthest([1.4, math.nan], math.inf))
    widths = iter([math.nan, 99.8 * 16, 100.5 * 16, math.nan])
    monkeypatch.setattr(module, "_pulse", lambda *_: Pulse(0.0, 1e4, next(widths), 0.0, 0.0))
    monkeypatch.setattr(module, "_interval", lambda one, step: step)
    monkeypatch.setattr(module, "measure_pulse", lambda *_: Pulse(0.0, 1e4, LONG, 0.0, 0.0))
    found = try_sensor(Sensor(range=1e5), Recorder(sampling_rate=1e6), half_sine(), STEP, BEGIN)
    assert found.width_left == pytest.approx(1.005, rel=1e-12)


def test_three_samples_make_a_pulse_however_small_and_a_flat_top_is_as_high_as_it_is():
    """Of 1, 5, 1: a parabola's top is the middle one; of 1, 5, 4 it lies 0.3 aside, 9/40 higher; clipped, nowhere."""

    def pulse(values, clipped=False):
        values = np.array(values)
        return module._pulse(SensorReading(np.arange(values.size), values, False, clipped, 0.0, 0.0), 1e-3)

    assert pulse([2e-3, 6e-3, 2e-3]).peak == pytest.approx(5e-3, rel=1e-12)
    assert pulse([1.001, 5.001, 4.001]).peak == pytest.approx(5.0 + 9.0 / 40.0, rel=1e-12)
    assert pulse([1.001, 5.001, 4.001], True).peak == pytest.approx(5.0, rel=1e-12)
    for nothing in ([5.0, 6.0], [0.0, 1e-3, 0.0], [-3.0, -1.0, -3.0]):
        assert pulse(nothing)[1:] == pytest.approx((0.0, math.nan, math.nan, math.nan), nan_ok=True)


def test_a_motion_is_made_16_times_as_dense_as_far_as_it_stays_in_bounds(monkeypatch):
    factors = []
    monkeypatch.setattr(module, "interpolate", lambda values, by: factors.append(by) or interpolate(values, by))
    for most in (4_000_000, 3000, 1000):
        monkeypatch.setattr(module, "MOST_SAMPLES", most)
        try_sensor(Sensor(range=1e5), Recorder(), half_sine(), STEP, BEGIN)
    assert factors == [16, 2, 1]
