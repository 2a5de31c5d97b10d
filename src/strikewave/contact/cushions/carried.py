"""A mass that rests on a cushion on a moving surface: a sensor in its buffer, a part in its package."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from strikewave.base.errors import IntegrationError
from strikewave.contact._law_kernels import DAMPING, YIELD_LOAD, base_force, damper_force
from strikewave.contact.law import AnyContact, check_end, positive, single

Array = NDArray[np.float64]

TOLERANCE = 1e-8
"""Relative error of a step: far below what is known of any cushion."""
_SCALE_SHARE = 1e-8
"""Absolute error of a step over the way and speed that the surface makes."""
_LONGEST_SHARE = 0.5
"""Longest step over the width of the surface's pulse, the integral of |a| over its largest value: a step that is longer
than the pulse could miss it."""


class Carried(NamedTuple):
    """What a carried mass does at each sample: its acceleration, m/s^2, and the compression of its cushion, m."""

    acceleration: Array
    compression: Array


def carried(contact: AnyContact, mass: float, acceleration: ArrayLike, step: float) -> Carried:
    """Return the motion of a mass that rests on a cushion on a surface that moves; its weight is left out.

    d'' = a - F(d, d')/m with d the compression, a the acceleration of the surface, straight between samples. The
    cushion pushes only: where the surface falls back the mass flies.

    Parameters
    ----------
    contact : Contact or HardeningContact
        A cushion that comes back, with or without a retardation.
    mass : float
        m, kg.
    acceleration : array_like
        a of the surface, m/s^2, from rest; shape (N,).
    step : float
        Time between samples, s.

    Raises
    ------
    ValueError
        If the cushion keeps a set, or loses by hysteresis, for which nothing approaches.
    IntegrationError
        If it bottoms out.

    Notes
    -----
    Source: Newton's law; the embedded Runge-Kutta rule of Dormand & Prince (Hairer, Norsett & Wanner 1993).

    Examples
    --------
    A surface that is accelerated at once and for good throws a mass on a linear cushion to twice its acceleration:

    >>> from strikewave.contact import Contact
    >>> motion = carried(Contact(1e6, 1.0), 1.0, np.full(101, 100.0), step=1e-4)
    >>> print(motion.acceleration.max().round(1))
    200.0
    """
    law, m, h = single(contact), float(positive("the mass", mass)), float(positive("the step", step))
    surface = np.asarray(acceleration, dtype=float)
    if law[YIELD_LOAD] < np.inf or law[DAMPING]:
        raise ValueError("a carried mass takes a cushion that comes back, without hysteresis: give a retardation")
    times = h * np.arange(surface.size)
    if surface.size < 2 or not np.any(surface):
        return Carried(np.zeros(surface.size), np.zeros(surface.size))

    def force(d: float, rate: float) -> float:
        return float(max(base_force(law, d) + damper_force(law, d, rate), 0.0)) if d > 0.0 else 0.0

    def rates(t: float, y: Array) -> tuple[float, float]:
        place = t / h
        k = min(int(place), surface.size - 2)
        base = surface[k] + (place - k) * (surface[k + 1] - surface[k])
        return y[1], base - force(y[0], y[1]) / m

    speed = float(np.sum(np.abs(surface))) * h
    scales = _SCALE_SHARE * np.array([speed * times[-1], speed])
    longest = _LONGEST_SHARE * speed / float(np.abs(surface).max())
    start = (0.0, times[-1]), [0.0, 0.0]
    motion = scipy.integrate.solve_ivp(rates, *start, "RK45", times, rtol=TOLERANCE, atol=scales, max_step=longest)
    if not motion.success:
        raise IntegrationError(f"the mass on its cushion could not be followed: {motion.message}")
    d, rate = motion.y
    check_end(contact, float(d.max()))
    pushed = np.array([force(float(x), float(v)) for x, v in zip(d, rate, strict=True)])
    return Carried(pushed / m, np.maximum(d, 0.0))
