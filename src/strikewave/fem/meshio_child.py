"""Reads a mesh file with meshio in a process of its own, whose memory is bounded; run by `strikewave.fem.mesh_files`.

meshio trusts the counts that stand in a file and unpacks what is packed in it, so that a small damaged or hostile file
may ask for any amount of memory or time. The process has bounds for both; it stands alone to start quickly.
"""

from __future__ import annotations

import contextlib
import importlib
import io
import json
import sys
from typing import Any

import numpy as np

NUMBERING = ("gmsh:physical", "part", "PartId", "material", "MaterialId", "CellEntityIds")
"""Cell data that number the parts; the first that a file has counts."""

NOT_SOLID = ("vertex", "line", "triangle", "quad", "polygon")
"""Beginnings of the names of cells that are no solids."""


def main(kind: str, source: str, target: str, largest_memory: str, most_seconds: str) -> int:
    """Write nodes, hexahedra, quadrilaterals and their names to an npz; return 0, or 1 with a reason on stderr."""
    _bound(int(largest_memory), int(most_seconds))
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            arrays = contents(importlib.import_module(f"meshio.{kind}").read(source), kind)
    except (Exception, SystemExit) as error:
        sys.stderr.write(f"{type(error).__name__} {error}"[:500])
        return 1
    np.savez(target, **arrays)
    return 0


def contents(mesh: Any, kind: str) -> dict[str, Any]:
    """Return the arrays of a meshio mesh: points, cells, rows of group and cell; as JSON the names and other solids."""
    others: dict[str, int] = {}
    for block in mesh.cells:
        if block.type != "hexahedron" and not block.type.startswith(NOT_SOLID):
            others[block.type] = others.get(block.type, 0) + len(block.data)
    hexahedra, parts = _cells(mesh, "hexahedron", 8), _groups(mesh, "hexahedron", 3 if kind == "gmsh" else None)
    if kind == "gmsh" and not mesh.cell_sets:
        hexahedra, parts = _once(hexahedra, parts)
    sides = _groups(mesh, "quad", 2 if kind == "gmsh" else None)
    return {
        "points": np.asarray(mesh.points, float),
        "hexahedra": hexahedra,
        "parts": _rows(parts),
        "quads": _cells(mesh, "quad", 4),
        "sides": _rows(sides),
        "names": np.array(json.dumps({"parts": list(parts), "sides": list(sides), "others": others})),
    }


def _cells(mesh: Any, kind: str, size: int) -> Any:
    """Return the cells of a type."""
    cells = [np.asarray(block.data, np.int64).reshape(-1, size) for block in mesh.cells if block.type == kind]
    return np.concatenate([np.empty((0, size), np.int64), *cells])


def _groups(mesh: Any, kind: str, dim: int | None) -> dict[str, Any]:
    """Return the cells of a type by group: physical groups of a dimension in gmsh's files, else numbers of cell data.

    meshio gives one tag of each cell, the first; of gmsh's 4.1 also all cells of every group with a name.
    """
    blocks = [number for number, block in enumerate(mesh.cells) if block.type == kind]
    key = next((name for name in NUMBERING if name in mesh.cell_data), None)
    tags = [np.asarray(mesh.cell_data[key][number]).ravel().astype(np.int64) for number in blocks] if key else []
    tag = np.concatenate([np.empty(0, np.int64), *tags])
    names = {int(number): str(name) for name, (number, of) in mesh.field_data.items() if of == dim} if dim else {}
    noun = "part" if kind == "hexahedron" else "side"
    groups = {names.get(int(t), f"{noun}-{t}"): np.flatnonzero(tag == t) for t in np.unique(tag) if t != 0}
    begin = np.cumsum([0, *(len(mesh.cells[number].data) for number in blocks)])
    for name in (name for name in names.values() if name in mesh.cell_sets):
        members = [start + mesh.cell_sets[name][number] for start, number in zip(begin, blocks, strict=False)]
        groups[name] = np.concatenate([np.empty(0, np.int64), *members]).astype(np.int64)
    return {name: members for name, members in groups.items() if len(members)}


def _once(cells: Any, groups: dict[str, Any]) -> tuple[Any, dict[str, Any]]:
    """Return each cell once: gmsh's 2.2 repeats a cell for every group that holds it."""
    _, first, number = np.unique(np.sort(cells, axis=1), axis=0, return_index=True, return_inverse=True)
    if len(first) == len(cells):
        return cells, groups
    return cells[first], {name: np.unique(number.ravel()[members]) for name, members in groups.items()}


def _rows(groups: dict[str, Any]) -> Any:
    """Return the cells of all groups, (members, 2): number of the group, cell."""
    rows = [np.column_stack([np.full(len(members), k), members]) for k, members in enumerate(groups.values())]
    return np.concatenate([np.empty((0, 2), np.int64), *rows])


def _bound(memory: int, seconds: int) -> None:
    """Bound memory and computing time of the process, where the system can."""
    try:
        import resource
    except ImportError:
        return
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
