"""Case in, finite element model out: parts and their meshes, solids, what holds, loads and touches them."""

from __future__ import annotations

import contextlib
import functools
import math
from collections.abc import Callable, Collection, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strikewave.base.constants import material
from strikewave.base.errors import MISSING, InputError, InputErrors, nearest
from strikewave.base.quantities import Value
from strikewave.cases.case import Case
from strikewave.cases.stack_of_case import once
from strikewave.cases.tables import fem as tables
from strikewave.fem.mesh import FACES, Mesh, joined
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
    Vector,
    control_faults,
)
from strikewave.fem.quality import check_mesh
from strikewave.fem.sections import GROWTH, Grading, nodes_between
from strikewave.fem.shapes import (
    FrameSize,
    TubeSize,
    ball,
    block,
    cylinder,
    frame,
    half_cylinder,
    half_space,
    moved,
    renamed,
    tube,
    turned,
)
from strikewave.fem.solids import AnySolid, Bilinear, Elastic, JohnsonCook, ZerilliArmstrong

Array = NDArray[np.float64]

ROUGH = 2.0
"""Largest factor by which an estimate of elements is too high; a model refused by it is too large without doubt."""
LARGEST = 3_000_000  # they take about 3 GB, which a usual machine has to spare
"""Most elements of a model."""
LARGEST_HISTORY = 200_000  # half a gigabyte for tens of parts, and no pulse needs as many
"""Most instants of the histories."""
FEWEST_INSTANTS = 3.0  # fewer show no pulse at all
"""Fewest intervals of the histories."""
ROUNDING = 1e-9
"""Share by which a size may exceed its part, by rounding of units."""
LARGEST_FINE_CORE = 0.5
"""Largest share of a radius that a core takes, as `strikewave.fem.sections.CORE`."""
NEAREST = 8  # a corner has so many around it
"""Elements looked at for each place, those whose centres are nearest."""
# Surfaces may overlap by a tenth of a face (`strikewave.fem.contact.SHALLOW`), and a deeper overlap is a part out of
# place.
INSIDE = 0.25
"""Share of an element's smallest depth that a place inside it lies behind each face."""
SHARE = {"whole": 1.0, "half": 0.5, "quarter": 0.25}
"""Share of a body that a sector holds."""
LENGTHS = ("width", "depth", "height", "length", "diameter", "outer_diameter", "radius")
"""Fields of a shape that give its size: its elements cannot be larger."""
CONTROLS = ("duration", "interval", "safety", "hourglass", "linear_viscosity", "quadratic_viscosity", "least_step")
"""Fields of [fem] that the engine calls as the case does."""
ELASTIC = {"density": "a density", "modulus": "Young's modulus", "poissons_ratio": "Poisson's ratio"}
"""Constants that every solid has, in words."""
_KINDS: dict[type, tuple[type[Elastic], tuple[str, ...]]] = {
    type(None): (Elastic, ()),
    tables.ElasticTable: (Elastic, ()),
    tables.BilinearTable: (Bilinear, ("yield_strength",)),
    tables.JohnsonCookTable: (JohnsonCook, ()),
    tables.ZerilliArmstrongTable: (ZerilliArmstrong, ()),
}
"""Solid of each table, and its further constants from the material."""


def build_model(case: Case, threads: int = 1) -> Model:
    """Return the model of a case with [mesh] and [fem]."""
    mesh_table, fem = check_elements(case)
    mesh = joined(built_parts(mesh_table))
    check_mesh(mesh)
    if len(mesh.hexahedra) > LARGEST:
        raise InputError("mesh", f"{len(mesh.hexahedra)} elements", f"at most {LARGEST}", "take larger elements")
    _check_sides(mesh, fem)
    _check_points(mesh, fem)
    for k, row in enumerate(fem.contact):
        _check_apart(mesh, f"fem.contact.{k}", part_of(row.first), part_of(row.second))
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


