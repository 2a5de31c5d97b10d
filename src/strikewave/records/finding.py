"""What is wrong with a record: what, where, how much, and which figures it harms."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

STATUSES = ("good", "suspect", "bad")
"""From best to worst."""
FIGURES = ("peak", "rise", "width", "velocity_change", "interval", "ringing_frequency", "spectrum")
"""What a finding can harm."""


class Finding(NamedTuple):
    """One thing that is wrong, or worth a word.

    Attributes
    ----------
    code : str
        Short name, such as ``clipped``.
    message : str
        What, where and how much, and what to do.
    value : float
        How much, in SI; NaN where there is no number.
    severity : str
        ``good`` (worth a word), ``suspect`` (some figures are harmed) or ``bad`` (nothing should be averaged).
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


def worst(findings: Iterable[Finding]) -> str:
    """Return the worst severity of several findings; ``good`` for none.

    Examples
    --------
    >>> worst([Finding("offset", "", severity="good"), Finding("clipped", "", severity="bad")])
    'bad'
    """
    return max((finding.severity for finding in findings), key=STATUSES.index, default="good")


def worst_first(findings: Iterable[Finding]) -> list[Finding]:
    """Return findings by severity, the worst first, otherwise in their order."""
    return sorted(findings, key=lambda finding: -STATUSES.index(finding.severity))


def unreadable(why: str) -> Finding:
    """Return the finding of a file that could not be read."""
    return Finding("unreadable", why, severity="bad", harms=FIGURES)
