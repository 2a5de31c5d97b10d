"""Compiled rotary machine: turntable, strikers on mounts, fed carriage and struck object as one system.

State: positions and speeds of the bodies (strikers, then the chain of the object), turntable angle and
speed, belt twist and motor speed, then energies: dissipated in each link, work of the drive, lost in drag and
belt, work of the feed.
Bases: one a striker (where the turntable carries its mount), then the carriage.

With u = theta - (own angle of the striker) - (angle of the blow from the radius), a striker on its circle of radius
R stands at f = R cos u - R0 cos(blow angle) along the blow and s = R sin u + R0 sin(blow angle) across it, both 0 at
the strike position of a striker without errors. With the striker's motion along the blow in its own coordinate, the
turntable keeps the inertia J(theta) = I - sum m f'^2 and obeys

    J theta'' = T_belt - T_drag - T_weight + sum f' F_mount + theta'^2 sum m f' f''

where F_mount is the force of the mount on the turntable along the blow. This is Lagrange's equation,
so energy is kept. On a rigid belt the motor turns with the turntable and I holds its inertia.
"""

import math
from typing import NamedTuple

import numpy as np
from numba.extending import overload

from strikewave.base.compiled import LEAF, kernel, leaf_kernel
from strikewave.contact import _integrator
from strikewave.contact._chain_kernels import (
    ACCELERATION,
    FORCE,
    OPEN,
    PLACE,
    SPEED,
    SWITCHES,
    YIELDING,
    chain_forces,
    chain_rates,
    is_a,
    link_motion,
    link_switch,
    link_switches,
    remember,
    spot_of,
)
from strikewave.contact._integrator import CONTINUE, RESTART, STOP
from strikewave.contact._law_kernels import residual, stored

DRIVE, FEED, PASSES, TOUCHED, EDGE, ON_FACE = 0, 1, 2, 3, 4, 5
"""Places of the machine's own modes, after those of the links; EDGE holds the striker (from 1) that met the edge of the
face, and from ON_FACE on there is one a striker: whether it is before the face."""
FEED_START, NEXT_APEX = 0, 1
"""Places of the machine's own memory, between the approach speeds of the links and their yielded depths."""

REGULATED, FULL_TORQUE, NO_TORQUE = 0, 1, 2
WAITING, FEEDING, HELD, RELEASED, RETRACTING = 0, 1, 2, 3, 4

DRIVE_SWITCH, FEED_SWITCH, APEX_SWITCH, FACE_SWITCH = 0, 2, 3, 4
"""Places of the machine's own switch functions, after those of the links; from FACE_SWITCH on one a striker."""

CARRIED = 2
"""Column of the table of bodies: mass that the turntable carries there, kg (0 for the object)."""
FIRST, SECOND, ACROSS = 4, 5, 6
"""Rows of the table of bases: f'(theta), f''(theta) and place across the blow of each seat, m."""
BASE_ROWS = 7
COSINE, SINE, REACH = 0, 1, 2
"""Columns of the table of seats: of the angle at which a striker stands, and its radius, m."""
BELT_TWIST, MOTOR_SPEED, OWN_STATES = 2, 3, 4
"""Places in the state after the turntable's angle; the energies follow."""

SETTINGS = (
    *("inertia", "drag", "set_speed", "gain", "torque", "ripple", "ripple_order", "ripple_phase"),
    *("motor_inertia", "belt_stiffness", "belt_damping", "weight_moment"),
    *("valve_delay", "stroke", "stroke_time", "acceleration", "cushion", "hold", "release_delay", "retract_time"),
    *("blows", "layered", "along", "across", "half_face", "pitch"),
)
"""Names of `RotarySystem.settings`, SI; see `strikewave.machines.rotary.rotary_system`."""
(INERTIA, DRAG, SET_SPEED, GAIN, TORQUE, RIPPLE, RIPPLE_ORDER, RIPPLE_PHASE) = range(8)
(MOTOR_INERTIA, BELT_STIFFNESS, BELT_DAMPING, WEIGHT_MOMENT) = range(8, 12)
(VALVE_DELAY, STROKE, STROKE_TIME, ACCELERATE, CUSHION, HOLD, RELEASE_DELAY, RETRACT_TIME) = range(12, 20)
(BLOWS, LAYERED, ALONG, ASIDE, HALF_FACE, PITCH) = range(20, 26)
FEED_TIMES = (VALVE_DELAY, STROKE_TIME, HOLD, RELEASE_DELAY, RETRACT_TIME)
"""How long each phase of the feed lasts: places in the settings."""


