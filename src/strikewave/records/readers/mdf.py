"""MDF version 3 and 4: channels of vehicle and test bench recorders, each group over its master channel.

Formulas, scripts and attachments that such a file may carry are not run, read or opened. The file is read in a child
process with limits, as its blocks can promise more than any memory holds.
"""

from __future__ import annotations

import functools
import logging
from pathlib import Path
from typing import Any

from strikewave.records.health_notice import HealthNotice
from strikewave.records.readers import Options
from strikewave.records.readers.child import isolated
from strikewave.records.readers.common import MOST_ARRAYS, ArrayColumn, assemble, damaged, extra, floats, left_out, text
from strikewave.records.record import Record

_PLAIN = {3: {0, 1, 2, 6, 7, 8, 9, 65535}, 4: {0, 1, 2, 4, 5, 6}}
"""Conversions from numbers to numbers, without text or formulas, by version."""


def sniff(head: bytes) -> bool:
    """Return whether a file begins like MDF."""
    return head[:8] in (b"MDF     ", b"UnFinMF ")


def read(path: Path, options: Options) -> Record:
    """Read the numeric channels of an MDF file."""
    extra("asammdf", path)
    return isolated("mdf", path, options)


def parse(path: Path, options: Options) -> Record:
    """Read an MDF file in this process."""
    logging.disable(logging.CRITICAL)
    asammdf = extra("asammdf", path)
    columns: list[ArrayColumn] = []
    skipped: list[str] = []
    raw: list[str] = []
    # An open file has no name with an ending that would have it unpacked.
    with path.open("rb") as opened, asammdf.MDF(opened, process_bus_logging=False, use_display_names=False) as file:
        groups = range(len(file.groups))
        for group in groups:
            for index, channel in enumerate(file.groups[group].channels):
                if len(columns) + len(skipped) > MOST_ARRAYS:
                    raise damaged(path, f"it has more than {MOST_ARRAYS} channels", "a file with fewer channels")
                channel_columns = _column(file, group, index, channel, raw)
                columns += channel_columns
                skipped += [channel.name] * (not channel_columns)
        findings = [*left_out(skipped)]
        if raw:
            listed = ", ".join(raw[:8])
            findings.append(HealthNotice("not-converted", f"their conversion is text or a formula: {listed}", len(raw)))
        return assemble(path, "mdf", columns, options, findings=findings)


def _column(file: Any, group: int, index: int, channel: Any, raw: list[str]) -> list[ArrayColumn]:
    """Return a channel; the master channel of its group is its time."""
    signal = file.get(group=group, index=index, raw=True, ignore_invalidation_bits=True)
    values = signal.samples
    if values.dtype.kind not in "biuf" or values.ndim != 1 or not values.size:
        return []
    version = 4 if str(file.version) >= "4" else 3
    conversion = signal.conversion
    if conversion is not None and conversion.conversion_type not in _PLAIN[version]:
        raw.append(channel.name)
        conversion = None
    master = file.masters_db.get(group) == index
    unit = text(signal.unit)
    name = "time" if master else str(channel.name)
    load = functools.partial(_physical, values, conversion)
    return [ArrayColumn(name, values.size, load, unit, folder=f"{group}", time=master)]


def _physical(values: Any, conversion: Any) -> Any:
    if conversion is None:
        return values
    try:
        return floats(conversion.convert(values, as_object=False))
    except TypeError:
        return values
