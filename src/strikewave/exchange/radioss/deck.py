"""An OpenRadioss deck of a model: starter ``_0000.rad``, engine ``_0001.rad``, in the format of 2023.

Sources: Altair Radioss Reference Guide 2022; the definitions of the cards that come along with OpenRadioss; its source,
in which /PLOAD pulls along the normal of a segment.
"""

from __future__ import annotations

import itertools
import textwrap
from collections.abc import Iterator

from strikewave.exchange.deck import (
    Deck,
    Heading,
    checked,
    has_one_point,
    head_lines,
    left_out_of_all,
    mesh_columns,
    plain,
    real,
    rows,
    walls_at_rigid_nodes,
)
from strikewave.exchange.radioss.blocks import Groups, Value, block
from strikewave.exchange.radioss.loads import load_lines
from strikewave.exchange.radioss.parts import part_lines
from strikewave.exchange.units import UnitSystem
from strikewave.fem.model import Model, NonReflecting
from strikewave.fem.recorder import section_elements
from strikewave.fem.solids import JohnsonCook

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

    Raises
    ------
    InputError
        If the model could not be run, or has more nodes than eight columns can number.
    """
    ties, groups = checked(model), Groups(model.mesh)
    left_out, differs = tuple(_left_out(model)), tuple(_differs(model))
    loads = list(load_lines(model, system, groups, ties))
    head = [
        *_begin(system, heading, left_out, differs),
        *part_lines(model, system),
        *groups.lines,
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
