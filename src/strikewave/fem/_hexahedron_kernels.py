"""Kernels of the one-point hexahedron; `strikewave.fem.hexahedron` explains them, `_layout` the rows."""

import math

import numpy as np

from strikewave.base.compiled import fused_called_kernel, fused_leaf_kernel
from strikewave.fem._layout import (
    BACK,
    BEFORE,
    CONSTANTS,
    DAMPED,
    DAMPING,
    EIGHT,
    FIVE,
    FIXED,
    FOUR,
    GX,
    GY,
    GZ,
    HELD,
    HOURGLASS,
    KINEMATIC,
    LAME,
    MASS,
    ONE,
    PLASTIC,
    SHEAR,
    SIX,
    SPEED,
    STATES,
    STEEPEST,
    STEP,
    STIFFNESS,
    STRAIN,
    STRESS,
    THREE,
    TRACE,
    TWO,
    VISCOUS,
    VOLUME,
    WORK,
    YIELDING,
    ZERO,
    T,
    U,
    V,
    W,
    X,
    Y,
    Z,
)
from strikewave.fem._solid_kernels import increments, update_stress

MIXED = 8.0 / 3.0
"""Factor of the products of linear and hourglass modes in the gradient; see `gradients`."""


@fused_leaf_kernel
def amplitudes(s, rows, j):
    """Replace eight nodal values by the amplitudes of their modes; the mean is dropped into the last row."""
    a0, a1, a2, a3 = s[rows[0] + j], s[rows[1] + j], s[rows[2] + j], s[rows[3] + j]
    a4, a5, a6, a7 = s[rows[4] + j], s[rows[5] + j], s[rows[6] + j], s[rows[7] + j]
    s01, d01, s32, d32 = a0 + a1, a1 - a0, a3 + a2, a2 - a3
    s45, d45, s76, d76 = a4 + a5, a5 - a4, a7 + a6, a6 - a7
    low, low2, low1, low12 = s01 + s32, s32 - s01, d01 + d32, d32 - d01
    top, top2, top1, top12 = s45 + s76, s76 - s45, d45 + d76, d76 - d45
    s[rows[0] + j] = 0.125 * (low1 + top1)
    s[rows[1] + j] = 0.125 * (low2 + top2)
    s[rows[2] + j] = 0.125 * (top - low)
    s[rows[3] + j] = 0.125 * (top2 - low2)
    s[rows[4] + j] = 0.125 * (top1 - low1)
    s[rows[5] + j] = 0.125 * (low12 + top12)
    s[rows[6] + j] = 0.125 * (top12 - low12)


@fused_leaf_kernel
def nodal_forces(s, rows, j):
    """Replace the forces on seven modes by the forces on eight nodes."""
    f1, f2, f3 = 0.125 * s[rows[0] + j], 0.125 * s[rows[1] + j], 0.125 * s[rows[2] + j]
    f23, f13, f12, f123 = 0.125 * s[rows[3] + j], 0.125 * s[rows[4] + j], 0.125 * s[rows[5] + j], 0.125 * s[rows[6] + j]
    low, top = -f3, f3
    low2, top2 = f2 - f23, f2 + f23
    low1, top1 = f1 - f13, f1 + f13
    low12, top12 = f12 - f123, f12 + f123
    # sums and differences in turn, as in a fast Hadamard transform: 24 additions for 56
    front, back, front1, back1 = low - low2, low + low2, low1 - low12, low1 + low12
    s[rows[0] + j], s[rows[1] + j] = front - front1, front + front1
    s[rows[3] + j], s[rows[2] + j] = back - back1, back + back1
    front, back, front1, back1 = top - top2, top + top2, top1 - top12, top1 + top12
    s[rows[4] + j], s[rows[5] + j] = front - front1, front + front1
    s[rows[7] + j], s[rows[6] + j] = back - back1, back + back1


@fused_leaf_kernel
def cross_rows(s, a, b, j):
    """Return the cross product of the modes a and b of the geometry."""
    x1, y1, z1, x2, y2, z2 = s[X[a] + j], s[Y[a] + j], s[Z[a] + j], s[X[b] + j], s[Y[b] + j], s[Z[b] + j]
    return y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, x1 * y2 - y1 * x2


