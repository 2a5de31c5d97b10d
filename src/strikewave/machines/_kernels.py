"""Compiled machine: turntable, strikers on mounts, fed carriage and struck object as one system.

The seats on the turntable and the carriage are the bases of the chain of bodies; `_layout` says where what stands.

With u = theta - (own angle of the striker) - (angle of the blow from the radius), a striker on its circle of radius
R stands at f = R cos u - R0 cos(blow angle) along the blow and s = R sin u + R0 sin(blow angle) across it, both 0 at
the strike position of a striker without errors. With the striker's motion along the blow in its own coordinate, the
turntable keeps the inertia J(theta) = I - sum m f'^2 and obeys

    J theta'' = T_belt - T_drag - T_weight + sum f' F_mount + theta'^2 sum m f' f''

where F_mount is the force of the mount on the turntable along the blow. This is Lagrange's equation,
so energy is kept. On a rigid belt the motor turns with the turntable and I holds its inertia.

A nose that pushes with the force F slides across the face with s' = R cos u theta', which the turntable alone decides,
as a guide holds the object across. It drags the face along with the force T = (mu F + c |s'|) sign(s'), and the
turntable loses the torque R cos u T: what the virtual work of T gives. Where a blow goes with the path, cos u and with
it T change their sign as the nose passes the strike position; the torque is 0 there and has a bend, no step. So nothing
sticks while the turntable turns, and the law needs no smoothing at s' = 0.
"""

import math
from typing import NamedTuple

import numpy as np
from numba.extending import overload

from strikewave.base.compiled import LEAF, inner_kernel, kernel, leaf_kernel
from strikewave.contact import _integrator
from strikewave.contact._chain_kernels import (
    ACCELERATION,
    FORCE,
    OPEN,
    PLACE,
    SPEED,
    ChainTables,
    chain_forces,
    chain_rates,
    frictionless,
    is_a,
    let_go,
    link_motion,
    link_of,
    link_switch,
    link_switches,
    never_touches,
    press,
    spot_of,
)
from strikewave.contact._integrator import CONTINUE, RESTART, STOP
from strikewave.contact._law_kernels import residual
from strikewave.machines._layout import (
    APEX_SWITCH,
    FEED_SWITCH,
    FULL_TORQUE_SWITCH,
    NO_TORQUE_SWITCH,
    OBJECT,
    layout_of,
)

REGULATED, FULL_TORQUE, NO_TORQUE = 0, 1, 2
"""Modes of the drive."""
WAITING, FEEDING, HELD, RELEASED, RETRACTING = 0, 1, 2, 3, 4
"""Modes of the feed: its phases."""

CARRIED = 2
"""Column of the table of bodies: mass that the turntable carries there, kg (0 for the object)."""
FIRST, SECOND, ACROSS = 4, 5, 6
"""Rows of the table of bases: f'(theta), f''(theta) and place across the blow of each seat, m."""
BASE_ROWS = 7
COSINE, SINE, REACH, STRETCH, LEFT = range(5)
"""Columns of the table of seats: of the angle at which a striker stands, and its radius, m; where strikers ride, m/k of
each on its mount, s^2, and what is left of its spot by yielding, m."""

