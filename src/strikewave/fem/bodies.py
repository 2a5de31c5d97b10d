"""Rigid parts; bodies of joined parts, their free motions, and their way back to where they began; SI.

Of a rigid part momentum p and angular momentum L about the centre of mass follow the forces on the nodes, dp/dt = sum
f, dL/dt = sum (x - c) x f, at the half steps of central differences. The rotation over a step is that of the angular
velocity J^-1 L with the inertia J at its middle.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import block_diag, eigvalsh, expm
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial.transform import Rotation

from strikewave.base.errors import InputError
from strikewave.fem import _node_kernels as kernels
from strikewave.fem._node_kernels import TieState
from strikewave.fem.boundary import Acting, Held, Now
from strikewave.fem.contact import extents, surface_of
from strikewave.fem.mesh import TINY, Array, Index, Mesh
from strikewave.fem.model import Model, Rigid

SHARES = 128  # a share is a thread of a device: many enough for large parts, few enough to bring the sums here at once
"""Shares in which the forces on a part are summed, in the same order on a device and on the processor."""


class RigidBody(Acting):
    """Nodes of a rigid part; its forces make them move together.

    ``centre`` (m), ``velocity`` (m/s) and ``spin``, the angular momentum (kg m^2/s), are of the centre of mass, the
    last two half a step before; ``turned`` (3, 3) is the rotation since the start.
    """

    def __init__(self, mesh: Mesh, rigid: Rigid, mass: Array, velocity: Array) -> None:
        super().__init__(mesh.nodes_of(rigid.part))
        weights = mass[self.nodes]
        self.mass = float(weights.sum())
        self.centre = weights @ mesh.points[self.nodes] / self.mass
        self.arms = mesh.points[self.nodes] - self.centre
        square = np.einsum("ni,ni->n", self.arms, self.arms)
        self.inertia = np.eye(3) * float(weights @ square) - np.einsum("n,ni,nj->ij", weights, self.arms, self.arms)
        self.moves, self.turns = np.array(rigid.translations), np.array(rigid.rotations)
        self.velocity = np.where(self.moves, velocity, 0.0)
        self.spin, self.turned = np.zeros(3), np.eye(3)
        self.sums = np.zeros((SHARES, 6))

    def apply(self, now: Now) -> None:
        """Write the forces between the nodes that keep them together, and those that hold what may not move."""
        kernels.sum_shares(self.nodes, now.x, now.f, tuple(self.centre.tolist()), self.sums)
        pose = self.move(self.sums, now.kick, now.step)
        rest = (now.kick, now.step), now.x, self.before, now.f, now.mass, self.force
        kernels.bring_nodes(self.nodes, self.arms, pose, *rest)

    def move(self, sums: Array, kick: float, step: float) -> Array:
        """Move the body under force and moment about its centre, (shares, 6); return rotation and centre, (4, 3)."""
        force, moment = np.split(sums.sum(axis=0), 2)
        self.velocity = np.where(self.moves, self.velocity + kick * force / self.mass, 0.0)
        self.spin = self.spin + kick * moment
        self.centre = self.centre + step * self.velocity
        # The inertia turns with the body: the rate at the middle of the step makes the rotation second order.
        half = Rotation.from_rotvec(0.5 * step * self._rate(self.turned)).as_matrix() @ self.turned
        self.turned = Rotation.from_rotvec(step * self._rate(half)).as_matrix() @ self.turned
        return np.vstack([self.turned, self.centre])

    def _rate(self, turned: Array) -> Array:
        """Return the angular velocity at an orientation, 1/s, about the axes that are free."""
        rate = np.zeros(3)
        free = np.flatnonzero(self.turns)
        if len(free):
            inertia = turned @ self.inertia @ turned.T
            rate[free] = np.linalg.solve(inertia[np.ix_(free, free)], self.spin[free])
        return rate


def surface_inverse_mass(body: RigidBody, mesh: Mesh, part: str) -> Array:
    """Return inverse masses of a rigid part's nodes that move under any contact at least as easily as the body, 1/kg.

    Forces f at nodes i with arms r_i move the body by K^-1 sum R_i^T f_i, R_i = (1, -r_i x), K = diag(M, J), and node j
    by R_j of that. Free masses A_i/a in place of the nodes, A_i their shares of the surface, move more under any forces
    where a is at least the largest eigenvalue of K^-1 sum A_i R_i^T R_i. With an even pressure on a body that cannot
    turn they move alike: together they weigh M. A body without freedoms has a = 0. So contact is stable for any mass;
    but a body far lighter than the layers of nodes that press it from two sides is pressed through.
    """
    surface = surface_of(mesh.side(f"{part}.all"))
    place = np.searchsorted(body.nodes, surface.nodes)
    area = extents(mesh.points[surface.nodes], surface.faces).area
    modes = np.zeros((len(place), 3, 6))
    modes[:, :, :3] = np.eye(3)
    modes[:, :, 3:] = np.cross(body.arms[place, None, :], np.eye(3))
    spread = np.einsum("n,nci,ncj->ij", area, modes, modes)
    masses = block_diag(body.mass * np.eye(3), body.inertia)
    free = np.flatnonzero([*body.moves, *body.turns])
    pick = np.ix_(free, free)
    most = eigvalsh(spread[pick], masses[pick])[-1] if len(free) else 0.0
    inverse_mass = np.zeros(len(body.nodes))
    inverse_mass[place] = most / area
    return inverse_mass


def rigid_bodies(model: Model, mass: Array, ties: TieState, held: Sequence[Index]) -> list[RigidBody]:
    """Return the rigid parts; ``mass`` (nodes,) is that of the nodes, ``held`` the nodes that are held or driven."""
    speeds = [np.array(model.velocity.get(rigid.part, (0.0, 0.0, 0.0))) for rigid in model.rigid]
    bodies = [RigidBody(model.mesh, rigid, mass, speed) for rigid, speed in zip(model.rigid, speeds, strict=True)]
    tied = np.concatenate([ties.nodes, ties.corners.ravel()])
    for rigid, body in zip(model.rigid, bodies, strict=True):
        if np.isin(body.nodes, tied).any():
            raise InputError(f"rigid {rigid.part}", "tied nodes", "no tie on a rigid part", "make both parts one")
        if any(np.isin(body.nodes, nodes).any() for nodes in held):
            hint = "state its freedoms instead (rigid), or drive a part that deforms"
            raise InputError(f"rigid {rigid.part}", "held or driven nodes", "no boundary that holds a rigid part", hint)
    for (first_part, first), (second_part, second) in itertools.combinations(zip(model.rigid, bodies, strict=True), 2):
        if np.isin(first.nodes, second.nodes).any():
            got = f"common nodes with rigid {second_part.part}"
            raise InputError(
                f"rigid {first_part.part}", got, "nodes of its own for each rigid part", "make both one part"
            )
    _check_surfaces(model, bodies)
    return bodies


def _check_surfaces(model: Model, bodies: Sequence[RigidBody]) -> None:
    """Refuse contact of rigid surfaces with each other and with walls: no elasticity bounds its force."""
    rigid = np.zeros(len(model.mesh.points), bool)
    for body in bodies:
        rigid[body.nodes] = True
    pairs = [(f"contact {each.name}", (each.first, each.second)) for each in model.contacts]
    for field, sides in (*pairs, *((f"wall {each.name}", (each.side,)) for each in model.walls)):
        if all(rigid[model.mesh.side(side)].all() for side in sides):
            hint = "let a part deform, or lock the freedoms of the rigid part in place of a wall"
            raise InputError(field, "rigid on rigid", "at least one surface that deforms", hint)


HELD = 1e-12  # squares of directions that are known to 1e-16, times some hundred nodes; a real hold is far above
"""Share of the largest eigenvalue below which boundaries do not hold a motion."""
ROUNDS, CLOSE = 20, 1e-13  # each round squares the angle that is left: three or four reach rounding
"""Most rounds of the fit of a rigid motion, and the share of a body's length below which a round is the last."""