def check_elements(case: Case) -> tuple[tables.MeshTable, tables.FemTable]:
    """Check all that can be checked without a mesh, and return the tables."""
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
    for group in fem.group:
        if group.name in names:
            raise InputError(f"fem.group.{group.name}.name", group.name, "a name that no part has")
        if len(set(group.parts)) < len(group.parts):
            raise InputError(f"fem.group.{group.name}.parts", ", ".join(group.parts), "each part once")
    _check_rigid(fem, {part.name for part in case.mesh.part if part.rigid})
    named_parts = [(path, part_of(side)) for path, side in _sides(fem)]
    for kind, rows in (("section", fem.section), ("point", fem.point)):
        named_parts += [(f"fem.{kind}.{row.name}.part", row.part) for row in rows]
    named_parts += [(f"fem.group.{group.name}.parts", part) for group in fem.group for part in group.parts]
    for path, name in named_parts:
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


def solid_of(part: tables.AnyPart) -> AnySolid:
    """Return the solid of a part; constants that it does not give are those of its material."""
    path, table = f"mesh.part.{part.name}", part.solid
    row = material(part.material, f"{path}.material") if part.material else None
    if row is None and table is None:
        hint = 'or one of your own: solid = { law = "elastic", density, modulus, poissons_ratio }'
        raise InputError(f"{path}.material", MISSING, "a material of the table (`strikewave materials`)", hint)
    kind, keys = _KINDS[type(table)]
    fields = [key for key in type(table).model_fields if key != "law"] if table else []
    constants = {key: value.si for key in fields if (value := getattr(table, key)) is not None}
    for key in (*ELASTIC, *keys):
        if key not in constants:
            value = getattr(row, "youngs_modulus" if key == "modulus" else key, None)
            if value is None:
                reason = f"the table of materials has none for {row.name}" if row else "the part names no material"
                raise InputError(f"{path}.solid.{key}", MISSING, f"{ELASTIC.get(key, 'a yield strength')}: {reason}")
            constants[key] = value
    if kind is JohnsonCook and ("specific_heat" in constants) != ("melting_temperature" in constants):
        lacking = "melting_temperature" if "specific_heat" in constants else "specific_heat"
        raise InputError(f"{path}.solid.{lacking}", MISSING, "both specific_heat and melting_temperature, or neither")
    try:
        return kind(youngs_modulus=constants.pop("modulus"), **constants)
    except InputError as error:
        field = "modulus" if error.field == "youngs_modulus" else error.field
        raise error.at(f"{path}.solid.{field}") from None


def _controls(fem: tables.FemTable, parts: Sequence[tables.AnyPart], threads: int) -> Controls:
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


def _boundary(row: tables.AnyBoundaryTable, path: str) -> AnyBoundary:
    side = side_name(row.side)
    if isinstance(row, tables.FixedSide):
        return Fixed(side)
    if isinstance(row, tables.SymmetrySide):
        return Symmetry(side)
    if isinstance(row, tables.GuidedSide):
        return Guided(row.side, direction(row.axis, f"{path}.axis"))
    if isinstance(row, tables.DrivenSide):
        return Driven(side, direction(row.direction, f"{path}.direction"), _curve(row.time, row.velocity, path))
    if isinstance(row, tables.PressedSide):
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


def _rigid(part: tables.AnyPart) -> Rigid:
    """Return which ways a rigid part may move."""
    if part.rigid == "free":
        return Rigid(part.name)
    along = (True,) * 3 if part.rigid == "translation" else tuple(axis == part.rigid for axis in "xyz")
    return Rigid(part.name, along, (False, False, False))  # type: ignore[arg-type]


def _check_rigid(fem: tables.FemTable, rigid: Collection[str]) -> None:
    """Refuse a boundary that holds or drives a rigid part, and ties of one."""
    conditions = [
        (f"boundary.{k}.side", x.side) for k, x in enumerate(fem.boundary) if not isinstance(x, tables.PressedSide)
    ]
    ties = [(f"tie.{k}.{key}", getattr(x, key)) for k, x in enumerate(fem.tie) for key in ("side", "onto")]
    for field, side in (*conditions, *ties):
        if part_of(side) in rigid:
            hint = f'{part_of(side)} is rigid: state its freedoms by rigid = "z" or the like, its start by velocity'
            raise InputError(f"fem.{field}", side, "a side of a part that deforms", hint)


