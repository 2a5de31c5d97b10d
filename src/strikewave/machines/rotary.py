"""The rotary machine: a turntable whose strikers hit a fed, spring-held object one after the other.

Each nose runs on a circle; the object's plane face stands across the direction of the blow and moves back along
it. At the strike position that direction makes the blow angle with the radius. At 0 the strike is that of a cam: the
face stands across the line from the axis, ``engagement`` inside the noses' reach, so that a nose meets it at the
angle arccos(1 - q/R) before its apex with the normal speed w sqrt(2 R q - q^2), which falls as the object has not
come back all the way. At a right angle the strike is tangential, with the whole speed of the rim; a face of finite
width then lets the nose pass, which slips off its edge.
"""

from __future__ import annotations

import bisect
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from strikewave.contact._chain_kernels import GRAVITY, MASS, OPEN, PLACE, SPEED, Links
from strikewave.contact._integrator import Control
from strikewave.contact._law_kernels import DAMPER
from strikewave.contact.chain import Link, Spring, Touch, first_depths, first_modes, link_arrays, stored_energy
from strikewave.contact.law import AnyContact, elastic_indentation, striking_law
from strikewave.contact.motion import State, integrate
from strikewave.errors import IntegrationError
from strikewave.machines._kernels import (
    ACROSS,
    BASE_ROWS,
    BELT_TWIST,
    CARRIED,
    EDGE,
    FEED,
    FEED_SWITCH,
    FIRST,
    INERTIA,
    MOTOR_SPEED,
    NEXT_APEX,
    ON_FACE,
    PASSES,
    RETRACTING,
    SECOND,
    SETTINGS,
    WAITING,
    RotarySystem,
    place_bases,
)
from strikewave.machines.feed import Feed, angle_at_valve_signal, expected_time
from strikewave.machines.layered import LayeredObject
from strikewave.machines.spans import ChainSpan, Moments, Places, Span, StackSpan
from strikewave.machines.strike import strike
from strikewave.machines.struck_object import ASSEMBLY, CARRIAGE, NOSE, StruckObject
from strikewave.machines.turntable import Turntable, braking_time, speed_after_wait, spin_up_time

Array = NDArray[np.float64]

FOREVER = 1e9
"""A time that never comes, s."""


@dataclass(frozen=True)
class Striker:
    """One striker on its mount.

    Parameters
    ----------
    mass : float
        Moving mass, kg.
    mount_stiffness, mount_damping : float
        The mount on the turntable along the blow, N/m and N s/m.
    contact : Contact
        Law of the contact between nose and face.
    angle_error, reach_error : float, optional
        How far it stands ahead of its place (rad), and beyond the radius of the others (m).
    """

    mass: float
    mount_stiffness: float
    mount_damping: float
    contact: AnyContact
    angle_error: float = 0.0
    reach_error: float = 0.0


@dataclass(frozen=True)
class Strikers:
    """The strikers, nominally at equal angles.

    Parameters
    ----------
    each : tuple of Striker
        In the order in which they strike.
    slowest_approach : float
        Lowest approach speed that the hysteresis factor uses, m/s.
    same_spot : bool
        Whether the strikers share what yields: it is the face, which all hit on the same spot, not the noses.
    """

    each: tuple[Striker, ...]
    slowest_approach: float
    same_spot: bool = True

    @property
    def count(self) -> int:
        """How many."""
        return len(self.each)

    @property
    def first(self) -> Striker:
        """The first one, which stands for all where they do not differ."""
        return self.each[0]

    @property
    def mass(self) -> float:
        """Mean mass of one, kg."""
        return sum(striker.mass for striker in self.each) / self.count


