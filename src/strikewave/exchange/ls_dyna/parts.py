"""Parts of an LS-DYNA deck: their section, solid, equation of state and hourglass control."""

from __future__ import annotations

import math
from collections.abc import Iterator

from strikewave.exchange.deck import NEVER, or_smallest, plain
from strikewave.exchange.ls_dyna.cards import Value, keyword
from strikewave.exchange.units import UnitSystem
from strikewave.fem.model import Model, Rigid
from strikewave.fem.solids import AnySolid, Bilinear, JohnsonCook

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
    no_cutoff = -1e3 * moduli[0]
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
