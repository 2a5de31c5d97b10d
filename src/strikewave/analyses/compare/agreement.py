"""Two histories laid on one another, and how well they agree."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.compare.curve import FEWEST, OF_FILES, ComparedCurve
from strikewave.base import declare
from strikewave.base.constants import COVERAGE
from strikewave.base.declare import KEY, MAIN, NOT_MEASURED
from strikewave.base.errors import InputError
from strikewave.base.shock_quantities import OF_FIGURE, RATIO
from strikewave.base.texts import percent
from strikewave.reporting.numbers import headed, shown
from strikewave.reporting.parts import written
from strikewave.signal.alignment import EvenHistory, Shift, are_opposite, by_correlation, by_onset, by_peak
from strikewave.signal.interpolation import resampled, share_above
from strikewave.signal.iso18571 import SAMPLES, Rating, rate
from strikewave.signal.pulse import Pulse
from strikewave.signal.srs import QUALITY, octaves, srs

Array = NDArray[np.float64]

RULES = {"correlation": by_correlation, "onset": by_onset, "peak": by_peak}  # how two histories are aligned
# Widths of the longer pulse that the interval of evaluation goes on before both and after both: the foot of the pulses
# and what follows them at once, little enough that quiet samples do not raise the scores
BESIDE = 0.5
# Natural frequencies of the spectra, times the width of the pulse: below, a spectrum is the velocity change alone, and
# above, the peak alone
SLOW, FAST = 0.05, 20.0
OF_SAMPLING = 0.4  # share of the lower sampling rate up to which spectra go
FREQUENCIES = 12.0  # natural frequencies an octave
LOST = 0.01  # share of the RMS of one history above half the sampling rate of the other from which on it is reported
LEAST_SHOWN = 5e-5  # uncertainty of a difference from which on it is shown: 0.01 % rounded


@declare.dataclass
class PairOfFigures:
    """A figure of both histories, and by how much the second differs, as a share."""

    a: float = declare.number(NOT_MEASURED, "of the reference")
    b: float = declare.number(NOT_MEASURED, "of what is held against it")
    a_uncertainty: float = declare.number(OF_FIGURE, "standard uncertainty of the first", default=0.0)
    b_uncertainty: float = declare.number(OF_FIGURE, "standard uncertainty of the second", default=0.0)
    name: str = ""  # name of the figure
    units: tuple[str, str] = ("", "")  # SI unit of the figure, and the unit in which it is shown as a rule
    budgeted: tuple[bool, bool] = (False, False)  # true if the uncertainty is that of a budget: it is shown then

    @declare.computed(declare.number(RATIO, "b / a - 1"))
    def difference(self) -> float:
        """B / a - 1; NaN where there is none."""
        return self.b / self.a - 1.0 if self.a else math.nan

    @declare.computed(declare.number(RATIO, "standard uncertainty of the difference", key="difference_uncertainty"))
    def uncertainty(self) -> float:
        """Standard uncertainty of the difference, from those of both that are known."""
        if not (self.a and self.b):
            return math.nan
        shares = [u / v for u, v in ((self.a_uncertainty, self.a), (self.b_uncertainty, self.b)) if math.isfinite(u)]
        return abs(self.b / self.a) * math.hypot(*shares)

    head = declare.phrase("figure", column=KEY)(lambda pair: headed(pair.name, *pair.units))
    a_words = declare.phrase("A", column=MAIN)(
        lambda pair: pair._words(pair.a, pair.a_uncertainty if pair.budgeted[0] else 0.0)
    )
    b_words = declare.phrase("B", column=MAIN)(
        lambda pair: pair._words(pair.b, pair.b_uncertainty if pair.budgeted[1] else 0.0)
    )

    def _words(self, value: float, doubt: float) -> str | None:
        if math.isnan(value):
            return None
        numbers = ((value, 4), (COVERAGE * doubt, 2))
        text, more = [written(shown(v, *self.units) if self.units[0] else v, digits) for v, digits in numbers]
        return text if doubt == 0.0 else f"{text} ± {more if math.isfinite(doubt) else '?'}"

    @declare.phrase("difference", column=MAIN, headline="{name}")
    def difference_words(self) -> str | None:
        """Return the difference with its standard uncertainty, where one is known."""
        if not math.isfinite(self.difference):
            return None
        doubt = f" ± {percent(self.uncertainty, 2)}" if self.uncertainty >= LEAST_SHOWN else ""
        return percent(self.difference, 2, "+") + doubt


@declare.dataclass(eq=False)
class CurveAgreement:
    """Two histories laid on one another; documents have the histories of it.

    Attributes
    ----------
    shift : Shift
        Time that was added to the times of B.
    interval : (float, float)
        Begin and end of the interval in which they are judged, s.
    pulse_a, pulse_b : Pulse
        The largest pulse of each.
    rating : Rating
        Scores of ISO/TS 18571 over the interval.
    frequency, spectrum_a, spectrum_b : ndarray
        Natural frequencies and shock response spectra (absolute, maximax); empty for no acceleration.
    lost : float
        Share of the RMS of the more finely sampled history above half the sampling rate of the other.
    """

    time: Array = declare.history("s", "common time, that of a")
    a: Array = declare.history(OF_FILES, "the reference there")
    b: Array = declare.history(OF_FILES, "the other there, shifted")
    deviation: Array | None = declare.history(OF_FILES, "standard deviation of a campaign there")
    shift: Shift
    interval: tuple[float, float]
    pulse_a: Pulse
    pulse_b: Pulse
    rating: Rating
    frequency: Array
    spectrum_a: Array
    spectrum_b: Array
    lost: float

    @property
    def inside_interval(self) -> NDArray[np.bool_]:
        """Which samples lie in the interval."""
        return (self.time >= self.interval[0]) & (self.time <= self.interval[1])

    @property
    def rms(self) -> float:
        """Root mean square of the difference over the interval, as a share of that of A."""
        kept = self.inside_interval
        whole = float(np.sqrt(np.mean(self.a[kept] ** 2)))
        return float(np.sqrt(np.mean((self.b[kept] - self.a[kept]) ** 2))) / whole if whole else math.nan

    @property
    def correlation(self) -> float:
        """Sum of products over the root of the sums of squares, over the interval; baselines are zero."""
        a, b = self.a[self.inside_interval], self.b[self.inside_interval]
        size = math.sqrt(float(a @ a) * float(b @ b))
        return float(a @ b) / size if size else math.nan

    @property
    def ratio(self) -> Array:
        """Spectrum of B over that of A, dB."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(20.0 * np.log10(self.spectrum_b / self.spectrum_a))

    @property
    def largest_ratio(self) -> tuple[float, float]:
        """The ratio of the spectra that is largest in size, dB, and its natural frequency, Hz; NaN without spectra."""
        if not self.frequency.size:
            return math.nan, math.nan
        ratio = self.ratio
        at = int(np.nanargmax(np.abs(ratio)))
        return float(ratio[at]), float(self.frequency[at])

    def inside(self, factor: float) -> float:
        """Return the share of the interval in which the two differ by at most so many deviations; NaN without any."""
        if self.deviation is None:
            return math.nan
        kept = self.inside_interval
        return float(np.mean(np.abs(self.b[kept] - self.a[kept]) <= factor * self.deviation[kept]))


