"""Plane sections of quadrilaterals, and the parts that grow out of them along an axis; SI.

A disc is an O-grid: a square core in a ring. Its corners are where three elements meet, so that no corner can do better
than 120 degrees; the sides of the core bulge by as much as makes it so (`BULGE`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError, nearest
from strikewave.fem.grading import ROUNDING, Grading, nodes_between
from strikewave.fem.mesh import Array, Index, Mesh, exterior_faces

Sector = Literal["whole", "half", "quarter"]
"""Whole; y >= 0; x >= 0 and y >= 0."""

SECTORS: tuple[Sector, ...] = ("whole", "half", "quarter")
"""All of them, for checks and messages."""
Surface = Callable[[Array], NDArray[np.bool_]]
"""Tells which points lie on a surface."""

BULGE = 2.0 * math.tan(math.pi / 12.0) / (1.0 + math.tan(math.pi / 12.0))
"""b of the core x = u sqrt(1 - b v^2 / 2): the corner's angle is 90 degrees + 2 atan(b / (2 - b)), 120 degrees here."""

CORE = 0.5
"""Half-width of the core over the disc's radius where nothing is graded; of 0.4 to 0.55 the one with the
longest shortest edge in discs and balls of 5 to 20 elements over the radius."""

RIM = 1.2
"""Largest size around the rim over the coarse size: counts are whole, and one element less is worth so much there."""

FINE_CORE = 0.7
"""Share of a fine zone that the core takes: its corners, sqrt(2) farther out, then end with the zone."""

FEWEST_IN_CORE = 2.0
"""Elements along the half-width of a core at least: one alone has no node of its own between axis and ring."""

COINCIDENT = 1e-6
"""Share of the shortest edge within which nodes are the same: pieces of a part are computed to 1e-15 of its size."""

ON_SURFACE = 1e-9
"""Share of the size of a body within which a node lies on its surface, by rounding."""

FLIPPED = [0, 3, 2, 1, 4, 7, 6, 5]
"""The nodes of a mirrored hexahedron, right-handed again."""
LARGEST_MESH = 20_000_000
"""Elements of one part: about 10 GB while it is made, what a workstation has to spare."""
QUAD_EDGES = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
"""Ends of the edges of a quadrilateral by its corners."""
HEXAHEDRON_EDGES = np.concatenate([QUAD_EDGES, QUAD_EDGES + 4, np.arange(4)[:, None] + [0, 4]])
"""Those of a hexahedron: lower face, upper face, between them."""


@dataclass(frozen=True)
class PlaneMesh:
    """Quadrilaterals in a plane: points (nodes, 2) in m, quads (elements, 4) counterclockwise."""

    points: Array
    quads: Index


def grid_section(x: Array, y: Array) -> PlaneMesh:
    """Return the rectangular section of nodes at each x and y.

    Examples
    --------
    >>> grid_section(np.arange(3.0), np.arange(2.0)).quads.tolist()
    [[0, 2, 3, 1], [2, 4, 5, 3]]
    """
    refuse_too_many((len(x) - 1) * (len(y) - 1))
    return _quads(np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1))


def merged_sections(sections: Sequence[PlaneMesh]) -> PlaneMesh:
    """Return one section of several, coincident nodes merged and neighbours numbered close together."""
    shift = np.cumsum([0, *(len(section.points) for section in sections)])
    points = np.concatenate([section.points for section in sections])
    quads = np.concatenate([section.quads + n for section, n in zip(sections, shift, strict=False)])
    return PlaneMesh(*renumbered(*merged_nodes(points, quads)))


