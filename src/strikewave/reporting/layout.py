"""Tables and sentences as lines of text that fit a width: no number and no word is ever broken.

Nothing here knows a terminal: `strikewave.reporting.terminal` prints what these functions return.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from strikewave.base.declare import KEY, MAIN
from strikewave.reporting.columns import Column

GAP = "  "
"""Space between two columns."""
MOST_HEAD_LINES = 3  # higher heads are hard to read
"""Lines of the words of a head, if words that long let it."""
MOST_ROW_LINES = 6  # chosen: a table of higher rows is read as a list, which is what a narrow screen then gets
"""Lines of a row up to which the widths are sought at which no row takes more."""
LEAST_TEXT = 16  # two or three words of English: narrower columns are a ladder of single words
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
    return [token.replace("\xa0", " ") for token in _GLUED.sub("\\1\xa0", text).split(" ")]


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

    Head, priority and kind (words or numbers) of the columns matter here. Of those beyond `MAIN`, the first that does
    not fit and all that matter no more are left out, and named below; where all are wanted (``wide``), one that does
    not fit stands in a further piece of the table.

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
    grid = _Grid(columns, list(rows), width)
    lines = [Line(line, "bold") for line in wrapped(title, width)] if title else []
    if wide:
        pieces = grid.pieces()
        for piece in pieces:
            lines += grid.lines(piece)
        return lines if pieces else lines + grid.turned(range(len(columns)))
    shown = grid.fitting()
    lines += grid.lines(shown) if grid.fits(shown) else grid.turned(shown)
    left_out = [" ".join(head.split()) for place, head in enumerate(grid.heads) if place not in shown]
    if left_out:
        lines += [Line(line, "dim") for line in wrapped(f"not shown: {', '.join(left_out)} (--wide)", width)]
    return lines


def _longest(texts: Iterable[str]) -> int:
    return max(map(length, texts), default=0)


class _Grid:
    """Columns with their cells, by their places: heads, units, and the least and the largest width that each wants."""

    def __init__(self, columns: Sequence[Column], rows: Sequence[Sequence[str]], width: float) -> None:
        self.columns, self.rows, self.width = columns, rows, width
        self.heads: list[str] = []
        self.units: list[str] = []
        self.least: list[int] = []
        self.most: list[int] = []
        for place, column in enumerate(columns):
            found = _UNIT.fullmatch(column.head)
            head, unit = (found[1], found[2]) if found else (column.head, "")
            cells = [row[place] for row in rows]
            longest = _longest("\n".join(cells).split("\n"))
            least = max(_longest(tokens(head)), length(unit))
            if column.words:
                least = max(least, min(LEAST_TEXT, longest))
                for cell in cells:
                    least = max(least, _longest(tokens(cell.replace("\n", " "))))
            else:
                least = max(least, _longest(cells))
            while len(wrapped(head, least)) > MOST_HEAD_LINES:
                least += 1
            self.heads.append(head)
            self.units.append(unit)
            self.least.append(least)
            self.most.append(max(longest, _longest(column.head.split("\n")), least))

    def fits(self, places: Sequence[int]) -> bool:
        """Tell whether columns fit the width, each as narrow as no word of it breaks."""
        needed = [self.least[place] for place in places]
        return sum(needed) + len(GAP) * (len(needed) - 1) <= self.width

    def fitting(self) -> list[int]:
        """Return the columns that fit, by priority; those that matter in any case."""
        priorities = [column.priority for column in self.columns]
        shown: list[int] = []
        for place in sorted(range(len(priorities)), key=priorities.__getitem__):
            if priorities[place] > MAIN and not self.fits([*shown, place]):
                break
            shown.append(place)
        return sorted(shown)

    def pieces(self) -> list[list[int]]:
        """Return all columns in pieces that fit, each with the keys; nothing where one does not fit beside them."""
        keys = [place for place, column in enumerate(self.columns) if column.priority == KEY]
        pieces: list[list[int]] = []
        for place in range(len(self.columns)):
            if place in keys:
                continue
            if not self.fits([*keys, place]):
                return []
            if pieces and self.fits([*pieces[-1], place]):
                pieces[-1].append(place)
            else:
                pieces.append([*keys, place])
        return [sorted(piece) for piece in pieces] or [keys]

    def widths(self, places: Sequence[int]) -> dict[int, int]:
        """Share the width among columns: words first, so that rows take few lines, then what makes the heads lower."""
        room = self.width - len(GAP) * (len(places) - 1)
        words = [place for place in places if self.columns[place].words]
        best = {place: self.least[place] for place in places}
        lacking = sum([self.most[place] - self.least[place] for place in words])
        share = min((room - sum(best.values())) / lacking, 1.0) if lacking else 0.0
        for place in words:  # each an equal part of what it lacks to stand in one line
            best[place] += int(share * (self.most[place] - self.least[place]))
        lowest = self._height(words, best)
        for high in range(2, MOST_ROW_LINES + 1):
            way = {place: self._narrowest(place, high) for place in places}
            if sum(way.values()) <= room and self._height(words, way) < lowest:
                best, lowest = way, self._height(words, way)
        for high in range(1, MOST_HEAD_LINES):
            way = {}
            for place, width in best.items():
                while len(wrapped(self.heads[place], width)) > high:
                    width += 1
                way[place] = width
            if sum(way.values()) <= room:
                return way
        return best

    def _narrowest(self, place: int, high: int) -> int:
        """Return the least width at which no cell of a column takes more than so many lines."""
        width = self.least[place]
        if self.columns[place].words:
            for row in self.rows:
                while width < self.most[place] and len(wrapped(row[place], width)) > high:
                    width += 1
        return width

    def _height(self, words: Sequence[int], widths: dict[int, int]) -> int:
        """Return the lines of all rows."""
        height = 0
        for row in self.rows:
            height += max([len(wrapped(row[place], widths[place])) for place in words], default=1)
        return height

    def lines(self, places: Sequence[int]) -> list[Line]:
        """Return head, rule and rows of some columns."""
        if not places:
            return []
        widths = self.widths(places)
        heads = [wrapped(self.heads[place], widths[place]) for place in places]
        units = [self.units[place] for place in places]
        high = max(map(len, heads))
        lines: list[Line] = []
        if any("".join(head).strip() for head in heads) or any(units):
            heads = [[""] * (high - len(head)) + head + [unit] for head, unit in zip(heads, units, strict=True)]
            lines += self._set(heads, high + any(units), places, widths, "bold")
        lines.append(Line("─" * (sum(widths.values()) + len(GAP) * (len(places) - 1))))
        for row in self.rows:
            cells = []
            for place in places:
                text, is_words = row[place], self.columns[place].words
                cells.append(wrapped(text, widths[place]) if is_words else text.split("\n"))
            lines += self._set(cells, max(map(len, cells)), places, widths)
        return lines

    def _set(
        self, cells: Sequence[Sequence[str]], high: int, places: Sequence[int], widths: dict[int, int], style: str = ""
    ) -> list[Line]:
        """Return the lines of a row of cells, words to the left and numbers to the right."""
        lines = []
        for at in range(high):
            parts = []
            for cell, place in zip(cells, places, strict=True):
                text = cell[at] if at < len(cell) else ""
                space = " " * (widths[place] - length(text))
                parts.append(text + space if self.columns[place].words else space + text)
            lines.append(Line(GAP.join(parts).rstrip(), style))
        return lines

    def turned(self, places: Sequence[int]) -> list[Line]:
        """Return each row as a list of heads and cells, one beside the other, or below where that is too wide."""
        keys = [place for place in places if self.columns[place].priority == KEY]
        others = [place for place in places if place not in keys]
        heads = [" ".join(self.columns[place].head.split()) for place in others]
        indent = 2 + _longest(heads) + len(GAP)
        beside = indent + max([self.least[place] for place in others], default=0) <= self.width
        lines = []
        for row in self.rows:
            called = ", ".join([f"{self.columns[place].head} {row[place]}".strip() for place in keys])
            lines += [Line(line, "bold") for line in wrapped(called, self.width)]
            for head, place in zip(heads, others, strict=True):
                if beside:
                    first, *more = wrapped(row[place], self.width - indent)
                    lines.append(Line(f"  {head}{' ' * (indent - 2 - length(head))}{first}".rstrip()))
                    lines += [Line(" " * indent + line) for line in more]
                else:
                    lines += [Line(f"  {line}") for line in wrapped(head, self.width - 2)]
                    lines += [Line(f"    {line}") for line in wrapped(row[place], self.width - 4)]
        return lines
