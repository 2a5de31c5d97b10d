"""Limits of a comparison: how one is typed, and whether what came out keeps it."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Annotated, Any

from strikewave.analyses.clauses import tag_of
from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, MORE, NOT_MEASURED
from strikewave.base.errors import InputError, nearest
from strikewave.base.result import FAILED, Notice
from strikewave.base.shock_quantities import MICROSECONDS
from strikewave.base.texts import NO_DOUBT, sign_needed
from strikewave.base.units import parse_quantity, typed_number
from strikewave.reporting.numbers import axis_unit, doubted
from strikewave.reporting.options import OptionGroup, WithBand, bare_number, quantity
from strikewave.reporting.parts import written
from strikewave.specifications.judging import CANNOT_TELL, FAIL, PASS, together

RELATIONS = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge}
# Metrics that a limit can be set for: unit ("1": a score of at most 1) and meaning. Differences count as sizes
METRICS = {
    "peak": ("%", "difference of the peaks, as a share"),
    "width": ("%", "difference of the pulse widths at 10 %, as a share"),
    "velocity_change": ("%", "difference of the velocity changes, as a share"),
    "impulse": ("%", "difference of the impulses, as a share"),
    "rms": ("%", "RMS of the difference over that of A"),
    "correlation": ("1", "correlation coefficient"),
    "srs": ("dB", "largest ratio of the shock response spectra, either way"),
    "iso18571": ("1", "overall rating of ISO/TS 18571"),
    "iso18571.corridor": ("1", "corridor score"),
    "iso18571.phase": ("1", "phase score"),
    "iso18571.magnitude": ("1", "magnitude score"),
    "iso18571.slope": ("1", "slope score"),
    "shift": ("s", "shift that aligns the two, either way"),
    "inside": ("%", "share of the time within the corridor of a campaign"),
}
# Examples of the number of a limit, by unit: what a bare 5 means, of a difference or a spectrum, would be a guess
EXAMPLES = {"%": 'a share with its sign, such as "5 %"', "dB": 'a level with its unit, such as "3 dB"'}
_LIMIT = re.compile(r"\s*([\w.\-]+)\s*(<=|>=|<|>)\s*(\S.*?)\s*")


DEVIATIONS = 2.0  # standard deviations of a campaign that its corridor is wide to either side: 95 % of normal records


@dataclass(frozen=True)
class Scoring(OptionGroup):
    """Over which interval and against which corridor and band two histories are scored.

    Attributes
    ----------
    deviations : float
        Half width of the corridor of a campaign, in its standard deviations; 2 by default.
    begin, end : str or float
        Interval in which they are judged, in the time of A: with a unit, or in s; both pulses by default.
    band : bool
        True, which is the default, to find the bands of a case that is run.

    Examples
    --------
    >>> import strikewave
    >>> strikewave.Scoring(begin="1 ms", end="3 ms").end
    0.003
    """

    deviations: Annotated[
        Any,
        bare_number("--deviations", help="Half width of a campaign's corridor in standard deviations; 2 by default."),
    ] = DEVIATIONS
    begin: Annotated[
        Any,
        quantity("--from", si="s", signed=True, help="Begin of the interval that is judged; both pulses by default."),
    ] = None
    end: Annotated[
        Any, quantity("--to", si="s", signed=True, help="End of the interval that is judged, in the time of A.")
    ] = None
    band: WithBand = True


@declare.dataclass
class ComparisonLimit:
    """A limit: of what, how, how much (SI), and as it was typed."""

    metric: str = declare.word("what is limited")
    relation: str
    value: float
    typed: str = declare.word("the limit as typed", key="limit", label="limit", column=KEY)


@declare.dataclass
class Judged:
    """A limit with what came out, and the verdict; ``doubt`` is the expanded uncertainty of that, 0 of none known."""

    limit: ComparisonLimit = declare.part(ComparisonLimit, "the limit", inline=True)
    value: float = declare.number(NOT_MEASURED, "what it comes to")
    margin: float = declare.number(NOT_MEASURED, "distance to the limit, below 0 beyond it")
    verdict: str = declare.word("pass, fail or cannot-tell")
    doubt: float = 0.0
    tag = declare.phrase("verdict", column=MAIN)(lambda one: tag_of(one.verdict))

    @declare.phrase("value ± U", column=MAIN)
    def value_words(self) -> str | None:
        """Return what it comes to, with its expanded uncertainty where that is known."""
        if not (math.isfinite(self.value) and self.doubt > NO_DOUBT * abs(self.value)):
            return self._words(self.value)
        size, name = axis_unit(*MICROSECONDS.units) if self.unit == "s" else (0.01, self.unit)
        return f"{' ± '.join(doubted(self.value / size, self.doubt / size))} {name}"

    margin_words = declare.phrase("margin", column=MORE)(lambda one: one._words(one.margin))
    of = declare.phrase("of", column=MORE)(lambda one: METRICS[one.limit.metric][1])

    @property
    def unit(self) -> str:
        """Unit in which the limit is typed, "1" of a score."""
        return METRICS[self.limit.metric][0]

    def _words(self, value: float) -> str | None:
        if math.isnan(value):
            return None
        size, name = axis_unit(*MICROSECONDS.units)
        return f"{written(value / size)} {name}" if self.unit == "s" else value_words(value, self.unit)


def read_limit(word: str, field: str = "--limit") -> ComparisonLimit:
    """Return a limit that was typed."""
    match = _LIMIT.fullmatch(word)
    if match is None:
        example = 'a metric, one of < <= > >=, and a number, such as "iso18571 > 0.8"'
        raise InputError(field, word, example, f"metrics: {', '.join(METRICS)}")
    metric, relation, number = match.groups()
    metric = metric.replace("-", "_")
    if metric not in METRICS:
        raise InputError(field, word, "a metric that is computed: " + ", ".join(METRICS), _near(metric))
    high = METRICS[metric][0] == "1" or metric == "inside"
    if high != relation.startswith(">"):
        ways = ("> or >=", "high is good") if high else ("< or <=", "it is a size, and low is good")
        raise InputError(field, word, f"{ways[0]} of {metric}", ways[1])
    return ComparisonLimit(metric, relation, _number(number, METRICS[metric][0], word, field), " ".join(word.split()))


def _near(metric: str) -> str:
    """Return the metric that may be meant, if one is like it."""
    near = nearest(metric, METRICS)
    return near if near.startswith("did you mean") else ""


def _number(text: str, unit: str, word: str, field: str) -> float:
    """Return the number of a limit: with its unit, or bare where it is a score, which may have the sign of a share."""
    if unit == "s":
        return _not_negative(parse_quantity(text, "s", field), word, field)
    sign = "dB" if unit == "dB" else "%"
    bare, signed = typed_number(text), typed_number(text, sign)
    if bare is not None and unit != "1":
        raise InputError(field, word, EXAMPLES[unit], sign_needed(bare) if unit == "%" else "")
    if bare is None and signed is None:
        raise InputError(field, word, EXAMPLES.get(unit, "a number of at most 1, such as 0.8"))
    value = bare if bare is not None else 0.01 * (signed or 0.0) if sign == "%" else signed or 0.0
    if unit == "1" and value > 1.0:
        raise InputError(field, word, "a number of at most 1, such as 0.8", "it is a score, and 1 is the best")
    return value if unit == "1" else _not_negative(value, word, field)


def _not_negative(value: float, word: str, field: str) -> float:
    if value < 0.0:
        raise InputError(field, word, "a limit of at least 0", "differences count either way, as sizes")
    return value


def judge(
    limits: Sequence[ComparisonLimit], values: Mapping[str, float], expanded: Mapping[str, float] = MappingProxyType({})
) -> tuple[Judged, ...]:
    """Hold values against limits; what has no value has no verdict either. Some have an expanded uncertainty."""
    judged = []
    for limit in limits:
        value = values.get(limit.metric, math.nan)
        if not math.isfinite(value):
            judged.append(Judged(limit, value, math.nan, CANNOT_TELL))
            continue
        doubt, holds = expanded.get(limit.metric, 0.0), RELATIONS[limit.relation](value, limit.value)
        margin = limit.value - value if limit.relation.startswith("<") else value - limit.value
        judged.append(Judged(limit, value, margin, PASS if holds else FAIL, doubt))
    return tuple(judged)


def value_words(value: float, unit: str) -> str:
    """Write the value of a metric, in the unit that its limit is typed in; a time in us.

    Examples
    --------
    >>> value_words(0.0412, "%"), value_words(0.8312, "1")
    ('4.12 %', '0.8312')
    """
    if unit == "s":
        return f"{value * 1e6:.4g}\N{NO-BREAK SPACE}us"
    return f"{100.0 * value:.4g} %" if unit == "%" else f"{value:.4g} dB" if unit == "dB" else f"{value:.4g}"


def verdict_of(judged: Sequence[Judged]) -> str | None:
    """Return the worst of several verdicts; None without any limit.

    Examples
    --------
    >>> verdict_of(judge([read_limit("rms < 10 %")], {"rms": 0.2})), verdict_of([])
    ('fail', None)
    """
    return together(one.verdict for one in judged) if judged else None


def limit_notices(judged: Sequence[Judged]) -> tuple[Notice, ...]:
    """Return a failed check for each limit that is not kept, or that nothing can be said of.

    A limit that is kept by less than the expanded uncertainty, known for some metrics, is reported: a value decides.
    """
    notices = []
    for row in judged:
        if row.verdict == PASS:
            if row.margin < row.doubt:
                message = (
                    f"{row.limit.typed}: {value_words(row.value, row.unit)} passes by its value alone; its U (k = 2), "
                    f"{value_words(row.doubt, row.unit)}, reaches over the limit"
                )
                notices.append(Notice("limit-in-doubt", message, row.doubt))
            continue
        value = value_words(row.value, row.unit)
        outcome = f"is {value}" if row.verdict == FAIL else "has no value here, so there is no verdict"
        message = f"{row.limit.typed}: {row.of} {outcome}"
        notices.append(Notice(f"limit-{row.limit.metric}", message, row.value, severity=FAILED))
    return tuple(notices)
