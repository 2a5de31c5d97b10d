"""Headings of columns of numbers: names and units, time and its step, settings of channels, counts of samples."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from datetime import date
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from strikewave.records.readers.columns import Marks, cells_of, is_comment, number
from strikewave.records.record import Array

# Seconds of a unit of time as instruments write it, in English and German
_SECONDS = {
    "s": 1.0, "sec": 1.0, "secs": 1.0, "second": 1.0, "seconds": 1.0, "sekunde": 1.0, "sekunden": 1.0,
    "ms": 1e-3, "msec": 1e-3, "millisecond": 1e-3, "milliseconds": 1e-3,
    "us": 1e-6, "usec": 1e-6, "mus": 1e-6, "microsecond": 1e-6, "microseconds": 1e-6,
    "ns": 1e-9, "nsec": 1e-9, "nanosecond": 1e-9, "nanoseconds": 1e-9,
    "ps": 1e-12, "min": 60.0, "minute": 60.0, "minutes": 60.0, "h": 3600.0, "hour": 3600.0, "hours": 3600.0,
    "millisekunden": 1e-3, "mikrosekunden": 1e-6, "nanosekunden": 1e-9,
}  # fmt: skip
UNITS_OF_TIME = ("s", "ms", "us", "ns", "ps", "min", "h")  # units that are offered for one that is none
# Factors before Hz; ``m`` is mega, as no instrument samples in millihertz
_HERTZ = {"": 1.0, "k": 1e3, "m": 1e6, "g": 1e9}
# A printed number: whole digits, decimals, power of ten
_DIGITS = re.compile(r"[+-]?(\d*)(?:[.,](\d*))?(?:[eE]([+-]?\d{1,4}))?")
# A number in a line; its parts are bounded, so that hostile lines take no time
_NUMBER = r"([+-]?(?:\d{1,25}(?:[.,]\d{0,25})?|[.,]\d{1,25})(?:[eE][+-]?\d{1,3})?)"
# Pattern between a name and its number: a unit in brackets, a mark, blanks, the letters of a drive or channel
_LINK = r"\"?\s{0,5}(?:[\[(]([^\])]{1,12})[\])])?\"?\s{0,5}[:=,;\t ]\s{0,5}\"?(?:[A-Za-z]\w{0,9}:)?\s{0,5}"
_NO_DATE = r"(?!\d|[-/:.]\d)"  # pattern behind a number that is not the first one of a date or a time of day
_AFTER = r"\"?[\s,;]{0,5}\"?([A-Za-zµμ/]{0,14})"  # a unit after the number
# Names of a sampling rate, in English and German
_RATE = r"sampl(?:e|ing)[ _-]?(?:rate|frequency|freq\.?)|fs|f_s|abtastrate|abtastfrequenz|samples per second"
# Names of a step in time
_INTERVAL = (
    r"sampl(?:e|ing)[ _-]?(?:interval|period|time)|abtast(?:intervall|zeit|periode)|dt|delta[ _-]?[tx]|tinc|"
    r"xincr|x[ _-]?increment|(?:horizontal|time)[ _-](?:interval|step|increment)|time ?step|increment"
)
_NAMES_OF_START = r"t0|x0|t_0|xzero|start"  # names of the time of the first sample
# Patterns of a rate, a step and a start in the lines above the data
_STATED = {
    kind: re.compile(rf"(?<![A-Za-z0-9_])(?:{names}){_LINK}{_NUMBER}{_NO_DATE}{_AFTER}", re.IGNORECASE)
    for kind, names in (("rate", _RATE), ("interval", _INTERVAL), ("start", _NAMES_OF_START))
}
_CHUNK = 2**20  # time stamps compared at once: keeps the memory beside them small
_LONGEST = 500  # characters of a line that are looked at: bounds the time of patterns on hostile lines
# Times the last printed digit that stamps may stray by: rounding by half a digit at both ends, and floating point
_WITHIN_DIGIT = 1.01
_WITHIN_STEP = 0.01  # share of a step by which stamps may stray whose digits are finer than it
_EVEN = 0.1  # share of a step by which stamps may stray and still have the mean step: jitter, not gaps
_ROUNDING = 8.0  # units in the last place by which computed stamps may stray
# Share of differences that must be the usual one, and how many times it the others must be, where there are gaps alone
_ALIKE, _FAR_LARGER = 0.95, 1.5
_COARSE = 4.0  # printed digits within a step below which the step is taken over a lag, where rounding counts less


def seconds_in(unit: str) -> float | None:
    """Return how many seconds a unit of time has; None for what is no unit of time."""
    return _SECONDS.get(unit.strip().lower().replace("µ", "u").replace("μ", "u"))


def to_seconds(values: Array, unit: str, stated: float | None = None) -> Array:
    """Bring times to seconds, in place; by a whole divisor, so that 20 us are 2e-05 s and not a digit less.

    Seconds of the unit that are stated overrule the unit; a divisor that is not whole, such as that of 3 ms, is none.
    """
    factor = stated or seconds_in(unit) or 1.0
    parts = round(1.0 / factor)
    if parts and 1.0 / parts == factor:
        values /= parts
    else:
        values *= factor
    return values


def last_digit(cells: Iterable[str]) -> float:
    """Return the worth of the last printed digit of the largest number; zero where nothing is a number.

    Digits are counted where most are printed, as trailing zeros may be left out elsewhere.

    Examples
    --------
    >>> last_digit(["0.1", "0.125"]), last_digit(["1.25e-6", "2.5e-5"])
    (0.001, 1e-07)
    """
    finest, most, largest = math.inf, 0, -math.inf
    for cell in cells:
        match = _DIGITS.fullmatch(cell.strip())
        if match is None or not (match[1] or match[2]):
            continue
        digits, decimals, power = match[1], match[2] or "", int(match[3] or 0)
        finest = min(finest, power - len(decimals))
        figures = (digits + decimals).lstrip("0")
        if figures:
            most = max(most, len(figures))
            largest = max(largest, len(figures) - 1 - len(decimals) + power)
    if math.isinf(finest):
        return 0.0
    return float(f"1e{int(max(finest, largest - most + 1))}")


def rises_evenly(values: Array, digit: float) -> bool:
    """Tell whether values rise by the same step within the rounding of their digits."""
    if values.size < 3 or not np.all(np.isfinite(values)) or np.any(np.diff(values) < 0.0):
        return False
    step = (values[-1] - values[0]) / (values.size - 1)
    room = _WITHIN_DIGIT * digit if np.unique(values).size < values.size or digit < step else _WITHIN_STEP * step
    return bool(step > 0.0 and _strays(values, step) <= room + 1e-9 * np.abs(values).max())


def step_of(stamps: Array, digit: float) -> float:
    """Return the step of time stamps: from end to end where they are even within rounding, else the median.

    ``digit`` is the worth of the last digit they are printed with, s.
    """
    if stamps.size < 2:
        return math.nan
    step = float(stamps[-1] - stamps[0]) / (stamps.size - 1)
    strays = _strays(stamps, step)
    noise = _ROUNDING * np.finfo(float).eps * max(abs(float(stamps[0])), abs(float(stamps[-1])))
    if step > 0.0 and strays <= _EVEN * step + noise:
        return step
    typical, gaps = _typical(stamps)
    if step > 0.0 and strays <= _WITHIN_DIGIT * digit + noise and not gaps:
        return step
    if typical <= _COARSE * digit and not gaps:
        lag = max(1, stamps.size // 8)
        typical = float(np.nanmedian(stamps[lag:] - stamps[:-lag])) / lag
    return typical if typical > 0.0 else math.nan


def _strays(stamps: Array, step: float) -> float:
    """Return the largest distance from a straight line through the first stamp, s; missing stamps have none."""
    worst = 0.0
    for k in range(0, stamps.size, _CHUNK):
        part = stamps[k : k + _CHUNK]
        line = stamps[0] + step * np.arange(k, k + part.size)
        worst = float(np.fmax.reduce(np.abs(part - line), initial=worst))
    return worst


def _typical(stamps: Array) -> tuple[float, bool]:
    """Return the median difference, and whether nearly all others are that or far larger, as gaps make them."""
    differences = np.diff(stamps[: 4 * _CHUNK])
    differences = differences[np.isfinite(differences)]
    if not differences.size:
        return math.nan, False
    middle = float(np.median(differences))
    same = np.abs(differences - middle) <= _EVEN * abs(middle)
    rest = differences[~same]
    return middle, bool(middle > 0.0 and same.mean() >= _ALIKE and np.all(np.abs(rest) >= _FAR_LARGER * middle))


def said_step(lines: Sequence[str]) -> tuple[float, float]:
    """Return the step and the start, s, that lines above the data name; NaN for a step they do not name."""
    interval = _stated(lines, "interval")
    rate = _stated(lines, "rate")
    step = interval if interval > 0.0 else 1.0 / rate if rate > 0.0 else math.nan
    start = _stated(lines, "start")
    return (step if math.isfinite(step) else math.nan), (start if math.isfinite(start) else 0.0)


def names_a_step(line: str) -> bool:
    """Tell whether a line names a rate, an interval or a start."""
    return any(pattern.search(line[:_LONGEST]) for pattern in _STATED.values())


def _stated(lines: Iterable[str], kind: str) -> float:
    for line in lines:
        for match in _STATED[kind].finditer(line[:_LONGEST]):
            factor = _hertz(match[1] or match[3]) if kind == "rate" else seconds_in(match[1] or match[3] or "s")
            if factor is not None:
                return _in_seconds(float(match[2].replace(",", ".")), factor)
    return math.nan


def _hertz(unit: str) -> float | None:
    match = re.fullmatch(r"([kmg]?)(?:hz|sa?(?:mples?)?/s(?:ec)?|sps|1/s)?", unit.lower())
    return None if match is None else _HERTZ[match[1]]


LONGEST_NAME = 200  # characters of a heading that are looked at: bounds the time of patterns on hostile lines
LONGEST_UNIT = 40  # characters of a unit; the longest that instruments write has 13
_BRACKETS = re.compile(r"^(.*?)\s*[\[({]([^\[\](){}]{1,30})[\])}]$")  # a name with a unit in brackets
_BEHIND = re.compile(r"/|,|(?:^|\s)in\s")  # marks before a unit without brackets
# A unit within a sentence: ``time in ms since the trigger``, ``acceleration (g) of the board``
_WITHIN = re.compile(r"(?:^|\s)in\s+(\S{1,40})(?=\s)|[\[(]([^\[\]()]{1,30})[\])]")
# A heading that ends in a unit in brackets, in a line of several
_BRACKETED = re.compile(r"[^\[\](){}]{1,200}[\[({][^\[\](){}]{1,30}[\])}]")
# A word before the names of all columns: ``columns: time acceleration``
_BEFORE_NAMES = re.compile(r"\s{0,5}[\w ]{1,30}:\s")
# Units behind an underscore, in files that write that of time so: ``time_ms``, ``board_g``
_SUFFIXES = {
    "g": "g", "n": "N", "kn": "kN", "v": "V", "mv": "mV", "pa": "Pa", "kpa": "kPa", "mpa": "MPa", "m_s2": "m/s^2",
    "ms2": "m/s^2", "mps2": "m/s^2", "mm": "mm", "ustrain": "ustrain",
}  # fmt: skip
# Units as instruments write them; anything else behind a mark is part of the name
_KNOWN = re.compile(
    r"[pnuµμmkMG]?(?:s|V|A|g|N|Pa|m|m/s|m/s\^?2|m/s²|m/s/s|Hz|Ω|bar|C|W|J|eu|EU)|°C?|deg|rad|rpm|%|psi|gn|g0|"
    r"(?:milli|micro|nano|kilo)?(?:second|volt|amp(?:ere)?|meter|metre|newton|pascal)s?|"
    r"sec|min|[um]sec|[mµuμ]?strain|[µuμ]m/m|[µuμ]?[εe]|counts?|lbf?",
    re.IGNORECASE,
)
# Headings of time, in several languages
_TIME = re.compile(
    r"(?:[\w.-]{1,30}[ _-]){0,3}(?:time|zeit|timestamp|messzeit)(?:[ _-]?(?:axis|base|stamp|value|achse|\d{1,3}))?"
    r"|t|x|x[ _-]?(?:axis|value|achse)|s|secs?|seconds?|sekunden?|temps|tiempo|tempo|elapsed|zeitachse|timebase",
    re.IGNORECASE,
)
# Headings of a column that counts samples
_COUNTER = re.compile(
    r"#|no\.?|nr\.?|n|index|sequence|samples?|points?|sample[ _-]?(?:no\.?|number|index)", re.IGNORECASE
)
# Letters before a comment above the data
_BEFORE_COMMENTS = "#%/;!* "
_MOST_COMMENTS = 50  # comments above the data in which a header is looked for, from the last one up
# Names of a line that gives the units of all columns after time
_Y_UNITS = re.compile(r"(?:vertical|y)[ _-]?units?(?:[ _-]label)?", re.IGNORECASE)


class Headings(NamedTuple):
    """Name and unit of each column, empty where the file has none; the header's cells as they stand."""

    names: list[str]
    units: list[str]
    header: tuple[str, ...] = ()

    @property
    def named(self) -> bool:
        """True if there is a header."""
        return any(self.names)


