"""Input of an explicit run: mesh, solids, boundaries, contacts and controls; SI.

A side is named ``part.side``, as in `Mesh.side`; ``part.all`` are all exterior faces of a part.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from strikewave.base.errors import InputError
from strikewave.fem.mesh import Mesh
from strikewave.fem.sections import ROUNDING
from strikewave.fem.solids import AnySolid

Vector = tuple[float, float, float]
"""Components along x, y and z."""
STIFFNESS = 0.8  # 1 is a kinematic constraint; 0.8 leaves a margin to where contact overshoots
"""Share s of the stiffness that closes a gap within one step; see `strikewave.fem.contact`."""
SAFETY = 0.9  # as is usual: the bound holds for linear elements, 10 % is left for what a step deforms
"""Share of the critical step that a run takes."""
HOURGLASS = 0.05  # usual in the stiffness form; 0.17 would bend steel cubes exactly, and hold plastic flow up
"""Coefficient of the hourglass stiffness."""
LINEAR_VISCOSITY, QUADRATIC_VISCOSITY = 0.06, 1.5  # a jump is spread over a few elements
"""Coefficients of the bulk viscosity, the usual ones of explicit codes."""
INTERVAL = 1e-6  # a hundred instants for a pulse of 100 us
"""Step of the histories, s."""


@dataclass(frozen=True)
class TimeCurve:
    """A quantity over time, straight between its points, constant before the first and after the last."""

    time: tuple[float, ...]
    """Instants, s, ascending."""
    value: tuple[float, ...]
    """Values there, SI."""


@dataclass(frozen=True)
class Fixed:
    """Nodes of a side do not move."""

    side: str


@dataclass(frozen=True)
class Symmetry:
    """Nodes of a flat side move only within its plane."""

    side: str


@dataclass(frozen=True)
class Guided:
    """Nodes of a side, or of a whole part named alone, move only along an axis."""

    side: str
    axis: Vector


@dataclass(frozen=True)
class Driven:
    """Nodes of a side move along a direction with a given velocity, m/s; they stay free across it."""

    side: str
    direction: Vector
    velocity: TimeCurve


@dataclass(frozen=True)
class Pressure:
    """A pressure on a side as it is deformed, Pa; positive pushes inward."""

    side: str
    pressure: TimeCurve


@dataclass(frozen=True)
class NonReflecting:
    """A side that lets waves out: dashpots rho c_p A normal to it and rho c_s A along it (Lysmer & Kuhlemeyer 1969)."""

    side: str


AnyBoundary = Fixed | Symmetry | Guided | Driven | Pressure | NonReflecting


@dataclass(frozen=True)
class SurfaceContact:
    """Two surfaces that may touch, both checked against each other."""

    first: str
    """One side."""
    second: str
    """The other side."""
    friction: float = 0.0
    """Coulomb's coefficient."""
    stiffness: float = STIFFNESS
    """Share s of the stiffness m*/dt^2 that closes a gap within one step; see `strikewave.fem.contact`."""

    @property
    def name(self) -> str:
        """Name of the contact, ``first-second``."""
        return f"{self.first}-{self.second}"


@dataclass(frozen=True)
class Tie:
    """Nodes of a side that stay where they are on another, whose mesh need not match."""

    side: str
    onto: str


@dataclass(frozen=True)
class RigidWall:
    """A rigid plane that does not move; the nodes of a side stay on the side its normal points to."""

    side: str
    point: Vector
    normal: Vector
    friction: float = 0.0

    @property
    def name(self) -> str:
        """Name of the wall, ``side-wall``."""
        return f"{self.side}-wall"


@dataclass(frozen=True)
class Rigid:
    """A part that does not deform: its freedoms of translation and of rotation about its centre of mass, by axis."""

    part: str
    translations: tuple[bool, bool, bool] = (True, True, True)
    rotations: tuple[bool, bool, bool] = (True, True, True)


