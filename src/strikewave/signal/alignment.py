"""The shift in time that lays one history on another: by cross-correlation, by their onsets, or by their peaks."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.signal.interpolation import resampled
from strikewave.signal.pulse import RISE_LOW, crossing, refine_peak

Array = NDArray[np.float64]

FINER = 16  # points between two samples: lines and parabolas then err by less than 1e-3 of a sample (measured)
AROUND = 3  # samples on either side of a peak between which it is sought again, band-limited
TOP = 0.8  # share of a peak at which its width gives its curvature: wide enough that noise does not
SAME_STEP = 1e-9  # share by which steps may differ and be the same: rounding
COHERENT, CHANCE = 0.25, 1e-3  # coherence of equal signal and noise; chance that noise alone passes a short band
LINES, WIDENED = 8.0, 0.1  # independent lines of a band at least, and its width over its frequency where that is more
CLEARLY = 1.1  # how much farther a correlation reaches below zero than above it where two histories have opposite signs
ROUNDS, CLOSE = 30, 1e-9  # Newton steps at most for the largest correlation, and the samples within which it has ended


class EvenHistory(NamedTuple):
    """An evenly sampled history: values, time between samples and time of the first one, s, and deviation of noise."""

    values: Array
    step: float
    start: float
    noise: float = 0.0

    @property
    def time(self) -> Array:
        """Time of each sample, s."""
        return np.asarray(self.start + self.step * np.arange(self.values.size))

    @property
    def end(self) -> float:
        """Time of the last sample, s."""
        return self.start + self.step * (self.values.size - 1)


class Shift(NamedTuple):
    """Shift that is added to the times of the second history, s, and its uncertainty.

    Attributes
    ----------
    shift : float
        s.
    uncertainty : float
        Standard uncertainty from noise, and for the correlation from all in which the two differ, s.
    rule : str
        Rule by which the shift was found, in words.
    """

    shift: float
    uncertainty: float
    rule: str


def are_opposite(first: EvenHistory, second: EvenHistory) -> bool:
    """Tell whether two histories are alike with opposite signs: their correlation reaches farthest below zero.

    Of two that are the same but for sign and shift it does, by Cauchy and Schwarz; a tenth is left to what differs.

    Examples
    --------
    >>> pulse = EvenHistory(np.exp(-((np.arange(-50, 51) / 9.0) ** 2)), 1e-6, 0.0)
    >>> are_opposite(pulse, pulse), are_opposite(pulse, pulse._replace(values=-pulse.values, start=1.0))
    (False, True)
    """
    from scipy.fft import irfft, next_fast_len, rfft

    step = max(first.step, second.step)
    a, b = _at_step(first, step), _at_step(second, step)
    size = next_fast_len(a.size + b.size, real=True)
    products = irfft(rfft(a, size) * np.conj(rfft(b, size)), size)
    return bool(-float(products.min()) > CLEARLY * float(products.max()))


def by_correlation(first: EvenHistory, second: EvenHistory, to_gap: bool = False) -> Shift:
    """Return the shift with the largest sum of products of two histories; both are taken as zero outside.

    Both are brought to the finer of their steps, or to half the coarser one where that is longer: what the finer one
    holds beyond has no product with the other. Products are summed up to the last frequency at which the two are
    coherent: beyond, those of noise with noise wiggle so finely that one of their wiggles would be the highest. The
    best shift in whole steps is sought among all, then between them: R(s) = Re sum A conj(B) exp(2 pi i f s) is known
    at any s, and its slope is brought to zero by Newton steps. With r the difference that is left where both are
    known, and b' the slope of the shifted history, the shift has the variance sum |B'|^2 |R|^2 / (sum |B'|^2)^2 over
    these frequencies, over the share of r that the shift has not taken up: that of a least-squares shift under noise
    of the spectrum of r. White noise of deviation s in one of them gives the Cramer-Rao bound s^2 / sum b'^2.

    ``to_gap``: up to the first frequency at which they are not coherent instead. What both picked up from elsewhere is
    coherent too, and may be so beyond a gap: the shift is then another one.

    Raises
    ------
    ValueError
        If one of them is zero throughout.
    """
    from scipy.fft import irfft, next_fast_len, rfft

    step = max(min(first.step, second.step), 0.5 * max(first.step, second.step))
    a, b = _at_step(first, step), _at_step(second, step)
    if not (np.any(a) and np.any(b)):
        raise ValueError("a history that is zero throughout has no shift")
    size = next_fast_len(a.size + b.size, real=True)
    spectrum_a, spectrum_b = rfft(a, size), rfft(b, size)
    both = spectrum_a * np.conj(spectrum_b)
    omega = 2.0 * math.pi * np.arange(both.size) / size
    place = _largest(both, omega, size, a.size)
    for _ in range(2):  # the band is found at a shift, and the shift in a band
        turned = spectrum_b * np.exp(-1j * omega * place)
        alike = np.arange(omega.size) < _coherent(spectrum_a, turned, size / min(a.size, b.size), to_gap)
        place = _largest(alike * both, omega, size, a.size)
    turned = alike * spectrum_b * np.exp(-1j * omega * place)
    left = irfft(alike * spectrum_a - turned, size)
    begin, end = max(math.ceil(place), 0), min(math.floor(place) + b.size, a.size)
    left[:begin] = left[end:] = 0.0  # what only one of them holds has no product, and does not move the shift
    slope = (omega * np.abs(turned)) ** 2
    weight = np.full(omega.size, 2.0)
    weight[0] = 1.0
    bend, spacing = float(weight @ slope), size / max(end - begin, 1)
    fitted = min(spacing * float(weight @ slope**2) / bend**2, 0.5)  # share that the shift has taken up
    moves = float(weight @ (slope * np.abs(rfft(left, size)) ** 2)) * spacing / (1.0 - fitted)
    method = f"largest cross-correlation of the two histories, found between samples of {step:.6g} s"
    return Shift(first.start - second.start + place * step, math.sqrt(moves) / bend * step, method)


def _coherent(a: NDArray[np.complex128], b: NDArray[np.complex128], spacing: float, to_gap: bool) -> int:
    """Return how many lines two aligned spectra have up to the last at which they are alike, or to the first gap.

    Padding has put independent lines a spacing apart. Coherence is taken over bands that widen with frequency. That of
    n independent lines of noise exceeds c with the probability (1 - c)^(n - 1). The strongest band is always alike.
    """
    edges, width = [0], LINES * spacing
    while edges[-1] < a.size:
        edges.append(edges[-1] + math.ceil(max(width, WIDENED * edges[-1])))
    edges = [*(edges[:-2] or [0]), a.size]  # the last one takes what is left: a lone line is always coherent
    begins, counts = np.array(edges[:-1]), np.diff(edges)
    powers = np.add.reduceat(np.abs(a) ** 2, begins) * np.add.reduceat(np.abs(b) ** 2, begins)
    products = np.abs(np.add.reduceat(a * np.conj(b), begins)) ** 2
    independent = np.maximum(counts / spacing, LINES)
    alike = products >= np.maximum(COHERENT, 1.0 - CHANCE ** (1.0 / (independent - 1.0))) * powers
    strongest = int(np.argmax(products))
    alike[strongest] = True
    if to_gap:
        gaps = np.flatnonzero(~alike[strongest:])
        return int(edges[strongest + int(gaps[0])]) if gaps.size else a.size
    return int(edges[int(np.flatnonzero(alike & (products > 0.0)).max(initial=0)) + 1])


def _largest(both: NDArray[np.complex128], omega: Array, size: int, forward: int) -> float:
    """Return where the correlation of this spectrum is largest, in steps: among whole ones, then between them."""
    from scipy.fft import irfft

    found = irfft(both, size)
    lag = int(np.argmax(found))
    whole = lag - size if lag >= forward else lag
    return _steepened(both, omega, whole + _vertex(found, lag))


def _vertex(found: Array, lag: int) -> float:
    """Return where the parabola through three neighbours of a ring is highest, from the middle one."""
    left, middle, right = found[lag - 1], found[lag], found[(lag + 1) % found.size]
    bend = left - 2.0 * middle + right
    return float(0.5 * (left - right) / bend) if bend < 0.0 else 0.0


def _steepened(both: NDArray[np.complex128], omega: Array, place: float) -> float:
    """Return where the correlation is largest, near a place, in steps."""
    begun = place
    for _ in range(ROUNDS):
        turned = both * np.exp(1j * omega * place)
        slope = -float(np.sum(omega * turned.imag))
        bend = -float(np.sum(omega**2 * turned.real))
        if not bend < 0.0:
            break
        move = max(-0.5, min(0.5, -slope / bend))
        place += move
        if abs(move) < CLOSE:
            break
    return place if abs(place - begun) < 1.0 else begun


def by_onset(first: EvenHistory, second: EvenHistory, share: float = RISE_LOW) -> Shift:
    """Return the shift that lays the first crossings of a share of the peak on one another.

    Each is sought backwards from the peak, so that noise and earlier pulses do not count; its uncertainty is the noise
    over the slope there.

    Raises
    ------
    ValueError
        If one begins above that share, or is zero throughout.
    """
    method = f"first crossings of {100.0 * share:g} % of the peaks"
    return _difference(first, second, lambda history: _onset(history, share), method)


def by_peak(first: EvenHistory, second: EvenHistory) -> Shift:
    """Return the shift that lays the peaks, found between samples, on one another.

    White noise of deviation s moves a peak of curvature c (from its width at 80 %) by s pi / (sqrt(3) dt c), and by
    sqrt(s / c) where that is less: between wiggles of noise, the highest is taken.

    Raises
    ------
    ValueError
        If one is zero throughout.
    """
    return _difference(first, second, _peak, "peaks, found between samples")


def _difference(
    first: EvenHistory, second: EvenHistory, place: Callable[[EvenHistory], tuple[float, float]], method: str
) -> Shift:
    (at, doubt), (other, further) = place(first), place(second)
    return Shift(at - other, math.hypot(doubt, further), method)


def _upright(history: EvenHistory) -> tuple[Array, int]:
    """Return a history whose largest magnitude is positive, and its sample."""
    index = int(np.argmax(np.abs(history.values)))
    if not history.values[index]:
        raise ValueError("a history that is zero throughout has no peak")
    return np.copysign(1.0, history.values[index]) * history.values, index


def _top(values: Array, index: int) -> tuple[float, float]:
    """Return place, in samples, and height of a peak between samples."""
    places = np.arange(-AROUND * FINER, AROUND * FINER + 1) / FINER + index
    places = places[(places >= 0.0) & (places <= values.size - 1)]
    fine = resampled(values, places)
    place, height = refine_peak(fine, int(np.argmax(fine)))
    return float(places[0] + place / FINER), height


def _peak(history: EvenHistory) -> tuple[float, float]:
    """Return time of the peak, and its uncertainty, s."""
    values, index = _upright(history)
    at, height = _top(values, index)
    edges = [crossing(values, index, TOP * height, side) for side in (-1, 1)]
    half = 0.5 * (edges[1] - edges[0]) if all(map(math.isfinite, edges)) else float(values.size)
    bend = 2.0 * (1.0 - TOP) * height / max(half, 0.5) ** 2
    doubt = min(history.noise * math.pi / (math.sqrt(3.0) * bend), math.sqrt(history.noise / bend))
    return history.start + at * history.step, doubt * history.step


def _onset(history: EvenHistory, share: float) -> tuple[float, float]:
    """Return the time when a share of the peak is crossed, and its uncertainty, s."""
    values, index = _upright(history)
    level = share * _top(values, index)[1]
    rough = crossing(values, index, level, -1)
    if math.isnan(rough):
        raise ValueError(f"a history that begins above {100.0 * share:g} % of its peak has no onset")
    places = np.arange(math.floor(rough) * FINER, (math.floor(rough) + 1) * FINER + 1) / FINER
    fine = resampled(values, np.minimum(places, values.size - 1.0))
    above = int(np.argmax(fine > level))
    rise = float(fine[above] - fine[above - 1])
    at = float(places[above - 1] + (level - fine[above - 1]) / rise / FINER) if above and rise > 0.0 else rough
    low, high = (crossing(values, index, wide * level, -1) for wide in (0.5, 2.0))
    known = math.isfinite(low)
    doubt = history.noise * (high - (low if known else rough)) / ((1.5 if known else 1.0) * level)
    return history.start + at * history.step, doubt * history.step


def _at_step(history: EvenHistory, step: float) -> Array:
    """Return a history at another step."""
    ratio = history.step / step
    if abs(ratio - 1.0) < SAME_STEP:
        return history.values
    count = math.floor((history.values.size - 1) * ratio * (1.0 + SAME_STEP)) + 1
    places = np.minimum(np.arange(count) / ratio, history.values.size - 1.0)
    return resampled(history.values, places, max(1.0, 1.0 / ratio))
