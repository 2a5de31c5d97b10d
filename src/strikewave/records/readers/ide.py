"""IDE: files of enDAQ and Mide recorders, calibrated by the file.

The numbers of such a file can be written as expressions; here only a decimal number or one fraction is taken. The file
is read in a child process with limits.
"""

from __future__ import annotations

import logging
import warnings
from pathlib import Path
from typing import Any

from strikewave.records.readers import Options
from strikewave.records.readers.child import isolated
from strikewave.records.readers.common import MOST_ARRAYS, ArrayColumn, assemble, damaged, extra, guard, left_out, text
from strikewave.records.record import Record

_MICROSECOND = 1e-6
"""s; times of such a file are in microseconds."""
_MOST_PER_BYTE = 8
"""Samples for each byte of the file at most: a sample has one bit at least."""


def sniff(head: bytes) -> bool:
    """Return whether a file begins like an IDE file: EBML whose document type is ``mide``."""
    return head[:4] == b"\x1aE\xdf\xa3" and b"mide" in head[:128]


def read(path: Path, options: Options) -> Record:
    """Read the channels of an IDE file."""
    extra("idelib", path)
    return isolated("ide", path, options)


def parse(path: Path, options: Options) -> Record:
    """Read an IDE file in this process."""
    logging.disable(logging.CRITICAL)
    idelib = extra("idelib", path)
    extra("idelib.parsers", path).valEval = _ratio
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        opened = idelib.importFile(str(path), quiet=True)
        with opened:
            columns: list[ArrayColumn] = []
            skipped: list[str] = []
            for channel in list(opened.channels.values())[:MOST_ARRAYS]:
                channel_columns = _columns(path, channel)
                columns += channel_columns
                skipped += [str(channel.name)] * (not channel_columns)
            return assemble(path, "ide", columns, options, findings=left_out(skipped))


def _ratio(value: Any) -> float:
    """Return the number that a text such as ``"1/32768"`` writes."""
    above, _, below = text(value).partition("/")
    return float(above) / float(below or 1.0)


def _columns(path: Path, channel: Any) -> list[ArrayColumn]:
    """Return the axes of one sensor, with their time, in place of what the file keeps of them."""
    events = channel.getSession()
    size = len(events)
    if not size:
        return []
    if size * len(channel.subchannels) > _MOST_PER_BYTE * path.stat().st_size:
        raise damaged(path, f"channel {channel.name} claims {size} samples")
    guard(path, 8.0 * size * (len(channel.subchannels) + 1))
    values = events.arraySlice()
    folder = f"{channel.id}"
    columns = [ArrayColumn("time", size, lambda: values[0] * _MICROSECOND, "s", folder=folder, time=True)]
    for k, axis in enumerate(channel.subchannels, start=1):
        if axis is not None and k < len(values):
            unit = text((axis.units or ("", ""))[1])
            name = f"{channel.name}/{axis.displayName}"
            columns.append(ArrayColumn(name, size, lambda k=k: values[k], unit, folder=folder))  # type: ignore[misc]
    return columns
