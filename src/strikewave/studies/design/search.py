"""The search for settings: differential evolution whose generations are runs of the engine.

Every run is kept, so that a search that was stopped asks for the same rows again and finds them, a later search of the
same case begins with what earlier ones found, and runs of a generation share the processes. With goals alone the least
of the margins is made as large as it can be: below zero it says by how much all limits at once must be widened. With an
objective a setting that meets all goals beats any that does not, of two that do the better one wins, and of two that do
not the one whose worst goal is missed by less (Deb 2000). Its last runs go from the best setting to the end of the
valley that it lies in: see `strikewave.studies.design.refining`.
"""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray

from strikewave.studies.design.refining import SHARE, refine
from strikewave.studies.design.runs import DesignRuns, Merit
from strikewave.studies.design.surrogate import surrogate_search
from strikewave.studies.engine.plan import sobol_sequence

Array = NDArray[np.float64]

PER_SETTING, SMALLEST = 8, 16
"""Settings of a generation for each one that is varied, and at least: the ten for each of Storn & Price 1997, as the
power of two that fills the ranges evenly."""
SETTLED = 1e-3
"""Spread of the merits of a generation over their mean at which a search ends."""


def search(runs: DesignRuns, merit: Merit, enough: float = -np.inf, salt: int = 0) -> int:
    """Search for the smallest merit, and return the number of the best run.

    It begins with the best runs that there are, and with settings that fill the ranges evenly. Where the plan has few
    runs, Gaussian processes say where: see `strikewave.studies.design.surrogate`.

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
