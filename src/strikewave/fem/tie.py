"""Nodes of a side tied to faces of another, whose mesh need not match; SI.

A tied node keeps its place p on a face and moves as the face does there: v_s = sum N_i v_i, with the shape functions
N_i of the four corners at p. The corners carry its mass and its force in turn, m_i += N_i m_s and f_i += N_i f_s, so
that momentum is kept exactly, and the work too: f_s . v_s = sum N_i f_s . v_i. Angular momentum is kept as well where
the node lies on the face; one that lies the vector d off it feels the moment d x f_s of a force that is handed on.

A run calls `gather_mass` once, `gather_tied_forces` in each step when all other forces are known (contact too), and
`move_tied` when the new velocities are. A tied node has no mass of its own then: its inverse mass is to be set to 0.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from strikewave.base.errors import InputError
from strikewave.fem import _contact_kernels as kernels
from strikewave.fem._tie_kernels import TieState, gather_mass, gather_tied_forces, move_tied
from strikewave.fem.contact import searched, two_surfaces
from strikewave.fem.mesh import Mesh
from strikewave.fem.model import SurfaceContact, Tie

__all__ = ["TieState", "gather_mass", "gather_tied_forces", "move_tied", "prepare_ties"]

NEAR = 0.1
"""Share of a face's size by which a node may lie off the face it is tied to: what a circle of 8 edges cuts off, as
`SHALLOW` of a contact; farther off, the moment of the forces handed on would count."""
REACH = 2.0
"""Times `NEAR` within which faces are looked for, so that a node just too far off is reported with its distance."""


def prepare_ties(ties: Sequence[Tie], mesh: Mesh) -> TieState:
    """Return the tied nodes of all ties, each with the face that is closest to it.

    Raises
    ------
    InputError
        If a side is not there, nodes lie further off than `NEAR`, are on both sides, tied twice, or tied to faces with
        tied corners.

    Examples
    --------
    >>> from strikewave.fem.mesh import joined
    >>> cube = np.array([[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], float)
    >>> side = {"big.top": np.array([[4, 5, 6, 7]], np.int32)}
    >>> big = Mesh(4.0 * cube, np.arange(8, dtype=np.int32)[None], np.zeros(1, np.int32), ("big",), side)
    >>> side = {"small.bottom": np.array([[0, 3, 2, 1]], np.int32)}
    >>> small = Mesh(cube + [1.5, 0.0, 4.0], big.hexahedra, big.part, ("small",), side)
    >>> state = prepare_ties([Tie("small.bottom", "big.top")], joined([big, small]))
    >>> state.nodes.tolist(), state.shape[0].tolist()
    ([8, 9, 10, 11], [0.625, 0.375, 0.0, 0.0])
    """
    states = [_tied(tie, mesh) for tie in ties]
    if not states:
        return TieState(np.zeros(0, np.int32), np.zeros((0, 4), np.int32), np.zeros((0, 4)))
    state = TieState(*(np.concatenate(column) for column in zip(*states, strict=True)))
    nodes, times = np.unique(state.nodes, return_counts=True)
    if np.any(times > 1):
        raise InputError("tie", f"{int(np.sum(times > 1))} nodes of two ties", "each node tied once")
    chained = np.intersect1d(nodes, state.corners).size
    if chained:
        raise InputError(
            "tie", f"{chained} tied nodes at corners of faces tied to", "faces whose corners are not tied themselves"
        )
    return state


def _tied(tie: Tie, mesh: Mesh) -> TieState:
    state = searched(two_surfaces(SurfaceContact(tie.side, tie.onto), mesh), mesh.points, REACH * NEAR)
    count = state.touch.first
    face, shape, distance = np.zeros(count, np.int32), np.zeros((count, 4)), np.full(count, np.inf)
    state.place[:] = mesh.points[state.touch.nodes]
    kernels.nearest_faces(state, face, shape, distance)
    off = distance > NEAR * state.size[face]
    if np.any(off):
        close = distance[np.isfinite(distance)]
        furthest = f"the furthest {close.max():.3g} m" if len(close) == count else "some nowhere near"
        raise InputError(
            f"tie of {tie.side}",
            f"{int(off.sum())} of {count} nodes off {tie.onto}, {furthest}",
            f"nodes within {NEAR:g} of the size of a face of {tie.onto}",
            "move the parts together, or tie the smaller side onto the larger one",
        )
    return TieState(state.touch.nodes[:count], state.touch.nodes[state.faces[face]], shape)
