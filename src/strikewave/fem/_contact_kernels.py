"""Compiled contact of two surfaces; `strikewave.fem.contact` explains the law.

Both surfaces stand in one table of nodes and one of faces, those of the first before those of the second, and every
node is checked against the faces of the other surface. What a node finds depends on the motion before the contact
alone, so that nodes can be taken in any order, by any number of threads; `scatter_forces` then adds up the forces on a
surface in the order of the nodes.
"""

import math
from typing import NamedTuple

import numpy as np

from strikewave.base.compiled import called_kernel, kernel, leaf_kernel
from strikewave.fem._history_kernels import ROWS
from strikewave.fem._surface_kernels import (
    add_scaled,
    apart,
    as_tuple,
    closest_point,
    cross,
    dot,
    first_guess,
    foot_of,
    is_beyond,
    middle_of,
    on_rim,
    patch,
    row,
    scaled,
    shape_functions,
    store,
)

_TINY = 1e-300
"""Keeps a division by zero out; no length of a mesh, nor its square, is as small."""


class NodeTouch(NamedTuple):
    """Nodes that may touch: their numbers, areas (m^2), velocity before the step, normal force and friction on them.

    The ``first`` so many belong to the first surface; ``step[0]`` is the time step before, s. ``held`` (nodes, 3, 3) is
    the sum of d d^T over the orthonormal directions d that boundaries hold.
    """

    nodes: np.ndarray
    first: int
    area: np.ndarray
    held: np.ndarray
    velocity: np.ndarray
    normal: np.ndarray
    friction: np.ndarray
    step: np.ndarray


class Step(NamedTuple):
    """The step dt of positions, that of velocities, how much closer nodes come, what share of depths is kept."""

    dt: float
    kick: float
    travel: float
    kept: float


class WallState(NamedTuple):
    """Nodes before a rigid plane, given by a point and its unit normal."""

    touch: NodeTouch
    offset: np.ndarray
    point: np.ndarray
    direction: np.ndarray
    stiffness: float
    coefficient: float


@leaf_kernel
def free_fraction(touch, i, n):
    """Return the share of a motion along n, |n| = 1, that boundaries leave to node i."""
    held = touch.held[i]
    # 0 by rounding may be below it
    return max(1.0 - n[0] * dot(row(held, 0), n) - n[1] * dot(row(held, 1), n) - n[2] * dot(row(held, 2), n), 0.0)


@leaf_kernel
def coulomb_force(slide, hold, most):
    """Return Coulomb's force: what would stop the sliding, ``hold`` times its velocity; at most ``most``."""
    speed = math.sqrt(dot(slide, slide))
    return scaled(slide, -min(hold, most / speed)) if speed > 0.0 else (0.0, 0.0, 0.0)


@leaf_kernel
def along(slide):
    """Return a vector's direction, of a vector of zeros zeros."""
    return scaled(slide, 1.0 / max(math.sqrt(dot(slide, slide)), _TINY))


@leaf_kernel
def kept_depth(touch, dt):
    """Return the share of their depth that touching nodes keep as the step changes; note the step.

    The stiffness grows with 1/dt^2: a depth that shrinks with dt holds the energy it held.
    """
    before = touch.step[0]
    touch.step[0] = dt
    return dt / before if dt < before else 1.0  # a step that grows leaves depths alone: they then hold less, never more


@leaf_kernel
def moved_offset(offset, gap, before, kept):
    """Return the gap from which depth is measured, for the gap at the beginning of the step and the one to come."""
    if before < offset:
        offset -= (1.0 - kept) * (offset - before)
    return max(offset, min(gap, 0.0))  # a node that comes out takes the offset along, up to the surface


@leaf_kernel
def wall_node(i, state, x, v, f, inverse_mass, step):
    """Add the force of a rigid plane on a node to the nodal forces."""
    touch = state.touch
    direction, point = as_tuple(state.direction), as_tuple(state.point)
    n = touch.nodes[i]
    store(touch.velocity, i, row(v, n))
    moving = add_scaled(row(v, n), step.kick * inverse_mass[n], row(f, n))
    gap = dot(add_scaled(add_scaled(row(x, n), step.dt, moving), -1.0, point), direction)
    state.offset[i] = moved_offset(state.offset[i], gap, gap - step.dt * dot(moving, direction), step.kept)
    depth = state.offset[i] - gap
    normal_force, friction_force = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    inverse = inverse_mass[n] * free_fraction(touch, i, direction)
    if depth > 0.0 and inverse > 0.0:  # a node that is held along the normal cannot be pressed out
        force = state.stiffness / (inverse * step.kick) * depth / step.dt
        normal_force = scaled(direction, force)
        slide = add_scaled(moving, -dot(moving, direction), direction)
        inverse = max(inverse, inverse_mass[n] * free_fraction(touch, i, along(slide)))
        friction_force = coulomb_force(slide, state.stiffness / (inverse * step.kick), state.coefficient * force)
    store(touch.normal, i, normal_force)
    store(touch.friction, i, friction_force)
    for c in range(3):
        f[n, c] += normal_force[c] + friction_force[c]


