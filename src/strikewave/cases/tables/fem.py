"""[fem]: a run of explicit finite elements; what holds the parts, loads them, where they touch, and what is watched.

A side is ``part.side``; the name of a part alone stands for all its exterior faces.
"""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import Field

from strikewave.base.quantities import (
    Coefficient,
    FrameCount,
    Instants,
    LeastStep,
    MaybeGravity,
    Pressures,
    RepeatedBlows,
    RunTime,
    SafetyFactor,
    Value,
    Velocities,
)
from strikewave.cases.tables.base import CaseTable, Name
from strikewave.cases.tables.mesh import Direction, PlaceTable, VectorTable, by_kind, of_known_kind


class ContactPair(CaseTable):
    """[[fem.contact]]: two surfaces that may touch, with Coulomb's coefficient ``friction``."""

    first: str
    second: str
    friction: Coefficient = Value(si=0.0, typed=0.0)


class TiePair(CaseTable):
    """[[fem.tie]]: nodes of a side that stay where they are ``onto`` another, whose mesh need not match."""

    side: str
    onto: str


class WallTable(CaseTable):
    """[[fem.wall]]: a rigid plane through ``point``; the nodes of a side stay on the side its normal points to."""

    side: str
    point: PlaceTable = PlaceTable()
    normal: Direction
    friction: Coefficient = Value(si=0.0, typed=0.0)


class FixedSide(CaseTable):
    """[[fem.boundary]], fixed: the nodes of the side do not move."""

    kind: Literal["fixed"]
    side: str


class SymmetrySide(CaseTable):
    """[[fem.boundary]], symmetry: the nodes of a flat side move only within its plane."""

    kind: Literal["symmetry"]
    side: str


class GuidedSide(CaseTable):
    """[[fem.boundary]], guided: a side, or a whole part, moves only along ``axis``, all of it alike."""

    kind: Literal["guided"]
    side: str
    axis: Direction


class DrivenSide(CaseTable):
    """[[fem.boundary]], driven: the nodes of a side have a velocity along ``direction``, straight between instants."""

    kind: Literal["driven"]
    side: str
    direction: Direction
    time: Instants
    velocity: Velocities


class PressedSide(CaseTable):
    """[[fem.boundary]], pressure: on a side as it is deformed, inward above 0, straight between instants."""

    kind: Literal["pressure"]
    side: str
    time: Instants
    pressure: Pressures


class OpenSide(CaseTable):
    """[[fem.boundary]], non-reflecting: waves leave through the side."""

    kind: Literal["non-reflecting"]
    side: str


BOUNDARIES = by_kind("kind", FixedSide, SymmetrySide, GuidedSide, DrivenSide, PressedSide, OpenSide)
"""Boundaries by their kind."""
AnyBoundaryTable: TypeAlias = FixedSide | SymmetrySide | GuidedSide | DrivenSide | PressedSide | OpenSide


class SectionTable(CaseTable):
    """[[fem.section]]: mean stress and motion of the elements of a part that a plane cuts before the blow."""

    name: Name
    part: str
    point: PlaceTable
    normal: Direction


class PointTable(CaseTable):
    """[[fem.point]]: the node of a part that lies nearest to a place before the blow."""

    name: Name
    part: str
    place: PlaceTable


class GroupTable(CaseTable):
    """[[fem.group]]: parts whose motion is reported as that of one body too, such as a tied assembly."""

    name: Name
    parts: tuple[str, ...] = Field(min_length=1)


class GravityTable(VectorTable):
    """gravity of [fem]; a component that is left out is 0."""

    EXAMPLE = '{ z = "-9.81 m/s^2" }'
    x: MaybeGravity = None
    y: MaybeGravity = None
    z: MaybeGravity = None


class FemTable(CaseTable):
    """[fem]: a run of explicit finite elements (8-node hexahedra).

    ``interval`` is the step of the histories, ``frames`` the number of pictures in the field file, ``blows`` how often
    the bodies meet, each time as the blow before left them. ``safety`` is the share of the critical time step,
    ``hourglass`` the coefficient of the stiffness against hourglass modes; the viscosities are those of shocks.
    ``least_step`` adds mass to elements that would need a smaller step.
    """

    duration: RunTime
    interval: RunTime = Value(si=1e-6, typed="1 us")
    frames: FrameCount = Value(si=20.0, typed=20)
    blows: RepeatedBlows = Value(si=1.0, typed=1)
    gravity: GravityTable | None = None
    safety: SafetyFactor = Value(si=0.9, typed=0.9)
    hourglass: Coefficient = Value(si=0.05, typed=0.05)
    linear_viscosity: Coefficient = Value(si=0.06, typed=0.06)
    quadratic_viscosity: Coefficient = Value(si=1.5, typed=1.5)
    least_step: LeastStep = Value(si=0.0, typed="0 s")
    contact: tuple[ContactPair, ...] = ()
    tie: tuple[TiePair, ...] = ()
    wall: tuple[WallTable, ...] = ()
    boundary: tuple[
        Annotated[AnyBoundaryTable, Field(discriminator="kind"), of_known_kind("kind", BOUNDARIES)], ...
    ] = ()
    section: tuple[SectionTable, ...] = ()
    point: tuple[PointTable, ...] = ()
    group: tuple[GroupTable, ...] = ()
