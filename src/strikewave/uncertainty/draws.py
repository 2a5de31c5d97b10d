"""The uncertain inputs of a case, the draws of each, and the case that a draw makes.

Where a case refuses a whole side of a range, the other side moves alone. What a quantity may be can depend on others: a
pad with a retardation has a restitution of 1, and no less. A range that does not know this would make every run fail
that is drawn from the refused side.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from statistics import NormalDist
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BaseModel

from strikewave.base.errors import MISSING, InputError, StrikewaveError
from strikewave.base.quantities import DEVIATIONS, TRUNCATION, Range, Value
from strikewave.base.units import DIMENSIONS
from strikewave.cases.case import FORM, Case
from strikewave.cases.paths import Form, with_quantities
from strikewave.cases.tables.machine import OwnStriker, RotaryTable

Array = NDArray[np.float64]
Shape = Literal["normal", "uniform", "log-uniform"]

NORMAL = NormalDist()  # of the standard library: to import scipy's takes longer than all draws of a band
SEED = 2019
"""Seed of the draws of a band: any; equal seeds reproduce a band bit for bit."""
STATED = "stated tolerance"
"""Basis of an input that is drawn within the tolerance that its case states."""

OF_EACH_STRIKER = {
    **{f"striker.{key}": key for key in OwnStriker.model_fields if key not in ("number", "restitution")},
    "contact.restitution": "restitution",
}
"""Inputs drawn for each striker separately, and their keys in a row of [[striker.each]]."""
FELT = ("machine", "striker", "feed", "object", "contact", "stack", "load", "mesh", "fem")
"""Tables that a blow, a bar or elements feel: a tolerance anywhere else changes no run."""
EXAMPLE = 'mass = { value = "1 kg", tolerance = "2 %" } in [striker], or --set striker.mass.tolerance="2 %"'
"""Example of a tolerance, for the error line where a case has none."""


def normal_quantile(probability: Array) -> Array:
    """Return the quantile of a standard normal variable at a probability between 0 and 1.

    Examples
    --------
    >>> normal_quantile(np.array([0.025, 0.5])).round(6).tolist()
    [-1.959964, 0.0]
    """
    return np.array([NORMAL.inv_cdf(p) for p in probability.ravel().tolist()]).reshape(probability.shape)


@dataclass(frozen=True)
class UncertainInput:
    """A quantity of a case that is not known exactly.

    Attributes
    ----------
    path : str
        In the case.
    value : Value
        Nominal, as the case has it.
    allowed : Range
        Range of values that it may take.
    low, high : float
        Ends of its range, SI.
    shape : {"normal", "uniform", "log-uniform"}
        Distribution between them: normal about the value, cut off at the ends; even; even in the logarithm.
    deviation : float
        Standard deviation of the normal distribution before it is cut off, SI.
    basis : str
        Basis of its range, such as "stated tolerance".
    reason : str
        Reason for its width.
    strikers : tuple of int
        Numbers of the strikers for which it is drawn separately; empty where it is drawn once a run.
    goes_with : tuple of (str, float)
        Paths of inputs, and powers: what is drawn is multiplied by these powers of their drawn values over their
        nominal ones. ``low`` and ``high`` hold where those are nominal.
    fitted_with : tuple of (str, float)
        Paths of inputs that the same data fix, and weights: its normal score is the sum of theirs, each with its
        weight, and of its own with what is left of 1 in squares.
    sets : tuple of str
        Fields of the case that take what is drawn, stated or not; the one at ``path`` where it is empty.
    """

    path: str
    value: Value
    allowed: Range
    low: float
    high: float
    shape: Shape = "uniform"
    deviation: float = math.nan
    basis: str = STATED
    reason: str = ""
    strikers: tuple[int, ...] = ()
    goes_with: tuple[tuple[str, float], ...] = ()
    fitted_with: tuple[tuple[str, float], ...] = ()
    sets: tuple[str, ...] = ()

    @property
    def fields(self) -> tuple[str, ...]:
        """Fields of the case that take what is drawn."""
        return self.sets or (self.path,)

    @property
    def count(self) -> int:
        """Count of the numbers drawn in a run."""
        return len(self.strikers) or 1

    @property
    def names(self) -> list[str]:
        """Name of each number drawn."""
        return [f"{self.path} of {number}" for number in self.strikers] or [self.path]

    def at(self, quantile: ArrayLike) -> Array:
        """Return the quantity at quantiles of its distribution, in SI.

        Examples
        --------
        >>> value = Value(si=0.5, typed=0.5)
        >>> UncertainInput("x", value, Range("", 0.0, 1.0), 0.2, 0.8).at([0.0, 0.5, 1.0]).round(12).tolist()
        [0.2, 0.5, 0.8]
        """
        u, low, high = np.asarray(quantile, dtype=float), self.low, self.high
        if self.shape == "log-uniform":
            return np.clip(low * (high / low) ** u, low, high)
        if self.shape == "uniform":
            return np.clip(low + u * (high - low), low, high)
        middle, deviation = self.value.si, self.deviation
        below, above = NORMAL.cdf((low - middle) / deviation), NORMAL.cdf((high - middle) / deviation)
        return np.clip(middle + deviation * normal_quantile(below + u * (above - below)), low, high)

    @property
    def width(self) -> float:
        """Half width of the tolerance or of the range, SI; that of a normal tolerance is two deviations."""
        return DEVIATIONS * self.deviation if self.shape == "normal" else 0.5 * (self.high - self.low)


def within(allowed: Range, low: float, high: float) -> tuple[float, float]:
    """Return ends of a range cut off where the quantity must not be."""
    low, high = max(low, allowed.low), min(high, allowed.high)
    if allowed.open_low and low == allowed.low:
        low = float(np.nextafter(low, high))
    return low, high


def stated(path: str, value: Value, allowed: Range, strikers: tuple[int, ...] = ()) -> UncertainInput:
    """Return a quantity within its stated tolerance.

    Uniform: even over the band. Normal: the tolerance is two standard deviations, and the distribution is cut off at
    three. Either is cut off where the quantity must not be, and keeps its form in between.
    """
    band, half = value.tolerance, value.half_width
    assert band is not None
    normal = band.distribution == "normal"
    reach = half * TRUNCATION / DEVIATIONS if normal else half
    low, high = within(allowed, value.si - reach, value.si + reach)
    deviation = half / DEVIATIONS if normal else math.nan
    reason = f"{band.typed}, {band.distribution}"
    return UncertainInput(path, value, allowed, low, high, band.distribution, deviation, STATED, reason, strikers)


def range_of(case: Case, path: str) -> Range:
    """Return the range of values that a quantity of a case may have."""
    allowed = allowed_at(case, path)
    assert allowed is not None
    return allowed


def allowed_at(case: Case, path: str) -> Range | None:
    """Return the range of the quantity at a path, stated or not; None where there can be none."""
    table, *places = path.split(".")
    if not places:
        return None
    part = getattr(case, table, None)
    if isinstance(part, BaseModel):
        return Form(type(part), table, "").range_at(places)
    return FORM.range_at([table, *places])


def drawn_strikers(case: Case, path: str) -> tuple[int, ...] | None:
    """Return the strikers for which a quantity is drawn separately; None where it is drawn once a run."""
    key = OF_EACH_STRIKER.get(path)
    if key is None or not isinstance(case.machine, RotaryTable):
        return None
    tables = case.rotary_tables()
    rows = {int(row.number.si): row for row in tables.striker.each}
    numbers = range(1, int(tables.machine.strikers.si) + 1)
    return tuple(n for n in numbers if n not in rows or getattr(rows[n], key) is None)


def tolerances_of(case: Case) -> tuple[UncertainInput, ...]:
    """Return the tolerances of a case that its run feels, by path.

    Raises
    ------
    InputError
        If the case has none.

    Examples
    --------
    >>> from strikewave import load_case
    >>> counts = {row.path: row.count for row in tolerances_of(load_case("li-ma-2019"))}
    >>> len(counts), counts["feed.arrival"], counts["striker.mass"]
    (24, 1, 4)
    """
    inputs = []
    for path, value in sorted(case.values().items()):
        if value.tolerance is None or path.partition(".")[0] not in FELT:
            continue
        strikers = drawn_strikers(case, path)
        if strikers != ():
            inputs.append(stated(path, value, range_of(case, path), strikers or ()))
    if not inputs:
        raise InputError("tolerance", MISSING, "a tolerance on at least one quantity that the run feels", EXAMPLE)
    return tuple(inputs)


def unfelt(case: Case, inputs: Sequence[UncertainInput]) -> list[str]:
    """Return the paths of other tolerances: of sensors, recorder, solver, or of single strikers' own values."""
    known = {row.path for row in inputs}
    return [path for path, value in case.values().items() if value.tolerance is not None and path not in known]


