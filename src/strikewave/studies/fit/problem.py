"""A fit as a problem of least squares over experiments, its solution, and numbers that would separate fields."""

from __future__ import annotations

import functools
import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, MORE, NO_UNIT, GivenUnits, Quantity
from strikewave.base.errors import InputError, StrikewaveError
from strikewave.base.quantities import DEVIATIONS, Value
from strikewave.base.result import Verdict
from strikewave.base.shock_quantities import RATIO
from strikewave.cases.case import Case
from strikewave.reporting.parts import Tag
from strikewave.studies.engine.case_evaluation import EVALUATED, CaseEvaluation, numbers_of
from strikewave.studies.fit.covariance import (
    CHANCE,
    KNOWN_ELSEWHERE,
    UNDETERMINED,
    Estimate,
    Excess,
    ResidualBlock,
    estimate,
    excess_of,
    independent_count,
)
from strikewave.studies.fit.estimation import FINAL_STEP, ROUGH, Search, each_or_none, result_of
from strikewave.studies.fit.free_fields import FreeField, case_at, stairs
from strikewave.studies.fit.measured import Measured, MeasuredNumber, MeasuredPulse
from strikewave.studies.simulation import Simulation, number_units
from strikewave.uncertainty.input_ranges import LEAST
from strikewave.uncertainty.runs import or_none

T = TypeVar("T")


class FastRun(Simulation):
    """A run whose numbers are those of `strikewave.machines.fast_run`: a tenth of the time, and within 1e-3."""

    @functools.cached_property
    def _found(self) -> tuple[Mapping[str, float | None], Verdict]:
        numbers, _, verdict = EVALUATED["fast"](CaseEvaluation("fast", tuple(numbers_of(self.case, "fast"))), self.case)
        return numbers, verdict

    @property
    def verdict(self) -> Verdict:
        """Verdict of the checks of the fast run."""
        return self._found[1]

    def number(self, name: str, sensor: str = "") -> float | None:
        """Return a number, SI; NaN where this run has none."""
        value = self._found[0].get(name)
        return math.nan if value is None else float(value)


def runs_fast(case: Case) -> bool:
    """Tell whether the fast run is that of this case: a machine with a drive, and an object that is no stack."""
    return case.command == "run" and case.launched() is None and not case.stack.layer


Array = NDArray[np.float64]

AS_STATED = Excess()  # excess of numbers that are off by no more than their uncertainties
OVER_NOISE = Quantity.of_data("standard deviations of the noise", digits=3)
NO_MORE_UNIT: GivenUnits = {OVER_NOISE.given_by: (NO_UNIT, NO_UNIT)}
"""Units of rows with a number over its noise, whose head states what it is over."""
FAINT_SLOPE = 1e-4
"""Slope of a record along a direction, over the largest, from which on its own best values follow the residual."""


@dataclass(frozen=True, eq=False)
class Experiment:
    """A setting of the case, and all measurements at it: one run serves them all.

    Attributes
    ----------
    case : Case
        With its settings; the free fields stand where the search begins.
    changes : tuple of str
        In what it differs from the case that is fitted, ``path=value`` each.
    measured : tuple of (MeasuredNumber or MeasuredPulse)
        Measured numbers and pulses.
    """

    case: Case
    changes: tuple[str, ...]
    measured: tuple[Measured, ...]


