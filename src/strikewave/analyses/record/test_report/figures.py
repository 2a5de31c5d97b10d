"""The pulses of one direction over one another, in the band that they are to keep."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from strikewave.analyses.record.verdicts.figures import draw_limits, shown_window
from strikewave.reporting.numbers import axis_unit, time_unit
from strikewave.reporting.style import BLUE, GREY, HALF, ORANGE, RED, legend_below, new_figure, plain, quiet, thin
from strikewave.specifications.judged_records import JudgedShock
from strikewave.specifications.judging import CANNOT_TELL, FAIL, PASS, PulseLimits

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_LINES = 24
"""Pulses that are drawn one by one, those that do not pass first; beyond them the range of all is filled."""
POINTS = 150
"""Points of a pulse, and of the range."""
COLOURS = {PASS: BLUE, CANNOT_TELL: ORANGE, FAIL: RED}
WORDS = {PASS: "passes", CANNOT_TELL: "cannot tell", FAIL: "fails"}


def drawn_shocks(shocks: Sequence[JudgedShock]) -> list[JudgedShock]:
    """Return the shocks that are drawn one by one: all of a few; else those that do not pass, and some that do."""
    if len(shocks) <= MOST_LINES:
        return list(shocks)
    odd = [one for verdict in (FAIL, CANNOT_TELL) for one in shocks if one.found.verdict == verdict]
    odd = odd[: MOST_LINES // 2]
    passed = [one for one in shocks if one.found.verdict == PASS]
    chosen = {round(place) for place in np.linspace(0, len(passed) - 1, MOST_LINES - len(odd))} if passed else set()
    return [*(passed[place] for place in sorted(chosen)), *odd]


def overlay(shocks: Sequence[JudgedShock], limits: PulseLimits, name: str) -> Figure:
    """Draw shocks over one another, each from the begin of the ideal pulse where the band lies best over it."""
    figure = new_figure(HALF)
    axes = figure.add_subplot()
    size, unit = axis_unit("m/s^2", "g")
    second, clock = time_unit(limits.pulse.duration)
    draw_limits(axes, limits, size, second)
    before, after = shown_window(limits)
    grid = np.linspace(-before, limits.pulse.duration + after, POINTS)
    drawn = drawn_shocks(shocks)
    if len(drawn) < len(shocks):
        low, high = np.full(POINTS, np.inf), np.full(POINTS, -np.inf)
        for one in shocks:
            values = np.interp(grid, one.shock.time - one.found.start, one.shock.values, np.nan, np.nan)
            low, high = np.fmin(low, values), np.fmax(high, values)
        known = np.isfinite(low) & np.isfinite(high)
        shown = (grid[known] / second, low[known] / size, high[known] / size)
        axes.fill_between(*shown, color=GREY, alpha=0.25, linewidth=0, label=f"range of all {len(shocks)}")
    named = set[str]()
    for one in drawn:
        verdict = one.found.verdict
        time = one.shock.time - one.found.start
        inside = (time >= grid[0]) & (time <= grid[-1])
        x, y = thin(time[inside], one.shock.values[inside], POINTS // 2)
        label = "" if verdict in named else WORDS[verdict]
        named.add(verdict)
        axes.plot(x / second, y / size, color=COLOURS[verdict], linewidth=0.8, alpha=0.8, label=label or "_")
    quiet(axes, plain(name, 40), f"time from the begin of the ideal pulse ({clock})", f"acceleration ({unit})")
    axes.margins(x=0.0, y=0.08)
    return legend_below(figure)
