"""Rigid part by a low-pass: against closed forms, the project's own bars, and planted shapes."""

import dataclasses
import math

import numpy as np
import pytest

from strikewave.records import find_pulses
from strikewave.records.pulse_shape import SmoothPulse
from strikewave.records.ringing import (
    FAMILY,
    BandSplit,
    Stretch,
    _best_cutoff,
    _family_as_wide,
    _lowest_mode,
    _only,
    _swing_in_blow,
    _tables,
    _width_through,
    split_bands,
)
from strikewave.signal.filters import Filter
from strikewave.signal.pulse import measure_pulse
from strikewave.waves import Layer, LoadPulse, Stack, Tap, run_bar

STEP, PEAK = 1e-6, 1000.0
TIME = STEP * np.arange(8000)


def half_sine(length, begin=2000e-6, time=TIME):
    u = (time - begin) / length
    return np.where((u > 0.0) & (u < 1.0), PEAK * np.sin(np.pi * np.clip(u, 0.0, 1.0)), 0.0)


def swing(frequency, share, begin=2000e-6, decay=600e-6):
    since = np.maximum(TIME - begin, 0.0)
    return share * PEAK * np.exp(-since / decay) * np.sin(2.0 * np.pi * frequency * since)


def split_of(values, step=STEP):
    return max(find_pulses(values, step), key=lambda pulse: abs(pulse.peak)).split


@pytest.mark.parametrize("share", [0.1, 0.3, 0.6])
def test_a_mode_far_above_the_pulse_is_taken_off(share, rng):
    split = split_of(half_sine(400e-6) + swing(15e3, share) + 0.002 * PEAK * rng.normal(size=TIME.size))
    assert split.separable
    assert split.lowest_mode == pytest.approx(15e3, rel=0.02)  # between the lines of a padded spectrum
    assert 2.0 / 400e-6 < split.cutoff < 15e3
    assert split.peak == pytest.approx(PEAK, rel=0.02)  # two of the 1 % that other shapes are given
    assert abs(split.peak - PEAK) < 2.0 * split.peak_uncertainty
    width = 400e-6 * (1.0 - 2.0 * math.asin(0.1) / math.pi)
    assert abs(split.width - width) < 2.0 * split.width_uncertainty < 0.2 * width


def test_energy_of_the_wave_part_is_that_of_the_swing():
    values = half_sine(400e-6)
    wave = swing(15e3, 0.6)
    # the begin of the swing lies in the band of the pulse, where the split cannot see it: a sixth of its energy here
    energy = np.sum(wave**2) / np.sum((values + wave) ** 2)
    assert split_of(values + wave).wave_energy == pytest.approx(energy, rel=0.2)


@pytest.mark.parametrize("times", [0.8, 1.2, 1.7])
def test_overlapping_bands_are_refused(times, rng):
    """A mode whose period is not half the pulse: no figure is given, and the reason says what overlaps."""
    length = 400e-6
    split = split_of(half_sine(length) + swing(times / length, 0.5) + 0.002 * PEAK * rng.normal(size=TIME.size))
    assert split is None or not split.separable
    if split is not None:
        assert "overlap" in split.reason


def test_a_pulse_that_does_not_ring_is_not_split(rng):
    assert split_of(half_sine(400e-6) + 0.005 * PEAK * rng.normal(size=TIME.size)) is None


def test_a_negative_blow_has_a_negative_rigid_peak():
    values = half_sine(400e-6) + swing(15e3, 0.3)
    up, down = split_of(values), split_of(-values)
    assert down.peak == pytest.approx(-up.peak, rel=1e-9)
    assert down.separable


def test_the_family_comes_back_as_what_it_was():
    """Each member through the filter: from its filtered width its own peak and width, to what lines in a table err."""
    _tables.cache_clear()
    cutoff, length = 5e3, 400e-6
    for k, member in enumerate(FAMILY):
        pulse = member._replace(begin=2000e-6, length=length)
        found = measure_pulse(Filter(cutoff).apply(pulse.at(TIME), STEP), STEP)
        left, widths, wider = _family_as_wide(cutoff * found.width)
        assert found.peak == pytest.approx(left[k], rel=3e-3)
        assert pulse.width() == pytest.approx(widths[k] / cutoff, rel=5e-3)
        assert found.width / pulse.width() - 1.0 == pytest.approx(wider[k], abs=6e-3)


