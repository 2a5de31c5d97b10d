"""A machine as parts and as the tables that the kernels take: strikers, object, and a rotary drive or a launch.

In a `RotaryDrive` each nose runs on a circle; the object's plane face stands across the direction of the blow and moves
back along it. At the strike position that direction makes the blow angle with the radius. At 0 the strike is that of a
cam: the face stands across the line from the axis, ``engagement`` inside the noses' reach, so that a nose meets it at
the angle arccos(1 - q/R) before its apex with the normal speed w sqrt(2 R q - q^2), which falls as the object has not
come back all the way. At a right angle the strike is tangential, with the whole speed of the rim; a face of finite
width then lets the nose pass, which slips off its edge.

A machine with a `Launch` has no drive: one striker that flies, swings on an arm or waits, and an object that may come
to it, just before first touch. What the kernels need of a drive that is not there stands in `_launch_settings`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strikewave.contact._chain_kernels import GRAVITY, MASS, OPEN, PLACE, SPEED, ChainTables
from strikewave.contact.chain import ChainContact, Link, Spring, first_depths, first_modes, link_arrays, stored_energy
from strikewave.contact.law import AnyContact
from strikewave.contact.motion import MotionState
from strikewave.machines._kernels import (
    ACROSS,
    BASE_ROWS,
    BELT_STIFFNESS,
    CARRIED,
    FIRST,
    HELD,
    INERTIA,
    MOTOR_INERTIA,
    SECOND,
    SETTINGS,
    WAITING,
    WEIGHT_MOMENT,
    MachineSystem,
    place_bases,
)
from strikewave.machines._layout import layout_of
from strikewave.machines.drive import Feed, Turntable, angle_at_valve_signal, speed_after_wait
from strikewave.machines.spans import Rebounds
from strikewave.machines.struck_object import ASSEMBLY, CARRIAGE, NOSE, LayeredObject, StruckObject

Array = NDArray[np.float64]

FOREVER = 1e9  # thirty years
"""Time that never comes, s."""
# The first touch is a located switch like all others, and 10 us at 100 m/s are 1 mm, far more than any contact is
# deep.
BEFORE_TOUCH = 10e-6
"""Time before first touch at which a launched machine begins, s."""
UNIT_RADIUS, UNIT_INERTIA = 1.0, 1.0  # it stands still, so any positive ones do
"""Radius and moment of inertia of the turntable of a launched machine without an arm, m and kg m^2."""
NO_LAST_PASS = 10**6  # it has neither a next striker nor a feed
"""Passes after which the feed of a launched machine would retract."""


@dataclass(frozen=True)
class Arm:
    """The arm of a pendulum that carries the striker; it hangs straight down at the strike."""

    inertia: float
    """Moment of inertia about the pivot, with the striker, kg m^2."""
    radius: float
    """Pivot to striker, m."""
    speed: float
    """Speed `BEFORE_TOUCH` of first touch, rad/s."""
    weight_moment: float
    """Weight times the distance of the centre of gravity from the pivot, N m."""


@dataclass(frozen=True)
class Launch:
    """Begin of a machine without a drive, `BEFORE_TOUCH` of first touch; speeds along the blow."""

    striker_speed: float = 0.0
    """Speed of a striker that flies, m/s."""
    object_speed: float = 0.0
    """Speed of the object, m/s; below 0 where it comes to the striker."""
    arm: Arm | None = None
    """Arm that carries the striker, if there is one."""
    striker_gravity: float = 0.0
    """Gravity along the blow on a flying striker, m/s^2."""
    travel: float = 0.0
    """Time from the release to first touch, s."""
    follow: float = 10e-3
    """Longest time to follow after first touch, s."""
    rebounds: Rebounds | None = None
    """Rebounds to follow; without them only the first blow counts."""


@dataclass(frozen=True)
class Striker:
    """One striker on its mount."""

    mass: float
    """Moving mass, kg."""
    mount_stiffness: float
    """Mount on the turntable along the blow, N/m; 0 where it flies."""
    mount_damping: float
    """N s/m."""
    contact: AnyContact
    """Law of the contact between nose and face."""
    angle_error: float = 0.0
    """Angle by which it stands ahead of its place, rad."""
    reach_error: float = 0.0
    """Distance beyond the radius of the others, m."""


@dataclass(frozen=True)
class Strikers:
    """The strikers, nominally at equal angles."""

    each: tuple[Striker, ...]
    """Strikers in the order in which they strike."""
    slowest_approach: float
    """Lowest approach speed that the hysteresis factor uses, m/s."""
    same_spot: bool = True
    """True if the strikers share the spot that yields: the face, which all hit at one place, not the noses."""
    friction: float = 0.0
    """Coefficient of Coulomb friction of a nose that slides across the face."""
    sliding_damping: float = 0.0
    """Viscous part of that friction, N s/m."""

    @property
    def count(self) -> int:
        """Number of strikers."""
        return len(self.each)

    @property
    def first(self) -> Striker:
        """First striker, which stands for all where they do not differ."""
        return self.each[0]

    @property
    def mass(self) -> float:
        """Mean mass of one, kg."""
        return sum(striker.mass for striker in self.each) / self.count


@dataclass(frozen=True)
class RotaryDrive:
    """Turntable with the strikers, feed with the object, and the geometry in which they meet."""

    turntable: Turntable
    """With motor, controller and brake."""
    feed: Feed
    """Feed of the object."""
    engagement: float
    """Distance along the blow by which the face at rest stands before the place of a nose at the strike position, m:
    the radial overlap of striker path and struck face."""
    blow_angle: float = 0.0
    """Angle of the blow from the outward radius at the strike position, rad: 0 as a cam, pi/2 along the path."""
    face_width: float = math.inf
    """Width of the face across the blow, m, about the strike position."""

    @property
    def first_touch(self) -> float:
        """Angle from the strike position at which a nose meets the face at rest, rad.

        R (cos(p - a) - cos a) = -q: p = a - arccos(cos a - q/R), with the angle a of the blow.
        """
        return self.blow_angle - math.acos(math.cos(self.blow_angle) - self.engagement / self.turntable.radius)

    @property
    def nominal_approach(self) -> float:
        """Approach speed at set speed on an object at rest in the strike position, m/s: w R sin(a - p).

        As a cam it is w sqrt(2 R q - q^2).
        """
        reach = math.cos(self.blow_angle) - self.engagement / self.turntable.radius
        return self.turntable.speed * self.turntable.radius * math.sqrt(1.0 - reach**2)

    @property
    def leaves(self) -> float:
        """Angle after the strike position from which a nose is past the object, rad.

        The apex of a cam; where it has left the face if the blow goes with the path: R sin(p - a) + R sin a = b/2.
        """
        if self.blow_angle == 0.0 or math.isinf(self.face_width):
            return 0.0
        way = 0.5 * self.face_width / self.turntable.radius - math.sin(self.blow_angle)
        return self.blow_angle + math.asin(min(way, 1.0))


@dataclass(frozen=True)
class Machine:
    """Strikers, struck object, and what brings them together: a rotary drive, or a launch just before first touch."""

    strikers: Strikers
    """Strikers on the turntable; the one that flies, swings or waits."""
    struck: StruckObject
    """Struck object as bodies."""
    start: RotaryDrive | Launch
    """Drive or launch that brings them together."""
    layered: LayeredObject | None = None
    """The object's layers, if it has any."""

    @property
    def launch(self) -> Launch | None:
        """Launch of a machine without a drive."""
        return self.start if isinstance(self.start, Launch) else None

    @property
    def rebounds(self) -> Rebounds | None:
        """Rebounds over which a launched machine is followed, if it is."""
        return self.start.rebounds if isinstance(self.start, Launch) else None

    @property
    def drive(self) -> RotaryDrive:
        """Rotary drive; ValueError for a launched machine."""
        if isinstance(self.start, Launch):
            raise ValueError("a launched machine has no drive")
        return self.start

    @property
    def pitch(self) -> float:
        """Angle between strikers, rad."""
        return 2.0 * math.pi / self.strikers.count

    @property
    def radius(self) -> float:
        """Radius of the path of the strikers, m; `UNIT_RADIUS` where nothing turns."""
        if isinstance(self.start, RotaryDrive):
            return self.start.turntable.radius
        return UNIT_RADIUS if self.start.arm is None else self.start.arm.radius

    @property
    def engagement(self) -> float:
        """Engagement of the drive, m; 0 at a launch."""
        return self.start.engagement if isinstance(self.start, RotaryDrive) else 0.0

    @property
    def nominal_approach(self) -> float:
        """Approach speed at first touch, m/s: at set speed on an object at rest, or as the launch gives it."""
        if isinstance(self.start, RotaryDrive):
            return self.start.nominal_approach
        arm = 0.0 if self.start.arm is None else self.start.arm.speed * self.start.arm.radius
        return arm + self.start.striker_speed - self.start.object_speed

    def with_feed(self, **changes: Any) -> Machine:
        """Return the machine with some settings of its feed changed."""
        return replace(self, start=replace(self.drive, feed=replace(self.drive.feed, **changes)))


