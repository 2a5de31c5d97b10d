"""Butterworth filters: low-pass, causal as a recorder has them and zero-phase as records are smoothed; high-pass.

|H(f)|^2 = 1 / (1 + (W/W_c)^(2 n)) with W = tan(pi f dt), the frequency as the bilinear transform warps it,
cutoff W_c and order n. Second-order sections, so that low cutoffs keep their digits.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base.texts import frequency_text
from strikewave.signal.motion import integral
from strikewave.signal.pulse import HALF_SINE_RISE, HALF_SINE_WIDTH, measure_pulse

Array = NDArray[np.float64]

# Share of a response that may be left where padding ends: a thousand times rounding, and far below any record
SETTLED = 1e-13
MOST_POLES = 12  # poles of a filter, at most: recorders have 2 to 8. Chosen well above, so that only a slip is refused
# Cutoff of each pass over the channel class, and its poles: appendix C of SAE J211-1
SAE_J211_CUTOFF, SAE_J211_POLES = 2.0775, 2
# Samples of a half-sine on which a filter is tried, at least, the longest step as a share of one over the cutoff, and
# how many times one over the cutoff the history goes on to either side: peak and width are then good to 1e-6 (measured
# at five times the cutoff).
HALF_SINE_SAMPLES, CUTOFF_STEP, REACH = 400, 0.02, 3.0
# Share by which a filter may change a figure unless said otherwise, about what a calibrated chain is uncertain by; and
# the shares that can be asked for: a width stays off by 4e-3 at ten cutoffs, beyond a half the pulse is another one.
ADVISED_LOSS, LOSSES = 0.02, (5e-3, 0.5)
# Cutoffs of a half-sine of 1 s that are searched, Hz, how many of them at first, and how exactly: a cutoff is stated to
# three digits.
CUTOFFS, CUTOFFS_TRIED, CUTOFF_ROUNDING = (0.3, 20.0), 40, 1e-4
FEET = 0.02  # share of the peak from which on a pulse is integrated, as a record is measured


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


class _ZeroPhase:
    """A filter that is run forward, then back, so that it delays nothing."""

    def _one_way(self, step: float) -> Array:
        """Return the second-order sections of one pass."""
        raise NotImplementedError

    def apply(self, values: ArrayLike, step: float, axis: int = -1) -> Array:
        """Filter a history; outside, it is taken to hold its first and its last value.

        A pulse that starts from rest at its first sample stays as it is (mirrored padding would bend it).

        Parameters
        ----------
        values : array_like
            Evenly sampled history.
        step : float
            Time between samples, s.
        axis : int, optional
            Axis of time.

        Raises
        ------
        ValueError
            If the cutoff is not below half the sampling rate, or another value makes no sense.
        """
        from scipy import signal

        sections = self._one_way(step)
        history = np.moveaxis(_history(values), axis, -1)
        radius = float(np.max(np.abs(signal.sos2zpk(sections)[1])))
        length = math.ceil(math.log(SETTLED) / math.log(radius)) if radius > 0.0 else 1
        padded = np.pad(history, [(0, 0)] * (history.ndim - 1) + [(length, length)], mode="edge")
        for _ in range(2):  # forward, then back
            state = signal.sosfilt_zi(sections).reshape(-1, *(1,) * (history.ndim - 1), 2) * padded[..., :1]
            padded = signal.sosfilt(sections, padded, zi=state)[0][..., ::-1]
        return np.ascontiguousarray(np.moveaxis(padded[..., length : padded.shape[-1] - length], -1, axis))


@dataclass(frozen=True)
class Filter(_ZeroPhase):
    """A zero-phase Butterworth low-pass: run forward, then back, so that it delays nothing.

    Two passes square the response. ``convention`` says what the cutoff means: at ``both`` passes together lose
    3 dB there, or ``each`` of them does (6 dB together). The two differ by a factor 1.25 in cutoff at 2 poles.
    Each pass alone has its cutoff where W_c = tan(pi f_c dt), for ``both`` over (sqrt(2) - 1)^(1/(2 n)).

    Attributes
    ----------
    cutoff : float
        Frequency of -3 dB, Hz.
    order : int
        Poles of each pass, n.
    convention : str
        ``both`` or ``each``.
    name : str
        Name of the filter; empty for its numbers.

    Examples
    --------
    A half-sine of 100 us through 10 kHz, the two conventions:

    >>> t = np.arange(-100, 201) * 1e-6
    >>> pulse = np.where((t > 0) & (t < 100e-6), np.sin(np.pi * t / 100e-6), 0.0)
    >>> [round(float(Filter(10e3, 2, how).apply(pulse, 1e-6).max()), 3) for how in ("both", "each")]
    [0.951, 0.892]
    """

    cutoff: float
    order: int = 4
    convention: str = "both"
    name: str = ""

    def __post_init__(self) -> None:
        if self.convention not in ("both", "each"):
            raise ValueError(f'the convention of a filter is "both" or "each", got {self.convention!r}')

    @classmethod
    def sae_j211(cls, channel_class: float) -> Filter:
        """Return the filter of a channel frequency class: 2 poles, each pass -3 dB at 2.0775 times the class.

        CFC 60, 180, 600 and 1000 are the usual ones.

        Source: SAE J211-1, Instrumentation for impact test, part 1, appendix C.

        Examples
        --------
        >>> round(Filter.sae_j211(1000).half_power(1e-6))
        1667
        """
        return cls(SAE_J211_CUTOFF * channel_class, SAE_J211_POLES, "each", f"CFC {channel_class:g} (SAE J211)")

    def __str__(self) -> str:
        how = "for both passes together" if self.convention == "both" else "for each pass"
        return (
            self.name
            or f"zero-phase Butterworth, {self.order} poles a pass, -3 dB at {frequency_text(self.cutoff)} {how}"
        )

    def _one_way(self, step: float) -> Array:
        return _butterworth(self.cutoff, step, self.order, self._widened())

    def gain(self, frequency: ArrayLike, step: float) -> Array:
        """Return the gain of both passes: 1 / (1 + (W/W_c)^(2 n))."""
        warped = np.tan(np.pi * np.asarray(frequency, dtype=float) * step)
        corner = self._widened() * math.tan(math.pi * self.cutoff * step)
        return np.asarray(1.0 / (1.0 + (warped / corner) ** (2 * self.order)))

    def half_power(self, step: float) -> float:
        """Return the frequency at which both passes together lose 3 dB, Hz."""
        corner = self._widened() * math.tan(math.pi * self.cutoff * step)
        return math.atan(corner * (math.sqrt(2.0) - 1.0) ** (0.5 / self.order)) / (math.pi * step)

    def _widened(self) -> float:
        if self.convention == "each" or self.order < 1:
            return 1.0
        return float((math.sqrt(2.0) - 1.0) ** (-0.5 / self.order))


@dataclass(frozen=True)
class HighPass(_ZeroPhase):
    """A zero-phase Butterworth high-pass, which takes off what changes slowly: an offset becomes zero.

    Both passes together lose 3 dB at the cutoff. What it leaves of a one-sided pulse integrates to zero over the whole
    record: it undershoots before and after, and the velocity change falls with cutoff times width.

    Attributes
    ----------
    cutoff : float
        Frequency of -3 dB, Hz.
    order : int
        Poles of each pass, n: two, since more undershoot further.

    Examples
    --------
    >>> drifting = 3.0 + np.sin(2 * np.pi * 0.02 * np.arange(40000) * 1e-3)
    >>> float(np.abs(HighPass(5.0).apply(drifting, 1e-3)[5000:-5000]).max()) < 1e-6
    True
    """

    cutoff: float
    order: int = 2

    def __str__(self) -> str:
        return (
            f"zero-phase Butterworth high-pass, {self.order} poles a pass, -3 dB at {frequency_text(self.cutoff)} for "
            "both passes together"
        )

    def _one_way(self, step: float) -> Array:
        return _butterworth(self.cutoff, step, self.order, self._narrowed(), "highpass")

    def gain(self, frequency: ArrayLike, step: float) -> Array:
        """Return the gain of both passes: 1 / (1 + (W_c/W)^(2 n))."""
        power = np.tan(np.pi * np.asarray(frequency, dtype=float) * step) ** (2 * self.order)
        corner = (self._narrowed() * math.tan(math.pi * self.cutoff * step)) ** (2 * self.order)
        return np.asarray(power / (power + corner))

    def _narrowed(self) -> float:
        return float((math.sqrt(2.0) - 1.0) ** (0.5 / max(self.order, 1)))


class Effect(NamedTuple):
    """Shares of a pulse that a filter passes: of its peak, of its width at 10 %, and of its integral.

    The integral is taken from foot to foot, where 2 % of the peak is left: a filter moves the feet.
    """

    peak: float
    width: float
    velocity_change: float

    @property
    def largest(self) -> float:
        """Largest change of any of them."""
        return max(abs(share - 1.0) for share in self)


def effect_on_pulse(filter_: Filter, pulse: Array, step: float) -> Effect:
    """Return what a filter leaves of a pulse, given with enough zeros on both sides.

    Examples
    --------
    >>> pulse = np.pad(np.sin(np.pi * np.linspace(0.0, 1.0, 401)), 2000)
    >>> [round(share, 3) for share in effect_on_pulse(Filter(2.5 / 400.0), pulse, 1.0)]
    [0.997, 1.019, 1.004]
    """
    gain = filter_.gain(np.fft.rfftfreq(pulse.size, step), step)
    before, after = (
        (measured.peak, measured.width, measure_pulse(h, step, fraction=FEET).area)
        for h in (pulse, np.fft.irfft(gain * np.fft.rfft(pulse), pulse.size))
        for measured in [measure_pulse(h, step)]
    )
    return Effect(*(new / old for new, old in zip(after, before, strict=True)))


def effect_on_half_sine(filter_: Filter, duration: float, samples: int = HALF_SINE_SAMPLES) -> Effect:
    """Return what a filter leaves of a half-sine.

    Parameters
    ----------
    filter_ : Filter
        The filter.
    duration : float
        Duration of the half-sine, from zero to zero, s.
    samples : int, optional
        Steps in which it is computed.
    """
    step = min(duration / samples, CUTOFF_STEP / filter_.cutoff)
    count = round(duration / step)
    reach = count + math.ceil(REACH / (filter_.cutoff * step))
    places = np.arange(-reach, count + reach + 1)
    pulse = np.where((places > 0) & (places < count), np.sin(np.pi * places / count), 0.0)
    return effect_on_pulse(filter_, pulse, step)


def advised_cutoff(rise: float, width: float, loss: float = ADVISED_LOSS, peak_alone: bool = False) -> float:
    """Return the cutoff of a 4-pole zero-phase filter from which on it changes a pulse by at most ``loss``, Hz.

    Of peak, width and velocity change the one that it changes most counts: the width of a half-sine grows first.

    The pulse is taken as the half-sine that is as steep: of a half-sine of duration T, the rise from 10 to 90 %
    is (asin 0.9 - asin 0.1) T / pi and the width at 10 % is T (1 - 2 asin(0.1) / pi).

    Parameters
    ----------
    rise, width : float
        From 10 to 90 % of the peak, and at 10 % of it, s; NaN where it is not known.
    loss : float, optional
        Share by which peak, width and velocity change may change.
    peak_alone : bool, optional
        True if the peak alone counts.

    Raises
    ------
    ValueError
        If neither rise nor width is known, or the loss makes no sense.
    """
    durations = [duration for duration in (rise / HALF_SINE_RISE, width / HALF_SINE_WIDTH) if duration > 0.0]
    least, most = LOSSES
    if not least <= loss <= most:
        raise ValueError(f"the loss of a cutoff lies between {least:g} and {most:g}, got {loss!r}")
    if not durations:
        raise ValueError("a cutoff needs the rise or the width of the pulse")
    return _cutoff_times_duration(loss, peak_alone) / min(durations)


@functools.lru_cache(maxsize=32)
def _cutoff_times_duration(loss: float, peak_alone: bool) -> float:
    """Return the cutoff of a half-sine of 1 s, Hz."""
    from scipy.optimize import brentq

    def excess(cutoff: float) -> float:
        effect = effect_on_half_sine(Filter(cutoff), 1.0)
        return (1.0 - effect.peak if peak_alone else effect.largest) - loss

    tried = np.geomspace(*CUTOFFS, CUTOFFS_TRIED)
    last = max((k for k in range(CUTOFFS_TRIED - 1) if excess(float(tried[k])) > 0.0), default=0)
    return float(brentq(excess, float(tried[last]), float(tried[last + 1]), xtol=CUTOFF_ROUNDING))


def _butterworth(cutoff: float, step: float, order: int, widened: float = 1.0, kind: str = "lowpass") -> Array:
    """Return second-order sections; ``widened`` multiplies the cutoff on the warped scale."""
    if not 0.0 < step < math.inf:
        raise ValueError(f"the step must be above zero and finite, got {step!r}")
    if not (isinstance(order, int) and 1 <= order <= MOST_POLES):
        raise ValueError(f"the order of a filter must be a whole number from 1 to {MOST_POLES}, got {order!r}")
    if not 0.0 < cutoff < 0.5 / step:
        raise ValueError(
            f"the cutoff must lie above zero and below half the sampling rate, {frequency_text(0.5 / step)}, got "
            f"{frequency_text(cutoff)}: "
            "take a lower cutoff or a finer step"
        )
    return _sections(order, 2.0 / math.pi * math.atan(widened * math.tan(math.pi * cutoff * step)), kind)


@functools.lru_cache(maxsize=64)
def _sections(order: int, share: float, kind: str) -> Array:
    from scipy import signal

    return np.asarray(signal.butter(order, share, kind, output="sos"))


def _history(values: ArrayLike) -> Array:
    history = np.asarray(values, dtype=float)
    if history.ndim == 0 or history.size == 0:
        raise ValueError("a filter needs a history with samples")
    if not np.all(np.isfinite(history)):
        raise ValueError("the history holds values that are not finite")
    return history


def stated(values: Array, step: float, bandwidth: float) -> Array:
    """Return histories (rows) at a bandwidth; before the first sample they hold its value.

    Near the end the filter would need what comes after: the last 1/bandwidth, at most half of it all, is NaN.

    Raises
    ------
    ValueError
        If the bandwidth is not below half the sampling rate.
    """
    if math.isinf(bandwidth):
        return values
    filtered = Filter(bandwidth).apply(values, step)
    lost = min(math.ceil(1.0 / (bandwidth * step)), values.shape[-1] // 2)
    filtered[..., values.shape[-1] - lost :] = np.nan
    return filtered


def ac_coupled(values: Array, step: float, constant: float) -> Array:
    """Return what a high-pass of first order makes of a history that begins at rest.

    Parameters
    ----------
    values : ndarray
        Samples; straight lines between them.
    step, constant : float
        Time between samples, and time constant, s.
    """
    from scipy.signal import lfilter

    half = 0.5 * step / constant
    gain = 1.0 / (1.0 + half)
    return np.asarray(lfilter([gain, -gain], [1.0, -(1.0 - half) * gain], values - values[0]))


def ac_uncoupled(values: Array, step: float, constant: float) -> Array:
    """Return the history of which a high-pass of first order made the values: the inverse of `ac_coupled`.

    x = y + (1 / tau) int y dt, by trapezoids. What stands off zero before the shock drifts on, so that its baseline
    must be taken off before.

    Examples
    --------
    >>> pulse = np.sin(np.pi * np.linspace(0.0, 1.0, 100))
    >>> bool(np.allclose(ac_uncoupled(ac_coupled(pulse, 1e-5, 2e-3), 1e-5, 2e-3), pulse, atol=1e-12))
    True
    """
    return np.asarray(values + integral(values, step) / constant)
