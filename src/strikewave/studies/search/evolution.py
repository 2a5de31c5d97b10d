"""The search for settings: runs in the order in which they are asked for, and where the next ones are worth it.

Every run is kept, so that a search that was stopped asks for the same rows again and finds them, a later search of the
same case begins with what earlier ones found, and runs of a generation share the processes. With goals alone the least
of the margins is made as large as it can be: below zero it says by how much all limits at once must be widened. With an
objective a setting that meets all goals beats any that does not, of two that do the better one wins, and of two that do
not the one whose worst goal is missed by less (Deb 2000).

Differential evolution fills the ranges by generations, and says which valley is the deepest; to the ends of the ranges,
along a ridge where two goals are missed alike, and to the last per cent of a valley it comes slowly. So its last runs
go on from the best setting: there the numbers, not the merit, are taken as parabolas, for they are smooth where the
merit has edges, and the best of these is run, within a box that grows where the model was right and shrinks where it
was not. Where runs are dear a Gaussian process of each number says where the next ones are worth it: of some that are
chosen together, so that workers share them, the first lies where the numbers are expected best, the others where the
merit is expected to improve most (expected improvement, Jones et al. 1998), by draws of the numbers, since a merit of
several is none of a normal distribution.
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
from strikewave.studies.engine.runner import Advance, StudyProgress, carry_out
from strikewave.studies.engine.store import RunStore
from strikewave.studies.search.gaussian_process import GaussianProcess, fitted_process
from strikewave.studies.search.goals import Goal, Objective, shares_of
from strikewave.studies.search.plan import RESOLUTION, DesignPlan

Array = NDArray[np.float64]
Merit = Callable[[Array], Array]
"""Merit of runs by their numbers, which is to be made small."""

FAR = 1e9
"""Merit of a run that failed or has not all numbers: worse than any that has them."""
INFEASIBLE = 1e6
"""Penalty added to the merit of a setting that misses a goal, so that any that meets all is better."""
BROKEN = 1e5
"""Penalty added to the merit of a setting that fails a check of the run, so that any that passes is nearer."""
PER_SETTING, SMALLEST = 8, 16
"""Settings of a generation for each one that is varied, and at least: the ten for each of Storn & Price 1997, as the
power of two that fills the ranges evenly."""
SETTLED = 1e-3
"""Spread of the merits of a generation over their mean at which a search ends."""
SHARE = 4
"""Share of the runs of a search, one in so many, that is left for its last steps at least. Chosen: of 150 runs over two
settings a quarter came to the same best setting with each of the seeds that were tried."""
WIDEST, GROWS, SHRINKS = 0.2, 2.0, 0.4
"""Half width of the first box and of the widest, in shares of the ranges; by what it grows and shrinks."""
STENCIL = 0.5
"""Distance of the runs that the parabolas go through from the middle, over the half width of the box."""
BOX_DRAWS = 4096
"""Settings of the box of which the model says the best: a few per cent of its width apart in three settings."""
BEYOND = 1.3
"""How far draws reach beyond the box, to be set back to its faces: the best often lies there, at the end of a range."""
TRIED = 3
"""Settings that are run of those that the model calls the best: a model errs, and runs share the processes."""
BEGIN_PER_SETTING, BEGIN_LEAST = 4, 8
"""Runs that fill the ranges before anything is expected, for each setting and at least, as a power of two. Chosen: less
than half of the ten for each that are usual where a process shall be right everywhere."""
TOGETHER = 4
"""Runs that are chosen together: the same whatever the workers, so that they change no bit."""
DRAWS = 32
"""Draws of the numbers at a place: the mean improvement is then known to a fifth, far better than the process is."""
GENERATIONS, MEMBERS = 40, 12
"""Generations and members of the search over the process, which costs a hundredth of a second each."""


class DesignRuns:
    """The runs of a design, in the order in which they were asked for.

    Parameters
    ----------
    plan : DesignPlan
        Plan of the runs.
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
            numbers, failures = self._store.table(names, finished.keys)
            verdicts = self._store.verdicts(finished.keys).texts
            for row, number, failure, verdict in zip(new, numbers, failures, verdicts, strict=True):
                self._places[row] = len(self.rows)
                self.rows.append(row)
                self._numbers.append(number)
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


