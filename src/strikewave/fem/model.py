"""What an explicit run needs: a mesh, a solid for each part, what holds and loads it, what touches; SI.

A side is named ``part.side``, as in `Mesh.side`; ``part.all`` are all exterior faces of a part.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from strikewave.fem.grading import ROUNDING
from strikewave.fem.mesh import Mesh
from strikewave.fem.solids import AnySolid

Vector = tuple[float, float, float]
"""Components along x, y and z."""
STIFFNESS = 0.8
"""Share s of the stiffness that closes a gap within one step: 1 is a kinematic constraint; 0.8 leaves a margin to where
contact overshoots, see `strikewave.fem.contact`."""
SAFETY = 0.9
"""Share of the critical step. The bound is safe for linear elements; 10 % is left for what a step deforms, as is
usual."""
HOURGLASS = 0.05
"""Coefficient of the hourglass stiffness: the usual one of the stiffness form; 0.17 would bend steel cubes exactly, and
hold plastic flow up."""
LINEAR_VISCOSITY, QUADRATIC_VISCOSITY = 0.06, 1.5
"""Coefficients of the bulk viscosity, the usual ones of explicit codes: a jump is spread over a few elements."""
INTERVAL = 1e-6
"""Step of the histories, s: a hundred for a pulse of 100 us."""


@dataclass(frozen=True)
class TimeCurve:
    """A quantity over time, straight between its points, constant before the first and after the last.

    Parameters
    ----------
    time, value : tuple of float
        s and SI; times ascend.
    """

    time: tuple[float, ...]
    value: tuple[float, ...]


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
    """Nodes of a side, or of a whole part named alone, move only along an axis: a single translation freedom."""

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
    """Two surfaces that may touch, both checked against each other.

    Parameters
    ----------
    first, second : str
        Sides.
    friction : float
        Coulomb's coefficient.
    stiffness : float
        Share s of the stiffness m*/dt^2 that closes a gap within one step; see `strikewave.fem.contact`.
    """

    first: str
    second: str
    friction: float = 0.0
    stiffness: float = STIFFNESS

    @property
    def name(self) -> str:
        """``first-second``."""
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
        """``side-wall``."""
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
    """How a model is run.

    Parameters
    ----------
    duration, interval : float
        s: length of the run, and of the step of its histories; the run ends with the first step that is not before
        the duration.
    safety : float
        Share of the critical time step.
    hourglass : float
        Coefficient of the hourglass stiffness; see `strikewave.fem.hexahedron`.
    linear_viscosity, quadratic_viscosity : float
        Coefficients of the bulk viscosity.
    full : tuple of str
        Parts with selectively reduced full integration instead of one point.
    least_step : float
        s: mass is added to elements that would need a smaller step; 0 adds none.
    threads : int
        Threads; the numbers do not depend on it.
    blows : int
        Blows one after another, each of the duration, on what the one before left; see `strikewave.fem.repeated_blows`.
    """

    duration: float
    interval: float = INTERVAL
    safety: float = SAFETY
    hourglass: float = HOURGLASS
    linear_viscosity: float = LINEAR_VISCOSITY
    quadratic_viscosity: float = QUADRATIC_VISCOSITY
    full: tuple[str, ...] = ()
    least_step: float = 0.0
    threads: int = 1
    blows: int = 1

    @property
    def intervals(self) -> int:
        """Steps of the histories."""
        return max(1, math.ceil(self.duration / self.interval - ROUNDING))


@dataclass(frozen=True)
class Model:
    """Everything that `strikewave.fem.solve.solve` needs.

    Attributes
    ----------
    mesh : Mesh
    solids : mapping of str to solid
        By part.
    controls : Controls
    velocity : mapping of str to vector
        Initial velocity by part, m/s; parts that are not named rest.
    gravity : vector
        m/s^2.
    boundaries, contacts, ties, walls, rigid, sections, points : tuple
    groups : mapping of str to tuple of str
        Parts whose motion is also recorded as that of one body.
    """

    mesh: Mesh
    solids: Mapping[str, AnySolid]
    controls: Controls
    velocity: Mapping[str, Vector] = field(default_factory=dict)
    gravity: Vector = (0.0, 0.0, 0.0)
    boundaries: tuple[AnyBoundary, ...] = ()
    contacts: tuple[SurfaceContact, ...] = ()
    ties: tuple[Tie, ...] = ()
    walls: tuple[RigidWall, ...] = ()
    rigid: tuple[Rigid, ...] = ()
    sections: tuple[CutSection, ...] = ()
    points: tuple[Point, ...] = ()
    groups: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @property
    def touching(self) -> dict[str, tuple[str, ...]]:
        """Sides of each contact and wall, by its name."""
        pairs: dict[str, tuple[str, ...]] = {each.name: (each.first, each.second) for each in self.contacts}
        return pairs | {each.name: (each.side,) for each in self.walls}


def stays(model: Model, sides: Sequence[str]) -> bool:
    """Tell whether two sides begin with the same velocity, or one, before a wall, with none.

    Examples
    --------
    >>> import numpy as np
    >>> from strikewave.fem.mesh import Mesh
    >>> nothing = Mesh(np.zeros((0, 3)), np.zeros((0, 8), np.int32), np.zeros(0, np.int32), ())
    >>> model = Model(nothing, {}, Controls(1e-3), velocity={"ball": (0.0, 0.0, -1.0)})
    >>> stays(model, ("ball.round", "base.top")), stays(model, ("base.bottom",))
    (False, True)
    """
    still = (0.0, 0.0, 0.0)
    speeds = {tuple(model.velocity.get(side.rpartition(".")[0] or side, still)) for side in sides}
    return len(speeds | ({still} if len(sides) == 1 else set())) == 1
