"""The columns of the tables of stacks, for screen and page."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from strikewave.reporting.layout import KEY, MAIN, MORE
from strikewave.reporting.parts import Tag
from strikewave.reporting.table_columns import TableColumn
from strikewave.studies.buffer.candidate import BufferCandidate, Leading


class RankedStack(NamedTuple):
    """A stack with its place in the rank, or what stands for it."""

    place: str
    candidate: BufferCandidate

    @property
    def leading(self) -> Leading | None:
        """What is known of it with other moduli; None of the sensor alone."""
        return self.candidate.leading if self.candidate.stack else None


def _cut(row: RankedStack) -> str:
    """Mark a reading that is cut off: what is shown is that of the element."""
    return "cut off" if row.candidate.clipped else ""


def _hertz(name: str, field: str, priority: int = MORE) -> TableColumn[RankedStack]:
    def value(row: RankedStack) -> float | None:
        frequency = float(getattr(row.candidate.band, field))
        return frequency if math.isfinite(frequency) else None

    return TableColumn(name, value, "Hz", "kHz", 3, priority=priority)


def _other(name: str, field: str, priority: int = MORE) -> TableColumn[RankedStack]:
    """Return the reading with other moduli."""
    return TableColumn(
        name,
        lambda row: None if row.leading is None else getattr(row.leading, field),
        "m/s^2",
        "g",
        priority=priority,
    )


def _robust(row: RankedStack) -> Tag | None:
    if row.leading is None or not row.candidate.keeps:
        return None
    return Tag("yes", "good") if row.leading.robust else Tag("no")


_NAMED: tuple[TableColumn[RankedStack], ...] = (
    TableColumn("#", lambda row: row.place, priority=KEY),
    TableColumn("stack, from the surface up", lambda row: row.candidate.name, words=True),
)
_CUT: TableColumn[RankedStack] = TableColumn("", _cut, words=True)
_READ: tuple[TableColumn[RankedStack], ...] = (
    TableColumn("reading", lambda row: row.candidate.true_peak, "m/s^2", "g", 5),
    _CUT,
    TableColumn("of the limit (%)", lambda row: 100.0 * (1.0 - row.candidate.margin), digits=3),
)
_WITHIN_10 = _hertz("within 10 % up to", "within_10", MAIN)
_RESONANCE = _hertz("resonance", "resonance")
_OTHER_MODULI = (_other("softer", "softer"), _other("stiffer", "stiffer", MAIN), _other("no slip", "confined"))
_ROBUST: TableColumn[RankedStack] = TableColumn("robust", _robust, words=True)

SCREEN_COLUMNS: tuple[TableColumn[RankedStack], ...] = (
    *_NAMED,
    *_READ,
    _hertz("within 5 % up to", "within_5"),
    _WITHIN_10,
    _hertz("-3 dB at", "half_power"),
    _RESONANCE,
    TableColumn("Q", lambda row: row.candidate.band.quality, digits=3, priority=MORE),
    *_OTHER_MODULI,
    _ROBUST,
)
"""Of the ranking on the screen: what no ranking depends on is left out first."""
RANK_COLUMNS: tuple[TableColumn[RankedStack], ...] = (
    *_NAMED,
    *_READ,
    _WITHIN_10,
    _RESONANCE,
    TableColumn("velocity change off by (%)", lambda row: 100.0 * row.candidate.velocity_error, digits=2),
    TableColumn("Pareto-optimal", lambda row: Tag("yes", "good") if row.candidate.pareto else None, words=True),
    _ROBUST,
)
"""Of the ranking on the page."""
MODULI_COLUMNS: tuple[TableColumn[RankedStack], ...] = (*_NAMED, *_OTHER_MODULI)
"""Of the readings with other moduli on the page."""


def needed(columns: Sequence[TableColumn[RankedStack]], rows: Sequence[RankedStack]) -> list[TableColumn[RankedStack]]:
    """Return the columns that say something of these stacks: which readings are cut off, only where one is."""
    cut = any(row.candidate.clipped for row in rows)
    return [column for column in columns if cut or column is not _CUT]
