"""The picture of a posterior: each value, and each pair of them, with the least-squares ones."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.reporting.style import BLUE, GREY, RED, WHOLE, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strikewave.studies.fit.result import FitStudy

Array = NDArray[np.float64]

BINS, FINE = 30, 24
"""Bins of a value, and along each side of a pair."""
MOST_DRAWN = 5
"""Most values in the picture: more panels cannot be read on a page."""
SMOOTH, SHOWN = 1.2, 0.002
"""Bins over which a pair is smoothed, so that contours do not follow single draws, and share of the draws on each side
that may lie outside of the picture."""
MASSES = (0.95, 0.68)
"""Shares of the draws that the contours of a pair hold."""


def corner_figure(study: FitStudy) -> Figure:
    """Return the corner picture: histograms on the diagonal, pairs below it, with 68 and 95 % of the draws."""
    assert study.posterior is not None
    values = study.parameters[:MOST_DRAWN]
    columns = [
        np.array([one.field.axis.shown(one.field.si(float(place))) for place in places])
        for one, places in zip(values, study.posterior.draws.T, strict=False)
    ]
    size = len(values)
    figure = new_figure((WHOLE[0], 1.0 + min(2.2 * size + 0.6, 8.0)))
    grid = figure.subplots(size, size, squeeze=False)
    for row in range(size):
        for column in range(size):
            axes = grid[row, column]
            if column > row:
                axes.set_visible(False)
                continue
            fitted = values[column].field.axis.shown(values[column].value)
            if row == column:
                _draw_value(axes, columns[row], fitted)
            else:
                _draw_pair(axes, columns[column], columns[row])
                axes.plot(fitted, values[row].field.axis.shown(values[row].value), "+", color=RED, markersize=10)
            axes.set_xlim(_range(columns[column]))
            if row != column:
                axes.set_ylim(_range(columns[row]))
            _label(axes, values, row, column)
    return figure


def _range(draws: Array) -> tuple[float, float]:
    """Return what is shown of a value: all but a few draws, and a tenth on either side."""
    low, high = np.quantile(draws, (SHOWN, 1.0 - SHOWN))
    return float(low - 0.1 * (high - low)), float(high + 0.1 * (high - low))


def _draw_value(axes: Any, draws: Array, fitted: float) -> None:
    """Draw a histogram, the median with 95 %, and the least-squares value."""
    axes.hist(draws, bins=BINS, range=_range(draws), density=True, color=BLUE, alpha=0.35)
    low, middle, high = np.quantile(draws, (0.025, 0.5, 0.975))
    axes.axvline(middle, color=BLUE, linewidth=1.3)
    axes.axvspan(low, high, color=BLUE, alpha=0.10, linewidth=0.0)
    axes.axvline(fitted, color=RED, linewidth=1.1, linestyle="--")
    axes.set_yticks([])


def _draw_pair(axes: Any, x: Array, y: Array) -> None:
    """Draw where 68 and 95 % of the draws of a pair lie."""
    from scipy.ndimage import gaussian_filter

    counts, x_edges, y_edges = np.histogram2d(x, y, bins=FINE, range=[_range(x), _range(y)])
    counts = gaussian_filter(counts, SMOOTH, mode="constant")
    falling = np.sort(counts.ravel())[::-1]
    held = np.cumsum(falling) / counts.sum()
    levels = sorted({float(falling[int(np.searchsorted(held, mass))]) for mass in MASSES})
    middles = [0.5 * (edges[1:] + edges[:-1]) for edges in (x_edges, y_edges)]
    axes.scatter(x[:: max(len(x) // 600, 1)], y[:: max(len(y) // 600, 1)], s=2, color=GREY, alpha=0.25, linewidths=0)
    if len(levels) > 1 and levels[0] > 0.0:
        axes.contour(*middles, counts.T, levels=levels, colors=[BLUE], linewidths=1.1)


def _label(axes: Any, values: Any, row: int, column: int) -> None:
    """Name values at the left and at the bottom; 95 % of the range is shown as it is."""
    axes.tick_params(labelsize=7)
    axes.locator_params(nbins=4)
    axes.spines[["top", "right"]].set_visible(False)
    axes.ticklabel_format(useOffset=False)
    if row == len(values) - 1:
        axes.set_xlabel(_name(values[column]), fontsize=8)
    else:
        axes.tick_params(labelbottom=False)
    if column == 0 and row > 0:
        axes.set_ylabel(_name(values[row]), fontsize=8)
    elif column != row:
        axes.tick_params(labelleft=False)


def _name(one: Any) -> str:
    name = one.field.path.rpartition(".")[2].replace("_", " ")
    return f"{name} ({one.field.axis.shown_unit})" if one.field.axis.unit else name
