"""Where a pulse begins and ends in a noisy trace, without a threshold set by hand.

Source: N. Maeda, A method for reading and checking phase times in auto-processing system of seismic wave data,
Zisin 38 (1985) 365-379: the place that splits a trace into two stretches of white noise of
different variance with the least information criterion.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FEWEST = 16
"""Samples of a quiet head, or of a pulse, below which neither is judged: a standard deviation is known to 18 %
there."""
FEWEST_TO_SPLIT = 8
"""Samples without which a stretch is not split: two on either side, and a choice between."""
FALSE_ALARM = 0.01
"""Records of pure noise in which a pulse is found; chosen: one in a hundred."""
PERSISTS = 5
"""Samples that must stand above a level one after another, so that a spike of the digitiser is no pulse."""
BLOCKS = 8
"""Parts of a quiet head whose means are compared: enough for a slow foot to show in the last, with means that are
known."""
ROUNDING = 1e-12
"""Share of the mean square below which a variance is rounding, as of a head of zeros."""
TINY = 1e-300
"""Keeps the logarithm of no variance out where all is zero."""
MOST_ALIKE = 0.999
"""Correlation of neighbours at most: at 1 no mean of noise would be known at all."""


def split(values: Array) -> int:
    """Return the first sample of the second of two stretches whose variances differ most.

        AIC(n) = n ln var(x[:n]) + (N - n - 1) ln var(x[n:])

    Parameters
    ----------
    values : array
        Trace that holds one change, shape (N,).

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> x = 0.01 * rng.standard_normal(400)
    >>> x[300:] += 0.05 * np.arange(100)
    >>> abs(split(x) - 300) <= 2
    True
    """
    size = values.size
    if size < FEWEST_TO_SPLIT:
        return 0
    x = values - values[0]
    floor = ROUNDING * float(np.mean(x**2)) + TINY
    count = np.arange(1.0, size)
    sums, squares = np.cumsum(x)[:-1], np.cumsum(x**2)[:-1]
    left = squares / count - (sums / count) ** 2
    rest = size - count
    right = (np.sum(x**2) - squares) / rest - ((np.sum(x) - sums) / rest) ** 2
    criterion = count * np.log(np.maximum(left, floor)) + (rest - 1.0) * np.log(np.maximum(right, floor))
    return int(np.argmin(criterion[2:-2])) + 3


def first_above(values: Array, level: float) -> int | None:
    """Return the first sample from which |values| stays above a level for `PERSISTS` samples; None without one."""
    above = np.abs(values) > level
    if above.size < PERSISTS:
        return None
    run = np.lib.stride_tricks.sliding_window_view(above, PERSISTS).all(axis=1)
    places = np.flatnonzero(run)
    return int(places[0]) if places.size else None


def onset(values: Array) -> int | None:
    """Return where the first pulse of a trace begins: `split` of what lies before it reaches half the largest value.

    None where no five samples in a row reach it.

    Examples
    --------
    >>> trace = np.concatenate([np.zeros(100), np.sin(np.linspace(0, np.pi, 200)), np.zeros(50)])
    >>> onset(trace)
    101
    """
    half = first_above(values, 0.5 * largest(values))
    return None if half is None else split(values[: half + 1])


def ending(values: Array) -> int:
    """Return where the first pulse of a trace ends: the onset of what is left, read backwards.

    The trace holds one pulse and what follows it.
    """
    back = onset(values[::-1])
    return values.size if back is None else values.size - back


def largest(values: Array) -> float:
    """Return the largest magnitude that lasts for `PERSISTS` samples."""
    if values.size < PERSISTS:
        return math.inf
    return float(np.lib.stride_tricks.sliding_window_view(np.abs(values), PERSISTS).min(axis=1).max())


def noise_ceiling(noise: float, samples: int) -> float:
    """Return the largest value that white noise of a standard deviation shows in so many samples.

    sqrt(2 ln(N/p)) times the standard deviation, with p = `FALSE_ALARM`.
    """
    return noise * math.sqrt(2.0 * math.log(max(samples, 2) / FALSE_ALARM))


class Drift(NamedTuple):
    """Largest difference between the means of parts of a stretch, and the standard error of such a difference."""

    difference: float
    error: float


def drift(values: Array) -> Drift:
    """Return by how much the means of `BLOCKS` equal parts of a stretch of noise differ.

        error = s sqrt(2/n (1 + r)/(1 - r))

    with s the standard deviation within the parts, n samples in each, and r the correlation of neighbours, whose
    powers that of samples farther apart is taken for (noise of first order). Infinite where a part has one sample.

    Examples
    --------
    >>> still = np.random.default_rng(1).standard_normal(4000)
    >>> steady, rising = drift(still), drift(still + 1e-3 * np.arange(4000))
    >>> steady.difference < 4.0 * steady.error, rising.difference > 20.0 * rising.error
    (True, True)
    """
    size = values.size // BLOCKS
    if size < 2:
        return Drift(0.0, math.inf)
    parts = values[: size * BLOCKS].reshape(BLOCKS, size)
    means = parts.mean(axis=1)
    apart = parts - means[:, None]
    power = float(np.mean(apart**2))
    if power == 0.0:
        return Drift(float(np.ptp(means)), 0.0)
    alike = min(max(float(np.mean(apart[:, 1:] * apart[:, :-1])) / power, 0.0), MOST_ALIKE)
    return Drift(float(np.ptp(means)), math.sqrt(2.0 * power / size * (1.0 + alike) / (1.0 - alike)))
