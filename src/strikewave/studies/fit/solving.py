"""The solution of a problem of least squares: searched, weighted, what the data say, and what would tell more."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.errors import InputError, StrikewaveError
from strikewave.base.quantities import DEVIATIONS, Value
from strikewave.base.shock_quantities import RATIO
from strikewave.cases.case import Case
from strikewave.studies.fit.covariance import UNDETERMINED, Estimate, estimate
from strikewave.studies.fit.estimation import FINAL_STEP, ROUGH, Search, each_or_none, result_of
from strikewave.studies.fit.free_fields import FreeField, case_at
from strikewave.studies.fit.measured import MeasuredPulse
from strikewave.studies.fit.problem import AS_STATED, Misfit, Problem
from strikewave.studies.simulation import Simulation, number_units
from strikewave.uncertainty.input_ranges import LEAST

Array = NDArray[np.float64]

ALIKE = 1e-2
"""Share by which sums of squares may differ, or number where they are below 1, and be the same: far below chance."""
ROUNDS, CLOSE = 4, 0.05
"""Times at most that what the model lacks is found again, and the share by which it may differ then: a standard
deviation of a dozen settings is known to a fifth."""
UNFELT = 1e-7
"""Slope of the residuals along a field, over the largest, below which it changes nothing that was measured."""


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
    """
    search = Search(problem.residuals, len(problem.fields), advance, problem.stairs)
    stopped, used, ends = False, problem, list[tuple[Array, Array]]()
    first = _begun(search, problem)
    try:
        _check_felt(problem, search, first)
        ends = _searched(problem, search)
        place, residuals = _nearest(ends, problem.start)
        if search.residuals != problem.residuals:  # from the end of fast runs full ones have a step or two to go
            search.residuals = problem.residuals
            place, residuals = search.descend(place)
        used, search, place = _weighted(problem, search, place, residuals)
    except KeyboardInterrupt:
        assert search.best is not None
        place, stopped = search.best[1], True
        search.residuals = problem.residuals
    residuals = result_of(used.residuals, place)
    moved = None
    try:
        jacobian = search.slopes(place, residuals, FINAL_STEP, both=True)
        moved = None if stopped else _moved(used, search, place)
    except KeyboardInterrupt:  # the values are found, their errors are not
        jacobian, stopped = np.zeros((residuals.size, place.size)), True
    found = estimate(place, residuals, jacobian, used.blocks(residuals, jacobian), moved)
    on_stairs = np.diag(problem.stairs**2 / 3.0)  # anywhere within one to either side fits as well
    found = replace(found, covariance=found.covariance + on_stairs)
    left = used.misfits(residuals, used.alone(residuals, jacobian))
    # other ends have the weights of the search
    base = residuals if used is problem else result_of(problem.residuals, place)
    return Solved(used, found, tuple(left), _others(ends, found, base), search.runs, stopped, search)


def _searched(problem: Problem, search: Search) -> list[tuple[Array, Array]]:
    """Return where searches end: one from the case where runs take seconds, else several, by fast runs if they do."""
    if problem.slow:
        return [search.descend(problem.start, accuracy=ROUGH)]
    fast = problem.fast()
    search.residuals = problem.residuals if fast is None else fast.residuals
    return search.wide(problem.start, problem.explained)


def _weighted(problem: Problem, search: Search, place: Array, residuals: Array) -> tuple[Problem, Search, Array]:
    """Return the problem with what is left in its weights, its search, and the best place by them.

    Where what is left is noise, or of one record alone, nothing changes. What the model lacks of numbers is found again
    at each place, until it is as it was.
    """
    used, misfits, excess = problem, problem.misfits(residuals), problem.excess_of(residuals)
    for _ in range(ROUNDS):
        is_noise = excess == AS_STATED and not any(misfit.more_than_noise for misfit in misfits)
        if is_noise or len(misfits) == 1:
            break
        used = problem.weighted(misfits, excess)
        search = search.of_others(used.residuals)
        search.begin(place)
        place, _ = search.descend(place)
        excess = problem.excess_of(result_of(problem.residuals, place))
        if math.isclose(excess.between, used.excess.between, rel_tol=CLOSE):
            break
    return used, search, place


