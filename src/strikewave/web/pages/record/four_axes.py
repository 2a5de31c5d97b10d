"""The shock response spectra of records on four axes; it runs in processes of the app."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from strikewave.analyses.record.figures.records import shown
from strikewave.analyses.record.spectrum import SpectrumResult
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.errors import StrikewaveError
from strikewave.web.charts import MOST_CURVES, SOFT, ChartLine, colour, dash, line_chart
from strikewave.web.curves import points

GRID = "#c9ced3"
BESIDE_GUIDES = 62
"""Pixels on the right of four axes for the names of the lines that leave there."""
WITHIN = 1.2
"""The lines of the grid end a twelfth of a decade inside the diagram, so that no name touches a number of an axis."""


def four_axes(result: SpectrumResult) -> dict[str, Any]:
    """Return the pseudo-velocities on four axes: lines of equal acceleration fall, of equal displacement rise.

    These lines need accelerations: records in other units have none. Spectra that enter no envelope are left out.
    """
    unit = result.reading.channel.unit
    is_acceleration = unit == "m/s^2"
    shocks = [(shock.name, shock.found.spectra[0]) for shock in result.used or result.shocks]
    drawn = (shocks or [(result.title, result.spectra[0])])[:MOST_CURVES]
    frequency = drawn[0][1].frequency
    sizes = [np.maximum(spectrum.positive, spectrum.negative) for _, spectrum in drawn]
    lines = [
        ChartLine(name, points(frequency, size), colour(k), dash(k))
        for k, ((name, _), size) in enumerate(zip(drawn, sizes, strict=True))
    ]
    above_zero = np.concatenate([size[size > 0.0] for size in sizes])
    if not above_zero.size:
        raise StrikewaveError("the record is zero throughout: it has no spectrum")
    low, high = 10.0 ** math.floor(math.log10(above_zero.min())), 10.0 ** math.ceil(math.log10(above_zero.max()))
    guides: list[ChartLine] = []
    for power in range(0, 7) if is_acceleration else ():
        g = 10.0**power
        guides += _guide(f"{g:g} g", frequency, g * STANDARD_GRAVITY / (2.0 * math.pi * frequency), low, high)
    for power in range(-7, 1) if is_acceleration else ():
        d = 10.0**power
        guides += _guide(f"{1e3 * d:g} mm", frequency, 2.0 * math.pi * frequency * d, low, high)
    options = line_chart(
        "Shock response spectrum" + (" on four axes" if is_acceleration else ""),
        "natural frequency (Hz)",
        f"pseudo-velocity ({'m/s' if is_acceleration else shown(unit).integral_unit})",
        [*lines, *guides],
        log=True,
        log_y=True,
    )
    options["legend"] |= {"data": [line.name for line in lines], "show": len(lines) > 1}
    for guide in options["series"][len(lines) :]:
        guide["endLabel"] = {"show": True, "formatter": "{a}", "fontSize": 9, "color": SOFT}
        guide["silent"] = True
    options["yAxis"] |= {"min": low, "max": high}
    options["grid"] |= {"right": BESIDE_GUIDES} if guides else {}
    return options


def _guide(name: str, frequency: Any, velocity: Any, low: float, high: float) -> Sequence[ChartLine]:
    """Return a line of the grid of four axes, where it crosses the diagram; its name stays inside."""
    seen = (velocity >= WITHIN * low) & (velocity <= high / WITHIN)
    if np.count_nonzero(seen) < 2:
        return ()
    return (ChartLine(name, points(frequency[seen], velocity[seen], 40), GRID, "dotted"),)
