"""Pictures of the parts of an explicit run in space: cut open, deformed, coloured by what a field says.

`body_picture` draws with matplotlib alone, without a screen: the exterior faces of the elements that a cut leaves are
seen along parallel lines and painted from the farthest to the nearest. Faces that are large against the picture are
divided first, so that painting by distance goes wrong nowhere by more than the size of such a piece. `scene` draws
the same with pyvista, where that is installed.
"""

from __future__ import annotations

import dataclasses
import importlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize, to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from strikewave.base.errors import InputError, MissingPackageError, nearest
from strikewave.fem.mesh import Index, Mesh, exterior
from strikewave.fem.model import Model, SurfaceContact, Symmetry
from strikewave.fem.run import FieldFrame
from strikewave.fem.snapshots import blow_axis, blow_contact, meeting_place, outward
from strikewave.fem.solids import pressure, von_mises
from strikewave.reporting.numbers import ShownQuantity, axis_unit, round_step, time_unit
from strikewave.reporting.style import BLUE, GREEN, GREY, ORANGE, RED, shortened

Array = NDArray[np.float64]

Vector = tuple[float, float, float]

ZONE_FACES = 16.0  # chosen: 32 elements across show mesh lines
"""Largest radius of the zone of a contact over the size of its faces."""
ROUNDING = 1e-9  # beyond rounding, 1e-16, and unseen
"""Share by which the radius of a zone exceeds the distance of a middle in it."""


@dataclass(frozen=True)
class Camera:
    """View of the parts."""

    toward: Vector = (-0.5, -1.0, 0.6)
    """Direction from the parts to the eye."""
    up: Vector = (0.0, 0.0, 1.0)
    """Direction that is up in the picture."""
    cut: tuple[Vector, Vector] | None = None
    """Point and normal of a plane; elements with their middle beyond it are left out."""
    warp: float = 1.0
    """Factor of the displacements."""
    parts: tuple[str, ...] = ()
    """Parts to be drawn; all where empty."""
    near: tuple[Vector, float] | None = None
    """Point and radius; elements with their middle farther away are left out."""
    limits: tuple[float, float] | None = None
    """Ends of the scale of colours, SI; from the least value, or 0, to the largest if absent."""

    def axes(self) -> Array:
        """Return what is right, up and toward the eye in the picture, unit vectors, (3, 3)."""
        toward, up = np.asarray(self.toward, float), np.asarray(self.up, float)
        right = np.cross(up, toward)
        if not float(np.linalg.norm(right)) > 1e-9 * float(np.linalg.norm(toward) * np.linalg.norm(up)):
            raise InputError("view.toward", self.toward, f"a direction other than up, {self.up}")
        frame = np.array([right, np.cross(toward, right), toward])
        return np.asarray(frame / np.linalg.norm(frame, axis=1, keepdims=True))


def view_of(model: Model) -> Camera:
    """Return the view that shows most of a model: onto its planes of symmetry, or else cut along its blow.

    The blow goes along the greatest initial momentum, or what is driven; without either along z.
    """
    mesh = model.mesh
    flat: list[Array] = []  # one normal of each plane: several sides may lie in one
    for normal in (outward(mesh, b.side) for b in model.boundaries if isinstance(b, Symmetry)):
        flat += [normal] if all(abs(normal @ other) < 0.9 for other in flat) else []
    axis = blow_axis(model)
    up = next(e for e in np.eye(3)[[2, 1, 0]] if all(abs(n @ e) < 0.5 for n in flat) or e[0] == 1.0)
    if flat:
        # straight onto the first plane, a little from the second and from above (chosen)
        toward = flat[0] + 0.5 * sum(flat[1:], np.zeros(3)) + 0.4 * up
        if len(flat) == 1:
            toward = toward + 0.35 * np.cross(up, flat[0])
        return Camera(toward=as_vector(toward), up=as_vector(up))
    normal = next(n for n in (np.array([0.0, -1.0, 0.0]), np.array([-1.0, 0.0, 0.0])) if abs(n @ axis) < 0.9)
    middle = 0.5 * (mesh.points.min(axis=0) + mesh.points.max(axis=0))
    # 19 and 24 degrees aside and above (chosen: three sides are seen)
    toward = normal + 0.35 * np.cross(normal, up) + 0.45 * up
    whole = Camera(toward=as_vector(toward), up=as_vector(up))
    cut = dataclasses.replace(whole, cut=(as_vector(middle), as_vector(normal)))
    return cut if _visible(mesh, cut).any() else whole