def _check_points(mesh: Mesh, fem: tables.FemTable) -> None:
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


def _sides(fem: tables.FemTable) -> Iterator[tuple[str, str]]:
    """Yield every side that [fem] names, with the path of the field."""
    for k, pair in enumerate(fem.contact):
        yield f"fem.contact.{k}.first", pair.first
        yield f"fem.contact.{k}.second", pair.second
    for k, tie in enumerate(fem.tie):
        yield f"fem.contact.{k}.side", tie.side
        yield f"fem.contact.{k}.onto", tie.onto
    for kind, rows in (("wall", fem.wall), ("boundary", fem.boundary)):
        for k, row in enumerate(rows):
            yield f"fem.{kind}.{k}.side", row.side


def _check_sides(mesh: Mesh, fem: tables.FemTable) -> None:
    """Refuse unknown sides, and pairs that share nodes."""
    for path, name in _sides(fem):
        part, _, side = side_name(name).partition(".")
        known = [key.partition(".")[2] for key in mesh.sides if key.partition(".")[0] == part] + ["all"]
        if side not in known:
            hint = nearest(f"{part}.{side}", [f"{part}.{other}" for other in known])
            near = nearest(side, known).startswith("did")  # all sides of a part begin alike: judge the rest alone
            raise InputError(path, name, f"a side of {part}: {', '.join(known)}", hint if near else "")
    pairs = [(f"fem.contact.{k}.second", row.first, row.second) for k, row in enumerate(fem.contact)]
    pairs += [(f"fem.contact.{k}.onto", row.side, row.onto) for k, row in enumerate(fem.tie)]
    for path, first, second in pairs:
        if np.intersect1d(mesh.side(side_name(first)), mesh.side(side_name(second))).size:
            raise InputError(path, second, f"a side that shares no nodes with {first}")


@contextlib.contextmanager
def fields_of_case(model: Model) -> Iterator[None]:
    """Raise errors of the engine with the field of the case that they stand for."""
    try:
        yield
    except InputErrors as error:
        pairs = [line.partition(":") for line in error.lines]
        raise InputErrors(_field(name, None, model) + mark + rest for name, mark, rest in pairs) from None
    except InputError as error:
        raise error.at(_field(error.field, error.got, model)) from None


def _field(name: str, got: object, model: Model) -> str:
    """Return the path in the case of a field of the engine; what comes from the case already stays as it is."""
    if name in CONTROLS or name == "tie" or name.startswith("section."):
        return f"fem.{name}"
    if name.startswith("rigid "):
        return f"mesh.part.{name.removeprefix('rigid ')}.rigid"
    if name in ("boundary.side", "boundary.direction"):
        refusing = [k for k, b in enumerate(model.boundaries) if isinstance(b, Symmetry | Driven) and b.side == got]
        return f"fem.boundary.{refusing[-1]}.side" if refusing else f"fem.{name}"
    for engine_name, path in _tables(model):
        if name == engine_name or name.startswith(f"{engine_name}."):
            return path + name.removeprefix(engine_name)
    return name


def _tables(model: Model) -> Iterator[tuple[str, str]]:
    """Yield what the engine calls the contacts, walls and ties, with their paths, in the order of the case."""
    for k, contact in enumerate(model.contacts):
        yield f"contact {contact.name}", f"fem.contact.{k}"
        yield f"{contact.first} and {contact.second}", f"fem.contact.{k}"
    for k, wall in enumerate(model.walls):
        for kind in ("wall", "contact"):
            yield f"{kind} {wall.name}", f"fem.wall.{k}"
    for k, tie in enumerate(model.ties):
        yield f"tie of {tie.side}", f"fem.contact.{k}.side"
        yield f"{tie.side} and {tie.onto}", f"fem.contact.{k}"


def vector(table: Any) -> Vector:
    """Return the numbers of a vector's table, 0 where it has none, or where there is no table.

    Examples
    --------
    >>> from strikewave.cases.tables.fem import VelocityTable
    >>> vector(VelocityTable(z="-1 m/s"))
    (0.0, 0.0, -1.0)
    """
    x, y, z = (getattr(table, axis, None) for axis in "xyz")
    return (x.si if x else 0.0, y.si if y else 0.0, z.si if z else 0.0)


