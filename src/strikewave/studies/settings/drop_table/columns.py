"""The columns of the table of designs of a drop table, for screen and page."""

from __future__ import annotations

from typing import NamedTuple

from strikewave.reporting.clause_words import tag_of
from strikewave.reporting.layout import KEY, MAIN, MORE
from strikewave.reporting.parts import NONE, Tag
from strikewave.reporting.table_columns import TableColumn
from strikewave.studies.settings.drop_table.search import DropCandidate, HeightOfFall


class RankedDrop(NamedTuple):
    """A candidate with its place, from 1."""

    place: int
    one: DropCandidate


DROP_COLUMNS: tuple[TableColumn[RankedDrop], ...] = (
    TableColumn("#", lambda row: str(row.place), priority=KEY),
    TableColumn("programmer", lambda row: row.one.programmer.name, words=True),
    TableColumn("height", lambda row: row.one.height, "m", "mm", priority=MAIN),
    TableColumn("rebound (%)", lambda row: 100.0 * row.one.restitution, decimals=0, priority=MAIN),
    TableColumn("diameter", lambda row: row.one.diameter, "m", "mm", priority=MAIN),
    TableColumn("thickness", lambda row: row.one.thickness, "m", "mm", priority=MAIN),
    TableColumn("rate", lambda row: row.one.rate, "N/m", "MN/m", priority=MORE),
    TableColumn("table", lambda row: row.one.table_mass, "kg", "kg", priority=MORE),
    TableColumn("peak", lambda row: row.one.reading.peak, "m/s^2", "g"),
    TableColumn("width", lambda row: row.one.reading.width, "s", "ms"),
    TableColumn("velocity change", lambda row: row.one.velocity_change, "m/s", "m/s", priority=MORE),
    TableColumn("margin (%)", lambda row: 100.0 * row.one.margin, decimals=0, priority=MORE),
    TableColumn("departure (%)", lambda row: 100.0 * row.one.departure, decimals=1, priority=MORE),
    TableColumn("verdict", lambda row: tag_of(row.one.verdict.verdict), words=True, priority=MORE),
    TableColumn("meets", lambda row: Tag("yes", "good") if row.one.meets else Tag("no", "bad"), words=True),
    TableColumn("verdict of the run", lambda row: row.one.run_verdict or NONE, words=True, priority=MORE),
)
"""Designs, best first."""
HEIGHT_COLUMNS: tuple[TableColumn[HeightOfFall], ...] = (
    TableColumn("rebound (%)", lambda row: 100.0 * row.restitution, decimals=0, priority=KEY),
    TableColumn("height of a free fall", lambda row: row.height, "m", "mm"),
)
"""Heights of a free fall that give the velocity change of the goal."""
