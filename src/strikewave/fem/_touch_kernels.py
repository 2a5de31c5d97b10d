"""Compiled contact of nodes, whatever they touch: what they note, how they are held and rub; a plane before them."""

import math
from typing import NamedTuple

import numpy as np

from strikewave.base.compiled import kernel, leaf_kernel
from strikewave.fem._surface_kernels import add_scaled, as_tuple, dot, row, scaled, store

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
    return dt / before if dt < before else 1.0


@leaf_kernel
def moved_offset(offset, gap, before, kept):
    """Return the gap from which depth is measured, for the gap at the beginning of the step and the one to come."""
    if before < offset:
        offset -= (1.0 - kept) * (offset - before)
    return max(offset, min(gap, 0.0))


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
    if depth > 0.0 and inverse > 0.0:
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