def name_and_unit(text: str) -> tuple[str, str]:
    """Part a heading into a name and a unit.

    Examples
    --------
    >>> [name_and_unit(text) for text in ("Acc (g)", "Time/s", "acc, m/s^2", "board", "[V]", "in ms")]
    [('Acc', 'g'), ('Time', 's'), ('acc', 'm/s^2'), ('board', ''), ('', 'V'), ('', 'ms')]
    >>> name_and_unit("time in ms since the trigger"), name_and_unit("Y[0]"), name_and_unit("strain [1]")
    (('time', 'ms'), ('Y[0]', ''), ('strain', '1'))
    """
    text = text.strip(" \"'\t")[:LONGEST_NAME]
    match = _BRACKETS.match(text)
    if match is not None and match[2].isdecimal() and (match[2] != "1" or match.end(1) == match.start(2) - 1):
        return text, ""
    if match is not None:
        return match[1].strip(), match[2].strip()
    for mark in _BEHIND.finditer(text):
        if (mark.start() or mark[0].strip() == "in") and is_unit(text[mark.end() :]):
            return text[: mark.start()].strip(), text[mark.end() :].strip()
    stem, _, tail = text.rpartition("_")
    if _TIME.fullmatch(stem) and seconds_in(tail) is not None:
        return stem, tail
    for mark in _WITHIN.finditer(text):
        unit = mark[1] or mark[2]
        if is_unit(unit):
            return text[: mark.start()].strip(), unit
    return text, ""


