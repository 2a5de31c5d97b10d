"""Compiled links, and the chain of bodies on fixed bases as a system of the integrator.

Nodes are bodies (0 .. bodies-1) and then bases. A link joins node a (behind) to node b (ahead):
indentation or compression d = x_a - x_b - offset; its force F pushes b forward and a back.

Friction between two nodes is Coulomb's: while they slide the force is the sliding one, against the slip; while they
stick it is whatever keeps them together, up to the sticking force. A body takes one friction link at most.
"""

import math
from typing import NamedTuple

import numpy as np
from numba.extending import overload

from strikewave.base.compiled import LEAF, leaf_kernel
from strikewave.contact import _integrator
from strikewave.contact._integrator import CONTINUE, RESTART
from strikewave.contact._law_kernels import (
    DAMPING,
    OFFSET,
    PRELOAD,
    SPOT,
    STIFFNESS,
    YIELD_LOAD,
    damper_force,
    flattening,
    hysteresis,
    push,
    residual,
    unyielding_force,
    yielding,
)

SPRING, STOP_LINK, CONTACT, FRICTION = 0, 1, 2, 3
OPEN, PUSHING, SLACK, YIELDING = 0, 1, 2, 3
"""Modes of springs, stops and contacts."""
STICKING, SLIDING, SLIDING_BACK = 0, 1, 2
"""Modes of friction; sliding where the node behind is the faster one."""
SWITCHES = 3
"""Switch functions of a link."""
_REGAIN = 1e-9
_AT_REST = 1e-12
"""Slip below which friction takes nodes to be at rest, m/s."""


KIND, BEHIND, AHEAD = 0, 1, 2
"""Columns of `Links.joins`."""
MASS, GRAVITY = 0, 1
"""Columns of the table of bodies, kg and m/s^2."""
PLACE, SPEED, FORCE, ACCELERATION = 0, 1, 2, 3
"""Rows of the table of bases: position, speed, the force of the links on the base, acceleration."""
MEAN, AMPLITUDE, RATE, PHASE = 0, 1, 2, 3
"""Columns of the table of shakes: mean position (m), amplitude (m), rate (rad/s), phase (rad)."""
SLIDING_FORCE, STICKING_FORCE = STIFFNESS, DAMPING
"""Where the row of a friction link holds its two forces, N."""


class Links(NamedTuple):
    """Links as two tables, one row a link: whole numbers (kind, nodes) and values as `_law_kernels` places them.

    The memory of a system begins with the approach speed of each link; it ends with the depth to which each has
    yielded, and then with how much its radius has grown, s.
    """

    joins: np.ndarray
    values: np.ndarray


class ChainSystem(NamedTuple):
    """Bodies on bases that stand still or shake; state = positions, speeds, energy dissipated in each link."""

    bodies: np.ndarray
    bases: np.ndarray
    joins: np.ndarray
    values: np.ndarray
    shakes: np.ndarray


@leaf_kernel
def shake(shakes, bases, t):
    """Fill position, speed and acceleration of each base: x = mean + a sin(w t + phase)."""
    for i in range(shakes.shape[0]):
        row = shakes[i]
        turn = row[RATE] * t + row[PHASE]
        swing = row[AMPLITUDE] * math.sin(turn)
        bases[PLACE, i] = row[MEAN] + swing
        bases[SPEED, i] = row[AMPLITUDE] * row[RATE] * math.cos(turn)
        bases[ACCELERATION, i] = -swing * row[RATE] ** 2


@leaf_kernel
def deepest_place(joins, memory, i):
    """Return the place in the memory of the depth to which link i has yielded; s follows so many links later."""
    return memory.shape[0] - 2 * joins.shape[0] + i


@leaf_kernel
def spot_of(joins, memory, i):
    """Return the depth to which link i has yielded, and s."""
    place = deepest_place(joins, memory, i)
    return memory[place], memory[place + joins.shape[0]]


