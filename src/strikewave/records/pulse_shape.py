"""The shape of a blow: a smooth pulse fitted to it, and figures read off a noisy record.

The record is taken as a smooth pulse and what that misses. The rest is smoothed by local parabolas, over the window
whose error is least by what is left and what noise gets through. Without noise the record stays as it is.

Noise like that before the blow is then put on the result, and all of it is done again. By what the figures are off in
the middle they are corrected: the highest of noisy values stands too high, smoothing rounds a foot. They are as
uncertain as those of a window an octave shorter scatter, or differ: detail that noise hides may be there.

Sources: C. L. Mallows, Some Comments on C_P, Technometrics 15 (1973) 661-675; B. Efron, Bootstrap Methods: Another Look
at the Jackknife, Annals of Statistics 7 (1979) 1-26.
"""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.shock_quantities import MICROSECONDS, OF_CHANNEL, OF_INTEGRAL
from strikewave.records._pulse_kernels import fit_pulse, row_figures, smoothed_rows, unit_pulses
from strikewave.records.record import Array
from strikewave.signal.pulse import RISE_HIGH, RISE_LOW, WIDTH_FRACTION

if TYPE_CHECKING:
    from strikewave.signal.filters import Effect, Filter

MOST_SAMPLES = 240  # more are averaged: 50 for each parameter, and a pulse 80 of them wide loses little by it
# Bounds of peak, begin, length (over the guess), share of rise, power: a step and a spike fit, none runs away in noise
LOWEST, HIGHEST = np.array([0.05, -math.inf, 0.2, 0.05, 0.3]), np.array([3.0, math.inf, 4.0, 0.95, 4.0])
BEFORE = 0.5  # lengths before the first sample at which a pulse may begin: one that is cut has begun before its stretch
# Pulses from which the fit begins: flat, between a half-sine and a haversine, and pointed. Near the feet of a power
# below one the sum of squares has a kink at each sample, and valleys between them: of 959 blows, measured and planted,
# one in twenty is fitted better than from the middle power alone.
STARTS = np.array([[1.0, -0.1, 1.2, 0.5, power] for power in (0.6, 1.3, 2.5)])
# How far peak, begin, length, share of rise and power usually lie from the guess; scales the steps of the fit
SPREADS = np.array([1.0, 0.1, 0.3, 0.2, 1.0])
# Evaluations of a fit at most, and the relative change below which it ends: noise moves the parameters far more
ROUNDS, CONVERGED = 50, 1e-6


# Samples of a pulse that a filter is tried on, and times one over the cutoff to either side of it
FILTERED, BESIDE_FILTERED = 400, 3.0
# Share of a parameter by which it is changed for a derivative: squared, it is far below an uncertainty
DERIVATIVE = 1e-4
TOE_POINTS = 33  # points at which a toe is integrated: straight lines between them keep 0.1 % of it


@declare.dataclass
class PulseUncertainty:
    """Standard uncertainties of the figures of a blow by what lies beside it; NaN where they are not known."""

    peak: float = declare.number(
        OF_CHANNEL, "standard uncertainty by noise and baseline", key="peak_uncertainty", default=math.nan
    )
    width: float = declare.number(MICROSECONDS, "the same of the width", key="width_uncertainty", default=math.nan)
    velocity_change: float = declare.number(
        OF_INTEGRAL, "the same of the velocity change", key="velocity_change_uncertainty", default=math.nan
    )


BUDGETED = tuple(declare.declarations(PulseUncertainty))  # figures of a blow that have an uncertainty


