"""How every picture looks: colours that a colour-blind reader can tell apart, quiet axes."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from strikewave.base import control_characters
from strikewave.base.result import RUN_BROKEN, RUN_FAILED, Verdicts

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

    Parameters
    ----------
    axes : Axes
        Where the points are drawn.
    x, y : ndarray
        Of the points, one a run; a point without a number is not marked.
    verdicts : Verdicts
        Of the runs.
    noun : str, optional
        What a run is called in the legend.
    size : float, optional
        Of the marks, points.
    """
    import numpy as np

    if not verdicts.texts:
        return
    for status, marker, words in (
        (RUN_BROKEN, "D", f"{noun} failed a check"),
        (RUN_FAILED, "x", f"{noun} failed"),
    ):
        chosen = np.array([one == status for one in verdicts.statuses], dtype=bool)
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
        text.set_text(control_characters.shown(text.get_text()))
    with matplotlib.rc_context({"svg.hashsalt": "strikewave"}):
        figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None)


def sheet_title(figure: Any, title: str) -> None:
    """Put a title over a sheet of several axes; what a user typed is no formula."""
    wrapped = textwrap.fill(title, 95)
    figure.suptitle(wrapped, x=0.01, ha="left", fontsize=12, fontweight="bold", parse_math=False)


def titled(figure: Figure, title: str) -> Figure:
    """Return a figure with the name of measured files above it, shortened, as a text."""
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
    width = max((HANDLE + LETTER * len(label) for label in labels), default=PHONE)
    columns = max(1, min(len(labels), int(min(figure.get_figwidth(), PHONE) / width)))
    figure.legend(
        handles, labels, loc="outside lower left", frameon=False, fontsize=8, ncols=columns, columnspacing=1.2
    )


def new_figure(size: tuple[float, float] = WHOLE) -> Figure:
    """Return an empty figure of a size in inches; matplotlib is loaded only here."""
    from matplotlib.figure import Figure

    return Figure(figsize=size, layout="constrained")


def one_diagram(draw: Callable[[Any], None], size: tuple[float, float] = HALF) -> Figure:
    """Return a figure with one pair of axes, on which ``draw`` draws."""
    figure = new_figure(size)
    draw(figure.add_subplot())
    return figure


def empty_axes(axes: Any, title: str, reason: str) -> None:
    """Leave axes empty but for the reason why nothing is drawn."""
    axes.set_title(title, loc="left", fontsize=10)
    axes.set_axis_off()
    axes.text(0.5, 0.5, reason, ha="center", va="center", transform=axes.transAxes, color=GREY)


def printable(text: str) -> str:
    """Return text in which what cannot be shown, or turns lines round, is replaced.

    Examples
    --------
    >>> printable("a\u202eb")
    'a\ufffdb'
    """
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
