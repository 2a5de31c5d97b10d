"""Compiled delay lines: force waves through layers, joints and an end, one time step at a time.

Each layer holds its forward wave P and backward wave M at its nodes in two rings; with a transit of
whole steps they move by one node a step, exactly. Force f = P + M, velocity v = (P - M)/Z.

At a joint between layers 1 and 2 the compression rate is x' = b - Y f with b = 2 P1/Z1 + 2 M2/Z2 and
Y = 1/Z1 + 1/Z2; the joint's own law closes it, and the waves that leave are f - P1 and f - M2. Springs,
Maxwell branches and masses follow the trapezoidal rule, which stores and gives back energy exactly: in
each branch f = w + R x', w' = beta (w + R x') + R x'. Nonlinear contacts are of second order in the step.

Where a striker hits the first face, contact law and delay lines go step by step. With the force F of this step unknown,
the striker has the speed u - h F and the face (F - 2 M)/Z + V, so that the indentation rate is c0 - c1 F: see
`strikewave.waves._press_kernels`.
"""

from typing import NamedTuple

import numpy as np

from strikewave.base.compiled import called_kernel, kernel, leaf_kernel
from strikewave.contact._law_kernels import DAMPER, YIELD_LOAD, depth_at_yield, flattening, residual
from strikewave.waves import _press_kernels
from strikewave.waves._press_kernels import CLOSED, CONTACT_SIZE, COUNT, begin_contact, contact_force, losses, press

BONDED, ELASTIC, MASS, UNILATERAL, OSCILLATOR, CONTACT = 0, 1, 2, 3, 4, 5
"""Kinds of joints; an elastic one has a spring, a dashpot, Maxwell branches; an oscillator is a mass on one."""
MOST_BRANCHES = 5
"""Branches of an elastic joint: its spring, and four Maxwell branches, the most that `loss.fit_loss` makes."""
FORCE, SPEED, INCIDENT = 0, 1, 2
"""Quantities that a load prescribes at the first face; an incident wave comes along a bar like the first layer."""

RESISTANCE, STIFFNESS, DAMPING, PRELOAD, BRANCHES, INERTIA, DATUM = 0, 1, 2, 3, 4, 5, 6
"""Columns of `Tables.joint_value`: sum of R, spring, dashpot, preload; number of branches; R of a mass on a spring;
indentation under the preload."""
JOINT_VALUES = 7
"""Number of these columns."""
END_OWN, END_WAVE, END_RESISTANCE, END_BETA, END_SIGMA, END_SPRING, END_DAMPING, END_INERTIA = range(8)
"""Places in `Tables.end`: f = own a + wave P; a' = beta f + sigma R v; of a mass on a spring: R of both, dashpot."""
COMPRESSION, RATE, LOST, WORK, GUESS, DEEPEST, GROWTH, OPEN = range(8)
"""Columns of `WaveState.joint`: x and x' (of a joint with mass: w and v; of a mass on a spring: w of spring and mass),
and the energy lost, J; of a nonlinear contact: work done on it, J, last force, deepest indentation, growth of its
radius; and 1 while the joint is open."""
JOINT_STATES = 8
"""Number of these columns."""
SEEN = 1e-12
"""A gap that counts as open, m: below it is the rounding of compressions of some 0.1 mm, added up over many steps."""


class Tables(NamedTuple):
    """A stack on a grid of steps: what does not change while it runs."""

    step: float
    impedance: np.ndarray
    nodes: np.ndarray
    start: np.ndarray
    joint_kind: np.ndarray
    joint_value: np.ndarray
    branch: np.ndarray
    law: np.ndarray
    end: np.ndarray


class WaveState(NamedTuple):
    """Waves in flight, what the joints remember, and when they opened and closed.

    ``clock`` counts steps and events; ``events`` holds joint, time, and 1 where it opened.
    """

    forward: np.ndarray
    backward: np.ndarray
    place: np.ndarray
    joint: np.ndarray
    memory: np.ndarray
    end: np.ndarray
    clock: np.ndarray
    events: np.ndarray


class RigidStriker(NamedTuple):
    """A rigid striker: row of its contact law, mass (kg), speed towards the face (m/s)."""

    law: np.ndarray
    mass: float
    speed: float


