"""Figures read off rows, smoothing and spread: against scipy's Savitzky-Golay filter, numpy, and exact examples."""

import math

import numpy as np
import pytest
from scipy.signal import savgol_coeffs, savgol_filter

from strikewave.records import pulse_shape
from strikewave.records.pulse_shape import (
    SmoothingWindow,
    SmoothPulse,
    Surroundings,
    figures_of,
    least_error,
    noise_like,
    parabola,
    read_pulse,
    windows_up_to,
    without_noise,
)


@pytest.fixture(autouse=True)
def nothing_kept():
    """Let each test compute what is kept for the next blow."""
    parabola.cache_clear()
    pulse_shape._kept_phases.cache_clear()


@pytest.mark.parametrize("half", [2, 3, 7])
def test_a_window_is_that_of_savitzky_and_golay(half, rng, monkeypatch):
    rows = rng.normal(size=(3, 40))
    window = SmoothingWindow(half)
    assert parabola(half) == pytest.approx(savgol_coeffs(2 * half + 1, 2), abs=1e-14)
    expected = savgol_filter(rows, 2 * half + 1, 2, mode="nearest")
    assert window.over(rows) == pytest.approx(expected, abs=1e-13)
    assert window.over(rows[0]) == pytest.approx(expected[0], abs=1e-13)
    monkeypatch.setattr("strikewave.records.pulse_shape.DIRECT", 1)
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
    middle, scatter = pulse_shape._spread(rows)
    assert middle[[0, 3]] == pytest.approx(np.median(rows[:, [0, 3]], axis=0))
    assert scatter[[0, 3]] == pytest.approx(np.std(rows[:, [0, 3]], axis=0))
    assert scatter[2] == pytest.approx(np.nanstd(rows[:, 2]))
    assert middle[2] == pytest.approx(np.median(np.where(np.isnan(rows[:, 2]), np.nanmean(rows[:, 2]), rows[:, 2])))
    assert middle[1] == 0.0
    assert math.isnan(scatter[1])
    assert pulse_shape._spread(rows[:8])[0][0] == pytest.approx(np.median(rows[:8, 0]))
    even = np.array([[1.0], [math.nan]])
    assert math.isnan(pulse_shape._spread(even)[1][0])


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
    drawn = pulse_shape._random_phases(40, 50)
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
        tip, run = pulse_shape._by_sampling(one, place, 10.0)
        assert tip == pytest.approx(14.0 / (16.0 * math.sqrt(3.0)))
        assert run == pytest.approx(math.hypot(1.0 / 2.0, 1.0 / 1.5) / (8.0 * math.sqrt(3.0)))
    assert pulse_shape._by_sampling(values, 5.0, -1.0).tolist() == [0.0, 0.0]
    open_ = np.array([5.0, 6.0, 5.0, 2.0, 0.0])
    assert pulse_shape._by_sampling(open_, 1.0, 6.0)[1] == pytest.approx(1.0 / 2.0 / (8.0 * math.sqrt(3.0)))


def bowl(middle=20.3, cubic=0.0, size=41):
    """Return a parabola of 10 with a second difference of -0.2, and a third of six times its cubic."""
    k = np.arange(float(size)) - middle
    return 10.0 - 0.1 * k**2 + cubic * k**3


@pytest.mark.parametrize("scale", [1.0, 1e-3])
def test_what_lies_between_samples_is_a_chord_and_a_parabola(scale):
    """An eighth of the second difference over the slope on each side, a sixteenth of the third at the tip, each anywhere
    up to it: over sqrt 3."""
    tip, width = pulse_shape._by_sampling(scale * bowl(), 20.3, scale * 10.0)
    sides = 0.1 * (10.3**2 - 9.3**2), 0.1 * (9.7**2 - 8.7**2)
    assert tip == pytest.approx(0.0, abs=1e-12 * scale)
    assert width == pytest.approx(0.2 / 8.0 / math.sqrt(3.0) * math.hypot(1.0 / sides[0], 1.0 / sides[1]))
    tip, _ = pulse_shape._by_sampling(scale * bowl(cubic=1e-4), 20.3, scale * 10.0)
    assert tip == pytest.approx(scale * 6e-4 / 16.0 / math.sqrt(3.0))
    assert pulse_shape._by_sampling(-bowl(), 20.3, -10.0).tolist() == [0.0, 0.0]


