"""Parts of an OpenRadioss deck: their property, solid and, where they are rigid, their body."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from strikewave.exchange.deck import or_smallest
from strikewave.exchange.radioss.blocks import Groups, Value, block
from strikewave.exchange.units import UnitSystem
from strikewave.fem.hexahedron import element_masses
from strikewave.fem.masses import nodal_sums
from strikewave.fem.mesh import Array, Index
from strikewave.fem.model import Model, Rigid
from strikewave.fem.rigid import RigidBody
from strikewave.fem.solids import AnySolid, Bilinear, JohnsonCook

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


def rigid_bodies(model: Model) -> list[tuple[Rigid, Index, Array]]:
    """Return rigid parts with their nodes and centre of mass, m."""
    mass = nodal_sums(model.mesh.hexahedra, element_masses(model.mesh, model.solids) / 8.0, len(model.mesh.points))
    bodies = [RigidBody(model.mesh, rigid, mass, np.zeros(3)) for rigid in model.rigid]
    return [(rigid, body.nodes, body.centre) for rigid, body in zip(model.rigid, bodies, strict=True)]


def rigid_lines(model: Model, system: UnitSystem, groups: Groups) -> Iterator[str]:
    """Yield rigid bodies: a main node of each, beyond those of the mesh, and what it may not do."""
    for count, (rigid, nodes, centre) in enumerate(rigid_bodies(model), start=1):
        main = len(model.mesh.points) + count
        yield from block("NODE", None, [main, *(centre * system.distance).tolist()])
        group = groups.nodes(f"nodes of {rigid.part}", nodes)
        yield from block(f"RBODY/{count}", rigid.part, [main, 0, 0, 0, 0.0, group, 0, 0, 0], [0.0] * 3, [0.0] * 3, [0])
        locked = [tuple(not free for free in ways) for ways in (rigid.translations, rigid.rotations)]
        if any(map(any, locked)):
            alone = groups.next("nodes")
            groups.lines += block(f"GRNOD/NODE/{alone}", f"main node of {rigid.part}", [main])
            yield from restraint(groups.next("restraint"), rigid.part, locked, 0, alone)
        velocity = np.where(rigid.translations, model.velocity.get(rigid.part, (0.0, 0.0, 0.0)), 0.0)
        if velocity.any():
            whole = groups.nodes(f"{rigid.part} with its main node", np.append(nodes, main - 1))
            components = (velocity * system.velocity).tolist()
            yield from block(f"INIVEL/TRA/{groups.next('velocity')}", rigid.part, [*components, whole, 0])


def restraint(number: int, title: str, held: Sequence[tuple[bool, ...]], skew: int, group: int) -> list[str]:
    """Return what holds a group of nodes, translations and rotations by axis."""
    ways = " ".join("".join(str(int(flag)) for flag in flags) for flags in held)
    return block(f"BCS/{number}", title, [ways, skew, group])
