"""Figures of single blows against their closed forms, and what is no blow."""

import dataclasses
import math

import numpy as np
import pytest

from strikewave.records import find_pulses, measuring
from strikewave.records.baseline import LocalBaseline
from strikewave.records.contacts import Box
from strikewave.records.measuring import BlowWindow, Rebound, RecordedPulse
from strikewave.records.pulse_shape import PulseUncertainty, ReadPulse, SmoothPulse
from strikewave.records.ringing import BandSplit

RATE, STEP = 1e6, 1e-6
T, HEIGHT, BEGIN = 200e-6, 5000.0, 10e-3


def half_sine(time, begin=BEGIN, duration=T, height=HEIGHT):
    u = (time - begin) / duration
    return height * np.where((u > 0) & (u < 1), np.sin(np.pi * u), 0.0)


@pytest.fixture
def time():
    return np.arange(40_000) * STEP


@pytest.mark.parametrize("noise", [0.0, 2.0])
def test_half_sine_measures_what_its_closed_form_says(time, rng, noise):
    [pulse] = find_pulses(half_sine(time) + 30.0 + noise * rng.normal(size=time.size), STEP)
    # without noise what is left is the sampling, 200 a blow; noise is 4e-4 of the peak
    assert pulse.peak == pytest.approx(HEIGHT, rel=1e-4 + 3 * noise / HEIGHT)
    assert pulse.time == pytest.approx(BEGIN + T / 2, abs=STEP if not noise else 5 * STEP)
    assert pulse.width == pytest.approx(T * (1 - 2 * math.asin(0.1) / math.pi), abs=STEP)
    assert pulse.rise == pytest.approx(T * (math.asin(0.9) - math.asin(0.1)) / math.pi, abs=STEP)
    # between the feet at 2 % all but 1 - cos(asin 0.02) = 2e-4 of the area lies
    assert pulse.velocity_change == pytest.approx(2 * HEIGHT * T / math.pi, rel=1e-3)
    assert pulse.begin == pytest.approx(BEGIN + T * math.asin(0.02) / math.pi, abs=2 * STEP)
    assert pulse.end == pytest.approx(BEGIN + T * (1 - math.asin(0.02) / math.pi), abs=2 * STEP)
    assert pulse.begin < pulse.time < pulse.end
    assert pulse.offset == pytest.approx(30.0, abs=1e-9 + noise)
    assert pulse.smooth.peak == pytest.approx(HEIGHT, rel=2e-3)
    assert pulse.smooth.width() == pytest.approx(pulse.width, rel=5e-3)
    assert pulse.smooth.misfit < 2e-3
    assert math.isnan(pulse.ringing_frequency)


@pytest.mark.verify
def test_noise_is_smoothed_off_the_peak(time):
    # noise of 3 % of the peak: the largest of the 40 samples near the top stands about 2.2 times that too high
    peaks = []
    for seed in range(20):
        noise = 0.03 * HEIGHT * np.random.default_rng(seed).normal(size=time.size)
        [pulse] = find_pulses(half_sine(time) + noise, STEP)
        peaks.append(pulse.peak)
    assert abs(np.mean(peaks) / HEIGHT - 1.0) < 0.02
    assert np.std(peaks) / HEIGHT < 0.02


def test_blows_of_a_third_of_the_area_and_of_two_and_a_half_times_the_width_count(time):
    small = find_pulses(half_sine(time) + half_sine(time, 25e-3, T, 0.3 * HEIGHT), STEP)
    assert [round(p.peak / HEIGHT, 2) for p in small] == [1.0, 0.3]
    wide = find_pulses(half_sine(time) + half_sine(time, 25e-3, 2.5 * T, 0.5 * HEIGHT), STEP)
    assert [round(p.width / p.smooth.width(), 1) for p in wide] == [1.0, 1.0]
    assert wide[1].width / wide[0].width == pytest.approx(2.5, rel=0.01)


