"""A run of a machine in spans: followed as bodies between blows, as a stack of layers in a blow.

Both kinds of span answer the same questions: what moved how at given times, which contacts and switches
there were, and which impulses.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.contact._chain_kernels import SWITCHES
from strikewave.contact.chain import contacts
from strikewave.contact.motion import Motion
from strikewave.machines import _stack_kernels as column
from strikewave.machines._kernels import FACE_SWITCH, ON_FACE, OWN_STATES
from strikewave.machines.struck_object import StruckObject
from strikewave.waves._kernels import Recording

Array = NDArray[np.float64]


class Moments(NamedTuple):
    """What the machine does at given times, SI, one value a time."""

    contact_force: Array
    rigid_acceleration: Array
    face_place: Array
    assembly_place: Array
    assembly_speed: Array
    object_speed: Array
    turntable_angle: Array
    turntable_speed: Array
    indentation: Array


@dataclass(frozen=True)
class Places:
    """Indices into the state and the links for a number of strikers, on rails that rub or not."""

    strikers: int
    rubs: bool = False

    @property
    def bodies(self) -> int:
        """Number of bodies."""
        return self.strikers + 2

    @property
    def nose(self) -> int:
        """Body index of the nose."""
        return self.strikers

    @property
    def assembly(self) -> int:
        """Body index of the assembly."""
        return self.strikers + 1

    @property
    def angle(self) -> int:
        """State index of the turntable's angle; its speed, the belt's twist and the motor's speed follow."""
        return 2 * self.bodies

    @property
    def energies(self) -> int:
        """State index of the energy dissipated in the first link; drive, drag and feed follow the last."""
        return self.angle + OWN_STATES

    @property
    def contacts(self) -> slice:
        """Links between strikers and nose."""
        return slice(0, self.strikers)

    @property
    def mounts(self) -> slice:
        """Links between seats and strikers."""
        return slice(self.strikers, 2 * self.strikers)

    @property
    def frame(self) -> int:
        """Link of the frame."""
        return 2 * self.strikers

    @property
    def support(self) -> int:
        """Link of the heavy-load spring."""
        return 2 * self.strikers + 1

    @property
    def stop(self) -> int:
        """Link of the stop."""
        return 2 * self.strikers + 2

    @property
    def rail(self) -> int:
        """Link of the rail's friction, where there is any."""
        return 2 * self.strikers + 3

    @property
    def links(self) -> int:
        """Number of links."""
        return 2 * self.strikers + 3 + self.rubs

    @property
    def own_memory(self) -> slice:
        """What the machine itself remembers, after the approach speeds of the links."""
        return slice(self.links, self.links + 2)

    @property
    def depths(self) -> slice:
        """How deep each link has yielded."""
        return slice(self.links + 2, 2 * self.links + 2)

    @property
    def growths(self) -> slice:
        """How much the radius of each link has grown by yielding, at the end of the memory."""
        return slice(2 * self.links + 2, 3 * self.links + 2)

    @property
    def own_switches(self) -> int:
        """Place of the machine's own switch functions, after those of the links."""
        return SWITCHES * self.links

    @property
    def own_modes(self) -> slice:
        """The machine's own modes, after those of the links."""
        return slice(self.links, self.links + ON_FACE + self.strikers)

    @property
    def switches(self) -> int:
        """Number of switch functions."""
        return self.own_switches + FACE_SWITCH + self.strikers


@dataclass(frozen=True)
class ChainSpan:
    """A span in which the object is nose, frame and assembly."""

    struck: StruckObject
    place: Places
    motion: Motion

    @property
    def begin(self) -> float:
        """First time, s."""
        return float(self.motion.record.time[0])

    @property
    def end(self) -> float:
        """Last time, s."""
        return float(self.motion.end.time)

    def sample(self, times: Array) -> Moments:
        """Return what the machine does at times within the span."""
        states, forces = self.motion.sample(times)
        place, struck = self.place, self.struck
        v = states[:, place.bodies : place.angle]
        pushed = forces[:, place.frame] + self._held(forces)
        momentum = v[:, place.nose] * struck.nose_mass + v[:, place.assembly] * struck.assembly_mass
        return Moments(
            forces[:, place.contacts].sum(axis=1),
            pushed / struck.assembly_mass + struck.gravity,
            states[:, place.nose],
            states[:, place.assembly],
            v[:, place.assembly],
            momentum / struck.mass,
            states[:, place.angle],
            states[:, place.angle + 1],
            self._indentation(states, forces[:, place.contacts]),
        )

    def _indentation(self, states: Array, contact_forces: Array) -> Array:
        """Return the deepest indentation of a striker that pushes, m; one off the face may stand beyond it."""
        deep = states[:, : self.place.strikers] - states[:, [self.place.nose]]
        return np.asarray(np.where(contact_forces > 0.0, deep, 0.0).max(axis=1))

    def _held(self, forces: Array) -> Array:
        """Return the force of spring, stop and rail on the assembly, of link forces (N, links)."""
        place = self.place
        rail = forces[:, place.rail] if place.rubs else 0.0
        return np.asarray(forces[:, place.stop] - forces[:, place.support] - rail)

    def contacts(self) -> Array:
        """Return begin, end, approach speed and striker (from 0) of each contact, shape (N, 4)."""
        rows = []
        for striker in range(self.place.strikers):
            found = contacts(self.motion, striker)
            # a contact that only stopped this span belongs to the next one
            found = found[found[:, 0] < self.end]
            rows.append(np.column_stack([found, np.full(len(found), striker, dtype=float)]))
        return np.concatenate(rows)

    def switches(self) -> Array:
        """Return which of the machine's own switches changed, and when, shape (N, 2)."""
        record = self.motion.record
        rows = np.column_stack([record.event[:, 0] - self.place.own_switches, record.event_time])
        return rows[rows[:, 0] >= 0]

    @cached_property
    def _per_step(self) -> Array:
        return self.motion.impulses()

    def impulses(self, begin: float, end: float) -> tuple[float, float]:
        """Return the impulses of contacts and supports between two switches or the span's ends, N s."""
        record, place = self.motion.record, self.place
        low, high = max(begin, self.begin), min(end, self.end)
        if high <= low:
            return 0.0, 0.0
        within = (record.time >= low - 1e-15) & (record.time + record.step <= high + 1e-15)
        links = self._per_step[within].sum(axis=0, keepdims=True)
        weight = self.struck.mass * self.struck.gravity * (high - low)
        return float(links[:, place.contacts].sum()), float(self._held(links)[0]) + weight

    def deepest(self, time: float, striker: int) -> float:
        """Return the depth to which the spot of a striker has yielded by a time, m."""
        row = int(np.searchsorted(self.motion.record.time, time, side="right")) - 1
        last = time >= self.end or row < 0
        memory = self.motion.end.memory if last else self.motion.record.memory[row]
        return float(memory[self.place.depths][striker])

    def parting_speed(self, time: float, striker: int) -> float:
        """Return how much faster the nose is than a striker, m/s."""
        state = self.motion.sample(np.array([time]))[0][0]
        return float(state[self.place.bodies + self.place.nose] - state[self.place.bodies + striker])


