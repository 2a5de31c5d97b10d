"""An OpenRadioss deck of a model: starter ``_0000.rad``, engine ``_0001.rad``, in the format of 2023.

Sources: Altair Radioss Reference Guide 2022; the definitions of the cards that come along with OpenRadioss; its source,
in which /PLOAD pulls along the normal of a segment.
"""

from __future__ import annotations

import itertools
import math
import textwrap
from collections.abc import Iterator, Sequence
from typing import ClassVar

import numpy as np

from strikewave.exchange.deck import (
    Deck,
    DeckSets,
    Heading,
    axes_from,
    axis_of,
    checked,
    has_one_point,
    head_lines,
    left_out_of_all,
    mesh_columns,
    or_smallest,
    plain,
    real,
    restraints,
    rows,
    tie_distance,
    walls_at_rigid_nodes,
)
from strikewave.exchange.units import UnitSystem
from strikewave.fem.bodies import RigidBody
from strikewave.fem.hexahedron import element_masses, nodal_sums
from strikewave.fem.model import Driven, Model, NonReflecting, Pressure, RigidWall, SurfaceContact, Tie, TimeCurve
from strikewave.fem.recorder import section_elements
from strikewave.fem.solids import AnySolid, Bilinear, JohnsonCook

Value = int | float | str | None


def block(name: str, title: str | None, *cards: Sequence[Value]) -> list[str]:
    """Return the lines of a block; whole numbers and words have ten columns, real ones twenty, None ten blank ones.

    Examples
    --------
    >>> block("MAT/ELAST/1", "steel", [7.82e-9], [211000.0, 0.288])
    ['/MAT/ELAST/1', 'steel', '             7.82e-9', '            211000.0               0.288']
    """
    lines = ["".join(_field(value) for value in card) for card in cards]
    return [f"/{name}", *([] if title is None else [plain(title, 100)]), *lines]


def _field(value: Value) -> str:
    if isinstance(value, float):
        return real(value, 20).rjust(20)
    return ("" if value is None else str(value)).rjust(10)


NAMES = {"faces": "SURF/SEG", "nodes": "GRNOD/NODE", "curve": "FUNCT", "axes": "SKEW/FIX"}
"""Names of the blocks of sets."""


class RadiossSets(DeckSets):
    """Surfaces, groups of nodes, functions and skews of a deck of OpenRadioss."""

    row: ClassVar[int] = 10

    def written(self, kind: str, number: int, title: str, rows: Sequence[Sequence[int | float]]) -> list[str]:
        """Return the lines of a surface, a group, a function or a skew, stated by its second and third axis."""
        if kind == "axes":
            return block(f"{NAMES[kind]}/{number}", f"axes {number}", [0.0, 0.0, 0.0], *rows[1:])
        cards = ([count, *face] for count, face in enumerate(rows, start=1)) if kind == "faces" else rows
        return block(f"{NAMES[kind]}/{number}", title, *cards)


ONE_POINT, FULL = 24, 17
"""Isolid: one point with physical stabilization; 2 x 2 x 2 points."""
REDUCED_PRESSURE = 1
"""Icpre of elements with 2 x 2 x 2 points: pressure at one of them, selectively reduced integration."""
LARGE_STRAIN = 4
"""Ismstr: no element is ever treated as if its strain were small."""
PLASTIC_RATE = 1
"""flagVP: the rate is that of the plastic strain."""


def part_lines(model: Model, system: UnitSystem) -> Iterator[str]:
    """Yield the lines of properties, solids and parts; all three of a part have its number."""
    rigid = {body.part for body in model.rigid}
    for number, name in enumerate(model.mesh.names, start=1):
        full = name in model.controls.full and name not in rigid
        yield from _solid_property(number, name, full, model)
        yield from material(number, name, model.solids[name], system)
        yield from block(f"PART/{number}", name, [number, number, 0])


def _solid_property(number: int, name: str, full: bool, model: Model) -> list[str]:
    c = model.controls
    kind: list[Value] = [FULL if full else ONE_POINT, LARGE_STRAIN, 0, REDUCED_PRESSURE if full else 0, 0, 0, 0, 0, 0.0]
    viscous = [or_smallest(c.quadratic_viscosity), or_smallest(c.linear_viscosity), 0.0, 0.0, 0.0]
    return block(f"PROP/SOLID/{number}", name, kind, viscous, [0.0] * 5)


