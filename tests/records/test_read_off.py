"""Figures read off rows, smoothing and spread: against scipy's Savitzky-Golay filter, numpy, and exact examples."""

import math

import numpy as np
import pytest
from scipy.signal import savgol_coeffs, savgol_filter

from strikewave.records import read_off
from strikewave.records.read_off import figures_of, least_error, noise_like, without_noise
from strikewave.records.smoothing import SmoothingWindow, parabola, windows_up_to


@pytest.mark.parametrize("half", [2, 3, 7])
def test_a_window_is_that_of_savitzky_and_golay(half, rng, monkeypatch):
    rows = rng.normal(size=(3, 40))
    window = SmoothingWindow(half)
    assert parabola(half) == pytest.approx(savgol_coeffs(2 * half + 1, 2), abs=1e-14)
    expected = savgol_filter(rows, 2 * half + 1, 2, mode="nearest")
    assert window.over(rows) == pytest.approx(expected, abs=1e-13)
    assert window.over(rows[0]) == pytest.approx(expected[0], abs=1e-13)
    monkeypatch.setattr("strikewave.records.smoothing.DIRECT", 1)
    assert window.over(rows) == pytest.approx(expected, abs=1e-13)
    assert window.gain == pytest.approx(math.sqrt(np.sum(savgol_coeffs(2 * half + 1, 2) ** 2)))


def test_windows_grow_by_half_an_octave():
    assert [window.half for window in windows_up_to(21)] == [0, 2, 3, 5, 7, 10, 14, 20]
    assert [window.half for window in windows_up_to(5)] == [0, 2, 3, 5]
    assert SmoothingWindow(0).gain == 1.0
    values = np.arange(3.0)
    assert SmoothingWindow(0).over(values) is values


def test_figures_of_a_lopsided_tent():
    """Up in 20 samples, down in 10: the rise from 10 to 90 % is 16, between both 10 % 27; the tip lies 1/12 later."""
    row = np.interp(np.arange(40.0), [5.0, 25.0, 35.0], [0.0, 2.0, 0.0])
    place, peak, rise, width = figures_of(row[None], slice(10, 30))[0]
    # a parabola through 1.9, 2, 1.8: vertex half a step times the first difference over the second
    shift = 0.5 * (1.9 - 1.8) / (1.9 - 4.0 + 1.8)
    top = 2.0 - 0.25 * (1.9 - 1.8) * shift
    assert (place, peak) == pytest.approx((25.0 + shift, top))
    assert rise == pytest.approx(0.8 * top / 0.1)
    assert width == pytest.approx((35.0 - 0.1 * top / 0.2) - (5.0 + 0.1 * top / 0.1))
    assert figures_of(row[None], slice(26, 30))[0, 0] == 26.0 + 0.5 * (2.0 - 1.6) / (2.0 - 3.6 + 1.6 or math.inf)
    both = figures_of(np.array([row, row[::-1]]), slice(5, 35))
    assert both[1, 0] == pytest.approx(39.0 - place)
    assert both[1, 3] == pytest.approx(width)
    assert both[1, 2] == pytest.approx(0.8 * top / 0.2)


def test_a_row_that_ends_above_has_no_width():
    rows = np.array([[5.0, 9.0, 6.0, 0.0], [0.0, 6.0, 9.0, 5.0], [0.0, 1.0, 4.0, 9.0]])
    found = figures_of(rows, slice(0, 4))
    assert np.isnan(found[:, 3]).all()
    assert np.isnan(found[0, 2])
    assert found[2, :2].tolist() == [3.0, 9.0]  # at the last sample no parabola
    assert found[2, 2] == pytest.approx((2.0 + 4.1 / 5.0) - 0.9)


def test_the_spread_of_columns_that_are_known_in_most_rows(rng):
    rows = rng.normal(size=(9, 4))
    rows[:5, 1] = math.nan
    rows[:3, 2] = math.nan
    middle, scatter = read_off._spread(rows)
    assert middle[[0, 3]] == pytest.approx(np.median(rows[:, [0, 3]], axis=0))
    assert scatter[[0, 3]] == pytest.approx(np.std(rows[:, [0, 3]], axis=0))
    assert scatter[2] == pytest.approx(np.nanstd(rows[:, 2]))
    assert middle[2] == pytest.approx(np.median(np.where(np.isnan(rows[:, 2]), np.nanmean(rows[:, 2]), rows[:, 2])))
    assert middle[1] == 0.0
    assert math.isnan(scatter[1])
    assert read_off._spread(rows[:8])[0][0] == pytest.approx(np.median(rows[:8, 0]))
    even = np.array([[1.0], [math.nan]])
    assert math.isnan(read_off._spread(even)[1][0])


