"""Boundaries of a mesh, each as the nodal force that holds or loads it; SI.

A boundary adds, once all other forces of an instant are known, the force by which central differences reach the
velocity that it asks for, m (v_wanted - v)/dt - f. Work and impulse of all of them then come from one formula, and
reactions are known to the rounding error.
"""

from __future__ import annotations

import abc
import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError
from strikewave.fem import _node_kernels as kernels
from strikewave.fem._node_kernels import TieState
from strikewave.fem.mesh import Array, Index, Mesh
from strikewave.fem.model import Driven, Fixed, Guided, Model, NonReflecting, Pressure, Symmetry, TimeCurve, Vector
from strikewave.fem.solids import AnySolid

Flags = NDArray[np.bool_]
FLAT = 1e-6  # files of meshes keep six digits or more
"""Largest difference between the normals of a symmetry side."""
PARALLEL = 1e-6  # as `FLAT`
"""Share of a unit vector below which a held direction is one of those held already."""


@dataclass
class Now:
    """The instant t_n: x there, v half a step before, f all forces so far.

    ``kick`` is the step of the velocity, ``step`` that of the position.
    """

    time: float
    kick: float
    step: float
    x: Array
    v: Array
    f: Array
    mass: Array


class Acting(abc.ABC):
    """Forces on some nodes (each once): ``force`` of this step, N, and velocity ``before`` it, m/s, (k, 3)."""

    def __init__(self, nodes: Index) -> None:
        self.nodes = np.ascontiguousarray(nodes, np.int32)
        self.force, self.before = np.zeros((len(nodes), 3)), np.zeros((len(nodes), 3))

    def add(self, now: Now) -> None:
        """Find the forces of this instant and add them to those of the nodes."""
        kernels.take_rows(self.nodes, now.v, self.before)
        self.apply(now)

    @abc.abstractmethod
    def apply(self, now: Now) -> None:
        """Write ``force`` and add it to ``now.f``."""

    def add_rest(self, now: Now) -> None:
        """Add the force that it takes to hold the nodes against contact too."""
        first = self.force.copy()  # `apply` overwrites the force; the work of the step is that of both
        self.apply(now)
        self.force += first

    def done(self, v: Array, kick: float) -> tuple[float, float, float, float]:
        """Return work (J) and impulse (N s) of the step that led to the velocity v."""
        done: tuple[float, float, float, float] = kernels.work_and_impulse(self.nodes, self.force, self.before, v, kick)
        return done

    def now(self) -> Array:
        """Return the power of the forces on the velocities before, W, and their sum, N: (4,)."""
        return np.append(np.einsum("ni,ni->", self.force, self.before), self.force.sum(axis=0))


class Weight(Acting):
    """Gravity on all nodes, of which each has its own mass (nodes,) here, that of tied ones too."""

    def __init__(self, mass: Array, gravity: Vector) -> None:
        super().__init__(np.arange(len(mass), dtype=np.int32))
        self.force[:] = mass[:, None] * np.array(gravity)

    def apply(self, now: Now) -> None:
        """Add the weight."""
        kernels.add_rows(self.nodes, self.force, now.f)


class Held(Acting):
    """Nodes without, or with a given, speed along some directions."""

    def __init__(self, nodes: Index, directions: Array, speed: TimeCurve | None = None) -> None:
        super().__init__(nodes)
        self.directions, self.speed = np.ascontiguousarray(directions, float), speed

    def apply(self, now: Now) -> None:
        """Hold the nodes at rest or at a speed."""
        # Velocities are those at the middle of the step to come.
        speed = 0.0 if self.speed is None else value_at(self.speed, now.time + 0.5 * now.step)
        kernels.hold(self.nodes, self.directions, speed, now.kick, now.v, now.f, now.mass, self.force)


class Pressed(Acting):
    """Faces under a pressure."""

    def __init__(self, faces: Index, pressure: TimeCurve) -> None:
        nodes, places = np.unique(faces, return_inverse=True)
        super().__init__(nodes)
        self.faces, self.pressure = places.reshape(faces.shape).astype(np.int32), pressure

    def apply(self, now: Now) -> None:
        """Press the faces as they are deformed now."""
        kernels.press(self.faces, value_at(self.pressure, now.time), now.x[self.nodes], self.force)
        kernels.add_rows(self.nodes, self.force, now.f)


