"""Agreement of one history with another, by ISO/TS 18571: corridor, phase, magnitude and slope, each from 0 to 1.

The equations are those of `objective-rating-metrics`_ 1.3 (TU Graz), which was opened; of the standard itself only the
list of contents. The standard is made for crash tests, sampled at 10 kHz: no score depends on the time between samples,
but phase, magnitude and slope depend on how many samples there are: see `SAMPLES`.

.. _objective-rating-metrics: https://pypi.org/project/objective-rating-metrics

Source: ``iso-18571``.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

RATE = 1e4  # sampling rate that the standard asks for, Hz
SAMPLES = 1000  # samples of any interval: 0.1 s at the standard's 10 kHz, so that a slope is averaged over 0.9 % of it

# Half widths of the corridors over the largest magnitude of the reference, and the power between them
INNER, OUTER, CORRIDOR_POWER = 0.05, 0.5, 2
MOST_SHIFT = 0.2  # share of the interval beyond which a shift counts as no phase at all: 1 - INIT_min, INIT_min = 0.8
MOST_MAGNITUDE, MOST_SLOPE = 0.5, 2.0  # relative errors of magnitude and of slope beyond which their scores are 0
WARPING = 0.1  # share of the interval by which time may be warped for the magnitude
AVERAGED = 9  # samples over which slopes are averaged; fewer towards the ends: 7, 5, 3, 1
WEIGHTS = (0.4, 0.2, 0.2, 0.2)  # weights of corridor, phase, magnitude and slope in the overall rating
FEWEST = 2 * AVERAGED  # samples without which slopes are not averaged anywhere
# Words of an overall rating, each with the rating from which on it applies: table of the standard, from memory
GRADES = (("excellent", 0.94), ("good", 0.8), ("fair", 0.58), ("poor", 0.0))


class Rating(NamedTuple):
    """Scores from 0 to 1, and the samples by which the compared history comes too late (early, if below zero)."""

    corridor: float
    phase: float
    magnitude: float
    slope: float
    overall: float
    delay: int

    @property
    def grade(self) -> str:
        """The word of the overall rating.

        Examples
        --------
        >>> Rating(1.0, 1.0, 1.0, 1.0, 1.0, 0).grade
        'excellent'
        """
        return next(word for word, least in GRADES if not self.overall <= least or least == 0.0)


def rate(reference: ArrayLike, compared: ArrayLike) -> Rating:
    """Rate a history against a reference, both sampled at the same times.

    Parameters
    ----------
    reference, compared : array_like
        As many samples each.

    Raises
    ------
    ValueError
        If they are not of one length, are too short, not finite, or the reference is zero throughout.

    Examples
    --------
    >>> time = np.linspace(0.0, 1.0, 400)
    >>> pulse = np.sin(np.pi * time) ** 2
    >>> rate(pulse, pulse).overall
    1.0
    >>> round(rate(pulse, 1.2 * pulse).slope, 6)
    0.9
    """
    a, b = np.asarray(reference, dtype=float), np.asarray(compared, dtype=float)
    if a.ndim != 1 or a.shape != b.shape or a.size < FEWEST:
        raise ValueError(f"a rating needs two histories of as many samples, {FEWEST} or more, got {a.shape}, {b.shape}")
    if not (np.all(np.isfinite(a)) and np.all(np.isfinite(b))):
        raise ValueError("a rating needs finite samples")
    if not np.any(a):
        raise ValueError("the reference is zero throughout: nothing can be held against it")
    delay = best_delay(a, b)
    size = a.size - abs(delay)
    first, second = (a[:size], b[delay:]) if delay >= 0 else (a[-size:], b[:size])
    scores = (
        corridor_score(a, b),
        max(1.0 - abs(delay) / (MOST_SHIFT * a.size), 0.0),
        magnitude_score(first, second),
        slope_score(first, second),
    )
    return Rating(*scores, float(np.dot(WEIGHTS, scores)), delay)


def corridor_score(reference: Array, compared: Array) -> float:
    """Return the mean score of the samples: 1 within the inner corridor, 0 outside the outer one.

    Between them ((b0 N - |T - C|) / ((b0 - a0) N))^2, with N the largest magnitude of the reference.
    """
    largest = float(np.max(np.abs(reference)))
    share = (OUTER - np.abs(reference - compared) / largest) / (OUTER - INNER)
    return float(np.mean(np.clip(share, 0.0, 1.0) ** CORRIDOR_POWER))


def best_delay(reference: Array, compared: Array) -> int:
    """Return the shift with the largest correlation coefficient, the least one of equal ones."""
    from scipy.signal import correlate

    size, most = reference.size, math.floor(reference.size * MOST_SHIFT)
    a, b = reference - reference.mean(), compared - compared.mean()
    lags = np.arange(-most, most + 1)
    product = correlate(b, a, "full")[size - 1 + lags]
    counts = size - np.abs(lags)

    def parts(values: Array, left: NDArray[np.int64]) -> Array:
        """Return sums over the beginnings (lag above zero) or the ends (below) that overlap."""
        sums = np.concatenate([[0.0], np.cumsum(values)])
        return np.where(left >= 0, sums[counts], sums[-1] - sums[size - counts])

    sum_a, sum_b = parts(a, lags), parts(b, -lags)
    squares = (parts(a * a, lags) - sum_a**2 / counts) * (parts(b * b, -lags) - sum_b**2 / counts)
    with np.errstate(divide="ignore", invalid="ignore"):
        scores = (product - sum_a * sum_b / counts) / np.sqrt(np.maximum(squares, 0.0))
    floor = np.finfo(float).eps * float(np.dot(a, a)) * float(np.dot(b, b))
    scores = np.where(squares > floor, scores, -np.inf)
    order = np.argsort(np.abs(lags) - 0.5 * (lags > 0), kind="stable")  # 0, then each shift forward before back
    best = order[int(np.argmax(np.round(scores[order], 13)))]
    return int(lags[best]) if np.isfinite(scores[best]) else 0


def _relative_error(reference: Array, compared: Array) -> float:
    """Return the summed difference over the summed magnitude of the reference."""
    return float(np.abs(reference - compared).sum()) / max(float(np.abs(reference).sum()), float(np.finfo(float).tiny))


def magnitude_score(reference: Array, compared: Array) -> float:
    """Return 1 - e / 0.5, e the summed difference along the warped path over the summed magnitude of the reference."""
    path = warped_path(compared, reference, math.ceil(WARPING * reference.size) - 1)
    a, b = reference[path[:, 1]], compared[path[:, 0]]
    return max(1.0 - _relative_error(a, b) / MOST_MAGNITUDE, 0.0)


def slope_score(reference: Array, compared: Array) -> float:
    """Return 1 - e / 2, e the summed difference of the averaged slopes over their summed magnitude in the reference."""
    a, b = _averaged_slope(reference), _averaged_slope(compared)
    return max(1.0 - _relative_error(a, b) / MOST_SLOPE, 0.0)


def _averaged_slope(values: Array) -> Array:
    """Return central differences, each averaged over as many neighbours on either side, four at most."""
    sums = np.concatenate([[0.0], np.cumsum(np.gradient(values))])
    place = np.arange(values.size)
    near = np.minimum(np.minimum(place, values.size - 1 - place), AVERAGED // 2)
    return np.asarray((sums[place + near + 1] - sums[place - near]) / (2 * near + 1))


def warped_path(first: Array, second: Array, reach: int) -> NDArray[np.int64]:
    """Return the pairs of samples of two histories that dynamic time warping lays on one another.

    Of all ways from the first pair to the last, by steps of one sample in either history or in both and at most
    ``reach`` samples apart, that with the least sum of squared differences; of equal ones that which, seen from its
    end, steps in the first history, then in the second.

    The cost D[i, j] = d[i, j] + min(D[i-1, j], D[i, j-1], D[i-1, j-1]) is found for all pairs of one i + j at once.

    Examples
    --------
    >>> warped_path(np.array([0.0, 1.0, 0.0]), np.array([0.0, 1.0, 1.0]), 1).tolist()
    [[0, 0], [1, 1], [1, 2], [2, 2]]
    """
    size = first.size
    cost = np.full((2 * size - 1, 2 * reach + 3), np.inf)  # row i + j, column i - j + reach + 1
    cost[0, reach + 1] = (first[0] - second[0]) ** 2
    for total in range(1, 2 * size - 1):
        low = max(-reach, -total, total - 2 * (size - 1))
        low += (low + total) % 2
        begin, end = (total + low) // 2, (total + min(reach, total, 2 * (size - 1) - total)) // 2 + 1  # of i
        if begin >= end:  # no pair of this sum is that near
            continue
        column, many = low + reach + 1, 2 * (end - begin) - 1
        distance = (first[begin:end] - second[total - end + 1 : total - begin + 1][::-1]) ** 2
        before = cost[total - 1]
        least = np.minimum(before[column - 1 : column - 1 + many : 2], before[column + 1 : column + 1 + many : 2])
        if total > 1:
            least = np.minimum(least, cost[total - 2, column : column + many : 2])
        cost[total, column : column + many : 2] = distance + least
    i = j = size - 1
    path = [(i, j)]
    while i or j:
        total, column = i + j, i - j + reach + 1
        up, left = cost[total - 1, column - 1], cost[total - 1, column + 1]
        both = cost[total - 2, column] if i and j else math.inf
        if up <= left and up <= both:
            i -= 1
        elif left <= both:
            j -= 1
        else:
            i, j = i - 1, j - 1
        path.append((i, j))
    return np.array(path[::-1])
