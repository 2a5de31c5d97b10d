"""Picture of velocity and displacement with their drift."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from strikewave.analyses.record.figures.records import COLUMNS, clock
from strikewave.analyses.record.moved import RecordMotion
from strikewave.reporting.numbers import axis_unit, headed
from strikewave.reporting.style import BLUE, new_figure, quiet

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def motion_figure(one: RecordMotion) -> Figure:
    """Draw velocity and displacement over time, their drift shaded."""
    figure = new_figure()
    rows: Any = figure.subplots(1, 2)
    factor, seconds = clock(float(np.ptp(one.time)))
    kept = np.unique(np.linspace(0, one.time.size - 1, min(one.time.size, 2 * COLUMNS)).round().astype(int))
    for axes, name, si, usual in zip(rows, ("velocity", "displacement"), ("m/s", "m"), ("m/s", "mm"), strict=True):
        size, _ = axis_unit(si, usual)
        values, drift = (getattr(one.motion, key)[kept] / size for key in (name, f"{name}_drift"))
        time = one.time[kept] * factor
        axes.fill_between(time, values - drift, values + drift, color=BLUE, alpha=0.2, linewidth=0)
        axes.plot(time, values, color=BLUE, linewidth=1.2)
        quiet(axes, name.capitalize(), f"time ({seconds})", headed(name, si, usual))
        axes.margins(x=0.01)
    return figure
