"""Kernels of rigid parts: the sums over their nodes, and the forces that bring the nodes along."""

from strikewave.base.compiled import called_kernel, leaf_kernel


@leaf_kernel
def sum_share(k, nodes, x, f, centre, sums):
    """Write force and moment about the centre of every n-th node from node k on into row k of n rows."""
    forces_x, forces_y, forces_z, moment_x, moment_y, moment_z = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
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
def bring_node(i, nodes, arms, pose, kick, step, x, before, f, mass, force):
    """Replace the force on a node by the one that brings it with its part within a step; write what that adds.

    ``pose`` holds the rotation since the start (rows 0 to 2) and the centre (row 3) at the end of the step.
    """
    n = nodes[i]
    for c in range(3):
        place = pose[3, c] + arms[i, 0] * pose[c, 0] + arms[i, 1] * pose[c, 1] + arms[i, 2] * pose[c, 2]
        whole = mass[n] * ((place - x[n, c]) / step - before[i, c]) / kick
        force[i, c] = whole - f[n, c]
        f[n, c] = whole


@called_kernel
def bring_nodes(nodes, arms, pose, kick, step, x, before, f, mass, force):
    """Bring the nodes of a part with it: see `bring_node`."""
    for i in range(nodes.size):
        bring_node(i, nodes, arms, pose, kick, step, x, before, f, mass, force)
