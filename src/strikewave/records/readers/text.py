"""Text with columns of numbers: CSV, TSV and blanks, from any instrument, with or without a header.

Where the numbers are is found first: encoding, marks, first line, columns, a last line cut off.
"""

from __future__ import annotations

import mmap
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import numpy as np

from strikewave.base.errors import InputError, nearest
from strikewave.base.texts import first_few
from strikewave.records.health_notice import HealthNotice
from strikewave.records.readers import FEWEST_SAMPLES, MOST_MEASUREMENTS, Options, joined_pieces, parted
from strikewave.records.readers.columns import (
    LONGEST_LINE,
    MOST_COLUMNS,
    CellLayout,
    Marks,
    ParsedColumns,
    Region,
    cells_of,
    decode,
    encoding_of,
    find_marks,
    is_comment,
    lines_of,
    number,
    parse,
    refuse,
)
from strikewave.records.readers.common import begin_together, one_each
from strikewave.records.readers.headings import (
    Headings,
    below_start_and_increment,
    counted_samples,
    find_headings,
    is_counter,
    is_time,
    last_digit,
    rises_evenly,
    said_step,
    seconds_in,
    settings_of,
    step_of,
    to_seconds,
)
from strikewave.records.readers.long_table import (
    MOST_LABELS,
    Labels,
    as_asked,
    as_long_table,
    labels_of,
    may_be_labels,
    may_count,
)
from strikewave.records.record import Array, Channel, Record