class SmoothPulse(NamedTuple):
    """a(t) = A sin^p(pi u), where u goes straight from 0 to 1/2 while the pulse rises and on to 1 while it falls.

    p = 1 is a half-sine, p = 2 a haversine, a late rise a saw-tooth.
    """

    peak: float  # A
    # When it begins and how long it lasts, s
    begin: float
    length: float
    rise_share: float  # share of the length in which it rises
    power: float  # p
    misfit: float = 0.0  # root mean square of what is left, over the peak

    def at(self, time: Array) -> Array:
        """Return the pulse at some times."""
        return _pulses_at(np.ravel(time), np.array([self[:5]]))[0].reshape(np.shape(time))

    @property
    def time(self) -> float:
        """Time of the peak, s."""
        return self.begin + self.rise_share * self.length

    def width(self, share: float = 0.1) -> float:
        """Return the time above a share of the peak, s."""
        return self.length * (1.0 - 2.0 * self._phase(share))

    def rise(self) -> float:
        """Return the time from 10 to 90 % of the peak, s."""
        return self.length * self.rise_share * 2.0 * (self._phase(0.9) - self._phase(0.1))

    def area(self) -> float:
        """Return the integral: A T Gamma((p+1)/2) / (sqrt(pi) Gamma(p/2 + 1)).

        Examples
        --------
        >>> round(SmoothPulse(1.0, 0.0, 1.0, 0.3, 1.0).area() - 2.0 / math.pi, 12)
        0.0
        """
        half = 0.5 * self.power
        ratio = math.exp(math.lgamma(half + 0.5) - math.lgamma(half + 1.0))
        return self.peak * self.length * ratio / math.sqrt(math.pi)

    def area_beyond(self, begin: float, end: float) -> float:
        """Return the integral of the magnitude before one time and after another, s times its unit."""
        toes = (self.begin, min(begin, self.begin + self.length)), (max(end, self.begin), self.begin + self.length)
        first, last = np.array(toes).T
        times = np.linspace(first, np.maximum(first, last), TOE_POINTS)
        return float(np.sum(np.trapezoid(np.abs(self.at(times)), times, axis=0)))

    def width_slope(self, share: float = 0.1, by: float = 0.02) -> float:
        """Return by how much the width falls where the share rises, s: what an error of the baseline does to it."""
        return (self.width(share - by) - self.width(share + by)) / (2.0 * by)

    def uncertainty(self, step: float, noise: float) -> PulseUncertainty:
        """Return the standard uncertainty of the figures, fitted to samples so far apart with white noise.

        That of a least-squares fit, from the derivatives of the pulse by its five parameters.

        Examples
        --------
        >>> figures = SmoothPulse(1.0, 0.0, 1.0, 0.5, 1.0).uncertainty(0.01, 0.1)
        >>> 0.01 < figures.peak < 0.05, 0.01 < figures.width < 0.1
        (True, True)
        """
        samples = math.ceil(self.length / step)
        time: Array = np.asarray(self.begin + step * np.arange(-samples, 2 * samples), dtype=np.float64)
        rows, changes = self._changed()
        pulses = [SmoothPulse(*row) for row in rows]
        values = np.array([(abs(pulse.peak), pulse.width(), pulse.area()) for pulse in pulses])
        figures = (values[:5] - values[5:]) / (2.0 * changes[:, None])
        columns, scale = self.tangents(time)
        spread = np.linalg.pinv(columns) / scale[:, None]
        return PulseUncertainty(*(noise * float(v) for v in np.linalg.norm(figures.T @ spread, axis=1)))

    def tangents(self, time: Array) -> tuple[Array, Array]:
        """Return the directions in which the pulse moves at some times with its five parameters, and how fast.

        The directions are unit columns.
        """
        rows, changes = self._changed()
        pulses = _pulses_at(time, rows)
        slopes = (pulses[:5] - pulses[5:]) / (2.0 * changes[:, None])
        speeds = np.linalg.norm(slopes, axis=1)
        speeds[speeds == 0.0] = 1.0
        return (slopes / speeds[:, None]).T, speeds

    def through(self, filter_: Filter) -> Effect:
        """Return what a filter leaves of the pulse."""
        from strikewave.signal.filters import effect_on_pulse

        step = min(self.length / FILTERED, 0.02 / filter_.cutoff)
        beside = self.length + BESIDE_FILTERED / filter_.cutoff
        time = np.arange(self.begin - beside, self.begin + self.length + beside, step)
        return effect_on_pulse(filter_, np.abs(self.at(time)), step)

    def _changed(self) -> tuple[Array, Array]:
        """Return the parameters with a little more of each, and with as much less, a row each, and these changes."""
        changes = np.array([abs(self.peak), self.length, self.length, 1.0, 1.0]) * DERIVATIVE
        return np.array(self[:5]) + np.vstack([np.diag(changes), -np.diag(changes)]), changes

    def _phase(self, share: float) -> float:
        return math.asin(share ** (1.0 / self.power)) / math.pi


