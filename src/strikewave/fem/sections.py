"""Plane sections of quadrilaterals, parts that grow out of them along an axis, places of nodes along a line; SI.

Along a line nodes stand close where it matters, and grow geometrically to coarse elsewhere. The size of an element is
h(x) = min(coarse, first + k d(x)), d the distance from the nearest fine zone, k = ln(growth): sizes that grow linearly
with distance are sizes in geometric progression. The number of elements is the integral of dx / h, rounded up; the
nodes stand at equal shares of it. Neighbours therefore never differ by more than ``growth``, and no element is larger
than h asks for.

A disc is an O-grid: a square core in a ring. Its corners are where three elements meet, so that no corner can do better
than 120 degrees; the sides of the core bulge by as much as makes it so (`BULGE`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError, nearest
from strikewave.fem.mesh import Array, Index, Mesh, exterior_faces

LARGEST_COUNT = 20_000  # a mesh of 3 million elements with so long a line has 12 by 12 across
"""Most elements along one line."""
GROWTH = 1.2  # as is usual: jumps in size send short waves back
"""Ratio of the sizes of neighbours where none is stated."""
LARGEST_GROWTH = 2.0  # chosen: the next octave of sizes, far beyond usual meshes
"""Largest ratio of the sizes of neighbours."""
ROUNDING = 1e-9  # above rounding
"""Tolerance of a count of elements above a whole number, and slope below which sizes are the same."""


@dataclass(frozen=True)
class Grading:
    """Sizes of the elements along a line."""

    coarse: float
    """Largest size, m."""
    fine: float | None = None
    """Size in and next to the fine zones, m; ``coarse`` everywhere when left out."""
    at: tuple[float, ...] = (0.0,)
    """Places of the fine zones, m from the line's beginning."""
    extent: float = 0.0
    """Half the length of a fine zone, m."""
    growth: float = GROWTH
    """Largest ratio of neighbours, above 1 to 2."""

    def __post_init__(self) -> None:
        if not 0.0 < self.coarse < math.inf:
            raise InputError("grading.coarse", self.coarse, "a size above 0")
        if self.fine is not None and not 0.0 < self.fine <= self.coarse:
            raise InputError("grading.fine", self.fine, f"above 0, at most the coarse size {self.coarse:g}")
        if not 0.0 <= self.extent < math.inf:
            raise InputError("grading.extent", self.extent, "at least 0")
        if not 1.0 < self.growth <= LARGEST_GROWTH:
            raise InputError("grading.growth", self.growth, f"above 1, at most {LARGEST_GROWTH:g}")
        if not self.at or not all(math.isfinite(place) for place in self.at):
            raise InputError("grading.at", self.at, "one finite position or more")

    @property
    def finest(self) -> float:
        """Size in the fine zones, m."""
        return self.coarse if self.fine is None else self.fine

    @property
    def slope(self) -> float:
        """Growth of the size with distance, k = ln(growth)."""
        return math.log(self.growth)

    def size(self, x: Array) -> Array:
        """Return h at places x, m.

        The size of a zone without extent begins at fine k / (growth - 1), which makes its first element ``fine``.
        """
        places = np.asarray(x, float)
        away = np.min([np.abs(places - place) for place in self.at], axis=0) - self.extent
        first = self.finest if self.extent > 0.0 else self.finest * self.slope / (self.growth - 1.0)
        sizes = np.minimum(self.coarse, first + self.slope * np.maximum(away, 0.0))
        return np.full(places.shape, self.coarse) if self.fine is None else sizes

    def _kinks(self, start: float, end: float) -> Array:
        """Return the places between which h is linear, with both ends."""
        if self.fine is None:
            return np.array([start, end])
        first = float(self.size(np.array([self.at[0]]))[0])
        reach = self.extent + max(self.coarse - first, 0.0) / self.slope
        zones = sorted(self.at)
        kinks = [zone + side * d for zone in zones for side in (-1.0, 1.0) for d in (0.0, self.extent, reach)]
        kinks += [0.5 * (a + b) for a, b in pairwise(zones)]
        return np.unique([start, end, *(kink for kink in kinks if start < kink < end)])


Sizes = float | Grading
"""Sizes along a line: one size, or a grading."""


def as_grading(sizes: Sizes) -> Grading:
    """Return a grading of one size or as it is."""
    return sizes if isinstance(sizes, Grading) else Grading(float(sizes))


