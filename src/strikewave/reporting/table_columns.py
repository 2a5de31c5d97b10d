"""Columns that screen and page share: each says once what it is called, what it shows of a row, and in which unit.

The screen prints them by `strikewave.reporting.terminal.print_rows`, the page shows them by `page_table`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from strikewave.reporting.layout import MAIN, ScreenColumn
from strikewave.reporting.numbers import decimals_of, fixed, headed, shown
from strikewave.reporting.parts import NONE, Table, Tag, written

Row = TypeVar("Row")


@dataclass(frozen=True)
class TableColumn(Generic[Row]):
    """A column of a table of things of one kind.

    Attributes
    ----------
    name : str
        What it holds; with a unit in brackets where that is none of which there is a choice, such as %.
    value : callable
        What it shows of a row: a number in SI, words, a tag, or None for nothing.
    si : str
        SI unit of its numbers; empty where they have none.
    usual : str
        Unit in which they are shown as a rule.
    digits : int
        Significant digits.
    decimals : int, optional
        Decimals in the usual unit, instead of significant digits.
    least_digits : int
        Significant digits that a sentence gives a number of the column: it then has as many here, with more decimals.
    priority : int
        `KEY`, `MAIN` or `MORE` of `strikewave.reporting.layout`: what a narrow screen leaves out first.
    words : bool
        Whether its cells are words, which stand to the left on the screen.

    Examples
    --------
    >>> speed = TableColumn[dict]("speed", lambda row: row["speed"], "rad/s", "rpm")
    >>> speed.head, speed.cell({"speed": 76.445}), speed.cell({"speed": None})
    ('speed (rpm)', '730.0', '–')
    """

    name: str
    value: Callable[[Row], float | str | Tag | None]
    si: str = ""
    usual: str = ""
    digits: int = 4
    decimals: int | None = None
    priority: int = MAIN
    words: bool = False
    least_digits: int = 0

    @property
    def head(self) -> str:
        """Its name with the unit in which it is shown."""
        return headed(self.name, self.si, self.usual)

    @property
    def on_screen(self) -> ScreenColumn:
        """The column as the screen takes it."""
        return ScreenColumn(self.head, self.priority, self.words)

    def cell(self, row: Row) -> str | Tag:
        """Return what it shows of a row."""
        value = self.value(row)
        if value is None or value != value:
            return NONE
        if isinstance(value, str | Tag):
            return value
        if self.decimals is not None:
            si, usual = self.si or "1", self.usual or "1"
            return fixed(value, si, usual, decimals_of(value, si, usual, self.decimals, self.least_digits))
        return written(shown(value, self.si, self.usual) if self.si else float(value), self.digits)

    def text(self, row: Row) -> str:
        """Return what it shows of a row, a tag as its word."""
        cell = self.cell(row)
        return cell.text if isinstance(cell, Tag) else cell


def page_table(
    caption: str, columns: Sequence[TableColumn[Row]], rows: Iterable[Row], empty: str = Table.empty
) -> Table:
    """Return a table of a page; ``empty`` are words that stand for one without rows.

    Examples
    --------
    >>> page_table("Machines", [TableColumn[float]("speed", float, "rad/s", "rpm")], [76.445]).cells()
    [['730.0']]
    """
    cells = [[column.cell(row) for column in columns] for row in rows]
    return Table(caption, [column.head for column in columns], cells, empty)
