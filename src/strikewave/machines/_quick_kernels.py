"""Compiled fast run of the rotary machine: rigid between blows, whole bodies within them.

While it coasts, the object is one body on spring, damper, stop and rail, and every striker rides on its steady circle
of radius R / (1 - m w^2/k). At first touch the striker that touches, its mount, nose, frame, assembly, supports and
turntable are followed as `_kernels` has them, the other strikers still riding; once all is quiet they are one body
and riders again, with their momentum and mean places. What still rings is let go, and counted.
"""

import math
from typing import NamedTuple

import numpy as np
from numba.extending import overload

from strikewave.base.compiled import LEAF, called_kernel, kernel, leaf_kernel
from strikewave.contact import _integrator
from strikewave.contact._chain_kernels import (
    GRAVITY,
    KIND,
    MASS,
    OPEN,
    PLACE,
    PUSHING,
    SLIDING,
    SLIDING_BACK,
    SPEED,
    STICKING,
    STOP_LINK,
    SWITCHES,
    chain_forces,
    frictionless,
    is_a,
    link_force,
    link_motion,
    link_switch,
    link_switches,
)
from strikewave.contact._integrator import CONTINUE, END, FULL, STOP, STOPPED, Record, advance
from strikewave.contact._law_kernels import PRELOAD, SPOT, STIFFNESS, residual
from strikewave.machines._kernels import (
    ALONG,
    APEX_SWITCH,
    ASIDE,
    BELT_STIFFNESS,
    COSINE,
    EDGE,
    FACE_SWITCH,
    FEED_SWITCH,
    FIRST,
    HALF_FACE,
    INERTIA,
    ON_FACE,
    OWN_STATES,
    PASSES,
    REACH,
    SECOND,
    SINE,
    TOUCHED,
    RotarySystem,
    motor_speed,
    own_switch,
    own_switches,
    place_bases,
    rotary_rates,
)
from strikewave.machines._note_kernels import (
    LET_GO,
    ROWS_USED,
    measure_row,
    missed_row,
    note_blow,
    note_coast,
    open_row,
    repeats,
)

QUIET, DONE, STUCK, AT_EDGE, CROWDED, TOO_MANY, LATE = -1, 0, 1, 2, 3, 4, 5
"""Why a run or a blow ended: a blow is over; done; the step shrank to nothing; a striker met the edge of the face;
another striker touched while a blow still rang; more blows than rows; longer than expected."""

RECORD_ROWS = 8
_STRETCH = 3
"""Column of the table of noses after those of the seats: m/k of a striker on its mount, s^2."""


class CoastSystem(NamedTuple):
    """Object as one body on the carriage, and the noses that ride before it; `_kernels` knows the other tables."""

    bodies: np.ndarray
    bases: np.ndarray
    joins: np.ndarray
    values: np.ndarray
    seats: np.ndarray
    settings: np.ndarray
    noses: np.ndarray
    left: np.ndarray
    frame: np.ndarray


class Riders(NamedTuple):
    """What the strikers differ in, one row each: law of the contact, mount, seat, mass, and how their spot yielded."""

    laws: np.ndarray
    mounts: np.ndarray
    seats: np.ndarray
    masses: np.ndarray
    deepest: np.ndarray
    growth: np.ndarray


class Part(NamedTuple):
    """Where one of the two systems stands, and the steps it has just made."""

    y: np.ndarray
    mode: np.ndarray
    memory: np.ndarray
    record: Record


class Train(NamedTuple):
    """How to run: ringing share at which a blow is over, and the energy that it is a share of, J.

    ``most`` passes end the run (0: the retraction does), or blows that repeat within a tolerance (0: never looked at).
    """

    share: float
    energy: float
    most: int
    repeats: float
    least: int


class Machine(NamedTuple):
    """One machine as both systems, and its riders."""

    coast: CoastSystem
    blow: RotarySystem
    riders: Riders


@leaf_kernel
def copy(source, begin, target, place, count):
    """Copy so many entries of one array from a place to a place of another."""
    for k in range(count):
        target[place + k] = source[begin + k]