def direction(table: Any, path: str) -> Vector:
    """Return the unit vector of a direction."""
    x, y, z = vector(table)
    length = math.hypot(x, y, z)
    if length == 0.0:
        raise InputError(path, "no direction", "a vector that is not 0", 'such as "z", or { x = 1, z = 1 }')
    return (x / length, y / length, z / length)


def _check_apart(mesh: Mesh, path: str, first: str, second: str) -> None:
    """Refuse two parts that stand in each other; surfaces that overlap a little are the contact's affair."""
    for this, that in ((first, second), (second, first)) if first != second else ():
        place = _inside(mesh, this, that)
        if place is not None:
            where = ", ".join(f"{x * 1e3:.4g}" for x in place)
            got = f"{this} inside {that} around ({where}) mm"
            raise InputError(path, got, "parts that stand beside each other", "move one of them: mesh.part.*.at")


def _inside(mesh: Mesh, this: str, that: str) -> Array | None:
    """Return a place in an element of one part, half-way from corner to centre, that lies in another part; or None."""
    from scipy.spatial import cKDTree

    boxes = mesh.points[mesh.nodes_of(that)]
    own = mesh.points[mesh.hexahedra[mesh.elements_of(this)]]
    low, high = boxes.min(axis=0), boxes.max(axis=0)
    own = own[np.all((own.max(axis=1) > low) & (own.min(axis=1) < high), axis=1)]
    if not len(own):
        return None
    places = (0.5 * (own + own.mean(axis=1, keepdims=True))).reshape(-1, 3)
    corners = mesh.points[mesh.hexahedra[mesh.elements_of(that)]]
    _, near = cKDTree(corners.mean(axis=1)).query(places, k=min(NEAREST, len(corners)))
    for column in np.asarray(near).reshape(len(places), -1).T:
        inside = np.flatnonzero(_in_elements(places, corners[column]))
        if inside.size:
            return np.asarray(places[inside[0]])
    return None


def _in_elements(places: Array, corners: Array) -> NDArray[np.bool_]:
    """Return which places lie inside their element, (n, 3) and (n, 8, 3)."""
    centre, depths, mine = corners.mean(axis=1), [], []
    for face in FACES:
        a, b, c, d = (corners[:, node] for node in face)
        normal = np.cross(c - a, d - b)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        middle = 0.25 * (a + b + c + d)
        depths.append(np.einsum("ij,ij->i", middle - centre, normal))
        mine.append(np.einsum("ij,ij->i", middle - places, normal))
    return np.asarray(np.min(mine, axis=0) > INSIDE * np.min(depths, axis=0))


def built_parts(table: tables.MeshTable) -> list[Mesh]:
    """Return the meshes of all parts, in their order; parts of a file come where the first of them stands."""
    meshes, read_files = [], set()
    for part in table.part:
        if not isinstance(part, tables.FilePart):
            mesh = _with_part_path(part, functools.partial(_MAKERS[type(part)], part))
            if part.turn is not None:
                axis = direction(part.turn.axis, f"mesh.part.{part.name}.turn.axis")
                mesh = turned(mesh, axis, part.turn.angle.si)
            meshes.append(moved(mesh, vector(part.at)) if part.at is not None else mesh)
        elif part.file not in read_files:
            read_files.add(part.file)
            rows = [row for row in table.part if isinstance(row, tables.FilePart) and row.file == part.file]
            meshes.append(_from_file(rows))
    return meshes


