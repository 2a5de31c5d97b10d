"""The search for settings: differential evolution whose generations are runs of the engine.

Every run is kept, so that a search that was stopped asks for the same rows again and finds them, a later search of the
same case begins with what earlier ones found, and runs of a generation share the processes. With goals alone the least
of the margins is made as large as it can be: below zero it says by how much all limits at once must be widened. With an
objective a setting that meets all goals beats any that does not, of two that do the better one wins, and of two that do
not the one whose worst goal is missed by less (Deb 2000).
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from strikewave.studies.design.goals import Goal, Objective, shares_of
from strikewave.studies.design.plan import DesignPlan
from strikewave.studies.engine.evaluation import Row
from strikewave.studies.engine.plan import sobol_sequence
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.runner import StudyProgress, carry_out
from strikewave.studies.engine.store import RunStore

Array = NDArray[np.float64]
Merit = Callable[[Array], Array]
"""What is to be made small, of runs by their numbers."""
Advance = Callable[[StudyProgress], None]

PER_SETTING, SMALLEST = 8, 16
"""Settings of a generation for each one that is varied, and at least: the ten for each of Storn & Price 1997, as the
power of two that fills the ranges evenly."""
FAR = 1e9
"""Merit of a run that failed or has not all numbers: worse than any that has them."""
INFEASIBLE = 1e6
"""What is added to the merit of a setting that misses a goal, so that any that meets all is better."""
SETTLED = 1e-3
"""Spread of the merits of a generation over their mean at which a search ends."""


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
        self.failures = list[str]()
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
            for row, found, failure in zip(new, numbers, failures, strict=True):
                self._places[row] = len(self.rows)
                self.rows.append(row)
                self._numbers.append(found)
                self.failures.append(failure)
        return np.array([self._numbers[self._places[row]] for row in rows])

    def _told(self, done: StudyProgress) -> None:
        if self._advance is not None:
            count, failed = len(self.rows) + done.done, sum(map(bool, self.failures)) + done.failed
            self._advance(StudyProgress(max(self.most, count), count, failed, done.rate))

    def place(self, row: Row) -> int:
        """Return the number of a run that was made."""
        return self._places[row]

    def best(self, merit: Merit) -> int:
        """Return the run of the smallest merit, the first of equal ones."""
        return int(np.argmin(merit(self.numbers)))


def margin_merit(goals: Sequence[Goal], names: Sequence[str]) -> Merit:
    """Return the merit whose smallest value has the largest least margin."""

    def merit(numbers: Array) -> Array:
        return np.nan_to_num(-shares_of(goals, names, numbers).min(axis=1), nan=FAR, posinf=FAR, neginf=-FAR)

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


def search(runs: DesignRuns, merit: Merit, enough: float = -np.inf, salt: int = 0) -> int:
    """Search for the smallest merit, and return the number of the best run.

    It begins with the best runs that there are, and with settings that fill the ranges evenly.

    Source: ``storn-price-1997``.

    Parameters
    ----------
    runs : DesignRuns
        What was run; what is run is added.
    merit : callable
        What is to be made small.
    enough : float, optional
        Merit at which it ends.
    salt : int, optional
        Tells the random numbers of several searches apart.
    """
    from scipy.optimize import differential_evolution

    plan = runs.plan
    first = _first_generation(runs, merit, salt)
    source = np.random.Generator(np.random.Philox(np.random.SeedSequence(plan.seed, spawn_key=(salt,))))
    runs.most = len(runs.rows) + plan.runs

    def of_places(places: Array) -> Array:
        rows = [plan.row_at(place) for place in places.reshape(len(plan.variables), -1).T]
        return merit(runs.of(rows))

    def is_enough(*_: object) -> bool:
        return float(merit(runs.numbers).min()) <= enough

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of infinite spreads where every run of a generation failed
        differential_evolution(
            of_places,
            plan.bounds,
            init=first,
            integrality=plan.whole,
            maxiter=max(plan.runs // len(first) - 1, 0),
            tol=SETTLED,
            rng=source,
            polish=False,
            vectorized=True,
            updating="deferred",
            callback=is_enough,
        )
    return runs.best(merit)


def _first_generation(runs: DesignRuns, merit: Merit, salt: int) -> Array:
    """Return the places that a search begins with: a quarter of them the best there are, the others spread evenly."""
    plan = runs.plan
    count = SMALLEST
    while count < PER_SETTING * len(plan.variables):
        count *= 2
    low, high = np.array(plan.bounds).T
    spread = low + sobol_sequence(len(plan.variables), count, plan.seed + salt) * (high - low)
    if runs.rows:
        order = np.argsort(merit(runs.numbers), kind="stable")[: count // 4]
        known = np.array([plan.place_of(runs.rows[place]) for place in order])
        spread[: len(known)] = known
    whole = np.array(plan.whole)
    spread[:, whole] = np.round(spread[:, whole])
    return np.asarray(spread)
