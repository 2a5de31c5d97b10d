"""Parts in a field or by their mesh, drawn with matplotlib alone, without a screen."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray

from strikewave.analyses.fem.figures.pictures.camera import Camera, kept_elements
from strikewave.analyses.fem.figures.pictures.fields import beyond_scale, colour_scale, quantity_of
from strikewave.analyses.fem.figures.pictures.painting import paint_faces
from strikewave.analyses.fem.figures.pictures.windows import frame_window, instant_words, window_about
from strikewave.base.errors import InputError
from strikewave.fem.mesh import Mesh, exterior
from strikewave.fem.run import FieldFrame
from strikewave.reporting.curves import shortened
from strikewave.reporting.style import BLUE, GREEN, GREY, ORANGE, RED

Array = NDArray[np.float64]

SMALLEST_LINED, SMALLEST_MESHED = 0.012, 0.006
"""Faces smaller than this share of the picture's width have no mesh lines: in pictures of fields, of the mesh."""
PART_COLOURS = (BLUE, ORANGE, GREEN, RED, "#CC79A7", "#56B4E9", GREY, "#F0E442")
"""Of parts in their order: the eight colours of Okabe and Ito, with grey for black, which would hide mesh lines."""


def body_picture(mesh: Mesh, frame: FieldFrame, view: Camera | None = None, quantity: str = "von_mises") -> Figure:
    """Draw the parts at an instant, coloured by a field, with matplotlib alone.

    Parameters
    ----------
    mesh : Mesh
        What was run.
    frame : FieldFrame
        The instant.
    view : Camera, optional
        From where, cut where.
    quantity : str, optional
        One of `QUANTITIES`.

    Raises
    ------
    InputError
        If the field is unknown or the view leaves nothing.
    """
    return frames_picture(mesh, [frame], view, quantity)


def frames_picture(
    mesh: Mesh, frames: Sequence[FieldFrame], view: Camera | None = None, quantity: str = "von_mises"
) -> Figure:
    """Draw the parts at several instants side by side, in one scale of colours; see `body_picture`.

    Raises
    ------
    InputError
        If there is no frame, the field is unknown or the view leaves nothing.
    """
    view, shown = view or Camera(), quantity_of(quantity)
    if not frames:
        raise InputError("frames", "none", "at least one")
    visible = kept_elements(mesh, view)
    values = [np.asarray(shown.of(frame, mesh)) / shown.scale for frame in frames]
    places = [mesh.points + view.warp * frame.displacement for frame in frames]
    scale = colour_scale([cells[visible] for cells in values], view, shown)
    window = window_about(mesh.hexahedra[visible], places, view)
    columns = min(len(frames), 3)
    rows = -(-len(frames) // columns)
    width, aspect = (9.8 if columns > 1 else 6.4), (window[3] - window[2]) / (window[1] - window[0])
    height = float(np.clip((width - 1.2) / columns * aspect, 1.2, 5.5)) + 0.35
    figure = Figure(figsize=(width, rows * height), dpi=160, layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes, frame, moved, cells in zip(panels, frames, places, values, strict=False):
        _paint(axes, mesh, moved, (view, visible), scale.to_rgba(cells)[:, :3], SMALLEST_LINED)
        frame_window(axes, window)
        larger = "" if view.warp == 1.0 else f", displacements × {view.warp:g}"
        axes.set_title(instant_words(frame.time) + larger, loc="left", fontsize=9)
    for axes in panels[len(frames) :]:
        axes.set_axis_off()
    extend = beyond_scale([cells[visible] for cells in values], scale)
    bar = figure.colorbar(scale, ax=list(panels), shrink=0.85, pad=0.01, aspect=24, extend=extend)
    bar.set_label(f"{shown.words} ({shown.unit})")
    return figure


def mesh_picture(mesh: Mesh, view: Camera | None = None) -> Figure:
    """Draw the mesh before the blow, each part in its colour, with matplotlib alone.

    Raises
    ------
    InputError
        If the view leaves nothing.
    """
    view = view or Camera()
    visible = kept_elements(mesh, view)
    palette = np.array([to_rgb(PART_COLOURS[k % len(PART_COLOURS)]) for k in range(len(mesh.names))])
    palette = 0.35 + 0.65 * palette  # pale, so that the mesh lines stand out
    window = window_about(mesh.hexahedra[visible], [mesh.points], view)
    height = 0.5 + float(np.clip(4.7 * (window[3] - window[2]) / (window[1] - window[0]), 1.0, 5.5))
    figure = Figure(figsize=(4.9, height), dpi=200, layout="constrained")
    axes = figure.add_subplot()
    _paint(axes, mesh, mesh.points, (view, visible), palette[mesh.part], SMALLEST_MESHED)
    frame_window(axes, window)
    present = np.unique(mesh.part[visible])
    patches = [Patch(color=tuple(palette[k]), label=shortened(mesh.names[k], 28)) for k in present[:12]]
    legend = figure.legend(
        handles=patches, loc="outside lower center", ncols=3, frameon=False, fontsize=8, handlelength=1.2
    )
    for text in legend.get_texts():
        text.set_parse_math(False)
    return figure


def _paint(
    axes: Any,
    mesh: Mesh,
    moved: Array,
    seen: tuple[Camera, NDArray[np.bool_]],
    colours: Array,
    smallest_lined: float,
) -> None:
    """Paint the exterior faces of the elements that are kept, from the farthest to the nearest."""
    view, visible = seen
    frame = view.axes()
    faces, element = exterior(mesh.hexahedra[visible])
    corners = moved[faces] @ frame.T
    across = float(np.ptp(corners.reshape(-1, 3)[:, :2], axis=0).max()) or 1.0
    paint_faces(axes, corners, colours[np.flatnonzero(visible)[element]], across, smallest_lined)
