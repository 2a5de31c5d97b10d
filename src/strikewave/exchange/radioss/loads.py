"""What holds, drives, loads and touches the parts of an OpenRadioss deck."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from strikewave.exchange.deck import axes_from, axis_of, driven_nodes, restraints, tie_distance
from strikewave.exchange.radioss.blocks import Groups, Value, block
from strikewave.exchange.radioss.parts import restraint, rigid_lines
from strikewave.exchange.units import UnitSystem
from strikewave.fem.model import Driven, Model, Pressure, RigidWall, SurfaceContact, Tie, TimeCurve
from strikewave.fem.tie import TieState

SHIFTED = 5
"""Inacti: overlaps before the blow stay as they are, without a force."""
FREE_TO_TURN = (False, False, False)
"""Rotations of nodes of solids, which have none to hold."""
SLIDES, RUBS = 0, 2
"""Slide of a wall: without and with friction."""
BY_BOXES = 2
"""Isearch of a tie: by boxes."""


def load_lines(model: Model, system: UnitSystem, groups: Groups, ties: TieState) -> Iterator[str]:
    """Yield the lines of all that holds, drives, loads and touches; groups go to ``groups``."""
    for group_held in restraints(model, ties):
        group = groups.nodes(" and ".join(group_held.sides), group_held.nodes)
        skew = groups.skew(group_held.axes) if group_held.is_local else 0
        directions = [group_held.held, FREE_TO_TURN]
        yield from restraint(groups.next("restraint"), " and ".join(group_held.sides), directions, skew, group)
    for number, contact in enumerate(model.contacts, start=1):
        yield from _contact(number, contact, groups)
    for number, tie in enumerate(model.ties, start=len(model.contacts) + 1):
        yield from _tie(number, tie, system, groups)
    for number, wall in enumerate(model.walls, start=1):
        yield from _wall(number, wall, system, groups, ties)
    for boundary in model.boundaries:
        if isinstance(boundary, Driven):
            yield from _driven(model, boundary, system, groups, ties)
        elif isinstance(boundary, Pressure):
            yield from _pressed(model, boundary, system, groups)
    yield from _gravity(model, system, groups)
    yield from _velocities(model, system, groups)
    yield from rigid_lines(model, system, groups)


def _contact(number: int, contact: SurfaceContact, groups: Groups) -> list[str]:
    """Return a contact of two surfaces of solids, which have no gap: nodes of each are checked against the other."""
    first, second = groups.surface(contact.first), groups.surface(contact.second)
    return block(
        f"INTER/TYPE24/{number}",
        contact.name,
        [first, second, 0, None, None, 0, None, 0, None, 0],
        [0, None, None, 0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0, 0, 0.0, 0.0],
        [0.0, float(contact.friction), None, None, 0.0, 0.0],
        ["000", None, None, SHIFTED, 0.0, None, None, 0.0],
        [0, 0, 0.0, None, 0, 0.0, None, 0],
    )


def _tie(number: int, tie: Tie, system: UnitSystem, groups: Groups) -> list[str]:
    nodes = groups.nodes(tie.side, np.unique(groups.mesh.side(tie.side)))
    reach = tie_distance(tie, groups.mesh) * system.distance
    title = f"{tie.side} on {tie.onto}"
    return block(
        f"INTER/TYPE2/{number}", title, [nodes, groups.surface(tie.onto), 0, 0, 0, BY_BOXES, 0, None, float(reach)]
    )


def _wall(number: int, wall: RigidWall, system: UnitSystem, groups: Groups, ties: TieState) -> list[str]:
    """Return a wall; its normal runs from its point to a second one, a unit of length away."""
    nodes = np.setdiff1d(np.unique(groups.mesh.side(wall.side)), ties.nodes).astype(np.int32)
    point = system.distance * np.array(wall.point)
    head = point + np.array(wall.normal) / np.linalg.norm(wall.normal)
    return block(
        f"RWALL/PLANE/{number}",
        wall.name,
        [0, RUBS if wall.friction else SLIDES, groups.nodes(wall.name, nodes), 0],
        [0.0, float(wall.friction), 0.0, 0.0, 0],
        point.tolist(),
        head.tolist(),
    )


def _driven(model: Model, boundary: Driven, system: UnitSystem, groups: Groups, ties: TieState) -> list[str]:
    """Return a driven side, along an axis or the first axis of a skew."""
    nodes = groups.nodes(f"{boundary.side} driven", driven_nodes(model, boundary, ties))
    scale = system.duration, system.velocity
    function = groups.function(f"velocity of {boundary.side}", boundary.velocity, scale, model.controls.duration)
    axis = axis_of(boundary.direction)
    skew = 0 if axis else groups.skew(axes_from(boundary.direction))
    way: list[Value] = [function, "XYZ"[axis[0]] if axis else "X", skew, 0, nodes, 0, 0]
    number = groups.next("driven")
    return block(f"IMPVEL/{number}", f"{boundary.side} driven", way, [1.0, axis[1] if axis else 1.0, 0.0, 0.0])


def _pressed(model: Model, boundary: Pressure, system: UnitSystem, groups: Groups) -> list[str]:
    """Return a pressure; OpenRadioss takes one along the normal, which is outward, as positive."""
    scale = system.duration, system.stress
    function = groups.function(f"pressure on {boundary.side}", boundary.pressure, scale, model.controls.duration)
    card: list[Value] = [groups.surface(boundary.side), function, 0, 0, 0, 0, 1.0, -1.0]
    return block(f"PLOAD/{groups.next('pressure')}", boundary.side, card)


def _gravity(model: Model, system: UnitSystem, groups: Groups) -> Iterator[str]:
    if not any(model.gravity):
        return
    constant = TimeCurve((0.0,), (1.0,))
    function = groups.function("gravity", constant, (system.duration, 1.0), model.controls.duration)
    nodes = groups.nodes("all nodes", np.arange(len(model.mesh.points) + len(model.rigid), dtype=np.int32))
    for number, (axis, value) in enumerate(zip("XYZ", model.gravity, strict=True), start=1):
        if value:
            card: list[Value] = [function, axis, 0, 0, nodes, None, 1.0, float(value) * system.acceleration]
            yield from block(f"GRAV/{number}", f"gravity along {axis}", card)


def _velocities(model: Model, system: UnitSystem, groups: Groups) -> Iterator[str]:
    rigid = {body.part for body in model.rigid}
    for name in model.mesh.names:
        velocity = np.array(model.velocity.get(name, (0.0, 0.0, 0.0)), float) * system.velocity
        if velocity.any() and name not in rigid:
            nodes = groups.nodes(f"nodes of {name}", model.mesh.nodes_of(name))
            yield from block(f"INIVEL/TRA/{groups.next('velocity')}", name, [*velocity.tolist(), nodes, 0])
