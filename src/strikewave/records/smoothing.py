"""Noise taken off a stretch of a record without touching what stands out of the noise."""

from __future__ import annotations

import functools
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.records._read_off_kernels import smoothed_rows

Array = NDArray[np.float64]

NARROWEST = 2
"""Samples to either side of the first window: five, of which a parabola takes three."""
LONGER = 1.4
"""Times that each window is as long as the one before: half an octave, so that few are tried and none is far too
long."""
DIRECT = 2**18
"""Products up to which a sum over windows is taken as it stands; beyond, by its spectrum."""


class SmoothingWindow(NamedTuple):
    """A local parabola over so many samples to either side; none leaves values as they are."""

    half: int

    def over(self, values: Array) -> Array:
        """Return values, or rows of them, smoothed.

        Examples
        --------
        >>> SmoothingWindow(2).over(np.arange(8.0) ** 2)[2:-2].round(6)
        array([ 4.,  9., 16., 25.])
        """
        if self.half == 0:
            return values
        weights, rows = parabola(self.half), np.atleast_2d(values)
        if weights.size * values.size <= DIRECT:
            return smoothed_rows(rows, weights).reshape(values.shape)
        from scipy.signal import fftconvolve

        padded = np.pad(rows, ((0, 0), (self.half, self.half)), mode="edge")
        return np.asarray(fftconvolve(padded, weights[None], "valid", axes=-1)).reshape(values.shape)

    @property
    def gain(self) -> float:
        """Standard deviation that it leaves of white noise."""
        return 1.0 if self.half == 0 else float(np.linalg.norm(parabola(self.half)))


def windows_up_to(longest: int) -> list[SmoothingWindow]:
    """Return the windows that are tried, each half an octave longer than the one before, from none on.

    Examples
    --------
    >>> [window.half for window in windows_up_to(6)]
    [0, 2, 3, 5]
    """
    halves = [0]
    half = NARROWEST
    while half <= longest:
        halves.append(half)
        half = max(half + 1, math.ceil(LONGER * half))
    return [SmoothingWindow(one) for one in halves]


@functools.lru_cache(maxsize=256)
def parabola(half: int) -> Array:
    """Return the weights whose sum with the samples is the middle of their least-squares parabola."""
    k = np.arange(-half, half + 1, dtype=float)
    n, second, fourth = k.size, float(np.sum(k**2)), float(np.sum(k**4))
    return np.asarray((fourth - second * k**2) / (n * fourth - second**2))
