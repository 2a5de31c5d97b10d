"""Figures of single blows against their closed forms, and what is no blow."""

import math

import numpy as np
import pytest

from strikewave.records import find_pulses

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
