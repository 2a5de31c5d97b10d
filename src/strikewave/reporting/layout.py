"""Tables and sentences as lines of text that fit a width: no number and no word is ever broken.

Nothing here knows a terminal: `strikewave.reporting.terminal` prints what these functions return.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from strikewave.base.declare import KEY, MAIN
from strikewave.reporting.columns import Column

GAP = "  "
"""Between two columns."""
MOST_HEAD_LINES = 3
"""Lines of the words of a head, if words that long let it: higher ones are hard to read."""
MOST_ROW_LINES = 6
"""Lines of a row up to which the widths are sought at which no row takes more."""
LEAST_TEXT = 16
"""Characters that a column of words gets at least, if its words are not shorter altogether."""
PLAIN = {
    **{"µ": "u", "μ": "u", "²": "^2", "³": "^3", "±": "+/-", "×": "x", "·": ".", "°": " deg", "Δ": "d", "χ": "chi"},
    **{"–": "-", "—": "-", "−": "-", "…": "...", "─": "-", "≤": "<=", "≥": ">=", "ε": "e", "’": "'"},
}
"""Replacement of a character where only ASCII can be shown."""
_NUMBER = r"[(\[<>~=+−-]*\d(?:[\d.,:]*\d)?(?:[eE][+-]?\d+)?"
_GLUED = re.compile(rf"(?<!\S)({_NUMBER}) (?=[%°µA-Za-z])|(?<=\S) (?=± )|(?<=±) |(?:(?<=N)|(?<=lbf)) (?=mm?\b|s\b)")
"""Spaces that no line may end at: between a number and its unit, about ±, within a unit such as N s."""
_UNIT = re.compile(r"(.*\S) (\([^()]*\))", re.DOTALL)


class Line(NamedTuple):
    """A line of text with its style: plain (empty), bold or dim."""

    text: str
    style: str = ""


def keys(*heads: str) -> list[Column]:
    """Return columns of words that name their row."""
    return texts(*heads, priority=KEY)


def texts(*heads: str, priority: int = MAIN) -> list[Column]:
    """Return columns of words."""
    return [Column("", (), label=head, priority=priority, words=True) for head in heads]


def numerals(*heads: str, priority: int = MAIN) -> list[Column]:
    """Return columns of numbers."""
    return [Column("", (), label=head, priority=priority) for head in heads]


def plain(text: str) -> str:
    """Return a text in ASCII, for a terminal that shows nothing else.

    Examples
    --------
    >>> plain("200 µs ± 5 µs, Müller – 9 m/s²")
    '200 us +/- 5 us, Muller - 9 m/s^2'
    """
    if text.isascii():
        return text
    text = "".join(PLAIN.get(character, character) for character in text)
    bare = "".join(c for c in unicodedata.normalize("NFKD", text) if not unicodedata.combining(c))
    return bare.encode("ascii", "replace").decode("ascii")


def clean(text: str) -> str:
    r"""Return a text without what a terminal would take as a command: such characters are written as \\xNN.

    Examples
    --------
    >>> print(clean("a\x1b[31mb"))
    a\x1b[31mb
    """
    text = text.replace("\xa0", " ").replace("\t", " ")
    return "".join(c if c.isprintable() or c == "\n" else ascii(c)[1:-1] for c in text)


def length(text: str) -> int:
    """Return the columns of a screen that a text takes.

    Examples
    --------
    >>> length("µs"), length("衝撃"), length("e\u0301")
    (2, 4, 1)
    """
    if text.isascii():
        return len(text)
    return sum((unicodedata.east_asian_width(c) in "WF") + 1 for c in text if not unicodedata.combining(c))


def tokens(text: str) -> list[str]:
    """Return what no line may break: words, and numbers with their units.

    Examples
    --------
    >>> tokens("4150 g (3200 to 4900 g), 1.2 N s of 65 %")
    ['4150 g', '(3200 to', '4900 g),', '1.2 N s', 'of', '65 %']
    """
    return [token.replace("\xa0", " ") for token in _GLUED.sub(lambda found: f"{found[1] or ''}\xa0", text).split(" ")]


def wrapped(text: str, width: float, indent: str = "") -> list[str]:
    """Return a text in lines that end at spaces; all but the first are indented. A longer word stands alone, whole.

    Examples
    --------
    >>> wrapped("the first reaches 4150 g in 200 us", 20, "  ")
    ['the first reaches', '  4150 g in 200 us']
    """
    lines: list[str] = []
    for paragraph in text.split("\n"):
        begin = len(lines)
        for token in tokens(paragraph):
            if len(lines) > begin and length(lines[-1]) + 1 + length(token) <= width:
                lines[-1] += f" {token}"
            else:
                lines.append((indent if lines else "") + token)
    return lines


def cut(text: str, width: float, end: str = "…") -> str:
    """Return a text in one line, cut between words where it is longer, with ``end`` after it.

    Examples
    --------
    >>> cut("the peak force of 20 kN is above 5 kN", 20)
    'the peak force of …'
    """
    text = " ".join(text.split())
    return text if length(text) <= width else f"{wrapped(text, width - 1 - len(end))[0]} {end}"


def table_lines(
    title: str, columns: Sequence[Column], rows: Iterable[Sequence[str]], width: float, wide: bool = False
) -> list[Line]:
    r"""Return a table as lines: with all columns that fit the width, or as a list where not even the main ones do.

    Parameters
    ----------
    title : str
        Title of the table; none if empty.
    columns : sequence of Column
        Its columns; head, priority and whether they are words matter here. Of those beyond `MAIN`, the first that does
        not fit and all that matter no more are left out, and named below.
    rows : iterable of sequences of str
        Its cells.
    width : float
        Characters of a line; may be infinite.
    wide : bool
        True if no column is left out: one that does not fit stands in a further piece of the table, below.

    Examples
    --------
    >>> from strikewave.base.declare import KEY, MORE
    >>> columns = [*numerals("#", priority=KEY), *numerals("rigid peak (g)"), *numerals("impulse (N s)", priority=MORE)]
    >>> print("\n".join(line.text for line in table_lines("Blows", columns, [["1", "4151.3", "4.32"]], 12)))
    Blows
        rigid
    #    peak
          (g)
    ─────────
    1  4151.3
    not shown:
    impulse
    (--wide)
    """
    grid = _Grid(columns, [list(row) for row in rows])
    heading = [Line(line, "bold") for line in wrapped(title, width)] if title else []
    if wide:
        pieces = grid.pieces(width)
        if pieces is None:
            return [*heading, *grid.turned(range(len(columns)), width)]
        return [*heading, *(line for places in pieces for line in grid.lines(places, width))]
    shown = grid.fitting(width)
    left_out = [column.head for place, column in enumerate(columns) if place not in shown]
    body = grid.lines(shown, width) if grid.fits(shown, width) else grid.turned(shown, width)
    return [*heading, *body, *_left_out(left_out, width)]


def _left_out(heads: Sequence[str], width: float) -> list[Line]:
    """Name the columns that are not shown."""
    if not heads:
        return []
    names = ", ".join(" ".join(_head_parts(head)[0].split()) for head in heads)
    return [Line(line, "dim") for line in wrapped(f"not shown: {names} (--wide)", width)]


def _head_parts(head: str) -> tuple[str, str]:
    """Return the words of a head, and its unit in brackets.

    Examples
    --------
    >>> _head_parts("impulse (N s)"), _head_parts("kind")
    (('impulse', '(N s)'), ('kind', ''))
    """
    found = _UNIT.fullmatch(head)
    return (found[1], found[2]) if found else (head, "")


def _longest(texts: Iterable[str]) -> int:
    return max(map(length, texts), default=0)


class _Grid:
    """Columns with their cells, and the widths that they take."""

    def __init__(self, columns: Sequence[Column], rows: Sequence[Sequence[str]]) -> None:
        self.columns, self.rows = columns, rows
        cells = [[row[place] for row in rows] for place in range(len(columns))]
        self.least = [self._least(column, texts) for column, texts in zip(columns, cells, strict=True)]
        self.most = [
            max(_longest(line for text in [column.head, *texts] for line in text.split("\n")), least)
            for column, texts, least in zip(columns, cells, self.least, strict=True)
        ]

    @staticmethod
    def _least(column: Column, cells: Sequence[str]) -> int:
        """Return the characters without which a column would break a word, or its head stand too high."""
        named, unit = _head_parts(column.head)
        parts = [token for text in cells for token in tokens(text.replace("\n", " "))] if column.words else cells
        longest = _longest(line for text in cells for line in text.split("\n"))
        least = max(_longest(tokens(named)), length(unit), _longest(parts))
        least = max(least, min(LEAST_TEXT, longest)) if column.words else least
        while len(wrapped(named, least)) > MOST_HEAD_LINES:
            least += 1
        return least

    def total(self, places: Sequence[int], widths: Sequence[int]) -> int:
        return sum(widths[place] for place in places) + len(GAP) * max(len(places) - 1, 0)

    def fits(self, places: Sequence[int], width: float) -> bool:
        return self.total(places, self.least) <= width

    def fitting(self, width: float) -> list[int]:
        """Return the columns that fit, by priority; those that matter in any case."""
        order = sorted(range(len(self.columns)), key=lambda place: self.columns[place].priority)
        shown: list[int] = []
        for place in order:
            if self.columns[place].priority > MAIN and not self.fits([*shown, place], width):
                break
            shown.append(place)
        return sorted(shown)

    def pieces(self, width: float) -> list[list[int]] | None:
        """Return all columns in pieces that fit, each with the keys; None where one does not fit beside them."""
        keys = [place for place, column in enumerate(self.columns) if column.priority == KEY]
        pieces: list[list[int]] = []
        for place in (place for place in range(len(self.columns)) if place not in keys):
            if not self.fits([*keys, place], width):
                return None
            if pieces and self.fits([*pieces[-1], place], width):
                pieces[-1].append(place)
            else:
                pieces.append([*keys, place])
        return [sorted(piece) for piece in pieces] or [keys]

    def widths(self, places: Sequence[int], width: float) -> dict[int, int]:
        """Share the width among columns: words first, so that rows take few lines, then what makes the heads lower."""
        ways = [self._in_proportion(places, width), *self._by_height(places, width)]
        widths = min(ways, key=lambda way: self._height(places, way))
        left = width - sum(widths.values()) - len(GAP) * (len(places) - 1)
        for high in range(1, MOST_HEAD_LINES):
            wanted = {place: self._head_width(place, widths[place], high) for place in places}
            if sum(wanted.values()) - sum(widths.values()) <= left:
                return wanted
        return widths

    def _in_proportion(self, places: Sequence[int], width: float) -> dict[int, int]:
        """Return widths that give each column of words an equal part of what it lacks to stand in one line."""
        widths = {place: self.least[place] for place in places}
        left = width - self.total(places, self.least)
        wanting = {place: self.most[place] - widths[place] for place in places if self.columns[place].words}
        share = min(left / sum(wanting.values()), 1.0) if any(wanting.values()) else 0.0
        return {place: widths[place] + int(share * wanting.get(place, 0)) for place in places}

    def _by_height(self, places: Sequence[int], width: float) -> Iterator[dict[int, int]]:
        """Give the widths at which no row takes more than two lines, or three and so on, where they fit."""
        for high in range(2, MOST_ROW_LINES + 1):
            widths = {place: self._row_width(place, high) for place in places}
            if sum(widths.values()) + len(GAP) * max(len(places) - 1, 0) <= width:
                yield widths

    def _row_width(self, place: int, high: int) -> int:
        """Return the least width at which no cell of a column takes more than so many lines."""
        if not self.columns[place].words:
            return self.least[place]
        widths = range(self.least[place], self.most[place])
        cells = {row[place] for row in self.rows}
        fits = (width for width in widths if all(len(wrapped(cell, width)) <= high for cell in cells))
        return next(fits, self.most[place])

    def _height(self, places: Sequence[int], widths: dict[int, int]) -> int:
        """Return the lines of all rows."""
        words = [place for place in places if self.columns[place].words]
        return sum(max((len(wrapped(row[place], widths[place])) for place in words), default=1) for row in self.rows)

    def _head_width(self, place: int, least: int, high: int) -> int:
        """Return the width at which a head takes no more than so many lines."""
        named = _head_parts(self.columns[place].head)[0]
        widths = range(least, max(length(named), least) + 1)
        return next(width for width in widths if len(wrapped(named, width)) <= high)

    def lines(self, places: Sequence[int], width: float) -> list[Line]:
        """Return head, rule and rows of some columns."""
        if not places:
            return []
        widths = self.widths(places, width)
        parts = [_head_parts(self.columns[place].head) for place in places]
        heads = [wrapped(named, widths[place]) for (named, _), place in zip(parts, places, strict=True)]
        units = [unit for _, unit in parts]
        high = max(map(len, heads))
        heads = [[""] * (high - len(head)) + head + [unit] for head, unit in zip(heads, units, strict=True)]
        lines = [self._line(heads, at, places, widths, "bold") for at in range(high + any(units))]
        lines = lines if any(line.text for line in lines) else []
        lines.append(Line("─" * self.total(range(len(places)), [widths[place] for place in places])))
        for row in self.rows:
            cells = [
                wrapped(row[place], widths[place]) if self.columns[place].words else row[place].split("\n")
                for place in places
            ]
            lines += [self._line(cells, at, places, widths) for at in range(max(map(len, cells)))]
        return lines

    def _line(
        self, cells: Sequence[Sequence[str]], at: int, places: Sequence[int], widths: dict[int, int], style: str = ""
    ) -> Line:
        """Return one line of a row of cells."""
        parts = []
        for cell, place in zip(cells, places, strict=True):
            text = cell[at] if at < len(cell) else ""
            space = " " * (widths[place] - length(text))
            parts.append(text + space if self.columns[place].words else space + text)
        return Line(GAP.join(parts).rstrip(), style)

    def turned(self, places: Sequence[int], width: float) -> list[Line]:
        """Return each row as a list of heads and cells, beside one another, or below where that is too wide."""
        keys = [place for place in places if self.columns[place].priority == KEY]
        others = [place for place in places if place not in keys]
        named = [" ".join(self.columns[place].head.split()) for place in others]
        column = _longest(named)
        beside = 2 + column + len(GAP) + max((self.least[place] for place in others), default=0) <= width
        lines = []
        for row in self.rows:
            called = ", ".join(f"{self.columns[place].head} {row[place]}".strip() for place in keys)
            lines += [Line(line, "bold") for line in wrapped(called, width)]
            for head, place in zip(named, others, strict=True):
                if beside:
                    space = 2 + column + len(GAP)
                    first, *more = wrapped(row[place], width - space)
                    lines += [Line(f"  {head}{' ' * (column - length(head))}{GAP}{first}".rstrip())]
                    lines += [Line(" " * space + line) for line in more]
                else:
                    lines += [Line(f"  {line}") for line in wrapped(head, width - 2)]
                    lines += [Line(f"    {line}") for line in wrapped(row[place], width - 4)]
        return lines
