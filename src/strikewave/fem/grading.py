"""Places of nodes along a line: fine where it matters, growing geometrically to coarse elsewhere.

The size of an element is h(x) = min(coarse, first + k d(x)), d the distance from the nearest fine zone, k = ln(growth):
sizes that grow linearly with distance are sizes in geometric progression. The number of elements is the integral of
dx / h, rounded up; the nodes stand at equal shares of it. Neighbours therefore never differ by more than ``growth``,
and no element is larger than h asks for.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from strikewave.base.errors import InputError
from strikewave.fem.mesh import Array

LARGEST_COUNT = 20_000
"""Elements along one line: a mesh of 3 million elements with so long a line has 12 by 12 across."""
GROWTH = 1.2
"""Ratio of neighbours where none is stated, as is usual: jumps in size send short waves back."""
LARGEST_GROWTH = 2.0
"""Ratio of neighbours at most. Chosen: the next octave of sizes, far beyond usual meshes."""
ROUNDING = 1e-9
"""What a count of elements may exceed a whole number by, and a slope below which sizes are the same: above rounding."""


@dataclass(frozen=True)
class Grading:
    """Sizes of the elements along a line.

    Parameters
    ----------
    coarse : float
        Largest size, m.
    fine : float, optional
        Size in and next to the fine zones, m; ``coarse`` everywhere when left out.
    at : tuple of float
        Where the fine zones lie, m from the line's beginning.
    extent : float
        Half the length of a fine zone, m.
    growth : float
        Largest ratio of neighbours, above 1 to 2.

    Raises
    ------
    InputError
        If a size is not above 0, ``fine`` is above ``coarse``, or the growth is out of its range.
    """

    coarse: float
    fine: float | None = None
    at: tuple[float, ...] = (0.0,)
    extent: float = 0.0
    growth: float = GROWTH

    def __post_init__(self) -> None:
        if not 0.0 < self.coarse < math.inf:
            raise InputError("grading.coarse", self.coarse, "a size above 0")
        if self.fine is not None and not 0.0 < self.fine <= self.coarse:
            raise InputError("grading.fine", self.fine, f"above 0, at most the coarse size {self.coarse:g}")
        if not 0.0 <= self.extent < math.inf:
            raise InputError("grading.extent", self.extent, "at least 0")
        if not 1.0 < self.growth <= LARGEST_GROWTH:
            raise InputError("grading.growth", self.growth, f"above 1, at most {LARGEST_GROWTH:g}")
        if not self.at or not all(math.isfinite(place) for place in self.at):
            raise InputError("grading.at", self.at, "one finite position or more")

    @property
    def finest(self) -> float:
        """Size in the fine zones, m."""
        return self.coarse if self.fine is None else self.fine

    @property
    def slope(self) -> float:
        """Growth of the size with distance, k = ln(growth)."""
        return math.log(self.growth)

    def size(self, x: Array) -> Array:
        """Return h at places x, m.

        The size of a zone without extent begins at fine k / (growth - 1), which makes its first element ``fine``.
        """
        places = np.asarray(x, float)
        away = np.min([np.abs(places - place) for place in self.at], axis=0) - self.extent
        first = self.finest if self.extent > 0.0 else self.finest * self.slope / (self.growth - 1.0)
        sizes = np.minimum(self.coarse, first + self.slope * np.maximum(away, 0.0))
        return np.full(places.shape, self.coarse) if self.fine is None else sizes

    def _kinks(self, start: float, end: float) -> Array:
        """Return the places between which h is linear, with both ends."""
        if self.fine is None:
            return np.array([start, end])
        first = float(self.size(np.array([self.at[0]]))[0])
        reach = self.extent + max(self.coarse - first, 0.0) / self.slope
        zones = sorted(self.at)
        kinks = [zone + side * d for zone in zones for side in (-1.0, 1.0) for d in (0.0, self.extent, reach)]
        kinks += [0.5 * (a + b) for a, b in pairwise(zones)]
        return np.unique([start, end, *(kink for kink in kinks if start < kink < end)])


Sizes = float | Grading
"""Sizes along a line: one size, or a grading."""


def as_grading(sizes: Sizes) -> Grading:
    """Return a grading of one size or as it is.

    Examples
    --------
    >>> as_grading(1e-3).finest
    0.001
    """
    return sizes if isinstance(sizes, Grading) else Grading(float(sizes))


def nodes_between(start: float, end: float, sizes: Sizes) -> Array:
    """Return the places of nodes from ``start`` to ``end``, both exact, m.

    On a piece where h goes from h0 with the slope b, the count of elements is ln(1 + b s / h0) / b; its inverse places
    the nodes.

    Raises
    ------
    InputError
        If the line has no length or needs more than 20 000 elements.

    Examples
    --------
    >>> nodes_between(0.0, 1.0, 0.3).tolist()
    [0.0, 0.25, 0.5, 0.75, 1.0]
    >>> nodes_between(0.0, 7.0, Grading(8.0, fine=1.0, growth=2.0)).round(9).tolist()
    [0.0, 1.0, 3.0, 7.0]
    """
    if not start < end:
        raise InputError("length", end - start, "above 0")
    grading = as_grading(sizes)
    kinks = grading._kinks(start, end)
    size = grading.size(kinks)
    length = np.diff(kinks)
    slope = np.diff(size) / length
    counts = np.array([_count(s, h, b) for s, h, b in zip(length, size, slope, strict=False)])
    reached = np.concatenate([[0.0], np.cumsum(counts)])
    total = max(1, math.ceil(reached[-1] - ROUNDING)) if reached[-1] < LARGEST_COUNT else 0
    if total == 0:
        raise InputError("size", grading.finest, f"at most {LARGEST_COUNT} elements along {end - start:g} m")
    wanted = np.linspace(0.0, reached[-1], total + 1)
    piece = np.clip(np.searchsorted(reached, wanted, side="right") - 1, 0, len(length) - 1)
    left = wanted - reached[piece]
    places = kinks[piece] + [_length(n, h, b) for n, h, b in zip(left, size[piece], slope[piece], strict=True)]
    places[0], places[-1] = start, end
    return places


def nodes_through(breaks: Sequence[float], sizes: Sizes) -> Array:
    """Return nodes along a line that has a node at each of several ascending places, m.

    Next to a break the ratio of neighbours may exceed the growth by how the rounding of the two counts differs.

    Examples
    --------
    >>> nodes_through([0.0, 0.5, 2.0], 0.5).tolist()
    [0.0, 0.5, 1.0, 1.5, 2.0]
    """
    pieces = [nodes_between(a, b, sizes) for a, b in pairwise(breaks)]
    return np.concatenate([pieces[0][:1], *(piece[1:] for piece in pieces)])


def _count(length: float, size: float, slope: float) -> float:
    """Return the number of elements on a piece: the integral of ds / (size + slope s)."""
    ratio = slope * length / size
    return length / size if abs(ratio) < ROUNDING else math.log1p(ratio) / slope


def _length(count: float, size: float, slope: float) -> float:
    """Return the length that a count of elements takes, the inverse of `_count`."""
    return count * size if abs(slope * count) < ROUNDING else size * math.expm1(slope * count) / slope
