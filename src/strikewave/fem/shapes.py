"""Meshes of bodies: blocks, frames, cylinders, tubes, balls, half-spaces; moved, turned and renamed; SI.

Every function returns a mesh of one part with named sides.

The axis of a round body is z. A sector is the whole body, the half with y >= 0, or the quarter with x >= 0 and y >= 0;
the cut faces are the sides ``x-`` and ``y-``.

A ball is meshed by bending: a half-ball whose flat face carries a fine core is mapped by the inversion of space that
turns its flat face into the lower hemisphere and its dome into the equator's disc. An inversion keeps all angles
(Liouville), so that the bent mesh is as good as the straight one. The upper half is bent from a coarser half-ball
with the same dome, and mirrored.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from strikewave.base.errors import InputError
from strikewave.fem import sections
from strikewave.fem.mesh import Array, Index, Mesh
from strikewave.fem.sections import Grading, PlaneMesh, Sector, Sizes, Surface

Vector = tuple[float, float, float]


def block(name: str, size: Vector, x: Sizes, y: Sizes, z: Sizes) -> Mesh:
    """Return a block, centred on the z axis, that stands on z = 0.

    ``size`` is its width along x, depth along y and height along z, m; a position of a grading counts from the lower
    end. Sides are ``x-``, ``x+``, ``y-``, ``y+``, ``z-``, ``z+``.
    """
    width, depth, height = (sections.positive(f"{name}.size", value) for value in size)
    across, deep, up = (
        sections.nodes_between(0.0, width, x),
        sections.nodes_between(0.0, depth, y),
        sections.nodes_between(0.0, height, z),
    )
    points, hexahedra = sections.extruded(sections.grid_section(across - 0.5 * width, deep - 0.5 * depth), up)
    ends = {"x": (-0.5 * width, 0.5 * width), "y": (-0.5 * depth, 0.5 * depth), "z": (0.0, height)}
    sides = {
        f"{letter}{sign}": sections.plane(axis, end, max(size))
        for axis, (letter, pair) in enumerate(ends.items())
        for sign, end in zip("-+", pair, strict=True)
    }
    return sections.part_mesh(name, points, hexahedra, sides)


@dataclass(frozen=True)
class FrameSize:
    """Sizes of a frame, m: outside along x, y, z, and the thickness of its four walls."""

    width: float
    """Size along x."""
    depth: float
    """Size along y."""
    height: float
    """Size along z."""
    left: float
    """Thickness of the wall on the left."""
    right: float
    """Thickness of the wall on the right."""
    bottom: float
    """Thickness of the wall below."""
    top: float
    """Thickness of the wall above."""

    def __post_init__(self) -> None:
        for name in ("width", "depth", "height", "left", "right", "bottom", "top"):
            sections.positive(name, getattr(self, name))
        for name, walls in (("width", self.left + self.right), ("height", self.bottom + self.top)):
            if not walls < getattr(self, name):
                raise InputError(name, getattr(self, name), f"above the thickness of its two walls, {walls:g} m")


def frame(name: str, size: FrameSize, x: Sizes, y: Sizes, z: Sizes, sector: Sector = "whole") -> Mesh:
    """Return a rectangular frame around an opening along y, centred on the z axis, that stands on z = 0.

    A position of a grading counts from the lower end; nodes lie on the opening's edges. Sides are ``left``, ``right``,
    ``bottom``, ``top``, ``front`` (y-), ``back`` (y+), and around the opening ``inner_left``, ``inner_right``,
    ``inner_bottom``, ``inner_top``; where it is cut, ``y-`` instead of ``front`` and ``x-`` instead of ``left`` and
    ``inner_left``. A quarter needs walls left and right that are alike.
    """
    sections.mirror_axes(sector)
    if sector == "quarter" and size.left != size.right:
        raise InputError("sector", sector, "whole or half: the walls left and right differ")
    low_x = 0.0 if sector == "quarter" else -0.5 * size.width
    low_y = -0.5 * size.depth if sector == "whole" else 0.0
    up = sections.nodes_through([0.0, size.bottom, size.height - size.top, size.height], z)
    inner_x = (size.left - 0.5 * size.width, 0.5 * size.width - size.right)
    inner_z = (size.bottom, size.height - size.top)
    walls = [0.0, *(wall - low_x for wall in inner_x if wall > low_x), 0.5 * size.width - low_x]
    full = sections.grid_section(up, sections.nodes_through(walls, x) + low_x)
    middle = full.points[full.quads].mean(axis=1)
    low, high = np.array([inner_z, inner_x]).T
    opening = np.all((middle > low) & (middle < high), axis=1)
    deep = sections.nodes_between(0.0, 0.5 * size.depth - low_y, y) + low_y
    points, hexahedra = sections.extruded(PlaneMesh(full.points, full.quads[~opening]), deep)
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
    sides = {side: sections.plane(axis, value, scale) for side, (axis, value) in places.items()}
    return sections.part_mesh(name, np.roll(points, -1, axis=1), hexahedra, sides)


def moved(mesh: Mesh, way: Vector) -> Mesh:
    """Return a mesh moved by a vector, m."""
    return replace(mesh, points=mesh.points + np.asarray(way, float))


def turned(mesh: Mesh, axis: Vector, angle: float, about: Vector = (0.0, 0.0, 0.0)) -> Mesh:
    """Return a mesh turned by an angle, rad, right-handed about an axis through a point (Rodrigues' formula)."""
    along = np.asarray(axis, float)
    length = float(np.linalg.norm(along))
    if not 0.0 < length < math.inf:
        raise InputError("axis", tuple(axis), "a direction of some length")
    x, y, z = along / length
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn = np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross
    return replace(mesh, points=(mesh.points - about) @ turn.T + about)


def renamed(mesh: Mesh, names: Mapping[str, str]) -> Mesh:
    """Return a mesh whose parts have new names, with their sides; parts that are not named keep theirs."""
    for name in names:
        mesh.elements_of(name)

    def new(side: str) -> str:
        part, _, rest = side.rpartition(".")
        return f"{names.get(part, part)}.{rest}"

    sides = {new(side): faces for side, faces in mesh.sides.items()}
    return replace(mesh, names=tuple(names.get(name, name) for name in mesh.names), sides=sides)


Body = tuple[Array, Index]
"""Points and hexahedra."""

CORNER = (7.0 * sections.BULGE - 2.0) / 12.0  # its corner, where four elements meet, has the tetrahedron's arccos(-1/3)
"""Coefficient c of a core in a ball, x = u sqrt(1 - b (v^2 + w^2) / 2 + c v^2 w^2)."""


def cylinder(name: str, diameter: float, length: float, across: Sizes, along: Sizes, sector: Sector = "whole") -> Mesh:
    """Return a solid cylinder that stands on z = 0.

    Sizes ``across`` are over the distance from the axis, where only a fine zone at the axis is used; positions
    ``along`` z count from the bottom. Sides are ``bottom``, ``top``, ``round``, and ``y-`` and ``x-`` where it is cut.
    """
    grading = sections.as_grading(across)
    radius = 0.5 * sections.positive(f"{name}.diameter", diameter)
    half_width, count = sections.core_half_width(radius, grading)
    heights = sections.nodes_between(0.0, sections.positive(f"{name}.length", length), along)
    points, hexahedra = sections.extruded(
        sections.disc_section(sections.shell_radii(half_width, radius, grading), count, sector), heights
    )
    scale = max(diameter, length)
    sides = {
        "bottom": sections.plane(2, 0.0, scale),
        "top": sections.plane(2, length, scale),
        "round": _on_cylinder(radius),
        **_cuts(sector, scale),
    }
    return sections.part_mesh(name, points, hexahedra, sides)


@dataclass(frozen=True)
class TubeSize:
    """Sizes of a tube, m; an end is closed where its thickness is not 0."""

    inner: float
    """Inner diameter."""
    outer: float
    """Outer diameter."""
    length: float
    """Length with the closed ends."""
    bottom: float = 0.0
    """Thickness of the lower end."""
    top: float = 0.0
    """Thickness of the upper end."""

    def __post_init__(self) -> None:
        if not 0.0 < self.inner < self.outer < math.inf:
            raise InputError("inner", self.inner, f"above 0, below the outer diameter {self.outer:g} m")
        if min(self.bottom, self.top) < 0.0 or not self.bottom + self.top < self.length < math.inf:
            raise InputError("length", self.length, f"above the thickness of the ends, {self.bottom + self.top:g} m")


def tube(name: str, size: TubeSize, across: Sizes, along: Sizes, sector: Sector = "whole") -> Mesh:
    """Return a tube that stands on z = 0, with closed ends where they have a thickness: a cup, or a closed shell.

    Sides are ``bottom``, ``top``, ``round``, ``inner_round``; ``inner_bottom`` and ``inner_top`` of closed ends; and
    ``y-`` and ``x-`` where it is cut.
    """
    grading = sections.as_grading(across)
    bore = 0.5 * size.inner
    half_width, count = sections.core_half_width(0.5 * size.outer, grading)
    wall = sections.ring_section(sections.nodes_between(bore, 0.5 * size.outer, grading), count, sector)
    section = wall
    if size.bottom or size.top:
        radii = sections.shell_radii(min(half_width, sections.CORE * bore), bore, grading)
        section = sections.merged_sections([wall, sections.disc_section(radii, count, sector)])
    heights = sections.nodes_through(sorted({0.0, size.bottom, size.length - size.top, size.length}), along)
    middle = 0.5 * (heights[:-1] + heights[1:])
    closed = (middle < size.bottom) | (middle > size.length - size.top)
    in_wall = np.all(np.hypot(*section.points.T)[section.quads] > (1.0 - sections.ON_SURFACE) * bore, axis=1)
    points, hexahedra = sections.extruded(section, heights, closed[:, None] | in_wall)
    scale = max(size.outer, size.length)
    ends = {"inner_bottom": size.bottom, "inner_top": size.length - size.top if size.top else 0.0}
    sides = {
        "bottom": sections.plane(2, 0.0, scale),
        "top": sections.plane(2, size.length, scale),
        "round": _on_cylinder(0.5 * size.outer),
        "inner_round": _on_cylinder(bore),
        **{side: sections.plane(2, z, scale) for side, z in ends.items() if z},
        **_cuts(sector, scale),
    }
    return sections.part_mesh(name, points, hexahedra, sides)


def half_cylinder(
    name: str, radius: float, length: float, sizes: Sizes, along: Sizes, sector: Sector = "whole"
) -> Mesh:
    """Return a half cylinder with its axis along y, its round side down and its flat side at z = 0.

    y goes from minus to plus half the length. ``sizes`` are over the distance along the round side from its lowest
    line, where only a fine zone is used; positions ``along`` the axis count from the front, or from the middle where it
    is cut there. Sides are ``round``, ``top``, ``front`` (y-), ``back`` (y+); where it is cut, ``y-`` instead of
    ``front``, and ``x-``.
    """
    grading = sections.as_grading(sizes)
    sections.positive(f"{name}.length", length)
    half_width, count = sections.core_half_width(sections.positive(f"{name}.radius", radius), grading)
    arcs = sections.shell_radii(half_width, 0.5 * math.pi * radius, grading)
    straight = sections.disc_section(_straightened(arcs, radius), count, "quarter")
    x, z = _bent(straight.points, radius).T
    section = PlaneMesh(np.column_stack([z, x]), straight.quads[:, ::-1])
    if sections.mirror_axes(sector):
        section = sections.merged_sections([section, sections.mirrored(section, 1)])
    low = -0.5 * length if sector == "whole" else 0.0
    points, hexahedra = sections.extruded(section, sections.nodes_between(0.0, 0.5 * length - low, along) + low)
    points = np.roll(points, -1, axis=1)
    scale = max(radius, length)
    sides = {
        "round": lambda at: np.abs(np.hypot(at[:, 0], at[:, 2]) - radius) <= sections.ON_SURFACE * radius,
        "top": sections.plane(2, 0.0, scale),
        "back": sections.plane(1, 0.5 * length, scale),
        **({"front": sections.plane(1, low, scale)} if sector == "whole" else _cuts(sector, scale)),
    }
    return sections.part_mesh(name, points, hexahedra, sides)


def half_space(name: str, radius: float, sizes: Sizes, sector: Sector = "whole") -> Mesh:
    """Return a half-ball below its flat face at z = 0, fine at the centre of that face: a half-space cut off.

    Sides are ``top``, ``round``, and ``y-`` and ``x-`` where it is cut.
    """
    grading = sections.as_grading(sizes)
    half_width, count = sections.core_half_width(sections.positive(f"{name}.radius", radius), grading)
    body = _mirrored(_half_ball(sections.shell_radii(half_width, radius, grading), count), 2)
    points, hexahedra = sections.renumbered(*_sector(body, sector))
    sides = {"top": sections.plane(2, 0.0, radius), "round": _on_ball(radius), **_cuts(sector, radius)}
    return sections.part_mesh(name, points, hexahedra, sides)


def ball(name: str, radius: float, sizes: Sizes, sector: Sector = "whole", lower_half: bool = False) -> Mesh:
    """Return a ball about the origin, graded from its lowest point, or what lies below its equator alone.

    ``sizes`` are over the distance from the lowest point along the surface, where only a fine zone is used; one size
    gives a ball with a cube at its centre instead of one at its lowest point. Sides are ``round``, ``top`` of a lower
    half, and ``y-`` and ``x-`` where it is cut.
    """
    grading = sections.as_grading(sizes)
    half_width, count = sections.core_half_width(sections.positive(f"{name}.radius", radius), grading)
    if grading.fine is None:
        upper = _half_ball(sections.shell_radii(half_width, radius, grading), count)
        body = _mirrored(upper, 2)
    else:
        equator = 0.5 * math.pi * radius
        body = _bent_half_ball(sections.shell_radii(half_width, equator, grading), count)
        upper = _mirrored(
            _bent_half_ball(sections.shell_radii(0.5 * equator, equator, Grading(grading.coarse)), count), 2
        )
    if not lower_half:
        body = _merged([body, upper])
    points, hexahedra = sections.renumbered(*_sector(body, sector))
    sides = {
        "round": _on_ball(radius),
        **({"top": sections.plane(2, 0.0, radius)} if lower_half else {}),
        **_cuts(sector, radius),
    }
    return sections.part_mesh(name, points, hexahedra, sides)


def _half_ball(depths: Array, count: int) -> Body:
    """Return a quarter (x, y >= 0) of the half-ball z >= 0: a bulging core in shells at the given depths.

    The first depth is the half-width of the core, the last the radius; ``count`` elements lie along the half-width.
    """
    sections.refuse_too_many(4.0 * count**2 * (count + 3.0 * len(depths)))
    u, v, w = np.meshgrid(*3 * [np.linspace(0.0, 1.0, count + 1)], indexing="ij")
    core = depths[0] * np.stack([_bulging(u, v, w), _bulging(v, w, u), _bulging(w, u, v)], axis=-1)
    slant = np.tan(0.25 * math.pi * np.linspace(0.0, 1.0, count + 1))
    slant[-1] = 1.0
    rim = np.stack(np.broadcast_arrays(1.0, slant[:, None], slant[None, :]), axis=-1)
    rim *= depths[-1] / np.linalg.norm(rim, axis=-1, keepdims=True)
    share = ((depths - depths[0]) / (depths[-1] - depths[0]))[:, None, None, None]
    shells = (1.0 - share) * core[-1] + share * rim
    return _merged([_grid(core), *(_grid(np.roll(shells, turn, axis=-1)) for turn in range(3))])


def _bulging(u: Array, v: Array, w: Array) -> Array:
    """Return the coordinate of a cube's point along u whose faces bulge; see `BULGE` and `CORNER`."""
    return u * np.sqrt(1.0 - sections.BULGE * (v**2 + w**2) / 2.0 + CORNER * v**2 * w**2)


def _bent_half_ball(arcs: Array, count: int) -> Body:
    """Return a quarter of the lower half of a ball, from shells that leave its surface at the given arcs, m.

    An arc counts from the lowest point; the last is that of the equator.
    """
    radius = 2.0 * float(arcs[-1]) / math.pi
    points, hexahedra = _half_ball(_straightened(arcs, radius), count)
    return _bent(points, radius), hexahedra


def _bent(points: Array, radius: float) -> Array:
    """Return points of the half-ball (half-disc) above a flat face bent to the lower half of the ball (disc).

    It is the inversion about the point R below the face, with the power 2 R^2.
    """
    up = np.arange(points.shape[1]) == points.shape[1] - 1
    away = points + radius * up
    return np.where(up, radius, 0.0) + np.where(up, -1.0, 1.0) * 2.0 * radius**2 * away / np.sum(
        away**2, axis=1, keepdims=True
    )


def _straightened(arcs: Array, radius: float) -> Array:
    """Return the distances on the flat face that `_bent` takes to arcs from the lowest point, R tan(s / 2 R)."""
    distances: Array = radius * np.tan(0.5 * arcs / radius)
    return distances


def _grid(points: Array) -> Body:
    """Return the hexahedra of a structured, right-handed grid of points (l, m, n, 3)."""
    number = np.arange(math.prod(points.shape[:3]), dtype=np.int32).reshape(points.shape[:3])
    low, high = slice(None, -1), slice(1, None)
    around = [(low, low), (high, low), (high, high), (low, high)]
    corners = [number[i, j, k] for k in (low, high) for i, j in around]
    return points.reshape(-1, 3), np.stack(corners, axis=-1).reshape(-1, 8)


def _merged(bodies: Sequence[Body]) -> Body:
    """Return one body of several, coincident nodes merged."""
    shift = np.cumsum([0, *(len(points) for points, _ in bodies)])
    hexahedra = np.concatenate([body[1] + n for body, n in zip(bodies, shift, strict=False)])
    return sections.merged_nodes(np.concatenate([points for points, _ in bodies]), hexahedra)


def _mirrored(body: Body, axis: int) -> Body:
    """Return a body mirrored where a coordinate is 0, its volumes positive again."""
    points, hexahedra = body
    return points * np.where(np.arange(3) == axis, -1.0, 1.0), hexahedra[:, sections.FLIPPED]


def _sector(quarter: Body, sector: Sector) -> Body:
    """Return the whole, half or quarter body of a quarter."""
    for axis in sections.mirror_axes(sector):
        quarter = _merged([quarter, _mirrored(quarter, axis)])
    return quarter


def _cuts(sector: Sector, scale: float) -> dict[str, Surface]:
    """Return the cut faces of a sector."""
    cut = {"whole": (), "half": (1,), "quarter": (1, 0)}[sector]
    return {("x-", "y-")[axis]: sections.plane(axis, 0.0, scale) for axis in cut}


def _on_cylinder(radius: float) -> Surface:
    return lambda points: np.abs(np.hypot(points[:, 0], points[:, 1]) - radius) <= sections.ON_SURFACE * radius


def _on_ball(radius: float) -> Surface:
    return lambda points: np.abs(np.linalg.norm(points, axis=1) - radius) <= sections.ON_SURFACE * radius
