"""Pictures of several spectra, of a spectrum that changes with time, and of one oscillator."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.record.figures.records import clock, say
from strikewave.analyses.record.figures.spectra import hertz_ticks, log_axis, number_tick, response_unit
from strikewave.reporting.numbers import axis_unit, headed, hertz
from strikewave.reporting.style import BLUE, GREEN, GREY, ORANGE, RED, legend_below, new_figure, plain, quiet, thin

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strikewave.analyses.record.spectrum import SpectrumResult

Array = NDArray[np.float64]

MOST_NAMES = 4
"""Spectra that a legend names: of more, one grey is enough."""
DECADES = 4.0
"""Decades of a rolling spectrum that its colours span: below a ten-thousandth of the largest lies noise."""
_COLOURS = (BLUE, GREEN, ORANGE, "#CC79A7")
_TOGETHER = {
    "envelope": ("envelope", "black", "-"),
    "p95_50": ("P95/50", RED, "--"),
    "resultant": ("resultant", "black", "-"),
}


def several_figure(result: SpectrumResult, place: int) -> Figure:
    """Draw spectra of one kind with what they come to: thin lines of each, thick ones of all."""
    figure = new_figure()
    axes: Any = figure.add_subplot()
    one = result.spectra[place]
    size, label = response_unit(one.kind, result.reading.channel.unit)
    hertz_size, _ = axis_unit("Hz", "Hz")
    drawn = result.used or list(result.shocks)
    if not any(np.any(shock.found.spectra[place].maximax > 0.0) for shock in drawn):
        say(axes, "there is no shock response spectrum to draw")
        return figure
    few = len(drawn) <= MOST_NAMES

    def draw(values: Array, **look: Any) -> None:
        positive = values > 0.0
        axes.loglog(one.frequency[positive] / hertz_size, values[positive] / size, **look)

    for k, shock in enumerate(drawn):
        name = plain(shock.name) if few else f"each of {len(drawn)}" if k == 0 else "_"
        draw(
            shock.found.values[one.kind], color=_COLOURS[k] if few else GREY, linewidth=0.9,
            alpha=1.0 if few else 0.6, label=name,
        )  # fmt: skip
    for name, kinds in result.together.items():
        words, colour, dash = _TOGETHER[name]
        draw(kinds[one.kind], color=colour, linestyle=dash, linewidth=2.2, label=words)
    title = f"Shock response spectra, {result.side}, Q = {one.q:g}"
    quiet(axes, title, headed("natural frequency", "Hz", "Hz"), label)
    log_axis(axes.xaxis, hertz_ticks())
    log_axis(axes.yaxis, number_tick)
    return legend_below(figure)


def rolling_figure(result: SpectrumResult) -> Figure:
    """Draw spectra over time and natural frequency, in colours told apart by all, a diagram a channel."""
    from matplotlib.colors import LogNorm

    drawn, side, one = result.rollings[:MOST_NAMES], result.side, result.spectra[0]
    values = [rolling.values for _, rolling in drawn]
    top = max(float(np.max(each)) for each in values)
    figure = _stacked(len(drawn))
    if not top > 0.0:
        say(figure.add_subplot(), "there is no shock response spectrum to draw")
        return figure
    rows: Any = figure.subplots(len(drawn), 1, squeeze=False, sharex=True)[:, 0]
    size, label = response_unit(one.kind, result.reading.channel.unit)
    hertz_size, _ = axis_unit("Hz", "Hz")
    factor, seconds = clock(max(float(np.ptp(rolling.time)) for _, rolling in drawn) or 1e-3)
    low = max(min(float(np.min(each[each > 0.0], initial=top)) for each in values), top * 10.0**-DECADES)
    norm = LogNorm(min(low, 0.5 * top) / size, top / size)
    some = "" if len(drawn) == len(result.rollings) else f", the first {len(drawn)} of {len(result.rollings)}"
    for k, (axes, (shock, rolling), each) in enumerate(zip(rows, drawn, values, strict=True)):
        image = axes.pcolormesh(
            edges(rolling.time) * factor, np.exp(edges(np.log(rolling.frequency))) / hertz_size,
            np.maximum(each.T, low) / size, norm=norm, cmap="cividis", shading="flat", rasterized=True,
        )  # fmt: skip
        axes.set_yscale("log")
        title = f"Rolling shock response spectrum, {side}, Q = {one.q:g}{some}" if k == 0 else ""
        if len(drawn) > 1:
            title = f"{title}\n{plain(shock.name)}".strip()
        last = f"middle of the window ({seconds})" if k + 1 == len(drawn) else ""
        quiet(axes, title, last, headed("natural frequency", "Hz", "Hz"))
        axes.grid(False)
        log_axis(axes.yaxis, hertz_ticks())
    bar = figure.colorbar(image, ax=list(rows))
    bar.set_label(label, fontsize=9)
    log_axis(bar.ax.yaxis, number_tick)
    bar.outline.set_visible(False)
    return figure


def _stacked(count: int) -> Figure:
    """Return a figure that has room for so many diagrams under one another."""
    return new_figure((8.0, 1.4 + 2.0 * count)) if count > 1 else new_figure()


def edges(places: Array) -> Array:
    """Return the edges of cells around places, half way between them.

    Examples
    --------
    >>> edges(np.array([1.0, 2.0, 4.0])).tolist()
    [0.5, 1.5, 3.0, 5.0]
    """
    if places.size == 1:
        return np.asarray(places[0] + np.array([-0.5, 0.5]) * (abs(places[0]) * 0.1 or 1.0))
    middle = 0.5 * (places[1:] + places[:-1])
    return np.concatenate([[2.0 * places[0] - middle[0]], middle, [2.0 * places[-1] - middle[-1]]])


def response_figure(result: SpectrumResult) -> Figure:
    """Draw what an oscillator does while each record lasts, a diagram a kind."""
    drawn, several = result.responses[:MOST_NAMES], len(result.responses) > 1
    histories = drawn[0][1].histories
    figure = _stacked(len(histories))
    rows: Any = figure.subplots(len(histories), 1, squeeze=False, sharex=True)[:, 0]
    factor, seconds = clock(max(float(one.time[-1] - one.time[0]) for _, one in drawn))
    for k, (axes, kind) in enumerate(zip(rows, histories, strict=True)):
        size, label = response_unit(kind, result.reading.channel.unit)
        for colour, (shock, one) in zip(_COLOURS, drawn, strict=False):
            name = plain(shock.name) if several and k == 0 else "_"
            line = thin(one.time * factor, one.histories[kind] / size)
            axes.plot(*line, color=colour, linewidth=1.0, alpha=0.8 if several else 1.0, label=name)
        some = "" if len(drawn) == len(result.responses) else f", the first {len(drawn)} of {len(result.responses)}"
        title = f"Response of an oscillator of {hertz(drawn[0][1].frequency)}{some}" if k == 0 else ""
        quiet(axes, title, f"time ({seconds})" if k + 1 == len(histories) else "", label)
        axes.margins(x=0.01)
    return legend_below(figure) if several else figure
