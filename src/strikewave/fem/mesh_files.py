"""Meshes from files: gmsh (.msh) and VTK (.vtk, .vtu) through meshio, Abaqus (.inp) as read here.

Parts are gmsh's physical volumes, Abaqus' element sets or the numbers of VTK cell data; sides are physical surfaces,
element surfaces, groups of quadrilaterals and node sets.

Of an Abaqus file are read ``*NODE``, ``*ELEMENT``, ``*NSET``, ``*ELSET`` (also ``GENERATE``), ``*SURFACE,
TYPE=ELEMENT`` and the set of each ``*SOLID SECTION``; all else is passed over. Parts are the sets of the solid
sections; without those, the sets that hold each element once, be they named with the elements or on their own. A file
of several parts or instances is refused, as its numbers have no meaning without their part; so is one that includes
other files.
"""

from __future__ import annotations

import functools
import importlib.util
import json
import math
import re
import subprocess
import tempfile
from array import array
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import EXISTING_FILE, InputError, MissingPackageError, nearest
from strikewave.base.processes import ONE_THREAD, environment, python_command
from strikewave.fem import meshio_child
from strikewave.fem.mesh import FACES, Array, Index, Mesh, exterior_faces, volumes
from strikewave.fem.quality import FARTHEST, check_mesh
from strikewave.fem.sections import FLIPPED, renumbered

Whole = NDArray[np.integer]

LARGEST_FILE = 1 << 30  # five times `LARGEST_COUNT` hexahedra as text, about 100 bytes for an element and its node
"""Most bytes of a mesh file."""

LARGEST_COUNT = 2_000_000  # two thirds of what a model may have, and minutes to read
"""Most hexahedra of a mesh file."""

SOLIDS_HINT = 'mesh it with hexahedra; in gmsh: transfinite volumes with "Recombine", or Mesh.SubdivisionAlgorithm = 2'
"""Hint for a mesh of tetrahedra: gmsh makes those unless it is asked for hexahedra."""


@dataclass(frozen=True)
class RawMesh:
    """Nodes, hexahedra and what is named in a file."""

    points: Array
    """Places of the nodes, (nodes, 3)."""
    hexahedra: Index
    """Nodes of each element, (elements, 8)."""
    parts: Mapping[str, Whole] = field(default_factory=dict)
    """Hexahedra by part; each belongs to one part at most."""
    quads: Mapping[str, Whole] = field(default_factory=dict)
    """Faces by the name of their side, (faces, 4)."""
    node_sets: Mapping[str, Whole] = field(default_factory=dict)
    """Nodes by the name of their set."""


def refuse_other_solids(counts: Mapping[str, int]) -> None:
    """Refuse solids that are not hexahedra of 8 nodes, by their count."""
    if counts:
        listed = ", ".join(f"{count} {kind}" for kind, count in sorted(counts.items()))
        raise InputError("mesh.file", listed, "hexahedra of 8 nodes as its only solids", SOLIDS_HINT)


HEXAHEDRON = re.compile(r"C3D8[A-Z]*\Z")
"""Types of 8-node hexahedra: letters after the 8 say how they are integrated, not what their nodes are."""
QUAD = re.compile(r"(S4|CPS4|CPE4|M3D4|R3D4|SFM3D4)[A-Z]*\Z")
"""Types of quadrilaterals, which mark sides: shells, plane elements, membranes, rigid and surface elements."""
SOLID = re.compile(r"C3D\d+[A-Z]*\Z")
"""Types of all solids: those that are not hexahedra of 8 nodes are refused."""

FLAT_HINT = "write it flat: one part, one instance (in Abaqus/CAE: noPartsInputFile=ON)"
"""Hint for numbers that mean nothing without their part."""

LONGEST_LINE = 10_000  # Abaqus takes 256 a line, and some tens of lines are the longest in use
"""Most characters of a keyword with its options."""

LARGEST_SETS = 100_000_000  # 800 MB: sets of sets could multiply without end
"""Most members of all sets and surfaces together."""


@dataclass
class _Contents:
    """Contents of a file: numbers as they stand there, names in capitals (Abaqus knows no case)."""

    nodes: array[int] = field(default_factory=lambda: array("q"))
    places: array[float] = field(default_factory=lambda: array("d"))
    hexahedra: array[int] = field(default_factory=lambda: array("q"))
    quads: dict[str, array[int]] = field(default_factory=dict)
    node_sets: dict[str, list[str]] = field(default_factory=dict)
    element_sets: dict[str, list[str]] = field(default_factory=dict)
    with_elements: dict[str, None] = field(default_factory=dict)
    surfaces: dict[str, list[str]] = field(default_factory=dict)
    sections: list[str] = field(default_factory=list)
    others: dict[str, int] = field(default_factory=dict)
    parts: int = 0
    instances: int = 0
    spelled: dict[str, str] = field(default_factory=dict)

    def known(self, name: str) -> str:
        """Return a name in capitals, and remember how it was first written."""
        self.spelled.setdefault(name.upper(), name)
        return name.upper()