def test_of_a_stretch_that_ends_above_one_side_is_known():
    _, left = pulse_shape._by_sampling(bowl()[:28], 20.3, 10.0)
    assert left == pytest.approx(0.2 / 8.0 / math.sqrt(3.0) / (0.1 * (10.3**2 - 9.3**2)))
    _, right = pulse_shape._by_sampling(bowl()[13:], 7.3, 10.0)
    assert right == pytest.approx(0.2 / 8.0 / math.sqrt(3.0) / (0.1 * (9.7**2 - 8.7**2)))
    assert pulse_shape._by_sampling(bowl()[13:28], 7.3, 10.0)[1] == 0.0
    assert pulse_shape._by_sampling(bowl()[10:28], 10.3, 10.0)[1] == pytest.approx(
        left
    )  # between its first two samples
    assert pulse_shape._by_sampling(bowl()[11:28], 9.3, 10.0)[1] == 0.0
    assert pulse_shape._by_sampling(bowl()[13:31], 7.3, 10.0)[1] == pytest.approx(right)  # and between its last two
    assert pulse_shape._by_sampling(bowl()[13:30], 7.3, 10.0)[1] == 0.0


@pytest.mark.parametrize(("place", "seen"), [(16, False), (17, True), (24, True), (25, False)])
def test_third_differences_near_the_tip_count(place, seen):
    values = bowl()
    values[place] += 0.01
    tip, _ = pulse_shape._by_sampling(values, 20.3, 10.0)
    assert bool(tip > 1e-4) is seen
    if place == 17:
        assert tip == pytest.approx(0.01 / 16.0 / math.sqrt(3.0))
    if place == 24:
        assert tip == pytest.approx(0.01 / 16.0 / math.sqrt(3.0))


@pytest.mark.parametrize(
    ("place", "seen"),
    [(8, False), (9, True), (12, True), (13, False), (27, False), (28, True), (31, True), (32, False)],
)
def test_second_differences_beside_a_crossing_count(place, seen):
    """The left one lies between samples 10 and 11, the right one between 29 and 30."""
    values = bowl()
    values[place] -= 1e-4
    _, plain = pulse_shape._by_sampling(bowl(), 20.3, 10.0)
    _, width = pulse_shape._by_sampling(values, 20.3, 10.0)
    assert (width != pytest.approx(plain, rel=1e-9)) is seen


TIME = np.arange(400.0)
PULSE = SmoothPulse(2.0, 150.0, 80.0, 0.45, 1.2)


def about(raw, later=0):
    return Surroundings(
        raw, np.arange(float(raw.size)) - later, slice(110 + later, 280 + later), slice(145 + later, 235 + later), 60
    )


def test_a_clean_record_is_read_as_it_is():
    """Place, peak, rise and width are those of its samples, and what is not known of them that between these."""
    raw = np.zeros(400)
    raw[170:211] = np.maximum(bowl(), 0.0)
    read = read_pulse(about(raw), PULSE, np.zeros(300))
    place, peak, rise, width = figures_of(raw[None], slice(145, 235))[0]
    assert (read.place, read.peak, read.rise, read.width) == pytest.approx((place, peak, rise, width), rel=1e-12)
    assert read.place == pytest.approx(190.3, abs=1e-9)
    assert np.array_equal(read.values, raw)
    assert [read.peak_scatter, read.width_scatter] == pytest.approx(pulse_shape._by_sampling(raw[110:280], 80.3, 10.0))