def machine_links(machine: Machine) -> tuple[list[Link], list[str]]:
    """Return the links and the node names of the machine, bodies first."""
    count, strikers = machine.strikers.count, machine.strikers
    names, seats = [f"striker {i + 1}" for i in range(count)], [f"seat {i + 1}" for i in range(count)]
    spot = 1 if strikers.same_spot else 0
    touches: list[Link] = [
        ChainContact(name, NOSE, striker.contact, strikers.slowest_approach, spot=spot)
        for name, striker in zip(names, strikers.each, strict=True)
    ]
    mounts: list[Link] = [
        Spring(seat, name, striker.mount_stiffness, striker.mount_damping)
        for seat, name, striker in zip(seats, names, strikers.each, strict=True)
    ]
    links = touches + mounts + machine.struck.links(rest=-machine.engagement)
    return links, [*names, NOSE, ASSEMBLY, *seats, CARRIAGE]


def machine_system(machine: Machine) -> MachineSystem:
    """Return the machine as the tables that the kernels take."""
    links, nodes = machine_links(machine)
    count, struck, start = machine.strikers.count, machine.struck, machine.start
    if isinstance(start, RotaryDrive):
        angle, pull, settings = start.blow_angle, 0.0, _drive_settings(start)
    else:
        angle = 0.0 if start.arm is None else 0.5 * math.pi  # an arm strikes along its path
        pull, settings = start.striker_gravity, _launch_settings(start)
    bodies, seats = np.zeros((count + 2, 3)), np.zeros((count, 3))
    for i, striker in enumerate(machine.strikers.each):
        stands = machine.pitch * i + angle - striker.angle_error
        flies = striker.mount_stiffness == 0.0
        bodies[i] = striker.mass, pull if flies else 0.0, 0.0 if flies else striker.mass
        seats[i] = math.cos(stands), math.sin(stands), machine.radius + striker.reach_error
    bodies[count] = struck.nose_mass, struck.gravity, 0.0
    bodies[count + 1] = struck.assembly_mass, struck.gravity, 0.0
    joins, of_links = link_arrays(links, nodes)
    chain = ChainTables(bodies, np.zeros((BASE_ROWS, count + 1)), joins, of_links)
    settings |= {
        "stop_at_touch": 0.0 if machine.layered is None and machine.rebounds is None else 1.0,
        "along": machine.radius * math.cos(angle),
        "across": machine.radius * math.sin(angle),
        "pitch": machine.pitch,
        "contact_friction": machine.strikers.friction,
        "sliding_damping": machine.strikers.sliding_damping,
    }
    values = np.array([settings[name] for name in SETTINGS], dtype=float)
    return MachineSystem(chain, seats, values)


