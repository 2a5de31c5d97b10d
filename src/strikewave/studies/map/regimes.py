"""What a train of blows settles to: named from its return map, as an impact oscillator's motion is.

The state in which each blow begins (approach speed, and where the turntable stands) is compared with that of the
blow so many before it. The motion is of period p if all blows looked at return to where they were p blows before.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TOLERANCE = 1e-3
"""Blows are alike within this share of the scale of each of their quantities: above what the fast run errs by (3e-4 of
the approach speed, docs/map.md), far below what tolerances do to a blow."""
CYCLES = 3
"""Times that a period must be seen: twice may be chance."""
LONGEST_PERIOD = 10
"""Longest period that is distinguished from irregular motion: the second half of a train of 60 blows holds it `CYCLES`
times."""

NAMES = ("period-1", "period-2", "period-n", "irregular", "misses", "no return", "failed", "unknown")
"""Regimes by their code."""
PERIOD_1, PERIOD_2, PERIOD_N, IRREGULAR, MISSES, NO_RETURN, FAILED, UNKNOWN = range(8)
"""Codes of the regimes."""


class Regime(NamedTuple):
    """A regime by its code (see `NAMES`), and its period in blows, 0 where it has none."""

    code: int
    period: int

    @property
    def name(self) -> str:
        """In words; a longer period with its number."""
        return f"period-{self.period}" if self.code == PERIOD_N else NAMES[self.code]


def period_of(states: Array, scales: Array, turn: int = 1, tolerance: float = TOLERANCE) -> int:
    """Return the shortest period of a sequence, 0 where it has none that is seen `CYCLES` times.

    Periods up to `LONGEST_PERIOD` are tried, and that of a turn.

    Parameters
    ----------
    states : ndarray
        Sections of the motion, shape (N, quantities).
    scales : ndarray
        Scale of each quantity, of which ``tolerance`` is a share.
    turn : int, optional
        Blows of a turn.
    tolerance : float, optional
        Largest difference of alike states.

    Examples
    --------
    >>> period_of(np.array([[1.0], [2.0]] * 6), np.array([1.0]))
    2
    """
    count = len(states)
    for period in sorted({*range(1, LONGEST_PERIOD + 1), turn}):
        if period * CYCLES > count:
            break
        apart = np.abs(states[period:] - states[:-period]) / scales
        if np.all(apart <= tolerance):
            return period
    return 0


def regime_of(
    states: Array, missed: NDArray[np.bool_], scales: Array, turn: int = 1, tolerance: float = TOLERANCE
) -> Regime:
    """Name what a train has settled to, from the passes after its transient.

    Parameters
    ----------
    states : ndarray
        Approach speed and angle of each pass, shape (N, quantities); not looked at where missed.
    missed : ndarray
        True if the pass touched nothing.
    scales : ndarray
        Scale of each quantity.
    turn : int, optional
        Strikers of a turn where they differ from one another: the blows can repeat after a whole turn at best.
    tolerance : float, optional
        See `period_of`.

    Returns
    -------
    Regime
        "no return" where every pass missed, "misses" where some did, else the period, or irregular.
        Fewer than `CYCLES` passes, or turns without a period, are unknown.

    Examples
    --------
    >>> regime_of(np.ones((9, 1)), np.zeros(9, dtype=bool), np.ones(1)).name
    'period-1'
    """
    if len(states) < CYCLES:
        return Regime(UNKNOWN, 0)
    if missed.all():
        return Regime(NO_RETURN, 0)
    if missed.any():
        return Regime(MISSES, 0)
    period = period_of(states, scales, turn, tolerance)
    if not period and turn * CYCLES > len(states):
        return Regime(UNKNOWN, 0)
    code = {0: IRREGULAR, 1: PERIOD_1, 2: PERIOD_2}.get(period, PERIOD_N)
    return Regime(code, period)
