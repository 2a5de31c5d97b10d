"""The pictures of a reproduced paper: computed numbers as curves, published ones as marks.

Only numbers are published: a peak is a level and a width is a bar, each with the word that names its source.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.texts import percent
from strikewave.papers.li_ma_2019.equations import EQUAL
from strikewave.papers.li_ma_2019.published import published_number
from strikewave.papers.li_ma_2019.unknowns import GasketStudy, JointStudy
from strikewave.reporting.style import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    RED,
    WHOLE,
    Trace,
    figure_with_axes,
    new_figure,
    put_legend,
    quiet,
    thin,
)
from strikewave.waves.li_ma import EXACT, arrivals, specimen_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strikewave.analyses.machine.result import Solution
    from strikewave.analyses.wave.result import WaveSolution

Array = NDArray[np.float64]

INKS = {"measured": RED, "LS-DYNA": "#4d5760"}
"""Colour of a mark by the source of its number."""
STROKES = {"measured": (0, (5, 2)), "LS-DYNA": (0, (1, 1.5))}
"""Dashes of a mark by the source of its number."""
ROLES = {"fitted": (RED, "D"), "predicted": (BLUE, "o"), "range": (ORANGE, "|"), "shown": (GREY, "s")}
"""Colour and shape of a number by its role."""
CURVES = ((BLUE, "-"), (ORANGE, "-"), (GREEN, "--"), (GREEN, "-"))
"""Colour and dashes of the first curves of a panel."""
DIRECT, BUFFERED = BLUE, ORANGE
"""Colours of the two sensors of Figure 5."""
TWO_ROWS = (9.8, 6.2)
"""Size of a figure of two rows, inches."""


class PublishedMark(NamedTuple):
    """A published number in a picture: peak (m/s^2), source ("measured", "LS-DYNA"), width (s) for a bar, remark."""

    value: float
    origin: str
    width: float | None = None
    what: str = ""

    @property
    def label(self) -> str:
        """Text beside the level."""
        peak = f"{self.origin} {self.value / STANDARD_GRAVITY:,.7g} g".replace(",", " ", 1)
        return f"{peak}, {self.what}" if self.what else peak

    @property
    def width_label(self) -> str:
        """Text beside the bar of the width."""
        return "" if self.width is None else f"{self.origin} {self.width * 1e6:g} µs"


class Ratio(NamedTuple):
    """A computed number over the published one: its label, the ratio and its role; ends of a range, less one."""

    label: str
    value: float
    role: str
    ends: tuple[float, float] | None = None


def ratio_figure(rows: Sequence[Ratio]) -> Figure:
    """Draw how far computed numbers are from the published ones; equal is 1."""
    figure, axes = figure_with_axes((9.8, 1.0 + 0.21 * len(rows)))
    for k, row in enumerate(rows):
        if row.ends is not None:
            axes.hlines(k, 1.0 + row.ends[0], 1.0 + row.ends[1], color=ROLES["range"][0], linewidth=7.0, alpha=0.6)
    for role, (colour, shape) in ROLES.items():
        points = [(row.value, k) for k, row in enumerate(rows) if row.role == role]
        if points:
            x, y = zip(*points, strict=True)
            if role != "range":
                axes.hlines(y, 1.0, x, color=colour, linewidth=1.1)
            axes.plot(x, y, shape, color=colour, markersize=6 if role != "range" else 10, label=role)
    for k, row in enumerate(rows):
        # labels stand on the side away from 1, where no line runs
        right = row.value >= 1.0 or row.ends is not None
        label = "0 %" if abs(row.value - 1.0) < EQUAL else f"{100.0 * (row.value - 1.0):+.3g} %"
        if row.ends is not None:
            label = " to ".join(f"{100.0 * end:+.3g} %" for end in row.ends)
        axes.annotate(
            label,
            (row.value if row.ends is None else 1.0 + row.ends[1], k),
            xytext=(8 if right else -8, 0),
            textcoords="offset points",
            ha="left" if right else "right",
            va="center",
            fontsize=8,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.4},
        )
    axes.axvline(1.0, color=GREY, linewidth=0.9)
    axes.set_xscale("log")
    values = [row.value for row in rows] + [1.0 + end for row in rows for end in row.ends or ()] or [1.0]
    axes.set_xlim(min(0.6, 0.75 * min(values)), max(1.7, 1.35 * max(values)))
    ticks = [
        t
        for t in (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)
        if axes.get_xlim()[0] <= t <= axes.get_xlim()[1]
    ]
    quiet(axes, "Computed over published", "computed / published; 1 is equal", "")
    axes.set_xlim(min(0.6, 0.75 * min(values)), max(1.7, 1.6 * max(values)))
    axes.set_xticks(ticks, [f"{t:g}" for t in ticks])
    # a logarithmic axis would number its minor ticks over the chosen ones
    axes.minorticks_off()
    axes.set_yticks(range(len(rows)), [row.label for row in rows], fontsize=8.5)
    axes.set_ylim(len(rows) - 0.4, -0.6)
    put_legend(axes)
    return figure


def sensors_figure(solution: Solution, direct: PublishedMark, buffered: PublishedMark) -> Figure:
    """Draw what a directly mounted and a buffered sensor read: all blows, and the first one (Figure 5)."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=TWO_ROWS, layout="constrained")
    train, first = figure.subplots(2, 1)
    for k, (name, colour) in enumerate((("direct", DIRECT), ("buffered", BUFFERED))):
        readings = reading_traces(solution, name)
        for reading in readings:
            time, values = thin(reading.time, reading.values)
            train.plot(time * 1e3, values / STANDARD_GRAVITY, color=colour, linewidth=0.8, zorder=3 + k)
        if readings:
            label = f"computed, {name}"
            first.plot(readings[0].time * 1e6, readings[0].values / STANDARD_GRAVITY, color=colour, label=label)
    for axes in (train, first):
        draw_levels(axes, (direct, buffered), (DIRECT, BUFFERED))
    quiet(train, "All blows", "time after first touch (ms)", "acceleration (g)")
    quiet(first, "First blow", "time after first touch (µs)", "acceleration (g)")
    train.margins(x=0.01)
    _headroom(train, first)
    put_legend(first)
    return figure


