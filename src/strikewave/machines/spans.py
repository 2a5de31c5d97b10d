"""A run of a machine in spans: as bodies between blows, as a stack of layers in a blow, and over its rebounds.

Both kinds of span have the same methods: moments at given times, contacts, switches and impulses.

Between two blows of a launched machine striker and object fly apart and come together again, by gravity, spring or arm.
With a restitution e and gravity g a ball that comes with v rises to the heights h e^(2n), flies 2 v e^n/g between the
blows n and n + 1, and would rest after v/g (1 + e)/(1 - e) of time from its release.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from strikewave.contact.chain import contacts
from strikewave.contact.motion import Motion
from strikewave.machines import _stack_kernels as column
from strikewave.machines._layout import StateLayout
from strikewave.machines.struck_object import StruckObject

Array = NDArray[np.float64]

_TIMES_AT_ONCE = 50_000  # two million would take 1 GB
"""Most times at which a machine's whole state is sampled at once, in 25 MB."""


class Moments(NamedTuple):
    """Motion and forces of a machine at given times, SI, one value a time.

    The rigid acceleration is that of a sensor whose zero is taken before the blow: of an object that falls without
    gravity; see `StruckObject.sensed_gravity`. Places and speeds are those of the machine's frame.
    """

    contact_force: Array
    rigid_acceleration: Array
    face_place: Array
    assembly_place: Array
    assembly_speed: Array
    object_speed: Array
    turntable_angle: Array
    turntable_speed: Array
    indentation: Array
    side_force: Array
    friction_heat: Array


class Impulses(NamedTuple):
    """Impulses on the object between two times, N s: of the contacts; of supports with gravity; across the blow."""

    contact: float = 0.0
    support: float = 0.0
    side: float = 0.0


@dataclass(frozen=True)
class ChainSpan:
    """A span in which the object is nose, frame and assembly."""

    struck: StruckObject
    layout: StateLayout
    motion: Motion

    @property
    def begin(self) -> float:
        """First time, s."""
        return float(self.motion.begin)

    @property
    def end(self) -> float:
        """Last time, s."""
        return float(self.motion.end.time)

    def sample(self, times: Array) -> Moments:
        """Return the moments at times within the span."""
        if times.size > _TIMES_AT_ONCE:
            parts = (self.sample(times[k : k + _TIMES_AT_ONCE]) for k in range(0, times.size, _TIMES_AT_ONCE))
            return Moments(*(np.concatenate(column) for column in zip(*parts, strict=True)))
        states, forces = self.motion.sample(times)
        at, struck = self.layout, self.struck
        x, v = states[:, at.positions], states[:, at.speeds]
        pushed = forces[:, at.frame] + self._held(forces)
        momentum = v[:, at.nose] * struck.nose_mass + v[:, at.assembly] * struck.assembly_mass
        columns = (
            forces[:, at.contacts].sum(axis=1),
            pushed / struck.assembly_mass + struck.sensed_gravity,
            x[:, at.nose],
            x[:, at.assembly],
            v[:, at.assembly],
            momentum / struck.mass,
            states[:, at.angle],
            states[:, at.turntable_speed],
            self._indentation(x, forces[:, at.contacts]),
            forces[:, self._side].sum(axis=1),
            states[:, at.rubbed],
        )
        return Moments(*(np.ascontiguousarray(column) for column in columns))  # a view would keep all states in memory

    @property
    def _side(self) -> slice:
        """Places of the side forces: behind those of the links."""
        return slice(self.motion.links - self.layout.contacts.stop, self.motion.links)

    def _indentation(self, x: Array, contact_forces: Array) -> Array:
        """Return the deepest indentation of a striker that pushes, m; one off the face may stand beyond it."""
        nose, strikers = x[:, self.layout.nose], x[:, self.layout.strikers].T
        pushed = [np.where(f > 0.0, place - nose, 0.0) for place, f in zip(strikers, contact_forces.T, strict=True)]
        return functools.reduce(np.maximum, pushed)  # the maximum over a short last axis takes numpy six times as long

    def _held(self, forces: Array) -> Array:
        """Return the force of spring, stop and rail on the assembly, of link forces (N, links)."""
        at = self.layout
        rail = forces[:, at.rail] if at.rubs else 0.0
        return np.asarray(forces[:, at.stop] - forces[:, at.support] - rail)

    def contacts(self) -> Array:
        """Return begin, end, approach speed and striker (from 0) of each contact, shape (N, 4)."""
        rows = []
        for striker, link in enumerate(np.arange(self.motion.links)[self.layout.contacts]):
            touches = contacts(self.motion, link)
            # a contact that only stopped this span belongs to the next one
            touches = touches[touches[:, 0] < self.end]
            rows.append(np.column_stack([touches, np.full(len(touches), striker, dtype=float)]))
        return np.concatenate(rows)

    def switches(self) -> Array:
        """Return which of the machine's own switches changed, and when, shape (N, 2)."""
        time, which = self.motion.switched
        rows = np.column_stack([which - self.layout.own_switches.start, time])
        return rows[rows[:, 0] >= 0]

    def impulses(self, begin: float, end: float) -> Impulses:
        """Return the impulses on the object between two switches or the span's ends."""
        low, high = max(begin, self.begin), min(end, self.end)
        if high <= low:
            return Impulses()
        links = self.motion.impulses(low, high)[None]
        weight = self.struck.mass * self.struck.gravity * (high - low)
        contact, side = (float(links[:, some].sum()) for some in (self.layout.contacts, self._side))
        return Impulses(contact, float(self._held(links)[0]) + weight, side)

    def deepest(self, time: float, striker: int) -> float:
        """Return the depth to which the spot of a striker has yielded by a time, m."""
        row = int(np.searchsorted(self.motion.changes.time, time, side="right")) - 1
        last = time >= self.end or row < 0
        memory = self.motion.end.memory if last else self.motion.changes.memory[row]
        return float(memory[self.layout.depths][striker])

    def parting_speed(self, time: float, striker: int) -> float:
        """Return the speed of the nose less that of a striker, m/s."""
        speeds = self.motion.sample(np.array([time]))[0][0][self.layout.speeds]
        return float(speeds[self.layout.nose] - speeds[striker])


