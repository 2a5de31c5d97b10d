"""A pulse on its way through a stack, as a page that plays by itself and as a GIF."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from strikewave.reporting.animation.gif import write_gif
from strikewave.reporting.animation.page import (
    Animation,
    Chart,
    Clock,
    FieldCurve,
    LayerBand,
    Panel,
    PlaceAxis,
    PlaceMark,
    PlayedSpan,
    animation_page,
    even_rows,
)
from strikewave.reporting.numbers import axis_unit
from strikewave.reporting.style import BLUE, RED, printable
from strikewave.reporting.wave_field import (
    DASHED,
    JOINT_STYLES,
    QUANTITIES,
    THICK,
    WaveField,
    distance_label,
    draw_along,
    name_layers,
    shade_layers,
    shades,
)
from strikewave.waves import Tap

Array = NDArray[np.float64]

PANELS = ("stress", "velocity")
"""Quantities that the page shows, from above."""
MOST_FRAMES, GIF_FRAMES = 400, 100
"""Of a page: 40 a second at speed 1, as smooth as a film; of a GIF: ten seconds."""
MOST_VALUES = 200_000
"""Values of each panel that a page holds at most: 2.7 bytes each, as 16-bit integers in base 64."""
PANEL_HEIGHT = 190.0
"""Of a panel of the page, pixels: two of them and the controls fill a screen of 768 lines."""
MARGIN = 1.09
"""Axes reach so far beyond the peak: what is written at the top of a panel stays clear of the curve."""
INK = "#1a1f24"
FILLS = (f"{BLUE}4d", f"{RED}4d")
"""Above and below zero: as in the figures, 30 % opaque."""
_DPI = 80
"""Of a GIF, dots an inch (chosen: 640 x 432 pixels, which a slide shows)."""
GIF_MARGIN = 1.2
"""Axes of a GIF reach so far beyond the peak: the names of layers stand above the curve."""
NOTE = (
    "Blue is compression or motion along the blow, red tension or motion against it; the darker a layer, the greater "
    "its impedance; ▲ marks a tap."
)


def wave_page(field: WaveField, title: str, name: str = "") -> str:
    """Return a page that shows stress and velocity along a stack while a pulse runs through it.

    Parameters
    ----------
    field : WaveField
        What is shown, with velocities.
    title, name : str
        Of the page, and of the case; plain text.

    Examples
    --------
    >>> from strikewave import load_case, run_wave
    >>> from strikewave.analyses.wave.field import field_of_solution
    >>> page = wave_page(field_of_solution(run_wave(load_case("li-ma-2019-fig13-bar"))), "a < b")
    >>> "<title>a &lt; b</title>" in page, len(page) < 1.5e6
    (True, True)
    """
    return animation_page(wave_animation(field), title, name)


def wave_animation(field: WaveField) -> Animation:
    """Return stress and velocity along a stack, frame by frame."""
    rows = even_rows(len(field.time), min(MOST_FRAMES, max(MOST_VALUES // len(field.position), 2)))
    time = np.array([_digits(t) for t in field.time[rows]])
    panels = [_panel(field, quantity, rows) for quantity in PANELS]
    alternative = "Stress and velocity along the stack; the values at the chosen place and time are written below."
    chart = Chart("waves", alternative, "place", "distance from the loaded face", PANEL_HEIGHT, panels)
    return Animation(
        kicker="Waves in a stack",
        note=NOTE,
        gif="animation.gif",
        clock=Clock.of(time),
        views=[PlayedSpan("whole", "whole run", time)],
        canvases=[chart],
        places=_places(field),
    )


def _places(field: WaveField) -> PlaceAxis:
    """Return the places of a field, the layers that have places, and the taps; the first tap is read first."""
    shown, band = np.unique(field.layer, return_inverse=True)
    layers, joints = field.stack.layers, field.stack.joints
    greys, ends = shades(field.stack), field.ends
    size, unit = axis_unit("m", "mm")
    return PlaceAxis(
        unit=unit,
        per=size,
        position=[_digits(x) for x in field.position],
        band=band.tolist(),
        bands=[
            LayerBand(
                layers[k].name,
                _digits(ends[k] - layers[k].length),
                _digits(ends[k]),
                round(255 * greys[k]),
                "" if k == 0 else _joint_line(joints[k - 1].kind),
            )
            for k in shown.tolist()
        ],
        marks=[PlaceMark(name, _digits(field.place(tap))) for name, tap in field.taps],
        start=_place_of(field, field.taps[0][1]) if field.taps else 0,
    )


def _place_of(field: WaveField, tap: Tap) -> int:
    """Return the place of the field nearest to a tap, in the tap's own layer where that has places."""
    elsewhere = np.where(field.layer == tap.layer, 0.0, field.ends[-1])
    return int(np.argmin(np.abs(field.position - field.place(tap)) + elsewhere))


