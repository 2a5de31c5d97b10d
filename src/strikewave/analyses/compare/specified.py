"""A specification as one side of a comparison: its ideal pulse as a history, and the verdict on the other side."""

from __future__ import annotations

import math

import numpy as np

from strikewave.analyses.compare.curve import ComparedCurve
from strikewave.base import declare
from strikewave.base.result import FAILED, WARNING, Notice
from strikewave.base.shock_quantities import MICROSECONDS
from strikewave.records.budget import Budget
from strikewave.reporting.clause_words import clause_words, decision_words
from strikewave.signal.alignment import EvenHistory
from strikewave.signal.filters import Filter, effect_on_half_sine
from strikewave.signal.pulse import HALF_SINE_WIDTH
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

PREFIX = "spec:"
"""Begin of the name of a specification."""
SAMPLES = 1000
"""Samples of the duration of an ideal pulse."""
BESIDE = (0.5, 1.0)
"""Durations before and after an ideal pulse without a band over which it is compared."""


@declare.dataclass
class SpecificationVerdict:
    """The verdict of a specification on a history.

    Attributes
    ----------
    limits : PulseLimits
        What that asks of a shock.
    found : ShockVerdict
        Clauses and place of the band.
    budget : Budget or None
        By which it was found.
    measured : bool
        Whether the history was: of a simulation no uncertainty is known.
    """

    specification: Specification = declare.part(Specification, "what it is judged by", inline=True)
    limits: PulseLimits
    found: ShockVerdict
    rule: Rule = declare.word("simple, or guarded by the expanded uncertainty", key="decision", default="simple")
    budget: Budget | None = None
    measured: bool = True
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
    """Return the ideal pulse of a specification as a history, time 0 where it begins.

    Raises
    ------
    InputError
        If there is no such specification, or it is one of a spectrum.

    Examples
    --------
    >>> curve, specification = specified_curve("B", "spec:jesd22-b110:B")
    >>> curve.name, round(curve.pulse.peak / 9.80665), specification.asked
    ('spec:jesd22-b110:B', 1500, 'jesd22-b110:B')
    """
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
