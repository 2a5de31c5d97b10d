"""The columns of the tables of settings, for screen and page: candidates, limits, masses of a striker."""

from __future__ import annotations

from typing import NamedTuple

from strikewave.reporting.layout import KEY, MAIN, MORE
from strikewave.reporting.numbers import shown, spelled
from strikewave.reporting.parts import NONE, Tag, written
from strikewave.reporting.shown_units import shown_unit
from strikewave.reporting.table_columns import TableColumn
from strikewave.studies.settings.candidate import Limit, SettingsCandidate
from strikewave.studies.settings.estimate import engagement_sensitivity
from strikewave.studies.settings.search import VARIED

LIMIT_UNITS = {"Pa": "MPa", "m": "mm", "N": "kN", "m/s": "m/s", "N m": "N m"}
"""Usual units of limits; shares and errors are shown as they are."""


class RankedSettings(NamedTuple):
    """A candidate with its place, from 1."""

    place: int
    candidate: SettingsCandidate

    def value(self, path: str) -> float:
        """Return a quantity of its case, SI."""
        return self.candidate.case.values()[path].si


def candidate_columns(varied: str) -> tuple[TableColumn[RankedSettings], ...]:
    """Return the columns of the table of candidates, of which one gives the stiffness of what was varied."""

    def setting(
        name: str, path: str, si: str, usual: str, digits: int = 4, priority: int = MORE + 1
    ) -> TableColumn[RankedSettings]:
        return TableColumn(name, lambda row: row.value(path), si, usual, digits, priority=priority)

    return (
        TableColumn("#", lambda row: str(row.place), priority=KEY),
        TableColumn("strikers", lambda row: f"{row.value('machine.strikers'):.0f}"),
        setting("speed", "machine.speed", "rad/s", "rpm", priority=MAIN),
        setting("engagement", "machine.engagement", "m", "mm", 3, MAIN),
        setting(varied, VARIED[varied][0], "N/m", "MN/m", 3, MAIN),
        setting("striker", "striker.mass", "kg", "kg"),
        setting("spring", "object.spring", "N/m", "kN/m", 3),
        setting("preload", "object.preload", "N", "N", 3),
        setting("damper", "object.damper", "N s/m", "N s/m", 3),
        TableColumn("peak", lambda row: row.candidate.observation.peak.typical, "m/s^2", "g"),
        TableColumn("CV (%)", lambda row: 100.0 * row.candidate.observation.peak.variation, decimals=2, priority=MORE),
        TableColumn("width at 10 %", lambda row: row.candidate.observation.width.typical, "s", "us", decimals=1),
        TableColumn(
            "interval", lambda row: row.candidate.observation.interval.typical, "s", "ms", decimals=3, priority=MORE
        ),
        TableColumn("stop", lambda row: row.candidate.observation.supply.stop_force, "N", "kN", 3, priority=MORE),
        TableColumn(
            "largest displacement",
            lambda row: row.candidate.observation.largest_displacement,
            "m",
            "mm",
            3,
            priority=MORE,
        ),
        TableColumn("0.1 mm (%)", _sensitivity, decimals=1, priority=MORE),
        TableColumn("meets", lambda row: _yes(row.candidate.meets), words=True),
        TableColumn("verdict of the run", lambda row: row.candidate.run_verdict or NONE, words=True, priority=MAIN),
    )


def _sensitivity(row: RankedSettings) -> float:
    """Return the change of the peak with 0.1 mm of engagement, %."""
    return 1e-2 * engagement_sensitivity(row.value("machine.engagement"), row.value("machine.radius"))


def _yes(true: bool) -> Tag:
    return Tag("yes", "good") if true else Tag("no", "bad")


def mass_columns(varied: str) -> tuple[TableColumn[SettingsCandidate], ...]:
    """Return the columns of the table of what the mass of a striker costs."""
    return (
        TableColumn("striker", lambda one: one.case.values()["striker.mass"].si, "kg", "kg", priority=KEY),
        TableColumn("engagement", lambda one: one.case.values()["machine.engagement"].si, "m", "mm"),
        TableColumn(varied, lambda one: one.case.values()[VARIED[varied][0]].si, "N/m", "MN/m"),
        TableColumn("contact", lambda one: one.observation.peak_force, "N", "kN", 3),
        TableColumn("lost a blow", lambda one: one.observation.supply.speed_lost, "rad/s", "rpm", 3),
    )


def _shown_limit(limit: Limit, value: float) -> str:
    usual = LIMIT_UNITS.get(limit.unit)
    return written(value if usual is None else shown(value, limit.unit, usual), 3)


def _limit_unit(limit: Limit) -> str:
    usual = LIMIT_UNITS.get(limit.unit)
    return "1" if usual is None else spelled(shown_unit(limit.unit, usual))


def _limit_result(limit: Limit) -> Tag:
    return Tag("kept", "good") if limit.kept else Tag("broken", "bad") if limit.decides else Tag("warned", "warned")


LIMIT_COLUMNS: tuple[TableColumn[Limit], ...] = (
    TableColumn("limit", lambda limit: limit.name.replace("_", " "), priority=KEY, words=True),
    TableColumn("value", lambda limit: _shown_limit(limit, limit.value)),
    TableColumn("at most", lambda limit: _shown_limit(limit, limit.limit)),
    TableColumn("unit", _limit_unit, words=True),
    TableColumn("result", _limit_result, words=True),
)
"""Limits of a candidate, each in its own unit."""
