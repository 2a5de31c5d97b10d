"""The picture of a design: its runs over two goals and over two settings, and margins of the ranked settings."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.reporting.style import BLUE, GREY, ORANGE, RED, legend_below, mark_runs, quiet, sheet_title
from strikewave.studies.axes import plain_log_ticks
from strikewave.studies.design.study import DesignStudy

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

WIDTH, HEIGHT, BAR = 9.0, 3.9, 0.3
"""Of the picture, of its upper row, and of a bar of a margin, inches."""
MOST_BARS = 8
"""Goals whose margins are drawn: the first ones."""
SHOWN = (1.0, 99.0)
"""Percentiles of the runs between which axes reach, widened to all limits and ranked settings: early runs of a search
lie far off."""


def design_picture(study: DesignStudy) -> Figure:
    """Draw the runs over the numbers of two goals, over two settings, and the margins of the ranked settings."""
    from matplotlib.figure import Figure

    bars = min(sum(not goal.is_check for goal in study.plan.goals), MOST_BARS)
    lower = 0.9 + BAR * max(bars, 1) * 1.6
    figure = Figure(figsize=(WIDTH, HEIGHT + (lower if bars else 0.0)), layout="constrained")
    sheet_title(figure, f"{study.case.name or 'case'}: {len(study.rows)} runs, {study.met} meet all goals")
    grid = figure.add_gridspec(2 if bars else 1, 2, height_ratios=[HEIGHT, lower] if bars else None)
    _numbers(figure.add_subplot(grid[0, 0]), study)
    _settings(figure.add_subplot(grid[0, 1]), study)
    if bars:
        _margins(figure.add_subplot(grid[1, :]), study, bars)
    return legend_below(figure)


def drawn_numbers(study: DesignStudy) -> list[str]:
    """Return the names of the two numbers that runs are drawn over: of goals that exclude each other, or the first."""
    first = [one.goal.number for one in study.conflict.reaches] if study.conflict is not None else []
    names = [*first, *(one.number for one in study.plan.objectives), *(one.number for one in study.plan.goals)]
    return list(dict.fromkeys(names))[:2]


def _numbers(axes: Any, study: DesignStudy) -> None:
    """Draw runs over two numbers, with the area in which both goals are met; over their order where there is one."""
    names = drawn_numbers(study)
    kept = [study.kept(name) for name in names]
    columns = [study.numbers[:, study.plan.evaluation.names.index(name)] / study.kept(name).scale for name in names]
    order = np.arange(1.0, len(study.rows) + 1.0)
    x, y = columns if len(columns) == 2 else (order, columns[0])
    _dots(axes, study, x, y, legend=True)
    labels = [one.label for one in kept] if len(kept) == 2 else ["run", kept[0].label]
    quiet(axes, "Runs by their numbers", *labels)
    of_axes = list(zip(names, (axes.axvspan, axes.axhspan), (x, y), "xy", strict=False))
    for name, span, values, which in of_axes if len(names) == 2 else [(names[0], axes.axhspan, y, "y")]:
        goal = study.plan.goal_of(name)
        low, high = _extent(study, values, name)
        if goal is not None and low < high:
            span(max(goal.low / study.kept(name).scale, low), min(goal.high / study.kept(name).scale, high), **AREA)
        if low < high:
            (axes.set_xlim if which == "x" else axes.set_ylim)(low, high)


AREA = {"color": BLUE, "alpha": 0.12, "linewidth": 0.0, "zorder": 0}
"""How the area in which a goal is met is drawn."""


def _extent(study: DesignStudy, values: Array, name: str) -> tuple[float, float]:
    """Return between what an axis reaches; see `SHOWN`."""
    known = values[np.isfinite(values)]
    if not known.size:
        return 0.0, 0.0
    ends = list(np.percentile(known, SHOWN)) + [float(values[one.run]) for one in study.candidates]
    goal = study.plan.goal_of(name)
    if goal is not None:
        ends += [limit / study.kept(name).scale for limit in (goal.low, goal.high) if math.isfinite(limit)]
    ends = [end for end in ends if math.isfinite(end)]
    room = 0.05 * (max(ends) - min(ends))
    return min(ends) - room, max(ends) + room


def _settings(axes: Any, study: DesignStudy) -> None:
    """Draw runs over the first two settings; over their order where there is one alone."""
    variables = study.plan.variables[:2]
    columns = [
        study.settings[:, k] if one.words else np.asarray(one.axis.shown(study.settings[:, k]))
        for k, one in enumerate(variables)
    ]
    order = np.arange(1.0, len(study.rows) + 1.0)
    x, y = columns if len(columns) == 2 else (order, columns[0])
    _dots(axes, study, x, y)
    labels = [one.label for one in variables] if len(variables) == 2 else ["run", variables[0].label]
    quiet(axes, "Runs by their settings", *labels)
    pairs = zip(variables, "xy" if len(variables) == 2 else "y", strict=True)
    for one, which in pairs:
        axis = axes.xaxis if which == "x" else axes.yaxis
        if one.words:
            axis.set_ticks(range(len(one.words)), list(one.words), fontsize=8)
        elif one.axis.log:
            (axes.set_xscale if which == "x" else axes.set_yscale)("log")
            plain_log_ticks(axis)


def _dots(axes: Any, study: DesignStudy, x: Array, y: Array, legend: bool = False) -> None:
    """Draw runs that miss a goal, that meet all, that are Pareto-optimal, and the ranked ones with their places."""

    def label(words: str) -> str:
        return words if legend else "_"

    met = study.margins >= 0.0
    dots = [axes.plot(x[~met], y[~met], ".", color=GREY, markersize=4, alpha=0.5, label=label("a goal is missed"))[0]]
    if met.any():
        dots += axes.plot(x[met], y[met], ".", color=BLUE, markersize=5, alpha=0.7, label=label("all goals met"))
    for one in dots:
        one.set_rasterized(True)
    mark_runs(axes, x, y, study.verdicts, size=5.0)
    if study.front:
        places = list(study.front)
        axes.plot(x[places], y[places], "o", color=RED, markersize=4, fillstyle="none", label=label("Pareto-optimal"))
    runs = [one.run for one in study.candidates]
    axes.plot(x[runs], y[runs], "D", color=ORANGE, markersize=6, label=label("ranked"), zorder=4)
    for place, run in enumerate(runs, 1):
        if math.isfinite(x[run]) and math.isfinite(y[run]):
            axes.annotate(str(place), (x[run], y[run]), (5, 4), textcoords="offset points", fontsize=8, zorder=5)


def _margins(axes: Any, study: DesignStudy, count: int) -> None:
    """Draw the margin of each goal at the first setting as a bar, those of the others as dots."""
    first = study.candidates[0]
    goals = study.plan.goals[:count]
    places = np.arange(count, dtype=float)[::-1]
    shares = 100.0 * first.shares[:count]
    colours = [BLUE if share >= 0.0 else RED for share in shares]
    axes.barh(places, np.nan_to_num(shares), height=0.5, color=colours, alpha=0.75)
    for one in study.candidates[1:]:
        axes.plot(100.0 * one.shares[:count], places, "D", color=ORANGE, markersize=3.5, alpha=0.8)
    if first.verified is not None:
        axes.plot(100.0 * first.verified[:count], places, "|", color="black", markersize=14)
    axes.set_yticks(places, [goal.typed for goal in goals], fontsize=8)
    axes.axvline(0.0, color="black", linewidth=0.8)
    quiet(axes, "Margins: bar, the first setting; line, its verification; dots, the others", "margin (%)", "")