class Recording(NamedTuple):
    """Force and velocity at nodes (layer, node), every so many steps, from step 0 on."""

    nodes: np.ndarray
    every: int
    force: np.ndarray
    velocity: np.ndarray


class Averages(NamedTuple):
    """Averages at nodes (layer, node) over all steps about each kept one, so that none between two of them is lost.

    ``velocity`` of the taps is the mean from a kept step to the next one; ``force`` on the faces is weighted by the hat
    function of a kept step, which falls in a straight line to zero at both its neighbours.
    """

    taps: np.ndarray
    faces: np.ndarray
    every: int
    velocity: np.ndarray
    force: np.ndarray


@leaf_kernel
def wrapped(place, nodes):
    """Return a place in a ring that may have run one round over its end."""
    return place if place < nodes else place - nodes


@leaf_kernel
def arriving_at_face(tables, state):
    """Return the backward wave that arrives at the loaded face in the step to come."""
    nodes = tables.nodes[0]
    return state.backward[tables.start[0] + (state.place[0] + 2) % nodes]


@leaf_kernel
def elastic_joint(tables, state, i, b, y):
    """Return the force of a spring with dashpot and Maxwell branches."""
    value = tables.joint_value[i]
    own = 0.0
    count = int(value[BRANCHES])
    for j in range(count):
        own += state.memory[i, j]
    f = (own + value[RESISTANCE] * b) / (1.0 + value[RESISTANCE] * y)
    rate = b - y * f
    lost = value[DAMPING] * rate * rate
    for j in range(count):
        resistance, beta = tables.branch[i, j, 0], tables.branch[i, j, 1]
        own = state.memory[i, j] + resistance * rate
        state.memory[i, j] = beta * own + resistance * rate
        lost += 0.5 * own * own * (1.0 - beta) / resistance
    state.joint[i, LOST] += tables.step * lost
    state.joint[i, COMPRESSION] += 0.5 * tables.step * (state.joint[i, RATE] + rate)
    state.joint[i, RATE] = rate
    return f


@leaf_kernel
def unilateral_joint(tables, state, i, b, y):
    """Return the force of a joint that pushes only, and move its compression (below zero: open).

    A rigid one closes within the step in which its gap would turn negative, and loses what that step cuts off.
    """
    value, step = tables.joint_value[i], tables.step
    x = state.joint[i, COMPRESSION]
    if value[STIFFNESS] == np.inf:
        f = max((b + x / step) / y, -value[PRELOAD])  # the force that just closes the gap at the end of the step
        rate = b - y * f
        state.joint[i, RATE] = rate
        state.joint[i, COMPRESSION] = min(x + step * rate, 0.0)
        state.joint[i, LOST] += step * (f + value[PRELOAD]) * rate
        note_gap(tables, state, i, -state.joint[i, COMPRESSION])
        return f
    ahead = x + 0.5 * step * state.joint[i, RATE]  # the trapezoidal rule, but for the rate to come
    r = 0.5 * step * value[STIFFNESS] + value[DAMPING]
    f = (value[STIFFNESS] * ahead + r * b) / (1.0 + r * y)
    touching = value[STIFFNESS] * (ahead + 0.5 * step * (b - y * f)) > -value[PRELOAD]
    if not touching or f < -value[PRELOAD]:
        f = -value[PRELOAD]
    rate = b - y * f
    middle = ahead + 0.5 * step * rate
    # the dashpot's part: where it would pull, what the spring still gives back is lost in it
    state.joint[i, LOST] += step * (f - max(value[STIFFNESS] * middle, -value[PRELOAD])) * rate
    state.joint[i, COMPRESSION] = middle
    state.joint[i, RATE] = rate
    note_gap(tables, state, i, -middle - value[PRELOAD] / value[STIFFNESS])
    return f