@kernel
def add_wall(state, x, v, f, inverse_mass, dt, kick=0.0):
    """Add the forces of a rigid plane to the nodal forces f; see `strikewave.fem.contact.add_contact`."""
    step = Step(dt, kick if kick > 0.0 else dt, 0.0, kept_depth(state.touch, dt))
    for i in range(state.touch.nodes.shape[0]):
        wall_node(i, state, x, v, f, inverse_mass, step)


@kernel
def contact_force(touch):
    """Return the force of the last step on the first surface, N."""
    force = (0.0, 0.0, 0.0)
    for i in range(touch.first):
        force = add_scaled(add_scaled(force, 1.0, row(touch.normal, i)), 1.0, row(touch.friction, i))
    return force


@kernel
def contact_work(touch, v, dt):
    """Return the energy that normal forces and friction took in the step that led to the velocity v, J.

    It is -sum F . (v_old + v_new)/2 dt over the nodes, as boundaries and all other forces left v_new.
    """
    normal_work, friction_work = 0.0, 0.0
    for i in range(touch.nodes.shape[0]):
        for c in range(3):
            middle = 0.5 * (touch.velocity[i, c] + v[touch.nodes[i], c])
            normal_work -= touch.normal[i, c] * middle
            friction_work -= touch.friction[i, c] * middle
    return normal_work * dt, friction_work * dt


EDGE = 0.05
"""Share of a face's size beyond the rim of a surface where a node is felt no more; within half of it, it is fully.

Without a strip a node that slides off an edge would lose its force at once and ring; chosen as narrow as lets the force
fade over several steps, so that a surface is hardly larger than its mesh."""
JUMP = 0.1
"""Share of the largest depth by which a node may be deeper behind a new face than behind its last one.

A node that slides from face to face keeps its depth; one whose closest face is suddenly the far side of a squashed
element is deeper by that element's thickness, many times as much."""
SAME = 1e-9
"""Share by which another face must be closer than the present one to take its place.

Above rounding: a node over a common edge is as far from both faces, and would change between them at every step."""
_CLEARLY_OVER = 4.0
"""A node closer to its last face than a quarter of its way to the rim needs no other face looked at.

On a square face the rim is (1 - |xi|)/2 of its size away; half of that again is left for skewed ones."""
_HALF = 0.5
"""w of `strikewave.fem.contact`: both surfaces are checked against each other, and each closes half of the gap."""
STANDING = 0.0, 0.0, 0.0
"""No velocity: what offsets are taken from before the mean is known."""
SPEEDS = 7
"""Numbers of a share of the velocities of a contact: see `speed_share`."""


class NodeContacts(NamedTuple):
    """Contact of each node: its face (-1: none yet), shape functions there, gap, and the force on it by parts.

    ``clear`` is the travel before which the node is not looked at, ``offset`` the gap from which depth is measured;
    ``known`` tells whether the node was over a face, or fully felt, when last looked at.
    """

    face: np.ndarray
    shape: np.ndarray
    gap: np.ndarray
    normal_force: np.ndarray
    friction_force: np.ndarray
    touches: np.ndarray
    clear: np.ndarray
    offset: np.ndarray
    known: np.ndarray


class ContactState(NamedTuple):
    """Two surfaces that may touch.

    Faces are corners by place in ``touch.nodes``, ``neighbours`` the faces across their edges (-1: rim of the surface),
    ``size`` the root of their areas, ``radius`` of the sphere about the mean of their corners, ``limit`` the depth
    beyond which a node is not taken to be inside, m. The faces that node i may meet are ``candidates[start[i] :
    start[i + 1]]``, true until ``travel[0]`` exceeds ``margin``. ``place`` and ``moving`` are position and velocity
    that the nodes would have at the end of the step without contact, ``inverse_mass`` is that of the nodes, 1/kg.
    ``speeds`` (shares, SPEEDS) is what `speed_share` finds.
    """

    touch: NodeTouch
    nodal: NodeContacts
    faces: np.ndarray
    neighbours: np.ndarray
    size: np.ndarray
    radius: np.ndarray
    limit: np.ndarray
    checked: np.ndarray
    start: np.ndarray
    candidates: np.ndarray
    place: np.ndarray
    moving: np.ndarray
    inverse_mass: np.ndarray
    travel: np.ndarray
    speeds: np.ndarray
    first_faces: int
    margin: float
    stiffness: float
    coefficient: float