class Dashpots(Acting):
    """Dashpots C that let waves out, taken at the middle of the step, so that no step is too long for them.

    The force -C (v + v_new)/2 with v_new = v + dt (f - C (v + v_new)/2)/m is -D (v + dt f/2m),
    D = C (1 + dt C/2m)^-1 (semi-implicit).

    Source: Lysmer & Kuhlemeyer 1969, Journal of the Engineering Mechanics Division 95, 859.
    """

    def __init__(self, nodes: Index, matrix: Array) -> None:
        super().__init__(nodes)
        self.matrix, self.kick, self.ready = matrix, 0.0, matrix

    def apply(self, now: Now) -> None:
        """Absorb the waves that arrive."""
        if now.kick != self.kick:
            self.kick, self.ready = now.kick, self.ready_for(now.kick, now.mass)
        kernels.absorb(self.nodes, self.ready, now.kick, now.v, now.f, now.mass, self.force)

    def ready_for(self, kick: float, mass: Array) -> Array:
        """Return D for a step of the velocity, with the masses of all nodes."""
        share = self.matrix * (0.5 * kick / mass[self.nodes])[:, None, None]
        return np.ascontiguousarray(self.matrix @ np.linalg.inv(np.eye(3) + share))


def value_at(curve: TimeCurve, time: float) -> float:
    """Return the value of a curve at a time."""
    return float(np.interp(time, curve.time, curve.value))


def area_vectors(points: Array, faces: Index) -> Array:
    """Return the area vector of each face, m^2, outward."""
    return np.asarray(
        0.5 * np.cross(points[faces[:, 2]] - points[faces[:, 0]], points[faces[:, 3]] - points[faces[:, 1]])
    )


def unit(vector: Sequence[float], field: str) -> Array:
    """Return a vector of length one."""
    length = float(np.linalg.norm(vector))
    if not 0.0 < length < np.inf:
        raise InputError(field, list(vector), "a vector that is not zero")
    return np.asarray(vector, float) / length


def nodes_named(mesh: Mesh, name: str) -> Index:
    """Return the nodes of a side, or of a part named alone."""
    return mesh.nodes_of(name) if name in mesh.names else np.unique(mesh.side(name))


def normal_of(mesh: Mesh, side: str) -> Array:
    """Return the normal of a flat side."""
    areas = area_vectors(mesh.points, mesh.side(side))
    mean = unit(areas.sum(axis=0), side)
    size = np.linalg.norm(areas, axis=1)
    off = float(np.abs(areas @ mean - size).max() / size.max())  # over the largest face: slivers may be askew
    if off > FLAT:
        raise InputError("boundary.side", side, "a flat side for symmetry", "use kind = guided or fixed on a bent one")
    return mean


def _across(axis: Array) -> Array:
    """Return two directions across an axis, (2, 3)."""
    return np.asarray(np.linalg.svd(axis[None])[2][1:])


def _held_directions(mesh: Mesh, boundary: Fixed | Symmetry | Guided) -> Array:
    if isinstance(boundary, Fixed):
        return np.eye(3)
    if isinstance(boundary, Symmetry):
        return normal_of(mesh, boundary.side)[None]
    return _across(unit(boundary.axis, "boundary.axis"))


def _orthonormal(basis: Array, new: Array) -> Array:
    """Return the rows of a basis and those parts of new directions that they do not span yet."""
    for direction in new:
        rest = direction - basis.T @ (basis @ direction)
        length = np.linalg.norm(rest)
        if length > PARALLEL:
            basis = np.vstack([basis, rest / length])
    return basis


def held_nodes(mesh: Mesh, boundaries: Sequence[Fixed | Symmetry | Guided], ties: TieState) -> Held | None:
    """Return all held nodes but tied ones with their directions."""
    directions: dict[bytes, Array] = {b"": np.zeros((0, 3))}
    kind = np.zeros(len(mesh.points), np.int64)
    keys = [b""]
    for boundary in boundaries:
        nodes = nodes_named(mesh, boundary.side)
        new = _held_directions(mesh, boundary)
        before = kind[nodes].copy()
        for old in np.unique(before):
            basis = _orthonormal(directions[keys[old]], new)
            key = basis.tobytes()
            if key not in directions:
                directions[key] = basis
                keys.append(key)
            kind[nodes[before == old]] = keys.index(key)
    table = np.array([np.vstack([directions[key], np.zeros((3 - len(directions[key]), 3))]) for key in keys])
    bases, corners = table[kind[ties.nodes]][:, None], table[kind[ties.corners]]
    loose = np.abs(bases - bases @ (np.swapaxes(corners, 2, 3) @ corners)).max(axis=(2, 3), initial=0.0)
    for boundary in boundaries:
        _check_tied(boundary, nodes_named(mesh, boundary.side), ties, loose > PARALLEL)
    kind[ties.nodes] = 0  # they follow corners that are held as they would be: checked above
    nodes = np.flatnonzero(kind).astype(np.int32)
    return Held(nodes, table[kind[nodes]]) if len(nodes) else None


