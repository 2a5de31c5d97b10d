"""Bodies of the threads of a device: one element, node or row each, by the formulas of the processor's loops.

Numba compiles for a device what it is called by a kernel there; the formulas themselves are those of
`strikewave.fem`, compiled from the same functions. An element has a scratch of its own, laid out as that of a chunk, in
lane 0: every place in it is a constant, so that it lies in registers, and rows that are not used cost nothing.

A sum over elements or contacts is taken by the node that it belongs to, in an order that a table fixes: it is the same
in every run.

In a search of faces those of the same surface stand in groups of consecutive ones, which in a mesh are neighbours, and
a group has a box about those of its faces: a node that is not in it is in none of them.
"""

from typing import NamedTuple

import numpy as np

from strikewave.base.compiled import fused_leaf_kernel, leaf_kernel
from strikewave.fem._full_kernels import POINTS, begin_sums, cofactors, end_sums, point_force, point_kinematics
from strikewave.fem._hexahedron_kernels import (
    all_nodal_forces,
    critical_step,
    hourglass_forces,
    mean_motion,
    stress_force,
    take_node,
    viscosity,
    work_share,
)
from strikewave.fem._history_kernels import ROWS as SHARE
from strikewave.fem._layout import (
    BACK,
    BEFORE,
    CONSTANTS,
    DAMPED,
    EIGHT,
    FIXED,
    FX,
    FY,
    FZ,
    HELD,
    HOURGLASS,
    KINEMATIC,
    LANES,
    MASS,
    PLASTIC,
    SIX,
    STATES,
    STEP,
    SUMS,
    WORK,
    ZERO,
    T,
    U,
    V,
    W,
    X,
)
from strikewave.fem._node_kernels import face_shares, move_tied_node
from strikewave.fem._solid_kernels import stress_of_one
from strikewave.fem._surface_kernels import face_box, face_extent, in_box

ROWS, KEPT, SEVEN, THREE_FIELDS = np.uint64(CONSTANTS), np.uint64(9), np.uint64(7), np.uint64(24)
"""Rows of constants; of the state without a back stress; of modes with a force; of forces on modes of three fields."""


class ElementResults(NamedTuple):
    """Results of elements for the nodes and for the balance.

    Forces on corners (3, chunks * 8 * LANES), sums of work (SUMS, chunks * LANES), critical step (chunks * LANES).
    """

    corner: np.ndarray
    works: np.ndarray
    step: np.ndarray


@fused_leaf_kernel
def take_nodes(blocks, chunk, lane, x, v, s):
    """Copy positions and velocities of the nodes of an element into the scratch."""
    for k in range(EIGHT):
        place = k * W
        n = np.uint64(blocks.nodes[chunk * EIGHT * W + place + lane])
        take_node(x, n, s, X[0] + place)
        take_node(v, n, s, U[0] + place)


@fused_leaf_kernel
def take_state(state, at, moving, s):
    """Copy the state of a point into the scratch; its back stress only where the yield surface moves."""
    for k in range(KEPT):
        s[HELD + k * W] = state[at + k * W]
    if moving:  # six numbers of fifteen, which most solids never use
        for k in range(SIX):
            s[HELD + BACK[0] + k * W] = state[at + BACK[0] + k * W]


@fused_leaf_kernel
def keep_state(state, at, moving, s):
    """Copy the state of a point back."""
    for k in range(KEPT):
        state[at + k * W] = s[HELD + k * W]
    if moving:
        for k in range(SIX):
            state[at + BACK[0] + k * W] = s[HELD + BACK[0] + k * W]


@fused_leaf_kernel
def leave_results(blocks, results, chunk, lane, s):
    """Write the results of an element: works are added, the hourglass energy is that of now.

    Lanes beyond those that are filled repeat the last element, and leave nothing.
    """
    if lane >= np.uint64(blocks.filled[chunk]):
        return
    for k in range(EIGHT):
        place = chunk * EIGHT * W + k * W + lane
        results.corner[0, place] = s[U[0] + k * W]
        results.corner[1, place] = s[V[0] + k * W]
        results.corner[2, place] = s[T[0] + k * W]
    element, middle = chunk * W + lane, work_share(s, ZERO)
    results.works[0, element] += middle * s[WORK]
    results.works[1, element] += middle * s[PLASTIC]
    results.works[2, element] += middle * s[DAMPED]
    results.works[3, element] = s[HOURGLASS]
    results.step[element] = s[STEP]


