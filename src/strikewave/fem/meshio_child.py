"""Reads a mesh file with meshio in a process of its own, whose memory is bounded; run by `strikewave.fem.imported`.

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
"""Cell data that number the parts; the first there is counts."""

NOT_SOLID = ("vertex", "line", "triangle", "quad", "polygon")
"""Beginnings of the names of cells that are no solids."""


def main(kind: str, source: str, target: str, largest_memory: str) -> int:
    """Write nodes, hexahedra, quadrilaterals and their names to an npz; return 0, or 1 with a word on stderr."""
    _bound_memory(int(largest_memory))
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            held = contents(importlib.import_module(f"meshio.{kind}").read(source), kind)
    except (Exception, SystemExit) as error:
        sys.stderr.write(f"{type(error).__name__} {error}"[:500])
        return 1
    np.savez(target, **held)
    return 0


def contents(mesh: Any, kind: str) -> dict[str, Any]:
    """Return the arrays of a meshio mesh: points, cells with their tags, and as JSON the names and other solids."""
    key = next((name for name in NUMBERING if name in mesh.cell_data), None)
    tags = [np.zeros(len(block.data)) for block in mesh.cells] if key is None else mesh.cell_data[key]
    others: dict[str, int] = {}
    for block in mesh.cells:
        if block.type != "hexahedron" and not block.type.startswith(NOT_SOLID):
            others[block.type] = others.get(block.type, 0) + len(block.data)
    groups = mesh.field_data.items() if kind == "gmsh" else ()
    names = [[int(dim), int(tag), str(name)] for name, (tag, dim) in groups]
    hexahedra, hexahedron_tags = _cells(mesh, tags, "hexahedron", 8)
    quads, quad_tags = _cells(mesh, tags, "quad", 4)
    return {
        "points": np.asarray(mesh.points, float),
        "hexahedra": hexahedra,
        "hexahedron_tags": hexahedron_tags,
        "quads": quads,
        "quad_tags": quad_tags,
        "words": np.array(json.dumps({"names": names, "others": others})),
    }


def _cells(mesh: Any, tags: Any, kind: str, size: int) -> tuple[Any, Any]:
    """Return the cells of a type and their tags."""
    pairs = [(block.data, tag) for block, tag in zip(mesh.cells, tags, strict=True) if block.type == kind]
    cells = [np.asarray(data, np.int64).reshape(-1, size) for data, _ in pairs]
    numbers = [np.asarray(tag).reshape(len(data)).astype(np.int64) for data, tag in pairs]
    return (
        np.concatenate([np.empty((0, size), np.int64), *cells]),
        np.concatenate([np.empty(0, np.int64), *numbers]),
    )


def _bound_memory(largest: int) -> None:
    """Let the process take no more memory than that, where the system can bound it."""
    try:
        import resource
    except ImportError:
        return
    resource.setrlimit(resource.RLIMIT_AS, (largest, largest))


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
