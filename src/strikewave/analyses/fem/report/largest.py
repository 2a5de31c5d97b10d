"""Where the stress and the plastic strain of an explicit run are largest, in words; needs no matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from strikewave.base.shock_quantities import MICROSECONDS, STRESS
from strikewave.reporting.faces import amount
from strikewave.reporting.numbers import listed
from strikewave.reporting.parts import written

if TYPE_CHECKING:
    from strikewave.fem.mesh import Mesh
    from strikewave.fem.snapshots import SnapshotRecorder


def largest_words(film: SnapshotRecorder, mesh: Mesh) -> str:
    """Say where von Mises stress and plastic strain are largest of all elements, seen or not; nothing where none is."""
    names, places = {"von_mises": "von Mises stress", "plastic_strain": "plastic strain"}, []
    for name, spot in film.largest.items():
        value = amount(STRESS, spot.value) if name == "von_mises" else written(spot.value)
        places.append(f"{names[name]} {value} in {place_words(mesh, spot.element)} at {instant_words(spot.time)}")
    if not places:
        return ""
    where = "centre of the element before the blow"
    return f"Largest values of all elements at the stored instants: {listed(places)} ({where})."


def place_words(mesh: Mesh, element: int) -> str:
    """Name the part of an element and its middle before the blow."""
    middle = mesh.points[mesh.hexahedra[element]].mean(axis=0) * 1e3
    place = ", ".join(f"{x:.4g}" for x in np.where(np.abs(middle) < 1e-9, 0.0, middle))
    return f"{mesh.names[int(mesh.part[element])]} at ({place}) mm"


def instant_words(time: float) -> str:
    """Write a time with its unit; the time 0 as the start."""
    return amount(MICROSECONDS, time) if time > 0.0 else "the start"
