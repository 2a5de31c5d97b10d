"""Parts of decks of all codes: sets, held nodes, curves that reach far enough, numbers in columns."""

from __future__ import annotations

import math
import re
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError
from strikewave.exchange.units import UnitSystem
from strikewave.fem.boundary import held_nodes, nodes_named
from strikewave.fem.contact import NEAR, TieState, extents
from strikewave.fem.engine import Engine
from strikewave.fem.mesh import Array, Index, Mesh
from strikewave.fem.model import Fixed, Guided, Model, RigidWall, Symmetry, Tie, TimeCurve
from strikewave.fem.solids import AnySolid, HeatedSolid, ZerilliArmstrong
from strikewave.fem.solve import check_controls

LARGEST_ID = 99_999_999
"""Largest number of a node or element in eight columns, those of LS-DYNA's standard format."""
ROWS = 4096
"""Rows that are written at once: half a megabyte of text, so that a deck of any size takes little memory."""
ALIGNED = 1e-9
"""Largest deviation of held directions from the axes: rounding of unit vectors; what is tilted gets axes of its
own."""
NEVER = 1e20
"""Stands for infinity: in the columns of any deck, and beyond any temperature or heat."""
SMALLEST = 1e-20
"""Stands for 0 where another code takes 0 for its own default: a coefficient as small does nothing."""
TIE_MARGIN = 1.01
"""Times the distance within which a node may lie off the face it is tied to: other codes measure to a face a little
otherwise, and numbers of a deck are cut to five digits."""
MOST_DIGITS = 15
"""Digits of a number in a deck: what a double holds."""


@dataclass(frozen=True)
class Deck:
    """Input of another code.

    Attributes
    ----------
    files : mapping of str to iterator of str
        Text in pieces, to be written one after another, by the end of the file's name, such as ``.k``.
    left_out : tuple of str
        Features of the model that the deck lacks, one line each.
    differs : tuple of str
        Features that the other code treats in its own way.
    """

    files: Mapping[str, Iterator[str]]
    left_out: tuple[str, ...]
    differs: tuple[str, ...]


@dataclass(frozen=True)
class Heading:
    """The name of a deck.

    Attributes
    ----------
    title : str
    case : str
        Name of the case.
    version : str
        Version of strikewave.
    frames : int
        Whole fields that the other code should write.
    notes : tuple of str
        Notes for a reader of its results, such as that a quarter is modelled.
    """

    title: str
    case: str = "model"
    version: str = ""
    frames: int = 20
    notes: tuple[str, ...] = ()

    @property
    def stem(self) -> str:
        r"""Beginning of the names of the files: the name of the case in letters that every code takes.

        Examples
        --------
        >>> Heading("A blow", "my case \u00e9").stem
        'my-case--'
        """
        return re.sub(r"[^A-Za-z0-9_.+-]", "-", self.case) or "model"


@dataclass(frozen=True)
class Restraint:
    """Nodes that are held along the same directions.

    Attributes
    ----------
    nodes : array (n,) of int32
    axes : array (3, 3)
        A right-handed local system by its rows; the global one where that does.
    held : tuple of bool
        True for each of the axes along which they are held.
    sides : tuple of str
        Names of the sides on which they are held.
    """

    nodes: Index
    axes: Array
    held: tuple[bool, bool, bool]
    sides: tuple[str, ...]

    @property
    def is_local(self) -> bool:
        """True if the axes are other than the global ones."""
        return not np.array_equal(self.axes, np.eye(3))


def checked(model: Model) -> TieState:
    """Prepare a model as a run would, so that what strikewave would not run is no deck; return its tied nodes."""
    check_controls(model)
    for name, solid in model.solids.items():
        check_solid(solid, name)
    check_ids(max(len(model.mesh.points), len(model.mesh.hexahedra)) + len(model.rigid))
    return Engine(model).ties


def check_ids(largest: int) -> None:
    """Refuse more nodes or elements than eight columns can number."""
    if largest > LARGEST_ID:
        raise InputError("mesh", f"{largest} nodes or elements", f"at most {LARGEST_ID}, eight columns of a deck")


def check_solid(solid: AnySolid, name: str) -> None:
    """Refuse a solid that decks do not hold."""
    hint = "run it here: strikewave fem"
    if isinstance(solid, ZerilliArmstrong):
        raise InputError(f"mesh.part.{name}.solid.law", "zerilli-armstrong", "elastic, bilinear or johnson-cook", hint)
    if isinstance(solid, HeatedSolid) and solid.preheat > 0.0:
        raise InputError(f"mesh.part.{name}.solid.preheat", solid.preheat, "0 in a deck", hint)


def has_one_point(model: Model) -> bool:
    """Tell whether a part that deforms has elements with one integration point."""
    rigid = {body.part for body in model.rigid}
    return any(name not in model.controls.full and name not in rigid for name in model.mesh.names)


def or_smallest(value: float) -> float:
    """Return a number that no code takes for its own default."""
    return value or SMALLEST


