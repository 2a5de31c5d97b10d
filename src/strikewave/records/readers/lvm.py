"""LabVIEW measurement files (``.lvm``) with a header; those without one are plain text."""

from __future__ import annotations

import math
import mmap
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from datetime import date
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from strikewave.base.errors import InputError, nearest
from strikewave.records.health_notice import HealthNotice
from strikewave.records.readers import FEWEST_SAMPLES, Options, joined_pieces, parted
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
from strikewave.records.readers.common import begin_together, one_each
from strikewave.records.readers.headings import PICO, last_digit, name_and_unit, seconds_in, step_of
from strikewave.records.readers.text import odd_cells
from strikewave.records.record import Array, Channel, Record

_BEGIN = b"LabVIEW Measurement"  # first words of a file with a header
# Around a block that other programs own, below the header of a segment
_SPECIAL, _SPECIAL_END = b"***Start_Special***", b"***End_Special***"
_MARK = b"***End_of_Header***"  # ends the header of the file, and that of each segment
_LARGEST_HEADER = 2**20  # bytes of a header: LabVIEW writes some hundred, and a line for each channel
_MOST_SEGMENTS = 10_000  # segments of a file: as many blows of one test, and each is looked at
_BLOCK = 2**22  # bytes in which lines are counted at a time: keeps the memory small
_EDGE = 4096  # bytes at both ends of a segment by which its digits are judged: some tens of lines
_MOST_JUDGED = 64  # columns whose digits are judged one by one; of more only the first, which holds time
_SAME_STEP = 0.01  # share by which the steps of segments may differ where one goes on from the other
# Units in the last place, and share of a step a sample, within which header and stamps agree: both are printed
_ROUNDING, _PER_SAMPLE = 8.0, 1e-9
# Date and time of a segment's first samples, as LabVIEW writes them in any language
_DATE = re.compile(r"(\d{4})/(\d{1,2})/(\d{1,2})")
_TIME = re.compile(r"(\d{1,2}):(\d{1,2}):(\d{1,2})(?:[.,](\d{1,40}))?")
# An earlier year is that of no clock: LabVIEW counts from 1904, and a waveform without a time begins there
_FIRST_YEAR = 1970
# Lines before that of the channels that may belong to a segment's head: notes and the name of the test
_HEAD_LINES = 50
# Marks between cells by the word of the header; empty for blanks
_SEPARATORS = {"tab": "\t", "comma": ",", "semicolon": ";", "space": "", "": "\t"}


class Segment(NamedTuple):
    """One run of the instrument: its header by key, its column names, the bytes of its lines and their first line.

    ``kind`` is one, multi or no: whose channels have a column of time; ``part`` counts the headers of the file before
    it, each of a session that appended to the file.
    """

    keys: dict[str, list[str]]
    columns: list[str]
    start: int
    end: int
    line: int
    marks: Marks
    kind: str
    part: int


class Layout(NamedTuple):
    """Channels of a segment: the column of each and that of its time, its name and unit, and whether it is wanted."""

    columns: list[tuple[int, int | None]]
    blank: list[Channel]
    wanted: list[bool]


class Read(NamedTuple):
    """Values and time stamps of the channels of a segment, and what reading it showed.

    ``origins`` are the clock times of the channels by the header, ps; None where it has none. ``every`` is the number
    of samples after which another measurement begins, 0 for none.
    """

    values: list[Array]
    stamps: list[Array | None]
    steps: list[float]
    starts: list[float]
    origins: list[int | None]
    findings: list[HealthNotice]
    every: int = 0


def sniff_lvm(head: bytes) -> bool:
    """Tell whether a file that begins so is a LabVIEW measurement file with a header."""
    return head.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(_BEGIN)