def latin_hypercube(numbers: int, runs: int, seed: int = SEED, stream: int = 0) -> Array:
    """Return points for some runs, shape (runs, numbers drawn): each number once in every n-th of its range.

    Source: ``mckay-1979``.

    Examples
    --------
    >>> points = latin_hypercube(2, 4, 1)
    >>> np.sort((4 * points).astype(int), axis=0).T.tolist()
    [[0, 1, 2, 3], [0, 1, 2, 3]]
    """
    source = np.random.Generator(np.random.Philox(np.random.SeedSequence(seed, spawn_key=(stream,))))
    strata = source.permuted(np.tile(np.arange(runs), (numbers, 1)), axis=1).T
    return np.asarray((strata + source.random((runs, numbers))) / runs)


def random_points(inputs: Sequence[UncertainInput], runs: int, seed: int) -> Array:
    """Return random points for some runs, shape (runs, numbers drawn).

    Each depends on seed, run and path alone: another tolerance in the case, or more runs, change none of them.
    """
    return np.array([np.concatenate([_random(row, run, seed) for row in inputs]) for run in range(runs)])


def _random(tolerance: UncertainInput, run: int, seed: int) -> Array:
    """Return the random numbers of a tolerance in a run; a striker has the same whether others are drawn or not."""
    source = np.random.Philox(np.random.SeedSequence(seed, spawn_key=(run, *tolerance.path.encode())))
    numbers = np.random.Generator(source).random(max(tolerance.strikers, default=1))
    return numbers[np.array(tolerance.strikers) - 1] if tolerance.strikers else numbers


