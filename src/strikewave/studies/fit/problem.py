"""A fit as a problem of least squares: experiments, each a case with its settings and what was measured of it."""

from __future__ import annotations

import functools
import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError, StrikewaveError
from strikewave.cases.case import Case
from strikewave.studies.engine.case_evaluation import numbers_of
from strikewave.studies.fit.covariance import Estimate, ResidualBlock, estimate
from strikewave.studies.fit.estimation import FINAL_STEP, ROUGH, Search
from strikewave.studies.fit.fast_run import FastRun, runs_fast
from strikewave.studies.fit.free_fields import FreeField, case_at
from strikewave.studies.fit.measured import Measured, MeasuredNumber, MeasuredPulse
from strikewave.studies.fit.noise import independent_count
from strikewave.studies.fit.transits import stairs
from strikewave.studies.simulation import Simulation
from strikewave.uncertainty.runs import or_none

Array = NDArray[np.float64]

CHANCE = 1e-3
"""Probability with which noise alone makes a residual that is said to be more than noise."""
ALIKE = 1e-2
"""Share by which sums of squares may differ, or number where they are below 1, and be the same: far below chance."""
FAINT_SLOPE = 1e-4
"""Slope of a record along a direction, over the largest, from which on its own best values follow the residual."""
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
    scatters : bool
        Whether it is noise with values of its own: then the shots differ, and the model need lack nothing.
    """

    called: str
    size: float
    share: float
    independent: float
    more_than_noise: bool
    is_number: bool = False
    noise_known: bool = True
    scatters: bool = False


class Problem:
    """Experiments and free fields, as residuals over the unit cube.

    Parameters
    ----------
    experiments : sequence of Experiment
        What is fitted to.
    fields : sequence of FreeField
        What is free.
    simulate : callable, optional
        Runs a case.
    """

    def __init__(
        self,
        experiments: Sequence[Experiment],
        fields: Sequence[FreeField],
        simulate: Callable[[Case], Simulation] = Simulation,
    ) -> None:
        self.experiments, self.fields, self._simulate = tuple(experiments), tuple(fields), simulate

    def fast(self) -> Problem | None:
        """Return the problem with fast runs, where these give all that was measured; else None."""
        given = all(
            runs_fast(experiment.case)
            and all(
                isinstance(one, MeasuredNumber) and one.name in numbers_of(experiment.case, "fast")
                for one in experiment.measured
            )
            for experiment in self.experiments
        )
        found = Problem(self.experiments, self.fields, FastRun) if given else None
        return None if found is None or or_none(found.residuals, self.start) is None else found

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

    @functools.cached_property
    def stairs(self) -> Array:
        """By how much each field moves until the runs feel it, in the unit cube: see `transits.stairs`."""
        paths = [field.path for field in self.fields]
        shares = np.max([stairs(one.case, paths) for one in self.experiments], axis=0)
        sizes = [(1.0 if field.log else abs(field.value.si)) / field.width for field in self.fields]
        return np.multiply(shares, sizes)

    def runs(self, place: Array) -> list[Simulation]:
        """Return a run of each experiment at a place."""
        return [self._simulate(case_at(one.case, self.fields, place)) for one in self.experiments]

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

    def shots(self) -> list[int]:
        """Return the number of the shot that each measured thing is of.

        What records of one file show of one blow is one shot; so are all numbers of one setting, of one record there if
        there is one. Another record at that setting, or the same number once more, is another shot.
        """
        shots, known = list[int](), dict[tuple[int, int], int]()
        for setting, experiment in enumerate(self.experiments):
            files, names = list[str](), Counter[str]()
            for one in experiment.measured:
                if isinstance(one, MeasuredPulse):
                    if one.shot not in files:
                        files.append(one.shot)
                    repeat = files.index(one.shot)
                else:
                    repeat = names[one.called]
                    names[one.called] += 1
                shots.append(known.setdefault((setting, repeat), len(known)))
        return shots

    def misfits(self, residuals: Array, alone: Array | None = None) -> list[Misfit]:
        """Return what is left of each measured thing, and whether that is more than noise.

        ``alone`` has the residuals with the values at their best for each record by itself.
        """
        found = []
        for one, rows in zip(self.measured, self.rows(), strict=True):
            left = residuals[rows]
            if isinstance(one, MeasuredNumber):
                size = abs(float(left[0]))
                found.append(Misfit(one.called, size, size * one.uncertainty / abs(one.value), 1.0, False, True))
                continue
            size, more = one.left * _root_mean_square(left), more_than_noise(one, left)
            found.append(
                Misfit(
                    one.called,
                    size,
                    share=size * one.deviation / float(np.max(np.abs(one.values))),
                    independent=_independent(one, left),
                    more_than_noise=more,
                    noise_known=bool(one.quiet),
                    scatters=more and alone is not None and not more_than_noise(one, alone[rows]),
                )
            )
        return found

    def explained(self, residuals: Array) -> bool:
        """Tell whether noise explains what is left of each record, and numbers are missed by less than is expected."""
        found = self.misfits(residuals)
        missed = [one.size for one in found if one.is_number]
        return not any(one.more_than_noise for one in found) and float(np.sum(np.square(missed))) <= len(missed)

    def alone(self, residuals: Array, jacobian: Array) -> Array:
        """Return the residuals of each record with the values at their best for it alone, by the slopes."""
        found = residuals.copy()
        for one, rows in zip(self.measured, self.rows(), strict=True):
            if isinstance(one, MeasuredPulse):
                part = jacobian[rows]
                found[rows] -= part @ np.linalg.lstsq(part, residuals[rows], FAINT_SLOPE)[0]
        return found

    def blocks(self, residuals: Array, jacobian: Array) -> list[ResidualBlock]:
        """Return the blocks of the residuals: their noise, and what is left of them where that is more."""
        alone, missed, blocks = self.alone(residuals, jacobian), self._missed(residuals), []
        for one, rows, shot in zip(self.measured, self.rows(), self.shots(), strict=True):
            if isinstance(one, MeasuredNumber):
                blocks.append(ResidualBlock(rows, np.ones(1), shot, missed))
                continue
            left = alone[rows] if more_than_noise(one, alone[rows]) else None
            quiet = independent_count(one.quiet, one.correlation) if one.quiet else math.inf
            blocks.append(ResidualBlock(rows, one.correlation / one.left**2, shot, left, one.shared, quiet))
        return blocks

    def _missed(self, residuals: Array) -> Array | None:
        """Return the root mean square of the numbers where they are missed by more than chance (Birge 1932)."""
        from scipy.special import chdtri

        pairs = zip(self.measured, self.rows(), strict=True)
        missed = np.array([float(residuals[rows][0]) for one, rows in pairs if isinstance(one, MeasuredNumber)])
        freedom = missed.size - len(self.fields)
        if freedom < 1 or float(missed @ missed) <= float(chdtri(freedom, CHANCE)):
            return None
        return np.array([_root_mean_square(missed)])

    def weighted(self, misfits: Sequence[Misfit]) -> Problem:
        """Return the problem with the records of each part weighted by what is left of them all, over their peaks.

        Weighted by its own alone, a record that led the fit, or lies in the middle of those that scatter, would lead it
        the more, and their scatter would look the smaller.
        """
        shares: dict[str, list[float]] = {}
        for one, misfit in zip(self.measured, misfits, strict=True):
            if isinstance(one, MeasuredPulse):
                shares.setdefault(one.part, []).append(misfit.share)

        def heavier(one: Measured) -> Measured:
            if isinstance(one, MeasuredNumber):
                return one
            left = _root_mean_square(np.array(shares[one.part])) * float(np.max(np.abs(one.values)))
            return replace(one, left=max(left / one.deviation, 1.0))

        experiments = [replace(one, measured=tuple(map(heavier, one.measured))) for one in self.experiments]
        return Problem(experiments, self.fields)


def _root_mean_square(values: Array) -> float:
    return math.sqrt(float(values @ values) / values.size)


def _independent(one: MeasuredPulse, left: Array) -> float:
    """Return how many independent samples what is left of a record has; laying the run on it takes one."""
    return max(independent_count(left.size, one.correlation) - 1.0, 1.0)


def more_than_noise(one: MeasuredPulse, left: Array) -> bool:
    """Tell whether noise, and the stated scatter of the amplitude, leave so much once in a thousand times at most."""
    from scipy.special import fdtri, ndtri

    quiet = independent_count(one.quiet, one.correlation) if one.quiet else math.inf
    limit = float(fdtri(_independent(one, left), min(quiet, 1e9), 1.0 - CHANCE))
    scatter = float(ndtri(1.0 - 0.5 * CHANCE)) * one.scatter * _root_mean_square(one.values) / one.deviation
    return bool(one.left * _root_mean_square(left) > math.hypot(math.sqrt(limit), scatter))


@dataclass(frozen=True, eq=False)
class Solved:
    """A problem, as weighted, with its best place, other places that fit as well, and its runs."""

    problem: Problem
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
    search = Search(problem.residuals, len(problem.fields), advance, problem.stairs)
    stopped, ends = False, list[tuple[Array, Array]]()
    first = _begun(search, problem)
    try:
        _check_felt(problem, search, first)
        if problem.slow:
            ends = [search.descend(problem.start, accuracy=ROUGH)]
        else:
            fast = problem.fast()
            search.residuals = problem.residuals if fast is None else fast.residuals
            ends = search.wide(problem.start, problem.explained)
        place, residuals = _nearest(ends, problem.start)
        if search.residuals != problem.residuals:  # from the end of fast runs full ones have a step or two to go
            search.residuals = problem.residuals
            place, residuals = search.descend(place)
        used, misfits = problem, problem.misfits(residuals)
        if len(misfits) > 1 and any(one.more_than_noise for one in misfits):
            used = problem.weighted(misfits)
            again = Search(used.residuals, len(problem.fields), advance, problem.stairs)
            again.begin(place)
            place, _ = again.descend(place)
            again.runs += search.runs
            search = again
    except KeyboardInterrupt:
        assert search.best is not None
        place, stopped, used = search.best[1], True, problem
        search.residuals = problem.residuals
    residuals = used.residuals(place)
    try:
        jacobian = search.slopes(place, residuals, FINAL_STEP, both=True)
    except KeyboardInterrupt:  # the values are found, their errors are not
        jacobian, stopped = np.zeros((residuals.size, place.size)), True
    found = estimate(place, residuals, jacobian, used.blocks(residuals, jacobian))
    on_stairs = np.diag(problem.stairs**2 / 3.0)  # anywhere within one to either side fits as well
    found = replace(found, covariance=found.covariance + on_stairs)
    left = used.misfits(residuals, used.alone(residuals, jacobian))
    base = residuals if used is problem else problem.residuals(place)  # other ends have the weights of the search
    return Solved(used, found, tuple(left), _others(ends, found, base), search.runs, stopped, search)


def _begun(search: Search, problem: Problem) -> Array:
    """Return the residuals where the search begins, which need all that was measured."""
    try:
        return search.begin(problem.start)
    except StrikewaveError:
        raise
    except ValueError as error:
        hint = "begin elsewhere (--set), or follow the blow for longer"
        raise InputError("--to", str(error), "what the case gives where the search begins", hint) from None


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


def _others(ends: Sequence[tuple[Array, Array]], found: Estimate, base: Array) -> tuple[Array, ...]:
    """Return ends of other searches that fit as well within chance and lie apart along what is determined.

    ``base`` has the residuals of the best place, weighted as those of the ends.
    """
    others: list[Array] = []
    kept = np.eye(found.place.size) - found.undetermined @ found.undetermined.T
    misfit = float(base @ base)
    scale = max(misfit / base.size, 1.0)
    for place, residuals in ends:
        rise = float(residuals @ residuals) - misfit
        apart = float(np.linalg.norm(kept @ (place - found.place)))
        if rise < found.widest**2 * scale and apart > max(10.0 * math.sqrt(np.trace(found.covariance)), 1e-3):
            others.append(place)
    return tuple(others)