@fused_leaf_kernel
def gradients(s, j):
    """Write the gradient of the volume with respect to the modes: the mean gradient of the element times its volume.

    8 (e2 x e3 + h3 x h2 / 3) and so on for e1, e2, e3; 8/3 (e3 x h2 + h3 x e2) and so on for h1, h2, h3; 0 for h4.
    """
    ax, ay, az = cross_rows(s, 1, 2, j)
    bx, by, bz = cross_rows(s, 5, 4, j)
    s[GX[0] + j], s[GY[0] + j], s[GZ[0] + j] = (8.0 * ax + MIXED * bx, 8.0 * ay + MIXED * by, 8.0 * az + MIXED * bz)
    ax, ay, az = cross_rows(s, 2, 0, j)
    bx, by, bz = cross_rows(s, 3, 5, j)
    s[GX[1] + j], s[GY[1] + j], s[GZ[1] + j] = (8.0 * ax + MIXED * bx, 8.0 * ay + MIXED * by, 8.0 * az + MIXED * bz)
    ax, ay, az = cross_rows(s, 0, 1, j)
    bx, by, bz = cross_rows(s, 4, 3, j)
    s[GX[2] + j], s[GY[2] + j], s[GZ[2] + j] = (8.0 * ax + MIXED * bx, 8.0 * ay + MIXED * by, 8.0 * az + MIXED * bz)
    ax, ay, az = cross_rows(s, 2, 4, j)
    bx, by, bz = cross_rows(s, 5, 1, j)
    s[GX[3] + j], s[GY[3] + j], s[GZ[3] + j] = (MIXED * (ax + bx), MIXED * (ay + by), MIXED * (az + bz))
    ax, ay, az = cross_rows(s, 0, 5, j)
    bx, by, bz = cross_rows(s, 3, 2, j)
    s[GX[4] + j], s[GY[4] + j], s[GZ[4] + j] = (MIXED * (ax + bx), MIXED * (ay + by), MIXED * (az + bz))
    ax, ay, az = cross_rows(s, 1, 3, j)
    bx, by, bz = cross_rows(s, 4, 0, j)
    s[GX[5] + j], s[GY[5] + j], s[GZ[5] + j] = (MIXED * (ax + bx), MIXED * (ay + by), MIXED * (az + bz))


@fused_leaf_kernel
def dot6(s, a, b, j):
    """Return the sum over the first six modes of products of two sets of rows."""
    return (
        s[a[0] + j] * s[b[0] + j]
        + s[a[1] + j] * s[b[1] + j]
        + s[a[2] + j] * s[b[2] + j]
        + s[a[3] + j] * s[b[3] + j]
        + s[a[4] + j] * s[b[4] + j]
        + s[a[5] + j] * s[b[5] + j]
    )


@fused_leaf_kernel
def kinematics(s, dt, j):
    """Write volume, and the strain and rotation increment of the mean gradient."""
    volume = (dot6(s, X, GX, j) + dot6(s, Y, GY, j) + dot6(s, Z, GZ, j)) / 3.0  # exact: it is of third degree (Euler)
    r = dt / volume
    a, b, c = r * dot6(s, U, GX, j), r * dot6(s, U, GY, j), r * dot6(s, U, GZ, j)
    d, e, f = r * dot6(s, V, GX, j), r * dot6(s, V, GY, j), r * dot6(s, V, GZ, j)
    g, h, i = r * dot6(s, T, GX, j), r * dot6(s, T, GY, j), r * dot6(s, T, GZ, j)
    s[VOLUME + j] = volume
    increments(s, (a, b, c, d, e, f, g, h, i), j)


