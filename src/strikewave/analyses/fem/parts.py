"""[mesh] in, meshes of parts out: each by the function of its shape, turned and moved to its place."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from strikewave.analyses.fem.vectors import direction, vector
from strikewave.base.errors import InputError, nearest
from strikewave.cases.tables.mesh import (
    AnyPart,
    AnyShaped,
    Ball,
    Block,
    Cylinder,
    FilePart,
    FramePart,
    HalfCylinder,
    HalfSpace,
    MeshTable,
    ShapedPart,
    Tube,
)
from strikewave.fem.grading import GROWTH, Grading, nodes_between
from strikewave.fem.mesh import Mesh
from strikewave.fem.round_shapes import TubeSize, ball, cylinder, half_cylinder, half_space, tube
from strikewave.fem.shapes import FrameSize, block, frame, moved, renamed, turned

LARGEST = 3_000_000
"""Elements of a model: about 3 GB, what a usual machine has to spare."""
ROUNDING = 1e-9
"""Share by which a size may exceed its part, by rounding of units."""
LARGEST_FINE_CORE = 0.5
"""Share of a radius that a core takes at most, as `strikewave.fem.sections.CORE`."""
SHARE = {"whole": 1.0, "half": 0.5, "quarter": 0.25}
"""Of a body that a sector holds."""
LENGTHS = ("width", "depth", "height", "length", "diameter", "outer_diameter", "radius")
"""Fields of a shape that give its size: its elements cannot be larger."""


def built_parts(table: MeshTable) -> list[Mesh]:
    """Return the meshes of all parts, in their order; those of a file come where the first of them stands.

    Raises
    ------
    InputError
        If a shape is impossible, or a file lacks a part that is named.
    """
    meshes, read_files = [], set()
    for part in table.part:
        if not isinstance(part, FilePart):
            meshes.append(_placed(part, _named(part, functools.partial(_MAKERS[type(part)], part))))
        elif part.file not in read_files:
            read_files.add(part.file)
            rows = [row for row in table.part if isinstance(row, FilePart) and row.file == part.file]
            meshes.append(_from_file(rows))
    return meshes


def _from_file(rows: Sequence[FilePart]) -> Mesh:
    """Return the parts of a mesh in a file under the names of their rows.

    Raises
    ------
    InputError
        If a part of the file has no row or two, a row no part, or the rows differ in their unit.
    """
    from strikewave.fem.imported import read_mesh

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


def estimated_elements(table: MeshTable) -> float:
    """Return about how many elements the parts of our own shapes will have, without making any.

    Raises
    ------
    InputError
        If elements are larger than their part, or a line of them would be too long.
    """
    shaped = [part for part in table.part if not isinstance(part, FilePart)]
    for part in shaped:
        longest = max((getattr(part, key) for key in LENGTHS if hasattr(part, key)), key=lambda length: length.si)
        most = longest.si * (2.0 if hasattr(part, "radius") else 1.0)
        if part.size.si > most * (1.0 + ROUNDING):
            allowed = f"at most the part's largest length, {most * 1e3:.4g} mm"
            raise InputError(f"mesh.part.{part.name}.size", part.size.typed, allowed)
    return sum(_named(part, functools.partial(_estimate, part)) for part in shaped)


def exact_volume(part: AnyPart) -> float | None:
    """Return the volume of a shape, or its sector, before flat faces are put in place of round ones, m^3.

    A part of a file has none to compare with.
    """
    if isinstance(part, FilePart):
        return None
    if isinstance(part, Block):
        whole = part.width.si * part.depth.si * part.height.si
    elif isinstance(part, FramePart):
        opening = (part.width.si - part.left.si - part.right.si) * (part.height.si - part.bottom.si - part.top.si)
        whole = part.depth.si * (part.width.si * part.height.si - opening)
    elif isinstance(part, Cylinder):
        whole = 0.25 * math.pi * part.diameter.si**2 * part.length.si
    elif isinstance(part, Tube):
        open_length = part.length.si - sum(end.si for end in (part.bottom, part.top) if end)
        whole = 0.25 * math.pi * (part.outer_diameter.si**2 * part.length.si - part.inner_diameter.si**2 * open_length)
    elif isinstance(part, HalfCylinder):
        whole = 0.5 * math.pi * part.radius.si**2 * part.length.si
    else:
        half = isinstance(part, HalfSpace) or part.part_of == "lower half"
        whole = (2.0 if half else 4.0) / 3.0 * math.pi * part.radius.si**3
    return SHARE[part.sector] * whole


def _named(part: AnyPart, make: Callable[[], Any]) -> Any:
    """Make a part; what its room refuses is named by the path of the part."""
    path = f"mesh.part.{part.name}"
    try:
        return make()
    except InputError as error:
        field = error.field.removeprefix(f"{part.name}.").removeprefix("grading.")
        field = {"coarse": "size", "fine": "finest", "at": "fine_at"}.get(field, field)
        raise error.at(f"{path}.{field}") from None


def _placed(part: ShapedPart, mesh: Mesh) -> Mesh:
    """Return the mesh of a part turned, then moved."""
    if part.turn is not None:
        axis = direction(part.turn.axis, f"mesh.part.{part.name}.turn.axis")
        mesh = turned(mesh, axis, part.turn.angle.si)
    return moved(mesh, vector(part.at)) if part.at is not None else mesh


def _grading(part: ShapedPart, at: float = 0.0) -> Grading:
    """Return the sizes along a line, finest at a place on it, m."""
    if part.finest is None:
        return Grading(part.size.si)
    extent = part.extent.si if part.extent else 0.0
    return Grading(part.size.si, part.finest.si, (at,), extent, part.growth.si if part.growth else GROWTH)


def _lines(part: Block | FramePart) -> list[tuple[float, Grading]]:
    """Return length and sizes along x, y and z of what is fine about the middle of its upper or lower side."""
    across = zip(_cuts(part), (part.width.si, part.depth.si), strict=True)
    lines = [(0.5 * length, 0.0) if cut else (length, 0.5 * length) for cut, length in across]
    height = part.height.si
    lines.append((height, height if part.fine_at in ("z+", "top") else 0.0))
    return [(length, _grading(part, at)) for length, at in lines]


def _cuts(part: Block | FramePart) -> tuple[bool, bool]:
    """Return whether a part is cut where x is 0, and where y is 0."""
    return part.sector == "quarter", part.sector != "whole"


def _along(part: Cylinder | Tube) -> Grading:
    return _grading(part, part.length.si if part.fine_at == "top" else 0.0)


def _block(part: Block) -> Mesh:
    (width, x), (depth, y), (height, z) = _lines(part)
    aside, behind = (0.5 * length if cut else 0.0 for cut, length in zip(_cuts(part), (width, depth), strict=True))
    return moved(block(part.name, (width, depth, height), x, y, z), (aside, behind, 0.0))


def _frame(part: FramePart) -> Mesh:
    sizes = (part.width, part.depth, part.height, part.left, part.right, part.bottom, part.top)
    x, y, z = (grading for _, grading in _lines(part))
    return frame(part.name, FrameSize(*(size.si for size in sizes)), x, y, z, part.sector)


def _cylinder(part: Cylinder) -> Mesh:
    return cylinder(part.name, part.diameter.si, part.length.si, _grading(part), _along(part), part.sector)


def _tube(part: Tube) -> Mesh:
    bottom, top = (end.si if end else 0.0 for end in (part.bottom, part.top))
    size = TubeSize(part.inner_diameter.si, part.outer_diameter.si, part.length.si, bottom, top)
    return tube(part.name, size, _grading(part), _along(part), part.sector)


def _half_cylinder(part: HalfCylinder) -> Mesh:
    along = Grading(part.size.si)
    return half_cylinder(part.name, part.radius.si, part.length.si, _grading(part), along, part.sector)


def _half_space(part: HalfSpace) -> Mesh:
    return half_space(part.name, part.radius.si, _grading(part), part.sector)


def _ball(part: Ball) -> Mesh:
    return ball(part.name, part.radius.si, _grading(part), part.sector, part.part_of == "lower half")


_MAKERS: dict[type, Callable[[Any], Mesh]] = {
    Block: _block,
    Cylinder: _cylinder,
    Tube: _tube,
    HalfCylinder: _half_cylinder,
    FramePart: _frame,
    HalfSpace: _half_space,
    Ball: _ball,
}
"""What makes the mesh of each shape."""


def _count(length: float, sizes: Grading) -> int:
    """Return the elements along a line."""
    return len(nodes_between(0.0, length, sizes)) - 1


def _estimate(part: AnyShaped) -> float:
    """Return about how many elements a part will have.

    A block's lines are counted; a round part has a core and a ring of as many elements as its radius takes.
    """
    if isinstance(part, Block | FramePart):
        return float(math.prod(_count(length, sizes) for length, sizes in _lines(part)))
    sizes, share = _grading(part), SHARE[part.sector]
    if isinstance(part, Tube):
        inner, outer = 0.5 * part.inner_diameter.si, 0.5 * part.outer_diameter.si
        wall = _count(max(outer - inner, sizes.finest), sizes)
        return share * math.pi * (inner + outer) / sizes.coarse * wall * _count(part.length.si, _along(part))
    radius = 0.5 * part.diameter.si if isinstance(part, Cylinder) else part.radius.si
    core = max(1.0, sizes.extent / sizes.finest, LARGEST_FINE_CORE * radius / sizes.coarse)
    ring = _count(radius, sizes)
    disc = share * 4.0 * core * (core + 2.0 * ring)
    if isinstance(part, Cylinder):
        return disc * _count(part.length.si, _along(part))
    if isinstance(part, HalfCylinder):
        return 0.5 * disc * part.length.si / sizes.coarse
    dome = share * 4.0 * core**2 * (core + 3.0 * ring)
    return dome if isinstance(part, HalfSpace) or part.part_of == "lower half" else 2.0 * dome
