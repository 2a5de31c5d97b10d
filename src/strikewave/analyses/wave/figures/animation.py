"""A pulse on its way through a stack, as a page that plays by itself and as a GIF."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.reporting.animation_page import even_rows, moving_page, packed, printable
from strikewave.reporting.wave_field import (
    DASHED,
    JOINT_STYLES,
    QUANTITIES,
    THICK,
    WaveField,
    draw_along,
    name_layers,
    shade_layers,
    shades,
)
from strikewave.waves import Tap

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

PANELS = ("stress", "velocity")
MOST_FRAMES, GIF_FRAMES = 400, 100
MOST_VALUES = 200_000
"""Values of each panel that a page holds at most: 2.7 bytes each, as 16-bit integers in base 64."""
_LARGEST = 32767
_PER_SECOND, _DPI = 12, 80


def animation_page(field: WaveField, title: str, name: str = "") -> str:
    """Return a page that shows stress and velocity along a stack while a pulse runs through it.

    It stands alone: its data are inside, 16 bits a value, and its policy lets nothing but its own script run.
    It begins to play unless the reader asks for less motion.

    Parameters
    ----------
    field : WaveField
        What is shown, with velocities.
    title, name : str
        Of the page, and of the case; plain text.

    Examples
    --------
    >>> from strikewave import load_case, run_wave
    >>> from strikewave.analyses.wave.field import bar_field
    >>> page = animation_page(bar_field(run_wave(load_case("li-ma-2019-fig13-bar"))), "a < b")
    >>> "<title>a &lt; b</title>" in page, len(page) < 1.5e6
    (True, True)
    """
    document = page_data(field)
    last = {"last_frame": len(document["time"]) - 1, "last_place": len(document["position"]) - 1}
    return moving_page(__package__, document, title, name, **last)


def page_data(field: WaveField) -> dict[str, Any]:
    """Return what the page's script draws from: mm, µs, and values as 16-bit shares of their peaks."""
    rows = even_rows(len(field.time), min(MOST_FRAMES, max(MOST_VALUES // len(field.position), 2)))
    time = field.time[rows] * 1e6
    kept, layers = np.unique(field.layer), field.stack.layers
    greys, ends = shades(field.stack), field.ends
    taps = [{"name": printable(name), "position": _digits(field.place(tap) * 1e3)} for name, tap in field.taps]
    return {
        "time": [_digits(t) for t in time],
        "decimals": _decimals(time),
        "position": [_digits(x * 1e3) for x in field.position],
        "start": _place_of(field, field.taps[0][1]) if field.taps else 0,
        "layer": np.searchsorted(kept, field.layer).tolist(),
        "layers": [
            {
                "name": printable(layers[k].name),
                "begin": _digits((ends[k] - layers[k].length) * 1e3),
                "end": _digits(ends[k] * 1e3),
                "grey": round(255 * greys[k]),
                "joint": "" if k == 0 else _drawn(field.stack.joints[k - 1].kind),
            }
            for k in kept.tolist()
        ],
        "taps": taps,
        "panels": [_panel(field, quantity, rows) for quantity in PANELS],
    }


def _place_of(field: WaveField, tap: Tap) -> int:
    """Return the place of the field nearest to a tap, in the tap's own layer where that has places."""
    elsewhere = np.where(field.layer == tap.layer, 0.0, field.ends[-1])
    return int(np.argmin(np.abs(field.position - field.place(tap)) + elsewhere))


def _drawn(kind: str) -> str:
    """Return how the joint before a layer is drawn: dashed, thick, or as a thin line."""
    style = JOINT_STYLES.get(kind)
    return {None: "", DASHED: "dashed", THICK: "thick"}[style]


def _panel(field: WaveField, quantity: str, rows: NDArray[np.int64]) -> dict[str, Any]:
    """Return one quantity as the page's script reads it."""
    shown = QUANTITIES[quantity]
    counts, peak = quantised(field.values(quantity)[rows] / shown.scale)
    return {"name": shown.name, "unit": shown.unit, "label": shown.label, "peak": peak, "data": packed(counts, "<i2")}


def quantised(values: Array) -> tuple[NDArray[np.int16], float]:
    """Return values as 16-bit shares of their largest magnitude, and that magnitude, 1 where all are zero.

    Examples
    --------
    >>> quantised(np.array([[-2.0, 1.0]]))
    (array([[-32767,  16384]], dtype=int16), 2.0)
    """
    peak = float(np.abs(values).max(initial=0.0)) or 1.0
    return np.rint(values / peak * _LARGEST).astype(np.int16), peak


def _decimals(time: Array) -> int:
    """Return how many decimals tell one time of a row from the next."""
    return int(np.clip(np.ceil(-np.log10(max(float(time[-1]) / len(time), 1e-9))), 0, 6))


def _digits(value: float) -> float:
    return float(f"{value:.7g}")


def write_gif(field: WaveField, title: str, path: Path, progress: Callable[[float], None] | None = None) -> None:
    """Write the same as a GIF, which any slide or page can show.

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
    from matplotlib.animation import PillowWriter
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    rows = even_rows(len(field.time), GIF_FRAMES)
    figure, show = _moving(field, title)
    FigureCanvasAgg(figure).draw()
    figure.set_layout_engine("none")
    writer = PillowWriter(fps=_PER_SECOND)
    with writer.saving(figure, str(path), _DPI):
        for done, row in enumerate(rows):
            show(int(row))
            writer.grab_frame()
            if progress is not None:
                progress((done + 1) / len(rows))


def _moving(field: WaveField, title: str) -> tuple[Figure, Callable[[int], None]]:
    """Return a figure of both panels, and what brings it to a row of the field."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 5.4), layout="constrained")
    figure.suptitle(textwrap.fill(printable(title), 90), x=0.01, ha="left", fontsize=10, parse_math=False)
    clock = figure.text(0.99, 0.01, "", ha="right", va="bottom", fontsize=10, family="monospace")
    panels = list(zip(figure.subplots(2, 1, sharex=True), map(QUANTITIES.__getitem__, PANELS), strict=True))
    values = [field.values(shown.name) / shown.scale for _, shown in panels]
    for (axes, shown), held in zip(panels, values, strict=True):
        shade_layers(axes, field)
        peak = float(np.abs(held).max(initial=0.0)) or 1.0
        axes.set_xlim(0.0, field.ends[-1] * 1e3)
        axes.set_ylim(-1.2 * peak, 1.2 * peak)
        axes.set_title(shown.label, loc="left", fontsize=9)
        axes.spines[["top", "right"]].set_visible(False)
    name_layers(panels[0][0], field)
    panels[1][0].set_xlabel("distance from the loaded face (mm)")
    drawn: list[Any] = []
    decimals = _decimals(field.time[even_rows(len(field.time), GIF_FRAMES)] * 1e6)

    def show(row: int) -> None:
        while drawn:
            drawn.pop().remove()
        for (axes, _), held in zip(panels, values, strict=True):
            drawn.extend(draw_along(axes, field, held[row]))
        clock.set_text(f"{field.time[row] * 1e6:.{decimals}f} µs")

    return figure, show
