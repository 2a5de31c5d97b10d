"""Kernels of the fully integrated hexahedron; `strikewave.fem.hexahedron` explains them, `_layout` the rows."""

import numpy as np

from strikewave.base.compiled import fused_called_kernel, fused_leaf_kernel
from strikewave.fem._hexahedron_kernels import (
    add_sums,
    all_nodal_forces,
    critical_step,
    gather,
    mean_motion,
    scatter,
    state_rows,
    steepest,
    stress_force,
    viscosity,
)
from strikewave.fem._layout import (
    ALL_PLASTIC,
    ALL_WORK,
    BEFORE,
    COFACTOR,
    EIGHT,
    FIXED,
    FX,
    FY,
    FZ,
    HELD,
    HOURGLASS,
    MASS,
    PLASTIC,
    PRESSURE,
    STATES,
    STEEPEST,
    STRAIN,
    STRESS,
    SWELLING,
    VOLUME,
    WEIGHT,
    WORK,
    T,
    U,
    V,
    W,
    X,
    Y,
    Z,
)
from strikewave.fem._solid_kernels import increments, update_stress

POINTS = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]) / np.sqrt(3.0)
"""xi, eta, zeta of the points, each of weight 1."""


@fused_leaf_kernel
def slopes(s, rows, place, j):
    """Return the derivatives of a field by xi, eta and zeta at a place."""
    x, y, z = place
    a, b, c, d = s[rows[3] + j], s[rows[4] + j], s[rows[5] + j], s[rows[6] + j]
    return (
        s[rows[0] + j] + z * b + y * c + y * z * d,
        s[rows[1] + j] + z * a + x * c + x * z * d,
        s[rows[2] + j] + y * a + x * b + x * y * d,
    )


@fused_leaf_kernel
def cross(a, b):  # not that of `_surface_kernels`: fused, it rounds a product and a sum once together
    """Return the cross product of two vectors."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@fused_leaf_kernel
def cofactors(s, place, j):
    """Write Jacobian and its cofactors at a place, and the steepest gradient so far: infinite if turned inside out."""
    x, y, z = slopes(s, X, place, j), slopes(s, Y, place, j), slopes(s, Z, place, j)
    p, q, r = (x[0], y[0], z[0]), (x[1], y[1], z[1]), (x[2], y[2], z[2])
    a, b, c = cross(q, r), cross(r, p), cross(p, q)
    weight = p[0] * a[0] + p[1] * a[1] + p[2] * a[2]
    s[WEIGHT + j] = weight
    s[COFACTOR[0] + j], s[COFACTOR[1] + j], s[COFACTOR[2] + j] = a
    s[COFACTOR[3] + j], s[COFACTOR[4] + j], s[COFACTOR[5] + j] = b
    s[COFACTOR[6] + j], s[COFACTOR[7] + j], s[COFACTOR[8] + j] = c
    largest, _, _ = steepest(a, b, c)
    # no step is small enough for a point turned inside out
    s[STEEPEST + j] = max(s[STEEPEST + j], 8.0 * largest / weight if weight > 0.0 else np.inf)


@fused_leaf_kernel
def gradient_row(s, rows, place, r, j):
    """Return r times the gradient of a field at a place, by x, y and z."""
    u, v, w = slopes(s, rows, place, j)
    return (
        r * (u * s[COFACTOR[0] + j] + v * s[COFACTOR[3] + j] + w * s[COFACTOR[6] + j]),
        r * (u * s[COFACTOR[1] + j] + v * s[COFACTOR[4] + j] + w * s[COFACTOR[7] + j]),
        r * (u * s[COFACTOR[2] + j] + v * s[COFACTOR[5] + j] + w * s[COFACTOR[8] + j]),
    )


@fused_leaf_kernel
def point_kinematics(s, place, dt, j):
    """Write the strain and rotation increment at a place, with the mean volume change of the element."""
    r = dt / s[WEIGHT + j]
    a, b, c = gradient_row(s, U, place, r, j)
    d, e, f = gradient_row(s, V, place, r, j)
    g, h, i = gradient_row(s, T, place, r, j)
    increments(s, (a, b, c, d, e, f, g, h, i), j)
    # the mean volume change for that of the point: with eight of their own, a flow without one would lock
    more = (s[SWELLING + j] - s[STRAIN[0] + j] - s[STRAIN[1] + j] - s[STRAIN[2] + j]) / 3.0
    s[STRAIN[0] + j] += more
    s[STRAIN[1] + j] += more
    s[STRAIN[2] + j] += more


@fused_leaf_kernel
def pull(s, rows, place, x, y, z, j):
    """Take a deviator's row (x, y, z) times the gradients of the modes at a place off the forces on the modes."""
    xi, eta, zeta = place
    a = x * s[COFACTOR[0] + j] + y * s[COFACTOR[1] + j] + z * s[COFACTOR[2] + j]
    b = x * s[COFACTOR[3] + j] + y * s[COFACTOR[4] + j] + z * s[COFACTOR[5] + j]
    c = x * s[COFACTOR[6] + j] + y * s[COFACTOR[7] + j] + z * s[COFACTOR[8] + j]
    s[rows[0] + j] -= a
    s[rows[1] + j] -= b
    s[rows[2] + j] -= c
    s[rows[3] + j] -= zeta * b + eta * c
    s[rows[4] + j] -= zeta * a + xi * c
    s[rows[5] + j] -= eta * a + xi * b
    s[rows[6] + j] -= eta * zeta * a + xi * zeta * b + xi * eta * c


