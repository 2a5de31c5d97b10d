"""Columns of quantities, and tables of them as CSV text: numbers in SI, or in the units that the user chose."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from strikewave.base import control_characters
from strikewave.base.declare import Quantity
from strikewave.base.units import in_unit
from strikewave.reporting.shown_units import shown_unit

FORMULA = ("=", "+", "-", "@", "\t", "\r")
"""A text that begins so is run as a formula by spreadsheets; an apostrophe before it keeps it a text."""
HISTORY_DIGITS = 9
"""Significant digits of histories: beyond the 1e-6 of their balances, and half the size of all 17."""


Values = Sequence[Any] | NDArray[Any]


class Column(NamedTuple):
    """A column of a table.

    Attributes
    ----------
    name : str
        What it holds.
    values : sequence or array
        Numbers in SI, or texts; None and NaN where there is nothing.
    si : str
        SI unit; empty for texts and counts, whose head has none.
    usual : str
        Unit in which it is written where none was chosen; the SI unit if empty.
    shown : str, optional
        Unit in which screens and notebooks show it as a rule, empty of words; None where they leave it out.
    label : str
        What these call it; its name if empty.
    """

    name: str
    values: Values
    si: str = ""
    usual: str = ""
    shown: str | None = None
    label: str = ""

    @classmethod
    def of(cls, name: str, values: Values, quantity: Quantity) -> Column:
        """Return a column of what a quantity measures: in its SI unit, shown in its usual one.

        Examples
        --------
        >>> Column.of("force", [1500.0], Quantity("N", "kN"))
        Column(name='force', values=[1500.0], si='N', usual='', shown='kN', label='')
        """
        return cls(name, values, quantity.si, shown=quantity.usual)

    @property
    def unit(self) -> str:
        """The unit in which it is written."""
        return shown_unit(self.si, self.usual or self.si)

    @property
    def head(self) -> str:
        """Its name with its unit.

        Examples
        --------
        >>> Column("time", [0.0], "s").head, Column("kind", ["full"]).head
        ('time [s]', 'kind')
        """
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    def converted(self) -> Values:
        """Return the values in the unit in which they are written."""
        if self.unit == self.si:
            return self.values
        if isinstance(self.values, np.ndarray):
            return np.asarray(in_unit(cast("Any", self.values), self.si, self.unit))
        return [None if value is None else in_unit(float(value), self.si, self.unit) for value in self.values]


def csv_table(columns: Sequence[Column], digits: int | None = None) -> str:
    """Return columns of equal length as CSV text.

    Parameters
    ----------
    columns : sequence of Column
        From the left.
    digits : int, optional
        Significant digits of numbers; all that tell them apart where left out.

    Examples
    --------
    >>> print(csv_table([Column("blow", [1, 2]), Column("peak", [40709.86, None], "m/s^2")]), end="")
    blow,peak [m/s^2]
    1,40709.86
    2,
    """
    cells = [[_cell(value, digits) for value in column.converted()] for column in columns]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([_cell(column.head, None) for column in columns])
    writer.writerows(zip(*cells, strict=True))
    return text.getvalue()


def _cell(value: Any, digits: int | None) -> Any:
    """Return a value fit for a spreadsheet: nothing where there is no number, no text that it would run.

    Examples
    --------
    >>> _cell(1 / 3, 3), _cell(math.inf, 3), _cell("=1+1", None), _cell(None, None), _cell(True, None)
    ('0.333', '', "'=1+1", '', True)
    """
    if isinstance(value, float):
        if not math.isfinite(value):
            return ""
        return repr(float(value)) if digits is None else f"{value:.{digits}g}"
    if isinstance(value, str):
        text = control_characters.shown(value)
        return f"'{text}" if text.startswith(FORMULA) else text
    return "" if value is None else value
