"""Quality of a mesh, part by part, and faults that make it unusable; SI.

The scaled Jacobian of a corner is the triple product of the unit vectors along its three edges: 1 where they are at
right angles, 0 or less where the corner is flat or turned inside out (Knupp 2000, Int J Numer Meth Eng 48, 1165).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, MORE, NO_UNIT, Quantity
from strikewave.base.errors import InputError, InputErrors
from strikewave.base.shock_quantities import LENGTH, STEP
from strikewave.fem.mesh import FACES, Array, Index, Mesh, volumes
from strikewave.fem.sections import HEXAHEDRON_EDGES

CORNERS = np.array(
    [[0, 1, 3, 4], [1, 2, 0, 5], [2, 3, 1, 6], [3, 0, 2, 7], [4, 7, 5, 0], [5, 4, 6, 1], [6, 5, 7, 2], [7, 6, 4, 3]]
)
"""Each corner of a hexahedron and the ends of its three edges, right-handed."""

FLAT = 1e-6  # files of meshes keep six digits or more: what is flatter cannot be distinguished from inverted
"""Scaled Jacobian at and below which a corner counts as flat; and shortest over longest edge of a flat element."""

FARTHEST = 1e6  # what lies farther has the wrong unit, or is no number
"""Largest coordinate, m."""

AT_ONCE = 50_000  # 24 numbers each of some tens of arrays: together below 1 GB
"""Elements looked at in one go."""

UNWARPED = 1e-9  # chosen: flat faces of built-in meshes have 0, warped ones 0.1; rounding would only distract
"""Warpage below which a face counts as flat, rad."""
SHAPE = Quantity(NO_UNIT, NO_UNIT, decimals=3, digits=0)
NAMED = 5  # enough to see where, few enough for a screen
"""Elements named of each kind of fault."""


@declare.dataclass
class PartQuality:
    """Quality of the mesh of a part."""

    part: str = declare.word("name of the part", column=KEY, in_document=False)
    elements: int = declare.count("how many elements", column=MAIN)
    nodes: int = declare.count("how many nodes", column=MORE)
    volume: float = declare.number(Quantity("m^3", "m^3"), "volume of the mesh")
    shortest_edge: float = declare.number(LENGTH, "shortest edge", column=MAIN)
    longest_edge: float = declare.number(LENGTH, "longest edge", column=MORE)
    aspect_ratio: float = declare.number(
        SHAPE, "largest of the longest over the shortest edge of an element", column=MAIN
    )
    scaled_jacobian: float = declare.number(
        SHAPE, "smallest of all corners, at most 1", label="scaled Jacobian", column=MAIN
    )
    warpage: float = declare.number(
        Quantity("rad", "rad"),
        "largest of the angles between the two triangles of a face, over its two diagonals; 0 where it is flat",
    )
    worst: int = declare.count("element with the smallest scaled Jacobian, counted within the part")
    worst_at: tuple[float, float, float] = declare.history("m", "its centre")
    step: float | None = declare.number(
        STEP,
        "shortest edge over wave speed; None without a wave speed. A guide: the solver's own bound is tighter",
        default=None,
        in_document=False,
    )

    @declare.computed(
        declare.number(
            Quantity("rad", "deg", "warpage", digits=3),
            "the same without rounding",
            column=MAIN,
            order=1,
            in_document=False,
        )
    )
    def shown_warpage(self) -> float:
        """Warpage, 0 where it is rounding."""
        return self.warpage if self.warpage >= UNWARPED else 0.0


def quality_report(mesh: Mesh, wave_speeds: Mapping[str, float] | None = None) -> tuple[PartQuality, ...]:
    """Return the quality of the mesh of each part; wave speeds by part in m/s."""
    speeds = wave_speeds or {}
    return tuple(_part_quality(mesh, name, speeds.get(name)) for name in mesh.names)


def scaled_jacobians(points: Array, hexahedra: Index) -> Array:
    """Return the scaled Jacobian of each corner, (elements, 8); 0 where an edge has no length."""
    scaled = np.empty((len(hexahedra), 8))
    for corner, ends in enumerate(CORNERS):
        origin, *tips = (points[hexahedra[:, node]] for node in ends)
        first, second, third = (tip - origin for tip in tips)
        lengths = np.sqrt(_dot(first, first)) * np.sqrt(_dot(second, second)) * np.sqrt(_dot(third, third))
        triple = _dot(first, np.cross(second, third))
        scaled[:, corner] = np.divide(triple, lengths, out=np.zeros_like(triple), where=lengths > 0.0)
    return scaled


def warpages(points: Array, hexahedra: Index) -> Array:
    """Return the warpage of each face, (elements, 6), rad: the angle between its triangles, over both diagonals."""
    angles = np.empty((len(hexahedra), 6))
    for number, face in enumerate(FACES):
        a, b, c, d = (points[hexahedra[:, node]] for node in face)
        across, along = c - a, d - b
        first = _angle(np.cross(b - a, across), np.cross(across, d - a))
        second = _angle(np.cross(c - b, along), np.cross(along, a - b))
        angles[:, number] = np.maximum(first, second)
    return angles


def check_mesh(mesh: Mesh) -> None:
    """Refuse a mesh that cannot be computed, with one line for each fault, the first five of each kind."""
    count = len(mesh.points)
    if mesh.hexahedra.size and not 0 <= mesh.hexahedra.min() <= mesh.hexahedra.max() < count:
        got = f"{mesh.hexahedra.min()} to {mesh.hexahedra.max()}"
        raise InputErrors([str(InputError("mesh.hexahedra", got, f"nodes from 0 to {count - 1}"))])
    lines = [
        str(InputError(f"mesh.point {node}", tuple(mesh.points[node].tolist()), f"coordinates within {FARTHEST:g} m"))
        for node in np.flatnonzero(~(np.abs(mesh.points) <= FARTHEST).all(axis=1))[:NAMED]
    ]
    for name in mesh.names:
        span = mesh.elements_of(name)
        if span.start == span.stop:
            lines.append(str(InputError(f"mesh.{name}", "no elements", "a part with elements", "remove the part")))
    if not lines:  # shapes of elements mean nothing where nodes are nowhere or twice in an element
        lines = _repeated(mesh) or _inverted(mesh)
    loose = np.flatnonzero(np.bincount(mesh.hexahedra.ravel(), minlength=count) == 0)
    if len(loose):
        first = ", ".join(str(node) for node in loose[:NAMED])
        got = f"{len(loose)} that belong to no element, such as {first}"
        lines.append(str(InputError("mesh.points", got, "nodes of elements only", "remove them")))
    if lines:
        raise InputErrors(lines)


def _part_quality(mesh: Mesh, name: str, speed: float | None) -> PartQuality:
    hexahedra = mesh.hexahedra[mesh.elements_of(name)]
    chunks = [hexahedra[k : k + AT_ONCE] for k in range(0, len(hexahedra), AT_ONCE)]
    lengths = np.concatenate([_edge_lengths(mesh.points, chunk) for chunk in chunks])
    scaled = np.concatenate([scaled_jacobians(mesh.points, chunk).min(axis=1) for chunk in chunks])
    shortest, longest = lengths.T
    with np.errstate(divide="ignore"):
        aspect = float((longest / shortest).max())
    worst = int(scaled.argmin())
    x, y, z = (float(value) for value in mesh.points[hexahedra[worst]].mean(axis=0))
    return PartQuality(
        part=name,
        elements=len(hexahedra),
        nodes=len(np.unique(hexahedra)),
        volume=float(sum(volumes(mesh.points, chunk).sum() for chunk in chunks)),
        shortest_edge=float(shortest.min()),
        longest_edge=float(longest.max()),
        aspect_ratio=aspect,
        scaled_jacobian=float(scaled[worst]),
        warpage=max(float(warpages(mesh.points, chunk).max()) for chunk in chunks),
        worst=worst,
        worst_at=(x, y, z),
        step=None if speed is None else float(shortest.min()) / speed,
    )


def _edge_lengths(points: Array, hexahedra: Index) -> Array:
    """Return the shortest and the longest edge of each element, (elements, 2)."""
    squares = [np.sum((points[hexahedra[:, a]] - points[hexahedra[:, b]]) ** 2, axis=1) for a, b in HEXAHEDRON_EDGES]
    return np.sqrt(np.column_stack([np.min(squares, axis=0), np.max(squares, axis=0)]))


def _repeated(mesh: Mesh) -> list[str]:
    """Return a line for each element that has a node twice."""
    ordered = np.sort(mesh.hexahedra, axis=1)
    bad = np.flatnonzero((ordered[:, 1:] == ordered[:, :-1]).any(axis=1))
    return _named(mesh, bad, ["a node twice"] * len(bad), "eight nodes of its own", "mesh with hexahedra only")


def _inverted(mesh: Mesh) -> list[str]:
    """Return a line for each element with a corner or a volume that is not positive."""
    bad: list[int] = []
    reasons: list[str] = []
    for start in range(0, len(mesh.hexahedra), AT_ONCE):
        chunk = mesh.hexahedra[start : start + AT_ONCE]
        smallest, volume = scaled_jacobians(mesh.points, chunk).min(axis=1), volumes(mesh.points, chunk)
        shortest, longest = _edge_lengths(mesh.points, chunk).T
        for element in np.flatnonzero((smallest <= FLAT) | (volume <= 0.0) | (shortest <= FLAT * longest)):
            bad.append(start + int(element))
            reasons.append(f"scaled Jacobian {smallest[element]:.3g}, volume {volume[element]:.3g} m^3")
    return _named(
        mesh,
        np.array(bad, int),
        reasons,
        f"scaled Jacobian and ratio of edges above {FLAT:g}, volume above 0",
        "mesh it anew there",
    )


def _named(mesh: Mesh, bad: NDArray[np.integer], reasons: list[str], allowed: str, hint: str) -> list[str]:
    """Return a line for the first of the bad elements: part, number within the part, centre."""
    lines = []
    for element, got in list(zip(bad, reasons, strict=True))[:NAMED]:
        part = mesh.names[mesh.part[element]]
        x, y, z = mesh.points[mesh.hexahedra[element]].mean(axis=0)
        field = f"mesh.{part} element {element - mesh.elements_of(part).start} at ({x:.4g}, {y:.4g}, {z:.4g}) m"
        lines.append(str(InputError(field, got, allowed, hint)))
    if len(bad) > NAMED:
        lines.append(f"mesh: {len(bad) - NAMED} more such elements")
    return lines


def _angle(first: Array, second: Array) -> Array:
    """Return the angle between vectors, rad, exact also where it is small."""
    turn = np.cross(first, second)
    return np.asarray(np.arctan2(np.sqrt(_dot(turn, turn)), _dot(first, second)))


def _dot(first: Array, second: Array) -> Array:
    return np.asarray(np.einsum("ij,ij->i", first, second))
