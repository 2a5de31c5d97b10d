"""Masses of elements and nodes, what is added for a wanted step, and the steps that they allow; SI."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from strikewave.base.errors import InputError
from strikewave.fem.full import critical_steps as full_critical_steps
from strikewave.fem.hexahedron import critical_steps, element_masses, shapes
from strikewave.fem.mesh import Array, Index, Mesh
from strikewave.fem.model import Model

SCALINGS = 60
"""Rounds in which mass is added. Without bulk viscosity one round does; with it the step grows more slowly than the
root of the mass, and where it stops growing no mass suffices."""
ROUNDING = 1e-9
"""Share by which a step may miss what it should fit: above rounding, far below what a step is cut by."""


def fitting(span: float, longest: float) -> float:
    """Return the largest step up to a longest one that goes into a span a whole number of times, s."""
    return span / max(1, math.ceil(span / longest - ROUNDING))


def part_masses(mesh: Mesh, element_mass: Array, name: str) -> Array:
    """Return the mass of a part at each of its nodes, kg."""
    chosen = mesh.elements_of(name)
    whole = nodal_sums(mesh.hexahedra[chosen], element_mass[chosen] / 8.0, len(mesh.points))
    return whole[mesh.nodes_of(name)]


def nodal_sums(hexahedra: Index, values: Array, nodes: int) -> Array:
    """Return the sum of a value of elements over those of each node, (nodes,)."""
    return np.asarray(np.bincount(hexahedra.ravel(), np.repeat(values, 8), nodes), float)


def scaled_masses(model: Model, parts: Iterable[str]) -> tuple[Array, float, float]:
    """Return the masses of the elements, kg; the mass that was added for the wanted step; the critical step, s.

    Raises
    ------
    InputError
        If no mass makes the wanted step stable.
    """
    mesh, controls = model.mesh, model.controls
    mass = element_masses(mesh, model.solids)
    before, least = mass.sum(), np.inf
    for name in parts:
        chosen, wanted = mesh.elements_of(name), controls.least_step / controls.safety
        for _ in range(SCALINGS):
            steps = first_steps(model, name, mass[chosen])
            short = wanted / steps
            if short.max() <= 1.0 + ROUNDING:
                break
            mass[chosen] *= np.maximum(short, 1.0) ** 2
        else:
            limit = f"at most about {controls.safety * float(steps.min()):.3g} s for {name}"
            raise InputError("least_step", controls.least_step, limit, "the bulk viscosity allows no longer one")
        least = min(least, float(steps.min()))
    return mass, float(mass.sum() - before), least


def first_steps(model: Model, part: str, mass: Array) -> Array:
    """Return the critical steps of the elements of a part before the run, s; ``mass`` is that of its elements."""
    mesh, controls = model.mesh, model.controls
    hexahedra, rest = mesh.hexahedra[mesh.elements_of(part)], (mass, model.solids[part], controls.linear_viscosity)
    if part in controls.full:
        return full_critical_steps(mesh.points, hexahedra, *rest)
    return critical_steps(shapes(mesh.points, hexahedra), *rest)