def agreement(
    a: ComparedCurve, b: ComparedCurve, align: str, between: tuple[float, float] | None = None
) -> CurveAgreement:
    """Lay B on A and return how well they agree.

    The common samples are those of the more finely sampled history, as they are; the other one is interpolated
    band-limited at their times. Without ``between``, they are judged over both pulses (at 10 % of their peaks) and
    half the longer width on either side, as far as both last.
    """
    shift = _shift(a, b, align)
    one, other = a.history, b.history._replace(start=b.history.start + shift.shift)
    begin, end = max(one.start, other.start), min(one.end, other.end)
    fine, coarse = (one, other) if one.step <= other.step * (1.0 + 1e-9) else (other, one)
    rounding = 1e-6 * fine.step
    kept = (fine.time >= begin - rounding) & (fine.time <= end + rounding)
    if np.count_nonzero(kept) < FEWEST:
        spans = f"A lasts from {one.start:.6g} s to {one.end:.6g} s, B from {other.start:.6g} s to {other.end:.6g} s"
        raise InputError("--align", align, "histories that overlap in time", f"{spans}; align them by correlation")
    time = fine.time[kept]
    places = np.clip((time - coarse.start) / coarse.step, 0.0, coarse.values.size - 1.0)
    found = {id(fine): fine.values[kept], id(coarse): resampled(coarse.values, places)}
    values_a, values_b = found[id(one)], found[id(other)]
    pulse_a, pulse_b = a.pulse, b.pulse
    pulse_b = pulse_b._replace(time=pulse_b.time + shift.shift)
    interval = _interval(time, values_a, values_b, (pulse_a, pulse_b)) if between is None else between
    inside = (time >= interval[0]) & (time <= interval[1])
    if np.count_nonzero(inside) < FEWEST:
        allowed = f"an interval within the common time, {time[0]:.6g} s to {time[-1]:.6g} s"
        raise InputError("--from", f"{interval[0]:g} s to {interval[1]:g} s", allowed)
    interval = max(interval[0], float(time[0])), min(interval[1], float(time[-1]))
    deviation = next((one.deviation for one in (a, b) if one.deviation is not None), None)
    if deviation is not None:
        owner = one if a.deviation is not None else other
        places = np.clip((time - owner.start) / owner.step, 0.0, deviation.size - 1.0)
        deviation = np.interp(places, np.arange(deviation.size), deviation)
    frequency, spectra = _spectra(a.unit, time, (values_a, values_b), pulse_a, coarse.step)
    return CurveAgreement(
        time,
        values_a,
        values_b,
        deviation,
        shift,
        interval,
        pulse_a,
        pulse_b,
        _rating(time, values_a, values_b, interval),
        frequency,
        *spectra,
        share_above(fine.values, fine.step, 0.5 / coarse.step) if coarse.step > fine.step * (1.0 + 1e-9) else 0.0,
    )


