"""Settings above columns of text: step, start and clock time of each channel, and how many samples the head counts."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from datetime import date
from itertools import pairwise
from typing import NamedTuple

from strikewave.records.readers.clock import seconds_in
from strikewave.records.readers.columns import Marks, cells_of, number
from strikewave.records.readers.headings import name_and_unit

PICO = 10**12
"""Picoseconds of a second: clock times are whole ones, as a double of seconds since 1904 holds no microsecond."""
_STEP = re.compile(
    r"dt|delta[ _-]?[tx]|x[ _-]?incr(?:ement)?|tinc|(?:sampl(?:e|ing)|time|horizontal)[ _-]?(?:interval|period|step|"
    r"increment)|abtast(?:intervall|zeit)|increment|wf_increment",
    re.IGNORECASE,
)
_START = re.compile(
    r"t_?0|x_?0|xzero|start(?:[ _-]?time)?|wf_start_(?:time|offset)|startzeit|trigger[ _-]?time", re.IGNORECASE
)
_COUNT = re.compile(
    r"[#%/;!* \"]{0,5}(?:(?:number|no\.?|num|anzahl)[ _-]?(?:of|der)?[ _-]?)?(?:samples|points|data[ _-]?points|"
    r"messwerte|werte|record[ _-]?length|block[ _-]?(?:size|length)|sample[ _-]?count|npts|blockl(?:ä|ae)nge)[\"]?"
    r"(?:[ _-]?(?:points|samples))?[\"]?\s{0,5}[:=,;\t ][\s:=,;\"]{0,5}(\d{1,12})\"?\s{0,5}(?:[,;\t].{0,200})?",
    re.IGNORECASE,
)
"""Names of a step, of a start, and a line that counts the samples, in English and German."""
_LONGEST = 500
"""Characters of a line that are looked at: bounds the time of patterns on hostile lines."""
_CLOCK = re.compile(
    r"(?:(\S{6,12})[ T]{1,3})?(\d{1,2}):(\d{2}):(\d{2})(?:[.,](\d{1,40}))?\s{0,2}([AaPp][Mm])?", re.ASCII
)
"""A time of day, perhaps behind a date."""
_ISO = re.compile(r"(\d{4})[-/](\d{1,2})[-/](\d{1,2})")
"""A date that can be read in one way only."""


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
    """Return what lines above the data say of each channel: a name, and a cell in the column of each.

    Examples
    --------
    >>> lines = ["waveform;bar [g];[1]", "t0;10:00:00,000;10:00:00,003", "delta t [ms];0,02;0,04"]
    >>> found = settings_of(lines, Marks(";", ","), 3, [1, 2])
    >>> found.steps, found.origins[2] - found.origins[1], found.names, found.units
    ({1: 2e-05, 2: 4e-05}, 3000000000, {1: 'bar'}, {1: 'g'})
    """
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
    """Return times of day as one number each, ps, of the same day or of days that can be read; empty for others.

    Examples
    --------
    >>> clock_times({1: "1/5/2026 10:00:00.5 PM", 2: "1/5/2026 10:00:01 PM"})
    {1: 79200500000000000, 2: 79201000000000000}
    >>> clock_times({1: "1/5/2026 10:00:00", 2: "1/6/2026 10:00:00"})
    {}
    """
    found = {k: _CLOCK.fullmatch(" ".join(cell.split())) for k, cell in cells.items()}
    days = {match[1] or "" for match in found.values() if match}
    times = {}
    for k, match in found.items():
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
    """Return step and start, s, that stand below these words in a head of two lines; NaN for what does not.

    Examples
    --------
    >>> below_start_and_increment(["X,CH1,Start,Increment,", "Sequence,Volt,-8e-03,2e-05,"], Marks(","))
    (2e-05, -0.008)
    """
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
    """Return how many samples lines above the data count; 0 where they do not, or say different numbers.

    Examples
    --------
    >>> counted_samples(["Sampling rate: 50 kHz", "Record Length,2500,Points"])
    2500
    >>> counted_samples(["Samples per second: 9"]), counted_samples(["Points: 9", "Samples: 8"])
    (0, 0)
    """
    counts = {int(match[1]) for line in lines if (match := _COUNT.fullmatch(line.strip()[:_LONGEST]))}
    return counts.pop() if len(counts) == 1 else 0
