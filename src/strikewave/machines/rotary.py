"""The rotary machine: a turntable whose strikers hit a fed, spring-held object one after the other.

The strike is that of a cam. Each nose runs on a circle; the object's plane face stands across the line
from the axis through the strike position, ``engagement`` inside the noses' reach, and moves back along
that line. A nose therefore meets the face at the angle arccos(1 - q/R) before its apex with the normal
speed w sqrt(2 R q - q^2), which falls as the object has not come back all the way.
"""

from __future__ import annotations

import bisect
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from strikewave.contact._chain_kernels import GRAVITY, MASS, OPEN, Links
from strikewave.contact._integrator import Control
from strikewave.contact._law_kernels import DAMPER
from strikewave.contact.chain import Link, Spring, Touch, first_depths, first_modes, link_arrays, stored_energy
from strikewave.contact.law import AnyContact, elastic_indentation, striking_law
from strikewave.contact.motion import State, integrate
from strikewave.errors import IntegrationError
from strikewave.machines._kernels import (
    APEX_SWITCH,
    FEED,
    FEED_SWITCH,
    NEXT_APEX,
    PASSES,
    RETRACTING,
    WAITING,
    RotarySystem,
)
from strikewave.machines.feed import Feed, angle_at_valve_signal, expected_time
from strikewave.machines.layered import LayeredObject
from strikewave.machines.spans import ChainSpan, Moments, Places, Span, StackSpan
from strikewave.machines.strike import strike
from strikewave.machines.struck_object import ASSEMBLY, CARRIAGE, NOSE, StruckObject
from strikewave.machines.turntable import Turntable, braking_time, speed_after_wait, spin_up_time

Array = NDArray[np.float64]

OWN_SWITCHES = APEX_SWITCH + 1
"""Number of the machine's own switch functions."""


@dataclass(frozen=True)
class Strikers:
    """Equal strikers at equal angles.

    Parameters
    ----------
    count : int
        How many.
    mass : float
        Moving mass of one, kg.
    mount_stiffness, mount_damping : float
        The mount on the turntable along the blow, N/m and N s/m.
    contact : Contact
        Law of the contact between nose and face.
    slowest_approach : float
        Lowest approach speed that the hysteresis factor uses, m/s.
    same_spot : bool
        Whether the strikers share what yields: it is the face, which all hit on the same spot, not the noses.
    """

    count: int
    mass: float
    mount_stiffness: float
    mount_damping: float
    contact: AnyContact
    slowest_approach: float
    same_spot: bool = True


@dataclass(frozen=True)
class RotaryMachine:
    """Turntable, strikers, feed, object, the engagement of the noses (m), and the object's layers if it has any."""

    turntable: Turntable
    strikers: Strikers
    feed: Feed
    struck: StruckObject
    engagement: float
    layered: LayeredObject | None = None

    @property
    def pitch(self) -> float:
        """Angle between strikers, rad."""
        return 2.0 * math.pi / self.strikers.count

    @property
    def nominal_approach(self) -> float:
        """Approach speed at set speed on an object at rest in the strike position, m/s: w sqrt(2 R q - q^2)."""
        q, radius = self.engagement, self.turntable.radius
        return self.turntable.speed * math.sqrt((2.0 * radius - q) * q)


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
    touches: list[Link] = [Touch(name, NOSE, strikers.contact, strikers.slowest_approach, spot=spot) for name in names]
    mounts: list[Link] = [
        Spring(seat, name, strikers.mount_stiffness, strikers.mount_damping)
        for seat, name in zip(seats, names, strict=True)
    ]
    links = touches + mounts + machine.struck.links(rest=-machine.engagement)
    return links, [*names, NOSE, ASSEMBLY, *seats, CARRIAGE]


def rotary_system(machine: RotaryMachine) -> RotarySystem:
    """Return the machine as the tables that the kernels take."""
    links, nodes = machine_links(machine)
    count, disc, feed, struck = machine.strikers.count, machine.turntable, machine.feed, machine.struck
    bodies = np.zeros((count + 2, 3))
    bodies[:count] = machine.strikers.mass, 0.0, machine.strikers.mass
    bodies[count] = struck.nose_mass, struck.gravity, 0.0
    bodies[count + 1] = struck.assembly_mass, struck.gravity, 0.0
    tables = link_arrays(links, nodes)
    settings = [disc.inertia, disc.radius, disc.speed, disc.speed_gain, disc.torque, disc.drag]
    settings += [feed.valve_delay, feed.stroke, feed.stroke_time, feed.release_delay, feed.retract_time, feed.blows]
    settings += [0.0 if machine.layered is None else 1.0, math.sin(machine.pitch), math.cos(machine.pitch)]
    return RotarySystem(bodies, np.zeros((5, count + 1)), tables.joins, tables.values, np.array(settings))


