"""[fem] and [mesh]: parts, what holds and loads them, where they touch, what is watched.

[fem]: a run of explicit finite elements; what holds the parts, loads them, where they touch, and what is watched. A
side is ``part.side``; the name of a part alone stands for all its exterior faces.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal, TypeAlias

from pydantic import BeforeValidator, Field, field_validator, model_validator

from strikewave.base.errors import MISSING, InputError, nearest
from strikewave.base.quantities import (
    Angle,
    Coefficient,
    ElementSize,
    FrameCount,
    Hardening,
    Instants,
    LeastStep,
    Length,
    MaybeCoefficient,
    MaybeDensity,
    MaybeElementSize,
    MaybeGravity,
    MaybeGrowth,
    MaybeHardening,
    MaybeHeatCapacity,
    MaybeLength,
    MaybeModulus,
    MaybeNumber,
    MaybePlace,
    MaybePoisson,
    MaybeShare,
    MaybeStrainRate,
    MaybeStrength,
    MaybeTemperature,
    MaybeVelocity,
    PerKelvin,
    Pressures,
    RepeatedBlows,
    RunTime,
    SafetyFactor,
    Strength,
    Value,
    Velocities,
)
from strikewave.cases.tables.common import CaseTable, Name

OTHER_WORDS = {
    "plastic": "bilinear",
    "elastic-plastic": "bilinear",
    "elastoplastic": "bilinear",
    "box": "block",
    "plate": "block",
    "sphere": "ball",
    "rod": "cylinder",
    "bar": "cylinder",
    "pipe": "tube",
    "cup": "tube",
    "shell": "tube",
    "roller": "half-cylinder",
    "import": "file",
    "clamped": "fixed",
    "prescribed": "driven",
    "absorbing": "non-reflecting",
    "infinite": "non-reflecting",
}
"""Other names of the kinds of tables here: such a word is answered with ours."""
_AXES = {sign + axis: {axis: float(sign + "1")} for axis in "xyz" for sign in ("", "-")}
"""Directions that go by a letter."""


def of_known_kind(key: str, kinds: Mapping[str, type[CaseTable]]) -> BeforeValidator:
    """Return the pydantic validator that refuses a table whose ``key`` names none of the kinds."""

    def check(raw: Any) -> Any:
        if not isinstance(raw, dict) or raw.get(key) in list(kinds):
            return raw
        kind = raw.get(key, MISSING)
        hint = "" if kind is MISSING else nearest(OTHER_WORDS.get(str(kind).lower(), str(kind)), kinds)
        raise InputError(key, kind, "one of " + ", ".join(f"'{known}'" for known in kinds), hint)

    return BeforeValidator(check)


def by_kind(key: str, *tables: type[CaseTable]) -> dict[str, type[CaseTable]]:
    """Return tables by the word that stands under ``key``.

    Examples
    --------
    >>> list(by_kind("shape", Block, Ball))
    ['block', 'ball']
    """
    return {str(table.model_fields[key].annotation.__args__[0]): table for table in tables}  # type: ignore[union-attr]


class VectorTable(CaseTable):
    """Components along x, y and z; one that is left out is 0."""

    EXAMPLE: ClassVar[str]

    @model_validator(mode="before")
    @classmethod
    def _is_table(cls, raw: Any) -> Any:
        """Refuse what is no table of components, in our own words."""
        if not isinstance(raw, dict | VectorTable):
            raise InputError("", raw, f"a table of components, such as {cls.EXAMPLE}")
        return raw


class PlaceTable(VectorTable):
    """A place or a way; a component that is left out is 0."""

    EXAMPLE = '{ z = "15 mm" }'
    x: MaybePlace = None
    y: MaybePlace = None
    z: MaybePlace = None


class VelocityTable(VectorTable):
    """A velocity; a component that is left out is 0."""

    EXAMPLE = '{ z = "-1 m/s" }'
    x: MaybeVelocity = None
    y: MaybeVelocity = None
    z: MaybeVelocity = None


class DirectionTable(VectorTable):
    """A direction, of any length; a component that is left out is 0."""

    EXAMPLE = '{ x = 1, z = 1 }, or "z", "-z"'
    x: MaybeNumber = None
    y: MaybeNumber = None
    z: MaybeNumber = None


def _direction(raw: Any) -> Any:
    """Read "z" or "-z" as a direction; refuse one that points nowhere."""
    if isinstance(raw, str):
        if raw not in _AXES:
            allowed = "one of " + ", ".join(f'"{axis}"' for axis in _AXES) + ", or a table such as { x = 1, z = 1 }"
            raise InputError("", raw, allowed)
        return _AXES[raw]
    return raw


Direction = Annotated[DirectionTable, BeforeValidator(_direction)]
"""A direction: x, y, z, -x, -y, -z, or a table of numbers."""


class SolidTable(CaseTable):
    """solid of a part; elastic constants that are left out are those of its material."""

    density: MaybeDensity = None
    modulus: MaybeModulus = None
    poissons_ratio: MaybePoisson = None


class ElasticTable(SolidTable):
    """solid of a part: linear elastic."""

    law: Literal["elastic"]


class BilinearTable(SolidTable):
    """solid of a part: von Mises yield with linear hardening.

    ``yield_strength`` is that of the material where it is left out; ``tangent_modulus`` is the slope of the uniaxial
    curve beyond yield (0), ``kinematic`` the share of the hardening that moves the yield surface (0: isotropic).
    """

    law: Literal["bilinear"]
    yield_strength: MaybeStrength = None
    tangent_modulus: MaybeHardening = None
    kinematic: MaybeShare = None


class HeatedTable(SolidTable):
    """solid of a part whose flow stress depends on rate and temperature.

    ``reference_rate`` is 1/s, ``room_temperature`` 293 K, ``preheat`` (kelvin above room at the start) 0 where
    left out; ``heat_fraction`` of the plastic work becomes heat (0.9) where ``specific_heat`` is given.
    """

    reference_rate: MaybeStrainRate = None
    room_temperature: MaybeTemperature = None
    preheat: MaybeTemperature = None
    specific_heat: MaybeHeatCapacity = None
    heat_fraction: MaybeShare = None


class JohnsonCookTable(HeatedTable):
    """solid of a part: flow stress (A + B p^n)(1 + C ln(rate / reference_rate))(1 - T*^m).

    All five constants are needed. Heat counts where ``specific_heat`` and ``melting_temperature`` are given, both.
    """

    law: Literal["johnson-cook"]
    A: Strength
    B: Hardening
    n: Coefficient
    C: Coefficient
    m: Coefficient
    melting_temperature: MaybeTemperature = None


class ZerilliArmstrongTable(HeatedTable):
    """solid of a part: flow stress C0 + (C1 + C2 sqrt(p)) exp(T (C4 ln(rate / reference_rate) - C3)) + C5 p^n.

    Copper and other face-centred metals have C2 and neither C1 nor C5, iron and other body-centred ones C1 and C5 and
    no C2: what is left out is 0, n 1. C3 and C4 are in 1/K.
    """

    law: Literal["zerilli-armstrong"]
    C0: Hardening
    C1: MaybeHardening = None
    C2: MaybeHardening = None
    C3: PerKelvin
    C4: PerKelvin
    C5: MaybeHardening = None
    n: MaybeCoefficient = None


SOLIDS = by_kind("law", ElasticTable, BilinearTable, JohnsonCookTable, ZerilliArmstrongTable)
"""Laws of solids by their name."""
AnySolidTable: TypeAlias = ElasticTable | BilinearTable | JohnsonCookTable | ZerilliArmstrongTable


class TurnTable(CaseTable):
    """turn of a part: about an axis through the origin of its shape, before it is moved."""

    axis: Direction
    angle: Angle


class PartTable(CaseTable):
    """Base of every [[mesh.part]].

    ``material`` is one of the table; without it ``solid`` has density, Young's modulus and Poisson's ratio. ``rigid``
    makes it a rigid body: "free", "translation" (it does not turn), or "x", "y", "z": it moves only along that axis.
    ``elements`` are hexahedra with one point, or "full": selectively reduced integration.
    """

    name: Name
    shape: str
    material: str = ""
    velocity: VelocityTable | None = None
    rigid: Literal["", "free", "translation", "x", "y", "z"] = ""
    solid: Annotated[AnySolidTable, Field(discriminator="law"), of_known_kind("law", SOLIDS)] | None = None
    elements: Literal["one-point", "full"] = "one-point"


class ShapedPart(PartTable):
    """Base of a part of a built-in shape: ``size`` of its elements; it is turned, then moved by ``at``.

    Its elements may be finer where it is touched: ``finest`` in a fine zone that reaches so far (``extent``), and from
    there each next one ``growth`` larger (1.2) up to ``size``.
    """

    size: ElementSize
    finest: MaybeElementSize = None
    extent: MaybeLength = None
    growth: MaybeGrowth = None
    at: PlaceTable | None = None
    turn: TurnTable | None = None


Sector = Literal["whole", "half", "quarter"]
"""Whole; y >= 0; x >= 0 and y >= 0: the sides ``y-`` and ``x-`` are planes of symmetry."""


class Block(ShapedPart):
    """[[mesh.part]], a block that stands on z = 0, the z axis through its middle; sides x-, x+, y-, y+, z-, z+.

    ``width`` along x, ``depth`` along y, ``height`` along z, those of the whole block in a sector too. It is fine about
    the middle of the side ``fine_at``.
    """

    shape: Literal["block"]
    width: Length
    depth: Length
    height: Length
    sector: Sector = "whole"
    fine_at: Literal["z-", "z+"] = "z+"


class Cylinder(ShapedPart):
    """[[mesh.part]], a cylinder that stands on z = 0; sides bottom, top, round.

    It is fine about its axis at the side ``fine_at``.
    """

    shape: Literal["cylinder"]
    diameter: Length
    length: Length
    sector: Sector = "whole"
    fine_at: Literal["bottom", "top"] = "top"


class Tube(ShapedPart):
    """[[mesh.part]], a tube that stands on z = 0; sides bottom, top, round, inner_round. It is fine at ``fine_at``.

    Its ends are closed where ``bottom`` and ``top`` give them a thickness: sides inner_bottom, inner_top.
    """

    shape: Literal["tube"]
    inner_diameter: Length
    outer_diameter: Length
    length: Length
    bottom: MaybeLength = None
    top: MaybeLength = None
    sector: Sector = "whole"
    fine_at: Literal["bottom", "top"] = "top"


class HalfCylinder(ShapedPart):
    """[[mesh.part]], half a cylinder, its axis along y, its flat side at z = 0 and its round side down.

    Sides round, top, front, back; ``y-`` takes the place of front in a sector. It is fine at its lowest line.
    """

    shape: Literal["half-cylinder"]
    radius: Length
    length: Length
    sector: Sector = "whole"


class FramePart(ShapedPart):
    """[[mesh.part]], a frame around an opening along y, that stands on z = 0, the z axis through its middle.

    ``left``, ``right``, ``bottom``, ``top`` are the thicknesses of its walls. Sides left, right, bottom, top, front,
    back, and inner_left to inner_top; in a sector ``y-`` takes the place of front, and ``x-`` that of left, where the
    walls left and right must be alike. It is fine about the middle of the side ``fine_at``.
    """

    shape: Literal["frame"]
    width: Length
    depth: Length
    height: Length
    left: Length
    right: Length
    bottom: Length
    top: Length
    sector: Sector = "whole"
    fine_at: Literal["bottom", "top"] = "top"


class HalfSpace(ShapedPart):
    """[[mesh.part]], a half-ball below z = 0; sides top, round. It is fine at the middle of its flat top."""

    shape: Literal["half-space"]
    radius: Length
    sector: Sector = "whole"


class Ball(ShapedPart):
    """[[mesh.part]], a ball about the origin; side round. It is fine at its lowest point.

    ``part_of`` "lower half" leaves out what lies above the equator, whose plane is then the side top.
    """

    shape: Literal["ball"]
    radius: Length
    sector: Sector = "whole"
    part_of: Literal["whole", "lower half"] = "whole"


def _one_of_it(raw: Any) -> Any:
    """Read a unit alone as one of it: "mm" is "1 mm"."""
    return f"1 {raw}" if isinstance(raw, str) and raw.strip()[:1].isalpha() else raw


class FilePart(PartTable):
    """[[mesh.part]], a part of a mesh in a file (gmsh, Abaqus, VTK): ``part`` names it there (its own name).

    Every part of a file needs its row; the only part of a file needs no name. ``unit`` is the length that 1 stands for
    in the file (1 m).
    """

    shape: Literal["file"]
    file: str
    part: str = ""
    unit: Annotated[MaybeLength, BeforeValidator(_one_of_it)] = None


SHAPES = by_kind("shape", Block, Cylinder, Tube, HalfCylinder, FramePart, HalfSpace, Ball, FilePart)
"""Parts by their shape."""
AnyShaped: TypeAlias = Block | Cylinder | Tube | HalfCylinder | FramePart | HalfSpace | Ball
AnyPart: TypeAlias = AnyShaped | FilePart


class MeshTable(CaseTable):
    """[mesh]: the parts of a finite-element mesh."""

    part: tuple[Annotated[AnyPart, Field(discriminator="shape"), of_known_kind("shape", SHAPES)], ...]

    @field_validator("part", mode="before")
    @classmethod
    def _some(cls, raw: Any) -> Any:
        """Refuse a mesh of nothing; a least length would be complained of beside every fault of a single part."""
        if raw in ([], ()):
            raise InputError("", MISSING, "[[mesh.part]], once for each part")
        return raw


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
