"""Kernels of what histories note (`strikewave.fem.recorder`): sums over nodes and contacts, extremes of elements.

A share is a run of `ROWS` rows, of which each has sums of its own: a thread of a device takes one, and the order of the
sums is the same on the processor.
"""

from typing import NamedTuple

import numpy as np

from strikewave.base.compiled import fused_called_kernel, fused_leaf_kernel
from strikewave.fem._layout import LANES, SIGMA, STATES, STRAIN_P

ROWS = 64
"""Rows of a share: few, so that a device has threads enough; many, so that hardly anything is left to sum."""
TOUCHED = 10
"""Numbers of a share of a contact: see `touch_share`."""
POINT = STATES * LANES
"""Numbers of the state of a point of a chunk."""
STRESS, PLASTIC = tuple(int(row) for row in SIGMA), int(STRAIN_P)
"""Places of the stress and the plastic strain of its first element there."""


def shares_of(count: int) -> int:
    """Return the number of shares in which so many rows are summed."""
    return -(-count // ROWS)


class WatchedNodes(NamedTuple):
    """Groups of nodes whose weighted sums are noted; share k has the rows ``begin[k] : begin[k + 1]``."""

    begin: np.ndarray
    nodes: np.ndarray
    weights: np.ndarray


@fused_leaf_kernel
def velocity_of(n, v, f, inverse_mass, half, now):
    """Write the velocity of a node at t_n, half a step after that of v; a tied one has no inverse mass, and follows."""
    for c in range(3):
        now[n, c] = v[n, c] + half * inverse_mass[n] * f[n, c]


@fused_called_kernel
def velocities(v, f, inverse_mass, half, now):
    """Write the velocities of all nodes at t_n: see `velocity_of`."""
    for n in range(inverse_mass.size):
        velocity_of(n, v, f, inverse_mass, half, now)


@fused_leaf_kernel
def watch_share(k, watched, points, x, now, sums):
    """Write the weighted sums of displacement and velocity over a share, (shares, 6)."""
    ux, uy, uz, vx, vy, vz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(watched.begin[k], watched.begin[k + 1]):
        n, w = watched.nodes[i], watched.weights[i]
        ux += w * (x[n, 0] - points[n, 0])
        uy += w * (x[n, 1] - points[n, 1])
        uz += w * (x[n, 2] - points[n, 2])
        vx, vy, vz = vx + w * now[n, 0], vy + w * now[n, 1], vz + w * now[n, 2]
    sums[k, 0], sums[k, 1], sums[k, 2] = ux, uy, uz
    sums[k, 3], sums[k, 4], sums[k, 5] = vx, vy, vz


@fused_called_kernel
def watch(watched, points, x, now, sums):
    """Write the sums of all shares: see `watch_share`."""
    for k in range(sums.shape[0]):
        watch_share(k, watched, points, x, now, sums)


@fused_leaf_kernel
def kinetic_share(k, v, f, mass, inverse_mass, dt_previous, dt_next, sums):
    """Write twice the kinetic energy at t_n, as central differences conserve it, of the nodes of a share, (shares,).

    v is at t_(n-1/2), a = f/m: m (v_n^2 - dt_previous dt_next a^2 / 4) is m v_(n-1/2) . v_(n+1/2) for equal steps.
    """
    total = 0.0
    for n in range(k * ROWS, min((k + 1) * ROWS, mass.size)):
        square = 0.0
        for c in range(3):
            a = f[n, c] * inverse_mass[n]
            now = v[n, c] + 0.5 * dt_previous * a  # at t_n, half a step after the velocity
            square += now * now - 0.25 * dt_previous * dt_next * a * a
        total += mass[n] * square
    sums[k] = total


@fused_called_kernel
def kinetic(v, f, mass, inverse_mass, dt_previous, dt_next, sums):
    """Write the sums of all shares: see `kinetic_share`."""
    for k in range(sums.size):
        kinetic_share(k, v, f, mass, inverse_mass, dt_previous, dt_next, sums)


@fused_leaf_kernel
def squared_von_mises(xx, yy, zz, xy, yz, zx):
    """Return 3/2 s : s, s the deviator of a stress."""
    return 0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * (xy * xy + yz * yz + zx * zx)


@fused_leaf_kernel
def mean_of(state, first, points):
    """Return the mean over the points of an element of the row that begins, for the first of them, at a place."""
    total = 0.0
    for p in range(points):
        total += state[first + p * POINT]
    return total / points


@fused_leaf_kernel
def peak_of_chunk(chunk, state, filled, points, peaks):
    """Write the largest squared von Mises stress and plastic strain of the elements of a chunk, (chunks, 2).

    Of an element they are those of the means over its points. What is not a number is the largest.
    """
    stress, strain = 0.0, 0.0
    for lane in range(filled[chunk]):
        at = chunk * points * POINT + lane
        square = squared_von_mises(
            mean_of(state, at + STRESS[0], points),
            mean_of(state, at + STRESS[1], points),
            mean_of(state, at + STRESS[2], points),
            mean_of(state, at + STRESS[3], points),
            mean_of(state, at + STRESS[4], points),
            mean_of(state, at + STRESS[5], points),
        )
        plastic = mean_of(state, at + PLASTIC, points)
        if not square <= stress:  # true of a NaN too, so that it shows
            stress = square
        if not plastic <= strain:
            strain = plastic
    peaks[chunk, 0], peaks[chunk, 1] = stress, strain


@fused_called_kernel
def peaks_of_chunks(state, filled, points, peaks):
    """Write those of all chunks: see `peak_of_chunk`."""
    for chunk in range(filled.size):
        peak_of_chunk(chunk, state, filled, points, peaks)


@fused_leaf_kernel
def touch_share(k, touch, sums):
    """Write what a share of the nodes of a contact feels, (shares, TOUCHED).

    The force on those of the first surface (3), the power of all forces on the velocities before the step, and of the
    first and of the second surface the area, the area under pressure, and the largest area of a node under pressure.
    """
    for c in range(TOUCHED):
        sums[k, c] = 0.0
    for i in range(k * ROWS, min((k + 1) * ROWS, touch.nodes.size)):
        under = False
        for c in range(3):
            force = touch.normal[i, c] + touch.friction[i, c]
            if i < touch.first:
                sums[k, c] += force
            sums[k, 3] += force * touch.velocity[i, c]  # at the velocity before the step, in which the force was found
            under = under or touch.normal[i, c] != 0.0
        own = 4 if i < touch.first else 7
        sums[k, own] += touch.area[i]
        if under:
            sums[k, own + 1] += touch.area[i]
            sums[k, own + 2] = max(sums[k, own + 2], touch.area[i])


@fused_called_kernel
def touches(touch, sums):
    """Write what all shares feel: see `touch_share`."""
    for k in range(sums.shape[0]):
        touch_share(k, touch, sums)
