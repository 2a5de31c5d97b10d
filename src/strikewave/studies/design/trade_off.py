"""A search for a whole trade-off at once: each next run where a model of those before expects a better front.

The search is optuna's: of each setting two densities are estimated, of the runs nearest the front and of the others,
and what is likely by the first and not by the second is run next (tree-structured Parzen estimator). Runs that miss a
goal rank behind all that meet theirs, by how much they miss.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.studies.design.candidates import front
from strikewave.studies.design.goals import Objective, shares_of
from strikewave.studies.design.plan import OPTUNA, DesignPlan
from strikewave.studies.design.runs import (
    FAR,
    INFEASIBLE,
    DesignRuns,
    Merit,
    margin_merit,
    objective_merit,
    under,
)
from strikewave.studies.design.search import search

if TYPE_CHECKING:
    import optuna

Array = NDArray[np.float64]

WEIGHTS = (0.25, 0.5, 0.75)
"""Weights of the first of two objectives, between the ends of their front, at which it is searched for besides."""
TOGETHER = 8
"""Runs that are chosen together: the same whatever the workers, so that they change no bit."""


def trade_off_search(runs: DesignRuns, salt: int) -> None:
    """Search for the front of all objectives; what is run is added to the runs.

    Source: ``ozaki-2022``.

    Parameters
    ----------
    runs : DesignRuns
        What was run, and tells where to begin.
    salt : int
        Tells the random numbers of several searches apart.
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
    """Return where each variable may lie: places of a range, numbers of a list, words without an order."""
    from optuna.distributions import CategoricalDistribution, FloatDistribution, IntDistribution

    found: dict[str, Any] = {}
    for one, (low, high) in zip(plan.variables, plan.bounds, strict=True):
        if one.is_range:
            found[one.path] = FloatDistribution(low, high)
        elif one.words:
            found[one.path] = CategoricalDistribution(range(int(high) + 1))
        else:
            found[one.path] = IntDistribution(int(low), int(high))
    return found


def _judged(runs: DesignRuns, numbers: Array) -> tuple[list[float] | None, dict[str, float]]:
    """Return the objectives of a run, all to be small, if it has them all, and by how much it misses each goal."""
    plan, names = runs.plan, runs.plan.evaluation.names
    values = [one.sign * float(numbers[names.index(one.number)]) for one in plan.objectives]
    missed = np.nan_to_num(-shares_of(plan.goals, names, numbers[None])[0], nan=FAR)
    return values if np.isfinite(values).all() else None, {str(k): float(share) for k, share in enumerate(missed)}


def _finished(
    plan: DesignPlan, row: tuple[Any, ...], where: dict[str, Any], values: Sequence[float], missed: dict[str, float]
) -> optuna.trial.FrozenTrial:
    """Return a run that was made before as the search takes it."""
    import optuna

    places = zip(where, plan.place_of(row), plan.whole, strict=True)
    at = {name: round(place) if whole else float(place) for name, place, whole in places}
    return optuna.trial.create_trial(params=at, distributions=where, values=values, constraints=missed)


def goals_met(runs: DesignRuns) -> bool:
    """Search for what meets all goals, and tell whether it was found; without objectives, with the largest margin."""
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
    merits = [objective_merit(one, plan.goals, names) for one in plan.objectives]
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
    places = [names.index(one.number) for one in objectives]
    signs = np.array([one.sign for one in objectives])
    known = runs.numbers[ends][:, places] * signs
    low, extent = known.min(axis=0), np.ptp(known, axis=0)
    weights = np.array([weight, *[(1.0 - weight) / (len(places) - 1)] * (len(places) - 1)])
    scale = weights / np.where(extent > 0.0, extent, 1.0)

    def merit(numbers: Array) -> Array:
        value = ((numbers[:, places] * signs - low) * scale).max(axis=1)
        return under(np.nan_to_num(value, nan=INFEASIBLE), goals, names, numbers)

    return merit
