"""Compiled rotary machine: turntable, strikers on mounts, fed carriage and struck object as one system.

State: positions and speeds of the bodies (strikers, then the chain of the object), turntable angle and
speed, then energies: dissipated in each link, work of the drive, lost in drag, work of the feed.
Bases: one a striker (where the turntable carries its mount), then the carriage.

A striker at angle p = theta - i pitch reaches f(p) = R (cos p - 1) along the blow, 0 at its apex. With
the striker's motion along the blow in its own coordinate, the turntable keeps the inertia
J(theta) = I - sum m f'(p)^2 and obeys

    J theta'' = T_drive - T_drag + sum f'(p) F_mount + theta'^2 sum m f'(p) f''(p)

where F_mount is the force of the mount on the turntable along the blow. This is Lagrange's equation,
so energy is kept.
"""

import math
from typing import NamedTuple

import numpy as np
from numba.extending import overload

from strikewave.compiled import LEAF, leaf_kernel
from strikewave.contact import _integrator
from strikewave.contact._chain_kernels import (
    FORCE,
    PLACE,
    SPEED,
    SWITCHES,
    chain_forces,
    chain_rates,
    is_a,
    link_switch,
    link_switches,
)
from strikewave.contact._integrator import CONTINUE, RESTART, STOP

DRIVE, FEED, PASSES, TOUCHED = 0, 1, 2, 3
"""Places of the machine's own modes, after those of the links."""
FEED_START, NEXT_APEX = 0, 1
"""Places of the machine's own memory, between the approach speeds of the links and their yielded depths."""

REGULATED, FULL_TORQUE, NO_TORQUE = 0, 1, 2
WAITING, FEEDING, HELD, RELEASED, RETRACTING = 0, 1, 2, 3, 4

DRIVE_SWITCH, FEED_SWITCH, APEX_SWITCH = 0, 2, 3
"""Places of the machine's own switch functions, after those of the links."""


CARRIED = 2
"""Column of the table of bodies: mass that the turntable carries there, kg (0 for the object)."""
FIRST, SECOND = 3, 4
"""Rows of the table of bases: f'(p) and f''(p) of each seat, m."""

INERTIA, RADIUS, SET_SPEED, GAIN, TORQUE, DRAG = 0, 1, 2, 3, 4, 5
VALVE_DELAY, STROKE, STROKE_TIME, RELEASE_DELAY, RETRACT_TIME = 6, 7, 8, 9, 10
BLOWS, LAYERED, PITCH_SINE, PITCH_COSINE = 11, 12, 13, 14
"""Places in `RotarySystem.settings`, SI."""


class RotarySystem(NamedTuple):
    """The rotary machine as tables: bodies, bases (scratch), links and settings."""

    bodies: np.ndarray
    bases: np.ndarray
    joins: np.ndarray
    values: np.ndarray
    settings: np.ndarray


@leaf_kernel
def cycloid(fraction):
    """Return position and rate of the cycloidal rise s = u - sin(2 pi u)/(2 pi), u in 0..1."""
    turn = 2.0 * math.pi * fraction
    return fraction - math.sin(turn) / (2.0 * math.pi), 1.0 - math.cos(turn)


@leaf_kernel
def carriage(settings, phase, since):
    """Return position (0 when fed, stroke when retracted) and speed of the carriage."""
    stroke = settings[STROKE]
    if phase == WAITING:
        return stroke, 0.0
    if phase == FEEDING:
        s, rate = cycloid(min(since / settings[STROKE_TIME], 1.0))
        return stroke * (1.0 - s), -stroke * rate / settings[STROKE_TIME]
    if phase == RETRACTING:
        s, rate = cycloid(min(since / settings[RETRACT_TIME], 1.0))
        return stroke * s, stroke * rate / settings[RETRACT_TIME]
    return 0.0, 0.0


@leaf_kernel
def wanted_torque(settings, speed):
    """Return what the speed controller asks for, N m: the drag at set speed plus gain times speed error."""
    return settings[DRAG] * settings[SET_SPEED] + settings[GAIN] * (settings[SET_SPEED] - speed)


@leaf_kernel
def drive_torque(settings, drive, speed):
    """Return the torque of the drive, N m: what is asked for, or the limit, or none."""
    if drive == FULL_TORQUE:
        return settings[TORQUE]
    return 0.0 if drive == NO_TORQUE else wanted_torque(settings, speed)


@leaf_kernel
def place_bases(system, t, y, mode, memory):
    """Fill the table of bases from turntable angle, turntable speed and feed phase."""
    bases, settings = system.bases, system.settings
    links, angle = system.joins.shape[0], 2 * system.bodies.shape[0]
    strikers, radius = bases.shape[1] - 1, settings[RADIUS]
    theta, speed = y[angle], y[angle + 1]
    sine, cosine = math.sin(theta), math.cos(theta)
    turn_sine, turn_cosine = settings[PITCH_SINE], settings[PITCH_COSINE]
    for i in range(strikers):
        if i > 0:
            sine, cosine = sine * turn_cosine - cosine * turn_sine, cosine * turn_cosine + sine * turn_sine
        bases[PLACE, i] = radius * (cosine - 1.0)
        bases[SPEED, i] = -radius * sine * speed
        bases[FIRST, i], bases[SECOND, i] = -radius * sine, -radius * cosine
    since = t - memory[links + FEED_START]
    bases[PLACE, strikers], bases[SPEED, strikers] = carriage(settings, mode[links + FEED], since)


