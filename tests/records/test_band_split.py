"""Rigid part by a low-pass: against closed forms, the project's own bars, and planted shapes."""

import math

import numpy as np
import pytest

from strikewave.records import find_pulses
from strikewave.records.band_split import FAMILY, _family_as_wide
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