def merged_nodes(points: Array, elements: NDArray[np.integer]) -> tuple[Array, Index]:
    """Merge nodes that lie within `COINCIDENT` of the shortest edge of each other; the rest keeps its order.

    Examples
    --------
    >>> points, quads = merged_nodes(np.array([[0., 0], [1, 0], [1, 1], [0, 1], [1, 0], [2, 0], [2, 1], [1, 1]]),
    ...                              np.arange(8).reshape(2, 4))
    >>> len(points), quads.tolist()
    (6, [[0, 1, 2, 3], [1, 4, 5, 2]])
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    first, second = edges(elements).T
    shortest = float(np.linalg.norm(points[first] - points[second], axis=1).min())
    pairs = cKDTree(points).query_pairs(COINCIDENT * shortest, output_type="ndarray")
    near = coo_array((np.ones(len(pairs), bool), (pairs[:, 0], pairs[:, 1])), shape=(len(points),) * 2)
    _, group = connected_components(near, directed=False)
    _, first, number = np.unique(group, return_index=True, return_inverse=True)
    order = np.argsort(first)
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    return points[first[order]], place[number][elements].astype(np.int32)


def core_half_width(radius: float, sizes: Grading) -> tuple[float, int]:
    """Return the half-width of a round body's core, m, and the elements along it.

    The core takes `FINE_CORE` of the fine zone, and has as many elements as keep those around the rim below `RIM` times
    the coarse size.
    """
    least = max(math.pi * radius / (4.0 * RIM * sizes.coarse), FEWEST_IN_CORE)
    half_width = min(max(least, FINE_CORE * sizes.extent / sizes.finest) * sizes.finest, CORE * radius)
    count = max(least, half_width / sizes.finest)
    refuse_too_many(count**2)
    return half_width, math.ceil(count - ROUNDING)


def refuse_too_many(elements: float) -> None:
    """Refuse a mesh before it fills the memory."""
    if not elements <= LARGEST_MESH:
        raise InputError("size", f"{elements:.3g} elements", f"at most {LARGEST_MESH} in a part", "use larger elements")


def disc_section(radii: Array, count: int, sector: Sector = "whole") -> PlaneMesh:
    """Return the O-grid of a disc about the origin.

    Parameters
    ----------
    radii : array
        Half-width of the core, radii of the ring's nodes on the axes, radius of the disc, ascending, m.
    count : int
        Elements along the half-width; twice as many along a quarter of the rim.
    sector : str
        "whole", "half" or "quarter".
    """
    u, v = np.meshgrid(*2 * [np.linspace(0.0, 1.0, count + 1)], indexing="ij")
    core = radii[0] * np.stack([u * np.sqrt(1.0 - BULGE * v**2 / 2.0), v * np.sqrt(1.0 - BULGE * u**2 / 2.0)], axis=-1)
    share = ((radii - radii[0]) / (radii[-1] - radii[0]))[:, None, None]
    ring = (1.0 - share) * core[-1] + share * radii[-1] * _eighth(count)
    return sector_of(merged_sections([_quads(core), _quads(ring), _quads(ring[:, ::-1, ::-1])]), sector)


def ring_section(radii: Array, count: int, sector: Sector = "whole") -> PlaneMesh:
    """Return a ring about the origin with nodes at ascending radii, m, and ``2 count`` elements in a quarter."""
    ring = radii[:, None, None] * _eighth(count)
    return sector_of(merged_sections([_quads(ring), _quads(ring[:, ::-1, ::-1])]), sector)


def shell_radii(half_width: float, radius: float, grading: Grading) -> Array:
    """Return half-width of the core, radii of the shells around it and the last radius, m.

    Sizes follow the grading by the distance from the centre; a core wider than the fine zone ends it.
    """
    extent = max(grading.extent, half_width) if grading.fine is not None else grading.extent
    return nodes_between(half_width, radius, replace(grading, at=(0.0,), extent=extent))


def _eighth(count: int) -> Array:
    """Return the directions from 0 to 45 degrees, (count + 1, 2)."""
    angle = 0.25 * math.pi * np.linspace(0.0, 1.0, count + 1)
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def sector_of(quarter: PlaneMesh, sector: Sector) -> PlaneMesh:
    """Return the whole, half or quarter section by mirroring a quarter (x, y >= 0)."""
    for axis in mirror_axes(sector):
        quarter = merged_sections([quarter, mirrored(quarter, axis)])
    return quarter


def mirror_axes(sector: Sector) -> tuple[int, ...]:
    """Return the axes at which a quarter is mirrored one after the other to give a sector."""
    if sector not in SECTORS:
        raise InputError("sector", sector, "a part of a round body", nearest(str(sector), SECTORS))
    return {"quarter": (), "half": (0,), "whole": (0, 1)}[sector]


def mirrored(section: PlaneMesh, axis: int) -> PlaneMesh:
    """Return a section mirrored at x = 0 (axis 0) or y = 0 (axis 1), its quads counterclockwise again."""
    sign = np.where(np.arange(2) == axis, -1.0, 1.0)
    return PlaneMesh(section.points * sign, section.quads[:, ::-1])


def extruded(section: PlaneMesh, heights: Array, keep: NDArray[np.bool_] | None = None) -> tuple[Array, Index]:
    """Return points and hexahedra of a section along z, layer by layer.

    ``keep`` (layers, quads) leaves out elements, and the nodes that only they use.

    Examples
    --------
    >>> square = grid_section(np.arange(2.0), np.arange(2.0))
    >>> points, hexahedra = extruded(square, np.array([0.0, 1.0, 2.0]))
    >>> points.shape, hexahedra.tolist()
    ((12, 3), [[0, 2, 3, 1, 4, 6, 7, 5], [4, 6, 7, 5, 8, 10, 11, 9]])
    """
    count = len(section.points)
    refuse_too_many(len(section.quads) * (len(heights) - 1.0))
    points = np.concatenate([np.column_stack([section.points, np.full(count, z)]) for z in heights])
    layers = count * np.arange(len(heights) - 1)[:, None, None]
    hexahedra = np.concatenate([section.quads + layers, section.quads + count + layers], axis=2)
    chosen = hexahedra.reshape(-1, 8) if keep is None else hexahedra[keep]
    used, number = np.unique(chosen, return_inverse=True)
    return points[used], number.reshape(-1, 8).astype(np.int32)


def part_mesh(name: str, points: Array, hexahedra: Index, sides: Mapping[str, Surface]) -> Mesh:
    """Return a mesh of one part; a side is all exterior faces whose four nodes lie on its surface."""
    exterior = exterior_faces(hexahedra)
    named = {f"{name}.{side}": exterior[on(points)[exterior].all(axis=1)] for side, on in sides.items()}
    return Mesh(points, hexahedra, np.zeros(len(hexahedra), np.int32), (name,), named)


def plane(axis: int, value: float, scale: float) -> Surface:
    """Return the plane where a coordinate has a value, to `ON_SURFACE` of the body's scale."""
    return lambda points: np.abs(points[:, axis] - value) <= ON_SURFACE * scale