@leaf_kernel
def rotary_rates(system, t, y, mode, memory, dy):
    """Fill the time derivative of the whole state."""
    bodies, bases, settings = system.bodies, system.bases, system.settings
    links, angle = system.joins.shape[0], 2 * bodies.shape[0]
    strikers = bases.shape[1] - 1
    place_bases(system, t, y, mode, memory)
    chain_rates(system.joins, system.values, bodies, y, bases, mode, memory, dy, angle + 2)
    speed = y[angle + 1]
    torque = drive_torque(settings, mode[links + DRIVE], speed)
    drag = settings[DRAG] * speed
    inertia, moment = settings[INERTIA], torque - drag
    for i in range(strikers):
        first = bases[FIRST, i]
        inertia -= bodies[i, CARRIED] * first * first
        moment += first * (bases[FORCE, i] + speed * speed * bodies[i, CARRIED] * bases[SECOND, i])
    energies = angle + 2 + links
    dy[angle], dy[angle + 1] = speed, moment / inertia
    dy[energies], dy[energies + 1] = torque * speed, drag * speed
    dy[energies + 2] = -bases[FORCE, strikers] * bases[SPEED, strikers]


@leaf_kernel
def own_switches(settings, links, t, angle, speed, mode, memory, g):
    """Fill the four switch functions of drive, feed and passing strikers."""
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
    g[FEED_SWITCH] = 1.0
    if phase == WAITING:
        g[FEED_SWITCH] = settings[VALVE_DELAY] - since
    elif phase == FEEDING:
        g[FEED_SWITCH] = settings[STROKE_TIME] - since
    elif phase == RELEASED:
        g[FEED_SWITCH] = settings[RELEASE_DELAY] - since
    elif phase == RETRACTING:
        g[FEED_SWITCH] = settings[RETRACT_TIME] - since
    g[APEX_SWITCH] = memory[links + NEXT_APEX] - angle


@leaf_kernel
def rotary_switches(system, t, y, mode, memory, g):
    """Fill the switch functions of links, drive, feed and passing strikers."""
    links, bodies = system.joins.shape[0], system.bodies.shape[0]
    place_bases(system, t, y, mode, memory)
    link_switches(system.joins, system.values, y, system.bases, bodies, mode, memory, g)
    own_switches(system.settings, links, t, y[2 * bodies], y[2 * bodies + 1], mode, memory, g[SWITCHES * links :])


@leaf_kernel
def _release_when_done(settings, t, mode, memory, links):
    if mode[links + FEED] == HELD and mode[links + PASSES] >= settings[BLOWS]:
        mode[links + FEED] = RELEASED
        memory[links + FEED_START] = t


@leaf_kernel
def own_switch(settings, links, strikers, own, t, mode, memory):
    """Change the mode at a switch of drive, feed, or a striker at its apex.

    A pass counts once the object is held in place, or earlier if the striker touched it.
    """
    if own < FEED_SWITCH:
        if mode[links + DRIVE] != REGULATED:
            mode[links + DRIVE] = REGULATED
        else:
            mode[links + DRIVE] = FULL_TORQUE if own == DRIVE_SWITCH else NO_TORQUE
        return CONTINUE
    if own == FEED_SWITCH:
        if mode[links + FEED] == RETRACTING:
            return STOP
        mode[links + FEED] += 1
        memory[links + FEED_START] = t
    else:
        memory[links + NEXT_APEX] += 2.0 * math.pi / strikers
        if mode[links + TOUCHED] == 1 or mode[links + FEED] == HELD:
            mode[links + PASSES] += 1
        mode[links + TOUCHED] = 0
    _release_when_done(settings, t, mode, memory, links)
    return CONTINUE


@leaf_kernel
def rotary_switch(system, k, t, y, mode, memory):
    """Change the mode at switch k: a link, the drive, the feed, or a striker at its apex.

    Where the struck object is a stack of layers, the first touch stops the integration.
    """
    bodies, links = system.bodies.shape[0], system.joins.shape[0]
    strikers = system.bases.shape[1] - 1
    if k < SWITCHES * links:
        place_bases(system, t, y, mode, memory)
        code = link_switch(system.joins, system.values, k, y, system.bases, bodies, mode, memory)
        if k // SWITCHES < strikers and code == RESTART:
            mode[links + TOUCHED] = 1
            if system.settings[LAYERED] > 0.0:
                return STOP
        return code
    return own_switch(system.settings, links, strikers, k - SWITCHES * links, t, mode, memory)


@overload(_integrator.derivatives, jit_options=LEAF)
def _derivatives(system, t, y, mode, memory, dy):
    def rates(system, t, y, mode, memory, dy):
        rotary_rates(system, t, y, mode, memory, dy)

    return rates if is_a(system, RotarySystem) else None


@overload(_integrator.forces, jit_options=LEAF)
def _forces(system, t, y, mode, memory, out):
    def fill(system, t, y, mode, memory, out):
        place_bases(system, t, y, mode, memory)
        chain_forces(system.joins, system.values, y, system.bases, system.bodies.shape[0], mode, memory, out)

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
