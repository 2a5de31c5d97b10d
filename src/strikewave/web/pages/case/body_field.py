"""A run of elements as a page turns it: the surface of the bodies, cut open, at instants, with fields in colours."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from matplotlib.colors import to_hex

from strikewave.analyses.fem.figures.animation import chosen
from strikewave.analyses.fem.figures.cut import QUANTITIES, colour_scale
from strikewave.analyses.fem.result import FemSolution
from strikewave.reporting.animation.page import even_rows
from strikewave.reporting.numbers import time_unit

LARGEST = 24 << 20
"""Bytes of a field that is sent to a page at most: the instants are fewer where the mesh is finer."""
LEVELS = 255
"""Steps of the scale of colours: a byte a face."""
SHADES = 33
"""Colours that are sent; between them the page fills in."""


def body_field(solution: FemSolution) -> bytes:
    """Return the moving surface as bytes: length of the head, head as JSON, then arrays; nothing where none was kept.

    The head names time, counts, and each field with its scale. The arrays are faces (faces, 4) as 32-bit places of
    points, then for each instant the points (points, 3), mm, in single precision; then for each field and instant a
    byte a face, from the least to the largest of its scale. All are little-endian.
    """
    film = solution.film
    stills = chosen(film) if film is not None else []
    if film is None or not stills:
        return b""
    skin = film.skin
    a_still = 12 * len(skin.points) + len(QUANTITIES) * len(skin.faces)
    stills = [stills[k] for k in even_rows(len(stills), max(2, (LARGEST - 16 * len(skin.faces)) // a_still))]
    second, time_name = time_unit(stills[-1].time)
    arrays: list[bytes] = [np.asarray(skin.faces, "<u4").tobytes()]
    arrays += [np.asarray(1e3 * skin.moved(still.displacement), "<f4").tobytes() for still in stills]
    fields = []
    for shown in QUANTITIES.values():
        values = [shown.of(skin, still)[skin.element] / shown.scale for still in stills]
        scale, _ = colour_scale(skin, values, shown)
        low, high = scale.get_clim()
        levels = [np.clip((cells - low) / (high - low) * LEVELS, 0.0, LEVELS).round() for cells in values]
        arrays += [np.asarray(level, np.uint8).tobytes() for level in levels]
        colours = [to_hex(scale.cmap(share)) for share in np.linspace(0.0, 1.0, SHADES)]
        fields.append({"name": shown.words, "unit": shown.unit, "low": low, "high": high, "colours": colours})
    head: dict[str, Any] = {
        "points": len(skin.points),
        "faces": len(skin.faces),
        "time": [round(still.time / second, 6) for still in stills],
        "time_unit": time_name,
        "axis": [float(x) for x in skin.axis],
        "towards": [float(x) for x in skin.cut.plane.normal],
        "fields": fields,
    }
    text = json.dumps(head, allow_nan=False).encode()
    text += b" " * (-len(text) % 4)  # arrays of words begin at a multiple of four
    return len(text).to_bytes(4, "little") + text + b"".join(arrays)
