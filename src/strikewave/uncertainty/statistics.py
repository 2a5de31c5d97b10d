"""Scatter of a sample, and bounds that assume no distribution: from its order alone."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from strikewave.base import declare
from strikewave.base.declare import MAIN
from strikewave.base.shock_quantities import VARIATION

COVERED, CONFIDENCE = 0.95, 0.95
"""Share of all runs that an upper limit covers, and how surely: the usual ones, which take 59 runs at least."""


@declare.dataclass
class RunSpread:
    """Median of a figure over the runs with its bounds at 95 %, and a limit that 95 % of all runs keep (95 %).

    The limit is infinite where too many of the others are known not to keep any.
    """

    median: float = declare.number(
        VARIATION._replace(label="median of the runs"),
        "median over the runs of the coefficient of variation of the blows of a run",
        column=MAIN,
        bounds="low high",
    )
    low: float = declare.number(VARIATION, "low bound of the median at 95 %")
    high: float = declare.number(VARIATION, "high bound of the median at 95 %")
    limit: float = declare.number(
        VARIATION, "what 95 % of all runs keep, with 95 % confidence; null where so few runs can tell nothing"
    )
    n: int = declare.count("runs that have it")


def variation(values: ArrayLike) -> float:
    """Return the coefficient of variation: standard deviation (n - 1) over size of the mean; NaN below two values.

    NaN among the values, such as the peak of a blow that missed, is left out.

    Examples
    --------
    >>> variation([1.0, 3.0, float("nan")]) == 2.0**-0.5, variation([1.0])
    (True, nan)
    """
    sample = np.asarray(values, dtype=float)
    sample = sample[np.isfinite(sample)]
    return float(np.std(sample, ddof=1) / abs(np.mean(sample))) if sample.size > 1 else math.nan


def upper_limit(values: ArrayLike, covered: float = COVERED, confidence: float = CONFIDENCE) -> float:
    """Return a limit that a share of all runs keeps, with a confidence, whatever their distribution.

    The r-th smallest of n values lies above the quantile p with the probability P(Bin(n, p) <= r - 1); r is the
    smallest that is sure enough. NaN where even the largest is not: at 95 % and 95 % below 59 values.

    Source: ``wilks-1941``.

    Examples
    --------
    >>> upper_limit(range(1, 60)), upper_limit(range(1, 59))
    (59.0, nan)
    """
    from scipy.special import bdtr

    sample = np.sort(np.asarray(values, dtype=float))
    n = sample.size
    if n == 0 or 1.0 - covered**n < confidence:
        return math.nan
    sure = bdtr(np.arange(n, dtype=float), n, covered) >= confidence
    return float(sample[int(np.argmax(sure))])


def median_bounds(values: ArrayLike, confidence: float = CONFIDENCE) -> tuple[float, float]:
    """Return bounds of the median, whatever the distribution: the r-th smallest and the r-th largest value.

    r is the largest with 1 - 2 P(Bin(n, 1/2) <= r - 1) at least the confidence; NaN below 6 values (at 95 %).

    Source: ``wilks-1941``.

    Examples
    --------
    >>> median_bounds(range(1, 11))
    (2.0, 9.0)
    """
    from scipy.special import bdtr

    sample = np.sort(np.asarray(values, dtype=float))
    n = sample.size
    sure = 1.0 - 2.0 * bdtr(np.arange(n // 2, dtype=float), n, 0.5) >= confidence
    if not sure.any():
        return math.nan, math.nan
    place = int(np.flatnonzero(sure)[-1])
    return float(sample[place]), float(sample[n - 1 - place])


def spread(values: ArrayLike, broken: ArrayLike = False) -> RunSpread:
    """Return median and limits of what several runs gave.

    Parameters
    ----------
    values : array_like
        One a run; NaN, where a run has none, is left out.
    broken : array_like of bool, optional
        True for runs that keep no limit, whatever their value: they failed, or missed a blow.

    Examples
    --------
    >>> spread([1.0, 2.0, 3.0]).median
    2.0
    >>> spread(range(100), [False] * 99 + [True]).limit, spread(range(100), [False] * 90 + [True] * 10).limit
    (98.0, inf)
    """
    sample = np.asarray(values, dtype=float)
    limited = np.where(broken, math.inf, sample)
    sample, limited = sample[np.isfinite(sample)], limited[~np.isnan(limited)]
    middle = float(np.median(sample)) if sample.size else math.nan
    return RunSpread(middle, *median_bounds(sample), upper_limit(limited), sample.size)