def _joint_line(kind: str) -> Literal["", "dashed", "thick"]:
    """Return how the joint before a layer is drawn: dashed, thick, or as a thin line."""
    style = JOINT_STYLES.get(kind)
    return "dashed" if style == DASHED else "thick" if style == THICK else ""


def _panel(field: WaveField, quantity: str, rows: NDArray[np.int64]) -> Panel:
    """Return one quantity over place, its axis symmetric about zero."""
    shown = QUANTITIES[quantity]
    values = field.values(quantity)[rows] / shown.scale
    most = MARGIN * (float(np.abs(values).max(initial=0.0)) or 1.0)
    return Panel(shown.name, shown.unit, [FieldCurve(INK, *FILLS, values)], label=shown.label, limits=(-most, most))


def _digits(value: float) -> float:
    """Return a value with the seven digits of a 32-bit number, which keeps the page short."""
    return float(f"{value:.7g}")


def write_wave_gif(field: WaveField, title: str, path: Path, progress: Callable[[float], None] | None = None) -> None:
    """Write the waves as a GIF.

    Parameters
    ----------
    field : WaveField
        What is shown, with velocities.
    title : str
        Above it; plain text.
    path : Path
        Where it is written.
    progress : callable, optional
        Called with the share that is done, 0 to 1.
    """
    rows = even_rows(len(field.time), GIF_FRAMES)
    figure, show = _moving(field, title, rows)
    write_gif(path, figure, show, rows.tolist(), progress)


def _moving(field: WaveField, title: str, rows: NDArray[np.int64]) -> tuple[Figure, Callable[[int], None]]:
    """Return a figure of both panels, and what brings it to a row of the field."""
    figure = Figure(figsize=(8.0, 5.4), dpi=_DPI, layout="constrained")
    figure.suptitle(textwrap.fill(printable(title), 90), x=0.01, ha="left", fontsize=10, parse_math=False)
    clock = figure.text(0.99, 0.01, "", ha="right", va="bottom", fontsize=10, family="monospace")
    panels = list(zip(figure.subplots(2, 1, sharex=True), map(QUANTITIES.__getitem__, PANELS), strict=True))
    values = [field.values(shown.name) / shown.scale for _, shown in panels]
    for (axes, shown), rows_of_values in zip(panels, values, strict=True):
        shade_layers(axes, field)
        peak = float(np.abs(rows_of_values).max(initial=0.0)) or 1.0
        axes.set_xlim(0.0, field.ends[-1] / axis_unit("m", "mm")[0])
        axes.set_ylim(-GIF_MARGIN * peak, GIF_MARGIN * peak)
        axes.set_title(shown.label, loc="left", fontsize=9)
        axes.spines[["top", "right"]].set_visible(False)
    name_layers(panels[0][0], field)
    panels[1][0].set_xlabel(distance_label())
    drawn: list[Any] = []
    unit = Clock.of(field.time[rows])

    def show(row: int) -> None:
        while drawn:
            drawn.pop().remove()
        for (axes, _), rows_of_values in zip(panels, values, strict=True):
            drawn.extend(draw_along(axes, field, rows_of_values[row]))
        clock.set_text(f"{field.time[row] / unit.per:.{unit.decimals}f} {unit.unit}")

    return figure, show