@leaf_kernel
def corners(state, face):
    """Return the places of the corners of a face."""
    k = state.faces[face]
    return row(state.place, k[0]), row(state.place, k[1]), row(state.place, k[2]), row(state.place, k[3])


@leaf_kernel
def is_far(a, b, c, d, radius, x, best):
    """Return whether no point of a face of some radius can be closer to x than ``best``."""
    reach = best + radius
    return apart(middle_of(a, b, c, d), x) > reach * reach


@leaf_kernel
def met_last(nodal, i):
    """Return xi and eta where node i touched its face in the step before; where it did not, of the face's middle."""
    if nodal.touches[i] == 0:
        return 0.0, 0.0
    n = nodal.shape[i]
    return n[1] + n[2] - n[0] - n[3], n[2] + n[3] - n[0] - n[1]


@leaf_kernel
def nearest_face(state, i):
    """Return the face closest to node i, xi, eta, the distance, and whether the point lies on the rim of that face.

    The face of the step before keeps its place unless another is closer; of equally close ones the first that the node
    is over is taken. The rim of a face is no closer than the foot of the node on its continuation.
    """
    x = row(state.place, i)
    chosen, best, xi, eta, rim = -1, np.inf, 0.0, 0.0, True
    last = state.nodal.face[i]
    if last >= 0:
        a, b, c, d = corners(state, last)
        xi, eta, square, rim = closest_point(x, a, b, c, d, *met_last(state.nodal, i))
        chosen, best = last, math.sqrt(square)
        # the usual case, and the reason why a contact costs little
        if not rim and _CLEARLY_OVER * best < (1.0 - max(abs(xi), abs(eta))) * state.size[last]:
            return chosen, xi, eta, best, rim
    for place in range(state.start[i], state.start[i + 1]):
        face = state.candidates[place]
        if face == last:
            continue
        a, b, c, d = corners(state, face)
        if chosen >= 0 and is_far(a, b, c, d, state.radius[face], x, best):
            continue
        new_xi, new_eta, square = foot_of(x, a, b, c, d, *first_guess(x, a, b, c, d))
        new_rim, closer = is_beyond(new_xi, new_eta), best * (1.0 - SAME)
        if new_rim and chosen >= 0 and square >= closer * closer:
            continue
        if new_rim:
            new_xi, new_eta, square = on_rim(x, a, b, c, d)
        distance = math.sqrt(square)
        # over a face goes before beside one, at the same distance
        over = rim and not new_rim and distance <= best * (1.0 + SAME)
        if chosen < 0 or over or distance < closer:
            chosen, best, xi, eta, rim = face, distance, new_xi, new_eta, new_rim
    return chosen, min(max(xi, -1.0), 1.0), min(max(eta, -1.0), 1.0), best, rim


@leaf_kernel
def is_behind(state, face, off):
    """Return whether a vector points inward of a face; of none (-1) it does not."""
    if face < 0:
        return False
    a, b, c, d = corners(state, face)
    return dot(off, cross(add_scaled(c, -1.0, a), add_scaled(d, -1.0, b))) < 0.0


@leaf_kernel
def in_valley(state, face, xi, eta, off):
    """Return whether a node whose closest point lies on edges of a face is behind the faces across these edges too."""
    across = state.neighbours[face]
    return (
        (eta > -1.0 or is_behind(state, across[0], off))
        and (xi < 1.0 or is_behind(state, across[1], off))
        and (eta < 1.0 or is_behind(state, across[2], off))
        and (xi > -1.0 or is_behind(state, across[3], off))
    )


@leaf_kernel
def gap_at(state, i, face, xi, eta, rim):
    """Return the gap of node i from a point of a face, the direction out of the face, and the share that is felt.

    Over the face the direction is its normal. Behind an edge between two faces that form a valley it is the line to the
    edge. Beyond any other edge the share falls to zero within `EDGE` of the size of the face.
    """
    a, b, c, d = corners(state, face)
    m, e, g, h = patch(a, b, c, d)
    point = add_scaled(add_scaled(add_scaled(m, xi, e), eta, g), xi * eta, h)
    normal = cross(add_scaled(e, eta, h), add_scaled(g, xi, h))
    normal = scaled(normal, 1.0 / max(math.sqrt(dot(normal, normal)), _TINY))
    off = add_scaled(row(state.place, i), -1.0, point)
    gap = dot(off, normal)
    if not rim or gap >= 0.0:
        return gap, normal, 1.0 if not rim else 0.0
    if in_valley(state, face, xi, eta, off):
        depth = math.sqrt(dot(off, off))
        return -depth, scaled(off, -1.0 / depth), 1.0
    beside = math.sqrt(max(dot(off, off) - gap * gap, 0.0))
    return gap, normal, min(max(2.0 - 2.0 * beside / (EDGE * state.size[face]), 0.0), 1.0)