@dataclass(frozen=True)
class CutSection:
    """Elements of a part that a plane cuts before the blow: their mean stress, velocity and acceleration."""

    name: str
    part: str
    point: Vector
    normal: Vector


@dataclass(frozen=True)
class Point:
    """The node of a part that lies nearest to a place before the blow."""

    name: str
    part: str
    place: Vector


@dataclass(frozen=True)
class Controls:
    """Controls of a run."""

    duration: float
    """Length of the run, s; it ends with the first step that is not before it."""
    interval: float = INTERVAL
    """Step of the histories, s."""
    safety: float = SAFETY
    """Share of the critical time step."""
    hourglass: float = HOURGLASS
    """Coefficient of the hourglass stiffness; see `strikewave.fem.hexahedron`."""
    linear_viscosity: float = LINEAR_VISCOSITY
    """Linear coefficient of the bulk viscosity."""
    quadratic_viscosity: float = QUADRATIC_VISCOSITY
    """Quadratic coefficient of the bulk viscosity."""
    full: tuple[str, ...] = ()
    """Parts with selectively reduced full integration instead of one point."""
    least_step: float = 0.0
    """Step that elements get by added mass, s; 0 adds none."""
    threads: int = 1
    """Threads of the run; the numbers do not depend on it."""
    blows: int = 1
    """Blows one after another, each of the duration, on the state that the one before left."""

    @property
    def intervals(self) -> int:
        """Steps of the histories."""
        return max(1, math.ceil(self.duration / self.interval - ROUNDING))