SETTINGS = (
    *("inertia", "drag", "set_speed", "gain", "torque", "ripple", "ripple_order", "ripple_phase"),
    *("motor_inertia", "belt_stiffness", "belt_damping", "weight_moment"),
    *("valve_delay", "stroke", "stroke_time", "acceleration", "cushion", "hold", "release_delay", "retract_time"),
    *("blows", "stop_at_touch", "along", "across", "half_face", "pitch", "contact_friction", "sliding_damping"),
)
"""Names of `MachineSystem.settings`, SI; see `strikewave.machines.run.machine_system`."""
(INERTIA, DRAG, SET_SPEED, GAIN, TORQUE, RIPPLE, RIPPLE_ORDER, RIPPLE_PHASE) = range(8)
(MOTOR_INERTIA, BELT_STIFFNESS, BELT_DAMPING, WEIGHT_MOMENT) = range(8, 12)
(VALVE_DELAY, STROKE, STROKE_TIME, ACCELERATE, CUSHION, HOLD, RELEASE_DELAY, RETRACT_TIME) = range(12, 20)
(BLOWS, STOP_AT_TOUCH, ALONG, ASIDE, HALF_FACE, PITCH, CONTACT_FRICTION, SLIDING_DAMPING) = range(20, 28)
(NOSE_MASS, FRAME_STIFFNESS, OBJECT_GRAVITY, NOSE_SHARE) = range(28, 32)
"""Frame of the object, in the settings where strikers ride: mass of its nose, kg, stiffness, N/m, gravity, m/s^2, share
of the nose in its mass."""
FEED_TIMES = (VALVE_DELAY, STROKE_TIME, HOLD, RELEASE_DELAY, RETRACT_TIME)
"""Places in the settings of the durations of the phases of the feed."""


class MachineSystem(NamedTuple):
    """A machine as tables: chain of bodies, seats and settings.

    One type serves the whole machine, a blow and free flight of a fast run: the compiler would make the whole
    integrator anew for another.
    """

    chain: ChainTables
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
    at, bases, settings, seats = layout_of(system), system.chain.bases, system.settings, system.seats
    theta, speed = y[at.angle], y[at.turntable_speed]
    sine, cosine = math.sin(theta), math.cos(theta)  # once: those of each striker by addition of its own angle
    for i in range(at.carriage):
        radius = seats[i, REACH]
        along = radius * (cosine * seats[i, COSINE] + sine * seats[i, SINE])
        across = radius * (sine * seats[i, COSINE] - cosine * seats[i, SINE])
        bases[PLACE, i], bases[SPEED, i] = along - settings[ALONG], -across * speed
        bases[FIRST, i], bases[SECOND, i], bases[ACROSS, i] = -across, -along, across + settings[ASIDE]
    place, rate, acceleration = carriage(settings, mode[at.feed], t - memory[at.feed_start])
    bases[PLACE, at.carriage], bases[SPEED, at.carriage], bases[ACCELERATION, at.carriage] = place, rate, acceleration


@leaf_kernel
def has_sliding(settings):
    """Return whether a nose that slides across the face is held back at all."""
    return settings[CONTACT_FRICTION] > 0.0 or settings[SLIDING_DAMPING] > 0.0


@leaf_kernel
def sliding_arm(system, i):
    """Return how far nose i goes across the face a turn of the turntable, R cos u, m/rad; the bases as placed last."""
    return -system.chain.bases[SECOND, i]


@leaf_kernel
def side_force(settings, normal, sliding):
    """Return the force with which a nose drags the face along, N: Coulomb's and a viscous one, (mu F + c |v|) sign(v).

    ``normal`` is the contact force, N, ``sliding`` the speed of the nose across the face, m/s.
    """
    if normal <= 0.0 or sliding == 0.0:  # at the strike position of a blow with the path: the torque is 0 there
        return 0.0
    return math.copysign(settings[CONTACT_FRICTION] * normal, sliding) + settings[SLIDING_DAMPING] * sliding


@leaf_kernel
def side_force_of(system, i, y, mode, memory):
    """Return the force with which nose i drags the face along, N; the bases as placed last."""
    if mode[i] == OPEN or not has_sliding(system.settings):
        return 0.0
    at = layout_of(system)
    normal, _, _ = press(system.chain, i, y, mode, memory)
    return side_force(system.settings, normal, sliding_arm(system, i) * y[at.turntable_speed])


@leaf_kernel
def turning_inertia(system):
    """Return J(theta) = I - sum m f'^2 of the turntable, kg m^2; the bases as placed last."""
    bodies, bases = system.chain.bodies, system.chain.bases
    inertia = system.settings[INERTIA]
    for i in range(layout_of(system).carriage):
        inertia -= bodies[i, CARRIED] * bases[FIRST, i] * bases[FIRST, i]
    return inertia


