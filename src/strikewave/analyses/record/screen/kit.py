"""What all that is printed of records has in common: long tables and lists cut short, figures in the channel's unit."""

from __future__ import annotations

import math
from collections.abc import Sequence

from strikewave.analyses.record.rows import INTEGRALS
from strikewave.base.shock_quantities import usual_unit
from strikewave.base.units import DIMENSIONS
from strikewave.reporting.columns import Column
from strikewave.reporting.numbers import with_unit
from strikewave.reporting.terminal import significant, table, tell

MOST_LINES = 12
"""Files or channels that have a line of their own, or a table, on the screen; the others are counted."""
MOST_ROWS = 60
"""Files shown in the table on the screen."""


def tell_first(lines: Sequence[str], most: int, others: str, indent: str = "") -> None:
    """Print the first lines, and how many others there are."""
    for line in lines[:most]:
        tell(line, indent)
    if len(lines) > most:
        tell(f"{len(lines) - most} more {others}: see report and JSON", indent)


def print_table(title: str, columns: Sequence[Column], rows: Sequence[Sequence[str]]) -> None:
    """Print a table, or its first rows."""
    if len(rows) > MOST_ROWS:
        title = f"{title}, the first {MOST_ROWS} of {len(rows)} rows"
    table(title, columns, rows[:MOST_ROWS])


def mean_of(values: Sequence[float]) -> float:
    """Return the mean of those that are finite; NaN where none is."""
    finite = [value for value in values if math.isfinite(value)]
    return sum(finite) / len(finite) if finite else math.nan


def value_text(value: float, unit: str) -> str:
    """Write a figure in the unit of its channel; a dash where there is none."""
    if value != value:
        return "-"
    if unit == "1":
        return f"{significant(1e6 * value, 5)} ustrain"
    if unit in DIMENSIONS:
        return with_unit(value, unit, usual_unit(unit), 5)
    return f"{significant(value, 5)} {unit}".strip()


def integral_text(value: float, unit: str) -> str:
    """Write an integral over time of what a channel measures in a unit; a dash where there is none."""
    integral = INTEGRALS.get(unit, "")
    if value != value:
        return "-"
    known = integral in DIMENSIONS
    return with_unit(value, integral, integral) if known else f"{significant(value, 4)} {integral}".strip()
