"""Sectors of a finite element model: how much of each body is there, along which planes it was cut, what holds them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strikewave.cases.case import Case
from strikewave.fem.boundary import unit
from strikewave.fem.measures import PartMeasure, interval_means, part_measure
from strikewave.fem.model import Fixed, Guided, Model, NonReflecting, Symmetry
from strikewave.fem.run import FemRun
from strikewave.fem.skin import outward

Array = NDArray[np.float64]

ACROSS = 1e-6
"""Sine of the angle below which a way lies in a plane: files of meshes keep six digits or more."""


@dataclass(frozen=True)
class Sector:
    """What is there of a body.

    Attributes
    ----------
    pieces : int
        So many of these make the whole body: 1, 2 or 4.
    sides : tuple of str
        Its sides in the planes of symmetry.
    normals : tuple of tuple of float
        Outward unit normals of those sides.
    """

    pieces: int = 1
    sides: tuple[str, ...] = ()
    normals: tuple[tuple[float, ...], ...] = ()

    @property
    def free(self) -> Array:
        """What projects a vector onto its planes of symmetry, (3, 3): what lies across them cancels in the whole."""
        projector = np.eye(3)
        for normal in self.normals:
            projector = projector - np.outer(normal, normal)
        return projector


@dataclass(frozen=True)
class WholeForce:
    """A contact of whole bodies, from that of their sectors: largest mean force, N, and impulse, N s."""

    peak: float
    impulse: float


def sectors(case: Case | None, model: Model) -> dict[str, Sector]:
    """Return what is there of each part and group; a part of a file, or a group of unlike ones, counts as whole.

    Examples
    --------
    >>> from strikewave import load_case
    >>> from strikewave.analyses.fem.build import build_model
    >>> case = load_case("hertz-ball-fem")
    >>> found = sectors(case, build_model(case))["ball"]
    >>> found.pieces, found.sides
    (4, ('ball.x-', 'ball.y-'))
    """
    mesh = model.mesh
    sector_of = {name: Sector() for name in mesh.names}
    for part in case.mesh.part if case is not None and case.mesh is not None else ():
        kind = getattr(part, "sector", "whole")
        if kind != "whole":
            sides = [name for axis in "xy" if (name := f"{part.name}.{axis}-") in mesh.sides]
            sides = sides if kind == "quarter" else sides[-1:]
            normals = tuple(tuple(outward(mesh, side).tolist()) for side in sides)
            sector_of[part.name] = Sector(2 ** len(sides), tuple(sides), normals)
    for name, parts in model.groups.items():
        first, *others = (sector_of[part] for part in parts)
        sector_of[name] = first if all(_alike(first, other) for other in others) else Sector()
    return sector_of


def open_cuts(model: Model, sector_of: dict[str, Sector]) -> Iterator[str]:
    """Yield the sides of sectors across whose planes of symmetry nodes may move."""
    held_sides = {b.side for b in model.boundaries if isinstance(b, Symmetry | Fixed)}
    guided = {b.side: unit(b.axis, "axis") for b in model.boundaries if isinstance(b, Guided)}
    rigid = {body.part: body for body in model.rigid}
    for part in model.mesh.names:
        sector = sector_of[part]
        for side, normal in zip(sector.sides, sector.normals, strict=True):
            along = guided.get(side, guided.get(part))
            if part in rigid:
                is_held = not any(rigid[part].rotations) and _in_plane(np.diag(rigid[part].translations), normal)
            else:
                is_held = side in held_sides or (along is not None and _in_plane(along, normal))
            if not is_held:
                yield side


def whole_forces(model: Model, run: FemRun, sector_of: dict[str, Sector]) -> dict[str, WholeForce | None]:
    """Return `whole_force` of each contact and wall."""
    return {name: whole_force(run, sector_of, name, sides) for name, sides in model.touching.items()}


def whole_force(run: FemRun, sector_of: dict[str, Sector], name: str, sides: tuple[str, ...]) -> WholeForce | None:
    """Return the contact of the whole bodies; None where they are no sectors, or not the same.

    Forces across a plane of symmetry cancel with those on its mirror image; the others add up.
    """
    impulse = whole_impulse(run, sector_of, name, sides)
    if impulse is None:
        return None
    mean = np.linalg.norm(interval_means(impulse, run.time), axis=1)
    return WholeForce(float(mean.max(initial=0.0)), float(np.linalg.norm(impulse[-1])))


def whole_impulse(run: FemRun, sector_of: dict[str, Sector], name: str, sides: tuple[str, ...]) -> Array | None:
    """Return the impulse of a contact of the whole bodies, N s, (instants, 3); None as of `whole_force`."""
    both = [sector_of[side.partition(".")[0]] for side in sides]
    if both[0].pieces == 1 or any(not _alike(both[0], other) for other in both):
        return None
    return np.asarray(both[0].pieces * (run.impulse[name] @ both[0].free))


def blow_of_bodies(model: Model, run: FemRun, sector_of: dict[str, Sector]) -> dict[str, PartMeasure]:
    """Return the blow that each body took: groups, then parts that nothing holds, then the others, the heaviest first.

    Held are parts with a fixed or non-reflecting side. What does not move comes last.
    """
    held_parts = {b.side.partition(".")[0] for b in model.boundaries if isinstance(b, Fixed | NonReflecting)}
    bodies = {name: part_measure(run, name, sector_of[name].free) for name in (*run.groups, *run.parts)}

    def place(name: str) -> tuple[bool, bool, bool, float]:
        body, part = bodies[name], name not in run.groups
        return body.velocity_change == 0.0, part, part and name in held_parts, -body.mass * sector_of[name].pieces

    return {name: bodies[name] for name in sorted(bodies, key=place)}


def _alike(first: Sector, second: Sector) -> bool:
    """Tell whether two sectors were cut along the same planes, but for where these stand."""
    return first.pieces == second.pieces and all(
        any(float(np.linalg.norm(np.cross(normal, twin))) < ACROSS for twin in second.normals)
        for normal in first.normals
    )


def _in_plane(ways: Array, normal: tuple[float, ...]) -> bool:
    """Tell whether all ways, unit vectors, lie in the plane of a normal."""
    return bool(np.all(np.abs(ways @ np.array(normal)) < ACROSS))
