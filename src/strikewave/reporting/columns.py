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

FORMULA = ("=", "+", "-", "@", "\t", "\r")  # spreadsheets run such a text; an apostrophe before it keeps it a text
"""Begin of texts that spreadsheets take for a formula."""
HISTORY_DIGITS = 9  # beyond the 1e-6 of their balances, and half the size of all 17
"""Significant digits of histories."""


Values: TypeAlias = "Sequence[Any] | NDArray[Any]"


class Column(NamedTuple):
    """A column of a table.

    Examples
    --------
    >>> speed = Column("speed", [76.445, None], "rad/s", shown="rpm")
    >>> speed.head, speed.texts(), speed.file_head
    ('speed (rpm)', ['730.0', '–'], 'speed [rad/s]')
    """

    name: str
    values: Values
    """Numbers in SI, texts or tags; None and NaN where there is nothing."""
    si: str = ""
    """SI unit; empty for texts and counts, whose head has none."""
    usual: str = ""
    """Unit in which files have it where none was chosen; the SI unit if empty."""
    shown: str | None = None
    """Unit in which faces show it as a rule, empty of words; None where notebooks leave it out."""
    label: str = ""
    """Label on the screen and the page; the name if empty."""
    digits: int = 4
    decimals: int | None = None
    """Decimals in the unit shown as a rule, instead of significant digits."""
    priority: int = MAIN
    """`KEY`, `MAIN` or `MORE` of `strikewave.base.declare`: the last is left out first on a narrow screen."""
    words: bool = False
    """True if its cells are words, which stand to the left on the screen and may take several lines there."""

    @classmethod
    def of(cls, name: str, values: Values, quantity: Quantity) -> Column:
        """Return a column of a quantity: in its SI unit, shown in its usual one."""
        return cls(name, values, quantity.si, shown=quantity.usual)

    @property
    def unit(self) -> str:
        """The unit in which files have it."""
        return shown_unit(self.si, self.usual or self.si)

    @property
    def file_head(self) -> str:
        """Name with unit, as files have them.

        Examples
        --------
        >>> Column("time", [0.0], "s").file_head, Column("kind", ["full"]).file_head
        ('time [s]', 'kind')
        """
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    @property
    def head(self) -> str:
        """Label with the unit that is shown."""
        return headed(self.label or self.name.replace("_", " "), self.si, self.shown or "")

    def cells(self) -> list[str | Tag]:
        """Return the cells of all rows."""
        si, usual = self.si or NO_UNIT, self.shown or NO_UNIT
        cells: list[str | Tag] = []
        for value in self.values:
            value = value.item() if hasattr(value, "item") else value
            if value is None or value != value:
                cells.append(NONE)
            elif isinstance(value, bool):
                cells.append("yes" if value else "no")
            elif isinstance(value, str | Tag):
                cells.append(value)
            elif self.decimals is not None:
                cells.append(fixed(value, si, usual, self.decimals))
            else:
                cells.append(written(value if si == usual == NO_UNIT else shown(value, si, usual), self.digits))
        return cells

    def texts(self) -> list[str]:
        """Return the cells of all rows, a tag as its word."""
        return [cell.text if isinstance(cell, Tag) else cell for cell in self.cells()]

    def converted(self) -> Values:
        """Return the values in the unit in which files have them."""
        if self.unit == self.si:
            return self.values
        if not isinstance(self.values, Sequence):
            return cast("Values", in_unit(cast("Any", self.values), self.si, self.unit))
        return [None if value is None else in_unit(float(value), self.si, self.unit) for value in self.values]


def page_table(caption: str, columns: Sequence[Column], empty: str = Table.empty) -> Table:
    """Return columns of equal length as a table of a page; ``empty`` are words that stand for one without rows."""
    rows = list(map(list, zip(*[column.cells() for column in columns], strict=True)))
    return Table(caption, [column.head for column in columns], rows, empty)


def csv_table(columns: Sequence[Column], digits: int | None = None) -> str:
    """Return columns of equal length as CSV text, numbers to so many significant digits, all that count by default.

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
