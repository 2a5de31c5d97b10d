"""How every picture looks: colours that a colour-blind reader can tell apart, quiet axes."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure


BLUE, ORANGE, GREEN, RED, GREY = "#0072B2", "#E69F00", "#009E73", "#D55E00", "#6E6E6E"
"""Okabe & Ito's colours, and a grey."""
HALF, WHOLE = (4.9, 3.3), (9.8, 3.4)
"""Sizes of a picture that shares its line and of one that does not, inches: a page is 9.8 inches wide at 96 pixels an
inch."""
LEGEND_LETTERS = 110
"""Labels with fewer letters in all stand six in a line below a picture, longer ones four (chosen by eye: both fit into
`WHOLE` in letters of 8 points)."""


def quiet(axes: Any, title: str, x: str, y: str) -> None:
    """Give axes a title, labels with units, a faint grid and no box."""
    axes.set_title(title, loc="left", fontsize=10)
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.grid(True, color="#E4E4E4", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.margins(x=0.0)


def save(figure: Any, path: Path) -> None:
    """Write a figure; the same figure gives the same bytes (no date, fixed identifiers)."""
    import matplotlib

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
        ncols = 6 if sum(map(len, entries)) < LEGEND_LETTERS else 4
        figure.legend(
            list(entries.values()), list(entries), loc="outside lower left", frameon=False, fontsize=8, ncols=ncols
        )
    return figure


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
