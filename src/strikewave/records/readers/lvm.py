"""LabVIEW measurement files (``.lvm``) with a header; those without one are plain text."""

from __future__ import annotations

import math
import mmap
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from strikewave.base.errors import InputError, nearest
from strikewave.records.health_notice import HealthNotice
from strikewave.records.readers import Options
from strikewave.records.readers.clock import last_digit, step_of
from strikewave.records.readers.columns import (
    MOST_COLUMNS,
    CellLayout,
    Marks,
    ParsedColumns,
    Region,
    cells_of,
    decode,
    encoding_of,
    lines_of,
    number,
    parse,
    refuse,
)
from strikewave.records.readers.common import one_each
from strikewave.records.readers.headings import name_and_unit
from strikewave.records.readers.text import odd_cells
from strikewave.records.record import Array, Channel, Record

_BEGIN = b"LabVIEW Measurement"
"""First words of a file with a header."""
_MARK = b"***End_of_Header***"
"""Ends the header of the file, and that of each segment."""
_LARGEST_HEADER = 2**20
"""Bytes of a header: LabVIEW writes some hundred, and a line for each channel."""
_MOST_SEGMENTS = 10_000
"""Segments of a file: as many blows of one test, and each is looked at."""
_BLOCK = 2**22
"""Bytes in which lines are counted at a time: keeps the memory small."""
_EDGE = 4096
"""Bytes at both ends of a segment by which its digits are judged: some tens of lines."""
_MOST_JUDGED = 64
"""Columns whose digits are judged one by one; of more only the first, which holds time."""
_SAME_STEP = 0.01
"""Share by which the steps of segments may differ where one goes on from the other."""
_ROUNDING, _PER_SAMPLE = 8.0, 1e-9
"""Units in the last place, and share of a step a sample, within which header and stamps agree: both are printed."""
_SEPARATORS = {"tab": "\t", "comma": ",", "semicolon": ";", "space": "", "": "\t"}
"""Marks between cells by the word of the header; empty for blanks."""


class Segment(NamedTuple):
    """One run of the instrument: its header by key, its column names, the bytes of its lines and their first line."""

    keys: dict[str, list[str]]
    columns: list[str]
    start: int
    end: int
    line: int


class Read(NamedTuple):
    """Values and time stamps of the channels of a segment, and what reading it showed."""

    values: list[Array]
    stamps: list[Array | None]
    steps: list[float]
    starts: list[float]
    findings: list[HealthNotice]


def sniff(head: bytes) -> bool:
    """Tell whether a file that begins so is a LabVIEW measurement file with a header."""
    return head.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(_BEGIN)


