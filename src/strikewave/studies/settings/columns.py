"""The tables of settings, for screen and page: candidates, limits, masses of a striker."""

from __future__ import annotations

from strikewave.reporting.faces import columns_of
from strikewave.reporting.parts import Tag
from strikewave.reporting.table_columns import TableColumn
from strikewave.studies.settings.candidate import Limit, SettingsCandidate
from strikewave.studies.settings.search import VARIED


def candidate_columns(varied: str, table: str = "ranking") -> list[TableColumn[SettingsCandidate]]:
    """Return the columns of candidates, or of what the "mass" of a striker costs, without what was not varied."""
    return [column for column in columns_of(SettingsCandidate, table) if column.name not in set(VARIED) - {varied}]


def _limit_result(limit: Limit) -> Tag:
    return Tag("kept", "good") if limit.kept else Tag("broken", "bad") if limit.decides else Tag("warned", "warned")


LIMIT_COLUMNS: tuple[TableColumn[Limit], ...] = (
    *columns_of(Limit),
    TableColumn("result", _limit_result, words=True),
)
"""Limits of a candidate, each in its own unit."""