def contact_zone(model: Model, view: Camera | None = None) -> tuple[Vector, float] | None:
    """Return the middle and a radius of where the bodies of the blow are nearest before it; None without a contact.

    The radius is half the extent of the smaller side, or `ZONE_FACES` times the size of the faces there, and reaches
    at least one element of each body of those that the view shows: a coarse mesh has no middle that near.
    """
    contact, place = blow_contact(model), meeting_place(model)
    if place is None or not isinstance(contact, SurfaceContact):
        return None
    mesh = model.mesh
    one, other = (mesh.points[np.unique(mesh.side(side))] for side in (contact.first, contact.second))
    reach = min(float(np.ptp(points, axis=0).max()) for points in (one, other))
    corners = mesh.points[mesh.side(contact.first)]
    close = np.argsort(np.linalg.norm(corners.mean(axis=1) - place, axis=1))[:4]
    size = float(np.linalg.norm(np.roll(corners[close], -1, axis=1) - corners[close], axis=2).mean())
    radius = min(0.5 * reach, ZONE_FACES * size)
    away = np.linalg.norm(_middles(mesh) - place, axis=1)
    shown = kept_elements(mesh, view or Camera())
    for side in (contact.first, contact.second):
        on_side = shown & np.isin(mesh.hexahedra, mesh.side(side)).any(axis=1)
        radius = max(radius, (1.0 + ROUNDING) * float(away[on_side if on_side.any() else shown].min()))
    return as_vector(place), radius


def as_vector(values: Array) -> Vector:
    """Return three numbers as a tuple of floats."""
    x, y, z = (float(v) for v in values)
    return x, y, z


def _middles(mesh: Mesh) -> Array:
    """Return the middle of each element before the blow, (elements, 3), m."""
    return np.asarray(mesh.points[mesh.hexahedra].mean(axis=1))


def kept_elements(mesh: Mesh, view: Camera) -> NDArray[np.bool_]:
    """Return which elements a view leaves, (elements,), by their middle before the blow."""
    visible = _visible(mesh, view)
    if not visible.any():
        raise InputError("view", "nothing left", "a cut, a zone and parts that leave elements to be drawn")
    return visible


def _visible(mesh: Mesh, view: Camera) -> NDArray[np.bool_]:
    """Return which elements a view leaves, (elements,), perhaps none."""
    middle = _middles(mesh)
    visible = np.ones(len(middle), bool)
    if view.parts:
        visible[:] = False
        for name in view.parts:
            visible[mesh.elements_of(name)] = True
    if view.cut is not None:
        point, normal = (np.asarray(v, float) for v in view.cut)
        visible &= (middle - point) @ normal <= 0.0
    if view.near is not None:
        centre, radius = view.near
        visible &= np.linalg.norm(middle - np.asarray(centre), axis=1) <= radius
    return visible


@dataclass(frozen=True)
class PicturedField(ShownQuantity):
    """A field that can be shown: its words, and its values by element from a frame."""

    words: str
    of: Callable[[FieldFrame, Mesh], Array]


QUANTITIES: Mapping[str, PicturedField] = {
    "von_mises": PicturedField("Pa", "MPa", "von Mises stress", lambda frame, mesh: von_mises(frame.stress)),
    "pressure": PicturedField("Pa", "MPa", "pressure", lambda frame, mesh: pressure(frame.stress)),
    "plastic_strain": PicturedField("1", "%", "equivalent plastic strain", lambda frame, mesh: frame.plastic_strain),
    "speed": PicturedField(
        "m/s", "m/s", "speed", lambda frame, mesh: np.linalg.norm(frame.velocity, axis=1)[mesh.hexahedra].mean(axis=1)
    ),
}


def quantity_of(name: str) -> PicturedField:
    """Return a field that can be shown, by its name."""
    if name not in QUANTITIES:
        raise InputError("quantity", name, "a field that can be shown", nearest(name, QUANTITIES))
    return QUANTITIES[name]


def colour_scale(values: Sequence[Array], view: Camera, shown: PicturedField) -> Any:
    """Return the scale of colours, the same for all frames."""
    if view.limits is not None:
        low, high = (limit / shown.scale for limit in view.limits)
    else:
        low = min(0.0, *(float(cells.min()) for cells in values))
        high = max(float(cells.max()) for cells in values)
    return ScalarMappable(Normalize(low, high if high > low else low + 1.0), "viridis")