@dataclass(frozen=True)
class Body:
    """Parts that ties or common nodes join."""

    parts: tuple[str, ...]
    """Names of the parts, also of those of which it has only a piece."""
    nodes: Index
    """Nodes of the body, (k,)."""
    weight: Array
    """Weights of the nodes on the way back, kg, (k,): their mass, or that of its rigid parts' nodes alone."""
    motions: Array
    """Rigid motions left free, (6, n): velocity of the centre, and rotation times `length`."""
    centre: Array
    """Centre of mass before the first blow, m, (3,)."""
    length: float
    """Root of the mean square distance from the centre, m."""

    def modes(self, points: Array, centre: Array) -> Array:
        """Return the velocities (k, 3, 6) of points in unit translations and rotations about a centre."""
        arms = (points - centre) / self.length
        velocities = np.zeros((len(points), 3, 6))
        velocities[:, :, :3] = np.eye(3)
        velocities[:, :, 3:] = np.cross(np.eye(3), arms[:, None, :]).swapaxes(1, 2)
        return velocities


def joined_parts(mesh: Mesh, ties: TieState) -> tuple[tuple[str, ...], ...]:
    """Return the parts of each body."""
    label = _labels(mesh, ties)
    return tuple(_parts(mesh, label, number) for number in np.unique(label[mesh.hexahedra[:, 0]]))