def reading_traces(solution: Solution, sensor: str) -> list[Trace]:
    """Return the readings of a sensor in each blow that touched: s after the first touch of the first one, m/s^2."""
    names = [row.name for row in solution.case.sensor]
    key = f"reading_{names.index(sensor) + 1}"
    values, starts = solution.arrays[key], solution.arrays[f"{key}_start"].values
    struck = [k for k, blow in enumerate(solution.blows) if blow.kind != "missed"]
    traces = []
    for row in struck:
        reading = values.values[row]
        reading = reading[np.isfinite(reading)]
        since = solution.blows[row].time - solution.blows[struck[0]].time + float(starts[row])
        traces.append(Trace(sensor, since + float(values.attrs["step"]) * np.arange(reading.size), reading))
    return traces


def passing_figure(solution: WaveSolution, tap: int = 0) -> Figure:
    """Draw the multiple reflections of a wave in a layer, and the force at a place in it by three routes (Figure 7).

    On the left the way of the wave, with the instants at which it passes the place: as it must be (filled) and as the
    paper's equations print it (open). On the right the force there under a steep front.
    """
    from matplotlib.figure import Figure

    place = solution.taps[tap][1]
    sandwich = specimen_of(solution.run.stack, place.layer)
    assert sandwich is not None
    figure = Figure(figsize=WHOLE, layout="constrained")
    way, force = figure.subplots(1, 2, width_ratios=(1.0, 1.7))
    x = place.position
    steps = np.arange(7.0)
    way.plot(steps % 2, steps, color=BLUE, linewidth=1.3)
    true, printed = (
        np.array([wave.transits for wave in arrivals(sandwich, x, 6, route)]) for route in ("corrected", "as printed")
    )
    way.plot(np.full(6, x), x + true, "o", color=BLUE, label="exact", zorder=4)
    way.plot(np.full(6, x), x + printed, "s", color=RED, fillstyle="none", label="as printed", zorder=4, markersize=8)
    way.axvline(x, color=GREY, linewidth=0.8, linestyle=":")
    quiet(way, "Way of the wave", "place x / l", "time / t₀, from interface I")
    way.set_xticks([0.0, x, 1.0], ["0 (I)", f"{x:g}", "1 (II)"])
    way.margins(x=0.08)
    put_legend(way)
    transit = sandwich.transit
    layers = solution.run.stack.layers
    arrival = sum(layer.transit for layer in layers[: place.layer]) + x * layers[place.layer].transit
    since = (solution.run.time - arrival) / transit
    shown = (since >= -0.5) & (since <= 6.0)
    scale = float(np.abs(solution.run.face_force).max())
    styles = {EXACT: (BLUE, "-", 1.6), "corrected": (GREEN, "--", 1.6), "as printed": (RED, "-.", 1.4)}
    for route, (colour, stroke, width) in styles.items():
        history = solution.by_route(tap, route)
        if history is not None:
            label = "exact, this stack" if route == EXACT else f"paper's route, {route}"
            time, values = thin(since[shown], history.force[shown] / scale)
            force.plot(time, values, stroke, color=colour, linewidth=width, label=label)
    quiet(force, f"Force at x = {x:g} l", f"time since the first arrival / t₀ = {transit * 1e6:.4g} µs", "force / load")
    force.set_ylim(bottom=0.0)
    force.legend(frameon=False, fontsize=8, loc="lower right")
    return figure