class TapHistories(NamedTuple):
    """Force (N), velocity (m/s), average acceleration about each sample (m/s^2) at the taps, (samples, taps)."""

    force: Array
    velocity: Array
    acceleration: Array


@dataclass(frozen=True)
class StackSpan:
    """One blow on a stack, from first touch until it has settled."""

    struck: StruckObject
    """Object as between blows."""
    begin: float
    """Time of first touch, s."""
    step: float
    """Spacing of the histories, s."""
    striker: int
    """Number of the striker, from 0."""
    history: Array
    """Columns as `_stack_kernels` names them."""
    taps: TapHistories
    """Histories of the taps; velocities and accelerations in the frame below."""
    rigid_acceleration: Array
    """Acceleration of the assembly as in `Moments`, average about each sample, m/s^2."""
    field_position: Array
    """Places of the x-t field from the first face, m; empty where none was kept."""
    field_step: float
    """Spacing of its times, s."""
    field_force: Array
    """Force, N, shape (times, places)."""
    frame: tuple[float, float]
    """Speed of the stack's frame at the beginning, and its acceleration."""
    touches: Array
    """Begin, end, approach speed of each contact."""
    switched: Array
    """Number and time of each switch of the machine."""
    momentum_error: float
    """Impulses less momentum gained by the waves, over the contact impulse."""
    yielded: float
    """Depth to which the spot has yielded by the end, m."""
    rubbed: float
    """Heat of sliding of the blows before, J."""

    @property
    def end(self) -> float:
        """Time of the last sample, s."""
        return self.begin + self.step * (len(self.history) - 1)

    def _at(self, times: Array, which: int) -> Array:
        return self._between(times, self.history[:, which])

    def _between(self, times: Array, values: Array) -> Array:
        return np.interp(times, self.begin + self.step * np.arange(len(values)), values)

    def sample(self, times: Array) -> Moments:
        """Return the moments at times within the span."""
        nose, assembly = self._at(times, column.NOSE_SPEED), self._at(times, column.ASSEMBLY_SPEED)
        struck = self.struck
        return Moments(
            self._at(times, column.CONTACT_FORCE),
            self._between(times, self.rigid_acceleration),
            self._at(times, column.FACE_PLACE),
            self._at(times, column.ASSEMBLY_PLACE),
            assembly,
            (nose * struck.nose_mass + assembly * struck.assembly_mass) / struck.mass,
            self._at(times, column.TURNTABLE_ANGLE),
            self._at(times, column.TURNTABLE_SPEED),
            self._at(times, column.INDENTATION),
            self._at(times, column.SIDE_FORCE),
            self.rubbed + self._at(times, column.FRICTION_HEAT),
        )

    def contacts(self) -> Array:
        """Return begin, end, approach speed and striker (from 0) of each contact, shape (N, 4)."""
        return np.column_stack([self.touches, np.full(len(self.touches), self.striker, dtype=float)])

    def switches(self) -> Array:
        """Return which of the machine's own switches changed, and when, shape (N, 2)."""
        return self.switched

    def impulses(self, begin: float, end: float) -> Impulses:
        """Return the impulses on the object between two times."""
        edges = np.clip([begin, end], self.begin, self.end)
        columns = (column.CONTACT_IMPULSE, column.END_IMPULSE, column.SIDE_IMPULSE)
        entered, through, side = (float(np.diff(self._at(edges, k))[0]) for k in columns)
        weight = self.struck.mass * self.struck.gravity * float(edges[1] - edges[0])
        return Impulses(entered, weight - through, side)

    def deepest(self, time: float, striker: int) -> float:
        """Return the depth to which the spot has yielded after the blow, m."""
        return self.yielded

    def parting_speed(self, time: float, striker: int) -> float:
        """Return the speed of the face less that of the striker, m/s."""
        at = np.array([time])
        return float(self._at(at, column.FACE_SPEED)[0] - self._at(at, column.STRIKER_SPEED)[0])

    def tap(self, k: int) -> tuple[Array, Array, Array]:
        """Return force (N), speed (m/s) and acceleration (m/s^2) at tap k, at the times of the history.

        The acceleration is that of a sensor, as the rigid one of `Moments`.
        """
        since = self.step * np.arange(len(self.history))
        speed, gravity = self.frame
        moving = self.taps.velocity[:, k] + speed + gravity * since
        return self.taps.force[:, k], moving, self.taps.acceleration[:, k] + self.struck.sensed_gravity

    def field(self) -> tuple[Array, Array]:
        """Return times after first touch, s, and force, N, at the places of the x-t field, shape (times, places)."""
        return self.field_step * np.arange(len(self.field_force), dtype=np.float64), self.field_force


