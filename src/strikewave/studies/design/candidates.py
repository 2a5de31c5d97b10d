"""The settings that are ranked: apart from each other, with what their tolerances leave of the goals, and verified."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.result import RUN_BROKEN, status_of, worse
from strikewave.base.shock_quantities import RATIO
from strikewave.studies.design.goals import Goal, Objective, shares_of
from strikewave.studies.design.plan import DesignPlan
from strikewave.studies.design.runs import DesignRuns
from strikewave.studies.engine.evaluation import Job, Row
from strikewave.studies.engine.plan import DrawVariation, drawn_rows
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.runner import carry_out
from strikewave.studies.engine.store import RunStore
from strikewave.uncertainty.draws import tolerances_of

Array = NDArray[np.float64]

MOST_CANDIDATES = 8
"""Settings that are ranked: a table of a screen."""
APART = 0.1
"""Least distance of two ranked settings, in shares of the range of one of them: nearer ones are the same to a maker.
Of values of a list, any other one counts."""
STEP = 0.01
"""Step of a setting by which slopes are found, as a share of its range: ten of the steps between which no settings are
tried, so that the rounding of settings is a tenth of it at most."""


@declare.dataclass
class Robustness:
    """Of draws within the tolerances of a setting, how many meet all goals."""

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
        """Low and high end."""
        return [self.low, self.high]


@dataclass(frozen=True)
class DesignCandidate:
    """A setting that is ranked.

    Attributes
    ----------
    run : int
        Number of its run, from 0.
    row : tuple of float
        Its settings.
    numbers : ndarray
        SI, in the order of the evaluation.
    shares : ndarray
        Margin of each goal, see `Goal.share`.
    verified : ndarray or None
        Margins by the run that verifies it; NaN where that has no such number. None where there is none.
    failure : str
        Why the run that verifies it failed; empty where it did not.
    robustness : Robustness or None
        None where it was not asked for.
    verdict : str
        What the checks of its run came to, of that which verifies it where this one's came to worse: the text of
        `strikewave.base.result.Verdict`.
    """

    run: int
    row: Row
    numbers: Array
    shares: Array
    verified: Array | None = None
    failure: str = ""
    robustness: Robustness | None = None
    verdict: str = ""

    @property
    def margin(self) -> float:
        """The least of its margins; infinite where there is no goal."""
        return float(self.shares.min(initial=math.inf))

    @property
    def meets(self) -> bool:
        """Whether it meets all goals, and does so when it is verified."""
        return self.margin >= 0.0 and self.holds

    @property
    def holds(self) -> bool:
        """Whether its runs failed no check, and no margin falls below zero when it is verified."""
        return self.confirmed and not self.breaks

    @property
    def confirmed(self) -> bool:
        """Whether no margin falls below zero by the run that verifies it, whatever the checks of its runs say."""
        return not self.failure and (self.verified is None or not bool((self.verified < 0.0).any()))

    @property
    def breaks(self) -> bool:
        """Whether one of its runs failed a check."""
        return status_of(self.verdict) == RUN_BROKEN


def chosen_runs(runs: DesignRuns, merit: Array) -> list[int]:
    """Return the runs that are ranked, the smallest merit first, each `APART` from those before it.

    Those that meet no goal are only taken where none does, and then the nearest alone; those that failed a check
    where all that meet the goals did.
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
    """Return the margins of rows by the runs that verify them, shape (rows, goals), why some failed, and verdicts."""
    if plan.verifying is None:
        return None, [""] * len(rows), [""] * len(rows)
    better, _ = plan.verifying
    finished = carry_out(better.job, rows, store, pool)
    numbers, failures, _ = store.table(better.evaluation.names, finished.keys)
    margins = np.full((len(rows), len(plan.goals)), np.nan)
    shares = shares_of(better.goals, better.evaluation.names, numbers)
    for k, goal in enumerate(better.goals):
        margins[:, plan.goals.index(goal)] = shares[:, k]
    return margins, failures, store.verdicts(finished.keys).texts


