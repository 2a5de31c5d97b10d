"""Parts of the contacts of a case: the force law of a pad, and the largest pressure that a contact bears."""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np

from strikewave.base.constants import Material
from strikewave.base.errors import MISSING, InputError, InputErrors, checked
from strikewave.base.quantities import AUTO, ContactPressure, Value
from strikewave.cases.tables.contact import CushionTable
from strikewave.contact import LogarithmicStiffness, PressureCap, Stiffness
from strikewave.contact.cushions import (
    Cushion,
    CushionMaterial,
    Pad,
    Wear,
    cushion_law,
    cushion_laws,
    cushion_material,
    retardation_of,
)
from strikewave.contact.elastoplastic import AutomaticPressure, automatic_pressure, hardness_of
from strikewave.contact.registry import CushionLaw

PROPERTIES = (
    *("modulus", "stress", "exponent", "limit_strain", "compression_factor", "shape_factor"),
    *("plateau", "densification", "retardation"),
)
"""Fields of a cushion that are properties of some law."""
_EXAMPLES = {"exponent": "2.5", "limit_strain": "0.8", "densification": "0.8", "retardation": '"20 us"'}
"""Example values of properties that may be missing; of the others `_PRESSURE`."""
_PRESSURE = '"2 MPa"'
T = TypeVar("T")


def cushion_of(table: CushionTable, path: str, area: float) -> Cushion:
    """Return the cushion of an area (m^2) that a table describes, as the blows before leave it."""
    row = _material_of(table, path)
    law = _law_of(table, row, path)
    properties = dict(row.properties) if row else {}
    for key in PROPERTIES:
        value = getattr(table, key)
        if value is None:
            continue
        if key not in (*law.needs, *law.options):
            if key == "retardation":
                continue
            allowed = f"none for the law {law.name}, which takes {', '.join((*law.needs, *law.options))}"
            raise InputError(f"{path}.{key}", value.typed, allowed, "remove it")
        properties[key] = value.si
    missing = [key for key in law.needs if key not in properties]
    if missing:
        allowed = f"a number, for the law {law.name}"
        faults = [InputError(f"{path}.{key}", MISSING, allowed, f"add {_example(key)}") for key in missing]
        raise InputErrors(map(str, faults))
    wear = Wear(table.settling.si if table.settling else 0.0, table.stiffening.si if table.stiffening else 0.0)
    blows = round(table.blows_before.si) if table.blows_before else 0
    pad = Pad(area, table.thickness.si)
    new = Cushion(law.name, pad, properties, wear, _retardation(table, law, path))
    return checked(path, lambda: new.after(blows))


def loses_by_rate(table: CushionTable) -> bool:
    """Tell whether the cushion of a table has a retardation, given or needed by its law: a loss of its own."""
    if table.loss_factor is not None:
        return table.loss_factor.si != 0.0
    of_law = table.law in cushion_laws() and "retardation" in cushion_law(table.law).needs
    return of_law or table.retardation is not None


def _example(key: str) -> str:
    return f"{key} = {_EXAMPLES.get(key, _PRESSURE)}"


def _material_of(table: CushionTable, path: str) -> CushionMaterial | None:
    """Return the row of the cushion materials that a table names; refuse the name of a law in its place."""
    name = table.material.lower()
    if name not in cushion_laws():
        return cushion_material(table.material, f"{path}.material") if name else None
    needed = ", ".join(_example(key) for key in cushion_law(name).needs)
    allowed = "a material of the table in docs/cushions.md; this is the name of a law"
    raise InputError(f"{path}.material", table.material, allowed, f'write law = "{name}" in its place, and {needed}')


def _law_of(table: CushionTable, row: CushionMaterial | None, path: str) -> CushionLaw:
    if row is not None and table.law and table.law != row.law:
        raise InputError(f"{path}.law", table.law, f"{row.law}, that of {row.name}", "leave it out")
    if row is None and not table.law:
        raise InputError(f"{path}.law", MISSING, "a cushion law, or a material", 'such as law = "power"')
    return cushion_law(row.law if row else table.law, f"{path}.law")


def _retardation(table: CushionTable, law: CushionLaw, path: str) -> float:
    """Return the retardation beside the law's own, s."""
    if (table.loss_factor is None) != (table.loss_frequency is None):
        key = "loss_frequency" if table.loss_frequency is None else "loss_factor"
        other = "loss_factor" if table.loss_frequency is None else "loss_frequency"
        raise InputError(f"{path}.{key}", MISSING, f"a value beside {other}", "a loss factor holds at a frequency")
    if table.loss_factor is not None and table.loss_frequency is not None:
        if table.retardation is not None:
            raise InputError(f"{path}.retardation", table.retardation.typed, "retardation or loss_factor, not both")
        return retardation_of(table.loss_factor.si, table.loss_frequency.si)
    if table.retardation is None or "retardation" in law.needs:
        return 0.0
    return table.retardation.si


