"""Blocks of OpenRadioss in their columns, and the numbers of groups, surfaces, functions and skews."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from strikewave.exchange.deck import lasting, plain, real
from strikewave.fem.mesh import Array, Index, Mesh
from strikewave.fem.model import TimeCurve

Value = int | float | str | None


def block(name: str, title: str | None, *cards: Sequence[Value]) -> list[str]:
    """Return the lines of a block; whole numbers and words have ten columns, real ones twenty, None ten blank ones.

    Examples
    --------
    >>> block("MAT/ELAST/1", "steel", [7.82e-9], [211000.0, 0.288])
    ['/MAT/ELAST/1', 'steel', '             7.82e-9', '            211000.0               0.288']
    """
    lines = ["".join(_field(value) for value in card) for card in cards]
    return [f"/{name}", *([] if title is None else [plain(title, 100)]), *lines]


def _field(value: Value) -> str:
    if isinstance(value, float):
        return real(value, 20).rjust(20)
    return ("" if value is None else str(value)).rjust(10)


@dataclass
class Groups:
    """Groups of nodes, surfaces, functions and skews of a deck.

    Attributes
    ----------
    mesh : Mesh
    lines : list of str
        Those written so far.
    """

    mesh: Mesh
    lines: list[str] = field(default_factory=list)
    _surfaces: dict[str, int] = field(default_factory=dict)
    _counts: dict[str, int] = field(default_factory=dict)

    def next(self, kind: str) -> int:
        """Return the next number of a kind."""
        self._counts[kind] = self._counts.get(kind, 0) + 1
        return self._counts[kind]

    def surface(self, side: str) -> int:
        """Return the number of the surface of a side's faces, normals outward."""
        if side not in self._surfaces:
            number = self._surfaces[side] = self.next("surface")
            faces = (self.mesh.side(side).astype(np.int64) + 1).tolist()
            rows = ([count, *face] for count, face in enumerate(faces, start=1))
            self.lines += block(f"SURF/SEG/{number}", side, *rows)
        return self._surfaces[side]

    def nodes(self, title: str, nodes: Index) -> int:
        """Write a group of nodes of the mesh and return its number."""
        number = self.next("nodes")
        numbers = (nodes.astype(np.int64) + 1).tolist()
        self.lines += block(f"GRNOD/NODE/{number}", title, *(numbers[k : k + 10] for k in range(0, len(numbers), 10)))
        return number

    def function(self, title: str, curve: TimeCurve, scale: tuple[float, float], until: float) -> int:
        """Write a function of time, with factors of time and value, and return its number; ``until`` is in s."""
        number, long = self.next("function"), lasting(curve, until)
        rows = ([t * scale[0], v * scale[1]] for t, v in zip(long.time, long.value, strict=True))
        self.lines += block(f"FUNCT/{number}", title, *rows)
        return number

    def skew(self, axes: Array) -> int:
        """Write a fixed skew, its axes by rows, and return its number; its second and third axis are given."""
        number = self.next("skew")
        second, third = axes[1].tolist(), axes[2].tolist()
        self.lines += block(f"SKEW/FIX/{number}", f"axes {number}", [0.0, 0.0, 0.0], second, third)
        return number
