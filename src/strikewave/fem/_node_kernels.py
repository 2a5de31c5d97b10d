"""Kernels over nodes: one step of central differences."""

from strikewave.base.compiled import fused_called_kernel, fused_leaf_kernel


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
