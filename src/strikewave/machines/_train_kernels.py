"""Compiled fast run of the rotary machine: rigid between blows, whole bodies within them.

In free flight the object is one body on spring, damper, stop and rail, and every striker rides on its steady circle
of radius R / (1 - m w^2/k). At first touch the striker that touches, its mount, nose, frame, assembly, supports and
turntable are followed as `_kernels` has them, the other strikers still circling; once all is quiet they are one body
and on their circles again, with their momentum and mean places. What still rings is let go, and counted.
"""

import math
from typing import NamedTuple

import numpy as np

from strikewave.base.compiled import called_kernel, inner_kernel, kernel, leaf_kernel
from strikewave.contact import _integrator
from strikewave.contact._chain_kernels import (
    GRAVITY,
    MASS,
    OPEN,
    PLACE,
    PUSHING,
    SLIDING,
    SLIDING_BACK,
    SPEED,
    STICKING,
    press,
    spot_of,
    spring_energy,
)
from strikewave.contact._integrator import END, FULL, STOPPED, StepRecord, advance
from strikewave.contact._law_kernels import SPOT, STIFFNESS, residual
from strikewave.machines._kernels import (
    BELT_STIFFNESS,
    CARRIED,
    FIRST,
    FRAME_STIFFNESS,
    HALF_FACE,
    INERTIA,
    LEFT,
    NOSE_MASS,
    NOSE_SHARE,
    OBJECT_GRAVITY,
    SECOND,
    MachineSystem,
    bend_of,
    face_of,
    larger,
    nose_motion,
    place_bases,
)
from strikewave.machines._layout import FEED_SWITCH, OBJECT, STRIKER, layout_of
from strikewave.machines._pass_kernels import (
    LET_GO,
    ROWS_USED,
    measure_row,
    missed_row,
    note_blow,
    note_flight,
    open_row,
    repeats,
)

QUIET, DONE, STUCK, AT_EDGE, CROWDED, TOO_MANY, LATE = -1, 0, 1, 2, 3, 4, 5
"""Ends of a run or a blow: a blow is over; done; the step shrank to nothing; a striker met the edge of the face;
another striker touched while a blow still rang; more blows than rows; longer than expected."""
RECORD_ROWS = 8
"""Steps after which the integrator comes back: so often a blow is looked at, whether it is quiet."""


class MountedStrikers(NamedTuple):
    """Differences between the strikers, one row each: law of the contact, mount, seat, mass, yielded spot."""

    laws: np.ndarray
    mounts: np.ndarray
    seats: np.ndarray
    masses: np.ndarray
    deepest: np.ndarray
    growth: np.ndarray


class Part(NamedTuple):
    """State of one of the two systems, and the steps that it has just made."""

    y: np.ndarray
    mode: np.ndarray
    memory: np.ndarray
    record: StepRecord


class Train(NamedTuple):
    """Controls of a run: ringing share at which a blow is over, and the energy that it is a share of, J.

    ``most`` passes end the run (0: the retraction does), or blows that repeat within a tolerance (0: never looked at).
    """

    share: float
    energy: float
    most: int
    repeats: float
    least: int


class TrainTables(NamedTuple):
    """One machine as both systems, and its mounted: in free flight the object is one body, and the strikers ride."""

    flight: MachineSystem
    blow: MachineSystem
    mounted: MountedStrikers


@leaf_kernel
def copy(source, target):
    """Copy the entries of one array into another."""
    for k in range(target.size):
        target[k] = source[k]


@called_kernel
def rigid_energy(flight, t, part):
    """Return the energy of object and turntable in free flight, J; belt and motor keep theirs."""
    y, at, settings = part.y, layout_of(flight), flight.settings
    place_bases(flight, t, y, part.mode, part.memory)
    mass, gravity = flight.chain.bodies[OBJECT, MASS], flight.chain.bodies[OBJECT, GRAVITY]
    centre, speed = y[at.positions][OBJECT] + settings[NOSE_SHARE] * bend_of(settings, 0.0), y[at.speeds][OBJECT]
    turning = y[at.turntable_speed]
    out = 0.5 * mass * speed * speed - mass * gravity * centre + 0.5 * settings[INERTIA] * turning * turning
    for i in (at.support, at.stop):
        out += spring_energy(flight.chain, i, y)
    return out