ELASTIC, LOW, YIELDING, HIGH = "elastic", "yielding, low", "yielding", "yielding, high"
"""Names of the answers of a contact; low and high are the ends of what is known of the pressure that it bears."""
WORTH_SHOWING = 0.05
"""Elastic and yielding answers that differ by more are all shown: less is within the error of the elastic law."""


def capped_pressure(given: ContactPressure, one: Material, other: Material, field: str) -> float:
    """Return the largest pressure that a contact bears, Pa: the one given, or that of the softer of two materials.

    Examples
    --------
    >>> from strikewave.base.constants import material
    >>> steel = material("45 steel")
    >>> round(capped_pressure("auto", steel, steel, "contact.yield_pressure") / 1e6, 1)
    2016.4
    """
    return given.si if isinstance(given, Value) else pressure_of_materials(one, other, field).best


def pressure_of_materials(one: Material, other: Material, field: str) -> AutomaticPressure:
    """Return the largest pressure that the softer of two materials bears, with its range, Pa."""
    for body in (one, other):
        missing = _missing(body)
        if missing:
            raise InputError(field, AUTO, f"a pressure: {body.name} {missing}", 'give it, such as "1 GPa"')
    return automatic_pressure(one, other)


def _missing(body: Material) -> str:
    """Return the reason why a material gives no pressure, in words; nothing where it gives one."""
    if hardness_of(body) is None:
        return "has neither hardness nor yield strength in the table of materials"
    return "" if body.kind == "metal" else "is no metal, so that its hardness does not follow from its yield strength"


def pressures_of_answers(given: ContactPressure, one: Material, other: Material) -> dict[str, float | None]:
    """Return the largest pressure of each answer of a contact, Pa: none where it is elastic.

    A pressure that was given stands alone; else the materials give one, with its range. Where they give none, only the
    elastic answer is left.

    Examples
    --------
    >>> from strikewave.base.constants import material
    >>> list(pressures_of_answers(None, material("65Mn"), material("65Mn")))
    ['elastic', 'yielding, low', 'yielding', 'yielding, high']
    """
    if isinstance(given, Value):
        return {ELASTIC: None, YIELDING: given.si}
    if _missing(one) or _missing(other):
        return {ELASTIC: None}
    best, low, high = automatic_pressure(one, other)
    return {ELASTIC: None, LOW: low, YIELDING: best, HIGH: high}


def refuse_beyond_law(
    cap: PressureCap, stiffness: Stiffness | LogarithmicStiffness, typed: str, field: str, pressure: float | None = None
) -> None:
    """Refuse a cap that a logarithmic law cannot reach: its indentation grows with the force up to B/e only.

    ``pressure`` is that of the cap, Pa; without it, the typed value is the load at which the contact yields.

    Examples
    --------
    >>> from strikewave.contact import LogarithmicStiffness, PressureCap
    >>> law = LogarithmicStiffness(1e9, math.e * 4e3, "johnson", "checked", "johnson-1985")
    >>> refuse_beyond_law(PressureCap(1.6e4, "line"), law, "8 GPa", "contact.yield_pressure", 8e9)
    Traceback (most recent call last):
        ...
    strikewave.base.errors.InputError: contact.yield_pressure: got "8 GPa"; allowed: below 4 GPa, where the \
logarithmic law johnson ends (at 4 kN); give a smaller one, or leave it out: the contact is then elastic
    """
    if not isinstance(stiffness, LogarithmicStiffness):
        return
    load, end = float(np.asarray(cap.yield_load)), stiffness.load / math.e
    if load < end:
        return
    limit = f"{end / 1e3:.4g} kN"
    allowed = f"below {limit}, where the logarithmic law {stiffness.law} ends"
    if pressure is not None:  # the load goes with the square of the pressure of a line, the cube of that of a point
        most = pressure * (end / load) ** (1.0 / (2.0 if cap.shape == "line" else 3.0))
        allowed = f"below {most / 1e9:.4g} GPa, where the logarithmic law {stiffness.law} ends (at {limit})"
    raise InputError(field, typed, allowed, "give a smaller one, or leave it out: the contact is then elastic")


def pressure_words(given: ContactPressure) -> str:
    """Return a largest pressure as it was typed."""
    return str(given.typed if isinstance(given, Value) else given)
