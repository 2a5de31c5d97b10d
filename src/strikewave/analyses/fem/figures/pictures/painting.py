"""Faces painted from the farthest to the nearest, those that are large divided first."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection
from numpy.typing import NDArray

Array = NDArray[np.float64]

PIECES_ACROSS = 90
"""A face larger than this share of the picture's width is divided before it is painted (chosen: painting by distance
then errs by about 1 % of the width)."""
MOST_PARTS = 200
"""A side of a face is divided at most into this many pieces: twice what a face as wide as the picture needs."""
NEARER = 0.75
"""How much nearer to the eye lines are painted than the pieces they border, in sizes of a piece: the middle of a
neighbouring piece lies half a size away, so that its line stays on top, while bodies in front still hide it."""


def paint_faces(
    axes: Any, corners: Array, colours: Array, across: float, smallest_lined: float, lines: Array | None = None
) -> None:
    """Paint the faces that look toward the eye, from the farthest to the nearest, those that look aside darker.

    Parameters
    ----------
    axes : matplotlib axes
    corners : array (faces, 4, 3)
        To the right, up and toward the eye, m.
    colours : array (faces, 3)
    across : float
        Width of the picture, m.
    smallest_lined : float
        Share of it from which on a face has mesh lines.
    lines : array (lines, 2, 3), optional
        Ends of dark lines on the faces, such as outlines.
    """
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    size = np.linalg.norm(normal, axis=1)
    facing = normal[:, 2] > 1e-9 * np.maximum(size, 1e-300)
    corners, size, normal = corners[facing], size[facing], normal[facing]
    colour = colours[facing] * (0.78 + 0.22 * normal[:, 2] / size)[:, None]
    lined = np.sqrt(0.5 * normal[:, 2]) > smallest_lined * across
    pieces, of, meshed = _divided(corners, across / PIECES_ACROSS, lined)
    fill = colour[of]
    edge, width = np.where(meshed[:, None], 0.45 * fill, fill), np.where(meshed, 0.35, 0.5)
    if lines is not None and len(lines):
        strokes = _outlines(lines, across / PIECES_ACROSS)
        dark = np.full((len(strokes), 3), 0.13)
        pieces, fill, edge = (np.concatenate(p) for p in ((pieces, strokes), (fill, dark), (edge, dark)))
        width = np.concatenate([width, np.full(len(strokes), 0.7)])
    order = np.argsort(pieces[:, :, 2].mean(axis=1), kind="stable")
    flat: Any = pieces[order][:, :, :2] * 1e3
    collection = PolyCollection(
        flat,
        facecolors=fill[order],
        edgecolors=edge[order],
        linewidths=width[order],
        rasterized=True,
    )
    collection.set_joinstyle("round")
    collection.set_snap(False)
    axes.add_collection(collection, autolim=False)


def _outlines(lines: Array, largest: float) -> Array:
    """Return lines (lines, 2, 3) as flat pieces (pieces, 4, 3) of about a size, a hair nearer to the eye."""
    count = np.clip(np.ceil(np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1) / largest), 1, MOST_PARTS).astype(int)
    of = np.repeat(np.arange(len(lines)), count)
    begin = (np.arange(len(of)) - np.repeat(np.cumsum(count) - count, count)) / count[of]
    way = lines[of, 1] - lines[of, 0]
    start = lines[of, 0] + begin[:, None] * way
    end = start + way / count[of, None]
    pieces = np.stack([start, end, end, start], axis=1)
    pieces[..., 2] += NEARER * largest
    return pieces


def _divided(
    corners: Array, largest: float, lined: NDArray[np.bool_]
) -> tuple[Array, NDArray[np.intp], NDArray[np.bool_]]:
    """Divide faces (faces, 4, 3) whose sides are longer than ``largest`` into pieces of about that size.

    Returns the pieces (pieces, 4, 3), the face of each, and which of them are mesh lines: flat pieces along a side.
    A face that is not divided is its own line, where it is ``lined``.
    """
    sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    longest = np.maximum(sides[:, :2], sides[:, 2:])
    counts = np.clip(np.ceil(longest / largest), 1, MOST_PARTS).astype(int)
    pieces, of, lines = [], [], []
    for n, m in np.unique(counts, axis=0):
        group = np.flatnonzero((counts == (n, m)).all(axis=1))
        cells, bordered = _cells(corners[group], int(n), int(m)), lined[group]
        pieces.append(cells.reshape(-1, 4, 3))
        of.append(np.repeat(group, n * m))
        lines.append(np.repeat(bordered & (n * m == 1), n * m))
        if n * m > 1:
            pieces.append(_strokes(cells[bordered]).reshape(-1, 4, 3))
            of.append(np.repeat(group[bordered], 2 * (n + m)))
            lines.append(np.ones(len(pieces[-1]), bool))
    return np.concatenate(pieces), np.concatenate(of), np.concatenate(lines)


def _cells(corners: Array, n: int, m: int) -> Array:
    """Divide faces bilinearly into n x m pieces, (faces, n, m, 4, 3)."""
    u, v = np.linspace(0.0, 1.0, n + 1)[:, None, None], np.linspace(0.0, 1.0, m + 1)[None, :, None]
    a, b, c, d = (corners[:, None, None, k] for k in range(4))
    grid = (1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d
    return np.stack([grid[:, :-1, :-1], grid[:, 1:, :-1], grid[:, 1:, 1:], grid[:, :-1, 1:]], axis=3)


def _strokes(cells: Array) -> Array:
    """Return the outer sides of divided faces (faces, n, m, 4, 3) as flat pieces (faces, 2 (n + m), 4, 3).

    They lie a hair nearer to the eye than the pieces they border.
    """
    lower, upper = cells[:, :, 0][:, :, [0, 1, 1, 0]], cells[:, :, -1][:, :, [3, 2, 2, 3]]
    left, right = cells[:, 0][:, :, [0, 3, 3, 0]], cells[:, -1][:, :, [1, 2, 2, 1]]
    strokes = np.concatenate([lower, upper, left, right], axis=1)
    strokes[..., 2] += NEARER * float(np.ptp(cells[:, 0, 0], axis=1).max(initial=0.0))
    return strokes