@leaf_kernel
def contact_force(law, d, rate, mode, approach, deepest, s):
    """Return the force of a contact and what it stores per length, N."""
    if mode == YIELDING:
        force, _, storing = yielding(law, d)
        return force * hysteresis(law, rate, approach), storing
    elastic = unyielding_force(law, d, deepest, s)
    if mode == SLACK:
        return 0.0, elastic
    return elastic * hysteresis(law, rate, approach) + damper_force(law, d, rate), elastic


@leaf_kernel
def link_force(kind, value, d, rate, mode, approach, deepest, s):
    """Return the force of a link and its elastic part, N: a stop never pulls.

    Spring and stop: F = preload + k d + c d'.
    """
    if kind != SPRING and mode == OPEN:
        return 0.0, 0.0
    if kind == CONTACT:
        return contact_force(value, d, rate, mode, approach, deepest, s)
    elastic = value[PRELOAD] + value[STIFFNESS] * d
    if kind == STOP_LINK and mode == SLACK:
        return 0.0, elastic
    return elastic + value[DAMPING] * rate, elastic


@leaf_kernel
def link_motion(joins, values, i, y, bases, bodies):
    """Return indentation d and its rate d' of link i."""
    a, b = joins[i, BEHIND], joins[i, AHEAD]
    if a < bodies:
        d, rate = y[a], y[bodies + a]
    else:
        d, rate = bases[PLACE, a - bodies], bases[SPEED, a - bodies]
    if b < bodies:
        d -= y[b]
        rate -= y[bodies + b]
    else:
        d -= bases[PLACE, b - bodies]
        rate -= bases[SPEED, b - bodies]
    return d - values[i, OFFSET], rate


@leaf_kernel
def frictionless(joins, values, table, y, bases, mode, memory, node):
    """Return the acceleration of a node without friction, m/s^2."""
    bodies = table.shape[0]
    if node >= bodies:
        return bases[ACCELERATION, node - bodies]
    push = 0.0
    for j in range(joins.shape[0]):
        if joins[j, KIND] == FRICTION or (joins[j, BEHIND] != node and joins[j, AHEAD] != node):
            continue
        d, rate = link_motion(joins, values, j, y, bases, bodies)
        deepest, s = spot_of(joins, memory, j)
        force, _ = link_force(joins[j, KIND], values[j], d, rate, mode[j], memory[j], deepest, s)
        push += force if joins[j, AHEAD] == node else -force
    return push / table[node, MASS] + table[node, GRAVITY]


@leaf_kernel
def holding_force(joins, values, table, y, bases, mode, memory, i):
    """Return the force with which friction link i would keep its nodes together, N: equal accelerations."""
    a, b = joins[i, BEHIND], joins[i, AHEAD]
    apart = frictionless(joins, values, table, y, bases, mode, memory, a)
    apart -= frictionless(joins, values, table, y, bases, mode, memory, b)
    give = 0.0
    if a < table.shape[0]:
        give += 1.0 / table[a, MASS]
    if b < table.shape[0]:
        give += 1.0 / table[b, MASS]
    return apart / give


@leaf_kernel
def friction_force(joins, values, table, y, bases, mode, memory, i):
    """Return the force of friction link i, N."""
    if mode[i] == STICKING:
        return holding_force(joins, values, table, y, bases, mode, memory, i)
    return values[i, SLIDING_FORCE] if mode[i] == SLIDING else -values[i, SLIDING_FORCE]


@leaf_kernel
def chain_forces(joins, values, table, y, bases, mode, memory, out):
    """Fill out with the force of each link."""
    for i in range(joins.shape[0]):
        if joins[i, KIND] == FRICTION:
            out[i] = friction_force(joins, values, table, y, bases, mode, memory, i)
            continue
        d, rate = link_motion(joins, values, i, y, bases, table.shape[0])
        deepest, s = spot_of(joins, memory, i)
        out[i], _ = link_force(joins[i, KIND], values[i], d, rate, mode[i], memory[i], deepest, s)