def _from_file(rows: Sequence[tables.FilePart]) -> Mesh:
    """Return the parts of a mesh in a file under the names of their rows."""
    from strikewave.fem.mesh_files import read_mesh

    first, units = rows[0], {row.unit.si if row.unit else 1.0 for row in rows}
    if len(units) > 1:
        raise InputError(f"mesh.part.{rows[1].name}.unit", sorted(units), f"one unit for all parts of {first.file}")
    try:
        mesh = read_mesh(first.file, units.pop())
    except InputError as error:
        raise error.at(f"mesh.part.{first.name}.file") from None
    only = mesh.names[0] if len(mesh.names) == len(rows) == 1 else ""
    names: dict[str, str] = {}
    for row in rows:
        called = row.part or only or row.name
        if called not in mesh.names or called in names:
            allowed = f"each part of {Path(first.file).name} in one row: {', '.join(mesh.names)}"
            hint = nearest(called, [name for name in mesh.names if name not in names])
            raise InputError(f"mesh.part.{row.name}.part", called, allowed, hint if hint.startswith("did") else "")
        names[called] = row.name
    left = [name for name in mesh.names if name not in names]
    if left:
        hint = f'add [[mesh.part]] with shape = "file", file = "{first.file}", part = "{left[0]}"'
        raise InputError("mesh.part", f"no row for {', '.join(left)}", "a row for each part of the file", hint)
    return renamed(mesh, names)


def estimated_elements(table: tables.MeshTable) -> float:
    """Return about how many elements the parts of our own shapes will have, without making any."""
    shaped = [part for part in table.part if not isinstance(part, tables.FilePart)]
    for part in shaped:
        longest = max((getattr(part, key) for key in LENGTHS if hasattr(part, key)), key=lambda length: length.si)
        most = longest.si * (2.0 if hasattr(part, "radius") else 1.0)
        if part.size.si > most * (1.0 + ROUNDING):
            allowed = f"at most the part's largest length, {most * 1e3:.4g} mm"
            raise InputError(f"mesh.part.{part.name}.size", part.size.typed, allowed)
    return sum(_with_part_path(part, functools.partial(_estimate, part)) for part in shaped)


def exact_volume(part: tables.AnyPart) -> float | None:
    """Return the volume, m^3, of a shape or its sector with its round faces; None for a part of a file."""
    if isinstance(part, tables.FilePart):
        return None
    if isinstance(part, tables.Block):
        whole = part.width.si * part.depth.si * part.height.si
    elif isinstance(part, tables.FramePart):
        opening = (part.width.si - part.left.si - part.right.si) * (part.height.si - part.bottom.si - part.top.si)
        whole = part.depth.si * (part.width.si * part.height.si - opening)
    elif isinstance(part, tables.Cylinder):
        whole = 0.25 * math.pi * part.diameter.si**2 * part.length.si
    elif isinstance(part, tables.Tube):
        open_length = part.length.si - sum(end.si for end in (part.bottom, part.top) if end)
        whole = 0.25 * math.pi * (part.outer_diameter.si**2 * part.length.si - part.inner_diameter.si**2 * open_length)
    elif isinstance(part, tables.HalfCylinder):
        whole = 0.5 * math.pi * part.radius.si**2 * part.length.si
    else:
        half = isinstance(part, tables.HalfSpace) or part.part_of == "lower half"
        whole = (2.0 if half else 4.0) / 3.0 * math.pi * part.radius.si**3
    return SHARE[part.sector] * whole


def _with_part_path(part: tables.AnyPart, make: Callable[[], Any]) -> Any:
    """Make a part; an error of its room gets the path of the part."""
    path = f"mesh.part.{part.name}"
    try:
        return make()
    except InputError as error:
        field = error.field.removeprefix(f"{part.name}.").removeprefix("grading.")
        field = {"coarse": "size", "fine": "finest", "at": "fine_at"}.get(field, field)
        raise error.at(f"{path}.{field}") from None


def _grading(part: tables.ShapedPart, at: float = 0.0) -> Grading:
    """Return the sizes along a line, finest at a place on it, m."""
    if part.finest is None:
        return Grading(part.size.si)
    extent = part.extent.si if part.extent else 0.0
    return Grading(part.size.si, part.finest.si, (at,), extent, part.growth.si if part.growth else GROWTH)