def by_hand(raw, smooth, noise):
    """Return figures of a noisy pulse and their scatter, as the module says, with the windows of scipy and plain medians."""
    near, box = slice(110, 280), slice(35, 125)

    def over(values, half):
        return savgol_filter(values, 2 * half + 1, 2, mode="nearest") if half else values

    halves = [0, 2, 3, 5, 7, 10, 14, 20]
    pulse = smooth.at(TIME)
    chances = [
        (np.mean((rest[near] - over(rest[near], half)) ** 2) + 2.0 * np.mean(noise * over(noise, half)), k, beside)
        for k, half in enumerate(halves)
        for beside, rest in ((True, raw - pulse), (False, raw))
    ]
    _, best, beside = min(chances)
    pulse = pulse if beside else 0.0 * pulse
    rest = raw - pulse
    halves_taken = halves[best], halves[max(best - 2, 0)]
    clean = pulse + over(rest, halves_taken[0])
    found = figures_of(clean[None, near], box)[0]
    base = over(rest, halves[min(best + 4, 7)])[near]
    start = figures_of((base + pulse[near])[None], box)[0]
    moved = {half: [] for half in halves_taken}
    columns, _ = np.linalg.qr(smooth.tangents(TIME[near])[0])
    for draw in noise_like(noise, 170, 32):
        again, left = pulse[near].copy(), base + draw - np.mean(draw[box])
        if beside:
            along = columns @ (columns.T @ left)
            again, left = again + along, left - along
        for half in moved:
            moved[half].append(figures_of((again + over(left, half))[None], box)[0] - start)
    off, off_finer = (np.median(moved[half], axis=0) for half in halves_taken)
    least, scatter = (np.std(moved[half], axis=0) for half in halves_taken)
    other = figures_of((pulse + over(rest, halves_taken[1]))[None, near], box)[0] - off_finer
    found = found - [0.0, *off[1:]]
    apart = other - found
    tip, side = pulse_shape._by_sampling(clean[near], *figures_of(clean[None, near], box)[0][:2])
    peak_scatter = math.sqrt(tip**2 + scatter[1] ** 2 + apart[1] ** 2)
    return [
        110.0 + found[0],
        *found[1:],
        peak_scatter,
        math.hypot(side, max(scatter[3], math.hypot(least[3], apart[3]))),
    ], beside


@pytest.mark.parametrize(("true", "beside"), [(PULSE, True), (SmoothPulse(2.0, 185.0, 30.0, 0.5, 3.0), False)])
def test_a_noisy_pulse_is_read_as_by_hand_wherever_it_lies(true, beside, rng):
    """Beside its own smooth pulse, and where that is none of it."""
    noise, own = 0.04 * rng.normal(size=(2, 400))
    raw = true.at(TIME) + own
    expected, near_pulse = by_hand(raw, PULSE, noise)
    assert near_pulse is beside
    read = read_pulse(about(raw), PULSE, noise)
    figures = [read.place, read.peak, read.rise, read.width, read.peak_scatter, read.width_scatter]
    assert figures == pytest.approx(expected, rel=1e-6)
    later = read_pulse(about(np.r_[np.zeros(37), raw], 37), PULSE, noise)
    assert later.place == pytest.approx(read.place + 37.0)
    assert np.array(later[2:]) == pytest.approx(np.array(read[2:]), rel=1e-9)
    assert later.values[147:317] == pytest.approx(read.values[110:280])


@pytest.mark.parametrize(("share", "noisy"), [(0.9e-5, False), (1.1e-5, True)])
def test_noise_of_a_hundred_thousandth_of_the_peak_moves_no_figure(share, noisy):
    raw = np.zeros(400)
    raw[170:211] = np.maximum(bowl(), 0.0)
    read = read_pulse(about(raw), PULSE, 10.0 * share * (-1.0) ** np.arange(340))
    clean = read_pulse(about(raw), PULSE, np.zeros(340))
    assert ((read.peak, read.peak_scatter) != (clean.peak, clean.peak_scatter)) is noisy