def drawn(inputs: Sequence[UncertainInput], points: Array) -> Array:
    """Return the numbers drawn at quantiles, shape (runs, numbers drawn), in SI."""
    edges = np.cumsum([row.count for row in inputs])[:-1]
    quantile = {row.path: part for row, part in zip(inputs, np.split(points, edges, axis=1), strict=True)}
    columns = {row.path: row.at(_mixed(row, quantile) if row.fitted_with else quantile[row.path]) for row in inputs}
    return together(inputs, columns)


def together(inputs: Sequence[UncertainInput], columns: Mapping[str, Array]) -> Array:
    """Return numbers drawn of each input by itself as they go with one another, shape (runs, numbers drawn), in SI."""
    nominal, scaled = {row.path: row.value.si for row in inputs}, []
    for row in inputs:
        column = columns[row.path]
        for path, power in row.goes_with:
            if path in columns:
                column = column * (columns[path] / nominal[path]) ** power
        scaled.append(column)
    return np.concatenate(scaled, axis=1)


def _mixed(fitted: UncertainInput, quantile: Mapping[str, Array]) -> Array:
    """Return the quantiles of an input that goes with others, from independent ones."""
    weights = {path: weight for path, weight in fitted.fitted_with if path in quantile}
    own = math.sqrt(max(1.0 - sum([weight**2 for weight in weights.values()]), 0.0))
    scores = own * normal_quantile(quantile[fitted.path])
    for path, weight in weights.items():
        scores = scores + weight * normal_quantile(quantile[path])
    return np.array([NORMAL.cdf(score) for score in scores.ravel().tolist()]).reshape(scores.shape)


def nominal(inputs: Sequence[UncertainInput]) -> Array:
    """Return the nominal values in the order of the drawn numbers, shape (1, numbers drawn)."""
    return np.array([[row.value.si for row in inputs for _ in range(row.count)]])