@dataclass(frozen=True)
class RotaryMachine:
    """Turntable, strikers, feed, object, and how they meet.

    Parameters
    ----------
    turntable : Turntable
        With its drive.
    strikers : Strikers
        On the turntable.
    feed : Feed
        Of the object.
    struck : StruckObject
        As bodies.
    engagement : float
        How far before the place of a nose at the strike position the face rests, along the blow, m.
    layered : LayeredObject, optional
        The object's layers, if it has any.
    blow_angle : float, optional
        Of the blow from the outward radius at the strike position, rad: 0 as a cam, pi/2 along the path.
    face_width : float, optional
        Of the face across the blow, m, about the strike position.
    """

    turntable: Turntable
    strikers: Strikers
    feed: Feed
    struck: StruckObject
    engagement: float
    layered: LayeredObject | None = None
    blow_angle: float = 0.0
    face_width: float = math.inf

    @property
    def pitch(self) -> float:
        """Angle between strikers, rad."""
        return 2.0 * math.pi / self.strikers.count

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
class RotaryRun:
    """A run of the machine; time 0 is the valve signal.

    Attributes
    ----------
    machine : RotaryMachine
        What ran.
    spans : tuple of Span
        Everything between valve signal and end of the retraction, one span after the other.
    phases : tuple of (str, float)
        Name and time of each phase, s.
    energy_error : float
        Energy that the ledger misses over the energy that flowed.
    """

    machine: RotaryMachine
    spans: tuple[Span, ...]
    phases: tuple[tuple[str, float], ...]
    energy_error: float

    @property
    def end(self) -> float:
        """Time at which the object is back, s."""
        return self.spans[-1].end

    def span_at(self, time: float) -> Span:
        """Return the span at a time; where two meet, the later one."""
        begins = [span.begin for span in self.spans]
        return self.spans[max(bisect.bisect_right(begins, time) - 1, 0)]

    def deepest(self, time: float, striker: int) -> float:
        """Return the depth to which the spot of a striker (from 0) has yielded by a time, m."""
        return self.span_at(time).deepest(time, striker)

    def sample(self, times: Array) -> Moments:
        """Return what the machine does at times between 0 and the end, in any order.

        Raises
        ------
        ValueError
            If a time lies outside.
        """
        wanted = np.atleast_1d(np.asarray(times, dtype=float))
        if len(self.spans) == 1:
            return self.spans[0].sample(wanted)
        begins = np.array([span.begin for span in self.spans])
        which = np.maximum(np.searchsorted(begins, wanted, side="right") - 1, 0)
        out = Moments(*(np.empty(wanted.size) for _ in Moments._fields))
        for k in np.unique(which):
            here = which == k
            for column, values in zip(out, self.spans[k].sample(wanted[here]), strict=True):
                column[here] = values
        return out

    def contacts(self) -> Array:
        """Return begin, end (s), approach speed (m/s) and striker (from 0) of each contact in order of time."""
        rows = np.concatenate([span.contacts() for span in self.spans])
        return rows[np.argsort(rows[:, 0], kind="stable")]

    def switch_times(self, which: int) -> Array:
        """Return when one of the machine's own switches changed, s."""
        rows = np.concatenate([span.switches() for span in self.spans])
        return rows[rows[:, 0] == which, 1]

    def impulses(self, begin: float, end: float) -> tuple[float, float]:
        """Return the impulses on the object of contacts and of supports with gravity between two times, N s."""
        parts = [span.impulses(begin, end) for span in self.spans if span.begin < end and span.end > begin]
        return sum(part[0] for part in parts), sum(part[1] for part in parts)


def machine_links(machine: RotaryMachine) -> tuple[list[Link], list[str]]:
    """Return the links and the node names of the machine, bodies first."""
    count, strikers = machine.strikers.count, machine.strikers
    names, seats = [f"striker {i + 1}" for i in range(count)], [f"seat {i + 1}" for i in range(count)]
    spot = 1 if strikers.same_spot else 0
    touches: list[Link] = [
        Touch(name, NOSE, striker.contact, strikers.slowest_approach, spot=spot)
        for name, striker in zip(names, strikers.each, strict=True)
    ]
    mounts: list[Link] = [
        Spring(seat, name, striker.mount_stiffness, striker.mount_damping)
        for seat, name, striker in zip(seats, names, strikers.each, strict=True)
    ]
    links = touches + mounts + machine.struck.links(rest=-machine.engagement)
    return links, [*names, NOSE, ASSEMBLY, *seats, CARRIAGE]


def rotary_system(machine: RotaryMachine) -> RotarySystem:
    """Return the machine as the tables that the kernels take."""
    links, nodes = machine_links(machine)
    count, disc, feed, struck = machine.strikers.count, machine.turntable, machine.feed, machine.struck
    angle = machine.blow_angle
    bodies, seats = np.zeros((count + 2, 3)), np.zeros((count, 3))
    for i, striker in enumerate(machine.strikers.each):
        stands = machine.pitch * i + angle - striker.angle_error
        bodies[i] = striker.mass, 0.0, striker.mass
        seats[i] = math.cos(stands), math.sin(stands), disc.radius + striker.reach_error
    bodies[count] = struck.nose_mass, struck.gravity, 0.0
    bodies[count + 1] = struck.assembly_mass, struck.gravity, 0.0
    tables = link_arrays(links, nodes)
    settings = {
        "inertia": disc.turning if disc.rigid_belt else disc.inertia,
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
        "weight_angle": 0.0,
        "valve_delay": feed.valve_delay,
        "stroke": feed.stroke,
        "stroke_time": feed.stroke_time,
        "acceleration": feed.acceleration,
        "cushion": feed.cushion,
        "hold": min(feed.hold, FOREVER),
        "release_delay": feed.release_delay,
        "retract_time": feed.retract_time,
        "blows": feed.blows,
        "layered": 0.0 if machine.layered is None else 1.0,
        "along": disc.radius * math.cos(angle),
        "across": disc.radius * math.sin(angle),
        "half_face": 0.5 * machine.face_width,
        "pitch": machine.pitch,
    }
    values = np.array([settings[name] for name in SETTINGS], dtype=float)
    return RotarySystem(bodies, np.zeros((BASE_ROWS, count + 1)), tables.joins, tables.values, seats, values)


