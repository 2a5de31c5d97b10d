"""Style of all pictures: colours that a colour-blind reader can tell apart, quiet axes, thinned curves, panels."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base import texts
from strikewave.base.result import RUN_BROKEN, RUN_FAILED, Verdicts
from strikewave.reporting.numbers import axis_unit, headed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BLUE, ORANGE, GREEN, RED, GREY = "#0072B2", "#E69F00", "#009E73", "#D55E00", "#6E6E6E"
"""Okabe & Ito's colours, and a grey."""
HALF, WHOLE = (4.9, 3.3), (9.8, 3.4)
"""Sizes of a picture that shares its line and of one that does not, inches: a page is 9.8 inches wide at 96 pixels an
inch."""
PHONE = 3.9
"""Inches of a `WHOLE` picture that a phone 390 pixels wide shows unscrolled; of a `HALF` one it shows all."""
LETTER, HANDLE = 0.062, 0.55
"""Inches of a letter of a legend in 8 points (the mean, rounded up), and of what stands beside a label."""


def quiet(axes: Any, title: str, x: str, y: str) -> None:
    """Give axes a title, labels with units, a faint grid and no box."""
    axes.set_title(title, loc="left", fontsize=10)
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.grid(True, color="#E4E4E4", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.margins(x=0.0)


def mark_runs(axes: Any, x: Any, y: Any, verdicts: Verdicts, noun: str = "run", size: float = 7.0) -> None:
    """Mark points of runs that failed a check, by an open diamond, and of those that failed, by a cross.

    There is a point a run, and one without a number is not marked; ``size`` is that of the marks, points.
    """
    if not verdicts.texts:
        return
    for status, marker, words in ((RUN_BROKEN, "D", f"{noun} failed a check"), (RUN_FAILED, "x", f"{noun} failed")):
        chosen = np.array(verdicts.statuses) == status
        chosen &= np.isfinite(np.asarray(x, dtype=float)) & np.isfinite(np.asarray(y, dtype=float))
        if chosen.any():
            axes.plot(
                np.asarray(x)[chosen], np.asarray(y)[chosen], marker, color=RED, markersize=size,
                markerfacecolor="none", markeredgewidth=1.4, linestyle="none", label=words, zorder=4, clip_on=False,
            )  # fmt: skip


def save(figure: Any, path: Path) -> None:
    """Write a figure; the same figure gives the same bytes (no date, fixed identifiers)."""
    import matplotlib
    from matplotlib.text import Text

    for text in figure.findobj(Text):
        text.set_text(texts.shown(text.get_text()))
    with matplotlib.rc_context({"svg.hashsalt": "strikewave"}):
        figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None)


def sheet_title(figure: Any, title: str) -> None:
    """Put a title over a sheet of several axes; what a user typed is no formula."""
    wrapped = textwrap.fill(title, 95)
    figure.suptitle(wrapped, x=0.01, ha="left", fontsize=12, fontweight="bold", parse_math=False)


def titled(figure: Figure, title: str) -> Figure:
    """Return a figure with the name of measured files above it, shortened, as text."""
    figure.suptitle(plain(title, 90), x=0.01, ha="left", fontsize=11)
    return figure


def legend_below(figure: Figure) -> Figure:
    """Put one legend of all axes below them, where it hides no curve."""
    entries: dict[str, Any] = {}
    for axes in figure.axes:
        new = dict(zip(*axes.get_legend_handles_labels()[::-1], strict=True))
        entries |= {label: handle for label, handle in new.items() if label not in entries}
    if entries:
        put_below(figure, list(entries.values()), list(entries))
    return figure


def put_below(figure: Figure, handles: Sequence[Any], labels: Sequence[str]) -> None:
    """Put a legend below a picture at its left, in as many columns as a narrow screen shows of it.

    Examples
    --------
    >>> figure = new_figure(HALF)
    >>> (line,) = figure.add_subplot().plot([0.0, 1.0])
    >>> put_below(figure, [line] * 6, ["blow 1", "blow 2", "blow 3", "blow 4", "blow 5", "blow 6"])
    >>> figure.legends[0]._ncols
    4
    """
    width = HANDLE + LETTER * max(map(len, labels)) if labels else PHONE
    columns = max(1, min(len(labels), int(min(figure.get_figwidth(), PHONE) / width)))
    figure.legend(
        handles, labels, loc="outside lower left", frameon=False, fontsize=8, ncols=columns, columnspacing=1.2
    )


