"""Ringing after a blow, or in it: whether a record rings, and at which frequency."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.records.smooth_pulse import SmoothPulse

Array = NDArray[np.float64]

LOWEST_RATIO = 0.3
"""Swings in a width of the blow below which what follows it is a slow motion, no ringing in it."""
RINGS = 0.05
"""Share of the peak by which a record swings after a blow, or strays from a smooth pulse in it, before ringing is
sought."""
STRAYS = 0.03
"""Misfit of the smooth pulse from which on ringing is sought in it: usual shapes are fitted better."""
CLEAR = 5.0
"""Standard deviations of noise that ringing swings by at least."""
SEPARATE = 2.5
"""Swings in a width from which on ringing that is seen in a blow alone is none of its shape: a flat top has fewer."""
FEWEST_AFTER = 8
"""Samples after a blow without which ringing is not sought."""
NOISE_OF_MISFIT = 1.5
"""Standard deviations of noise that the misfit of the smooth pulse must have: it is made of more."""
PADDED = 8
"""Times that a spectrum is padded so that its peak is found between."""
RINGS_WITHIN = 5.0
"""Widths after the blow in which its ringing is looked for."""


class Stretch(NamedTuple):
    """A record around a blow, positive and above its baseline, until the next blow.

    Attributes
    ----------
    values : ndarray
        Samples.
    step : float
        Time between them, s.
    begin, end : int
        Samples at the feet of the blow.
    width : float
        Samples of its width.
    smooth : SmoothPulse
        The smooth pulse that fits it best; time 0 is the first sample.
    noise : float
        Standard deviation of white noise of a sample.
    """

    values: Array
    step: float
    begin: int
    end: int
    width: float
    smooth: SmoothPulse
    noise: float


def ringing_of(stretch: Stretch) -> float:
    """Return the frequency at which a record rings after a blow, or in it, Hz; NaN where it does not."""
    values, step, begin, end, width, smooth, noise = stretch
    last = min(round(end + RINGS_WITHIN * width), values.size)
    if last - end < FEWEST_AFTER:
        return math.nan
    if swings_after(stretch):
        return strongest_frequency(values[end:last], step, LOWEST_RATIO / (width * step))
    if smooth.misfit * smooth.peak < max(STRAYS * smooth.peak, NOISE_OF_MISFIT * noise):
        return math.nan
    rest = values[begin:last] - smooth.at(step * np.arange(begin, last, dtype=np.float64))
    frequency = strongest_frequency(rest, step, 1.0 / (width * step))
    return frequency if frequency * width * step > SEPARATE else math.nan


def swings_after(stretch: Stretch) -> bool:
    """Tell whether a record swings after a blow, by more than its noise."""
    after = stretch.values[stretch.end : round(stretch.end + RINGS_WITHIN * stretch.width)]
    least = max(RINGS * stretch.smooth.peak, CLEAR * stretch.noise)
    return after.size >= FEWEST_AFTER and 0.5 * float(np.ptp(after)) >= least


def strongest_frequency(values: Array, step: float, lowest: float) -> float:
    """Return the frequency of the highest peak of a spectrum, above a lowest one, Hz; NaN where there is none.

    Examples
    --------
    >>> time = np.arange(400) * 1e-5
    >>> round(strongest_frequency(np.exp(-time / 1e-3) * np.sin(2.0 * np.pi * 3000.0 * time), 1e-5, 500.0), -2)
    3000.0
    """
    frequencies, height = spectrum_after(values, step)
    above = np.flatnonzero(frequencies >= lowest)
    return float(frequencies[above[np.argmax(height[above])]]) if above.size else math.nan


def spectrum_after(values: Array, step: float) -> tuple[Array, Array]:
    """Return frequencies, Hz, and amplitude spectrum of what dies out: faded to its end, not from its begin."""
    window = np.hanning(2 * values.size)[values.size :]
    padded = PADDED * values.size
    height = np.abs(np.fft.rfft((values - np.mean(values)) * window, padded))
    return np.asarray(np.fft.rfftfreq(padded, step)), np.asarray(height)
