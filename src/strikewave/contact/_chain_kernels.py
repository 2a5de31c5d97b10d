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

from strikewave.base.compiled import LEAF, called_kernel, leaf_kernel
from strikewave.contact import _integrator
from strikewave.contact._integrator import CONTINUE, RESTART
from strikewave.contact._law_kernels import (
    DAMPING,
    NO_DEPTH,
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
    stored,
    unyielding_force,
    yielding,
)

SPRING, STOP_LINK, CONTACT, FRICTION = 0, 1, 2, 3
"""Kinds of links."""
OPEN, PUSHING, SLACK, YIELDING = 0, 1, 2, 3
"""Modes of springs, stops and contacts."""
STICKING, SLIDING, SLIDING_BACK = 0, 1, 2
"""Modes of friction; sliding where the node behind is the faster one."""
SWITCHES = 3
"""Switch functions of a link: open or touching, force kept or lost, elastic or yielding."""
_REGAIN = 1e-9
"""Share of its elastic part at which a lost force acts again: above the rounding with which it was lost, so that the
link does not switch back at once; far below any force that matters."""
_AT_REST = 1e-12
"""Slip below which friction takes nodes to be at rest, m/s: above the rounding of speeds up to 1 km/s."""
KIND, BEHIND, AHEAD = 0, 1, 2
"""Columns of `Links.joins`."""
MASS, GRAVITY = 0, 1
"""Columns of the table of bodies, kg and m/s^2."""
PLACE, SPEED, FORCE, ACCELERATION = 0, 1, 2, 3
"""Rows of the table of bases: position, speed, the force of the links on the base, acceleration."""
MEAN, AMPLITUDE, RATE, PHASE = 0, 1, 2, 3
"""Columns of the table of shakes: mean position (m), amplitude (m), rate (rad/s), phase (rad)."""
SLIDING_FORCE, STICKING_FORCE = STIFFNESS, DAMPING
"""Places of the two forces in the row of a friction link, N."""


class Links(NamedTuple):
    """Links as two tables, one row a link: whole numbers (kind, nodes) and values as `_law_kernels` places them.

    The memory of a system begins with the approach speed of each link; it ends with the depth to which each has
    yielded, and then with how much its radius has grown, s.
    """

    joins: np.ndarray
    values: np.ndarray


class ChainTables(NamedTuple):
    """Bodies (one row each), bases (one column each, scratch), and the links that join them, as of `Links`.

    The state of a system with such a chain begins with the positions of the bodies and their speeds, its modes with
    those of the links, its switch functions with three for each link; its memory is that of `Links`.
    """

    bodies: np.ndarray
    bases: np.ndarray
    joins: np.ndarray
    values: np.ndarray

    @property
    def links(self) -> Links:
        """The links alone."""
        return Links(self.joins, self.values)


class ChainSystem(NamedTuple):
    """A chain on bases that stand still or shake; state = positions, speeds, energy dissipated in each link."""

    chain: ChainTables
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
def deepest_place(chain, memory, i):
    """Return the place in the memory of the depth to which link i has yielded; s follows so many links later."""
    return memory.shape[0] - 2 * chain.joins.shape[0] + i


@leaf_kernel
def spot_of(chain, memory, i):
    """Return the depth to which link i has yielded, and s."""
    place = deepest_place(chain, memory, i)
    return memory[place], memory[place + chain.joins.shape[0]]


@leaf_kernel
def contact_force(law, d, rate, mode, approach, deepest, s):
    """Return the force of a contact and what it stores per length, N."""
    if mode == YIELDING:  # without a damper: a law has a damper, or a cap
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
    if kind != SPRING and mode == OPEN:  # a spring never lets go
        return 0.0, 0.0
    if kind == CONTACT:
        return contact_force(value, d, rate, mode, approach, deepest, s)
    elastic = value[PRELOAD] + value[STIFFNESS] * d
    if kind == STOP_LINK and mode == SLACK:
        return 0.0, elastic
    return elastic + value[DAMPING] * rate, elastic


@leaf_kernel
def link_motion(chain, i, y):
    """Return indentation d and its rate d' of link i."""
    joins, bases, bodies = chain.joins, chain.bases, chain.bodies.shape[0]
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
    return d - chain.values[i, OFFSET], rate


@leaf_kernel
def press(chain, i, y, mode, memory):
    """Return the force of link i, which is no friction, its elastic part, N, and the rate d', m/s."""
    d, rate = link_motion(chain, i, y)
    deepest, s = spot_of(chain, memory, i)
    force, elastic = link_force(chain.joins[i, KIND], chain.values[i], d, rate, mode[i], memory[i], deepest, s)
    return force, elastic, rate


@leaf_kernel
def spring_energy(chain, i, y):
    """Return the energy that spring or stop i stores, J."""
    values = chain.values[i]
    d, _ = link_motion(chain, i, y)
    if chain.joins[i, KIND] == STOP_LINK:
        d = max(d, 0.0)
    return values[PRELOAD] * d + 0.5 * values[STIFFNESS] * d * d