@leaf_kernel
def larger(settings_speed, stretch):
    """Return the radius of a rider's steady circle over that of its seat, 1 / (1 - w^2 m/k)."""
    return 1.0 / (1.0 - settings_speed * settings_speed * stretch)


@leaf_kernel
def nose_motion(system, i, theta, speed):
    """Return place and speed along the blow and place across it of a nose that rides, m, m/s, m."""
    nose, settings = system.noses[i], system.settings
    sine, cosine = math.sin(theta), math.cos(theta)
    along = nose[REACH] * (cosine * nose[COSINE] + sine * nose[SINE])
    across = nose[REACH] * (sine * nose[COSINE] - cosine * nose[SINE])
    circle = larger(speed, nose[_STRETCH])
    return circle * along - settings[ALONG], -circle * across * speed, across + settings[ASIDE]


@leaf_kernel
def bend_of(frame, acceleration):
    """Return how far a frame is bent that pushes its nose steadily, m: m (g - a)/k."""
    return frame[0] * (frame[2] - acceleration) / frame[1]


@called_kernel
def face_of(system, t, y, mode, memory):
    """Return place of the struck face of the coasting object, m: the frame bends as its acceleration wants."""
    place_bases(system, t, y, mode, memory)
    a = frictionless(system.joins, system.values, system.bodies, y, system.bases, mode, memory, 0)
    frame = system.frame
    return y[0] + bend_of(frame, 0.0) * frame[3] + bend_of(frame, a) * (1.0 - frame[3])


@called_kernel
def coast_rates(system, t, y, mode, memory, dy):
    """Fill the time derivative of the whole state: a machine that no striker touches."""
    rotary_rates(system, t, y, mode, memory, dy)


@called_kernel
def coast_switches(system, t, y, mode, memory, g):
    """Fill the switch functions of links, drive, feed, apexes; then of each nose: first touch, edge of the face."""
    links, count = system.joins.shape[0], system.noses.shape[0]
    face = face_of(system, t, y, mode, memory)
    link_switches(system.joins, system.values, system.bodies, y, system.bases, mode, memory, g)
    own_switches(system, t, y[2], motor_speed(system, y), mode, memory, g[SWITCHES * links :])
    first = SWITCHES * links + FACE_SWITCH
    half = system.settings[HALF_FACE]
    for i in range(count):
        before = mode[links + ON_FACE + i]
        place, _, across = nose_motion(system, i, y[2], y[3])
        g[first + i] = face + system.left[i] - place if before else 1.0
        g[first + count + i] = 1.0
        if half < np.inf:
            inside = half - abs(across)
            g[first + count + i] = inside if before else -inside


@called_kernel
def coast_switch(system, k, t, y, mode, memory):
    """Change the mode at switch k; a first touch, an apex and an edge met stop the integration."""
    links, count = system.joins.shape[0], system.noses.shape[0]
    face = face_of(system, t, y, mode, memory)
    if k < SWITCHES * links:
        return link_switch(system.joins, system.values, system.bodies, k, y, system.bases, mode, memory)
    own = k - SWITCHES * links
    if own < FACE_SWITCH:
        code = own_switch(system, own, t, y, mode, memory)
        return STOP if own == APEX_SWITCH else code
    i = (own - FACE_SWITCH) % count
    place, _, _ = nose_motion(system, i, y[2], y[3])
    if own < FACE_SWITCH + count:
        mode[links + TOUCHED] = 1
        mode[links + ON_FACE + count] = i
        return STOP
    mode[links + ON_FACE + i] = 1 - mode[links + ON_FACE + i]
    if mode[links + ON_FACE + i] and place > face + system.left[i]:
        mode[links + EDGE] = i + 1
        return STOP
    return CONTINUE


@overload(_integrator.derivatives, jit_options=LEAF)
def _derivatives(system, t, y, mode, memory, dy):
    def rates(system, t, y, mode, memory, dy):
        coast_rates(system, t, y, mode, memory, dy)

    return rates if is_a(system, CoastSystem) else None


@overload(_integrator.forces, jit_options=LEAF)
def _forces(system, t, y, mode, memory, out):
    def fill(system, t, y, mode, memory, out):
        place_bases(system, t, y, mode, memory)
        chain_forces(system.joins, system.values, system.bodies, y, system.bases, mode, memory, out)

    return fill if is_a(system, CoastSystem) else None


