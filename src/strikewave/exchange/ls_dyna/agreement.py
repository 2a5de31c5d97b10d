"""How far one curve is from another: differences of size, of phase, and over the pulse.

Source: Sprague, M. A. & Geers, T. L. (2003), "Spectral elements and field separation for an acoustic fluid subject to
cavitation", J. Comput. Phys. 184, 149-162: M and P as below, C their root of squares.
"""

from __future__ import annotations

import math

import numpy as np

from strikewave.base import declare
from strikewave.base.declare import MORE, NO_UNIT, Quantity
from strikewave.exchange.ls_dyna.ascii import Array

SAMPLES = 4096
"""Instants of a curve that are compared, at most: an integral over a pulse is then known to 1e-6."""


@declare.dataclass
class Agreement:
    """A curve against a reference over a window of time; r is the reference, c the curve."""

    magnitude: float = declare.number(
        Quantity(NO_UNIT, "%", "M", 2, 0, signed=True),
        "M = sqrt(integral of c^2 / integral of r^2) - 1",
        column=MORE + 1,
        tables="pair",
    )
    phase: float = declare.number(
        Quantity(NO_UNIT, NO_UNIT, "P", digits=3),
        "P = arccos(integral of c r / sqrt(integral of c^2 times integral of r^2)) / pi, from 0 to 1",
        column=MORE + 1,
        tables="pair",
    )
    rms: float = declare.number(
        Quantity(NO_UNIT, "%", "RMS", 2, 0),
        "root of the mean square difference over the largest reference",
        column=MORE + 1,
        tables="pair",
    )

    @declare.computed(
        declare.number(Quantity(NO_UNIT, NO_UNIT, "C", digits=3), "C = sqrt(M^2 + P^2)", column=MORE + 1, tables="pair")
    )
    def combined(self) -> float:
        """Magnitude and phase in one."""
        return math.hypot(self.magnitude, self.phase)


def agreement(reference: tuple[Array, Array], curve: tuple[Array, Array], window: tuple[float, float]) -> Agreement:
    """Compare a curve with a reference, each time (s) and values; straight lines between instants, 0 beyond them.

    Parameters
    ----------
    reference, curve : tuple of array (instants,)
        Times rise.
    window : tuple of float
        First and last instant, s.

    Returns
    -------
    Agreement
        NaN where one of them is 0 throughout.

    Examples
    --------
    >>> t = np.linspace(0.0, 1.0, 2001)
    >>> errors = agreement((t, np.sin(np.pi * t)), (t, 1.1 * np.sin(np.pi * t)), (0.0, 1.0))
    >>> round(errors.magnitude, 6), round(errors.phase, 6), round(errors.rms, 4)
    (0.1, 0.0, 0.0707)
    """
    t = instants(reference[0], curve[0], window)
    r, c = (np.interp(t, time, values, left=0.0, right=0.0) for time, values in (reference, curve))
    rr, cc, rc, off = (float(np.trapezoid(product, t)) for product in (r * r, c * c, r * c, (c - r) ** 2))
    if not (rr > 0.0 and cc > 0.0):
        return Agreement(math.nan, math.nan, math.nan)
    cosine = min(1.0, max(-1.0, rc / math.sqrt(rr * cc)))
    rms = math.sqrt(off / (t[-1] - t[0])) / float(np.abs(r).max())
    return Agreement(math.sqrt(cc / rr) - 1.0, math.acos(cosine) / math.pi, rms)


def instants(first: Array, second: Array, window: tuple[float, float]) -> Array:
    """Return the instants of two curves within a window and its ends, thinned to at most twice `SAMPLES`, rising."""
    inside = [time[(time > window[0]) & (time < window[1])] for time in (first, second)]
    thinned = [time[:: max(1, -(-len(time) // SAMPLES))] for time in inside]
    return np.unique(np.concatenate([*thinned, window]))
