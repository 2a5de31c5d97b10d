"""What is wrong with a record: what, where, how much, and which figures it harms."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

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


@dataclass(frozen=True)
class HealthNotice:
    """What was found on a record: how bad it is, which figures it harms, and where.

    Attributes
    ----------
    code : str
        Short name, such as ``clipped``.
    message : str
        What, where and how much.
    value : float
        The number that raised it, SI; NaN where there is none.
    severity : str
        ``good`` (worth knowing), ``suspect`` (some figures are harmed) or ``bad`` (nothing should be averaged).
    harms : tuple of str
        Names of `FIGURES` that are not to be trusted.
    start, end : float
        Where in time, s; NaN where it is the whole record.
    effects : tuple of (str, float)
        By how much of itself it may falsify a figure, estimated from the record: signed where it is known which way.
    """

    code: str
    message: str
    value: float = float("nan")
    severity: str = "suspect"
    harms: tuple[str, ...] = ()
    start: float = float("nan")
    end: float = float("nan")
    effects: tuple[tuple[str, float], ...] = ()

    @property
    def notice(self) -> Notice:
        """The notice of a result that takes its numbers from the record."""
        return Notice(self.code, self.message, self.value, severity=INFO if self.severity == "good" else WARNING)

    def health_document(self) -> dict[str, Any]:
        """Return the row of the JSON document under ``health``."""
        words = {"code": self.code, "message": self.message, "value": self.value, "severity": self.severity}
        where = {"harms": list(self.harms), "start": self.start, "end": self.end}
        return {**words, **where, "effects": dict(self.effects)}


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
