"""The tables of a sweep, for screen and page: the range of each number, and the main effect of each setting."""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np

from strikewave.reporting.layout import KEY, MORE
from strikewave.reporting.numbers import percent, share_with_error, shown
from strikewave.reporting.parts import NONE, written
from strikewave.reporting.table_columns import TableColumn
from strikewave.studies.engine.case_evaluation import called
from strikewave.studies.sweep.study import KeptNumber, SweepStudy

MOST_RUN_ROWS = 100
"""Runs of a sweep over one setting that are printed: more are read in runs.csv, and in the picture."""
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


class RunRow(NamedTuple):
    """One run of a sweep over a single setting."""

    study: SweepStudy
    run: int

    def number(self, one: KeptNumber) -> str:
        """Return a number of it, in the unit of its head."""
        value = float(self.study.number(one.name)[self.run])
        if value != value:
            return NONE
        return percent(value, 2).removesuffix(" %") if one.usual == "%" else written(shown(value, one.si, one.usual), 4)


def run_columns(study: SweepStudy) -> tuple[TableColumn[RunRow], ...]:
    """Return the columns of the runs over a single setting: the setting, each number, and what its checks came to."""
    (variable,) = study.plan.variables
    return (
        TableColumn(variable.path, lambda row: variable.brief(study.plan.rows[row.run][0]), priority=KEY),
        *(TableColumn(one.label, partial(RunRow.number, one=one)) for one in study.plan.kept),
        TableColumn("verdict", lambda row: study.verdicts.texts[row.run] or NONE, priority=KEY, words=True),
    )


def run_rows(study: SweepStudy) -> list[RunRow]:
    """Return a row a run of a sweep over a single setting, in its order; none over several, or of too many runs."""
    count = len(study.plan.rows)
    if len(study.plan.variables) != 1 or count > MOST_RUN_ROWS:
        return []
    return [RunRow(study, int(run)) for run in np.argsort(study.settings[:, 0], kind="stable")]


class EffectRow(NamedTuple):
    """The main effect of a setting on a number."""

    path: str
    number: KeptNumber
    share: float
    chance: float
    low: float
    high: float
    standard_error: float

    @property
    def stands_out(self) -> bool:
        """Whether the share is beyond chance."""
        return self.share > self.chance


EFFECT_COLUMNS: tuple[TableColumn[EffectRow], ...] = (
    TableColumn("number", lambda row: called(row.number.name), priority=KEY, words=True),
    TableColumn("setting", lambda row: row.path, priority=KEY, words=True),
    TableColumn("share of the variance", lambda row: share_with_error(row.share, row.standard_error, 1)),
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
                path,
                one,
                effect.share,
                study.chance(effect),
                float(effect.means.min()),
                float(effect.means.max()),
                effect.standard_error,
            )
            for path, effect in effects.items()
            if effect.means.size
        ]
        rows += sorted(found, key=lambda row: -np.nan_to_num(row.share, nan=-1.0))[:MOST_EFFECTS]
    return rows
