"""Meshes from files: gmsh (.msh) and VTK (.vtk, .vtu) through meshio, Abaqus (.inp) by `strikewave.fem.abaqus`.

Parts are gmsh's physical volumes, Abaqus' element sets (see `strikewave.fem.abaqus`) or the numbers of VTK cell data;
sides are physical surfaces, element surfaces, groups of quadrilaterals and node sets.
"""

from __future__ import annotations

import importlib.util
import json
import math
import re
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from strikewave.base.child_process import ONE_THREAD, environment, python_command
from strikewave.base.errors import EXISTING_FILE, InputError
from strikewave.fem import meshio_child
from strikewave.fem.abaqus import read_abaqus
from strikewave.fem.mesh import Array, Index, Mesh, exterior_faces, volumes
from strikewave.fem.quality import FARTHEST, check_mesh
from strikewave.fem.raw_mesh import LARGEST_COUNT, LARGEST_FILE, RawMesh, Whole, refuse_other_solids
from strikewave.fem.sections import FLIPPED, renumbered

FORMATS = {".msh": "gmsh", ".vtk": "vtk", ".vtu": "vtu"}
"""Formats that meshio reads, by the end of the file's name."""

LEAST_MEMORY = 4 << 30
"""Bytes that the process which reads a file may take, besides `MEMORY_PER_BYTE` times the file: it is a limit of
addresses, of which libraries reserve far more than they use."""

MEMORY_PER_BYTE = 20
"""Bytes of memory for each byte of a file: a text of numbers becomes Python objects before it becomes arrays."""

LEAST_TIME, BYTES_PER_SECOND = 60.0, 1e6
"""Seconds that the process may take for any file, and what it must read a second besides: meshio reads several times as
much on a slow machine."""

LONGEST_HINT = 200
"""Last characters of what meshio reports: the error stands at the end."""

LONGEST_NAME = 60
"""Characters of a name: it stands in tables, legends and names of files."""

GMSH_HINT = "; gmsh writes what is read here with Mesh.MshFileVersion 4.1 (or 2.2), SaveAll and SaveParametric 0"
"""Said of a .msh file that meshio refuses."""


def read_mesh(path: str | Path, scale: float = 1.0) -> Mesh:
    """Return the mesh of a file: its hexahedra in parts, and its named sides.

    Node orders that are inverted are turned, nodes of no element are left out, and nodes and elements are numbered
    anew so that neighbours lie close. Names keep letters, digits, ``_``, ``+`` and ``-``; all else becomes ``-``.
    Elements of no part are the part ``unnamed``.

    Parameters
    ----------
    path : str or Path
        .msh (gmsh 2.2, 4.1), .inp (Abaqus), .vtk (legacy) or .vtu.
    scale : float
        Length in m that 1 stands for in the file, such as 1e-3 for mm.

    Raises
    ------
    InputError
        If the file is missing, too large or damaged, holds other solids than hexahedra of 8 nodes, overlapping parts,
        or a named face that is not on the surface of a part; or if meshio is needed and missing.
    InputErrors
        If elements are flat or inverted, see `strikewave.fem.quality.check_mesh`.
    """
    file = Path(path)
    if not 0.0 < scale < math.inf:
        raise InputError("scale", scale, "above 0, such as 1e-3 for a mesh in mm")
    if not file.is_file():
        raise InputError("mesh.file", str(path), EXISTING_FILE)
    if file.stat().st_size > LARGEST_FILE:
        raise InputError("mesh.file", f"{file.stat().st_size} bytes", f"at most {LARGEST_FILE}")
    kind = file.suffix.lower()
    if kind not in (*FORMATS, ".inp"):
        raise InputError("mesh.file", file.name, "a name that ends in .inp, " + ", ".join(FORMATS))
    return ordered_mesh(read_abaqus(file) if kind == ".inp" else _read_meshio(file, FORMATS[kind]), scale)


def ordered_mesh(raw: RawMesh, scale: float = 1.0) -> Mesh:
    """Return the mesh of what a file holds; see `read_mesh`."""
    count = len(raw.hexahedra)
    if not 0 < count <= LARGEST_COUNT:
        raise InputError("mesh.file", f"{count} hexahedra", f"from 1 to {LARGEST_COUNT}")
    if raw.hexahedra.min() < 0 or raw.hexahedra.max() >= len(raw.points):
        raise InputError("mesh.file", int(raw.hexahedra.max()), f"nodes below {len(raw.points)}")
    names, part = _parts(raw)
    used, number = np.unique(raw.hexahedra, return_inverse=True)
    hexahedra = number.reshape(-1, 8).astype(np.int32)
    points = raw.points[used] * scale
    if not np.all(np.abs(points) <= FARTHEST):
        raise InputError("mesh.file", "a node farther away", f"coordinates within {FARTHEST:g} m", "check the scale")
    points, hexahedra, part, place = _close_together(points, _turned(points, hexahedra), part)
    new = np.full(len(raw.points), -1, np.int64)
    new[used] = place
    mesh = Mesh(points, hexahedra, part, names)
    check_mesh(mesh)
    return Mesh(points, hexahedra, part, names, _sides(mesh, raw, new))


def _parts(raw: RawMesh) -> tuple[tuple[str, ...], Index]:
    """Return the names of the parts and the part of each element.

    Sets of all elements are no parts where there are others.
    """
    count = len(raw.hexahedra)
    sets = {_clean(name): members for name, members in raw.parts.items() if len(members)}
    if len(sets) < sum(len(members) > 0 for members in raw.parts.values()):
        raise InputError("mesh.file", ", ".join(raw.parts), "parts whose names differ in letters and digits")
    some = {name: members for name, members in sets.items() if len(members) < count}
    sets = some or dict(list(sets.items())[:1])
    part = np.full(count, -1, np.int32)
    names = list(sets)
    for number, (name, members) in enumerate(sets.items()):
        taken = part[members]
        if np.any(taken >= 0):
            other = names[int(taken.max())]
            raise InputError(
                "mesh.file",
                f"sets {other} and {name} overlap",
                "one part for each element",
                "gmsh: a volume in one physical group; Abaqus: parts by solid sections",
            )
        part[members] = number
    if np.any(part < 0):
        names.append("unnamed")
        part[part < 0] = len(names) - 1
    return tuple(names), part


