"""The pulse of a blow without its ringing, by a joint fit of both and by a low-pass between their bands.

For the joint fit, the record is the pulse and one mode that it drives or strikes. Three physical models, the simplest
first, are fitted by variable projection: their amplitudes are linear, so that shape, frequency and decay are sought.

mount
    the sensor stands on an oscillator and records its absolute acceleration;
mode
    the pulse and a share of such a response: a mode of the object at the place of the sensor;
struck
    the pulse, and a swing of any phase that begins somewhere in it.

The first two leave the area of the pulse as it is. The simplest model that fits about as well as the best is taken;
what the others that fit as well say enters the uncertainty.

Source of the projection: G. H. Golub, V. Pereyra, The differentiation of pseudo-inverses and nonlinear least squares
problems whose variables separate, SIAM Journal on Numerical Analysis 10 (1973) 413-432.

The low-pass is independent of that: no mode is modelled. The cutoff lies where two costs together are least, both over
the peak:

loss
    what the filter takes off a pulse. It is corrected by sending a family of ideal pulses through the same filter, each
    as long as makes it come out as wide as the record does; how far the family disagrees is what is not known of it;
leak
    what the filter leaves of the wave part, which is as large in the blow as its decay after it says.

A third cost no filter can take off: in the pulse's own band an elastic body moves by -s a'' / w^2 more than a rigid
one, with the frequency w of its lowest mode. For a half-sine of duration T this is s / (2 f T)^2 of the peak.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from strikewave.base import declare
from strikewave.base.shock_quantities import FREQUENCY, MICROSECONDS, OF_CHANNEL, RATIO
from strikewave.base.texts import percent
from strikewave.records._pulse_kernels import unit_pulses
from strikewave.records.pulse_shape import SmoothPulse
from strikewave.records.record import Array
from strikewave.records.robust import alike_as_one
from strikewave.records.thresholds import OfRingingSought
from strikewave.signal.filters import Filter
from strikewave.signal.pulse import HALF_SINE_WIDTH, crossing, measure_pulse

QUICKLY = 0.2  # damping ratio above which what is seen in a blow alone is its shape, no ringing
AFTER_WIDTHS, PERIODS = 3.0, 6.0  # widths, or swings if longer, after the blow that are fitted
BEFORE_WIDTHS = 0.6  # widths before the blow that are fitted: they hold its begin
MOST_SAMPLES = 500  # samples that are fitted at most; a finer record is averaged, as far as its ringing allows
A_SWING, A_WIDTH = 12, 24  # samples a swing, and a width, that averaging leaves
FEWEST = 24  # samples without which nine parameters are not fitted
# Shares of the guess: a soft mount lengthens a pulse, a mode may start late
STARTS = ((1.0, 0.0), (0.65, 0.0), (1.0, 0.45))
FITS = 0.03  # misfit below which no other beginning is tried
FAR = 0.2  # misfit that ends the search: 1.5 times the largest that led to a fit, of 545 in 603 planted blows
# Bounds of begin / length, log length, share of rise, power, log frequency, log decay / frequency, onset / length
LOWEST = (-1.0, -1.6, 0.05, 0.3, -0.9, -7.0, -0.6)
HIGHEST = (1.0, 1.1, 0.95, 4.0, 0.9, -0.3, 0.7)
SPREADS = (0.1, 0.2, 0.1, 0.5, 0.1, 1.0, 0.1)  # how far these usually lie from their guess; scales the steps of the fit
ROUNDS, CONVERGED = 30, 1e-5  # evaluations of a fit at most, and the relative change below which it ends
# Widths after the feet of a blow by which its pulse is over, and what is recorded is its ringing; and swings in a width
# below which a blow may be one lobe of its ringing, half a swing and its feet, so that the pulse goes on beneath it.
# Chosen on 800 planted draws of ringing and of mounts (benchmarks/planted, from seed 300000, which no test has) and 600
# of swings that are struck within a pulse, each fitted without regard to its tail: of widths 0, 0.25, 0.5, 0.75 and 1,
# and of swings 0, 0.5, 0.75 and 1, the first with which no tail refuses one of the 1053 fits that are reported. With
# 0.75 swings seven are lost, and three half a width after the feet; with 1 swing, three at the feet.
OVER_WIDTHS, A_LOBE = 0.25, 1.0
# Frequencies over their guess, and decays over it, of the swings that are tried before a fit: its bounds
NEAR = np.exp(np.linspace(-0.9, 0.9, 61))
DECAYS = np.exp(np.linspace(-7.0, -0.3, 12))
TIP = 0.04  # share of the length of a pulse over which its tip is averaged: a straight one loses 2 % of its peak by it
# Decay over frequency above which a mode does not swing: it has gone to its bound to make up for something else
OVERDAMPED = 0.7
# Times that a pulse without ringing may be as wide as the smooth pulse, and share of its peak that it must have
WIDER, LOWER = 4.0, 0.25
# Standard uncertainties of peak, width, area by shapes outside the family, planted
SHAPES = np.array([0.025, 0.04, 0.015])
# The same of a mode that has an amplitude of its own and swings less than `OfRingingSought.SEPARATE` times in a width:
# swing and pulse are alike, and what is missed beyond `OfRingingSought.ENOUGH` may be of either, by as many times more.
ALIKE = np.array([0.2, 0.25, 0.15])
# Share of the squares of the columns added to them: a mode and a pulse that look alike share their amplitude
RIDGE = 1e-10
TINY = 1e-300  # added too: a pulse that lies outside has no square
# Bound of the correlation of neighbours in what is left: what is left of a shape that no model has is smooth
SMOOTH_REST = 0.98
FAST = 64  # spectra have a multiple of so many samples: their transform is fast
DIFFERENCE = math.sqrt(np.finfo(float).eps)  # change of a parameter for a derivative of what is left


class RigidPulse(NamedTuple):
    """A pulse without its ringing."""

    peak: float  # in the unit of the record, with its sign
    # From 10 to 90 % of that peak, and above 10 %, s
    rise: float
    width: float
    velocity_change: float  # integral of the pulse
    # Standard uncertainties: of the fit, and of which model holds
    peak_uncertainty: float
    width_uncertainty: float
    velocity_change_uncertainty: float
    # Frequency of the ringing, Hz; damping ratio
    frequency: float
    damping: float
    misfit: float  # root mean square of what is left, over the peak
    model: str  # ``mount``, ``mode`` or ``struck``
    shape: SmoothPulse  # the pulse itself

    def moved(self, later: float, sign: float = 1.0) -> RigidPulse:
        """Return the pulse so much later, s, and turned round for a sign of -1."""
        shape = self.shape._replace(begin=self.shape.begin + later, peak=sign * self.shape.peak)
        return self._replace(peak=sign * self.peak, velocity_change=sign * self.velocity_change, shape=shape)


class Fit(NamedTuple):
    """One model fitted: pulse, frequency in rad/s, decay in 1/s, misfit, uncertainties of the figures."""

    pulse: SmoothPulse
    omega: float
    decay: float
    misfit: float
    doubt: Array
    model: str


Columns = Callable[[Array, Array, float, Array | float, Array | float], tuple[Array, Array]]
"""Pulse, time since the onset of the swing, step, frequency, decay: columns of a model, gains at frequency zero. Many
pulses at once where each has a row, and frequency and decay a column of one."""


def fit_rigid_pulse(
    values: Array,
    step: float,
    guess: SmoothPulse,
    frequency: float,
    noise: float = 0.0,
    models: Sequence[Columns] | None = None,
) -> RigidPulse | None:
    """Fit a positive pulse together with its ringing; None where no such model fits.

    Parameters
    ----------
    values : ndarray
        Record around one blow, its baseline taken off; time 0 is its first sample.
    step : float
        Time between samples, s.
    guess : SmoothPulse
        About where the pulse lies.
    frequency : float
        About that of the ringing, Hz.
    noise : float, optional
        Standard deviation of white noise of a sample.
    models : sequence, optional
        Models of `MODELS` to try; all by default.
    """
    tried = models or MODELS
    best_of: dict[str, Fit] = {}
    for share, onset in STARTS if len(tried) > 1 else STARTS[:1]:
        for model in tried:
            so_far = best_of.get(_name(model))
            if (onset and model is not _struck) or (so_far is not None and so_far.misfit < FITS):
                continue
            fit = _fit(values, step, guess._replace(length=share * guess.length), frequency, model, onset)
            if fit is not None and (so_far is None or fit.misfit < so_far.misfit):
                best_of[fit.model] = fit
        if min((fit.misfit for fit in best_of.values()), default=math.inf) > FAR:
            return None
    fits = [best_of[_name(model)] for model in tried if _name(model) in best_of]
    fits = [fit for fit in fits if fit.decay < OVERDAMPED * fit.omega and _plausible(fit, guess)]
    least = min((fit.misfit for fit in fits), default=math.inf)
    if least > OfRingingSought.POOR:
        return None
    enough = max(OfRingingSought.AS_GOOD * least, OfRingingSought.ENOUGH)
    best = next(fit for fit in fits if fit.misfit <= max(enough, noise / fit.pulse.peak))  # the simplest of them
    figures = np.array([_figures(fit.pulse) for fit in fits if fit.misfit <= enough or fit is best])
    own = np.array(_figures(best.pulse))
    models_apart = np.max(np.abs(figures - own), axis=0) / math.sqrt(3.0)
    is_apart = best.model == "mount" or best.omega / (2.0 * math.pi) * best.pulse.width() > OfRingingSought.SEPARATE
    shapes = SHAPES if is_apart else ALIKE * max(best.misfit / OfRingingSought.ENOUGH, 1.0)
    floor = np.hypot(shapes, 0.5 * best.misfit) * own
    doubt = np.sqrt(best.doubt**2 + models_apart**2 + floor**2)
    pulse, frequency = best.pulse, best.omega / (2.0 * math.pi)
    damping = best.decay / math.hypot(best.omega, best.decay)
    read = pulse.peak, pulse.rise(), pulse.width(), pulse.area()
    of_peak, of_width, of_change = (float(v) for v in doubt)
    return RigidPulse(*read, of_peak, of_width, of_change, frequency, damping, best.misfit, best.model, pulse)


def _plausible(fit: Fit, guess: SmoothPulse) -> bool:
    """Tell whether a pulse is one that ringing could have made of the guess."""
    return fit.pulse.width() < WIDER * guess.width() and fit.pulse.peak > LOWER * guess.peak


def _figures(pulse: SmoothPulse) -> tuple[float, float, float]:
    return pulse.peak, pulse.width(), pulse.area()


def _mount(pulse: Array, since: Array, step: float, omega: Array | float, decay: Array | float) -> tuple[Array, Array]:
    """Return the absolute acceleration of an oscillator whose base moves by the pulse, a line between samples.

    Its kernel is exp(-d t) (2 d cos w t + (w^2 - d^2) / w sin w t), with damped frequency w and decay d. Between
    samples it is integrated exactly; the sum over samples is a product of spectra, padded so that no end meets a begin.
    """
    count = pulse.shape[-1]
    root = np.asarray(1j * omega - decay)
    grown = np.exp(root * step)
    first = (grown - 1.0) / root  # of a step, exact; of a slope (e^{rh} - 1 - r h) / (r^2 h)
    ramp = (first - step) / (root * step)
    swing = 2.0 * decay - 1j * (omega**2 - decay**2) / omega
    later = swing * (ramp + (first - ramp) / grown)
    time: Array = step * np.arange(count, dtype=np.float64)
    angle = omega * time
    kernel = np.exp(-decay * time) * (later.real * np.cos(angle) - later.imag * np.sin(angle))
    kernel[..., :1] = (swing * ramp).real
    padded = -(-2 * count // FAST) * FAST
    spectrum = np.fft.rfft(pulse, padded) * np.fft.rfft(kernel, padded)
    return np.asarray(np.fft.irfft(spectrum, padded)[..., None, :count]), np.ones(1)


def _mode(pulse: Array, since: Array, step: float, omega: Array | float, decay: Array | float) -> tuple[Array, Array]:
    """Return the pulse, and the response of an oscillator to it."""
    response, _ = _mount(pulse, since, step, omega, decay)
    return np.concatenate([pulse[..., None, :], response], axis=-2), np.ones(2)


def _struck(pulse: Array, since: Array, step: float, omega: Array | float, decay: Array | float) -> tuple[Array, Array]:
    """Return the pulse, and a decaying cosine and sine from an onset on; the cosine grows in a quarter of a swing."""
    after = np.maximum(since, 0.0)
    fall = np.exp(-decay * after)
    grown = 1.0 - np.exp(-4.0 * omega / (2.0 * np.pi) * after)
    swings = fall * np.cos(omega * after) * grown, fall * np.sin(omega * after)
    return np.stack([pulse, *swings], axis=-2), np.array([1.0, 0.0, 0.0])


MODELS: tuple[Columns, ...] = (_mount, _mode, _struck)  # the simplest first


def _name(model: Columns) -> str:
    return getattr(model, "__name__", "").strip("_")


def _fit(values: Array, step: float, guess: SmoothPulse, frequency: float, model: Columns, onset: float) -> Fit | None:
    """Fit one model from one guess."""
    from scipy.optimize import least_squares

    time: Array = step * np.arange(values.size, dtype=np.float64)
    scale = float(np.max(np.abs(values)))
    y = values / scale
    omega0 = 2.0 * math.pi * frequency

    def split(v: Array) -> tuple[SmoothPulse, float, float]:
        length = guess.length * math.exp(v[1])
        begin = guess.begin + v[0] * guess.length
        omega = omega0 * math.exp(v[4])
        return SmoothPulse(1.0, begin, length, float(v[2]), float(v[3])), omega, omega * math.exp(v[5])

    def projected(rows: Array) -> tuple[Array, Array, Array]:
        """Return what is left of the record by rows of parameters, their amplitudes, the gains of these."""
        v = rows.T[:, :, None]
        begin, length = guess.begin + v[0] * guess.length, guess.length * np.exp(v[1])
        omega = omega0 * np.exp(v[4])
        inside = slice(*np.searchsorted(time, (begin.min(), (begin + length).max())))
        pulses = np.zeros((rows.shape[0], time.size))
        pulses[:, inside] = unit_pulses((time[inside] - begin) / length, rows[:, 2], rows[:, 3])
        struck = begin + (v[6] * length if v.shape[0] > 6 else 0.0)
        columns, gains = model(pulses, time - struck, step, omega, omega * np.exp(v[5]))
        products = columns @ np.swapaxes(columns, 1, 2)
        diagonal = np.arange(products.shape[1])
        products[:, diagonal, diagonal] = products[:, diagonal, diagonal] * (1.0 + RIDGE) + TINY
        amplitudes = np.linalg.solve(products, columns @ y[:, None])
        rest = y - np.sum(amplitudes * columns, axis=1)
        return np.asarray(rest), np.asarray(amplitudes[:, :, 0], dtype=np.float64), gains

    def slopes_of_rest(v: Array) -> Array:
        """Return the derivatives of what is left, from one call: each parameter is changed away from its bound."""
        change = np.where(v < 0.0, -DIFFERENCE, DIFFERENCE) * np.maximum(np.abs(v), 1.0)
        moved = v + change
        change = np.where((moved < low) | (moved > high), -change, change)
        rest, _, _ = projected(np.vstack([v, v + np.diag(change)]))
        return np.asarray(((rest[1:] - rest[0]) / ((v + change) - v)[:, None]).T)

    count = 7 if model is _struck else 6
    low, high = np.array(LOWEST[:count]), np.array(HIGHEST[:count])
    shape = np.clip(guess.rise_share, 0.1, 0.9), np.clip(guess.power, 0.5, 2.0)
    start = np.array([0.0, 0.0, *shape, 0.0, -3.0, onset])[:count]
    try:
        best = least_squares(
            lambda v: projected(v[None, :])[0][0],
            start,
            slopes_of_rest,
            bounds=(low, high),
            x_scale=SPREADS[:count],
            max_nfev=ROUNDS,
            xtol=CONVERGED,
            ftol=CONVERGED,
        )
    except (ValueError, np.linalg.LinAlgError):
        return None

    changes = 1e-4 * np.array(SPREADS[:count])
    rows = np.vstack([best.x, best.x + np.diag(changes), best.x - np.diag(changes)])
    left, amplitudes, gains = projected(rows)
    rest = left[0]
    peaks = amplitudes @ gains
    peak = float(peaks[0])
    if not peak > 0.0:
        return None
    pulse, omega, decay = split(best.x)
    figures = np.array([_figures(split(row)[0]._replace(peak=gain)) for row, gain in zip(rows, peaks, strict=True)])
    slopes = (figures[1 : count + 1] - figures[count + 1 :]) / (2.0 * changes[:, None])
    variance = float(np.sum(rest**2)) / max(rest.size - 9, 1) * alike_as_one(rest, SMOOTH_REST)
    covariance = variance * np.linalg.pinv(best.jac.T @ best.jac)
    doubt = np.sqrt(np.maximum(np.einsum("ki,kl,li->i", slopes, covariance, slopes), 0.0))
    own = math.sqrt(variance / (0.5 * max(pulse.length / step, 1.0)))
    of_peak = math.hypot(doubt[0], own, _missed_at_tip(rest, pulse._replace(peak=peak), step))
    doubt = np.array([of_peak, doubt[1], doubt[2]]) * np.array([scale, 1.0, scale])
    misfit = math.sqrt(float(np.mean(rest**2))) / peak
    return Fit(pulse._replace(peak=peak * scale), omega, decay, misfit, doubt, _name(model))


def _missed_at_tip(rest: Array, pulse: SmoothPulse, step: float) -> float:
    """Return the standard uncertainty of a peak by what is left of the record near it: a tip that is no family's.

    What is left may be of the pulse or of what swings. The peak lies between that of the fit and that of the record
    without the swing, anywhere as likely.
    """
    time: Array = step * np.arange(rest.size, dtype=np.float64)
    count = max(round(TIP * pulse.length / step), 1)
    inside = np.abs(time - pulse.time) < 0.25 * pulse.length
    if np.count_nonzero(inside) < count:
        return 0.0
    means = np.convolve((pulse.at(time) + rest)[inside], np.full(count, 1.0 / count), "valid")
    return abs(float(np.max(means)) - pulse.peak) / math.sqrt(3.0)


def rigid_pulse(stretch: Stretch, frequency: float, last: RigidPulse | None = None) -> RigidPulse | None:
    """Return the pulse without its ringing; None where nothing rings, or no model of it fits.

    ``frequency`` is that of `ringing_of`; ``last`` the pulse of the blow before it in a train, whose ringing is alike.
    """
    if not frequency > 0.0:
        return None
    values, step, width = stretch.values, stretch.step, stretch.width
    low = max(round(stretch.begin - BEFORE_WIDTHS * width), 0)
    lasting = max(AFTER_WIDTHS * width, PERIODS / (frequency * step), FEWEST)
    high = min(round(stretch.end + lasting), values.size)
    finest = min(-(-(high - low) // MOST_SAMPLES), int(1.0 / (frequency * step * A_SWING)), int(width / A_WIDTH))
    factor = max(1, finest)
    count = (high - low) // factor
    if count < FEWEST:
        return None
    part = values[low : low + count * factor].reshape(count, factor).mean(axis=1)
    middle = step * (low + 0.5 * (factor - 1))
    guess = stretch.smooth._replace(begin=stretch.smooth.begin - middle)
    alone = part - guess.at(factor * step * np.arange(count, dtype=np.float64))
    over = OVER_WIDTHS if frequency * width * step > A_LOBE else WIDER - 1.0
    tail = part[min(round((stretch.end + over * width - low) / factor), count) :]
    if least_beside_one_mode(tail, factor * step, frequency) > OfRingingSought.BETTER**2 * float(np.sum(alone**2)):
        return None
    models = MODELS if last is None else [model for model in MODELS if _name(model) == last.model]
    rigid = fit_rigid_pulse(part, factor * step, guess, frequency, stretch.noise / math.sqrt(factor), models)
    if rigid is None and last is not None:
        return rigid_pulse(stretch, frequency)
    if rigid is None or (rigid.damping > QUICKLY and not swings_after(stretch)):
        return None
    better = rigid.misfit * rigid.peak < OfRingingSought.BETTER * math.sqrt(float(np.mean(alone**2)))
    return rigid.moved(middle) if better else None


def least_beside_one_mode(values: Array, step: float, frequency: float) -> float:
    """Return the least sum of squares that one decaying swing leaves of a record, near a frequency, Hz.

    All frequencies and decays of a grid at once: a cosine and a sine for each, their amplitudes by projection. Where
    more is left than a fit may miss, no pulse before these samples and no mode of it can make up for it.
    """
    if values.size < FEWEST_AFTER:
        return 0.0
    time = step * np.arange(values.size, dtype=np.float64)
    omega = 2.0 * math.pi * frequency * NEAR
    swings = np.exp(-1j * np.multiply.outer(omega, time))
    falls = np.exp(-2.0 * math.pi * frequency * np.multiply.outer(DECAYS, time))
    # of columns c + i s, times a fall: sums of c y + i s y, of c^2 + s^2, and of c^2 - s^2 + 2 i c s
    # without a product of matrices, whose threads would wait in a busy loop for the next one
    along = np.einsum("ft,dt->fd", swings, falls * values)
    both = np.sum(falls**2, axis=1)
    turned = np.einsum("ft,dt->fd", swings**2, falls**2)
    taken = 2.0 * (both * np.abs(along) ** 2 - (np.conj(turned) * along**2).real)
    taken /= np.maximum(both**2 - np.abs(turned) ** 2, RIDGE * both**2)
    return float(np.sum(values**2) - np.max(taken))


FEWEST_AFTER = 8  # samples after a blow without which ringing is not sought
PADDED = 8  # times that a spectrum is padded so that its peak is found between
RINGS_WITHIN = 5.0  # widths after the blow in which its ringing is looked for


class Stretch(NamedTuple):
    """A record around a blow, positive and above its baseline, until the next blow."""

    values: Array  # samples
    step: float  # time between them, s
    # Samples at the feet of the blow
    begin: int
    end: int
    width: float  # samples of its width
    smooth: SmoothPulse  # the smooth pulse that fits it best; time 0 is the first sample
    noise: float  # standard deviation of white noise of a sample


def ringing_of(stretch: Stretch) -> float:
    """Return the frequency at which a record rings after a blow, or in it, Hz; NaN where it does not."""
    values, step, begin, end, width, smooth, noise = stretch
    last = min(round(end + RINGS_WITHIN * width), values.size)
    if last - end < FEWEST_AFTER:
        return math.nan
    if swings_after(stretch):
        return strongest_frequency(values[end:last], step, OfRingingSought.LOWEST_RATIO / (width * step))
    if smooth.misfit * smooth.peak < max(OfRingingSought.STRAYS * smooth.peak, OfRingingSought.NOISE_OF_MISFIT * noise):
        return math.nan
    rest = values[begin:last] - smooth.at(step * np.arange(begin, last, dtype=np.float64))
    frequency = strongest_frequency(rest, step, 1.0 / (width * step))
    return frequency if frequency * width * step > OfRingingSought.SEPARATE else math.nan


def swings_after(stretch: Stretch) -> bool:
    """Tell whether a record swings after a blow, by more than its noise."""
    after = stretch.values[stretch.end : round(stretch.end + RINGS_WITHIN * stretch.width)]
    least = max(OfRingingSought.RINGS * stretch.smooth.peak, OfRingingSought.CLEAR * stretch.noise)
    return after.size >= FEWEST_AFTER and 0.5 * float(np.ptp(after)) >= least


def strongest_frequency(values: Array, step: float, lowest: float) -> float:
    """Return the frequency of the highest peak of a spectrum, above a lowest one, Hz; NaN where there is none."""
    frequencies, height = spectrum_after(values, step)
    above = np.flatnonzero(frequencies >= lowest)
    return float(frequencies[above[np.argmax(height[above])]]) if above.size else math.nan


def spectrum_after(values: Array, step: float) -> tuple[Array, Array]:
    """Return frequencies, Hz, and amplitude spectrum of what dies out: faded to its end, not from its begin."""
    window = np.hanning(2 * values.size)[values.size :]
    padded = PADDED * values.size
    height = np.abs(np.fft.rfft((values - np.mean(values)) * window, padded))
    return np.asarray(np.fft.rfftfreq(padded, step)), np.asarray(height)


# Ideal pulses of one length, flat to peaked, leaning or not, as contacts, pads and machines make them; no saw-tooths
FAMILY = tuple(SmoothPulse(1.0, 0.0, 1.0, rise, power) for power in (0.7, 1.0, 1.5, 2.0, 3.0) for rise in (0.25, 0.5))
# Cutoff times length: a fifth of the peak is left at the shortest, 0.01 % taken at the longest; 40 are right to 0.1 %
LENGTHS = np.exp(np.linspace(math.log(0.15), math.log(30.0), 40))
# Samples of a tabulated pulse and of 1 / cutoff; 1 / cutoffs on either side
SAMPLES, SAMPLES_OF_CUTOFF, REACH = 200, 20, 4.0
# Times the narrowest width that a filter lets out by which the filtered pulse must be wider: less tells no length
NARROWER = 1.03
# Cutoffs that are tried, over the frequency of the lowest mode
CUTOFFS = np.exp(np.linspace(math.log(0.15), math.log(1.0), 25))
HIGHEST_CUTOFF = 0.45  # share of the sampling rate above which there is no cutoff
# Standard uncertainty of s: 1 on a mount, pi^2/6 at the far end of a free bar, -pi^2/3 at the struck end
ELASTIC = 1.65
# Standard uncertainties of peak and width, over themselves, by shapes that the family has not: the smallest of 0.5, 1,
# 1.5, 2, 3 and 4 % with which two standard uncertainties hold 97 of 100 of 318 planted blows that ring (seeds that no
# test has).
OTHER_SHAPES = 0.01, 0.02
# Height at the foot of a swing that begins there, over its own: area 1 / w, times 1.3 cutoffs of a low-pass
ONSET = 0.2
# Times that the wave part may be larger in the blow than after it: its decay is that of a few swings
LARGEST_GROWTH = 3.0
# Height of a spectral peak, over the highest, that is a mode: lower, side lobes count; higher, a bar loses its first
OTHER_MODES = 0.1
NOISES = 4.0  # times the noise of a spectrum that such a peak must be: noise reaches it once in 1e7 lines (exp(-16))
UNKNOWN = 0.1  # uncertainty of the peak above which no figure is given: 20 % (95 %) is a whole tolerance of a shock


@declare.dataclass
class BandSplit:
    """A blow split by a low-pass into its rigid part and its wave part."""

    cutoff: float = declare.number(FREQUENCY, "of the zero-phase low-pass, -3 dB")
    lowest_mode: float = declare.number(FREQUENCY, "frequency of the lowest mode of the wave part")
    peak: float = declare.number(OF_CHANNEL, "of the rigid part, the loss corrected, with its sign")
    width: float = declare.number(MICROSECONDS, "of the rigid part at 10 % of its peak")
    peak_uncertainty: float = declare.number(OF_CHANNEL, "standard uncertainty of that peak")
    width_uncertainty: float = declare.number(MICROSECONDS, "standard uncertainty of that width")
    loss: float = declare.number(
        RATIO, "what the filter takes off the peak of a pulse as wide, over it: the mean of the family"
    )
    loss_uncertainty: float = declare.number(
        RATIO, "what is not known of the peak by how the family disagrees, over it"
    )
    leak: float = declare.number(
        RATIO, "what is not known of the peak by what the filter leaves of the wave part, over it"
    )
    elastic: float = declare.number(
        RATIO, "what is not known of the peak by what the lowest mode does in the pulse's own band, over it"
    )
    widening: float = declare.number(RATIO, "what the filter adds to the width of a pulse, over it")
    wave_energy: float = declare.number(
        RATIO,
        "integral of the square of the wave part (what the filter takes off the record, less what it takes off the "
        "pulse) over that of the record, from the begin of the blow on",
    )

    @declare.computed(declare.word("whether the low-pass separates pulse and ringing"))
    def separable(self) -> bool:
        """True if the bands lie so far apart that the rigid part can be separated."""
        return self.peak_uncertainty <= UNKNOWN * abs(self.peak)

    @declare.computed(declare.word("why it does not"))
    def reason(self) -> str:
        """Reason why the rigid part cannot be separated; empty where it can."""
        if self.separable:
            return ""
        parts = {
            "the filter changes pulses of different shape differently": self.loss_uncertainty,
            "the filter leaves too much of the wave part": self.leak,
            "the lowest mode moves in the band of the pulse": self.elastic,
        }
        most = max(parts, key=lambda name: parts[name])
        return f"the bands of pulse and wave part overlap: {most} ({percent(parts[most], 0)} of the peak)"

    def signed(self, sign: float) -> BandSplit:
        """Return the split of a blow turned round for a sign of -1."""
        return replace(self, peak=sign * self.peak)


def split_bands(stretch: Stretch, frequency: float) -> BandSplit | None:
    """Split a positive blow that rings, near a frequency in Hz; None where the low-pass leaves no pulse."""
    values, step, begin, end, width, smooth, noise = stretch
    lowest = _lowest_mode(stretch, frequency)
    swing = _swing_in_blow(stretch, lowest)
    scale = max(smooth.peak, float(np.max(values[begin : end + 1])) - swing)
    cutoff = _best_cutoff(width * step, lowest, swing / scale, step)
    if not cutoff > 0.0:
        return None
    filter_ = Filter(cutoff)
    low = filter_.apply(values, step)
    top = begin + int(np.argmax(low[begin : end + 1]))
    if not low[top] > 0.0:
        return None
    filtered = measure_pulse(_only(low, top), step)
    members = _family_as_wide(cutoff * filtered.width)
    if members is None or not filtered.peak > 0.0:
        return None
    left, lengths, wider = members
    peaks, widths = filtered.peak / left, lengths / cutoff
    peak, own_width = float(np.mean(peaks)), float(np.mean(widths))
    spread = float(np.std(peaks)) / peak
    leak = swing * float(filter_.gain(lowest, step)) / peak
    elastic = ELASTIC / (2.0 * lowest * own_width / HALF_SINE_WIDTH) ** 2
    noisy = noise * math.sqrt(2.0 * cutoff * step) / peak
    at_foot = math.hypot(leak, noisy, ONSET * swing / peak * cutoff / lowest)
    slope = float(np.mean([member.width_slope() / member.width() for member in FAMILY]))
    wave = values - low
    pulse_lost = float(np.mean(1.0 - left)) * peak * math.sqrt(0.5)  # its root mean square, as a half-sine has it
    taken = float(np.sum(wave[begin:] ** 2)) - pulse_lost**2 * own_width / step
    return BandSplit(
        cutoff,
        lowest,
        peak,
        own_width,
        peak * math.hypot(spread, leak, elastic, noisy, OTHER_SHAPES[0]),
        own_width * math.hypot(float(np.std(widths)) / own_width, at_foot * slope, elastic, OTHER_SHAPES[1]),
        float(np.mean(1.0 - left)),
        spread,
        leak,
        elastic,
        float(np.mean(wider)),
        max(taken, 0.0) / float(np.sum(values[begin:] ** 2)),
    )


def _only(values: Array, top: int) -> Array:
    """Return the excursion around a place, nothing beside it."""
    first, last = (crossing(values, top, 0.0, side) for side in (-1, 1))
    alone = values.copy()
    if math.isfinite(first):
        alone[: math.floor(first)] = 0.0
    if math.isfinite(last):
        alone[math.ceil(last) + 1 :] = 0.0
    return alone


def _lowest_mode(stretch: Stretch, frequency: float) -> float:
    """Return the lowest frequency at which the record rings after its blow, Hz."""
    if not swings_after(stretch):
        return frequency
    after = stretch.values[stretch.end : round(stretch.end + RINGS_WITHIN * stretch.width)]
    frequencies, height = spectrum_after(after, stretch.step)
    peaks = np.flatnonzero((height[1:-1] > height[:-2]) & (height[1:-1] >= height[2:])) + 1
    lowest = OfRingingSought.LOWEST_RATIO / (stretch.width * stretch.step)
    high = [k for k in peaks if frequencies[k] >= lowest]
    noise = NOISES * stretch.noise * math.sqrt(0.375 * after.size)  # a Hann window has the mean square 3/8
    least = max(OTHER_MODES * max((height[k] for k in high), default=0.0), noise)
    return float(min((frequencies[k] for k in high if height[k] >= least), default=frequency))


def _swing_in_blow(stretch: Stretch, frequency: float) -> float:
    """Return how large the wave part is when the pulse has its peak: as after the blow, grown back by its decay."""
    values, step, _, end, width, smooth, _ = stretch
    if not swings_after(stretch):
        return math.sqrt(2.0) * smooth.misfit * smooth.peak
    period = max(round(1.0 / (frequency * step)), 2)
    after = values[end : round(end + RINGS_WITHIN * width)]
    first = float(np.max(np.abs(after[: max(period, 4)])))
    half = after.size // 2
    sizes = [math.sqrt(float(np.mean(part**2))) for part in (after[:half], after[half:])]
    rate = math.log(sizes[0] / sizes[1]) / half if min(sizes) > 0.0 else 0.0
    back = max(end - smooth.time / step, 0.0)
    return first * min(math.exp(max(rate, 0.0) * back), LARGEST_GROWTH)


def _best_cutoff(width: float, lowest: float, swing: float, step: float) -> float:
    """Return the cutoff at which spread of the family and leak of the wave part are least together, Hz; NaN for none.

    The pulse is taken to be as wide as the record, through the filter a half-sine of this width.
    """
    best, cost = math.nan, math.inf
    for cutoff in CUTOFFS * lowest:
        if cutoff > HIGHEST_CUTOFF / step:
            break
        members = _family_as_wide(_width_through(cutoff * width))
        if members is None:
            continue
        peaks = 1.0 / members[0]
        both = math.hypot(float(np.std(peaks) / np.mean(peaks)), swing * float(Filter(cutoff).gain(lowest, step)))
        if both < cost:
            best, cost = float(cutoff), both
    return best


def _family_as_wide(width: float) -> tuple[Array, Array, Array] | None:
    """Return what a filter leaves of the family that comes out of it as wide, over one over its cutoff.

    Shares of the peak, widths before the filter over one over its cutoff, shares added to the width; None where the
    width is that of the filter.
    """
    rows = []
    for member, (through, left) in zip(FAMILY, _tables(), strict=True):
        if width < NARROWER * through[0]:
            return None
        length = float(np.interp(width, through, LENGTHS))
        own = length * member.width()
        rows.append((float(np.interp(length, LENGTHS, left)), own, width / own - 1.0))
    left, own_widths, wider = np.array(rows).T
    return left, own_widths, wider


def _width_through(width: float) -> float:
    """Return the width of a half-sine after a filter, from that before it, both over one over its cutoff."""
    through, _ = _tables()[FAMILY.index(SmoothPulse(1.0, 0.0, 1.0, 0.5, 1.0))]
    return float(np.interp(width / HALF_SINE_WIDTH, LENGTHS, through))


@functools.cache
def _tables() -> tuple[tuple[Array, Array], ...]:
    """Return, for each of the family over `LENGTHS`, its width through a filter of cutoff 1, and the peak left."""
    filter_ = Filter(1.0)
    tables = []
    for member in FAMILY:
        rows = []
        for length in LENGTHS:
            step = min(length / SAMPLES, 1.0 / SAMPLES_OF_CUTOFF)
            count = math.ceil((length + 2.0 * REACH) / step)
            pulse = member._replace(begin=REACH, length=float(length)).at(step * np.arange(count))
            gain = filter_.gain(np.fft.rfftfreq(count, step), step)
            after = measure_pulse(np.fft.irfft(gain * np.fft.rfft(pulse), count), step)
            rows.append((after.width, after.peak))
        widths, peaks = np.array(rows).T
        tables.append((np.maximum.accumulate(widths), peaks))
    return tuple(tables)
