"""Pictures of several spectra, of a spectrum that changes with time, and of one oscillator."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.record.figures.records import clock, say
from strikewave.analyses.record.figures.spectra import hertz, hertz_ticks, log_axis, number_tick, response_unit
from strikewave.reporting.curves import thin
from strikewave.reporting.numbers import axis_unit, headed
from strikewave.reporting.style import BLUE, GREEN, GREY, ORANGE, RED, legend_below, new_figure, plain, quiet
from strikewave.signal.srs import RollingSpectrum, Spectrum

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strikewave.analyses.record.spectrum import OscillatorResponse, SpectrumResult

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
    if not any(np.any(shock.spectra[place].maximax > 0.0) for shock in drawn):
        say(axes, "there is no shock response spectrum to draw")
        return figure
    few = len(drawn) <= MOST_NAMES

    def draw(values: Array, **look: Any) -> None:
        positive = values > 0.0
        axes.loglog(one.frequency[positive] / hertz_size, values[positive] / size, **look)

    for k, shock in enumerate(drawn):
        name = plain(shock.name) if few else f"each of {len(drawn)}" if k == 0 else "_"
        draw(
            shock.spectra[place].side(result.side), color=_COLOURS[k] if few else GREY, linewidth=0.9,
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


def rolling_figure(rolling: RollingSpectrum, side: str, one: Spectrum, unit: str) -> Figure:
    """Draw a spectrum over time and natural frequency, in colours that the colour-blind tell apart."""
    from matplotlib.colors import LogNorm

    figure = new_figure()
    axes: Any = figure.add_subplot()
    values = getattr(rolling, side)
    top = float(np.max(values))
    if not top > 0.0:
        say(axes, "there is no shock response spectrum to draw")
        return figure
    size, label = response_unit(one.kind, unit)
    hertz_size, _ = axis_unit("Hz", "Hz")
    factor, seconds = clock(float(np.ptp(rolling.time)) or 1e-3)
    low = max(float(np.min(values[values > 0.0])), top * 10.0**-DECADES)
    norm = LogNorm(min(low, 0.5 * top) / size, top / size)
    image = axes.pcolormesh(
        edges(rolling.time) * factor, np.exp(edges(np.log(rolling.frequency))) / hertz_size,
        np.maximum(values.T, low) / size, norm=norm, cmap="cividis", shading="flat", rasterized=True,
    )  # fmt: skip
    axes.set_yscale("log")
    quiet(
        axes, f"Rolling shock response spectrum, {side}, Q = {one.q:g}", f"middle of the window ({seconds})",
        headed("natural frequency", "Hz", "Hz"),
    )  # fmt: skip
    axes.grid(False)
    log_axis(axes.yaxis, hertz_ticks())
    bar = figure.colorbar(image, ax=axes)
    bar.set_label(label, fontsize=9)
    bar.outline.set_visible(False)
    return figure


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


def response_figure(histories: Mapping[str, Array], one: OscillatorResponse, unit: str) -> Figure:
    """Draw what an oscillator does while the record lasts, a diagram a kind."""
    figure = new_figure()
    rows: Any = figure.subplots(len(histories), 1, squeeze=False, sharex=True)
    factor, seconds = clock(float(one.time[-1] - one.time[0]))
    for k, (axes, (kind, values)) in enumerate(zip(rows[:, 0], histories.items(), strict=True)):
        size, label = response_unit(kind, unit)
        axes.plot(*thin(one.time * factor, values / size), color=BLUE, linewidth=1.0)
        title = f"Response of an oscillator of {hertz(one.frequency)}" if k == 0 else ""
        quiet(axes, title, f"time ({seconds})" if k + 1 == len(histories) else "", label)
        axes.margins(x=0.01)
    return figure