@inner_kernel
def machine_rates(system, t, y, mode, memory, dy):
    """Fill the time derivative of the whole state."""
    at, bodies, bases, settings = layout_of(system), system.chain.bodies, system.chain.bases, system.settings
    place_bases(system, t, y, mode, memory)
    chain_rates(system.chain, y, mode, memory, dy, dy[at.dissipated])
    theta, speed, motor = y[at.angle], y[at.turntable_speed], y[at.motor_speed]
    stiffness = settings[BELT_STIFFNESS]
    rigid = stiffness == np.inf
    torque = drive_torque(settings, mode[at.drive], theta, speed if rigid else motor)
    drag = settings[DRAG] * speed  # viscous
    pull, slip = torque, 0.0  # on a rigid belt the motor's inertia is in that of the turntable
    if not rigid:
        slip = motor - speed
        pull = stiffness * y[at.belt_twist] + settings[BELT_DAMPING] * slip
    rubbed = 0.0
    moment = pull - drag - settings[WEIGHT_MOMENT] * math.sin(theta)
    for i in range(at.carriage):
        moment += bases[FIRST, i] * (bases[FORCE, i] + speed * speed * bodies[i, CARRIED] * bases[SECOND, i])
    for i in range(at.contacts.stop):
        braking = side_force_of(system, i, y, mode, memory) * sliding_arm(system, i)
        moment -= braking
        rubbed += braking * speed
    dy[at.angle], dy[at.turntable_speed] = speed, moment / turning_inertia(system)
    dy[at.belt_twist] = slip
    dy[at.motor_speed] = 0.0 if rigid else (torque - pull) / settings[MOTOR_INERTIA]
    dy[at.driven] = torque * (speed if rigid else motor)
    # both are lost: in bearings and air, and in the belt
    dy[at.dragged] = drag * speed + settings[BELT_DAMPING] * slip * slip
    # the feed bears the carriage against what the links push on it
    dy[at.fed] = -bases[FORCE, at.carriage] * bases[SPEED, at.carriage]
    dy[at.rubbed] = rubbed


@leaf_kernel
def machine_forces(system, t, y, mode, memory, out):
    """Fill the force of each link, then the side force of each striker on the face, N."""
    at, links = layout_of(system), system.chain.joins.shape[0]
    place_bases(system, t, y, mode, memory)
    chain_forces(system.chain, y, mode, memory, out)
    for i in range(at.contacts.stop):
        out[links + i] = side_force_of(system, i, y, mode, memory)


@leaf_kernel
def own_switches(system, t, y, mode, memory, g):
    """Fill the machine's own switch functions: drive, feed, passing strikers, and seats at the edges of the face.

    The controller sees the speed of the motor, as the turntable would have it.
    """
    at, settings = layout_of(system), system.settings
    drive, limit = mode[at.drive], settings[TORQUE]
    wanted = wanted_torque(settings, y[at.turntable_speed if settings[BELT_STIFFNESS] == np.inf else at.motor_speed])
    g[FULL_TORQUE_SWITCH], g[NO_TORQUE_SWITCH] = 1.0, 1.0
    if drive == REGULATED:
        g[FULL_TORQUE_SWITCH], g[NO_TORQUE_SWITCH] = limit - wanted, wanted
    elif drive == FULL_TORQUE:
        g[FULL_TORQUE_SWITCH] = wanted - limit
    else:
        g[NO_TORQUE_SWITCH] = -wanted
    phase, since = mode[at.feed], t - memory[at.feed_start]
    g[FEED_SWITCH] = settings[FEED_TIMES[phase]] - since
    g[APEX_SWITCH] = memory[at.next_apex] - y[at.angle]
    half, edges, on_face = settings[HALF_FACE], g[at.edges], mode[at.on_face]
    for i in range(at.carriage):
        inside = half - abs(system.chain.bases[ACROSS, i]) if half < np.inf else 1.0
        edges[i] = inside if on_face[i] else -inside  # positive while the mode holds, on either side of the edge


@leaf_kernel
def larger(speed, stretch):
    """Return the radius of a rider's steady circle over that of its seat, 1 / (1 - w^2 m/k)."""
    return 1.0 / (1.0 - speed * speed * stretch)