def is_unit(text: str) -> bool:
    """Tell whether a word is a unit that instruments write."""
    word = text.strip(" \"'()[]")[:LONGEST_UNIT]
    return bool(_KNOWN.fullmatch(word)) or seconds_in(word) is not None


def is_time(name: str, unit: str) -> bool:
    """Tell whether a heading is that of time."""
    if unit and seconds_in(unit) is None:
        return False
    return bool(_TIME.fullmatch(name[:60])) or bool(unit)


def is_counter(name: str, unit: str) -> bool:
    """Tell whether a heading is that of a column that counts samples."""
    return bool(_COUNTER.fullmatch(unit[:40] or name[:40]))


def find_headings(above: Sequence[str], marks: Marks, width: int, filled: Sequence[int]) -> Headings:
    """Find names and units in the lines above the data.

    ``filled`` are the columns that hold numbers.
    """
    lines = _whole([line for line in above if line.strip()])
    rows = [_row(line, marks, width) for line in lines if not is_comment(line) and not _setting(line, marks, filled)]
    rows = [row for row in rows if sum(bool(row[k]) for k in filled) * 2 > len(filled)]
    if not rows:
        return _commented(lines, marks, width, filled)
    worded = [row for row in rows if any(row[k] and number(row[k], marks.decimal) is None for k in filled)]
    rows = worded or rows  # numbers beside a row of words are a setting of each channel, such as an offset
    headings = _of_rows(rows, marks, filled)
    stated = _said_units(lines, marks, width, filled)
    return headings._replace(units=[own or unit for own, unit in zip(headings.units, stated, strict=True)])