def drawn_case(case: Case, inputs: Sequence[UncertainInput], numbers: Sequence[float]) -> Case:
    """Return a case with drawn values in the place of uncertain ones; strikers get rows of their own.

    Examples
    --------
    >>> from strikewave import load_case
    >>> case = load_case("li-ma-2019-fig13", ["striker.mass.tolerance=2 %"])
    >>> changed = drawn_case(case, tolerances_of(case), [1.01, 0.99, 1.0, 1.02])
    >>> [row.mass.si for row in changed.striker.each]
    [1.01, 0.99, 1.0, 1.02]
    """
    own: dict[int, dict[str, Value]] = {}
    once: dict[str, Value] = {}
    of_materials: dict[str, Value] = {}
    left = iter(numbers)
    for source in inputs:
        for number in source.strikers:
            own.setdefault(number, {})[OF_EACH_STRIKER[source.path]] = _exactly(source, next(left))
        if not source.strikers:
            (of_materials if source.sets else once).update(dict.fromkeys(source.fields, _exactly(source, next(left))))
    changed = with_quantities(case.with_values(once, keep_tolerances=False), of_materials)
    if not own:
        return changed
    striker = changed.rotary_tables().striker
    rows = {int(row.number.si): row for row in striker.each}
    for number, values in own.items():
        row = rows.get(number) or OwnStriker(number=Value(si=float(number), typed=number))
        rows[number] = row.model_copy(update=values)
    each = tuple([rows[number] for number in sorted(rows)])
    return changed.model_copy(update={"striker": striker.model_copy(update={"each": each})})


def _exactly(source: UncertainInput, number: float) -> Value:
    """Return a drawn number as a value without tolerance that reads back bit for bit."""
    number = float(number)
    typed = f"{number!r} {source.allowed.unit}" if source.allowed.unit in DIMENSIONS else number
    return Value(si=number, typed=typed, provenance=source.value.provenance, note=source.value.note)


STEPS = 10  # halvings by which the end of an allowed range is found: to a thousandth of its side


def allowed_inputs(
    case: Case, inputs: Sequence[UncertainInput], build: Callable[[Case], object]
) -> tuple[UncertainInput, ...]:
    """Return inputs, each on the part of its range that the case allows while the others are nominal.

    Parameters
    ----------
    case : Case
        Case of the inputs.
    inputs : sequence of UncertainInput
        Inputs, and the ranges within which they move.
    build : callable
        Builds the parts of a case, and raises where they do not go together.

    Examples
    --------
    >>> from strikewave import load_case
    >>> from strikewave.analyses.machine.build import build_machine
    >>> from strikewave.uncertainty.input_ranges import known_inputs
    >>> pad = ["contact.cushion.retardation=20 us", "contact.restitution=1"]
    >>> case = load_case("iec-60068-2-27-rubber", pad)
    >>> known = known_inputs(case)
    >>> sorted({row.path for row in known} - {row.path for row in allowed_inputs(case, known, build_machine)})
    ['contact.restitution']
    """

    def goes(moved: UncertainInput, number: float) -> bool:
        columns = {row.path: np.full((1, row.count), row.value.si) for row in inputs}
        columns[moved.path][:] = number
        try:
            build(drawn_case(case, inputs, together(inputs, columns)[0].tolist()))
        except (StrikewaveError, ValueError, ArithmeticError):
            return False
        return True

    def end(moved: UncertainInput, wanted: float) -> float:
        if goes(moved, wanted):
            return wanted
        good, bad = moved.value.si, wanted
        for _ in range(STEPS):
            middle = 0.5 * (good + bad)
            good, bad = (middle, bad) if goes(moved, middle) else (good, middle)
        return good

    if not inputs or not goes(inputs[0], inputs[0].value.si):
        return tuple(inputs)
    allowed = []
    for row in inputs:
        low, high = end(row, row.low), end(row, row.high)
        if (low, high) == (row.low, row.high):
            allowed.append(row)
        elif high > low:
            reason = f"{row.reason}; as far as the case allows"
            allowed.append(dataclasses.replace(row, low=low, high=high, reason=reason))
    return tuple(allowed)
