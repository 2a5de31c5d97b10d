"""Parts of a section of a report: words, tables, pictures.

All text is plain text: the page escapes it, so a title may hold ``<`` or ``&``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from strikewave.base.texts import plain

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NONE = "–"
"""Stands where there is no number."""
_UNSIGNED = r"(\d[\d.,]*|inf)([eE][+-]?\d+)?"
_NUMBER = re.compile(rf"[+−-]?{_UNSIGNED}( ± {_UNSIGNED})?( ?%)?")


@dataclass(frozen=True)
class Tag:
    """A short word in a coloured box, in a cell of a table.

    ``look`` is its colour: a provenance, a kind of blow, a status of a number, ``good`` or
    ``bad``; any other is grey.
    """

    text: str
    look: str = ""


@dataclass(frozen=True)
class Formula:
    """An equation in a cell of a table: typeset from ``tex``; ``text`` says the same in plain text."""

    tex: str
    text: str


Cell = str | int | float | Tag | Formula | None


@dataclass(frozen=True)
class Table:
    """A table with its caption."""

    caption: str
    columns: Sequence[str]
    """Heads, with units."""
    rows: Sequence[Sequence[Cell]]
    """Text as it shall be read, numbers (written with four digits), `Tag`, `Formula`, or None for nothing."""
    empty: str = "Nothing to show."
    """Words that stand for a table without rows."""
    kind: ClassVar[str] = "table"

    def cells(self) -> list[list[Tag | Formula | str]]:
        """Return all cells as text, tag or formula.

        Examples
        --------
        >>> Table("", ["a", "b"], [["x", 1234.567], [None, float("nan")]]).cells()
        [['x', '1235'], ['–', '–']]
        """
        return [[cell if isinstance(cell, Tag | Formula) else written(cell) for cell in row] for row in self.rows]

    def numeric(self) -> list[bool]:
        """Return for each column whether it holds nothing but numbers, which are set to the right.

        Examples
        --------
        >>> Table("", ["a", "b"], [["x", "1.5"], ["2", "-3 %"], ["3", "2 ± 0.1"]]).numeric()
        [False, True]
        """
        columns, rows = [], self.cells()
        for place in range(len(self.columns)):
            filled = [row[place] for row in rows if row[place] not in ("", NONE)]
            numbers = [cell for cell in filled if isinstance(cell, str) and _NUMBER.fullmatch(cell)]
            columns.append(bool(filled) and len(numbers) == len(filled))
        return columns


@dataclass(frozen=True)
class Picture:
    """A matplotlib figure with its caption."""

    figure: Figure
    """Figure to draw; one at most 5.5 inches wide shares its line with the next one."""
    caption: str
    label: str = ""
    """Text for a reader who cannot see it; the caption if empty."""
    kind: ClassVar[str] = "picture"


@dataclass(frozen=True)
class Photo:
    """A photograph with its caption; ``address`` is that of data within the page."""

    address: str
    caption: str
    kind: ClassVar[str] = "picture"


@dataclass(frozen=True)
class SignatureLines:
    """Lines to sign on: the role of each signatory, and the name."""

    rows: Sequence[tuple[str, str]]
    kind: ClassVar[str] = "signatures"


@dataclass(frozen=True)
class Flow:
    """Steps in a row, each leading to the next."""

    steps: Sequence[str]
    caption: str = ""
    kind: ClassVar[str] = "flow"


@dataclass(frozen=True)
class Code:
    """Text to be copied: commands, or a whole file behind ``summary``, which opens it."""

    text: str
    summary: str = ""
    kind: ClassVar[str] = "code"


@dataclass(frozen=True)
class Link:
    """A way to another file of the same result; ``file`` is its name."""

    file: str
    text: str
    kind: ClassVar[str] = "link"


Part = Table | Picture | Photo | SignatureLines | Flow | Code | Link


@dataclass(frozen=True)
class Section:
    """A section of a report."""

    title: str
    text: str = ""
    """Paragraphs, with an empty line between them; they stand before the parts."""
    parts: Sequence[Part] = ()
    folded: str = ""
    """Words that open the parts where they begin folded away, as inputs do; print shows them all."""
    alone: bool = False
    """True if the page up to here stands for itself: print begins a new one after it."""

    def paragraphs(self) -> list[str]:
        """Return the paragraphs of the text."""
        return list(filter(None, map(str.strip, re.split(r"\n\s*\n", self.text))))


# conversions of units and sums of decimal fractions are off by 1e-16 to 1e-12, a result by more than any digit shown
EXACT = 1e-9
"""Share of a number by which it may differ from its text and still count as equal to it."""


def written(value: str | int | float | None, digits: int = 4) -> str:
    """Write a value for a cell: text stays, numbers get so many significant digits, no number is a dash.

    A zero at the end stands where the number was rounded, and not where it is exact: 2.995 is 3.00 and 3 is 3.

    Examples
    --------
    >>> written(19685.34), written(1.5e-7), written(None), written(11), written("as it is")
    ('19685', '1.5e-07', '–', '11', 'as it is')
    >>> written(2.995, 3), written(3.0, 3), written(0.1 + 0.2, 3), written(99.996)
    ('3.00', '3', '0.3', '100.0')
    """
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return NONE
    if isinstance(value, str | bool | int):
        return str(value)
    text = plain(value, digits)
    if text.lstrip("-").isdigit() and len(text.lstrip("-")) > digits:
        return text
    is_exact = not math.isfinite(value) or math.isclose(float(text), value, rel_tol=EXACT, abs_tol=0.0)
    return text if is_exact else f"{value:#.{digits}g}".rstrip(".")