@leaf_kernel
def relative_inverse_mass(state, i, face, shape, n):
    """Return 1/m* of node i against a face, along n; see `strikewave.fem.contact`."""
    k = state.faces[face]
    shared, alone = 0.0, 0.0
    for c in range(4):
        inverse = state.inverse_mass[k[c]] * free_fraction(state.touch, k[c], n)
        shared += shape[c] * inverse * state.touch.area[k[c]]
        alone += shape[c] * shape[c] * inverse
    # of both bounds the larger, so that the stiffness is stable for a lone node on a face as for matching meshes
    return state.inverse_mass[i] * free_fraction(state.touch, i, n) + max(shared / state.touch.area[i], alone)


@leaf_kernel
def approach_of(state, i, face, shape):
    """Return the velocity of node i relative to a face."""
    k = state.faces[face]
    speed = row(state.moving, i)
    for c in range(4):
        speed = add_scaled(speed, -shape[c], row(state.moving, k[c]))
    return speed


@leaf_kernel
def depth_of(nodal, i, gap, before, share, kept):
    """Return the depth that a node is pressed out of; ``before`` is the gap at the beginning of the step.

    An overlap that has not come about by pressing counts for nothing until the node has moved out of it: one from
    before the blow, one of a node that came in beside the rim or from deep inside, or one beyond the rim. Only what
    the step would add is then pressed back.
    """
    nodal.offset[i] = moved_offset(nodal.offset[i], gap, before, kept)
    if not nodal.known[i] or share < 1.0:
        nodal.offset[i] = min(nodal.offset[i], before)
    return nodal.offset[i] - gap


@leaf_kernel
def press(state, i, step):
    """Find the face that node i meets and the force on the node."""
    nodal = state.nodal
    last, last_gap = nodal.face[i], nodal.gap[i]
    face, xi, eta, distance, rim = nearest_face(state, i)
    nodal.face[i], nodal.touches[i] = face, 0
    gap, normal, share = gap_at(state, i, face, xi, eta, rim)
    nodal.gap[i] = gap
    shape = shape_functions(xi, eta)
    speed = approach_of(state, i, face, shape)
    before = gap - step.dt * dot(speed, normal)
    if face != last and before < min(last_gap, 0.0) - JUMP * state.limit[face]:  # the far side of a squashed element
        nodal.known[i] = 0
    felt = share > 0.0 and gap > -state.limit[face]
    depth = depth_of(nodal, i, gap, before, share, step.kept) if felt else 0.0
    nodal.known[i] = felt and share == 1.0
    if depth <= 0.0:
        nodal.clear[i] = state.travel[0] + distance - step.travel if gap >= 0.0 else 0.0
        return
    inverse = relative_inverse_mass(state, i, face, shape, normal)
    if inverse <= 0.0:  # both sides are held along the normal
        return
    stop = _HALF * state.stiffness * share / step.kick
    force = stop / inverse * depth / step.dt
    nodal.touches[i] = 1
    nodal.clear[i] = 0.0
    store(nodal.normal_force, i, scaled(normal, force))
    for c in range(4):
        nodal.shape[i, c] = shape[c]
    if state.coefficient > 0.0:
        slide = add_scaled(speed, -dot(speed, normal), normal)
        # the lighter of both directions: friction then never turns the sliding round
        inverse = max(inverse, relative_inverse_mass(state, i, face, shape, along(slide)))
        store(nodal.friction_force, i, coulomb_force(slide, stop / inverse, state.coefficient * force))


@leaf_kernel
def predict_node(i, state, x, v, f, inverse_mass, step):
    """Fill place and velocity of a node at the end of the step without contact."""
    n = state.touch.nodes[i]
    state.inverse_mass[i] = inverse_mass[n]
    for c in range(3):
        state.touch.velocity[i, c] = v[n, c]
        state.moving[i, c] = v[n, c] + step.kick * inverse_mass[n] * f[n, c]
        state.place[i, c] = x[n, c] + step.dt * state.moving[i, c]


