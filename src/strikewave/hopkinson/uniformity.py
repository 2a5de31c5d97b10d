"""How soon the stress in an elastic specimen between two equal bars is uniform.

Multiple reflections run in the specimen, each time reflected by r = (1 - beta)/(1 + beta) of its force, and the
forces on the two faces approach each other.

Symbols: beta = Z_specimen/Z_bar, t0 transit time of the specimen (s), k number of the transit, from 1,
alpha = 2 (F1 - F2)/(F1 + F2).

Source: L. M. Yang, V. P. W. Shim, An analysis of stress uniformity in split Hopkinson bar test specimens,
International Journal of Impact Engineering 31 (2005) 129-150 (not opened: the closed form is the sum of echoes,
with which the tests compare it, and with the delay lines of `strikewave.waves`); the 5 % that is usual: Ravichandran &
Subhash 1994.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

UNIFORM = 0.05
"""A specimen whose forces differ by less than this share of their mean counts as in equilibrium: Ravichandran & Subhash
1994, as is usual."""
MOST_TRANSITS = 100_000
"""Transits that are summed: a wave of r = 0.9999 has fallen to 5e-5 by then."""
NEGLIGIBLE = 1e-18
"""Share of the incident force below which an echo adds nothing to a sum in floating point."""
PER_TRANSIT, LONG = 200, 5000.0
"""Instants a transit at which the forces are compared; from so many transits on one each, as nothing changes within
one."""
MORE = 4.0
"""Transits that are looked at at least, and beyond the estimate: the rise of the load shifts all by some."""
SAFETY = 0.01
"""Share of the limit at which the estimate of the transits ends, so that alpha stays below the limit after it."""
TINY = 1e-300
"""Keeps the logarithm of 0 out, for a specimen as stiff as the bar."""


def stress_difference(beta: ArrayLike, transit: ArrayLike) -> Array:
    """Return the magnitude of alpha during the k-th transit after a step: (k - 1) t0 < t < k t0.

        alpha_k = 2 beta (1 - beta)^(k-1) / [(1 + beta)^k - (1 - beta)^(k-1)]

    written with r = (1 - beta)/(1 + beta), so that it neither overflows nor cancels.
    Theory: :eq:`hopkinson-uniformity`.

    Parameters
    ----------
    beta : array_like
        Impedance ratio, above 0.
    transit : array_like
        k, from 1; both broadcast.

    Returns
    -------
    ndarray
        Stress difference of the faces over their mean, in the broadcast shape of both.

    Raises
    ------
    ValueError
        If one is out of range.

    Examples
    --------
    >>> stress_difference(0.5, [1, 2, 3, 4, 5]).round(4).tolist()
    [2.0, 0.2857, 0.08, 0.0253, 0.0083]
    """
    b, k = np.asarray(beta, dtype=float), np.asarray(transit, dtype=float)
    if not (np.all(np.isfinite(b)) and np.all(b > 0.0) and np.all(k >= 1.0)):
        raise ValueError("beta must be above zero and the transit at least 1")
    log = (k - 1.0) * np.log(np.maximum(np.abs((1.0 - b) / (1.0 + b)), TINY))
    sign = np.where((b > 1.0) & (k % 2.0 == 0.0), -1.0, 1.0)
    left = sign * np.exp(log)
    below = np.where(sign > 0.0, b - np.expm1(log), 1.0 + b - left)
    return np.asarray(np.abs(2.0 * b * left / below))


class Faces(NamedTuple):
    """Forces on the two faces of the specimen over the plateau of the incident force, and their alpha."""

    first: Array
    second: Array

    @property
    def alpha(self) -> Array:
        """2 (F1 - F2)/(F1 + F2); NaN where nothing has come yet."""
        total = self.first + self.second
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(total > 0.0, 2.0 * (self.first - self.second) / total, np.nan)


def face_forces(beta: float, time: ArrayLike, rise: float = 0.0) -> Faces:
    """Return the forces on both faces under an incident force that rises in a straight line to 1 and stays.

        P(t) = T sum_m r^(2m) s(t - 2m),  F1 = P(t) + r P(t - 2),  F2 = (1 + r) P(t - 1)

    with T = 2 beta/(1 + beta), r = (1 - beta)/(1 + beta), the incident force s, and times in transits t0. At a
    step, values are those just after it.

    Parameters
    ----------
    beta : float
        Impedance ratio.
    time : array_like
        Times after the wave reaches the first face, over t0, ascending or not.
    rise : float, optional
        Time of the rise, over t0.

    Examples
    --------
    >>> faces = face_forces(0.5, [0.5, 1.5, 2.5])
    >>> (abs(faces.alpha) - stress_difference(0.5, [1, 2, 3])).round(15).tolist()
    [0.0, 0.0, 0.0]
    """
    t = np.asarray(time, dtype=float)
    if not 0.0 < beta < math.inf or not 0.0 <= rise < math.inf or not np.all(np.isfinite(t)):
        raise ValueError("beta must be above zero, the rise zero or above, times finite")
    if t.size and float(t.max()) > MOST_TRANSITS:
        raise ValueError(f"at most {MOST_TRANSITS} transits, got {float(t.max()):g}")
    let, r = 2.0 * beta / (1.0 + beta), (1.0 - beta) / (1.0 + beta)

    def incident(at: Array) -> Array:
        return np.clip(at / rise, 0.0, 1.0) if rise > 0.0 else np.where(at >= 0.0, 1.0, 0.0)

    def running(at: Array) -> Array:
        total = np.zeros_like(at)
        for m in range(int(max(float(at.max(initial=0.0)), 0.0) // 2.0) + 1):
            share = r ** (2 * m)
            if share < NEGLIGIBLE:
                break
            total += share * incident(at - 2.0 * m)
        return let * total

    return Faces(running(t) + r * running(t - 2.0), (1.0 + r) * running(t - 1.0))


def transits_to_uniform(beta: float, rise: float = 0.0, limit: float = UNIFORM) -> float:
    """Return after how many transits |alpha| stays below a limit.

    Found on a grid of 1/200 of a transit; from 5000 transits on of one transit.

    Examples
    --------
    >>> transits_to_uniform(0.5), transits_to_uniform(0.1), transits_to_uniform(0.1, rise=2.0) < 2.25
    (3.0, 8.0, True)
    """
    if not (0.0 < limit < 2.0 and 0.0 < beta < math.inf):
        raise ValueError(f"the limit lies between 0 and 2, and beta above zero, got {limit!r} and {beta!r}")
    r = abs((1.0 - beta) / (1.0 + beta))
    needed = 2.0 if r == 0.0 else 2.0 + math.log(SAFETY * limit * min(beta, 1.0)) / math.log(r)
    last = min(max(needed, MORE) + 2.0 * rise + MORE, MOST_TRANSITS)
    per = PER_TRANSIT if last < LONG else 1
    time = (np.arange(int(last * per)) + 0.5) / per
    above = np.flatnonzero(~(np.abs(face_forces(beta, time, rise).alpha) < limit))
    return float(above[-1] + 1) / per if above.size else 0.0
