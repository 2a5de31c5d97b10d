"""An LS-DYNA keyword deck of a model.

Sources: LS-DYNA Keyword User's Manual, volumes I and II; Flanagan & Belytschko 1981 for what *HOURGLASS IHQ = 5 does.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from strikewave.exchange.deck import (
    Deck,
    Heading,
    checked,
    has_one_point,
    head_lines,
    left_out_of_all,
    mesh_columns,
    or_smallest,
    plain,
    rows,
    walls_at_rigid_nodes,
)
from strikewave.exchange.ls_dyna.cards import Sets, keyword, remark
from strikewave.exchange.ls_dyna.loads import STICKS, load_lines
from strikewave.exchange.ls_dyna.parts import part_lines
from strikewave.exchange.units import UnitSystem
from strikewave.fem.model import Model
from strikewave.fem.recorder import section_elements
from strikewave.fem.solids import JohnsonCook

NODE = "%8d%16.9e%16.9e%16.9e\n"
"""A row of *NODE: a number of eight columns, coordinates of sixteen."""
ELEMENT = "%8d" * 10 + "\n"
"""A row of *ELEMENT_SOLID: its number, that of its part, eight nodes."""


def ls_dyna_deck(model: Model, system: UnitSystem, heading: Heading) -> Deck:
    """Return the deck of a model, as one file ``.k``.

    Nodes, elements and parts are numbered from 1 in the order of the mesh.

    Raises
    ------
    InputError
        If the model could not be run, or has more nodes than eight columns can number.

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
    ties, sets = checked(model), Sets(model.mesh)
    left_out, differs = tuple(_left_out(model)), tuple(_differs(model))
    loads = list(load_lines(model, system, sets, ties))
    lines = [
        *_head(model, system, heading, left_out, differs),
        *_controls(model, system),
        *_output(model, system, heading.frames),
        *part_lines(model, system),
        *sets.lines,
        *loads,
    ]
    return Deck({".k": itertools.chain(_pieces(lines), _mesh(model, system))}, left_out, differs)


def _pieces(lines: list[str]) -> Iterator[str]:
    yield from (line + "\n" for line in lines)


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
    return ["*KEYWORD", *keyword("TITLE", plain(heading.title.replace("&", "and"), 80)), *remark(remarks)]


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
