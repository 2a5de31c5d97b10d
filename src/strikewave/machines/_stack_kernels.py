"""Compiled blow on a stack: strikers, turntable, contact law and delay lines together, step by step.

The stack moves in a frame of its own that starts with the object's speed and falls with gravity; waves are
what differs from it. The machine's bodies follow the trapezoidal rule with the contact force of this step
found as in `strikewave.waves._press_kernels`; spring, damper, stop and rail friction act on the far end of the stack.
"""

from typing import NamedTuple

import numpy as np

from strikewave.base.compiled import kernel, leaf_kernel
from strikewave.contact._chain_kernels import MASS, PLACE, SPEED
from strikewave.contact._law_kernels import stored
from strikewave.machines._kernels import (
    ACROSS,
    HALF_FACE,
    RETRACTING,
    STROKE,
    machine_rates,
    own_switch,
    own_switches,
    side_force,
    sliding_arm,
    turning_inertia,
)
from strikewave.machines._layout import APEX_SWITCH, FEED_SWITCH, layout_of
from strikewave.waves._kernels import (
    END_BETA,
    END_OWN,
    END_RESISTANCE,
    END_SIGMA,
    END_WAVE,
    advance,
    arriving_at_face,
    force_and_velocity,
    gather,
    record,
)
from strikewave.waves._press_kernels import (
    CLOSED,
    CONTACT_SIZE,
    COUNT,
    DEEPEST,
    DEPTH,
    FORCE,
    LOST,
    QUIET,
    begin_contact,
    press,
)
from strikewave.waves._press_kernels import POWER as POWER_LOST

(
    CONTACT_FORCE,
    FACE_PLACE,
    NOSE_PLACE,
    NOSE_SPEED,
    ASSEMBLY_PLACE,
    ASSEMBLY_SPEED,
    TURNTABLE_ANGLE,
    TURNTABLE_SPEED,
    STRIKER_SPEED,
    FACE_SPEED,
    CONTACT_IMPULSE,
    END_IMPULSE,
    INDENTATION,
    SIDE_FORCE,
    SIDE_IMPULSE,
    FRICTION_HEAT,
) = range(16)
"""Columns of the history of a blow; nose and assembly by the mean of what they consist of."""
COLUMNS = 16

DRAGGING, BRAKING, HEATING, ACROSS_IMPULSE = 0, 1, 2, 3
"""Places of what a sliding nose does: force, N, slowing of the turntable, rad/s^2, power, W, impulse, N s."""

SETTLED, CROWDED, ENDLESS = 0, 1, 2
"""Ends of a blow: all quiet; two strikers in touch at once; the history is full."""


class Supports(NamedTuple):
    """Hold of the far end on the carriage: heavy-load spring with damper, stop, rail friction; SI."""

    spring: float
    preload: float
    damper: float
    rest: float
    stop: float
    stop_damping: float
    stop_offset: float
    sliding: float
    sticking: float


class StackBlow(NamedTuple):
    """One blow on a stack: who strikes, from where, and how long to follow it; SI."""

    striker: int
    approach: float
    time: float
    speed: float
    gravity: float
    face: float
    end: float
    first_of_assembly: int
    nose_mass: float
    assembly_mass: float
    nose_speed: float
    assembly_speed: float
    settle: float
    every: int
    deepest: float


class BlowNotes(NamedTuple):
    """Tables that a blow fills: its history, its touches, and the switches of the machine (which, time)."""

    history: np.ndarray
    touches: np.ndarray
    switches: np.ndarray


@leaf_kernel
def rub(supports, tables, state, share, slip):
    """Add rail friction to what holds the end of the stack, and return it, N.

    ``slip`` is what the end's speed on the carriage would be in this step but for the wave and its reflection. With
    v = (2 p - f)/z and f = share (a + F) + ... the friction F = v z/share would stop the end.
    """
    if supports.sticking == 0.0:
        return 0.0
    last = tables.nodes.size - 1
    nodes, z = tables.nodes[last], tables.impedance[last]
    p = state.forward[tables.start[last] + (state.place[last] + 2) % nodes]
    f = share * state.end[0] + tables.end[END_WAVE] * p
    stops = (slip + (2.0 * p - f) / z) * z / share
    friction = stops
    if abs(stops) > supports.sticking:
        friction = supports.sliding if stops > 0.0 else -supports.sliding
    state.end[0] += friction
    return friction