Span = ChainSpan | StackSpan


# Chosen: 4e-4 of the energy is left then, and the number of blows stays finite, ln(0.02)/ln(e) of them.
REST_SHARE = 0.02
"""Approach speed over the first below which an object rests."""
# A frame that rings touches again within about one such time; a flight of 20 mm/s, the slowest that is followed after
# a fall of 50 mm, takes 4 ms, twenty times a contact of 200 us.
FLIGHT_SHARE = 5.0
"""Time apart, over that of the blow before, after which a touch begins another blow."""
# Chosen: a frame that rings swings the speeds through zero several times, and the last one counts.
FLIGHT_SAMPLES = 4001
"""Times among which the top of a flight is looked for before it is located."""


@dataclass(frozen=True)
class Rebounds:
    """Rebounds of a launched machine that are followed after its first blow."""

    brake_after: int | None = None
    """Blows after which a brake catches it, at the top of its rebound; without one it is followed until it rests."""


def blow_numbers(contacts: Array) -> NDArray[np.int64]:
    """Return the number, from 0, of the blow that each contact belongs to; rows of begin and end, in order of time."""
    numbers = np.zeros(len(contacts), dtype=np.int64)
    begin = contacts[0, 0] if len(contacts) else 0.0
    for row in range(1, len(contacts)):
        numbers[row] = numbers[row - 1]
        if is_flight(begin, contacts[row - 1, 1], contacts[row, 0]):
            numbers[row] += 1
            begin = contacts[row, 0]
    return numbers


def is_flight(begin: float, released: float, touched: float) -> bool:
    """Return whether a touch begins another blow than the one that began and was released at these times, s."""
    return touched - released > FLIGHT_SHARE * (released - begin)


def end_at_touch(rebounds: Rebounds, contacts: Array, time: float, approach: float) -> str:
    """Return the end of following at a touch, of a time (s) and approach speed (m/s): "rest", "brake", or "" for none.

    ``contacts`` are begin, end (s) and approach speed (m/s) of the contacts before, in order of time.
    """
    if not len(contacts):
        return ""
    numbers = blow_numbers(contacts)
    begin = contacts[numbers == numbers[-1]][0, 0]
    if not is_flight(begin, contacts[-1, 1], time):
        return ""
    if rebounds.brake_after is not None:
        return "brake" if numbers[-1] + 1 >= rebounds.brake_after else ""
    return "rest" if approach < REST_SHARE * contacts[0, 2] else ""


def top_of_flight(span: ChainSpan, released: float) -> float:
    """Return the time at which striker and object are farthest apart in a flight that ends with a span, s."""

    def parting(times: Array) -> Array:
        speeds = span.motion.sample(times)[0][:, span.layout.speeds]
        moving = span.sample(times).object_speed
        return np.asarray(moving - speeds[:, span.layout.strikers][:, 0])

    times = np.linspace(max(released, span.begin), span.end, FLIGHT_SAMPLES)
    rates = parting(times)
    last = int(np.flatnonzero(rates > 0.0)[-1])
    return float(
        scipy.optimize.brentq(lambda t: float(parting(np.array([t]))[0]), times[last], times[last + 1], xtol=1e-12)
    )