def train_figure(machine: Solution, equal: Solution, typical: PublishedMark) -> Figure:
    """Draw the rigid-body pulses of a train, and their peaks beside those of a machine with equal blows (Figure 9)."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=WHOLE, layout="constrained")
    train, peaks = figure.subplots(1, 2, width_ratios=(2.3, 1.0), sharey=True)
    begun = machine.blows[0].time
    time, values = thin(machine.arrays["time"].values - begun, machine.arrays["rigid_acceleration"].values)
    train.plot(time * 1e3, values / STANDARD_GRAVITY, color=BLUE, linewidth=0.8)
    train.plot(
        [(blow.time - begun) * 1e3 for blow in machine.blows],
        [blow.rigid_peak / STANDARD_GRAVITY for blow in machine.blows],
        "o",
        color=BLUE,
        markersize=3.5,
    )
    draw_levels(train, (typical,))
    quiet(train, "Rigid-body acceleration, all blows", "time after first touch (ms)", "acceleration (g)")
    train.set_xlim(-10.0, (machine.blows[-1].time - begun) * 1e3 + 15.0)
    for solution, colour, shape, label in ((machine, BLUE, "o", "this machine"), (equal, GREEN, "^", "equal blows")):
        index = [blow.index for blow in solution.blows]
        peaks.plot(
            index,
            [blow.rigid_peak / STANDARD_GRAVITY for blow in solution.blows],
            f"{shape}-",
            color=colour,
            markersize=4,
            linewidth=0.8,
            label=label,
        )
    quiet(peaks, "Peak by blow", "blow", "")
    peaks.axhline(typical.value / STANDARD_GRAVITY, color=INKS[typical.origin], linewidth=1.0, linestyle=(0, (5, 2)))
    peaks.margins(x=0.06)
    peaks.set_xticks([blow.index for blow in machine.blows][::2])
    peaks.legend(frameon=False, fontsize=8, loc="lower right")
    _headroom(train)
    return figure


def pulse_figure(
    title: str, curves: Sequence[Trace], marks: Sequence[PublishedMark], until: float | None = None
) -> Figure:
    """Draw computed pulses with the marks of published ones (Figures 11 and 15), up to ``until`` in s.

    Traces have s after first touch and m/s^2; no curve gives a picture of the marks alone.
    """
    figure, axes = figure_with_axes(WHOLE)
    for (colour, stroke), curve in zip(CURVES[: len(curves)], curves, strict=True):
        time, values = thin(curve.time, curve.values)
        axes.plot(time * 1e6, values / STANDARD_GRAVITY, stroke, color=colour, linewidth=1.4, label=curve.label)
    draw_levels(axes, marks)
    draw_widths(axes, marks)
    quiet(axes, title, "time after first touch (µs)", "acceleration (g)")
    last = until or max((float(curve.time[-1]) for curve in curves), default=4e-4)
    axes.set_xlim(0.0, last * 1e6)
    _headroom(axes)
    if curves:
        put_legend(axes)
    return figure


def fixture_figure(solution: Solution, sensor: str, marks: Sequence[PublishedMark]) -> Figure:
    """Draw what the sensor between two cylinders reads: all blows, and the first one (Figure 13)."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=TWO_ROWS, layout="constrained")
    train, first = figure.subplots(2, 1)
    readings = reading_traces(solution, sensor)
    for reading in readings:
        time, values = thin(reading.time, reading.values)
        train.plot(time * 1e3, values / STANDARD_GRAVITY, color=BLUE, linewidth=0.8)
    if readings:
        time, values = thin(readings[0].time, readings[0].values)
        first.plot(time * 1e6, values / STANDARD_GRAVITY, color=BLUE, linewidth=1.3, label="computed")
    draw_levels(train, marks)
    draw_levels(first, marks)
    draw_widths(first, marks)
    quiet(train, "All blows", "time after first touch (ms)", "acceleration (g)")
    quiet(first, "First blow", "time after first touch (µs)", "acceleration (g)")
    train.margins(x=0.01)
    first.set_xlim(0.0, 6e2)
    _headroom(train, first)
    put_legend(first)
    return figure