@called_kernel
def predict_positions(state, x, v, f, inverse_mass, step, first, last):
    """Fill place and velocity of the nodes first to last - 1."""
    for i in range(first, last):
        predict_node(i, state, x, v, f, inverse_mass, step)


@leaf_kernel
def speed_share(k, state, middle):
    """Write of a share of the nodes the sums of their velocities, by surface, and the largest square of an offset.

    Offsets are those from a velocity ``middle``: no two nodes come closer faster than twice the largest, whatever it
    is; the mean of both surfaces makes them small.
    """
    for c in range(SPEEDS):
        state.speeds[k, c] = 0.0
    for i in range(k * ROWS, min((k + 1) * ROWS, state.moving.shape[0])):
        own = 0 if i < state.touch.first else 3
        speed = row(state.moving, i)
        off = add_scaled(speed, -1.0, middle)
        for c in range(3):
            state.speeds[k, own + c] += speed[c]
        state.speeds[k, SPEEDS - 1] = max(state.speeds[k, SPEEDS - 1], dot(off, off))


@called_kernel
def mean_speed(state):
    """Return the mean velocity of both surfaces, once the shares of `speed_share` are there."""
    first, second = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for k in range(state.speeds.shape[0]):
        share = state.speeds[k]
        first = add_scaled(first, 1.0, (share[0], share[1], share[2]))
        second = add_scaled(second, 1.0, (share[3], share[4], share[5]))
    others = state.moving.shape[0] - state.touch.first
    return scaled(add_scaled(scaled(first, 1.0 / state.touch.first), 1.0 / others, second), 0.5)


@called_kernel
def travel_of(state, dt):
    """Return the travel of the step, the most by which any two nodes of the two surfaces can come closer.

    The shares of `speed_share` are there, with offsets from `mean_speed`.
    """
    fastest = 0.0
    for k in range(state.speeds.shape[0]):
        fastest = max(fastest, state.speeds[k, SPEEDS - 1])
    return 2.0 * dt * math.sqrt(fastest)


@called_kernel
def begin_step(state, step):
    """Return the step with its travel, once all positions are predicted, and the share of depths that is kept."""
    shares = state.speeds.shape[0]
    for k in range(shares):
        speed_share(k, state, STANDING)
    middle = mean_speed(state)  # twice: offsets from the mean are small, and a body that flies needs no new search
    for k in range(shares):
        speed_share(k, state, middle)
    travel = travel_of(state, step.dt)
    state.travel[0] += travel
    return Step(step.dt, step.kick, travel, kept_depth(state.touch, step.dt))


@leaf_kernel
def press_node(i, state, step):
    """Find the face that a node meets and the force on the node, where it can meet one in this step."""
    nodal = state.nodal
    met = state.start[i + 1] > state.start[i] or nodal.face[i] >= 0
    if met and not state.travel[0] + step.travel < nodal.clear[i]:  # a NaN is looked at, not passed over
        for c in range(3):
            nodal.friction_force[i, c] = 0.0
        press(state, i, step)
    else:
        nodal.touches[i] = 0


@called_kernel
def press_nodes(state, step, first, last):
    """Find the faces that the nodes first to last - 1 meet and the forces on them, from the motion of all of them."""
    for i in range(first, last):
        press_node(i, state, step)


@called_kernel
def scatter_forces(state, f, first, last):
    """Add the forces on one surface, the nodes first to last - 1, to f: those on nodes, and reactions to corners."""
    touch, nodal = state.touch, state.nodal
    touch.normal[first:last] = 0.0
    touch.friction[first:last] = 0.0
    for i in range(nodal.face.shape[0]):
        if nodal.touches[i] == 0:
            continue
        if first <= i < last:
            for c in range(3):
                touch.normal[i, c] += nodal.normal_force[i, c]
                touch.friction[i, c] += nodal.friction_force[i, c]
            continue
        corner = state.faces[nodal.face[i]]
        for c in range(3):
            for k in range(4):
                touch.normal[corner[k], c] -= nodal.shape[i, k] * nodal.normal_force[i, c]
                touch.friction[corner[k], c] -= nodal.shape[i, k] * nodal.friction_force[i, c]
    for i in range(first, last):
        for c in range(3):
            f[touch.nodes[i], c] += touch.normal[i, c] + touch.friction[i, c]


@kernel
def nearest_faces(state, face, shape, distance):
    """Fill, for each node with candidates, the closest face, the shape functions at the closest point, the distance."""
    for i in range(face.shape[0]):
        if state.start[i + 1] > state.start[i]:
            face[i], xi, eta, distance[i], _ = nearest_face(state, i)
            values = shape_functions(xi, eta)
            for c in range(4):
                shape[i, c] = values[c]
