"""Broyden's method on the logarithms of settings: what full runs miss a goal by corrects them, and the slopes."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CLOSE = 0.002
"""Miss at which a search ends: a 25th of what a goal of 5 % allows, so that rounding the values does not lose it
again."""
MOST_RUNS = 12
"""Most runs of a search. Of 36 searches from li-ma-2019 (two goals), 32 came `CLOSE` in three to five runs; the others
came no nearer in twelve."""
LONGEST_STEP = 0.6
"""Longest step of the logarithm of a setting from one run to the next, a factor of 1.8: the slopes hold near a run
only, and estimates were off by 1.6 at most (measured, li-ma-2019)."""
WORST_CONDITION = 1e4
"""Condition number of the slopes beyond which the first ones are taken again: the step would be that of rounding."""
SHORTEST_STEP = 1e-5
"""Step of the logarithms below which a search stands still: rounding changes a setting by more."""
LEAST_SQUARE = 1e-12
"""Least square of a step that Broyden's correction is divided by: a step that the bounds cut to nothing tells no
slope."""


class NearestSettings(NamedTuple):
    """Where a search ended.

    Logarithms of the nearest settings and of the last ones, runs, whether it came close, and why a run could not be
    made; empty where each could.
    """

    nearest: Array
    last: Array
    runs: int
    close: bool
    failure: str


def nearest_settings(
    missed: Callable[[Array], tuple[Array | None, str]], start: Array, low: Array, high: Array, slopes: Array
) -> NearestSettings | str:
    """Return the settings whose run comes nearest to a goal, or why no run could be made.

    Each run gives its misses and corrects the slopes. A run that cannot be made halves the step.

    Parameters
    ----------
    missed : callable
        Returns the logarithms of results over the goal at settings, or None and why there are none.
    start, low, high : ndarray
        Logarithms of the first settings, and of their bounds.
    slopes : ndarray
        First guess of the slopes of the misses over the logarithms of settings.

    Examples
    --------
    >>> found = nearest_settings(lambda x: (np.log(x) - np.log([2.0, 3.0]), ""), *np.log([[1.5, 4.0], [1, 1], [9, 9]]),
    ...                          np.eye(2))
    >>> np.exp(found.nearest).round(6).tolist(), found.runs, found.close
    ([2.0, 3.0], 2, True)
    """
    first_slopes, slopes = slopes, slopes.copy()
    x, failure, best = np.clip(start, low, high), "", None
    for runs in range(1, MOST_RUNS + 1):
        off, reason = missed(np.exp(x))
        if off is None:
            failure = reason
            if best is None:
                return failure
            x = 0.5 * (x + best[0])
            continue
        if best is not None:
            moved = x - best[0]
            slopes += np.outer(off - best[1] - slopes @ moved, moved) / max(float(moved @ moved), LEAST_SQUARE)
        if best is None or np.abs(off).max() < np.abs(best[1]).max():
            best = x, off
        if np.abs(best[1]).max() < CLOSE:
            return NearestSettings(best[0], x, runs, True, failure)
        if not np.linalg.cond(slopes) < WORST_CONDITION:
            slopes = first_slopes.copy()
        step = np.clip(-np.linalg.solve(slopes, best[1]), -LONGEST_STEP, LONGEST_STEP)
        following = np.clip(best[0] + step, low, high)
        if np.abs(following - x).max() < SHORTEST_STEP:
            break
        x = following
    assert best is not None
    return NearestSettings(best[0], x, runs, False, failure)
