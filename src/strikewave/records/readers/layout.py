"""Where the numbers of a text file are: its encoding, its marks, its first line, its columns, a last line cut off."""

from __future__ import annotations

import re
from collections import Counter
from itertools import islice
from pathlib import Path
from typing import NamedTuple

from strikewave.base.first_few import first_few
from strikewave.records.health_notice import HealthNotice
from strikewave.records.readers.columns import (
    LONGEST_LINE,
    MOST_COLUMNS,
    Marks,
    cells_of,
    decode,
    encoding_of,
    find_marks,
    is_comment,
    lines_of,
    number,
    refuse,
)
from strikewave.records.readers.headings import Headings, find_headings

HEAD = 2**20
"""Bytes from the beginning in which header and first data are looked for: heads of loggers have kilobytes."""
_PART = 2**16
"""Bytes from the middle and the end of a large file that are looked at: some hundred lines."""
_LINES, _MIDDLE_LINES, _SHORT = 200, 100, 500
"""Lines of the beginning and the end, and of the middle, by which marks and columns are judged; a shorter file is
judged by all of its lines."""
_MOST_JUDGED, _FEWEST_JUDGED = 2**18, 8
"""Characters of those lines at most, for lines of thousands of cells, and lines that are left at least."""
_CLEAN = 5
"""One line in so many must be numbers alone for the others to be left out as words, errors or heads."""
_SPARSE, _FEWEST = 100, 16
"""A column with a value in fewer than one line in so many, or in fewer lines than a blow needs samples while most have
none, holds settings, not samples."""
_BESIDE = 40
"""First lines of the data beside which settings may stand without a column of their own."""
_MOST_SETTINGS, _LONGEST_KIND = 40, 60
"""Lines above the data in which settings of each channel are looked for, and letters of their names."""
_FEWEST_ALIKE, _FEWEST_MANY = 8, 50
"""Numbers above the last one, all of as many digits, or so many of any, by which it is known to be cut."""
_OVER = re.compile(
    r"[+-]?\d\S*|[<>+-]?\s?(?:over\w*|ovr|ovld|o\.?l\.?|inf\w*|∞|clip\w*|error)|-{1,9}|\*{1,9}|\?{1,9}", re.IGNORECASE
)
"""Cells of a line of data that hold no number: over the range, an error, blanks of dashes and the like."""
_DECIMALS = re.compile(r"[+-]?\d*(?:[.,](\d*))?(?:[eE][+-]?(\d*))?")
"""Decimals and digits of the power of a printed number."""


class Look(NamedTuple):
    """Lines from the beginning, the middle and the end of a file; `ended` when its last line has an end.

    It may be a part of a file, from the byte ``begin``, which is in the line ``line``, to ``end``. Where lines are
    `quoted` as a whole, their quotes are taken off.
    """

    path: Path
    size: int
    encoding: str
    lone_returns: bool
    head: list[str]
    middle: list[str]
    tail: list[str]
    ended: bool
    quoted: bool = False
    begin: int = 0
    end: int | None = None
    line: int = 1


class NumberLayout(NamedTuple):
    """Where the numbers are: first line, columns that hold some, columns that hold them in most lines.

    Up to the line `beside`, settings may stand behind the columns.
    """

    marks: Marks
    width: int
    first: int
    filled: list[int]
    full: list[int]
    headings: Headings
    above: list[str]
    findings: list[HealthNotice]
    beside: int = 0