def read_lvm(path: Path, options: Options = Options()) -> Record:  # noqa: B008  (a tuple, frozen)
    r"""Read a LabVIEW measurement file.

    Segments are joined where their clock goes on; each of the others begins a measurement of its own.

    Examples
    --------
    >>> import tempfile
    >>> header = "LabVIEW Measurement\nSeparator\tTab\nX_Columns\tNo\n***End_of_Header***\n"
    >>> segment = "Channels\t1\nY_Unit_Label\tg\nX0\t0\nDelta_X\t5E-6\n***End_of_Header***\n"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "blow.lvm"
    ...     _ = file.write_text(header + segment + "X_Value\tboard\tComment\n\t1.5\n\t2.5\n")
    ...     record = read_lvm(file)
    >>> [(c.name, c.unit, c.step, c.values.tolist()) for c in record.channels]
    [('board', 'g', 5e-06, [1.5, 2.5])]
    """
    if options.time is not None and options.time.strip().casefold() not in ("x_value", "1"):
        raise InputError("--time", options.time, "X_Value", nearest(options.time, ["X_Value"]))
    if options.time_unit is not None:
        raise InputError("--time-unit", f"{options.time_unit:g} s", "none here", "LabVIEW measurement files are in s")
    with path.open("rb") as opened, mmap.mmap(opened.fileno(), 0, access=mmap.ACCESS_READ) as content:
        encoding = encoding_of(content[:_LARGEST_HEADER])
        if encoding is None or encoding.startswith("utf-16"):
            raise refuse(path, "a LabVIEW measurement file in ASCII or UTF-8")
        segments = _segments(path, content, encoding)
        ended = content[-1:] in (b"\n", b"\r")
    pieces: list[Record] = []
    runs: list[Read] = []
    before, layout = segments[0], _layout(path, segments[0], options)
    for segment in segments:
        own = _layout(path, segment, options)
        is_alike = (segment.columns, segment.kind, segment.part) == (before.columns, before.kind, before.part)
        is_alike = is_alike and [one.unit for one in own.blank] == [one.unit for one in layout.blank]
        run = _run(path, encoding, segment, own, options, segment is segments[-1] and not ended)
        shift = _shift(runs[-1], run, layout.wanted, options) if runs and is_alike else None
        if runs and shift is None:
            pieces.append(_record(path, layout, runs, options))
            runs = []
        before, layout = segment, own
        runs.append(_shifted(run, shift) if shift else run)
    pieces.append(_record(path, layout, runs, options))
    whole = [piece for piece in pieces if max(channel.values.size for channel in piece.channels) > 1]
    if not whole:
        raise refuse(path, "at least two lines of numbers")
    if len(whole) < len(pieces):
        lost = len(pieces) - len(whole)
        message = f"{lost} of {len(pieces)} measurements have fewer than two lines: they are left out"
        short = HealthNotice("segments", message, float(lost))
        whole[0] = replace(whole[0], findings=(short, *whole[0].findings))
    return joined_pieces([one for piece in whole for one in (replace(piece, further=()), *piece.further)])


def _record(path: Path, layout: Layout, runs: Sequence[Read], options: Options) -> Record:
    """Return the record of segments whose clock goes on; in pieces where a header without time stands for several."""
    channels = [_channel(runs, j, blank, layout.wanted[j], options) for j, blank in enumerate(layout.blank)]
    size = max(channel.values.size for channel in channels)
    findings = [finding for run in runs for finding in run.findings]
    channels, later = begin_together(channels, runs[0].origins)
    for j in (j for j, want in enumerate(layout.wanted) if not want):
        channels[j] = replace(channels[j], values=np.broadcast_to(np.float64(np.nan), (size,)))
    record = Record(str(path), "lvm", tuple(channels), (*findings, *later))
    every = runs[0].every
    return parted(record, range(every, size, every)) if every else record


