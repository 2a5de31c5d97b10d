"""Parts that may touch but stand inside each other before the blow are found here, however deep they are."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError
from strikewave.fem.mesh import FACES, Mesh

Array = NDArray[np.float64]

NEAREST = 8
"""Elements looked at for each place, those whose centres are nearest: a corner has so many around it."""
INSIDE = 0.25
"""A place is inside an element where it is deeper behind each of its faces than this share of its smallest depth.

Surfaces may overlap by a tenth of a face (`strikewave.fem.contact.SHALLOW`); what is deeper is a part out of place."""


def check_apart(mesh: Mesh, pairs: Iterable[tuple[str, str, str]]) -> None:
    """Refuse parts that stand in each other; surfaces that overlap a little are the contact's affair.

    Parameters
    ----------
    mesh : Mesh
        Before the blow.
    pairs : iterable of (str, str, str)
        Path of the field, and the names of two parts.

    Raises
    ------
    InputError
        If a place within an element of one lies inside an element of the other.
    """
    for path, first, second in pairs:
        for this, that in ((first, second), (second, first)):
            place = _inside(mesh, this, that)
            if place is not None:
                where = ", ".join(f"{x * 1e3:.4g}" for x in place)
                got = f"{this} inside {that} around ({where}) mm"
                raise InputError(path, got, "parts that stand beside each other", "move one of them: mesh.part.*.at")


def _inside(mesh: Mesh, this: str, that: str) -> Array | None:
    """Return a place within an element of one part that lies inside an element of another; None where there is none.

    Places are half-way between the corners of an element and its centre.
    """
    from scipy.spatial import cKDTree

    boxes = mesh.points[mesh.nodes_of(that)]
    own = mesh.points[mesh.hexahedra[mesh.elements_of(this)]]
    low, high = boxes.min(axis=0), boxes.max(axis=0)
    own = own[np.all((own.max(axis=1) > low) & (own.min(axis=1) < high), axis=1)]
    if not len(own):
        return None
    places = (0.5 * (own + own.mean(axis=1, keepdims=True))).reshape(-1, 3)
    corners = mesh.points[mesh.hexahedra[mesh.elements_of(that)]]
    _, near = cKDTree(corners.mean(axis=1)).query(places, k=min(NEAREST, len(corners)))
    for column in np.asarray(near).reshape(len(places), -1).T:
        inside = np.flatnonzero(_in_elements(places, corners[column]))
        if inside.size:
            return np.asarray(places[inside[0]])
    return None


def _in_elements(places: Array, corners: Array) -> NDArray[np.bool_]:
    """Tell which places lie inside their element, (n, 3) and (n, 8, 3)."""
    centre, depths, mine = corners.mean(axis=1), [], []
    for face in FACES:
        a, b, c, d = (corners[:, node] for node in face)
        normal = np.cross(c - a, d - b)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        middle = 0.25 * (a + b + c + d)
        depths.append(np.einsum("ij,ij->i", middle - centre, normal))
        mine.append(np.einsum("ij,ij->i", middle - places, normal))
    return np.asarray(np.min(mine, axis=0) > INSIDE * np.min(depths, axis=0))