def start_state(machine: RotaryMachine, system: RotarySystem) -> State:
    """Return the state at the valve signal: at speed, object at rest on its stop, carriage retracted."""
    place, disc, struck = places_of(machine), machine.turntable, machine.struck
    count, feed = place.strikers, machine.feed
    speed = speed_after_wait(disc, feed.wait)
    y = np.zeros(place.energies + place.links + 3)
    modes = np.zeros(place.own_modes.stop, dtype=np.int64)
    modes[place.links + FEED] = WAITING
    memory = np.zeros(place.growths.stop)
    memory[place.growths] = 1.0
    memory[place.links + NEXT_APEX] = machine.pitch + machine.leaves
    memory[place.depths] = first_depths(Links(system.joins, system.values))
    y[place.angle] = angle_at_valve_signal(feed, disc.speed, machine.pitch) + machine.leaves
    y[place.angle + 1] = y[place.angle + MOTOR_SPEED] = speed
    if not disc.rigid_belt:
        y[place.angle + BELT_TWIST] = disc.drag * speed / disc.belt_stiffness
    place_bases(system, 0.0, y, modes, memory)
    bases = system.bases
    # on its mount a striker runs steadily on the larger circle R / (1 - m w^2 / k)
    for i, striker in enumerate(machine.strikers.each):
        larger = 1.0 / (1.0 - striker.mass * speed**2 / striker.mount_stiffness)
        y[i] = bases[PLACE, i] - (larger - 1.0) * bases[SECOND, i]
        y[place.bodies + i] = larger * bases[SPEED, i]
    rest = -machine.engagement + feed.stroke
    y[place.assembly] = rest
    y[place.nose] = rest + struck.nose_mass * struck.gravity / struck.frame_stiffness
    nodes = np.concatenate([y[: place.bodies], bases[PLACE]])
    modes[: place.links] = first_modes(Links(system.joins, system.values), nodes)
    before = np.abs(bases[ACROSS, :count]) <= 0.5 * machine.face_width
    modes[place.links + ON_FACE :] = before
    modes[place.contacts] = np.where(before, modes[place.contacts], OPEN)
    return State(0.0, y, modes, memory)


def places_of(machine: RotaryMachine) -> Places:
    """Return where the state and the links of a machine stand."""
    return Places(machine.strikers.count, machine.struck.rubs)


def energy(machine: RotaryMachine, system: RotarySystem, state: State) -> float:
    """Return kinetic energy of turntable, motor and bodies, energy stored in links and belt, and of height, J."""
    place, disc = places_of(machine), machine.turntable
    x, v = state.y[: place.bodies], state.y[place.bodies : place.angle]
    speed, twist, motor = state.y[place.angle + 1 : place.energies]
    place_bases(system, state.time, state.y, state.mode, state.memory)
    bases = system.bases
    inertia = system.settings[INERTIA] - float(
        system.bodies[: place.strikers, CARRIED] @ bases[FIRST, : place.strikers] ** 2
    )
    nodes = np.concatenate([x, bases[PLACE]])
    stored = stored_energy(Links(system.joins, system.values), nodes, state.memory[place.depths], state.mode)
    if not disc.rigid_belt:
        stored += 0.5 * disc.belt_stiffness * twist**2 + 0.5 * disc.motor_inertia * motor**2
    height = -float(np.sum(system.bodies[:, MASS] * system.bodies[:, GRAVITY] * x))
    return 0.5 * inertia * speed**2 + 0.5 * float(system.bodies[:, MASS] @ v**2) + stored + height