Rows = list[str]
Options = dict[str, str]


def read_abaqus(path: Path) -> RawMesh:
    """Return nodes, elements and sets of an Abaqus input file, or refuse it by the line that is wrong."""
    contents = _Contents()
    with path.open(encoding="latin-1") as lines:
        for keyword, options, rows in _blocks(lines):
            if keyword in _READERS:
                try:
                    _READERS[keyword](contents, options, rows)
                except (ValueError, OverflowError) as error:
                    if isinstance(error, InputError):
                        raise
                    raise InputError(f"mesh.file *{keyword}", str(error), "numbers as Abaqus writes them") from None
    refuse_other_solids(contents.others)
    return _Resolver(contents).mesh()


def _blocks(lines: Iterable[str]) -> Iterator[tuple[str, Options, Rows]]:
    """Yield each keyword with its options and the lines of its data."""
    keyword, options, rows = "", Options(), Rows()
    pending = ""
    for raw in lines:
        line = raw.strip()
        if not line or line.startswith("**"):
            continue
        if pending or line.startswith("*"):
            line = pending + line
            pending = line if line.endswith(",") else ""
            if len(line) > LONGEST_LINE:
                raise InputError("mesh.file", line, f"keywords of at most {LONGEST_LINE} characters")
            if pending:
                continue
            yield keyword, options, rows
            name, *terms = (term.strip() for term in line[1:].split(","))
            keyword, rows = " ".join(name.upper().split()), []
            pairs = (term.partition("=") for term in terms)
            options = {key.strip().upper(): value.strip().strip('"') for key, _, value in pairs}
        elif keyword in _READERS:
            rows.append(line)
    yield keyword, options, rows


def _entries(rows: Rows) -> Iterator[list[str]]:
    """Yield the entries of each line."""
    for row in rows:
        entries = [entry.strip() for entry in row.split(",")]
        yield entries if entries[-1] else entries[:-1]


def _nodes(contents: _Contents, options: Options, rows: Rows) -> None:
    for number, *place in _entries(rows):
        contents.nodes.append(int(number))
        xyz = [float(x.upper().replace("D", "E")) if x else 0.0 for x in place[:3]]
        contents.places.extend(xyz + [0.0] * (3 - len(xyz)))
        if "NSET" in options:
            contents.node_sets.setdefault(contents.known(options["NSET"]), []).append(number)


def _elements(contents: _Contents, options: Options, rows: Rows) -> None:
    kind = options.get("TYPE", "").upper()
    size = 9 if HEXAHEDRON.match(kind) else 5 if QUAD.match(kind) else 0
    if not size:
        if SOLID.match(kind):
            contents.others[kind] = contents.others.get(kind, 0) + len(rows)
        return
    numbers = array("q", (int(entry) for entries in _entries(rows) for entry in entries if entry))
    if len(numbers) % size:
        raise InputError(f"mesh.file *ELEMENT, TYPE={kind}", f"{len(numbers)} numbers", f"{size} for each element")
    name = contents.known(options["ELSET"]) if options.get("ELSET") else ""
    if size == 5:
        contents.quads.setdefault(name, array("q")).extend(numbers)
        return
    contents.hexahedra.extend(numbers)
    if len(contents.hexahedra) > 9 * LARGEST_COUNT:
        raise InputError("mesh.file", f"{len(contents.hexahedra) // 9} hexahedra", f"at most {LARGEST_COUNT}")
    if name:
        contents.with_elements[name] = None
        contents.element_sets.setdefault(name, []).extend(str(number) for number in numbers[::9])


def _set(key: str) -> _Reader:
    """Return the reader of *NSET or *ELSET; a generated row is kept as first:last:step."""

    def read(contents: _Contents, options: Options, rows: Rows) -> None:
        if not options.get(key):
            raise InputError(f"mesh.file *{key}", "no name", f"{key}=name")
        sets = contents.node_sets if key == "NSET" else contents.element_sets
        members = sets.setdefault(contents.known(options[key]), [])
        for entries in _entries(rows):
            if "GENERATE" in options:
                first, last, step = (int(entry) for entry in [*entries, "1"][:3])
                members.append(f"{first}:{last}:{step}")
            else:
                members.extend(entry for entry in entries if entry)

    return read


