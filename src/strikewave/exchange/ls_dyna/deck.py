"""An LS-DYNA keyword deck of a model.

Sources: LS-DYNA Keyword User's Manual, volumes I and II; Flanagan & Belytschko 1981 for what *HOURGLASS IHQ = 5 does.
"""

from __future__ import annotations

import itertools
import math
import textwrap
from collections.abc import Iterator, Sequence
from typing import ClassVar

import numpy as np

from strikewave.exchange.deck import (
    NEVER,
    Deck,
    DeckSets,
    Heading,
    TimeCurve,
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
from strikewave.fem.model import Driven, Model, NonReflecting, Pressure, Rigid, RigidWall, SurfaceContact, Tie
from strikewave.fem.recorder import section_elements
from strikewave.fem.solids import AnySolid, Bilinear, JohnsonCook

Value = int | float | None
ROUGH = 1e-9
"""Largest share of a number that a standard field of ten columns may cut off; a long one has twenty.

Far below what two codes agree to, so that the deck is the model."""
LONGEST_REMARK, REMARK_WIDTH = 2000, 78
"""Characters of a remark, and of one of its lines: LS-DYNA reads 80 columns, two of them ``$`` and a blank."""


def keyword(name: str, *cards: str | Sequence[Value]) -> list[str]:
    """Return the lines of a keyword; a card is a line as it is, or the values of its fields, None for a blank one.

    Fields have ten columns; all of the keyword have twenty, marked by ``+``, where ten would cut numbers off. A keyword
    with a line as it is, such as a title, must have numbers that go into ten.

    Examples
    --------
    >>> keyword("CONTROL_TERMINATION", [8e-5])
    ['*CONTROL_TERMINATION', '    8.0e-5']
    >>> keyword("CONTROL_TERMINATION", [1.23456789012e-5])[0]
    '*CONTROL_TERMINATION+'
    """
    wide = any(_is_rough(value) for card in cards if not isinstance(card, str) for value in card)
    width = 20 if wide else 10
    lines = [card if isinstance(card, str) else "".join(_field(value, width) for value in card) for card in cards]
    return [f"*{name}{'+' if wide else ''}", *lines]


def _is_rough(value: Value) -> bool:
    return isinstance(value, float) and abs(float(_real(value, 10)) - value) > ROUGH * abs(value)


def _field(value: Value, width: int) -> str:
    if value is None:
        return " " * width
    return (_real(value, width) if isinstance(value, float) else str(value)).rjust(width)


def _real(value: float, width: int) -> str:
    """Write a number so that it is one with a point too."""
    text = real(value, width)
    return text.replace("e", ".0e") if "." not in text and len(text) <= width - 2 else text


SETS: dict[str, tuple[str, list[Value]]] = {
    "faces": ("SET_SEGMENT_TITLE", [0.0] * 4),
    "nodes": ("SET_NODE_LIST_TITLE", [0.0] * 4),
    "curve": ("DEFINE_CURVE_TITLE", [0, 1.0, 1.0, 0.0, 0.0]),
}
"""Keywords of sets with a title, and what stands behind their number: attributes of 0, factors of 1, offsets of 0."""


class LsDynaSets(DeckSets):
    """Sets, curves and axes of a deck of LS-DYNA."""

    row: ClassVar[int] = 8

    def written(self, kind: str, number: int, title: str, rows: Sequence[Sequence[int | float]]) -> list[str]:
        """Return the lines of faces, nodes, a curve, axes or a vector from the origin."""
        if kind == "axes":
            return keyword("DEFINE_COORDINATE_VECTOR", [number, *rows[0], *rows[1]])
        if kind == "vector":
            return keyword("DEFINE_VECTOR", [number, 0.0, 0.0, 0.0, *rows[0]])
        name, head = SETS[kind]
        cards = ["".join(f"{real(x, 20):>20}" for x in row) for row in rows] if kind == "curve" else rows
        return keyword(name, plain(title, 80), [number, *head], *cards)


ONE_POINT, FULL = 1, 2
"""Numbers of the sections, and ELFORM of their elements: constant stress; selectively reduced integration."""
STIFFNESS = 5
"""IHQ of Flanagan's and Belytschko's stiffness form with exactly integrated volumes."""
HOURGLASS = 1
"""Number of the hourglass control."""
NO_FAILURE = 1e6
"""D1 of Johnson's and Cook's fracture: a strain that is never reached."""
CONSTRAINED = {"": 0, "x": 1, "y": 2, "z": 3, "xy": 4, "yz": 5, "xz": 6, "xyz": 7}
"""CON1 and CON2 of *MAT_RIGID by the axes that are held."""


def part_lines(model: Model, system: UnitSystem) -> Iterator[str]:
    """Yield the lines of sections, hourglass control, parts and their solids."""
    c, rigid = model.controls, {body.part: body for body in model.rigid}
    sections = {name: FULL if name in c.full and name not in rigid else ONE_POINT for name in model.mesh.names}
    for kind in sorted(set(sections.values())):
        yield from keyword("SECTION_SOLID", [kind, kind])
    viscous = [or_smallest(c.quadratic_viscosity), or_smallest(c.linear_viscosity)]
    yield from keyword("HOURGLASS", [HOURGLASS, STIFFNESS, or_smallest(c.hourglass), 1, *viscous])
    for number, name in enumerate(model.mesh.names, start=1):
        solid, rigid_body = model.solids[name], rigid.get(name)
        state = number if isinstance(solid, JohnsonCook) and rigid_body is None else 0
        yield from keyword("PART", plain(name, 70), [number, sections[name], number, state, HOURGLASS, 0, 0, 0])
        yield from rigid_solid(number, solid, rigid_body, system) if rigid_body else material(number, solid, system)


def material(number: int, solid: AnySolid, system: UnitSystem) -> list[str]:
    """Return the lines of a solid and, where it needs one, its equation of state, both of the same number.

    Examples
    --------
    >>> from strikewave.exchange.units import SYSTEMS
    >>> from strikewave.fem.solids import Elastic
    >>> material(1, Elastic(7820.0, 211e9, 0.288), SYSTEMS["mm-t-s"])
    ['*MAT_ELASTIC', '         1   7.82e-9  211000.0     0.288']
    """
    head: list[Value] = [number, solid.density * system.density]
    moduli = [solid.youngs_modulus * system.stress, solid.poissons_ratio]
    if isinstance(solid, JohnsonCook):
        return _johnson_cook(head, moduli, solid, system)
    if isinstance(solid, Bilinear) and math.isfinite(solid.yield_strength):
        hardening = [solid.yield_strength * system.stress, solid.tangent_modulus * system.stress]
        isotropic = 1.0 - solid.kinematic
        return keyword("MAT_PLASTIC_KINEMATIC", [*head, *moduli, *hardening, isotropic], [0.0, 0.0, 0.0, 0.0])
    return keyword("MAT_ELASTIC", [*head, *moduli])


def _johnson_cook(head: list[Value], moduli: list[float], solid: JohnsonCook, system: UnitSystem) -> list[str]:
    """Return *MAT_JOHNSON_COOK and *EOS_LINEAR_POLYNOMIAL with p = K mu.

    LS-DYNA turns all plastic work into heat: the specific heat is divided by the share that does here.
    """
    stress = system.stress
    melting = solid.melting_temperature if math.isfinite(solid.melting_temperature) else NEVER
    heated = math.isfinite(solid.specific_heat) and solid.heat_fraction > 0.0
    heat = solid.specific_heat / solid.heat_fraction * system.specific_heat if heated else NEVER
    no_cutoff = -1e3 * moduli[0]  # a tension that no solid reaches
    number = head[0]
    return [
        *keyword(
            "MAT_JOHNSON_COOK",
            [*head, solid.shear_modulus * stress, *moduli, 0.0, 1.0, 0.0],
            [
                *(solid.A * stress, solid.B * stress, solid.n, solid.C, solid.m),
                *(melting, solid.room_temperature, solid.reference_rate * system.rate),
            ],
            [heat, no_cutoff, 1.0, 0.0, NO_FAILURE, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 1e-6],
        ),
        *keyword(
            "EOS_LINEAR_POLYNOMIAL", [number, 0.0, solid.bulk_modulus * stress, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0, 1.0]
        ),
    ]


def rigid_solid(number: int, solid: AnySolid, rigid: Rigid, system: UnitSystem) -> list[str]:
    """Return the lines of the solid of a rigid part; its moduli stiffen contact alone."""
    constraints = [
        CONSTRAINED["".join(axis for axis, free in zip("xyz", ways, strict=True) if not free)]
        for ways in (rigid.translations, rigid.rotations)
    ]
    moduli = [solid.youngs_modulus * system.stress, solid.poissons_ratio]
    return keyword(
        "MAT_RIGID",
        [number, solid.density * system.density, *moduli, 0.0, 0.0, 0.0],
        [1.0 if any(constraints) else 0.0, *constraints],
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    )


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


def load_lines(sets: LsDynaSets) -> Iterator[str]:
    """Yield the lines of all that holds, drives, loads and touches; their sets go to ``sets``."""
    model, system = sets.model, sets.system
    for restraint in restraints(model, sets.ties):
        number = sets.nodes(" and ".join(restraint.sides), restraint.nodes)
        axes = sets.axes(restraint.axes) if restraint.is_local else 0
        yield from keyword("BOUNDARY_SPC_SET", [number, axes, *(int(is_held) for is_held in restraint.held), 0, 0, 0])
    for number, contact in enumerate(model.contacts, start=1):
        yield from _contact(number, contact, sets)
    for number, tie in enumerate(model.ties, start=len(model.contacts) + 1):
        yield from _tie(number, tie, sets)
    for wall in model.walls:
        yield from _wall(wall, sets)
    for boundary in model.boundaries:
        if isinstance(boundary, Driven):
            yield from _driven(boundary, sets)
        elif isinstance(boundary, Pressure):
            curve = sets.curve(f"pressure on {boundary.side}", boundary.pressure, system.stress)
            yield from keyword("LOAD_SEGMENT_SET", [sets.faces(boundary.side), curve, 1.0, 0.0])
        elif isinstance(boundary, NonReflecting):
            yield from keyword("BOUNDARY_NON_REFLECTING", [sets.faces(boundary.side), 0.0, 0.0])
    if any(model.gravity):
        curve = sets.curve("gravity", CONSTANT, 1.0)
        for axis, value in zip("XYZ", model.gravity, strict=True):
            if value:  # LS-DYNA takes the acceleration of the base, which is opposite to gravity
                yield from keyword(f"LOAD_BODY_{axis}", [curve, -float(value) * system.acceleration])
    yield from _velocities(model, system)


def _contact(number: int, contact: SurfaceContact, sets: LsDynaSets) -> list[str]:
    """Return a contact of two sides, each checked against the other; faces of solids have no thickness."""
    friction = float(f"{contact.friction:.{DIGITS}g}")
    return keyword(
        "CONTACT_AUTOMATIC_SURFACE_TO_SURFACE_ID",
        f"{number:10d}{plain(contact.name, 70)}",
        [sets.faces(contact.first), sets.faces(contact.second), SEGMENTS, SEGMENTS, 0, 0, 1, 1],
        [friction, friction, 0.0, 0.0, 0.0, 0, 0.0, NO_DEATH],
        [1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0],
        [SOFT],
        [0.0],
        [1, TRACKED],
    )


def _tie(number: int, tie: Tie, sets: LsDynaSets) -> list[str]:
    """Return a tie; nodes within 0.6 times the sum of both thicknesses are tied, which below 0 move nothing."""
    mesh = sets.model.mesh
    nodes = sets.nodes(tie.side, np.unique(mesh.side(tie.side)))
    reach = -float(f"{tie_distance(tie, mesh) * sets.system.distance:.{DIGITS}g}")
    return keyword(
        "CONTACT_TIED_NODES_TO_SURFACE_CONSTRAINED_OFFSET_ID",
        f"{number:10d}{plain(f'{tie.side} on {tie.onto}', 70)}",
        [nodes, sets.faces(tie.onto), NODES, SEGMENTS, 0, 0, 1, 1],
        [0.0, 0.0, 0.0, 0.0, 0.0, 0, 0.0, NO_DEATH],
        [1.0, 1.0, reach, reach, 1.0, 1.0, 1.0, 1.0],
    )


def _wall(wall: RigidWall, sets: LsDynaSets) -> list[str]:
    """Return a wall; its normal runs from tail to head, a unit of length long."""
    tail = sets.system.distance * np.array(wall.point)
    head = tail + np.array(wall.normal) / np.linalg.norm(wall.normal)
    friction = min(float(wall.friction), STICKS)
    return keyword(
        "RIGIDWALL_PLANAR",
        [sets.side_nodes(wall.name, wall.side), 0, 0, 0.0, 0.0, NO_DEATH, 1.0],
        [*tail.tolist(), *head.tolist(), friction, 0.0],
    )


def _driven(boundary: Driven, sets: LsDynaSets) -> list[str]:
    """Return a driven side: along an axis (DOF 1 to 3), or a vector and free across it (DOF 4)."""
    nodes = sets.side_nodes(f"{boundary.side} driven", boundary.side)
    curve = sets.curve(f"velocity of {boundary.side}", boundary.velocity, sets.system.velocity)
    axis = axis_of(boundary.direction)
    if axis is None:
        vector = sets.add("vector", "", [[float(x) for x in boundary.direction]])
        way: list[Value] = [4, 0, curve, 1.0, vector]
    else:
        way = [axis[0] + 1, 0, curve, axis[1], 0]
    return keyword("BOUNDARY_PRESCRIBED_MOTION_SET", [nodes, *way, NO_END, 0.0])


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


NODE = "%8d%16.9e%16.9e%16.9e\n"
"""A row of *NODE: a number of eight columns, coordinates of sixteen."""
ELEMENT = "%8d" * 10 + "\n"
"""A row of *ELEMENT_SOLID: its number, that of its part, eight nodes."""


def ls_dyna_deck(model: Model, system: UnitSystem, heading: Heading) -> Deck:
    """Return the deck of a model, as one file ``.k``.

    Nodes, elements and parts are numbered from 1 in the order of the mesh.

    Examples
    --------
    >>> import numpy as np
    >>> from strikewave.exchange.units import SYSTEMS
    >>> from strikewave.fem import Controls, Elastic, Mesh
    >>> cube = np.array([[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], float)
    >>> mesh = Mesh(1e-3 * cube, np.arange(8, dtype=np.int32)[None], np.zeros(1, np.int32), ("cube",))
    >>> model = Model(mesh, {"cube": Elastic(7820.0, 211e9, 0.3)}, Controls(2e-6), velocity={"cube": (1.0, 0.0, 0.0)})
    >>> text = "".join(ls_dyna_deck(model, SYSTEMS["mm-t-s"], Heading("a cube")).files[".k"])
    >>> print(text[text.index("*NODE"):][:63])
    *NODE
           1 0.000000000e+00 0.000000000e+00 0.000000000e+00
    """
    sets = LsDynaSets(model, system, checked(model))
    left_out, differs = tuple(_left_out(model)), tuple(_differs(model))
    loads = list(load_lines(sets))
    lines = [
        *_head(model, system, heading, left_out, differs),
        *_controls(model, system),
        *_output(model, system, heading.frames),
        *part_lines(model, system),
        *sets.lines,
        *loads,
    ]
    return Deck({".k": itertools.chain((line + "\n" for line in lines), _mesh(model, system))}, left_out, differs)


def _mesh(model: Model, system: UnitSystem) -> Iterator[str]:
    nodes, elements = mesh_columns(model.mesh, system.distance)
    yield "*NODE\n"
    yield from rows(NODE, nodes)
    yield "*ELEMENT_SOLID\n"
    yield from rows(ELEMENT, elements)
    yield "*END\n"


def _head(
    model: Model, system: UnitSystem, heading: Heading, left_out: tuple[str, ...], differs: tuple[str, ...]
) -> list[str]:
    length, mass, time = system.words
    remarks = [
        f"{heading.title}: case {heading.case}, strikewave {heading.version}",
        f"units: {length}, {mass}, {time} ({system.name}), K; "
        f"1 of stress is {1.0 / system.stress:g} Pa, 1 of force {1.0 / system.force:g} N",
        *heading.notes,
        *head_lines("LS-DYNA", differs, left_out),
        *(f"wall {number}: {wall.name}" for number, wall in enumerate(model.walls, start=1)),
        *(f"section {number}: {section.name}" for number, section in enumerate(model.sections, start=1)),
    ]
    comments = [f"$ {line}" for text in remarks for line in textwrap.wrap(plain(text, LONGEST_REMARK), REMARK_WIDTH)]
    return ["*KEYWORD", *keyword("TITLE", plain(heading.title.replace("&", "and"), 80)), *comments]


def _controls(model: Model, system: UnitSystem) -> Iterator[str]:
    """Yield how the deck is run.

    OSU = 1 updates stress in the middle of the step, energies are all added up, MS1ST = 1 scales mass before the first
    step alone, RWPNAL = 1 lets walls stop nodes of rigid parts too.
    """
    c = model.controls
    scaling = [-c.least_step / c.safety * system.duration, 0, 0, 1] if c.least_step else [0.0]
    yield from keyword("CONTROL_TERMINATION", [c.duration * system.duration])
    yield from keyword("CONTROL_TIMESTEP", [0.0, c.safety, 0, 0.0, *scaling])
    yield from keyword("CONTROL_BULK_VISCOSITY", [or_smallest(c.quadratic_viscosity), or_smallest(c.linear_viscosity)])
    yield from keyword("CONTROL_ACCURACY", [1])
    yield from keyword("CONTROL_ENERGY", [2, 2, 2, 2])
    if walls_at_rigid_nodes(model):
        yield from keyword("CONTROL_CONTACT", [0.1, 1.0, 1, 0, 1, 0, 1], [0, 0, 0, 0, 4.0])


def _output(model: Model, system: UnitSystem, frames: int) -> Iterator[str]:
    """Yield what LS-DYNA writes: histories at each interval, fields at as many instants as asked for."""
    c = model.controls
    interval = c.interval * system.duration
    is_wanted = {
        "GLSTAT": True,
        "MATSUM": True,
        "RCFORC": bool(model.contacts),
        "RWFORC": bool(model.walls),
        "SECFORC": bool(model.sections),
        "ELOUT": bool(model.sections),
        "NODOUT": bool(model.points),
    }
    for name in (name for name, wanted in is_wanted.items() if wanted):
        yield from keyword(f"DATABASE_{name}", [interval])
    yield from keyword("DATABASE_BINARY_D3PLOT", [c.duration * system.duration / max(frames, 1)])
    for point in model.points:
        node = model.mesh.nearest_node(point.part, point.place) + 1
        yield from keyword("DATABASE_HISTORY_NODE_ID", f"{node:10d}{plain(point.name, 70)}")
    for number, section in enumerate(model.sections, start=1):
        part = model.mesh.names.index(section.part) + 1
        tail = [x * system.distance for x in section.point]
        head = [x + float(n) for x, n in zip(tail, section.normal, strict=True)]
        yield from keyword("SET_PART_LIST", [number, 0.0, 0.0, 0.0, 0.0], [part])
        yield from keyword("DATABASE_CROSS_SECTION_PLANE", [number, *tail, *head, 0.0], [0.0] * 5)
        cut = (section_elements(model.mesh, section)[0].astype(np.int64) + 1).tolist()
        yield from keyword("DATABASE_HISTORY_SOLID", *(cut[k : k + 8] for k in range(0, len(cut), 8)))


def _left_out(model: Model) -> Iterator[str]:
    yield from left_out_of_all(model, "matsum")
    for section in model.sections:
        yield (
            f"section {section.name}: secforc has its force, elout the stresses of its elements; their mean and "
            "their motion are not written"
        )


def _differs(model: Model) -> Iterator[str]:
    if model.contacts:
        yield (
            "contact is a penalty on the depth that is there, its stiffness from nodal masses and the time step "
            "(SOFT = 1); strikewave's is one on the gap at the end of the step"
        )
    if has_one_point(model):
        yield (
            "hourglass control is Flanagan's and Belytschko's stiffness form (IHQ = 5), QM strikewave's coefficient, "
            "which need not scale alike; strikewave's follows from a potential and is bounded where a solid yields"
        )
    yield (
        "bulk viscosity acts in compression alone, its length the cube root of the volume; the linear part of "
        "strikewave's always acts, its length the smallest thickness"
    )
    if any(isinstance(solid, JohnsonCook) for solid in model.solids.values()):
        yield (
            "Johnson and Cook: pressure is K (density ratio - 1), all plastic work heats (the specific heat is that "
            "over heat_fraction), and nothing fails (D1 = 1e6)"
        )
    if model.walls:
        yield (
            "walls are a constraint: a node that has passed one is put back on it and at once loses its velocity into "
            "it, and the energy of that; strikewave's are a penalty on the gap at the end of the step"
        )
    for wall in walls_at_rigid_nodes(model):
        yield f"wall {wall.name}: its nodes of rigid parts meet a penalty on the depth that is there (RWPNAL = 1)"
    for wall in model.walls:
        if wall.friction >= STICKS:
            yield f"wall {wall.name}: its friction of {wall.friction:g} is no sliding at all there (FRIC = 1)"
