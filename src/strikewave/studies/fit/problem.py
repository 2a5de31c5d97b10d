"""A fit as a problem of least squares: experiments, each a case with its settings and what was measured of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError
from strikewave.cases.case import Case
from strikewave.studies.fit.estimation import (
    FINAL_STEP,
    ROUGH,
    Estimate,
    ResidualBlock,
    Search,
    autocorrelation,
    enough_shots,
    estimate,
    independent_count,
)
from strikewave.studies.fit.free_fields import FreeField, case_at
from strikewave.studies.fit.measured import Measured, MeasuredNumber, MeasuredPulse
from strikewave.studies.fit.simulation import Simulation

Array = NDArray[np.float64]

CHANCE = 1e-3
"""Probability with which noise alone makes a residual that is said to be more than noise."""
ALIKE = 1e-2
"""Share by which sums of squares may differ, or number where they are below 1, and be the same: far below chance."""
UNFELT = 1e-7
"""Slope of the residuals along a field, over the largest, below which it changes nothing that was measured."""


@dataclass(frozen=True, eq=False)
class Experiment:
    """A setting of the case, and all that was measured at it: one run serves it all.

    Attributes
    ----------
    case : Case
        With its settings; the free fields stand where the search begins.
    changes : tuple of str
        In what it differs from the case that is fitted, ``path=value`` each.
    measured : tuple of (MeasuredNumber or MeasuredPulse)
        What was measured.
    """

    case: Case
    changes: tuple[str, ...]
    measured: tuple[Measured, ...]


@dataclass(frozen=True)
class Misfit:
    """What is left of one measured thing, over its noise.

    Attributes
    ----------
    called : str
        What it is called.
    size : float
        Root mean square of the residual over the standard deviation of its noise, or its standard uncertainty.
    share : float
        Root mean square of the residual over the peak, or over the number.
    independent : float
        Independent samples that the residual has.
    more_than_noise : bool
        Whether noise alone leaves so much once in a thousand times at most.
    is_number : bool
        Whether it is a stated number, not a record.
    noise_known : bool
        Whether the noise of the record is known; else it is taken as `strikewave.studies.fit.measured.QUIETEST`.
    """

    called: str
    size: float
    share: float
    independent: float
    more_than_noise: bool
    is_number: bool = False
    noise_known: bool = True


class Problem:
    """Experiments and free fields, as residuals over the unit cube.

    Parameters
    ----------
    experiments : sequence of Experiment
        What is fitted to.
    fields : sequence of FreeField
        What is free.
    """

    def __init__(self, experiments: Sequence[Experiment], fields: Sequence[FreeField]) -> None:
        self.experiments, self.fields = tuple(experiments), tuple(fields)

    @property
    def measured(self) -> list[Measured]:
        """All that was measured, in the order of the residuals."""
        return [one for experiment in self.experiments for one in experiment.measured]

    @property
    def slow(self) -> bool:
        """Whether a run takes seconds: of elements."""
        return any(one.case.command == "fem" for one in self.experiments)

    @property
    def start(self) -> Array:
        """Place of the case in the unit cube."""
        return np.array([field.place(field.value.si) for field in self.fields])

    def runs(self, place: Array) -> list[Simulation]:
        """Return a run of each experiment at a place."""
        return [Simulation(case_at(one.case, self.fields, place)) for one in self.experiments]

    def residuals(self, place: Array) -> Array:
        """Return all residuals at a place."""
        parts = [
            measured.residuals(run)
            for experiment, run in zip(self.experiments, self.runs(place), strict=True)
            for measured in experiment.measured
        ]
        return np.concatenate(parts)

    def rows(self) -> list[slice]:
        """Return where the residuals of each measured thing stand."""
        ends = np.cumsum([0, *(1 if isinstance(one, MeasuredNumber) else one.time.size for one in self.measured)])
        return [slice(int(a), int(b)) for a, b in pairwise(ends)]

    def misfits(self, residuals: Array) -> list[Misfit]:
        """Return what is left of each measured thing, and whether that is more than noise."""
        from scipy.stats import f

        found = []
        for one, rows in zip(self.measured, self.rows(), strict=True):
            left = residuals[rows]
            size = math.sqrt(float(left @ left) / left.size)
            if isinstance(one, MeasuredNumber):
                found.append(Misfit(one.called, size, size * one.uncertainty / abs(one.value), 1.0, False, True))
                continue
            count = max(independent_count(left.size, one.correlation) - 1.0, 1.0)  # the shift takes one
            quiet = independent_count(one.quiet, one.correlation) if one.quiet else math.inf
            limit = float(f.ppf(1.0 - CHANCE, count, min(quiet, 1e9)))
            share = size * one.deviation / float(np.max(np.abs(one.values)))
            found.append(Misfit(one.called, size, share, count, size**2 > limit, noise_known=bool(one.quiet)))
        return found

    def blocks(self, residuals: Array) -> list[ResidualBlock]:
        """Return the correlation of the residuals: that of the noise, or of what is left where that is more."""
        blocks = []
        shots = iter(range(len(self.measured)))
        for one, rows, misfit in zip(self.measured, self.rows(), self.misfits(residuals), strict=True):
            correlation = one.correlation
            if misfit.more_than_noise:
                correlation = misfit.size**2 * autocorrelation(residuals[rows])
            offset = one.offset if isinstance(one, MeasuredPulse) else 0.0
            blocks.append(ResidualBlock(rows, correlation, next(shots), offset))
        return blocks

    def freedom(self, residuals: Array) -> float:
        """Return the degrees of freedom of the covariance."""
        blocks, size = self.blocks(residuals), len(self.fields)
        if enough_shots(blocks, size):
            return float(len(blocks) - size)
        misfits = [one for one in self.misfits(residuals) if one.more_than_noise]
        if not misfits:  # as well as the noise is known that the quiet before the pulse shows
            quiet = [
                independent_count(one.quiet, one.correlation)
                for one in self.measured
                if isinstance(one, MeasuredPulse) and one.quiet
            ]
            return sum(quiet) or math.inf
        left = [
            independent_count(residuals[block.rows].size, block.correlation)
            for block in blocks
            if block.correlation.size > 1
        ]
        return max(sum(left) - size, 1.0)

    def reweighted(self, residuals: Array) -> Problem:
        """Return the problem with records weighted by what is left of them, where that is more than their noise."""
        misfits = iter(self.misfits(residuals))
        experiments = []
        for experiment in self.experiments:
            measured: list[Measured] = []
            for one in experiment.measured:
                misfit = next(misfits)
                heavy = isinstance(one, MeasuredPulse) and misfit.more_than_noise
                measured.append(one.reweighted(one.deviation * misfit.size) if heavy else one)  # type: ignore[union-attr]
            experiments.append(replace(experiment, measured=tuple(measured)))
        return Problem(experiments, self.fields)


@dataclass(frozen=True, eq=False)
class Solved:
    """A problem, as weighted and as stated, with its best place, other places that fit as well, and its runs."""

    problem: Problem
    stated: Problem
    estimate: Estimate
    misfits: tuple[Misfit, ...]
    others: tuple[Array, ...]
    runs: int
    stopped: bool
    search: Search


def solve(problem: Problem, advance: Callable[[int, float], None] | None = None) -> Solved:
    """Find the best place, and what the data say of it.

    Ctrl-C ends the search at the best place so far.

    Raises
    ------
    InputError
        If the case itself cannot be run, or a field changes nothing that was measured.
    """
    search, stopped, ends = Search(problem.residuals, len(problem.fields), advance), False, list[tuple[Array, Array]]()
    first = search.begin(problem.start)
    try:
        _check_felt(problem, search, first)
        ends = [search.descend(problem.start, accuracy=ROUGH)] if problem.slow else search.wide(problem.start)
        place, residuals = _nearest(ends, problem.start)
        heavier = problem.reweighted(residuals)
        if len(problem.measured) > 1 and any(one.more_than_noise for one in problem.misfits(residuals)):
            again = Search(heavier.residuals, len(problem.fields), advance)
            again.begin(place)
            place, _ = again.descend(place)
            again.runs += search.runs
            search, used = again, heavier
        else:
            used = problem
    except KeyboardInterrupt:
        assert search.best is not None
        place, stopped, used = search.best[1], True, problem
    residuals = used.residuals(place)
    jacobian = search.slopes(place, residuals, FINAL_STEP, both=True)
    found = estimate(place, residuals, jacobian, used.blocks(residuals), used.freedom(residuals))
    others = _others(ends, found)
    own = residuals if used is problem else problem.residuals(place)  # misfits are over the noise, not the new weights
    return Solved(used, problem, found, tuple(problem.misfits(own)), others, search.runs, stopped, search)


def _check_felt(problem: Problem, search: Search, first: Array) -> None:
    """Refuse a field that changes nothing that was measured."""
    sizes = np.linalg.norm(search.slopes(problem.start, first, FINAL_STEP), axis=0)
    for field, size in zip(problem.fields, sizes, strict=True):
        if size <= UNFELT * max(float(np.max(sizes)), np.finfo(float).tiny):
            raise InputError("--free", field.path, "a field that changes what was measured", "leave it out")


def _nearest(ends: Sequence[tuple[Array, Array]], start: Array) -> tuple[Array, Array]:
    """Return the end of the searches that fits best; of those that fit as well, the one nearest to the start."""
    misfits = [float(residuals @ residuals) for _, residuals in ends]
    alike = [end for end, misfit in zip(ends, misfits, strict=True) if misfit <= min(misfits) * (1.0 + ALIKE) + ALIKE]
    return min(alike, key=lambda end: float(np.linalg.norm(end[0] - start)))


def _others(ends: Sequence[tuple[Array, Array]], found: Estimate) -> tuple[Array, ...]:
    """Return ends of other searches that fit as well within chance and lie apart along what is determined."""
    others: list[Array] = []
    kept = np.eye(found.place.size) - found.undetermined @ found.undetermined.T
    scale = max(found.misfit / max(found.residuals.size, 1), 1.0)
    for place, residuals in ends:
        rise = float(residuals @ residuals) - found.misfit
        apart = float(np.linalg.norm(kept @ (place - found.place)))
        if rise < found.reach**2 * scale and apart > max(10.0 * math.sqrt(np.trace(found.covariance)), 1e-3):
            others.append(place)
    return tuple(others)