def _moved(problem: Problem, search: Search, place: Array) -> Array | None:
    """Return how far the best place moves with the stated scatter of amplitudes, in columns; None where none is stated.

    A record that rings leaves ripples in the misfit, over which slopes say too little of what per cents of amplitude
    do: each such record is fitted again at `DEVIATIONS` standard deviations to either side, and the root mean square
    of both moves counts. Where a run takes seconds, slopes must do.
    """
    pulses = [datum for datum in problem.measured if isinstance(datum, MeasuredPulse) and datum.scatter]
    if not pulses or problem.slow:
        return None
    columns = []
    for pulse in pulses:
        for sign in (-1.0, 1.0):
            other = problem.scaled(pulse, 1.0 + sign * DEVIATIONS * pulse.scatter)
            elsewhere = search.of_others(other.residuals)
            elsewhere.begin(place)
            columns.append((elsewhere.descend(place, accuracy=ROUGH)[0] - place) / (math.sqrt(2.0) * DEVIATIONS))
            search.runs = elsewhere.runs
    return np.column_stack(columns)


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


SETTINGS, CHANGED = ("machine.speed", "machine.height"), 1.25
"""Settings of which another value may separate fields, and the factor: what most machines can be set to besides."""


@declare.dataclass
class SeparatingNumber:
    """A number that would separate fields, measured to 1 %."""

    group: tuple[str, ...] = declare.word("fields that are not told apart")
    number: str = declare.word("number that would tell them apart, with the setting where it is another one")
    errors: tuple[float, ...] = declare.history(
        RATIO, "standard error of each field then, as a share of the width of its bounds"
    )


def separating(solved: Solved) -> list[SeparatingNumber]:
    """Return the numbers that would separate each group of fields of which one direction is not determined, best first.

    A number adds g g'/u^2 to the information, with g its slope and u = 1 % of it; along the undetermined direction v
    the standard error is then u/|g v|. Those where that is still beyond `UNDETERMINED` are left out.
    """
    found, fields = solved.estimate, solved.problem.fields
    groups = found.groups()
    if not groups or solved.stopped:
        return []
    base = solved.problem.experiments[0].case
    slopes = _slopes(solved, base, "")
    free = {field.path for field in fields}
    for path in SETTINGS:
        if path in base.values() and path not in free:
            value = base.values()[path]
            changed = base.with_values({path: Value(si=CHANGED * value.si, typed=value.typed)}, keep_tolerances=False)
            slopes |= _slopes(solved, changed, f" at {CHANGED:g} times {path}")
    rows = []
    for group in groups:
        projector = (found.undetermined @ found.undetermined.T)[np.ix_(group, group)]
        values, vectors = np.linalg.eigh(projector)
        if np.count_nonzero(values > 0.5) != 1:
            continue
        direction = vectors[:, -1]
        for name, slope in slopes.items():
            felt = abs(float(slope[group] @ direction)) / LEAST
            error = 1.0 / felt if felt > 0.0 else math.inf
            if error < UNDETERMINED:
                errors = tuple(float(error * abs(part)) for part in direction)
                rows.append(SeparatingNumber(tuple(fields[k].path for k in group), name, errors))
    return sorted(rows, key=lambda row: max(row.errors))


def _logarithms(case: Case, fields: Sequence[FreeField], names: Sequence[tuple[str, str]], at: Array) -> Array:
    """Return the logarithms of numbers of a case at a place; NaN where one is none or zero."""
    run = Simulation(case_at(case, fields, at))
    found = [run.number(*name) for name in names]
    return np.log(np.abs([math.nan if value is None or value == 0.0 else value for value in found]))


def _slopes(solved: Solved, case: Case, words: str) -> dict[str, Array]:
    """Return the slopes of the logarithm of each number that a case gives, in the unit cube."""
    place, fields, size = solved.estimate.place, solved.problem.fields, solved.estimate.place.size
    names = [
        (name, sensor)
        for name in number_units(case)
        if name.startswith(("first.", "tap.", "sensor."))
        for sensor in ([one.name for one in case.sensor] if "sensor_" in name else [""])
    ]

    ends = [(np.clip(place - s, 0.0, 1.0), np.clip(place + s, 0.0, 1.0)) for s in FINAL_STEP * np.eye(size)]
    values = each_or_none(functools.partial(_logarithms, case, fields, names), [end for pair in ends for end in pair])
    columns = []
    for k, (low, high) in enumerate(ends):
        before, after = values[2 * k : 2 * k + 2]
        if before is None or after is None:
            return {}
        columns.append((after - before) / (high[k] - low[k]))
    table = np.column_stack(columns)
    return {
        f"{name} {sensor}".strip() + words: row
        for (name, sensor), row in zip(names, table, strict=True)
        if np.all(np.isfinite(row))
    }