@fused_leaf_kernel
def point_force(s, place, j):
    """Add the forces of the deviator at a place, and its share of mean stress and works."""
    xx, yy, zz = s[STRESS[0] + j], s[STRESS[1] + j], s[STRESS[2] + j]
    xy, yz, zx = s[STRESS[3] + j], s[STRESS[4] + j], s[STRESS[5] + j]
    mean, weight = (xx + yy + zz) / 3.0, s[WEIGHT + j]
    # the deviator works on the gradients of the point, the mean stress on those of the element (`end_sums`)
    pull(s, FX, place, xx - mean, xy, zx, j)
    pull(s, FY, place, xy, yy - mean, yz, j)
    pull(s, FZ, place, zx, yz, zz - mean, j)
    s[PRESSURE + j] -= weight * mean
    s[ALL_WORK + j] += weight * s[WORK + j]
    s[ALL_PLASTIC + j] += weight * s[PLASTIC + j]


@fused_leaf_kernel
def begin_sums(s, j):
    """Set all sums over the points to zero, and keep the mean volume change."""
    s[SWELLING + j] = s[STRAIN[0] + j] + s[STRAIN[1] + j] + s[STRAIN[2] + j]
    # eight points leave no hourglass modes
    s[PRESSURE + j], s[ALL_WORK + j], s[ALL_PLASTIC + j], s[HOURGLASS + j] = 0.0, 0.0, 0.0, 0.0


@fused_leaf_kernel
def end_sums(s, j):
    """Write the means over the element: a stress without shear, work and plastic work."""
    share = 1.0 / s[VOLUME + j]
    mean = -share * s[PRESSURE + j]
    s[STRESS[0] + j], s[STRESS[1] + j], s[STRESS[2] + j] = mean, mean, mean
    s[STRESS[3] + j], s[STRESS[4] + j], s[STRESS[5] + j] = 0.0, 0.0, 0.0
    s[WORK + j], s[PLASTIC + j] = share * s[ALL_WORK + j], share * s[ALL_PLASTIC + j]


@fused_called_kernel
def point_forces(s, state, place, dt, solid, kind):
    """Bring one point of a chunk to the end of a step and add its forces."""
    kept = state_rows(solid)
    # a loop over the lanes for each formula: only such loops become vector loops
    for k in range(kept):
        s[HELD + k] = state[k]
    for j in range(W):
        cofactors(s, place, j)
    for j in range(W):
        point_kinematics(s, place, dt, j)
    update_stress(s, solid, kind, dt)
    for j in range(W):
        point_force(s, place, j)
    for k in range(kept):
        state[k] = s[HELD + k]


@fused_called_kernel
def chunk_forces(blocks, chunk, x, v, f, dt, viscous, s, sums):
    """Bring one chunk of elements to the end of a step and add its forces; returns its critical time step."""
    part, count, point = blocks.part[chunk], np.uint64(blocks.filled[chunk]), np.uint64(STATES) * W
    solid, kind = blocks.solids[part], blocks.kinds[part]
    linear, quadratic = viscous
    first = np.uint64(chunk) * EIGHT * point
    gather(blocks, chunk, x, v, s)
    for j in range(W):
        s[FIXED + MASS + j] = blocks.constants[np.uint64(chunk) * W + j]
        mean_motion(s, dt, j)
    for j in range(W):  # one bulk viscosity for the element, kept with its first point
        s[HELD + BEFORE + j] = blocks.state[first + BEFORE + j]
        viscosity(s, solid, dt, linear, quadratic, j)
        blocks.state[first + BEFORE + j] = s[HELD + BEFORE + j]
        begin_sums(s, j)
    for k in range(np.uint64(3) * EIGHT * W):
        s[FX[0] + k] = 0.0
    for p in range(8):
        at = first + np.uint64(p) * point
        place = POINTS[p, 0], POINTS[p, 1], POINTS[p, 2]
        point_forces(s, blocks.state[at : at + point], place, dt, solid, kind)
    for j in range(W):
        end_sums(s, j)
        critical_step(s, solid, j)
        stress_force(s, j)
    for k in range(np.uint64(7) * W):
        s[U[0] + k] += s[FX[0] + k]
        s[V[0] + k] += s[FY[0] + k]
        s[T[0] + k] += s[FZ[0] + k]
    for j in range(W):
        all_nodal_forces(s, j)
    scatter(blocks, chunk, s, f)
    return add_sums(s, count, sums)


@fused_called_kernel
def slab_forces(blocks, slabs, chosen, x, v, f, dt, viscous, s, sums):
    """Treat the chosen slabs one after another, as `_hexahedron_kernels.slab_forces` does, by eight points each."""
    least = np.inf
    for k in chosen:
        sums[k, 3] = 0.0
        for chunk in range(slabs[k, 0], slabs[k, 1]):
            least = min(least, chunk_forces(blocks, chunk, x, v, f, dt, viscous, s, sums[k]))
    return least