@dataclass(frozen=True)
class StackSpan:
    """One blow on a stack, from first touch until it has settled.

    Attributes
    ----------
    struck : StruckObject
        The object as between blows.
    begin, step : float
        Time of first touch, spacing of the histories, s.
    striker : int
        Who struck.
    history : ndarray
        Columns as `_stack_kernels` names them.
    taps : Recording
        Force and velocity at the taps; velocities in the frame below.
    field_position : ndarray
        Places of the x-t field from the first face, m; empty where none was kept.
    field_step, field_force : float and ndarray
        Spacing of its times, s, and force, N, shape (times, places).
    frame : (float, float)
        Speed of the stack's frame at the beginning, and its acceleration.
    grid_step : float
        Time step of the waves, s.
    touches, switched : ndarray
        Begin, end, approach speed of each contact; which of the machine's switches, and when.
    momentum_error : float
        Impulses less momentum gained by the waves, over the contact impulse.
    yielded : float
        Depth to which the spot has yielded by the end, m.
    """

    struck: StruckObject
    begin: float
    step: float
    striker: int
    history: Array
    taps: Recording
    field_position: Array
    field_step: float
    field_force: Array
    frame: tuple[float, float]
    grid_step: float
    touches: Array
    switched: Array
    momentum_error: float
    yielded: float

    @property
    def end(self) -> float:
        """Time of the last sample, s."""
        return self.begin + self.step * (len(self.history) - 1)

    def _at(self, times: Array, which: int) -> Array:
        grid = self.begin + self.step * np.arange(len(self.history))
        return np.interp(times, grid, self.history[:, which])

    def sample(self, times: Array) -> Moments:
        """Return what the machine does at times within the span."""
        nose, assembly = self._at(times, column.NOSE_SPEED), self._at(times, column.ASSEMBLY_SPEED)
        struck = self.struck
        return Moments(
            self._at(times, column.CONTACT_FORCE),
            self._at(times, column.RIGID_ACCELERATION),
            self._at(times, column.FACE_PLACE),
            self._at(times, column.ASSEMBLY_PLACE),
            assembly,
            (nose * struck.nose_mass + assembly * struck.assembly_mass) / struck.mass,
            self._at(times, column.TURNTABLE_ANGLE),
            self._at(times, column.TURNTABLE_SPEED),
            self._at(times, column.INDENTATION),
        )

    def contacts(self) -> Array:
        """Return begin, end, approach speed and striker (from 0) of each contact, shape (N, 4)."""
        return np.column_stack([self.touches, np.full(len(self.touches), self.striker, dtype=float)])

    def switches(self) -> Array:
        """Return which of the machine's own switches changed, and when, shape (N, 2)."""
        return self.switched

    def impulses(self, begin: float, end: float) -> tuple[float, float]:
        """Return the impulses of contacts and supports between two times, N s."""
        edges = np.clip([begin, end], self.begin, self.end)
        entered, through = (np.diff(self._at(edges, k))[0] for k in (column.CONTACT_IMPULSE, column.END_IMPULSE))
        weight = self.struck.mass * self.struck.gravity * (edges[1] - edges[0])
        return float(entered), float(weight - through)

    def deepest(self, time: float, striker: int) -> float:
        """Return the depth to which the spot has yielded after the blow, m."""
        return self.yielded

    def parting_speed(self, time: float, striker: int) -> float:
        """Return how much faster the face is than the striker, m/s."""
        at = np.array([time])
        return float(self._at(at, column.FACE_SPEED)[0] - self._at(at, column.STRIKER_SPEED)[0])

    def tap(self, k: int) -> tuple[Array, Array, Array]:
        """Return force (N), speed (m/s) and acceleration (m/s^2) at tap k, at the times of the history."""
        since = self.step * np.arange(len(self.history))
        speed, gravity = self.frame
        velocity = self.taps.velocity[:, k]
        acceleration = (velocity[:, 2] - velocity[:, 0]) / (2.0 * self.grid_step) + gravity
        return self.taps.force[:, k], velocity[:, 1] + speed + gravity * since, acceleration

    def field(self) -> tuple[Array, Array]:
        """Return times after first touch, s, and force, N, at the places of the x-t field, shape (times, places)."""
        return self.field_step * np.arange(len(self.field_force), dtype=np.float64), self.field_force


Span = ChainSpan | StackSpan
