"""Limits of a comparison: how one is typed, and whether what came out keeps it."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from strikewave.base.errors import InputError, nearest
from strikewave.base.result import FAILED, Notice
from strikewave.base.units import parse_quantity
from strikewave.specifications.decisions import CANNOT_TELL, FAIL, PASS, together

RELATIONS = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge}
METRICS = {
    "peak": ("1", "difference of the peaks, as a share"),
    "width": ("1", "difference of the pulse widths at 10 %, as a share"),
    "velocity_change": ("1", "difference of the velocity changes, as a share"),
    "impulse": ("1", "difference of the impulses, as a share"),
    "rms": ("1", "RMS of the difference over that of A"),
    "correlation": ("1", "correlation coefficient"),
    "srs": ("dB", "largest ratio of the shock response spectra, either way"),
    "iso18571": ("1", "overall rating of ISO/TS 18571"),
    "iso18571.corridor": ("1", "corridor score"),
    "iso18571.phase": ("1", "phase score"),
    "iso18571.magnitude": ("1", "magnitude score"),
    "iso18571.slope": ("1", "slope score"),
    "shift": ("s", "shift that aligns the two, either way"),
    "inside": ("1", "share of the time within the corridor of a campaign"),
}
"""What a limit can be of: its unit, and what it is. Differences count either way, as sizes."""
_LIMIT = re.compile(r"\s*([\w.\-]+)\s*(<=|>=|<|>)\s*(\S.*?)\s*")


class ComparisonLimit(NamedTuple):
    """A limit: of what, how, how much (SI), and as it was typed."""

    metric: str
    relation: str
    value: float
    typed: str


class Judged(NamedTuple):
    """A limit with what came out, by how much it is kept (missed, if below zero), and the verdict."""

    limit: ComparisonLimit
    value: float
    margin: float
    verdict: str


def read_limit(word: str, field: str = "--limit") -> ComparisonLimit:
    """Return a limit that was typed.

    Raises
    ------
    InputError
        If it names nothing that is computed, or holds no number.

    Examples
    --------
    >>> read_limit("iso18571 > 0.8")[:3], read_limit("shift < 2 us")[:3], read_limit("peak < 5 %")[:3]
    (('iso18571', '>', 0.8), ('shift', '<', 2e-06), ('peak', '<', 0.05))
    """
    found = _LIMIT.fullmatch(word)
    if found is None:
        raise InputError(field, word, 'a metric, one of < <= > >=, and a number, such as "iso18571 > 0.8"')
    metric, relation, number = found.groups()
    metric = metric.replace("-", "_")
    if metric not in METRICS:
        raise InputError(field, word, "a metric that is computed", nearest(metric, METRICS))
    return ComparisonLimit(metric, relation, _number(number, METRICS[metric][0], word, field), " ".join(word.split()))


def _number(text: str, unit: str, word: str, field: str) -> float:
    """Return the number of a limit: with its unit, or bare where it has none."""
    if unit == "s":
        return parse_quantity(text, "s", field)
    scale = 1.0
    if unit == "dB":
        text = re.sub(r"\s*dB$", "", text)
    elif text.endswith("%"):
        text, scale = text[:-1], 0.01
    try:
        value = scale * float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        allowed = "a number of dB, such as 3 dB" if unit == "dB" else "a number, such as 0.8, or a share, such as 5 %"
        raise InputError(field, word, allowed)
    return value


def judge(limits: Sequence[ComparisonLimit], values: Mapping[str, float]) -> tuple[Judged, ...]:
    """Hold values against limits; what has no value has no verdict either.

    Examples
    --------
    >>> judged = judge([read_limit("iso18571 > 0.8"), read_limit("inside > 95 %")], {"iso18571": 0.9})
    >>> [(one.verdict, round(one.margin, 3)) for one in judged]
    [('pass', 0.1), ('cannot-tell', nan)]
    """
    judged = []
    for limit in limits:
        value = values.get(limit.metric, math.nan)
        if not math.isfinite(value):
            judged.append(Judged(limit, value, math.nan, CANNOT_TELL))
            continue
        kept = RELATIONS[limit.relation](value, limit.value)
        margin = limit.value - value if limit.relation.startswith("<") else value - limit.value
        judged.append(Judged(limit, value, margin, PASS if kept else FAIL))
    return tuple(judged)


def verdict_of(judged: Sequence[Judged]) -> str | None:
    """Return the worst of several verdicts; None without any limit.

    Examples
    --------
    >>> verdict_of(judge([read_limit("rms < 10 %")], {"rms": 0.2})), verdict_of([])
    ('fail', None)
    """
    return together(one.verdict for one in judged) if judged else None


def limit_notices(judged: Sequence[Judged]) -> tuple[Notice, ...]:
    """Return a failed check for each limit that is not kept, or that nothing can be said of."""
    notices = []
    for one in judged:
        if one.verdict == PASS:
            continue
        message = f"{one.limit.typed}: {METRICS[one.limit.metric][1]} "
        message += f"is {one.value:.4g}" if one.verdict == FAIL else "has no value here, so there is no verdict"
        notices.append(Notice(f"limit-{one.limit.metric}", message, one.value, one.limit.value, FAILED))
    return tuple(notices)