@dataclass(frozen=True)
class Model:
    """Input of `strikewave.fem.solve.solve`."""

    mesh: Mesh
    """Mesh of all parts."""
    solids: Mapping[str, AnySolid]
    """Solid of each part."""
    controls: Controls
    """Controls of the run."""
    velocity: Mapping[str, Vector] = field(default_factory=dict)
    """Initial velocity by part, m/s; parts that are not named rest."""
    gravity: Vector = (0.0, 0.0, 0.0)
    """Acceleration of gravity, m/s^2."""
    boundaries: tuple[AnyBoundary, ...] = ()
    contacts: tuple[SurfaceContact, ...] = ()
    ties: tuple[Tie, ...] = ()
    walls: tuple[RigidWall, ...] = ()
    rigid: tuple[Rigid, ...] = ()
    sections: tuple[CutSection, ...] = ()
    points: tuple[Point, ...] = ()
    groups: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Parts whose motion is also recorded as that of one body."""

    @property
    def touching(self) -> dict[str, tuple[str, ...]]:
        """Sides of each contact and wall, by its name."""
        pairs: dict[str, tuple[str, ...]] = {each.name: (each.first, each.second) for each in self.contacts}
        return pairs | {each.name: (each.side,) for each in self.walls}


def stays(model: Model, sides: Sequence[str]) -> bool:
    """Return whether two sides begin with the same velocity, or one, before a wall, with none."""
    still = (0.0, 0.0, 0.0)
    speeds = {tuple(model.velocity.get(side.rpartition(".")[0] or side, still)) for side in sides}
    return len(speeds | ({still} if len(sides) == 1 else set())) == 1


MOST_BLOWS = 20  # yield has come to an end after a few, and each takes its own files and up to 4.5 times its steps
"""Most blows of a run."""
MOST_HOURGLASS = 0.5  # three times the 0.17 at which a cube bends exactly
"""Largest coefficient of the hourglass stiffness."""


def faults(model: Model) -> Iterator[InputError]:
    """Yield what cannot be run."""
    yield from control_faults(model.controls)
    yield from _parts(model)
    yield from _repeated(model)
    yield from _vectors(model)
    for boundary in model.boundaries:
        if isinstance(boundary, Driven):
            yield from _curve(f"velocity of {boundary.side}", boundary.velocity)
        elif isinstance(boundary, Pressure):
            yield from _curve(f"pressure on {boundary.side}", boundary.pressure)


def control_faults(c: Controls) -> Iterator[InputError]:
    """Yield what is wrong with the controls alone."""
    rows = [
        ("duration", 0.0 < c.duration < np.inf, "above 0"),
        ("interval", 0.0 < c.interval <= c.duration, "above 0, at most the duration"),
        ("safety", 0.0 < c.safety <= 1.0, "above 0 to 1"),
        ("hourglass", 0.0 <= c.hourglass <= MOST_HOURGLASS, f"from 0 to {MOST_HOURGLASS:g}"),
        ("linear_viscosity", 0.0 <= c.linear_viscosity < np.inf, "at least 0"),
        ("quadratic_viscosity", 0.0 <= c.quadratic_viscosity < np.inf, "at least 0"),
        ("least_step", 0.0 <= c.least_step < np.inf, "at least 0"),
        ("threads", c.threads >= 1, "at least 1"),
        ("blows", 1 <= c.blows <= MOST_BLOWS, f"a whole number from 1 to {MOST_BLOWS}"),
    ]
    yield from (InputError(name, getattr(c, name), allowed) for name, good, allowed in rows if not good)


def _parts(model: Model) -> Iterator[InputError]:
    parts = model.mesh.names
    for name in parts:
        if name not in model.solids:
            yield InputError(f"part {name}", "no solid", "a solid for each part")
    named: list[tuple[str, Iterable[str]]] = [
        ("velocity", model.velocity),
        ("full", model.controls.full),
        ("rigid", (each.part for each in model.rigid)),
        *((f"point {each.name}", (each.part,)) for each in model.points),
        *((f"section {each.name}", (each.part,)) for each in model.sections),
        *((f"group {name}", group) for name, group in model.groups.items()),
    ]
    for key, names in named:
        for name in names:
            if name not in parts:
                yield InputError(key, name, "a part of the mesh: " + ", ".join(parts))


def _repeated(model: Model) -> Iterator[InputError]:
    """Yield names that stand for two things: a run would keep only one of them."""
    named = [
        ("contact", [each.name for each in model.contacts], ""),
        ("wall", [each.name for each in model.walls], "stand the second wall before another side, such as part.all"),
        ("rigid", [each.part for each in model.rigid], ""),
        ("point", [each.name for each in model.points], ""),
        ("section", [each.name for each in model.sections], ""),
    ]
    for key, names, hint in named:
        for name in sorted({name for name in names if names.count(name) > 1}):
            yield InputError(key, f"{name} twice", "each only once", hint)


def _vectors(model: Model) -> Iterator[InputError]:
    rows = [
        ("gravity", model.gravity),
        *((f"velocity of {name}", vector) for name, vector in model.velocity.items()),
        *((f"{what} of {w.name}", getattr(w, what)) for w in model.walls for what in ("point", "normal")),
        *((f"{what} of section {s.name}", getattr(s, what)) for s in model.sections for what in ("point", "normal")),
        *((f"place of point {p.name}", p.place) for p in model.points),
        *((f"direction of {b.side}", b.direction) for b in model.boundaries if isinstance(b, Driven)),
        *((f"axis of {b.side}", b.axis) for b in model.boundaries if isinstance(b, Guided)),
    ]
    for key, vector in rows:
        if len(vector) != 3 or not np.all(np.isfinite(vector)):
            yield InputError(key, vector, "three finite numbers")


def _curve(field: str, curve: TimeCurve) -> Iterator[InputError]:
    if not curve.time or len(curve.time) != len(curve.value):
        yield InputError(field, f"{len(curve.time)} times, {len(curve.value)} values", "as many of both, at least one")
    elif not np.all(np.isfinite([curve.time, curve.value])):
        yield InputError(field, "a number that is not finite", "finite times and values")
    for before, after in itertools.pairwise(curve.time):
        if before >= after:
            yield InputError(field, f"{after:g} s after {before:g} s", "times that ascend")
            return