def _parts(mesh: Mesh, label: Index, number: int) -> tuple[str, ...]:
    return tuple(name for name in mesh.names if np.any(label[mesh.nodes_of(name)] == number))


def bodies_of(
    mesh: Mesh, mass: Array, ties: TieState, holds: Sequence[Held], rigid: Sequence[RigidBody] = ()
) -> list[Body]:
    """Return the bodies of a mesh; ``mass`` (nodes,) is the nodes' own, ``holds`` what is held and does not move.

    Contacts do not join bodies: what touches may part.
    """
    label = _labels(mesh, ties)
    bodies = []
    for number in np.unique(label[mesh.hexahedra[:, 0]]):
        nodes = np.flatnonzero(label == number).astype(np.int32)
        places, weights = mesh.points[nodes], mass[nodes]
        centre = weights @ places / weights.sum()
        length = float(np.sqrt(weights @ np.sum((places - centre) ** 2, axis=1) / weights.sum()))
        stiff = [each for each in rigid if label[each.nodes[0]] == number]
        if stiff:
            weights = np.where(np.isin(nodes, np.concatenate([each.nodes for each in stiff])), weights, 0.0)
        body = Body(_parts(mesh, label, number), nodes, weights, np.eye(6), centre, length)
        bodies.append(replace(body, motions=_left_free(body, mesh.points, holds, stiff)))
    return bodies


def _labels(mesh: Mesh, ties: TieState) -> Index:
    """Return a number for each node, the same for all of a body."""
    corners = [np.stack([mesh.hexahedra[:, 0], mesh.hexahedra[:, k]]) for k in range(1, 8)]
    tied = [np.stack([ties.nodes, ties.corners[:, k]]) for k in range(4)] if len(ties.nodes) else []
    rows, columns = np.concatenate([*corners, *tied], axis=1)
    count = len(mesh.points)
    graph = coo_array((np.ones(len(rows), np.int8), (rows, columns)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1])


def _left_free(body: Body, points: Array, holds: Sequence[Held], rigid: Sequence[RigidBody]) -> Array:
    """Return the rigid motions (6, n) along no direction in which a node is held or a rigid part locked."""
    gram = np.zeros((6, 6))
    for hold in holds:
        own = np.isin(hold.nodes, body.nodes)
        rows = hold.directions[own] @ body.modes(points[hold.nodes[own]], body.centre)
        gram += np.einsum("kij,kil->jl", rows, rows)
    for part in rigid:
        centre = points[part.nodes[0]] - part.arms[0]
        locked = np.concatenate([body.modes(centre[None], body.centre)[0][~part.moves], np.eye(6)[3:][~part.turns]])
        gram += locked.T @ locked
    values, vectors = np.linalg.eigh(gram)
    return np.asarray(vectors[:, values <= HELD * max(float(values[-1]), TINY)])


def way_back(body: Body, before: Array, now: Array) -> tuple[Array, Array]:
    """Return the rigid motion, R x + t, that brings a body back to where it began.

    Among the motions that boundaries leave, it is the one after which sum m |x - x_0|^2 is least: where a body is free
    its centre of mass is then where it was, and it has not turned. With rigid parts the sum is over their nodes. Both
    places are of all nodes of the mesh, (nodes, 3), m; the result is R (3, 3) and t (3,), m.
    """
    start, places = before[body.nodes], now[body.nodes]
    motion = np.eye(4)
    for _ in range(ROUNDS):
        moved = places @ motion[:3, :3].T + motion[:3, 3]
        modes = body.modes(moved, body.centre) @ body.motions
        gram = np.einsum("n,nci,ncj->ij", body.weight, modes, modes)
        pull = np.einsum("n,nci,nc->i", body.weight, modes, start - moved)
        step = body.motions @ np.linalg.solve(gram, pull) if len(pull) else np.zeros(6)
        motion = _screw(step, body) @ motion
        if np.abs(step).max() <= CLOSE * body.length:
            break
    return motion[:3, :3], motion[:3, 3]


def _screw(step: Array, body: Body) -> Array:
    """Return the finite motion (4, 4) of a rigid one that goes on; it stays among those that boundaries leave."""
    rate = step[3:] / body.length
    twist = np.zeros((4, 4))
    twist[:3, :3] = np.cross(np.eye(3), rate)
    twist[:3, 3] = step[:3] - np.cross(rate, body.centre)
    return np.asarray(expm(twist))