@leaf_kernel
def hold(supports, tables, state, place, frame, wave, carriage, carriage_speed):
    """Set the end of the stack to f = a + R v of all that holds it; return the parts of a of spring and friction.

    ``frame`` and ``wave`` are the speeds of the frame and, a step ago, of the end in it.
    """
    d, rate = place - carriage - supports.rest, frame - carriage_speed
    spring, resistance = supports.preload + supports.spring * d + supports.damper * rate, supports.damper
    deep = carriage - place - supports.stop_offset
    stop = 0.0
    if deep > 0.0 and supports.stop * deep > supports.stop_damping * (rate + wave):  # it never pulls
        stop = supports.stop * deep - supports.stop_damping * rate
        resistance += supports.stop_damping
    z = tables.impedance[tables.impedance.size - 1]
    share = 1.0 / (1.0 + resistance / z)
    tables.end[END_OWN], tables.end[END_WAVE] = share, 2.0 * resistance / z * share
    tables.end[END_RESISTANCE], tables.end[END_BETA], tables.end[END_SIGMA] = resistance, 0.0, 0.0
    state.end[0] = spring - stop
    return spring, rub(supports, tables, state, share, rate)


@leaf_kernel
def move_machine(system, t, dt, y, mode, memory, push, braked, rates):
    """Move strikers and turntable to time t by the trapezoidal rule; ``push`` (N) acts back on each striker.

    ``braked`` is the rate at which a nose that slides slows the turntable, rad/s^2; ``rates`` holds the rates a step
    ago and takes the new ones.
    """
    at, bodies = layout_of(system), system.chain.bodies
    old, new = rates[0], rates[1]
    # a prediction by the rates a step ago, then their mean with the new ones; push and braking last the whole step
    old[at.turntable_speed] -= braked
    x, v, old_v, new_v = y[at.positions], y[at.speeds], old[at.speeds], new[at.speeds]
    for i in range(x.size):
        old_v[i] -= push[i] / bodies[i, MASS]
        x[i] += dt * (v[i] + 0.5 * dt * old_v[i])
        v[i] += dt * old_v[i]
    y[at.angle] += dt * (y[at.turntable_speed] + 0.5 * dt * old[at.turntable_speed])
    y[at.turntable_speed] += dt * old[at.turntable_speed]
    y[at.belt_twist] += dt * old[at.belt_twist]
    y[at.motor_speed] += dt * old[at.motor_speed]
    machine_rates(system, t, y, mode, memory, new)
    y[at.turntable_speed] -= 0.5 * dt * braked
    for i in range(x.size):
        v[i] += 0.5 * dt * (new_v[i] - push[i] / bodies[i, MASS] - old_v[i])
    for i in (at.turntable_speed, at.belt_twist, at.motor_speed):
        y[i] += 0.5 * dt * (new[i] - old[i])
    energies, old_power, new_power = y[at.energies], old[at.energies], new[at.energies]
    for i in range(energies.size):
        energies[i] += 0.5 * dt * (old_power[i] + new_power[i])
    for i in range(y.size):
        old[i] = new[i]


@leaf_kernel
def rub_face(system, striker, normal, half, y, side):
    """Let a nose that pushes (N) slide across the face to the end of half a step, s; book impulse (N s) and heat (J).

    ``side`` holds the side force, the rate at which it slows the turntable, its power and its impulse, all a step ago
    and then now; as the push of the contact, each acts half a step before and half a step after.
    """
    at, arm = layout_of(system), sliding_arm(system, striker)
    force = side_force(system.settings, normal, arm * y[at.turntable_speed])
    braking = force * arm / turning_inertia(system)
    y[at.turntable_speed] += half * (side[BRAKING] - braking)
    power = force * arm * y[at.turntable_speed]
    y[at.rubbed] += half * (side[HEATING] + power)
    side[ACROSS_IMPULSE] += half * (side[DRAGGING] + force)
    side[DRAGGING], side[BRAKING], side[HEATING] = force, braking, power