class RotarySystem(NamedTuple):
    """The rotary machine as tables: bodies, bases (scratch), links, seats and settings."""

    bodies: np.ndarray
    bases: np.ndarray
    joins: np.ndarray
    values: np.ndarray
    seats: np.ndarray
    settings: np.ndarray


@leaf_kernel
def stroke_profile(fraction, rise, fall):
    """Return position, speed and acceleration of a stroke of 1 in a time of 1.

    The speed rises as (1 - cos)/2 over the share ``rise`` of the time, stays, and falls alike over ``fall``, the
    cushioning; with halves it is the cycloid u - sin(2 pi u)/(2 pi).
    """
    top = 1.0 / (1.0 - 0.5 * (rise + fall))
    if fraction < rise:
        turn = math.pi / rise
        place = 0.5 * top * (fraction - math.sin(turn * fraction) / turn)
        return place, 0.5 * top * (1.0 - math.cos(turn * fraction)), 0.5 * top * turn * math.sin(turn * fraction)
    left = 1.0 - fraction
    if left < fall:
        turn = math.pi / fall
        place = 1.0 - 0.5 * top * (left - math.sin(turn * left) / turn)
        return place, 0.5 * top * (1.0 - math.cos(turn * left)), -0.5 * top * turn * math.sin(turn * left)
    return top * (fraction - 0.5 * rise), top, 0.0


@kernel
def stroke_places(fractions, rise, fall, out):
    """Fill the positions of a stroke at fractions of its time; see `stroke_profile`."""
    for i in range(out.size):
        out[i], _, _ = stroke_profile(min(max(fractions[i], 0.0), 1.0), rise, fall)


@leaf_kernel
def carriage(settings, phase, since):
    """Return position (0 when fed, stroke when retracted), speed and acceleration of the carriage."""
    stroke = settings[STROKE]
    if phase == WAITING:
        return stroke, 0.0, 0.0
    if phase == FEEDING:
        time = settings[STROKE_TIME]
        s, v, a = stroke_profile(min(since / time, 1.0), settings[ACCELERATE], settings[CUSHION])
        return stroke * (1.0 - s), -stroke * v / time, -stroke * a / time**2
    if phase == RETRACTING:
        time = settings[RETRACT_TIME]
        s, v, a = stroke_profile(min(since / time, 1.0), settings[ACCELERATE], settings[CUSHION])
        return stroke * s, stroke * v / time, stroke * a / time**2
    return 0.0, 0.0, 0.0


@leaf_kernel
def wanted_torque(settings, speed):
    """Return what the speed controller asks for, N m: the drag at set speed plus gain times speed error."""
    return settings[DRAG] * settings[SET_SPEED] + settings[GAIN] * (settings[SET_SPEED] - speed)


@leaf_kernel
def drive_torque(settings, drive, angle, speed):
    """Return the torque of the drive, N m: what is asked for, or the limit, or none; and its ripple.

    A ripple I r n w0^2 cos(n theta + phase) makes the speed swing by the share r of the set speed w0.
    """
    torque = 0.0 if drive == NO_TORQUE else settings[TORQUE]
    if drive == REGULATED:
        torque = wanted_torque(settings, speed)
    if settings[RIPPLE] != 0.0:
        order = settings[RIPPLE_ORDER]
        swing = settings[INERTIA] * settings[RIPPLE] * order * settings[SET_SPEED] ** 2
        torque += swing * math.cos(order * angle + settings[RIPPLE_PHASE])
    return torque


@leaf_kernel
def place_bases(system, t, y, mode, memory):
    """Fill the table of bases from turntable angle, turntable speed and feed phase."""
    bases, settings, seats = system.bases, system.settings, system.seats
    links, angle = system.joins.shape[0], 2 * system.bodies.shape[0]
    strikers = bases.shape[1] - 1
    theta, speed = y[angle], y[angle + 1]
    sine, cosine = math.sin(theta), math.cos(theta)
    for i in range(strikers):
        radius = seats[i, REACH]
        along = radius * (cosine * seats[i, COSINE] + sine * seats[i, SINE])
        across = radius * (sine * seats[i, COSINE] - cosine * seats[i, SINE])
        bases[PLACE, i], bases[SPEED, i] = along - settings[ALONG], -across * speed
        bases[FIRST, i], bases[SECOND, i], bases[ACROSS, i] = -across, -along, across + settings[ASIDE]
    since = t - memory[links + FEED_START]
    place, rate, acceleration = carriage(settings, mode[links + FEED], since)
    bases[PLACE, strikers], bases[SPEED, strikers], bases[ACCELERATION, strikers] = place, rate, acceleration


