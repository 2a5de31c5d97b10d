"""TDMS: channels of LabVIEW and DIAdem, in groups, most with a grid of their own (waveforms)."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

from strikewave.records.readers import Options
from strikewave.records.readers.child import isolated
from strikewave.records.readers.clock import seconds_in
from strikewave.records.readers.common import ArrayColumn, assemble, extra, guard, left_out, number, text
from strikewave.records.readers.settings import PICO
from strikewave.records.record import Record

MANY_SEGMENTS = 1000
"""Segments, each with a head and samples of some channels, above which a file is read with limits of time and memory:
npTDMS looks at each of them for each channel, which takes minutes where there are 10 000 of both."""
_HEAD, _BIG_ENDIAN = 28, 1 << 6
"""Bytes of the head of a segment: its mark, flags, version, and how far the next one and its samples are; the flag of
big-endian numbers."""

_FIRST_SECOND = 24107 * 86400
"""Seconds from 1904, from which TDMS counts, to 1970: an earlier time is that of no clock, but of a waveform without
one."""


def sniff(head: bytes) -> bool:
    """Return whether a file begins like TDMS."""
    return head[:4] == b"TDSm"


def read(path: Path, options: Options) -> Record:
    """Read the numeric channels of a TDMS file, in a child process where it has many segments."""
    extra("nptdms", path)
    return isolated("tdms", path, options) if _has_many_segments(path) else parse(path, options)


def _has_many_segments(path: Path) -> bool:
    """Tell whether a file has more than `MANY_SEGMENTS`, by the heads with which they begin."""
    size, place = path.stat().st_size, 0
    with path.open("rb") as file:
        for _ in range(MANY_SEGMENTS):
            file.seek(place)
            head = file.read(_HEAD)
            if place >= size or len(head) < _HEAD or head[:4] != b"TDSm":
                return False
            flags, length = int.from_bytes(head[4:8], "little"), head[12:20]
            place += _HEAD + int.from_bytes(length, "big" if flags & _BIG_ENDIAN else "little")
    return place < size


def parse(path: Path, options: Options) -> Record:
    """Read the numeric channels of a TDMS file; an index file beside it is not looked at."""
    nptdms = extra("nptdms", path)
    logging.getLogger("nptdms").setLevel(logging.CRITICAL)
    with path.open("rb") as opened, nptdms.TdmsFile.open(opened, raw_timestamps=True) as file:
        columns: list[ArrayColumn] = []
        skipped: list[str] = []
        for channel in (channel for group in file.groups() for channel in group.channels()):
            name = f"{channel.group_name}/{channel.name}"
            raw = channel._raw_data_dtype()
            is_stamp = channel.data_type is nptdms.types.TimeStamp
            if (channel.dtype.kind not in "biuf" and not is_stamp) or not len(channel) or not _is_over_time(channel):
                skipped.append(name)
                continue
            guard(path, len(channel) * max(raw.itemsize, 1), compressed=False)
            columns.append(_stamps(channel, name) if is_stamp else _column(channel, name))
        return assemble(path, "tdms", columns, options, findings=left_out(skipped))


def _is_over_time(channel: Any) -> bool:
    """Tell whether a channel is a waveform over time, or has no grid; a spectrum has a grid of frequencies."""
    properties = channel.properties
    unit = text(properties.get("wf_xunit_string"))
    return not unit or not number(properties.get("wf_increment")) > 0.0 or seconds_in(unit) is not None


def _column(channel: Any, name: str) -> ArrayColumn:
    """Return a channel with the grid, the clock time of its begin and the unit of its properties."""
    properties = channel.properties
    scale = seconds_in(text(properties.get("wf_xunit_string"))) or 1.0
    step = number(properties.get("wf_increment")) * scale
    start = number(properties.get("wf_start_offset")) * scale
    unit = text(properties.get("unit_string")) or text(properties.get("NI_UnitDescription"))
    grid = step if step > 0.0 else float("nan")
    origin = _clock_time(properties.get("wf_start_time")) if step > 0.0 else None
    folder = f"{channel.group_name}/"
    return ArrayColumn(name, len(channel), channel.read_data, unit, grid, start, folder, origin=origin)


def _stamps(channel: Any, name: str) -> ArrayColumn:
    """Return a channel of clock times, as time since the first of them."""
    folder = f"{channel.group_name}/"
    origin = _clock_time(channel[0])
    return ArrayColumn(
        name, len(channel), lambda: channel.read_data().as_datetime64("ns"), folder=folder, time=True, origin=origin
    )


def _clock_time(value: Any) -> int | None:
    """Return a timestamp as one number, ps; None for another value, and for one that was never set."""
    seconds, fractions = getattr(value, "seconds", None), getattr(value, "second_fractions", None)
    if seconds is None or fractions is None or int(seconds) < _FIRST_SECOND:
        return None
    return int(seconds) * PICO + (int(fractions) * PICO >> 64)