@declare.dataclass
class Misfit:
    """Residual of a measured record or number, over its noise."""

    called: str = declare.word("what it is called", label="measured", column=KEY, order=-1)
    size: float = declare.number(
        OVER_NOISE,
        "root mean square of the residual over the standard deviation of its noise, or its standard uncertainty",
        label="over its noise or uncertainty",
        column=MAIN,
    )
    share: float = declare.number(
        Quantity(NO_UNIT, "%", "RMS residual", digits=3),
        "root mean square of the residual over the peak, or over the number",
        column=MAIN,
        order=-1,
    )
    independent: float = declare.number(RATIO, "independent samples that the residual has")
    independent_samples = declare.computed(
        declare.count("independent samples, whole ones", column=MORE, in_document=False)
    )(lambda misfit: math.floor(misfit.independent))
    more_than_noise: bool = declare.word("whether noise alone leaves so much once in a thousand times at most")
    is_number: bool = declare.word("whether it is a stated number, not a record", default=False)
    noise_known: bool = declare.word(
        "whether the noise of the record is known; else 1e-4 of its peak is taken", default=True
    )
    scatters: bool = declare.word(
        "whether it is noise with values of its own: then the shots differ, and the model need lack nothing",
        default=False,
    )

    @declare.phrase("is", column=MAIN)
    def kind(self) -> Tag:
        """Return whether it is a number, noise, or more."""
        if self.is_number:
            return Tag("number")
        return Tag("not noise", "warned") if self.more_than_noise else Tag("noise", "good")


