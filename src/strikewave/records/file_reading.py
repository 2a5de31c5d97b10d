"""A file evaluated: its channels with their calibrations, those that respond, repeats of a test in its columns."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Mapping, Sequence
from typing import Any

from strikewave.base.errors import InputError, nearest, show
from strikewave.records.calibration import calibration_of, laid_over
from strikewave.records.health_notice import HealthNotice
from strikewave.records.reading import ChannelReading, FileReading, Request, read_channel
from strikewave.records.record import Channel, Record
from strikewave.records.response_reading import read_response, told_apart


def read_file(record: Record, stated: Mapping[str, Mapping[str, Any]], request: Request) -> FileReading:
    """Return the wanted channels of a record, evaluated.

    Parameters
    ----------
    record : Record
        As `read_record` gives it.
    stated : mapping
        Calibrations found beside the file; those of the request go first.
    request : Request
        What is wanted.

    Raises
    ------
    InputError
        As `read_channel` and `Record.channel` do.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(4000) * 1e-5
    >>> values = 100.0 * np.exp(-(((t - 0.02) / 1e-4) ** 2)) + 1e-3 * np.sin(1e9 * t)
    >>> file = read_file(Record("a.csv", "text", (Channel("board", values, 1e-5, unit="g"),)), {}, Request())
    >>> file.status, round(file.channels[0].pulses[0].peak)
    ('good', 981)
    """
    wanted = record.only(request.channels).channels
    places = {id(channel): number for number, channel in enumerate(record.channels, start=1)}
    tables, unused = _by_number(record, laid_over(stated, request.calibrations))
    base = _base_of(record, wanted, request)
    driving = None if base is None else _read(base, places, tables, request)
    readings = []
    for channel in wanted:
        if driving is None or base is channel:
            readings.append(driving or _read(channel, places, tables, request))
            continue
        number = places[id(channel)]
        readings.append(read_response(channel, number, calibration_of(tables, channel.name, number), request, driving))
    told = readings if driving is not None else told_apart(readings)
    return FileReading(record.path, record.format, tuple(told), (*record.findings, *unused))


def _read(channel: Channel, places: Mapping[int, int], tables: Mapping[str, Any], request: Request) -> ChannelReading:
    """Return a channel of a file, evaluated."""
    number = places[id(channel)]
    return read_channel(channel, number, calibration_of(tables, channel.name, number), request)


def _base_of(record: Record, wanted: Sequence[Channel], request: Request) -> Channel | None:
    """Return the driving channel; None where none is named."""
    if not request.base:
        return None
    base = record.channel(request.base, "--base")
    names = [channel.name for channel in wanted]
    if not any(channel is base for channel in wanted):
        hint = f"add --channel {request.base}"
        raise InputError("--base", request.base, f"one of the channels that are read: {', '.join(names)}", hint)
    if len(wanted) == 1:
        hint = "leave it out" if len(record.channels) == 1 else "name a channel that responds by --channel too"
        raise InputError("--base", request.base, f"a channel beside others: only {names[0]} is read", hint)
    return base


def repeats(file: FileReading) -> list[FileReading]:
    """Return a file a channel: repeats of the same test that stand in columns, or sheets, of one file.

    Each is called as the file with the name of its column, and its channel as what the names have in common.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(4000) * 1e-5
    >>> channels = tuple(Channel(f"shot {k}", np.exp(-(((t - 0.02) / 1e-4) ** 2)), 1e-5) for k in (1, 2))
    >>> file = read_file(Record("a.csv", "text", channels), {}, Request())
    >>> [(one.path, [(r.channel.name, r.number) for r in one.channels]) for one in repeats(file)]
    [('a.csv: shot 1', [('shot', 1)]), ('a.csv: shot 2', [('shot', 1)])]
    """
    names = [reading.channel.name for reading in file.channels]
    stems = {re.sub(r"[\W_]*\d*[\W_]*$", "", name.rpartition("/")[2]) for name in names}
    common = stems.pop() if len(stems) == 1 else ""
    return [
        dataclasses.replace(
            file,
            path=f"{file.path}: {reading.channel.name}",
            channels=(
                dataclasses.replace(
                    reading, number=1, channel=dataclasses.replace(reading.channel, name=common or "repeats")
                ),
            ),
        )
        for reading in file.channels
    ]


def _by_number(
    record: Record, tables: Mapping[str, Mapping[str, Any]]
) -> tuple[dict[str, dict[str, Any]], list[HealthNotice]]:
    """Return calibrations by the numbers of their channels, and a finding for each channel that the file lacks."""
    known = record.keys
    by_number: dict[str, dict[str, Any]] = {}
    unused = []
    for name, table in tables.items():
        if name != "all" and name not in known:
            message = f"a calibration is for {show(name)}, which the file does not have: {nearest(name, known)}"
            unused.append(HealthNotice("calibration-unused", message))
            continue
        key = name if name == "all" else str(known[name] + 1)
        by_number[key] = {**by_number.get(key, {}), **table}
    return by_number, unused
