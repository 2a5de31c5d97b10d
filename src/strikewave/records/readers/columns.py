"""Columns of numbers in text: encodings, the marks between cells, and a parser that takes any size in blocks."""

from __future__ import annotations

import codecs
import csv
import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from strikewave.base.errors import InputError
from strikewave.records.readers import LARGEST_ARRAY
from strikewave.records.record import Array

BLOCK = 8 * 2**20  # bytes read at a time: large enough for Arrow to be fast, little beside the columns
LONGEST_LINE = 2**20  # a longer line, in bytes, is refused: ten thousand cells of a hundred characters
# A line with more cells is refused: no recorder has as many channels, and each column takes memory of its own
MOST_COLUMNS = 10_000
# A line that begins so is a comment
COMMENTS = ("#", "%", "//")
MOST_WORDS = 1000  # different words of a coded column that are told apart: more are no names of channels
_MISSING = frozenset({"nan", "+nan", "-nan", "na", "n/a", "null"})  # words for a missing value, in small letters
# The same as Arrow takes them, letter by letter
_NULLS = ["", " ", "nan", "NaN", "NAN", "+nan", "-nan", "-NaN", "NA", "N/A", "n/a", "null", "NULL"]
# Lines by which marks are found where all but one give no numbers at all, and the share of them that are numbers
_SAMPLE, _PLAIN = 40, 0.8
_SMALL = 16 * 2**10  # bytes of a block below which it is read line by line and not halved again: some hundred lines
_THREADED = 2**20  # bytes of a block from which on Arrow takes threads: smaller ones are read before threads have begun
# Bytes that no text has: all control characters but tab, line ends, form feed and the old end of file
_CONTROL = bytes(set(range(32)) - {9, 10, 12, 13, 26}) + b"\x7f"
# Characters that may stand at either end of a line and mean nothing; the last is the mark of byte order
_ENDS = " \t\r\n\x1a\ufeff"


class Marks(NamedTuple):
    """Delimiter between cells, empty for blanks, and decimal mark."""

    delimiter: str
    decimal: str = "."


class Region(NamedTuple):
    """Lines of a file: from a byte on, or some lines after it, to an end; `cut` leaves out the last one.

    Where lines are `quoted` as a whole, their quotes are taken off.
    """

    path: Path
    encoding: str
    start: int = 0
    end: int | None = None
    skip: int = 0
    cut: bool = False
    lone_returns: bool = False
    line: int = 1
    quoted: bool = False


class CellLayout(NamedTuple):
    """Layout of a line: delimiter, number of cells, wanted cells, and the header that must not come again.

    Up to the line `beside`, settings may stand behind the cells. Of the wanted ones, those that are `coded` hold words.
    """

    marks: Marks
    width: int
    wanted: tuple[int, ...]
    header: tuple[str, ...] = ()
    beside: int = 0
    coded: tuple[int, ...] = ()


class ParsedColumns(NamedTuple):
    """Columns wanted, how many of their cells are no numbers, and the line of the first of these.

    ``labels`` are the words of each coded column: its values are their places, NaN for none and beyond `MOST_WORDS`.
    """

    columns: list[Array]
    words: int
    first_word: int
    labels: dict[int, list[str]] = {}  # noqa: RUF012  (never changed)


def refuse(path: Path, allowed: str, hint: str = "") -> InputError:
    """Return the error for a file that cannot be used."""
    return InputError("FILE", path, allowed, hint)


def encoding_of(head: bytes) -> str | None:
    r"""Return the encoding of text by its first bytes, or None where they are no text."""
    for bom, name in ((codecs.BOM_UTF16_LE, "utf-16-le"), (codecs.BOM_UTF16_BE, "utf-16-be")):
        if head.startswith(bom):
            text = decode(head, name).encode("utf-8", "replace")
            return None if text.translate(None, _CONTROL) != text else name
    if head.translate(None, _CONTROL) != head:
        return None
    try:
        codecs.getincrementaldecoder("utf-8")().decode(head)
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8"


def decode(raw: bytes, encoding: str) -> str:
    """Decode part of a file; what cannot be decoded becomes a replacement character."""
    return codecs.getincrementaldecoder(encoding)("replace").decode(raw)