def _whole(lines: Sequence[str]) -> list[str]:
    """Join lines that end within quotes with the next ones: spreadsheets break headings so."""
    joined: list[str] = []
    for line in lines:
        if joined and joined[-1].count('"') % 2 and len(joined[-1]) < LONGEST_NAME:
            joined[-1] += " " + line
        else:
            joined.append(line)
    return joined


def _of_rows(rows: list[list[str]], marks: Marks, filled: Sequence[int]) -> Headings:
    """Take names and units from the last of the rows above the data, or from the last two."""
    below = rows[-1]
    has_units = len(rows) > 1 and _all_units([below[k] for k in filled])
    second = len(rows) > 1 and not has_units and _is_second_head(rows[-2], below, marks, filled)
    header = rows[-2] if has_units or second else below
    parts = [name_and_unit(cell) for cell in header]
    units = [cell.strip("()[] ") for cell in below] if has_units else [unit for _, unit in parts]
    if second:
        units = [unit or name_and_unit(cell)[1] for unit, cell in zip(units, below, strict=True)]
    if not has_units and _all_units([header[k] for k in filled]):
        units = [unit or name for name, unit in parts]
    names = [name for name, _ in parts]
    return _with_suffixes(Headings(names, units, tuple(header)))


def _is_second_head(above: Sequence[str], below: Sequence[str], marks: Marks, filled: Sequence[int]) -> bool:
    """Tell whether the row above names time and holds no number: then the one below it only tells more of the same."""
    if any(number(above[k], marks.decimal) is not None for k in filled):
        return False
    named = [k for k in filled if is_time(*name_and_unit(above[k]))]
    again = [k for k in filled if is_time(*name_and_unit(below[k]))]
    return bool(named) and (not again or again[0] == named[0])


