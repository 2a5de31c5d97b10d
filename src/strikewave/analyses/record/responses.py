"""Response channels of records together: their figures as rows and columns, and summed up over blows and files."""

from __future__ import annotations

import math
from collections.abc import Sequence

from strikewave.analyses.record.rows import units_given
from strikewave.base import declare
from strikewave.base.declare import NO_UNIT, declarations
from strikewave.records.campaign import Statistic, statistic
from strikewave.records.health_notice import RESPONSE_FIGURES
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.records.response import MOST_MODES, MeasuredResponse, Mode
from strikewave.reporting.columns import Column
from strikewave.reporting.numbers import shown_unit


@declare.dataclass
class ResponseSummary:
    """Figures of one response channel over all blows of all files."""

    channel: str = declare.word("name of the response channel in the first file")
    unit: str
    statistics: dict[str, Statistic] = declare.named(
        Statistic, "of each figure that has a value; the peak by its magnitude, modes by the strongest", inline=True
    )


def responding(files: Sequence[FileReading]) -> list[tuple[FileReading, ChannelReading]]:
    """Return the channels that answer the blows of a base, with their files."""
    return [(file, reading) for file in files for reading in file.channels if reading.responses]


def base_of(file: FileReading) -> ChannelReading | None:
    """Return the driving channel of a file; None where it has none."""
    driven = any(reading.responses for reading in file.channels)
    return next((reading for reading in file.channels if driven and reading.pulses), None)


def harmed(file: FileReading, reading: ChannelReading) -> tuple[str, ...]:
    """Return the figures of a response channel that are not to be trusted."""
    findings = [*file.findings, *reading.findings]
    spoilt = any(finding.severity == "bad" for finding in findings)
    return tuple(name for name in RESPONSE_FIGURES if spoilt or any(name in finding.harms for finding in findings))


def summaries(files: Sequence[FileReading]) -> list[ResponseSummary]:
    """Sum up each response channel over its blows in all files; figures that a finding harms are left out."""
    rows = responding(files)
    found = []
    for number in dict.fromkeys(reading.number for _, reading in rows):
        own = [(file, reading) for file, reading in rows if reading.number == number]
        unit = own[0][1].channel.unit
        counting = [
            (k, reading, harmed(file, reading)) for k, (file, reading) in enumerate(own) if reading.channel.unit == unit
        ]
        statistics = {}
        for name in RESPONSE_FIGURES:
            pairs = [
                (k, value)
                for k, reading, wrong in counting
                if name not in wrong
                for value in (response.figure(name) for response in reading.responses)
                if math.isfinite(value)
            ]
            if pairs:
                statistics[name] = statistic([value for _, value in pairs], [k for k, _ in pairs])
        found.append(ResponseSummary(own[0][1].channel.name, unit, statistics))
    return found


def response_columns(files: Sequence[FileReading]) -> list[Column]:
    """Return all responses, one line a blow; where channels differ in unit, ``unit`` is that of each line."""
    rows = [(file, reading, one) for file, reading in responding(files) for one in reading.responses]
    units = [reading.channel.unit for _, reading, _ in rows]
    only = units[0] if len(set(units)) == 1 else ""
    columns = [
        Column("file", [file.path for file, _, _ in rows]),
        Column("channel", [reading.channel.name for _, reading, _ in rows]),
        Column("unit", [shown_unit(unit, unit) if only else unit for unit in units]),
        Column("status", [reading.status for _, reading, _ in rows]),
        Column("harmed", [" ".join(harmed(file, reading)) for file, reading, _ in rows]),
        Column("blow", [one.blow for _, _, one in rows]),
    ]
    for name in ("time", "peak", "ratio", "delay", "duration", "rms"):
        columns.append(Column(name, [getattr(one, name) for _, _, one in rows], _si(MeasuredResponse, name, only)))
    for k in range(MOST_MODES):
        modes = [one.modes[k] if k < len(one.modes) else None for _, _, one in rows]
        for name in ("frequency", "frequency_uncertainty", "damping", "damping_uncertainty", "decay_time", "amplitude"):
            values = [None if mode is None else getattr(mode, name) for mode in modes]
            columns.append(Column(f"mode_{k + 1}_{name}", values, _si(Mode, name, only)))
    return columns


def _si(kind: type, name: str, unit: str) -> str:
    """Return the SI unit of a field of responses of a channel of a unit; none of a share."""
    si = declarations(kind)[name].quantity.within(units_given(unit)).si
    return "" if si == NO_UNIT != unit else si