def left_out_of_all(model: Model, sums: str) -> Iterator[str]:
    """Yield what decks of no code have; ``sums`` is where the code tells of each part alone."""
    if model.controls.blows > 1:
        yield f"blows 2 to {model.controls.blows}: the deck is that of the first one"
    for name, parts in model.groups.items():
        yield f"group {name}: add up {', '.join(parts)} in {sums}"


def head_lines(code: str, differs: Sequence[str], left_out: Sequence[str]) -> list[str]:
    """Return the lines about the other code in the head of a deck.

    Examples
    --------
    >>> head_lines("LS-DYNA", ["friction"], [])
    ['what LS-DYNA does in its own way: friction', 'left out: nothing']
    """
    ways = [f"what {code} does in its own way: {line}" for line in differs]
    return [*ways, *(f"left out: {line}" for line in left_out or ("nothing",))]


def walls_at_rigid_nodes(model: Model) -> list[RigidWall]:
    """Return the walls whose side has nodes of a rigid part, such as those that a deforming part shares with one."""
    rigid = [model.mesh.nodes_of(body.part) for body in model.rigid]
    return [wall for wall in model.walls if any(np.isin(model.mesh.side(wall.side), nodes).any() for nodes in rigid)]


def tie_distance(tie: Tie, mesh: Mesh) -> float:
    """Return the distance within which all nodes of a tie lie on the other side, m, with a margin of 1 %."""
    faces = mesh.side(tie.onto)
    return TIE_MARGIN * NEAR * float(extents(mesh.points, faces).size.max())


def restraints(model: Model, ties: TieState) -> list[Restraint]:
    """Return all held nodes, each once, by what they are held along."""
    holding = [b for b in model.boundaries if isinstance(b, Fixed | Symmetry | Guided)]
    restrained = held_nodes(model.mesh, holding, ties)
    if restrained is None:
        return []
    planes = np.einsum("nki,nkj->nij", restrained.directions, restrained.directions)
    # projections tell sets of held directions apart whatever vectors span them; + 0.0 makes -0 and 0 one
    kinds, which = np.unique(planes.round(9).reshape(-1, 9) + 0.0, axis=0, return_inverse=True)
    named = {side: nodes_named(model.mesh, side) for side in dict.fromkeys(b.side for b in holding)}
    groups = []
    for k in range(len(kinds)):
        rows = np.flatnonzero(which.ravel() == k)
        nodes = restrained.nodes[rows]
        sides = tuple(side for side, members in named.items() if np.isin(nodes, members).any())
        groups.append(Restraint(nodes, *_axes(planes[rows[0]]), sides))
    return groups


def _axes(plane: Array) -> tuple[Array, tuple[bool, bool, bool]]:
    """Return axes by rows, and along which of them a projection onto the held directions holds."""
    diagonal = plane.diagonal()
    if np.abs(plane - np.diag(diagonal.round())).max() < ALIGNED:
        x, y, z = (bool(share > 0.5) for share in diagonal)
        return np.eye(3), (x, y, z)
    shares, rows = np.linalg.eigh(plane)
    axes = rows.T * np.array([[1.0], [1.0], [np.sign(np.linalg.det(rows))]])
    x, y, z = (bool(share > 0.5) for share in shares)
    return np.asarray(axes), (x, y, z)


def lasting(curve: TimeCurve, until: float) -> TimeCurve:
    """Return a curve with points at 0 and beyond the end of a run, as codes take a curve for 0 outside of its points.

    Examples
    --------
    >>> lasting(TimeCurve((1.0, 2.0), (3.0, 4.0)), 5.0)
    TimeCurve(time=(0.0, 1.0, 2.0, 10.0), value=(3.0, 3.0, 4.0, 4.0))
    """
    time, value = list(curve.time), list(curve.value)
    if time[0] > 0.0:
        time, value = [0.0, *time], [value[0], *value]
    last = max(2.0 * until, 2.0 * time[-1])  # well past the end, where codes take their last step
    return TimeCurve((*time, last), (*value, value[-1]))