def look_at(path: Path, part: tuple[int, int, int] | None = None, encoding: str | None = None) -> Look:
    """Look at the beginning, the middle and the end of a text file, or of a part of it.

    Parameters
    ----------
    path : Path
        The file.
    part : (int, int, int), optional
        First byte and end of a part, and the line in which it begins.
    encoding : str, optional
        Of the whole file, for a part of it.

    Raises
    ------
    InputError
        If it is no text, or its lines are too long.
    """
    begin, end = (0, path.stat().st_size) if part is None else part[:2]
    size = end - begin
    with path.open("rb") as opened:
        opened.seek(begin)
        head = opened.read(min(HEAD, size))
        opened.seek(begin + (size // 2 & ~1))
        middle = opened.read(_PART) if size > HEAD else b""
        opened.seek(begin + (max(0, size - _PART) & ~1))
        tail = opened.read(min(_PART, size)) if size > HEAD else b""
    encoding = encoding or encoding_of(head)
    if encoding is None:
        raise refuse(path, "text, or another known format", "it holds bytes that are no text")
    lines = lines_of(decode(head, encoding).removeprefix("\ufeff"))
    lone = (
        b"\r" in head.replace(b"\r\n", b"")
        if encoding in ("utf-8", "cp1252")
        else "\r" in decode(head, encoding).replace("\r\n", "")
    )
    if size > HEAD:
        lines, ends = lines[:-1], lines_of(decode(tail, encoding))[1:]
        between = lines_of(decode(middle, encoding))[1:-1]
    else:
        ends, between = lines[-_LINES:], lines[len(lines) // 2 :][:_MIDDLE_LINES]
    if not lines:
        raise refuse(path, f"lines of at most {LONGEST_LINE} bytes", "is this a text file of numbers?")
    ended = not ends or not ends[-1].strip(" \t\x1a")
    between, ends = between[:_MIDDLE_LINES], [end for end in ends if end.strip()][-_LINES:]
    quoted = _are_quoted(lines[:_LINES])
    if quoted:
        lines, between, ends = ([line.replace('"', "") for line in part] for part in (lines, between, ends))
    place = () if part is None else part
    return Look(path, size, encoding, lone, lines, between, ends, ended, quoted, *place)


def _are_quoted(lines: list[str]) -> bool:
    """Tell whether each line as a whole stands in quotes, as some programs write what they take for a single cell."""
    bodies = [line.strip()[1:-1] for line in lines if line.strip().startswith('"') and line.strip().endswith('"')]
    many = [body for body in bodies if '"' not in body and re.search(r"[,;\t]", body)]
    return len(many) > 2 and len(many) >= len(lines) - lines.count("") - _CLEAN and not _decimal_commas(many)


def _decimal_commas(bodies: list[str]) -> bool:
    """Tell whether lines in quotes are single numbers with a decimal comma."""
    return all(number(body.strip(), ",") is not None for body in bodies[len(bodies) // 2 :])


def lay_out(look: Look) -> NumberLayout:
    """Find the marks, the columns and the first line of the numbers, and what stands above them.

    Raises
    ------
    InputError
        If there are no columns of numbers, or too many.
    """
    short = len(look.head) <= _SHORT and look.size <= HEAD
    body = [
        line
        for line in (look.head if short else look.head[:_LINES] + look.middle + look.tail[:-1])
        if line.strip() and not is_comment(line)
    ]
    while sum(map(len, body)) > _MOST_JUDGED and len(body) > _FEWEST_JUDGED:
        body = body[::2]
    marks = find_marks(body, look.path)
    rows = [[number(cell, marks.decimal) for cell in cells_of(line, marks)] for line in body]
    rows = [row for row in rows if any(v is not None and v == v for v in row)]
    clean = [row for row in rows if None not in row]
    rows = clean if len(clean) >= max(2, len(rows) // _CLEAN) else rows
    if not rows:
        raise refuse(look.path, "columns of numbers", "no line of it holds numbers only")
    width = Counter(map(len, rows)).most_common(1)[0][0]
    if width > MOST_COLUMNS:
        raise refuse(look.path, f"at most {MOST_COLUMNS} columns", f"it has {width}")
    filled, full, findings = _columns_with_numbers([row for row in rows if len(row) == width], look.path)
    findings = sorted(
        findings + _labels(body, marks, width, filled, findings), key=lambda notice: (notice.code, notice.message)
    )
    first = _first_line(look, marks, width, full)
    above = look.head[:first]
    findings += _settings_above(above, marks, full)
    beside = _settings_beside(look, marks, width, first)
    if beside:
        message = f"settings stand behind the columns in lines {first + 1} to {beside}: they are left out"
        findings.append(HealthNotice("column-dropped", message, width + 1.0, severity="good"))
    headings = find_headings(above, marks, width, filled)
    dropped = {finding.value for finding in findings if finding.code == "column-dropped"}
    for k, name in enumerate(headings.names):
        if name and k not in filled and k + 1.0 not in dropped:
            message = f"column {k + 1}, {name}, is left out: it holds no number"
            findings.append(HealthNotice("column-dropped", message, k + 1.0, severity="good"))
    return NumberLayout(marks, width, first, filled, full, headings, above, findings, beside)


def _settings_beside(look: Look, marks: Marks, width: int, first: int) -> int:
    """Return the last of the first lines of the data that have more cells than columns; 0 where none has."""
    lines = look.head[first : first + _BESIDE + 1]
    wider = [k for k, line in enumerate(lines, start=first + 1) if any(cells_of(line, marks)[width:])]
    many = len(look.head) - first > 2 * len(wider)  # else the lines that have fewer cells are the odd ones
    together = bool(wider) and wider[0] == first + 1 and wider == list(range(wider[0], wider[-1] + 1))
    return wider[-1] if many and together and len(wider) <= _BESIDE else 0


def _columns_with_numbers(
    rows: list[list[float | None]], path: Path
) -> tuple[list[int], list[int], list[HealthNotice]]:
    filled, full, findings = [], [], []
    for k, column in enumerate(zip(*rows, strict=True)):
        here = [value is not None and value == value for value in column]
        numbers, word_count = sum(here), column.count(None)
        sparse = numbers <= len(rows) // _SPARSE or (numbers == 1 and here[0] and len(rows) > 2)
        sparse = sparse or (numbers < _FEWEST and len(rows) >= 2 * _FEWEST)
        if numbers > word_count and not sparse:
            filled.append(k)
            full += [k] if 2 * numbers >= len(rows) else []
        elif numbers or word_count:
            what = (
                "holds words" if word_count >= numbers else f"has a value in {numbers} of {len(rows)} lines looked at"
            )
            findings.append(
                HealthNotice("column-dropped", f"column {k + 1} is left out: it {what}", k + 1.0, severity="good")
            )
    if not filled:
        raise refuse(path, "columns of numbers", "no column of it holds numbers in most lines")
    return filled, full or filled, findings


def _labels(
    body: list[str], marks: Marks, width: int, filled: list[int], known: list[HealthNotice]
) -> list[HealthNotice]:
    """Say which columns hold settings beside the first lines of the data."""
    reported = {finding.value for finding in known}
    if all(k in filled or k + 1.0 in reported for k in range(width)):
        return []
    rows = [cells for cells in (cells_of(line, marks) for line in body) if len(cells) == width]
    numbers = [row for row in rows if all(number(row[k], marks.decimal) is not None for k in filled)]
    return [
        HealthNotice("column-dropped", f"column {k + 1} is left out: it holds settings", k + 1.0, severity="good")
        for k in range(width)
        if k not in filled and k + 1.0 not in reported and any(_says(row[k], marks) for row in numbers)
    ]


def _says(cell: str, marks: Marks) -> bool:
    """Tell whether a cell holds a word or a number, and not a word for none."""
    value = number(cell, marks.decimal)
    return value is None or value == value


def _first_line(look: Look, marks: Marks, width: int, full: list[int]) -> int:
    """Return the first line of the data: the first with a number in every column, and lines like it above."""

    def values(line: str) -> list[float | None]:
        cells = cells_of(line, marks)
        return [number(cells[k] if k < len(cells) else "", marks.decimal) for k in full]

    def holds(line: str, least: int) -> bool:
        numbers = [] if is_comment(line) else values(line)
        return sum(v is not None and v == v for v in numbers) >= least

    for least in (len(full), 1):
        first = next((k for k, line in enumerate(look.head) if holds(line, least)), None)
        if first is not None:
            break
    else:
        raise refuse(look.path, "columns of numbers", f"the first {HEAD} bytes hold none")
    while first > 0 and _nearly(look.head[first - 1], marks, width, full):
        first -= 1
    after = _after_settings(look, marks, full, first)
    return next((k for k in range(after, len(look.head)) if holds(look.head[k], least)), first) if after else first


def _after_settings(look: Look, marks: Marks, full: list[int], first: int) -> int:
    """Return the line after settings that have a number for each channel, such as ``delta t``; 0 without one.

    They begin with a name where the lines of data begin with none, with a date, or with names that come again. Where
    more columns stand before those of the data, settings have their values there, beside the samples.
    """
    if full[0] != 1:
        return 0
    lines = look.head[first : first + _MOST_SETTINGS]
    body = [line for line in look.head[first:] if line.strip()]
    if look.size > HEAD:
        body = look.middle + look.tail
    later = max(len(body) // 2, len(body) - _LINES)
    usual = [cells_of(line, marks)[0] for line in body[later:]]
    twice = 0 if look.size > HEAD else max(sum(bool(line.strip()) for line in lines) - later, 0)  # in a short file
    kinds = Counter(map(_kind, usual))
    counts = Counter(usual[twice:] + [cells_of(line, marks)[0] for line in lines])
    come_again = bool(usual) and sum(counts[cell] > 1 for cell in usual) > len(usual) // 2
    after = 0
    for k, line in enumerate(lines, start=first):
        cells = cells_of(line, marks)
        has_numbers = any(number(cell, marks.decimal) is not None for cell in cells[1:] if cell)
        is_name = cells[0][:1].isalpha() and (_kind(cells[0]) not in kinds or (come_again and counts[cells[0]] == 1))
        if has_numbers and not is_name:
            break
        after = k + 1 if is_name else after
    return after


def _settings_above(above: list[str], marks: Marks, full: list[int]) -> list[HealthNotice]:
    """Say which lines above the data have a number for each channel and are settings."""
    rows = [cells_of(line, marks) for line in above if full[0] == 1 and not is_comment(line)]
    names = [
        row[0]
        for row in rows
        if row[0][:1].isalpha() and all(k < len(row) and number(row[k] or "-", marks.decimal) is not None for k in full)
    ]
    if not names:
        return []
    message = f"settings above the data are no samples: {first_few([name[:_LONGEST_KIND] for name in names], 4)}"
    return [HealthNotice("settings", message, float(len(names)), severity="good")]


def _kind(cell: str) -> str:
    """Return what a cell looks like: all words and all numbers are one.

    Examples
    --------
    >>> _kind("05/01/2026 10:45"), _kind("delta t"), _kind("")
    ('0/0/0 0:0', 'a a', '')
    """
    return re.sub(r"[^\W\d_]+", "a", re.sub(r"\d+", "0", cell[:_LONGEST_KIND]))


def _nearly(line: str, marks: Marks, width: int, full: list[int]) -> bool:
    """Tell whether a line is one of data in which some cells are missing or over the range."""
    cells = cells_of(line, marks)
    if is_comment(line) or len(cells) != width or len(full) < 2:
        return False
    values = [number(cells[k], marks.decimal) for k in full]
    rest = [cells[k] for k, value in zip(full, values, strict=True) if value is None]
    return values[0] is not None and values[0] == values[0] and all(_OVER.fullmatch(cell[:20]) for cell in rest)


def is_data(line: str, layout: NumberLayout) -> bool:
    """Tell whether a line is one of data: a number in every column that is full of them, or nearly."""
    cells = cells_of(line, layout.marks)
    values = [number(cells[k] if k < len(cells) else "", layout.marks.decimal) for k in layout.full]
    whole = not is_comment(line) and all(value is not None and value == value for value in values)
    return whole or _nearly(line, layout.marks, layout.width, layout.full)


def is_cut(look: Look, layout: NumberLayout) -> bool:
    """Tell whether the last line lacks columns, or ends in a number that was cut."""
    filled = (line for line in reversed(look.head[layout.first :]) if line.strip())
    lines = look.tail if look.size > HEAD else list(islice(filled, _LINES))[::-1]
    if len(lines) < 3 or is_comment(lines[-1]):
        return False
    *before, last = (cells_of(line, layout.marks) for line in lines if not is_comment(line))
    values = [number(last[k] if k < len(last) else "", layout.marks.decimal) for k in layout.full]
    lacking = [k for k, value in zip(layout.full, values, strict=True) if value is None or value != value]
    usual = all(k < len(row) and row[k] for row in before[-10:] for k in lacking)
    if lacking and usual:
        return not look.ended or len(last) < min(map(len, before[-10:]))
    return not look.ended and not lacking and _number_is_cut(before, last, layout)


def _number_is_cut(before: list[list[str]], last: list[str], layout: NumberLayout) -> bool:
    """Tell whether the last number has fewer digits than any above it, where these are all alike or many."""
    k = max(k for k, cell in enumerate(last) if cell)
    if k != len(last) - 1 or k not in layout.filled:
        return False
    above = [_digits(row[k]) for row in before if k < len(row) and row[k]]
    alike = len(above) >= _FEWEST_ALIKE and len(set(above)) == 1
    own = _digits(last[k])
    return (alike or len(above) >= _FEWEST_MANY) and any(
        digits < min(others) for digits, *others in zip(own, *above, strict=True)
    )


def _digits(cell: str) -> tuple[int, int]:
    match = _DECIMALS.fullmatch(cell)
    return (len(match[1] or ""), len(match[2] or "")) if match else (0, 0)