def nodes_between(start: float, end: float, sizes: Sizes) -> Array:
    """Return the places of nodes from ``start`` to ``end``, both exact, m.

    On a piece where h goes from h0 with the slope b, the count of elements is ln(1 + b s / h0) / b; its inverse places
    the nodes.
    """
    if not start < end:
        raise InputError("length", end - start, "above 0")
    grading = as_grading(sizes)
    kinks = grading._kinks(start, end)
    size = grading.size(kinks)
    length = np.diff(kinks)
    slope = np.diff(size) / length
    counts = np.array([_count(s, h, b) for s, h, b in zip(length, size, slope, strict=False)])
    reached = np.concatenate([[0.0], np.cumsum(counts)])
    total = max(1, math.ceil(reached[-1] - ROUNDING)) if reached[-1] < LARGEST_COUNT else 0
    if total == 0:
        raise InputError("size", grading.finest, f"at most {LARGEST_COUNT} elements along {end - start:g} m")
    wanted = np.linspace(0.0, reached[-1], total + 1)
    piece = np.clip(np.searchsorted(reached, wanted, side="right") - 1, 0, len(length) - 1)
    left = wanted - reached[piece]
    places = kinks[piece] + [_length(n, h, b) for n, h, b in zip(left, size[piece], slope[piece], strict=True)]
    places[0], places[-1] = start, end  # exact: parts meet there
    return places


def nodes_through(breaks: Sequence[float], sizes: Sizes) -> Array:
    """Return nodes along a line that has a node at each of several ascending places, m.

    Next to a break the ratio of neighbours may exceed the growth by how the rounding of the two counts differs.
    """
    pieces = [nodes_between(a, b, sizes) for a, b in pairwise(breaks)]
    return np.concatenate([pieces[0][:1], *(piece[1:] for piece in pieces)])


def _count(length: float, size: float, slope: float) -> float:
    """Return the number of elements on a piece: the integral of ds / (size + slope s)."""
    ratio = slope * length / size
    return length / size if abs(ratio) < ROUNDING else math.log1p(ratio) / slope


def _length(count: float, size: float, slope: float) -> float:
    """Return the length that a count of elements takes, the inverse of `_count`."""
    return count * size if abs(slope * count) < ROUNDING else size * math.expm1(slope * count) / slope


Sector = Literal["whole", "half", "quarter"]
"""Whole; y >= 0; x >= 0 and y >= 0."""

SECTORS: tuple[Sector, ...] = ("whole", "half", "quarter")
"""All sectors."""
Surface = Callable[[Array], NDArray[np.bool_]]
"""Function that marks the points which lie on a surface."""

BULGE = 2.0 * math.tan(math.pi / 12.0) / (1.0 + math.tan(math.pi / 12.0))
"""b of the core x = u sqrt(1 - b v^2 / 2): the corner's angle is 90 degrees + 2 atan(b / (2 - b)), 120 degrees here."""

CORE = 0.5  # of 0.4 to 0.55 the one with the longest shortest edge, in bodies of 5 to 20 elements over the radius
"""Half-width of the core over the disc's radius where nothing is graded."""

RIM = 1.2  # counts are whole, and one element less is worth so much there
"""Largest size around the rim over the coarse size."""

FINE_CORE = 0.7  # its corners, sqrt(2) farther out, then end with the zone
"""Share of a fine zone that the core takes."""

FEWEST_IN_CORE = 2.0  # one alone has no node of its own between axis and ring
"""Fewest elements along the half-width of a core."""

COINCIDENT = 1e-6  # pieces of a part are computed to 1e-15 of its size
"""Share of the shortest edge within which nodes are the same."""

ON_SURFACE = 1e-9  # rounding
"""Share of the size of a body within which a node lies on its surface."""

FLIPPED = [0, 3, 2, 1, 4, 7, 6, 5]
"""The nodes of a mirrored hexahedron, right-handed again."""
LARGEST_MESH = 20_000_000  # about 10 GB while it is made: what a workstation has to spare
"""Most elements of one part."""
QUAD_EDGES = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
"""Ends of the edges of a quadrilateral by its corners."""
HEXAHEDRON_EDGES = np.concatenate([QUAD_EDGES, QUAD_EDGES + 4, np.arange(4)[:, None] + [0, 4]])
"""Ends of the edges of a hexahedron: lower face, upper face, between them."""


@dataclass(frozen=True)
class PlaneMesh:
    """Quadrilaterals in a plane: points (nodes, 2) in m, quads (elements, 4) counterclockwise."""

    points: Array
    quads: Index


def grid_section(x: Array, y: Array) -> PlaneMesh:
    """Return the rectangular section of nodes at each x and y."""
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

    ``radii`` are the half-width of the core, the radii of the ring's nodes on the axes and that of the disc, ascending,
    m; ``count`` elements lie along the half-width, twice as many along a quarter of the rim.
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