@fused_leaf_kernel
def one_point_element(i, s, blocks, x, v, dt, viscous, results):
    """Bring an element of one point to the end of a step, as `_hexahedron_kernels.chunk_forces` does for a chunk."""
    chunk, lane = np.uint64(i) // W, np.uint64(i) % W
    part = blocks.part[chunk]
    solid, kind = blocks.solids[part], blocks.kinds[part]
    at, moving = chunk * np.uint64(STATES) * W + lane, solid[KINEMATIC] > 0.0
    take_nodes(blocks, chunk, lane, x, v, s)
    for k in range(ROWS):
        s[FIXED + k * W] = blocks.constants[chunk * ROWS * W + k * W + lane]
    take_state(blocks.state, at, moving, s)
    mean_motion(s, dt, ZERO)
    viscosity(s, solid, dt, viscous[0], viscous[1], ZERO)
    critical_step(s, solid, ZERO)
    stress_of_one(s, solid, kind, dt, ZERO)
    stress_force(s, ZERO)
    hourglass_forces(s, ZERO)
    all_nodal_forces(s, ZERO)
    keep_state(blocks.state, at, moving, s)
    leave_results(blocks, results, chunk, lane, s)


@fused_leaf_kernel
def full_element(i, s, blocks, x, v, dt, viscous, results):
    """Bring a fully integrated element to the end of a step, as `_full_kernels.chunk_forces` does for a chunk."""
    chunk, lane = np.uint64(i) // W, np.uint64(i) % W
    part = blocks.part[chunk]
    solid, kind = blocks.solids[part], blocks.kinds[part]
    point, moving = np.uint64(STATES) * W, solid[KINEMATIC] > 0.0
    first = chunk * EIGHT * point + lane
    take_nodes(blocks, chunk, lane, x, v, s)
    s[FIXED + MASS] = blocks.constants[chunk * W + lane]
    mean_motion(s, dt, ZERO)
    s[HELD + BEFORE] = blocks.state[first + BEFORE]
    viscosity(s, solid, dt, viscous[0], viscous[1], ZERO)
    blocks.state[first + BEFORE] = s[HELD + BEFORE]
    begin_sums(s, ZERO)
    for k in range(THREE_FIELDS):
        s[FX[0] + k * W] = 0.0
    for p in range(8):
        at = first + np.uint64(p) * point
        place = POINTS[p, 0], POINTS[p, 1], POINTS[p, 2]
        take_state(blocks.state, at, moving, s)
        cofactors(s, place, ZERO)
        point_kinematics(s, place, dt, ZERO)
        stress_of_one(s, solid, kind, dt, ZERO)
        point_force(s, place, ZERO)
        keep_state(blocks.state, at, moving, s)
    end_sums(s, ZERO)
    critical_step(s, solid, ZERO)
    stress_force(s, ZERO)
    for k in range(SEVEN):
        s[U[0] + k * W] += s[FX[0] + k * W]
        s[V[0] + k * W] += s[FY[0] + k * W]
        s[T[0] + k * W] += s[FZ[0] + k * W]
    all_nodal_forces(s, ZERO)
    leave_results(blocks, results, chunk, lane, s)


@leaf_kernel
def gather_node(n, start, places, corner, f):
    """Add to the force on a node those on its corners of elements, at places[start[n] : start[n + 1]]."""
    for c in range(3):
        total = 0.0  # by the node, not added by the elements: the order of a sum is then that of the table
        for k in range(start[n], start[n + 1]):
            total += corner[c, places[k]]
        f[n, c] += total


