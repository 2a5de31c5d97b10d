"""The tables of a sweep, for screen and page: the range of each number, and the main effect of each setting."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from strikewave.reporting.layout import KEY, MORE
from strikewave.reporting.numbers import percent
from strikewave.reporting.parts import NONE
from strikewave.reporting.table_columns import TableColumn
from strikewave.studies.engine.case_evaluation import called
from strikewave.studies.sweep.study import KeptNumber, SweepStudy

MOST_EFFECTS = 12
"""Settings that a table of main effects names, those with the largest shares."""


class KeptNumberRow(NamedTuple):
    """A number over all runs."""

    study: SweepStudy
    number: KeptNumber

    def end(self, which: int) -> str:
        """Return its smallest (0) or largest (1) value."""
        ends = self.study.best(self.number.name)
        return NONE if ends is None else self.number.words(float(self.study.number(self.number.name)[ends[which]]))

    def place(self, which: int) -> str:
        """Return the settings of its smallest (0) or largest (1) value."""
        ends = self.study.best(self.number.name)
        return NONE if ends is None else self.study.at(ends[which])

    @property
    def median(self) -> str:
        """Its median over the runs that have it."""
        values = self.study.number(self.number.name)
        return NONE if np.isnan(values).all() else self.number.words(float(np.nanmedian(values)))


NUMBER_COLUMNS: tuple[TableColumn[KeptNumberRow], ...] = (
    TableColumn("number", lambda row: called(row.number.name), priority=KEY, words=True),
    TableColumn("smallest", lambda row: row.end(0)),
    TableColumn("median", lambda row: row.median),
    TableColumn("largest", lambda row: row.end(1)),
    TableColumn("smallest at", lambda row: row.place(0), priority=MORE, words=True),
    TableColumn("largest at", lambda row: row.place(1), priority=MORE, words=True),
)
"""What each number is over all runs."""


def number_rows(study: SweepStudy) -> list[KeptNumberRow]:
    """Return a row a number."""
    return [KeptNumberRow(study, one) for one in study.plan.kept]


class EffectRow(NamedTuple):
    """The main effect of a setting on a number."""

    path: str
    number: KeptNumber
    share: float
    chance: float
    low: float
    high: float

    @property
    def stands_out(self) -> bool:
        """Whether the share is beyond chance."""
        return self.share > self.chance


EFFECT_COLUMNS: tuple[TableColumn[EffectRow], ...] = (
    TableColumn("number", lambda row: called(row.number.name), priority=KEY, words=True),
    TableColumn("setting", lambda row: row.path, priority=KEY, words=True),
    TableColumn("share of the variance", lambda row: percent(row.share) if row.share == row.share else None),
    TableColumn("by chance below", lambda row: percent(row.chance) if row.chance else None),
    TableColumn("smallest mean", lambda row: row.number.words(row.low)),
    TableColumn("largest mean", lambda row: row.number.words(row.high)),
)
"""What each setting does to each number; of random runs with the share that 95 of 100 studies of settings that do
nothing stay below."""


def effect_rows(study: SweepStudy) -> list[EffectRow]:
    """Return a row a number and setting, the settings with the largest shares first."""
    rows = []
    for one in study.plan.kept:
        effects = study.effects.get(one.name, {})
        found = [
            EffectRow(
                path, one, effect.share, study.chance(effect), float(effect.means.min()), float(effect.means.max())
            )
            for path, effect in effects.items()
            if effect.means.size
        ]
        rows += sorted(found, key=lambda row: -np.nan_to_num(row.share, nan=-1.0))[:MOST_EFFECTS]
    return rows
