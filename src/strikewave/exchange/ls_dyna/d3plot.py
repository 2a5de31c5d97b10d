"""Fields that LS-DYNA wrote: ``d3plot``, ``d3plot01``, ... as a mesh of hexahedra and frames; SI.

Read by this module alone, in NumPy, without a library: of a model of 8-node solids all that is read here is two tables.
Words of 4 or 8 bytes, either byte order. Other elements are stepped over; what the layout does not let step over
(particles, fluids, solids of more than 8 nodes, roads) is refused by name.

Every count of the header is checked against the size of the files before memory is taken; one state at a time is held.

Source: LSTC, "LS-DYNA Database Binary Output Files" (2017): control data, geometry, numbering, titles, state data.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError
from strikewave.exchange.ls_dyna.histories import title_of
from strikewave.fem.mesh import Mesh
from strikewave.fem.run import FieldFrame
from strikewave.fem.vtkhdf import MOST_NODES

if TYPE_CHECKING:
    from strikewave.exchange.units import UnitSystem

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

END = -999999.0
"""Stands in place of a time where the states of a file end, and before titles."""
HEADER = 64
"""Words of control data; further ones may follow."""
MOST_EXTRA = 1024
"""Further words of control data at most; versions up to R16 write 64 or 128."""
NUMBERS_PER_NODE = 100
"""Numbers for each of them that a count of the header may stand for: states of solids have some tens."""
TITLE = 72
"""Characters of a title; 4 to a word, in files of 8-byte words too."""
HEADING, PART_TITLES, LISTS = 90000, 90001, (90001, 90002, 90020)
"""Kinds of titles: of the run, of parts, and all that are lists of numbers and titles (parts, contacts, fluids)."""
KINDS = range(90000, 1_000_000)
"""Range of the kinds of titles; as a time, none of these words is above 1e-38."""
CONTROL = {
    "dimensions": 15, "nodes": 16, "globals": 18, "temperatures": 19, "coordinates": 20, "velocities": 21,
    "accelerations": 22, "solids": 23, "solid_numbers": 27, "beams": 28, "beam_numbers": 30, "shells": 31,
    "shell_numbers": 33, "solid_history": 34, "layers": 36, "particles": 37, "numbering": 39, "thick_shells": 40,
    "thick_numbers": 42, "stress": 43, "plastic_strain": 44, "fluid_materials": 47, "flow": 48, "materials": 51,
    "gas_particles": 54, "shells_of_8": 55, "temperature_rates": 56, "extra": 57,
}  # fmt: skip
"""Place of each count in the control data, words."""
EXTRA = {"solids_of_20": 64, "solid_heat": 65, "solids_of_27": 66, "solids_of_21": 68, "solids_of_15": 69,
         "solids_of_20_t": 71, "solids_of_40": 72, "solids_of_64": 73}  # fmt: skip
"""The same, where there are so many words."""
REFUSED = (
    "particles", "gas_particles", "shells_of_8", "solids_of_20", "solids_of_27", "solids_of_21", "solids_of_15",
    "solids_of_20_t", "solids_of_40", "solids_of_64", "flow",
)  # fmt: skip
"""Counts that must be 0."""

COUNTED = (
    "nodes", "globals", "solids", "beams", "shells", "thick_shells", "numbering", "materials", "solid_heat",
    "fluid_materials", "solid_numbers", "beam_numbers", "shell_numbers", "thick_numbers", "solid_history",
)  # fmt: skip
"""Counts that are bounded before they are used."""


class D3plotState(NamedTuple):
    """A field at an instant, and which elements are not deleted, (elements,)."""

    frame: FieldFrame
    alive: NDArray[np.bool_]


@dataclass(frozen=True)
class D3plot:
    """The solids of a model and where their states stand.

    Attributes
    ----------
    mesh : Mesh
        m; parts are named as in the file, ``part-NUMBER`` where they have no title of their own.
    numbers : tuple of int
        Number of each part, in the order of the mesh.
    """

    mesh: Mesh
    numbers: tuple[int, ...]
    _files: tuple[Path, ...]
    _layout: _StateLayout
    _order: Whole
    _units: UnitSystem

    def states(self) -> Iterator[D3plotState]:
        """Yield the states in the order of time, one in memory at a time.

        A state that is cut off, as where a run was killed, and all after it, is left out.
        """
        last = -np.inf
        for place, file in enumerate(self._files):
            for words in _stored(file, self._layout, self._layout.begin if place == 0 else 0):
                if words[0] == END or words[0] <= last or self._is_padding(words):
                    break
                last = float(words[0])
                yield _finite(file, self._state(words))

    def _is_padding(self, words: NDArray[Any]) -> bool:
        """Return whether these are zeros that fill a file up to a whole block: no node has a place."""
        return not words[self._layout.place_of_nodes :][: 3 * len(self.mesh.points)].any()

    def _state(self, words: NDArray[Any]) -> D3plotState:
        layout, units, count = self._layout, self._units, len(self.mesh.points)
        nodes = words[layout.place_of_nodes :]
        moved = nodes[: 3 * count].reshape(-1, 3) * units.length - self.mesh.points
        velocity = np.zeros_like(moved)
        if layout.place_of_velocity is not None:
            place = layout.place_of_velocity
            velocity = words[place : place + 3 * count].reshape(-1, 3) / units.velocity
        solids = words[layout.place_of_solids :][: layout.solids * layout.solid_numbers]
        points = solids.reshape(layout.solids, layout.points, -1)[self._order].mean(axis=1)
        stress, strain = points[:, :6] / units.stress, points[:, 6] if layout.strained else np.zeros(layout.solids)
        alive = np.ones(layout.solids, bool)
        if layout.place_of_alive is not None:
            alive = words[layout.place_of_alive :][: layout.solids][self._order] != 0.0
        return D3plotState(FieldFrame(float(words[0]) * units.time, moved, velocity, stress, strain), alive)


class _StateLayout(NamedTuple):
    """Places of things in a state, in words, and the begin of the states in the first file, bytes."""

    real: np.dtype[Any]
    begin: int
    words: int
    solids: int
    solid_numbers: int
    points: int
    strained: bool
    place_of_nodes: int
    place_of_velocity: int | None
    place_of_solids: int
    place_of_alive: int | None


def read_d3plot(path: Path, units: UnitSystem) -> D3plot:
    """Return the solids of a d3plot; its states are read when they are asked for.

    Parameters
    ----------
    path : Path
        The first file, ``d3plot``; the others, ``d3plot01`` and so on, stand beside it.
    units : UnitSystem
        Units of the model.
    """
    reader = _Reader(path)
    control = reader.control
    _check(path, control)
    rigid_shells = reader.skip_materials()
    points = reader.reals(3 * control["nodes"]).reshape(-1, 3) * units.length
    solids = reader.integers(9 * control["solids"]).reshape(-1, 9)
    for kind, words in (("thick_shells", 9), ("beams", 6), ("shells", 5)):
        reader.skip(words * control[kind])
    numbers = reader.part_numbers()
    titles = reader.titles()
    hexahedra, part = solids[:, :8] - 1, solids[:, 8] - 1
    inside = solids.size and hexahedra.min() >= 0 and hexahedra.max() < len(points) and part.min() >= 0
    if not inside or part.max() >= max(control["materials"], 1) or not np.isfinite(points).all():
        raise _damaged(path, "solids that name nodes and parts beyond those of the file")
    used, place = np.unique(part, return_inverse=True)
    order = np.argsort(place, kind="stable")
    own = tuple(int(numbers[k]) if k < len(numbers) else int(k) + 1 for k in used)
    mesh = Mesh(points, hexahedra[order].astype(np.int32), place[order].astype(np.int32), _names(own, titles))
    layout = _state_layout(path, reader, rigid_shells)
    return D3plot(mesh, own, _family(path), layout, order, units)


class _Reader:
    """Reads the geometry of the first file, word by word; never beyond its end."""

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            if not path.is_file() or path.stat().st_size < 4 * HEADER:
                raise InputError("FILE", path, f"a file of at least {4 * HEADER} bytes")
            self.held: Any = np.memmap(path, np.uint8, "r")
        except OSError as error:
            raise InputError("FILE", path, "a file that can be read", error.strerror or str(error)) from None
        self.size, order = self._words()
        self.whole = np.dtype(f"{order}i{self.size}")
        self.real = np.dtype(f"{order}f{self.size}")
        self.place = 0
        head = self.integers(HEADER)
        self.control = {name: int(head[k]) for name, k in CONTROL.items()}
        further = self.integers(min(max(self.control["extra"], 0), MOST_EXTRA))
        for name, k in EXTRA.items():
            self.control[name] = int(further[k - HEADER]) if k - HEADER < len(further) else 0

    def _words(self) -> tuple[int, str]:
        """Return the size of a word and the byte order: those for which dimensions and file type make sense."""
        for size in (4, 8):
            for order in "<>":
                head = np.frombuffer(self.held[: size * HEADER].tobytes(), f"{order}i{size}")
                if len(head) == HEADER and head[11] % 1000 in (1, 5) and 2 <= head[15] <= 9 and head[16] > 0:
                    if head[11] > 1000:
                        raise _refused(self.path, "numbers of 8 bytes in a file of 4")
                    return size, order
        raise InputError("FILE", self.path, "a d3plot of LS-DYNA", "its control data are of something else")

    def take(self, bytes_: int) -> bytes:
        """Return so many bytes and go on behind them."""
        if bytes_ > self.held.size - self.place:
            raise _damaged(self.path, f"{bytes_} bytes from byte {self.place} on, which it does not have")
        self.place += bytes_
        return bytes(self.held[self.place - bytes_ : self.place])

    def integers(self, count: int) -> Whole:
        return np.frombuffer(self.take(count * self.size), self.whole).astype(np.int64)

    def reals(self, count: int) -> Array:
        return np.frombuffer(self.take(count * self.size), self.real).astype(float)

    def skip(self, count: int) -> None:
        if count * self.size > self.held.size - self.place:
            raise _damaged(self.path, f"{count} words from byte {self.place} on, which it does not have")
        self.place += count * self.size

    def skip_materials(self) -> int:
        """Step over the types of materials and fluids; return how many shells are rigid and have no state."""
        rigid = 0
        if self.control["dimensions"] in (5, 7):
            rigid, count = self.integers(2)
            self.skip(int(count))
        self.skip(self.control["fluid_materials"])
        return int(rigid)

    def part_numbers(self) -> Whole:
        """Step over the numbers of nodes and elements; return those of the parts in the order of the file."""
        begin, words = self.place, self.control["numbering"]
        self.skip(words)
        if words < 16:
            return np.empty(0, np.int64)
        self.place = begin
        head = self.integers(16)
        if head[0] > 0:
            self.place = begin + words * self.size
            return np.empty(0, np.int64)
        count = self.control["materials"]
        self.place = begin + (words - 3 * count) * self.size
        return self.integers(3 * count)[:count]

    def titles(self) -> dict[int, str]:
        """Return the titles of parts by their numbers; leave the place where the states begin."""
        by_number: dict[int, str] = {}
        if self._next_real() != END:
            return by_number
        self.skip(1)
        while (kind := self._next_whole()) in KINDS:
            self.skip(1)
            if kind == HEADING:
                self.take(TITLE)
            elif kind not in LISTS:
                raise _refused(self.path, f"titles of kind {kind}")
            else:
                count = int(self.integers(1)[0])
                row = np.dtype([("number", self.whole), ("title", f"S{TITLE}")])
                if not 0 <= count <= MOST_NODES:
                    raise _damaged(self.path, f"{count} titles")
                rows = np.frombuffer(self.take(count * row.itemsize), row)
                if kind == PART_TITLES:
                    by_number = {int(n): title_of(text) for n, text in rows}
            if self._next_real() == END:
                self.skip(1)
        return by_number

    def _next_real(self) -> float:
        return float(self._peek(self.real)) if self.place + self.size <= self.held.size else np.nan

    def _next_whole(self) -> int:
        return int(self._peek(self.whole)) if self.place + self.size <= self.held.size else 0

    def _peek(self, dtype: np.dtype[Any]) -> Any:
        return np.frombuffer(bytes(self.held[self.place : self.place + self.size]), dtype)[0]


def _check(path: Path, control: dict[str, int]) -> None:
    """Refuse what cannot be stepped over, and counts that no file has."""
    for name in REFUSED:
        if control[name] != 0:
            raise _refused(path, name.replace("_", " "))
    if control["dimensions"] not in (4, 5):
        raise _refused(path, f"NDIM = {control['dimensions']} (roads, rigid body data, or packed elements)")
    if control["solids"] <= 0:
        raise _refused(path, "no solids, or solids of 10 nodes")
    if control["coordinates"] == 0 or control["stress"] not in (999, 1000):
        raise _refused(path, "no coordinates or no stress of solids in its states")
    for name in COUNTED:
        if not 0 <= control[name] <= NUMBERS_PER_NODE * MOST_NODES:
            raise _damaged(path, f"{control[name]} {name.replace('_', ' ')}")


def _state_layout(path: Path, reader: _Reader, rigid_shells: int) -> _StateLayout:
    """Return where things stand in a state; see "State data" of the source."""
    c, nodes = reader.control, reader.control["nodes"]
    heat, rates = c["temperatures"] % 10, c["temperature_rates"]
    warm = {0: 0, 1: 1, 2: 4, 3: 6}.get(heat, 0) + (c["temperatures"] // 10 % 10 == 1)
    warm += (rates % 10 == 1) + 6 * (rates // 10 % 10 == 1)
    place_of_nodes = 1 + c["globals"]
    place = place_of_nodes + nodes * (3 + warm)
    velocity = place if c["velocities"] else None
    place += 3 * nodes * (bool(c["velocities"]) + bool(c["accelerations"])) + c["solid_heat"] * c["solids"]
    place_of_solids = place
    place += c["solids"] * c["solid_numbers"] + c["thick_shells"] * c["thick_numbers"] + c["beams"] * c["beam_numbers"]
    place += (c["shells"] - rigid_shells) * c["shell_numbers"]
    elements = c["solids"] + c["thick_shells"] + c["beams"] + c["shells"]
    alive = place if c["layers"] <= -10000 else None
    place += elements if alive is not None else nodes * (c["layers"] < 0)
    strained = c["plastic_strain"] in (999, 1000)
    each = 6 + strained + c["solid_history"]
    points = 8 if c["solid_numbers"] >= 8 * each else 1
    if c["solid_numbers"] < each or c["solid_numbers"] % points:
        raise _damaged(path, f"{c['solid_numbers']} numbers to a solid, where {each} are needed")
    return _StateLayout(
        reader.real, reader.place, place, c["solids"], c["solid_numbers"], points, strained,
        place_of_nodes, velocity, place_of_solids, alive,
    )  # fmt: skip


def _stored(file: Path, layout: _StateLayout, begin: int) -> Iterator[NDArray[Any]]:
    """Yield the states of a file as words; what is left at its end is none."""
    try:
        with file.open("rb") as stream:
            if layout.words * layout.real.itemsize > file.stat().st_size - begin:
                return
            stream.seek(begin)
            while len(words := np.fromfile(stream, layout.real, layout.words)) == layout.words:
                yield words.astype(float)
    except OSError as error:
        raise InputError("FILE", file, "a file that can be read", error.strerror or str(error)) from None


def _finite(file: Path, state: D3plotState) -> D3plotState:
    """Return a state in which all is finite."""
    for what, values in vars(state.frame).items():
        if not np.isfinite(values).all():
            field = f"{file.name}, {what.replace('_', ' ')} at {state.frame.time:g} s"
            raise InputError(field, "NaN or infinity", "finite numbers", "the run blew up there")
    return state


def _family(path: Path) -> tuple[Path, ...]:
    """Return the files of a run, the first one before those with numbers, in their order."""
    beside = path.absolute().parent
    numbered = re.compile(re.escape(path.name) + r"(\d{2,5})")
    by_number = {int(match[1]): file for file in beside.iterdir() if (match := numbered.fullmatch(file.name))}
    return (path, *(by_number[number] for number in sorted(by_number)))


def _names(numbers: tuple[int, ...], titles: dict[int, str]) -> tuple[str, ...]:
    """Return a name for each part: its title where no other has it, else its number."""
    wanted = [titles.get(number, "") for number in numbers]
    return tuple(
        title if title and wanted.count(title) == 1 else f"part-{number}"
        for number, title in zip(numbers, wanted, strict=True)
    )


def _refused(path: Path, what: str) -> InputError:
    hint = "solids of 8 nodes are read; shells and beams are stepped over"
    return InputError("FILE", f"{path.name}: {what}", "a d3plot without it", hint)


def _damaged(path: Path, what: str) -> InputError:
    return InputError("FILE", f"{path.name} claims {what}", "a d3plot that is whole")
