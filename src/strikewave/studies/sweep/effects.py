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
        (epsilon squared), so that it may be below 0 by chance.
    runs : int
        How many have the number.
    """

    places: Array
    means: Array
    lows: Array
    highs: Array
    share: float
    runs: int


def main_effect(setting: ArrayLike, number: ArrayLike, grid: bool) -> MainEffect:
    """Return the main effect of a setting; runs without the number are left out.

    Source: ``kelley-1935`` for the correction.

    Parameters
    ----------
    setting, number : array_like
        One a run.
    grid : bool
        Whether the runs are a full grid, in which nothing is left to chance.

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
    free = y.size - begins.size
    if not grid and free > 0:
        between -= (begins.size - 1) * (total - between) / free
    return MainEffect(
        np.add.reduceat(x, begins) / sizes,
        means,
        np.minimum.reduceat(y, begins),
        np.maximum.reduceat(y, begins),
        between / total if total > 0.0 else float("nan"),
        y.size,
    )


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