def material(number: int, name: str, solid: AnySolid, system: UnitSystem) -> list[str]:
    """Return the lines of a solid.

    The bilinear one is LAW2 with b = E E_t / (E - E_t) and n = 1; Chard is the kinematic share of the hardening.

    Examples
    --------
    >>> from strikewave.exchange.units import SYSTEMS
    >>> from strikewave.fem.solids import Elastic
    >>> material(1, "rod", Elastic(7820.0, 211e9, 0.288), SYSTEMS["mm-t-s"])[0]
    '/MAT/ELAST/1'
    """
    moduli: list[Value] = [solid.youngs_modulus * system.stress, solid.poissons_ratio]
    density: list[Value] = [solid.density * system.density]
    if isinstance(solid, JohnsonCook):
        flow = [solid.A * system.stress, solid.B * system.stress, solid.n]
        rate: list[Value] = [solid.C, solid.reference_rate * system.rate, 0, 0, 0.0, 0.0]
        heat = _heat(solid, system)
    elif isinstance(solid, Bilinear) and math.isfinite(solid.yield_strength):
        flow = [solid.yield_strength * system.stress, solid.plastic_modulus * system.stress, 1.0]
        rate = [0.0, 0.0, 0, 0, 0.0, solid.kinematic]
        heat = [0.0, 0.0, 0.0, 0.0]
    else:
        return block(f"MAT/ELAST/{number}", name, density, moduli)
    moduli = [*moduli, 0, PLASTIC_RATE]
    return block(f"MAT/PLAS_JOHNS/{number}", name, density, moduli, [*flow, 0.0, 0.0], rate, heat)


def _heat(solid: JohnsonCook, system: UnitSystem) -> list[float]:
    """Return m, melting temperature, heat capacity by volume, room temperature; 0 stands for no melting, no heating.

    OpenRadioss turns all plastic work into heat: the capacity is divided by the share that does here.
    """
    heated = math.isfinite(solid.specific_heat) and solid.heat_fraction > 0.0
    capacity = solid.density * solid.specific_heat / solid.heat_fraction * system.heat_capacity if heated else 0.0
    melting = solid.melting_temperature if math.isfinite(solid.melting_temperature) else 0.0
    return [solid.m, melting, capacity, solid.room_temperature]


def rigid_lines(sets: RadiossSets) -> Iterator[str]:
    """Yield rigid bodies: a main node of each, beyond those of the mesh, and what it may not do."""
    model, system = sets.model, sets.system
    mass = nodal_sums(model.mesh.hexahedra, element_masses(model.mesh, model.solids) / 8.0, len(model.mesh.points))
    for count, rigid in enumerate(model.rigid, start=1):
        body = RigidBody(model.mesh, rigid, mass, np.zeros(3))
        main = len(model.mesh.points) + count
        yield from block("NODE", None, [main, *(body.centre * system.distance).tolist()])
        group = sets.nodes(f"nodes of {rigid.part}", body.nodes)
        yield from block(f"RBODY/{count}", rigid.part, [main, 0, 0, 0, 0.0, group, 0, 0, 0], [0.0] * 3, [0.0] * 3, [0])
        locked = [tuple(not free for free in ways) for ways in (rigid.translations, rigid.rotations)]
        if any(map(any, locked)):
            alone = sets.add("nodes", f"main node of {rigid.part}", [[main]])
            yield from restraint(sets.next("restraint"), rigid.part, locked, 0, alone)
        velocity = np.where(rigid.translations, model.velocity.get(rigid.part, (0.0, 0.0, 0.0)), 0.0)
        if velocity.any():
            group = sets.nodes(f"{rigid.part} with its main node", np.append(body.nodes, main - 1))
            components = (velocity * system.velocity).tolist()
            yield from block(f"INIVEL/TRA/{sets.next('velocity')}", rigid.part, [*components, group, 0])