def read(path: Path, options: Options = Options()) -> Record:  # noqa: B008  (a tuple, frozen)
    r"""Read a LabVIEW measurement file.

    Segments are joined where their clock goes on; else only the first is read, and a finding reports it.

    Raises
    ------
    InputError
        If the header is not whole, or the lines below it are not columns of numbers.

    Examples
    --------
    >>> import tempfile
    >>> header = "LabVIEW Measurement\nSeparator\tTab\nX_Columns\tNo\n***End_of_Header***\n"
    >>> segment = "Channels\t1\nY_Unit_Label\tg\nX0\t0\nDelta_X\t5E-6\n***End_of_Header***\n"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "blow.lvm"
    ...     _ = file.write_text(header + segment + "X_Value\tboard\tComment\n\t1.5\n\t2.5\n")
    ...     record = read(file)
    >>> [(c.name, c.unit, c.step, c.values.tolist()) for c in record.channels]
    [('board', 'g', 5e-06, [1.5, 2.5])]
    """
    with path.open("rb") as opened, mmap.mmap(opened.fileno(), 0, access=mmap.ACCESS_READ) as content:
        encoding = encoding_of(content[:_LARGEST_HEADER])
        if encoding is None or encoding.startswith("utf-16"):
            raise refuse(path, "a LabVIEW measurement file in ASCII or UTF-8")
        keys, segments = _segments(path, content, encoding)
        ended = content[-1:] in (b"\n", b"\r")
    marks = _marks(path, keys)
    layout = _columns(segments[0], _said(keys, "X_Columns", "One").casefold(), path)
    labels = [name_and_unit(segments[0].columns[k]) for k, _ in layout]
    units = segments[0].keys.get("Y_Unit_Label", [])
    names = one_each([name or f"channel {k}" for k, (name, _) in enumerate(labels, start=1)])
    units = [(units[k] if k < len(units) else "") or labels[k][1] for k in range(len(names))]
    blank = [Channel(name, np.empty(0), unit=unit) for name, unit in zip(names, units, strict=True)]
    wanted = {c.name for c in Record(str(path), "lvm", tuple(blank)).only(options.channels).channels}
    is_wanted = [name in wanted for name in names]
    if options.time is not None and options.time.strip().casefold() not in ("x_value", "1"):
        raise InputError("--time", options.time, "X_Value", nearest(options.time, ["X_Value"]))
    if options.time_unit is not None:
        raise InputError("--time-unit", f"{options.time_unit:g} s", "none here", "LabVIEW measurement files are in s")
    runs, findings = _runs(path, encoding, marks, segments, layout, is_wanted, options, ended)
    channels = [_channel(runs, j, blank[j], is_wanted[j], options) for j in range(len(names))]
    size = max(channel.values.size for channel in channels)
    if size < 2:
        raise refuse(path, "at least two lines of numbers")
    unread = np.broadcast_to(np.float64(np.nan), (size,))
    whole = [c if want else replace(c, values=unread) for c, want in zip(channels, is_wanted, strict=True)]
    return Record(str(path), "lvm", tuple(whole), tuple(findings))


def _runs(
    path: Path,
    encoding: str,
    marks: Marks,
    segments: list[Segment],
    layout: Sequence[tuple[int, int | None]],
    is_wanted: list[bool],
    options: Options,
    ended: bool,
) -> tuple[list[Read], list[HealthNotice]]:
    """Read segments as long as their clock goes on."""
    runs: list[Read] = []
    findings: list[HealthNotice] = []
    for k, segment in enumerate(segments):
        alike = segment.columns == segments[0].columns
        run = (
            _run(path, encoding, marks, segment, layout, is_wanted, segment is segments[-1] and not ended)
            if alike
            else None
        )
        if run is None or (runs and not _goes_on(runs[-1], run, is_wanted, options)):
            what = "the clock starts anew in" if alike else "other channels begin in"
            message = f"it holds {len(segments)} segments; {what} number {k + 1}: read up to there"
            findings.append(HealthNotice("segments", message, float(len(segments))))
            break
        runs.append(run)
        findings += run.findings
    return runs, findings


def _segments(path: Path, content: mmap.mmap, encoding: str) -> tuple[dict[str, list[str]], list[Segment]]:
    """Find the headers of file and segments."""
    if not len(content) or content.find(b"\n" + _BEGIN) >= 0:
        raise refuse(path, "one record in a file", "several files are in this one: split them")
    marks: list[int] = []
    at = content.find(_MARK)
    while at >= 0 and len(marks) <= _MOST_SEGMENTS:
        marks.append(at)
        at = content.find(_MARK, at + 1)
    if len(marks) < 2:
        raise refuse(path, "a LabVIEW measurement file that is whole", f"it lacks {_MARK.decode()}")
    if len(marks) > _MOST_SEGMENTS:
        raise refuse(path, f"at most {_MOST_SEGMENTS} segments")
    begins = [max(content.rfind(b"\nChannels", last, mark) + 1, last) for last, mark in pairwise(marks)]
    if marks[0] > _LARGEST_HEADER or any(m - b > _LARGEST_HEADER for m, b in zip(marks[1:], begins, strict=True)):
        raise refuse(path, "a LabVIEW measurement file that is whole", "a header has no end")
    keys = _keys(content[: marks[0]], encoding)
    mark = _marks(path, keys)
    segments, line, counted = [], 1, 0
    for k, begin in enumerate(begins):
        head = _after(content, marks[k + 1])
        start = _after(content, head)
        names = cells_of(decode(content[head : min(start, head + _LARGEST_HEADER)], encoding), mark)
        line, counted = line + _lines(content, counted, start), start
        end = begins[k + 1] if k + 1 < len(begins) else len(content)
        if end < start:
            raise refuse(path, "a LabVIEW measurement file that is whole", "a segment lacks its names")
        segments.append(Segment(_keys(content[begin : marks[k + 1]], encoding), names, start, end, line))
    return keys, segments