@called_kernel
def contact_joint(tables, state, i, b, y):
    """Return the force of a nonlinear contact that pushes only, counted from its preload, and press it on.

    It is elastic, with a damper that never pulls, or beyond its yield load plastic; what has yielded stays.
    """
    value, law, own = tables.joint_value[i], tables.law[i], state.joint[i]
    preload, half, was = value[PRELOAD], 0.5 * tables.step, value[DATUM] + own[COMPRESSION]
    ahead = was + half * own[RATE]
    push = contact_force(law, ahead, half, 1.0, own[DEEPEST], own[GROWTH], b + preload * y, y, own[GUESS])
    rate = b - y * (push - preload)
    d = ahead + half * rate
    power, yielded = losses(law, d, rate, push, own[DEEPEST], own[GROWTH])
    own[LOST] += yielded
    if law[DAMPER] > 0.0:
        own[LOST] += tables.step * power
    own[WORK] += tables.step * (push - preload) * rate
    if d > own[DEEPEST] and law[YIELD_LOAD] < np.inf:  # an elastic law remembers nothing
        own[DEEPEST], own[GROWTH] = d, flattening(law, d)
    own[COMPRESSION], own[RATE], own[GUESS] = d - value[DATUM], rate, push
    note_gap(tables, state, i, residual(own[DEEPEST], own[GROWTH]) - d)
    return push - preload


@leaf_kernel
def note_gap(tables, state, i, gap):
    """Note the time at which a joint opens or closes."""
    opened = 1.0 if gap > SEEN else 0.0
    if opened != state.joint[i, OPEN]:
        k = state.clock[1]
        if k < state.events.shape[0]:  # a chatter is counted on, not written down
            state.events[k, 0], state.events[k, 1], state.events[k, 2] = i, state.clock[0] * tables.step, opened
        state.clock[1] += 1
        state.joint[i, OPEN] = opened


@leaf_kernel
def hung_mass(spring, damping, inertia, w, q):
    """Return own and R of a mass on a spring, whose force on what carries it is own + R v.

    w and q are the states of spring and mass: spring g = w + R1 (v - u) with its dashpot, mass g = R2 u - q.
    """
    stiff = spring + damping
    share = 1.0 / (1.0 + stiff / inertia)
    return share * (w - stiff * q / inertia), share * stiff


@leaf_kernel
def swing(spring, damping, inertia, v, states):
    """Move a mass on a spring on, given the speed v of what carries it; return the power lost in its dashpot, W."""
    w, q = states[0], states[1]
    own, resistance = hung_mass(spring, damping, inertia, w, q)
    u = (own + resistance * v + q) / inertia
    states[0], states[1] = w + 2.0 * spring * (v - u), 2.0 * inertia * u - q
    return damping * (v - u) ** 2


@leaf_kernel
def oscillator_joint(tables, state, i, p, m):
    """Return the forces before and behind bonded faces that carry a mass on a spring."""
    z1, z2, value = tables.impedance[i], tables.impedance[i + 1], tables.joint_value[i]
    states = state.joint[i]
    spring, damping, inertia = value[RESISTANCE], value[DAMPING], value[INERTIA]
    own, resistance = hung_mass(spring, damping, inertia, states[0], states[1])
    v = (2.0 * p - 2.0 * m - own) / (z1 + z2 + resistance)
    states[LOST] += tables.step * swing(spring, damping, inertia, v, states)
    return 2.0 * p - z1 * v, 2.0 * m + z2 * v


@leaf_kernel
def end_force(tables, state, p, z):
    """Return the force of the stack on its end, and move the end on."""
    end = tables.end
    if end[END_INERTIA] > 0.0:
        spring, damping, inertia = end[END_SPRING], end[END_DAMPING], end[END_INERTIA]
        own, resistance = hung_mass(spring, damping, inertia, state.end[0], state.end[1])
        v = (2.0 * p - own) / (z + resistance)
        swing(spring, damping, inertia, v, state.end)
        return 2.0 * p - z * v
    f = end[END_OWN] * state.end[0] + end[END_WAVE] * p
    state.end[0] = end[END_BETA] * f + end[END_SIGMA] * end[END_RESISTANCE] * (2.0 * p - f) / z
    return f


@leaf_kernel
def mass_joint(tables, state, i, p, m):
    """Return the forces before and behind a point mass between bonded faces; their difference drives it."""
    z1, z2, resistance = tables.impedance[i], tables.impedance[i + 1], tables.joint_value[i, RESISTANCE]
    w = state.joint[i, COMPRESSION]
    v = (2.0 * p - 2.0 * m + w) / (z1 + z2 + resistance)
    state.joint[i, COMPRESSION] = 2.0 * resistance * v - w
    state.joint[i, RATE] = v
    return 2.0 * p - z1 * v, 2.0 * m + z2 * v


