"""Damping laws: the hysteresis factor chi of F = K d^n (1 + chi d'/v0) for a restitution asked for.

For two free bodies the restitution that comes out depends on chi alone, not on n, K, mass or speed
(see `restitution`). One law, one short function; `factor` looks one up by name.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.contact import _kernels
from strikewave.errors import InputError, nearest


def exact(restitution_asked: ArrayLike) -> NDArray[np.float64]:
    """Return the hysteresis factor that gives exactly the restitution asked for, 0 < e <= 1.

    chi is the root of (1 + chi)/(1 - e chi) = exp(chi (1 + e)), found through L = chi (1 + e):
    e = [1 - exp(-L)(1 + L)] / (L - 1 + exp(-L)). Exact for every exponent n. Source: integral of the
    phase plane of Hunt & Crossley's law; the derivation stands in ``contact/_kernels.py``.

    Raises
    ------
    ValueError
        If a restitution lies outside 0 < e <= 1 (e = 0 would need an infinite factor).

    Examples
    --------
    >>> print(exact(0.5).round(6))
    1.432751
    """
    (e,), shape = _kernels.flat(_asked(restitution_asked))
    out = np.empty_like(e)
    _kernels.factors(e, out)
    return out.reshape(shape)


def li_ma_printed(restitution_asked: ArrayLike) -> NDArray[np.float64]:
    """Return the factor of Li & Ma 2019 as printed, chi = 30 (1 - e) / (19 e), 0 < e <= 1.

    The energy estimate behind it misses the restitution asked for: 0.5 comes out as 0.4740, 0.3 as
    0.2591. Source: Li & Ma 2019, eq (24).

    Examples
    --------
    >>> print(li_ma_printed(0.5).round(6))
    1.578947
    """
    e = _asked(restitution_asked)
    return np.asarray(30.0 * (1.0 - e) / (19.0 * e))


def _asked(restitution_asked: ArrayLike) -> NDArray[np.float64]:
    """Return restitutions as an array, or raise ValueError where one lies outside 0 < e <= 1."""
    e = np.asarray(restitution_asked, dtype=float)
    if not np.all((e > 0.0) & (e <= 1.0)):
        raise ValueError(f"the restitution must satisfy 0 < e <= 1, got {restitution_asked!r}")
    return e


def restitution(hysteresis_factor: ArrayLike) -> NDArray[np.float64]:
    """Return the restitution that a hysteresis factor gives two free bodies, chi >= 0.

    Inverse of `exact`; whatever law the factor came from.

    Raises
    ------
    ValueError
        If a factor is negative or not finite.

    Examples
    --------
    >>> print(restitution(li_ma_printed(0.5)).round(4))
    0.474
    """
    (chi,), shape = _kernels.flat(hysteresis_factor)
    if not np.all((chi >= 0.0) & np.isfinite(chi)):
        raise ValueError(f"the hysteresis factor must be finite and >= 0, got {hysteresis_factor!r}")
    out = np.empty_like(chi)
    _kernels.restitutions(chi, out)
    return out.reshape(shape)


def cut_off_restitution(damping_ratio: float) -> float:
    """Return the restitution of a linear spring and damper that never pulls, zeta = c / (2 sqrt(k m)).

    e = exp(-2 zeta arccos(zeta) / sqrt(1 - zeta^2)), continued by arcosh beyond zeta = 1; the contact
    ends when the force, not the compression, is back at zero. Source: Schwager & Poschel 2007 (their
    eqs for e with the arctangent of a double angle reduced).

    Examples
    --------
    >>> round(cut_off_restitution(0.0), 3), round(cut_off_restitution(1.0), 4)
    (1.0, 0.1353)
    """
    zeta = damping_ratio
    if abs(zeta - 1.0) < 1e-9:
        return math.exp(-2.0)
    if zeta < 1.0:
        return math.exp(-2.0 * zeta * math.acos(zeta) / math.sqrt(1.0 - zeta * zeta))
    return math.exp(-2.0 * zeta * math.acosh(zeta) / math.sqrt(zeta * zeta - 1.0))


def cut_off_damping_ratio(restitution_asked: float) -> float:
    """Return the damping ratio of a stop that gives a restitution, 0.01 <= e <= 1; inverse of `cut_off_restitution`.

    Raises
    ------
    ValueError
        If the restitution lies outside the range.

    Examples
    --------
    >>> round(cut_off_restitution(cut_off_damping_ratio(0.3)), 12)
    0.3
    """
    if not 0.01 <= restitution_asked <= 1.0:
        raise ValueError(f"the restitution of a stop must lie within 0.01 to 1, got {restitution_asked!r}")
    low, high = 0.0, 10.0
    for _ in range(200):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        if cut_off_restitution(middle) > restitution_asked:
            low = middle
        else:
            high = middle
    return low


class DampingLaw(NamedTuple):
    """A damping law with its name, status (``checked`` or ``from memory``) and source."""

    name: str
    function: Callable[[ArrayLike], NDArray[np.float64]]
    status: str
    source: str


DAMPING_LAWS = {
    law.name: law
    for law in (
        DampingLaw("exact", exact, "checked", "hunt-crossley-1975"),
        DampingLaw("li-ma-printed", li_ma_printed, "checked", "li-ma-2019"),
    )
}
"""The damping laws by the name that a case file and ``--damping`` use."""


def factor(name: str, restitution_asked: ArrayLike) -> NDArray[np.float64]:
    """Return the hysteresis factor of a named law.

    Raises
    ------
    InputError
        If no law has that name.

    Examples
    --------
    >>> print(factor("exact", 1.0))
    0.0
    """
    if name not in DAMPING_LAWS:
        raise InputError("damping", name, "a damping law", nearest(name, DAMPING_LAWS))
    return DAMPING_LAWS[name].function(restitution_asked)