def positive(name: str, value: float) -> float:
    """Return a value that is finite and above 0, or refuse it by name."""
    if not 0.0 < value < math.inf:
        raise InputError(name, value, "above 0")
    return value


def edges(elements: NDArray[np.integer]) -> NDArray[np.integer]:
    """Return the edges of quadrilaterals (elements, 4) or hexahedra (elements, 8), (edges, 2), with repetitions."""
    return elements[:, QUAD_EDGES if elements.shape[1] == 4 else HEXAHEDRON_EDGES].reshape(-1, 2)


def near_order(points: Array, elements: Index) -> NDArray[np.integer]:
    """Return the order of nodes in which neighbours lie close together (reverse Cuthill-McKee)."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import reverse_cuthill_mckee

    first, second = edges(elements).T
    rows, columns = np.concatenate([first, second]), np.concatenate([second, first])
    graph = coo_array((np.ones(len(rows), bool), (rows, columns)), shape=(len(points),) * 2)
    return np.asarray(reverse_cuthill_mckee(graph.tocsr(), symmetric_mode=True))


def renumbered(points: Array, elements: Index) -> tuple[Array, Index]:
    """Return points in the order of `near_order`, and elements by their lowest node."""
    order = near_order(points, elements)
    place = np.empty(len(order), np.int32)
    place[order] = np.arange(len(order))
    moved = place[elements]
    return points[order], moved[np.argsort(moved.min(axis=1), kind="stable")]


def _quads(points: Array) -> PlaneMesh:
    """Return the section of a structured patch of points (m, n, 2), right-handed."""
    number = np.arange(points.shape[0] * points.shape[1], dtype=np.int32).reshape(points.shape[:2])
    corners = [number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]]
    return PlaneMesh(points.reshape(-1, 2), np.stack(corners, axis=-1).reshape(-1, 4))