def _layout(path: Path, segment: Segment, options: Options) -> Layout:
    """Return the channels of a segment, and which of them are wanted."""
    columns = _columns(segment, path)
    labels = [name_and_unit(segment.columns[k]) for k, _ in columns]
    units = _cells(path, segment, "Y_Unit_Label", columns)
    names = one_each([name or f"channel {k}" for k, (name, _) in enumerate(labels, start=1)])
    units = [unit or label for unit, (_, label) in zip(units, labels, strict=True)]
    blank = [Channel(name, np.empty(0), unit=unit) for name, unit in zip(names, units, strict=True)]
    wanted = {c.name for c in Record(str(path), "lvm", tuple(blank)).only(options.channels).channels}
    return Layout(columns, blank, [name in wanted for name in names])


def _cells(path: Path, segment: Segment, key: str, columns: Sequence[tuple[int, int | None]]) -> list[str]:
    """Return the cell of each channel in a line of the header, empty where it has none.

    Where each channel has a column of time, LabVIEW lays the cells out as the columns are, two to a channel, of which
    one is empty; other programs write one to a channel, or the same one twice.
    """
    cells, count = segment.keys.get(key, []), len(columns)
    if segment.kind == "multi" and any(cells[1:]):
        padded = [*cells, *[""] * (2 * count)]
        pairs = [(padded[k], padded[k + 1]) for k in range(0, 2 * count, 2)]
        if not any(second for _, second in pairs):
            return [first for first, _ in pairs]
        if any(cells[count:]):
            pairs = [("" if second and seconds_in(first) else first, second) for first, second in pairs]
            if any(first and second and first != second for first, second in pairs):
                hint = f"in the line {key} a channel has two different cells"
                raise refuse(path, "a header with one value to a channel", hint)
            return [first or second for first, second in pairs]
    return [cells[k] if k < len(cells) else "" for k in range(count)]


def _values(path: Path, segment: Segment, key: str, columns: Sequence[tuple[int, int | None]]) -> list[float]:
    """Return the number of each channel in a line of the header; one that stands alone is that of all of them."""
    cells = _cells(path, segment, key, columns)
    if len(list(filter(None, segment.keys.get(key, [])))) == 1:
        cells = [next(filter(None, segment.keys[key]))] * len(cells)
    numbers = [number(cell.replace(",", ".")) for cell in cells]
    return [math.nan if value is None else value for value in numbers]


def _origins(path: Path, segment: Segment, columns: Sequence[tuple[int, int | None]]) -> list[int | None]:
    """Return the clock time from which each channel counts, ps; None where the header has none."""
    days = _cells(path, segment, "Date", columns)
    return [_clock_time(day, time) for day, time in zip(days, _cells(path, segment, "Time", columns), strict=True)]


def _clock_time(day: str, time: str) -> int | None:
    """Return date and time as one number, ps."""
    on, at = _DATE.fullmatch(day), _TIME.fullmatch(time)
    if on is None or at is None or int(on[1]) < _FIRST_YEAR:
        return None
    try:
        days = date(int(on[1]), int(on[2]), int(on[3])).toordinal()
    except ValueError:
        return None
    seconds = ((24 * days + int(at[1])) * 60 + int(at[2])) * 60 + int(at[3])
    return seconds * PICO + int((at[4] or "0").ljust(12, "0")[:12])


def _segments(path: Path, content: mmap.mmap, encoding: str) -> list[Segment]:
    """Find the headers of file and segments; a session that appended to the file wrote the header of a file again."""
    starts, at = [0], content.find(b"\n" + _BEGIN)
    while at >= 0 and len(starts) <= _MOST_SEGMENTS:
        starts.append(at + 1)
        at = content.find(b"\n" + _BEGIN, at + 1)
    segments: list[Segment] = []
    line, counted = 1, 0
    for part, (begin, end) in enumerate(pairwise([*starts, len(content)])):
        for segment in _of_session(path, content, encoding, (begin, end), part):
            if len(segments) >= _MOST_SEGMENTS:
                raise refuse(path, f"at most {_MOST_SEGMENTS} segments")
            line, counted = line + _lines(content, counted, segment.start), segment.start
            segments.append(segment._replace(line=line))
    return segments


