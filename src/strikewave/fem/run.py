"""Results of an explicit run: histories, energy balance, and the few numbers that it is judged by; SI.

Where flat faces meet, contact is a velocity taken within one time step: the force of that step is the impulse over dt,
and grows without bound as dt gets shorter. Forces and rigid-body accelerations are therefore judged by their means over
the intervals of the histories, `mean_force` and `mean_acceleration`, which depend on the interval alone.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import MAIN, MORE, NO_UNIT, Quantity
from strikewave.base.shock_quantities import ENERGY, LENGTH, MASS, MEASURED_IMPULSE, MICROSECONDS, TOTAL_PEAK
from strikewave.fem.contact import Overlap
from strikewave.fem.mesh import TINY
from strikewave.signal.pulse import WIDTH_FRACTION, crossing

Array = NDArray[np.float64]

ENERGIES = ("kinetic", "internal", "plastic", "hourglass", "contact", "viscous", "external")
"""Columns of the energy balance; ``internal`` is elastic energy and plastic work, ``plastic`` the plastic work in
it."""
KEPT = ("kinetic", "internal", "hourglass", "contact", "viscous")
"""Energies whose sum is the energy at the start and the work from outside."""


AT_REST = 1e-8  # a strain of 1e-12 at 5 km/s; coordinates rounded to 1e-16 strain an element of 1/1000 by 1e-13
"""Speed below which bodies are at rest, m/s."""


def energy_at_rest(mass: float) -> float:
    """Return the energy of a mass, kg, at the speed `AT_REST`, J: less is rounding."""
    return 0.5 * mass * AT_REST**2


@dataclass(frozen=True)
class PartHistory:
    """Motion of a part at the instants of the run, each (instants, 3)."""

    mass: float
    """kg."""
    velocity: Array
    """Momentum over mass, m/s."""
    acceleration: Array
    """Rate of momentum over mass, m/s^2, average about each instant: its trapezoidal integral is the velocity's
    change."""
    displacement: Array
    """Mean displacement by mass, m."""


@dataclass(frozen=True)
class PointHistory:
    """Motion of a node, each (instants, 3); acceleration is the average about each instant."""

    node: int
    displacement: Array
    velocity: Array
    acceleration: Array


@dataclass(frozen=True)
class SectionHistory:
    """Means over the elements of a section, by volume: stress (instants, 6: xx yy zz xy yz zx) and motion."""

    elements: int
    stress: Array
    velocity: Array
    acceleration: Array


@dataclass(frozen=True)
class FieldFrame:
    """Fields of the whole model at an instant."""

    time: float
    """s."""
    displacement: Array
    """Displacement of the nodes, m, (nodes, 3)."""
    velocity: Array
    """Velocity of the nodes, m/s, (nodes, 3)."""
    stress: Array
    """Cauchy stress of the elements, Pa, (elements, 6): xx yy zz xy yz zx, tension positive."""
    plastic_strain: Array
    """Equivalent plastic strain of the elements, (elements,)."""


@declare.dataclass
class Rest:
    """Record of how bodies came to rest between the blow before and this one."""

    maxima: int = declare.count(
        "maxima of the kinetic energy at which velocities were set to zero, of all bodies",
        label="kinetic-energy maxima of relaxation",
        column=MORE,
    )
    steps: int = declare.count("steps on the way to rest", label="steps of relaxation", column=MORE)
    kinetic_share: float = declare.number(
        Quantity(NO_UNIT, NO_UNIT, digits=3),
        "kinetic energy that was left, over the energy in play of the blow before",
        label="kinetic energy left (share)",
        column=MORE,
    )
    plastic_energy: float = declare.number(
        ENERGY, "plastic work that the way to rest itself did", label="yield during relaxation", column=MORE
    )
    added_distance: float = declare.number(
        Quantity("m", "um", digits=3),
        "by how much what strikes begins farther away than at first, as it would have stood inside what it strikes",
        label="moved back at the start",
        column=MORE,
    )
    overlap: float = declare.number(LENGTH, "deepest overlap that is let out without a force")
    plastic_before: float = declare.number(ENERGY, "plastic work of everything before this blow")


@dataclass(frozen=True)
class FemRun:
    """Histories of a run; row i of each is at ``time[i]``.

    Attributes
    ----------
    time : array (instants,)
        s, equal steps from 0; where a run stopped early the last may be shorter.
    force : mapping of str to array (instants, 3)
        Contact force on the first surface, N, by name of the contact or wall.
    impulse : mapping of str to array (instants, 3)
        Integral of that force over time, N s.
    energy : mapping of str to array (instants,)
        J, by the words of `ENERGIES`.
    initial_energy : float
        At the start, J.
    parts : mapping of str to PartHistory
        Motion of each part as one body.
    points : mapping of str to PointHistory
        Motion of each point.
    sections : mapping of str to SectionHistory
        Stress and motion of each section.
    momentum : array (instants, 3)
        Momentum of the whole model, kg m/s.
    impulse_given : array (instants, 3)
        Impulse of boundaries, walls and gravity, N s.
    steps : int
        Number of time steps.
    step : float
        Smallest time step, s.
    added_mass : float
        kg, by mass scaling on request.
    seconds : float
        Wall time.
    elements : int
        Number of elements.
    stopped : str
        Reason why the run ended early; empty when it did not.
    frames : tuple of FieldFrame
        Only those asked for; a writer takes them as they come instead where one is given.
    von_mises : mapping of str to array (instants,)
        Largest von Mises stress of the elements of each part that deforms, Pa.
    plastic_strain : mapping of str to array (instants,)
        Largest equivalent plastic strain of the same.
    overlaps : tuple of Overlap
        Overlaps of contacts and walls before the blow.
    groups : mapping of str to PartHistory
        Motion of groups of parts, each as one body.
    pressed : mapping of str to array (instants, surfaces, 2)
        Share of each surface that is pressed, and how many faces that is: both surfaces of a contact, one of a wall.
    blow : int
        Number of this blow of the bodies, from 1.
    rest : Rest or None
        Relaxation of the bodies to rest before this blow; None before the first.
    plastic_work : mapping of str to float
        Plastic work of each part that deforms, in this run, J.
    bodies : tuple of tuple of str
        Parts that ties or common nodes join.
    """

    time: Array
    force: Mapping[str, Array]
    impulse: Mapping[str, Array]
    energy: Mapping[str, Array]
    initial_energy: float
    parts: Mapping[str, PartHistory]
    points: Mapping[str, PointHistory]
    sections: Mapping[str, SectionHistory]
    momentum: Array
    impulse_given: Array
    steps: int
    step: float
    added_mass: float
    seconds: float
    elements: int
    stopped: str = ""
    frames: tuple[FieldFrame, ...] = field(default=())
    von_mises: Mapping[str, Array] = field(default_factory=dict)
    plastic_strain: Mapping[str, Array] = field(default_factory=dict)
    overlaps: tuple[Overlap, ...] = ()
    groups: Mapping[str, PartHistory] = field(default_factory=dict)
    pressed: Mapping[str, Array] = field(default_factory=dict)
    blow: int = 1
    rest: Rest | None = None
    plastic_work: Mapping[str, float] = field(default_factory=dict)
    bodies: tuple[tuple[str, ...], ...] = ()

    @property
    def energy_error(self) -> Array:
        """Energy that is missing (negative) or too much, as a share of the largest energy in play, (instants,)."""
        accounted = sum(self.energy[name] for name in KEPT)
        return np.asarray((accounted - self._given) / self._in_play)

    @property
    def contact_gain(self) -> float:
        """Most energy that contacts and walls made in place of taking it, as a share of the largest energy in play."""
        return max(0.0, float((-self.energy["contact"] / self._in_play).max()))

    @property
    def _given(self) -> Array:
        return np.asarray(self.initial_energy + self.energy["external"])

    @property
    def _in_play(self) -> Array:
        return np.asarray(np.maximum(np.maximum.accumulate(np.abs(self._given)), max(self.rounding_energy, TINY)))

    @property
    def rounding_energy(self) -> float:
        """Energy below which nothing moves, J; see `energy_at_rest`."""
        return energy_at_rest(sum(part.mass for part in self.parts.values()))

    @property
    def energy_in_play(self) -> float:
        """Energy that was there at the start and came from outside, the largest, J."""
        return float(self._in_play[-1])

    @property
    def momentum_error(self) -> float:
        """Largest difference of momentum and what was given, over the largest momentum in play."""
        off = self.momentum - self.momentum[0] - self.impulse_given
        carried = sum((part.mass * np.abs(part.velocity) for part in self.parts.values()), np.zeros_like(off))
        return float(np.abs(off).max() / max(float(carried.max()), TINY))

    @property
    def speed(self) -> float:
        """Element-steps a second."""
        return self.elements * self.steps / self.seconds


ENERGY_LIMIT = 0.01  # runs at the default step keep 1e-4 and better: 1 % shows a contact or element that makes energy
"""Share of the energy in play that may be missing or too much."""
HOURGLASS_LIMIT = 0.05  # the usual limit of explicit codes is 5 to 10 %
"""Share of the largest internal energy that may stand in hourglass modes."""
ALIGNED = math.cos(math.radians(5.0))  # 1 - cos 5 degrees is 0.4 % of a force
"""Cosine of the angle to x, y or z below which a direction is taken as that one."""
TOP = 0.75  # a half-sine is above it for 0.46 of its duration, a rectangle for all
"""Share of the peak above which a force is at its top."""
UNLOADED = 1e-9  # rounding: nothing was touched
"""Share of the energy in play below which internal energy is none."""
STILL = 1e-12  # rounding of its sums
"""Share of the largest velocity in play; a part whose velocity changes by less does not move."""


CONTACT_FORCE = Quantity("N", "kN", digits=5)
MEASURED_WIDTH = Quantity("s", "us", "pulse width at 10 %")
MEASURED_VELOCITY = Quantity("m/s", "m/s")
MEASURED_STRESS = Quantity("Pa", "MPa")
PLASTIC_STRAIN = Quantity(NO_UNIT, NO_UNIT, digits=3)
BODY_MASS = Quantity("kg", "kg")
BALANCE_ERROR = Quantity(NO_UNIT, NO_UNIT, "energy balance error", digits=2)
"""Numbers of measures have significant digits: they go over decades."""


@declare.dataclass
class ContactMeasure:
    """A contact over the whole run."""

    peak: float = declare.number(
        CONTACT_FORCE,
        "largest mean force of an interval of the histories, of whole bodies (before, of the meshed sector)",
        column=MAIN,
        tables="blow",
        headline="contact force",
    )
    at: float = declare.number(MICROSECONDS, "middle of the interval of the peak", key="time", label="at", column=MORE)
    impulse: float = declare.number(
        MEASURED_IMPULSE,
        "size of the impulse over the run, of whole bodies (before, of the meshed sector)",
        column=MAIN,
        tables="blow",
    )
    begin: float = declare.number(
        MICROSECONDS, "when the force first rises above a tenth of its peak", label="begins", column=MORE
    )
    end: float = declare.number(MICROSECONDS, "when it last falls below that")

    @declare.computed(
        declare.number(
            MICROSECONDS,
            "from begin to end, all contacts and gaps between them",
            column=MAIN,
            tables="blow",
            headline="contact duration",
        )
    )
    def duration(self) -> float:
        """From first to last tenth of the peak, all contacts and gaps between them, s."""
        return self.end - self.begin


@declare.dataclass
class EnergyExtent:
    """Extent of an energy over a run."""

    largest: float = declare.number(ENERGY, "largest in size over the run", column=MAIN)
    last: float = declare.number(ENERGY, "at the end of the run", label="at the end", column=MAIN)

    @classmethod
    def of(cls, history: Array) -> EnergyExtent:
        """Return the extent of an energy over time."""
        return cls(float(history[np.abs(history).argmax()]), float(history[-1]))


@dataclass(frozen=True)
class BalanceMeasure:
    """Errors of the energy and momentum balances of a run."""

    energy: float
    """Largest energy error in size, with its sign: below 0 energy is missing; a share of the energy in play."""
    hourglass: float
    """Largest hourglass energy over the largest internal energy, with the plastic work of blows before."""
    momentum: float
    """Momentum error, as `FemRun.momentum_error`."""


@declare.dataclass
class PartMeasure:
    """The blow that a part took, as one rigid body, and the most that its elements bore."""

    mass: float = declare.number(MASS, "its mass", column=MORE, tables="parts")
    direction: tuple[float, float, float] = declare.history(
        NO_UNIT,
        "unit vector along its largest change of velocity, or the axis within 5 degrees of it; the rest is measured "
        "along it",
    )
    rigid_peak: float = declare.number(
        TOTAL_PEAK,
        "largest mean over an interval of the rate of momentum over mass",
        column=MAIN,
        tables="parts blow",
        headline="rigid-body peak of {name}",
    )
    width: float = declare.number(
        MEASURED_WIDTH,
        "width of that pulse at 10 % of its peak; null where the run ends above it",
        column=MAIN,
        tables="parts blow",
        headline="pulse width of {name}",
    )
    velocity_change: float = declare.number(
        MEASURED_VELOCITY, "largest change of momentum over mass", column=MAIN, tables="parts blow"
    )
    von_mises: float = declare.number(
        MEASURED_STRESS,
        "largest von Mises stress of its elements at the instants of the histories; null for a rigid part or a group",
        label="largest von Mises stress",
        default=math.nan,
        column=MAIN,
        tables="elements",
    )
    plastic_strain: float = declare.number(
        PLASTIC_STRAIN,
        "largest plastic strain of its elements; null alike",
        label="largest plastic strain",
        default=math.nan,
        column=MAIN,
        tables="elements",
    )

    @declare.phrase("along", column=MORE, tables="parts")
    def along(self) -> str:
        """Return the components of its direction, or that it does not move."""
        components = np.round(self.direction, 4) + 0.0
        return ", ".join(f"{x:.3g}" for x in components) if any(components) else "does not move"


def interval_means(gathered: Array, time: Array) -> Array:
    """Return the mean rate of a quantity (instants, ...) over each interval: its change over the time that it took."""
    spans = np.diff(time)
    return np.asarray(np.diff(gathered, axis=0) / spans.reshape(-1, *[1] * (gathered.ndim - 1)))


def middles(time: Array) -> Array:
    """Return the middles of the intervals, s, (instants - 1,)."""
    return np.asarray(0.5 * (time[1:] + time[:-1]))


def mean_force(run: FemRun, name: str) -> Array:
    """Return the mean force of a contact or wall over each interval, N, (instants - 1, 3)."""
    return interval_means(run.impulse[name], run.time)


def mean_acceleration(run: FemRun, name: str) -> Array:
    """Return the mean rigid-body acceleration of a part or group over each interval, m/s^2, (instants - 1, 3)."""
    part = run.parts[name] if name in run.parts else run.groups[name]
    return interval_means(part.velocity, run.time)


def contact_measure(run: FemRun, name: str) -> ContactMeasure | None:
    """Measure a contact or wall by the size of its mean force; None where nothing touched."""
    size = np.linalg.norm(mean_force(run, name), axis=1)
    peak = float(size.max(initial=0.0))
    if not peak > 0.0:
        return None
    above = np.flatnonzero(size > WIDTH_FRACTION * peak)
    begin, end = _ends(size, run.time, int(above[0]), int(above[-1]))
    return ContactMeasure(
        peak=peak,
        at=float(middles(run.time)[int(np.argmax(size))]),
        impulse=float(np.linalg.norm(run.impulse[name][-1])),
        begin=begin,
        end=float(run.time[-1]) if math.isnan(end) else end,
    )


def top_duration(run: FemRun, name: str) -> float:
    """Return the time that the mean force of a contact stays above `TOP` of its peak, s, in whole intervals."""
    size = np.linalg.norm(mean_force(run, name), axis=1)
    at = int(np.argmax(size))
    below = np.flatnonzero(~(size > TOP * size[at]))
    begin = int(below[below < at].max(initial=-1)) + 1
    end = int(below[below > at].min(initial=size.size))
    return float(run.time[end] - run.time[begin])


def _ends(values: Array, time: Array, first: int, last: int) -> tuple[float, float]:
    """Return the times at which means reach a tenth of their largest, before one interval and after another, s.

    What is above from the start begins with it; NaN where the end is not reached.
    """
    level, count = WIDTH_FRACTION * float(values.max()), np.arange(values.size)
    begin, end = crossing(values, first, level, -1), crossing(values, last, level, 1)
    start, over = (float(t) for t in np.interp([begin, end], count, middles(time)))
    return float(time[0]) if math.isnan(begin) else start, over


def part_measure(run: FemRun, name: str) -> PartMeasure:
    """Measure the blow that a part or group took, zeros where its velocity does not change, and what a part bore."""
    part = run.parts[name] if name in run.parts else run.groups[name]
    bore = [float(most[name].max()) if name in most else math.nan for most in (run.von_mises, run.plastic_strain)]
    change = part.velocity - part.velocity[0]
    size = np.linalg.norm(change, axis=1)
    scale = max((float(np.abs(other.velocity).max()) for other in run.parts.values()), default=0.0)
    if not float(size.max()) > STILL * scale:
        return PartMeasure(part.mass, (0.0, 0.0, 0.0), 0.0, math.nan, 0.0, *bore)
    way = near_axis(change[int(np.argmax(size))])
    x, y, z = (float(component) for component in way)
    along = mean_acceleration(run, name) @ way
    at = int(np.argmax(along))
    begin, end = _ends(along, run.time, at, at)
    return PartMeasure(part.mass, (x, y, z), float(along[at]), end - begin, float((change @ way).max()), *bore)


def balance_measure(run: FemRun) -> BalanceMeasure:
    """Measure the energy error, the hourglass energy and the momentum error of a run."""
    error = run.energy_error
    before = run.rest.plastic_before if run.rest else 0.0
    internal = max(float(np.max(run.energy["internal"])) + before, UNLOADED * run.energy_in_play, run.rounding_energy)
    glass = float(np.max(np.abs(run.energy["hourglass"])))
    share = glass / internal if internal > 0.0 else (0.0 if glass == 0.0 else np.inf)
    return BalanceMeasure(float(error[int(np.argmax(np.abs(error)))]), share, run.momentum_error)


def near_axis(vector: Array) -> Array:
    """Return the unit vector along a vector that is not 0; within 5 degrees of x, y or z, that one, with its sign."""
    way = vector / np.linalg.norm(vector)
    largest = int(np.argmax(np.abs(way)))
    if abs(way[largest]) > ALIGNED:
        way = np.eye(3)[largest] * np.sign(way[largest])
    return np.asarray(way + 0.0)


def blow_axis(run: FemRun) -> Array:
    """Return the axis along which a run is shown: that of the greatest change of momentum of a part, by `near_axis`.

    Its largest component is positive. Where nothing changes, it is z.
    """
    changes = [part.mass * (part.velocity - part.velocity[0]) for part in run.parts.values()]
    peaks = [change[int(np.argmax(np.linalg.norm(change, axis=1)))] for change in changes]
    best = max(peaks, key=lambda change: float(np.linalg.norm(change)), default=np.zeros(3))
    if not float(np.linalg.norm(best)) > 0.0:
        return np.array([0.0, 0.0, 1.0])
    axis = near_axis(best)
    return np.asarray(axis * np.sign(axis[int(np.argmax(np.abs(axis)))]) + 0.0)


PRESSES = 0.01  # the last 1 % of a pulse gives no speed
"""Share of the peak above which a contact still presses at the end of a run."""


@dataclass(frozen=True)
class BlowMeasure:
    """A blow among several."""

    blow: int
    """Number of the blow, from 1."""
    restitution: Mapping[str, float | None]
    """Coefficient by contact or wall; see `restitution`."""
    plastic_strain: Mapping[str, float]
    """Largest at the end, of each part that deforms: of all blows so far."""
    plastic_energy: Mapping[str, float]
    """Plastic work of this blow in each part that deforms, J."""
    rest: Rest | None
    """Record of how the bodies came to rest before it."""


def blow_measure(run: FemRun, touching: Mapping[str, Sequence[str]]) -> BlowMeasure:
    """Measure a blow; ``touching`` are the sides of each contact and wall, `Model.touching`."""
    return BlowMeasure(
        blow=run.blow,
        restitution={name: restitution(run, name, sides) for name, sides in touching.items()},
        plastic_strain={name: float(values[-1]) for name, values in run.plastic_strain.items()},
        plastic_energy=dict(run.plastic_work),
        rest=run.rest,
    )


def restitution(run: FemRun, name: str, sides: Sequence[str]) -> float | None:
    """Return the speed of separation over that of approach of the two bodies of a contact, from their momenta.

    A body is all that ties or common nodes join, so that its vibration counts for nothing. Both speeds are along the
    impulse of the contact, the first at the end and the second at the start of the run; a wall rests. None where
    nothing touched, the bodies did not approach each other at the start, or still press at the end.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> down, up = np.array([0.0, 0.0, -2.0]), np.array([0.0, 0.0, 1.5])
    >>> ball = SimpleNamespace(mass=1.0, velocity=np.array([down, 0.0 * down, up, up]))
    >>> impulse = np.array([[0.0, 0.0, x] for x in (0.0, 2.0, 3.5, 3.5)])
    >>> run = SimpleNamespace(time=np.arange(4.0), impulse={"a": impulse}, parts={"ball": ball}, bodies=())
    >>> restitution(run, "a", ("ball.round",))
    0.75
    """
    if contact_measure(run, name) is None or still_presses(run, name):
        return None
    impulse = run.impulse[name][-1]
    normal = impulse / max(float(np.linalg.norm(impulse)), TINY)
    speeds = [_velocity(run, side.rpartition(".")[0] or side) for side in sides]
    relative = speeds[0] - (speeds[1] if len(speeds) > 1 else 0.0)
    approach, separation = -float(relative[0] @ normal), float(relative[-1] @ normal)
    return separation / approach if approach > 0.0 else None


def _velocity(run: FemRun, part: str) -> Array:
    """Return momentum over mass (instants, 3) of the body that a part belongs to, m/s."""
    names = next((body for body in run.bodies if part in body), (part,))
    momentum = sum((run.parts[name].mass * run.parts[name].velocity for name in names), np.zeros(3))
    return np.asarray(momentum / sum(run.parts[name].mass for name in names))


def pressing_at_end(run: FemRun, name: str) -> float:
    """Return the mean force of a contact over the last interval of a run, N."""
    last = (run.impulse[name][-1] - run.impulse[name][-2]) / (run.time[-1] - run.time[-2])
    return float(np.linalg.norm(last))


def still_presses(run: FemRun, name: str) -> bool:
    """Return whether a contact presses at the end of a run, by the mean force of the last interval."""
    measure = contact_measure(run, name)
    return measure is not None and pressing_at_end(run, name) > PRESSES * measure.peak