@inner_kernel
def blow_energy(blow, t, part):
    """Return the energy of striker, object and turntable in a blow, J, less what the contact stores."""
    y, at, bodies = part.y, layout_of(blow), blow.chain.bodies
    x, v, turning = y[at.positions], y[at.speeds], y[at.turntable_speed]
    place_bases(blow, t, y, part.mode, part.memory)
    first = blow.chain.bases[FIRST, STRIKER]
    out = 0.5 * (blow.settings[INERTIA] - bodies[STRIKER, MASS] * first * first) * turning * turning
    for i in range(x.size):
        out += 0.5 * bodies[i, MASS] * v[i] * v[i] - bodies[i, MASS] * bodies[i, GRAVITY] * x[i]
    for i in range(at.mounts.start, at.rail):
        out += spring_energy(blow.chain, i, y)
    return out


@inner_kernel
def begin_blow(flight, blow, strikers, going, struck, t):
    """Set the bodies of a blow from free flight to the first touch of the striker that its modes name."""
    circling, at, chain, share = layout_of(flight), layout_of(blow), blow.chain, flight.settings[NOSE_SHARE]
    i = going.mode[circling.touching]
    y, z, mode, memory = struck.y, going.y, struck.mode, struck.memory
    copy(strikers.laws[i], chain.values[at.contacts.start])
    copy(strikers.mounts[i], chain.values[at.mounts.start])
    copy(strikers.seats[i], blow.seats[STRIKER])
    chain.bodies[STRIKER, MASS] = chain.bodies[STRIKER, CARRIED] = strikers.masses[i]
    mode[at.contacts][STRIKER] = mode[at.mounts][STRIKER] = mode[at.frame] = PUSHING
    copy(going.mode[circling.held_modes], mode[at.held_modes])
    mode[at.on_face][STRIKER] = 1
    copy(going.memory[circling.own_memory], memory[at.own_memory])
    memory[at.depths][STRIKER], memory[at.growths][STRIKER] = strikers.deepest[i], strikers.growth[i]
    place_bases(flight, t, z, going.mode, going.memory)
    face = face_of(flight, z, going.mode, going.memory)
    place, speed, _ = nose_motion(flight, i, z[circling.angle], z[circling.turntable_speed])
    centre, fast = z[circling.positions][OBJECT] + share * bend_of(flight.settings, 0.0), z[circling.speeds][OBJECT]
    x, v = y[at.positions], y[at.speeds]
    # the centre of mass stays
    x[STRIKER], x[at.nose], x[at.assembly] = place, face, (centre - share * face) / (1.0 - share)
    v[STRIKER], v[at.nose], v[at.assembly] = speed, fast, fast
    copy(z[circling.turntable], y[at.turntable])
    copy(z[circling.held_energies], y[at.held_energies])
    memory[at.contacts][STRIKER] = max(speed - fast, 0.0)
    return rigid_energy(flight, t, going) - blow_energy(blow, t, struck)