@leaf_kernel
def nose_motion(system, i, theta, speed):
    """Return place and speed along the blow and place across it of a nose that rides, m, m/s, m."""
    seat, settings = system.seats[i], system.settings
    sine, cosine = math.sin(theta), math.cos(theta)
    along = seat[REACH] * (cosine * seat[COSINE] + sine * seat[SINE])
    across = seat[REACH] * (sine * seat[COSINE] - cosine * seat[SINE])
    circle = larger(speed, seat[STRETCH])
    return circle * along - settings[ALONG], -circle * across * speed, across + settings[ASIDE]


@leaf_kernel
def bend_of(settings, acceleration):
    """Return how far a frame is bent that pushes its nose steadily, m: m (g - a)/k."""
    return settings[NOSE_MASS] * (settings[OBJECT_GRAVITY] - acceleration) / settings[FRAME_STIFFNESS]


@inner_kernel
def face_of(system, y, mode, memory):
    """Return the place of the struck face of an object in free flight, m; the bases as placed last.

    The frame bends as its acceleration wants.
    """
    at, share = layout_of(system), system.settings[NOSE_SHARE]
    a = frictionless(system.chain, OBJECT, y, mode, memory)
    mean = y[at.positions][OBJECT] + bend_of(system.settings, 0.0) * share
    return mean + bend_of(system.settings, a) * (1.0 - share)


@leaf_kernel
def riding(at):
    """Return whether the strikers ride on their circles before an object in free flight: a system of a fast run."""
    return at.touches.start < at.touches.stop


@inner_kernel
def flight_switches(system, y, mode, memory, own):
    """Fill, among the machine's own switch functions, those of each nose that rides: first touch, edge of the face."""
    at, face = layout_of(system), face_of(system, y, mode, memory)
    half, on_face, touches, edges = system.settings[HALF_FACE], mode[at.on_face], own[at.touches], own[at.edges]
    for i in range(system.seats.shape[0]):
        place, _, across = nose_motion(system, i, y[at.angle], y[at.turntable_speed])
        touches[i] = face + system.seats[i, LEFT] - place if on_face[i] else 1.0
        edges[i] = 1.0
        if half < np.inf:
            inside = half - abs(across)
            edges[i] = inside if on_face[i] else -inside


@inner_kernel
def flight_switch(system, own, y, mode, memory):
    """Change the mode at a first touch, which stops the integration, or as a nose that rides passes an edge."""
    at = layout_of(system)
    if own < at.edges.start:
        mode[at.touched] = 1
        mode[at.touching] = own - at.touches.start
        return STOP
    i, on_face = own - at.edges.start, mode[at.on_face]
    on_face[i] = 1 - on_face[i]
    place, _, _ = nose_motion(system, i, y[at.angle], y[at.turntable_speed])
    if on_face[i] and place > face_of(system, y, mode, memory) + system.seats[i, LEFT]:
        mode[at.edge] = i + 1
        return STOP
    return CONTINUE


@inner_kernel
def machine_switches(system, t, y, mode, memory, g):
    """Fill the switch functions of links, drive, feed, passing strikers and edges of the face."""
    at = layout_of(system)
    on_face = mode[at.on_face]
    place_bases(system, t, y, mode, memory)
    link_switches(system.chain, y, mode, memory, g)
    for i in range(at.carriage):
        if on_face[i] == 0:
            never_touches(i, g)
    own = g[at.own_switches]
    own_switches(system, t, y, mode, memory, own)
    if riding(at):
        flight_switches(system, y, mode, memory, own)


@leaf_kernel
def _release_when_done(settings, t, mode, memory, at):
    if mode[at.feed] == HELD and mode[at.passes] >= settings[BLOWS]:
        mode[at.feed] = RELEASED
        memory[at.feed_start] = t