def _with_suffixes(headings: Headings) -> Headings:
    """Take units behind underscores off the names of a file that writes that of time so."""
    if not any(unit and cell.endswith(f"_{unit}") for cell, unit in zip(headings.header, headings.units, strict=False)):
        return headings
    names, units = list(headings.names), list(headings.units)
    for k, (name, unit) in enumerate(zip(names, units, strict=True)):
        for suffix, meant in _SUFFIXES.items():
            stem = name[: -len(suffix) - 1]
            if not unit and stem and name.casefold().endswith(f"_{suffix}"):
                names[k], units[k] = stem, meant
    return headings._replace(names=names, units=units)


def _setting(line: str, marks: Marks, filled: Sequence[int]) -> bool:
    """Tell whether a line is a name and its value, not a header."""
    cells = cells_of(line, marks)
    values = [number(cell, marks.decimal) for cell in cells]
    numbers = sum(value is not None and value == value for value in values[1:])
    if names_a_step(line) and len(filled) > 1 and values[0] is None:
        return "start" not in line.lower() or numbers > 0
    return bool(_Y_UNITS.fullmatch(cells[0])) or (len(filled) == 1 and names_a_step(line))


def _row(line: str, marks: Marks, width: int) -> list[str]:
    """Cut a header into as many cells as there are columns; it may be cut otherwise than the data.

    Of several ways that give as many cells, the one with most units counts.
    """
    choices = [cells_of(line, marks)]
    if not marks.delimiter:
        joined = re.sub(r"(\S)[ \t](?=[\[(])", "\\1\0", line.replace('"', ""))
        choices.append([cell.replace("\0", " ") for cell in joined.split()])
        choices.append([cell.strip() for cell in re.split(r"[ \t]{2,}", line.strip())])
    choices += [cells_of(line, Marks(other)) for other in ("\t", ";", ",", "|") if other in line]
    choices.append([cell.strip(' \t,;|"') for cell in _BRACKETED.findall(line[: width * LONGEST_NAME])])
    fitting = [cells for cells in choices if len(cells) == width] or [choices[0]]
    cells = max(fitting, key=_units_in)
    return (cells + [""] * width)[:width]


def _units_in(cells: Sequence[str]) -> int:
    """Count the cells that are a unit, end in one, or name time."""
    clean = [cell for cell in cells if cell.strip(" ,;|") == cell]
    return sum(bool(name_and_unit(cell)[1]) or is_unit(cell) or is_time(cell, "") for cell in clean)


def _all_units(cells: Sequence[str]) -> bool:
    written = [cell for cell in cells if cell.strip("-")]
    return bool(written) and all(
        is_unit(cell) or (len(cell) < 32 and cell[0] + cell[-1] in ("()", "[]")) or is_counter(cell, "")
        for cell in written
    )


