"""Histories that are compared, the ideal pulse of a specification among them, and how well two agree."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import field

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.clauses import clause_words, decision_words
from strikewave.base import declare
from strikewave.base.constants import COVERAGE
from strikewave.base.declare import KEY, MAIN, MORE, NOT_MEASURED, Quantity
from strikewave.base.errors import InputError
from strikewave.base.result import FAILED, WARNING, Band, Notice
from strikewave.base.shock_quantities import MICROSECONDS, OF_FIGURE, RATIO
from strikewave.base.texts import frequency_text, percent
from strikewave.records.budget import Budget
from strikewave.reporting.numbers import headed, shown
from strikewave.reporting.parts import written
from strikewave.signal.alignment import EvenHistory, Shift, are_opposite, by_correlation, by_onset, by_peak
from strikewave.signal.filters import Filter, effect_on_half_sine
from strikewave.signal.interpolation import resampled, share_above
from strikewave.signal.iso18571 import SAMPLES, Rating, rate
from strikewave.signal.pulse import HALF_SINE_WIDTH, Pulse, foot_to_foot, measure_pulse
from strikewave.signal.srs import QUALITY, octaves, srs
from strikewave.specifications.judged_records import (
    BY_INDICATIVE,
    HOLDS,
    NOT_STATED,
    SHARE,
    VERDICT,
    Asked,
    filter_leaves,
    rests_on_indicative,
)
from strikewave.specifications.judging import (
    CANNOT_TELL,
    FAIL,
    Clause,
    MeasuredFigure,
    PulseLimits,
    Rule,
    Shock,
    ShockVerdict,
    judge_shock,
)
from strikewave.specifications.reading import Specification, load_specification

Array = NDArray[np.float64]

FEWEST = 8  # samples of a history, at least: fewer are no pulse
# Figures of a pulse that are compared, and what `Pulse` calls them
FIGURES = {"peak": "peak", "width": "width", "integral": "area"}
# Name of the quantity by its SI unit
QUANTITIES = {"m/s^2": "acceleration", "N": "force", "m/s": "velocity", "m": "displacement", "Pa": "stress"}
# Quantity of both histories, see `strikewave.analyses.compare.result.CompareResult.given_units`
OF_FILES = Quantity.of_data("the files' own numbers")
OF_NOISE = OF_FILES._replace(label="noise (standard deviation)", digits=3)


@declare.dataclass(eq=False)
class ComparedCurve:
    """A history, and what is known of it."""

    name: str = declare.word("what it is called: a is the reference, b what is held against it", column=MAIN)
    kind: str = declare.word("record, campaign, simulation or specification", column=MAIN)
    history: EvenHistory  # in SI; of a campaign the mean
    unit: str  # SI; empty where a file does not say it
    deviation: Array | None = None  # standard deviation of a campaign at each sample
    count: int = declare.count("histories that it is the mean of", default=1, label="histories", column=MORE)
    # Bands of its peak, width and velocity change in a simulation whose inputs move within what is known of them
    band: Mapping[str, Band] = field(default_factory=dict)
    # Its largest pulse as `strikewave record` measures it, noise taken into account; of a campaign the means. None for
    # what has no noise
    measured: Pulse | None = None
    # Standard uncertainty of its peak, width and velocity change (or impulse) from noise; of a campaign, that of the
    # mean from their scatter
    uncertainty: Mapping[str, float] = field(default_factory=dict)
    budgeted: bool = False  # true if the uncertainties are those of a budget
    # Why a figure is not to be trusted: by peak, width and velocity_change
    troubles: Mapping[str, str] = field(default_factory=dict)
    notices: tuple[Notice, ...] = ()  # notices to the user about it
    # Outcome of the checks of a simulation, `strikewave.base.result.Verdict.text`; empty for a measured history
    verdict: str = ""
    sampling_rate = declare.computed(
        declare.number(Quantity("Hz", "kHz", "sampling rate"), "samples a second", column=MAIN)
    )(lambda curve: 1.0 / curve.history.step)
    samples = declare.computed(declare.count("how many samples", column=MAIN, in_document=False))(
        lambda curve: curve.history.values.size
    )
    noise = declare.computed(declare.number(OF_NOISE, "standard deviation of a sample", column=MAIN))(
        lambda curve: curve.history.noise
    )

    @property
    def sign(self) -> float:
        """Sign of the largest magnitude."""
        values = self.history.values
        return math.copysign(1.0, float(values[int(np.argmax(np.abs(values)))]))

    @property
    def pulse(self) -> Pulse:
        """Largest pulse, with its sign: the width at 10 % of the peak, the integral from foot to foot."""
        if self.measured is not None:
            return self.measured
        upright, step = self.sign * self.history.values, self.history.step
        measured = measure_pulse(upright, step, self.history.start)
        return measured._replace(peak=self.sign * measured.peak, area=self.sign * foot_to_foot(upright, step))

    def filtered(self, low_pass: Filter | None) -> ComparedCurve:
        """Return it through a low-pass."""
        if low_pass is None:
            return self
        half = 0.5 / self.history.step
        if not low_pass.half_power(self.history.step) < half or not low_pass.cutoff < half:
            allowed = f"a cutoff below half the sampling rate of {self.name}, {frequency_text(half)}"
            raise InputError("--filter", frequency_text(low_pass.cutoff), allowed)
        values = low_pass.apply(self.history.values, self.history.step)
        return dataclasses.replace(self, history=self.history._replace(values=values))


def checked_curve(option: str, curve: ComparedCurve) -> ComparedCurve:
    """Return a curve that can be compared."""
    values = curve.history.values
    if values.size < FEWEST:
        raise InputError(option, f"{curve.name}, {values.size} samples", f"a history of {FEWEST} samples or more")
    if not np.all(np.isfinite(values)):
        missing = int(np.count_nonzero(~np.isfinite(values)))
        raise InputError(option, f"{curve.name}, {missing} samples that are no numbers", "a history of numbers")
    if not np.any(values):
        raise InputError(option, f"{curve.name}, zero throughout", "a history with a pulse")
    if not (curve.history.step > 0.0 and math.isfinite(curve.history.step)):
        raise InputError(option, f"{curve.name}, without time", "a history with a time column, or --rate")
    return curve


def even_history(time: Array, values: Array, noise: float = 0.0) -> EvenHistory:
    """Return samples at rising times as an evenly sampled history, by straight lines where their times are uneven."""
    known = np.isfinite(values) & np.isfinite(time)
    time, values = time[known], values[known]
    if time.size < 2:
        return EvenHistory(values, math.nan, float(time[0]) if time.size else 0.0, noise)
    step = float(time[-1] - time[0]) / (time.size - 1)
    grid = time[0] + step * np.arange(time.size)
    if np.max(np.abs(grid - time)) > EVEN * step:
        values = np.interp(grid, time, values)
    return EvenHistory(np.asarray(values, dtype=float), step, float(time[0]), noise)


# Steps by which times may differ from even ones and be taken as such: a thousandth of a sample shifts a pulse by far
# less than it can be aligned
EVEN = 1e-3


def mean_curve(option: str, name: str, curves: Sequence[ComparedCurve], shifts: Sequence[float]) -> ComparedCurve:
    """Return the mean and the deviations of curves shifted onto the first one, over the time that all have."""
    first = curves[0].history
    begin = max(curve.history.start + shift for curve, shift in zip(curves, shifts, strict=True))
    end = min(curve.history.end + shift for curve, shift in zip(curves, shifts, strict=True))
    grid = first.time[(first.time >= begin) & (first.time <= end)]
    if grid.size < FEWEST:
        raise InputError(option, name, "records that overlap in time once they are aligned")
    rows = []
    for curve, shift in zip(curves, shifts, strict=True):
        history = curve.history
        rows.append(
            resampled(
                history.values, np.clip((grid - shift - history.start) / history.step, 0.0, history.values.size - 1.0)
            )
        )
    values = np.mean(rows, axis=0)
    pulses = np.array([curve.pulse for curve in curves])
    moved = Pulse(*map(float, np.append(np.mean(pulses[:, 0] + np.asarray(shifts)), np.mean(pulses[:, 1:], axis=0))))
    figures = [[getattr(curve.pulse, name) for name in FIGURES.values()] for curve in curves]
    scatter = np.std(figures, axis=0, ddof=1) / math.sqrt(len(curves))
    budgeted = all(curve.budgeted for curve in curves)
    if budgeted:  # what a channel may have done is common to all of its records
        scatter = np.hypot(
            scatter, np.mean([[curve.uncertainty[name] for name in FIGURES] for curve in curves], axis=0)
        )
    noise = math.sqrt(float(np.mean([curve.history.noise**2 for curve in curves])) / len(curves))
    return ComparedCurve(
        name,
        "campaign",
        EvenHistory(values, first.step, float(grid[0]), noise),
        curves[0].unit,
        np.std(rows, axis=0, ddof=1),
        len(curves),
        measured=moved,
        uncertainty=dict(zip(FIGURES, scatter.tolist(), strict=True)),
        budgeted=budgeted,
        notices=tuple(dict.fromkeys(notice for curve in curves for notice in curve.notices)),
    )


PREFIX = "spec:"  # begin of the name of a specification
PULSE_SAMPLES = 1000  # samples of the duration of an ideal pulse
BESIDE_PULSE = (0.5, 1.0)  # durations before and after an ideal pulse without a band over which it is compared


@declare.dataclass
class SpecificationVerdict:
    """Verdict of a specification on a history."""

    specification: Specification = declare.part(Specification, "what it is judged by", inline=True)
    limits: PulseLimits  # limits that the specification sets for a shock
    found: ShockVerdict  # clauses and place of the band
    rule: Rule = declare.word("simple, or guarded by the expanded uncertainty", key="decision", default="simple")
    budget: Budget | None = None  # by which it was found
    measured: bool = True  # true if the history was measured: of a simulation no uncertainty is known
    share = declare.computed(SHARE)(lambda one: one.asked.share)
    holds = declare.computed(HOLDS)(lambda one: one.asked.holds if one.measured else ())
    not_stated = declare.computed(NOT_STATED)(lambda one: one.asked.not_stated if one.measured else ())
    verdict = declare.computed(VERDICT)(lambda one: one.found.verdict)
    by_indicative = declare.computed(BY_INDICATIVE)(lambda one: rests_on_indicative(one.found.clauses, one.verdict))
    start = declare.computed(declare.number(MICROSECONDS, "where the ideal pulse begins"))(lambda one: one.found.start)
    clauses = declare.computed(declare.rows(Clause, "its clauses"))(lambda one: one.found.clauses)

    @property
    def asked(self) -> Asked:
        """Decision rule and uncertainty of the verdict."""
        return Asked(self.rule, budget=self.budget)

    @property
    def decision(self) -> str:
        """Decision rule and uncertainty of the verdict, in words."""
        return decision_words(self.rule, self.holds, self.not_stated)


def specified_curve(option: str, word: str) -> tuple[ComparedCurve, Specification]:
    """Return the ideal pulse of a specification as a history, time 0 where it begins."""
    specification = load_specification(word.removeprefix(PREFIX), option)
    limits = specification.pulse_limits()
    pulse, band = limits.pulse, limits.band
    before, after = BESIDE_PULSE if band is None else (band.before, band.after)
    step = pulse.duration / PULSE_SAMPLES
    first, last = -math.ceil(before * PULSE_SAMPLES), math.ceil((1.0 + after) * PULSE_SAMPLES)
    values = pulse.at(step * np.arange(first, last + 1))
    history = EvenHistory(np.asarray(values, dtype=float), step, first * step)
    return ComparedCurve(f"{PREFIX}{specification.asked}", "specification", history, "m/s^2"), specification


def judged_by(
    specification: Specification,
    curve: ComparedCurve,
    low_pass: Filter | None,
    rule: Rule = "simple",
    budget: Budget | None = None,
) -> SpecificationVerdict:
    """Judge a history by a specification, as `strikewave record` judges a blow."""
    limits, history, pulse = specification.pulse_limits(), curve.history, curve.pulse
    doubt = curve.uncertainty
    figures = {}
    if curve.measured is not None:
        figures = {
            "peak": MeasuredFigure(abs(pulse.peak), doubt.get("peak", 0.0), curve.budgeted),
            "velocity_change": MeasuredFigure(abs(pulse.area), doubt.get("integral", 0.0), curve.budgeted),
        }
        if pulse.width > 0.0:
            figures["width"] = MeasuredFigure(pulse.width, doubt.get("width", 0.0), curve.budgeted)
    shock = Shock(
        curve.sign * history.values,
        history.step,
        history.start,
        min(max(round((pulse.time - history.start) / history.step), 0), history.values.size - 1),
        figures,
        1.0 if low_pass is None else filter_leaves(low_pass, limits.pulse, history.step),
        math.nan if low_pass is None else low_pass.half_power(history.step),
        dict(curve.troubles),
        filter_width=1.0
        if low_pass is None or not pulse.width > 0.0
        else effect_on_half_sine(low_pass, pulse.width / HALF_SINE_WIDTH).width,
    )
    verdict = judge_shock(shock, limits, rule)
    return SpecificationVerdict(specification, limits, verdict, rule, budget, curve.measured is not None)


def verdict_notices(judged: SpecificationVerdict) -> tuple[Notice, ...]:
    """Return a failed check for each clause that is not kept, and a warning for one of which nothing can be said."""
    notices = []
    for clause in judged.found.clauses:
        if clause.verdict in (FAIL, CANNOT_TELL):
            code = "spec-" + "-".join(clause.clause.split()[:2])
            severity = FAILED if clause.verdict == FAIL else WARNING
            ends = [end for end in (clause.low, clause.high) if math.isfinite(end)]
            limit = min(ends, key=lambda end: abs(end - clause.value), default=math.nan)
            notices.append(Notice(code, clause_words(clause), clause.value, limit, severity))
    return tuple(notices)


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
        """Mask of the samples in the interval."""
        return (self.time >= self.interval[0]) & (self.time <= self.interval[1])

    @property
    def rms(self) -> float:
        """Root mean square of the difference over the interval, as a share of that of A."""
        inside = self.inside_interval
        size = float(np.sqrt(np.mean(self.a[inside] ** 2)))
        return float(np.sqrt(np.mean((self.b[inside] - self.a[inside]) ** 2))) / size if size else math.nan

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
        """Largest ratio of the spectra either way, dB, and its natural frequency, Hz; NaN without spectra."""
        if not self.frequency.size:
            return math.nan, math.nan
        ratio = self.ratio
        at = int(np.nanargmax(np.abs(ratio)))
        return float(ratio[at]), float(self.frequency[at])

    def inside(self, factor: float) -> float:
        """Return the share of the interval in which the two differ by at most so many deviations; NaN without any."""
        if self.deviation is None:
            return math.nan
        within = self.inside_interval
        return float(np.mean(np.abs(self.b[within] - self.a[within]) <= factor * self.deviation[within]))


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
    common = (fine.time >= begin - rounding) & (fine.time <= end + rounding)
    if np.count_nonzero(common) < FEWEST:
        spans = f"A lasts from {one.start:.6g} s to {one.end:.6g} s, B from {other.start:.6g} s to {other.end:.6g} s"
        raise InputError("--align", align, "histories that overlap in time", f"{spans}; align them by correlation")
    time = fine.time[common]
    places = np.clip((time - coarse.start) / coarse.step, 0.0, coarse.values.size - 1.0)
    sampled = {id(fine): fine.values[common], id(coarse): resampled(coarse.values, places)}
    values_a, values_b = sampled[id(one)], sampled[id(other)]
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
    # As many samples as ISO/TS 18571 is used with
    step = float(time[1] - time[0])
    factor = max((interval[1] - interval[0]) / step / (SAMPLES - 1), 1.0)
    samples = np.clip((np.linspace(*interval, SAMPLES) - time[0]) / step, 0.0, time.size - 1.0)
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
        rate(resampled(values_a, samples, factor), resampled(values_b, samples, factor)),
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
