"""Velocity and displacement of a measured acceleration, and how far they may have drifted."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


class IntegratedMotion(NamedTuple):
    """Motion of a base whose acceleration was measured.

    Attributes
    ----------
    velocity, displacement : ndarray
        At the samples, zero at the first: m/s and m for a record in m/s^2.
    velocity_drift, displacement_drift : ndarray
        Standard deviations of both, by what the zero and the noise are uncertain by.
    """

    velocity: Array
    displacement: Array
    velocity_drift: Array
    displacement_drift: Array


def integral(values: Array, step: float) -> Array:
    """Return the integral of straight lines between samples, from the first sample on.

    Examples
    --------
    >>> integral(np.array([0.0, 1.0, 1.0]), 2.0)
    array([0., 1., 3.])
    """
    return np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]))]) * step


def motion(values: ArrayLike, step: float, zero_error: float = 0.0, noise: float = 0.0) -> IntegratedMotion:
    """Integrate an acceleration twice, as straight lines between its samples, and tell the drift.

    v' = a, d' = v; exactly: v_1 = v_0 + h (a_0 + a_1)/2, d_1 = d_0 + h v_0 + h^2 (2 a_0 + a_1)/6. A zero that is off
    by u gives u t and u t^2/2; white noise of sigma a sample gives sigma sqrt(h t) and sigma sqrt(h t^3/3).

    Parameters
    ----------
    values : array_like
        Acceleration, its zero taken off, m/s^2.
    step : float
        Time between samples, h, s.
    zero_error : float, optional
        Standard deviation of the zero, u, m/s^2.
    noise : float, optional
        Standard deviation of the noise of a sample, sigma, m/s^2.

    Raises
    ------
    ValueError
        If the record has fewer than two samples, one is not finite, or the step or an error makes no sense.

    Examples
    --------
    10 m/s^2 for 1 s, the zero known to 0.01 m/s^2:

    >>> found = motion(np.full(1001, 10.0), 1e-3, zero_error=0.01)
    >>> [round(float(row[-1]), 6) for row in found]
    [10.0, 5.0, 0.01, 0.005]
    """
    a = np.asarray(values, dtype=float)
    if a.ndim != 1 or a.size < 2 or not np.all(np.isfinite(a)):
        raise ValueError(f"a motion needs one row of two finite samples or more, got shape {a.shape}")
    if not (0.0 < step < math.inf and 0.0 <= zero_error < math.inf and 0.0 <= noise < math.inf):
        raise ValueError(
            f"a motion needs a step above zero and errors of zero or more, all finite, got step={step!r}, "
            f"zero_error={zero_error!r}, noise={noise!r}"
        )
    velocity = integral(a, step)
    ways = step * velocity[:-1] + step**2 / 6.0 * (2.0 * a[:-1] + a[1:])
    displacement = np.concatenate([[0.0], np.cumsum(ways)])
    t = step * np.arange(a.size)
    return IntegratedMotion(
        velocity,
        displacement,
        np.hypot(zero_error * t, noise * np.sqrt(step * t)),
        np.hypot(0.5 * zero_error * t**2, noise * np.sqrt(step * t**3 / 3.0)),
    )


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