def _surface(contents: _Contents, options: Options, rows: Rows) -> None:
    if options.get("TYPE", "ELEMENT").upper() == "ELEMENT" and options.get("NAME"):
        contents.surfaces.setdefault(contents.known(options["NAME"]), []).extend(rows)


def _section(contents: _Contents, options: Options, rows: Rows) -> None:
    if options.get("ELSET"):
        contents.sections.append(contents.known(options["ELSET"]))


def _part(contents: _Contents, options: Options, rows: Rows) -> None:
    contents.parts += 1
    if contents.parts > 1:
        raise InputError("mesh.file", "several *PART", "one part", FLAT_HINT)


def _instance(contents: _Contents, options: Options, rows: Rows) -> None:
    contents.instances += 1
    if contents.instances > 1 or rows:
        got = "an *INSTANCE that is moved" if rows else "several *INSTANCE"
        raise InputError("mesh.file", got, "one instance where its part stands", FLAT_HINT)


def _include(contents: _Contents, options: Options, rows: Rows) -> None:
    raise InputError("mesh.file", "*INCLUDE", "a file that holds the whole mesh", "put the included lines in its place")


_Reader = Callable[[_Contents, Options, Rows], None]
_READERS: dict[str, _Reader] = {
    "NODE": _nodes,
    "ELEMENT": _elements,
    "NSET": _set("NSET"),
    "ELSET": _set("ELSET"),
    "SURFACE": _surface,
    "SOLID SECTION": _section,
    "PART": _part,
    "INSTANCE": _instance,
    "INCLUDE": _include,
}
"""Readers by keyword; data of other keywords are passed over."""