def new_figure(size: tuple[float, float] = WHOLE) -> Figure:
    """Return an empty figure of a size in inches; matplotlib is loaded only here."""
    from matplotlib.figure import Figure

    return Figure(figsize=size, layout="constrained")


def figure_with_axes(size: tuple[float, float] = HALF) -> tuple[Figure, Any]:
    """Return a figure of a size in inches, and its one pair of axes."""
    figure = new_figure(size)
    return figure, figure.add_subplot()


def one_diagram(draw: Callable[[Any], None], size: tuple[float, float] = HALF) -> Figure:
    """Return a figure with one pair of axes, on which ``draw`` draws."""
    figure, axes = figure_with_axes(size)
    draw(axes)
    return figure


def empty_axes(axes: Any, title: str, reason: str) -> None:
    """Leave axes empty but for the reason why nothing is drawn."""
    axes.set_title(title, loc="left", fontsize=10)
    axes.set_axis_off()
    axes.text(0.5, 0.5, reason, ha="center", va="center", transform=axes.transAxes, color=GREY)


def printable(text: str) -> str:
    """Return text in which letters that cannot be shown, or turn lines round, are replaced."""
    return "".join(letter if letter.isprintable() else "\ufffd" for letter in text)


def plain(text: str, most: int = 40) -> str:
    r"""Return a name of a stranger as a label: shortened in its middle, no mark of TeX, nothing that hides.

    Examples
    --------
    >>> plain("board"), plain("a$b\n"), plain("x" * 99, 9)
    ('board', 'a\\$b�', 'xxxx…xxxx')
    """
    text = printable(text)
    if len(text) > most:
        text = text[: most // 2] + "…" + text[-((most - 1) // 2) :]
    text = " " + text if text.startswith("_") else text  # else a legend would leave it out
    return text.replace("$", r"\$")


Array = NDArray[np.float64]


COLOURS = (BLUE, RED, GREEN, ORANGE, GREY)
DASHES = ("-", "--", "-.", ":")
"""Dashes of curves in their order; five colours and four dashes tell twenty curves apart."""
MOST_PULSES = 40  # chosen: more only darken the band that they fill
"""Pulses drawn over each other; of more blows the first, the odd ones and an even choice of the rest are drawn."""
PIXEL_COLUMNS = 1400  # more than the 940 pixels of a picture as wide as a page
"""Columns into which all samples of a curve are gathered."""
_LONGEST_NAME = 20  # chosen: beside a diagram it takes an eighth of its width
"""Letters of a name in a picture."""


def thin(time: Array, values: Array, columns: int = PIXEL_COLUMNS) -> tuple[Array, Array]:
    """Keep the smallest and the largest sample of each column, and the last, so that a long history keeps its peaks.

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


TRACED = {"g": ("acceleration", "m/s^2"), "kN": ("force", "N"), "MPa": ("stress", "Pa"), "m/s": ("velocity", "m/s")}
"""Usual unit of traced quantities: their name and SI unit."""


class Trace(NamedTuple):
    """A curve: its label, times (s) and values (SI)."""

    label: str
    time: Array
    values: Array


def traces(title: str, curves: Sequence[Trace], unit: str, since: str, wide: bool = True) -> Figure:
    """Draw curves over each other, the first one on top, told apart by dashes too.

    The unit is a usual one of `TRACED`; ``since`` is the label of the time axis, whose usual unit is the microsecond.
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
        look: dict[str, Any] = {"color": COLOURS[k % len(COLOURS)], "linewidth": 1.3, "zorder": 3 + len(curves) - k}
        axes.plot(time / second, values / size, DASHES[k % len(DASHES)], label=curve.label, **look)
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
    is_alone = grid is not None and grid.ncols == 1
    line = HANDLE * len(entries[1]) + LETTER * sum(map(len, entries[1]))
    if is_alone and max(axes.figure.get_figwidth(), line) > HALF[0]:
        put_below(axes.figure, *entries)
        return
    place: dict[str, Any] = {"loc": "lower right", "bbox_to_anchor": (1.0, 0.98), "borderaxespad": 0.0}
    axes.legend(*entries, frameon=False, fontsize=8, ncols=len(entries[0]), columnspacing=1.2, **place)