@leaf_kernel
def sprung_joint(tables, state, i, b, y):
    """Return the force of a joint that gives way."""
    if tables.joint_kind[i] == ELASTIC:
        return elastic_joint(tables, state, i, b, y)
    if tables.joint_kind[i] == UNILATERAL:
        return unilateral_joint(tables, state, i, b, y)
    return contact_joint(tables, state, i, b, y)


@leaf_kernel
def advance(tables, state, face):
    """Move all waves by one step with the wave ``face`` sent in at the loaded face; return the force at the end."""
    layers = tables.nodes.size
    z, start, nodes, place = tables.impedance, tables.start, tables.nodes, state.place
    forward, backward = state.forward, state.backward
    sent = face
    here = wrapped(place[0] + 1, nodes[0])
    state.clock[0] += 1
    for i in range(layers - 1):
        there = wrapped(place[i + 1] + 1, nodes[i + 1])
        p = forward[start[i] + wrapped(here + 1, nodes[i])]
        m = backward[start[i + 1] + wrapped(there + 1, nodes[i + 1])]
        z1, z2 = z[i], z[i + 1]
        kind = tables.joint_kind[i]
        if kind == BONDED:  # by itself: most joints are, and the general law would divide by an infinite stiffness
            f = 2.0 * (z2 * p + z1 * m) / (z1 + z2)
            g = f
        elif kind == MASS:
            f, g = mass_joint(tables, state, i, p, m)
        elif kind == OSCILLATOR:
            f, g = oscillator_joint(tables, state, i, p, m)
        else:
            f = g = sprung_joint(tables, state, i, 2.0 * (p / z1 + m / z2), 1.0 / z1 + 1.0 / z2)
        forward[start[i] + here] = sent
        backward[start[i] + here] = f - p
        place[i] = here
        sent = g - m
        here = there
    last = layers - 1
    p = forward[start[last] + wrapped(here + 1, nodes[last])]
    f = end_force(tables, state, p, z[last])
    forward[start[last] + here] = sent
    backward[start[last] + here] = f - p
    place[last] = here
    return f


@leaf_kernel
def force_and_velocity(tables, state, layer, node):
    """Return force and velocity at a node of a layer after the last step; node 0 is its first face."""
    nodes, here = tables.nodes[layer], state.place[layer]
    ahead = here - node
    behind = here - (nodes - 1 - node)
    p = state.forward[tables.start[layer] + (ahead if ahead >= 0 else ahead + nodes)]
    m = state.backward[tables.start[layer] + (behind if behind >= 0 else behind + nodes)]
    return p + m, (p - m) / tables.impedance[layer]


class Extremes(NamedTuple):
    """Least and greatest force at nodes (layer, node), looked at every so many steps."""

    nodes: np.ndarray
    every: int
    least: np.ndarray
    greatest: np.ndarray


@leaf_kernel
def widen(tables, state, extremes, n):
    """Take the forces after step n into the extremes."""
    if n % extremes.every != 0:
        return
    for k in range(extremes.nodes.shape[0]):
        f, _ = force_and_velocity(tables, state, extremes.nodes[k, 0], extremes.nodes[k, 1])
        extremes.least[k] = min(extremes.least[k], f)
        extremes.greatest[k] = max(extremes.greatest[k], f)


@leaf_kernel
def record(tables, state, recording, n):
    """Write what the nodes of a recording hold after step n."""
    row = n // recording.every
    if n != row * recording.every or row >= recording.force.shape[0]:
        return
    for k in range(recording.nodes.shape[0]):
        f, v = force_and_velocity(tables, state, recording.nodes[k, 0], recording.nodes[k, 1])
        recording.force[row, k], recording.velocity[row, k] = f, v


@leaf_kernel
def gather(tables, state, averages, n):
    """Take what the nodes of averages hold after step n into the rows about it."""
    every, rows = averages.every, averages.force.shape[0]
    row = n // every
    phase = n - row * every
    part = 1.0 / every
    later = part * phase / every
    for k in range(averages.faces.shape[0]):
        f, _ = force_and_velocity(tables, state, averages.faces[k, 0], averages.faces[k, 1])
        if row < rows:
            averages.force[row, k] += (part - later) * f
        if row + 1 < rows:
            averages.force[row + 1, k] += later * f
    for k in range(averages.taps.shape[0]):
        _, v = force_and_velocity(tables, state, averages.taps[k, 0], averages.taps[k, 1])
        if row < rows:  # a kept step belongs by halves to the mean before and the one after it
            averages.velocity[row, k] += part * v if phase > 0 else 0.5 * part * v
        if phase == 0 and 0 < row <= rows:
            averages.velocity[row - 1, k] += 0.5 * part * v