def _lines(part: tables.Block | tables.FramePart) -> list[tuple[float, Grading]]:
    """Return length and sizes along x, y and z of a part that is fine about the middle of its upper or lower side."""
    across = zip(_cuts(part), (part.width.si, part.depth.si), strict=True)
    lines = [(0.5 * length, 0.0) if cut else (length, 0.5 * length) for cut, length in across]
    height = part.height.si
    lines.append((height, height if part.fine_at in ("z+", "top") else 0.0))
    return [(length, _grading(part, at)) for length, at in lines]


def _cuts(part: tables.Block | tables.FramePart) -> tuple[bool, bool]:
    """Return whether a part is cut where x is 0, and where y is 0."""
    return part.sector == "quarter", part.sector != "whole"


def _along(part: tables.Cylinder | tables.Tube) -> Grading:
    return _grading(part, part.length.si if part.fine_at == "top" else 0.0)


def _block(part: tables.Block) -> Mesh:
    (width, x), (depth, y), (height, z) = _lines(part)
    aside, behind = (0.5 * length if cut else 0.0 for cut, length in zip(_cuts(part), (width, depth), strict=True))
    return moved(block(part.name, (width, depth, height), x, y, z), (aside, behind, 0.0))


def _frame(part: tables.FramePart) -> Mesh:
    sizes = (part.width, part.depth, part.height, part.left, part.right, part.bottom, part.top)
    x, y, z = (grading for _, grading in _lines(part))
    return frame(part.name, FrameSize(*(size.si for size in sizes)), x, y, z, part.sector)


def _tube(part: tables.Tube) -> Mesh:
    bottom, top = (end.si if end else 0.0 for end in (part.bottom, part.top))
    size = TubeSize(part.inner_diameter.si, part.outer_diameter.si, part.length.si, bottom, top)
    return tube(part.name, size, _grading(part), _along(part), part.sector)


_MAKERS: dict[type, Callable[[Any], Mesh]] = {
    tables.Block: _block,
    tables.Cylinder: lambda p: cylinder(p.name, p.diameter.si, p.length.si, _grading(p), _along(p), p.sector),
    tables.Tube: _tube,
    tables.HalfCylinder: lambda p: half_cylinder(
        p.name, p.radius.si, p.length.si, _grading(p), Grading(p.size.si), p.sector
    ),
    tables.FramePart: _frame,
    tables.HalfSpace: lambda p: half_space(p.name, p.radius.si, _grading(p), p.sector),
    tables.Ball: lambda p: ball(p.name, p.radius.si, _grading(p), p.sector, p.part_of == "lower half"),
}
"""Function that makes the mesh of each shape."""


def _count(length: float, sizes: Grading) -> int:
    """Return the elements along a line."""
    return len(nodes_between(0.0, length, sizes)) - 1


def _estimate(part: tables.AnyShaped) -> float:
    """Return about how many elements a part will have: a round part has a core, and a ring as deep as its radius."""
    if isinstance(part, tables.Block | tables.FramePart):
        return float(math.prod(_count(length, sizes) for length, sizes in _lines(part)))
    sizes, share = _grading(part), SHARE[part.sector]
    if isinstance(part, tables.Tube):
        inner, outer = 0.5 * part.inner_diameter.si, 0.5 * part.outer_diameter.si
        wall = _count(max(outer - inner, sizes.finest), sizes)
        return share * math.pi * (inner + outer) / sizes.coarse * wall * _count(part.length.si, _along(part))
    radius = 0.5 * part.diameter.si if isinstance(part, tables.Cylinder) else part.radius.si
    # the core is as large as the fine extent, or half the radius where that is more
    core = max(1.0, sizes.extent / sizes.finest, LARGEST_FINE_CORE * radius / sizes.coarse)
    ring = _count(radius, sizes)
    # four rings of core x ring elements around a core of 2 x 2 squares of core elements
    disc = share * 4.0 * core * (core + 2.0 * ring)
    if isinstance(part, tables.Cylinder):
        return disc * _count(part.length.si, _along(part))
    if isinstance(part, tables.HalfCylinder):
        return 0.5 * disc * part.length.si / sizes.coarse
    dome = share * 4.0 * core**2 * (core + 3.0 * ring)
    return dome if isinstance(part, tables.HalfSpace) or part.part_of == "lower half" else 2.0 * dome