def _pulses_at(time: Array, rows: Array) -> Array:
    """Return pulses at some times, of rows of their five parameters."""
    peaks, begins, lengths, shares, powers = rows.T
    since = (time - begins[:, None]) / lengths[:, None]
    return np.asarray(peaks[:, None] * unit_pulses(since, shares, powers))


def fit_smooth_pulse(time: Array, values: Array, begin: float, length: float) -> SmoothPulse:
    """Fit a smooth positive pulse by least squares, beginning from a guess of its begin and length.

    Times are in s; the baseline of the values is taken off.
    """
    factor = -(-values.size // MOST_SAMPLES)
    count = values.size // factor * factor
    t = (time[:count].reshape(-1, factor).mean(axis=1) - begin) / length
    scale = float(np.max(values)) or 1.0
    y = values[:count].reshape(-1, factor).mean(axis=1) / scale
    low, high = LOWEST.copy(), HIGHEST.copy()
    low[1], high[1] = t[0] - BEFORE, t[-1]
    fits = [fit_pulse(t, y, start, low, high, SPREADS, ROUNDS, CONVERGED) for start in np.clip(STARTS, low, high)]
    best, squares = min(fits, key=lambda fit: float(fit[1]))
    peak, first, run, share, power = (float(v) for v in best)
    misfit = math.sqrt(squares / y.size) / peak
    return SmoothPulse(peak * scale, begin + first * length, run * length, share, power, misfit)


LONGEST = 3  # a window reaches over a third of the box at most: over two thirds a parabola follows a half-sine
# Windows by which the one that doubts the one of least error is shorter, and that of the pulse which noise is put on is
# longer, for what noise left on it would be put on twice. Chosen on planted half-sines, saw-teeth, trapezoids, machine
# and ringing pulses, 20 to 200 samples long, in white noise of 0.5 to 5 %, of one set of seeds: less leaves peaks of
# tips and plateaus off by more than is stated.
FINER, SMOOTHER = 2, 4
DRAWS, SEED = 32, 1  # draws of noise, whose scatter is then known to an eighth; a seed, so that figures repeat
KEPT = 2**14  # random numbers that are cached for the next blow, often as long: 256 kB, the dearest step of a blow
NO_NOISE = 1e-5  # share of the peak below which noise moves no figure by a digit that is shown
# A chord misses an eighth of a 2nd, a parabola 1/16 of a 3rd one
BOW, OVERSHOOT = 8.0 * math.sqrt(3.0), 16.0 * math.sqrt(3.0)

FLAT = 1e-9  # share of the peak a sample at least that a side rises by


class ReadPulse(NamedTuple):
    """A pulse without its noise."""

    values: Array  # the stretch without noise
    # Figures in samples: place of the peak, peak, 10 to 90 % of it, between the crossings of 10 %; NaN where the
    # stretch ends above
    place: float
    peak: float
    rise: float
    width: float
    # Standard uncertainties by noise faster than the blow, by detail that it hides, and by the sampling
    peak_scatter: float
    width_scatter: float


class Surroundings(NamedTuple):
    """The record about a blow."""

    values: Array  # baseline taken off, the blow upwards
    time: Array  # times, s
    near: slice  # samples to which the smooth pulse was fitted
    inside: slice  # those in which the peak lies
    width: int  # samples of the box of the blow


def read_pulse(about: Surroundings, smooth: SmoothPulse, noise: Array) -> ReadPulse:
    """Read the figures of a pulse off a noisy stretch."""
    raw, near = about.values, about.near
    pulse = smooth.at(about.time)
    windows = windows_up_to(max(about.width // LONGEST, 2))
    best, beside = least_error(raw[near], pulse[near], windows, noise)
    pulse = pulse if beside else np.zeros_like(pulse)
    taken, finer = windows[best], windows[max(best - FINER, 0)]
    clean = pulse + taken.over(raw - pulse)
    box = slice(about.inside.start - near.start, about.inside.stop - near.start)
    figures = figures_of(clean[None, near], box)[0]
    doubt = _by_sampling(clean[near], *figures[:2])
    if float(np.std(noise)) > NO_NOISE * figures[1]:
        draws = noise_like(noise, near.stop - near.start, DRAWS)
        base = windows[min(best + SMOOTHER, len(windows) - 1)].over(raw - pulse)[near]
        start = figures_of((base + pulse[near])[None], box)[0]
        rest = base + draws - draws[:, box].mean(axis=1, keepdims=True)
        again = pulse[near] + np.zeros_like(rest)
        if beside:
            basis, _ = np.linalg.qr(smooth.tangents(about.time[near])[0])
            along = (rest @ basis) @ basis.T
            again, rest = again + along, rest - along
        moved = np.hstack([figures_of(again + window.over(rest), box) - start for window in (taken, finer)])
        (off, off_finer), (least, scatter) = (np.split(each, 2) for each in _spread(moved))
        other = figures_of((pulse + finer.over(raw - pulse))[None, near], box)[0] - off_finer
        figures = figures - np.array([0.0, *off[1:]])  # on a plateau noise moves the highest value anywhere
        apart = np.nan_to_num(other - figures)
        of_peak = math.hypot(scatter[1], apart[1])  # a tip is the sharpest detail there is
        of_width = max(scatter[3], math.hypot(least[3], apart[3]))
        doubt = np.hypot(doubt, [of_peak, of_width])
    place, peak, rise, width = (float(value) for value in figures)
    return ReadPulse(clean, near.start + place, peak, rise, width, float(doubt[0]), float(doubt[1]))


def figures_of(rows: Array, inside: slice) -> Array:
    """Return place, peak, rise and width of the largest value inside each row, in samples; NaN where it is cut."""
    first, last, _ = inside.indices(rows.shape[1])
    return np.asarray(row_figures(rows, first, last, WIDTH_FRACTION, RISE_LOW, RISE_HIGH))


def noise_like(noise: Array, size: int, count: int) -> Array:
    """Return rows of noise with the spectrum of a sample of it; white where the sample is shorter than a row."""
    rows = noise.size // size
    if rows == 0:
        return float(np.std(noise)) * np.random.default_rng(SEED).normal(size=(count, size))
    spectrum = np.abs(np.fft.rfft(noise - np.mean(noise)))
    shape = -(-count // rows), spectrum.size
    phases = _kept_phases(*shape) if math.prod(shape) <= KEPT else _random_phases(*shape)
    drawn = np.fft.irfft(spectrum * phases, noise.size)
    return np.asarray(drawn[:, : rows * size].reshape(-1, size)[:count])


def _random_phases(rows: int, lines: int) -> NDArray[np.complex128]:
    """Return complex normal numbers of variance 1, the same at each call: what makes noise of a spectrum."""
    parts = np.random.default_rng(SEED).normal(size=(2, rows, lines)) * math.sqrt(0.5)
    return np.asarray(parts[0] + 1j * parts[1])


_kept_phases = functools.lru_cache(maxsize=16)(_random_phases)


def least_error(raw: Array, pulse: Array, windows: list[SmoothingWindow], noise: Array) -> tuple[int, bool]:
    """Return which window makes the least error, and whether of the rest beside the smooth pulse or of the record."""
    rests = np.array([raw - pulse, raw])
    errors = np.empty((len(windows), 2))
    for k, window in enumerate(windows):
        errors[k] = np.mean((rests - window.over(rests)) ** 2, axis=1)
        errors[k] += 2.0 * float(noise @ window.over(noise)) / noise.size
    best, alone = divmod(int(np.argmin(errors)), 2)
    return best, not alone


def without_noise(raw: Array, pulse: Array, noise: Array, width: int) -> Array:
    """Return a stretch about a blow without its noise.

    ``pulse`` is the smooth pulse fitted to it, ``noise`` are samples of the noise alone, ``width`` those of the blow.
    """
    windows = windows_up_to(max(width // LONGEST, 2))
    best, beside = least_error(raw, pulse, windows, noise)
    return pulse + windows[best].over(raw - pulse) if beside else windows[best].over(raw)


def _spread(rows: Array) -> tuple[Array, Array]:
    """Return medians and standard deviations of columns that are known in most rows; else zero and NaN.

    The mean would lie between two crossings of a level that ringing grazes.
    """
    known = np.isfinite(rows)
    count = known.sum(axis=0)
    enough, count = count > 0.5 * rows.shape[0], np.maximum(count, 1)
    mean = np.where(known, rows, 0.0).sum(axis=0) / count
    half = rows.shape[0] // 2
    middle = np.sort(np.where(known, rows, mean), axis=0)[[~half, half]].mean(axis=0)  # the median of its columns
    scatter = np.sqrt((np.where(known, rows - mean, 0.0) ** 2).sum(axis=0) / count)
    return np.where(enough, middle, 0.0), np.where(enough, scatter, math.nan)


def _by_sampling(values: Array, place: float, peak: float) -> Array:
    """Return what may lie between the samples: of the peak, and of the width in samples."""
    top = int(place)
    low = WIDTH_FRACTION * peak
    before, after = np.flatnonzero(values[: top + 1] <= low), top + np.flatnonzero(values[top:] <= low)
    second, third = np.abs(np.diff(values, 2)), np.abs(np.diff(values, 3))
    if not peak > 0.0:
        return np.zeros(2)
    runs = []
    for k in (int(k) for k in (*before[-1:], *(after[:1] - 1)) if 0 <= k < values.size - 1):
        bow = float(second[max(k - 1, 0) : k + 1].max(initial=0.0)) / BOW
        runs.append(bow / max(abs(float(values[k + 1] - values[k])), FLAT * peak))
    tip = float(third[max(top - 3, 0) : top + 2].max(initial=0.0)) / OVERSHOOT
    return np.array([tip, math.hypot(*runs)])


NARROWEST = 2  # samples to either side of the first window: five, of which a parabola takes three
# Times that each window is as long as the one before: half an octave, so that few are tried and none is far too long
LONGER = 1.4
DIRECT = 2**18  # products up to which a sum over windows is taken as it stands; beyond, by its spectrum


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
    """Return the windows that are tried, each half an octave longer than the one before, from none on."""
    halves = [0]
    half = NARROWEST
    while half <= longest:
        halves.append(half)
        half = max(half + 1, math.ceil(LONGER * half))
    return [SmoothingWindow(half) for half in halves]


@functools.lru_cache(maxsize=256)
def parabola(half: int) -> Array:
    """Return the weights whose sum with the samples is the middle of their least-squares parabola."""
    k = np.arange(-half, half + 1, dtype=float)
    n, second, fourth = k.size, float(np.sum(k**2)), float(np.sum(k**4))
    return np.asarray((fourth - second * k**2) / (n * fourth - second**2))
