"""A channel that answers the blow of another one: a board that swings, with no blow of its own.

Its modes come from a matrix pencil over what follows the peak, taken over three windows: a mode that not all of them
show is none, and their scatter is stated as its uncertainty, which is too small: the windows overlap.

Source of the pencil: Y. Hua, T. K. Sarkar, Matrix pencil method for estimating parameters of exponentially damped
sinusoids in noise, IEEE Transactions on Acoustics, Speech and Signal Processing 38 (1990) 814-824.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

EFFECTIVE = 0.1
"""Share of the peak magnitude that the effective duration holds all samples above."""
MOST_MODES, MOST_POLES = 3, 12
"""Modes reported, and decaying exponentials sought at most."""
MOST_SAMPLES = 400
"""Samples of a pencil at most: its time grows with their cube."""
SAMPLES_A_SWING = 8.0
"""Samples that thinning leaves of a swing of the strongest frequency."""
SHARE_OF_LARGEST = 0.02
"""Singular values, over the largest, that count as signal."""
WINDOWS = ((0.0, 1.0), (0.1, 1.0), (0.0, 0.8))
"""Begin and end of the windows, over the stretch."""
ALIKE = 0.05
"""Difference of frequencies, over themselves, within which two windows show the same mode."""
FEWEST = 24
"""Samples without which no mode is sought."""
BOTH_SIDES, ZERO_MEAN = 0.5, 0.2
"""Other side of the peak, over it, and area over that of the magnitude: a channel with more, and less, swings about
zero. A half-sine has 0 and 1; a decaying sine at a damping ratio of 5 % has 0.85 and below 0.1."""


class Mode(NamedTuple):
    """A decaying swing: frequency in Hz, damping ratio, amplitude at the peak of the record; standard uncertainties."""

    frequency: float
    damping: float
    amplitude: float
    frequency_uncertainty: float
    damping_uncertainty: float

    @property
    def decay_time(self) -> float:
        """Time in which the swing falls to 1/e, s."""
        return math.sqrt(1.0 - self.damping**2) / (2.0 * math.pi * self.frequency * self.damping)


class MeasuredResponse(NamedTuple):
    """What a channel does after the blow of another one.

    Attributes
    ----------
    peak : float
        Absolute maximum above the zero before the blow, with its sign.
    time, delay : float
        When, s; and how long after the peak of the base.
    ratio : float
        Magnitude of the peak over that of the base; NaN where their units differ.
    begin, duration : float
        Effective duration, s: from the first to the last time above 10 % of the peak magnitude.
    rms : float
        Root mean square over the effective duration.
    modes : tuple of Mode
        The strongest, that with the most energy first.
    """

    peak: float
    time: float
    delay: float
    ratio: float
    begin: float
    duration: float
    rms: float
    modes: tuple[Mode, ...]


def effective_span(values: Array, share: float = EFFECTIVE) -> tuple[float, float]:
    """Return the places of the first and last crossing of a share of the peak magnitude, between samples.

    Examples
    --------
    >>> first, last = effective_span(np.exp(-np.arange(1000) / 100.0))
    >>> first, round(last)  # 100 ln 10
    (0.0, 230)
    """
    size = np.abs(values)
    level = share * float(np.max(size))
    above = np.flatnonzero(size >= level)
    first, last = int(above[0]), int(above[-1])
    begin = first - (size[first] - level) / (size[first] - size[first - 1]) if first else 0.0
    after = (size[last] - level) / (size[last] - size[last + 1]) if last < size.size - 1 else 0.0
    return float(begin), float(last + after)


def swings(values: Array) -> bool:
    """Tell whether a record, its zero taken off, swings about zero rather than being struck to one side.

    Examples
    --------
    >>> t = np.linspace(0.0, 1.0, 2000)
    >>> swings(np.exp(-3.0 * t) * np.sin(60.0 * t)), swings(np.sin(np.pi * t))
    (True, False)
    """
    first, last = effective_span(values)
    part = values[math.floor(first) : math.ceil(last) + 1]
    low, high = sorted((-float(np.min(part)), float(np.max(part))))
    total = float(np.sum(np.abs(part)))
    return low > BOTH_SIDES * high and abs(float(np.sum(part))) < ZERO_MEAN * total


def decaying_modes(values: Array, step: float) -> tuple[Mode, ...]:
    """Return the strongest decaying swings of a free response, the one with the most energy first.

    Examples
    --------
    >>> t = np.arange(2000) * 1e-5
    >>> [mode] = decaying_modes(np.exp(-100.0 * t) * np.cos(2.0 * np.pi * 800.0 * t), 1e-5)
    >>> round(mode.frequency), round(mode.damping, 3)
    (800, 0.02)
    """
    from scipy.signal import decimate

    if values.size < FEWEST or not np.any(values):
        return ()
    spectrum = np.abs(np.fft.rfft(values * np.hanning(2 * values.size)[values.size :]))
    strong = np.flatnonzero(spectrum[1:] > 0.1 * np.max(spectrum[1:])) + 1
    swing = values.size / float(strong[-1])
    factor = max(int(swing / SAMPLES_A_SWING), 1)
    thinned = np.asarray(decimate(values, factor, ftype="fir") if factor > 1 else values, dtype=np.float64)
    thinned, step = thinned[:MOST_SAMPLES], step * factor
    found = [
        _pencil(thinned[round(a * thinned.size) : round(b * thinned.size)], step, a * thinned.size * step)
        for a, b in WINDOWS
    ]
    modes = []
    for root, amplitude in found[0]:
        alike = [
            min(other, key=lambda one: abs(one[0].imag - root.imag))[0] if other else complex("nan") for other in found
        ]
        if all(abs(one.imag - root.imag) < ALIKE * root.imag for one in alike):
            frequencies = np.array([one.imag for one in alike]) / (2.0 * np.pi)
            dampings = np.array([-one.real / abs(one) for one in alike])
            spread = float(np.std(frequencies, ddof=1)), float(np.std(dampings, ddof=1))
            modes.append(Mode(float(frequencies[0]), float(dampings[0]), amplitude, *spread))
    modes.sort(key=lambda mode: -(mode.amplitude**2) * mode.decay_time)
    return tuple(modes[:MOST_MODES])


def _pencil(values: Array, step: float, late: float) -> list[tuple[complex, float]]:
    """Return decaying roots of positive frequency, 1/s, and their amplitudes at the begin of the stretch."""
    size, length = values.size, values.size // 3
    if size < FEWEST:
        return []
    rows = np.lib.stride_tricks.sliding_window_view(values, length + 1)
    _, large, right = np.linalg.svd(rows, full_matrices=False)
    order = min(int(np.count_nonzero(large > SHARE_OF_LARGEST * large[0])), MOST_POLES)
    signal = right[:order].T
    grown = np.linalg.eigvals(np.linalg.pinv(signal[:-1]) @ signal[1:])
    grown = grown[np.abs(grown) > 0.0]
    columns = grown[None, :] ** np.arange(size)[:, None]
    amplitudes = np.linalg.lstsq(columns, values.astype(np.complex128), rcond=None)[0]
    roots = np.log(grown) / step
    return [
        (complex(root), float(2.0 * abs(a) * math.exp(-root.real * late)))
        for root, a in zip(roots, amplitudes, strict=True)
        if root.imag > 0.0 and root.real < 0.0 and -root.real < root.imag
    ]


def measure_response(
    values: Array, step: float, start: float, blow: tuple[float, float, float], same_unit: bool = True
) -> MeasuredResponse:
    """Measure a channel against the blow of another one.

    Parameters
    ----------
    values : ndarray
        The channel, finite.
    step, start : float
        Time between samples, and of the first, s.
    blow : tuple of float
        Of the base: begin and time of the peak, s, and the peak.
    same_unit : bool, optional
        Whether base and channel have the same unit, so that a ratio makes sense.
    """
    begin, time, peak = blow
    place = min(max(round((begin - start) / step), 0), values.size - FEWEST)
    level = float(np.median(values[:place])) if place >= FEWEST else float(np.median(values))
    above = values[place:] - level
    top = int(np.argmax(np.abs(above)))
    if above[top] == 0.0:
        return MeasuredResponse(0.0, begin, begin - time, 0.0 if same_unit else math.nan, begin, 0.0, 0.0, ())
    first, last = effective_span(above)
    held = above[math.floor(first) : math.ceil(last) + 1]
    moment = start + (place + top) * step
    return MeasuredResponse(
        float(above[top]),
        moment,
        moment - time,
        abs(float(above[top]) / peak) if same_unit else math.nan,
        start + (place + first) * step,
        (last - first) * step,
        math.sqrt(float(np.mean(held**2))),
        decaying_modes(above[top : math.ceil(last) + 1], step),
    )
