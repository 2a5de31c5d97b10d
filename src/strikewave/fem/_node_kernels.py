"""Kernels over nodes: a step of central differences, boundaries, rigid parts, and ties of nodes to faces."""

from typing import NamedTuple

import numpy as np

from strikewave.base.compiled import called_kernel, fused_called_kernel, fused_leaf_kernel, kernel, leaf_kernel


@fused_leaf_kernel
def move_node(n, x, v, f, inverse_mass, kick, step):
    """Move a node: v += kick f / m, x += step v; clear its force. A tied one has no inverse mass: it follows others."""
    share = kick * inverse_mass[n]
    if share != 0.0:
        for c in range(3):
            v[n, c] += share * f[n, c]
            x[n, c] += step * v[n, c]
    for c in range(3):
        f[n, c] = 0.0


@fused_called_kernel
def advance(x, v, f, inverse_mass, kick, step, first, last):
    """Move the nodes first to last - 1."""
    for n in range(first, last):
        move_node(n, x, v, f, inverse_mass, kick, step)


@leaf_kernel
def sum_share(k, nodes, x, f, centre, sums):
    """Write force and moment about the centre of every n-th node from node k on into row k of n rows."""
    forces_x, forces_y, forces_z, moment_x, moment_y, moment_z = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    # a fixed share of nodes a row: the order of the sums is that of a device
    for i in range(k, nodes.size, sums.shape[0]):
        n = nodes[i]
        a, b, c = x[n, 0] - centre[0], x[n, 1] - centre[1], x[n, 2] - centre[2]
        forces_x, forces_y, forces_z = forces_x + f[n, 0], forces_y + f[n, 1], forces_z + f[n, 2]
        moment_x += b * f[n, 2] - c * f[n, 1]
        moment_y += c * f[n, 0] - a * f[n, 2]
        moment_z += a * f[n, 1] - b * f[n, 0]
    sums[k, 0], sums[k, 1], sums[k, 2] = forces_x, forces_y, forces_z
    sums[k, 3], sums[k, 4], sums[k, 5] = moment_x, moment_y, moment_z


@called_kernel
def sum_shares(nodes, x, f, centre, sums):
    """Write force and moment about the centre of the nodes of a part, by shares: see `sum_share`."""
    for k in range(sums.shape[0]):
        sum_share(k, nodes, x, f, centre, sums)


@leaf_kernel
def bring_node(i, nodes, arms, pose, times, x, before, f, mass, force):
    """Replace the force on a node by the one that brings it with its part within a step; write what that adds.

    ``pose`` holds the rotation since the start (rows 0 to 2) and the centre (row 3) at the end of the step; ``times``
    are the step of velocities and that of positions, s.
    """
    n, (kick, step) = nodes[i], times
    for c in range(3):
        # a velocity (place - x)/step ends at the place, so that nodes do not drift off their part
        place = pose[3, c] + arms[i, 0] * pose[c, 0] + arms[i, 1] * pose[c, 1] + arms[i, 2] * pose[c, 2]
        whole = mass[n] * ((place - x[n, c]) / step - before[i, c]) / kick
        force[i, c] = whole - f[n, c]
        f[n, c] = whole


@called_kernel
def bring_nodes(nodes, arms, pose, times, x, before, f, mass, force):
    """Bring the nodes of a part with it: see `bring_node`."""
    for i in range(nodes.size):
        bring_node(i, nodes, arms, pose, times, x, before, f, mass, force)


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


@leaf_kernel
def hold_node(i, nodes, directions, speed, kick, v, f, mass, force):
    """Write and add the force that gives a node a speed along its held directions within a step."""
    n = nodes[i]
    for c in range(3):
        force[i, c] = 0.0
    for k in range(3):
        d = directions[i, k]
        if d[0] == 0.0 and d[1] == 0.0 and d[2] == 0.0:  # fewer than three directions are held
            continue
        along = 0.0
        for c in range(3):
            along += (v[n, c] + kick * f[n, c] / mass[n]) * d[c]  # the speed to which all other forces would bring it
        push = mass[n] * (speed - along) / kick
        for c in range(3):
            force[i, c] += push * d[c]
    for c in range(3):
        f[n, c] += force[i, c]


