"""How the parts of a run are looked at, and which of their elements are seen."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError
from strikewave.fem.mesh import Mesh
from strikewave.fem.model import Model, SurfaceContact, Symmetry
from strikewave.fem.skin import blow_axis, blow_contact, meeting_place, outward

Array = NDArray[np.float64]

Vector = tuple[float, float, float]

ZONE_FACES = 16.0
"""Radius of the zone of a contact over the size of its faces, at most (chosen: about 32 elements across, each large
enough to have mesh lines)."""
ROUNDING = 1e-9
"""Share by which the radius of a zone exceeds the distance of a middle that shall be in it: far beyond the rounding of
coordinates, 1e-16, and no change of the picture."""


@dataclass(frozen=True)
class Camera:
    """How parts are looked at.

    Attributes
    ----------
    toward : vector
        From the parts to the eye.
    up : vector
        What is up in the picture.
    cut : (point, normal), optional
        Elements whose middle lies beyond this plane, on the side that the normal points to, are left out.
    warp : float
        By what displacements are multiplied.
    parts : tuple of str
        Parts to be drawn; all where empty.
    near : (point, radius), optional
        Elements whose middle lies farther from the point are left out: the zone of a contact.
    limits : (float, float), optional
        Ends of the scale of colours, SI; from the least value, or 0, to the largest if absent.
    """

    toward: Vector = (-0.5, -1.0, 0.6)
    up: Vector = (0.0, 0.0, 1.0)
    cut: tuple[Vector, Vector] | None = None
    warp: float = 1.0
    parts: tuple[str, ...] = ()
    near: tuple[Vector, float] | None = None
    limits: tuple[float, float] | None = None

    def axes(self) -> Array:
        """Return what is right, up and toward the eye in the picture, unit vectors, (3, 3).

        Raises
        ------
        InputError
            If the eye looks along ``up`` or a direction has no length.
        """
        toward, up = np.asarray(self.toward, float), np.asarray(self.up, float)
        right = np.cross(up, toward)
        if not float(np.linalg.norm(right)) > 1e-9 * float(np.linalg.norm(toward) * np.linalg.norm(up)):
            raise InputError("view.toward", self.toward, f"a direction other than up, {self.up}")
        frame = np.array([right, np.cross(toward, right), toward])
        return np.asarray(frame / np.linalg.norm(frame, axis=1, keepdims=True))


def view_of(model: Model) -> Camera:
    """Return the view that shows most of a model: onto its planes of symmetry, or else cut along its blow.

    The blow goes along the greatest initial momentum, or what is driven; without either along z.
    """
    mesh = model.mesh
    flat: list[Array] = []
    for normal in (outward(mesh, b.side) for b in model.boundaries if isinstance(b, Symmetry)):
        flat += [normal] if all(abs(normal @ other) < 0.9 for other in flat) else []
    axis = blow_axis(model)
    up = next(e for e in np.eye(3)[[2, 1, 0]] if all(abs(n @ e) < 0.5 for n in flat) or e[0] == 1.0)
    if flat:
        toward = flat[0] + 0.5 * sum(flat[1:], np.zeros(3)) + 0.4 * up
        if len(flat) == 1:
            toward = toward + 0.35 * np.cross(up, flat[0])
        return Camera(toward=_vector(toward), up=_vector(up))
    normal = next(n for n in (np.array([0.0, -1.0, 0.0]), np.array([-1.0, 0.0, 0.0])) if abs(n @ axis) < 0.9)
    middle = 0.5 * (mesh.points.min(axis=0) + mesh.points.max(axis=0))
    toward = normal + 0.35 * np.cross(normal, up) + 0.45 * up
    whole = Camera(toward=_vector(toward), up=_vector(up))
    cut = dataclasses.replace(whole, cut=(_vector(middle), _vector(normal)))
    return cut if _visible(mesh, cut).any() else whole


def contact_zone(model: Model, view: Camera | None = None) -> tuple[Vector, float] | None:
    """Return the middle and a radius of where the bodies of the blow are nearest before it; None without a contact.

    The radius is half the extent of the smaller side, or `ZONE_FACES` times the size of the faces there, and reaches
    at least one element of each body of those that the view shows: a coarse mesh has no middle that near.
    """
    contact, place = blow_contact(model), meeting_place(model)
    if place is None or not isinstance(contact, SurfaceContact):
        return None
    mesh = model.mesh
    one, other = (mesh.points[np.unique(mesh.side(side))] for side in (contact.first, contact.second))
    reach = min(float(np.ptp(points, axis=0).max()) for points in (one, other))
    corners = mesh.points[mesh.side(contact.first)]
    close = np.argsort(np.linalg.norm(corners.mean(axis=1) - place, axis=1))[:4]
    size = float(np.linalg.norm(np.roll(corners[close], -1, axis=1) - corners[close], axis=2).mean())
    radius = min(0.5 * reach, ZONE_FACES * size)
    away = np.linalg.norm(_middles(mesh) - place, axis=1)
    shown = kept_elements(mesh, view or Camera())
    for side in (contact.first, contact.second):
        on_side = shown & np.isin(mesh.hexahedra, mesh.side(side)).any(axis=1)
        radius = max(radius, (1.0 + ROUNDING) * float(away[on_side if on_side.any() else shown].min()))
    return _vector(place), radius


def _vector(values: Array) -> Vector:
    x, y, z = (float(v) for v in values)
    return x, y, z


def _middles(mesh: Mesh) -> Array:
    """Return the middle of each element before the blow, (elements, 3), m."""
    return np.asarray(mesh.points[mesh.hexahedra].mean(axis=1))


def kept_elements(mesh: Mesh, view: Camera) -> NDArray[np.bool_]:
    """Return which elements a view leaves, (elements,), by their middle before the blow.

    Raises
    ------
    InputError
        If the view names a part that is not there, or leaves nothing.
    """
    visible = _visible(mesh, view)
    if not visible.any():
        raise InputError("view", "nothing left", "a cut, a zone and parts that leave elements to be drawn")
    return visible


def _visible(mesh: Mesh, view: Camera) -> NDArray[np.bool_]:
    """Return which elements a view leaves, (elements,); it may be none."""
    middle = _middles(mesh)
    visible = np.ones(len(middle), bool)
    if view.parts:
        visible[:] = False
        for name in view.parts:
            visible[mesh.elements_of(name)] = True
    if view.cut is not None:
        point, normal = (np.asarray(v, float) for v in view.cut)
        visible &= (middle - point) @ normal <= 0.0
    if view.near is not None:
        centre, radius = view.near
        visible &= np.linalg.norm(middle - np.asarray(centre), axis=1) <= radius
    return visible