@leaf_kernel
def frictionless(chain, node, y, mode, memory):
    """Return the acceleration of a node without friction, m/s^2."""
    joins, table = chain.joins, chain.bodies
    bodies = table.shape[0]
    if node >= bodies:
        return chain.bases[ACCELERATION, node - bodies]
    total = 0.0
    for j in range(joins.shape[0]):
        # a body takes one friction link, so that no other friction is left out
        if joins[j, KIND] == FRICTION or (joins[j, BEHIND] != node and joins[j, AHEAD] != node):
            continue
        force, _, _ = press(chain, j, y, mode, memory)
        total += force if joins[j, AHEAD] == node else -force
    return total / table[node, MASS] + table[node, GRAVITY]


@leaf_kernel
def holding_force(chain, i, y, mode, memory):
    """Return the force with which friction link i would keep its nodes together, N: equal accelerations."""
    a, b, table = chain.joins[i, BEHIND], chain.joins[i, AHEAD], chain.bodies
    apart = frictionless(chain, a, y, mode, memory)
    apart -= frictionless(chain, b, y, mode, memory)
    inverse_mass = 0.0
    if a < table.shape[0]:
        inverse_mass += 1.0 / table[a, MASS]
    if b < table.shape[0]:
        inverse_mass += 1.0 / table[b, MASS]
    return apart / inverse_mass


@called_kernel
def friction_force(chain, i, y, mode, memory):
    """Return the force of friction link i, N."""
    if mode[i] == STICKING:
        return holding_force(chain, i, y, mode, memory)
    sliding = chain.values[i, SLIDING_FORCE]
    return sliding if mode[i] == SLIDING else -sliding  # against the slip: the faster node behind is held back


@leaf_kernel
def link_push(chain, i, y, mode, memory):
    """Return the force of link i, its elastic part, N, and the rate d', m/s."""
    if chain.joins[i, KIND] == FRICTION:
        _, rate = link_motion(chain, i, y)
        return friction_force(chain, i, y, mode, memory), 0.0, rate
    return press(chain, i, y, mode, memory)


@leaf_kernel
def chain_forces(chain, y, mode, memory, out):
    """Fill out with the force of each link."""
    for i in range(chain.joins.shape[0]):
        out[i], _, _ = link_push(chain, i, y, mode, memory)


@leaf_kernel
def chain_rates(chain, y, mode, memory, dy, power):
    """Fill speeds and accelerations, the power that each link dissipates, W, and the forces on bases."""
    joins, table, bases = chain.joins, chain.bodies, chain.bases
    bodies = table.shape[0]
    for i in range(bodies):
        dy[i] = y[bodies + i]
        dy[bodies + i] = table[i, GRAVITY]
    for i in range(bases.shape[1]):
        bases[FORCE, i] = 0.0
    for i in range(joins.shape[0]):
        power[i] = 0.0
        if joins[i, KIND] in (STOP_LINK, CONTACT) and mode[i] == OPEN:  # most links are open most of the time
            continue
        force, elastic, rate = link_push(chain, i, y, mode, memory)
        power[i] = (force - elastic) * rate  # the elastic part is stored, and comes back
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
        g[2] = rate  # it yields on until it turns back
    else:
        g[0] = left
        ratio = push(law, d, rate, approach)
        g[1] = ratio if mode == PUSHING else _REGAIN - ratio
        if mode == PUSHING and law[YIELD_LOAD] < np.inf:
            g[2] = deepest - d


@called_kernel
def friction_switch(chain, i, y, mode, memory, rate):
    """Return the switch function of friction link i: it still holds, or still slides the same way.

    What has just broken loose has no slip yet: it slides until the slip is a little below zero, so that neither
    rounding nor a short excess of the force can switch it back and forth.
    """
    if mode[i] == STICKING:
        return chain.values[i, STICKING_FORCE] - abs(holding_force(chain, i, y, mode, memory))
    return (rate if mode[i] == SLIDING else -rate) + _AT_REST


@leaf_kernel
def link_switches(chain, y, mode, memory, g):
    """Fill the switch functions of each link.

    A force lost while the link is still compressed comes back only above a small share, so that rounding
    cannot switch it back and forth.
    """
    values = chain.values
    for i in range(chain.joins.shape[0]):
        own = g[SWITCHES * i : SWITCHES * (i + 1)]
        own[0], own[1], own[2] = 1.0, 1.0, 1.0
        kind = chain.joins[i, KIND]
        if kind == SPRING:
            continue
        d, rate = link_motion(chain, i, y)
        if kind == FRICTION:
            own[0] = friction_switch(chain, i, y, mode, memory, rate)
        elif kind == CONTACT:
            deepest, s = spot_of(chain, memory, i)
            contact_switches(values[i], d, rate, mode[i], memory[i], deepest, s, own)
        elif mode[i] == OPEN:
            own[0] = -d
        else:
            own[0] = d
            ratio = 1.0 + values[i, DAMPING] * rate / (values[i, STIFFNESS] * max(d, NO_DEPTH))
            own[1] = ratio if mode[i] == PUSHING else _REGAIN - ratio