@leaf_kernel
def switch_machine(system, t, y, mode, memory, g, switches, changed):
    """Let drive, feed and passing strikers change their modes; list the changes; return how many there are."""
    at = layout_of(system)
    own = g[at.own_switches]
    own_switches(system, t, y, mode, memory, own)
    for k in range(APEX_SWITCH + 1):
        # the end of a run is left to the bodies after the blow
        ends = k == FEED_SWITCH and (mode[at.feed] == RETRACTING or system.settings[STROKE] == 0.0)
        if own[k] < 0.0 and not ends:
            own_switch(system, k, t, y, mode, memory)
            if changed < switches.shape[0]:
                switches[changed, 0], switches[changed, 1] = k, t
            changed += 1
    return changed


@leaf_kernel
def slip_off(law, contact, touches, t, dt):
    """End a contact whose striker has left the face: what it stores is lost."""
    if contact[CLOSED] > 0.0:
        contact[LOST] += stored(law, contact[DEPTH], contact[DEEPEST])
        k = int(contact[COUNT]) - 1
        if k < touches.shape[0]:
            touches[k, 1] = t
    contact[FORCE], contact[CLOSED], contact[POWER_LOST] = 0.0, 0.0, 0.0
    contact[QUIET] += dt


@leaf_kernel
def another_touches(system, y, striker, face):
    """Return whether another striker than this one reaches beyond the face, and is before it."""
    touching, half = False, system.settings[HALF_FACE]
    for i in range(system.seats.shape[0]):
        touching = touching or (i != striker and y[i] > face and abs(system.chain.bases[ACROSS, i]) <= half)
    return touching