class _Resolver:
    """Turns the numbers of a file into places in arrays."""

    def __init__(self, contents: _Contents) -> None:
        self.contents = contents
        self.spent = 0
        rows = (
            np.frombuffer(contents.hexahedra, np.int64).reshape(-1, 9)
            if contents.hexahedra
            else np.empty((0, 9), np.int64)
        )
        self.nodes = _Numbers("node", np.array(contents.nodes, np.int64))
        self.elements = _Numbers("element", rows[:, 0])
        self.hexahedra = self.nodes.places(rows[:, 1:])

    def mesh(self) -> RawMesh:
        """Return the mesh with its parts, sides and sets."""
        contents = self.contents
        sets = self._sets(contents.element_sets, self.elements)
        nodes = self._sets(contents.node_sets, self.nodes)
        spell = contents.spelled
        return RawMesh(
            points=np.array(contents.places).reshape(-1, 3),
            hexahedra=self.hexahedra.astype(np.int32),
            parts={spell[name]: sets[name] for name in self.parts(sets) if name in sets and len(sets[name])},
            quads={
                **{spell[name]: self._shells(quads) for name, quads in contents.quads.items() if name},
                **{spell[name]: self._surface(name, sets) for name in contents.surfaces},
            },
            node_sets={spell[name]: members for name, members in nodes.items() if not name.startswith("_")},
        )

    def parts(self, sets: dict[str, Whole]) -> list[str]:
        """Return the sets that are parts: those of solid sections, or the first choice that holds each element once.

        Chosen from are the sets named with the elements, if several; those on their own of which no surface is made;
        the one named with all elements; and all. Where none fits, sets that are only there for a surface are left out.
        """
        if self.contents.sections:
            return list(dict.fromkeys(self.contents.sections))
        of_surfaces = {row[0].upper() for rows in self.contents.surfaces.values() for row in _entries(rows) if row}
        own = list(self.contents.with_elements)
        some = [name for name in sets if not name.startswith("_") and len(sets[name]) < len(self.hexahedra)]
        alone = [name for name in some if name not in own and name not in of_surfaces]
        choices = (own if len(own) > 1 else [], alone, own, some)
        return next((names for names in choices if self._each_once(names, sets)), [*own, *alone])

    def _each_once(self, names: list[str], sets: dict[str, Whole]) -> bool:
        """Return whether each element is in one of the sets, and in one only."""
        count = len(self.hexahedra)
        members = [sets[name] for name in names]
        return sum(map(len, members)) == count and len(np.unique(np.concatenate([[], *members]))) == count

    def _shells(self, quads: array[int]) -> Whole:
        return self.nodes.places(np.frombuffer(quads, np.int64).reshape(-1, 5)[:, 1:])

    def _sets(self, written: dict[str, list[str]], numbers: _Numbers) -> dict[str, Whole]:
        """Return the members of each set that there are: numbers, ranges, and members of sets named before it."""
        sets: dict[str, Whole] = {}
        for name, entries in written.items():
            single = array("q", (int(entry) for entry in entries if entry.isdecimal()))
            members = [numbers.known(np.array(single, np.int64))]
            for entry in dict.fromkeys(entry.upper() for entry in entries if not entry.isdecimal()):
                if ":" in entry:
                    first, last, step = (int(number) for number in entry.split(":"))
                    members.append(numbers.between(first, last, step))
                elif entry in sets:
                    members.append(sets[entry])
                else:
                    raise InputError(f"mesh.file set {name}", entry, "a set that comes before it", nearest(entry, sets))
                self._spend(len(members[-1]))
            sets[name] = np.unique(np.concatenate(members))
        return sets

    def _surface(self, name: str, sets: dict[str, Whole]) -> Whole:
        """Return the faces of a surface: rows of a set or an element, and S1 to S6, or all that are exposed."""
        faces: list[Whole] = [np.empty((0, 4), np.int64)]
        exposed: list[Whole] = []
        rows = _entries(self.contents.surfaces[name])
        for member, label in dict.fromkeys((row[0], (*row, "")[1]) for row in rows if row):
            if member.isdecimal():
                elements = self.elements.known(np.array([int(member)], np.int64))
            elif member.upper() in sets:
                elements = sets[member.upper()]
            else:
                allowed = "an element or an element set"
                raise InputError(f"mesh.file surface {name}", member, allowed, nearest(member, sets))
            hexahedra = self.hexahedra[elements]
            if not label:
                exposed.append(elements)
            elif re.fullmatch("S[1-6]", label.upper()):
                faces.append(hexahedra[:, FACES[int(label[1]) - 1]])
            else:
                raise InputError(f"mesh.file surface {name}", label, "a face from S1 to S6")
            self._spend(len(elements))
        if exposed:
            faces.append(self._free_faces(np.unique(np.concatenate(exposed))))
        return np.concatenate(faces)

    def _free_faces(self, elements: Whole) -> Whole:
        """Return the faces of elements that no other element of the model shares."""
        faces = self.hexahedra[elements][:, FACES].reshape(-1, 4)
        self._spend(len(self.outside))
        keys = np.sort(np.concatenate([self.outside, faces]), axis=1)
        _, number = np.unique(keys, axis=0, return_inverse=True)
        exterior, candidates = np.split(number.ravel(), [len(self.outside)])
        return faces[np.isin(candidates, exterior)]

    @functools.cached_property
    def outside(self) -> Whole:
        """Exterior faces of the model."""
        return exterior_faces(self.hexahedra.astype(np.int32)).astype(np.int64)

    def _spend(self, members: int) -> None:
        """Refuse a file whose sets would fill the memory."""
        self.spent += members
        if self.spent > LARGEST_SETS:
            raise InputError("mesh.file", "sets of sets", f"at most {LARGEST_SETS} members of all sets together")


class _Numbers:
    """Numbers of nodes or elements in a file, each once."""

    def __init__(self, kind: str, numbers: Whole) -> None:
        self.kind = kind
        self.order = np.argsort(numbers, kind="stable")
        self.sorted = numbers[self.order]
        twice = self.sorted[1:][self.sorted[1:] == self.sorted[:-1]]
        if len(twice):
            raise InputError(f"mesh.file {kind}", f"number {twice[0]} twice", "each number once", FLAT_HINT)

    def known(self, numbers: Whole) -> Whole:
        """Return the places of those numbers that there are."""
        if not len(self.sorted):
            return np.empty(0, np.int64)
        near = np.minimum(np.searchsorted(self.sorted, numbers), len(self.sorted) - 1)
        return self.order[near[self.sorted[near] == numbers]]

    def between(self, first: int, last: int, step: int) -> Whole:
        """Return the places of the numbers first, first + step, ... up to last that there are."""
        if step < 1:
            raise InputError(f"mesh.file {self.kind} set", f"a step of {step}", "at least 1")
        low, high = np.searchsorted(self.sorted, [first, last + 1])
        return self.order[low:high][(self.sorted[low:high] - first) % step == 0]

    def places(self, numbers: Whole) -> Whole:
        """Return the places of numbers, all of which there must be."""
        places = self.known(numbers.ravel())
        if len(places) != numbers.size:
            missing = numbers.ravel()[~np.isin(numbers.ravel(), self.sorted)]
            raise InputError(f"mesh.file {self.kind}", f"number {missing[0]}", f"a {self.kind} of the file")
        return places.reshape(numbers.shape)