def _shift(a: ComparedCurve, b: ComparedCurve, align: str) -> Shift:
    """Return the shift by a rule, whatever the signs of the two."""
    if align == "none":
        return Shift(0.0, 0.0, "none")
    try:
        return RULES[align](a.history, _upright(a, b))
    except ValueError as error:
        raise InputError("--align", align, "a rule that fits both histories", str(error)) from None


def _upright(a: ComparedCurve, b: ComparedCurve) -> EvenHistory:
    """Return B with the sign of A, where the two are alike with opposite signs."""
    other = b.history
    return other._replace(values=-other.values) if are_opposite(a.history, other) else other


def shift_to_gap(a: ComparedCurve, b: ComparedCurve) -> Shift:
    """Return the shift by correlation up to the first frequency at which the two are not coherent."""
    return by_correlation(a.history, _upright(a, b), to_gap=True)


def _interval(time: Array, a: Array, b: Array, pulses: tuple[Pulse, Pulse]) -> tuple[float, float]:
    """Return begin and end of the interval: both pulses, and half the longer one on either side."""
    edges = []
    for values, pulse in zip((a, b), pulses, strict=True):
        index = int(np.argmin(np.abs(time - pulse.time)))
        upright = math.copysign(1.0, pulse.peak) * values
        below = upright <= 0.1 * abs(pulse.peak)
        before, after = np.flatnonzero(below[: index + 1]), np.flatnonzero(below[index:])
        edges.append(
            (
                float(time[before[-1]]) if before.size else float(time[0]),
                float(time[index + after[0]]) if after.size else float(time[-1]),
            )
        )
    longest = max(end - begin for begin, end in edges)
    begin, end = min(one[0] for one in edges), max(one[1] for one in edges)
    return begin - BESIDE * longest, end + BESIDE * longest


def _rating(time: Array, a: Array, b: Array, interval: tuple[float, float]) -> Rating:
    """Return the scores of ISO/TS 18571 over an interval, brought to as many samples as the standard is used with."""
    step = float(time[1] - time[0])
    places = (np.linspace(*interval, SAMPLES) - time[0]) / step
    factor = max((interval[1] - interval[0]) / step / (SAMPLES - 1), 1.0)
    places = np.clip(places, 0.0, time.size - 1.0)
    return rate(resampled(a, places, factor), resampled(b, places, factor))


def _spectra(
    unit: str, time: Array, values: tuple[Array, Array], pulse: Pulse, step: float
) -> tuple[Array, tuple[Array, Array]]:
    """Return natural frequencies and the spectra of both; empty for what is no acceleration."""
    nothing = np.empty(0)
    width = pulse.width if pulse.width > 0.0 else float(time[-1] - time[0])
    low, high = SLOW / width, min(FAST / width, OF_SAMPLING / step)
    if unit not in ("m/s^2", "") or not low < high:
        return nothing, (nothing, nothing)
    frequency = np.asarray(octaves(low, high, FREQUENCIES))
    fine = float(time[1] - time[0])
    first, second = (srs(one, fine, frequency, QUALITY).maximax for one in values)
    return frequency, (first, second)
