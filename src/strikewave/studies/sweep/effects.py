"""The main effect of each setting: the mean of a number over all runs in which the setting has a value."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

MOST_LEVELS = 12
"""Most values of a setting that are told apart where the runs are no full grid; of more, and of random ones, as many
groups of equal size are made as `GROUPS` says."""
GROUPS = 8
"""Groups of runs of a setting without levels. Chosen: enough for one bend, and few enough that a hundred runs leave
twelve in each."""


FEWEST_LEFT = 3
"""Runs that a standard error takes: of two, each alone has no variance."""
SIGNIFICANCE = 0.05
"""Share of studies of settings that do nothing in which one is named all the same."""


class MainEffect(NamedTuple):
    """The main effect of a setting on a number.

    Attributes
    ----------
    places : ndarray
        Value of the setting of each group, the mean of its runs, SI.
    means, lows, highs : ndarray
        Mean, smallest and largest number of its runs, SI.
    share : float
        Correlation ratio: variance of the means, weighted by their runs, over that of all runs. In a full grid it is
        the share of the setting alone; of groups of random runs the share expected by chance is taken off
        (epsilon squared), and 0 stands for what then is below it.
    runs : int
        Number of runs that have the number.
    estimate : float
        The share before that: over many studies of settings that do nothing it is 0 on the mean.
    standard_error : float
        Standard error of the estimate, by the jackknife over the runs; 0 in a full grid, which leaves nothing to
        chance. NaN of fewer than three runs.
    """

    places: Array
    means: Array
    lows: Array
    highs: Array
    share: float
    runs: int
    estimate: float = float("nan")
    standard_error: float = float("nan")


def main_effect(setting: ArrayLike, number: ArrayLike, grid: bool) -> MainEffect:
    """Return the main effect of a setting; runs without the number are left out.

    Source: ``kelley-1935`` for the correction.

    Parameters
    ----------
    setting, number : array_like
        One a run.
    grid : bool
        True if the runs are a full grid, in which nothing is left to chance.

    Examples
    --------
    >>> effect = main_effect([1, 1, 2, 2], [0.0, 1.0, 3.0, 4.0], True)
    >>> effect.means.tolist(), effect.share
    ([0.5, 3.5], 0.9)
    """
    x, y = np.asarray(setting, dtype=float), np.asarray(number, dtype=float)
    known = np.isfinite(y)
    x, y = x[known], y[known]
    groups = _groups(x, grid)
    order = np.argsort(groups, kind="stable")
    begins = np.flatnonzero(np.diff(groups[order], prepend=-1))
    x, y, sizes = x[order], y[order], np.diff(begins, append=y.size)
    means = np.add.reduceat(y, begins) / sizes
    total = float(np.sum((y - y.mean()) ** 2)) if y.size else 0.0
    between = float(np.sum(sizes * (means - y.mean()) ** 2)) if y.size else 0.0
    share = float(_share(np.array(between), np.array(total), y.size, np.array(begins.size), grid))
    return MainEffect(
        np.add.reduceat(x, begins) / sizes,
        means,
        np.minimum.reduceat(y, begins),
        np.maximum.reduceat(y, begins),
        share if share != share else max(share, 0.0),
        y.size,
        share,
        0.0 if grid else jackknife_error(y, sizes),
    )


def _share(between: Array, total: Array, runs: int, groups: Array, grid: bool) -> Array:
    """Return the share of the squares between groups in those of all runs, less what is expected by chance."""
    free = runs - groups  # degrees of freedom within groups
    by_chance = (groups - 1) * (total - between) / np.where(free > 0, free, 1)
    taken = between if grid else between - np.where(free > 0, by_chance, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(total > 0.0, taken / total, np.nan)


def jackknife_error(y: Array, sizes: NDArray[np.int64]) -> float:
    """Return the standard error of a share: by the shares without each of the runs.

    Parameters
    ----------
    y : ndarray
        Numbers of the runs, group after group.
    sizes : ndarray
        Sizes of the groups.

    Notes
    -----
    Variance (n - 1)/n sum (s_i - mean s)^2 over the shares s_i without run i. Source: ``efron-stein-1981``.

    Examples
    --------
    >>> jackknife_error(np.array([0.0, 1.0]), np.array([2]))
    nan
    """
    runs = y.size
    if runs < FEWEST_LEFT:
        return float("nan")
    group = np.repeat(np.arange(sizes.size), sizes)
    y = y - y.mean()  # against cancellation in the squares below
    sums = np.bincount(group, y, sizes.size)
    squares = sums**2 / sizes
    left, sums_left = sizes[group] - 1, sums[group] - y
    of_group = np.where(left > 0, sums_left**2 / np.where(left > 0, left, 1), 0.0)
    of_mean = y**2 / (runs - 1)  # the mean of all is 0, so that the others add up to -y
    between = squares.sum() - squares[group] + of_group - of_mean
    total = float(np.sum(y**2)) - y**2 - of_mean
    shares = _share(between, total, runs - 1, sizes.size - (left == 0), False)
    return float(np.sqrt((runs - 1) / runs * np.sum((shares - shares.mean()) ** 2)))


def share_by_chance(runs: int, groups: int, settings: int) -> float:
    """Return the share that the largest of some settings which do nothing stays below in 95 of 100 random studies.

    With F the quantile of the analysis of variance at 0.05/settings (Bonferroni), (F - 1)(k - 1)/(F (k - 1) + n - k)
    for n runs in k groups. Source: ``kelley-1935``.

    Examples
    --------
    >>> round(share_by_chance(16, 8, 39), 2), round(share_by_chance(500, 8, 39), 3)
    (0.83, 0.033)
    """
    from scipy.stats import f

    between, within = groups - 1, runs - groups
    if between < 1 or within < 1:
        return 1.0
    ratio = float(f.isf(SIGNIFICANCE / settings, between, within))
    return (ratio - 1.0) * between / (ratio * between + within)


def _groups(x: Array, grid: bool) -> NDArray[np.int64]:
    """Return the number of the group of each run: by its value, or by its rank where there are many values.

    In a grid always by its value: groups of equal size would part the runs of one value, and so mix settings.
    """
    levels, place = np.unique(x, return_inverse=True)
    if grid or levels.size <= MOST_LEVELS:
        return place
    rank = np.empty(x.size, dtype=np.int64)
    rank[np.argsort(x, kind="stable")] = np.arange(x.size)
    return rank * GROUPS // x.size