@leaf_kernel
def chain_rates(joins, values, table, y, bases, mode, memory, dy, first):
    """Fill speeds, accelerations, dissipated powers (from index ``first``) and the forces on bases."""
    bodies = table.shape[0]
    for i in range(bodies):
        dy[i] = y[bodies + i]
        dy[bodies + i] = table[i, GRAVITY]
    for i in range(bases.shape[1]):
        bases[FORCE, i] = 0.0
    for i in range(joins.shape[0]):
        dy[first + i] = 0.0
        kind = joins[i, KIND]
        if kind in (STOP_LINK, CONTACT) and mode[i] == OPEN:
            continue
        d, rate = link_motion(joins, values, i, y, bases, bodies)
        if kind == FRICTION:
            force, elastic = friction_force(joins, values, table, y, bases, mode, memory, i), 0.0
        else:
            deepest, s = spot_of(joins, memory, i)
            force, elastic = link_force(kind, values[i], d, rate, mode[i], memory[i], deepest, s)
        dy[first + i] = (force - elastic) * rate
        a, b = joins[i, BEHIND], joins[i, AHEAD]
        if a < bodies:
            dy[bodies + a] -= force / table[a, MASS]
        else:
            bases[FORCE, a - bodies] -= force
        if b < bodies:
            dy[bodies + b] += force / table[b, MASS]
        else:
            bases[FORCE, b - bodies] += force


@leaf_kernel
def contact_switches(law, d, rate, mode, approach, deepest, s, g):
    """Fill the switch functions of a contact: apart or touching, force kept or lost, elastic or yielding."""
    left = d - residual(deepest, s)
    if mode == OPEN:
        g[0] = -left
    elif mode == YIELDING:
        g[2] = rate
    else:
        g[0] = left
        kept = push(law, d, rate, approach)
        g[1] = kept if mode == PUSHING else _REGAIN - kept
        if mode == PUSHING and law[YIELD_LOAD] < np.inf:
            g[2] = deepest - d


@leaf_kernel
def friction_switch(joins, values, table, y, bases, mode, memory, i, rate):
    """Return the switch function of friction link i: it still holds, or still slides the same way.

    What has just broken loose has no slip yet: it slides until the slip is a little below zero, so that neither
    rounding nor a short excess of the force can toss it to and fro.
    """
    if mode[i] == STICKING:
        return values[i, STICKING_FORCE] - abs(holding_force(joins, values, table, y, bases, mode, memory, i))
    return (rate if mode[i] == SLIDING else -rate) + _AT_REST


@leaf_kernel
def link_switches(joins, values, table, y, bases, mode, memory, g):
    """Fill the switch functions of each link.

    A force lost while the link is still compressed comes back only above a small share, so that rounding
    cannot toss it to and fro.
    """
    for i in range(joins.shape[0]):
        own = g[SWITCHES * i : SWITCHES * (i + 1)]
        own[0], own[1], own[2] = 1.0, 1.0, 1.0
        kind = joins[i, KIND]
        if kind == SPRING:
            continue
        d, rate = link_motion(joins, values, i, y, bases, table.shape[0])
        if kind == FRICTION:
            own[0] = friction_switch(joins, values, table, y, bases, mode, memory, i, rate)
        elif kind == CONTACT:
            deepest, s = spot_of(joins, memory, i)
            contact_switches(values[i], d, rate, mode[i], memory[i], deepest, s, own)
        elif mode[i] == OPEN:
            own[0] = -d
        else:
            own[0] = d
            kept = 1.0 + values[i, DAMPING] * rate / (values[i, STIFFNESS] * max(d, 1e-30))
            own[1] = kept if mode[i] == PUSHING else _REGAIN - kept


@leaf_kernel
def remember(joins, values, memory, i, deepest):
    """Keep the depth to which contact i has yielded, for all contacts of its spot: the deepest of any."""
    for j in range(joins.shape[0]):
        if j == i or (values[j, SPOT] > 0.0 and values[j, SPOT] == values[i, SPOT]):
            place = deepest_place(joins, memory, j)
            memory[place] = max(memory[place], deepest)
            memory[place + joins.shape[0]] = flattening(values[j], memory[place])


