"""The window of a picture: its sides, the bar of a round length, the instant in words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from strikewave.analyses.fem.figures.pictures.camera import Camera
from strikewave.fem.mesh import Index
from strikewave.reporting.numbers import axis_unit, round_step, time_unit

Array = NDArray[np.float64]

WIDEST = 4.0
"""A picture is at most so many times as high as wide (chosen: a bar of a round length fits below it)."""


def window_about(hexahedra: Index, places: Sequence[Array], view: Camera) -> tuple[float, float, float, float]:
    """Return the window that holds the elements at all instants with a little air: left, right, low, high, mm."""
    nodes, frame = np.unique(hexahedra), view.axes()
    flat = np.concatenate([moved[nodes] @ frame.T[:, :2] for moved in places]) * 1e3
    (left, low), (right, high) = flat.min(axis=0), flat.max(axis=0)
    largest = max(right - left, high - low, 1e-9)
    air, below = 0.02 * largest, 0.1 * largest
    aside = max(air, 0.5 * (largest / WIDEST - right + left))
    return float(left - aside), float(right + aside), float(low - air - below), float(high + air)


def instant_words(time: float) -> str:
    """Write a time as the histories do."""
    size, unit = time_unit(time)
    return f"{time / size:.4g} {unit}"


def frame_window(axes: Any, window: tuple[float, float, float, float], bar: bool = True) -> None:
    """Show a window without axes, and, where asked for, a bar of a round length below the parts, mm."""
    left, right, low, high = window
    axes.set(xlim=(left, right), ylim=(low, high), xticks=[], yticks=[], aspect="equal")
    axes.spines[:].set_visible(False)
    if bar:
        _draw_bar(axes, window)


def _draw_bar(axes: Any, window: tuple[float, float, float, float]) -> None:
    """Draw a bar of a round length, at most a quarter of the width, below the parts."""
    left, right, low, high = window
    size, unit = axis_unit("m", "mm")
    round_length = round_step(0.25 * (right - left) * 1e-3 / size)
    length = round_length * size * 1e3
    begin, below = left + 0.03 * (right - left), low + 0.06 * max(right - left, high - low)
    halo = [withStroke(linewidth=3.5, foreground="white")]
    (line,) = axes.plot([begin, begin + length], [below, below], color="#1a1f24", linewidth=2.0, solid_capstyle="butt")
    line.set_path_effects(halo)
    label = axes.annotate(
        f"{round_length:g} {unit}",
        (begin + 0.5 * length, below),
        (0, -3),
        textcoords="offset points",
        ha="center",
        va="top",
        fontsize=8,
    )
    label.set_path_effects(halo)
