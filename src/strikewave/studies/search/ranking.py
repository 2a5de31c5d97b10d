"""The ranking of a design: verified settings, Pareto fronts, and goals that exclude each other.

A front of several objectives is searched for at its ends and between, or at once by optuna: its tree-structured Parzen
estimator describes the settings of runs near the front and of the others by two densities, and proposes settings likely
by the first and not by the second; runs that miss a goal rank behind all that meet theirs, by their miss. Where nothing
meets all goals they are left out one after the other: one without which the others still cannot be met stays out (the
deletion filter of Chinneck & Dravnieks 1991). The rest cannot be met together, and would without any one of them, as
far as the searches find: a global search proves no absence. A goal comes to the number of runs that pass their checks,
whether these are among the fewest or not.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, MORE, NO_UNIT, Quantity
from strikewave.base.result import RUN_BROKEN, status_of, worse
from strikewave.base.shock_quantities import RATIO
from strikewave.studies.engine.case_evaluation import OF_NUMBER, OfKept
from strikewave.studies.engine.evaluation import Job, Row
from strikewave.studies.engine.plan import DrawVariation, drawn_rows
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.runner import finished_runs
from strikewave.studies.engine.store import RunStore
from strikewave.studies.search.evolution import (
    FAR,
    INFEASIBLE,
    DesignRuns,
    Merit,
    margin_merit,
    objective_merit,
    reach_merit,
    search,
    under,
)
from strikewave.studies.search.goals import Goal, Objective, shares_of
from strikewave.studies.search.plan import OPTUNA, DesignPlan
from strikewave.uncertainty.draws import tolerances_of

if TYPE_CHECKING:
    import optuna

Array = NDArray[np.float64]

MOST_CANDIDATES = 8  # ranked settings: a table of a screen
APART = 0.1
"""Least distance of two ranked settings, in shares of the range of one of them: nearer ones are the same to a maker. Of
a list any other value counts."""
STEP = 0.01
"""Step of slopes, as a share of the range: ten of the steps of `RESOLUTION`, so that rounding is a tenth at most."""
WEIGHTS = (0.25, 0.5, 0.75)  # of the first of two objectives: points between the ends of the front, evenly
TOGETHER = 8  # runs that optuna proposes together, whatever the workers: their number changes no bit
MARGIN = Quantity(NO_UNIT, "%", "margin", 1, 0)


@declare.dataclass
class Robustness:
    """Draws within the tolerances of a setting, and those that meet all goals."""

    met: int = declare.count("draws that meet all goals")
    drawn: int = declare.count("draws")
    low: float
    high: float

    @declare.computed(declare.number(RATIO, "share of the draws that meet all goals"))
    def share(self) -> float:
        """Share of the draws that meet all goals."""
        return self.met / self.drawn

    @declare.computed(declare.word("of the share that would meet them, 95 % (Clopper & Pearson)"))
    def interval(self) -> list[float]:
        """Low and high end of the interval."""
        return [self.low, self.high]


@declare.dataclass(eq=False)
class DesignRun:
    """A run of a design.

    Attributes
    ----------
    plan : DesignPlan
        Plan of the design.
    run : int
        Number of the run, from 0.
    row : tuple of float
        Settings of the run.
    numbers : ndarray
        SI, in the order of the evaluation.
    """

    plan: DesignPlan
    run: int
    row: Row
    numbers: Array

    number = declare.computed(declare.count("number of the run, from 1", key="run"))(lambda run: run.run + 1)
    settings = declare.computed(declare.word("its settings by their paths, SI or words"))(
        lambda run: run.plan.setting(run.row)
    )
    by_name = declare.computed(declare.word("its numbers by their names, SI", key="numbers"))(
        lambda run: dict(zip(run.plan.evaluation.names, run.numbers.tolist(), strict=True))
    )


@declare.dataclass(eq=False)
class DesignCandidate(DesignRun):
    """A ranked setting.

    Attributes
    ----------
    shares : ndarray
        Margin of each goal, see `Goal.share`.
    verified : ndarray or None
        Margins by the run that verifies it; NaN where that has no such number. None where there is none.
    """

    @declare.computed(declare.word("whether it meets all goals"))
    def meets(self) -> bool:
        """True if it meets all goals, also when it is verified."""
        return self.margin >= 0.0 and self.holds

    @declare.computed(
        declare.number(MARGIN, "least margin, as of clauses: the distance to the nearer limit over its scale")
    )
    def margin(self) -> float:
        """The least of its margins; infinite where there is no goal."""
        return float(self.shares.min(initial=math.inf))

    shares: Array
    verified: Array | None

    margins = declare.computed(declare.number(MARGIN, "margin of each goal"))(
        lambda candidate: candidate.by_goal(candidate.shares)
    )
    verified_margins = declare.computed(declare.number(MARGIN, "the same by a full run, where that is another one"))(
        lambda candidate: None if candidate.verified is None else candidate.by_goal(candidate.verified)
    )

    failure: str = declare.word("why that run failed; empty where it did not")
    verdict: str = declare.word(
        "what the checks of its run came to, of that which verifies it where this one's came to worse: passed, or "
        "broken with the checks that failed"
    )
    robustness: Robustness | None = declare.part(
        Robustness, "by the option robust: how many draws within the tolerances meet all goals", key="robust"
    )

    def by_goal(self, shares: Array) -> dict[str, float]:
        """Return margins by their goals."""
        return dict(zip([goal.typed for goal in self.plan.goals], shares.tolist(), strict=True))

    @property
    def holds(self) -> bool:
        """True if its runs failed no check, and no margin falls below zero when it is verified."""
        return self.confirmed and not self.breaks

    @property
    def confirmed(self) -> bool:
        """True if no margin falls below zero by the run that verifies it, whatever its checks say."""
        return not self.failure and (self.verified is None or not bool((self.verified < 0.0).any()))

    @property
    def breaks(self) -> bool:
        """True if one of its runs failed a check."""
        return status_of(self.verdict) == RUN_BROKEN


def chosen_runs(runs: DesignRuns, merit: Array) -> list[int]:
    """Return the ranked runs, the smallest merit first, each `APART` from those before it.

    Where no run meets all goals it is the nearest alone; runs that failed a check count where all that meet them did.
    """
    plan = runs.plan
    names = plan.evaluation.names
    least = shares_of(plan.goals, names, runs.numbers).min(axis=1, initial=math.inf)
    able = np.flatnonzero((least >= 0.0) & np.isfinite(merit))
    if not able.size:
        return [int(np.argmin(merit))]
    able = _sound(runs, able)
    taken, places = list[int](), list[Array]()
    whole = np.array(plan.whole)
    for run in able[np.argsort(merit[able], kind="stable")]:
        place = plan.place_of(runs.rows[run])
        if all(bool((np.abs(place - other) >= np.where(whole, 1.0, APART)).any()) for other in places):
            taken.append(int(run))
            places.append(place)
        if len(taken) == MOST_CANDIDATES:
            break
    return taken


def _sound(runs: DesignRuns, able: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return those of some runs that failed no check; all of them where each did."""
    sound = [run for run in able if status_of(runs.verdicts[run]) != RUN_BROKEN]
    return np.array(sound, np.intp) if sound else able