@overload(_integrator.switches, jit_options=LEAF)
def _switches(system, t, y, mode, memory, g):
    def fill(system, t, y, mode, memory, g):
        coast_switches(system, t, y, mode, memory, g)

    return fill if is_a(system, CoastSystem) else None


@overload(_integrator.horizon, jit_options=LEAF)
def _horizon(system, t, y, mode, memory):
    def most(system, t, y, mode, memory):
        return np.inf

    return most if is_a(system, CoastSystem) else None


@overload(_integrator.switch, jit_options=LEAF)
def _switch(system, k, t, y, mode, memory):
    def change(system, k, t, y, mode, memory):
        return coast_switch(system, k, t, y, mode, memory)

    return change if is_a(system, CoastSystem) else None


@leaf_kernel
def spring_energy(joins, values, i, y, bases, bodies):
    """Return the energy that spring or stop i stores, J."""
    d, _ = link_motion(joins, values, i, y, bases, bodies)
    if joins[i, KIND] == STOP_LINK:
        d = max(d, 0.0)
    return values[i, PRELOAD] * d + 0.5 * values[i, STIFFNESS] * d * d


@called_kernel
def rigid_energy(coast, t, part):
    """Return the energy of object and turntable while they coast, J; belt and motor keep theirs."""
    y = part.y
    place_bases(coast, t, y, part.mode, part.memory)
    mass, gravity, frame = coast.bodies[0, MASS], coast.bodies[0, GRAVITY], coast.frame
    centre = y[0] + frame[3] * bend_of(frame, 0.0)
    out = 0.5 * mass * y[1] * y[1] - mass * gravity * centre + 0.5 * coast.settings[INERTIA] * y[3] * y[3]
    for i in range(2):
        out += spring_energy(coast.joins, coast.values, i, y, coast.bases, 1)
    return out


@called_kernel
def blow_energy(blow, t, part):
    """Return the energy of striker, object and turntable in a blow, J, less what the contact stores."""
    y, bodies = part.y, blow.bodies
    place_bases(blow, t, y, part.mode, part.memory)
    first = blow.bases[FIRST, 0]
    out = 0.5 * (blow.settings[INERTIA] - bodies[0, MASS] * first * first) * y[7] * y[7]
    for i in range(3):
        out += 0.5 * bodies[i, MASS] * y[3 + i] * y[3 + i] - bodies[i, MASS] * bodies[i, GRAVITY] * y[i]
    for i in range(1, 5):
        out += spring_energy(blow.joins, blow.values, i, y, blow.bases, 3)
    return out


@called_kernel
def begin_blow(coast, blow, strikers, going, struck, t):
    """Set the bodies of a blow from what coasts to the first touch of the striker that the coasting mode names."""
    links, many, noses = coast.joins.shape[0], blow.joins.shape[0], coast.noses.shape[0]
    i = going.mode[links + ON_FACE + noses]
    y, z = struck.y, going.y
    copy(strikers.laws[i], 0, blow.values[0], 0, blow.values.shape[1])
    copy(strikers.mounts[i], 0, blow.values[1], 0, blow.values.shape[1])
    copy(strikers.seats[i], 0, blow.seats[0], 0, 3)
    blow.bodies[0, 0] = blow.bodies[0, 2] = strikers.masses[i]
    struck.mode[0] = struck.mode[1] = struck.mode[2] = PUSHING
    copy(going.mode, 0, struck.mode, 3, links + ON_FACE)
    struck.mode[many + ON_FACE] = 1
    copy(going.memory, links, struck.memory, many, 2)
    struck.memory[many + 2], struck.memory[2 * many + 2] = strikers.deepest[i], strikers.growth[i]
    face = face_of(coast, t, z, going.mode, going.memory)
    place, speed, _ = nose_motion(coast, i, z[2], z[3])
    frame = coast.frame
    y[0], y[1] = place, face
    y[2] = (z[0] + frame[3] * bend_of(frame, 0.0) - frame[3] * face) / (1.0 - frame[3])
    y[3], y[4], y[5] = speed, z[1], z[1]
    copy(z, 2, y, 6, OWN_STATES)
    copy(z, 6, y, 13, links + 3)
    struck.memory[0] = max(speed - z[1], 0.0)
    return rigid_energy(coast, t, going) - blow_energy(blow, t, struck)


