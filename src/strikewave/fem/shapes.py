"""Meshes of bodies bounded by planes, and how a mesh is moved, turned and renamed; SI.

Round bodies are in `strikewave.fem.round_shapes`. Every function returns a mesh of one part with named sides.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from strikewave.base.errors import InputError
from strikewave.fem.grading import Sizes, nodes_between, nodes_through
from strikewave.fem.mesh import Mesh
from strikewave.fem.sections import (
    PlaneMesh,
    Sector,
    extruded,
    grid_section,
    mirror_axes,
    part_mesh,
    plane,
    positive,
)

Vector = tuple[float, float, float]


def block(name: str, size: Vector, x: Sizes, y: Sizes, z: Sizes) -> Mesh:
    """Return a block, centred on the z axis, that stands on z = 0.

    Parameters
    ----------
    name : str
        Of the part.
    size : tuple of float
        Width along x, depth along y, height along z, m.
    x, y, z : float or Grading
        Sizes of elements, m; a position of a grading counts from the lower end.

    Returns
    -------
    Mesh
        With the sides ``x-``, ``x+``, ``y-``, ``y+``, ``z-``, ``z+``.

    Raises
    ------
    InputError
        If a size is not above 0.

    Examples
    --------
    >>> bar = block("bar", (0.01, 0.01, 0.1), 0.005, 0.005, 0.01)
    >>> len(bar.hexahedra), len(bar.side("bar.z+")), len(bar.side("bar.x-"))
    (40, 4, 20)
    """
    width, depth, height = (positive(f"{name}.size", value) for value in size)
    across, deep, up = nodes_between(0.0, width, x), nodes_between(0.0, depth, y), nodes_between(0.0, height, z)
    points, hexahedra = extruded(grid_section(across - 0.5 * width, deep - 0.5 * depth), up)
    ends = {"x": (-0.5 * width, 0.5 * width), "y": (-0.5 * depth, 0.5 * depth), "z": (0.0, height)}
    sides = {
        f"{letter}{sign}": plane(axis, end, max(size))
        for axis, (letter, pair) in enumerate(ends.items())
        for sign, end in zip("-+", pair, strict=True)
    }
    return part_mesh(name, points, hexahedra, sides)


@dataclass(frozen=True)
class FrameSize:
    """Sizes of a frame, m: outside along x, y, z, and the thickness of its four walls.

    Parameters
    ----------
    width, depth, height : float
        Along x, y and z.
    left, right, bottom, top : float
        Thickness of the walls around the opening.
    """

    width: float
    depth: float
    height: float
    left: float
    right: float
    bottom: float
    top: float

    def __post_init__(self) -> None:
        for name in ("width", "depth", "height", "left", "right", "bottom", "top"):
            positive(name, getattr(self, name))
        for name, walls in (("width", self.left + self.right), ("height", self.bottom + self.top)):
            if not walls < getattr(self, name):
                raise InputError(name, getattr(self, name), f"above the thickness of its two walls, {walls:g} m")


def frame(name: str, size: FrameSize, x: Sizes, y: Sizes, z: Sizes, sector: Sector = "whole") -> Mesh:
    """Return a rectangular frame around an opening along y, centred on the z axis, that stands on z = 0.

    Parameters
    ----------
    name : str
        Of the part.
    size : FrameSize
        m.
    x, y, z : float or Grading
        Sizes of elements, m; a position of a grading counts from the lower end. Nodes lie on the opening's edges.
    sector : str
        "whole"; "half", y >= 0; or "quarter", x >= 0 too.

    Returns
    -------
    Mesh
        With the sides ``left``, ``right``, ``bottom``, ``top``, ``front`` (y-), ``back`` (y+), and around the opening
        ``inner_left``, ``inner_right``, ``inner_bottom``, ``inner_top``; where it is cut, ``y-`` instead of ``front``
        and ``x-`` instead of ``left`` and ``inner_left``.

    Raises
    ------
    InputError
        If the sector is not known, or a quarter is asked for of a frame whose walls left and right differ.

    Examples
    --------
    >>> part = frame("frame", FrameSize(0.06, 0.02, 0.08, 0.01, 0.01, 0.01, 0.01), 0.005, 0.005, 0.005)
    >>> len(part.hexahedra), len(part.side("frame.inner_top"))
    (384, 32)
    """
    mirror_axes(sector)
    if sector == "quarter" and size.left != size.right:
        raise InputError("sector", sector, "whole or half: the walls left and right differ")
    low_x = 0.0 if sector == "quarter" else -0.5 * size.width
    low_y = -0.5 * size.depth if sector == "whole" else 0.0
    up = nodes_through([0.0, size.bottom, size.height - size.top, size.height], z)
    inner_x = (size.left - 0.5 * size.width, 0.5 * size.width - size.right)
    inner_z = (size.bottom, size.height - size.top)
    walls = [0.0, *(wall - low_x for wall in inner_x if wall > low_x), 0.5 * size.width - low_x]
    full = grid_section(up, nodes_through(walls, x) + low_x)
    middle = full.points[full.quads].mean(axis=1)
    low, high = np.array([inner_z, inner_x]).T
    opening = np.all((middle > low) & (middle < high), axis=1)
    deep = nodes_between(0.0, 0.5 * size.depth - low_y, y) + low_y
    points, hexahedra = extruded(PlaneMesh(full.points, full.quads[~opening]), deep)
    scale = max(size.width, size.depth, size.height)
    left = {"x-": (0, 0.0)} if sector == "quarter" else {"left": (0, low_x), "inner_left": (0, inner_x[0])}
    places = {
        **left,
        "right": (0, 0.5 * size.width),
        "bottom": (2, 0.0),
        "top": (2, size.height),
        "front" if sector == "whole" else "y-": (1, low_y),
        "back": (1, 0.5 * size.depth),
        "inner_right": (0, inner_x[1]),
        "inner_bottom": (2, inner_z[0]),
        "inner_top": (2, inner_z[1]),
    }
    sides = {side: plane(axis, value, scale) for side, (axis, value) in places.items()}
    return part_mesh(name, np.roll(points, -1, axis=1), hexahedra, sides)


def moved(mesh: Mesh, way: Vector) -> Mesh:
    """Return a mesh moved by a vector, m.

    Examples
    --------
    >>> float(moved(block("b", (1.0, 1.0, 1.0), 1.0, 1.0, 1.0), (0.0, 0.0, 2.0)).points[:, 2].min())
    2.0
    """
    return replace(mesh, points=mesh.points + np.asarray(way, float))


def turned(mesh: Mesh, axis: Vector, angle: float, about: Vector = (0.0, 0.0, 0.0)) -> Mesh:
    """Return a mesh turned by an angle, rad, right-handed about an axis through a point (Rodrigues' formula).

    Raises
    ------
    InputError
        If the axis has no length.

    Examples
    --------
    >>> quarter_turn = turned(block("b", (2.0, 1.0, 1.0), 1.0, 1.0, 1.0), (0.0, 0.0, 1.0), np.pi / 2)
    >>> quarter_turn.points.max(axis=0).round(12).tolist()
    [0.5, 1.0, 1.0]
    """
    along = np.asarray(axis, float)
    length = float(np.linalg.norm(along))
    if not 0.0 < length < math.inf:
        raise InputError("axis", tuple(axis), "a direction of some length")
    x, y, z = along / length
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn = np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross
    return replace(mesh, points=(mesh.points - about) @ turn.T + about)


def renamed(mesh: Mesh, names: Mapping[str, str]) -> Mesh:
    """Return a mesh whose parts have new names, with their sides; parts that are not named keep theirs.

    Examples
    --------
    >>> renamed(block("b", (1.0, 1.0, 1.0), 1.0, 1.0, 1.0), {"b": "anvil"}).names
    ('anvil',)
    """
    for name in names:
        mesh.elements_of(name)

    def new(side: str) -> str:
        part, _, rest = side.rpartition(".")
        return f"{names.get(part, part)}.{rest}"

    sides = {new(side): faces for side, faces in mesh.sides.items()}
    return replace(mesh, names=tuple(names.get(name, name) for name in mesh.names), sides=sides)