def test_rows_of_noise_have_its_spectrum(rng):
    """Of a sum of two cosines of whole periods in a row every row holds these two alone."""
    t = np.arange(3 * 64)
    noise = 7.0 + np.cos(2.0 * np.pi * 5 * t / 64) + 0.5 * np.cos(2.0 * np.pi * 11 * t / 64)
    rows = noise_like(noise, 64, 400)
    lines = np.abs(np.fft.rfft(rows, axis=1)) ** 2
    assert rows.shape == (400, 64)
    others = np.delete(np.arange(33), [5, 11])
    assert np.max(lines[:, others]) < 1e-20
    # complex normal amplitudes of variance 1: powers in the mean as they are, to 1 / sqrt(134 that are independent)
    assert np.mean(lines[:, 5]) == pytest.approx(32.0**2, rel=0.25)
    assert np.mean(lines[:, 11]) == pytest.approx(16.0**2, rel=0.25)
    assert np.array_equal(rows, noise_like(noise, 64, 400))
    short = noise_like(noise[:60], 64, 50)
    assert short.shape == (50, 64)
    assert np.std(short) == pytest.approx(np.std(noise[:60]), rel=0.05)  # 3200 numbers: to 1.3 %


def test_random_phases_have_variance_one():
    drawn = read_off._random_phases(40, 50)
    assert drawn.shape == (40, 50)
    assert np.mean(np.abs(drawn) ** 2) == pytest.approx(1.0, abs=0.07)  # three times 1 / sqrt(2000)
    assert np.mean(drawn.real * drawn.imag) == pytest.approx(0.0, abs=0.04)


@pytest.mark.parametrize("noise_size", [0.0, 0.3])
def test_the_least_error_is_that_of_mallows(noise_size, rng):
    """Squares of what smoothing takes and twice the covariance of noise and smoothed noise, written out."""
    raw, pulse = rng.normal(size=60), np.sin(np.arange(60) / 9.0)
    noise = noise_size * rng.normal(size=80)
    windows = windows_up_to(7)
    errors = [
        np.mean((rest - savgol_filter(rest, 2 * w.half + 1, 2, mode="nearest")) ** 2)
        + 2.0 * np.mean(noise * savgol_filter(noise, 2 * w.half + 1, 2, mode="nearest"))
        if w.half
        else 2.0 * np.mean(noise**2)
        for w in windows
        for rest in (raw - pulse, raw)
    ]
    best, beside = least_error(raw, pulse, windows, noise)
    k = int(np.argmin(errors))
    assert (best, beside) == (k // 2, k % 2 == 0)


def test_noise_is_taken_off_beside_the_pulse_or_of_the_record(rng):
    noise = rng.normal(size=(2, 90))
    pulse = 50.0 * np.sin(np.pi * np.arange(90) / 90) ** 40
    cleaned = without_noise(pulse + noise[0], pulse, noise[1], 60)
    assert np.std(cleaned - pulse) < 0.5  # a window of 41 samples leaves 0.23
    parabola_ = 0.02 * (np.arange(90) - 45.0) ** 2
    wrong = 80.0 * (-1.0) ** np.arange(90)
    assert np.std((without_noise(parabola_ + noise[0], wrong, noise[1], 60) - parabola_)[20:-20]) < 0.45


def test_what_lies_between_samples():
    """Worked by hand: at the level 1 second differences of 1 on slopes of 2 and 1.5, third ones of 14 at the tip."""
    values = np.array([0.0, 0.0, 1.0, 3.0, 6.0, 10.0, 4.0, 2.0, 0.5, 0.0])
    for one, place in ((values, 5.3), (values[::-1], 4.3)):
        tip, run = read_off._by_sampling(one, place, 10.0)
        assert tip == pytest.approx(14.0 / (16.0 * math.sqrt(3.0)))
        assert run == pytest.approx(math.hypot(1.0 / 2.0, 1.0 / 1.5) / (8.0 * math.sqrt(3.0)))
    assert read_off._by_sampling(values, 5.0, -1.0).tolist() == [0.0, 0.0]
    open_ = np.array([5.0, 6.0, 5.0, 2.0, 0.0])
    assert read_off._by_sampling(open_, 1.0, 6.0)[1] == pytest.approx(1.0 / 2.0 / (8.0 * math.sqrt(3.0)))
