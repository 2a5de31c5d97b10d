"""The largest pressure that a contact of a case bears: the one given, or that of the softer of its materials."""

from __future__ import annotations

from strikewave.base.errors import InputError
from strikewave.base.materials import Material
from strikewave.base.quantities import AUTO, ContactPressure, Value
from strikewave.contact.elastoplastic import AutomaticPressure, automatic_pressure, hardness_of

ELASTIC, LOW, YIELDING, HIGH = "elastic", "yielding, low", "yielding", "yielding, high"
"""Names of the answers of a contact; low and high are the ends of what is known of the pressure that it bears."""
WORTH_SHOWING = 0.05
"""Elastic and yielding answers that differ by more are all shown: less is within what the elastic law itself errs."""


def capped_pressure(given: ContactPressure, one: Material, other: Material, field: str) -> float:
    """Return the largest pressure that a contact bears, Pa: the one given, or that of the softer of two materials.

    Raises
    ------
    InputError
        If it is to follow from the materials, and one of them has neither hardness nor yield strength.

    Examples
    --------
    >>> from strikewave.base.materials import material
    >>> steel = material("45 steel")
    >>> round(capped_pressure("auto", steel, steel, "contact.yield_pressure") / 1e6, 1)
    2016.4
    """
    return given.si if isinstance(given, Value) else pressure_of_materials(one, other, field).best


def pressure_of_materials(one: Material, other: Material, field: str) -> AutomaticPressure:
    """Return the largest pressure that the softer of two materials bears, with its range, Pa.

    Raises
    ------
    InputError
        If one of them has neither hardness nor yield strength.
    """
    for body in (one, other):
        if hardness_of(body) is None:
            allowed = f"a pressure: {body.name} has neither hardness nor yield strength in the table of materials"
            raise InputError(field, AUTO, allowed, 'give it, such as "1 GPa"')
    return automatic_pressure(one, other)


def pressures_of_answers(given: ContactPressure, one: Material, other: Material) -> dict[str, float | None]:
    """Return the largest pressure of each answer of a contact, Pa: none where it is elastic.

    A pressure that was given stands alone; else the materials give one, with its range. Where they give none, only the
    elastic answer is left.

    Examples
    --------
    >>> from strikewave.base.materials import material
    >>> list(pressures_of_answers(None, material("65Mn"), material("65Mn")))
    ['elastic', 'yielding, low', 'yielding', 'yielding, high']
    """
    if isinstance(given, Value):
        return {ELASTIC: None, YIELDING: given.si}
    if hardness_of(one) is None or hardness_of(other) is None:
        return {ELASTIC: None}
    best, low, high = automatic_pressure(one, other)
    return {ELASTIC: None, LOW: low, YIELDING: best, HIGH: high}


def pressure_words(given: ContactPressure) -> str:
    """Return a largest pressure as it was typed."""
    return str(given.typed if isinstance(given, Value) else given)