def run_rotary(
    machine: RotaryMachine, tolerance: float = 1e-9, progress: Callable[[float], None] | None = None
) -> RotaryRun:
    """Run the machine from rest to rest.

    Spin-up and braking follow closed forms; from the valve signal to the end of the retraction everything
    is integrated together, with every contact, stop, drive limit and feed phase as a located switch. Where
    the object is a stack of layers, each blow is followed by `strike` instead.

    Parameters
    ----------
    machine : RotaryMachine
        What to run.
    tolerance : float, optional
        Local error of a step over the scales of one contact.
    progress : callable, optional
        Called with the share of the expected time done, 0 to 1.

    Raises
    ------
    IntegrationError
        If the motion cannot be followed, or the turntable comes to a stand among the blows.
    ValueError
        If the drive cannot hold the set speed.
    """
    disc, feed, place = machine.turntable, machine.feed, places_of(machine)
    contacts = [striker.contact for striker in machine.strikers.each]
    if machine.layered is not None and any(striking_law(contact)[DAMPER] for contact in contacts):
        raise ValueError("a machine's striker takes a contact with hysteresis, not with a damper")
    system = rotary_system(machine)
    start = state = start_state(machine, system)
    approach = machine.nominal_approach
    pitch_time = machine.pitch / disc.speed
    depth = elastic_indentation(machine.strikers.first.contact, machine.struck.nose_mass, approach)
    scale = np.full(start.y.size, 0.5 * machine.struck.mass * approach**2)
    scale[: place.bodies] = depth
    scale[place.bodies : place.angle] = approach
    scale[place.angle : place.energies : 2] = depth / disc.radius
    scale[place.angle + 1 : place.energies : 2] = approach / disc.radius
    expected = expected_time(feed, pitch_time)
    control = Control(tolerance, scale, 2e-3 * depth / approach, 0.02 * pitch_time, 3.0 * expected)
    report = None if progress is None else (lambda t: progress(min(t / expected, 1.0)))
    spans: list[Span] = []
    while True:
        motion = integrate(system, state, control, (place.links, place.switches), report)
        if motion.record.time.size:  # none where the next striker touches at once
            spans.append(ChainSpan(machine.struck, place, motion))
        state = motion.end
        if state.mode[place.links + EDGE]:
            raise IntegrationError(_at_the_edge(machine, state, place))
        if machine.layered is None or not np.any(state.mode[place.contacts] != OPEN):
            break
        first = not any(isinstance(span, StackSpan) for span in spans)
        blow, state = strike(machine.layered, machine.struck, system, state, field=first)
        spans.append(blow)
    if state.mode[place.links + FEED] != RETRACTING or state.time >= control.end:
        done = int(state.mode[place.links + PASSES])
        raise IntegrationError(
            f"after {state.time:.3g} s only {done} of {feed.blows} passes were made and the turntable turns at "
            f"{state.y[place.angle + 1]:.3g} rad/s: give it more inertia or torque, or less engagement"
        )
    dissipated = state.y[place.energies : place.energies + place.links]
    driven, dragged, fed = state.y[place.energies + place.links :]
    gained = energy(machine, system, state) - energy(machine, system, start)
    flowed = abs(driven) + dragged + np.abs(dissipated).sum()
    missing = gained - (driven - dragged - dissipated.sum() + fed)
    run = RotaryRun(machine, tuple(spans), (), float(abs(missing) / flowed))
    last_speed = float(state.y[place.angle + 1])
    return replace(run, phases=_phases(run, last_speed))


def _at_the_edge(machine: RotaryMachine, state: State, place: Places) -> str:
    """Return in words that a striker met the edge of the face."""
    striker = int(state.mode[place.links + EDGE])
    deep = float(state.y[striker - 1] - state.y[place.nose])
    return (
        f"at {state.time:.4g} s striker {striker} met the edge of the face {deep * 1e3:.3g} mm behind it: make "
        f"machine.face_width ({machine.face_width * 1e3:.4g} mm) larger, or machine.engagement "
        f"({machine.engagement * 1e3:.4g} mm) smaller; or the object has not come back yet"
    )


def _phases(run: RotaryRun, last_speed: float) -> tuple[tuple[str, float], ...]:
    """Return name and time of each phase; 0 is the valve signal."""
    disc, feed = run.machine.turntable, run.machine.feed
    times, touched = run.switch_times(FEED_SWITCH), run.contacts()
    at_speed = -feed.wait
    named = [
        ("spin-up", at_speed - spin_up_time(disc)),
        ("at speed", at_speed),
        ("valve signal", 0.0),
        ("feed", float(times[0])),
        ("fed", float(times[1])),
        ("retract command", float(times[2]) - feed.release_delay),
        ("retract", float(times[2])),
        ("brake", run.end),
        ("stopped", run.end + braking_time(disc, last_speed)),
    ]
    if len(touched):
        named.append(("blows", float(touched[0, 0])))
    return tuple(sorted(named, key=lambda item: item[1]))
