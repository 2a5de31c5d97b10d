"""The zero of a simulated acceleration, as that of a sensor: what it reads before the blow."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike


def zero_before(time: ArrayLike, values: ArrayLike, touch: float = 0.0) -> float:
    """Return the last value not after a first touch: zero of a sensor whose baseline is taken before the blow.

    A table in its fall has the acceleration of gravity, and a fed object that of its carriage; a recorder takes that as
    zero. Zero where nothing is known before the touch.

    Parameters
    ----------
    time, values : array_like
        Rising times, s, and an acceleration.
    touch : float, optional
        Time of the first touch, s.

    Examples
    --------
    >>> zero_before(np.array([-1e-5, 0.0, 1e-5]), np.array([-9.8, -9.8, 40.0]))
    -9.8
    """
    place = int(np.searchsorted(np.asarray(time, dtype=float), touch, side="right")) - 1
    last = float(np.asarray(values, dtype=float)[place]) if place >= 0 else 0.0
    return last if np.isfinite(last) else 0.0
