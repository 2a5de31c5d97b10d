"""Picture of a map: one quantity in colour, regimes hatched, when the object is back as lines, the case as a mark."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.base.declare import declarations
from strikewave.base.errors import InputError, nearest
from strikewave.base.result import Verdicts
from strikewave.reporting.faces import label_of
from strikewave.reporting.numbers import axis_unit, headed
from strikewave.reporting.style import BLUE, GREY, ORANGE, RED, mark_runs, put_below, quiet, sheet_title
from strikewave.studies.axes import plain_log_ticks
from strikewave.studies.map.cells import FAILED, NAMES, PERIOD_1, UNKNOWN, MapCell
from strikewave.studies.map.study import MapStudy

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

PANEL, MARGIN = (5.6, 4.6), (1.9, 1.5)
"""Size of a panel and what stands around all of them, inches."""
LABELLED = 0.02
"""A regime with this share of a panel is named in it: a smaller one has no room for its name."""
CONTRAST = (2, 98)
"""Percentiles of the values between which a logarithmic scale of colours goes: a few cells that barely scatter, or
wildly, would take the contrast from all others."""
HATCHES = ("", "//", "\\\\", "xx", "..", "oo", "", "")
"""Hatching of each regime, by code; failed cells are grey."""
DARK = "#222222"
LEVELS = (1.0, 2.0, 3.0)
"""Striking periods T after which the object is back on its stop, as lines: what comes later is no regular train."""
MARK_EDGE = {"markeredgecolor": "white", "markeredgewidth": 1.0}


COLOURS = (
    "cv", "cv_later", "peak", "first_peak", "largest_displacement", "stop_force", "train_time", "missed",
)  # fmt: skip
"""Fields of a cell that may be shown in colour."""
LOGARITHMIC = ("cv", "cv_later")
"""Fields of a cell that are shown on a logarithmic scale."""


CELL = "cell"
"""Name of a run in the legend."""
ACROSS, SMALLEST_MARK, LARGEST_MARK = 130.0, 1.5, 6.0
"""Points of a panel over the cells along it, a mark: half a cell of the panel's 260; and the ends between which marks
are seen and cover no neighbour."""


def colour_label(name: str) -> str:
    """Return what a field is called, with the unit in which it is shown."""
    declared = declarations(MapCell)[name]
    return headed(label_of(name, declared), declared.quantity.si, declared.quantity.usual)


def picture(study: MapStudy) -> Figure:
    """Draw a map: a panel for each value of the third setting, where there is one."""
    from matplotlib.figure import Figure

    colour = study.colour
    if colour not in COLOURS:
        raise InputError("--colour", colour, "a quantity of the map", nearest(colour, COLOURS))
    panels = study.plan.shape[0]
    size = (PANEL[0] * panels + MARGIN[0], PANEL[1] + MARGIN[1])
    figure = Figure(figsize=size, layout="constrained")
    every = figure.subplots(1, panels, squeeze=False, sharey=True)[0]
    values, norm = _shown(study.field(colour), colour)
    drawn = [_panel(axes, study, k, values[k], norm) for k, axes in enumerate(every)]
    bar = figure.colorbar(drawn[0], ax=list(every), pad=0.02, extend="both" if colour in LOGARITHMIC else "neither")
    bar.set_label(colour_label(colour))
    if colour in LOGARITHMIC:
        bar.ax.yaxis.set_major_formatter("{x:g}")
    _legend(figure, every[0], study)
    title = textwrap.shorten(f"{study.case.title or study.case.name}: {study.plan.blows} blows", 80 * panels)
    sheet_title(figure, title)
    return figure


def _shown(values: Array, colour: str) -> tuple[Array, Any]:
    """Return values in the unit in which they are shown, and the norm of their colours."""
    from matplotlib.colors import LogNorm, Normalize

    quantity = declarations(MapCell)[colour].quantity
    shown = values / axis_unit(quantity.si, quantity.usual)[0]
    known = shown[np.isfinite(shown)]
    if not known.size:
        return shown, Normalize(0.0, 1.0)
    if colour not in LOGARITHMIC:
        return shown, Normalize(float(known.min()), float(known.max()) + 1e-12)
    low, high = np.percentile(known[known > 0.0], CONTRAST) if np.any(known > 0.0) else (0.1, 1.0)
    return np.where(shown == 0.0, low, shown), LogNorm(float(low), max(float(high), 1.01 * float(low)))


def _panel(axes: Any, study: MapStudy, k: int, values: Array, norm: Any) -> Any:
    """Draw one panel and return what carries the colours."""
    x, y = (axis.shown(np.array(axis.values)) for axis in study.plan.axes[:2])
    axes.set_facecolor("#D9D9D9")
    drawn = axes.pcolormesh(x, y, np.ma.masked_invalid(values), norm=norm, cmap="cividis", shading="nearest")
    drawn.set_rasterized(True)
    scales, drawn_axes = (axes.set_xscale, axes.set_yscale), (axes.xaxis, axes.yaxis)
    for axis, scale, drawn_axis in zip(study.plan.axes[:2], scales, drawn_axes, strict=True):
        scale("log" if axis.log else "linear")
        if axis.log:
            plain_log_ticks(drawn_axis)
    _regimes(axes, study, k, x, y)
    _returns(axes, study, k, x, y)
    _broken(axes, study, k, x, y)
    _marks(axes, study, k)
    third = study.plan.axes[2] if len(study.plan.axes) > 2 else None
    title = "" if third is None else f"{third.label}: {third.shown(third.values[k]):.4g}"
    first = study.plan.axes[1]
    quiet(axes, title, study.plan.axes[0].label, first.label if k == 0 else "")
    axes.grid(False)
    return drawn


def _broken(axes: Any, study: MapStudy, k: int, x: Array, y: Array) -> None:
    """Mark the cells whose blows failed a check, or that failed."""
    panel = slice(k * x.size * y.size, (k + 1) * x.size * y.size)
    across, up = np.meshgrid(x, y)
    size = min(max(SMALLEST_MARK, ACROSS / max(x.size, y.size)), LARGEST_MARK)
    mark_runs(axes, across.ravel(), up.ravel(), Verdicts(study.verdicts.texts[panel]), CELL, size)


def _regimes(axes: Any, study: MapStudy, k: int, x: Array, y: Array) -> None:
    """Hatch and name the regimes of a panel; the first, period-1, stays plain."""
    from matplotlib import patheffects
    from scipy.ndimage import distance_transform_edt

    codes = study.field("regime")[k]
    for code, name in enumerate(NAMES):
        here = codes == code
        if not here.any() or code == UNKNOWN:
            continue
        if HATCHES[code]:
            filled = axes.contourf(x, y, here.astype(float), levels=[0.5, 1.5], colors="none", hatches=[HATCHES[code]])
            filled.set(edgecolor="white", linewidth=0.0)
        if here.mean() < LABELLED or code == PERIOD_1:
            continue
        inside = distance_transform_edt(np.pad(here, 1))[1:-1, 1:-1]
        row, column = np.unravel_index(int(np.argmax(inside)), inside.shape)
        text = axes.text(x[column], y[row], name, color=DARK, fontsize=9, ha="center", va="center", zorder=6)
        text.set_path_effects([patheffects.withStroke(linewidth=3, foreground="white")])


def _returns(axes: Any, study: MapStudy, k: int, x: Array, y: Array) -> None:
    """Draw where the object is back on its stop after whole striking periods: first return, and after one bounce."""
    from matplotlib import patheffects

    for name, style in (("return_ratio", "solid"), ("bounce_ratio", "dashed")):
        ratio = np.ma.masked_invalid(study.field(name)[k])
        levels = [level for level in LEVELS if ratio.count() and ratio.min() < level < ratio.max()]
        if levels:
            lines = axes.contour(x, y, ratio, levels=levels, colors="white", linestyles=style, linewidths=1.6)
            for text in axes.clabel(lines, fmt=lambda level: f"{level:g} T", fontsize=9, colors="white"):
                text.set_path_effects([patheffects.withStroke(linewidth=2, foreground=DARK)])


def _marks(axes: Any, study: MapStudy, k: int) -> None:
    """Mark the case, the range of what is assumed of it, and the nearest even setting."""
    plan, here = study.plan, study.here
    at = [axis.shown(value) for axis, value in zip(plan.axes, here, strict=True)]
    nearest_panel = 0 if len(plan.axes) < 3 else int(np.argmin(np.abs(np.array(plan.axes[2].values) - here[2])))
    limits = axes.get_xlim(), axes.get_ylim()
    if k == nearest_panel:
        for which, axis in enumerate(plan.axes[:2]):
            ends = study.over_range(axis.path)
            if ends is not None:
                line = [[at[0], at[0]], [at[1], at[1]]]
                line[which] = [axis.shown(end) for end in ends]
                axes.plot(*line, color=RED, linewidth=2.2, solid_capstyle="butt", zorder=4)
        axes.plot(at[0], at[1], "*", color=RED, markersize=15, zorder=5, **MARK_EDGE)
    setting = study.setting
    if setting is not None and (len(plan.axes) < 3 or setting.values[2] == plan.axes[2].values[k]):
        x, y = (axis.shown(value) for axis, value in zip(plan.axes[:2], setting.values[:2], strict=True))
        axes.plot(x, y, "D", color=BLUE, markersize=8, zorder=5, **MARK_EDGE)
    axes.set_xlim(*limits[0])
    axes.set_ylim(*limits[1])


def _legend(figure: Figure, axes: Any, study: MapStudy) -> None:
    """Explain marks, lines and hatches below the axes."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    empty: dict[str, Any] = {"linestyle": "none"}
    handles: list[Any] = [Line2D([], [], marker="*", color=RED, markersize=12, label=f"{study.case.name}", **empty)]
    doubted = [axis.path for axis in study.plan.axes[:2] if study.over_range(axis.path) is not None]
    if doubted:
        names = " and ".join(doubted)
        handles.append(Line2D([], [], color=RED, linewidth=2.2, label=f"{names} assumed: half to twice"))
    if study.setting is not None:
        label = f"nearest with CV within {100.0 * study.wanted:g} %"
        handles.append(Line2D([], [], marker="D", color=BLUE, label=label, **empty))
    style: Any
    for name, style, label in (
        ("return_ratio", "solid", "back on the stop after k striking periods T"),
        ("bounce_ratio", "dashed", "back after one bounce"),
    ):
        ratio = study.field(name)
        if np.isfinite(ratio).any() and any(np.nanmin(ratio) < level < np.nanmax(ratio) for level in LEVELS):
            handles.append(Line2D([], [], color=GREY, linestyle=style, linewidth=1.6, label=f"{label} (white)"))
    marks = {line.get_label(): line for part in figure.axes for line in part.get_lines()}
    handles += [line for label, line in marks.items() if str(label).startswith(f"{CELL} ")]
    for name in study.shares:
        code = NAMES.index(name)
        if HATCHES[code]:
            handles.append(Patch(facecolor="#7A7A7A", edgecolor="white", hatch=HATCHES[code], label=name))
        elif code == FAILED:
            handles.append(Patch(facecolor="#D9D9D9", edgecolor=ORANGE, label="no result, or no regime"))
    if NAMES[PERIOD_1] in study.shares:
        handles.append(Patch(facecolor="none", edgecolor=GREY, label="plain: period-1"))
    put_below(figure, handles, [str(handle.get_label()) for handle in handles])