def start_state(machine: RotaryMachine, system: RotarySystem) -> State:
    """Return the state at the valve signal: at speed, object at rest on its stop, carriage retracted."""
    place, disc, struck = Places(machine.strikers.count), machine.turntable, machine.struck
    speed = speed_after_wait(disc, machine.feed.wait)
    theta = angle_at_valve_signal(machine.feed, disc.speed, machine.pitch)
    y = np.zeros(place.angle + 2 + place.links + 3)
    p = theta - machine.pitch * np.arange(place.strikers)
    # on its mount a striker runs steadily on the larger circle R / (1 - m w^2 / k)
    circle = disc.radius / (1.0 - machine.strikers.mass * speed**2 / machine.strikers.mount_stiffness)
    y[: place.strikers] = circle * np.cos(p) - disc.radius
    y[place.bodies : place.bodies + place.strikers] = -circle * speed * np.sin(p)
    rest = -machine.engagement + machine.feed.stroke
    y[place.assembly] = rest
    y[place.nose] = rest + struck.nose_mass * struck.gravity / struck.frame_stiffness
    y[place.angle], y[place.angle + 1] = theta, speed
    seats = disc.radius * (np.cos(p) - 1.0)
    nodes = np.concatenate([y[: place.bodies], seats, [machine.feed.stroke]])
    modes = np.concatenate([first_modes(Links(system.joins, system.values), nodes), [0, WAITING, 0, 0]]).astype(
        np.int64
    )
    memory = np.zeros(place.growths.stop)
    memory[place.growths] = 1.0
    memory[place.links + NEXT_APEX] = machine.pitch
    memory[place.depths] = first_depths(Links(system.joins, system.values))
    return State(0.0, y, modes, memory)


def energy(machine: RotaryMachine, system: RotarySystem, state: State) -> float:
    """Return kinetic energy of turntable and bodies, energy stored in links, and energy of height, J."""
    place, radius = Places(machine.strikers.count), machine.turntable.radius
    x, v = state.y[: place.bodies], state.y[place.bodies : place.angle]
    theta, speed = state.y[place.angle], state.y[place.angle + 1]
    p = theta - machine.pitch * np.arange(place.strikers)
    inertia = machine.turntable.inertia - machine.strikers.mass * float(np.sum((radius * np.sin(p)) ** 2))
    out = state.mode[place.links + FEED] in (WAITING, RETRACTING)
    nodes = np.concatenate([x, radius * (np.cos(p) - 1.0), [machine.feed.stroke if out else 0.0]])
    stored = stored_energy(Links(system.joins, system.values), nodes, state.memory[place.depths])
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
    disc, feed, place = machine.turntable, machine.feed, Places(machine.strikers.count)
    if machine.layered is not None and striking_law(machine.strikers.contact)[DAMPER]:
        raise ValueError("a machine's striker takes a contact with hysteresis, not with a damper")
    system = rotary_system(machine)
    start = state = start_state(machine, system)
    approach = machine.nominal_approach
    pitch_time = machine.pitch / disc.speed
    depth = elastic_indentation(machine.strikers.contact, machine.struck.nose_mass, approach)
    scale = np.full(start.y.size, 0.5 * machine.struck.mass * approach**2)
    scale[: place.bodies] = depth
    scale[place.bodies : place.angle] = approach
    scale[place.angle], scale[place.angle + 1] = depth / disc.radius, approach / disc.radius
    expected = expected_time(feed, pitch_time)
    control = Control(tolerance, scale, 2e-3 * depth / approach, 0.02 * pitch_time, 3.0 * expected)
    report = None if progress is None else (lambda t: progress(min(t / expected, 1.0)))
    spans: list[Span] = []
    while True:
        motion = integrate(system, state, control, (place.links, place.own_switches + OWN_SWITCHES), report)
        if motion.record.time.size:  # none where the next striker touches at once
            spans.append(ChainSpan(machine.struck, place, motion))
        state = motion.end
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