def _of_session(path: Path, content: mmap.mmap, encoding: str, place: tuple[int, int], part: int) -> Iterator[Segment]:
    """Yield the segments below one header of a file."""
    allowed = "a LabVIEW measurement file that is whole"
    marks: list[int] = []
    at = content.find(_MARK, *place)
    while at >= 0 and len(marks) <= _MOST_SEGMENTS + 1:  # one of the file, and one too many
        marks.append(at)
        at = content.find(_MARK, at + 1, place[1])
    if len(marks) < 2:
        raise refuse(path, allowed, f"it lacks {_MARK.decode()}")
    begins = [_head_of(content, last, mark) for last, mark in pairwise(marks)]
    headers = [(place[0], marks[0]), *zip(begins, marks[1:], strict=True)]
    if any(mark - begin > _LARGEST_HEADER for begin, mark in headers):
        raise refuse(path, allowed, "a header has no end")
    keys = _keys(content[place[0] : marks[0]], encoding)
    mark, kind = _marks(path, keys), _said(keys, "X_Columns", "One").casefold()
    for k, begin in enumerate(begins):
        head = _after_special(content, _after(content, marks[k + 1]))
        start = _after(content, head)
        names = cells_of(decode(content[head : min(start, head + _LARGEST_HEADER)], encoding), mark)
        end = begins[k + 1] if k + 1 < len(begins) else place[1]
        if end < start or names[0].startswith("***"):
            raise refuse(path, allowed, "a segment lacks its names")
        own = _keys(content[begin : marks[k + 1]], encoding, mark.delimiter)
        yield Segment(own, names, start, end, 0, mark, kind, part)


def _head_of(content: mmap.mmap, last: int, mark: int) -> int:
    """Return where the header of a segment begins: below the last blank line before its channels."""
    begin = max(content.rfind(b"\nChannels", last, mark) + 1, last)
    at = begin
    for _ in range(_HEAD_LINES):
        before = content.rfind(b"\n", last, max(at - 1, last)) + 1
        if before <= last or not content[before:at].strip(b" \t\r\n,;"):
            return at if before > last or at == begin else begin
        at = before
    return begin


def _after_special(content: mmap.mmap, head: int) -> int:
    """Return where the line of column names begins: below blank lines, and blocks that other programs own."""
    for _ in range(_HEAD_LINES):
        line = content[head : min(_after(content, head), head + _LARGEST_HEADER)]
        if line.startswith(_SPECIAL):
            end = content.find(_SPECIAL_END, head)
            head = _after(content, end) if end >= 0 else head
            if end < 0:
                return head
        elif line and not line.strip(b" \t\r\n,;"):
            head = _after(content, head)
        else:
            return head
    return head


def _after(content: mmap.mmap, at: int) -> int:
    end = content.find(b"\n", at)
    return len(content) if end < 0 else end + 1


def _lines(content: mmap.mmap, start: int, end: int) -> int:
    step = _BLOCK
    return sum(content[k : min(k + step, end)].count(b"\n") for k in range(start, end, step))


def _keys(header: bytes, encoding: str, delimiter: str | None = None) -> dict[str, list[str]]:
    """Return the cells of a header by its keys; before its delimiter is known, tabs go before other marks."""
    rows = [line.replace(",", "\t").replace(";", "\t").split("\t") for line in lines_of(decode(header, encoding))]
    loose = {row[0].strip(): [cell.strip() for cell in row[1:]] for row in rows if row[0].strip()}
    own = delimiter or "\t"
    cut = [line.split(own) for line in lines_of(decode(header, encoding)) if own in line]
    return loose | {row[0].strip(): [cell.strip() for cell in row[1:]] for row in cut if row[0].strip()}


def _said(keys: dict[str, list[str]], key: str, otherwise: str) -> str:
    return (keys.get(key) or [""])[0] or otherwise


