"""A mesh of 8-node hexahedra in named parts, with the named sides of each part; SI.

Nodes of a hexahedron are numbered as in VTK: 0-3 around the lower face, 4-7 above them, right-handed::

        7-------6
       /|      /|        eta
      4-------5 |         |  xi
      | 3-----|-2     zeta| /
      |/      |/          |/
      0-------1      (xi from 0 to 1, eta from 0 to 3, zeta from 0 to 4)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError, nearest

Array = NDArray[np.float64]
Index = NDArray[np.int32]

TINY = 1e-300  # no length, momentum or energy in SI is as small
"""Divisor where nothing moves or has an extent."""

FACES = np.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]], np.int32)
"""The six faces of a hexahedron by its nodes, normals outward: zeta-, zeta+, eta-, xi+, eta+, xi-."""


@dataclass(frozen=True)
class Mesh:
    """Nodes, hexahedra, the part of each hexahedron, and named sides."""

    points: Array
    """Places of the nodes, m, (nodes, 3)."""
    hexahedra: Index
    """Nodes of each element, (elements, 8); elements of a part stand together, in the order of ``names``."""
    part: Index
    """Index in ``names`` of the part of each element, (elements,)."""
    names: tuple[str, ...]
    """Names of the parts, which share no nodes unless they were imported so."""
    sides: Mapping[str, Index] = field(default_factory=dict)
    """Faces by ``part.side``, such as ``striker.top``, (faces, 4), normals outward."""

    def elements_of(self, name: str) -> slice:
        """Return the elements of a part as a slice."""
        if name not in self.names:
            raise InputError("part", name, "a part of the mesh", nearest(name, self.names))
        index = self.names.index(name)
        return slice(*(int(n) for n in np.searchsorted(self.part, [index, index + 1])))

    def nodes_of(self, name: str) -> Index:
        """Return the nodes of a part, in ascending order."""
        return np.unique(self.hexahedra[self.elements_of(name)])

    def nearest_node(self, name: str, place: Sequence[float]) -> int:
        """Return the node of a part that lies nearest to a place, m."""
        nodes = self.nodes_of(name)
        return int(nodes[np.argmin(np.sum((self.points[nodes] - np.array(place)) ** 2, axis=1))])

    def side(self, name: str) -> Index:
        """Return the faces of a side, ``part.side``; ``part.all`` are all exterior faces of the part."""
        if name in self.sides:
            return self.sides[name]
        part, _, side = name.rpartition(".")
        if side == "all" and part in self.names:
            return exterior_faces(self.hexahedra[self.elements_of(part)])
        known = [*self.sides, *(f"{part}.all" for part in self.names)]
        raise InputError("side", name, "a side of a part", nearest(name, known))


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """Return one mesh of several, their parts side by side; nothing is merged."""
    names = tuple(name for mesh in meshes for name in mesh.names)
    for name in names:
        if names.count(name) > 1:
            raise InputError("mesh.part.name", name, "a name of its own for each part")
    nodes = np.cumsum([0, *(len(mesh.points) for mesh in meshes)])
    parts = np.cumsum([0, *(len(mesh.names) for mesh in meshes)])
    pairs = list(zip(meshes, nodes, parts, strict=False))
    return Mesh(
        points=np.concatenate([mesh.points for mesh in meshes]),
        hexahedra=np.concatenate([mesh.hexahedra + n for mesh, n, _ in pairs]).astype(np.int32),
        part=np.concatenate([mesh.part + p for mesh, _, p in pairs]).astype(np.int32),
        names=names,
        sides={name: (faces + n).astype(np.int32) for mesh, n, _ in pairs for name, faces in mesh.sides.items()},
    )


def exterior_faces(hexahedra: Index) -> Index:
    """Return the faces that belong to one element alone, (faces, 4), normals outward."""
    return exterior(hexahedra)[0]


def exterior(hexahedra: Index) -> tuple[Index, Index]:
    """Return the faces that belong to one element alone, as `exterior_faces`, and that element, (faces,)."""
    faces = hexahedra[:, FACES].reshape(-1, 4)
    key = np.sort(faces, axis=1)
    order = np.lexsort(key.T[::-1])
    same = np.all(key[order[1:]] == key[order[:-1]], axis=1)
    alone = np.ones(len(faces), bool)
    alone[order[1:][same]] = False
    alone[order[:-1][same]] = False
    return faces[alone], (np.flatnonzero(alone) // len(FACES)).astype(np.int32)


def volumes(points: Array, hexahedra: Index) -> Array:
    """Return the volume of each hexahedron, m^3, exact for faces that are bilinear; negative where inverted.

    Each face's flux of x/3 is that of its bilinear patch (Flanagan & Belytschko 1981, eq 77, by another way).
    """
    total = np.zeros(len(hexahedra))
    for face in FACES:
        a, b, c, d = (points[hexahedra[:, n]] for n in face)
        middle = 0.25 * (a + b + c + d)
        for p, q in ((a, b), (b, c), (c, d), (d, a)):
            total += np.einsum("ij,ij->i", middle, np.cross(p, q)) / 6.0
    return total
