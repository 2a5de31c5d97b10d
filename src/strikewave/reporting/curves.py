"""Curves of a report: sizes, thinning, looks, and panels of histories."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.reporting.numbers import axis_unit, headed
from strikewave.reporting.style import (
    BLUE,
    GREEN,
    GREY,
    HALF,
    HANDLE,
    LETTER,
    ORANGE,
    RED,
    WHOLE,
    new_figure,
    put_below,
    quiet,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure


Array = NDArray[np.float64]


COLOURS = (BLUE, RED, GREEN, ORANGE, GREY)
DASHES = ("-", "--", "-.", ":")
"""Of curves in their order; five colours and four dashes tell twenty curves apart."""
MOST_PULSES = 40
"""Pulses drawn over each other; of more blows the first, the odd ones and an even choice of the rest are drawn (chosen:
more only darken the band that they fill)."""
PIXEL_COLUMNS = 1400
"""Columns into which all samples of a curve are gathered: more than the 940 pixels of a picture as wide as a page."""
_LONGEST_NAME = 20
"""Letters of a name in a picture (chosen: beside a diagram it takes an eighth of its width)."""


def thin(time: Array, values: Array, columns: int = PIXEL_COLUMNS) -> tuple[Array, Array]:
    """Keep the smallest and the largest sample of each column, so that a long history keeps its peaks.

    Parameters
    ----------
    time, values : array
        Samples, shape (N,).
    columns : int, optional
        Number of columns; at most twice as many samples are kept, and the last one.

    Examples
    --------
    >>> values = np.zeros(10_000)
    >>> values[1234], values[5678] = 9.0, -3.0
    >>> _, thinned = thin(np.arange(10_000.0), values, 100)
    >>> thinned.size <= 201, thinned.max(), thinned.min()
    (True, np.float64(9.0), np.float64(-3.0))
    """
    if values.size <= 2 * columns:
        return time, values
    length = -(-values.size // columns)
    starts = np.arange(0, values.size, length)
    ends = np.append(starts[1:], values.size)
    low = [start + int(np.argmin(values[start:end])) for start, end in zip(starts, ends, strict=True)]
    high = [start + int(np.argmax(values[start:end])) for start, end in zip(starts, ends, strict=True)]
    shown = np.unique([*low, *high, values.size - 1])
    return time[shown], values[shown]


def shortened(name: str, longest: int = _LONGEST_NAME) -> str:
    """Return a name that is not too long for a picture.

    Examples
    --------
    >>> shortened("upper"), shortened("a very long name of a layer")
    ('upper', 'a very long name of…')
    """
    return name if len(name) <= longest else name[: longest - 1].rstrip() + "…"


def spread(places: Array, least: float, most: float) -> Array:
    """Return rising places moved apart, each so far from the next, and half that from 0 and from ``most``, if they fit.

    Examples
    --------
    >>> print(spread(np.array([1.0, 1.0, 8.0]), 2.0, 10.0))
    [1. 3. 8.]
    """
    step = min(least, most / max(len(places), 1))
    groups: list[tuple[float, int]] = []  # middle and size
    for place in places:
        middle, size = float(place), 1
        while True:
            half = 0.5 * step * size
            middle = min(max(middle, half), most - half)
            if not groups or middle - groups[-1][0] >= half + 0.5 * step * groups[-1][1]:
                break
            other, count = groups.pop()
            middle, size = (other * count + middle * size) / (count + size), count + size
        groups.append((middle, size))
    return np.concatenate([middle + step * (np.arange(size) - 0.5 * (size - 1)) for middle, size in groups])


TRACED = {
    "g": ("acceleration", "m/s^2"),
    "kN": ("force", "N"),
    "MPa": ("stress", "Pa"),
    "m/s": ("velocity", "m/s"),
}
"""Usual unit of traced quantities: their name and SI unit."""


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
        Usual unit of the axis, one of `TRACED`: "g", "kN", "MPa", "m/s".
    since : str
        What the time axis shows; its usual unit is the microsecond.
    wide : bool, optional
        Whether it fills the width of a page.

    Examples
    --------
    >>> t = np.linspace(0, 1e-4, 100)
    >>> len(traces("speed", [Trace("tap", t, t)], "m/s", "time").axes[0].lines)
    1
    """
    name, si = TRACED[unit]
    (size, _), (second, _) = axis_unit(si, unit), axis_unit("s", "us")
    figure = new_figure(WHOLE if wide else HALF)
    axes = figure.add_subplot()
    for k, curve in reversed(list(enumerate(curves))):
        finite = np.isfinite(curve.values)
        if not finite.any():
            continue
        time, values = thin(curve.time[finite], curve.values[finite])
        style = DASHES[k % len(DASHES)]
        axes.plot(
            time / second,
            values / size,
            style,
            color=COLOURS[k % len(COLOURS)],
            linewidth=1.3,
            label=curve.label,
            zorder=3 + len(curves) - k,
        )
    quiet(axes, title, headed(since, "s", "us"), headed(name, si, unit))
    if len(curves) > 1:
        handles, labels = axes.get_legend_handles_labels()
        put_legend(axes, handles[::-1], labels[::-1])
    return figure


def put_legend(axes: Any, handles: Sequence[Any] | None = None, labels: Sequence[str] | None = None) -> None:
    """Put the legend where it hides no curve, and where a narrow screen shows it.

    It stands above the axes at their right, where it fits in one line. In a wide figure of one column, whose right side
    a phone shows only after scrolling, it stands below at the left.
    """
    entries = axes.get_legend_handles_labels() if handles is None else (handles, labels or ())
    grid = axes.get_gridspec()
    if axes.figure.get_figwidth() > HALF[0] and grid is not None and grid.ncols == 1:
        put_below(axes.figure, *entries)
        return
    if grid is not None and grid.ncols == 1 and HANDLE * len(entries[1]) + LETTER * sum(map(len, entries[1])) > HALF[0]:
        put_below(axes.figure, *entries)
        return
    axes.legend(
        *entries,
        frameon=False,
        fontsize=8,
        loc="lower right",
        bbox_to_anchor=(1.0, 0.98),
        ncols=len(entries[0]),
        borderaxespad=0.0,
        columnspacing=1.2,
    )