def front_figure(solution: WaveSolution, marks: Sequence[PublishedMark]) -> Figure:
    """Draw the acceleration at the taps of a bar under a steep front, with the levels of published peaks."""
    figure, axes = figure_with_axes(WHOLE)
    for k, ((name, _), (colour, stroke)) in enumerate(zip(solution.taps, CURVES[: len(solution.taps)], strict=True)):
        time, values = thin(solution.run.time, solution.run.acceleration[:, k])
        axes.plot(time * 1e6, values / STANDARD_GRAVITY, stroke, color=colour, linewidth=1.1, label=f"computed, {name}")
    draw_levels(axes, marks)
    quiet(axes, "A bar alone under a front of 5 µs", "time after the start of the load (µs)", "acceleration (g)")
    axes.set_xlim(0.0, 60.0)
    _headroom(axes)
    put_legend(axes)
    return figure


def draw_levels(axes: Any, marks: Sequence[PublishedMark], colours: Sequence[str] = ()) -> None:
    """Draw published peaks as levels across the axes, labelled above the highest and below the others."""
    highest = max((mark.value for mark in marks), default=0.0)
    for k, mark in enumerate(marks):
        ink, height, above = INKS[mark.origin], mark.value / STANDARD_GRAVITY, mark.value == highest
        axes.axhline(height, color=colours[k] if colours else ink, linewidth=1.2, linestyle=STROKES[mark.origin])
        axes.annotate(
            mark.label,
            (1.0, height),
            xycoords=("axes fraction", "data"),
            xytext=(-3, 2 if above else -2),
            textcoords="offset points",
            ha="right",
            va="bottom" if above else "top",
            fontsize=8,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.6},
            zorder=6,
        )


