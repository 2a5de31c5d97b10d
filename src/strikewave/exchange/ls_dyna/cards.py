"""Keywords of LS-DYNA in their columns, and the numbers of sets and curves."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from strikewave.exchange.deck import TimeCurve, lasting, plain, real
from strikewave.fem.mesh import Array, Index, Mesh

Value = int | float | None
ROUGH = 1e-9
"""Largest share of a number that a standard field of ten columns may cut off; a long one has twenty.

Far below what two codes agree to, so that the deck is the model."""
LONGEST_REMARK, REMARK_WIDTH = 2000, 78
"""Characters of a remark, and of one of its lines: LS-DYNA reads 80 columns, two of them ``$`` and a blank."""


def keyword(name: str, *cards: str | Sequence[Value]) -> list[str]:
    """Return the lines of a keyword; a card is a line as it is, or the values of its fields, None for a blank one.

    Fields have ten columns; all of the keyword have twenty, marked by ``+``, where ten would cut numbers off. A keyword
    with a line as it is, such as a title, must have numbers that go into ten.

    Examples
    --------
    >>> keyword("CONTROL_TERMINATION", [8e-5])
    ['*CONTROL_TERMINATION', '    8.0e-5']
    >>> keyword("CONTROL_TERMINATION", [1.23456789012e-5])[0]
    '*CONTROL_TERMINATION+'
    """
    wide = any(_is_rough(value) for card in cards if not isinstance(card, str) for value in card)
    width = 20 if wide else 10
    lines = [card if isinstance(card, str) else "".join(_field(value, width) for value in card) for card in cards]
    return [f"*{name}{'+' if wide else ''}", *lines]


def _is_rough(value: Value) -> bool:
    return isinstance(value, float) and abs(float(_real(value, 10)) - value) > ROUGH * abs(value)


def _field(value: Value, width: int) -> str:
    if value is None:
        return " " * width
    return (_real(value, width) if isinstance(value, float) else str(value)).rjust(width)


def _real(value: float, width: int) -> str:
    """Write a number so that it is one with a point too."""
    text = real(value, width)
    return text.replace("e", ".0e") if "." not in text and len(text) <= width - 2 else text


@dataclass
class Sets:
    """Sets and curves of a deck, each written once.

    Attributes
    ----------
    mesh : Mesh
    lines : list of str
        Those written so far.
    """

    mesh: Mesh
    lines: list[str] = field(default_factory=list)
    _segments: dict[str, int] = field(default_factory=dict)
    _counts: dict[str, int] = field(default_factory=dict)

    def next(self, kind: str) -> int:
        """Return the next number of a kind."""
        self._counts[kind] = self._counts.get(kind, 0) + 1
        return self._counts[kind]

    def segments(self, side: str) -> int:
        """Return the number of the set of a side's faces, normals outward."""
        if side not in self._segments:
            number = self._segments[side] = self.next("segments")
            rows = ("%10d" * 4 % tuple(face) for face in (self.mesh.side(side).astype(np.int64) + 1).tolist())
            self.lines += keyword("SET_SEGMENT_TITLE", plain(side, 80), [number, 0.0, 0.0, 0.0, 0.0], *rows)
        return self._segments[side]

    def nodes(self, title: str, nodes: Index) -> int:
        """Write a set of nodes and return its number."""
        number = self.next("nodes")
        numbers = (nodes.astype(np.int64) + 1).tolist()
        rows = (numbers[k : k + 8] for k in range(0, len(numbers), 8))
        self.lines += keyword("SET_NODE_LIST_TITLE", plain(title, 80), [number, 0.0, 0.0, 0.0, 0.0], *rows)
        return number

    def curve(self, title: str, curve: TimeCurve, scale: tuple[float, float], until: float) -> int:
        """Write a curve over time, with factors of time and value, and return its number; ``until`` is in s."""
        number, long = self.next("curve"), lasting(curve, until)
        points = (
            f"{real(t * scale[0], 20):>20}{real(v * scale[1], 20):>20}"
            for t, v in zip(long.time, long.value, strict=True)
        )
        self.lines += keyword("DEFINE_CURVE_TITLE", plain(title, 80), [number, 0, 1.0, 1.0, 0.0, 0.0], *points)
        return number

    def axes(self, axes: Array) -> int:
        """Write a local system, its axes by rows, and return its number."""
        number = self.next("axes")
        x, y = axes[0].tolist(), axes[1].tolist()
        self.lines += keyword("DEFINE_COORDINATE_VECTOR", [number, *x, *y])
        return number

    def vector(self, direction: Sequence[float]) -> int:
        """Write a vector from the origin, and return its number."""
        number = self.next("vector")
        self.lines += keyword("DEFINE_VECTOR", [number, 0.0, 0.0, 0.0, *(float(x) for x in direction)])
        return number


def remark(lines: Sequence[str]) -> list[str]:
    """Return lines of a comment, none longer than 80 columns."""
    return [f"$ {text}" for line in lines for text in textwrap.wrap(plain(line, LONGEST_REMARK), REMARK_WIDTH)]