def beyond_scale(values: Sequence[Array], scale: Any) -> str:
    """Return at which ends values lie beyond the scale of colours, in the words of matplotlib."""
    below = any(float(cells.min()) < scale.norm.vmin for cells in values)
    above = any(float(cells.max()) > scale.norm.vmax for cells in values)
    return "both" if below and above else "min" if below else "max" if above else "neither"


WIDEST = 4.0  # chosen: a bar of a round length fits below it
"""Largest height of a picture over its width."""


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
    """Return a time in the unit of the histories."""
    size, unit = time_unit(time)
    return f"{time / size:.4g} {unit}"


def frame_window(axes: Any, window: tuple[float, float, float, float], bar: bool = True) -> None:
    """Show a window without axes, and, where asked for, a bar of a round length below the parts, mm."""
    left, right, low, high = window
    axes.set(xlim=(left, right), ylim=(low, high), xticks=[], yticks=[], aspect="equal")
    axes.spines[:].set_visible(False)
    if not bar:
        return
    size, unit = axis_unit("m", "mm")
    round_length = round_step(0.25 * (right - left) * 1e-3 / size)  # at most a quarter of the width
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


PIECES_ACROSS = 90
"""Pieces across a picture; a larger face is divided (chosen: painting by distance then errs by 1 % of the width)."""
MOST_PARTS = 200  # twice those of a face as wide as the picture
"""Most pieces along a side of a face."""
# The middle of a neighbour lies half a size away, so that the line stays on top while bodies in front still hide it.
NEARER = 0.75
"""Distance by which lines are painted nearer to the eye than the pieces they border, in sizes of a piece."""


def paint_faces(
    axes: Any, corners: Array, colours: Array, across: float, smallest_lined: float, lines: Array | None = None
) -> None:
    """Paint the faces that look toward the eye, from the farthest to the nearest, those that look aside darker.

    ``corners`` (faces, 4, 3) go right, up and toward the eye, m, as do ``lines`` (lines, 2, 3), dark ones such as
    outlines. ``across`` is the width of the picture, m; a face larger than ``smallest_lined`` of it has mesh lines.
    """
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    size = np.linalg.norm(normal, axis=1)
    # a face seen edgewise, and one without an area, has nothing to paint
    facing = normal[:, 2] > 1e-9 * np.maximum(size, 1e-300)
    corners, size, normal = corners[facing], size[facing], normal[facing]
    # chosen: shape is seen, and colours still compare with the scale
    colour = colours[facing] * (0.78 + 0.22 * normal[:, 2] / size)[:, None]
    lined = np.sqrt(0.5 * normal[:, 2]) > smallest_lined * across
    pieces, of, meshed = _divided(corners, across / PIECES_ACROSS, lined)
    fill = colour[of]
    edge, width = np.where(meshed[:, None], 0.45 * fill, fill), np.where(meshed, 0.35, 0.5)
    if lines is not None and len(lines):
        strokes = _outlines(lines, across / PIECES_ACROSS)
        dark = np.full((len(strokes), 3), 0.13)
        pieces, fill, edge = (np.concatenate(p) for p in ((pieces, strokes), (fill, dark), (edge, dark)))
        width = np.concatenate([width, np.full(len(strokes), 0.7)])
    # stable: equal distances keep the order of the mesh, so that files repeat
    order = np.argsort(pieces[:, :, 2].mean(axis=1), kind="stable")
    flat: Any = pieces[order][:, :, :2] * 1e3
    collection = PolyCollection(
        flat, facecolors=fill[order], edgecolors=edge[order], linewidths=width[order], rasterized=True
    )
    collection.set_joinstyle("round")
    collection.set_snap(False)
    axes.add_collection(collection, autolim=False)


def _outlines(lines: Array, largest: float) -> Array:
    """Return lines (lines, 2, 3) as flat pieces (pieces, 4, 3) of about a size, a hair nearer to the eye."""
    count = np.clip(np.ceil(np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1) / largest), 1, MOST_PARTS).astype(int)
    of = np.repeat(np.arange(len(lines)), count)
    begin = (np.arange(len(of)) - np.repeat(np.cumsum(count) - count, count)) / count[of]
    way = lines[of, 1] - lines[of, 0]
    start = lines[of, 0] + begin[:, None] * way
    end = start + way / count[of, None]
    pieces = np.stack([start, end, end, start], axis=1)
    pieces[..., 2] += NEARER * largest
    return pieces


