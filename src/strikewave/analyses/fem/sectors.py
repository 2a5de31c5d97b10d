"""Sectors of a finite element model: how much of each body is meshed, what holds its cuts, and the run of whole bodies.

Sums over a body (mass, force, impulse, energy) are so many times those of its sector as sectors make the body; vectors
lose what lies across a plane of symmetry, which cancels with that of the mirror image. `of_whole_bodies` does both
once, where a result is made: all that is shown of a run is taken from what it returns.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from strikewave.cases.case import Case
from strikewave.fem.boundary import unit
from strikewave.fem.model import Fixed, Guided, Model, NonReflecting, Symmetry
from strikewave.fem.recorder import assembly
from strikewave.fem.run import FemRun, PartHistory, PartMeasure, SectionHistory, part_measure
from strikewave.fem.snapshots import outward

Array = NDArray[np.float64]

ACROSS = 1e-6  # files of meshes keep six digits or more
"""Sine of the angle below which a direction lies in a plane."""
_TENSOR = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
"""Components of a stress, xx yy zz xy yz zx, at their places in a tensor."""
_COMPONENTS = np.array([0, 4, 8, 1, 5, 2])
"""Places of the components in a tensor, row by row."""


@dataclass(frozen=True)
class Sector:
    """The meshed part of a body; ``pieces`` of it, 1, 2 or 4, make the whole."""

    pieces: int = 1
    sides: tuple[str, ...] = ()
    """Sides in the planes of symmetry."""
    normals: tuple[tuple[float, ...], ...] = ()
    """Outward unit normals of those sides."""

    @property
    def free(self) -> Array:
        """Projector of a vector onto the planes of symmetry, (3, 3): a component across them cancels in the whole."""
        projector = np.eye(3)
        for normal in self.normals:
            projector = projector - np.outer(normal, normal)
        return projector

    def whole(self, summed: Array) -> Array:
        """Return the vectors (instants, 3) of the whole body from those summed over its sector."""
        return np.asarray(self.pieces * (summed @ self.free)) if self.pieces > 1 else summed


def sectors(case: Case | None, model: Model) -> dict[str, Sector]:
    """Return the sector of each part and group; a part of a file, or a group of unlike sectors, counts as whole."""
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
        sector_of[name] = _shared(sector_of, parts)
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


def of_whole_bodies(model: Model, run: FemRun, sector_of: dict[str, Sector]) -> FemRun:
    """Return the histories of whole bodies from those of their sectors; the run itself where all are whole.

    A contact of sectors that do not match stays as it is modelled; so do energies, momentum and added mass of
    everything where the parts are not all the same sector (`unlike_sectors`).
    """
    if all(sector_of[name].pieces == 1 for name in run.parts):
        return run
    shared = _shared(sector_of, list(run.parts))
    touching = {name: _shared(sector_of, [_part(side) for side in sides]) for name, sides in model.touching.items()}
    parts = {}
    for name, part in run.parts.items():
        moved = (history @ sector_of[name].free for history in (part.velocity, part.acceleration, part.displacement))
        parts[name] = PartHistory(sector_of[name].pieces * part.mass, *moved)
    cuts = {section.name: section for section in model.sections}
    sections = {
        name: _whole_section(section, sector_of[cuts[name].part], unit(cuts[name].normal, "normal"))
        for name, section in run.sections.items()
    }
    rest = run.rest and replace(
        run.rest,
        plastic_energy=shared.pieces * run.rest.plastic_energy,
        plastic_before=shared.pieces * run.rest.plastic_before,
    )
    return replace(
        run,
        force={name: touching[name].whole(force) for name, force in run.force.items()},
        impulse={name: touching[name].whole(impulse) for name, impulse in run.impulse.items()},
        energy={name: shared.pieces * values for name, values in run.energy.items()},
        initial_energy=shared.pieces * run.initial_energy,
        parts=parts,
        groups={name: assembly(parts, model.groups[name]) for name in run.groups},
        sections=sections,
        momentum=shared.whole(run.momentum),
        impulse_given=shared.whole(run.impulse_given),
        added_mass=shared.pieces * run.added_mass,
        # the share of a surface that is pressed is that of the whole; the number of faces is not
        pressed={name: pressed * np.array([1.0, touching[name].pieces]) for name, pressed in run.pressed.items()},
        rest=rest,
        plastic_work={name: sector_of[name].pieces * work for name, work in run.plastic_work.items()},
    )


def unlike_sectors(model: Model, sector_of: dict[str, Sector]) -> list[str]:
    """Return the parts that are sectors, where the parts of a model are not all the same sector."""
    shared = _shared(sector_of, list(model.mesh.names))
    return [] if shared.pieces > 1 else [name for name in model.mesh.names if sector_of[name].pieces > 1]


def blow_of_bodies(model: Model, run: FemRun) -> dict[str, PartMeasure]:
    """Return the blow of each body in a run of whole bodies: groups, then free parts, then held ones, heaviest first.

    Held are parts with a fixed or non-reflecting side; bodies at rest come last.
    """
    held_parts = {_part(b.side) for b in model.boundaries if isinstance(b, Fixed | NonReflecting)}
    bodies = {name: part_measure(run, name) for name in (*run.groups, *run.parts)}

    def place(name: str) -> tuple[bool, bool, bool, float]:
        body, part = bodies[name], name not in run.groups
        return body.velocity_change == 0.0, part, part and name in held_parts, -body.mass

    return {name: bodies[name] for name in sorted(bodies, key=place)}


def _part(side: str) -> str:
    return side.partition(".")[0]


def _shared(sector_of: dict[str, Sector], names: Sequence[str]) -> Sector:
    """Return the sector that all of some parts are; the whole where they are not the same."""
    first, *others = (sector_of[name] for name in names)
    return first if all(_alike(first, other) for other in others) else Sector()


def _whole_section(section: SectionHistory, sector: Sector, normal: Array) -> SectionHistory:
    """Return the means over a section of the whole body: over its mirror images at the planes that it crosses squarely.

    A plane along the cut itself has its mirror image elsewhere, which is another section.
    """
    stress, velocity, acceleration = section.stress[:, _TENSOR], section.velocity, section.acceleration
    for cut in sector.normals:
        if abs(float(normal @ cut)) < ACROSS:
            mirror = np.eye(3) - 2.0 * np.outer(cut, cut)
            stress = 0.5 * (stress + mirror @ stress @ mirror)
            velocity, acceleration = (0.5 * (history + history @ mirror) for history in (velocity, acceleration))
    return SectionHistory(section.elements, stress.reshape(-1, 9)[:, _COMPONENTS], velocity, acceleration)


def _alike(first: Sector, second: Sector) -> bool:
    """Return whether two sectors were cut along parallel planes."""
    return first.pieces == second.pieces and all(
        any(float(np.linalg.norm(np.cross(normal, twin))) < ACROSS for twin in second.normals)
        for normal in first.normals
    )


def _in_plane(ways: Array, normal: tuple[float, ...]) -> bool:
    """Return whether all ways, unit vectors, lie in the plane of a normal."""
    return bool(np.all(np.abs(ways @ np.array(normal)) < ACROSS))
