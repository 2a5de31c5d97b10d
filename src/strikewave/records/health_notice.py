"""What is wrong with a record: what, where, how much, and which figures it harms."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import field
from math import nan

from strikewave.base import declare
from strikewave.base.declare import NOT_MEASURED
from strikewave.base.result import INFO, WARNING, Notice

STATUSES = ("good", "suspect", "bad")
"""From best to worst."""
FIGURES = ("peak", "rise", "width", "velocity_change", "interval", "ringing_frequency", "spectrum")
"""What a notice can harm."""
RESPONSE_FIGURES = ("peak", "ratio", "delay", "duration", "rms", "frequency", "damping")
"""What a notice on a response channel can harm."""
HARMED = 0.05
"""Estimated effect on a figure beyond which it is harmed: the usual uncertainty of a calibrated shock accelerometer."""
NO_EFFECT = 0.0005
"""Effects below which they are not worth a word."""


@declare.dataclass
class HealthNotice:
    """What was found on a record: how bad it is, which figures it harms, and where."""

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
    """Return the worst severity of several notices; ``good`` for none.

    Examples
    --------
    >>> worst([HealthNotice("offset", "", severity="good"), HealthNotice("clipped", "", severity="bad")])
    'bad'
    """
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


def unreadable(why: str) -> HealthNotice:
    """Return the notice of a file that could not be read."""
    return HealthNotice("unreadable", why, severity="bad", harms=FIGURES)