@fused_leaf_kernel
def steepest(a, b, c):
    """Return a bound of the largest eigenvalue of a a^T + b b^T + c c^T, the largest of its terms, and its trace."""
    aa, bb = a[0] * a[0] + a[1] * a[1] + a[2] * a[2], b[0] * b[0] + b[1] * b[1] + b[2] * b[2]
    cc = c[0] * c[0] + c[1] * c[1] + c[2] * c[2]
    ab, bc = abs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]), abs(b[0] * c[0] + b[1] * c[1] + b[2] * c[2])
    ca = abs(c[0] * a[0] + c[1] * a[1] + c[2] * a[2])
    return max(aa + ab + ca, bb + ab + bc, cc + bc + ca), max(aa, bb, cc), aa + bb + cc


@fused_leaf_kernel
def stress_force(s, j):
    """Write the forces of stress and viscosity on the modes: minus stress times gradient."""
    q = s[VISCOUS + j]
    xx, yy, zz = q - s[STRESS[0] + j], q - s[STRESS[1] + j], q - s[STRESS[2] + j]
    xy, yz, zx = -s[STRESS[3] + j], -s[STRESS[4] + j], -s[STRESS[5] + j]
    for m in range(SIX):
        row = m * W + j
        gx, gy, gz = s[GX[0] + row], s[GY[0] + row], s[GZ[0] + row]
        s[U[0] + row] = xx * gx + xy * gy + zx * gz
        s[V[0] + row] = xy * gx + yy * gy + yz * gz
        s[T[0] + row] = zx * gx + yz * gy + zz * gz
    s[U[6] + j], s[V[6] + j], s[T[6] + j] = 0.0, 0.0, 0.0


@fused_leaf_kernel
def weighted(s, a, c, j):
    """Return the sum of six modes in rows from a on, weighted by rows from c on."""
    return (
        s[a + j] * s[c + j]
        + s[a + W + j] * s[c + W + j]
        + s[a + TWO * W + j] * s[c + TWO * W + j]
        + s[a + THREE * W + j] * s[c + THREE * W + j]
        + s[a + FOUR * W + j] * s[c + FOUR * W + j]
        + s[a + FIVE * W + j] * s[c + FIVE * W + j]
    )


@fused_leaf_kernel
def subtract(s, a, c, q, j):
    """Take q times six rows from c on off the rows from a on."""
    s[a + j] -= q * s[c + j]
    s[a + W + j] -= q * s[c + W + j]
    s[a + TWO * W + j] -= q * s[c + TWO * W + j]
    s[a + THREE * W + j] -= q * s[c + THREE * W + j]
    s[a + FOUR * W + j] -= q * s[c + FOUR * W + j]
    s[a + FIVE * W + j] -= q * s[c + FIVE * W + j]


@fused_leaf_kernel
def hourglass_force(s, n, j):
    """Add the forces of hourglass mode n (0 to 3) on the modes, and its energy.

    q = h + sum of c_m x_m over the six other modes is what is left of a mode h when the motion that is linear over the
    first shape is taken off it; its energy is 8 k q^2 / (1 + r), its force 8 k q / r, r = sqrt(1 + q^2 / q_y^2).
    """
    own, row = (n + THREE) * W + j, FIXED + n * SIX * W
    qx = s[X[0] + own] + weighted(s, X[0], row, j)
    qy = s[Y[0] + own] + weighted(s, Y[0], row, j)
    qz = s[Z[0] + own] + weighted(s, Z[0], row, j)
    square = qx * qx + qy * qy + qz * qz
    # beyond q_y the stiffness falls as that of a yielding element does, or a bent plastic part would be too stiff
    root = math.sqrt(1.0 + s[FIXED + YIELDING + j] * square)
    both = 8.0 * s[FIXED + STIFFNESS + j] / (root * (1.0 + root))  # one quotient for two: they take long
    s[HOURGLASS + j] += both * root * square
    k = both * (1.0 + root)
    qx, qy, qz = k * qx, k * qy, k * qz
    s[U[0] + own] -= qx
    s[V[0] + own] -= qy
    s[T[0] + own] -= qz
    subtract(s, U[0], row, qx, j)
    subtract(s, V[0], row, qy, j)
    subtract(s, T[0], row, qz, j)


@fused_leaf_kernel
def take_node(field, n, s, place):
    """Copy a vector of a node into three fields of the scratch."""
    s[place], s[place + EIGHT * W], s[place + TWO * EIGHT * W] = field[n, 0], field[n, 1], field[n, 2]


