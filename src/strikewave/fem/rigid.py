"""Parts that do not deform; SI.

Momentum p and angular momentum L about the centre of mass follow the forces on the nodes, dp/dt = sum f, dL/dt = sum
(x - c) x f, at the half steps of central differences. The rotation over a step is that of the angular velocity
J^-1 L with the inertia J at its middle.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
from scipy.linalg import block_diag, eigvalsh
from scipy.spatial.transform import Rotation

from strikewave.base.errors import InputError
from strikewave.fem import _rigid_kernels as kernels
from strikewave.fem.boundary import Acting, Now
from strikewave.fem.mesh import Array, Index, Mesh
from strikewave.fem.model import Model, Rigid
from strikewave.fem.surfaces import extents, surface_of
from strikewave.fem.tie import TieState

SHARES = 128
"""In how many shares the forces on a part are summed: a share is a thread of a device, and the order is the same on the
processor. So many that threads share large parts, so few that the sums are brought here in no time."""


class RigidBody(Acting):
    """The nodes of a rigid part; its forces make them move together.

    Attributes
    ----------
    centre, velocity, spin : array (3,)
        Centre of mass, m; its velocity, m/s, and angular momentum, kg m^2/s, half a step before.
    turned : array (3, 3)
        Rotation since the start.
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
        rest = now.kick, now.step, now.x, self.before, now.f, now.mass, self.force
        kernels.bring_nodes(self.nodes, self.arms, pose, *rest)

    def move(self, sums: Array, kick: float, step: float) -> Array:
        """Move the body under force and moment about its centre, (shares, 6); return rotation and centre, (4, 3)."""
        force, moment = np.split(sums.sum(axis=0), 2)
        self.velocity = np.where(self.moves, self.velocity + kick * force / self.mass, 0.0)
        self.spin = self.spin + kick * moment
        self.centre = self.centre + step * self.velocity
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
    """Return the rigid parts; ``mass`` (nodes,) is that of the nodes, ``held`` the nodes that are held or driven.

    Raises
    ------
    InputError
        If a node of one is tied, held, driven or that of another, or two rigid surfaces may touch.
    """
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
