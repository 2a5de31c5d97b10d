"""Parts that do not deform; SI.

Momentum p and angular momentum L about the centre of mass follow the forces on the nodes, dp/dt = sum f, dL/dt = sum
(x - c) x f, at the half steps of central differences. The rotation over a step is that of the angular velocity
J^-1 L with the inertia J at its middle.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from strikewave.fem.boundary import Acting, Now
from strikewave.fem.mesh import Array, Mesh
from strikewave.fem.model import Rigid


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

    def act(self, now: Now) -> None:
        """Write the forces between the nodes that keep them together, and those that hold what may not move."""
        f, x = now.f[self.nodes], now.x[self.nodes]
        self.velocity = np.where(self.moves, self.velocity + now.kick * f.sum(axis=0) / self.mass, 0.0)
        self.spin = self.spin + now.kick * np.cross(x - self.centre, f).sum(axis=0)
        self.centre = self.centre + now.step * self.velocity
        half = Rotation.from_rotvec(0.5 * now.step * self._rate(self.turned)).as_matrix() @ self.turned
        self.turned = Rotation.from_rotvec(now.step * self._rate(half)).as_matrix() @ self.turned
        wanted = (self.centre + self.arms @ self.turned.T - x) / now.step
        force = now.mass[self.nodes][:, None] * (wanted - self.before) / now.kick
        self.force[:] = force - f
        now.f[self.nodes] = force

    def _rate(self, turned: Array) -> Array:
        """Return the angular velocity at an orientation, 1/s, about the axes that are free."""
        rate = np.zeros(3)
        free = np.flatnonzero(self.turns)
        if len(free):
            inertia = turned @ self.inertia @ turned.T
            rate[free] = np.linalg.solve(inertia[np.ix_(free, free)], self.spin[free])
        return rate