def struck_bar(rng, periods):
    """Return record, step and rigid peak (force over mass) of a free bar, seen at its far end or its middle."""
    length, modulus, density = rng.uniform(0.05, 0.2), rng.uniform(70e9, 210e9), rng.uniform(2700.0, 8000.0)
    bar = Layer("bar", density, modulus, 7e-4, length)
    lowest = math.sqrt(modulus / density) / (2.0 * length)
    duration = periods / lowest
    shape = str(rng.choice(["half-sine", "sine-squared"]))
    tap = Tap(0, float(rng.choice([0.5, 1.0])))
    run = run_bar(Stack((bar,)), LoadPulse(shape, 2e4, duration), [tap], 16.0 * duration)
    fine = run.time[1] - run.time[0]
    factor = max(1, round(duration / 200.0 / fine))
    values = run.acceleration[: run.time.size // factor * factor, 0].reshape(-1, factor).mean(axis=1)
    step, peak = factor * fine, 2e4 / bar.mass
    values = np.concatenate([np.zeros(round(8.0 * duration / step)), values])
    return values + 0.003 * peak * rng.normal(size=values.size), step, peak


def test_rigid_peak_of_a_struck_bar_is_force_over_mass(rng):
    """Six free bars, whose modes never die: the rigid part is known exactly, and two uncertainties hold it."""
    for periods in (3.0, 4.0, 5.0, 6.0, 8.0, 10.0):
        values, step, peak = struck_bar(rng, periods)
        split = split_of(values, step)
        if split is not None and split.separable:
            assert abs(split.peak - peak) < 2.5 * split.peak_uncertainty
            assert split.peak_uncertainty < 0.08 * peak


@pytest.mark.verify
def test_coverage_of_the_rigid_peak_over_sixty_bars():
    """Two standard uncertainties hold 90 % of the peaks that are given, and the median misses by less than one; blows
    shorter than a period of the lowest mode are refused. A mode that the pulse leaves at rest is not seen: that costs
    one draw or two. Bars without loss ring for ever, so that in some no blow is found."""
    rng = np.random.default_rng(20240611)
    misses, errors, short = [], [], []
    for _ in range(60):
        periods = float(np.exp(rng.uniform(np.log(0.5), np.log(12.0))))
        values, step, peak = struck_bar(rng, periods)
        pulses = find_pulses(values, step)
        split = max(pulses, key=lambda pulse: abs(pulse.peak)).split if pulses else None
        if split is not None and split.separable:
            misses.append((split.peak - peak) / split.peak_uncertainty)
            errors.append(split.peak / peak - 1.0)
            short.append(periods)
    within = np.mean(np.abs(misses) < 2.0)
    print(f"{len(misses)} given; bias {np.median(errors):.2%}, spread {np.std(errors):.2%}, within two {within:.0%}")
    assert len(misses) >= 15
    assert within >= 0.9
    assert abs(np.median(misses)) < 1.0
    assert min(short) > 1.0


def test_an_excursion_alone():
    """To where it first falls to zero, on either side; what lies beyond is none of it, and no end is cut off."""
    values = np.array([3.0, -1.0, 1.0, 4.0, 2.0, 0.0, 2.0, -3.0])
    assert _only(values, 3).tolist() == [0.0, -1.0, 1.0, 4.0, 2.0, 0.0, 0.0, 0.0]
    assert _only(np.abs(values) + 1.0, 3).tolist() == (np.abs(values) + 1.0).tolist()
    assert _only(values[::-1], 4).tolist() == [0.0, 0.0, 0.0, 2.0, 4.0, 1.0, -1.0, 0.0]


def ringing_stretch(after, noise=0.0, misfit=0.0, step=1e-5, width=40.0):
    """Return a half-sine of 10 from the sample 60 on for 44 samples, and what follows it from the sample 104 on."""
    smooth = SmoothPulse(10.0, 60 * step, 44 * step, 0.5, 1.0, misfit)
    values = np.zeros(104 + after.size)
    values[:104] = smooth.at(step * np.arange(104))
    values[104:] = after
    return Stretch(values, step, 60, 104, width, smooth, noise)


def tone(frequency, amplitude, size=200):
    return amplitude * np.cos(2.0 * np.pi * frequency * 1e-5 * np.arange(size))


@pytest.mark.parametrize(("share", "noise", "lowest"), [(0.11, 0.62, 9e3), (0.08, 0.0, 25e3), (0.11, 0.9, 25e3)])
def test_the_lowest_mode_has_a_tenth_of_the_highest_line_and_four_noises(share, noise, lowest):
    """A line of amplitude A over n samples is A / 2 times the sum of the window, n / 2, and noise s of a spectrum is
    s sqrt(3 n / 8): an amplitude of 0.5 is 25, and four noises of 0.62 and 0.9 are 21 and 31."""
    after = tone(25e3, 4.5) + tone(9e3, 4.5 * share)
    assert _lowest_mode(ringing_stretch(after, noise), 26e3) == pytest.approx(lowest, rel=0.01)
    assert _lowest_mode(ringing_stretch(after, 1.1), 26e3) == 26e3  # five noises of what swings


def test_slow_motion_after_a_blow_is_no_lowest_mode():
    """Less than 0.3 swings in a width of 0.4 ms, 750 Hz."""
    fast = tone(25e3, 1.0)
    assert _lowest_mode(ringing_stretch(fast + tone(1.5e3, 4.0)), 25e3) == pytest.approx(1.5e3, rel=0.1)
    assert _lowest_mode(ringing_stretch(fast + np.linspace(6.0, -6.0, 200)), 25e3) > 750.0
    assert _lowest_mode(ringing_stretch(0.0 * fast), 25e3) == 25e3


@pytest.mark.parametrize(("decay", "capped"), [(0.01, False), (0.06, True), (-0.01, False)])
def test_a_swing_is_grown_back_to_the_peak_by_its_decay(decay, capped):
    """Of an exponential both halves of whole periods tell the decay exactly; 22 samples lie between peak and foot. What
    grows after a blow is taken as it is; at most three times as much."""
    k = np.arange(200)
    after = 2.0 * np.exp(-decay * k) * np.cos(2.0 * np.pi * k / 20)
    found = _swing_in_blow(ringing_stretch(after), 5e3)
    first = np.max(np.abs(after[:20]))
    assert found == pytest.approx(first * (3.0 if capped else math.exp(22 * max(decay, 0.0))), rel=1e-9)


def test_a_swing_that_has_died_out_is_what_the_smooth_pulse_misses():
    """Root mean square times sqrt 2; and what swings in a period alone is not grown."""
    assert _swing_in_blow(ringing_stretch(np.zeros(200), misfit=0.04), 5e3) == pytest.approx(0.4 * math.sqrt(2.0))
    once = np.zeros(200)
    once[[3, 30]] = 1.5, -4.0
    assert _swing_in_blow(ringing_stretch(once), 5e3) == 1.5
    assert _swing_in_blow(ringing_stretch(once), 3e3) == 4.0
    assert _swing_in_blow(ringing_stretch(np.r_[0.0, 0.0, 0.0, 1.5, -4.0, np.zeros(195)]), 40e3) == 1.5


def test_the_cutoff_costs_least_of_all_that_are_tried():
    """From 0.15 to 1 times the lowest mode: without a swing the highest that is below 0.45 of the rate, for the family
    differs the less; for a strong swing a low one; for a pulse as narrow as the filter none."""
    width, lowest = 400e-6, 12e3
    tried = lowest * np.exp(np.linspace(math.log(0.15), 0.0, 25))
    assert _best_cutoff(width, lowest, 0.0, 1e-6) == pytest.approx(lowest)
    for share, found in ((0.4499, tried[-1]), (0.4501, tried[-2])):
        assert _best_cutoff(width, lowest, 0.0, share / lowest) == pytest.approx(found)
    assert math.isnan(_best_cutoff(20e-6, lowest, 0.3, 1e-6))
    for swing in (0.03, 0.3, 3.0):
        costs = []
        for cutoff in tried:
            left = _family_as_wide(_width_through(cutoff * width))[0]
            gain = 1.0 / (
                1.0
                + (math.sqrt(2.0) - 1.0) * (math.tan(math.pi * lowest * 1e-6) / math.tan(math.pi * cutoff * 1e-6)) ** 8
            )
            costs.append(math.hypot(np.std(1.0 / left) / np.mean(1.0 / left), swing * gain))
        assert _best_cutoff(width, lowest, swing, 1e-6) == pytest.approx(tried[int(np.argmin(costs))])


@pytest.mark.parametrize("noise", [0.0, 15.0])
def test_a_split_states_what_its_filter_does(noise):
    """Each share of the uncertainty on its own: that of the family, of the gain at the mode, of what an elastic body
    moves, s / (2 f T)^2, of white noise in the band, and of other shapes; the foot by what stands there over its slope."""
    length, frequency = 400e-6, 15e3
    pulse = SmoothPulse(PEAK, 2000e-6, length, 0.5, 1.0)
    values = half_sine(length) + swing(frequency, 0.3)
    record = Stretch(values, STEP, 2000, 2400, 374.5, pulse, noise)
    split = split_bands(record, 14.8e3)
    assert split.lowest_mode == pytest.approx(frequency, rel=0.01)
    swings = _swing_in_blow(record, split.lowest_mode)
    for peak, scale in ((400.0, np.max(values[2000:2401]) - swings), (1700.0, 1700.0)):
        other = split_bands(record._replace(smooth=pulse._replace(peak=peak)), 14.8e3)
        assert other.cutoff == _best_cutoff(374.5 * STEP, split.lowest_mode, swings / scale, STEP)
    assert swings == pytest.approx(300.0 * math.exp(-200.0 / 600.0), rel=0.05)
    filter_ = Filter(split.cutoff)
    low = filter_.apply(values, STEP)
    found = measure_pulse(_only(low, 2000 + int(np.argmax(low[2000:2401]))), STEP)
    left, widths, wider = _family_as_wide(split.cutoff * found.width)
    peaks = found.peak / left
    assert split.peak == pytest.approx(np.mean(peaks))
    assert split.width == pytest.approx(np.mean(widths) / split.cutoff)
    assert (split.loss, split.widening) == (pytest.approx(1.0 - np.mean(left)), pytest.approx(np.mean(wider)))
    assert split.loss_uncertainty == pytest.approx(np.std(peaks) / np.mean(peaks))
    assert split.leak == pytest.approx(swings * float(filter_.gain(split.lowest_mode, STEP)) / split.peak)
    half_sine_as_wide = split.width / (1.0 - 2.0 * math.asin(0.1) / math.pi)
    assert split.elastic == pytest.approx(1.65 / (2.0 * split.lowest_mode * half_sine_as_wide) ** 2, rel=1e-6)
    heard = noise * math.sqrt(2.0 * split.cutoff * STEP) / split.peak
    shares = np.array([split.loss_uncertainty, split.leak, split.elastic, heard, 0.01])
    assert split.peak_uncertainty == pytest.approx(split.peak * np.linalg.norm(shares))
    foot = np.linalg.norm([split.leak, heard, 0.2 * swings / split.peak * split.cutoff / split.lowest_mode])
    slope = np.mean([one.width_slope() / one.width() for one in FAMILY])
    own = np.array([np.std(widths) / np.mean(widths), foot * slope, split.elastic, 0.02])
    assert split.width_uncertainty == pytest.approx(split.width * np.linalg.norm(own))
    wave = (values - low)[2000:]
    lost = 0.5 * (split.loss * split.peak) ** 2 * split.width / STEP
    assert split.wave_energy == pytest.approx((np.sum(wave**2) - lost) / np.sum(values[2000:] ** 2))
    assert split.signed(-1.0) == dataclasses.replace(split, peak=-split.peak)
    small = split_bands(
        Stretch(1e-9 * values, STEP, 2000, 2400, 374.5, pulse._replace(peak=1e-9 * PEAK), 1e-9 * noise), 14.8e3
    )
    assert small.peak == pytest.approx(1e-9 * split.peak, rel=1e-6, abs=0.0)
    assert small.peak_uncertainty == pytest.approx(1e-9 * split.peak_uncertainty, rel=1e-6, abs=0.0)
    assert (small.cutoff, small.wave_energy) == pytest.approx((split.cutoff, split.wave_energy))
    assert split_bands(Stretch(-values, STEP, 2000, 2400, 374.5, pulse, noise), 14.8e3) is None


@pytest.mark.parametrize(("doubt", "separable"), [(9.9, True), (10.1, False)])
def test_bands_are_separable_where_a_tenth_of_the_peak_is_known(doubt, separable):
    split = BandSplit(1e3, 2e3, -100.0, 1e-3, doubt, 1e-5, 0.1, 0.03, 0.06, 0.02, 0.1, 0.2)
    assert split.separable is separable
    assert ("leaves too much of the wave part (6 %" in split.reason) is not separable
    assert ("differently (7 %" in dataclasses.replace(split, loss_uncertainty=0.07).reason) is not separable
    assert ("band of the pulse (8 %" in dataclasses.replace(split, elastic=0.08).reason) is not separable


def test_the_width_through_a_filter_is_that_of_a_half_sine():
    """Sampled by hand: of 2 over the cutoff, and the narrowest that a filter lets out."""
    cutoff = 5e3
    for length in (0.4, 2.0):
        found = measure_pulse(Filter(cutoff).apply(half_sine(length / cutoff), STEP), STEP)
        width = length * (1.0 - 2.0 * math.asin(0.1) / math.pi)
        assert _width_through(width) == pytest.approx(cutoff * found.width, rel=4e-3)
    narrowest = max(one[0][0] for one in _tables())
    assert _family_as_wide(1.031 * narrowest) is not None
    assert _family_as_wide(1.029 * narrowest) is None
