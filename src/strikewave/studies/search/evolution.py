"""The search for settings of a case: runs in the order in which they are asked for, and where the next ones pay.

Every run is kept: a search that was stopped asks for the same rows again and finds them, a later search of the same
case begins with all earlier runs, and runs of a generation share the processes. With goals alone the least of the
margins is maximized: below zero it says by how much all limits at once must be widened. With an objective a setting
that meets all goals beats any that does not; of two that do the better one wins, and of two that do not the one whose
worst goal is missed by less (Deb 2000).

Differential evolution fills the ranges by generations and finds the deepest valley; it is slow at the ends of ranges,
along a ridge where two goals are missed alike, and in the last per cent of a valley. So its last runs refine the best
setting: parabolas describe the numbers, which are smooth where the merit has edges; the best of these is run, within a
box that grows where the model was right and shrinks where it was not. For expensive runs a Gaussian process of each
number proposes the next ones: of some that are chosen together, so that workers share them, the first has the best
expected numbers, the others the largest expected improvement (Jones et al. 1998), by draws of the numbers, since a
merit of several is not normal.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, NO_UNIT, Quantity
from strikewave.studies.engine.case_evaluation import OF_NUMBER, OfKept
from strikewave.studies.engine.evaluation import Row
from strikewave.studies.engine.plan import sobol_sequence
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.runner import Advance, StudyProgress, finished_runs
from strikewave.studies.engine.store import RunStore
from strikewave.studies.search.gaussian_process import GaussianProcess, fitted_process
from strikewave.studies.search.goals import Goal, Objective, shares_of
from strikewave.studies.search.plan import RESOLUTION, DesignPlan

Array = NDArray[np.float64]
Merit = Callable[[Array], Array]  # merit of runs by their numbers, to be minimized

FAR = 1e9  # of a run that failed or lacks a number: worse than any that has them all
INFEASIBLE = 1e6  # added where a goal is missed: any setting that meets all goals is better
BROKEN = 1e5  # added where a check of the run fails: any setting that passes is nearer
PER_SETTING, SMALLEST = 8, 16
"""Settings of a generation for each varied one, and at least: the ten of Storn & Price 1997, as the power of two that
fills the ranges evenly."""
SETTLED = 1e-3  # spread of the merits of a generation over their mean at which a search ends: chosen
SHARE = 4
"""Part of the runs, one in so many, that refines. Chosen: of 150 runs over two settings a quarter came to the same best
setting with each seed that was tried."""
WIDEST, GROWS, SHRINKS = 0.2, 2.0, 0.4
"""Half width of the first and widest box, in shares of the ranges, and its factors: chosen."""
STENCIL = 0.5  # distance of the runs of the parabolas over the half width of the box: inside, where they shall hold
BOX_DRAWS = 4096  # settings of the box by the model: a few per cent of its width apart in three settings
BEYOND = 1.3  # draws reach beyond the box and are set back to its faces: the best often lies at the end of a range
TRIED = 3  # runs of the settings that the model calls the best: a model errs, and runs share the processes
BEGIN_PER_SETTING, BEGIN_LEAST = 4, 8
"""Runs that fill the ranges before anything is expected, for each setting and at least, as a power of two. Chosen: less
than half of the ten for each that are usual where a process shall be right everywhere."""
TOGETHER = 4  # runs that are chosen together, whatever the workers: their number changes no bit
DRAWS = 32  # of the numbers at a place: the mean improvement is then known to a fifth, better than the process is
GENERATIONS, MEMBERS = 40, 12  # of the search over the process: a hundredth of a second each


class DesignRuns:
    """Runs of a design, in the order in which they were asked for; ``store`` has finished ones."""

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
            # a store keeps each run as it comes back: a search that is stopped goes on there
            made = finished_runs(self.plan.job, new, self._store, self._pool, self._report)
            for row, number, failure, verdict in zip(
                new, made.numbers, made.failures, made.verdicts.texts, strict=True
            ):
                self._places[row] = len(self.rows)
                self.rows.append(row)
                self._numbers.append(number)
                self.failures.append(failure)
                self.verdicts.append(verdict)
        return np.array([self._numbers[self._places[row]] for row in rows])

    def _report(self, done: StudyProgress) -> None:
        if self._advance is not None:
            count, failed = len(self.rows) + done.done, sum(map(bool, self.failures)) + done.failed
            self._advance(StudyProgress(max(self.most, count), count, failed, done.rate))

    def place(self, row: Row) -> int:
        """Return the number of a run that was made."""
        return self._places[row]

    def meet(self) -> bool:
        """Tell whether a run meets all goals."""
        shares = shares_of(self.plan.goals, self.plan.evaluation.names, self.numbers)
        return bool((shares.min(axis=1, initial=np.inf) >= 0.0).any())

    def best(self, merit: Merit) -> int:
        """Return the run of the smallest merit, the first of equal ones."""
        return int(np.argmin(merit(self.numbers)))


def margin_merit(goals: Sequence[Goal], names: Sequence[str]) -> Merit:
    """Return the merit that is smallest at the largest least margin of settings that pass all checks."""
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
    """Return values where all goals are met; elsewhere the miss of the worst goal, above all values."""
    if not goals:
        return value
    worst = margin_merit(goals, names)(numbers)
    return np.where(worst <= 0.0, value, np.where(worst < FAR, INFEASIBLE + worst, FAR))


def search(runs: DesignRuns, merit: Merit, enough: float = -np.inf, salt: int = 0) -> int:
    """Search for the smallest merit, or one of ``enough``, and return the number of the best run.

    It begins with the best earlier runs, and settings that fill the ranges evenly. ``salt`` separates the random
    numbers of several searches. Source: ``storn-price-1997``.
    """
    if runs.plan.by_surrogate:
        surrogate_search(runs, merit, enough, salt)
        return runs.best(merit)
    from scipy.optimize import differential_evolution

    plan = runs.plan
    first = _first_generation(runs, merit, salt)
    source = np.random.Generator(np.random.Philox(np.random.SeedSequence(plan.seed, spawn_key=(salt,))))
    begun = len(runs.rows)
    runs.most = begun + plan.runs

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
            maxiter=max((plan.runs - plan.runs // SHARE) // len(first) - 1, 0),
            tol=SETTLED,
            rng=source,
            polish=False,
            vectorized=True,
            updating="deferred",
            callback=is_enough,
        )
    refine(runs, merit, enough, begun + plan.runs)
    return runs.best(merit)


def _first_generation(runs: DesignRuns, merit: Merit, salt: int) -> Array:
    """Return the first places: a quarter of them the best earlier runs, the others spread evenly."""
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


def refine(runs: DesignRuns, merit: Merit, enough: float, most: int) -> None:
    """Refine the best run until its merit is ``enough``, no better one is found, or ``most`` runs are made in all."""
    plan = runs.plan
    free = [k for k, whole in enumerate(plan.whole) if not whole]
    width = WIDEST
    while free and width * RESOLUTION >= 1.0:
        best = runs.best(merit)
        before = float(merit(runs.numbers)[best])
        if before <= enough or len(runs.rows) + 2 * len(free) + TRIED > most:
            return
        place = plan.place_of(runs.rows[best])
        moves = [way * STENCIL * width * axis for axis in np.eye(place.size)[free] for way in (-1.0, 1.0)]
        ends = [np.where(move != 0.0, np.clip(place + move, 0.0, 1.0), place) for move in moves]
        about = runs.of([plan.row_at(end) for end in ends])
        places = np.array([plan.place_of(plan.row_at(end)) for end in ends])[:, free]
        slopes, curves = _parabolas(place[free], runs.numbers[best], places, about)
        even = BEYOND * width * (2.0 * sobol_sequence(len(free), BOX_DRAWS, plan.seed + len(runs.rows)) - 1.0)
        steps = np.clip(place[free] + np.clip(even, -width, width), 0.0, 1.0) - place[free]
        model = runs.numbers[best] + steps @ slopes + steps**2 @ curves
        order = np.argsort(merit(model), kind="stable")
        rows = []
        for step in steps[order]:
            wanted = place.copy()
            wanted[free] += step
            row = plan.row_at(wanted)
            if row not in rows:
                rows.append(row)
            if len(rows) == TRIED:
                break
        runs.of(rows)
        better = float(merit(runs.numbers).min()) < before
        width = min(width * GROWS, WIDEST) if better else width * SHRINKS


def _parabolas(middle: Array, value: Array, places: Array, values: Array) -> tuple[Array, Array]:
    """Return slopes and curvatures (halved) of numbers along each setting, shape (settings, numbers).

    They go through the middle and a run on either side; where one side has no run or no number, they are lines, and
    where neither has, the number does not change.

    Examples
    --------
    >>> places, values = np.array([[-1.0], [2.0]]), np.array([[3.0], [18.0]])
    >>> [each.tolist() for each in _parabolas(np.zeros(1), np.array([2.0]), places, values)]
    [[[2.0]], [[3.0]]]
    """
    slopes, curves = (np.zeros((middle.size, value.size)) for _ in range(2))
    for k in range(middle.size):
        sides = places[2 * k : 2 * k + 2, k] - middle[k]
        rises = values[2 * k : 2 * k + 2] - value
        with np.errstate(invalid="ignore", divide="ignore"):
            of_sides = rises / sides[:, None]
            curve = (of_sides[1] - of_sides[0]) / (sides[1] - sides[0])
            slope = of_sides[0] - curve * sides[0]
        line = np.where(np.isfinite(of_sides[0]), of_sides[0], np.nan_to_num(of_sides[1], posinf=0.0, neginf=0.0))
        whole = np.isfinite(curve)
        slopes[k], curves[k] = np.where(whole, slope, line), np.where(whole, curve, 0.0)
    return slopes, curves


@declare.dataclass
class KnownNumber(OfKept):
    """Error of a number predicted by the other runs; NaN where too few of them have it."""

    name: str = declare.word("which number", label="number", column=KEY)
    error: float = declare.number(
        OF_NUMBER, "root mean square of what is left", label="leave-one-out error", column=KEY
    )
    share: float = declare.number(
        Quantity(NO_UNIT, "%", "of its scatter over the runs", 1, 0), "the same over its scatter", column=MAIN
    )


def unit_places(plan: DesignPlan, rows: Sequence[tuple[float, ...]]) -> Array:
    """Return rows as places in the unit cube."""
    ends = np.array(plan.bounds)[:, 1]
    places = np.array([plan.place_of(row) for row in rows]).reshape(len(rows), len(plan.variables))
    return np.asarray(places / np.maximum(ends, 1.0))


def processes(runs: DesignRuns) -> list[GaussianProcess] | None:
    """Return a process of each number by the runs that have it; None where one has too few."""
    places, numbers, found = unit_places(runs.plan, runs.rows), runs.numbers, list[GaussianProcess]()
    for values in numbers.T:
        known = np.isfinite(values)
        if known.sum() < len(runs.plan.variables) + 2:
            return None
        found.append(fitted_process(places[known], values[known]))
    return found


def known_numbers(runs: DesignRuns) -> list[KnownNumber]:
    """Return the leave-one-out error of each number."""
    names, found = runs.plan.evaluation.names, processes(runs)
    if found is None:
        return [KnownNumber(runs.plan.kept(name), name, np.nan, np.nan) for name in names]
    errors = [float(np.sqrt(np.mean(one.left_out() ** 2))) for one in found]
    spreads = [float(np.std(one.values)) for one in found]
    return [
        KnownNumber(runs.plan.kept(name), name, error, error / spread if spread > 0.0 else 0.0)
        for name, error, spread in zip(names, errors, spreads, strict=True)
    ]


def surrogate_search(runs: DesignRuns, merit: Merit, enough: float, salt: int) -> None:
    """Search for the smallest merit by Gaussian processes. Source: ``jones-1998``."""
    plan = runs.plan
    most = len(runs.rows) + (plan.later_runs if runs.rows else plan.runs)
    runs.most = most
    source = np.random.Generator(np.random.Philox(np.random.SeedSequence(plan.seed, spawn_key=(salt,))))
    begin = min(2 ** int(np.ceil(np.log2(max(BEGIN_LEAST, BEGIN_PER_SETTING * len(plan.variables))))), most)
    filling = [_row(plan, place) for place in sobol_sequence(len(plan.variables), 2 ** int(np.log2(begin)), plan.seed)]
    if len(runs.rows) < begin:
        runs.of(filling)
    while len(runs.rows) < most and float(merit(runs.numbers).min()) > enough:
        found = processes(runs)
        count = min(TOGETHER, most - len(runs.rows))
        if found is None:
            asked = [_row(plan, place) for place in source.random((count, len(plan.variables)))]
        else:
            asked = _chosen(runs, merit, found, count, source)
        before = len(runs.rows)
        runs.of(asked)
        if len(runs.rows) == before:  # only settings that were run before: it stands still
            return


def _row(plan: DesignPlan, place: Array) -> tuple[float, ...]:
    """Return the row of a place in the unit cube."""
    return plan.row_at(place * np.maximum(np.array(plan.bounds)[:, 1], 1.0))


def _chosen(
    runs: DesignRuns, merit: Merit, found: list[GaussianProcess], count: int, source: np.random.Generator
) -> list[tuple[float, ...]]:
    """Return rows that are worth a run, each as if those before it had given the expected numbers."""
    plan, best, rows = runs.plan, float(merit(runs.numbers).min()), list[tuple[float, ...]]()
    normal = source.standard_normal((DRAWS, len(found)))

    def expected(places: Array) -> Array:
        """Return the merit of the numbers that are expected."""
        return merit(np.column_stack([one.at(places)[0] for one in found]))

    def gained(places: Array) -> Array:
        """Return the mean improvement, less than zero."""
        pairs = [one.at(places) for one in found]
        value, spread = (np.column_stack(part) for part in zip(*pairs, strict=True))
        drawn = value[:, None, :] + spread[:, None, :] * normal[None, :, :]
        merits = merit(drawn.reshape(-1, len(found))).reshape(len(places), DRAWS)
        return -np.maximum(best - merits, 0.0).mean(axis=1)

    for k in range(count):
        place = _least(plan, gained if k else expected, source)
        rows.append(_row(plan, place))
        found = [one.with_run(unit_places(plan, rows[-1:])[0]) for one in found]
    return rows


def _least(plan: DesignPlan, function: Merit, source: np.random.Generator) -> Array:
    """Return the place of the smallest value of a function; places of lists lie on their values."""
    from scipy.optimize import differential_evolution

    ends, whole = np.array(plan.bounds)[:, 1], np.array(plan.whole)

    def of_settable(places: Array) -> Array:
        settable = places.reshape(len(plan.variables), -1).T.copy()
        settable[:, whole] = np.round(settable[:, whole] * ends[whole]) / np.maximum(ends[whole], 1.0)
        return function(settable)

    end = differential_evolution(
        of_settable,
        [(0.0, 1.0)] * len(plan.variables),
        maxiter=GENERATIONS,
        popsize=MEMBERS,
        rng=source,
        polish=False,
        vectorized=True,
        updating="deferred",
    )
    return np.asarray(end.x)
