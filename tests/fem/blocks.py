"""Blocks of hexahedra and lattices of springs, small and independent of the solver."""

from dataclasses import dataclass, field

import numpy as np

from strikewave.fem.mesh import Mesh, volumes


def block(name, counts, size=(1.0, 1.0, 1.0), origin=(0.0, 0.0, 0.0)):
    """A box of counts elements with the sides bottom and top (across z)."""
    axes = [np.linspace(0.0, length, n + 1) for length, n in zip(size, counts, strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3) + np.array(origin)
    nodes = np.arange(len(points), dtype=np.int32).reshape([n + 1 for n in counts])
    nx, ny, nz = counts
    corner = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    hexahedra = np.stack([nodes[i : nx + i, j : ny + j, k : nz + k].ravel() for i, j, k in corner], 1)
    loop = [(0, 0), (1, 0), (1, 1), (0, 1)]
    top = np.stack([nodes[i : nx + i, j : ny + j, -1].ravel() for i, j in loop], 1)
    bottom = np.stack([nodes[i : nx + i, j : ny + j, 0].ravel() for i, j in loop[::-1]], 1)
    part = np.zeros(len(hexahedra), np.int32)
    return Mesh(points, hexahedra, part, (name,), {f"{name}.top": top, f"{name}.bottom": bottom})


def nodal_mass(mesh, density=1.0):
    """An eighth of each element's mass at each of its nodes."""
    mass = np.zeros(len(mesh.points))
    np.add.at(mass, mesh.hexahedra.ravel(), np.repeat(density * volumes(mesh.points, mesh.hexahedra) / 8.0, 8))
    return mass


@dataclass
class Lattice:
    """Masses on the nodes, springs along all edges and the diagonals of all faces of the hexahedra."""

    mesh: Mesh
    stiffness: float = 1.0
    pairs: np.ndarray = field(init=False)
    k: np.ndarray = field(init=False)
    length: np.ndarray = field(init=False)
    mass: np.ndarray = field(init=False)

    def __post_init__(self):
        corner = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])
        joins = [(p, q) for p in range(8) for q in range(p) if 0 < np.abs(corner[p] - corner[q]).sum() < 3]
        every = np.sort(np.concatenate([self.mesh.hexahedra[:, j] for j in joins]), axis=1)
        self.pairs, count = np.unique(every, axis=0, return_counts=True)
        self.length = np.linalg.norm(np.subtract(*self.mesh.points[self.pairs.T]), axis=1)
        self.k = self.stiffness * count * self.length
        self.mass = nodal_mass(self.mesh)

    def force(self, x):
        a, b = self.pairs.T
        d = x[b] - x[a]
        now = np.linalg.norm(d, axis=1)
        t = (self.k * (now - self.length) / now)[:, None] * d
        return np.stack([np.bincount(a, t[:, c], len(x)) - np.bincount(b, t[:, c], len(x)) for c in range(3)], 1)

    def energy(self, x):
        now = np.linalg.norm(np.subtract(*x[self.pairs.T]), axis=1)
        return 0.5 * np.sum(self.k * (now - self.length) ** 2)

    def critical_step(self):
        """2/omega of the fastest vibration, by the power method."""
        x = self.mesh.points
        v = np.random.default_rng(1).standard_normal(x.shape)
        for _ in range(300):
            small = 1e-7 / np.abs(v).max()
            v = -self.force(x + small * v) / small / self.mass[:, None]
            fastest = np.linalg.norm(v)
            v /= fastest
        return 2.0 / np.sqrt(fastest)
