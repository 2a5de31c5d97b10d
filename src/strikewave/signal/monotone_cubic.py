"""A monotone cubic through samples, of which no part lies beyond its two samples: PCHIP.

scipy has it too, to the last bit; to import that takes as long as the run of a layered bar.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


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

    Examples
    --------
    >>> curve = monotone_cubic(np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 1.0]))
    >>> curve(np.array([0.5, 1.5])).tolist(), curve.derivative()(np.array([1.0])).tolist()
    ([0.6875, 1.0], [0.0])
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