def _after(content: mmap.mmap, at: int) -> int:
    end = content.find(b"\n", at)
    return len(content) if end < 0 else end + 1


def _lines(content: mmap.mmap, start: int, end: int) -> int:
    step = _BLOCK
    return sum(content[k : min(k + step, end)].count(b"\n") for k in range(start, end, step))


def _keys(header: bytes, encoding: str) -> dict[str, list[str]]:
    rows = [line.replace(",", "\t").replace(";", "\t").split("\t") for line in lines_of(decode(header, encoding))]
    loose = {row[0].strip(): [cell.strip() for cell in row[1:]] for row in rows if row[0].strip()}
    tabs = [line.split("\t") for line in lines_of(decode(header, encoding)) if "\t" in line]
    return loose | {row[0].strip(): [cell.strip() for cell in row[1:]] for row in tabs if row[0].strip()}


def _said(keys: dict[str, list[str]], key: str, otherwise: str) -> str:
    return (keys.get(key) or [""])[0] or otherwise


def _marks(path: Path, keys: dict[str, list[str]]) -> Marks:
    word = _said(keys, "Separator", "Tab")
    decimal = "," if keys.get("Decimal_Separator", ["."])[:1] in (["", ""], [","], [""]) else "."
    delimiter = _SEPARATORS.get(word.casefold(), word if word in (",", ";") else None)
    if delimiter is None or delimiter == decimal == ",":
        raise refuse(path, "Separator Tab, Comma, Semicolon or Space", f"its header says {word[:20]}")
    return Marks(delimiter, decimal)


def _columns(segment: Segment, kind: str, path: Path) -> list[tuple[int, int | None]]:
    """Return the column of each channel, and that of its time."""
    if kind not in ("one", "multi", "no"):
        raise refuse(path, "X_Columns One, Multi or No", f"its header says {kind[:20]}")
    names = [name.casefold() for name in segment.columns]
    if not names or len(names) > MOST_COLUMNS:
        raise refuse(path, f"1 to {MOST_COLUMNS} columns")
    columns: list[tuple[int, int | None]] = []
    time: int | None = None
    for k, name in enumerate(names):
        if name == "x_value":
            time = k
        elif name not in ("comment", ""):
            columns.append((k, None if kind == "no" else time))
    claimed = number(_said(segment.keys, "Channels", ""))
    if claimed is not None and 0 < claimed < len(columns):
        columns = columns[: int(claimed)]
    if not columns:
        raise refuse(path, "a LabVIEW measurement file that is whole", "it names no channels")
    return columns


def _run(
    path: Path,
    encoding: str,
    marks: Marks,
    segment: Segment,
    layout: Sequence[tuple[int, int | None]],
    is_wanted: Sequence[bool],
    unended: bool,
) -> Read:
    """Read one segment."""
    read_columns = sorted(
        {k for pair, want in zip(layout, is_wanted, strict=True) if want for k in pair if k is not None}
    )
    region = Region(path, encoding, segment.start, segment.end, line=segment.line)
    cut, digits = _look(region, marks, max(read_columns), unended)
    width = len(segment.columns)
    table = parse(
        region._replace(cut=cut),
        CellLayout(marks, width, tuple(read_columns)),
        100 + (segment.end - segment.start) // (4 * width),
    )
    values_of = dict(zip(read_columns, table.columns, strict=True))
    values, stamps, steps, starts = [], [], [], []
    for j, ((k, time), want) in enumerate(zip(layout, is_wanted, strict=True)):
        own = _trimmed(values_of[k], _nth(segment.keys, "Samples", j)) if want else np.empty(0)
        clock = values_of[time][: own.size] if want and time is not None else None
        stated = _nth(segment.keys, "Delta_X", j)
        step = stated if stated > 0.0 else math.nan
        start = _nth(segment.keys, "X0", j)
        if clock is not None and clock.size:
            digit = digits.get(time or 0, 0.0)
            step, start = _agreed(step, step_of(clock, digit), clock, digit), float(clock[0])
        values.append(own)
        stamps.append(clock)
        steps.append(step)
        starts.append(start if math.isfinite(start) else 0.0)
    findings = odd_cells(ParsedColumns([], table.words, table.first_word))
    findings += [HealthNotice("truncated", "the last line is cut: it is left out")] if cut else []
    return Read(values, stamps, steps, starts, findings)


