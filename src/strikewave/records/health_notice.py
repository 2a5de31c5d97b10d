"""What is wrong with a record: what, where, how much, and which figures it harms."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from strikewave.base.result import INFO, WARNING, Notice

STATUSES = ("good", "suspect", "bad")
"""From best to worst."""
FIGURES = ("peak", "rise", "width", "velocity_change", "interval", "ringing_frequency", "spectrum")
"""What a notice can harm."""


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
    """

    code: str
    message: str
    value: float = float("nan")
    severity: str = "suspect"
    harms: tuple[str, ...] = ()
    start: float = float("nan")
    end: float = float("nan")

    @property
    def notice(self) -> Notice:
        """The notice of a result that takes its numbers from the record."""
        return Notice(self.code, self.message, self.value, severity=INFO if self.severity == "good" else WARNING)

    def health_document(self) -> dict[str, Any]:
        """Return the row of the JSON document under ``health``."""
        words = {"code": self.code, "message": self.message, "value": self.value, "severity": self.severity}
        return {**words, "harms": list(self.harms), "start": self.start, "end": self.end}


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


def unreadable(why: str) -> HealthNotice:
    """Return the notice of a file that could not be read."""
    return HealthNotice("unreadable", why, severity="bad", harms=FIGURES)