def restraint(number: int, title: str, held: Sequence[tuple[bool, ...]], skew: int, group: int) -> list[str]:
    """Return what holds a group of nodes, translations and rotations by axis."""
    ways = " ".join("".join(str(int(flag)) for flag in flags) for flags in held)
    return block(f"BCS/{number}", title, [ways, skew, group])


SHIFTED = 5
"""Inacti: overlaps before the blow stay as they are, without a force."""
FREE_TO_TURN = (False, False, False)
"""Rotations of nodes of solids, which have none to hold."""
SLIDES, RUBS = 0, 2
"""Slide of a wall: without and with friction."""
BY_BOXES = 2
"""Isearch of a tie: by boxes."""


def load_lines(sets: RadiossSets) -> Iterator[str]:
    """Yield the lines of all that holds, drives, loads and touches; groups go to ``sets``."""
    model, system = sets.model, sets.system
    for group_held in restraints(model, sets.ties):
        title = " and ".join(group_held.sides)
        group = sets.nodes(title, group_held.nodes)
        skew = sets.axes(group_held.axes) if group_held.is_local else 0
        yield from restraint(sets.next("restraint"), title, [group_held.held, FREE_TO_TURN], skew, group)
    for number, contact in enumerate(model.contacts, start=1):
        yield from _contact(number, contact, sets)
    for number, tie in enumerate(model.ties, start=len(model.contacts) + 1):
        yield from _tie(number, tie, sets)
    for number, wall in enumerate(model.walls, start=1):
        yield from _wall(number, wall, sets)
    for boundary in model.boundaries:
        if isinstance(boundary, Driven):
            yield from _driven(boundary, sets)
        elif isinstance(boundary, Pressure):  # OpenRadioss takes one along the normal, which is outward, as positive
            curve = sets.curve(f"pressure on {boundary.side}", boundary.pressure, system.stress)
            card: list[Value] = [sets.faces(boundary.side), curve, 0, 0, 0, 0, 1.0, -1.0]
            yield from block(f"PLOAD/{sets.next('pressure')}", boundary.side, card)
    yield from _gravity(sets)
    rigid = {body.part for body in model.rigid}
    for name in model.mesh.names:
        velocity = np.array(model.velocity.get(name, (0.0, 0.0, 0.0)), float) * system.velocity
        if velocity.any() and name not in rigid:
            nodes = sets.nodes(f"nodes of {name}", model.mesh.nodes_of(name))
            yield from block(f"INIVEL/TRA/{sets.next('velocity')}", name, [*velocity.tolist(), nodes, 0])
    yield from rigid_lines(sets)


def _contact(number: int, contact: SurfaceContact, sets: RadiossSets) -> list[str]:
    """Return a contact of two surfaces of solids, which have no gap: nodes of each are checked against the other."""
    return block(
        f"INTER/TYPE24/{number}",
        contact.name,
        [sets.faces(contact.first), sets.faces(contact.second), 0, None, None, 0, None, 0, None, 0],
        [0, None, None, 0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0, 0, 0.0, 0.0],
        [0.0, float(contact.friction), None, None, 0.0, 0.0],
        ["000", None, None, SHIFTED, 0.0, None, None, 0.0],
        [0, 0, 0.0, None, 0, 0.0, None, 0],
    )


def _tie(number: int, tie: Tie, sets: RadiossSets) -> list[str]:
    mesh = sets.model.mesh
    nodes = sets.nodes(tie.side, np.unique(mesh.side(tie.side)))
    reach = float(tie_distance(tie, mesh) * sets.system.distance)
    card: list[Value] = [nodes, sets.faces(tie.onto), 0, 0, 0, BY_BOXES, 0, None, reach]
    return block(f"INTER/TYPE2/{number}", f"{tie.side} on {tie.onto}", card)


def _wall(number: int, wall: RigidWall, sets: RadiossSets) -> list[str]:
    """Return a wall; its normal runs from its point to a second one, a unit of length away."""
    point = sets.system.distance * np.array(wall.point)
    head = point + np.array(wall.normal) / np.linalg.norm(wall.normal)
    return block(
        f"RWALL/PLANE/{number}",
        wall.name,
        [0, RUBS if wall.friction else SLIDES, sets.side_nodes(wall.name, wall.side), 0],
        [0.0, float(wall.friction), 0.0, 0.0, 0],
        point.tolist(),
        head.tolist(),
    )