def draw_widths(axes: Any, marks: Sequence[PublishedMark]) -> None:
    """Draw published widths as labelled bars, the first at a tenth of its peak, the next ones below."""
    wide = [mark for mark in marks if mark.width is not None]
    for k, mark in enumerate(wide):
        height, end = (0.1 - 0.07 * k) * mark.value / STANDARD_GRAVITY, 1e6 * (mark.width or 0.0)
        axes.plot([0.0, end], [height] * 2, "|-", color=INKS[mark.origin], linewidth=1.6, markersize=9, zorder=5)
        axes.annotate(
            mark.width_label,
            (end, height),
            xytext=(4, 4 if k == 0 else -4 - 10 * (k - 1)),
            textcoords="offset points",
            ha="left",
            va="bottom" if k == 0 else "top",
            fontsize=8,
            color=INKS[mark.origin],
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.4},
            zorder=6,
        )


def _headroom(*all_axes: Any) -> None:
    """Leave room above the highest level for its label."""
    for axes in all_axes:
        low, high = axes.get_ylim()
        axes.set_ylim(low, high + 0.1 * (high - low))


COLUMN, ROW, BESIDE, MARGIN = 0.36, 0.42, 0.2, 1.2
"""Width of a column and height of a row of cells, margin beside each panel and beside all of them, inches."""
LEAST_HEIGHT = 3.1
"""Height of a map with few rows, inches."""
NEAR = 0.1
"""Relative difference from the published number up to which a cell is framed: the paper's good consistency."""
LIGHT = 0.55
"""Place on the scale of colours from which letters are dark: cividis is then light enough."""
NUMBERED = 40
"""Columns of all panels up to which cells carry their numbers: of more, a number is wider than its cell."""
TICKED = 8
"""Columns of a panel up to which each has its label; of more, every second one."""
HATCH = "///"
"""Hatching of cells that contradict the paper otherwise."""


def gasket_figure(study: GasketStudy) -> Figure:
    """Draw the direct peak over modulus and loss, a panel for each thickness; hatched where the pulse is not calmed."""
    from matplotlib.colors import LogNorm

    moduli, losses, thicknesses = study.grid
    peaks = np.abs(study.field("direct")) / STANDARD_GRAVITY / 1e3
    calm, published = study.field("calm") > 0.0, published_number("direct peak").value / STANDARD_GRAVITY / 1e3
    numbered, every_so_many = len(moduli) * len(thicknesses) <= NUMBERED, 1 if len(moduli) <= TICKED else 2
    labels = [np.format_float_positional(modulus / 1e6, 3, fractional=False, trim="-") for modulus in moduli]
    shown = range(0, len(moduli), every_so_many)
    width = (COLUMN * len(moduli) + BESIDE) * len(thicknesses) + MARGIN
    figure = new_figure((width, max(LEAST_HEIGHT, 1.7 + ROW * len(losses))))
    norm = LogNorm(float(np.nanmin(peaks)), 1.01 * float(np.nanmax(peaks)))
    every = figure.subplots(1, len(thicknesses), squeeze=False, sharey=True)[0]
    for axes, panel, quiet_cells, thickness in zip(every, peaks, calm, thicknesses, strict=True):
        drawn = _cells(axes, panel, norm, published, ~quiet_cells, numbered)
        axes.set_title(f"{thickness * 1e3:g} mm thick", loc="left", fontsize=10)
        axes.set_xticks(shown, [labels[k] for k in shown], fontsize=8)
        axes.set_xlabel("modulus of the gasket (MPa)")
    every[0].set_yticks(range(len(losses)), [f"{loss:g}" for loss in losses], fontsize=8)
    every[0].set_ylabel("loss factor (1)")
    _bar(figure, drawn, list(every), "direct peak (1000 g)")
    _key(figure, published, "the buffered sensor rings more than the direct one", "no engagement up to 18 mm")
    return figure