@called_kernel
def ringing(coast, blow, struck, t):
    """Return the energy that rings in the frame, J, and how far the nose that would ride is from the face, m.

    The frame rings about the bend with which it carries its nose; the striker rings about its steady circle. The
    distance is less what both swing; a nose that has left the face is far from it.
    """
    y, bases, frame = struck.y, blow.bases, coast.frame
    place_bases(blow, t, y, struck.mode, struck.memory)
    held = 0.0
    for i in range(3, 5):
        d, rate = link_motion(blow.joins, blow.values, i, y, bases, 3)
        force, _ = link_force(blow.joins[i, KIND], blow.values[i], d, rate, struck.mode[i], 0.0, 0.0, 1.0)
        held += force if blow.joins[i, KIND] == STOP_LINK else -force
    mass = coast.bodies[0, MASS]
    bend = y[1] - y[2] - bend_of(frame, held / mass + frame[2])
    reduced = frame[0] * (1.0 - frame[3])
    of_frame = 0.5 * frame[1] * bend * bend + 0.5 * reduced * (y[4] - y[5]) ** 2
    stiffness, striker = blow.values[1, STIFFNESS], blow.bodies[0, MASS]
    circle = larger(y[7], striker / stiffness)
    rides = bases[PLACE, 0] - (circle - 1.0) * bases[SECOND, 0]
    of_striker = 0.5 * stiffness * (y[0] - rides) ** 2 + 0.5 * striker * (y[3] - circle * bases[SPEED, 0]) ** 2
    swing = math.sqrt(2.0 * of_frame / frame[1]) + math.sqrt(2.0 * of_striker / stiffness)
    apart = (
        y[1]
        - max(rides, y[0])
        + residual(struck.memory[blow.joins.shape[0] + 2], struck.memory[2 * blow.joins.shape[0] + 2])
    )
    before = struck.mode[blow.joins.shape[0] + ON_FACE]
    return of_frame, apart - swing if before else np.inf


@called_kernel
def end_blow(coast, blow, strikers, going, struck, t):
    """Let object and striker coast again, with their momentum and mean places; return the energy let go, J."""
    links, many, noses = coast.joins.shape[0], blow.joins.shape[0], coast.noses.shape[0]
    i = going.mode[links + ON_FACE + noses]
    y, z, frame = struck.y, going.y, coast.frame
    before = blow_energy(blow, t, struck)
    share = frame[3]
    z[0] = share * y[1] + (1.0 - share) * y[2] - share * bend_of(frame, 0.0)
    z[1] = share * y[4] + (1.0 - share) * y[5]
    copy(y, 6, z, 2, OWN_STATES)
    first = blow.bases[FIRST, 0]
    inertia = coast.settings[INERTIA]
    own = inertia - blow.bodies[0, MASS] * first * first
    z[3] = (own * y[7] + first * blow.bodies[0, MASS] * y[3]) / inertia
    if coast.settings[BELT_STIFFNESS] == np.inf:
        z[5] = z[3]
    copy(y, 13, z, 6, links + 3)
    copy(struck.mode, 3, going.mode, 0, links + ON_FACE)
    copy(struck.memory, many, going.memory, links, 2)
    half = coast.settings[HALF_FACE]
    for j in range(noses):
        _, _, across = nose_motion(coast, j, z[2], z[3])
        going.mode[links + ON_FACE + j] = 1 if abs(across) <= half else 0
    _keep_spot(strikers, coast.left, i, struck.memory[many + 2], struck.memory[2 * many + 2])
    place_bases(coast, t, z, going.mode, going.memory)
    if links > 2:
        slips = z[1] - coast.bases[SPEED, 0]
        if going.mode[2] == STICKING:
            z[1] = coast.bases[SPEED, 0]
        else:
            going.mode[2] = SLIDING if slips > 0.0 else SLIDING_BACK
    return before - rigid_energy(coast, t, going)