def _marks(path: Path, keys: dict[str, list[str]]) -> Marks:
    word = _said(keys, "Separator", "Tab")
    decimal = "," if keys.get("Decimal_Separator", ["."])[:1] in (["", ""], [","], [""]) else "."
    delimiter = _SEPARATORS.get(word.casefold(), word if word in (",", ";") else None)
    if delimiter is None or delimiter == decimal == ",":
        raise refuse(path, "Separator Tab, Comma, Semicolon or Space", f"its header says {word[:20]}")
    return Marks(delimiter, decimal)


def _columns(segment: Segment, path: Path) -> list[tuple[int, int | None]]:
    """Return the column of each channel, and that of its time."""
    if segment.kind not in ("one", "multi", "no"):
        raise refuse(path, "X_Columns One, Multi or No", f"its header says {segment.kind[:20]}")
    names = [name.casefold() for name in segment.columns]
    if not names or len(names) > MOST_COLUMNS:
        raise refuse(path, f"1 to {MOST_COLUMNS} columns")
    columns: list[tuple[int, int | None]] = []
    time: int | None = None
    for k, name in enumerate(names):
        if name == "x_value":
            time = k
        elif name not in ("comment", ""):
            columns.append((k, None if segment.kind == "no" else time))
    claimed = number(_said(segment.keys, "Channels", ""))
    if claimed is not None and 0 < claimed < len(columns):
        columns = columns[: int(claimed)]
    if not columns:
        raise refuse(path, "a LabVIEW measurement file that is whole", "it names no channels")
    return columns


