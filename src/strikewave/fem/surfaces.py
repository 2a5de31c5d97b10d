"""Surfaces of meshes: their nodes, the faces across each edge, how thick the solid behind them is; SI."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from strikewave.fem import _surface_kernels as surface_kernels
from strikewave.fem.mesh import FACES, TINY, Array, Index, Mesh, volumes


@dataclass(frozen=True)
class Surface:
    """Faces of a mesh by the place of their corners in ``nodes``.

    Attributes
    ----------
    nodes : array (nodes,) of int32
        Nodes of the mesh, ascending.
    faces : array (faces, 4) of int32
    """

    nodes: Index
    faces: Index


@dataclass(frozen=True)
class Extents:
    """Areas of a surface as it lies.

    Attributes
    ----------
    area : array (nodes,)
        The share of each node in the area of its faces, m^2.
    size : array (faces,)
        Root of the area of each face, m.
    radius : array (faces,)
        Of the sphere about the mean of a face's corners that holds the face, m.
    """

    area: Array
    size: Array
    radius: Array


def surface_of(faces: Index) -> Surface:
    """Return the surface that faces of a mesh make.

    Examples
    --------
    >>> surface_of(np.array([[4, 5, 9, 8], [5, 6, 10, 9]])).faces.tolist()
    [[0, 1, 4, 3], [1, 2, 5, 4]]
    """
    nodes, places = np.unique(faces, return_inverse=True)
    return Surface(nodes.astype(np.int32), places.reshape(-1, 4).astype(np.int32))


def extents(points: Array, faces: Index) -> Extents:
    """Return nodal areas, sizes and radii of faces whose corners are rows of ``points``.

    The area of a face is half the cross product of its diagonals (of a warped face, that of its projection along the
    mean normal).

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]])
    >>> sizes = extents(square, np.array([[0, 1, 2, 3]], np.int32))
    >>> sizes.area.tolist(), sizes.size.tolist()
    ([1.0, 1.0, 1.0, 1.0], [2.0])
    """
    area, size, radius = np.zeros(len(points)), np.zeros(len(faces)), np.zeros(len(faces))
    surface_kernels.add_areas(points, faces, area, size, radius)
    return Extents(area, size, radius)


def have_common(some: Index, others: Index) -> bool:
    """Tell whether two lists of faces have one in common.

    Examples
    --------
    >>> have_common(np.array([[0, 1, 4, 3]]), np.array([[5, 8, 7, 4], [3, 4, 1, 0]]))
    True
    """
    rows = np.concatenate([np.unique(np.sort(faces, axis=1), axis=0) for faces in (some, others)])
    return len(np.unique(rows, axis=0)) < len(rows)


def neighbours(faces: Index) -> Index:
    """Return the face across each edge (corners 0-1, 1-2, 2-3, 3-0) of each face, -1 at the rim, (faces, 4).

    An edge of more than two faces counts as rim.

    Examples
    --------
    >>> neighbours(np.array([[0, 1, 4, 3], [1, 2, 5, 4]])).tolist()
    [[-1, 1, -1, -1], [-1, -1, -1, 0]]
    """
    edges = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    same = np.all(edges[order[1:]] == edges[order[:-1]], axis=1)
    pair = same & ~np.append(same[1:], False) & ~np.insert(same[:-1], 0, False)
    across = np.full(len(edges), -1, np.int32)
    first, second = order[:-1][pair], order[1:][pair]
    across[first], across[second] = second // 4, first // 4
    return across.reshape(-1, 4)


def thickness(mesh: Mesh, faces: Index) -> Array:
    """Return the volume of the element behind each face over the area of the face, m, (faces,).

    A face that belongs to no element is taken to be as thick as it is wide.
    """
    size = extents(mesh.points, faces).size
    marked = np.zeros(len(mesh.points), bool)
    marked[faces] = True
    behind = np.flatnonzero(marked[mesh.hexahedra].sum(axis=1) >= 4)
    sides = mesh.hexahedra[behind][:, FACES].reshape(-1, 4)
    whole = marked[sides].all(axis=1)
    owners = np.append(np.repeat(behind, 6)[whole], np.full(len(faces), -1))
    rows = np.sort(np.concatenate([sides[whole], faces]), axis=1)
    order = np.lexsort((-owners, *rows.T))
    new = np.any(rows[order[1:]] != rows[order[:-1]], axis=1)
    group = np.append(0, np.cumsum(new))
    first = np.flatnonzero(np.append(True, new))
    element = np.empty(len(rows), int)
    element[order] = owners[order[first]][group]
    element = element[len(rows) - len(faces) :]
    depth = np.abs(volumes(mesh.points, mesh.hexahedra[element])) / np.maximum(size, TINY) ** 2
    return np.where(element >= 0, depth, size)
