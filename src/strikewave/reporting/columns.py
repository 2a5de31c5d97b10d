"""Columns, of which all tables are made: of files, screens, pages, notebooks and the app.

A column holds its values, numbers in SI, and says what it is called and how each is written. Files take them by
`csv_table`, the screen by `strikewave.reporting.terminal.print_rows`, the page by `page_table`.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias, cast

from strikewave.base import texts
from strikewave.base.declare import MAIN, NO_UNIT, Quantity
from strikewave.base.units import in_unit
from strikewave.reporting.numbers import fixed, headed, shown, shown_unit
from strikewave.reporting.parts import NONE, Table, Tag, written

if TYPE_CHECKING:
    from numpy.typing import NDArray

FORMULA = ("=", "+", "-", "@", "\t", "\r")
"""A text that begins so is run as a formula by spreadsheets; an apostrophe before it keeps it a text."""
HISTORY_DIGITS = 9
"""Significant digits of histories: beyond the 1e-6 of their balances, and half the size of all 17."""


Values: TypeAlias = "Sequence[Any] | NDArray[Any]"


class Column(NamedTuple):
    """A column of a table.

    Attributes
    ----------
    name : str
        Name of the values.
    values : sequence or array
        Numbers in SI, texts or tags; None and NaN where there is nothing.
    si : str
        SI unit; empty for texts and counts, whose head has none.
    usual : str
        Unit in which files have it where none was chosen; the SI unit if empty.
    shown : str, optional
        Unit in which screens, pages and notebooks show it as a rule, empty of words; None where notebooks leave it
        out.
    label : str
        Label on the screen and the page; the name if empty.
    digits : int
        Significant digits that these show.
    decimals : int, optional
        Decimals in the unit shown as a rule, instead of significant digits.
    priority : int
        `KEY`, `MAIN` or `MORE` of `strikewave.base.declare`: what a narrow screen leaves out first.
    words : bool
        True if its cells are words, which stand to the left on the screen and may take several lines there.

    Examples
    --------
    >>> speed = Column("speed", [76.445, None], "rad/s", shown="rpm")
    >>> speed.head, speed.texts(), speed.file_head
    ('speed (rpm)', ['730.0', '–'], 'speed [rad/s]')
    """

    name: str
    values: Values
    si: str = ""
    usual: str = ""
    shown: str | None = None
    label: str = ""
    digits: int = 4
    decimals: int | None = None
    priority: int = MAIN
    words: bool = False

    @classmethod
    def of(cls, name: str, values: Values, quantity: Quantity) -> Column:
        """Return a column of what a quantity measures: in its SI unit, shown in its usual one.

        Examples
        --------
        >>> Column.of("force", [1500.0], Quantity("N", "kN"))[:5]
        ('force', [1500.0], 'N', '', 'kN')
        """
        return cls(name, values, quantity.si, shown=quantity.usual)

    @property
    def unit(self) -> str:
        """The unit in which files have it."""
        return shown_unit(self.si, self.usual or self.si)

    @property
    def file_head(self) -> str:
        """Its name with its unit, as files have them.

        Examples
        --------
        >>> Column("time", [0.0], "s").file_head, Column("kind", ["full"]).file_head
        ('time [s]', 'kind')
        """
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    @property
    def head(self) -> str:
        """What it is called with the unit in which it is shown."""
        return headed(self.label or self.name.replace("_", " "), self.si, self.shown or "")

    def cells(self) -> list[str | Tag]:
        """Return what it shows of each row."""
        return [self._cell(value) for value in self.values]

    def texts(self) -> list[str]:
        """Return what it shows of each row, a tag as its word."""
        return [cell.text if isinstance(cell, Tag) else cell for cell in self.cells()]

    def _cell(self, value: Any) -> str | Tag:
        value = value.item() if hasattr(value, "item") else value
        if value is None or value != value:
            return NONE
        if isinstance(value, bool):
            return "yes" if value else "no"
        if isinstance(value, str | Tag):
            return value
        si, usual = self.si or NO_UNIT, self.shown or NO_UNIT
        if self.decimals is not None:
            return fixed(value, si, usual, self.decimals)
        return written(value if si == usual == NO_UNIT else shown(value, si, usual), self.digits)

    def converted(self) -> Values:
        """Return the values in the unit in which files have them."""
        if self.unit == self.si:
            return self.values
        if not isinstance(self.values, Sequence):
            return cast("Values", in_unit(cast("Any", self.values), self.si, self.unit))
        return [None if value is None else in_unit(float(value), self.si, self.unit) for value in self.values]


def page_table(caption: str, columns: Sequence[Column], empty: str = Table.empty) -> Table:
    """Return columns of equal length as a table of a page; ``empty`` are words that stand for one without rows.

    Examples
    --------
    >>> page_table("Machines", [Column("speed", [76.445], "rad/s", shown="rpm")]).cells()
    [['730.0']]
    """
    cells = zip(*(column.cells() for column in columns), strict=True)
    return Table(caption, [column.head for column in columns], [list(row) for row in cells], empty)


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
    cells = [[_file_cell(value, digits) for value in column.converted()] for column in columns]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([_file_cell(column.file_head, None) for column in columns])
    writer.writerows(zip(*cells, strict=True))
    return text.getvalue()


def _file_cell(value: Any, digits: int | None) -> Any:
    """Return a value fit for a spreadsheet: nothing where there is no number, no text that it would run.

    Examples
    --------
    >>> _file_cell(1 / 3, 3), _file_cell(math.inf, 3), _file_cell("=1+1", None), _file_cell(None, None)
    ('0.333', '', "'=1+1", '')
    """
    if isinstance(value, float):
        if not math.isfinite(value):
            return ""
        return repr(float(value)) if digits is None else f"{value:.{digits}g}"
    if isinstance(value, str):
        text = texts.shown(value)
        return f"'{text}" if text.startswith(FORMULA) else text
    return "" if value is None else value