@fused_leaf_kernel
def take_four_nodes(field, nodes, first, s, place):
    """Copy vectors of four nodes: a row then takes one store of four numbers, where four stores would wait in turn."""
    a, b = np.uint64(nodes[first]), np.uint64(nodes[first + ONE])
    c, d = np.uint64(nodes[first + TWO]), np.uint64(nodes[first + THREE])
    for k in range(3):
        row = place + np.uint64(k) * EIGHT * W
        s[row], s[row + ONE], s[row + TWO], s[row + THREE] = field[a, k], field[b, k], field[c, k], field[d, k]


@fused_leaf_kernel
def gather(blocks, chunk, x, v, s):
    """Copy positions and velocities of the nodes of a chunk into the scratch."""
    first = np.uint64(chunk) * EIGHT * W
    for four in range(TWO * W):
        place = FOUR * four
        take_four_nodes(x, blocks.nodes, first + place, s, X[0] + place)
        take_four_nodes(v, blocks.nodes, first + place, s, U[0] + place)


@fused_leaf_kernel
def scatter(blocks, chunk, s, f):
    """Add the forces of a chunk to those of its nodes."""
    first = np.uint64(chunk) * EIGHT * W
    count = np.uint64(blocks.filled[chunk])
    for k in range(EIGHT):
        row = k * W
        for j in range(count):  # lanes beyond repeat the last element, and must not count twice
            n = np.uint64(blocks.nodes[first + row + j])
            f[n, 0] += s[U[0] + row + j]
            f[n, 1] += s[V[0] + row + j]
            f[n, 2] += s[T[0] + row + j]


@fused_leaf_kernel
def viscosity(s, solid, dt, linear, quadratic, j):
    """Write the pressure of the bulk viscosity, -rho l (q1 c - q2 l min(r, 0)) r, and what the critical step needs.

    Its work is what the mean of the pressures before and after does.
    """
    volume, mass = s[VOLUME + j], s[FIXED + MASS + j]
    p = s[GX[0] + j], s[GY[0] + j], s[GZ[0] + j]
    q = s[GX[1] + j], s[GY[1] + j], s[GZ[1] + j]
    r = s[GX[2] + j], s[GY[2] + j], s[GZ[2] + j]
    largest, longest, straight = steepest(p, q, r)
    trace = dot6(s, GX, GX, j) + dot6(s, GY, GY, j) + dot6(s, GZ, GZ, j)
    thickness = 2.0 * volume / math.sqrt(longest)  # between opposite faces, by the steepest of the three gradients
    swelling = s[STRAIN[0] + j] + s[STRAIN[1] + j] + s[STRAIN[2] + j]
    rate = swelling / dt
    squeezed = min(rate, 0.0)  # the quadratic part spreads shock fronts, which compress: it leaves expansion alone
    damping = thickness * (linear * solid[SPEED] - quadratic * thickness * squeezed)
    pressure = -(mass / volume) * damping * rate
    s[DAMPED + j] = -0.5 * (s[HELD + BEFORE + j] + pressure) * swelling  # by the mean of both pressures, as all works
    s[VISCOUS + j], s[HELD + BEFORE + j] = pressure, pressure
    s[STEEPEST + j] = (largest + trace - straight) / volume
    s[TRACE + j] = trace / volume
    s[DAMPING + j] = damping * trace / (volume * volume)


@fused_leaf_kernel
def critical_step(s, solid, j):
    """Write the critical step 4 / (d + sqrt(d^2 + 4 w)), w = (2 G a + lambda b) / m, d that of the bulk viscosity.

    a V bounds the largest eigenvalue of the sum of g g^T over the modes, b V is its trace. The step is 0 where
    the element is turned inside out, or a number is not finite.
    """
    square = (2.0 * solid[SHEAR] * s[STEEPEST + j] + solid[LAME] * s[TRACE + j]) / s[FIXED + MASS + j]
    damping = s[DAMPING + j]
    # viscosity shortens the step of central differences
    step = 4.0 / (damping + math.sqrt(damping * damping + 4.0 * square))
    s[STEP + j] = step if s[VOLUME + j] > 0.0 and step > 0.0 else 0.0