def _run(path: Path, encoding: str, segment: Segment, layout: Layout, options: Options, unended: bool) -> Read:
    """Read one segment."""
    read_columns = sorted(
        {k for pair, want in zip(layout.columns, layout.wanted, strict=True) if want for k in pair if k is not None}
    )
    region = Region(path, encoding, segment.start, segment.end, line=segment.line)
    cut, digits = _look(region, segment.marks, max(read_columns), unended)
    width = len(segment.columns)
    cells = CellLayout(segment.marks, width, tuple(read_columns))
    table = parse(region._replace(cut=cut), cells, 100 + (segment.end - segment.start) // (4 * width))
    values_of = dict(zip(read_columns, table.columns, strict=True))
    samples, stated, begins = (_values(path, segment, key, layout.columns) for key in ("Samples", "Delta_X", "X0"))
    values, stamps, steps, starts = [], [], [], []
    for j, ((k, time), want) in enumerate(zip(layout.columns, layout.wanted, strict=True)):
        own = _trimmed(values_of[k], samples[j]) if want else np.empty(0)
        own_grid = segment.kind == "one" and stated[j] > 0.0 and stated[j] != stated[0] and own.size <= samples[j]
        clock = values_of[time][: own.size] if want and time is not None and not own_grid else None
        step = stated[j] if stated[j] > 0.0 else math.nan
        start = begins[j]
        if clock is not None and clock.size:
            digit = digits.get(time or 0, 0.0)
            step, start = _agreed(step, step_of(clock, digit), clock, digit), float(clock[0])
        values.append(own)
        stamps.append(clock)
        steps.append(step)
        starts.append(start if math.isfinite(start) else 0.0)
    findings = odd_cells(ParsedColumns([], table.words, table.first_word))
    findings += [HealthNotice("truncated", "the last line is cut: it is left out")] if cut else []
    sizes = [(own.size, count) for own, count, want in zip(values, samples, layout.wanted, strict=True) if want]
    differing, every = _counted(path, segment, [(size + cut, count) for size, count in sizes], options)
    return Read(values, stamps, steps, starts, _origins(path, segment, layout.columns), findings + differing, every)


def _counted(
    path: Path, segment: Segment, sizes: Sequence[tuple[int, float]], options: Options
) -> tuple[list[HealthNotice], int]:
    """Compare the samples of channels with those that the header counts: what differs, and where other ones begin.

    LabVIEW appends later writes to one header without counting them. Where lines have no time, each write is a
    measurement of its own: the distance between them is not known.
    """
    off = next(((size, int(count)) for size, count in sizes if 0.0 < count < 1e15 and size != count), None)
    if off is None:
        return [], 0
    size, count = off
    if size < count:
        message = f"its header counts {count} samples, the file has {size}: it was cut, or not written to its end"
        return [HealthNotice("count-differs", message, float(size))], 0
    if segment.kind != "no" or options.rate is not None:
        message = f"its header counts {count} samples, the file has {size}, over one time"
        return [HealthNotice("count-differs", message, float(size), severity="good")], 0
    if size % count or count < FEWEST_SAMPLES or len({own for own, _ in sizes}) > 1:
        hint = "if they go on without a break, state the sampling rate by --rate; else split the file"
        raise refuse(path, f"{count} lines as its header counts, or whole measurements of as many: it has {size}", hint)
    return [], count


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


def _trimmed(values: Array, samples: float) -> Array:
    """Cut a channel to the samples its header claims, where what is behind them is empty."""
    if 0.0 < samples < values.size and np.isnan(values[int(samples) :]).all():
        return values[: int(samples)]
    return values


def _agreed(stated: float, measured: float, stamps: Array, digit: float) -> float:
    """Return the step of the header where the stamps agree with it within their rounding, else that of the stamps."""
    rounding = _ROUNDING * np.finfo(float).eps * float(np.abs(stamps[[0, -1]]).max())
    room = max(2.0 * digit + rounding, _PER_SAMPLE * stated * stamps.size)
    off = abs(stated * (stamps.size - 1) - float(stamps[-1] - stamps[0]))
    return stated if off <= room else measured


def _shift(before: Read, after: Read, is_wanted: Sequence[bool], options: Options) -> float | None:
    """Return by how much the times of a segment are to be moved, s, to go on where the one before it ends.

    None where they do not go on: a segment may count on, or begin at zero at the clock time at which the one before
    ends.
    """
    if before.every or after.every:
        return None
    if options.rate is not None:
        return 0.0
    moves = [0.0]
    if None not in before.origins and None not in after.origins:
        moves += [(b - a) / PICO for a, b in zip(before.origins[:1], after.origins[:1], strict=True) if a and b]
    fitting = [move for move in moves if _goes_on(before, after, is_wanted, move)]
    return fitting[0] if fitting else None


def _shifted(run: Read, shift: float) -> Read:
    """Return a segment whose times are moved, s."""
    stamps = [None if part is None else part + shift for part in run.stamps]
    return run._replace(stamps=stamps, starts=[start + shift for start in run.starts])


def _goes_on(before: Read, after: Read, is_wanted: Sequence[bool], shift: float) -> bool:
    """Tell whether the clock of a segment, moved by a shift, goes on where the one before it ends."""
    for j, want in enumerate(is_wanted):
        if not want or not after.values[j].size or not before.values[j].size:
            continue
        step = before.steps[j]
        due = before.starts[j] + before.values[j].size * step
        late = after.starts[j] + shift - due
        if not abs(late) <= 0.5 * step or not abs(after.steps[j] - step) <= _SAME_STEP * step:
            return False
    return True


def _channel(runs: Sequence[Read], j: int, blank: Channel, want: bool, options: Options) -> Channel:
    values = runs[0].values[j] if len(runs) == 1 else np.concatenate([run.values[j] for run in runs])
    parts = [part for run in runs if (part := run.stamps[j]) is not None]
    if options.rate is not None:
        return Channel(blank.name, values, 1.0 / options.rate, 0.0, blank.unit)
    stamps = None if not want or len(parts) < len(runs) else parts[0] if len(parts) == 1 else np.concatenate(parts)
    return Channel(blank.name, values, runs[0].steps[j], runs[0].starts[j], blank.unit, stamps)
