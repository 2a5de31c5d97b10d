"""How every picture looks: colours that a colour-blind reader can tell apart, quiet axes."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import Any

BLUE, ORANGE, GREEN, RED, GREY = "#0072B2", "#E69F00", "#009E73", "#D55E00", "#6E6E6E"
"""Okabe & Ito's colours, and a grey."""


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
