"""Fields that can be shown, and their scale of colours."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from numpy.typing import NDArray

from strikewave.analyses.fem.figures.pictures.camera import Camera
from strikewave.base.errors import InputError, nearest
from strikewave.fem.invariants import pressure, von_mises
from strikewave.fem.mesh import Mesh
from strikewave.fem.run import FieldFrame
from strikewave.reporting.numbers import ShownQuantity

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PicturedField(ShownQuantity):
    """A field that can be shown: its words, how it comes from a frame by element."""

    words: str
    of: Callable[[FieldFrame, Mesh], Array]


QUANTITIES: Mapping[str, PicturedField] = {
    "von_mises": PicturedField("Pa", "MPa", "von Mises stress", lambda frame, mesh: von_mises(frame.stress)),
    "pressure": PicturedField("Pa", "MPa", "pressure", lambda frame, mesh: pressure(frame.stress)),
    "plastic_strain": PicturedField("1", "%", "equivalent plastic strain", lambda frame, mesh: frame.plastic_strain),
    "speed": PicturedField(
        "m/s",
        "m/s",
        "speed",
        lambda frame, mesh: np.linalg.norm(frame.velocity, axis=1)[mesh.hexahedra].mean(axis=1),
    ),
}


def quantity_of(name: str) -> PicturedField:
    """Return a field that can be shown, by its name.

    Raises
    ------
    InputError
        If there is none of this name.
    """
    if name not in QUANTITIES:
        raise InputError("quantity", name, "a field that can be shown", nearest(name, QUANTITIES))
    return QUANTITIES[name]


def colour_scale(values: Sequence[Array], view: Camera, shown: PicturedField) -> Any:
    """Return the scale of colours, the same for all frames."""
    if view.limits is not None:
        low, high = (limit / shown.scale for limit in view.limits)
    else:
        low = min(0.0, *(float(cells.min()) for cells in values))
        high = max(float(cells.max()) for cells in values)
    return ScalarMappable(Normalize(low, high if high > low else low + 1.0), "viridis")


def beyond_scale(values: Sequence[Array], scale: Any) -> str:
    """Say to which side values lie beyond the scale of colours, as matplotlib calls it."""
    below = any(float(cells.min()) < scale.norm.vmin for cells in values)
    above = any(float(cells.max()) > scale.norm.vmax for cells in values)
    return "both" if below and above else "min" if below else "max" if above else "neither"