@leaf_kernel
def rotary_rates(system, t, y, mode, memory, dy):
    """Fill the time derivative of the whole state."""
    bodies, bases, settings = system.bodies, system.bases, system.settings
    links, angle = system.joins.shape[0], 2 * bodies.shape[0]
    strikers = bases.shape[1] - 1
    energies = angle + OWN_STATES
    place_bases(system, t, y, mode, memory)
    chain_rates(system.joins, system.values, bodies, y, bases, mode, memory, dy, energies)
    theta, speed, motor = y[angle], y[angle + 1], y[angle + MOTOR_SPEED]
    stiffness = settings[BELT_STIFFNESS]
    rigid = stiffness == np.inf
    torque = drive_torque(settings, mode[links + DRIVE], theta, speed if rigid else motor)
    drag = settings[DRAG] * speed
    pull, slip = torque, 0.0
    if not rigid:
        slip = motor - speed
        pull = stiffness * y[angle + BELT_TWIST] + settings[BELT_DAMPING] * slip
    inertia = settings[INERTIA]
    moment = pull - drag - settings[WEIGHT_MOMENT] * math.sin(theta)
    for i in range(strikers):
        first = bases[FIRST, i]
        inertia -= bodies[i, CARRIED] * first * first
        moment += first * (bases[FORCE, i] + speed * speed * bodies[i, CARRIED] * bases[SECOND, i])
    links_end = energies + links
    dy[angle], dy[angle + 1] = speed, moment / inertia
    dy[angle + BELT_TWIST] = slip
    dy[angle + MOTOR_SPEED] = 0.0 if rigid else (torque - pull) / settings[MOTOR_INERTIA]
    dy[links_end] = torque * (speed if rigid else motor)
    dy[links_end + 1] = drag * speed + settings[BELT_DAMPING] * slip * slip
    dy[links_end + 2] = -bases[FORCE, strikers] * bases[SPEED, strikers]


@leaf_kernel
def own_switches(system, t, angle, speed, mode, memory, g):
    """Fill the switch functions of drive, feed, passing strikers and edges of the face; ``speed`` is the motor's."""
    settings, links = system.settings, system.joins.shape[0]
    drive, limit = mode[links + DRIVE], settings[TORQUE]
    wanted = wanted_torque(settings, speed)
    g[0], g[1] = 1.0, 1.0
    if drive == REGULATED:
        g[0], g[1] = limit - wanted, wanted
    elif drive == FULL_TORQUE:
        g[0] = wanted - limit
    else:
        g[1] = -wanted
    phase, since = mode[links + FEED], t - memory[links + FEED_START]
    g[FEED_SWITCH] = settings[FEED_TIMES[phase]] - since
    g[APEX_SWITCH] = memory[links + NEXT_APEX] - angle
    half = settings[HALF_FACE]
    for i in range(system.seats.shape[0]):
        inside = half - abs(system.bases[ACROSS, i]) if half < np.inf else 1.0
        g[FACE_SWITCH + i] = inside if mode[links + ON_FACE + i] else -inside


@leaf_kernel
def motor_speed(system, y):
    """Return the speed that the controller sees, rad/s: that of the motor, as the turntable would have it."""
    angle = 2 * system.bodies.shape[0]
    return y[angle + 1] if system.settings[BELT_STIFFNESS] == np.inf else y[angle + MOTOR_SPEED]


@leaf_kernel
def rotary_switches(system, t, y, mode, memory, g):
    """Fill the switch functions of links, drive, feed, passing strikers and edges of the face."""
    links, angle = system.joins.shape[0], 2 * system.bodies.shape[0]
    place_bases(system, t, y, mode, memory)
    link_switches(system.joins, system.values, system.bodies, y, system.bases, mode, memory, g)
    for i in range(system.seats.shape[0]):
        if mode[links + ON_FACE + i] == 0:
            g[SWITCHES * i] = 1.0
    own_switches(system, t, y[angle], motor_speed(system, y), mode, memory, g[SWITCHES * links :])


@leaf_kernel
def _release_when_done(settings, t, mode, memory, links):
    if mode[links + FEED] == HELD and mode[links + PASSES] >= settings[BLOWS]:
        mode[links + FEED] = RELEASED
        memory[links + FEED_START] = t


