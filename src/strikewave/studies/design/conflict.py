"""Why nothing meets all goals: the fewest that exclude each other, and what each of them comes to under the others.

Goals are left out one after the other; one without which the others still cannot be met stays out (the deletion filter
of Chinneck & Dravnieks 1991). What is left cannot be met together, and would without any one of them: as far as the
searches find. A global search finds no proof that nothing is there. What a goal comes to is that of runs that pass
their checks, whether these are among the fewest or not.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from strikewave.studies.design.goals import Goal
from strikewave.studies.design.runs import INFEASIBLE, DesignRuns, margin_merit, reach_merit
from strikewave.studies.design.search import search


class Reach(NamedTuple):
    """What a goal comes to where the others that exclude it are met.

    Attributes
    ----------
    goal : Goal
        The one that is given up.
    value : float
        Its number at best, SI; NaN where the others were not met.
    run : int
        Where.
    """

    goal: Goal
    value: float
    run: int

    @property
    def lacks(self) -> float:
        """By how much its limit would have to be moved, SI."""
        return max(self.goal.low - self.value, self.value - self.goal.high)


class Conflict(NamedTuple):
    """Goals that exclude each other.

    Attributes
    ----------
    goals : tuple of Goal
        The fewest: without any one of them, the others can be met.
    reaches : tuple of Reach
        What each comes to under the others.
    """

    goals: tuple[Goal, ...]
    reaches: tuple[Reach, ...]


def conflict_of(runs: DesignRuns) -> Conflict:
    """Return which goals exclude each other.

    Source: ``chinneck-dravnieks-1991``.
    """
    goals = list(runs.plan.goals)
    for salt, goal in enumerate(runs.plan.goals, 1):
        rest = [one for one in goals if one is not goal]
        if rest and not _can_be_met(runs, rest, salt):
            goals = rest
    names = runs.plan.evaluation.names
    reaches = []
    for salt, goal in enumerate(goals, len(runs.plan.goals) + 1):
        checks = [one for one in runs.plan.goals if one.is_check and one not in goals]
        others = [*(one for one in goals if one is not goal), *checks]
        merit = reach_merit(goal, others, names)
        run = search(runs, merit, salt=salt)
        met = float(merit(runs.numbers)[run]) < INFEASIBLE
        value = float(runs.numbers[run, names.index(goal.number)]) if met else np.nan
        reaches.append(Reach(goal, value, run))
    return Conflict(tuple(goals), tuple(reaches))


def _can_be_met(runs: DesignRuns, goals: Sequence[Goal], salt: int) -> bool:
    """Tell whether some goals can be met together: by what was run, or else by a search that ends where they are."""
    merit = margin_merit(goals, runs.plan.evaluation.names)
    if float(merit(runs.numbers).min()) <= 0.0:
        return True
    best = search(runs, merit, 0.0, salt)
    return float(merit(runs.numbers)[best]) <= 0.0
