"""Butterworth low-pass filters: causal, as a recorder has them, and zero-phase, as records are smoothed.

|H(f)|^2 = 1 / (1 + (W/W_c)^(2 n)) with W = tan(pi f dt), the frequency as the bilinear transform warps it,
cutoff W_c and order n. Second-order sections, so that low cutoffs keep their digits.
"""

from __future__ import annotations

import functools
import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

SETTLED = 1e-13
"""Share of a response that may be left where padding ends."""


def low_pass(values: ArrayLike, step: float, cutoff: float, order: int = 4, axis: int = -1) -> Array:
    """Filter a history causally, as an anti-alias filter does: -3 dB at the cutoff, and delayed.

    The filter is at rest before the first sample, so a history that begins with a jump keeps it.

    Parameters
    ----------
    values : array_like
        Evenly sampled history.
    step : float
        Time between samples, s.
    cutoff : float
        Frequency of -3 dB, Hz, below half the sampling rate.
    order : int, optional
        Poles of the filter.
    axis : int, optional
        Axis of time.

    Raises
    ------
    ValueError
        If the cutoff is not below half the sampling rate, or another value makes no sense.

    Examples
    --------
    >>> low_pass(np.ones(400), step=1e-6, cutoff=20e3)[[0, 20, 399]].round(3)
    array([0.   , 0.409, 1.   ])
    """
    from scipy import signal

    sections = _butterworth(cutoff, step, order)
    return np.asarray(signal.sosfilt(sections, _history(values), axis=axis))


def zero_phase(values: ArrayLike, step: float, cutoff: float, order: int = 4, axis: int = -1) -> Array:
    """Filter a history forward and back: no delay, and -3 dB at the cutoff for both passes together.

    Each pass alone has its cutoff where W_c = tan(pi f_c dt) / (sqrt(2) - 1)^(1/(2 n)), higher than the one
    asked for, because two passes square the response; the slope is that of 2 n poles. A filter whose single
    pass has the cutoff takes twice as much: the two conventions differ by a factor 1.25 in cutoff at n = 2.

    Outside, the history is taken to hold its first and its last value, as long as the response lasts: a
    pulse that starts from rest at its first sample stays as it is (mirrored padding would bend it).

    Parameters
    ----------
    values : array_like
        Evenly sampled history.
    step : float
        Time between samples, s.
    cutoff : float
        Frequency of -3 dB of both passes together, Hz, below half the sampling rate.
    order : int, optional
        Poles of each pass.
    axis : int, optional
        Axis of time.

    Raises
    ------
    ValueError
        If the cutoff is not below half the sampling rate, or another value makes no sense.

    Examples
    --------
    A half-sine of 100 us through 10 kHz:

    >>> t = np.arange(-100, 201) * 1e-6
    >>> pulse = np.where((t > 0) & (t < 100e-6), np.sin(np.pi * t / 100e-6), 0.0)
    >>> print(zero_phase(pulse, 1e-6, 10e3, order=2).max().round(3))
    0.951
    """
    from scipy import signal

    sections = _butterworth(cutoff, step, order, (math.sqrt(2.0) - 1.0) ** (-0.5 / order) if order > 0 else 1.0)
    history = np.moveaxis(_history(values), axis, -1)
    radius = float(np.max(np.abs(signal.sos2zpk(sections)[1])))
    length = math.ceil(math.log(SETTLED) / math.log(radius)) if radius > 0.0 else 1
    padded = np.pad(history, [(0, 0)] * (history.ndim - 1) + [(length, length)], mode="edge")
    for _ in range(2):  # forward, then back
        state = signal.sosfilt_zi(sections).reshape(-1, *(1,) * (history.ndim - 1), 2) * padded[..., :1]
        padded = signal.sosfilt(sections, padded, zi=state)[0][..., ::-1]
    return np.ascontiguousarray(np.moveaxis(padded[..., length : padded.shape[-1] - length], -1, axis))


def _butterworth(cutoff: float, step: float, order: int, widened: float = 1.0) -> Array:
    """Return second-order sections; ``widened`` multiplies the cutoff on the warped scale."""
    if not 0.0 < step < math.inf:
        raise ValueError(f"the step must be above zero and finite, got {step!r}")
    if not (isinstance(order, int) and 1 <= order <= 12):
        raise ValueError(f"the order of a filter must be a whole number from 1 to 12, got {order!r}")
    if not 0.0 < cutoff < 0.5 / step:
        raise ValueError(
            f"the cutoff must lie above zero and below half the sampling rate, {0.5 / step:g} Hz, got {cutoff:g} Hz: "
            "take a lower cutoff or a finer step"
        )
    return _sections(order, 2.0 / math.pi * math.atan(widened * math.tan(math.pi * cutoff * step)))


@functools.lru_cache(maxsize=64)
def _sections(order: int, share: float) -> Array:
    from scipy import signal

    return np.asarray(signal.butter(order, share, output="sos"))


def _history(values: ArrayLike) -> Array:
    history = np.asarray(values, dtype=float)
    if history.ndim == 0 or history.size == 0:
        raise ValueError("a filter needs a history with samples")
    if not np.all(np.isfinite(history)):
        raise ValueError("the history holds values that are not finite")
    return history
