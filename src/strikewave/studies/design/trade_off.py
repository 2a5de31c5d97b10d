"""A search for a whole trade-off at once: each next run where a model of those before expects a better front.

The search is optuna's: of each setting two densities are estimated, of the runs nearest the front and of the others,
and what is likely by the first and not by the second is run next (tree-structured Parzen estimator). Runs that miss a
goal rank behind all that meet theirs, by how much they miss.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.studies.design.goals import shares_of
from strikewave.studies.design.plan import DesignPlan
from strikewave.studies.design.runs import FAR, DesignRuns

if TYPE_CHECKING:
    import optuna

Array = NDArray[np.float64]

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
