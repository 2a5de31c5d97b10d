"""Velocity and displacement of records as a chapter: table and picture."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from strikewave.analyses.record.moved import RecordMotion
from strikewave.base.shock_quantities import LENGTH, MILLISECONDS, VELOCITY
from strikewave.reporting.faces import amount
from strikewave.reporting.parts import Cell, Part, Picture, Section, Table

MOST_ROWS = 60
"""Channels of the table; motion.csv has all."""


def motion_table(found: Sequence[RecordMotion]) -> Table:
    """Return where the motions end, and how well that is known."""
    rows: list[list[Cell]] = []
    for one in found[:MOST_ROWS]:
        last = {name: float(values[-1]) for name, values in one.motion._asdict().items()}
        speed, way = (
            f"{amount(of, last[name], digits=3)} ± {amount(of, last[f'{name}_drift'], digits=2)}"
            for name, of in (("velocity", VELOCITY), ("displacement", LENGTH))
        )
        lost = "–" if math.isnan(one.lost) else f"from {amount(MILLISECONDS, one.lost)} on"
        rows.append([Path(one.file).name, one.channel, speed, way, lost])
    title = "Motion from rest before the first blow to the end of the record, ± a standard deviation of its drift"
    heads = ["file", "channel", "velocity at the end", "displacement at the end", "drift exceeds the displacement"]
    return Table(title, heads, rows, empty="No acceleration with a blow: no motion.")


def motion_section(found: Sequence[RecordMotion]) -> Section:
    """Return table and picture, that of the first channel."""
    from strikewave.analyses.record.figures.motions import motion_figure

    text = (
        "The record, its zero before the first blow taken off, integrated once and twice. A zero that is off by u "
        "gives u t and u t²/2; both are told from what lies before the blow. motion.csv has the histories."
    )
    parts: list[Part] = []
    if found:
        caption = f"{Path(found[0].file).name}, {found[0].channel}: shaded is a standard deviation of drift either way."
        parts.append(Picture(motion_figure(found[0]), caption))
    return Section("Motion", text, [*parts, motion_table(found)])