def verified(
    plan: DesignPlan, rows: Sequence[Row], store: RunStore, pool: Pool
) -> tuple[Array | None, list[str], Sequence[str]]:
    """Return margins of rows by the runs that verify them, shape (rows, goals), their failures, and verdicts."""
    if plan.verifying is None:
        return None, [""] * len(rows), [""] * len(rows)
    better, _ = plan.verifying
    made = finished_runs(better.job, rows, store, pool)
    margins = np.full((len(rows), len(plan.goals)), np.nan)
    shares = shares_of(better.goals, better.evaluation.names, made.numbers)
    for k, goal in enumerate(better.goals):
        margins[:, plan.goals.index(goal)] = shares[:, k]
    return margins, made.failures, made.verdicts.texts


def robustness_of(plan: DesignPlan, row: Row, store: RunStore, pool: Pool) -> Robustness:
    """Return the count of draws within the tolerances of a setting that meet all goals, and fail no check.

    Source: ``clopper-pearson-1934``.
    """
    from scipy.stats import binomtest

    case = plan.case_of(row)
    inputs = tolerances_of(case)
    drawn = drawn_rows(inputs, plan.robust, plan.seed)
    made = finished_runs(Job(DrawVariation(case, inputs), plan.evaluation), drawn, store, pool)
    least = shares_of(plan.goals, plan.evaluation.names, made.numbers).min(axis=1, initial=math.inf)
    passed = np.array([status_of(text) != RUN_BROKEN for text in made.verdicts.texts])
    met = int(np.sum((least >= 0.0) & passed))
    interval = binomtest(met, plan.robust).proportion_ci(0.95, "exact")
    return Robustness(met, plan.robust, float(interval.low), float(interval.high))


