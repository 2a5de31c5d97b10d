"""Kernels of boundaries: each writes the force that it adds, so that one energy balance serves all of them."""

from strikewave.base.compiled import called_kernel, leaf_kernel


@leaf_kernel
def hold_node(i, nodes, directions, speed, kick, v, f, mass, force):
    """Write and add the force that gives a node a speed along its held directions within a step."""
    n = nodes[i]
    for c in range(3):
        force[i, c] = 0.0
    for k in range(3):
        d = directions[i, k]
        if d[0] == 0.0 and d[1] == 0.0 and d[2] == 0.0:
            continue
        along = 0.0
        for c in range(3):
            along += (v[n, c] + kick * f[n, c] / mass[n]) * d[c]
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
    half = 0.5 * kick / mass[n]
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
    force[:] = 0.0
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
            work += 0.5 * force[i, c] * (before[i, c] + v[nodes[i], c])
        x, y, z = x + force[i, 0], y + force[i, 1], z + force[i, 2]
    return kick * work, kick * x, kick * y, kick * z
