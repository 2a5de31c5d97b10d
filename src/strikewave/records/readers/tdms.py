"""TDMS: channels of LabVIEW and DIAdem, in groups, most with a grid of their own (waveforms)."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

from strikewave.records.readers import Options
from strikewave.records.readers.common import ArrayColumn, assemble, extra, guard, left_out, number, text
from strikewave.records.record import Record


def sniff(head: bytes) -> bool:
    """Return whether a file begins like TDMS."""
    return head[:4] == b"TDSm"


def read(path: Path, options: Options) -> Record:
    """Read the numeric channels of a TDMS file; an index file beside it is not looked at."""
    nptdms = extra("nptdms", path)
    logging.getLogger("nptdms").setLevel(logging.CRITICAL)
    with path.open("rb") as opened, nptdms.TdmsFile.open(opened) as file:
        columns: list[ArrayColumn] = []
        skipped: list[str] = []
        for channel in (channel for group in file.groups() for channel in group.channels()):
            name = f"{channel.group_name}/{channel.name}"
            raw = channel._raw_data_dtype()
            if channel.dtype.kind not in "biufM" or not len(channel):
                skipped.append(name)
                continue
            guard(path, len(channel) * max(raw.itemsize, 1), compressed=False)
            columns.append(_column(channel, name))
        return assemble(path, "tdms", columns, options, findings=left_out(skipped))


def _column(channel: Any, name: str) -> ArrayColumn:
    """Return a channel with the grid and unit of its properties."""
    properties = channel.properties
    step = number(properties.get("wf_increment"))
    start = number(properties.get("wf_start_offset"))
    unit = text(properties.get("unit_string")) or text(properties.get("NI_UnitDescription"))
    folder = f"{channel.group_name}/"
    return ArrayColumn(name, len(channel), channel.read_data, unit, step if step > 0.0 else float("nan"), start, folder)
