"""The tables of a design, for screen and page: ranked settings, goals, sensitivities, goals that do not go together."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from strikewave.base.percents import percent
from strikewave.reporting.layout import KEY, MORE
from strikewave.reporting.parts import NONE
from strikewave.reporting.table_columns import TableColumn
from strikewave.studies.design.candidates import DesignCandidate, Sensitivity
from strikewave.studies.design.conflict import Reach
from strikewave.studies.design.goals import Goal
from strikewave.studies.design.study import DesignStudy
from strikewave.studies.design.surrogate import SurrogateError

MOST_SETTINGS = 6
"""Settings that a table shows in columns of their own; the CSV file has all."""


class RankedRow(NamedTuple):
    """A ranked setting and its place."""

    study: DesignStudy
    place: int
    one: DesignCandidate


def ranked_rows(study: DesignStudy) -> list[RankedRow]:
    """Return a row a ranked setting."""
    return [RankedRow(study, place, one) for place, one in enumerate(study.candidates, 1)]


def ranked_columns(study: DesignStudy) -> tuple[TableColumn[RankedRow], ...]:
    """Return the columns of ranked settings: settings, least margin, what verifies it, draws."""

    def setting(k: int) -> Callable[[RankedRow], str]:
        return lambda row: study.plan.variables[k].brief(row.one.row[k])

    columns = [TableColumn[RankedRow]("place", lambda row: str(row.place), priority=KEY)]
    for k, variable in enumerate(study.plan.variables[:MOST_SETTINGS]):
        columns.append(TableColumn(variable.path, setting(k), priority=KEY if k < 2 else MORE))
    for objective in study.plan.objectives[:2]:
        columns.append(TableColumn(objective.number, _number(objective.number)))
    if study.plan.goals:
        columns.append(TableColumn("least margin", lambda row: _share(row.one.margin)))
        columns.append(TableColumn("of goal", _tightest, priority=MORE, words=True))
    if study.plan.verifying is not None and study.plan.goals:
        columns.append(TableColumn("verified", _verified))
    if study.plan.robust:
        columns.append(TableColumn("draws that meet all", _draws))
    columns.append(TableColumn("verdict", lambda row: row.one.verdict or NONE, words=True))
    return tuple(columns)


def _number(name: str) -> Callable[[RankedRow], str]:
    return lambda row: row.study.value_words(name, row.study.value(row.one.run, name))


def _share(margin: float) -> str | None:
    return percent(margin, 1) if math.isfinite(margin) else None


def _tightest(row: RankedRow) -> str:
    shares = row.one.shares.tolist()
    return row.study.plan.goals[shares.index(min(shares))].number


def _verified(row: RankedRow) -> str:
    checked = row.one.verified
    if row.one.failure:
        return "failed"
    known = [] if checked is None else [share for share in checked.tolist() if math.isfinite(share)]
    return percent(min(known), 1) if known else "–"


def _draws(row: RankedRow) -> str | None:
    found = row.one.robustness
    if found is None:
        return None
    return f"{percent(found.share, 0)} ({percent(found.low, 0)} to {percent(found.high, 0)})"


class GoalRow(NamedTuple):
    """A goal at the first of the ranked settings."""

    study: DesignStudy
    number: int
    goal: Goal

    @property
    def value(self) -> str:
        """Its number there."""
        return self.study.value_words(
            self.goal.number, self.study.value(self.study.candidates[0].run, self.goal.number)
        )

    @property
    def margin(self) -> str | None:
        """Its margin."""
        return _share(float(self.study.candidates[0].shares[self.number]))

    @property
    def verified(self) -> str | None:
        """Its margin by the run that verifies it."""
        checked = self.study.candidates[0].verified
        return None if checked is None else _share(float(checked[self.number]))


GOAL_COLUMNS: tuple[TableColumn[GoalRow], ...] = (
    TableColumn("goal", lambda row: row.goal.typed, priority=KEY, words=True),
    TableColumn("comes to", lambda row: row.value, priority=KEY),
    TableColumn("margin", lambda row: row.margin),
    TableColumn("verified", lambda row: row.verified),
)
"""What each goal comes to at the first setting; margins are shares of half a band, or of the one limit."""


def goal_rows(study: DesignStudy) -> list[GoalRow]:
    """Return a row a goal."""
    return [GoalRow(study, k, goal) for k, goal in enumerate(study.plan.goals)]


class SensitivityRow(NamedTuple):
    """How a number moves with a setting."""

    study: DesignStudy
    of: Sensitivity
    name: str
    change: float

    def room(self, which: int) -> str | None:
        """Return to where the setting may be moved down (0) or up (1), till the first goal is missed."""
        far = self.of.room[which]
        places = [one.path for one in self.study.plan.variables]
        k = places.index(self.of.path)
        variable, value = self.study.plan.variables[k], self.study.candidates[0].row[k]
        if math.isnan(far):
            return None
        low, high = variable.axis.values[0], variable.axis.values[-1]
        moved = value - far if which == 0 else value + far
        return variable.brief(moved) if low <= moved <= high else f"beyond {variable.brief(high if which else low)}"


SENSITIVITY_COLUMNS: tuple[TableColumn[SensitivityRow], ...] = (
    TableColumn("setting", lambda row: row.of.path, priority=KEY, words=True),
    TableColumn("number", lambda row: row.name, priority=KEY, words=True),
    TableColumn("change per 1 % of its range", lambda row: signed(row.study, row.name, row.change)),
    TableColumn("all goals met from", lambda row: row.room(0)),
    TableColumn("to", lambda row: row.room(1)),
)
"""How the numbers move with each setting, and between which values of it alone all goals stay met, as slopes say."""


def signed(study: DesignStudy, name: str, change: float) -> str:
    """Write a change with its sign."""
    words = study.value_words(name, abs(change)) if change else "0"
    return f"{'-' if change < 0.0 else '+'}{words}"


def sensitivity_rows(study: DesignStudy) -> list[SensitivityRow]:
    """Return a row a setting and number."""
    names = study.plan.evaluation.names
    wanted = dict.fromkeys(aim.number for aim in study.plan.aims)
    return [
        SensitivityRow(study, one, name, float(one.changes[names.index(name)]))
        for one in study.sensitivities
        for name in wanted
    ]


class SurrogateRow(NamedTuple):
    """How well a number is known by the other runs."""

    study: DesignStudy
    one: SurrogateError


SURROGATE_COLUMNS: tuple[TableColumn[SurrogateRow], ...] = (
    TableColumn("number", lambda row: row.one.name, priority=KEY, words=True),
    TableColumn("leave-one-out error", lambda row: row.study.value_words(row.one.name, row.one.error), priority=KEY),
    TableColumn("of its scatter over the runs", lambda row: _share(row.one.share)),
)
"""What each number was off where a Gaussian process of all other runs foretold it, root mean square."""


def surrogate_rows(study: DesignStudy) -> list[SurrogateRow]:
    """Return a row a number; none where runs are many."""
    return [SurrogateRow(study, one) for one in study.surrogate]


class ReachRow(NamedTuple):
    """A goal that others exclude, and what it comes to where they are met."""

    study: DesignStudy
    reach: Reach


REACH_COLUMNS: tuple[TableColumn[ReachRow], ...] = (
    TableColumn("without the goal", lambda row: row.reach.goal.typed, priority=KEY, words=True),
    TableColumn("it comes to", lambda row: row.study.value_words(row.reach.goal.number, row.reach.value), priority=KEY),
    TableColumn("its limit would move by", lambda row: row.study.value_words(row.reach.goal.number, row.reach.lacks)),
    TableColumn("at", lambda row: row.study.at(row.study.rows[row.reach.run]), priority=MORE, words=True),
)
"""What each of the goals that exclude each other comes to at best while the others are met."""


def reach_rows(study: DesignStudy) -> list[ReachRow]:
    """Return a row a goal that others exclude."""
    return [] if study.conflict is None else [ReachRow(study, one) for one in study.conflict.reaches]