@fused_leaf_kernel
def mean_motion(s, dt, j):
    """Turn what the nodes have into modes, and write what the mean gradient gives: see `kinematics`."""
    for row in (X, Y, Z, U, V, T):
        amplitudes(s, row, j)
    gradients(s, j)
    kinematics(s, dt, j)


@fused_leaf_kernel
def hourglass_forces(s, j):
    """Add the forces of all hourglass modes on the modes, and write their energy."""
    s[HOURGLASS + j] = 0.0
    for n in (ZERO, ONE, TWO, THREE):
        hourglass_force(s, n, j)


@fused_leaf_kernel
def all_nodal_forces(s, j):
    """Turn the forces on the modes into those on the nodes."""
    for row in (U, V, T):
        nodal_forces(s, row, j)


@fused_leaf_kernel
def work_share(s, j):
    """Return the volume in the middle of the step, which works per volume are multiplied by."""
    # strain is over the shape in the middle of the step, and so must be the volume
    return s[VOLUME + j] * (1.0 - 0.5 * (s[STRAIN[0] + j] + s[STRAIN[1] + j] + s[STRAIN[2] + j]))


@fused_leaf_kernel
def state_rows(solid):
    """Return how many numbers of the state a chunk of a solid needs: those before the back stress, unless it moves."""
    return np.uint64(STATES) * W if solid[KINEMATIC] > 0.0 else BACK[0]


@fused_called_kernel
def chunk_forces(blocks, chunk, x, v, f, dt, viscous, s, sums):
    """Bring one chunk of elements to the end of a step and add its forces; returns its critical time step."""
    at, fixed = np.uint64(chunk) * np.uint64(STATES) * W, np.uint64(chunk) * np.uint64(CONSTANTS) * W
    part = blocks.part[chunk]
    solid, kind = blocks.solids[part], blocks.kinds[part]
    kept, count = state_rows(solid), np.uint64(blocks.filled[chunk])
    linear, quadratic = viscous
    gather(blocks, chunk, x, v, s)
    # Constants and state stand in the scratch with all else: the loops below run over one array.
    for k in range(np.uint64(CONSTANTS) * W):
        s[FIXED + k] = blocks.constants[fixed + k]
    for k in range(kept):
        s[HELD + k] = blocks.state[at + k]
    for j in range(W):
        mean_motion(s, dt, j)
    for j in range(W):
        viscosity(s, solid, dt, linear, quadratic, j)
        critical_step(s, solid, j)
    update_stress(s, solid, kind, dt)
    for j in range(W):
        stress_force(s, j)
        hourglass_forces(s, j)
        all_nodal_forces(s, j)
    scatter(blocks, chunk, s, f)
    for k in range(kept):
        blocks.state[at + k] = s[HELD + k]
    return add_sums(s, count, sums)


@fused_leaf_kernel
def add_sums(s, count, sums):
    """Add the work of a chunk to the sums of its slab; returns its critical time step."""
    least = np.inf
    for j in range(count):
        middle = work_share(s, j)
        sums[0] += middle * s[WORK + j]
        sums[1] += middle * s[PLASTIC + j]
        sums[2] += middle * s[DAMPED + j]
        sums[3] += s[HOURGLASS + j]
        least = min(least, s[STEP + j])
    return least


@fused_called_kernel
def slab_forces(blocks, slabs, chosen, x, v, f, dt, viscous, s, sums):
    """Treat the chosen slabs one after another; returns the smallest critical time step among them.

    ``slabs`` holds first and last chunk (exclusive) of each; row k of ``sums`` gets the sums of slab k: work is added,
    the hourglass energy is that of now.
    """
    least = np.inf
    for k in chosen:
        sums[k, 3] = 0.0  # an energy held now, where the others are works, which add up
        for chunk in range(slabs[k, 0], slabs[k, 1]):
            least = min(least, chunk_forces(blocks, chunk, x, v, f, dt, viscous, s, sums[k]))
    return least