def _look(region: Region, marks: Marks, last: int, unended: bool) -> tuple[bool, dict[int, float]]:
    """Tell whether the last line lacks columns; return the last digits of the numbers of each column."""
    end = region.end or 0
    with region.path.open("rb") as opened:
        opened.seek(region.start)
        head = opened.read(min(_EDGE, end - region.start))
        opened.seek(max(region.start, end - _EDGE))
        tail = opened.read(end - opened.tell())
    first = [cells_of(line, marks) for line in lines_of(decode(head, region.encoding))[:-1]]
    rows = [cells_of(line, marks) for line in lines_of(decode(tail, region.encoding)) if line.strip()]
    cut = unended and len(rows) > 1 and (len(rows[-1]) <= last or number(rows[-1][last], marks.decimal) is None)
    digits = {
        k: max(last_digit(row[k] for row in part if len(row) > k) for part in (first, rows[1:-1]))
        for k in range(last + 1 if last < _MOST_JUDGED else 1)
    }
    return cut, digits


def _nth(keys: dict[str, list[str]], key: str, k: int) -> float:
    cells = [cell.replace(",", ".") for cell in keys.get(key, []) if cell]
    value = number(cells[min(k, len(cells) - 1)]) if cells else None
    return math.nan if value is None else value


def _trimmed(values: Array, samples: float) -> Array:
    """Cut a channel to the samples its header claims, where what is behind them is empty."""
    if 0.0 < samples < values.size and np.isnan(values[int(samples) :]).all():
        return values[: int(samples)]
    return values


def _agreed(stated: float, measured: float, stamps: Array, digit: float) -> float:
    """Return the step of the header where the stamps agree with it within their rounding, else that of the stamps."""
    room = max(
        2.0 * digit + _ROUNDING * np.finfo(float).eps * float(np.abs(stamps[[0, -1]]).max()),
        _PER_SAMPLE * stated * stamps.size,
    )
    off = abs(stated * (stamps.size - 1) - float(stamps[-1] - stamps[0]))
    return stated if off <= room else measured


def _goes_on(before: Read, after: Read, is_wanted: Sequence[bool], options: Options) -> bool:
    """Tell whether the clock of a segment goes on where the one before it ends."""
    if options.rate is not None:
        return True
    for j, want in enumerate(is_wanted):
        if not want or not after.values[j].size or not before.values[j].size:
            continue
        step = before.steps[j]
        due = before.starts[j] + before.values[j].size * step
        if not abs(after.starts[j] - due) <= 0.5 * step or not abs(after.steps[j] - step) <= _SAME_STEP * step:
            return False
    return True


def _channel(runs: Sequence[Read], j: int, blank: Channel, want: bool, options: Options) -> Channel:
    values = runs[0].values[j] if len(runs) == 1 else np.concatenate([run.values[j] for run in runs])
    parts = [part for run in runs if (part := run.stamps[j]) is not None]
    if options.rate is not None:
        return Channel(blank.name, values, 1.0 / options.rate, 0.0, blank.unit)
    stamps = None if not want or len(parts) < len(runs) else parts[0] if len(parts) == 1 else np.concatenate(parts)
    return Channel(blank.name, values, runs[0].steps[j], runs[0].starts[j], blank.unit, stamps)