def _driven(boundary: Driven, sets: RadiossSets) -> list[str]:
    """Return a driven side, along an axis or the first axis of a skew."""
    nodes = sets.side_nodes(f"{boundary.side} driven", boundary.side)
    curve = sets.curve(f"velocity of {boundary.side}", boundary.velocity, sets.system.velocity)
    axis = axis_of(boundary.direction)
    skew = 0 if axis else sets.axes(axes_from(boundary.direction))
    way: list[Value] = [curve, "XYZ"[axis[0]] if axis else "X", skew, 0, nodes, 0, 0]
    number = sets.next("driven")
    return block(f"IMPVEL/{number}", f"{boundary.side} driven", way, [1.0, axis[1] if axis else 1.0, 0.0, 0.0])


def _gravity(sets: RadiossSets) -> Iterator[str]:
    model = sets.model
    if not any(model.gravity):
        return
    curve = sets.curve("gravity", TimeCurve((0.0,), (1.0,)), 1.0)
    nodes = sets.nodes("all nodes", np.arange(len(model.mesh.points) + len(model.rigid), dtype=np.int32))
    for number, (axis, value) in enumerate(zip("XYZ", model.gravity, strict=True), start=1):
        if value:
            card: list[Value] = [curve, axis, 0, 0, nodes, None, 1.0, float(value) * sets.system.acceleration]
            yield from block(f"GRAV/{number}", f"gravity along {axis}", card)


FORMAT = 2023
"""Year of the format: the last that OpenRadioss' own documentation of cards describes."""
NODE = "%10d%20.13e%20.13e%20.13e\n"
"""A row of /NODE: a number of ten columns, coordinates of twenty."""
ELEMENT = "%10d" * 9 + "\n"
"""A row of /BRICK: its number and eight nodes."""
ANIMATED = ("VECT/DISP", "VECT/VEL", "ELEM/VONM", "ELEM/EPSP", "BRICK/TENS/STRESS")
"""Fields that are written: those of a run of strikewave."""
LONGEST_REMARK, REMARK_WIDTH = 2000, 96
"""Characters of a remark, and of one of its lines: OpenRadioss reads 100 columns."""


def radioss_deck(model: Model, system: UnitSystem, heading: Heading) -> Deck:
    """Return the deck of a model, as two files ``_0000.rad`` and ``_0001.rad``.

    Nodes, elements and parts are numbered from 1 in the order of the mesh; the main nodes of rigid parts follow.
    """
    sets = RadiossSets(model, system, checked(model))
    left_out, differs = tuple(_left_out(model)), tuple(_differs(model))
    loads = list(load_lines(sets))
    head = [
        *_begin(system, heading, left_out, differs),
        *part_lines(model, system),
        *sets.lines,
        *loads,
        *_histories(model),
    ]
    starter = itertools.chain((line + "\n" for line in head), _mesh(model, system))
    engine = (line + "\n" for line in _engine(model, system, heading))
    return Deck({"_0000.rad": starter, "_0001.rad": engine}, left_out, differs)


def _begin(system: UnitSystem, heading: Heading, left_out: tuple[str, ...], differs: tuple[str, ...]) -> list[str]:
    length, mass, time = system.words
    units = "".join(f"{word:>20}" for word in (mass, length, time))
    remarks = [
        f"{heading.title}: case {heading.case}, strikewave {heading.version}; units {system.name}",
        *heading.notes,
        *head_lines("OpenRadioss", differs, left_out),
    ]
    remark_lines = [
        f"# {line}" for text in remarks for line in textwrap.wrap(plain(text, LONGEST_REMARK), REMARK_WIDTH)
    ]
    begin = ["#RADIOSS STARTER", *remark_lines, "/BEGIN", heading.stem, f"{FORMAT:10d}{0:10d}", units, units]
    return [*begin, *block("TITLE", heading.title)]