@leaf_kernel
def slip(joins, values, table, y, bases, mode, memory, i):
    """Let friction link i stick or slide, as the force that would hold it says; what comes to rest has no slip left.

    The speeds of the two bodies become that of their common momentum: they differ by rounding only.
    """
    a, b, bodies = joins[i, BEHIND], joins[i, AHEAD], table.shape[0]
    if mode[i] != STICKING:
        if a < bodies and b < bodies:
            both = table[a, MASS] + table[b, MASS]
            y[bodies + a] = (table[a, MASS] * y[bodies + a] + table[b, MASS] * y[bodies + b]) / both
            y[bodies + b] = y[bodies + a]
        elif a < bodies:
            y[bodies + a] = bases[SPEED, b - bodies]
        else:
            y[bodies + b] = bases[SPEED, a - bodies]
    held = holding_force(joins, values, table, y, bases, mode, memory, i)
    if mode[i] != STICKING and abs(held) <= values[i, STICKING_FORCE]:
        mode[i] = STICKING
    else:
        mode[i] = SLIDING if held > 0.0 else SLIDING_BACK


@leaf_kernel
def link_switch(joins, values, table, k, y, bases, mode, memory):
    """Change the mode of the link that switch k belongs to; remember approach speed and yielded depth."""
    i, which, bodies = k // SWITCHES, k % SWITCHES, table.shape[0]
    if joins[i, KIND] == FRICTION:
        slip(joins, values, table, y, bases, mode, memory, i)
    elif which == 1:
        mode[i] = SLACK if mode[i] == PUSHING else PUSHING
    elif which == 2 and mode[i] == PUSHING:
        mode[i] = YIELDING
    elif which == 2:
        d, _ = link_motion(joins, values, i, y, bases, bodies)
        remember(joins, values, memory, i, d)
        mode[i] = PUSHING
    elif mode[i] == OPEN:
        _, rate = link_motion(joins, values, i, y, bases, bodies)
        mode[i] = PUSHING
        memory[i] = max(rate, 0.0)
        return RESTART
    else:
        mode[i] = OPEN
    return CONTINUE


def is_a(system, kind):
    """Tell whether a numba type is that of the NamedTuple ``kind``."""
    return getattr(system, "instance_class", None) is kind


@overload(_integrator.derivatives, jit_options=LEAF)
def _derivatives(system, t, y, mode, memory, dy):
    def rates(system, t, y, mode, memory, dy):
        s = system
        shake(s.shakes, s.bases, t)
        chain_rates(s.joins, s.values, s.bodies, y, s.bases, mode, memory, dy, 2 * s.bodies.shape[0])

    return rates if is_a(system, ChainSystem) else None


@overload(_integrator.forces, jit_options=LEAF)
def _forces(system, t, y, mode, memory, out):
    def fill(system, t, y, mode, memory, out):
        shake(system.shakes, system.bases, t)
        chain_forces(system.joins, system.values, system.bodies, y, system.bases, mode, memory, out)

    return fill if is_a(system, ChainSystem) else None


@overload(_integrator.switches, jit_options=LEAF)
def _switches(system, t, y, mode, memory, g):
    def fill(system, t, y, mode, memory, g):
        shake(system.shakes, system.bases, t)
        link_switches(system.joins, system.values, system.bodies, y, system.bases, mode, memory, g)

    return fill if is_a(system, ChainSystem) else None


@overload(_integrator.horizon, jit_options=LEAF)
def _horizon(system, t, y, mode, memory):
    def most(system, t, y, mode, memory):
        return np.inf

    return most if is_a(system, ChainSystem) else None


@overload(_integrator.switch, jit_options=LEAF)
def _switch(system, k, t, y, mode, memory):
    def change(system, k, t, y, mode, memory):
        s = system
        shake(s.shakes, s.bases, t)
        return link_switch(s.joins, s.values, s.bodies, k, y, s.bases, mode, memory)

    return change if is_a(system, ChainSystem) else None
