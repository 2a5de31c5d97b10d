"""The runs of a design in the order in which they were asked for, and what is to be made small of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from strikewave.studies.design.goals import Goal, Objective, shares_of
from strikewave.studies.design.plan import DesignPlan
from strikewave.studies.engine.evaluation import Row
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.runner import Advance, StudyProgress, carry_out
from strikewave.studies.engine.store import RunStore

Array = NDArray[np.float64]
Merit = Callable[[Array], Array]
"""What is to be made small, of runs by their numbers."""

FAR = 1e9
"""Merit of a run that failed or has not all numbers: worse than any that has them."""
INFEASIBLE = 1e6
"""What is added to the merit of a setting that misses a goal, so that any that meets all is better."""
BROKEN = 1e5
"""What is added to the merit of a setting that fails a check of the run, so that any that passes is nearer."""


class DesignRuns:
    """The runs of a design, in the order in which they were asked for.

    Parameters
    ----------
    plan : DesignPlan
        What is run.
    store : RunStore
        Finished runs.
    pool : Pool
        Who runs the others.
    advance : callable, optional
        Called as runs come back, with how many there are.
    """

    def __init__(self, plan: DesignPlan, store: RunStore, pool: Pool, advance: Advance | None = None) -> None:
        self.plan, self._store, self._pool, self._advance = plan, store, pool, advance
        self.rows = list[Row]()
        self.failures, self.verdicts = list[str](), list[str]()
        self._numbers = list[Array]()
        self._places = dict[Row, int]()
        self.most = plan.runs

    @property
    def numbers(self) -> Array:
        """Numbers of all runs, shape (runs, names), SI; NaN where a run has none."""
        count = len(self.plan.evaluation.names)
        return np.array(self._numbers).reshape(len(self._numbers), count)

    def of(self, rows: Sequence[Row]) -> Array:
        """Return the numbers of rows, which are run where they are new."""
        new = [row for row in dict.fromkeys(rows) if row not in self._places]
        if new:
            names = self.plan.evaluation.names
            finished = carry_out(self.plan.job, new, self._store, self._pool, self._told)
            numbers, failures, _ = self._store.table(names, finished.keys)
            verdicts = self._store.verdicts(finished.keys).texts
            for row, found, failure, verdict in zip(new, numbers, failures, verdicts, strict=True):
                self._places[row] = len(self.rows)
                self.rows.append(row)
                self._numbers.append(found)
                self.failures.append(failure)
                self.verdicts.append(verdict)
        return np.array([self._numbers[self._places[row]] for row in rows])

    def _told(self, done: StudyProgress) -> None:
        if self._advance is not None:
            count, failed = len(self.rows) + done.done, sum(map(bool, self.failures)) + done.failed
            self._advance(StudyProgress(max(self.most, count), count, failed, done.rate))

    def place(self, row: Row) -> int:
        """Return the number of a run that was made."""
        return self._places[row]

    def meet(self) -> bool:
        """Tell whether one of the runs meets all goals."""
        shares = shares_of(self.plan.goals, self.plan.evaluation.names, self.numbers)
        return bool((shares.min(axis=1, initial=np.inf) >= 0.0).any())

    def best(self, merit: Merit) -> int:
        """Return the run of the smallest merit, the first of equal ones."""
        return int(np.argmin(merit(self.numbers)))


def margin_merit(goals: Sequence[Goal], names: Sequence[str]) -> Merit:
    """Return the merit whose smallest value has the largest least margin, of settings that pass all checks."""
    checks, others = [goal for goal in goals if goal.is_check], [goal for goal in goals if not goal.is_check]

    def missed(of: Sequence[Goal], numbers: Array) -> Array:
        least = shares_of(of, names, numbers).min(axis=1, initial=np.inf)
        return np.nan_to_num(-least, nan=FAR, posinf=FAR, neginf=-FAR)

    def merit(numbers: Array) -> Array:
        value, failed = missed(others, numbers), missed(checks, numbers)
        return np.where(failed < 0.0, value, np.where(failed < FAR, BROKEN + failed, FAR))

    return merit


def objective_merit(objective: Objective, goals: Sequence[Goal], names: Sequence[str]) -> Merit:
    """Return the merit of an objective under goals, by the rules of Deb.

    Source: ``deb-2000``.
    """

    def merit(numbers: Array) -> Array:
        value = objective.sign * numbers[:, names.index(objective.number)]
        return under(np.nan_to_num(value, nan=FAR), goals, names, numbers)

    return merit


def reach_merit(goal: Goal, others: Sequence[Goal], names: Sequence[str]) -> Merit:
    """Return the merit of the margin of one goal under others."""
    alone = margin_merit([goal], names)

    def merit(numbers: Array) -> Array:
        return under(alone(numbers), others, names, numbers)

    return merit


def under(value: Array, goals: Sequence[Goal], names: Sequence[str], numbers: Array) -> Array:
    """Return values where all goals are met, and else how far the worst of them is missed, above all values."""
    if not goals:
        return value
    worst = margin_merit(goals, names)(numbers)
    return np.where(worst <= 0.0, value, np.where(worst < FAR, INFEASIBLE + worst, FAR))