def search(runs: DesignRuns, merit: Merit, enough: float = -np.inf, salt: int = 0) -> int:
    """Search for the smallest merit, and return the number of the best run.

    It begins with the best runs that there are, and with settings that fill the ranges evenly. Where the plan has few
    runs, Gaussian processes say where.

    Source: ``storn-price-1997``.
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


def refine(runs: DesignRuns, merit: Merit, enough: float, most: int) -> None:
    """Go on from the best run while a better one is found, or until so many runs are made."""
    plan = runs.plan
    free = [k for k, whole in enumerate(plan.whole) if not whole]
    width = WIDEST
    while free and width * RESOLUTION >= 1.0:
        best = runs.best(merit)
        before = float(merit(runs.numbers)[best])
        if before <= enough or len(runs.rows) + 2 * len(free) + TRIED > most:
            return
        place = plan.place_of(runs.rows[best])
        ends = [_moved(place, k, way * STENCIL * width) for k in free for way in (-1.0, 1.0)]
        about = runs.of([plan.row_at(end) for end in ends])
        places = np.array([plan.place_of(plan.row_at(end)) for end in ends])[:, free]
        slopes, curves = _parabolas(place[free], runs.numbers[best], places, about)
        steps = _steps(place[free], width, len(free), plan.seed + len(runs.rows))
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


def _moved(place: Array, setting: int, way: float) -> Array:
    """Return a place with one setting moved within its range."""
    moved = place.copy()
    moved[setting] = min(max(moved[setting] + way, 0.0), 1.0)
    return moved


def _steps(place: Array, width: float, settings: int, seed: int) -> Array:
    """Return steps in a box about a place and in the ranges, evenly and on the faces; shape (draws, settings)."""
    even = BEYOND * width * (2.0 * sobol_sequence(settings, BOX_DRAWS, seed) - 1.0)
    return np.asarray(np.clip(place + np.clip(even, -width, width), 0.0, 1.0) - place)


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
    """How well a number is known by the other runs; NaN where too few of them have it."""

    name: str = declare.word("which number", label="number", column=KEY)
    error: float = declare.number(
        OF_NUMBER, "root mean square of what is left", label="leave-one-out error", column=KEY
    )
    share: float = declare.number(
        Quantity(NO_UNIT, "%", "of its scatter over the runs", 1, 0), "the same over its scatter", column=MAIN
    )


def unit_places(plan: DesignPlan, rows: Sequence[tuple[float, ...]]) -> Array:
    """Return rows as places of which each coordinate goes from 0 to 1."""
    ends = np.array(plan.bounds)[:, 1]
    places = np.array([plan.place_of(row) for row in rows]).reshape(len(rows), len(plan.variables))
    return np.asarray(places / np.maximum(ends, 1.0))


def processes(runs: DesignRuns) -> list[GaussianProcess] | None:
    """Return a process of each number by the runs that have it; None where they are too few of one."""
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
    """Search for the smallest merit; what is run is added to the runs.

    Source: ``jones-1998``.
    """
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
        if len(runs.rows) == before:  # it stands where it was
            return


def _row(plan: DesignPlan, place: Array) -> tuple[float, ...]:
    """Return the row of a place of which each coordinate goes from 0 to 1."""
    return plan.row_at(place * np.maximum(np.array(plan.bounds)[:, 1], 1.0))


def _chosen(
    runs: DesignRuns, merit: Merit, found: list[GaussianProcess], count: int, source: np.random.Generator
) -> list[tuple[float, ...]]:
    """Return rows that are worth a run, each as if those before it had come to what is expected."""
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
    """Return the place where a function of places is least; those of lists lie on their values."""
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