def robustness_of(plan: DesignPlan, row: Row, store: RunStore, pool: Pool) -> Robustness:
    """Return how many draws within the tolerances of a setting meet all goals, and fail no check.

    Source: ``clopper-pearson-1934``.

    Raises
    ------
    InputError
        If the case has no tolerance that a run feels.
    """
    from scipy.stats import binomtest

    case = plan.case_of(row)
    inputs = tolerances_of(case)
    drawn = drawn_rows(inputs, plan.robust, plan.seed)
    finished = carry_out(Job(DrawVariation(case, inputs), plan.evaluation), drawn, store, pool)
    numbers, _, _ = store.table(plan.evaluation.names, finished.keys)
    least = shares_of(plan.goals, plan.evaluation.names, numbers).min(axis=1, initial=math.inf)
    passed = np.array([status_of(text) != RUN_BROKEN for text in store.verdicts(finished.keys).texts])
    met = int(np.sum((least >= 0.0) & passed))
    interval = binomtest(met, plan.robust).proportion_ci(0.95, "exact")
    return Robustness(met, plan.robust, float(interval.low), float(interval.high))


@dataclass(frozen=True)
class Sensitivity:
    """How the numbers of the goals move with a setting, about the best one.

    Attributes
    ----------
    path : str
        Of the setting.
    step : float
        Between the two runs that it is found by, SI.
    changes : ndarray
        Change of each number per `STEP` of the range of the setting, SI.
    room : tuple of float
        How far the setting may be moved down and up till a goal is missed, SI, where the numbers go on as they do here.
    """

    path: str
    step: float
    changes: Array
    room: tuple[float, float]


def sensitivities(runs: DesignRuns, best: int) -> tuple[Sensitivity, ...]:
    """Return the sensitivities of all settings that have a range, by runs on either side of the best one."""
    plan, row = runs.plan, runs.rows[best]
    place, names, found = plan.place_of(row), plan.evaluation.names, list[Sensitivity]()
    ranges = [k for k, one in enumerate(plan.variables) if one.is_range]
    pairs = []
    for k in ranges:
        ends = []
        for way in (-STEP, STEP):
            moved = place.copy()
            moved[k] = min(max(moved[k] + way, 0.0), 1.0)
            ends.append(plan.row_at(moved))
        pairs.append(ends)
    numbers = runs.of([one for ends in pairs for one in ends])
    at_best = runs.of([row])[0]
    for number, (k, ends) in enumerate(zip(ranges, pairs, strict=True)):
        apart = plan.place_of(ends[1])[k] - plan.place_of(ends[0])[k]
        step = ends[1][k] - ends[0][k]
        slopes = (numbers[2 * number + 1] - numbers[2 * number]) / step
        room = _room(plan.goals, names, at_best, slopes)
        found.append(Sensitivity(plan.variables[k].path, step, slopes * step * STEP / apart, room))
    return tuple(found)


def _room(goals: Sequence[Goal], names: Sequence[str], numbers: Array, slopes: Array) -> tuple[float, float]:
    """Return how far a setting may go down and up till the first goal is missed; NaN where one is missed already.

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
    """Return the runs that meet all goals and that no other such run beats in all objectives, by the first of them.

    Those that failed a check are taken where all that meet the goals did.
    """
    plan, names = runs.plan, runs.plan.evaluation.names
    least = shares_of(plan.goals, names, runs.numbers).min(axis=1, initial=math.inf)
    values = np.column_stack([one.sign * runs.numbers[:, names.index(one.number)] for one in objectives])
    able = _sound(runs, np.flatnonzero((least >= 0.0) & np.isfinite(values).all(axis=1)))
    kept = [run for run in able if not _beaten(values[run], values[able])]
    return sorted(map(int, kept), key=lambda run: float(values[run, 0]))


def _beaten(value: Array, others: Array) -> bool:
    return bool(((others <= value).all(axis=1) & (others < value).any(axis=1)).any())


def ranked_candidates(runs: DesignRuns, ranked: list[int], store: RunStore, pool: Pool) -> tuple[DesignCandidate, ...]:
    """Return the ranked settings with what verifies them; those that hold first, the most robust of them first."""
    plan = runs.plan
    rows = [runs.rows[run] for run in ranked]
    margins, failures, verdicts = verified(plan, rows, store, pool)
    shares = shares_of(plan.goals, plan.evaluation.names, runs.numbers)
    found = [
        DesignCandidate(
            run,
            row,
            runs.numbers[run],
            shares[run],
            None if margins is None else margins[k],
            failures[k],
            robustness_of(plan, row, store, pool) if plan.robust else None,
            worse(runs.verdicts[run], verdicts[k]),
        )
        for k, (run, row) in enumerate(zip(ranked, rows, strict=True))
    ]
    return tuple(sorted(found, key=lambda one: (not one.holds, -one.robustness.share if one.robustness else 0.0)))