@called_kernel
def hold(nodes, directions, speed, kick, v, f, mass, force):
    """Hold nodes: see `hold_node`.

    ``directions`` (nodes, 3, 3) holds up to three orthonormal rows; rows of zeros hold nothing.
    """
    for i in range(nodes.size):
        hold_node(i, nodes, directions, speed, kick, v, f, mass, force)


@leaf_kernel
def absorb_node(i, nodes, matrix, kick, v, f, mass, force):
    """Write and add the force of a node's dashpots, -D (v + kick f / 2 m): see `strikewave.fem.boundary.Dashpots`."""
    n = nodes[i]
    half = 0.5 * kick / mass[n]  # at the middle of the step, so that no step is too long for a dashpot
    a, b, c = v[n, 0] + half * f[n, 0], v[n, 1] + half * f[n, 1], v[n, 2] + half * f[n, 2]
    for k in range(3):
        force[i, k] = -(matrix[i, k, 0] * a + matrix[i, k, 1] * b + matrix[i, k, 2] * c)
    for k in range(3):
        f[n, k] += force[i, k]


@called_kernel
def absorb(nodes, matrix, kick, v, f, mass, force):
    """Let waves out at nodes: see `absorb_node`."""
    for i in range(nodes.size):
        absorb_node(i, nodes, matrix, kick, v, f, mass, force)


@leaf_kernel
def face_modes(x, p, q, r, s, c):
    """Return the modes xi, eta and xi eta of a face's shape in direction c."""
    xi, eta = x[q, c] + x[r, c] - x[p, c] - x[s, c], x[r, c] + x[s, c] - x[p, c] - x[q, c]
    return 0.25 * xi, 0.25 * eta, 0.25 * (x[p, c] + x[r, c] - x[q, c] - x[s, c])


@leaf_kernel
def face_shares(x, p, q, r, s, c):
    """Return what a face gives its corners of area in direction c: evenly, and by the signs of their xi and eta.

    A corner has the exact share of a bilinear face, e x g + xi e x w / 3 + eta w x g / 3, with the modes e, g, w of its
    shape.
    """
    e1, g1, w1 = face_modes(x, p, q, r, s, (c + 1) % 3)
    e2, g2, w2 = face_modes(x, p, q, r, s, (c + 2) % 3)
    return e1 * g2 - e2 * g1, (e1 * w2 - e2 * w1) / 3.0, (w1 * g2 - w2 * g1) / 3.0


@called_kernel
def press(faces, pressure, x, force):
    """Write the forces of a pressure on the nodes of faces, given by places in ``force``, as they are now."""
    force[:] = 0.0  # by the faces as they are now: a pressure follows its surface
    for k in range(faces.shape[0]):
        p, q, r, s = faces[k, 0], faces[k, 1], faces[k, 2], faces[k, 3]
        for c in range(3):
            even, one, two = face_shares(x, p, q, r, s, c)
            force[p, c] -= pressure * (even - one - two)
            force[q, c] -= pressure * (even + one - two)
            force[r, c] -= pressure * (even + one + two)
            force[s, c] -= pressure * (even - one + two)


@leaf_kernel
def add_row(i, nodes, force, f):
    """Add a force to those of its node."""
    for c in range(3):
        f[nodes[i], c] += force[i, c]


@called_kernel
def add_rows(nodes, force, f):
    """Add forces to those of their nodes."""
    for i in range(nodes.size):
        add_row(i, nodes, force, f)


@leaf_kernel
def take_row(i, nodes, field, rows):
    """Copy the row of a node."""
    for c in range(3):
        rows[i, c] = field[nodes[i], c]


@called_kernel
def take_rows(nodes, field, rows):
    """Copy the rows of some nodes."""
    for i in range(nodes.size):
        take_row(i, nodes, field, rows)


@called_kernel
def work_and_impulse(nodes, force, before, v, kick):
    """Return the work of forces, by the mean of the velocities before and after a step, and their impulse."""
    work, x, y, z = 0.0, 0.0, 0.0, 0.0
    for i in range(nodes.size):
        for c in range(3):
            # by the mean velocity, for which central differences balance
            work += 0.5 * force[i, c] * (before[i, c] + v[nodes[i], c])
        x, y, z = x + force[i, 0], y + force[i, 1], z + force[i, 2]
    return kick * work, kick * x, kick * y, kick * z