@leaf_kernel
def pressed_node(i, nodes, start, places, faces, pressure, x, force, f):
    """Write and add what a pressure does at a node, which is corner place % 4 of face place // 4 for its places."""
    for c in range(3):
        total = 0.0
        for k in range(start[i], start[i + 1]):
            face, corner = places[k] // 4, places[k] % 4
            even, one, two = face_shares(x, faces[face, 0], faces[face, 1], faces[face, 2], faces[face, 3], c)
            xi = 1.0 if corner == 1 or corner == 2 else -1.0
            eta = 1.0 if corner > 1 else -1.0
            total -= pressure * (even + xi * one + eta * two)
        force[i, c] = total
        f[nodes[i], c] += total


@leaf_kernel
def tied_corner(i, corners, start, places, ties, f):
    """Add to the force on a corner that of the tied nodes of its faces, at places = 4 node + corner, ascending."""
    for k in range(start[i], start[i + 1]):
        tied, corner = places[k] // 4, places[k] % 4
        for c in range(3):
            f[corners[i], c] += ties.shape[tied, corner] * f[ties.nodes[tied], c]


@leaf_kernel
def clear_row(i, nodes, f):
    """Leave nothing at a node."""
    for c in range(3):
        f[nodes[i], c] = 0.0


@leaf_kernel
def follow_node(i, ties, x, v, dt):
    """Bring a tied node to the end of a step with its face."""
    move_tied_node(i, ties, v)
    for c in range(3):
        x[ties.nodes[i], c] += dt * v[ties.nodes[i], c]


@leaf_kernel
def join_row(i, force, first):
    """Add the row of a first force to that of a second."""
    for c in range(3):
        force[i, c] += first[i, c]


@leaf_kernel
def copy_row(i, force, first):
    """Copy the row of a force."""
    for c in range(3):
        first[i, c] = force[i, c]


@leaf_kernel
def book_row(i, nodes, force, before, v, kick, done):
    """Add work and impulse of a force in a step; see `_node_kernels.work_and_impulse`."""
    work = 0.0
    for c in range(3):
        work += 0.5 * force[i, c] * (before[i, c] + v[nodes[i], c])
        done[i, 1 + c] += kick * force[i, c]
    done[i, 0] += kick * work


@leaf_kernel
def book_touch(i, touch, v, kick, done):
    """Add the energy that contact took at a node, and its impulse on the first surface; see `contact_work`."""
    work = 0.0
    for c in range(3):
        force = touch.normal[i, c] + touch.friction[i, c]
        work -= 0.5 * force * (touch.velocity[i, c] + v[touch.nodes[i], c])
        if i < touch.first:
            done[i, 1 + c] += kick * force
    done[i, 0] += kick * work


@leaf_kernel
def collect_node(n, state, start, sources, f):
    """Add to f the contact force on a node: that of its own contact, and what others press on the corner that it is.

    ``sources[start[n] : start[n + 1]]`` are the nodes that may meet a face of which it is a corner, ascending, so that
    the order of the sums is that of `_contact_kernels.scatter_forces`.
    """
    touch, nodal = state.touch, state.nodal
    first = n < touch.first
    own = nodal.touches[n] != 0
    for c in range(3):
        normal = nodal.normal_force[n, c] if own and first else 0.0
        friction = nodal.friction_force[n, c] if own and first else 0.0
        for k in range(start[n], start[n + 1]):
            i = sources[k]
            if nodal.touches[i] == 0:
                continue
            for corner in range(4):
                if state.faces[nodal.face[i], corner] == n:
                    normal -= nodal.shape[i, corner] * nodal.normal_force[i, c]
                    friction -= nodal.shape[i, corner] * nodal.friction_force[i, c]
        if own and not first:
            normal += nodal.normal_force[n, c]
            friction += nodal.friction_force[n, c]
        touch.normal[n, c], touch.friction[n, c] = normal, friction
        f[touch.nodes[n], c] += normal + friction