def _divided(
    corners: Array, largest: float, lined: NDArray[np.bool_]
) -> tuple[Array, NDArray[np.intp], NDArray[np.bool_]]:
    """Divide faces (faces, 4, 3) into pieces (pieces, 4, 3) of about a size; return also their faces and mesh lines.

    Mesh lines of a divided face are flat pieces along its sides; a face that is not divided is its own.
    """
    sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    longest = np.maximum(sides[:, :2], sides[:, 2:])
    counts = np.clip(np.ceil(longest / largest), 1, MOST_PARTS).astype(int)
    pieces, of, lines = [], [], []
    for n, m in np.unique(counts, axis=0):
        group = np.flatnonzero((counts == (n, m)).all(axis=1))
        cells, bordered = _cells(corners[group], int(n), int(m)), lined[group]
        pieces.append(cells.reshape(-1, 4, 3))
        of.append(np.repeat(group, n * m))
        lines.append(np.repeat(bordered & (n * m == 1), n * m))
        if n * m > 1:
            pieces.append(_strokes(cells[bordered]).reshape(-1, 4, 3))
            of.append(np.repeat(group[bordered], 2 * (n + m)))
            lines.append(np.ones(len(pieces[-1]), bool))
    return np.concatenate(pieces), np.concatenate(of), np.concatenate(lines)


def _cells(corners: Array, n: int, m: int) -> Array:
    """Divide faces bilinearly into n x m pieces, (faces, n, m, 4, 3)."""
    u, v = np.linspace(0.0, 1.0, n + 1)[:, None, None], np.linspace(0.0, 1.0, m + 1)[None, :, None]
    a, b, c, d = (corners[:, None, None, k] for k in range(4))
    grid = (1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d
    return np.stack([grid[:, :-1, :-1], grid[:, 1:, :-1], grid[:, 1:, 1:], grid[:, :-1, 1:]], axis=3)


def _strokes(cells: Array) -> Array:
    """Return the outer sides of divided faces (faces, n, m, 4, 3) as flat pieces (faces, 2 (n + m), 4, 3).

    They lie a hair nearer to the eye than the pieces they border.
    """
    lower, upper = cells[:, :, 0][:, :, [0, 1, 1, 0]], cells[:, :, -1][:, :, [3, 2, 2, 3]]
    left, right = cells[:, 0][:, :, [0, 3, 3, 0]], cells[:, -1][:, :, [1, 2, 2, 1]]
    strokes = np.concatenate([lower, upper, left, right], axis=1)
    strokes[..., 2] += NEARER * float(np.ptp(cells[:, 0, 0], axis=1).max(initial=0.0))
    return strokes


SMALLEST_LINED, SMALLEST_MESHED = 0.012, 0.006
"""Smallest share of the picture's width at which a face has mesh lines: in pictures of fields, and of the mesh."""
PART_COLOURS = (BLUE, ORANGE, GREEN, RED, "#CC79A7", "#56B4E9", GREY, "#F0E442")
"""Colours of parts in their order: those of Okabe and Ito, with grey for black, which would hide mesh lines."""


def body_picture(mesh: Mesh, frame: FieldFrame, view: Camera | None = None, quantity: str = "von_mises") -> Figure:
    """Draw the parts at an instant, coloured by one of `QUANTITIES`, with matplotlib alone."""
    return frames_picture(mesh, [frame], view, quantity)


def frames_picture(
    mesh: Mesh, frames: Sequence[FieldFrame], view: Camera | None = None, quantity: str = "von_mises"
) -> Figure:
    """Draw the parts at several instants side by side, in one scale of colours; see `body_picture`."""
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
    """Draw the mesh before the blow, each part in its colour, with matplotlib alone."""
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
    axes: Any, mesh: Mesh, moved: Array, seen: tuple[Camera, NDArray[np.bool_]], colours: Array, smallest_lined: float
) -> None:
    """Paint the exterior faces of the elements that are kept, from the farthest to the nearest."""
    view, visible = seen
    frame = view.axes()
    faces, element = exterior(mesh.hexahedra[visible])
    corners = moved[faces] @ frame.T
    across = float(np.ptp(corners.reshape(-1, 3)[:, :2], axis=0).max()) or 1.0
    paint_faces(axes, corners, colours[np.flatnonzero(visible)[element]], across, smallest_lined)


def scene(mesh: Mesh, frame: FieldFrame, view: Camera | None = None, quantity: str = "von_mises") -> NDArray[np.uint8]:
    """Render `body_picture` with pyvista, without a screen: an image (height, width, 3), by VTK's hidden surfaces."""
    view, shown = view or Camera(), quantity_of(quantity)
    try:
        pyvista: Any = importlib.import_module("pyvista")
    except ImportError:
        raise MissingPackageError("scene", "pyvista", "mesh") from None
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