def joint_figure(study: JointStudy) -> Figure:
    """Draw the sensor's peak over stiffness of the faces and preload; hatched where the rigid pulse is not kept."""
    from matplotlib.colors import LogNorm

    peaks = study.field("peak") / STANDARD_GRAVITY / 1e3
    kept_pulse = np.array([cell.blow.keeps(study.assumed) for cell in study.cells]).reshape(peaks.shape)
    published = published_number("wave peak").value / STANDARD_GRAVITY / 1e3
    figure = new_figure((9.8, max(LEAST_HEIGHT, 1.8 + 0.8 * ROW * len(study.grid.preloads))))
    axes = figure.add_subplot()
    norm = LogNorm(float(np.nanmin(peaks)), 1.01 * float(np.nanmax(peaks)))
    drawn = _cells(axes, peaks, norm, published, ~kept_pulse)
    stiffnesses = [f"{k / 1e9:.3g}" if math.isfinite(k) else "rigid" for k in study.grid.stiffnesses]
    axes.set_xticks(range(len(stiffnesses)), stiffnesses, fontsize=8)
    axes.set_yticks(range(len(study.grid.preloads)), [f"{preload:g}" for preload in study.grid.preloads], fontsize=8)
    axes.set_xlabel("stiffness of the faces of each joint (GN/m)")
    axes.set_ylabel("preload of each joint (N)")
    _bar(figure, drawn, [axes], "peak of the sensor (1000 g)")
    _key(figure, published, "rigid pulse not kept within 5 %", "")
    return figure


def _cells(axes: Any, values: Array, norm: Any, published: float, odd: NDArray[np.bool_], numbered: bool = True) -> Any:
    """Draw cells with their numbers; those near the published one framed, odd ones hatched, unknown ones grey."""
    from matplotlib.patches import Rectangle

    axes.set_facecolor("#D9D9D9")
    drawn = axes.pcolormesh(
        np.arange(values.shape[1]), np.arange(values.shape[0]), np.ma.masked_invalid(values), norm=norm, cmap="cividis"
    )
    for (row, column), value in np.ndenumerate(values):
        if not math.isfinite(value):
            continue
        corner, dark = (column - 0.5, row - 0.5), norm(value) > LIGHT
        ink = "black" if dark else "white"
        if odd[row, column]:
            axes.add_patch(Rectangle(corner, 1, 1, fill=False, hatch=HATCH, edgecolor=GREY, linewidth=0.0))
        if abs(value / published - 1.0) <= NEAR:
            axes.add_patch(Rectangle(corner, 1, 1, fill=False, edgecolor=RED, linewidth=2.0, zorder=4))
        if not numbered:
            continue
        box = {"facecolor": drawn.cmap(norm(value)), "edgecolor": "none", "pad": 0.8}
        axes.text(column, row, f"{value:.3g}", ha="center", va="center", fontsize=7.5, color=ink, bbox=box)
    axes.spines[["top", "right"]].set_visible(False)
    return drawn


def _bar(figure: Figure, drawn: Any, axes: list[Any], label: str) -> None:
    bar = figure.colorbar(drawn, ax=axes, pad=0.02)
    bar.set_label(label)
    ticks = [tick for tick in (1, 2, 5, 10, 20, 50, 100, 200) if drawn.norm.vmin <= tick <= drawn.norm.vmax]
    bar.set_ticks(ticks, labels=[f"{tick:g}" for tick in ticks])
    bar.ax.minorticks_off()


def _key(figure: Figure, published: float, odd: str, unknown: str) -> None:
    from matplotlib.patches import Patch

    near = f"within {percent(NEAR, 0)} of the measured {published:.4g} (1000 g)"
    patches = [
        Patch(fill=False, edgecolor=RED, linewidth=2.0, label=near),
        Patch(fill=False, hatch=HATCH, edgecolor=GREY, linewidth=0.0, label=odd),
    ]
    if unknown:
        patches.append(Patch(facecolor="#D9D9D9", label=unknown))
    figure.legend(handles=patches, loc="outside lower left", ncols=3, frameon=False, fontsize=8)
