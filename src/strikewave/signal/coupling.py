"""AC coupling: a high-pass of first order, and its exact inverse."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from strikewave.signal.motion import integral

Array = NDArray[np.float64]


def ac_coupled(values: Array, step: float, constant: float) -> Array:
    """Return what a high-pass of first order makes of a history that begins at rest.

    Parameters
    ----------
    values : ndarray
        Samples; straight lines between them.
    step, constant : float
        Time between samples, and time constant, s.

    Examples
    --------
    >>> ac_coupled(np.array([0.0, 1.0, 1.0, 1.0]), 1e-3, 0.1).round(4)
    array([0.    , 0.995 , 0.9851, 0.9753])
    """
    from scipy.signal import lfilter

    half = 0.5 * step / constant
    gain = 1.0 / (1.0 + half)
    return np.asarray(lfilter([gain, -gain], [1.0, -(1.0 - half) * gain], values - values[0]))


def ac_uncoupled(values: Array, step: float, constant: float) -> Array:
    """Return the history of which a high-pass of first order made the values: the inverse of `ac_coupled`.

    x = y + (1 / tau) int y dt, by trapezoids. What stands off zero before the shock drifts on, so that its baseline
    must be taken off before.

    Examples
    --------
    >>> pulse = np.sin(np.pi * np.linspace(0.0, 1.0, 100))
    >>> bool(np.allclose(ac_uncoupled(ac_coupled(pulse, 1e-5, 2e-3), 1e-5, 2e-3), pulse, atol=1e-12))
    True
    """
    return np.asarray(values + integral(values, step) / constant)