FORMATS = {".msh": "gmsh", ".vtk": "vtk", ".vtu": "vtu"}
"""Formats that meshio reads, by the end of the file's name."""

LEAST_MEMORY = 4 << 30  # a limit of addresses, of which libraries reserve far more than they use
"""Bytes that the process which reads a file may take, besides `MEMORY_PER_BYTE` times the file."""

MEMORY_PER_BYTE = 20  # a text of numbers becomes Python objects before it becomes arrays
"""Bytes of memory for each byte of a file."""

LEAST_TIME, BYTES_PER_SECOND = 60.0, 1e6  # meshio reads several times as much on a slow machine
"""Seconds that the process may take for any file, and the bytes that it must read in each second besides."""

LONGEST_HINT = 200  # the error stands at the end
"""Last characters of a report of meshio that a refusal shows."""

LONGEST_NAME = 60  # it stands in tables, legends and names of files
"""Most characters of a name."""

GMSH_HINT = "; gmsh writes what is read here with Mesh.MshFileVersion 4.1 (or 2.2), SaveAll and SaveParametric 0"
"""Hint for a .msh file that meshio refuses."""


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
        If the file cannot be read, or its elements cannot be computed (`strikewave.fem.quality.check_mesh`).
    """
    file = Path(path)
    if not 0.0 < scale < math.inf:
        raise InputError("scale", scale, "above 0, such as 1e-3 for a mesh in mm")
    if not file.is_file():
        raise InputError("mesh.file", path, EXISTING_FILE)
    if file.stat().st_size > LARGEST_FILE:
        raise InputError("mesh.file", f"{file.stat().st_size} bytes", f"at most {LARGEST_FILE}")
    kind = file.suffix.lower()
    if kind not in (*FORMATS, ".inp"):
        raise InputError("mesh.file", file.name, "a name that ends in .inp, " + ", ".join(FORMATS))
    return ordered_mesh(read_abaqus(file) if kind == ".inp" else _read_meshio(file, FORMATS[kind]), scale)


def ordered_mesh(raw: RawMesh, scale: float = 1.0) -> Mesh:
    """Return the mesh of the contents of a file; see `read_mesh`."""
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
    """Return hexahedra, those with a negative volume turned inside out."""
    return np.where((volumes(points, hexahedra) < 0.0)[:, None], hexahedra[:, FLIPPED], hexahedra)


def _close_together(points: Array, hexahedra: Index, part: Index) -> tuple[Array, Index, Index, Whole]:
    """Return points and elements with neighbours close in memory, elements by part, and the new place of each point."""
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
    """Return the exterior faces that have the nodes of some of the faces, and whether each of these is there."""
    keys = np.sort(np.concatenate([outside, faces]), axis=1)
    _, number = np.unique(keys, axis=0, return_inverse=True)
    own, wanted = number.ravel()[: len(outside)], number.ravel()[len(outside) :]
    return outside[np.isin(own, wanted)], np.isin(wanted, own)


def _clean(name: str) -> str:
    """Return a name of letters, digits, _, + and -, at most `LONGEST_NAME` of them."""
    return re.sub("[^A-Za-z0-9_+-]+", "-", name)[:LONGEST_NAME] or "unnamed"


def _read_meshio(file: Path, kind: str) -> RawMesh:
    """Return the mesh that meshio reads in a process with bounds; whatever ends that means that the file is damaged."""
    if importlib.util.find_spec("meshio") is None:
        raise MissingPackageError(f"mesh.file: {file.name}", "meshio", "mesh")
    size = file.stat().st_size
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "mesh.npz"
        memory = LEAST_MEMORY + MEMORY_PER_BYTE * size
        seconds = math.ceil(LEAST_TIME + size / BYTES_PER_SECOND)
        arguments = (kind, str(file.resolve()), str(target), str(memory), str(seconds))
        try:
            done = subprocess.run(
                python_command(meshio_child.__file__, *arguments),
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
    names = json.loads(str(arrays["names"]))
    refuse_other_solids(names["others"])
    points, quads = arrays["points"], arrays["quads"]
    if points.ndim != 2 or points.shape[1] != 3 or (quads.size and not 0 <= quads.min() <= quads.max() < len(points)):
        raise InputError("mesh.file", f"points {points.shape}", "three coordinates for each node of an element")
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
