"""What a case may be within its tolerances: where they stand, what is drawn, and the case that a draw makes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base.errors import MISSING, InputError
from strikewave.base.quantities import DEVIATIONS, TRUNCATION, Range, Value
from strikewave.base.units import DIMENSIONS
from strikewave.cases.case import Case
from strikewave.cases.paths import Form
from strikewave.cases.tables import OwnStriker

Array = NDArray[np.float64]

OF_EACH_STRIKER = {
    **{f"striker.{key}": key for key in OwnStriker.model_fields if key not in ("number", "restitution")},
    "contact.restitution": "restitution",
}
"""What is drawn for each striker separately, and where it stands in a row of [[striker.each]]."""
FELT = ("machine", "striker", "feed", "object", "contact", "stack")
"""Tables that a blow feels: a tolerance anywhere else changes no run."""
EXAMPLE = 'mass = { value = "1 kg", tolerance = "2 %" } in [striker], or --set striker.mass.tolerance="2 %"'
"""A tolerance, for the error line where a case has none."""


@dataclass(frozen=True)
class Tolerance:
    """A quantity of a case that has a tolerance.

    Attributes
    ----------
    path : str
        In the case.
    value : Value
        Nominal, with its tolerance.
    allowed : Range
        What it may be.
    strikers : tuple of int
        Numbers of the strikers for which it is drawn separately; empty where it is drawn once a run.
    """

    path: str
    value: Value
    allowed: Range
    strikers: tuple[int, ...] = ()

    @property
    def count(self) -> int:
        """How many numbers are drawn in a run."""
        return len(self.strikers) or 1

    @property
    def names(self) -> list[str]:
        """Name of each number drawn."""
        return [f"{self.path} of {number}" for number in self.strikers] or [self.path]


def tolerances_of(case: Case) -> tuple[Tolerance, ...]:
    """Return the tolerances of a machine case that its blows feel, by path.

    Raises
    ------
    InputError
        If the case is that of a bar alone, or has none.

    Examples
    --------
    >>> from strikewave import load_case
    >>> found = {tolerance.path: tolerance.count for tolerance in tolerances_of(load_case("li-ma-2019"))}
    >>> len(found), found["feed.arrival"], found["striker.mass"]
    (24, 1, 4)
    """
    rig = case.rotary_tables()
    numbers = range(1, int(rig.machine.strikers.si) + 1)
    rows = {int(row.number.si): row for row in rig.striker.each}
    tolerances = []
    for path, value in sorted(case.values().items()):
        if value.tolerance is None or path.partition(".")[0] not in FELT:
            continue
        table, *places = path.split(".")
        allowed = Form(type(getattr(case, table)), table, "").range_at(places)
        assert allowed is not None
        key = OF_EACH_STRIKER.get(path)
        drawn = tuple(n for n in numbers if n not in rows or getattr(rows[n], key) is None) if key else ()
        if drawn or not key:
            tolerances.append(Tolerance(path, value, allowed, drawn))
    if not tolerances:
        raise InputError("tolerance", MISSING, "a tolerance on at least one quantity that a blow feels", EXAMPLE)
    return tuple(tolerances)


def unfelt(case: Case, tolerances: Sequence[Tolerance]) -> list[str]:
    """Return the paths of other tolerances: of sensors, recorder, solver, or of what each striker has for itself."""
    known = {tolerance.path for tolerance in tolerances}
    return [path for path, value in case.values().items() if value.tolerance is not None and path not in known]


def draw(value: Value, allowed: Range, quantile: ArrayLike) -> Array:
    """Return what a toleranced quantity is at quantiles of its distribution, in SI.

    Uniform: even over the band. Normal: the tolerance is two standard deviations, and the distribution is cut off at
    three. Either is cut off where the quantity must not be, and keeps its form in between.

    Examples
    --------
    >>> share = Range("", 0.0, 1.0)
    >>> value = share.read({"value": 0.5, "tolerance": 0.2})
    >>> draw(value, share, [0.0, 0.5, 1.0]).round(12).tolist()
    [0.2, 0.5, 0.8]
    """
    from scipy.special import ndtr, ndtri

    u, half = np.asarray(quantile, dtype=float), value.half_width
    assert value.tolerance is not None
    normal = value.tolerance.distribution == "normal"
    reach = half * TRUNCATION / DEVIATIONS if normal else half
    low, high = max(value.si - reach, allowed.low), min(value.si + reach, allowed.high)
    if allowed.open_low and low == allowed.low:
        low = float(np.nextafter(low, high))
    if not normal:
        return np.clip(low + u * (high - low), low, high)
    deviation = half / DEVIATIONS
    below, above = ndtr((low - value.si) / deviation), ndtr((high - value.si) / deviation)
    return np.clip(value.si + deviation * ndtri(below + u * (above - below)), low, high)


def quantiles(tolerances: Sequence[Tolerance], runs: int, seed: int) -> Array:
    """Return quantiles for some runs, shape (runs, numbers drawn).

    Each depends on seed, run and path alone: another tolerance in the case, or more runs, change none of them.
    """
    return np.array(
        [np.concatenate([_random(tolerance, run, seed) for tolerance in tolerances]) for run in range(runs)]
    )


def _random(tolerance: Tolerance, run: int, seed: int) -> Array:
    """Return the random numbers of one tolerance in one run; a striker has the same whether others are drawn or not."""
    source = np.random.Philox(np.random.SeedSequence(seed, spawn_key=(run, *tolerance.path.encode())))
    numbers = np.random.Generator(source).random(max(tolerance.strikers, default=1))
    return numbers[np.array(tolerance.strikers) - 1] if tolerance.strikers else numbers


def drawn(tolerances: Sequence[Tolerance], points: Array) -> Array:
    """Return what is drawn at quantiles, shape (runs, numbers drawn), in SI."""
    columns, place = [], 0
    for tolerance in tolerances:
        columns.append(draw(tolerance.value, tolerance.allowed, points[:, place : place + tolerance.count]))
        place += tolerance.count
    return np.concatenate(columns, axis=1)


def nominal(tolerances: Sequence[Tolerance]) -> Array:
    """Return the nominal values in the order of the drawn numbers, shape (1, numbers drawn)."""
    return np.array([[tolerance.value.si for tolerance in tolerances for _ in range(tolerance.count)]])


def drawn_case(case: Case, tolerances: Sequence[Tolerance], numbers: Sequence[float]) -> Case:
    """Return a case with what was drawn instead of what has a tolerance; strikers get rows of their own.

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
    left = iter(numbers)
    for tolerance in tolerances:
        for number in tolerance.strikers:
            own.setdefault(number, {})[OF_EACH_STRIKER[tolerance.path]] = _exactly(tolerance, next(left))
        if not tolerance.strikers:
            once[tolerance.path] = _exactly(tolerance, next(left))
    changed = case.with_values(once, keep_tolerances=False)
    return changed.model_copy(update={"striker": _with_rows(changed.rotary_tables().striker, own)}) if own else changed


def _with_rows(striker: Any, own: dict[int, dict[str, Value]]) -> Any:
    """Return [striker] with values of single strikers in its rows."""
    rows = {int(row.number.si): row for row in striker.each}
    for number, values in own.items():
        row = rows.get(number) or OwnStriker(number=Value(si=float(number), typed=number))
        rows[number] = row.model_copy(update=values)
    return striker.model_copy(update={"each": tuple(rows[number] for number in sorted(rows))})


def _exactly(tolerance: Tolerance, number: float) -> Value:
    """Return a drawn number as a value without tolerance that reads back bit for bit."""
    number = float(number)
    typed = f"{number!r} {tolerance.allowed.unit}" if tolerance.allowed.unit in DIMENSIONS else number
    return tolerance.value.model_copy(update={"si": number, "typed": typed, "tolerance": None})
