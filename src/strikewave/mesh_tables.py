"""[mesh]: the parts of a model of hexahedra, by their shape; what each is made of, where it stands, how it moves."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import BeforeValidator, Field

from strikewave.errors import MISSING, InputError, nearest
from strikewave.quantities import (
    Angle,
    ElementSize,
    Length,
    MaybeCoefficient,
    MaybeElementSize,
    MaybeGrowth,
    MaybeHardening,
    MaybeHeatCapacity,
    MaybeLength,
    MaybeNumber,
    MaybePlace,
    MaybeShare,
    MaybeStrainRate,
    MaybeStrength,
    MaybeTemperature,
    MaybeVelocity,
    Strength,
)
from strikewave.tables import Name, Table


def of_known_kind(key: str, kinds: Mapping[str, type[Table]]) -> BeforeValidator:
    """Return the pydantic validator that refuses a table whose ``key`` names none of the kinds."""

    def check(raw: Any) -> Any:
        if not isinstance(raw, dict) or raw.get(key) in list(kinds):
            return raw
        kind = raw.get(key, MISSING)
        hint = "" if kind is MISSING else nearest(str(kind), kinds)
        raise InputError(key, kind, "one of " + ", ".join(f"'{known}'" for known in kinds), hint)

    return BeforeValidator(check)


def by_kind(key: str, *tables: type[Table]) -> dict[str, type[Table]]:
    """Return tables by the word that stands under ``key``.

    Examples
    --------
    >>> list(by_kind("shape", Block, Ball))
    ['block', 'ball']
    """
    return {str(table.model_fields[key].annotation.__args__[0]): table for table in tables}  # type: ignore[union-attr]


class PlaceTable(Table):
    """A place or a way; a component that is left out is 0."""

    x: MaybePlace = None
    y: MaybePlace = None
    z: MaybePlace = None


class VelocityTable(Table):
    """A velocity; a component that is left out is 0."""

    x: MaybeVelocity = None
    y: MaybeVelocity = None
    z: MaybeVelocity = None


class DirectionTable(Table):
    """A direction, of any length; a component that is left out is 0."""

    x: MaybeNumber = None
    y: MaybeNumber = None
    z: MaybeNumber = None


_AXES = {sign + axis: {axis: float(sign + "1")} for axis in "xyz" for sign in ("", "-")}


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


class ElasticTable(Table):
    """solid of a part: linear elastic, with the constants of its material."""

    law: Literal["elastic"]


class BilinearTable(Table):
    """solid of a part: von Mises yield with linear hardening.

    ``yield_strength`` is that of the material where it is left out; ``tangent_modulus`` is the slope of the uniaxial
    curve beyond yield (0), ``kinematic`` the share of the hardening that moves the yield surface (0: isotropic).
    """

    law: Literal["bilinear"]
    yield_strength: MaybeStrength = None
    tangent_modulus: MaybeHardening = None
    kinematic: MaybeShare = None


class JohnsonCookTable(Table):
    """solid of a part: flow stress (A + B p^n)(1 + C ln(rate / reference_rate))(1 - T*^m).

    B, C are 0 where left out, n, m are 1, ``reference_rate`` 1/s, ``room_temperature`` 293 K. Heat counts where
    ``specific_heat`` and ``melting_temperature`` are given; ``heat_fraction`` of the plastic work becomes heat (0.9).
    """

    law: Literal["johnson-cook"]
    A: Strength
    B: MaybeHardening = None
    n: MaybeCoefficient = None
    C: MaybeCoefficient = None
    m: MaybeCoefficient = None
    reference_rate: MaybeStrainRate = None
    room_temperature: MaybeTemperature = None
    melting_temperature: MaybeTemperature = None
    specific_heat: MaybeHeatCapacity = None
    heat_fraction: MaybeShare = None


SOLIDS = by_kind("law", ElasticTable, BilinearTable, JohnsonCookTable)
AnySolidTable: TypeAlias = ElasticTable | BilinearTable | JohnsonCookTable


class TurnTable(Table):
    """turn of a part: about an axis through the origin of its shape, before it is moved."""

    axis: Direction
    angle: Angle


class PartTable(Table):
    """What every [[mesh.part]] has.

    ``rigid`` makes it a rigid body: "free", "translation" (it does not turn), or "x", "y", "z": it moves only along
    that axis. ``elements`` are hexahedra with one point, or "full": selectively reduced integration.
    """

    name: Name
    shape: str
    material: str
    velocity: VelocityTable | None = None
    rigid: Literal["", "free", "translation", "x", "y", "z"] = ""
    solid: Annotated[AnySolidTable, Field(discriminator="law"), of_known_kind("law", SOLIDS)] | None = None
    elements: Literal["one-point", "full"] = "one-point"


class ShapedPart(PartTable):
    """What a part of a shape of our own has: ``size`` of its elements; it is turned, then moved by ``at``.

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

    Sides round, top, front, back. It is fine at its lowest line; the half has x >= 0.
    """

    shape: Literal["half-cylinder"]
    radius: Length
    length: Length
    sector: Literal["whole", "half"] = "whole"


class Frame(ShapedPart):
    """[[mesh.part]], a frame around an opening along y, that stands on z = 0, the z axis through its middle.

    ``left``, ``right``, ``bottom``, ``top`` are the thicknesses of its walls. Sides left, right, bottom, top, front,
    back, and inner_left to inner_top. It is fine about the middle of the side ``fine_at``.
    """

    shape: Literal["frame"]
    width: Length
    depth: Length
    height: Length
    left: Length
    right: Length
    bottom: Length
    top: Length
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


class FilePart(PartTable):
    """[[mesh.part]], a part of a mesh in a file (gmsh, Abaqus, VTK): ``part`` names it there (its own name).

    Every part of a file needs its row. ``unit`` is the length that 1 stands for in the file (1 m).
    """

    shape: Literal["file"]
    file: str
    part: str = ""
    unit: MaybeLength = None


SHAPES = by_kind("shape", Block, Cylinder, Tube, HalfCylinder, Frame, HalfSpace, Ball, FilePart)
AnyShaped: TypeAlias = Block | Cylinder | Tube | HalfCylinder | Frame | HalfSpace | Ball
AnyPart: TypeAlias = AnyShaped | FilePart


class MeshTable(Table):
    """[mesh]: the parts of a model of hexahedra."""

    part: tuple[Annotated[AnyPart, Field(discriminator="shape"), of_known_kind("shape", SHAPES)], ...] = Field(
        min_length=1
    )