@leaf_kernel
def cross_edge(system, i, y, mode, memory):
    """Let striker i come before the face or leave it; what a contact stores as it slips off is lost.

    Coming at a place behind the face it meets the edge: that stops the run.
    """
    links, bodies = system.joins.shape[0], system.bodies.shape[0]
    d, _ = link_motion(system.joins, system.values, i, y, system.bases, bodies)
    deepest, s = spot_of(system.joins, memory, i)
    if mode[links + ON_FACE + i] == 0:
        mode[links + ON_FACE + i] = 1
        if d > residual(deepest, s):
            mode[links + EDGE] = i + 1
            return STOP
        return CONTINUE
    mode[links + ON_FACE + i] = 0
    if mode[i] == OPEN:
        return CONTINUE
    if mode[i] == YIELDING:
        remember(system.joins, system.values, memory, i, d)
        deepest, s = spot_of(system.joins, memory, i)
    y[2 * bodies + OWN_STATES + i] += stored(system.values[i], d, deepest)
    mode[i] = OPEN
    return RESTART


@leaf_kernel
def own_switch(system, own, t, y, mode, memory):
    """Change the mode at a switch of drive, feed, a striker at its apex or at an edge of the face.

    A pass counts once the object is held in place, or earlier if the striker touched it.
    """
    settings, links = system.settings, system.joins.shape[0]
    if own < FEED_SWITCH:
        if mode[links + DRIVE] != REGULATED:
            mode[links + DRIVE] = REGULATED
        else:
            mode[links + DRIVE] = FULL_TORQUE if own == DRIVE_SWITCH else NO_TORQUE
        return CONTINUE
    if own >= FACE_SWITCH:
        return cross_edge(system, own - FACE_SWITCH, y, mode, memory)
    if own == FEED_SWITCH:
        if mode[links + FEED] == RETRACTING or settings[STROKE] == 0.0:
            return STOP
        mode[links + FEED] += 1
        memory[links + FEED_START] = t
    else:
        memory[links + NEXT_APEX] += settings[PITCH]
        if mode[links + TOUCHED] == 1 or mode[links + FEED] == HELD:
            mode[links + PASSES] += 1
        mode[links + TOUCHED] = 0
    _release_when_done(settings, t, mode, memory, links)
    return CONTINUE


@leaf_kernel
def rotary_switch(system, k, t, y, mode, memory):
    """Change the mode at switch k: a link, the drive, the feed, a striker at its apex or at an edge.

    Where the struck object is a stack of layers, the first touch stops the integration.
    """
    links, strikers = system.joins.shape[0], system.seats.shape[0]
    place_bases(system, t, y, mode, memory)
    if k < SWITCHES * links:
        code = link_switch(system.joins, system.values, system.bodies, k, y, system.bases, mode, memory)
        if k // SWITCHES < strikers and code == RESTART:
            mode[links + TOUCHED] = 1
            if system.settings[LAYERED] > 0.0:
                return STOP
        return code
    return own_switch(system, k - SWITCHES * links, t, y, mode, memory)


@overload(_integrator.derivatives, jit_options=LEAF)
def _derivatives(system, t, y, mode, memory, dy):
    def rates(system, t, y, mode, memory, dy):
        rotary_rates(system, t, y, mode, memory, dy)

    return rates if is_a(system, RotarySystem) else None


@overload(_integrator.forces, jit_options=LEAF)
def _forces(system, t, y, mode, memory, out):
    def fill(system, t, y, mode, memory, out):
        place_bases(system, t, y, mode, memory)
        chain_forces(system.joins, system.values, system.bodies, y, system.bases, mode, memory, out)

    return fill if is_a(system, RotarySystem) else None


@overload(_integrator.switches, jit_options=LEAF)
def _switches(system, t, y, mode, memory, g):
    def fill(system, t, y, mode, memory, g):
        rotary_switches(system, t, y, mode, memory, g)

    return fill if is_a(system, RotarySystem) else None


@overload(_integrator.horizon, jit_options=LEAF)
def _horizon(system, t, y, mode, memory):
    def most(system, t, y, mode, memory):
        return np.inf

    return most if is_a(system, RotarySystem) else None


@overload(_integrator.switch, jit_options=LEAF)
def _switch(system, k, t, y, mode, memory):
    def change(system, k, t, y, mode, memory):
        return rotary_switch(system, k, t, y, mode, memory)

    return change if is_a(system, RotarySystem) else None
