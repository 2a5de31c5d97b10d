"""Two sensors on one object: common and differential motion, delay, gain, transfer function.

Half the sum of both is the motion they have in common, half the difference what they do against one another. Modes in
which the two places move against one another, as the first of a free bar between its ends, are not in the common
motion; what the differential motion does in the pulse's own band says how far the body is from rigid there.

The delay is that of the largest cross-correlation, found between samples (`strikewave.signal.alignment`): under white
noise in both sensors that is the maximum-likelihood weight of Knapp & Carter for a transient well above it, and its
standard uncertainty, from what delay and gain leave, then is their bound. The transfer function is averaged over blows,
and over neighbouring lines where these are few; both channels are laid on one another before, so that a delay costs no
coherence.

Sources: C. H. Knapp, G. C. Carter, The generalized correlation method for estimation of time delay, IEEE Transactions
on Acoustics, Speech and Signal Processing 24 (1976) 320-327; J. S. Bendat, A. G. Piersol, Random data, 4th ed. (2010),
chapters 6 and 9.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.fft import next_fast_len
from scipy.ndimage import uniform_filter1d

from strikewave.base.texts import beside_doubt, percent, plain
from strikewave.records.health.sampled_record import with_unit
from strikewave.records.measuring import RecordedPulse, find_pulses
from strikewave.records.record import Array
from strikewave.records.ringing import UNKNOWN
from strikewave.records.robust import alike_as_one
from strikewave.records.thresholds import OfTwoSensors
from strikewave.signal.alignment import EvenHistory, by_correlation
from strikewave.signal.filters import Filter, advised_cutoff
from strikewave.signal.interpolation import resampled

# Widths before a blow that its window holds, and after its begin at least and at most: twenty give lines that are a
# twentieth of the band of the pulse apart, so that averaging some of them still follows the transfer function.
BEFORE, SHORTEST, LONGEST = 1.0, 20.0, 100.0
LOOKED_BACK = 40.0  # widths before a blow from which zero and noise of a channel are taken, as those of a blow are
FEWEST = 32  # samples without which a window, or what lies before it, says nothing
AVERAGES = 5  # spectra averaged, over blows or lines: what is not coherent then has a coherence of 0.2
HIGHEST = 0.45  # share of the sampling rate above which nothing is taken off
# Standard uncertainty of a delay of rigid parts, over what the wave parts differ by and 1 / w of the cutoff. A swing of
# frequency w that begins with the pulse has the area 1 / w of its height in its band; over the area of the pulse, and
# half a width before its middle, it moves the middle by 0.8 / w, with w about twice that of the cutoff; its phase may
# be any.
OF_WAVE = 0.25
SMOOTH_REST = 0.98  # bound of the correlation of neighbours in what a copy leaves, which is as smooth as the pulse


class Transfer(NamedTuple):
    """Motion of the second sensor over that of the first, by frequency."""

    frequency: Array  # Hz
    # Complex estimates that noise of the second, or of the first, does not bias; in truth it lies between both
    h1: NDArray[np.complex128]
    h2: NDArray[np.complex128]
    coherence: Array  # share of the power of the second that follows linearly from the first
    uncertainty: Array  # standard uncertainty of the magnitude, over it
    averages: int  # spectra averaged: blows times neighbouring lines
    resolution: float  # width of the lines that are averaged, Hz
    # First and last frequency, Hz, of the lines around the strongest that are known within 10 % and stand above the
    # noise; NaN where there is none
    trusted: tuple[float, float]
    # Frequency up to which it is 1 within 10 % and its uncertainty, Hz; NaN where it is not, from the first line on
    alike_to: float


class PairedMotion(NamedTuple):
    """Joint motion of two sensors on one object."""

    blows: int  # blows that delay, gain and transfer function are means of
    # Delay of the second after the first, and its standard uncertainty, s; NaN where it is no delayed copy
    delay: float
    delay_uncertainty: float
    # Second over first; NaN where it is no delayed copy
    gain: float
    gain_uncertainty: float
    explained: float  # share of the energy of the second that delay and gain explain
    peak_lag: float  # from the peak of the first to that of the second, the largest values of either sign, s
    common: RecordedPulse | None  # largest blow of the common motion
    # Standard uncertainty of its rigid peak: by noise or the fit, and by the differential motion in its band
    common_uncertainty: float
    differential_peak: float  # largest value of half the difference, with its sign
    differential_in_band: float  # its largest magnitude below the cutoff that leaves 98 % of the common pulse
    differential_share: float  # root mean square of the differential over that of the common motion
    transfer: Transfer | None  # None where no blow is long enough
    one_body: str  # ``yes``, ``no`` or ``cannot-tell``
    reason: str  # why, in words

    @property
    def leads(self) -> int:
        """Number of the sensor that is ahead by more than two standard uncertainties, 1 or 2; 0 for neither."""
        if not abs(self.delay) > OfTwoSensors.TWICE * self.delay_uncertainty:
            return 0
        return 1 if self.delay > 0.0 else 2

    @property
    def rigid_peak(self) -> float:
        """Peak of the common motion, without its ringing where it rings; NaN where it is not known within 10 %."""
        peak = math.nan if self.common is None else _rigid(self.common)[0]
        return peak if self.common_uncertainty <= UNKNOWN * abs(peak) else math.nan


class Window(NamedTuple):
    """One blow in both channels, above their zeros."""

    first: Array
    second: Array
    noises: tuple[float, float]
    cutoff: float = math.inf
    """Below which lies the rigid part of the blow, where it can be separated, Hz."""


def paired_motion(
    first: Array, second: Array, step: float, blows: Sequence[RecordedPulse], start: float = 0.0
) -> PairedMotion:
    """Compare two channels that were sampled together, about the blows of one of them.

    Both are finite, of one unit and equally long; the blows, one at least, are those of either channel.
    """
    every = [_window(first, second, step, start, blows, k) for k in range(len(blows))]
    windows = [window for window in every if window is not None]
    largest = max(blows, key=lambda blow: abs(blow.peak))
    apart = [_copied(window, step) for window in windows]
    copies = [copy for copy in apart if copy.explained >= OfTwoSensors.COPY and not copy.ambiguous]
    delay, delay_doubt = _mean([(copy.delay, copy.delay_doubt) for copy in copies])
    gain, gain_doubt = _mean([(copy.gain, copy.gain_doubt) for copy in copies])
    zeros = [_zero(values, step, start, largest) for values in (first, second)]
    both = first - zeros[0], second - zeros[1]
    common, differential = 0.5 * (both[0] + both[1]), 0.5 * (both[1] - both[0])
    pulse = max(find_pulses(common, step, start), key=lambda blow: abs(blow.peak), default=None)
    near = _near(largest, step, start, first.size)
    if (window := every[list(blows).index(largest)]) is not None:
        near = slice(near.start, near.start + window.first.size)
    against = differential[near]
    in_band = math.nan
    if pulse is not None:
        cutoff = min(advised_cutoff(pulse.smooth.rise(), pulse.smooth.width(), peak_alone=True), 0.4 / step)
        low = Filter(cutoff).apply(differential, step)[_near(pulse, step, start, first.size)]
        in_band = float(np.max(np.abs(low)))
    doubt = math.hypot(_rigid(pulse)[1], in_band / math.sqrt(3.0)) if pulse is not None else math.nan
    shared = math.sqrt(float(np.mean(common[near] ** 2)))
    lags = [int(np.argmax(np.abs(w.second))) - int(np.argmax(np.abs(w.first))) for w in windows]
    transfer = _transfer(windows, step, 0.0 if math.isnan(delay) else delay) if windows else None
    explained = float(np.mean([copy.explained for copy in apart])) if apart else math.nan
    pair = PairedMotion(
        len(copies) or len(windows),
        delay,
        delay_doubt,
        gain,
        gain_doubt,
        explained,
        float(np.mean(lags)) * step if windows else math.nan,
        pulse,
        doubt,
        float(against[np.argmax(np.abs(against))]) if against.size else math.nan,
        in_band,
        math.sqrt(float(np.mean(against**2))) / shared if shared > 0.0 else math.nan,
        transfer,
        "",
        "",
    )
    answer, reason = _as_one_body(pair, any(copy.ambiguous for copy in apart), step, _width(largest))
    return pair._replace(one_body=answer, reason=reason)


def _width(blow: RecordedPulse) -> float:
    return blow.width if blow.width > 0.0 else blow.smooth.width()


def _rigid(pulse: RecordedPulse) -> tuple[float, float]:
    """Return the peak of a blow without its ringing, as well as it is known, and its standard uncertainty."""
    known = [] if pulse.rigid is None else [(pulse.rigid.peak_uncertainty, pulse.rigid.peak)]
    if pulse.split is not None and pulse.split.separable:
        known.append((pulse.split.peak_uncertainty, pulse.split.peak))
    doubt, peak = min(known, default=(pulse.uncertainty.peak, pulse.peak))
    return peak, doubt if math.isfinite(doubt) else pulse.noise


def _place(time: float, step: float, start: float, size: int) -> int:
    return min(max(round((time - start) / step), 0), size)


def _near(blow: RecordedPulse, step: float, start: float, size: int) -> slice:
    """Return the samples of a blow, a width more on either side."""
    width = _width(blow)
    return slice(*(_place(time, step, start, size) for time in (blow.begin - width, blow.end + width)))


def _quiet(values: Array, step: float, start: float, blow: RecordedPulse) -> Array:
    """Return what lies before a blow."""
    width = _width(blow)
    ends = (blow.begin - LOOKED_BACK * width, blow.begin - BEFORE * width)
    return values[slice(*(_place(time, step, start, values.size) for time in ends))]


def _zero(values: Array, step: float, start: float, blow: RecordedPulse) -> float:
    """Return the zero of a channel before a blow of either."""
    quiet = _quiet(values, step, start, blow)
    return float(np.median(quiet if quiet.size >= FEWEST else values))


def _window(
    first: Array, second: Array, step: float, start: float, blows: Sequence[RecordedPulse], k: int
) -> Window | None:
    """Return a blow in both channels until both have settled, or the next blow comes; None where that is too short."""
    blow, width = blows[k], _width(blows[k])
    begin = _place(blow.begin - BEFORE * width, step, start, first.size)
    until = min(blow.begin + LONGEST * width, blows[k + 1].begin - BEFORE * width if k + 1 < len(blows) else math.inf)
    end = _place(until, step, start, first.size)
    pair, noises, settled = [], [], 0
    for values in (first, second):
        above = values[begin:end] - _zero(values, step, start, blow)
        quiet = _quiet(values, step, start, blow)
        noise = float(np.std(quiet)) if quiet.size >= FEWEST else blow.noise
        least = max(OfTwoSensors.SETTLED * float(np.max(np.abs(above), initial=0.0)), OfTwoSensors.CLEAR * noise)
        high = np.flatnonzero(np.abs(above) > least)
        settled = max(settled, int(high[-1]) + 1 if high.size else 0)
        pair.append(above)
        noises.append(noise)
    length = min(max(settled + math.ceil(width / step), FEWEST, round((BEFORE + SHORTEST) * width / step)), end - begin)
    if settled == 0 or length < FEWEST:
        return None
    cutoff = blow.split.cutoff if blow.split is not None and blow.split.separable else math.inf
    return Window(pair[0][:length], pair[1][:length], (noises[0], noises[1]), cutoff)


class Copy(NamedTuple):
    """The second channel of a window as a delayed copy of the first: delay in s, gain, share of energy explained."""

    delay: float
    delay_doubt: float
    gain: float
    gain_doubt: float
    explained: float
    ambiguous: bool


def _copied(window: Window, step: float) -> Copy:
    """Find delay and gain of the second channel against the first, where both stand above their noise.

    If the rigid part can be separated, it is theirs. A copy has the same delay in half of that band: what both differ
    by, beyond noise, is not known of it. Nor is what the begin of the wave part does in the band: see `OF_WAVE`.
    """
    cutoff = _band(window, step)
    copy, half = _copied_below(window, step, cutoff), _copied_below(window, step, 0.5 * cutoff)
    excess = [
        math.sqrt(max((a - b) ** 2 - doubt**2, 0.0) / 3.0)
        for a, b, doubt in ((copy.delay, half.delay, half.delay_doubt), (copy.gain, half.gain, half.gain_doubt))
    ]
    wave = 0.0
    if window.cutoff <= cutoff and copy.gain != 0.0:
        against = window.second / copy.gain - window.first
        left = against - Filter(cutoff).apply(against, step)
        share = float(np.max(np.abs(left))) / float(np.max(np.abs(window.first)))
        wave = OF_WAVE * share / (2.0 * math.pi * cutoff)
    return copy._replace(
        delay_doubt=math.hypot(copy.delay_doubt, excess[0], wave), gain_doubt=math.hypot(copy.gain_doubt, excess[1])
    )


def _copied_below(window: Window, step: float, cutoff: float) -> Copy:
    """Find delay and gain of the second channel against the first below a frequency."""
    from scipy.signal import correlate

    first, second = window.first, window.second
    if cutoff < HIGHEST / step:
        first, second = (Filter(cutoff).apply(values, step) for values in (first, second))
    products = correlate(second, first)
    sign = 1.0 if float(np.max(products)) >= -float(np.min(products)) else -1.0
    power, energy = float(np.sum(first**2)), float(np.sum(second**2))
    if not (power > 0.0 and energy > 0.0):
        return Copy(0.0, math.nan, math.nan, math.nan, 0.0, False)
    scale = float(np.max(np.abs(products))) / power  # so that what the shift leaves is noise, not another gain
    shift = by_correlation(EvenHistory(sign / scale * second, step, 0.0), EvenHistory(first, step, 0.0))
    places = np.arange(second.size) - shift.shift / step
    inside = (places >= 0.0) & (places <= first.size - 1.0)
    moved = np.zeros(second.size)
    moved[inside] = resampled(first, places[inside])
    power = float(np.sum(moved**2))
    gain = float(np.sum(moved * second)) / power
    rest = second - gain * moved
    spread = math.sqrt(float(np.mean(rest**2)) * alike_as_one(rest, SMOOTH_REST) / power)
    explained = max(1.0 - float(np.sum(rest**2)) / energy, 0.0)
    return Copy(shift.shift, shift.uncertainty, gain, spread, explained, _rivalled(sign * products))


def _band(window: Window, step: float) -> float:
    """Return the frequency up to which both channels stand above their noise, or the rigid part goes, Hz.

    The gain, what delay and gain explain, and the half of the band in which both must be the same are taken in it.
    """
    size = window.first.size
    padded = next_fast_len(size + math.ceil(size / 2), real=True)
    spectra = [np.fft.rfft(values, padded) for values in (window.first, window.second)]
    high = np.ones(spectra[0].size, dtype=bool)
    for spectrum, noise in zip(spectra, window.noises, strict=True):
        power = uniform_filter1d(np.abs(spectrum) ** 2, AVERAGES, mode="reflect")
        high &= power > OfTwoSensors.ABOVE_NOISE * noise**2 * size
    if not high.any():
        return min(HIGHEST / step, window.cutoff)
    top = int(np.argmax(np.where(high, np.abs(spectra[0]), 0.0)))
    off = np.flatnonzero(~high[top:])
    return min((top + (int(off[0]) if off.size else high.size)) / (padded * step), window.cutoff)


def _rivalled(products: Array) -> bool:
    """Tell whether another maximum of a correlation is about as high as the largest."""
    top = int(np.argmax(products))
    high = products[top]
    for side in (products[top:], products[top::-1]):
        fallen = np.flatnonzero(side < OfTwoSensors.APART * high)
        if fallen.size and float(np.max(side[fallen[0] :], initial=0.0)) > OfTwoSensors.RIVAL * high:
            return True
    return False


def _mean(known: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """Return the mean of values and its standard uncertainty: by theirs, or by their scatter where that is more."""
    if not known:
        return math.nan, math.nan
    values, doubts = np.array(known).T
    stated = math.sqrt(float(np.mean(doubts**2)) / values.size)
    scatter = float(np.std(values, ddof=1)) / math.sqrt(values.size) if values.size > 2 else 0.0
    return float(np.mean(values)), max(stated, scatter)


def _transfer(windows: Sequence[Window], step: float, delay: float) -> Transfer | None:
    """Estimate the transfer function over windows that are cut to the shortest, the second moved back by a delay."""
    from scipy.signal import csd

    size = min(window.first.size for window in windows)
    back = round(delay / step)
    second = [np.roll(window.second, -back) for window in windows]
    x = np.concatenate([window.first[:size] for window in windows])
    y = np.concatenate([values[:size] for values in second])
    lines = max(-(-AVERAGES // len(windows)), 1)

    def mean_spectrum(a: Array, b: Array) -> NDArray[np.complex128]:
        _, density = csd(a, b, 1.0 / step, "boxcar", size, 0, detrend=False)
        real, imaginary = (uniform_filter1d(part, lines, mode="reflect") for part in (density.real, density.imag))
        return np.asarray(real + 1j * imaginary)

    frequency: Array = np.asarray(np.fft.rfftfreq(size, step), dtype=np.float64)
    xx, yy, xy = mean_spectrum(x, x).real, mean_spectrum(y, y).real, mean_spectrum(x, y)
    floor = np.finfo(float).tiny
    coherence = np.minimum(np.abs(xy) ** 2 / np.maximum(xx * yy, floor), 1.0)
    averages = lines * len(windows)
    uncertainty = np.sqrt((1.0 - coherence) / np.maximum(2.0 * averages * coherence, floor))
    turn = np.exp(-2j * np.pi * frequency * back * step)
    h1, h2 = xy / np.maximum(xx, floor) * turn, yy / np.where(xy == 0.0, floor, np.conj(xy)) * turn
    noises = [2.0 * step * float(np.mean([window.noises[k] ** 2 for window in windows])) for k in (0, 1)]
    sure = (
        (uncertainty <= OfTwoSensors.SURE)
        & (xx >= OfTwoSensors.ABOVE_NOISE * noises[0])
        & (yy >= OfTwoSensors.ABOVE_NOISE * noises[1])
    )
    trusted, alike_to = (math.nan, math.nan), math.nan
    if sure.any():
        middle = int(np.argmax(np.where(sure, xx, 0.0)))
        off = np.flatnonzero(~sure)
        low = int(off[off < middle].max(initial=-1)) + 1
        high = int(off[off > middle].min(initial=sure.size)) - 1
        trusted = float(frequency[low]), float(frequency[high])
        apart = np.abs(h1[low : high + 1] - 1.0) > OfTwoSensors.ALIKE + OfTwoSensors.TWICE * uncertainty[low : high + 1]
        same = int(np.argmax(apart)) if apart.any() else apart.size
        alike_to = float(frequency[low + same - 1]) if same else math.nan
    return Transfer(frequency, h1, h2, coherence, uncertainty, averages, lines / (size * step), trusted, alike_to)


def _as_one_body(pair: PairedMotion, ambiguous: bool, step: float, width: float) -> tuple[str, str]:
    """Tell whether two sensors agree as one rigid body, gain 1 and delay 0, and why."""
    if pair.transfer is None:
        return "cannot-tell", "no blow lies long enough in both channels"
    if math.isnan(pair.delay):
        if ambiguous:
            return "cannot-tell", "several delays fit about as well: the channels swing more than they are struck"
        return "no", f"a delayed copy of the first explains {percent(pair.explained, 0)} of the energy of the second"
    gain_doubt = math.hypot(pair.gain_uncertainty, OfTwoSensors.CALIBRATED)
    delay_doubt = math.hypot(pair.delay_uncertainty, step / math.sqrt(12.0))
    gain_off = abs(pair.gain - 1.0) > OfTwoSensors.TWICE * gain_doubt
    delay_off = abs(pair.delay) > OfTwoSensors.TWICE * delay_doubt
    gain_text = "gain " + " ± ".join(beside_doubt(pair.gain, pair.gain_uncertainty))
    delay_text = "delay " + " ± ".join(beside_doubt(1e6 * pair.delay, 1e6 * pair.delay_uncertainty)) + " µs"
    both = f"{gain_text} and {delay_text}"
    if gain_off or delay_off:
        off = " and ".join([gain_text] * gain_off + [delay_text] * delay_off)
        more = [f"calibration {percent(OfTwoSensors.CALIBRATED, 0)}"] * gain_off
        more += [f"sampling {plain(1e6 * step / math.sqrt(12.0), 2)} µs"] * delay_off
        return "no", f"{off} (standard uncertainties; {' and '.join(more)} more)"
    if gain_doubt > OfTwoSensors.SURE or delay_doubt > OfTwoSensors.SURE * width:
        return "cannot-tell", f"{both}: too uncertain to tell"
    if math.isnan(pair.transfer.alike_to):
        return "cannot-tell", f"{both}, but no band of the transfer function can be trusted"
    return "yes", f"{both}; alike within 10 % up to {with_unit(pair.transfer.alike_to, 'Hz')}"