class Problem:
    """Experiments and free fields, as residuals over the unit cube.

    Parameters
    ----------
    experiments : sequence of Experiment
        Experiments that the case is fitted to.
    fields : sequence of FreeField
        Free fields.
    simulate : callable, optional
        Runs a case.
    excess : Excess, optional
        Excess scatter of the numbers, which sets their weights.
    """

    def __init__(
        self,
        experiments: Sequence[Experiment],
        fields: Sequence[FreeField],
        simulate: Callable[[Case], Simulation] = Simulation,
        excess: Excess = AS_STATED,
    ) -> None:
        self.experiments, self.fields, self._simulate = tuple(experiments), tuple(fields), simulate
        self.excess = excess

    def fast(self) -> Problem | None:
        """Return the problem with fast runs, where these give all that was measured; else None."""
        given = all(
            runs_fast(experiment.case)
            and all(
                isinstance(datum, MeasuredNumber)
                and (datum.of_field or datum.name in numbers_of(experiment.case, "fast"))
                for datum in experiment.measured
            )
            for experiment in self.experiments
        )
        found = Problem(self.experiments, self.fields, FastRun) if given else None
        return None if found is None or or_none(found.residuals, self.start) is None else found

    @property
    def measured(self) -> list[Measured]:
        """All measurements, in the order of the residuals."""
        return [datum for experiment in self.experiments for datum in experiment.measured]

    @property
    def slow(self) -> bool:
        """True if a run takes seconds: one of elements."""
        return any(experiment.case.command == "fem" for experiment in self.experiments)

    @property
    def start(self) -> Array:
        """Place of the case in the unit cube."""
        return np.array([field.place(field.value.si) for field in self.fields])

    @functools.cached_property
    def stairs(self) -> Array:
        """Step of each field that the runs feel, in the unit cube: see `free_fields.stairs`."""
        paths = [field.path for field in self.fields]
        shares = np.max([stairs(experiment.case, paths) for experiment in self.experiments], axis=0)
        sizes = [(1.0 if field.log else abs(field.value.si)) / field.width for field in self.fields]
        return np.multiply(shares, sizes)

    def runs(self, place: Array) -> list[Simulation]:
        """Return a run of each experiment at a place."""
        return [self._simulate(case_at(experiment.case, self.fields, place)) for experiment in self.experiments]

    def with_runs(self, runs: Iterable[T]) -> list[tuple[Measured, T]]:
        """Return each measured thing with the run of its experiment (or a like), in the order of the residuals."""
        pairs = zip(self.experiments, runs, strict=True)
        return [(datum, run) for experiment, run in pairs for datum in experiment.measured]

    def residuals(self, place: Array) -> Array:
        """Return all residuals at a place."""
        return np.concatenate([datum.residuals(run) for datum, run in self.with_runs(self.runs(place))])

    def rows(self) -> list[slice]:
        """Return where the residuals of each measured thing stand."""
        ends = np.cumsum([0, *(1 if isinstance(datum, MeasuredNumber) else datum.time.size for datum in self.measured)])
        return [slice(int(a), int(b)) for a, b in pairwise(ends)]

    def shots(self) -> list[int | None]:
        """Return the number of the shot that each measured thing is of; None for what is known from elsewhere.

        What records of one file show of one blow is one shot; so are all numbers of one setting, of one record there if
        there is one. Another record at that setting, or the same number once more, is another shot.
        """
        shots, known = list[int | None](), dict[tuple[int, int], int]()
        for setting, experiment in enumerate(self.experiments):
            files, names = list[str](), Counter[str]()
            for datum in experiment.measured:
                if isinstance(datum, MeasuredPulse):
                    if datum.shot not in files:
                        files.append(datum.shot)
                    repeat = files.index(datum.shot)
                elif datum.of_field:
                    shots.append(None)
                    continue
                else:
                    repeat = names[datum.called]
                    names[datum.called] += 1
                shots.append(known.setdefault((setting, repeat), len(known)))
        return shots

    @property
    def shot_count(self) -> int:
        """Number of shots."""
        return len({shot for shot in self.shots() if shot is not None})

    def scaled(self, pulse: MeasuredPulse, factor: float) -> Problem:
        """Return the problem with the amplitude of one record times a factor."""
        louder = replace(pulse, values=factor * pulse.values)
        experiments = [
            replace(experiment, measured=tuple(louder if datum is pulse else datum for datum in experiment.measured))
            for experiment in self.experiments
        ]
        return Problem(experiments, self.fields, self._simulate, self.excess)

    def misfits(self, residuals: Array, alone: Array | None = None) -> list[Misfit]:
        """Return the residual of each measurement, and whether it is more than noise.

        ``alone`` has the residuals with the values at their best for each record by itself.
        """
        found = []
        for datum, rows in zip(self.measured, self.rows(), strict=True):
            left = residuals[rows]
            if isinstance(datum, MeasuredNumber):
                size = datum.left * abs(float(left[0]))
                found.append(Misfit(datum.called, size, size * datum.uncertainty / abs(datum.value), 1.0, False, True))
                continue
            size, more = datum.left * _root_mean_square(left), more_than_noise(datum, left)
            found.append(
                Misfit(
                    datum.called,
                    size,
                    share=size * datum.deviation / float(np.max(np.abs(datum.values))),
                    independent=_independent(datum, left),
                    more_than_noise=more,
                    noise_known=bool(datum.quiet),
                    scatters=more and alone is not None and not more_than_noise(datum, alone[rows]),
                )
            )
        return found

    def explained(self, residuals: Array) -> bool:
        """Tell whether noise explains the residual of each record, and numbers miss by less than expected."""
        found = self.misfits(residuals)
        missed = [one.size for one in found if one.is_number]
        return not any(one.more_than_noise for one in found) and float(np.sum(np.square(missed))) <= len(missed)

    def alone(self, residuals: Array, jacobian: Array) -> Array:
        """Return the residuals of each record with the values at their best for it alone, by the slopes."""
        found = residuals.copy()
        for datum, rows in zip(self.measured, self.rows(), strict=True):
            if isinstance(datum, MeasuredPulse):
                part = jacobian[rows]
                found[rows] -= part @ np.linalg.lstsq(part, residuals[rows], FAINT_SLOPE)[0]
        return found

    def blocks(self, residuals: Array, jacobian: Array) -> list[ResidualBlock]:
        """Return the blocks of the residuals: their noise, and their remainder where that is more."""
        alone, blocks = self.alone(residuals, jacobian), []
        numbers = sum(isinstance(one, MeasuredNumber) for one in self.measured)
        for datum, rows, shot in zip(self.measured, self.rows(), self.shots(), strict=True):
            if isinstance(datum, MeasuredNumber):
                blocks.append(ResidualBlock(rows, np.ones(1), shot, quiet=self.excess.freedom / numbers, pooled=True))
                continue
            left = alone[rows] if more_than_noise(datum, alone[rows]) else None
            quiet = independent_count(datum.quiet, datum.correlation) if datum.quiet else math.inf
            noise = datum.correlation / datum.left**2
            blocks.append(ResidualBlock(rows, noise, shot, left, datum.shared, datum.stated, quiet))
        return blocks

    def excess_of(self, residuals: Array) -> Excess:
        """Return the excess of the numbers over their uncertainties, by all residuals."""
        rows, groups, known = list[int](), list[int](), dict[tuple[int, str], int]()
        place = 0
        for setting, experiment in enumerate(self.experiments):
            for datum in experiment.measured:
                if isinstance(datum, MeasuredNumber):
                    rows.append(place)
                    groups.append(
                        KNOWN_ELSEWHERE if datum.of_field else known.setdefault((setting, datum.called), len(known))
                    )
                place += 1 if isinstance(datum, MeasuredNumber) else datum.time.size
        if len(rows) == len(known) <= len(self.fields):  # values that meet them all
            return AS_STATED
        return excess_of(residuals[rows], groups, len(self.fields))

    def weighted(self, misfits: Sequence[Misfit], excess: Excess) -> Problem:
        """Return the problem with what is left in its weights: of the records of each part, and of the numbers.

        Records where one is more than noise, by what is left of them all, over their peaks. Weighted by its own alone,
        a record that led the fit, or lies in the middle of those that scatter, would lead it the more, and their
        scatter would look the smaller. Numbers by their excess, so that many repeats at one setting do not outweigh
        what the model lacks there.
        """
        shares: dict[str, list[float]] = {}
        if any(one.more_than_noise for one in misfits):
            for one, misfit in zip(self.measured, misfits, strict=True):
                if isinstance(one, MeasuredPulse):
                    shares.setdefault(one.part, []).append(misfit.share)

        def heavier(one: Measured, repeats: Counter[str]) -> Measured:
            if isinstance(one, MeasuredNumber):
                return one if one.of_field else replace(one, left=excess.weight(repeats[one.called]))
            if one.part not in shares:
                return one
            left = _root_mean_square(np.array(shares[one.part])) * float(np.max(np.abs(one.values)))
            return replace(one, left=max(left / one.deviation, 1.0))

        experiments = []
        for experiment in self.experiments:
            repeats = Counter(datum.called for datum in experiment.measured)
            measured = tuple(heavier(one, repeats) for one in experiment.measured)
            experiments.append(replace(experiment, measured=measured))
        return Problem(experiments, self.fields, self._simulate, excess)


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


ALIKE = 1e-2  # share by which equal sums of squares may differ, absolute below 1: far below chance
ROUNDS, CLOSE = 4, 0.05
"""Rounds of weighting at most, and the share within which the lack of fit has settled: a standard deviation of a dozen
settings is known to a fifth."""
UNFELT = 1e-7
"""Slope of the residuals along a field, over the largest, below which no measurement feels it: below rounding."""


@dataclass(frozen=True, eq=False)
class Solved:
    """A weighted problem with its best place, other places that fit as well, and its runs."""

    problem: Problem
    estimate: Estimate
    misfits: tuple[Misfit, ...]
    others: tuple[Array, ...]
    runs: int
    stopped: bool
    search: Search


def solve(problem: Problem, advance: Callable[[int, float], None] | None = None) -> Solved:
    """Find the best place, and its errors by the data.

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
    """Return the problem weighted by its residuals, its search, and the best place by these weights.

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
    """Return the moves of the best place by the stated scatter of amplitudes, in columns; None where none is stated.

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
    """Refuse a field that no measurement feels."""
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
"""Settings that may separate fields, and the factor of another value: one that most machines can be set to."""


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
