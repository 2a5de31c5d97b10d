"""The few numbers that a run is judged by: of its contacts, its parts and its balances, and the axis of its blow; SI.

Where flat faces meet, contact is a velocity taken within one time step: the force of that step is the impulse over dt,
and grows without bound as dt gets shorter. Forces and rigid-body accelerations are therefore judged by their means over
the intervals of the histories, `mean_force` and `mean_acceleration`, which depend on the interval alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import MAIN, MORE, NO_UNIT, Quantity
from strikewave.base.shock_quantities import ENERGY, MASS, MEASURED_IMPULSE, MICROSECONDS, TOTAL_PEAK
from strikewave.fem.run import FemRun
from strikewave.signal.pulse import WIDTH_FRACTION, crossing

Array = NDArray[np.float64]

ENERGY_LIMIT = 0.01
"""Share of the energy in play that may be missing or too much: runs at the default step keep theirs to 1e-4 and better,
so that 1 % tells a contact or an element that makes energy."""
HOURGLASS_LIMIT = 0.05
"""Share of the largest internal energy that may stand in hourglass modes: the usual limit of explicit codes is 5 to 10
%."""
ALIGNED = math.cos(math.radians(5.0))
"""Cosine of the angle to x, y or z below which a direction is taken as that one: 1 - cos 5 degrees is 0.4 % of a
force."""
TOP = 0.75
"""Share of the peak above which a force is at its top: a half-sine is for 0.46 of its duration, a rectangle for all."""
UNLOADED = 1e-9
"""Internal energy of less than this share of the energy in play is rounding: nothing was touched."""
STILL = 1e-12
"""A part whose velocity changes by less than this share of the largest in play does not move: rounding of its sums."""


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
    """How large an energy was."""

    largest: float = declare.number(ENERGY, "largest in size over the run", column=MAIN)
    last: float = declare.number(ENERGY, "at the end of the run", label="at the end", column=MAIN)

    @classmethod
    def of(cls, history: Array) -> EnergyExtent:
        """Return that of an energy over time."""
        return cls(float(history[np.abs(history).argmax()]), float(history[-1]))


@dataclass(frozen=True)
class BalanceMeasure:
    """How well the energy and momentum balances of a run close.

    Attributes
    ----------
    energy : float
        Largest energy error in size, with its sign: below 0 energy is missing; a share of the energy in play.
    hourglass : float
        Largest hourglass energy over the largest internal energy, with the plastic work of blows before.
    momentum : float
        As `FemRun.momentum_error`.
    """

    energy: float
    hourglass: float
    momentum: float


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
    """Return the mean rate of a quantity over each interval: its change over the time that it took.

    Parameters
    ----------
    gathered : array (instants, ...)
        Such as impulse, N s, or velocity, m/s.
    time : array (instants,)
        s.

    Returns
    -------
    array (instants - 1, ...)
        At the middles of the intervals, `middles`.

    Examples
    --------
    >>> interval_means(np.array([[0.0], [1.0], [1.0]]), np.array([0.0, 0.5, 1.0])).tolist()
    [[2.0], [0.0]]
    """
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
    """Measure a contact or wall by the size of its mean force; None where nothing touched.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> t = np.linspace(0.0, 1e-3, 1001)
    >>> given = 1e3 * 6e-4 / np.pi * (1.0 - np.cos(np.pi * np.clip((t - 2e-4) / 6e-4, 0.0, 1.0)))
    >>> measure = contact_measure(SimpleNamespace(time=t, impulse={"a-b": np.outer(given, [0, 0, 1])}), "a-b")
    >>> round(measure.peak, 2), round(measure.at * 1e6, 1), round(measure.duration * 1e6), round(measure.impulse, 4)
    (1000.0, 499.5, 562, 0.382)
    """
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
    """Return how long the mean force of a contact stays above `TOP` of its peak about it, s, in whole intervals."""
    size = np.linalg.norm(mean_force(run, name), axis=1)
    at = int(np.argmax(size))
    below = np.flatnonzero(~(size > TOP * size[at]))
    begin = int(below[below < at].max(initial=-1)) + 1
    end = int(below[below > at].min(initial=size.size))
    return float(run.time[end] - run.time[begin])


def _ends(values: Array, time: Array, first: int, last: int) -> tuple[float, float]:
    """Return when means reach a tenth of their largest before one interval and after another, s.

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
    """Return the unit vector along a vector that is not 0; within 5 degrees of x, y or z, that one, with its sign.

    Examples
    --------
    >>> near_axis(np.array([0.1, 0.0, -2.0])).tolist(), near_axis(np.array([3.0, 0.0, -4.0])).tolist()
    ([0.0, 0.0, -1.0], [0.6, 0.0, -0.8])
    """
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
