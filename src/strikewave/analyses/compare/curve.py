"""A history that is compared: evenly sampled, in SI, its baseline taken off; or the ideal pulse of a specification."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import field

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.clauses import clause_words, decision_words
from strikewave.base import declare
from strikewave.base.declare import MAIN, MORE, Quantity
from strikewave.base.errors import InputError
from strikewave.base.result import FAILED, WARNING, Band, Notice
from strikewave.base.shock_quantities import MICROSECONDS
from strikewave.base.texts import frequency_text
from strikewave.records.budget import Budget
from strikewave.signal.alignment import EvenHistory
from strikewave.signal.filters import Filter, effect_on_half_sine
from strikewave.signal.interpolation import resampled
from strikewave.signal.pulse import HALF_SINE_WIDTH, Pulse, foot_to_foot, measure_pulse
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
        """Its largest pulse, with its sign: the width at 10 % of the peak, the integral from foot to foot."""
        if self.measured is not None:
            return self.measured
        upright, step = self.sign * self.history.values, self.history.step
        found = measure_pulse(upright, step, self.history.start)
        return found._replace(peak=self.sign * found.peak, area=self.sign * foot_to_foot(upright, step))

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
    begin = max(one.history.start + shift for one, shift in zip(curves, shifts, strict=True))
    end = min(one.history.end + shift for one, shift in zip(curves, shifts, strict=True))
    grid = first.time[(first.time >= begin) & (first.time <= end)]
    if grid.size < FEWEST:
        raise InputError(option, name, "records that overlap in time once they are aligned")
    rows = []
    for one, shift in zip(curves, shifts, strict=True):
        history = one.history
        rows.append(
            resampled(
                history.values, np.clip((grid - shift - history.start) / history.step, 0.0, history.values.size - 1.0)
            )
        )
    values = np.mean(rows, axis=0)
    pulses = np.array([one.pulse for one in curves])
    moved = Pulse(*map(float, np.append(np.mean(pulses[:, 0] + np.asarray(shifts)), np.mean(pulses[:, 1:], axis=0))))
    figures = [[getattr(one.pulse, name) for name in FIGURES.values()] for one in curves]
    scatter = np.std(figures, axis=0, ddof=1) / math.sqrt(len(curves))
    budgeted = all(one.budgeted for one in curves)
    if budgeted:  # what a channel may have done is common to all of its records
        scatter = np.hypot(scatter, np.mean([[one.uncertainty[name] for name in FIGURES] for one in curves], axis=0))
    noise = math.sqrt(float(np.mean([one.history.noise**2 for one in curves])) / len(curves))
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
        notices=tuple(dict.fromkeys(notice for one in curves for notice in one.notices)),
    )


PREFIX = "spec:"  # begin of the name of a specification
SAMPLES = 1000  # samples of the duration of an ideal pulse
BESIDE = (0.5, 1.0)  # durations before and after an ideal pulse without a band over which it is compared


@declare.dataclass
class SpecificationVerdict:
    """The verdict of a specification on a history."""

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
        """How it was judged, and what its uncertainty holds."""
        return Asked(self.rule, budget=self.budget)

    @property
    def decision(self) -> str:
        """By which rule it was judged, and what its uncertainty holds, in words."""
        return decision_words(self.rule, self.holds, self.not_stated)


def specified_curve(option: str, word: str) -> tuple[ComparedCurve, Specification]:
    """Return the ideal pulse of a specification as a history, time 0 where it begins."""
    specification = load_specification(word.removeprefix(PREFIX), option)
    limits = specification.pulse_limits()
    pulse, band = limits.pulse, limits.band
    before, after = BESIDE if band is None else (band.before, band.after)
    step = pulse.duration / SAMPLES
    first, last = -math.ceil(before * SAMPLES), math.ceil((1.0 + after) * SAMPLES)
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
    found = judge_shock(shock, limits, rule)
    return SpecificationVerdict(specification, limits, found, rule, budget, curve.measured is not None)


def verdict_notices(judged: SpecificationVerdict) -> tuple[Notice, ...]:
    """Return a failed check for each clause that is not kept, and a warning for one of which nothing can be said."""
    notices = []
    for clause in judged.found.clauses:
        if clause.verdict in (FAIL, CANNOT_TELL):
            code = "spec-" + "-".join(clause.clause.split()[:2])
            severity = FAILED if clause.verdict == FAIL else WARNING
            notices.append(Notice(code, clause_words(clause), clause.value, _limit(clause), severity))
    return tuple(notices)


def _limit(clause: Clause) -> float:
    """Return the limit that is nearest to the value."""
    ends = [end for end in (clause.low, clause.high) if math.isfinite(end)]
    return min(ends, key=lambda end: abs(end - clause.value), default=math.nan)