@kernel
def follow(tables, state, law, machine, supports, blow, recordings, averages, notes):
    """Follow one blow from first touch until it has settled.

    ``machine`` is (system, y, mode, memory) with strikers only, moved on in place. Fills ``notes``, the history every
    so many steps; returns why it ended, the steps made, the numbers of touches and switches, the displacement of the
    end in its frame, the impulse that the waves got, energies (lost in stop, damper, rail and contact, given by the
    feed, half of what first and last step push the end), and the deepest indentation.
    """
    system, y, mode, memory = machine
    history, touches, switches = notes.history, notes.touches, notes.switches
    at, bases, s = layout_of(system), system.chain.bases, blow.striker
    speeds, g = y[at.speeds], np.empty(at.switches)
    dt, z, last = tables.step, tables.impedance[0], tables.nodes.size - 1
    rates, push, contact = np.empty((2, y.size)), np.zeros(speeds.size), np.empty(CONTACT_SIZE)
    side = np.zeros(4)
    mass = system.chain.bodies[s, MASS]
    machine_rates(system, blow.time, y, mode, memory, rates[0])
    begin_contact(law, contact, blow.approach, blow.deepest)
    u_face, u_end, u_nose, u_assembly, v_face, v_end = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    v_nose, v_assembly = blow.nose_speed, blow.assembly_speed
    was_force, was_in, was_end, was_carried = 0.0, 0.0, 0.0, 0.0
    was_damped, was_stopped, was_rubbed = 0.0, 0.0, 0.0
    entered, through, net = 0.0, 0.0, 0.0
    lost_stop, lost_damper, lost_rail, fed, push_ends = 0.0, 0.0, 0.0, 0.0, 0.0
    why, changed, n = ENDLESS, 0, 0
    while n < history.shape[0] * blow.every:
        t, since = blow.time + n * dt, n * dt
        frame, fallen = blow.speed + blow.gravity * since, (blow.speed + 0.5 * blow.gravity * since) * since
        m = arriving_at_face(tables, state)
        inertia, half = 0.0, 0.0
        # machine, contact, side force, then waves: each needs the force of this step from the one before it
        if n > 0:  # at first touch nothing has moved yet
            inertia, half = 0.5 * dt / mass, 0.5 * dt
            push[s] = contact[FORCE]
            move_machine(system, t, dt, y, mode, memory, push, side[BRAKING], rates)
        free = speeds[s] + inertia * contact[FORCE]
        force = 0.0
        if abs(bases[ACROSS, s]) <= system.settings[HALF_FACE]:
            force = press(law, contact, touches, t, dt, free - frame + 2.0 * m / z, inertia + 1.0 / z)
        else:
            slip_off(law, contact, touches, t, dt)
        speeds[s] = free - inertia * force
        rub_face(system, s, force, half, y, side)

        carriage, carriage_speed = bases[PLACE, at.carriage], bases[SPEED, at.carriage]
        # by the speed of the step before: the force of the spring hardly changes in a step
        place = blow.end + fallen + u_end + dt * v_end
        spring, friction = hold(supports, tables, state, place, frame, v_end, carriage, carriage_speed)
        f_end = advance(tables, state, force - m)
        _, v_new = force_and_velocity(tables, state, last, tables.nodes[last] - 1)
        f_in, _ = force_and_velocity(tables, state, blow.first_of_assembly, 0)
        v_now = (force - 2.0 * m) / z
        u_face += half * (v_face + v_now)
        u_end += half * (v_end + v_new)
        v_face, v_end = v_now, v_new

        rate, deep = frame + v_end - carriage_speed, carriage - place - supports.stop_offset
        damped, stopped = supports.damper * rate * rate, 0.0
        if deep > 0.0:
            stopped = (supports.stop * deep - (spring + friction + supports.damper * v_end - f_end)) * rate
        rubbed = friction * (frame + v_new - carriage_speed)
        if n > 0:
            kick = half * (was_force + force - was_in - f_in) / blow.nose_mass
            u_nose += dt * (v_nose + 0.5 * kick)
            v_nose += kick
            kick = half * (was_in + f_in - was_end - f_end) / blow.assembly_mass
            u_assembly += dt * (v_assembly + 0.5 * kick)
            v_assembly += kick
            entered += half * (was_force + force)
            through += half * (was_end + f_end)
            fed -= half * (was_carried + f_end * carriage_speed)
            lost_damper += half * (was_damped + damped)
            lost_stop += half * (was_stopped + stopped)
            lost_rail += half * (was_rubbed + rubbed)
        else:
            push_ends = 0.5 * dt * f_end * v_end
        was_force, was_in, was_end = force, f_in, f_end
        was_carried, was_damped, was_stopped, was_rubbed = f_end * carriage_speed, damped, stopped, rubbed
        net += dt * (force - f_end)
        for recording in recordings:
            record(tables, state, recording, n)
        gather(tables, state, averages, n)
        if n % blow.every == 0:
            row = history[n // blow.every]
            row[CONTACT_FORCE] = force
            row[FACE_PLACE], row[FACE_SPEED] = blow.face + fallen + u_face, frame + v_face
            row[NOSE_PLACE], row[NOSE_SPEED] = blow.face + fallen + u_nose, frame + v_nose
            row[ASSEMBLY_PLACE], row[ASSEMBLY_SPEED] = blow.end + fallen + u_assembly, frame + v_assembly
            row[TURNTABLE_ANGLE], row[TURNTABLE_SPEED] = y[at.angle], y[at.turntable_speed]
            row[STRIKER_SPEED] = speeds[s]
            row[CONTACT_IMPULSE], row[END_IMPULSE] = entered, through
            row[INDENTATION] = max(contact[DEPTH], 0.0)
            row[SIDE_FORCE], row[SIDE_IMPULSE], row[FRICTION_HEAT] = side[DRAGGING], side[ACROSS_IMPULSE], y[at.rubbed]
        changed = switch_machine(system, t, y, mode, memory, g, switches, changed)
        n += 1
        if (n - 1) % blow.every == 0:  # at kept steps alone: it costs as much as a step
            crowded = another_touches(system, y, s, blow.face + fallen + u_face)
            if crowded or contact[QUIET] > blow.settle:
                why = CROWDED if contact[CLOSED] > 0.0 else SETTLED
                break
    push_ends += 0.5 * dt * was_end * v_end
    energies = (lost_stop, lost_damper, lost_rail, contact[LOST], fed, push_ends)
    return why, n, int(contact[COUNT]), changed, u_end, net, energies, contact[DEEPEST]
