"""What holds, drives, loads and touches the parts of an LS-DYNA deck."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from strikewave.exchange.deck import axis_of, driven_nodes, plain, restraints, tie_distance
from strikewave.exchange.ls_dyna.cards import Sets, Value, keyword
from strikewave.exchange.units import UnitSystem
from strikewave.fem.model import Driven, Model, NonReflecting, Pressure, RigidWall, SurfaceContact, Tie, TimeCurve
from strikewave.fem.tie import TieState

SEGMENTS, NODES = 0, 4
"""SURFATYP: a set of segments, a set of nodes."""
SOFT = 1
"""Contact stiffness from nodal masses and the time step too, as that of strikewave is."""
TRACKED = 1
"""IGNORE: overlaps before the blow stay as they are, without a force."""
CONSTANT = TimeCurve((0.0,), (1.0,))
"""A load that does not change: gravity."""
NO_DEATH, NO_END = 1e20, 1e28
"""Time at which a contact or wall, and a prescribed motion, ends: LS-DYNA's own defaults for never."""
DIGITS = 5
"""Digits of what stands in ten columns beside a title: friction, and the reach of a tie."""
STICKS = 1.0
"""FRIC of a wall from which on nodes do not slide at all."""


def load_lines(model: Model, system: UnitSystem, sets: Sets, ties: TieState) -> Iterator[str]:
    """Yield the lines of all that holds, drives, loads and touches; their sets go to ``sets``."""
    yield from _held(model, sets, ties)
    for number, contact in enumerate(model.contacts, start=1):
        yield from _contact(number, contact, sets)
    for number, tie in enumerate(model.ties, start=len(model.contacts) + 1):
        yield from _tie(number, tie, system, sets)
    for wall in model.walls:
        yield from _wall(wall, system, sets, ties)
    for boundary in model.boundaries:
        if isinstance(boundary, Driven):
            yield from _driven(model, boundary, system, sets, ties)
        elif isinstance(boundary, Pressure):
            yield from _pressed(model, boundary, system, sets)
        elif isinstance(boundary, NonReflecting):
            yield from keyword("BOUNDARY_NON_REFLECTING", [sets.segments(boundary.side), 0.0, 0.0])
    yield from _gravity(model, system, sets)
    yield from _velocities(model, system)


def _held(model: Model, sets: Sets, ties: TieState) -> Iterator[str]:
    for restraint in restraints(model, ties):
        number = sets.nodes(" and ".join(restraint.sides), restraint.nodes)
        axes = sets.axes(restraint.axes) if restraint.is_local else 0
        yield from keyword("BOUNDARY_SPC_SET", [number, axes, *(int(is_held) for is_held in restraint.held), 0, 0, 0])


def _contact(number: int, contact: SurfaceContact, sets: Sets) -> list[str]:
    """Return a contact of two sides, each checked against the other; faces of solids have no thickness."""
    first, second = sets.segments(contact.first), sets.segments(contact.second)
    friction = float(f"{contact.friction:.{DIGITS}g}")
    return keyword(
        "CONTACT_AUTOMATIC_SURFACE_TO_SURFACE_ID",
        f"{number:10d}{plain(contact.name, 70)}",
        [first, second, SEGMENTS, SEGMENTS, 0, 0, 1, 1],
        [friction, friction, 0.0, 0.0, 0.0, 0, 0.0, NO_DEATH],
        [1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0],
        [SOFT],
        [0.0],
        [1, TRACKED],
    )


def _tie(number: int, tie: Tie, system: UnitSystem, sets: Sets) -> list[str]:
    """Return a tie; nodes within 0.6 times the sum of both thicknesses are tied, which below 0 move nothing."""
    nodes = sets.nodes(tie.side, np.unique(sets.mesh.side(tie.side)))
    reach = -float(f"{tie_distance(tie, sets.mesh) * system.distance:.{DIGITS}g}")
    return keyword(
        "CONTACT_TIED_NODES_TO_SURFACE_CONSTRAINED_OFFSET_ID",
        f"{number:10d}{plain(f'{tie.side} on {tie.onto}', 70)}",
        [nodes, sets.segments(tie.onto), NODES, SEGMENTS, 0, 0, 1, 1],
        [0.0, 0.0, 0.0, 0.0, 0.0, 0, 0.0, NO_DEATH],
        [1.0, 1.0, reach, reach, 1.0, 1.0, 1.0, 1.0],
    )


def _wall(wall: RigidWall, system: UnitSystem, sets: Sets, ties: TieState) -> list[str]:
    """Return a wall; its normal runs from tail to head, a unit of length long."""
    nodes = np.setdiff1d(np.unique(sets.mesh.side(wall.side)), ties.nodes).astype(np.int32)
    tail = system.distance * np.array(wall.point)
    head = tail + np.array(wall.normal) / np.linalg.norm(wall.normal)
    friction = min(float(wall.friction), STICKS)
    return keyword(
        "RIGIDWALL_PLANAR",
        [sets.nodes(wall.name, nodes), 0, 0, 0.0, 0.0, NO_DEATH, 1.0],
        [*tail.tolist(), *head.tolist(), friction, 0.0],
    )


def _driven(model: Model, boundary: Driven, system: UnitSystem, sets: Sets, ties: TieState) -> list[str]:
    """Return a driven side: along an axis (DOF 1 to 3), or a vector and free across it (DOF 4)."""
    nodes = sets.nodes(f"{boundary.side} driven", driven_nodes(model, boundary, ties))
    scale = system.duration, system.velocity
    curve = sets.curve(f"velocity of {boundary.side}", boundary.velocity, scale, model.controls.duration)
    axis = axis_of(boundary.direction)
    if axis is None:
        way: list[Value] = [4, 0, curve, 1.0, sets.vector(boundary.direction)]
    else:
        way = [axis[0] + 1, 0, curve, axis[1], 0]
    return keyword("BOUNDARY_PRESCRIBED_MOTION_SET", [nodes, *way, NO_END, 0.0])


def _pressed(model: Model, boundary: Pressure, system: UnitSystem, sets: Sets) -> list[str]:
    scale = system.duration, system.stress
    curve = sets.curve(f"pressure on {boundary.side}", boundary.pressure, scale, model.controls.duration)
    return keyword("LOAD_SEGMENT_SET", [sets.segments(boundary.side), curve, 1.0, 0.0])


def _gravity(model: Model, system: UnitSystem, sets: Sets) -> Iterator[str]:
    """Yield gravity; LS-DYNA takes the acceleration of the base, which is opposite to it."""
    if not any(model.gravity):
        return
    curve = sets.curve("gravity", CONSTANT, (system.duration, 1.0), model.controls.duration)
    for axis, value in zip("XYZ", model.gravity, strict=True):
        if value:
            yield from keyword(f"LOAD_BODY_{axis}", [curve, -float(value) * system.acceleration])


def _velocities(model: Model, system: UnitSystem) -> Iterator[str]:
    rigid = {body.part: body for body in model.rigid}
    for number, name in enumerate(model.mesh.names, start=1):
        velocity = np.array(model.velocity.get(name, (0.0, 0.0, 0.0)), float) * system.velocity
        if name in rigid:
            velocity = np.where(rigid[name].translations, velocity, 0.0)
            if velocity.any():
                yield from keyword("INITIAL_VELOCITY_RIGID_BODY", [number, *velocity.tolist(), 0.0, 0.0, 0.0])
        elif velocity.any():
            by_part: list[Value] = [number, 2, 0.0, *velocity.tolist(), 0, 0]
            yield from keyword("INITIAL_VELOCITY_GENERATION", by_part, [0.0] * 6 + [0, 0])
