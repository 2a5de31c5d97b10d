"""Kernels over nodes: one step of central differences, and the kinetic energy of the balance."""

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


@fused_called_kernel
def doubled_kinetic(v, f, mass, inverse_mass, dt_previous, dt_next):
    """Return twice the kinetic energy at t_n that central differences conserve.

    v is at t_(n-1/2), a = f/m: m (v_n^2 - dt_previous dt_next a^2 / 4) is m v_(n-1/2) . v_(n+1/2) for equal steps.
    """
    total = 0.0
    for n in range(mass.size):
        square = 0.0
        for c in range(3):
            a = f[n, c] * inverse_mass[n]
            now = v[n, c] + 0.5 * dt_previous * a
            square += now * now - 0.25 * dt_previous * dt_next * a * a
        total += mass[n] * square
    return total
