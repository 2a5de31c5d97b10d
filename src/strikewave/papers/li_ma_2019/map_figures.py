"""Pictures of the maps over what is not published: gaskets of Figure 5, joints of Figure 13."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.percents import percent
from strikewave.papers.li_ma_2019.gaskets import GasketStudy
from strikewave.papers.li_ma_2019.joints import JointStudy
from strikewave.papers.li_ma_2019.published import published_number
from strikewave.reporting.style import GREY, RED, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

COLUMN, ROW, BESIDE, MARGIN = 0.36, 0.42, 0.2, 1.2
"""Width of a column and height of a row of cells, what stands beside each panel and beside all of them, inches."""
LEAST_HEIGHT = 3.1
"""Height of a map with few rows, inches."""
NEAR = 0.1
"""A cell within a tenth of the published number is framed: what the paper calls good consistency."""
LIGHT = 0.55
"""Place on the scale of colours from which on letters are dark: those of cividis are then light enough."""
NUMBERED = 40
"""Columns of all panels up to which cells carry their numbers: of more, a number is wider than its cell."""
TICKED = 8
"""Columns of a panel up to which each has its label; of more, every second one."""
HATCH = "///"
"""Of cells that contradict the paper otherwise."""


def gasket_figure(study: GasketStudy) -> Figure:
    """Draw the direct peak over modulus and loss, a panel for each thickness; hatched where the pulse is not calmed."""
    moduli, losses, thicknesses = study.grid
    peaks = np.abs(study.field("direct")) / STANDARD_GRAVITY / 1e3
    calm, published = study.field("calm") > 0.0, published_number("direct peak").value / STANDARD_GRAVITY / 1e3
    numbered, every_so_many = len(moduli) * len(thicknesses) <= NUMBERED, 1 if len(moduli) <= TICKED else 2
    shown = range(0, len(moduli), every_so_many)
    width = (COLUMN * len(moduli) + BESIDE) * len(thicknesses) + MARGIN
    size = (width, max(LEAST_HEIGHT, 1.7 + ROW * len(losses)))
    figure = new_figure(size)
    every = figure.subplots(1, len(thicknesses), squeeze=False, sharey=True)[0]
    for axes, panel, quiet_cells, thickness in zip(every, peaks, calm, thicknesses, strict=True):
        drawn = _cells(axes, panel, _norm(peaks), published, ~quiet_cells, numbered)
        axes.set_title(f"{thickness * 1e3:g} mm thick", loc="left", fontsize=10)
        axes.set_xticks(shown, [_plain(moduli[k] / 1e6) for k in shown], fontsize=8)
        axes.set_xlabel("modulus of the gasket (MPa)")
    every[0].set_yticks(range(len(losses)), [f"{loss:g}" for loss in losses], fontsize=8)
    every[0].set_ylabel("loss factor (1)")
    _bar(figure, drawn, list(every), "direct peak (1000 g)")
    _key(figure, published, "the buffered sensor rings more than the direct one", "no engagement up to 18 mm")
    return figure


def joint_figure(study: JointStudy) -> Figure:
    """Draw the sensor's peak over stiffness of the faces and preload; hatched where the rigid pulse is not kept."""
    peaks = study.field("peak") / STANDARD_GRAVITY / 1e3
    kept = np.array([cell.blow.keeps(study.assumed) for cell in study.cells]).reshape(peaks.shape)
    published = published_number("wave peak").value / STANDARD_GRAVITY / 1e3
    figure = new_figure((9.8, max(LEAST_HEIGHT, 1.8 + 0.8 * ROW * len(study.grid.preloads))))
    axes = figure.add_subplot()
    drawn = _cells(axes, peaks, _norm(peaks), published, ~kept)
    stiffnesses = [f"{one / 1e9:.3g}" if math.isfinite(one) else "rigid" for one in study.grid.stiffnesses]
    axes.set_xticks(range(len(stiffnesses)), stiffnesses, fontsize=8)
    axes.set_yticks(range(len(study.grid.preloads)), [f"{one:g}" for one in study.grid.preloads], fontsize=8)
    axes.set_xlabel("stiffness of the faces of each joint (GN/m)")
    axes.set_ylabel("preload of each joint (N)")
    _bar(figure, drawn, [axes], "peak of the sensor (1000 g)")
    _key(figure, published, "rigid pulse not kept within 5 %", "")
    return figure


def _plain(number: float) -> str:
    return str(np.format_float_positional(number, 3, fractional=False, trim="-"))


def _norm(values: Array) -> Any:
    from matplotlib.colors import LogNorm

    known = values[np.isfinite(values)]
    return LogNorm(float(known.min()), 1.01 * float(known.max()))


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