@inner_kernel
def ringing(flight, blow, struck, t):
    """Return the energy that rings in the frame, J, and how far the nose that would ride is from the face, m.

    The frame rings about the bend with which it carries its nose; the striker rings about its steady circle. The
    distance is less what both swing; a nose that has left the face is far from it.
    """
    at, chain, bases, settings = layout_of(blow), blow.chain, blow.chain.bases, flight.settings
    y, mode, memory = struck.y, struck.mode, struck.memory
    x, v = y[at.positions], y[at.speeds]
    place_bases(blow, t, y, mode, memory)
    pulled, _, _ = press(chain, at.support, y, mode, memory)
    pushed, _, _ = press(chain, at.stop, y, mode, memory)
    carried = bend_of(settings, (pushed - pulled) / flight.chain.bodies[OBJECT, MASS] + settings[OBJECT_GRAVITY])
    bend = x[at.nose] - x[at.assembly] - carried
    reduced = settings[NOSE_MASS] * (1.0 - settings[NOSE_SHARE])
    of_frame = 0.5 * settings[FRAME_STIFFNESS] * bend * bend + 0.5 * reduced * (v[at.nose] - v[at.assembly]) ** 2
    stiffness, striker = chain.values[at.mounts.start, STIFFNESS], chain.bodies[STRIKER, MASS]
    circle = larger(y[at.turntable_speed], striker / stiffness)
    rides = bases[PLACE, STRIKER] - (circle - 1.0) * bases[SECOND, STRIKER]
    swings = v[STRIKER] - circle * bases[SPEED, STRIKER]
    of_striker = 0.5 * stiffness * (x[STRIKER] - rides) ** 2 + 0.5 * striker * swings**2
    swing = math.sqrt(2.0 * of_frame / settings[FRAME_STIFFNESS]) + math.sqrt(2.0 * of_striker / stiffness)
    deepest, growth = spot_of(chain, memory, at.contacts.start)
    apart = x[at.nose] - max(rides, x[STRIKER]) + residual(deepest, growth)
    return of_frame, apart - swing if mode[at.on_face][STRIKER] else np.inf


@inner_kernel
def end_blow(flight, blow, strikers, going, struck, t):
    """Let object and striker fly again, with their momentum and mean places; return the energy let go, J."""
    circling, at, settings = layout_of(flight), layout_of(blow), flight.settings
    i, share = going.mode[circling.touching], settings[NOSE_SHARE]
    y, z, mode = struck.y, going.y, going.mode
    x, v = y[at.positions], y[at.speeds]
    before = blow_energy(blow, t, struck)
    z[circling.positions][OBJECT] = share * x[at.nose] + (1.0 - share) * x[at.assembly] - share * bend_of(settings, 0.0)
    z[circling.speeds][OBJECT] = share * v[at.nose] + (1.0 - share) * v[at.assembly]
    copy(y[at.turntable], z[circling.turntable])
    first, inertia, mass = blow.chain.bases[FIRST, STRIKER], settings[INERTIA], blow.chain.bodies[STRIKER, MASS]
    own = inertia - mass * first * first
    # angular momentum is kept: what the striker swings goes to its seat
    z[circling.turntable_speed] = (own * y[at.turntable_speed] + first * mass * v[STRIKER]) / inertia
    if settings[BELT_STIFFNESS] == np.inf:
        z[circling.motor_speed] = z[circling.turntable_speed]
    copy(y[at.held_energies], z[circling.held_energies])  # energies of supports and drive go on from part to part
    copy(struck.mode[at.held_modes], mode[circling.held_modes])
    copy(struck.memory[at.own_memory], going.memory[circling.own_memory])
    half, on_face = settings[HALF_FACE], mode[circling.on_face]
    for j in range(flight.seats.shape[0]):
        _, _, across = nose_motion(flight, j, z[circling.angle], z[circling.turntable_speed])
        on_face[j] = 1 if abs(across) <= half else 0
    deepest, growth = spot_of(blow.chain, struck.memory, at.contacts.start)
    _keep_spot(strikers, flight.seats, i, deepest, growth)
    place_bases(flight, t, z, mode, going.memory)
    if circling.rubs:
        slips = z[circling.speeds][OBJECT] - flight.chain.bases[SPEED, circling.carriage]
        if mode[circling.rail] == STICKING:
            z[circling.speeds][OBJECT] = flight.chain.bases[SPEED, circling.carriage]
        else:  # by the speed of the whole object, which takes the place of the assembly's
            mode[circling.rail] = SLIDING if slips > 0.0 else SLIDING_BACK
    return before - rigid_energy(flight, t, going)


