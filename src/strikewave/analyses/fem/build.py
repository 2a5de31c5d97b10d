"""Case in, finite element model out: parts, solids, what holds, loads and touches them."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from typing import Any

import numpy as np

from strikewave.analyses.fem.overlaps import check_apart
from strikewave.analyses.fem.parts import LARGEST, built_parts, estimated_elements
from strikewave.analyses.fem.vectors import direction, vector
from strikewave.base.errors import MISSING, InputError, nearest
from strikewave.base.materials import Material, material
from strikewave.base.quantities import Value
from strikewave.cases.case import Case
from strikewave.cases.stack_of_case import once
from strikewave.cases.tables.fem import (
    AnyBoundaryTable,
    DrivenSide,
    FemTable,
    FixedSide,
    GuidedSide,
    PressedSide,
    SymmetrySide,
)
from strikewave.cases.tables.mesh import (
    AnyPart,
    BilinearTable,
    ElasticTable,
    JohnsonCookTable,
    MeshTable,
    ZerilliArmstrongTable,
)
from strikewave.fem.checks import control_faults
from strikewave.fem.mesh import Mesh, joined
from strikewave.fem.model import (
    AnyBoundary,
    Controls,
    CutSection,
    Driven,
    Fixed,
    Guided,
    Model,
    NonReflecting,
    Point,
    Pressure,
    Rigid,
    RigidWall,
    SurfaceContact,
    Symmetry,
    Tie,
    TimeCurve,
)
from strikewave.fem.quality import check_mesh
from strikewave.fem.solids import AnySolid, Bilinear, Elastic, JohnsonCook, ZerilliArmstrong

ROUGH = 2.0
"""Largest factor by which an estimate of elements is too high: what it refuses is too large without doubt."""
LARGEST_HISTORY = 200_000
"""Instants of the histories: half a gigabyte for tens of parts, and no pulse needs as many."""
FEWEST_INSTANTS = 3.0
"""Intervals of the histories at least: fewer show no pulse at all."""
ELASTIC = {"density": "a density", "youngs_modulus": "Young's modulus", "poissons_ratio": "Poisson's ratio"}
"""Constants that every solid has, in words."""
_KINDS: dict[type, tuple[type[Elastic], tuple[str, ...]]] = {
    type(None): (Elastic, ()),
    ElasticTable: (Elastic, ()),
    BilinearTable: (Bilinear, ("yield_strength",)),
    JohnsonCookTable: (JohnsonCook, ()),
    ZerilliArmstrongTable: (ZerilliArmstrong, ()),
}
"""The solid of each table, and what it takes of the material besides."""


def build_model(case: Case, threads: int = 1) -> Model:
    """Return the model of a case with [mesh] and [fem].

    Raises
    ------
    InputError
        If parts do not fit together: sides that there are not, too many elements, or a material lacks what its
        law needs.

    Examples
    --------
    >>> from strikewave import load_case
    >>> model = build_model(load_case("two-bars-fem"))
    >>> model.mesh.names
    ('striker', 'bar')
    """
    mesh_table, fem = check_elements(case)
    mesh = joined(built_parts(mesh_table))
    check_mesh(mesh)
    if len(mesh.hexahedra) > LARGEST:
        raise InputError("mesh", f"{len(mesh.hexahedra)} elements", f"at most {LARGEST}", "take larger elements")
    _check_sides(mesh, fem)
    _check_points(mesh, fem)
    pairs = [(f"fem.contact.{k}", part_of(row.first), part_of(row.second)) for k, row in enumerate(fem.contact)]
    check_apart(mesh, [pair for pair in pairs if pair[1] != pair[2]])
    parts = mesh_table.part
    return Model(
        mesh=mesh,
        solids={part.name: solid_of(part) for part in parts},
        controls=_controls(fem, parts, threads),
        velocity={part.name: vector(part.velocity) for part in parts if part.velocity is not None},
        gravity=vector(fem.gravity),
        boundaries=tuple(_boundary(row, f"fem.boundary.{k}") for k, row in enumerate(fem.boundary)),
        contacts=tuple(SurfaceContact(side_name(x.first), side_name(x.second), x.friction.si) for x in fem.contact),
        ties=tuple(Tie(side_name(row.side), side_name(row.onto)) for row in fem.tie),
        walls=tuple(
            RigidWall(side_name(x.side), vector(x.point), direction(x.normal, f"fem.wall.{k}.normal"), x.friction.si)
            for k, x in enumerate(fem.wall)
        ),
        rigid=tuple(_rigid(part) for part in parts if part.rigid),
        sections=tuple(
            CutSection(x.name, x.part, vector(x.point), direction(x.normal, f"fem.section.{x.name}.normal"))
            for x in fem.section
        ),
        points=tuple(Point(x.name, x.part, vector(x.place)) for x in fem.point),
        groups={row.name: row.parts for row in fem.group},
    )


def check_elements(case: Case) -> tuple[MeshTable, FemTable]:
    """Check all that can be checked without a mesh, and return the tables.

    Raises
    ------
    InputError
        If the case has no mesh, a part is named that there is not, a material lacks what its law needs, or there would
        be too many elements.
    """
    if case.mesh is None or case.fem is None:
        hint = f"this case has none: `strikewave {case.command}` runs it" if case.machine or case.stack.layer else ""
        raise InputError("mesh", MISSING, "[mesh] with its parts and [fem]", hint)
    names = [part.name for part in case.mesh.part]
    once("mesh.part", names)
    for part in case.mesh.part:
        solid_of(part)
    estimate = estimated_elements(case.mesh)
    if estimate > ROUGH * LARGEST:
        hint = "take a larger size, or a finest size only where parts touch"
        raise InputError("mesh", f"about {estimate:.3g} elements", f"at most {LARGEST}", hint)
    fem = case.fem
    once("fem.section", [row.name for row in fem.section])
    once("fem.point", [row.name for row in fem.point])
    once("fem.group", [row.name for row in fem.group])
    _check_groups(fem, names)
    _check_rigid(fem, {part.name for part in case.mesh.part if part.rigid})
    for path, name in _part_names(fem):
        if name not in names:
            raise InputError(path, name, "a part of [mesh]", nearest(name, names))
    for k, row in enumerate(fem.boundary):
        _boundary(row, f"fem.boundary.{k}")
    instants = fem.duration.si / fem.interval.si
    if not FEWEST_INSTANTS <= instants <= LARGEST_HISTORY:
        allowed = f"between a {LARGEST_HISTORY}th and a third of the duration, {fem.duration.typed}"
        raise InputError("fem.interval", fem.interval.typed, allowed)
    for fault in control_faults(_controls(fem, case.mesh.part, threads=1)):
        raise InputError(f"fem.{fault.field}", fault.got, fault.allowed)
    return case.mesh, fem


def side_name(name: str) -> str:
    """Return a side by its whole name; a part alone stands for all its exterior faces.

    Examples
    --------
    >>> side_name("ball"), side_name("ball.round")
    ('ball.all', 'ball.round')
    """
    return name if "." in name else f"{name}.all"


def part_of(side: str) -> str:
    """Return the part of a side."""
    return side.partition(".")[0]


def solid_of(part: AnyPart) -> AnySolid:
    """Return the solid of a part; constants that it does not give are those of its material.

    Raises
    ------
    InputError
        If the material is unknown, or neither it nor the solid has a constant that is needed.
    """
    path, table = f"mesh.part.{part.name}", part.solid
    row = material(part.material, f"{path}.material") if part.material else None
    if row is None and table is None:
        hint = 'or one of your own: solid = { law = "elastic", density, youngs_modulus, poissons_ratio }'
        raise InputError(f"{path}.material", MISSING, "a material of the table (`strikewave materials`)", hint)
    kind, keys = _KINDS[type(table)]
    constants = _given(table, *(key for key in type(table).model_fields if key != "law")) if table else {}
    for key in (*ELASTIC, *keys):
        if key not in constants:
            constants[key] = _of_material(row, key, f"{path}.solid.{key}")
    if kind is JohnsonCook and ("specific_heat" in constants) != ("melting_temperature" in constants):
        lacking = "melting_temperature" if "specific_heat" in constants else "specific_heat"
        raise InputError(f"{path}.solid.{lacking}", MISSING, "both specific_heat and melting_temperature, or neither")
    try:
        return kind(**constants)
    except InputError as error:
        raise error.at(f"{path}.solid.{error.field}") from None


def _given(table: Any, *keys: str) -> dict[str, float]:
    """Return the fields of a table that are there."""
    return {key: value.si for key in keys if (value := getattr(table, key)) is not None}


def _of_material(row: Material | None, key: str, path: str) -> float:
    """Return a constant of a material."""
    value: float | None = getattr(row, key, None)
    if value is None:
        reason = f"the table of materials has none for {row.name}" if row else "the part names no material"
        raise InputError(path, MISSING, f"{ELASTIC.get(key, 'a yield strength')}: {reason}")
    return value


def _controls(fem: FemTable, parts: Sequence[AnyPart], threads: int) -> Controls:
    return Controls(
        duration=fem.duration.si,
        interval=fem.interval.si,
        safety=fem.safety.si,
        hourglass=fem.hourglass.si,
        linear_viscosity=fem.linear_viscosity.si,
        quadratic_viscosity=fem.quadratic_viscosity.si,
        full=tuple(part.name for part in parts if part.elements == "full"),
        least_step=fem.least_step.si,
        threads=threads,
        blows=round(fem.blows.si),
    )


def _boundary(row: AnyBoundaryTable, path: str) -> AnyBoundary:
    side = side_name(row.side)
    if isinstance(row, FixedSide):
        return Fixed(side)
    if isinstance(row, SymmetrySide):
        return Symmetry(side)
    if isinstance(row, GuidedSide):
        return Guided(row.side, direction(row.axis, f"{path}.axis"))
    if isinstance(row, DrivenSide):
        return Driven(side, direction(row.direction, f"{path}.direction"), _curve(row.time, row.velocity, path))
    if isinstance(row, PressedSide):
        return Pressure(side, _curve(row.time, row.pressure, path))
    return NonReflecting(side)


def _curve(time: Sequence[Value], value: Sequence[Value], path: str) -> TimeCurve:
    """Return a quantity over time; instants must ascend and each needs its value."""
    if not time or len(time) != len(value):
        allowed = f"one for each of the {len(value)} values, at least 1"
        raise InputError(f"{path}.time", f"{len(time)} instants", allowed)
    instants = tuple(x.si for x in time)
    late = next((k for k in range(1, len(instants)) if not instants[k] > instants[k - 1]), None)
    if late is not None:
        allowed = f"later than the one before it, {time[late - 1].typed}"
        raise InputError(f"{path}.time.{late}", time[late].typed, allowed)
    return TimeCurve(instants, tuple(x.si for x in value))


def _rigid(part: AnyPart) -> Rigid:
    """Return which ways a rigid part may move."""
    if part.rigid == "free":
        return Rigid(part.name)
    along = (True,) * 3 if part.rigid == "translation" else tuple(axis == part.rigid for axis in "xyz")
    return Rigid(part.name, along, (False, False, False))  # type: ignore[arg-type]


def _part_names(fem: FemTable) -> Iterator[tuple[str, str]]:
    """Yield every part that [fem] names, with the path of the field."""
    for path, side in _sides(fem):
        yield path, part_of(side)
    for kind, rows in (("section", fem.section), ("point", fem.point)):
        for row in rows:
            yield f"fem.{kind}.{row.name}.part", row.part
    for group in fem.group:
        yield from ((f"fem.group.{group.name}.parts", part) for part in group.parts)


def _check_rigid(fem: FemTable, rigid: Collection[str]) -> None:
    """Refuse a boundary that holds or drives a rigid part, and ties of one."""
    conditions = [(f"boundary.{k}.side", x.side) for k, x in enumerate(fem.boundary) if not isinstance(x, PressedSide)]
    ties = [(f"tie.{k}.{key}", getattr(x, key)) for k, x in enumerate(fem.tie) for key in ("side", "onto")]
    for field, side in (*conditions, *ties):
        if part_of(side) in rigid:
            hint = f'{part_of(side)} is rigid: state its freedoms by rigid = "z" or the like, its start by velocity'
            raise InputError(f"fem.{field}", side, "a side of a part that deforms", hint)


def _check_points(mesh: Mesh, fem: FemTable) -> None:
    """Refuse a point farther from its part than an element there."""
    for row in fem.point:
        nodes, place = mesh.nodes_of(row.part), np.array(vector(row.place))
        far = np.linalg.norm(mesh.points[nodes] - place, axis=1)
        own = mesh.hexahedra[mesh.elements_of(row.part)]
        corners = mesh.points[own[np.any(own == nodes[np.argmin(far)], axis=1)]]
        if far.min() > np.linalg.norm(np.ptp(corners, axis=1), axis=1).max():
            ends = (mesh.points[nodes].min(axis=0), mesh.points[nodes].max(axis=0))
            low, high = (", ".join(f"{x * 1e3 + 0.0:.4g}" for x in end) for end in ends)
            got = f"a place {far.min() * 1e3:.4g} mm from {row.part}"
            raise InputError(f"fem.point.{row.name}.place", got, f"in {row.part}, from ({low}) to ({high}) mm")


def _check_groups(fem: FemTable, names: Sequence[str]) -> None:
    """Refuse a group that is called as a part, or has a part twice."""
    for row in fem.group:
        if row.name in names:
            raise InputError(f"fem.group.{row.name}.name", row.name, "a name that no part has")
        if len(set(row.parts)) < len(row.parts):
            raise InputError(f"fem.group.{row.name}.parts", ", ".join(row.parts), "each part once")


def _sides(fem: FemTable) -> Iterator[tuple[str, str]]:
    """Yield every side that [fem] names, with the path of the field."""
    for k, pair in enumerate(fem.contact):
        yield f"fem.contact.{k}.first", pair.first
        yield f"fem.contact.{k}.second", pair.second
    for k, tie in enumerate(fem.tie):
        yield f"fem.tie.{k}.side", tie.side
        yield f"fem.tie.{k}.onto", tie.onto
    for kind, rows in (("wall", fem.wall), ("boundary", fem.boundary)):
        for k, row in enumerate(rows):
            yield f"fem.{kind}.{k}.side", row.side


def _nearest_side(part: str, side: str, known: Sequence[str]) -> str:
    """Name the side nearest to a mistyped one; nothing where none is near."""
    hint = nearest(f"{part}.{side}", [f"{part}.{other}" for other in known])
    return hint if nearest(side, known).startswith("did") else ""


def _check_sides(mesh: Mesh, fem: FemTable) -> None:
    """Refuse sides that there are not, and pairs that share nodes."""
    for path, name in _sides(fem):
        part, _, side = side_name(name).partition(".")
        known = [key.partition(".")[2] for key in mesh.sides if key.partition(".")[0] == part] + ["all"]
        if side not in known:
            raise InputError(path, name, f"a side of {part}: {', '.join(known)}", _nearest_side(part, side, known))
    pairs = [(f"fem.contact.{k}.second", row.first, row.second) for k, row in enumerate(fem.contact)]
    pairs += [(f"fem.tie.{k}.onto", row.side, row.onto) for k, row in enumerate(fem.tie)]
    for path, first, second in pairs:
        if np.intersect1d(mesh.side(side_name(first)), mesh.side(side_name(second))).size:
            raise InputError(path, second, f"a side that shares no nodes with {first}")