@declare.dataclass(eq=False)
class Sensitivity:
    """Change of the numbers with a setting, about the best run.

    Attributes
    ----------
    names : tuple of str
        Names of the numbers.
    moved : ndarray
        Change of each number per `STEP` of the range of the setting, SI.
    """

    path: str = declare.word("path of a setting of the best one", key="setting")
    names: tuple[str, ...]
    moved: Array

    changes = declare.computed(
        declare.word(
            "change of each number, SI, for a hundredth of the range of the setting",
            key="changes_per_hundredth_of_range",
        )
    )(lambda sensitivity: dict(zip(sensitivity.names, sensitivity.moved.tolist(), strict=True)))
    room: tuple[float, float] = declare.word(
        "how far it may move down and up until a goal is missed, SI, where the numbers go on as they do here"
    )


def sensitivities(runs: DesignRuns, best: int) -> tuple[Sensitivity, ...]:
    """Return the sensitivities of all settings that have a range, by runs on either side of the best one."""
    plan, row = runs.plan, runs.rows[best]
    place, names, found = plan.place_of(row), plan.evaluation.names, list[Sensitivity]()
    ranges = [k for k, variable in enumerate(plan.variables) if variable.is_range]
    pairs = []
    for k in ranges:
        ends = []
        for way in (-STEP, STEP):
            moved = place.copy()
            moved[k] = min(max(moved[k] + way, 0.0), 1.0)
            ends.append(plan.row_at(moved))
        pairs.append(ends)
    numbers = runs.of([end for ends in pairs for end in ends])
    at_best = runs.of([row])[0]
    for number, (k, ends) in enumerate(zip(ranges, pairs, strict=True)):
        apart = plan.place_of(ends[1])[k] - plan.place_of(ends[0])[k]
        step = ends[1][k] - ends[0][k]
        slopes = (numbers[2 * number + 1] - numbers[2 * number]) / step
        room = _room(plan.goals, names, at_best, slopes)
        found.append(Sensitivity(plan.variables[k].path, names, slopes * step * STEP / apart, room))
    return tuple(found)


def _room(goals: Sequence[Goal], names: Sequence[str], numbers: Array, slopes: Array) -> tuple[float, float]:
    """Return the room of a setting down and up until the first goal is missed; NaN where one is missed already.

    Examples
    --------
    >>> _room([Goal("x < 3", "x", -math.inf, 3.0)], ["x"], np.array([2.0]), np.array([-0.5]))
    (2.0, inf)
    """
    places = [names.index(goal.number) for goal in goals]
    if not all(goal.low <= numbers[k] <= goal.high for goal, k in zip(goals, places, strict=True)):
        return math.nan, math.nan
    ends = [
        (limit - numbers[k]) / slopes[k]
        for goal, k in zip(goals, places, strict=True)
        for limit in (goal.low, goal.high)
        if math.isfinite(limit) and slopes[k] != 0.0
    ]
    down, up = [-end for end in ends if end <= 0.0], [end for end in ends if end >= 0.0]
    return float(min(down, default=math.inf)), float(min(up, default=math.inf))


def front(runs: DesignRuns, objectives: Sequence[Objective]) -> list[int]:
    """Return the Pareto-optimal runs that meet all goals, sorted by the first objective.

    Runs that failed a check count where all that meet the goals did.
    """
    plan, names = runs.plan, runs.plan.evaluation.names
    least = shares_of(plan.goals, names, runs.numbers).min(axis=1, initial=math.inf)
    values = np.column_stack(
        [objective.sign * runs.numbers[:, names.index(objective.number)] for objective in objectives]
    )
    able = _sound(runs, np.flatnonzero((least >= 0.0) & np.isfinite(values).all(axis=1)))
    kept = [run for run in able if not _beaten(values[run], values[able])]
    return sorted(map(int, kept), key=lambda run: float(values[run, 0]))


def _beaten(value: Array, others: Array) -> bool:
    return bool(((others <= value).all(axis=1) & (others < value).any(axis=1)).any())