def lines_of(text: str) -> list[str]:
    """Split text at its line ends, of any system."""
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def cells_of(line: str, marks: Marks) -> list[str]:
    """Cut a line into cells."""
    line = line.strip("\x1a\ufeff\r\n")
    if not marks.delimiter:
        return line.replace('"', " ").split() or [""]
    if '"' not in line:
        return [cell.strip() for cell in line.split(marks.delimiter)]
    try:
        row = next(csv.reader([line], delimiter=marks.delimiter, skipinitialspace=True))
    except csv.Error:
        return [line]
    return [cell.strip() for cell in row]


def number(cell: str, decimal: str = ".") -> float | None:
    """Return the number in a cell: NaN where it is empty or a word for none, None where it is no finite number.

    Examples
    --------
    >>> number("1,5", ","), number(""), number("1e999"), number("over")
    (1.5, nan, None, None)
    """
    if not cell or cell.lower() in _MISSING:
        return math.nan
    if decimal == ",":
        if "." in cell or cell[-1] == ",":
            return None
        cell = cell.replace(",", ".", 1)
    if "_" in cell or not cell.isascii():
        return None
    try:
        value = float(cell)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def is_comment(line: str) -> bool:
    """Tell whether a line is a comment."""
    return line.lstrip(_ENDS).startswith(COMMENTS)


def find_marks(lines: Sequence[str], path: Path) -> Marks:
    """Find what stands between cells and before decimals: the marks under which most lines are numbers only."""
    orders = [Marks("\t"), Marks(";"), Marks(","), Marks(""), Marks("\t", ","), Marks(";", ","), Marks("", ",")]
    if any('"' in line for line in lines):
        orders.append(Marks(",", ","))
    best = _plain(orders, lines) or max(orders, key=lambda marks: _fit(lines, marks))
    if best == Marks(","):
        rows = [cells_of(line, best) for line in lines]
        if _decimals_behind_commas(rows, 2):
            return Marks("\t", ",")
        if _decimals_behind_commas(rows, 0):
            hint = "commas stand both between the numbers and within them: export it with semicolons or points"
            raise refuse(path, "a file whose numbers can be told apart", hint)
    return best


