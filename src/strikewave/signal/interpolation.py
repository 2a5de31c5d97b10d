"""Interpolation of an evenly sampled history: band-limited at any places, or a monotone cubic through samples.

No part of the monotone cubic lies beyond its two samples (PCHIP). scipy has it too, to the last bit; to import that
takes as long as the run of a layered bar.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

# Samples on each side that are looked at, and the shape of the Kaiser window over them: with 8, flat up to 0.46 of the
# sampling rate, smooth pulses err by 3e-5, too much to find a peak within 0.01 samples; with 14, no less than with 12.
REACH, KAISER = 32, 12.0
FLAT, ERROR = 0.42, 1e-6  # share of the sampling rate, and the error up to it (measured); at 0.45 it is 1e-3
# Samples within which a place is that of a sample, whose value is then taken as it is: rounding of times
SAME_PLACE = 1e-9
HELD = 1 << 21  # weights that are held together: 16 MB


def resampled(values: ArrayLike, places: ArrayLike, factor: float = 1.0) -> Array:
    """Interpolate a history band-limited, at places counted in its samples.

    A sum of samples weighted by sinc(d) under a Kaiser window, d the distance in samples; at a sample it is the sample.
    Outside the samples the history is held, so that one that is cut while it is not zero is not made to ring; places
    outside have no value, NaN.

    Parameters
    ----------
    values : array_like
        Evenly sampled history.
    places : array_like
        Places, in samples from the first one.
    factor : float, optional
        New step over old one; above 1, what the new samples cannot hold is taken off, by a sinc wider by as much.

    Raises
    ------
    ValueError
        If there is no sample, or one is not finite.
    """
    history, where = np.asarray(values, dtype=float), np.asarray(places, dtype=float)
    if history.ndim != 1 or history.size == 0 or not np.all(np.isfinite(history)):
        raise ValueError("interpolation needs a history of finite samples")
    wide = max(1.0, factor)
    reach = math.ceil(REACH * wide)
    padded = np.pad(history, reach + 1, mode="edge")
    found = np.full(where.shape, np.nan)
    inside = np.flatnonzero((where >= -SAME_PLACE) & (where <= history.size - 1 + SAME_PLACE))
    offsets = np.arange(1 - reach, reach + 1)
    chunk = max(HELD // offsets.size, 1)
    for begin in range(0, inside.size, chunk):
        rows = inside[begin : begin + chunk]
        at = np.clip(where[rows], 0.0, history.size - 1.0)
        near = np.rint(at).astype(np.int64)
        is_sample = (np.abs(at - near) <= SAME_PLACE) & (wide == 1.0)
        found[rows[is_sample]] = history[near[is_sample]]
        rows, at = rows[~is_sample], at[~is_sample]
        floor = np.floor(at).astype(np.int64)
        phases, which = np.unique(np.round(at - floor, 10), return_inverse=True)
        weights = _weights(phases, offsets, wide, reach)
        samples = padded[floor[:, None] + (offsets + reach + 1)]
        found[rows] = np.einsum("ij,ij->i", samples, weights[which])
    return found


def _weights(phases: Array, offsets: NDArray[np.int64], wide: float, reach: int) -> Array:
    """Return the weights of the samples around places, a row a place; they add up to 1."""
    from scipy.special import i0

    distance = phases[:, None] - offsets
    window = i0(KAISER * np.sqrt(np.maximum(1.0 - (distance / reach) ** 2, 0.0)))
    weights = np.sinc(distance / wide) * window
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))


def share_above(values: ArrayLike, step: float, frequency: float) -> float:
    """Return how much of a history's root mean square lies above a frequency, 0 to 1.

    Parameters
    ----------
    values : array_like
        Evenly sampled history that begins and ends at rest.
    step : float
        Time between samples, s.
    frequency : float
        Hz.
    """
    history = np.asarray(values, dtype=float)
    power = np.abs(np.fft.rfft(history)) ** 2
    if history.size % 2 == 0 and power.size > 1:
        power[-1] *= 0.5
    power[0] *= 0.5
    total = float(power.sum())
    above = float(power[np.fft.rfftfreq(history.size, step) > frequency].sum())
    return math.sqrt(above / total) if total > 0.0 else 0.0


@dataclass(frozen=True, eq=False)
class PiecewisePolynomial:
    """Polynomials between knots: rows of coefficients of t - t_left, the constants first."""

    knots: Array
    coefficients: Array

    def __call__(self, times: Array) -> Array:
        """Return the values at some times; the first and the last polynomial go on beyond the knots."""
        at = np.clip(np.searchsorted(self.knots, times, side="right") - 1, 0, len(self.knots) - 2)
        since, values, power = times - self.knots[at], np.zeros(np.shape(times)), np.ones(np.shape(times))
        for row in self.coefficients:
            values, power = values + row[at] * power, power * since
        return values

    def derivative(self) -> PiecewisePolynomial:
        """Return the derivative."""
        powers = np.arange(1.0, len(self.coefficients))
        return PiecewisePolynomial(self.knots, self.coefficients[1:] * powers[:, None])


def monotone_cubic(times: Array, values: Array) -> PiecewisePolynomial:
    """Return the cubic through samples at increasing times, two at least.

    Its slope at a sample is the weighted harmonic mean of those beside it, or 0 at an extreme. Source: Fritsch &
    Butland 1984; the ends as in Moler's pchiptx.

    Raises
    ------
    ValueError
        If the times do not increase, or there are fewer than two.
    """
    if len(times) < 2 or not np.all(np.diff(times) > 0.0):
        raise ValueError(f"a curve needs two samples or more, at increasing times, got {len(times)}")
    steps = np.diff(times)
    secants = np.diff(values) / steps
    slopes = _slopes(steps, secants)
    bend = (slopes[:-1] + slopes[1:] - 2.0 * secants) / steps
    rows = (values[:-1], slopes[:-1], (secants - slopes[:-1]) / steps - bend, bend / steps)
    return PiecewisePolynomial(times, np.stack(rows))


def _slopes(steps: Array, secants: Array) -> Array:
    """Return the slope at each sample."""
    if len(steps) == 1:
        return np.repeat(secants, 2)
    before, after = 2.0 * steps[1:] + steps[:-1], steps[1:] + 2.0 * steps[:-1]
    rises = np.sign(secants)
    monotone = (rises[1:] == rises[:-1]) & (rises[1:] != 0.0)
    slopes = np.zeros(len(steps) + 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = (before / secants[:-1] + after / secants[1:]) / (before + after)
    slopes[1:-1][monotone] = 1.0 / mean[monotone]
    slopes[0] = _end_slope(steps[0], steps[1], secants[0], secants[1])
    slopes[-1] = _end_slope(steps[-1], steps[-2], secants[-1], secants[-2])
    return slopes


def _end_slope(step: float, next_step: float, secant: float, next_secant: float) -> float:
    """Return the slope at an end: that of the parabola through three samples, where it keeps the shape."""
    slope = ((2.0 * step + next_step) * secant - step * next_secant) / (step + next_step)
    if np.sign(slope) != np.sign(secant):
        return 0.0
    if np.sign(secant) != np.sign(next_secant) and abs(slope) > 3.0 * abs(secant):
        return 3.0 * secant
    return float(slope)
