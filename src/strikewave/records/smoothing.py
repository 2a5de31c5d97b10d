"""Noise taken off a stretch of a record without touching what stands out of the noise."""

from __future__ import annotations

import functools
import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CONFIDENCE = 2.0
"""Standard deviations by which the estimates of two windows may differ before the longer one counts as bent.

Less would stop the windows in noise, more would let them cut off a tip."""
NARROWEST = 2
"""Samples to either side of the first window: five, of which a parabola takes three."""
LONGER = 1.4
"""Times that each window is as long as the one before: half an octave, so that few are tried and none is far too
long."""


def smooth(values: Array, noise: float, longest: int) -> tuple[Array, Array]:
    """Smooth by local parabolas, each over the longest window that the noise allows; return values and their noise.

    Windows grow until the confidence intervals of their estimates no longer all meet: there the parabola bends
    what is really in the record. With no noise the values come back as they are.

    Parameters
    ----------
    values : ndarray
        Evenly sampled stretch.
    noise : float
        Standard deviation of the white noise of a single sample.
    longest : int
        Samples of the longest window on either side.

    Source: A. Goldenshluger, A. Nemirovski, On spatially adaptive estimation of nonparametric regression,
    Mathematical Methods of Statistics 6 (1997) 135-170.

    Examples
    --------
    >>> smooth(np.array([0.0, 0.0, 9.0, 0.0, 0.0]), noise=1e-3, longest=2)[0].round(6)
    array([0., 0., 9., 0., 0.])
    """
    best, spread = values.copy(), np.full(values.size, noise)
    if noise <= 0.0:
        return best, spread
    low, high = values - CONFIDENCE * noise, values + CONFIDENCE * noise
    going = np.ones(values.size, dtype=bool)
    half = NARROWEST
    while half <= min(longest, values.size // 2):
        weights, gain = _parabola(half)
        padded = np.pad(values, half, mode="edge")
        estimate = np.convolve(padded, weights, mode="valid")
        low = np.maximum(low, estimate - CONFIDENCE * gain * noise)
        high = np.minimum(high, estimate + CONFIDENCE * gain * noise)
        going &= low <= high
        if not going.any():
            break
        best[going], spread[going] = estimate[going], gain * noise
        half = max(half + 1, math.ceil(LONGER * half))
    return best, spread


@functools.lru_cache(maxsize=256)
def _parabola(half: int) -> tuple[Array, float]:
    """Return the weights whose sum with the samples is the middle of their least-squares parabola, and their norm."""
    k = np.arange(-half, half + 1, dtype=float)
    n, second, fourth = k.size, float(np.sum(k**2)), float(np.sum(k**4))
    weights = (fourth - second * k**2) / (n * fourth - second**2)
    return weights, float(np.linalg.norm(weights))