def _mesh(model: Model, system: UnitSystem) -> Iterator[str]:
    nodes, elements = mesh_columns(model.mesh, system.distance)
    yield "/NODE\n"
    yield from rows(NODE, nodes)
    for number, name in enumerate(model.mesh.names, start=1):
        chosen = model.mesh.elements_of(name)
        yield f"/BRICK/{number}\n"
        yield from rows(ELEMENT, [elements[0][chosen], *(column[chosen] for column in elements[2:])])
    yield "/END\n"


def _histories(model: Model) -> Iterator[str]:
    """Yield what histories are of: parts, contacts and ties, walls, points, the elements of sections."""
    counts = {"PART": len(model.mesh.names), "INTER": len(model.contacts + model.ties), "RWALL": len(model.walls)}
    for kind, count in counts.items():
        if count:
            ten_each = (list(range(k, min(k + 10, count + 1))) for k in range(1, count + 1, 10))
            yield from block(f"TH/{kind}/1", kind.lower(), ["DEF"], *ten_each)
    if model.points:
        places: list[list[Value]] = [
            [model.mesh.nearest_node(p.part, p.place) + 1, 0, f" {plain(p.name, 80)}"] for p in model.points
        ]
        yield from block("TH/NODE/1", "points", ["D", "V", "A"], *places)
    for number, section in enumerate(model.sections, start=1):
        elements, _ = section_elements(model.mesh, section)
        cut: list[list[Value]] = [[int(element) + 1, None, f" {plain(section.name, 80)}"] for element in elements]
        yield from block(f"TH/BRIC/{number}", f"section {section.name}", ["DEF"], *cut)


def _engine(model: Model, system: UnitSystem, heading: Heading) -> Iterator[str]:
    """Yield how the deck is run, and what is written how often."""
    c = model.controls
    end, interval = c.duration * system.duration, c.interval * system.duration
    yield from [f"/RUN/{heading.stem}/1", real(end, 20), f"/VERS/{FORMAT}", "/PARITH/ON", "/PRINT/-1000"]
    if c.least_step:
        yield from ["/DT/NODA/CST/0", f"{real(c.safety, 20)} {real(c.least_step * system.duration, 20)}"]
    else:
        yield from ["/DT", f"{real(c.safety, 20)} 0.0"]
    yield from ["/TFILE/4", real(interval, 20), "/ANIM/DT", f"0.0 {real(end / max(heading.frames, 1), 20)}"]
    yield from (f"/ANIM/{what}" for what in ANIMATED)


def _left_out(model: Model) -> Iterator[str]:
    yield from left_out_of_all(model, "the histories of parts")
    for boundary in model.boundaries:
        if isinstance(boundary, NonReflecting):
            yield f"non-reflecting side {boundary.side}: it is free there, and sends waves back"
    for wall in walls_at_rigid_nodes(model):
        yield f"wall {wall.name}, for nodes of rigid parts: OpenRadioss takes them from walls (Ikrem = 0)"
    for section in model.sections:
        yield f"section {section.name}: the histories of its elements are written, their mean and motion are not"
    if model.controls.hourglass and has_one_point(model):
        yield f"hourglass coefficient {model.controls.hourglass:g}: the stabilization of Isolid = 24 has none"


def _differs(model: Model) -> Iterator[str]:
    if model.contacts:
        yield (
            "contact (TYPE24) is a penalty on the depth that is there, its stiffness from that of the surfaces; "
            "strikewave's is one on the gap at the end of the step"
        )
    if has_one_point(model):
        yield "elements of one point (Isolid = 24) are stabilized physically, in axes that turn with them"
    yield "bulk viscosity acts in compression alone; the linear part of strikewave's always acts"
    if any(isinstance(solid, JohnsonCook) for solid in model.solids.values()):
        yield (
            "Johnson and Cook: all plastic work heats (the heat capacity is that over heat_fraction), pressure is "
            "linear in the volume"
        )
    if model.walls:
        yield (
            "walls are a kinematic condition: a node that would pass one at once loses its velocity into it, and the "
            "energy of that; strikewave's are a penalty on the gap at the end of the step"
        )
    if model.controls.least_step:
        yield "mass is scaled at nodes throughout the run (/DT/NODA/CST), here at elements before it"
