"""Curves and drawings of the pages: as few points as a diagram has pixels, no peak lost; SVG that is shown as it is."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from strikewave.reporting.curves import thin

COLUMNS = 300
"""Columns of pixels of a curve on a page."""


def points(x: Any, y: Any, columns: int = COLUMNS) -> list[list[float]]:
    """Return a curve as points, without what is not finite; each column of pixels keeps its least and its greatest.

    Examples
    --------
    >>> points(np.array([0.0, 1.0, 2.0]), np.array([0.0, np.nan, 4.0]))
    [[0.0, 0.0], [2.0, 4.0]]
    """
    x, y = np.asarray(x, float), np.asarray(y, float)
    kept = np.isfinite(y) & np.isfinite(x)
    x, y = thin(x[kept], y[kept], columns)
    return [[float(f"{a:.6g}"), float(f"{b:.6g}")] for a, b in zip(x, y, strict=True)]


def svg_of(figure: Any) -> bytes:
    """Return a figure of matplotlib as SVG."""
    with io.BytesIO() as file:
        figure.savefig(file, format="svg")
        return file.getvalue()
