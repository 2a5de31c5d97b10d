"""All blows as a table: a line a blow, with every figure."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from strikewave.analyses.record.document import RIGID, SPLIT, pulse_row
from strikewave.analyses.record.figure_units import INTEGRALS, OF_CHANNEL, OF_INTEGRAL, PULSE_UNITS
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.records.smooth_pulse import PulseUncertainty
from strikewave.reporting.columns import Column
from strikewave.reporting.shown_units import shown_unit

FIGURES = (
    *("time", "peak", "rise", "width", "velocity_change", "ringing_frequency", "offset", "noise", "method"),
    *("begin", "end", "smooth_peak", "smooth_width", "smooth_misfit"),
    *(name for name in RIGID if name.endswith("_uncertainty")),
    *(f"rigid_{name}" for name in RIGID),
)
"""Columns of every table of blows, after those that say where each stands."""
OF_SPLIT = (*SPLIT, "cutoff", "wave_energy")
"""Figures of the band split that have a column, after its name."""
EXPANDED = tuple(f"{name}_expanded_uncertainty" for name in PulseUncertainty._fields)
"""Columns of expanded uncertainties by a budget."""


def pulse_columns(files: Sequence[FileReading]) -> list[Column]:
    """Return all pulses, one line a pulse; where channels differ in unit, ``unit`` is that of each line."""
    places = [
        (file.path, reading, index)
        for file in files
        for reading in file.channels
        for index in range(1, len(reading.pulses) + 1)
    ]
    units = [reading.channel.unit for _, reading, _ in places]
    only = units[0] if len(set(units)) == 1 else ""
    columns = [
        Column("file", [file for file, _, _ in places]),
        Column("channel", [reading.channel.name for _, reading, _ in places]),
        Column("unit", [shown_unit(unit, unit) if only else unit for unit in units]),
        Column("status", [reading.status for _, reading, _ in places]),
        Column("index", [index for _, _, index in places]),
    ]
    rows = [_row(reading, index - 1) for _, reading, index in places]
    expanded = EXPANDED if any(reading.uncertainties for _, reading, _ in places) else ()
    for name in (*FIGURES, *(f"split_{name}" for name in OF_SPLIT), *expanded):
        si = only if name in OF_CHANNEL else INTEGRALS.get(only, f"{only} s") if name in OF_INTEGRAL else ""
        columns.append(Column(name, [row[name] for row in rows], PULSE_UNITS.get(name, si)))
    return columns


def _row(reading: ChannelReading, place: int) -> dict[str, Any]:
    """Return the figures of a pulse; NaN where it was not split, or has no budget."""
    row = pulse_row(reading.pulses[place])
    split = row["split"] or dict.fromkeys(OF_SPLIT, math.nan)
    known = reading.uncertainties[place].figures if reading.uncertainties else None
    return {
        **row,
        **{f"split_{name}": split[name] for name in OF_SPLIT},
        **{
            column: math.nan if known is None else known[name].expanded
            for name, column in zip(PulseUncertainty._fields, EXPANDED, strict=True)
        },
    }