@leaf_kernel
def unilateral_energy(tables, state, i):
    """Return the energy in the spring of a unilateral joint and in the bolt that its opening pulls, J."""
    value, x = tables.joint_value[i], state.joint[i, COMPRESSION]
    if value[STIFFNESS] == np.inf:
        return -value[PRELOAD] * x
    x += 0.5 * tables.step * state.joint[i, RATE]
    pulled = min(x + value[PRELOAD] / value[STIFFNESS], 0.0)
    return 0.5 * value[STIFFNESS] * (x - pulled) ** 2 - value[PRELOAD] * pulled


@leaf_kernel
def swing_energy(step, spring, inertia, states):
    """Return the energy of a mass on a spring, J: w^2 dt/(4 R1) + q^2 dt/(4 R2)."""
    return 0.25 * step * (states[0] ** 2 / spring + states[1] ** 2 / inertia)


@leaf_kernel
def energy(tables, state):
    """Return the energy of the waves in flight, of springs and of masses, J."""
    total = 0.0
    for i in range(tables.nodes.size):
        nodes = tables.nodes[i]
        arrived = wrapped(state.place[i] + 1, nodes)
        for j in range(nodes):
            if j != arrived:  # it has gone on as the wave that left the joint: not twice
                p, m = state.forward[tables.start[i] + j], state.backward[tables.start[i] + j]
                total += (p * p + m * m) * tables.step / tables.impedance[i]
    for i in range(tables.joint_kind.size):
        value = tables.joint_value[i]
        if tables.joint_kind[i] == MASS:
            total += tables.step * state.joint[i, COMPRESSION] ** 2 / (4.0 * value[RESISTANCE])
        elif tables.joint_kind[i] == ELASTIC:
            for j in range(int(value[BRANCHES])):
                resistance, beta = tables.branch[i, j, 0], tables.branch[i, j, 1]
                total += state.memory[i, j] ** 2 * tables.step / (2.0 * resistance * (1.0 + beta))
        elif tables.joint_kind[i] == UNILATERAL:
            total += unilateral_energy(tables, state, i)
        elif tables.joint_kind[i] == OSCILLATOR:
            total += swing_energy(tables.step, value[RESISTANCE], value[INERTIA], state.joint[i])
        elif tables.joint_kind[i] == CONTACT:
            total += state.joint[i, WORK] - state.joint[i, LOST]
    if tables.end[END_INERTIA] > 0.0:
        total += swing_energy(tables.step, tables.end[END_SPRING], tables.end[END_INERTIA], state.end)
    elif tables.end[END_BETA] != 0.0:
        total += state.end[0] ** 2 * tables.step / (4.0 * tables.end[END_RESISTANCE])
    return total


@leaf_kernel
def momentum(tables, state):
    """Return the momentum of waves in flight and point masses between layers, N s."""
    total = 0.0
    for i in range(tables.nodes.size):
        arrived = wrapped(state.place[i] + 1, tables.nodes[i])
        for j in range(tables.nodes[i]):
            if j != arrived:
                total += (state.forward[tables.start[i] + j] - state.backward[tables.start[i] + j]) * tables.step
    for i in range(tables.joint_kind.size):
        if tables.joint_kind[i] == MASS:
            total += 0.5 * tables.step * state.joint[i, COMPRESSION]
        elif tables.joint_kind[i] == OSCILLATOR:
            total += 0.5 * tables.step * state.joint[i, 1]
    return total


@leaf_kernel
def rates(values, history):
    """Move a history of four values on by one and return its first, second and third difference."""
    history[3], history[2], history[1], history[0] = history[2], history[1], history[0], values
    first = history[0] - history[1]
    second = history[0] - 2.0 * history[1] + history[2]
    return first, second, second - (history[1] - 2.0 * history[2] + history[3])


