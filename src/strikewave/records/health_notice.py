"""Health notices of a record: fault, place, size and harmed figures; and the checks that find them, a row each."""

from __future__ import annotations

import string
from collections.abc import Callable, Iterable, Mapping
from dataclasses import field, replace
from math import nan
from typing import Any, NamedTuple

from strikewave.base import declare
from strikewave.base.declare import NOT_MEASURED
from strikewave.base.result import INFO, WARNING, Notice
from strikewave.base.texts import percent
from strikewave.records.thresholds import HARMED, NO_EFFECT

STATUSES = ("good", "suspect", "bad")  # from best to worst
# Figures that a notice can harm
FIGURES = ("peak", "rise", "width", "velocity_change", "interval", "ringing_frequency", "spectrum")
# Figures that a notice on a response channel can harm
RESPONSE_FIGURES = ("peak", "ratio", "delay", "duration", "rms", "frequency", "damping")
BLOW = ("peak", "rise", "width", "velocity_change")  # figures of a single blow
EVERY = ("every",)  # harms of a check that takes all figures, of a blow or of a response
OF_BLOWS, OF_RESPONSES, OF_BOTH = "blow", "response", "both"  # objects of a check


@declare.dataclass
class HealthNotice:
    """Finding on a record: severity, harmed figures and place."""

    code: str = declare.word("short name, such as clipped")
    message: str = declare.word("what, where and how much")
    value: float = declare.number(NOT_MEASURED, "the number that raised it, SI; null where there is none", default=nan)
    severity: str = declare.word(
        "good, worth knowing; suspect, some figures are harmed; bad, nothing should be averaged", default="suspect"
    )
    harms: tuple[str, ...] = declare.word("figures that are not to be trusted", default=())
    start: float = declare.number(NOT_MEASURED, "where in time, s; null where it is the whole record", default=nan)
    end: float = declare.number(NOT_MEASURED, "until when", default=nan)
    effects: tuple[tuple[str, float], ...] = field(default=())

    @property
    def notice(self) -> Notice:
        """The notice of a result that takes its numbers from the record."""
        return Notice(self.code, self.message, self.value, severity=INFO if self.severity == "good" else WARNING)

    @declare.computed(
        declare.word("by how much of itself it may falsify a figure; signed where it is known which way", key="effects")
    )
    def effect_by_figure(self) -> dict[str, float]:
        """The effects, by the names of their figures."""
        return dict(self.effects)


def worst(notices: Iterable[HealthNotice]) -> str:
    """Return the worst severity of several notices; ``good`` for none."""
    return max((notice.severity for notice in notices), key=STATUSES.index, default="good")


def worst_first(notices: Iterable[HealthNotice]) -> list[HealthNotice]:
    """Return notices by severity, the worst first, otherwise in their order."""
    return sorted(notices, key=lambda notice: -STATUSES.index(notice.severity))


def by_effect(
    code: str,
    message: str,
    value: float,
    effects: Mapping[str, float],
    signed: bool = True,
    doubt: Mapping[str, float] | None = None,
    start: float = float("nan"),
    end: float = float("nan"),
    figures: tuple[str, ...] = FIGURES,
) -> HealthNotice:
    """Return a notice that says what it does to each figure; those beyond `HARMED` are harmed, and it is suspect.

    A rise time, and the ratio to a base, are harmed with the peak that they depend on. What is not known of an effect,
    its ``doubt``, counts too.

    Examples
    --------
    >>> by_effect("hum", "hum of 50 Hz", 1.0, {"peak": 0.02, "velocity_change": 0.08}, signed=False).message
    'hum of 50 Hz: peak +-2.0 %, velocity change +-8.0 %'
    """
    sign = "+" if signed else ""
    parts = [
        f"{name.replace('_', ' ')} {'' if signed else '+-'}{100.0 * effect:{sign}.1f} %"
        for name, effect in effects.items()
        if abs(effect) >= NO_EFFECT
    ]
    harms = [name for name, effect in effects.items() if abs(effect) + (doubt or {}).get(name, 0.0) > HARMED]
    if "peak" in harms or "width" in harms:
        harms.append("rise")
    if "peak" in harms:
        harms.append("ratio")
    message = f"{message}: {', '.join(parts)}" if parts else message
    return HealthNotice(
        code,
        message,
        value,
        severity="suspect" if harms else "good",
        harms=tuple(name for name in figures if name in harms),
        start=start,
        end=end,
        effects=tuple((name, float(effect)) for name, effect in effects.items()),
    )


class Fault(NamedTuple):
    """Fault that a check finds, in numbers; its row of the table words it."""

    value: float  # the number that raised it, SI
    details: Mapping[str, Any] = {}  # other values that the message takes
    severity: str = ""  # that of the row, or of the effects, where it is empty
    harms: tuple[str, ...] = ()  # figures beside those of the row and of the effects
    # Where in time, s; NaN where it is the whole record
    start: float = nan
    end: float = nan
    # By how much of itself it may falsify each figure: then it is suspect where it harms one, and else good
    effects: Mapping[str, float] | None = None
    signed: bool = True  # True if the sign of the effects is known
    doubt: Mapping[str, float] | None = None  # uncertainty of the effects, by figure
    message: str = ""  # in place of that of the row


class Check(NamedTuple):
    """A row of the table of checks."""

    name: str  # code of what it finds
    severity: str  # the worst that it finds; see `Fault`
    of: str  # object that it looks at: the blows of a record, a response, or both
    find: Callable[[Any], Iterable[Fault]]  # finds the faults of a record
    # Message on what is found, as `str.format` takes it. ``:unit`` writes a number with the unit of the record, ``:%1``
    # in per cent with one decimal
    message: str
    harms: tuple[str, ...] = ()  # figures that are not to be trusted, whatever is found
    ends: bool = False  # True if nothing else is looked for where it finds something

    def notices(self, record: Any) -> list[HealthNotice]:
        """Return what it finds on a record, in words."""
        return [self._notice(record, fault) for fault in self.find(record)]

    def _notice(self, record: Any, fault: Fault) -> HealthNotice:
        message = _Wording(record).format(fault.message or self.message, value=fault.value, **fault.details)
        harms = {*self.harms, *fault.harms}
        if fault.effects is None:
            chosen = record.figures if {*EVERY} <= harms else tuple(name for name in record.figures if name in harms)
            severity = fault.severity or self.severity
            return HealthNotice(self.name, message, fault.value, severity, chosen, fault.start, fault.end)
        place = {"start": fault.start, "end": fault.end, "figures": record.figures}
        notice = by_effect(self.name, message, fault.value, fault.effects, fault.signed, fault.doubt, **place)
        only_timing = set(notice.harms) <= set(record.jumping)  # withheld, and nothing is suspect for it
        return replace(
            notice,
            severity=fault.severity or ("good" if only_timing else notice.severity),
            harms=tuple(name for name in record.figures if name in harms or name in notice.harms),
        )


class _Wording(string.Formatter):
    """Writes the numbers of a message."""

    def __init__(self, record: Any) -> None:
        self.record = record

    def format_field(self, value: Any, spec: str) -> str:
        """Write a number with the unit of its record, in per cent, or as Python does."""
        if spec == "unit":
            return str(self.record.text(value))
        return percent(value, int(spec[1:])) if spec.startswith("%") else str(super().format_field(value, spec))


def unreadable(why: str) -> HealthNotice:
    """Return the notice of a file that could not be read."""
    return HealthNotice("unreadable", why, severity="bad", harms=FIGURES)