def _drive_settings(drive: RotaryDrive) -> dict[str, float]:
    """Return the settings of the kernels by turntable, feed and face."""
    disc, feed = drive.turntable, drive.feed
    return {
        "inertia": disc.turning if disc.rigid_belt else disc.inertia,  # on a rigid belt the motor turns with it
        "drag": disc.drag,
        "set_speed": disc.speed,
        "gain": disc.speed_gain,
        "torque": disc.torque,
        "ripple": disc.ripple,
        "ripple_order": disc.ripple_order,
        "ripple_phase": disc.ripple_phase,
        "motor_inertia": disc.motor_inertia,
        "belt_stiffness": disc.belt_stiffness,
        "belt_damping": disc.belt_damping,
        "weight_moment": 0.0,
        "valve_delay": feed.valve_delay,
        "stroke": feed.stroke,
        "stroke_time": feed.stroke_time,
        "acceleration": feed.acceleration,
        "cushion": feed.cushion,
        "hold": min(feed.hold, FOREVER),
        "release_delay": feed.release_delay,
        "retract_time": feed.retract_time,
        "blows": feed.blows,
        "half_face": 0.5 * drive.face_width,
    }


def _launch_settings(launch: Launch) -> dict[str, float]:
    """Return the settings of the kernels without drive and feed: an arm that hangs free, and an end in time.

    No motor, belt, brake or ripple; the object is in place from the start, on a face without edges, and the run ends
    with the hold of the feed. A stroke of 0 means no feed.
    """
    absent = (
        *("drag", "set_speed", "gain", "torque", "ripple", "ripple_order", "ripple_phase", "motor_inertia"),
        *("belt_damping", "valve_delay", "stroke", "release_delay"),
    )
    return dict.fromkeys(absent, 0.0) | {
        "inertia": UNIT_INERTIA if launch.arm is None else launch.arm.inertia,
        "belt_stiffness": math.inf,
        "weight_moment": 0.0 if launch.arm is None else launch.arm.weight_moment,
        "stroke_time": 1.0,
        "acceleration": 0.5,
        "cushion": 0.5,
        "retract_time": 1.0,
        "hold": BEFORE_TOUCH + launch.follow,
        "blows": NO_LAST_PASS,
        "half_face": math.inf,
    }


