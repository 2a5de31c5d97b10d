"""Which parts make one body, which ways it may move, and how it goes back to where it began; SI."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import expm
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from strikewave.fem.boundary import Held
from strikewave.fem.mesh import TINY, Array, Index, Mesh
from strikewave.fem.rigid import RigidBody
from strikewave.fem.tie import TieState

HELD = 1e-12
"""Share of the largest eigenvalue below which boundaries hold a motion not at all.

Eigenvalues are squares of directions that are known to 1e-16 times some hundred nodes; a real hold is far above."""
ROUNDS, CLOSE = 20, 1e-13
"""Of the fit of a rigid motion at most, and the share of a body's length below which a round is the last.

Each round squares the angle that is left, so that three or four reach rounding."""


@dataclass(frozen=True)
class Body:
    """Parts that ties or common nodes join.

    Attributes
    ----------
    parts : tuple of str
        Also those of which it has only a piece.
    nodes : array (k,)
    weight : array (k,)
        Of the nodes on the way back, kg: their mass; where the body has rigid parts, that of their nodes alone.
    motions : array (6, n)
        Columns span the rigid motions that boundaries and the freedoms of rigid parts leave: velocity of the centre
        and rotation times `length`.
    centre : array (3,)
        Of mass, before the first blow, m.
    length : float
        Root of the mean square distance from it, m.
    """

    parts: tuple[str, ...]
    nodes: Index
    weight: Array
    motions: Array
    centre: Array
    length: float

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

    Examples
    --------
    >>> from strikewave.fem.mesh import joined
    >>> from strikewave.fem.tie import prepare_ties
    >>> cube = np.array([[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], float)
    >>> one = Mesh(cube, np.arange(8, dtype=np.int32)[None], np.zeros(1, np.int32), ("one",))
    >>> two = Mesh(cube + 2.0, one.hexahedra, one.part, ("two",))
    >>> mesh = joined([one, two])
    >>> [(body.parts, body.motions.shape[1]) for body in bodies_of(mesh, np.ones(16), prepare_ties((), mesh), ())]
    [(('one',), 6), (('two',), 6)]
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
    its centre of mass is then where it was, and it has not turned. With rigid parts the sum is over their nodes.

    Parameters
    ----------
    body : Body
    before, now : array (nodes of the mesh, 3)
        Places of the nodes, m.

    Returns
    -------
    rotation : array (3, 3)
    shift : array (3,)
        m.
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