@leaf_kernel
def _keep_spot(strikers, seats, i, deepest, growth):
    """Keep how deep a contact has yielded, for all strikers that share its spot."""
    for j in range(seats.shape[0]):
        if j == i or (strikers.laws[j, SPOT] > 0.0 and strikers.laws[j, SPOT] == strikers.laws[i, SPOT]):
            strikers.deepest[j], strikers.growth[j] = deepest, growth
            seats[j, LEFT] = residual(deepest, growth)


@inner_kernel
def crowded(flight, blow, struck, i):
    """Return whether another striker than i, which rides, is behind the face while a blow lasts."""
    at, y, half = layout_of(blow), struck.y, flight.settings[HALF_FACE]
    face = y[at.positions][at.nose]
    for j in range(flight.seats.shape[0]):
        place, _, across = nose_motion(flight, j, y[at.angle], y[at.turntable_speed])
        if j != i and abs(across) <= half and place > face + flight.seats[j, LEFT]:
            return True
    return False


@inner_kernel
def follow_blow(machine, going, struck, control, train, passes, t, work):
    """Follow one blow from first touch until all is quiet; return why it came back, and when. ``work`` is scratch."""
    flight, blow, mounted = machine.flight, machine.blow, machine.mounted
    at, y, mode, memory = layout_of(blow), struck.y, struck.mode, struck.memory
    i = going.mode[layout_of(flight).touching]
    passes.numbers[LET_GO] += begin_blow(flight, blow, mounted, going, struck, t)
    if not open_row(flight, blow, going, struck, passes, t):
        return TOO_MANY, t
    h = control.first_step
    while True:
        why, t, h, steps, _ = advance(blow, control, t, h, y, mode, memory, struck.record, at.switches)
        note_blow(flight, blow, struck, passes, steps, work)
        if why in (_integrator.STUCK, END):
            return STUCK if why == _integrator.STUCK else LATE, t
        if why == STOPPED and mode[at.edge]:
            return AT_EDGE, t
        if why == STOPPED:
            break
        if crowded(flight, blow, struck, i):
            return CROWDED, t
        if mode[at.contacts][STRIKER] != OPEN:  # a blow is not over while it touches
            continue
        of_frame, apart = ringing(flight, blow, struck, t)
        if apart > 0.0 and of_frame <= train.share * train.energy:
            break
    passes.numbers[LET_GO] += end_blow(flight, blow, mounted, going, struck, t)
    measure_row(passes)
    return DONE if why == STOPPED else QUIET, t


@kernel
def run_train(machine, going, struck, controls, train, passes):
    """Run a machine from the valve signal; return why it ended, and when."""
    flight, control = machine.flight, controls[0]
    at, y, mode, memory = layout_of(flight), going.y, going.mode, going.memory
    work, work_of_blow = np.empty(y.size), np.empty(struck.y.size)
    t, h, looked = 0.0, control.first_step, 0
    while True:
        mode[at.touching] = -1
        why, t, h, steps, events = advance(flight, control, t, h, y, mode, memory, going.record, at.switches)
        note_flight(flight, going, passes, steps, work)
        if why in (_integrator.STUCK, END):
            return STUCK if why == _integrator.STUCK else LATE, t
        if why == FULL:  # only so that the steps are written down
            continue
        if mode[at.edge]:
            return AT_EDGE, t
        if mode[at.touching] >= 0:
            code, t = follow_blow(machine, going, struck, controls[1], train, passes, t, work_of_blow)
            if code != QUIET:
                return code, t
            h = control.first_step
        elif going.record.event[events - 1, 0] - at.own_switches.start == FEED_SWITCH:
            return DONE, t
        else:
            place_bases(flight, t, y, mode, memory)
            if not missed_row(flight, going, passes, t, face_of(flight, y, mode, memory)):
                return TOO_MANY, t
        rows = passes.counts[ROWS_USED]
        if train.most and mode[at.passes] >= train.most:
            return DONE, t
        if (
            train.repeats > 0.0
            and rows > max(looked, train.least)
            and repeats(passes.table, rows - 1, train.repeats, flight.seats.shape[0])
        ):
            return DONE, t
        looked = rows