def test_what_only_swings_holds_no_blow(time, rng):
    decay = np.exp(-np.maximum(time - BEGIN, 0.0) / 3e-3) * (time > BEGIN)
    swing = (
        HEIGHT
        * decay
        * np.sin(2 * np.pi * 2.5e3 * (time - BEGIN) + 0.5 * np.pi)
        * np.minimum((time - BEGIN) / 2e-3, 1.0)
    )
    assert find_pulses(swing + rng.normal(size=time.size), STEP) == []


def test_ringing_frequency_is_that_of_the_swing_after_the_blow(time):
    since = np.maximum(time - BEGIN - T / 2, 0.0)
    ringing = 0.1 * HEIGHT * np.exp(-since / 2e-3) * np.sin(2 * np.pi * 7e3 * since)
    [pulse] = find_pulses(half_sine(time) + ringing, STEP)
    # a decay of 2 ms widens the line to 1/(2 pi 2 ms) = 80 Hz; its middle is known better
    assert pulse.ringing_frequency == pytest.approx(7e3, abs=40.0)


@pytest.mark.parametrize("shape", [lambda u: np.sin(np.pi * u), lambda u: np.sin(np.pi * u) ** 2, lambda u: 1.0 - u])
@pytest.mark.parametrize("length", [0.15e-3, 0.3e-3, 0.8e-3])
@pytest.mark.parametrize("noise", [0.2, 2.0])
def test_the_tail_of_a_blow_is_no_ringing(time, rng, shape, length, noise):
    """In noise of 4e-5 and 4e-4 of the peak, where a few samples of a tail stand out of it."""
    share = (time - BEGIN) / length
    pulse = np.where((share >= 0.0) & (share <= 1.0), shape(np.clip(share, 0.0, 1.0)), 0.0)
    [found] = find_pulses(HEIGHT * pulse + noise * rng.normal(size=time.size), STEP)
    assert math.isnan(found.ringing_frequency)


@pytest.mark.parametrize("share", [0.2, 1.0])
def test_a_zero_that_drifts_in_a_straight_line_moves_no_figure(time, share):
    [plain] = find_pulses(half_sine(time), STEP)
    [drifting] = find_pulses(half_sine(time) + share * HEIGHT * time / time[-1], STEP)
    # the line is found to the width of the blocks it is drawn through; the blow lasts 1/200 of the record
    assert drifting.peak == pytest.approx(plain.peak, rel=0.01)
    assert drifting.velocity_change == pytest.approx(plain.velocity_change, rel=0.02)


def test_a_record_that_does_not_come_back_gives_the_velocity_change_of_the_smooth_pulse(time):
    plateau = 0.04 * HEIGHT * (time > BEGIN + T / 2)
    [pulse] = find_pulses(half_sine(time) + plateau, STEP)
    assert pulse.velocity_change == pulse.smooth.area()
    assert pulse.velocity_change == pytest.approx(2 * HEIGHT * T / math.pi, rel=0.1)


WINDOW = BlowWindow(Box(100, 10, 5.0), 0, 400, 1, LocalBaseline(2.0, wander=0.3, width=10), 0.5, 1e-3, 7.0)


@pytest.mark.parametrize(
    ("earliest", "latest", "widths", "reach"),
    [
        (0, 400, 1, (88, 123)),
        (0, 400, 5, (48, 163)),
        (90, 400, 5, (95, 163)),
        (0, 121, 5, (48, 116)),
        (0, 400, 12, (0, 233)),
    ],
)
def test_a_blow_reaches_halfway_to_its_neighbours(earliest, latest, widths, reach):
    """Two samples more before, and three after, at most; to the end of a record of 400 where none follows."""
    window = dataclasses.replace(WINDOW, earliest=earliest, latest=latest)
    assert measuring._reach(window, 400, widths) == reach
    assert window.time(3) == 7.003
    assert window.baseline.level == 2.0


def test_the_uncertainty_of_figures_read_off_a_record():
    """A level that wanders: on the peak as it is, on the width by the slope at 10 %, on the area over its duration; beside
    them what reading says, and 2 % of the peak for a sample at the feet."""
    smooth = SmoothPulse(5.0, 7.1, 0.02, 0.5, 1.0)
    read = ReadPulse(np.zeros(1), 0.0, 5.0, 1.0, 1.0, 0.4, 3.0)
    found = measuring._of_record(smooth, (7.1, 7.12), WINDOW, read)
    slope = 2.0 * 0.02 / (math.pi * math.sqrt(0.99))
    assert found.peak == pytest.approx(0.5)
    assert found.width == pytest.approx(math.hypot(slope * 0.3 / 5.0, 3e-3), rel=1e-4)
    assert found.velocity_change == pytest.approx(math.hypot(0.3 * 10 * math.sqrt(2.0) * 1e-3, 0.02 * 5.0 * 1e-3))


