"""The same pictures by pyvista, where that is installed."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.fem.figures.pictures.camera import Camera, kept_elements
from strikewave.analyses.fem.figures.pictures.fields import colour_scale, quantity_of
from strikewave.base.errors import InputError
from strikewave.fem.mesh import Mesh
from strikewave.fem.run import FieldFrame

Array = NDArray[np.float64]


def scene(mesh: Mesh, frame: FieldFrame, view: Camera | None = None, quantity: str = "von_mises") -> NDArray[np.uint8]:
    """Render the parts at an instant with pyvista, without a screen: an image (height, width, 3).

    The same view, cut and scale as `body_picture`, by VTK's own hidden surfaces.

    Raises
    ------
    InputError
        If pyvista is not installed or finds nothing to draw with, the field is unknown or the view leaves nothing.
    """
    view, shown = view or Camera(), quantity_of(quantity)
    try:
        pyvista: Any = importlib.import_module("pyvista")
    except ImportError:
        hint = "pip install 'strikewave[mesh]', or use body_picture, which needs matplotlib alone"
        raise InputError("scene", "no pyvista", "an installation with pyvista", hint) from None
    visible = kept_elements(mesh, view)
    cells = np.asarray(shown.of(frame, mesh))[visible] / shown.scale
    scale = colour_scale([cells], view, shown)
    grid = pyvista.UnstructuredGrid({12: mesh.hexahedra[visible]}, mesh.points + view.warp * frame.displacement)
    label = f"{shown.words} ({shown.unit})"
    grid.cell_data[label] = cells
    try:
        plotter = pyvista.Plotter(off_screen=True, window_size=(1400, 1000))
        plotter.set_background("white")
        plotter.add_mesh(
            grid,
            scalars=label,
            cmap="viridis",
            clim=[scale.norm.vmin, scale.norm.vmax],
            show_edges=True,
            line_width=0.5,
            lighting=False,
            scalar_bar_args={
                "color": "black",
                "vertical": True,
                "position_x": 0.82,
                "position_y": 0.2,
                "height": 0.6,
                "title_font_size": 22,
                "label_font_size": 22,
                "fmt": "%.4g",
            },
        )
        plotter.enable_parallel_projection()
        plotter.view_vector(view.toward, viewup=view.up)
        plotter.camera.zoom(1.3)
        image = plotter.screenshot(return_img=True)
        plotter.close()
    except RuntimeError as error:
        hint = "use body_picture, which needs no graphics, or install an OSMesa or EGL build of VTK"
        raise InputError("scene", str(error)[:120], "a machine that VTK can draw on", hint) from None
    return np.asarray(image, np.uint8)
