"""The last steps of a search: about the best setting the numbers are taken as parabolas, and the best of these is run.

A generation fills the ranges, and says which valley is the deepest; to the ends of the ranges, along a ridge where two
goals are missed alike, and to the last per cent of a valley it comes slowly. Here the numbers, not the merit, are
modelled: they are smooth where the merit has edges. The steps stay within a box that grows where the model was right
and shrinks where it was not.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from strikewave.studies.design.plan import RESOLUTION
from strikewave.studies.design.runs import DesignRuns, Merit
from strikewave.studies.engine.plan import sobol_sequence

Array = NDArray[np.float64]

SHARE = 4
"""Share of the runs of a search, one in so many, that is left for its last steps at least. Chosen: of 150 runs over two
settings a quarter came to the same best setting with each of the seeds that were tried."""
WIDEST, GROWS, SHRINKS = 0.2, 2.0, 0.4
"""Half width of the first box and of the widest, in shares of the ranges; by what it grows and shrinks."""
STENCIL = 0.5
"""Distance of the runs that the parabolas go through from the middle, over the half width of the box."""
DRAWS = 4096
"""Settings of the box of which the model says the best: a few per cent of its width apart in three settings."""
BEYOND = 1.3
"""How far draws reach beyond the box, to be set back to its faces: the best often lies there, at the end of a range."""
TRIED = 3
"""Settings that are run of those that the model calls the best: a model errs, and runs share the processes."""


def refine(runs: DesignRuns, merit: Merit, enough: float, most: int) -> None:
    """Go on from the best run while a better one is found, or until so many runs are made.

    Parameters
    ----------
    runs : DesignRuns
        What was run; what is run is added.
    merit : callable
        What is to be made small.
    enough : float
        Merit at which it ends.
    most : int
        Number of runs, with those before, that are not exceeded.
    """
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
    even = BEYOND * width * (2.0 * sobol_sequence(settings, DRAWS, seed) - 1.0)
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
