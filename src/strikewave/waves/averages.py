"""Accelerations of what is kept of a run: averages over all steps, in which a jump of velocity keeps its size.

Of velocities that jump, a difference at one fine step grows without bound as the step gets shorter, and between kept
steps it is seen or not by chance. The average of the acceleration with the hat function of a kept step,

    a_i = integral a(t) max(0, 1 - |t - t_i|/h) dt / h = (V_{i+1/2} - V_{i-1/2})/h,

with h the kept step (s) and V the mean velocity from one kept step to the next (m/s), has the same integral as a(t) and
the same first moment: a jump keeps its size and its time. It is a(t) sampled behind a low-pass of sinc(f h)^2; where
every step is kept, it is the central difference.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from strikewave.waves._kernels import Averages

Array = NDArray[np.float64]


def empty_averages(taps: NDArray[np.int64], faces: NDArray[np.int64], every: int, rows: int) -> Averages:
    """Return averages about rows of kept steps before anything ran."""
    return Averages(taps, faces, every, np.zeros((rows, len(taps))), np.zeros((rows, len(faces))))


def mean_acceleration(mean_velocity: Array, before: Array, step: float) -> Array:
    """Return the average acceleration about each kept step, m/s^2, shape (N, taps).

    The first one holds the jump with which a load begins: its integral counts from one kept step before.

    Parameters
    ----------
    mean_velocity : ndarray
        From each kept step to the next, m/s, shape (N, taps).
    before : ndarray
        Velocity before the first kept step, m/s, shape (taps,).
    step : float
        Kept step h, s.

    Examples
    --------
    A jump of 2 m/s a quarter of the way between two kept steps 1 s apart:

    >>> mean_acceleration(np.array([[0.0], [1.5], [2.0]]), np.zeros(1), 1.0).ravel().tolist()
    [0.0, 1.5, 0.5]
    """
    return np.asarray(np.diff(np.vstack([before, mean_velocity]), axis=0) / step)


def from_within(average: Array, value: Array, every: int) -> Array:
    """Return the average of a force about the first or the last kept step, over what of its hat lies within the run.

    ``average`` is the one that counts zero outside, N; ``value`` the force at that step. Then the trapezoidal rule over
    the kept steps gives the impulse of all steps.
    """
    return 2.0 * average - value / every