def _turned(points: Array, hexahedra: Index) -> Index:
    """Return hexahedra of which those with a negative volume are turned inside out."""
    return np.where((volumes(points, hexahedra) < 0.0)[:, None], hexahedra[:, FLIPPED], hexahedra)


def _close_together(points: Array, hexahedra: Index, part: Index) -> tuple[Array, Index, Index, Whole]:
    """Return points and elements in an order of memory, elements by part, and where each point went."""
    numbered = np.column_stack([points, np.arange(len(points))])
    moved, _ = renumbered(numbered, hexahedra)
    place = np.empty(len(points), np.int64)
    place[moved[:, 3].astype(np.int64)] = np.arange(len(points))
    hexahedra = place[hexahedra].astype(np.int32)
    order = np.lexsort((hexahedra.min(axis=1), part))
    return moved[:, :3].copy(), hexahedra[order], part[order], place


def _sides(mesh: Mesh, raw: RawMesh, new: Whole) -> dict[str, Index]:
    """Return the sides of each part: faces that were named, and faces whose four nodes are in a node set."""
    sides: dict[str, Index] = {}
    exterior = {part: exterior_faces(mesh.hexahedra[mesh.elements_of(part)]) for part in mesh.names}
    for name, quads in raw.quads.items():
        faces = new[quads] if len(quads) else np.empty((0, 4), np.int64)
        on_surface = np.zeros(len(faces), bool)
        for part, outside in exterior.items():
            matched, hit = _matched(outside, faces)
            on_surface |= hit
            if len(matched):
                sides[f"{part}.{_clean(name)}"] = matched
        if not on_surface.all():
            got = f"{int((~on_surface).sum())} of {len(faces)} faces of {_clean(name)} elsewhere"
            raise InputError("mesh.file", got, "named faces on the surface of a part")
    for name, nodes in raw.node_sets.items():
        inside = np.zeros(len(mesh.points), bool)
        places = new[nodes]
        inside[places[places >= 0]] = True
        for part, outside in exterior.items():
            matched = outside[inside[outside].all(axis=1)]
            if len(matched):
                sides.setdefault(f"{part}.{_clean(name)}", matched)
    return sides


def _matched(outside: Index, faces: Whole) -> tuple[Index, NDArray[np.bool_]]:
    """Return the exterior faces that have the nodes of some of the faces, and which of those were found."""
    keys = np.sort(np.concatenate([outside, faces]), axis=1)
    _, number = np.unique(keys, axis=0, return_inverse=True)
    own, wanted = number.ravel()[: len(outside)], number.ravel()[len(outside) :]
    return outside[np.isin(own, wanted)], np.isin(wanted, own)


def _clean(name: str) -> str:
    """Return a name of letters, digits, _, + and -, at most 60 of them.

    Examples
    --------
    >>> _clean("top face.1")
    'top-face-1'
    """
    return re.sub("[^A-Za-z0-9_+-]+", "-", name)[:LONGEST_NAME] or "unnamed"


def _read_meshio(file: Path, kind: str) -> RawMesh:
    """Return what meshio finds in a file, in a process with bounds; whatever ends it means that the file is damaged."""
    if importlib.util.find_spec("meshio") is None:
        hint = "pip install 'strikewave[mesh]'"
        raise InputError("mesh.file", file.name, f"{file.suffix} only where meshio is installed", hint)
    size = file.stat().st_size
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "mesh.npz"
        memory = LEAST_MEMORY + MEMORY_PER_BYTE * size
        seconds = math.ceil(LEAST_TIME + size / BYTES_PER_SECOND)
        words = (kind, str(file.resolve()), str(target), str(memory), str(seconds))
        try:
            done = subprocess.run(
                python_command(meshio_child.__file__, *words),
                capture_output=True,
                text=True,
                timeout=seconds,
                env=environment(**ONE_THREAD),
                check=False,
            )
            reason = done.stderr[-LONGEST_HINT:] or f"the reader ended with {done.returncode}"
        except subprocess.TimeoutExpired:
            reason = "it takes too long"
        if not target.is_file():
            hint = f"it could not be read: {reason}" + (GMSH_HINT if kind == "gmsh" else "")
            raise InputError("mesh.file", file.name, f"a {kind} file", hint)
        with np.load(target, allow_pickle=False) as archive:
            arrays = dict(archive)
    names = json.loads(str(arrays["words"]))
    refuse_other_solids(names["others"])
    points, quads = arrays["points"], arrays["quads"]
    if points.ndim != 2 or points.shape[1] != 3 or (quads.size and not 0 <= quads.min() <= quads.max() < len(points)):
        raise InputError("mesh.file", f"points {points.shape}", "three coordinates for each node that is used")
    return RawMesh(
        points,
        arrays["hexahedra"],
        dict(_members(names["parts"], arrays["parts"])),
        {name: quads[members] for name, members in _members(names["sides"], arrays["sides"])},
    )


def _members(names: Sequence[str], rows: Whole) -> Iterator[tuple[str, Whole]]:
    """Yield the name and the cells of each group; rows are number of the group, cell."""
    for number, name in enumerate(names):
        yield name, rows[rows[:, 0] == number, 1]
