"""Peak, width and velocity change of noisy blows: bias well below the stated uncertainty, which holds the truth.

Shapes, noise and seeds are not those that anything was chosen by.
"""

import dataclasses
import itertools
import math

import numpy as np
import pytest

from strikewave.records import find_pulses

DURATION = 1e-3
SHAPES = {
    "half-sine": lambda u: np.sin(np.pi * u),
    "haversine": lambda u: np.sin(np.pi * u) ** 2,
    "lopsided": lambda u: np.sin(np.pi * np.where(u < 0.4, u / 0.8, 1.0 - (1.0 - u) / 1.2)) ** 1.2,
    "flat": lambda u: np.tanh(6.0 * np.sin(np.pi * u)) / math.tanh(6.0),
}


def true_figures(shape):
    """Peak, width and area from foot to foot of a shape, on ten thousand samples."""
    u = np.linspace(0.0, 1.0, 10_001)
    values = SHAPES[shape](u)
    above, feet = u[values >= 0.1 * values.max()], u[values >= 0.02 * values.max()]
    inside = (u >= feet[0]) & (u <= feet[-1])
    area = float(np.sum(values[inside])) * 1e-4
    return np.array([values.max(), (above[-1] - above[0]) * DURATION, area * DURATION])


def drawn(shape, samples, noise, seed, coloured=False):
    """Draw a record of 42 durations; coloured noise remembers three samples."""
    rng = np.random.default_rng(seed)
    step = DURATION / samples
    time = step * np.arange(42 * samples) - DURATION * (30.0 + rng.uniform() / samples)
    u = time / DURATION
    values = np.where((u > 0.0) & (u < 1.0), SHAPES[shape](np.clip(u, 0.0, 1.0)), 0.0)
    white = rng.normal(size=time.size)
    if coloured:
        white = np.convolve(white, np.exp(-np.arange(12.0) / 3.0), mode="same")
        white /= white.std()
    return values + noise * white, step


def errors(shape, samples, noise, draws, first, coloured=False):
    """Relative errors of the figures, and what is stated of them, a row a draw."""
    true = true_figures(shape)
    rows = []
    for k in range(draws):
        values, step = drawn(shape, samples, noise, first + k, coloured)
        [pulse] = [one for one in find_pulses(values, step) if abs(one.time - 30.5e-3) < DURATION]
        figures = np.array([pulse.peak, pulse.width, pulse.velocity_change])
        rows.append([figures / true - 1.0, np.array(dataclasses.astuple(pulse.uncertainty)) / true])
    return np.array(rows)


@pytest.mark.verify
@pytest.mark.parametrize(
    ("shape", "samples", "noise"), [("half-sine", 200, 0.03), ("half-sine", 50, 0.02), ("lopsided", 200, 0.02)]
)
def test_width_of_a_noisy_blow_is_within_what_is_stated(shape, samples, noise):
    found = errors(shape, samples, noise, 40, 910_000)
    error, stated = found[:, 0], found[:, 1]
    # 40 draws of 95 % are below 34 once in seventy times
    assert np.all(np.count_nonzero(np.abs(error) <= 2.0 * stated, axis=0) >= 34)
    # a sixth of it is what 40 draws tell of a mean
    assert np.all(np.abs(error.mean(axis=0)) < 0.5 * stated.mean(axis=0))
    assert np.median(stated[:, 1]) < 0.6 * noise  # and it is no more than noise demands


def test_figures_of_a_clean_blow_are_as_they_are():
    """Between 200 samples a chord of a half-sine is within (pi / 200)^2 / 8 = 3e-5 of the peak, a width within 1e-4."""
    found = errors("half-sine", 200, 0.0, 2, 911_000)
    assert np.all(np.abs(found[:, 0]) < [5e-5, 2e-4, 1e-3])


SHARP = pytest.mark.xfail(reason="sides of few samples, and the highest value of a plateau")
PEAK, PLATEAU = 0.75, 0.6
"""Least share of draws whose peak is within twice its stated uncertainty: 95 % is meant. A plateau's highest value is its
noise's as much as its own."""


NOISES = (0.005, 0.02, 0.05)
CELLS = [
    *itertools.product(("half-sine", "haversine", "lopsided"), (20, 50, 200), NOISES),
    *itertools.product(SHAPES, (1000,), NOISES[1:2]),  # slow, and no other than 200 samples at any noise
    *itertools.product(["flat"], (200,), NOISES),
    *(("flat", 50, noise) for noise in NOISES[1:]),
    *(pytest.param("flat", *cell, marks=SHARP) for cell in [(50, NOISES[0]), *itertools.product([20], NOISES)]),
]


@pytest.mark.verify
@pytest.mark.parametrize("coloured", [False, True])
@pytest.mark.parametrize(("shape", "samples", "noise"), CELLS)
def test_coverage_over_shapes_rates_and_noise(shape, samples, noise, coloured):
    found = errors(shape, samples, noise, 60 if samples < 500 else 25, 920_000, coloured)
    error, stated = found[:, 0], found[:, 1]
    covered = np.mean(np.abs(error) <= 2.0 * stated, axis=0)
    if shape == "flat":
        # at 5 % of coloured noise 69 % of 400 other draws hold the width: 60 draws stray from that by 6 %
        assert np.all(covered >= [PLATEAU, PLATEAU, 0.8])
        assert np.all(np.abs(error.mean(axis=0)) < [2.0, 1.5, 1.0] * stated.mean(axis=0))
        return
    # of 60 draws of 95 %, 85 % is three standard deviations
    assert np.all(covered >= [PEAK, 0.85, 0.8])
    assert np.all(np.abs(error.mean(axis=0)) < [1.5, 1.0, 1.0] * stated.mean(axis=0))


@pytest.mark.verify
def test_velocity_change_over_a_longer_window_is_as_uncertain_as_noise_makes_it():
    """Over 1.2 durations of white noise: their root, and the error of the baseline from 30 widths before."""
    missed = []
    for seed in range(60):
        values, step = drawn("half-sine", 100, 0.02, 930_000 + seed)
        [pulse] = find_pulses(values, step)
        first = round((pulse.time - 0.6 * DURATION) / step)
        window = values[first : first + 120] - pulse.offset
        missed.append((np.sum(window) * step - 2.0 / math.pi * DURATION, pulse.area_uncertainty(1.2 * DURATION)))
    error, stated = np.array(missed).T
    assert np.count_nonzero(np.abs(error) <= 2.0 * stated) >= 52  # of 95 %: once in a hundred fewer
    assert np.sqrt(np.mean(stated**2)) == pytest.approx(np.std(error), rel=0.3)  # 9 % by 60 draws


@pytest.mark.parametrize("shape", ["half-sine", "haversine"])
@pytest.mark.parametrize("samples", [40, 200])
def test_what_lies_beyond_the_feet_is_in_the_uncertainty_of_the_velocity_change(shape, samples):
    """Where noise is next to none, the area that a foot at 2 % of the peak cuts off is all that is wrong, and is said."""
    whole = {"half-sine": 2.0 / math.pi, "haversine": 0.5}[shape] * DURATION
    for k in range(5):
        values, step = drawn(shape, samples, 1e-5, 920_000 + k)
        [pulse] = find_pulses(values, step)
        assert abs(pulse.velocity_change - whole) < 2.0 * pulse.uncertainty.velocity_change < 0.004 * whole
