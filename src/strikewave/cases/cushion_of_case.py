"""Table of a cushion in, force law of its pad out."""

from __future__ import annotations

from typing import TypeVar

from strikewave.base.errors import MISSING, InputError, InputErrors, checked
from strikewave.base.quantities import Value
from strikewave.cases.tables.contact import CushionTable
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
from strikewave.contact.registry import CushionLaw

PROPERTIES = (
    *("modulus", "stress", "exponent", "limit_strain", "compression_factor", "shape_factor"),
    *("plateau", "densification", "retardation"),
)
"""Fields of a cushion that are properties of some law."""
_EXAMPLES = {"exponent": "2.5", "limit_strain": "0.8", "densification": "0.8", "retardation": '"20 us"'}
"""What to add where a property is missing; of the others `_PRESSURE`."""
_PRESSURE = '"2 MPa"'
T = TypeVar("T")


def cushion_of(table: CushionTable, path: str, area: float) -> Cushion:
    """Return the cushion of an area (m^2) that a table describes, as the blows before leave it.

    Raises
    ------
    InputError
        If its law or material is unknown, or a property is missing or foreign.
    """
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
    wear = Wear(_or_zero(table.settling), _or_zero(table.stiffening))
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
    """Return the row of the cushion materials that a table names; the name of a law is none, and is said to be one."""
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


def _or_zero(value: Value | None) -> float:
    return 0.0 if value is None else value.si