def start_state(machine: Machine, system: MachineSystem) -> MotionState:
    """Return the state at the valve signal: at speed, object at rest on its stop, carriage retracted."""
    if isinstance(machine.start, Launch):
        return _launched_state(machine, machine.start, system)
    drive, at, struck = machine.start, layout_of(system), machine.struck
    disc, feed = drive.turntable, drive.feed
    start = _blank_state(system)
    _, y, modes, memory = start
    x, v = y[at.positions], y[at.speeds]
    modes[at.feed] = WAITING
    memory[at.next_apex] = machine.pitch + drive.leaves
    y[at.angle] = angle_at_valve_signal(feed, disc.speed, machine.pitch) + drive.leaves
    swing = disc.ripple * math.sin(disc.ripple_order * y[at.angle] + disc.ripple_phase)
    speed = speed_after_wait(disc, feed.wait)
    speed += swing * disc.speed
    y[at.turntable_speed] = y[at.motor_speed] = speed
    if not disc.rigid_belt:
        y[at.belt_twist] = disc.drag * speed / disc.belt_stiffness
    place_bases(system, 0.0, y, modes, memory)
    bases = system.chain.bases
    # on its mount a striker runs steadily on the larger circle R / (1 - m w^2 / k)
    for i, striker in enumerate(machine.strikers.each):
        larger = 1.0 / (1.0 - striker.mass * speed**2 / striker.mount_stiffness)
        x[i] = bases[PLACE, i] - (larger - 1.0) * bases[SECOND, i]
        v[i] = larger * bases[SPEED, i]
    x[at.assembly] = -drive.engagement + feed.stroke
    x[at.nose] = x[at.assembly] + struck.nose_mass * struck.gravity / struck.frame_stiffness  # the frame carries it
    modes[at.link_modes] = modes_at(system, y)
    before = np.abs(bases[ACROSS, at.strikers]) <= 0.5 * drive.face_width
    modes[at.on_face] = before
    modes[at.contacts] = np.where(before, modes[at.contacts], OPEN)
    return start


