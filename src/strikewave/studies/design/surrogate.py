"""A search with few runs: each next one where a Gaussian process of those before expects the most.

A process is fitted to each number. Of some runs that are chosen together, so that workers share them, the first lies
where the numbers are expected best, the others where the merit is expected to improve most (expected improvement, Jones
et al. 1998), by draws of the numbers, since a merit of several is none of a normal distribution.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.studies.design.gaussian_process import GaussianProcess, fitted_process
from strikewave.studies.design.plan import DesignPlan
from strikewave.studies.design.runs import DesignRuns, Merit
from strikewave.studies.engine.plan import sobol_sequence

Array = NDArray[np.float64]

BEGIN_PER_SETTING, BEGIN_LEAST = 4, 8
"""Runs that fill the ranges before anything is expected, for each setting and at least, as a power of two. Chosen: less
than half of the ten for each that are usual where a process shall be right everywhere."""
TOGETHER = 4
"""Runs that are chosen together: the same whatever the workers, so that they change no bit."""
DRAWS = 32
"""Draws of the numbers at a place: the mean improvement is then known to a fifth, far better than the process is."""
GENERATIONS, PER_SETTING = 40, 12
"""Of the search over the process, which costs a hundredth of a second each."""


class SurrogateError(NamedTuple):
    """How well a number of a run is known by all others.

    Attributes
    ----------
    name : str
        Of the number.
    error : float
        Root mean square of what is left, SI; NaN where too few runs have the number.
    share : float
        The same over the standard deviation of the number over the runs.
    """

    name: str
    error: float
    share: float


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


def left_out_errors(runs: DesignRuns) -> tuple[SurrogateError, ...]:
    """Return the leave-one-out error of each number."""
    names, found = runs.plan.evaluation.names, processes(runs)
    if found is None:
        return tuple(SurrogateError(name, np.nan, np.nan) for name in names)
    errors = [float(np.sqrt(np.mean(one.left_out() ** 2))) for one in found]
    spreads = [float(np.std(one.values)) for one in found]
    shares = [error / spread if spread > 0.0 else 0.0 for error, spread in zip(errors, spreads, strict=True)]
    return tuple(map(SurrogateError, names, errors, shares))


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
        popsize=PER_SETTING,
        rng=source,
        polish=False,
        vectorized=True,
        updating="deferred",
    )
    return np.asarray(end.x)