def _plain(orders: Iterable[Marks], lines: Sequence[str]) -> Marks | None:
    """Return the only marks under which lines of a sample are numbers, where nearly all are; None in doubt."""
    sample = lines[:: max(len(lines) // _SAMPLE, 1)]
    fitting = [(marks, _fit(sample, marks)[0]) for marks in orders]
    fitting = [(marks, count) for marks, count in fitting if count]
    return fitting[0][0] if len(fitting) == 1 and fitting[0][1] >= max(_PLAIN * len(sample), 2) else None


def _fit(lines: Iterable[str], marks: Marks) -> tuple[int, int, int]:
    """Count the lines that are numbers only and their numbers; the numbers on all lines where there are none."""
    plain = inside = numbers = 0
    for line in lines:
        values = [number(cell, marks.decimal) for cell in cells_of(line, marks)[:MOST_COLUMNS]]
        count = sum(value is not None and value == value for value in values)
        clean = count > 0 and None not in values
        plain, inside, numbers = plain + clean, inside + clean * count, numbers + count
    return plain, inside, 0 if plain else numbers


def _decimals_behind_commas(rows: list[list[str]], width: int) -> bool:
    """Tell whether every second cell of whole numbers reads like decimals: 0,05 and -0,5 but not 01,05."""
    rows = [row for row in rows if row and number(row[0]) is not None]
    if not rows or any(len(row) % 2 or (len(row) != width if width else len(row) < 4) for row in rows):
        return False
    ahead = [cell.lstrip("+-") for row in rows for cell in row[::2]]
    behind = [cell for row in rows for cell in row[1::2]]
    if not all(cell.isdecimal() for cell in ahead + behind) or any(len(c) > 1 and c[0] == "0" for c in ahead):
        return False
    return any(len(c) > 1 and c[0] == "0" for c in behind) or any(row[0] == "-0" for row in rows)


def parse(region: Region, grid: CellLayout, expected: int) -> ParsedColumns:
    """Read columns of numbers in blocks; blocks that are not clean are read again line by line.

    ``expected`` is about how many lines there are.
    """
    store = _Store(region.path, len(grid.wanted), expected)
    line = region.line + region.skip
    for block in blocks(region):
        _take(block, line, grid, store, region.encoding)
        line += block.count(b"\n")
    labels = {k: list(codes) for k, codes in store.labels.items()}
    return ParsedColumns(store.columns(), store.words, store.first_word, labels)


class _Store:
    """Columns that grow."""

    def __init__(self, path: Path, count: int, expected: int) -> None:
        self.path = path
        self.used = 0
        self.words = 0
        self.first_word = 0
        self.labels: dict[int, dict[str, int]] = {}
        self._arrays = [np.empty(0)] * count
        self._grow(expected)

    def code(self, column: int, word: str) -> float:
        """Return the code of a word of a column."""
        known, word = self.labels.setdefault(column, {}), word.strip()
        if not word or (word not in known and len(known) >= MOST_WORDS):
            return math.nan
        return float(known.setdefault(word, len(known)))

    def add(self, columns: Sequence[Array]) -> None:
        """Append as many values to every column."""
        end = self.used + (columns[0].size if columns else 0)
        if self._arrays and end > self._arrays[0].size:
            self._grow(end + end // 4 + 1000)
        for array, values in zip(self._arrays, columns, strict=True):
            array[self.used : end] = values
        self.used = end

    def columns(self) -> list[Array]:
        """Return the columns as long as they are filled."""
        loose = bool(self._arrays) and self.used < 0.5 * self._arrays[0].size
        return [array[: self.used].copy() if loose else array[: self.used] for array in self._arrays]

    def _grow(self, size: int) -> None:
        most = LARGEST_ARRAY // (8 * max(1, len(self._arrays)))
        if self.used > most or (self.used and size > most and self._arrays[0].size >= most):
            raise refuse(self.path, f"channels of at most {LARGEST_ARRAY >> 30} GiB", "read fewer channels")
        for k, old in enumerate(self._arrays):
            self._arrays[k] = np.empty(min(size, most))
            self._arrays[k][: self.used] = old[: self.used]


def blocks(region: Region) -> Iterator[bytes]:
    """Give whole lines, in UTF-8 or an encoding that keeps ASCII, in blocks of about `BLOCK` bytes."""
    lines = carried = b""
    skip = region.skip
    for raw in _raw(region):
        text = carried + raw
        end = text.rfind(b"\n") + 1
        if len(text) - end > LONGEST_LINE:
            raise refuse(region.path, f"lines of at most {LONGEST_LINE} bytes", "is this a text file of numbers?")
        if lines:
            yield lines
        lines, carried = text[:end], text[end:]
        while skip and lines:
            lines, skip = lines[lines.find(b"\n") + 1 :], skip - 1
    last = lines + carried
    while skip and last:
        last, skip = last.partition(b"\n")[2], skip - 1
    if region.cut:
        last = last[: last.rstrip(_ENDS[:5].encode()).rfind(b"\n") + 1]
    if last:
        yield last


def _raw(region: Region) -> Iterator[bytes]:
    wide = region.encoding.startswith("utf-16")
    decoder = codecs.getincrementaldecoder(region.encoding)("replace")
    with region.path.open("rb") as opened:
        at = opened.seek(region.start)
        while raw := opened.read(BLOCK if region.end is None else min(BLOCK, region.end - at)):
            beginning, at = at == 0, at + len(raw)
            raw = decoder.decode(raw).encode("utf-8", "replace") if wide else raw
            raw = raw.removeprefix(codecs.BOM_UTF8) if beginning else raw
            raw = raw.replace(b'"', b"") if region.quoted else raw
            yield raw.replace(b"\r\n", b"\n").replace(b"\r", b"\n") if region.lone_returns else raw


def _take(block: bytes, line: int, grid: CellLayout, store: _Store, encoding: str) -> None:
    """Read a block at once; halve it where that fails, so that only few lines are read one by one."""
    columns = _at_once(block, grid, store)
    if columns is not None:
        return store.add(columns)
    middle = block.rfind(b"\n", 0, len(block) // 2) + 1
    if len(block) <= _SMALL or not middle:
        return _one_by_one(block, line, grid, store, encoding)
    _take(block[:middle], line, grid, store, encoding)
    return _take(block[middle:], line + block.count(b"\n", 0, middle), grid, store, encoding)


def _at_once(block: bytes, grid: CellLayout, store: _Store) -> list[Array] | None:
    import pyarrow as pa  # type: ignore[import-untyped]
    from pyarrow import csv as fast

    delimiter, decimal = grid.marks
    names = [str(k) for k in range(grid.width)]
    wanted = [names[k] for k in grid.wanted]
    types = {names[k]: pa.string() if k in grid.coded else pa.float64() for k in grid.wanted}
    convert = fast.ConvertOptions(column_types=types, include_columns=wanted, null_values=_NULLS, decimal_point=decimal)
    try:
        table = fast.read_csv(
            pa.BufferReader(block if delimiter else _single_blanks(block)),
            fast.ReadOptions(column_names=names, use_threads=len(block) > _THREADED),
            fast.ParseOptions(delimiter=delimiter or " "),
            convert,
        )
    except pa.ArrowInvalid:
        return None
    columns = [
        _codes(table.column(k), place, store) if place in grid.coded else _floats(table.column(k))
        for k, place in enumerate(grid.wanted)
    ]
    return None if any(np.isinf(column).any() for column in columns) else columns


def _codes(column: Any, place: int, store: _Store) -> Array:
    """Return the codes of an Arrow column of words."""
    parts = [np.empty(0)]
    for chunk in column.chunks:
        coded = chunk.dictionary_encode()
        codes = np.array([store.code(place, word.as_py() or "") for word in coded.dictionary] or [math.nan])
        parts.append(codes[coded.indices.to_numpy(zero_copy_only=False)])
    return np.concatenate(parts)


def _floats(column: Any) -> Array:
    """Return an Arrow column of float64, NaN where it has nothing; Arrow's own way would import pandas (0.3 s)."""
    parts = []
    for chunk in column.chunks:
        valid, data = chunk.buffers()
        part = np.frombuffer(data, np.float64, len(chunk), 8 * chunk.offset)
        if chunk.null_count:
            bits = np.unpackbits(np.frombuffer(valid, np.uint8), bitorder="little")
            part = np.where(bits[chunk.offset : chunk.offset + len(chunk)], part, np.nan)
        parts.append(part)
    return parts[0] if len(parts) == 1 else np.concatenate([np.empty(0), *parts])


def _single_blanks(block: bytes) -> bytes:
    block = block.replace(b"\r\n", b"\n").replace(b"\t", b" ")
    while b"  " in block:
        block = block.replace(b"  ", b" ")
    return block.replace(b"\n ", b"\n").replace(b" \n", b"\n").strip(b" ")


def _one_by_one(block: bytes, line: int, grid: CellLayout, store: _Store, encoding: str) -> None:
    rows = []
    text = block.decode("utf-8" if encoding.startswith("utf-16") else encoding, "replace")
    for k, row in enumerate(lines_of(text), start=line):
        if len(row) > LONGEST_LINE:
            raise refuse(store.path, f"lines of at most {LONGEST_LINE} bytes", f"line {k} is longer")
        if not row.strip(_ENDS) or is_comment(row):
            continue
        cells = cells_of(row, grid.marks)
        if k > grid.beside and any(cells[grid.width :]):
            hint = f"line {k} has {len(cells)}: is it damaged, or are two files in one?"
            raise refuse(store.path, f"{grid.width} columns in every line", hint)
        if grid.header and tuple(cells[: len(grid.header)]) == grid.header:
            raise refuse(store.path, "one record in a file", f"the header comes again in line {k}: split it there")
        own = [(j, cells[j] if j < len(cells) else "") for j in grid.wanted]
        rows.append([store.code(j, cell) if j in grid.coded else _value(cell, grid, store, k) for j, cell in own])
    if rows:
        store.add(list(np.array(rows, dtype=float).T))


def _value(cell: str, grid: CellLayout, store: _Store, line: int) -> float:
    value = number(cell, grid.marks.decimal)
    if value is not None:
        return value
    store.first_word = store.first_word or line
    store.words += 1
    return math.nan