def _blank_state(system: MachineSystem) -> MotionState:
    """Return a state of zeros in which no link has yielded."""
    at = layout_of(system)
    memory = np.zeros(at.memories)
    memory[at.depths], memory[at.growths] = first_depths(system.chain.links), 1.0
    return MotionState(0.0, np.zeros(at.states), np.zeros(at.modes, dtype=np.int64), memory)


def _launched_state(machine: Machine, launch: Launch, system: MachineSystem) -> MotionState:
    """Return the state `BEFORE_TOUCH` of a launched machine: striker or arm moving, object in place."""
    at, struck, start = layout_of(system), machine.struck, _blank_state(system)
    _, y, modes, memory = start
    x, v = y[at.positions], y[at.speeds]
    modes[at.feed], modes[at.on_face] = HELD, 1
    memory[at.next_apex] = FOREVER
    turning = 0.0 if launch.arm is None else launch.arm.speed
    y[at.angle], y[at.turntable_speed] = -turning * BEFORE_TOUCH, turning
    place_bases(system, 0.0, y, modes, memory)
    bases = system.chain.bases
    if machine.strikers.first.mount_stiffness > 0.0:
        x[0], v[0] = bases[PLACE, 0], bases[SPEED, 0]
    else:
        x[0], v[0] = -launch.striker_speed * BEFORE_TOUCH, launch.striker_speed
    x[at.nose] = x[at.assembly] = -launch.object_speed * BEFORE_TOUCH
    if launch.object_speed == 0.0:
        x[at.nose] += struck.nose_mass * struck.gravity / struck.frame_stiffness
    v[at.nose] = v[at.assembly] = launch.object_speed
    modes[at.link_modes] = modes_at(system, y)
    return start


def nodes_at(system: MachineSystem, y: Array) -> Array:
    """Return the places of bodies and bases, m; the bases as placed last."""
    return np.concatenate([y[layout_of(system).positions], system.chain.bases[PLACE]])


def modes_at(system: MachineSystem, y: Array, deepest: Array | None = None) -> NDArray[np.int64]:
    """Return the mode of each link in a state, the bases as placed last; see `first_modes`."""
    speeds = np.concatenate([y[layout_of(system).speeds], system.chain.bases[SPEED]])
    return first_modes(system.chain.links, nodes_at(system, y), deepest, speeds)


def energy(system: MachineSystem, state: MotionState) -> float:
    """Return kinetic energy of turntable, motor and bodies, energy stored in links and belt, and of height, J."""
    at, y, bodies, settings = layout_of(system), state.y, system.chain.bodies, system.settings
    place_bases(system, state.time, y, state.mode, state.memory)
    first = system.chain.bases[FIRST, at.strikers]
    inertia = float(settings[INERTIA]) - float(bodies[at.strikers, CARRIED] @ first**2)
    stored = stored_energy(system.chain.links, nodes_at(system, y), state.memory[at.depths], state.mode)
    if settings[BELT_STIFFNESS] < np.inf:
        twist, motor = y[at.belt_twist], y[at.motor_speed]
        stored += 0.5 * settings[BELT_STIFFNESS] * twist**2 + 0.5 * settings[MOTOR_INERTIA] * motor**2
    height = -float(np.sum(bodies[:, MASS] * bodies[:, GRAVITY] * y[at.positions]))
    height -= float(settings[WEIGHT_MOMENT]) * math.cos(y[at.angle])
    moving = 0.5 * inertia * y[at.turntable_speed] ** 2 + 0.5 * float(bodies[:, MASS] @ y[at.speeds] ** 2)
    return moving + stored + height
