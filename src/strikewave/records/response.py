"""A channel that answers the blows of another one, with no blow of its own: how high, when, how long, in which modes.

The effective duration is T_E of MIL-STD-810H, method 516.8: the minimum length of time that contains all data
magnitudes exceeding 1/3 of the shock peak magnitude. So it is quoted; the text of the standard itself was not at hand.
The standard's other duration, T_e, by the moving root mean square, is not given.

Of the modes, decaying swings: a matrix pencil over three windows finds which swings there are; least squares of all of
them together, on the samples themselves, then gives the figures. Their covariance is that of least squares with the
noise that is left: cov = (J'J)^-1 J'S J (J'J)^-1 with the derivatives J and the autocovariance S of the residuals,
tapered. In white noise S = s^2 I, and this is the Cramer-Rao bound s^2 (J'J)^-1; in coloured noise it counts the noise
near each frequency.

Source of the pencil: Y. Hua, T. K. Sarkar, Matrix pencil method for estimating parameters of exponentially damped
sinusoids in noise, IEEE Transactions on Acoustics, Speech and Signal Processing 38 (1990) 814-824. Of the covariance:
W. K. Newey, K. D. West, A simple, positive semi-definite, heteroskedasticity and autocorrelation consistent covariance
matrix, Econometrica 55 (1987) 703-708.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN
from strikewave.base.shock_quantities import FREQUENCY, MILLISECONDS, OF_CHANNEL, RATIO, SECONDS
from strikewave.records.record import Array
from strikewave.records.thresholds import OfAnswers

MOST_MODES, MOST_POLES = 3, 12  # modes reported, and decaying exponentials sought at most
MOST_SAMPLES = 400  # samples of a pencil at most: its time grows with their cube
MOST_FITTED = 20_000  # samples that are fitted at most: longer stretches are thinned
SAMPLES_A_SWING = 8.0  # samples that thinning leaves of a swing of the strongest frequency
SHARE_OF_LARGEST = 0.02  # singular values, over the largest, that count as signal
TINY = 1e-9  # growth a sample below which an exponential is gone at once
WINDOWS = ((0.0, 1.0), (0.1, 1.0), (0.0, 0.8))  # begin and end of the windows, over the stretch
ALIKE = 0.05  # difference of frequencies, over themselves, within which two windows show the same mode
FEWEST = 24  # samples without which no mode is sought
# Steps of least squares, halvings of one that makes it worse, and the share of the squares that ends it
STEPS, HALVINGS, ENOUGH = 40, 8, 1e-9
MEMORY = 20  # the memory of the noise is followed over one in so many of the samples
# Times that what a fit has taken of the noise is put back into what it leaves: it then changes by less than 1 %
ROUNDS = 4


@declare.dataclass
class Mode:
    """A decaying swing."""

    frequency: float = declare.number(FREQUENCY, "of the swing as it decays")
    damping: float = declare.number(RATIO, "damping ratio")
    amplitude: float = declare.number(OF_CHANNEL, "at the begin of the stretch")
    frequency_uncertainty: float = declare.number(FREQUENCY, "standard uncertainty of the frequency")
    damping_uncertainty: float = declare.number(RATIO, "standard uncertainty of the damping ratio")

    @declare.computed(declare.number(MILLISECONDS, "time in which the swing falls to 1/e"))
    def decay_time(self) -> float:
        """Time in which the swing falls to 1/e, s."""
        return math.sqrt(1.0 - self.damping**2) / (2.0 * math.pi * self.frequency * self.damping)


def decaying_modes(values: Array, step: float) -> tuple[Mode, ...]:
    """Return the strongest decaying swings of a free response, the one with the most energy first."""
    from scipy.signal import decimate

    if values.size < FEWEST or not np.any(values):
        return ()
    factor = math.ceil(values.size / MOST_FITTED)
    if factor > 1:
        values, step = np.asarray(decimate(values, factor, ftype="fir"), dtype=np.float64), step * factor
    roots = np.array(_roots(values, step))
    modes: list[Mode] = []
    while roots.size:
        fit = _fitted(values, step, roots)
        if fit is None:
            roots = roots[:-1]  # the one with the least energy
            continue
        modes, certain = fit
        if np.all(certain):
            break
        roots = roots[certain]
        modes = []
    modes.sort(key=_energy)
    return tuple(modes[:MOST_MODES])


def _energy(mode: Mode) -> float:
    return -(mode.amplitude**2) * mode.decay_time


def _roots(values: Array, step: float) -> list[complex]:
    """Return decaying roots of positive frequency, 1/s, that all windows show; the one with the most energy first."""
    from scipy.signal import decimate

    spectrum = np.abs(np.fft.rfft(values * np.hanning(2 * values.size)[values.size :]))
    strong = np.flatnonzero(spectrum[1:] > 0.1 * np.max(spectrum[1:])) + 1
    factor = max(int(values.size / float(strong[-1]) / SAMPLES_A_SWING), 1)
    thinned = np.asarray(decimate(values, factor, ftype="fir") if factor > 1 else values, dtype=np.float64)
    thinned, step = thinned[:MOST_SAMPLES], step * factor
    size = thinned.size
    first, *others = (_pencil(thinned[round(a * size) : round(b * size)], step, a * size * step) for a, b in WINDOWS)
    shown = []
    for root, amplitude in first:
        if all(any(abs(r.imag - root.imag) < ALIKE * root.imag for r, _ in other) for other in others):
            shown.append((root, amplitude))
    shown.sort(key=lambda pair: pair[1] ** 2 / pair[0].real)
    return [root for root, _ in shown]


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
    grown = grown[np.isfinite(grown) & (np.abs(grown) > TINY)]
    columns = grown[None, :] ** np.arange(size)[:, None]
    amplitudes = np.linalg.lstsq(columns, values.astype(np.complex128), rcond=None)[0]
    roots = np.log(grown.astype(np.complex128)) / step  # of real ones too: those below 0 turn half a circle a sample
    return [
        (complex(root), float(2.0 * abs(a) * math.exp(-root.real * late)))
        for root, a in zip(roots, amplitudes, strict=True)
        if root.imag > 0.0 and root.real < 0.0 and -root.real < root.imag
    ]


def _fitted(values: Array, step: float, roots: NDArray[np.complex128]) -> tuple[list[Mode], NDArray[np.bool_]] | None:
    """Fit modes that begin at these roots, with a constant; return them and which are certain, None where none fit."""
    time = np.asarray(step * np.arange(values.size), dtype=np.float64)
    rates, columns, linear, rest = _refined(values, time, np.concatenate([-roots.real, roots.imag]))
    count = roots.size
    decays, omegas = rates[:count], rates[count:]
    if np.any(decays >= omegas) or np.any(omegas >= np.pi / step):
        return None
    covariance = covariance_of(np.hstack([_slopes(columns, linear, time), columns]), rest)
    if covariance is None:
        return None
    modes, certain = [], []
    for k in range(count):
        decay, omega = decays[k], omegas[k]
        size = math.hypot(decay, omega)
        toward = np.array([omega**2, -decay * omega]) / size**3  # d(damping) / d(decay, omega)
        pair = covariance[np.ix_([k, count + k], [k, count + k])]
        a = 2 * count + 2 * k
        amplitude = math.hypot(linear[2 * k], linear[2 * k + 1])
        doubt = math.sqrt(max(0.5 * (covariance[a, a] + covariance[a + 1, a + 1]), 0.0))
        uncertain = math.sqrt(pair[1, 1]) / (2.0 * math.pi)
        damping_uncertainty = math.sqrt(max(float(toward @ pair @ toward), 0.0))
        numbers = (omega / (2.0 * math.pi), decay / size, amplitude, uncertain, damping_uncertainty)
        modes.append(Mode(*map(float, numbers)))
        is_known = 2.0 * math.pi * uncertain < OfAnswers.MOST_UNCERTAIN * omega
        decays_away = decay * float(time[-1]) > OfAnswers.LOSES
        certain.append(decays_away and is_known and amplitude > OfAnswers.CERTAIN * doubt)
    return modes, np.array(certain)


def _refined(values: Array, time: Array, rates: Array) -> tuple[Array, Array, Array, Array]:
    """Return decays and angular frequencies of least squares, their columns, amplitudes, and what is left."""
    columns, linear, rest = _beside(values, time, rates)
    for _ in range(STEPS):
        both = np.hstack([_slopes(columns, linear, time), columns])
        sizes = np.linalg.norm(both, axis=0) + np.finfo(np.float64).tiny  # slopes have units of their own
        change = (np.linalg.lstsq(both / sizes, rest, rcond=None)[0] / sizes)[: rates.size]
        squares = float(rest @ rest)
        for halving in range(HALVINGS):
            tried = np.asarray(rates + 0.5**halving * change, dtype=np.float64)
            if np.all(tried > 0.0):
                seen = _beside(values, time, tried)
                if float(seen[2] @ seen[2]) <= squares:
                    break
        else:
            break
        rates, (columns, linear, rest) = tried, seen
        if squares - float(rest @ rest) <= ENOUGH * squares:
            break
    return rates, columns, linear, rest


def _beside(values: Array, time: Array, rates: Array) -> tuple[Array, Array, Array]:
    """Return cosines and sines of decaying swings and a constant, their best amplitudes, and what they leave."""
    decays, omegas = np.split(rates, 2)
    waves = np.exp(np.outer(time, -decays + 1j * omegas))
    columns = np.hstack([np.stack([waves.real, waves.imag], axis=2).reshape(time.size, -1), np.ones((time.size, 1))])
    linear = np.linalg.lstsq(columns, values, rcond=None)[0]
    return columns, linear, values - columns @ linear


def _slopes(columns: Array, linear: Array, time: Array) -> Array:
    """Return the derivatives of the swings by decay and angular frequency."""
    cosines, sines = columns[:, :-1:2], columns[:, 1:-1:2]
    a, b = linear[:-1:2], linear[1:-1:2]
    return np.hstack([-time[:, None] * (a * cosines + b * sines), time[:, None] * (b * cosines - a * sines)])


def covariance_of(columns: Array, rest: Array) -> Array | None:
    """Return the covariance of least squares in the noise that is left, of whatever colour; None where it has none.

    The autocovariance is tapered by a triangle (Bartlett), so that what comes out is no less than 0. What the fit has
    taken of the noise is missing in what is left: as much as the covariance says, and it is put back.
    """
    from scipy.fft import irfft, next_fast_len, rfft

    size, count = columns.shape
    if size <= 2 * count:
        return None
    base, corner = np.linalg.qr(columns)
    if np.any(np.abs(np.diag(corner)) < 1e-12 * np.linalg.norm(columns, axis=0)):  # one follows from those before it
        return None
    memory = max(size // MEMORY, 1)
    length = next_fast_len(2 * size, real=True)
    bases = rfft(base, length, axis=0)
    power, taken = np.abs(rfft(rest, length)) ** 2, np.abs(bases) ** 2
    taper = np.zeros(length)
    taper[: memory + 1] = 1.0 - np.arange(memory + 1) / (memory + 1)
    taper[length - memory :] = taper[memory:0:-1]
    scattered = np.zeros((count, count))
    for _ in range(ROUNDS):
        alike = irfft(power + taken @ np.diag(scattered), length) * taper / size
        scattered = base.T @ irfft(bases * rfft(alike).real[:, None], length, axis=0)[:size]
    back = np.linalg.inv(corner)
    return np.asarray(back @ scattered @ back.T)


EFFECTIVE = 1.0 / 3.0  # share of the peak magnitude that the effective duration holds all samples above


class BaseBlow(NamedTuple):
    """A blow of the driving channel: begin, time of the peak, and end, s, and the peak."""

    begin: float
    time: float
    end: float
    peak: float


@declare.dataclass
class FreeDecay:
    """The stretch in which a response swings freely."""

    begin: float = declare.number(SECONDS, "begin of the free decay")
    end: float = declare.number(SECONDS, "its end")


@declare.dataclass
class MeasuredResponse:
    """Response of a channel after a blow of another one, until the next blow or the end of the record."""

    blow: int = declare.count("number of the blow of the base, from 1", column=KEY)
    peak: float = declare.number(
        OF_CHANNEL, "absolute maximum above the zero before the first blow, with its sign", column=MAIN
    )
    time: float = declare.number(SECONDS, "when")
    delay: float = declare.number(MILLISECONDS, "how long after the peak of the base")
    base_peak: float = declare.number(OF_CHANNEL, "that of the base, in the unit of the base")
    ratio: float = declare.number(RATIO, "magnitude of the peak over that of the base; null where their units differ")
    begin: float = declare.number(SECONDS, "begin of the effective duration")
    duration: float = declare.number(
        MILLISECONDS, "effective duration: from the first to the last time above a third of the peak magnitude"
    )
    rms: float = declare.number(OF_CHANNEL, "root mean square over the effective duration")
    modes: tuple[Mode, ...] = declare.rows(
        Mode, "the strongest of the free decay, that with the most energy first; amplitudes at its begin"
    )
    zero: float = declare.number(OF_CHANNEL, "what all this is counted from")
    decay: FreeDecay = declare.part(FreeDecay, "the free decay")

    def figure(self, name: str) -> float:
        """Return a figure: the peak by its magnitude, frequency and damping of the strongest mode; NaN for none."""
        if name in ("frequency", "damping"):
            return float(getattr(self.modes[0], name)) if self.modes else math.nan
        value = float(getattr(self, name))
        return abs(value) if name == "peak" else value


def effective_span(values: Array, share: float = EFFECTIVE) -> tuple[float, float]:
    """Return the places of the first and last crossing of a share of the peak magnitude, between samples."""
    size = np.abs(values)
    level = share * float(np.max(size))
    above = np.flatnonzero(size >= level)
    first, last = int(above[0]), int(above[-1])
    begin = first - (size[first] - level) / (size[first] - size[first - 1]) if first else 0.0
    after = (size[last] - level) / (size[last] - size[last + 1]) if last < size.size - 1 else 0.0
    return float(begin), float(last + after)


def swings(values: Array) -> bool:
    """Tell whether a record, its zero taken off, swings about zero rather than being struck to one side."""
    first, last = effective_span(values, OfAnswers.FREE)
    part = values[math.floor(first) : math.ceil(last) + 1]
    low, high = sorted((-float(np.min(part)), float(np.max(part))))
    total = float(np.sum(np.abs(part)))
    return low > OfAnswers.BOTH_SIDES * high and abs(float(np.sum(part))) < OfAnswers.ZERO_MEAN * total


def zero_before(values: Array, place: int) -> float:
    """Return the zero of a record before a place; where too little lies before it, the median of the whole."""
    return float(np.median(values[:place] if place >= FEWEST else values))


def measure_responses(
    values: Array, step: float, start: float, blows: Sequence[BaseBlow], same_unit: bool = True
) -> tuple[MeasuredResponse, ...]:
    """Measure a channel against the blows of another one: after each, until the next.

    Times are in s; ``same_unit`` says that base and channel have one unit, so that a ratio makes sense.
    """
    places = [min(max(round((blow.begin - start) / step), 0), max(values.size - FEWEST, 0)) for blow in blows]
    zero = zero_before(values, places[0]) if places else 0.0
    ends = [*places[1:], values.size]
    return tuple(
        replace(_measure(number, values[place:end] - zero, step, start + place * step, blow, same_unit), zero=zero)
        for number, (blow, place, end) in enumerate(zip(blows, places, ends, strict=True), 1)
        if end - place >= FEWEST
    )


def _measure(number: int, above: Array, step: float, start: float, blow: BaseBlow, same_unit: bool) -> MeasuredResponse:
    """Measure what follows one blow."""
    top = int(np.argmax(np.abs(above)))
    place, peak = _tip(above, top)
    moment = start + place * step
    ratio = abs(peak / blow.peak) if same_unit else math.nan
    if peak == 0.0:
        at = blow.begin
        none = FreeDecay(at, at)
        return MeasuredResponse(number, 0.0, at, at - blow.time, blow.peak, ratio, at, 0.0, 0.0, (), 0.0, none)
    first, last = effective_span(above)
    lasting = above[math.floor(first) : math.ceil(last) + 1]
    free = max(top, math.ceil((blow.end - start) / step))
    until = math.ceil(effective_span(above, OfAnswers.FREE)[1]) + 1
    return MeasuredResponse(
        number,
        peak,
        moment,
        moment - blow.time,
        blow.peak,
        ratio,
        start + first * step,
        (last - first) * step,
        math.sqrt(float(np.mean(lasting**2))),
        decaying_modes(above[free:until], step),
        0.0,
        FreeDecay(start + free * step, start + max(until - 1, free) * step),
    )


def _tip(above: Array, top: int) -> tuple[float, float]:
    """Return place and height of the largest value, by the parabola through it and its neighbours where it is round."""
    if not 0 < top < above.size - 1:
        return float(top), float(above[top])
    left, middle, right = (float(value) for value in above[top - 1 : top + 2])
    bend = left - 2.0 * middle + right
    if middle == 0.0 or min(left / middle, right / middle) < OfAnswers.ROUND:
        return float(top), middle
    shift = 0.5 * (left - right) / bend if bend else 0.0
    return top + shift, middle - 0.25 * (left - right) * shift