@leaf_kernel
def drain_share(k, done, sums):
    """Write the sums over the rows of a share of what was done, (shares, DONE), and begin anew."""
    for c in range(sums.shape[1]):
        total = 0.0
        for i in range(k * SHARE, min((k + 1) * SHARE, done.shape[0])):
            total += done[i, c]
            done[i, c] = 0.0
        sums[k, c] = total


@leaf_kernel
def acting_share(k, force, before, sums):
    """Write power and sum of the forces of a share, (shares, DONE); see `strikewave.fem.boundary.Acting.now`."""
    power, x, y, z = 0.0, 0.0, 0.0, 0.0
    for i in range(k * SHARE, min((k + 1) * SHARE, force.shape[0])):
        for c in range(3):
            power += force[i, c] * before[i, c]
        x, y, z = x + force[i, 0], y + force[i, 1], z + force[i, 2]
    sums[k, 0], sums[k, 1], sums[k, 2], sums[k, 3] = power, x, y, z


@leaf_kernel
def drain_chunk(chunk, works, sums):
    """Write the sums over a chunk, (chunks, SUMS); what was summed over steps, all but the last, begins anew."""
    for row in range(SUMS):
        total = 0.0
        for lane in range(LANES):
            total += works[row, chunk * LANES + lane]
            if row < SUMS - 1:
                works[row, chunk * LANES + lane] = 0.0
        sums[chunk, row] = total


@leaf_kernel
def take_stress(i, places, state, stress):
    """Copy the stress that stands at six places."""
    for c in range(6):
        stress[i, c] = state[places[i, c]]


@leaf_kernel
def note_travel(i, state, travel):
    """Note how much closer nodes may have come since the last search."""
    state.travel[i] = travel


class FaceGroups(NamedTuple):
    """Boxes of faces (faces, 6) and of groups (groups, 6), least before greatest coordinates.

    Group g holds the faces ``edges[g]`` to ``edges[g + 1]``, exclusive; the ``first`` so many are of the first surface.
    """

    edges: np.ndarray
    boxes: np.ndarray
    bounds: np.ndarray
    first: int


@leaf_kernel
def survey_face(face, state, share, boxes, area):
    """Write area, size, radius and box of a face as it lies; the box is wider by a share of the size and the margin."""
    area[face] = face_extent(face, state.place, state.faces, state.size, state.radius)
    state.radius[face] += state.margin
    face_box(face, state.place, state.faces, share * state.size[face] + state.margin, boxes)


@leaf_kernel
def survey_node(n, state, start, places, area):
    """Write the area of a node, a corner of faces at places = 4 face + corner, ascending; forget that it is clear."""
    total = 0.0
    for k in range(start[n], start[n + 1]):
        total += 0.25 * area[places[k] // 4]
    state.touch.area[n] = total
    state.nodal.clear[n] = 0.0


@leaf_kernel
def bound_group(g, groups):
    """Write the box of a group."""
    for c in range(3):
        low, high = np.inf, -np.inf
        for face in range(groups.edges[g], groups.edges[g + 1]):
            low, high = min(low, groups.boxes[face, c]), max(high, groups.boxes[face, 3 + c])
        groups.bounds[g, c], groups.bounds[g, 3 + c] = low, high


@leaf_kernel
def count_near(n, state, groups, count):
    """Write how many faces of the other surface have a node in their boxes."""
    count[n] = list_near(n, state, groups, 0, False, state.candidates)


@leaf_kernel
def fill_near(n, state, groups, start, candidates):
    """Write these faces, ascending, from start[n] on."""
    list_near(n, state, groups, start[n], True, candidates)


@leaf_kernel
def list_near(n, state, groups, at, filling, candidates):
    """Count, or fill in from a place on, the faces near a node; return the place after the last."""
    if not state.checked[n]:
        return at
    first, last = (groups.first, groups.bounds.shape[0]) if n < state.touch.first else (0, groups.first)
    for g in range(first, last):
        if not in_box(state.place, n, groups.bounds, g):
            continue
        for face in range(groups.edges[g], groups.edges[g + 1]):
            if in_box(state.place, n, groups.boxes, face):
                if filling:
                    candidates[at] = face
                at += 1
    return at