@pytest.mark.parametrize(("wander", "times"), [(math.nan, 1.0), (0.1, 1.0), (0.5, math.sqrt(10.0))])
def test_the_uncertainty_of_fitted_figures_grows_with_what_wanders(wander, times):
    """White noise of 0.5 wanders by 0.5 / sqrt(10) over ten samples."""
    smooth = SmoothPulse(5.0, 7.1, 0.02, 0.5, 1.0)
    window = dataclasses.replace(WINDOW, baseline=LocalBaseline(2.0, wander=wander, width=10))
    assert np.array(dataclasses.astuple(measuring._of_fit(smooth, window))) == pytest.approx(
        times * np.array(dataclasses.astuple(smooth.uncertainty(1e-3, 0.5))), rel=1e-9
    )


@pytest.mark.parametrize("cycles", [6, 9.37])
def test_ringing_after_a_blow_is_found_between_the_lines(cycles):
    """A swing of constant size over 280 samples, faded by Hann's window: a parabola through logarithms finds it to 0.3 %."""
    values = 2.0 + np.r_[np.zeros(118), 3.0 * np.sin(2.0 * np.pi * cycles / 280.0 * np.arange(282))]
    window = dataclasses.replace(WINDOW, noise=0.01)
    assert measuring._ringing(values, window) == pytest.approx(cycles / 0.28, rel=3e-3 if cycles > 6 else 0.02)
    assert math.isnan(measuring._ringing(values, dataclasses.replace(window, latest=159)))  # 31 samples
    # power (3 / 2 x 140)^2 over 30 times the noise in squares of the window, 105: a noise of 3.7
    assert measuring._ringing(values, dataclasses.replace(window, noise=3.3)) > 0.0
    assert math.isnan(measuring._ringing(values, dataclasses.replace(window, noise=4.2)))


def measured(**more):
    smooth = SmoothPulse(5.0, 7.1, 0.02, 0.5, 1.0)
    known = (7.11, 5.0, 0.01, 0.02, 0.06, math.nan, 2.0, 0.0, smooth, "record", 7.1, 7.12)
    return dataclasses.replace(RecordedPulse(*known, step=1e-3), **more)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_rebound_after_a_swing_to_the_other_side_is_a_lobe(sign):
    one = measured(peak=5.0 * sign, rebounds=(Rebound(7.2, 2.0 * sign, 0.01),))
    for place, deep, count in (
        (150, -1.01, 0),
        (150, -0.99, 1),
        (119, -9.0, 1),
        (120, -9.0, 0),
        (199, -9.0, 0),
        (200, -9.0, 1),
    ):
        values = np.full(400, 2.0)
        values[place] += sign * deep
        assert len(measuring.one_sided(values, 1e-3, 7.0, one)) == count, place


def test_the_stretch_about_a_blow():
    """A width of 20 samples before it, 5 widths or eight swings after it, turned upwards, over its zero."""
    values = np.arange(400.0)
    found = measuring.stretch_of(values, 1e-3, 7.0, measured(peak=-5.0))
    assert found.values.tolist() == [-(k - 2.0) for k in range(80, 221)]
    assert (found.begin, found.end, found.width, found.step) == (20, 40, pytest.approx(20.0), 1e-3)
    assert (found.smooth.peak, found.smooth.begin) == (-5.0, pytest.approx(0.02))
    rings = measuring.stretch_of(values, 1e-3, 7.0, measured(ringing_frequency=50.0))
    assert rings.values.size == 40 + 160 + 1
    assert measuring.stretch_of(values, 1e-3, 7.0, measured(), 7.15).values.size == 70
    assert measuring.stretch_of(values, 1e-3, 7.0, measured(width=math.nan)).width == pytest.approx(
        1e3 * measured().smooth.width()
    )
    assert measuring.stretch_of(values, 1e-3, 7.0, measured(width=2e-3, end=7.102)).values.size == 2 + 2 + 32 + 1


