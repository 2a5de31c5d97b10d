"""Pictures of waves: what taps and sensors show, the x-t diagram, and the paper's routes beside the exact solution."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.figures.pulses import HALF, WHOLE, thin
from strikewave.figures.style import BLUE, GREEN, GREY, ORANGE, RED, quiet
from strikewave.units import STANDARD_GRAVITY

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

COLOURS = (BLUE, RED, GREEN, ORANGE, GREY)
DASHES = ("-", "--", "-.", ":")


class Trace(NamedTuple):
    """A curve: its label, times (s) and values (SI)."""

    label: str
    time: Array
    values: Array


def traces(title: str, curves: Sequence[Trace], unit: str, since: str, wide: bool = True) -> Figure:
    """Draw curves over each other, the first one on top.

    Parameters
    ----------
    title : str
        What they show.
    curves : sequence of Trace
        Each with its label; the colours and dashes of a reader who sees no colours.
    unit : str
        "g", "kN", "MPa", "m/s": what the axis shows.
    since : str
        Label of the time axis, which is in microseconds.
    wide : bool, optional
        Whether it fills the width of a page.

    Examples
    --------
    >>> t = np.linspace(0, 1e-4, 100)
    >>> len(traces("speed", [Trace("tap", t, t)], "m/s", "time (us)").axes[0].lines)
    1
    """
    from matplotlib.figure import Figure

    names = {"g": "acceleration (g)", "kN": "force (kN)", "MPa": "stress (MPa)", "m/s": "velocity (m/s)"}
    scales = {"g": STANDARD_GRAVITY, "kN": 1e3, "MPa": 1e6, "m/s": 1.0}
    figure = Figure(figsize=WHOLE if wide else HALF, layout="constrained")
    axes = figure.add_subplot()
    for k, curve in reversed(list(enumerate(curves))):
        finite = np.isfinite(curve.values)
        if not finite.any():
            continue
        time, values = thin(curve.time[finite], curve.values[finite])
        style = DASHES[k % len(DASHES)]
        axes.plot(
            time * 1e6,
            values / scales[unit],
            style,
            color=COLOURS[k % len(COLOURS)],
            linewidth=1.3,
            label=curve.label,
            zorder=3 + len(curves) - k,
        )
    quiet(axes, title, since, names[unit])
    if len(curves) > 1:
        handles, labels = axes.get_legend_handles_labels()
        above_right(axes, handles[::-1], labels[::-1])
    return figure


def above_right(axes: Any, handles: Sequence[Any] | None = None, labels: Sequence[str] | None = None) -> None:
    """Put the legend above the axes, where it hides no curve."""
    given = axes.get_legend_handles_labels() if handles is None else (handles, labels)
    axes.legend(
        *given,
        frameon=False,
        fontsize=8,
        loc="lower right",
        bbox_to_anchor=(1.0, 0.98),
        ncols=len(given[0]),
        borderaxespad=0.0,
        columnspacing=1.2,
    )


def xt_diagram(title: str, time: Array, position: Array, force: Array, edges: Sequence[tuple[str, float]]) -> Figure:
    """Draw the force along a stack over time: blue is compression, red is tension.

    Parameters
    ----------
    time, position, force : array
        s, m, N with shape (times, places).
    edges : sequence of (str, float)
        Name and far end of each layer, m.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=WHOLE, layout="constrained")
    axes = figure.add_subplot()
    most = float(np.abs(force).max()) / 1e3 or 1.0
    mesh = axes.pcolormesh(
        _edges(time) * 1e6,
        _edges(position) * 1e3,
        force.T / 1e3,
        cmap="RdBu",
        vmin=-most,
        vmax=most,
        rasterized=True,
    )
    begin = 0.0
    for name, end in edges:
        axes.axhline(end * 1e3, color="#333333", linewidth=0.6)
        if end - begin > 0.04 * edges[-1][1]:
            axes.text(
                1.0,
                0.5 * (begin + end) * 1e3,
                f" {name}",
                transform=axes.get_yaxis_transform(),
                fontsize=8,
                va="center",
                ha="left",
            )
        begin = end
    longest = max(len(name) for name, _ in edges)
    figure.colorbar(mesh, ax=axes, label="force (kN), compression above 0", pad=0.015 + 0.008 * longest)
    axes.set_title(title, loc="left", fontsize=10)
    axes.set_xlabel("time (µs)")
    axes.set_ylabel("distance from the loaded face (mm)")
    axes.invert_yaxis()
    return figure


def _edges(centres: Array) -> Array:
    """Return the edges of cells about their centres; both sides of a joint have the same place and share an edge."""
    return np.concatenate([centres[:1], 0.5 * (centres[1:] + centres[:-1]), centres[-1:]])


def insertion_loss(curves: Sequence[tuple[str, Array, Array]]) -> Figure:
    """Draw the insertion loss (dB) of buffers over frequency (Hz): what a buffer takes off the motion below it."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=WHOLE, layout="constrained")
    axes: Any = figure.add_subplot()
    for k, (name, frequency, loss) in enumerate(curves):
        axes.semilogx(frequency / 1e3, loss, DASHES[k % 4], color=COLOURS[k % len(COLOURS)], label=name, linewidth=1.4)
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    quiet(axes, "Insertion loss of the buffer", "frequency (kHz)", "loss (dB), below 0 it amplifies")
    axes.set_xticks([1, 2, 5, 10, 20, 50, 100], ["1", "2", "5", "10", "20", "50", "100"])
    axes.minorticks_off()
    if len(curves) > 1:
        above_right(axes)
    return figure
