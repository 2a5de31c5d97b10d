"""Compiled ties of nodes to faces; `strikewave.fem.tie` explains them."""

from typing import NamedTuple

import numpy as np

from strikewave.base.compiled import kernel, leaf_kernel


class TieState(NamedTuple):
    """Tied nodes, the corners of the face that each is tied to, (nodes, 4), and the shape functions there."""

    nodes: np.ndarray
    corners: np.ndarray
    shape: np.ndarray


@kernel
def gather_mass(ties, mass):
    """Hand the mass of each tied node to the corners of its face; nothing is left at the node."""
    for i in range(ties.nodes.shape[0]):
        node = ties.nodes[i]
        for k in range(4):
            mass[ties.corners[i, k]] += ties.shape[i, k] * mass[node]
        mass[node] = 0.0


@kernel
def gather_tied_forces(ties, f):
    """Hand the force on each tied node to the corners of its face; nothing is left at the node."""
    for i in range(ties.nodes.shape[0]):
        node = ties.nodes[i]
        for k in range(4):
            for c in range(3):
                f[ties.corners[i, k], c] += ties.shape[i, k] * f[node, c]
        for c in range(3):
            f[node, c] = 0.0


@leaf_kernel
def move_tied_node(i, ties, v):
    """Give a tied node the velocity of its place on the face (or any other vector that the nodes have)."""
    for c in range(3):
        total = 0.0
        for k in range(4):
            total += ties.shape[i, k] * v[ties.corners[i, k], c]
        v[ties.nodes[i], c] = total


@kernel
def move_tied(ties, v):
    """Move all tied nodes: see `move_tied_node`."""
    for i in range(ties.nodes.shape[0]):
        move_tied_node(i, ties, v)
