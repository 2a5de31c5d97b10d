"""Statistics that a few wrong values do not bend: spread, outliers, trend; and how much of what a fit leaves is new."""

from __future__ import annotations

import functools
import math

import numpy as np
from numpy.typing import ArrayLike

from strikewave.records.contacts import MAD_TO_SIGMA
from strikewave.records.record import Array

# Factors by which the median deviation of 2 to 9 normal values is too small; of more of them, 1 + 0.8 / (n - 0.8).
# Source: ``croux-1992``; a test has them by simulation.
SMALL_SAMPLE = (1.196, 1.495, 1.363, 1.206, 1.200, 1.140, 1.129, 1.107)
MOST_OUTLIERS = 4  # one in so many values at most is an outlier: more of them are another group
EQUAL = 1e-9  # share of the largest value by which values scatter that are no copies of one another: more than rounding
# Values without which the studentized deviate cannot tell an outlier: with four its bound is all but its largest value
FEWEST_FOR_OUTLIERS = 5
# Values up to which the distribution of Kendall's S is counted; beyond, it is normal to a percent of its bounds
EXACT = 60
MOST_OF_LINE = 1000  # values between which slopes are taken, half a million of them; of more, means over neighbours


def spread_of(values: ArrayLike) -> float:
    """Return the standard deviation of normal values, from the median of their deviations from the median.

    Half of the values may be anything.
    """
    sample = np.asarray(values, dtype=float)
    n = sample.size
    if n < 2:
        return math.nan
    factor = SMALL_SAMPLE[n - 2] if n - 2 < len(SMALL_SAMPLE) else n / (n - 0.8)
    return factor * MAD_TO_SIGMA * float(np.median(np.abs(sample - np.median(sample))))


def outliers(values: ArrayLike, false_alarm: float) -> list[int]:
    """Return the places of outliers by the generalized extreme studentized deviate, the farthest first.

    Where the others are equal, as copies are, none is an outlier. Source: ``rosner-1983``.
    """
    sample = np.asarray(values, dtype=float)
    if sample.size < FEWEST_FOR_OUTLIERS:
        return []
    from scipy.special import stdtrit

    left = list(range(sample.size))
    gone: list[int] = []
    count = 0
    while len(gone) < sample.size // MOST_OUTLIERS:
        n = len(left)
        part = sample[left]
        deviations = np.abs(part - np.mean(part))
        spread = float(np.std(part, ddof=1))
        k = int(np.argmax(deviations))
        if not float(np.std(np.delete(part, k))) > EQUAL * float(np.max(np.abs(part))):
            break
        gone.append(left.pop(k))
        t = float(stdtrit(n - 2, 1.0 - false_alarm / (2.0 * n)))
        if deviations[k] / spread > (n - 1) * t / math.sqrt((n - 2 + t * t) * n):
            count = len(gone)
    return gone[:count]


def median_line(x: Array, y: Array, confidence: float) -> tuple[float, float, float]:
    """Return the median of the slopes between all points, and its bounds, NaN where there are too few points.

    The bounds hold for any distribution of the errors: they are those of Kendall's rank correlation.

    No two points have the same ``x``. Source: ``sen-1968``.
    """
    if x.size > MOST_OF_LINE:
        size = -(-x.size // MOST_OF_LINE)
        edges = np.arange(0, x.size, size)
        x, y = (np.add.reduceat(v, edges) / np.diff([*edges, x.size]) for v in (x, y))
    first, second = np.triu_indices(x.size, 1)
    slopes = np.sort((y[second] - y[first]) / (x[second] - x[first]))
    reach = kendall_bound(x.size, confidence)
    if reach is None:
        return float(np.median(slopes)), math.nan, math.nan
    low = (slopes.size - reach) // 2 - 1
    return float(np.median(slopes)), float(slopes[low]), float(slopes[slopes.size - 1 - low])


@functools.lru_cache(maxsize=256)
def kendall_bound(n: int, confidence: float) -> int | None:
    """Return the least c with P(|S| > c) <= 1 - confidence, for Kendall's S of n unrelated pairs.

    None where even the largest S is not rare enough.
    """
    most = n * (n - 1) // 2
    if n > EXACT:
        from scipy.special import ndtri

        deviation = math.sqrt(n * (n - 1) * (2 * n + 5) / 18.0)
        c = math.ceil(float(ndtri(0.5 + 0.5 * confidence)) * deviation)
        return min(c + (c - most) % 2, most)
    counts = np.ones(1)  # shares of the orders of so many values by the number of pairs that are the wrong way round
    for k in range(2, n + 1):
        counts = np.convolve(counts, np.full(k, 1.0 / k))
    tail = np.cumsum(counts)  # P(inversions <= m), S = most - 2 m
    allowed = np.flatnonzero(tail <= 0.5 * (1.0 - confidence))
    return most - 2 * int(allowed[-1]) - 2 if allowed.size else None


def alike_as_one(rest: Array, most: float = 0.9) -> float:
    """Return how many neighbours count as one: (1 + r) / (1 - r), with the correlation r of a value and the next.

    That of a process of first order, whose mean is uncertain by as much more than that of white noise, squared.

    ``most`` bounds r: a few values do not tell a longer memory.
    """
    power = float(np.sum(rest**2))
    alike = float(np.sum(rest[1:] * rest[:-1])) / power if power > 0.0 else 0.0
    alike = min(max(alike, 0.0), most)
    return (1.0 + alike) / (1.0 - alike)