@leaf_kernel
def never_touches(i, g):
    """Take from contact i the switch function of its first touch."""
    g[SWITCHES * i] = 1.0


@leaf_kernel
def link_of(k):
    """Return the link that switch k belongs to."""
    return k // SWITCHES


@called_kernel
def remember(chain, i, memory, deepest):
    """Keep the depth to which contact i has yielded, for all contacts of its spot: the deepest of any."""
    values = chain.values
    for j in range(values.shape[0]):
        if j == i or (values[j, SPOT] > 0.0 and values[j, SPOT] == values[i, SPOT]):
            place = deepest_place(chain, memory, j)
            memory[place] = max(memory[place], deepest)
            memory[place + values.shape[0]] = flattening(values[j], memory[place])


@leaf_kernel
def let_go(chain, i, y, mode, memory):
    """Open contact i while it is pressed: return what it stores, J, which is lost; what yields is remembered."""
    d, _ = link_motion(chain, i, y)
    if mode[i] == YIELDING:
        remember(chain, i, memory, d)
    deepest, _ = spot_of(chain, memory, i)
    mode[i] = OPEN
    return stored(chain.values[i], d, deepest)


@called_kernel
def slip(chain, i, y, mode, memory):
    """Let friction link i stick or slide, as the force that would hold it decides; what comes to rest has no slip left.

    The speeds of the two bodies become that of their common momentum: they differ by rounding only.
    """
    table, bases = chain.bodies, chain.bases
    a, b, bodies = chain.joins[i, BEHIND], chain.joins[i, AHEAD], table.shape[0]
    if mode[i] != STICKING:
        if a < bodies and b < bodies:
            both = table[a, MASS] + table[b, MASS]
            y[bodies + a] = (table[a, MASS] * y[bodies + a] + table[b, MASS] * y[bodies + b]) / both
            y[bodies + b] = y[bodies + a]
        elif a < bodies:
            y[bodies + a] = bases[SPEED, b - bodies]
        else:
            y[bodies + b] = bases[SPEED, a - bodies]
    needed = holding_force(chain, i, y, mode, memory)
    # a link that stuck has just broken loose: it slides, though rounding may leave the force below the limit
    if mode[i] != STICKING and abs(needed) <= chain.values[i, STICKING_FORCE]:
        mode[i] = STICKING
    else:
        mode[i] = SLIDING if needed > 0.0 else SLIDING_BACK


@leaf_kernel
def link_switch(chain, k, y, mode, memory):
    """Change the mode of the link that switch k belongs to; remember approach speed and yielded depth."""
    i, which = link_of(k), k % SWITCHES
    if chain.joins[i, KIND] == FRICTION:
        slip(chain, i, y, mode, memory)
    elif which == 1:
        mode[i] = SLACK if mode[i] == PUSHING else PUSHING
    elif which == 2 and mode[i] == PUSHING:
        mode[i] = YIELDING
    elif which == 2:
        d, _ = link_motion(chain, i, y)
        remember(chain, i, memory, d)
        mode[i] = PUSHING
    elif mode[i] == OPEN:
        _, rate = link_motion(chain, i, y)
        mode[i] = PUSHING
        memory[i] = max(rate, 0.0)  # one that touches while it parts, as a shaking base does, approaches with nothing
        return RESTART
    else:
        mode[i] = OPEN
    return CONTINUE


def is_a(system, kind):
    """Return whether a numba type is that of the NamedTuple ``kind``."""
    return getattr(system, "instance_class", None) is kind


@overload(_integrator.derivatives, jit_options=LEAF)
def _derivatives(system, t, y, mode, memory, dy):
    def rates(system, t, y, mode, memory, dy):
        chain = system.chain
        shake(system.shakes, chain.bases, t)
        chain_rates(chain, y, mode, memory, dy, dy[2 * chain.bodies.shape[0] :])

    return rates if is_a(system, ChainSystem) else None


@overload(_integrator.forces, jit_options=LEAF)
def _forces(system, t, y, mode, memory, out):
    def fill(system, t, y, mode, memory, out):
        shake(system.shakes, system.chain.bases, t)
        chain_forces(system.chain, y, mode, memory, out)

    return fill if is_a(system, ChainSystem) else None


@overload(_integrator.switches, jit_options=LEAF)
def _switches(system, t, y, mode, memory, g):
    def fill(system, t, y, mode, memory, g):
        shake(system.shakes, system.chain.bases, t)
        link_switches(system.chain, y, mode, memory, g)

    return fill if is_a(system, ChainSystem) else None


@overload(_integrator.horizon, jit_options=LEAF)
def _horizon(system, t, y, mode, memory):
    def most(system, t, y, mode, memory):
        return np.inf

    return most if is_a(system, ChainSystem) else None


@overload(_integrator.switch, jit_options=LEAF)
def _switch(system, k, t, y, mode, memory):
    def change(system, k, t, y, mode, memory):
        shake(system.shakes, system.chain.bases, t)
        return link_switch(system.chain, k, y, mode, memory)

    return change if is_a(system, ChainSystem) else None