HEAD = 2**20  # bytes from the beginning in which header and first data are looked for: heads of loggers have kilobytes
_PART = 2**16  # bytes from the middle and the end of a large file that are looked at: some hundred lines
# Lines of both ends and the middle that show a layout; a short file shows all
_LINES, _MIDDLE_LINES, _SHORT = 200, 100, 500
# Characters of those lines at most, for lines of thousands of cells, and lines that are left at least
_MOST_JUDGED, _FEWEST_JUDGED = 2**18, 8
_CLEAN = 5  # one line in so many must be numbers alone for the others to be left out as words, errors or heads
_SPARSE, _FEWEST = 100, 16  # a column with fewer values, by share or count, holds settings: a blow needs more samples
_BESIDE = 40  # first lines of the data beside which settings may stand without a column of their own
# Lines above the data in which settings of each channel are looked for, and letters of their names
_MOST_SETTINGS, _LONGEST_KIND = 40, 60
# Numbers above the last one, all of as many digits, or so many of any, by which it is known to be cut
_FEWEST_ALIKE, _FEWEST_MANY = 8, 50
# Cells of a line of data that hold no number: over the range, an error, blanks of dashes and the like
_OVER = re.compile(
    r"[+-]?\d\S*|[<>+-]?\s?(?:over\w*|ovr|ovld|o\.?l\.?|inf\w*|∞|clip\w*|error)|-{1,9}|\*{1,9}|\?{1,9}", re.IGNORECASE
)
# Decimals and digits of the power of a printed number
_DECIMALS = re.compile(r"[+-]?\d*(?:[.,](\d*))?(?:[eE][+-]?(\d*))?")


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
    """Layout of the numbers: first line, columns that hold some, columns that hold them in most lines.

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

    ``part`` are its first byte, its end, and the line in which it begins; ``encoding`` is that of the whole file.
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
    single = all(number(body.strip(), ",") is not None for body in many[len(many) // 2 :])  # with a decimal comma
    return len(many) > 2 and len(many) >= len(lines) - lines.count("") - _CLEAN and not single


def lay_out(look: Look) -> NumberLayout:
    """Find the marks, the columns and the first line of the numbers, and what stands above them."""
    short = len(look.head) <= _SHORT and look.size <= HEAD
    looked_at = look.head if short else look.head[:_LINES] + look.middle + look.tail[:-1]
    body = [line for line in looked_at if line.strip() and not is_comment(line)]
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
    findings += _labels(body, marks, width, filled, findings)
    findings.sort(key=lambda notice: (notice.code, notice.message))
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
            findings.append(_dropped(k, "it holds no number", f", {name},"))
    return NumberLayout(marks, width, first, filled, full, headings, above, findings, beside)


def _dropped(k: int, why: str, name: str = "") -> HealthNotice:
    """Return the notice of a column that is no channel."""
    return HealthNotice("column-dropped", f"column {k + 1}{name} is left out: {why}", k + 1.0, severity="good")


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
            few = f"it has a value in {numbers} of {len(rows)} lines looked at"
            findings.append(_dropped(k, "it holds words" if word_count >= numbers else few))
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
    others = [k for k in range(width) if k not in filled and k + 1.0 not in reported]
    return [_dropped(k, "it holds settings") for k in others if any(_says(row[k], marks) for row in numbers)]


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
    body = look.middle + look.tail if look.size > HEAD else [line for line in look.head[first:] if line.strip()]
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
    full_line = not is_comment(line) and all(value is not None and value == value for value in values)
    return full_line or _nearly(line, layout.marks, layout.width, layout.full)


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


Rows = Sequence[Sequence[str]]
"""Cells of some lines."""
_SHOWN = 1000  # lines by which a column is judged to be time or a count
_FIRST = 20  # lines in which time without a name must rise evenly by its own digits, before all are looked at
_EDGE_LINES = 50  # lines at either end by which the digits of time are judged: they may grow fewer as it grows
# Lines after the head in which a rate is looked for too: some instruments write settings beside the first data
_AFTER_HEAD = 40
# Lines of samples by which two first numbers are known to be none: start and step of Tektronix and the like
_MARKED = 20
# Share by which a rate that is stated may differ from that of the file without a warning: clocks are good to 1e-4
SAME_RATE = 0.01
_MOST_CODED = 4  # columns of words in which names of channels, measurements and units are looked for
# Letters of the last line of a head that comes again with each measurement, and lines of such a head at most
_SHORTEST_HEAD, _MOST_HEAD_LINES = 3, 200
_SPARE = 1.05  # times the lines that a file is thought to have: lines grow longer with time


def sniff_text(head: bytes) -> bool:
    """Tell whether a file that begins so is text."""
    return encoding_of(head) is not None


def read_text(path: Path, options: Options = Options()) -> Record:  # noqa: B008  (a tuple, frozen)
    r"""Read columns of numbers from text.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "blow.csv"
    ...     _ = file.write_text("Zeit [ms];Platine [g]\n0,00;1,5\n0,01;5,25\n0,02;2,0\n")
    ...     record = read_text(file)
    >>> [(c.name, c.unit, c.values.tolist(), c.stamps.tolist()) for c in record.channels]
    [('Platine', 'g', [1.5, 5.25, 2.0], [0.0, 1e-05, 2e-05])]
    """
    look = look_at(path)
    layout = lay_out(look)
    parts = _parts(look, layout)
    if len(parts) == 1:
        return _read(look, layout, options)
    looks = [look_at(path, part, look.encoding) for part in parts]
    return joined_pieces([_read(one, lay_out(one), options) for one in looks])


def _parts(look: Look, layout: NumberLayout) -> list[tuple[int, int, int]]:
    """Return the measurements of a file whose head comes again: first byte, end, and first line of each."""
    size = look.path.stat().st_size
    above = [line for line in layout.above if line.strip()]
    key = above[-1].rstrip() if above and not look.quoted and not look.lone_returns else ""
    if len(key) < _SHORTEST_HEAD or not re.search(r"[^\W\d_]", key):
        return [(0, size, 1)]
    encoding = look.encoding
    raw, line_end = key.encode(encoding, "replace"), "\n".encode(encoding)
    parts: list[tuple[int, int, int]] = []
    begin, line = 0, 1
    with look.path.open("rb") as opened, mmap.mmap(opened.fileno(), 0, access=mmap.ACCESS_READ) as content:
        at = content.find(raw)
        while (at := content.find(line_end + raw, at + 1)) >= 0 and len(parts) <= MOST_MEASUREMENTS:
            place = at + len(line_end)
            after = content.find(line_end, place)
            if content[place : after if after >= 0 else size].decode(encoding, "replace").rstrip() != key:
                continue
            end = _end_of_data(content, place, begin, line_end, look.encoding, layout)
            parts.append((begin, end, line))
            line += content[begin:end].count(line_end)
            begin = end
    return [*parts, (begin, size, line)]


def _end_of_data(
    content: mmap.mmap, place: int, begin: int, line_end: bytes, encoding: str, layout: NumberLayout
) -> int:
    """Return the byte at which the last line of data above a head ends."""
    for _ in range(_MOST_HEAD_LINES):
        before = content.rfind(line_end, begin, place - len(line_end))
        if before < 0:
            break
        start = before + len(line_end)
        if is_data(content[start:place].decode(encoding, "replace"), layout):
            break
        place = start
    return place


def _read(look: Look, layout: NumberLayout, options: Options) -> Record:
    """Read columns of numbers from a file, or a part of it."""
    path = look.path
    rows = _rows(look.head[layout.first : layout.first + _SHOWN], layout)
    time = _time_column(rows, layout, options)
    table = _read_long(look, layout, rows, time, options)
    if table is not None:
        return table
    shown, findings = _channels(path, rows, layout, time)
    own = settings_of(layout.above, layout.marks, layout.width, list(shown))
    unique = one_each([own.names.get(k, name) for k, (name, _) in shown.items()])
    units = [unit or own.units.get(k, "") for k, (_, unit) in shown.items()]
    shown = dict(zip(shown, zip(unique, units, strict=True), strict=True))
    wanted = _wanted(str(path), shown, options.channels)
    clock = None if options.rate is not None else time
    if options.time_unit is not None and time is None:
        hint = "no column of it is: name it by --time"
        raise InputError("--time-unit", f"{options.time_unit:g} s", "a file with time", hint)
    columns, odd, _ = _numbers(look, layout, wanted if clock is None else {*wanted, clock})
    unit = 1.0 if clock is None else options.time_unit or seconds_in(layout.headings.units[clock]) or 1.0
    stamps, lost = _with_time(columns, clock, unit)
    step, start, skip, notes = _grid(look, layout, clock, unit, stamps, [] if time is not None else list(shown))
    size = next(iter(columns.values())).size - skip
    if size < 2:
        raise refuse(path, "at least two lines of numbers")
    if options.rate is not None:
        step, start = 1.0 / options.rate, 0.0
        notes += _overruled(look, rows, layout, time, options.rate)
    unread = np.broadcast_to(np.float64(np.nan), (size,))
    has_grid = stamps is not None or options.rate is not None
    channels = []
    for k, (name, unit_of) in shown.items():
        values = columns[k][skip:] if k in wanted else unread
        grid = (step, start) if has_grid else (own.steps.get(k, step), own.starts.get(k, start))
        channels.append(Channel(name, values, *grid, unit_of, stamps))
    if stamps is None:
        channels, later = begin_together(channels, [own.origins.get(k) for k in shown])
        notes += later
    record = Record(str(path), "text", tuple(channels), (*findings, *odd, *lost, *notes))
    return _as_counted(record, counted_samples(layout.above), size, stamps is not None or options.rate is not None)


def _as_counted(record: Record, count: int, size: int, goes_on: bool) -> Record:
    """Compare the samples of a record with those that its head counts, and part it where they are whole measurements.

    Lines with a time, or of a rate that the user states, go on as they say.
    """
    if not count or size == count:
        return record
    if size > count and not goes_on and size % count == 0 and count >= FEWEST_SAMPLES:
        return parted(record, range(count, size, count))
    message = f"its head counts {count} samples, the file has {size}"
    severity = "suspect" if size > count and not goes_on else "good"
    return replace(record, findings=(*record.findings, HealthNotice("count-differs", message, float(size), severity)))


def _wanted(path: str, shown: dict[int, tuple[str, str]], names: Sequence[str]) -> set[int]:
    """Return the columns of the channels asked for; the others keep their place and cost no memory."""
    columns = {name: k for k, (name, _) in shown.items()}
    blank = Record(path, "text", tuple(Channel(name, np.empty(0)) for name in columns))
    return {columns[channel.name] for channel in blank.only(names).channels}


def _read_long(look: Look, layout: NumberLayout, rows: Rows, time: int | None, options: Options) -> Record | None:
    """Read a table in which a column names the channel, or the measurement, of each line; None where there is none."""
    names, units, _ = layout.headings
    rest = look.middle + look.tail if look.size > HEAD else look.head[layout.first :][_SHOWN:][-_SHOWN:]
    sample = [*rows, *_rows(rest, layout)]
    numbers = set(layout.filled)
    may = [
        k
        for k in range(layout.width)
        if k != time
        and (k not in numbers or may_count(names[k], sample[0][k] if len(sample[0]) > k else ""))
        and may_be_labels(names[k], [row[k] for row in sample if len(row) > k], k in numbers)
    ]
    counting = [k for k in may if k in layout.filled]
    coded = tuple(k for k in may if k not in layout.filled)[:_MOST_CODED]
    if not counting and not coded:
        return None
    columns, odd, words_of = _numbers(look, layout, {*layout.filled, *coded}, coded)
    named = [(k, Labels(names[k], columns[k], words_of.get(k, []))) for k in coded]
    counted = [(k, labels_of(names[k], columns[k])) for k in counting]
    clock = time if time is not None or layout.headings.named else _rising(columns, layout, [*named, *counted])
    unit = 1.0 if clock is None else options.time_unit or seconds_in(units[clock]) or 1.0
    stamps, lost = _with_time(columns, clock, unit)
    step, start = said_step([re.sub(r"^[#%/\s]+", "", line) for line in look.head[: layout.first]])
    for chosen in (counted, *([label] for label in counted), []):
        labels = {
            k: label._replace(codes=columns[k]) if not label.are_numbers else labels_of(names[k], columns[k])
            for k, label in [*named, *chosen]
        }
        values = [k for k in layout.filled if k != clock and k not in labels]
        unique = one_each([names[k] or f"value {n}" for n, k in enumerate(values, start=1)])
        pairs = zip(unique, values, strict=True)
        channels = [Channel(name, columns[k], step, start, units[k], stamps) for name, k in pairs]
        # a column of labels is none that is left out
        findings = [f for f in layout.findings if f.code != "column-dropped" or f.value - 1.0 not in labels]
        record = Record(str(look.path), "text", tuple(channels), (*findings, *odd, *lost))
        table = as_long_table(record, list(labels.values()))
        if table is not None:
            return as_asked(table, options)
    several = next((label for _, label in named if label.is_channel and len(label.present()) > 1), None)
    if several is not None:
        allowed = f"2 to {MOST_LABELS} channels of at least {FEWEST_SAMPLES} lines in the column {several.heading}"
        raise refuse(look.path, allowed, f"it has {len(several.present())} names")
    return None


def _rising(columns: dict[int, Array], layout: NumberLayout, labels: Sequence[tuple[int, Labels]]) -> int | None:
    """Return the first column without a name that rises evenly in the lines of each label, where one is."""
    taken = {k for k, _ in labels}
    for _, label in labels:
        lines = [label.codes == code for code in label.present()]
        for k in layout.filled:
            if k not in taken and lines and all(rises_evenly(columns[k][own], 0.0) for own in lines):
                return k
    return None


def _numbers(
    look: Look, layout: NumberLayout, columns: set[int], coded: tuple[int, ...] = ()
) -> tuple[dict[int, Array], list[HealthNotice], dict[int, list[str]]]:
    """Read columns of numbers; report cells that are none, and a last line that was cut.

    Those that are ``coded`` hold words, and become their places among the words that are returned.
    """
    wanted, cut = tuple(sorted(columns)), is_cut(look, layout)
    lone = look.lone_returns
    region = Region(look.path, look.encoding, look.begin, look.end, layout.first, cut, lone, look.line, look.quoted)
    cells = CellLayout(layout.marks, layout.width, wanted, layout.headings.header, layout.beside, coded)
    table = parse(region, cells, _expected(look))
    findings = odd_cells(table)
    if cut:
        findings.append(HealthNotice("truncated", "the last line is cut: it is left out"))
    return dict(zip(wanted, table.columns, strict=True)), findings, table.labels


def _time_column(rows: Rows, layout: NumberLayout, options: Options) -> int | None:
    if options.time is not None:
        return _named_time(layout, options.time, options.time_unit is not None or options.rate is not None)
    names, units, _ = layout.headings
    if layout.headings.named or any(units):
        by_name = [k for k in layout.filled if is_time(names[k], units[k])]
        sure = [k for k in by_name if units[k] or len(names[k]) > 2 or (options.rate and names[k].casefold() == "t")]
        return next((k for k in sure + by_name if k in sure or _rises(rows, layout, k)), None)
    if len(layout.filled) < 2:
        return None
    return next((k for k in layout.filled if _even(rows, layout, k)), None)


def _named_time(layout: NumberLayout, wanted: str, unit_stated: bool) -> int:
    names = layout.headings.names
    folded = [name.casefold() for name in names]
    headers = [cell.casefold() for cell in layout.headings.header]
    text = wanted.strip().casefold()
    for known in (folded, headers):
        if text and text in known:
            k = known.index(text)
            break
    else:
        if not (text.isdecimal() and len(text) < 9 and 1 <= int(text) <= layout.width):
            hint = nearest(wanted, filter(None, names)) if layout.headings.named else ""
            raise InputError("--time", wanted, f"the name of a column, or its number from 1 to {layout.width}", hint)
        k = int(text) - 1
    if k not in layout.filled:
        raise InputError("--time", wanted, "a column of numbers", "this one holds words, or is almost empty")
    unit = layout.headings.units[k]
    if unit and seconds_in(unit) is None and not unit_stated:
        hint = f"its unit is {unit}: state another by --time-unit, or give --rate instead"
        raise InputError("--time", wanted, "a column in s, ms, us or ns", hint)
    return k


def _overruled(look: Look, rows: Rows, layout: NumberLayout, time: int | None, rate: float) -> list[HealthNotice]:
    """Say that a rate that is stated is not that of the time column, or of the lines above the data."""
    if time is None:
        step = said_step([re.sub(r"^[#%/\s]+", "", line) for line in look.head[: layout.first]])[0]
    else:
        cells, values = _values(rows, layout, time)
        step = step_of(values, last_digit(cells)) * (seconds_in(layout.headings.units[time]) or 1.0)
    if not step > 0.0 or abs(step * rate - 1.0) <= SAME_RATE:
        return []
    message = f"a rate of {rate:.6g} Hz is stated, and the file says {1.0 / step:.6g} Hz: the stated one is taken"
    return [HealthNotice("rate-overrules", message, rate, severity="good")]


def _rows(lines: Iterable[str], layout: NumberLayout) -> Rows:
    """Cut lines of data into cells, once for all columns that are looked at."""
    return [cells_of(line, layout.marks) for line in lines if line.strip() and not is_comment(line)]


def _cells(rows: Rows, column: int) -> list[str]:
    return [row[column] for row in rows if len(row) > column]


def _values(rows: Rows, layout: NumberLayout, column: int) -> tuple[list[str], Array]:
    cells = _cells(rows, column)
    values = [number(cell, layout.marks.decimal) for cell in cells]
    return cells, np.array([np.nan if value is None else value for value in values])


def _even(rows: Rows, layout: NumberLayout, column: int) -> bool:
    cells, values = _values(rows, layout, column)
    return rises_evenly(values[:_FIRST], last_digit(cells[:_FIRST])) and rises_evenly(values, _coarsest(cells))


def _rises(rows: Rows, layout: NumberLayout, column: int) -> bool:
    _, values = _values(rows, layout, column)
    return bool(values.size > 1 and values[-1] > values[0] and np.all(np.diff(values) >= 0.0))


def _coarsest(cells: Sequence[str]) -> float:
    """Return the last digit of times whose digits may grow fewer as they grow."""
    return max(last_digit(cells[:_EDGE_LINES]), last_digit(cells[-_EDGE_LINES:]))


def _channels(
    path: Path, rows: Rows, layout: NumberLayout, time: int | None
) -> tuple[dict[int, tuple[str, str]], list[HealthNotice]]:
    """Name the channels by column; leave out time, and a column that counts samples."""
    names, units, _ = layout.headings
    findings = list(layout.findings)
    shown: dict[int, tuple[str, str]] = {}
    for k in layout.filled:
        if k == time:
            continue
        unnamed = layout.headings.named and not names[k] and not units[k]
        if (unnamed or is_counter(names[k], units[k])) and np.all(np.diff(_values(rows, layout, k)[1]) == 1.0):
            findings.append(_dropped(k, "it counts the samples"))
            continue
        shown[k] = (names[k] or f"channel {len(shown) + 1}", units[k])
    if not shown:
        raise refuse(path, "a channel besides time")
    unique = one_each([name for name, _ in shown.values()])
    return {k: (name, shown[k][1]) for k, name in zip(shown, unique, strict=True)}, findings


def _expected(look: Look) -> int:
    """Return about how many lines the file has."""
    lines = (look.head[-200:] + look.middle + look.tail) or [""]
    letters = 2 if look.encoding.startswith("utf-16") else 1
    return int(_SPARE * look.size / (letters * (1 + sum(map(len, lines)) / len(lines)))) + 100


def odd_cells(table: ParsedColumns) -> list[HealthNotice]:
    """Say how many cells are no numbers."""
    if not table.words:
        return []
    many = "1 cell is no number" if table.words == 1 else f"{table.words} cells are no numbers"
    message = f"{many}, the first in line {table.first_word}: taken as missing"
    return [HealthNotice("not-a-number", message, float(table.words))]


def _with_time(columns: dict[int, Array], clock: int | None, unit: float) -> tuple[Array | None, list[HealthNotice]]:
    """Return the stamps, s; leave out lines without time."""
    if clock is None:
        return None, []
    here = np.isfinite(columns[clock])
    lost = int(here.size - here.sum())
    if lost:
        for k, values in columns.items():
            columns[k] = values[here]
    message = f"{lost} lines have no time: they are left out"
    findings = [HealthNotice("time-missing", message, float(lost))] if lost else []
    return to_seconds(columns[clock], "", unit), findings


def _grid(
    look: Look, layout: NumberLayout, clock: int | None, unit: float, stamps: Array | None, loose: list[int]
) -> tuple[float, float, int, list[HealthNotice]]:
    """Return step, start, how many first lines are no samples, and findings."""
    if clock is not None and stamps is not None and stamps.size:
        edges = (look.head[layout.first :][:_EDGE_LINES], look.tail[-_EDGE_LINES - 1 : -1])
        digit = max(last_digit(_cells(_rows(lines, layout), clock)) for lines in edges) * unit
        findings = []
        if not layout.headings.named and digit == 1.0 and np.all(np.diff(stamps[:_SHOWN]) == 1.0):
            message = f"column {clock + 1} rises by 1 a line, taken as time in s: if it counts samples, give --rate"
            findings = [HealthNotice("counter", message)]
        return step_of(stamps, digit), float(stamps[0]), 0, findings
    step, start = said_step([re.sub(r"^[#%/\s]+", "", line) for line in look.head[: layout.first + _AFTER_HEAD]])
    below = below_start_and_increment(layout.above, layout.marks)
    step, start = (known if np.isfinite(known) else other for known, other in zip(below, (step, start), strict=True))
    rows = [cells_of(line, layout.marks) for line in look.head[layout.first : layout.first + _MARKED + 2]]
    if np.isnan(step) and _begins_with_a_clock(rows, loose, layout.marks.decimal):
        begun = [number(rows[k][loose[0]], layout.marks.decimal) or 0.0 for k in (0, 1)]
        message = "the first two lines are start and step of all columns: they are no samples"
        return begun[1], begun[0], 2, [HealthNotice("start-and-step", message, begun[1], severity="good")]
    return step, start, 0, []


def _begins_with_a_clock(rows: list[list[str]], shown: list[int], decimal: str) -> bool:
    """Tell whether all columns share two first numbers, a start and a step, written as no sample is: 1e-07."""
    if len(shown) < 2 or len(rows) < _MARKED + 2 or any(len(row) <= shown[-1] for row in rows):
        return False
    start, step = ({rows[k][j] for j in shown} for k in (0, 1))
    samples = [row[j] for row in rows[2:] for j in shown]
    if len(start) + len(step) > 2 or any("e" in cell.lower() for cell in samples):
        return False
    first, second = number(start.pop(), decimal), number(step.pop(), decimal)
    written = all("e" in rows[1][j].lower() for j in shown)
    if not written or first is None or second is None or not 0.0 < second < 1.0:
        return False
    return abs(first / second - round(first / second)) < 1e-6