@dataclass
class DeckSets(ABC):
    """Sets, curves and axes of a deck, numbered within their kind; the faces of a side are written once.

    Attributes
    ----------
    lines : list of str
        Lines of all that is written so far.
    """

    row: ClassVar[int]
    """Numbers of nodes on a line."""

    model: Model
    system: UnitSystem
    ties: TieState
    lines: list[str] = field(default_factory=list)
    _counts: Counter[str] = field(default_factory=Counter)
    _sides: dict[str, int] = field(default_factory=dict)

    @abstractmethod
    def written(self, kind: str, number: int, title: str, rows: Sequence[Sequence[int | float]]) -> list[str]:
        """Return the lines of faces, nodes, a curve, axes or a vector."""

    def next(self, kind: str) -> int:
        """Return the next number of a kind."""
        self._counts[kind] += 1
        return self._counts[kind]

    def add(self, kind: str, title: str, rows: Sequence[Sequence[int | float]]) -> int:
        """Write what is one of a kind, and return its number."""
        number = self.next(kind)
        self.lines += self.written(kind, number, title, rows)
        return number

    def faces(self, side: str) -> int:
        """Return the number of the set of a side's faces, normals outward."""
        if side not in self._sides:
            self._sides[side] = self.add("faces", side, (self.model.mesh.side(side).astype(np.int64) + 1).tolist())
        return self._sides[side]

    def nodes(self, title: str, nodes: Index) -> int:
        """Write a set of nodes, and return its number."""
        numbers = (nodes.astype(np.int64) + 1).tolist()
        return self.add("nodes", title, [numbers[k : k + self.row] for k in range(0, len(numbers), self.row)])

    def side_nodes(self, title: str, side: str) -> int:
        """Write the nodes of a side that do not follow another side, and return the number of their set."""
        return self.nodes(title, np.setdiff1d(nodes_named(self.model.mesh, side), self.ties.nodes))

    def curve(self, title: str, curve: TimeCurve, scale: float) -> int:
        """Write a curve over time that lasts beyond the run, its values times a factor, and return its number."""
        long = lasting(curve, self.model.controls.duration)
        points = zip(long.time, long.value, strict=True)
        return self.add("curve", title, [[t * self.system.duration, v * scale] for t, v in points])

    def axes(self, axes: Array) -> int:
        """Write a local system, its axes by rows, and return its number."""
        return self.add("axes", "", axes.tolist())


def axis_of(direction: Sequence[float]) -> tuple[int, float] | None:
    """Return the axis (0, 1, 2) that a direction runs along, and its sense; nothing for a tilted one.

    Examples
    --------
    >>> axis_of((0.0, 0.0, -2.0)), axis_of((1.0, 1.0, 0.0))
    ((2, -1.0), None)
    """
    way = np.asarray(direction, float) / np.linalg.norm(direction)
    k = int(np.abs(way).argmax())
    return (k, float(np.sign(way[k]))) if abs(abs(way[k]) - 1.0) < ALIGNED else None


def axes_from(direction: Sequence[float]) -> Array:
    """Return right-handed axes by rows, of which the first runs along a direction."""
    first = np.asarray(direction, float) / np.linalg.norm(direction)
    second = np.cross(np.eye(3)[int(np.abs(first).argmin())], first)
    second /= np.linalg.norm(second)
    return np.stack([first, second, np.cross(first, second)])


def real(value: float, width: int) -> str:
    """Write a number with as many digits as go into some columns.

    Examples
    --------
    >>> real(7.82e-9, 10), real(-0.123456789012, 10), real(211e9, 20), real(0.0, 10)
    ('7.82e-9', '-.12345679', '211000000000.0', '0.0')
    """
    for digits in range(MOST_DIGITS if math.isfinite(value) else 0, 0, -1):
        text = f"{value:.{digits}g}"
        if "e" in text:
            mantissa, power = text.split("e")
            text = f"{mantissa}e{int(power)}"
        elif "." not in text:
            text += ".0"
        short = text.replace("0.", ".", 1) if text.startswith(("0.", "-0.")) and len(text) > width else text
        if len(short) <= width:
            return short
    raise InputError("number", value, f"a finite one that goes into {width} columns")


def plain(text: str, width: int) -> str:
    r"""Return a title in printable ASCII that no code takes for a keyword.

    Examples
    --------
    >>> plain("*a ball\nat 1 \u00b5s", 72)
    'a ball at 1 ?s'
    """
    ascii_only = text.encode("ascii", "replace").decode("ascii")
    words = " ".join("".join(c if c.isprintable() else " " for c in ascii_only).split())
    return words.lstrip("*$/#&@ ")[:width].rstrip()


def rows(pattern: str, columns: Sequence[NDArray[np.generic]]) -> Iterator[str]:
    r"""Yield lines of a table in pieces of `ROWS`; ``pattern`` formats a row, ended by a new line.

    Examples
    --------
    >>> "".join(rows("%3d%6.2f\n", [np.array([1, 2]), np.array([0.5, 1.5])]))
    '  1  0.50\n  2  1.50\n'
    """
    for start in range(0, len(columns[0]), ROWS):
        pieces = [column[start : start + ROWS].tolist() for column in columns]
        yield pattern * len(pieces[0]) % tuple(value for row in zip(*pieces, strict=True) for value in row)


def mesh_columns(mesh: Mesh, scale: float) -> tuple[list[NDArray[np.generic]], list[NDArray[np.generic]]]:
    """Return columns of nodes (number, x, y, z) and of elements (number, part, eight nodes), counted from 1."""
    points = scale * mesh.points
    nodes: list[NDArray[np.generic]] = [np.arange(1, len(points) + 1), *points.T]
    hexahedra = mesh.hexahedra.astype(np.int64) + 1
    elements: list[NDArray[np.generic]] = [np.arange(1, len(hexahedra) + 1), mesh.part.astype(np.int64) + 1]
    return nodes, [*elements, *hexahedra.T]
