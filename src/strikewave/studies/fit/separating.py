"""Which further measurement would tell apart what the data do not: by the information that each would add."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.quantities import Value
from strikewave.base.shock_quantities import RATIO
from strikewave.cases.case import Case
from strikewave.studies.fit.batches import each_or_none
from strikewave.studies.fit.covariance import UNDETERMINED
from strikewave.studies.fit.estimation import FINAL_STEP
from strikewave.studies.fit.free_fields import FreeField, case_at
from strikewave.studies.fit.solving import Solved
from strikewave.studies.simulation import Simulation, number_units
from strikewave.uncertainty.known import LEAST

Array = NDArray[np.float64]

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
    found = [run.number(*one) for one in names]
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