def _check_tied(boundary: Fixed | Symmetry | Guided | Driven, nodes: Index, ties: TieState, loose: Flags) -> None:
    """Refuse tied nodes of a side that follow corners (tied nodes, 4) which are not held or driven as they are."""
    wrong = np.isin(ties.nodes, nodes) & np.any(loose & (ties.shape > PARALLEL), axis=1)
    if wrong.any():
        got = f"{int(wrong.sum())} nodes of {boundary.side}, which are tied and follow another side"
        hint = "hold or drive what they are tied to, or tie the other side onto this one"
        raise InputError("boundary.side", got, "a side that is not tied", hint)


def dashpots(
    mesh: Mesh, sides: Sequence[NonReflecting], solids: Mapping[str, AnySolid], free: Flags
) -> Dashpots | None:
    """Return the dashpots of all non-reflecting sides."""
    matrix = np.zeros((len(mesh.points), 3, 3))
    for boundary in sides:
        solid = solids[boundary.side.rpartition(".")[0] or boundary.side]
        faces = mesh.side(boundary.side)
        areas = area_vectors(mesh.points, faces)
        size = np.linalg.norm(areas, axis=1)
        normal = areas / size[:, None]
        shear = solid.density * float(np.sqrt(solid.shear_modulus / solid.density))
        normal_part = (solid.density * solid.wave_speed - shear) * np.einsum("fi,fj->fij", normal, normal)
        # A quarter of the face for each of its corners.
        share = 0.25 * size[:, None, None] * (shear * np.eye(3) + normal_part)
        for corner in faces.T:
            np.add.at(matrix, corner, share)
    nodes = np.flatnonzero(np.any(matrix, axis=(1, 2)) & free).astype(np.int32)
    return Dashpots(nodes, matrix[nodes]) if len(nodes) else None


def build_boundaries(model: Model, ties: TieState) -> tuple[list[Acting], list[Held]]:
    """Return the loads of a model (pressures, dashpots), which contact feels, and its holds (driven, held nodes)."""
    mesh = model.mesh
    free = np.ones(len(mesh.points), bool)
    free[ties.nodes] = False
    loads: list[Acting] = [Pressed(mesh.side(b.side), b.pressure) for b in model.boundaries if isinstance(b, Pressure)]
    quiet = dashpots(mesh, [b for b in model.boundaries if isinstance(b, NonReflecting)], model.solids, free)
    restrained = held_nodes(mesh, [b for b in model.boundaries if isinstance(b, Fixed | Symmetry | Guided)], ties)
    moving = [b for b in model.boundaries if isinstance(b, Driven)]
    _check_driven(mesh, moving, ties)
    driven = [_driven(mesh, b, restrained, free) for b in moving]
    return [*loads, *([quiet] if quiet else [])], [*driven, *([restrained] if restrained else [])]


def _check_driven(mesh: Mesh, boundaries: Sequence[Driven], ties: TieState) -> None:
    """Refuse nodes that are driven twice, unless alike or across each other, and tied ones that follow other nodes."""
    nodes = [nodes_named(mesh, each.side) for each in boundaries]
    ways = [unit(each.direction, "boundary.direction") for each in boundaries]
    kinds = [(each.direction, each.velocity) for each in boundaries]
    alike = [[i for i, other in enumerate(kinds) if other == kind] for kind in kinds]
    for i, j in itertools.combinations(range(len(boundaries)), 2):
        if j not in alike[i] and abs(ways[i] @ ways[j]) > PARALLEL and np.isin(nodes[i], nodes[j]).any():
            got = f"{boundaries[i].side} and {boundaries[j].side}, with common nodes"
            raise InputError("boundary.side", got, "nodes driven once, or along directions at right angles")
    for each, own, same in zip(boundaries, nodes, alike, strict=True):
        _check_tied(each, own, ties, ~np.isin(ties.corners, np.concatenate([nodes[i] for i in same])))


def _driven(mesh: Mesh, boundary: Driven, held: Held | None, free: Flags) -> Held:
    nodes = nodes_named(mesh, boundary.side)
    nodes = nodes[free[nodes]]
    direction = unit(boundary.direction, "boundary.direction")
    if held is not None:
        common = np.isin(held.nodes, nodes)
        if np.any(np.abs(held.directions[common] @ direction) > PARALLEL):
            raise InputError(
                "boundary.side", boundary.side, "nodes that are not held along the direction they are driven"
            )
    rows = np.zeros((len(nodes), 3, 3))
    rows[:, 0] = direction
    return Held(nodes, rows, boundary.velocity)