def test_the_stretch_about_a_blow_ends_with_the_record():
    values = np.arange(400.0)
    early = measuring.stretch_of(values, 1e-3, 7.0, measured(begin=7.005, end=7.02))
    assert (early.values[0], early.begin, early.end) == (-2.0, 5, 20)
    assert early.smooth.begin == pytest.approx(0.1)
    late = measuring.stretch_of(values, 1e-3, 7.0, measured(begin=7.39, end=7.5))
    assert (late.values[0], late.values[-1], late.begin, late.end) == (368.0, 397.0, 20, 29)
    before = measuring.stretch_of(values, 1e-3, 7.0, measured(begin=6.9, end=7.02))
    assert (before.begin, before.end, before.values[0]) == (0, 20, -2.0)
    assert measuring.stretch_of(values, 1e-3, 7.0, measured(), 7.11).values.size == 120 - 80  # its own end at least


def test_a_blow_near_an_end_of_its_record_has_the_same_figures():
    """Two samples behind it are enough; with half of its width before it the line of the record is its baseline."""
    values = 100.0 * np.sin(np.pi * np.clip((np.arange(3000.0) - 1000.3) / 50.0, 0.0, 1.0))
    [whole] = find_pulses(values, 1e-3)
    for last in (1060, 1052):
        [cut] = find_pulses(values[:last], 1e-3)
        assert (cut.peak, cut.width, cut.velocity_change, cut.time, cut.begin, cut.end) == (
            whole.peak, whole.width, whole.velocity_change, whole.time, whole.begin, whole.end,
        )  # fmt: skip
    for first in (930, 970):
        [cut] = find_pulses(values[first:], 1e-3, first * 1e-3)
        assert (cut.peak, cut.width, cut.velocity_change) == pytest.approx(
            (whole.peak, whole.width, whole.velocity_change), rel=1e-4
        )
        assert (cut.time, cut.begin, cut.end) == pytest.approx((whole.time, whole.begin, whole.end), abs=1e-6)
    [cut] = find_pulses(values[:1045], 1e-3)
    assert (cut.peak, math.isnan(cut.width)) == (whole.peak, True)


def split_of(peak, doubt, **parts):
    known = {"loss_uncertainty": 0.0, "leak": 0.0, "elastic": 0.0} | parts
    return BandSplit(
        1e3, 2e3, peak, 0.018, doubt, 1e-3, 0.0, known["loss_uncertainty"], known["leak"], known["elastic"], 0, 0
    )


def test_a_rigid_part_is_known_within_a_tenth_and_differs_by_what_harms():
    assert measured(split=split_of(-5.0, 0.5)).split_peak == -5.0
    unknown = measured(split=split_of(-5.0, 0.51, leak=0.2, elastic=0.1))
    assert math.isnan(unknown.split_peak)
    assert math.isnan(unknown.split_width)
    assert "leaves too much of the wave part (20 % of the peak)" in unknown.split.reason
    assert split_of(5.0, 0.4).reason == ""
    assert split_of(5.0, 0.4).signed(-1.0).peak == -5.0
    assert math.isnan(measured().methods_apart)
    assert not measured(split=dataclasses.replace(split_of(5.0, 0.1), width=0.02)).differs_by_split
    assert measured(split=dataclasses.replace(split_of(6.0, 0.1), width=0.02)).differs_by_split
    assert measured(split=dataclasses.replace(split_of(5.0, 0.1), width=0.016)).differs_by_split


def test_the_area_over_another_duration_wanders_with_it():
    known = measured(baseline=LocalBaseline(2.0, wander=0.3, width=10), uncertainty=PulseUncertainty(0.1, 0.2, 0.4))
    assert known.area_uncertainty(0.09) == pytest.approx(0.3 * 10 * 3.0 * 1e-3)
    assert measured(uncertainty=PulseUncertainty(0.1, 0.2, 0.4)).area_uncertainty(0.09) == 0.4