def ranked_candidates(runs: DesignRuns, ranked: list[int], store: RunStore, pool: Pool) -> tuple[DesignCandidate, ...]:
    """Return the ranked settings with their verification: those that hold first, of these the most robust."""
    plan = runs.plan
    rows = [runs.rows[run] for run in ranked]
    margins, failures, verdicts = verified(plan, rows, store, pool)
    shares = shares_of(plan.goals, plan.evaluation.names, runs.numbers)
    found = [
        DesignCandidate(
            plan,
            run,
            row,
            runs.numbers[run],
            shares[run],
            None if margins is None else margins[k],
            failures[k],
            worse(runs.verdicts[run], verdicts[k]),
            robustness_of(plan, row, store, pool) if plan.robust else None,
        )
        for k, (run, row) in enumerate(zip(ranked, rows, strict=True))
    ]
    return tuple(sorted(found, key=lambda one: (not one.holds, -one.robustness.share if one.robustness else 0.0)))


@declare.dataclass(eq=False)
class Reach(OfKept):
    """A goal that others exclude, and its best number where they are met.

    Attributes
    ----------
    goal : Goal
        The one that is given up.
    """

    goal: Goal

    without = declare.computed(declare.word("goal that is given up, as typed", label="without the goal", column=KEY))(
        lambda reach: reach.goal.typed
    )
    value: float = declare.number(
        OF_NUMBER, "its number at best; none where the others were not met", label="it comes to", column=KEY
    )

    @declare.computed(declare.number(OF_NUMBER, "what its limit lacks", label="its limit would move by", column=MAIN))
    def lacks(self) -> float:
        """Distance by which its limit would have to move, SI."""
        return max(self.goal.low - self.value, self.value - self.goal.high)

    run: DesignRun = declare.part(DesignRun, "where", inline=True)

    at = declare.computed(declare.word("where", label="at", column=MORE, in_document=False))(
        lambda reach: reach.run.plan.at(reach.run.row)
    )


@declare.dataclass(eq=False)
class Conflict:
    """Goals that exclude each other: the fewest, since without any one of them the others can be met.

    Attributes
    ----------
    goals : tuple of Goal
        The fewest.
    """

    goals: tuple[Goal, ...]

    typed = declare.computed(declare.word("the fewest goals that exclude each other", key="goals"))(
        lambda conflict: [goal.typed for goal in conflict.goals]
    )
    reaches: tuple[Reach, ...] = declare.rows(Reach, "what each comes to under the others", key="reachable")


def conflict_of(runs: DesignRuns) -> Conflict:
    """Return the goals that exclude each other. Source: ``chinneck-dravnieks-1991``."""
    goals = list(runs.plan.goals)
    names = runs.plan.evaluation.names
    for salt, goal in enumerate(runs.plan.goals, 1):
        rest = [other for other in goals if other is not goal]
        if not rest:
            continue
        merit = margin_merit(rest, names)
        least = float(merit(runs.numbers).min())
        if least > 0.0:  # no run meets the rest yet: a search ends where one does
            best = search(runs, merit, 0.0, salt)
            least = float(merit(runs.numbers)[best])
        goals = rest if least > 0.0 else goals
    reaches = []
    for salt, goal in enumerate(goals, len(runs.plan.goals) + 1):
        checks = [check for check in runs.plan.goals if check.is_check and check not in goals]
        others = [*(other for other in goals if other is not goal), *checks]
        merit = reach_merit(goal, others, names)
        run = search(runs, merit, salt=salt)
        met = float(merit(runs.numbers)[run]) < INFEASIBLE
        value = float(runs.numbers[run, names.index(goal.number)]) if met else np.nan
        where = DesignRun(runs.plan, run, runs.rows[run], runs.numbers[run])
        reaches.append(Reach(runs.plan.kept(goal.number), goal, value, where))
    return Conflict(tuple(goals), tuple(reaches))


def trade_off_search(runs: DesignRuns, salt: int) -> None:
    """Search for the front of all objectives by optuna; ``salt`` separates the random numbers of searches.

    Source: ``ozaki-2022``.
    """
    import optuna

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    plan = runs.plan
    seed = int(np.random.SeedSequence(plan.seed, spawn_key=(salt,)).generate_state(1)[0])
    sampler = optuna.samplers.TPESampler(seed=seed)
    study = optuna.create_study(directions=["minimize"] * len(plan.objectives), sampler=sampler)
    where = _distributions(plan)
    for row, numbers in zip(runs.rows, runs.numbers, strict=True):
        values, missed = _judged(runs, numbers)
        if values:
            study.add_trial(_finished(plan, row, where, values, missed))
    runs.most = len(runs.rows) + plan.runs
    for asked in range(0, plan.runs, TOGETHER):
        trials = [study.ask(where) for _ in range(min(TOGETHER, plan.runs - asked))]
        rows = [plan.row_at([float(trial.params[name]) for name in where]) for trial in trials]
        for trial, numbers in zip(trials, runs.of(rows), strict=True):
            values, missed = _judged(runs, numbers)
            for name, share in missed.items():
                trial.set_constraint(name, share)
            study.tell(trial, values, optuna.trial.TrialState.COMPLETE if values else optuna.trial.TrialState.FAIL)


