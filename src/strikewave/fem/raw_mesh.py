"""What a mesh file holds, before it is put in order; in the file's own unit of length."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError
from strikewave.fem.mesh import Array, Index

Whole = NDArray[np.integer]

LARGEST_FILE = 1 << 30
"""Bytes of a mesh file: five times that of `LARGEST_COUNT` hexahedra as text, about 100 bytes for an element and its
node."""

LARGEST_COUNT = 2_000_000
"""Hexahedra of a mesh file: two thirds of what a model may have, and minutes to read."""

SOLIDS_HINT = 'mesh it with hexahedra; in gmsh: transfinite volumes with "Recombine", or Mesh.SubdivisionAlgorithm = 2'
"""What to do with a mesh of tetrahedra: gmsh makes those unless it is asked for hexahedra."""


@dataclass(frozen=True)
class RawMesh:
    """Nodes, hexahedra and what is named in a file.

    Attributes
    ----------
    points : array (nodes, 3)
    hexahedra : array (elements, 8)
    parts : mapping of str to array of int
        Hexahedra by part; each belongs to one part at most.
    quads : mapping of str to array (faces, 4)
        Faces by the name of their side.
    node_sets : mapping of str to array of int
        Nodes by the name of their set.
    """

    points: Array
    hexahedra: Index
    parts: Mapping[str, Whole] = field(default_factory=dict)
    quads: Mapping[str, Whole] = field(default_factory=dict)
    node_sets: Mapping[str, Whole] = field(default_factory=dict)


def refuse_other_solids(counts: Mapping[str, int]) -> None:
    """Refuse solids that are not hexahedra of 8 nodes, by their count."""
    if counts:
        listed = ", ".join(f"{count} {kind}" for kind, count in sorted(counts.items()))
        raise InputError("mesh.file", listed, "hexahedra of 8 nodes as its only solids", SOLIDS_HINT)