@leaf_kernel
def cross_edge(system, i, y, mode, memory):
    """Let striker i come before the face or leave it; what a contact stores as it slips off is lost.

    Coming at a place behind the face it meets the edge: that stops the run.
    """
    at, chain = layout_of(system), system.chain
    on_face = mode[at.on_face]
    if on_face[i] == 0:
        on_face[i] = 1
        d, _ = link_motion(chain, i, y)
        deepest, s = spot_of(chain, memory, i)
        if d > residual(deepest, s):
            mode[at.edge] = i + 1
            return STOP
        return CONTINUE
    on_face[i] = 0
    if mode[i] == OPEN:
        return CONTINUE
    y[at.dissipated][i] += let_go(chain, i, y, mode, memory)
    return RESTART


@leaf_kernel
def own_switch(system, own, t, y, mode, memory):
    """Change the mode at a switch of drive, feed, a striker at its apex or at an edge of the face.

    A pass counts once the object is held in place, or earlier if the striker touched it.
    """
    at, settings = layout_of(system), system.settings
    if own in (FULL_TORQUE_SWITCH, NO_TORQUE_SWITCH):
        if mode[at.drive] != REGULATED:
            mode[at.drive] = REGULATED
        else:
            mode[at.drive] = FULL_TORQUE if own == FULL_TORQUE_SWITCH else NO_TORQUE
        return CONTINUE
    if own >= at.edges.start:
        return cross_edge(system, own - at.edges.start, y, mode, memory)
    if own == FEED_SWITCH:
        if mode[at.feed] == RETRACTING or settings[STROKE] == 0.0:
            return STOP
        mode[at.feed] += 1
        memory[at.feed_start] = t
    else:
        memory[at.next_apex] += settings[PITCH]
        if mode[at.touched] == 1 or mode[at.feed] == HELD:  # passes before the object is there are none
            mode[at.passes] += 1
        mode[at.touched] = 0
    _release_when_done(settings, t, mode, memory, at)
    return CONTINUE


@inner_kernel
def machine_switch(system, k, t, y, mode, memory):
    """Change the mode at switch k: a link, the drive, the feed, a striker at its apex or at an edge.

    Where the struck object is a stack of layers, or rebounds are followed, each touch stops the integration; where the
    strikers ride, each touch and each apex.
    """
    at = layout_of(system)
    place_bases(system, t, y, mode, memory)
    own = k - at.own_switches.start
    if own >= 0:
        if riding(at) and own >= at.touches.start:
            return flight_switch(system, own, y, mode, memory)
        code = own_switch(system, own, t, y, mode, memory)
        return STOP if riding(at) and own == APEX_SWITCH else code
    code = link_switch(system.chain, k, y, mode, memory)
    if link_of(k) < at.contacts.stop and code == RESTART:  # a first touch, not one that is regained
        mode[at.touched] = 1
        if system.settings[STOP_AT_TOUCH] > 0.0:
            return STOP
    return code


@overload(_integrator.derivatives, jit_options=LEAF)
def _derivatives(system, t, y, mode, memory, dy):
    def rates(system, t, y, mode, memory, dy):
        machine_rates(system, t, y, mode, memory, dy)

    return rates if is_a(system, MachineSystem) else None


@overload(_integrator.forces, jit_options=LEAF)
def _forces(system, t, y, mode, memory, out):
    def fill(system, t, y, mode, memory, out):
        machine_forces(system, t, y, mode, memory, out)

    return fill if is_a(system, MachineSystem) else None


@overload(_integrator.switches, jit_options=LEAF)
def _switches(system, t, y, mode, memory, g):
    def fill(system, t, y, mode, memory, g):
        machine_switches(system, t, y, mode, memory, g)

    return fill if is_a(system, MachineSystem) else None


@overload(_integrator.horizon, jit_options=LEAF)
def _horizon(system, t, y, mode, memory):
    def most(system, t, y, mode, memory):
        return np.inf

    return most if is_a(system, MachineSystem) else None


@overload(_integrator.switch, jit_options=LEAF)
def _switch(system, k, t, y, mode, memory):
    def change(system, k, t, y, mode, memory):
        return machine_switch(system, k, t, y, mode, memory)

    return change if is_a(system, MachineSystem) else None