def _distributions(plan: DesignPlan) -> dict[str, Any]:
    """Return the distribution of each variable: places of a range, numbers of a list, words without an order."""
    from optuna.distributions import CategoricalDistribution, FloatDistribution, IntDistribution

    found: dict[str, Any] = {}
    for variable, (low, high) in zip(plan.variables, plan.bounds, strict=True):
        if variable.is_range:
            found[variable.path] = FloatDistribution(low, high)
        elif variable.words:
            found[variable.path] = CategoricalDistribution(range(int(high) + 1))
        else:
            found[variable.path] = IntDistribution(int(low), int(high))
    return found


def _judged(runs: DesignRuns, numbers: Array) -> tuple[list[float] | None, dict[str, float]]:
    """Return the objectives of a run, to be minimized, if it has them all, and its miss of each goal."""
    plan, names = runs.plan, runs.plan.evaluation.names
    values = [objective.sign * float(numbers[names.index(objective.number)]) for objective in plan.objectives]
    missed = np.nan_to_num(-shares_of(plan.goals, names, numbers[None])[0], nan=FAR)
    return values if np.isfinite(values).all() else None, {str(k): float(share) for k, share in enumerate(missed)}


def _finished(
    plan: DesignPlan, row: tuple[Any, ...], where: dict[str, Any], values: Sequence[float], missed: dict[str, float]
) -> optuna.trial.FrozenTrial:
    """Return a finished run as optuna takes it."""
    import optuna

    places = zip(where, plan.place_of(row), plan.whole, strict=True)
    at = {name: round(place) if whole else float(place) for name, place, whole in places}
    return optuna.trial.create_trial(params=at, distributions=where, values=values, constraints=missed)


def goals_met(runs: DesignRuns) -> bool:
    """Search for a setting that meets all goals, and tell whether there is one; its margin is maximized alone."""
    plan = runs.plan
    if not plan.goals:
        return True
    merit = margin_merit(plan.goals, plan.evaluation.names)
    enough = 0.0 if plan.objectives else -math.inf
    best = search(runs, merit, enough)
    return float(merit(runs.numbers)[best]) <= 0.0


def ranking(runs: DesignRuns) -> Merit:
    """Return the merit by which settings are ranked, after the searches that the objectives need."""
    plan, names = runs.plan, runs.plan.evaluation.names
    if not plan.objectives or (plan.goals and not runs.meet()):
        return margin_merit(plan.goals, names)
    salt = 2 * len(plan.goals) + 1
    if plan.search == OPTUNA:
        trade_off_search(runs, salt)
        return weighted_merit(runs, plan.objectives, front(runs, plan.objectives), WEIGHTS[1])
    merits = [objective_merit(objective, plan.goals, names) for objective in plan.objectives]
    for number, merit in enumerate(merits):
        search(runs, merit, salt=salt + number)
    if len(merits) == 1:
        return merits[0]
    ends = front(runs, plan.objectives)
    salt += len(merits)
    between = [weighted_merit(runs, plan.objectives, ends, weight) for weight in WEIGHTS]
    for number, merit in enumerate(between if len(merits) == 2 else between[1:2]):
        search(runs, merit, salt=salt + number)
    return between[1]


def weighted_merit(runs: DesignRuns, objectives: tuple[Objective, ...], ends: list[int], weight: float) -> Merit:
    """Return the merit of several objectives together: the largest of them, each over its extent on the Pareto front.

    The first has the weight, the others share the rest (Tchebycheff's norm, which reaches every point of a front).
    """
    names, goals = runs.plan.evaluation.names, runs.plan.goals
    places = [names.index(objective.number) for objective in objectives]
    signs = np.array([one.sign for one in objectives])
    known = runs.numbers[ends][:, places] * signs
    low, extent = known.min(axis=0), np.ptp(known, axis=0)
    weights = np.array([weight, *[(1.0 - weight) / (len(places) - 1)] * (len(places) - 1)])
    scale = weights / np.where(extent > 0.0, extent, 1.0)

    def merit(numbers: Array) -> Array:
        value = ((numbers[:, places] * signs - low) * scale).max(axis=1)
        return under(np.nan_to_num(value, nan=INFEASIBLE), goals, names, numbers)

    return merit