def _said_units(lines: Sequence[str], marks: Marks, width: int, filled: Sequence[int]) -> list[str]:
    """Return the units that a line such as ``Vertical Units,V,V`` names for all columns after time."""
    for line in lines:
        cells = cells_of(line, marks)
        if _Y_UNITS.fullmatch(cells[0]):
            units = [cell if is_unit(cell) else "" for cell in cells[1:]]
            return [units[k - 1] if 0 < k <= len(units) and k in filled else "" for k in range(width)]
    return [""] * width


def _commented(lines: Sequence[str], marks: Marks, width: int, filled: Sequence[int]) -> Headings:
    """Take the last comment that names time, or a unit for every column, as a header.

    A comment below it that holds units only gives the units.
    """
    blank = Headings([""] * width, [""] * width)
    comments = [line.strip().lstrip(_BEFORE_COMMENTS).strip() for line in lines if _comments(line)]
    units: list[str] = []
    for comment in reversed(comments[-_MOST_COMMENTS:]):
        for header in (comment, _BEFORE_NAMES.sub("", comment, count=1)):
            row = _row(header, marks, width)
            if width == 1:
                row = [header]
            if not all(row[k] for k in filled):
                continue
            if not units and _all_units([row[k] for k in filled]):
                units = [cell.strip("()[] ") for cell in row]
                break
            parts = [name_and_unit(cell) for cell in row]
            headings = _with_suffixes(Headings([name for name, _ in parts], [unit for _, unit in parts], tuple(row)))
            if is_time(headings.names[filled[0]], headings.units[filled[0]]) or all(headings.units[k] for k in filled):
                own = [unit or below for unit, below in zip(headings.units, units or blank.units, strict=True)]
                return Headings(headings.names, own)
    return blank._replace(units=units) if units else blank


def _comments(line: str) -> bool:
    """Tell whether a line above the data is a comment, of any kind."""
    return line.lstrip().startswith(tuple(_BEFORE_COMMENTS.strip()))


# Picoseconds of a second: clock times are whole ones, as a double of seconds since 1904 holds no microsecond
PICO = 10**12
_STEP = re.compile(
    r"dt|delta[ _-]?[tx]|x[ _-]?incr(?:ement)?|tinc|(?:sampl(?:e|ing)|time|horizontal)[ _-]?(?:interval|period|step|"
    r"increment)|abtast(?:intervall|zeit)|increment|wf_increment",
    re.IGNORECASE,
)
_START = re.compile(
    r"t_?0|x_?0|xzero|start(?:[ _-]?time)?|wf_start_(?:time|offset)|startzeit|trigger[ _-]?time", re.IGNORECASE
)
# Names of a step, of a start, and a line that counts the samples, in English and German
_COUNT = re.compile(
    r"[#%/;!* \"]{0,5}(?:(?:number|no\.?|num|anzahl)[ _-]?(?:of|der)?[ _-]?)?(?:samples|points|data[ _-]?points|"
    r"messwerte|werte|record[ _-]?length|block[ _-]?(?:size|length)|sample[ _-]?count|npts|blockl(?:ä|ae)nge)[\"]?"
    r"(?:[ _-]?(?:points|samples))?[\"]?\s{0,5}[:=,;\t ][\s:=,;\"]{0,5}(\d{1,12})\"?\s{0,5}(?:[,;\t].{0,200})?",
    re.IGNORECASE,
)
# A time of day, perhaps behind a date
_CLOCK = re.compile(
    r"(?:(\S{6,12})[ T]{1,3})?(\d{1,2}):(\d{2}):(\d{2})(?:[.,](\d{1,40}))?\s{0,2}([AaPp][Mm])?", re.ASCII
)
_ISO = re.compile(r"(\d{4})[-/](\d{1,2})[-/](\d{1,2})")  # a date that can be read in one way only


class PerChannel(NamedTuple):
    """Settings by the column of each channel: step and start, s, clock time, ps, name, unit; empty where none is."""

    steps: Mapping[int, float]
    starts: Mapping[int, float]
    origins: Mapping[int, int]
    names: Mapping[int, str]
    units: Mapping[int, str]