@leaf_kernel
def watch(tables, sent, returning, through, left, histories, norms, integrals):
    """Follow the energy norms of the first three time derivatives of all waves: time integrals, largest values.

    Waves move unchanged and joints only lose, so what entered at both faces bounds each norm. ``sent`` and
    ``returning`` are the waves at the loaded face, ``through`` and ``left`` those at the end.
    """
    dt, first, last = tables.step, tables.impedance[0], tables.impedance[tables.impedance.size - 1]
    gains, losses = rates(sent, histories[0]), rates(returning, histories[1])
    outs, backs = rates(through, histories[2]), rates(left, histories[3])
    scale = dt
    for k in range(3):
        scale /= dt * dt
        norms[k] += (gains[k] ** 2 - losses[k] ** 2) * scale / first + (backs[k] ** 2 - outs[k] ** 2) * scale / last
        norm = np.sqrt(max(norms[k], 0.0))  # joints only take: below zero by rounding
        integrals[k] += norm * dt
        integrals[3 + k] = max(integrals[3 + k], norm)


@kernel
def drive(tables, state, load, by, recordings, averages, extremes, integrals):
    """Run a stack under a prescribed load at every step, ``by`` `FORCE`, `SPEED` of the face or `INCIDENT` wave.

    Fills ``integrals`` with the time integrals of the energy norms of the first three time derivatives
    of all waves, and returns the impulse of the load and that given to the end, N s.
    """
    histories, norms = np.zeros((4, 4)), np.zeros(3)
    entered, through = 0.0, 0.0
    last = tables.nodes.size - 1
    for n in range(load.size):
        m = arriving_at_face(tables, state)
        sent = load[n]
        if by == FORCE:
            sent -= m
        elif by == SPEED:
            sent = sent * tables.impedance[0] + m
        f = advance(tables, state, sent)
        entered += (sent + m) * tables.step
        through += f * tables.step
        for recording in recordings:
            record(tables, state, recording, n)
        gather(tables, state, averages, n)
        widen(tables, state, extremes, n)
        f_end, v_end = force_and_velocity(tables, state, last, tables.nodes[last] - 1)
        z = tables.impedance[last]  # (f + z v)/2 arrives at the end, (f - z v)/2 leaves it
        watch(tables, sent, m, 0.5 * (f_end + z * v_end), 0.5 * (f_end - z * v_end), histories, norms, integrals)
    return entered, through


@kernel
def strike(tables, state, striker, steps, recordings, averages, extremes, integrals, touches):
    """Let a rigid striker hit the stack at step 0, and follow both for so many steps.

    Fills ``touches`` (begin, end, approach speed of each contact) and returns how many there were, the speed
    of the striker, the impulse on the stack, that on its end, the energy lost in the contact, and the deepest
    indentation.
    """
    dt, z, law, mass = tables.step, tables.impedance[0], striker.law, striker.mass
    histories, norms, contact = np.zeros((4, 4)), np.zeros(3), np.empty(CONTACT_SIZE)
    last = tables.nodes.size - 1
    begin_contact(law, contact, striker.speed, depth_at_yield(law))
    v, entered, through = striker.speed, 0.0, 0.0
    for n in range(steps):
        m = arriving_at_face(tables, state)
        inertia = 0.5 * dt / mass if n > 0 else 0.0  # at first touch nothing has moved yet
        free = v - inertia * contact[_press_kernels.FORCE]
        force = press(law, contact, touches, n * dt, dt, free + 2.0 * m / z, inertia + 1.0 / z)
        v = free - inertia * force
        f = advance(tables, state, force - m)
        entered += force * dt
        through += f * dt
        for recording in recordings:
            record(tables, state, recording, n)
        gather(tables, state, averages, n)
        widen(tables, state, extremes, n)
        f_end, v_end = force_and_velocity(tables, state, last, tables.nodes[last] - 1)
        ze = tables.impedance[last]
        watch(tables, force - m, m, 0.5 * (f_end + ze * v_end), 0.5 * (f_end - ze * v_end), histories, norms, integrals)
    count = int(contact[COUNT])
    if contact[CLOSED] > 0.0 and count <= touches.shape[0]:
        touches[count - 1, 1] = steps * dt
    return count, v, entered, through, contact[_press_kernels.LOST], contact[_press_kernels.DEEPEST]