@leaf_kernel
def _keep_spot(strikers, left, i, deepest, growth):
    """Keep how deep a contact has yielded, for all strikers that share its spot."""
    for j in range(left.size):
        if j == i or (strikers.laws[j, SPOT] > 0.0 and strikers.laws[j, SPOT] == strikers.laws[i, SPOT]):
            strikers.deepest[j], strikers.growth[j] = deepest, growth
            left[j] = residual(deepest, growth)


@called_kernel
def crowded(coast, struck, i):
    """Tell whether another striker than i, which rides, is behind the face while a blow lasts."""
    half = coast.settings[HALF_FACE]
    for j in range(coast.noses.shape[0]):
        place, _, across = nose_motion(coast, j, struck.y[6], struck.y[7])
        if j != i and abs(across) <= half and place > struck.y[1] + coast.left[j]:
            return True
    return False


@kernel
def follow_blow(machine, going, struck, control, train, notes, t):
    """Follow one blow from first touch until all is quiet; return why it came back, and when."""
    coast, blow, riders = machine.coast, machine.blow, machine.riders
    links, noses, many = coast.joins.shape[0], coast.noses.shape[0], blow.joins.shape[0]
    i = going.mode[links + ON_FACE + noses]
    work = np.empty(struck.y.size)
    notes.numbers[LET_GO] += begin_blow(coast, blow, riders, going, struck, t)
    if not open_row(coast, blow, going, struck, notes, t):
        return TOO_MANY, t
    h, count = control.first_step, SWITCHES * many + FACE_SWITCH + 1
    while True:
        why, t, h, steps, _ = advance(blow, control, t, h, struck.y, struck.mode, struck.memory, struck.record, count)
        note_blow(coast, blow, struck, notes, steps, work)
        if why in (_integrator.STUCK, END):
            return STUCK if why == _integrator.STUCK else LATE, t
        if why == STOPPED and struck.mode[many + EDGE]:
            return AT_EDGE, t
        if why == STOPPED:
            break
        if crowded(coast, struck, i):
            return CROWDED, t
        if struck.mode[0] != OPEN:
            continue
        of_frame, apart = ringing(coast, blow, struck, t)
        if apart > 0.0 and of_frame <= train.share * train.energy:
            break
    notes.numbers[LET_GO] += end_blow(coast, blow, riders, going, struck, t)
    measure_row(notes)
    return DONE if why == STOPPED else QUIET, t


@kernel
def run_train(machine, going, struck, controls, train, notes):
    """Run a machine from the valve signal; return why it ended, and when."""
    coast = machine.coast
    links, noses = coast.joins.shape[0], coast.noses.shape[0]
    count = SWITCHES * links + FACE_SWITCH + 2 * noses
    work = np.empty(going.y.size)
    control = controls[0]
    t, h, looked = 0.0, control.first_step, 0
    while True:
        going.mode[links + ON_FACE + noses] = -1
        why, t, h, steps, events = advance(
            coast, controls[0], t, h, going.y, going.mode, going.memory, going.record, count
        )
        note_coast(coast, going, notes, steps, work)
        if why in (_integrator.STUCK, END):
            return STUCK if why == _integrator.STUCK else LATE, t
        if why == FULL:
            continue
        if going.mode[links + EDGE]:
            return AT_EDGE, t
        if going.mode[links + ON_FACE + noses] >= 0:
            code, t = follow_blow(machine, going, struck, controls[1], train, notes, t)
            if code != QUIET:
                return code, t
            h = control.first_step
        elif going.record.event[events - 1, 0] == SWITCHES * links + FEED_SWITCH:
            return DONE, t
        elif not missed_row(coast, going, notes, t, face_of(coast, t, going.y, going.mode, going.memory)):
            return TOO_MANY, t
        rows = notes.counts[ROWS_USED]
        if train.most and going.mode[links + PASSES] >= train.most:
            return DONE, t
        if (
            train.repeats > 0.0
            and rows > max(looked, train.least)
            and repeats(notes.table, rows - 1, train.repeats, noses)
        ):
            return DONE, t
        looked = rows