def names_a_setting(cell: str) -> bool:
    """Tell whether a cell is the name of a step or a start.

    Examples
    --------
    >>> names_a_setting("delta t [ms]"), names_a_setting("board")
    (True, False)
    """
    name = name_and_unit(cell)[0]
    return bool(_STEP.fullmatch(name) or _START.fullmatch(name))


def settings_of(lines: Sequence[str], marks: Marks, width: int, columns: Sequence[int]) -> PerChannel:
    """Return what lines above the data say of each channel: a name, and a cell in the column of each."""
    steps: dict[int, float] = {}
    starts: dict[int, float] = {}
    origins: dict[int, int] = {}
    names: dict[int, str] = {}
    units: dict[int, str] = {}
    for line in lines:
        cells = cells_of(line[:_LONGEST], marks)
        name, unit = name_and_unit(cells[0].strip("#%/;!* :="))
        if len(cells) == width + 1:
            cells = cells[1:]  # the lines of data have no column for the names of settings
        own = {k: cells[k] for k in columns if k < len(cells) and cells[k]}
        values = {k: number(cell, marks.decimal) for k, cell in own.items()}
        plain = {k: value for k, value in values.items() if value is not None and math.isfinite(value)}
        seconds = seconds_in(unit) or 1.0
        if _STEP.fullmatch(name) and len(plain) == len(columns) and min(plain.values()) > 0.0:
            steps = {k: _in_seconds(value, seconds) for k, value in plain.items()}
        elif _START.fullmatch(name) and len(plain) == len(columns):
            starts = {k: _in_seconds(value, seconds) for k, value in plain.items()}
        elif _START.fullmatch(name) and own:
            origins = clock_times(own) or origins
        elif name.casefold() == "waveform":
            stated = {k: name_and_unit(cell) for k, cell in own.items() if not re.fullmatch(r"\[\d{1,9}\]", cell)}
            names = {k: called for k, (called, _) in stated.items() if called}
            units = {k: in_unit for k, (_, in_unit) in stated.items() if in_unit}
    return PerChannel(steps, starts, origins, names, units)


def _in_seconds(value: float, factor: float) -> float:
    return value / round(1.0 / factor) if factor < 1.0 else value * factor


def clock_times(cells: Mapping[int, str]) -> dict[int, int]:
    """Return times of day as one number each, ps, of the same day or of days that can be read; empty for others."""
    matches = {k: _CLOCK.fullmatch(" ".join(cell.split())) for k, cell in cells.items()}
    days = {match[1] or "" for match in matches.values() if match}
    times = {}
    for k, match in matches.items():
        if match is None:
            return {}
        day = _day(match[1] or "") if len(days) > 1 else 0
        hour = int(match[2]) % 12 + 12 * (match[6].lower() == "pm") if match[6] else int(match[2])
        if day is None:
            return {}
        seconds = ((24 * day + hour) * 60 + int(match[3])) * 60 + int(match[4])
        times[k] = seconds * PICO + int((match[5] or "0").ljust(12, "0")[:12])
    return times


def _day(text: str) -> int | None:
    """Return the number of a day whose year comes first; None for another one."""
    match = _ISO.fullmatch(text)
    try:
        return None if match is None else date(int(match[1]), int(match[2]), int(match[3])).toordinal()
    except ValueError:
        return None


def below_start_and_increment(lines: Sequence[str], marks: Marks) -> tuple[float, float]:
    """Return step and start, s, that stand below these words in a head of two lines; NaN for what does not."""
    step = start = math.nan
    for names, values in pairwise(cells_of(line[:_LONGEST], marks) for line in lines):
        for name, cell in zip(names, values, strict=False):
            value = number(cell, marks.decimal)
            if value is None or not math.isfinite(value):
                continue
            if name.casefold().startswith("incr") and value > 0.0:
                step = value
            elif name.casefold() == "start":
                start = value
    return step, start


def counted_samples(lines: Sequence[str]) -> int:
    """Return how many samples lines above the data count; 0 where they do not, or say different numbers."""
    counts = {int(match[1]) for line in lines if (match := _COUNT.fullmatch(line.strip()[:_LONGEST]))}
    return counts.pop() if len(counts) == 1 else 0
