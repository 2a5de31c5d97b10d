"""The largest pressure that a contact of a case bears: the one given, or that of the softer of its materials."""

from __future__ import annotations

import math

import numpy as np

from strikewave.base.errors import InputError
from strikewave.base.materials import Material
from strikewave.base.quantities import AUTO, ContactPressure, Value
from strikewave.contact import LogarithmicStiffness, PressureCap, Stiffness
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
        If it is to follow from the materials, and one of them is no metal, or has neither hardness nor yield strength.

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
        If one of them is no metal, or has neither hardness nor yield strength.
    """
    for body in (one, other):
        missing = _missing(body)
        if missing:
            raise InputError(field, AUTO, f"a pressure: {body.name} {missing}", 'give it, such as "1 GPa"')
    return automatic_pressure(one, other)


def _missing(body: Material) -> str:
    """Return in words why a material gives no pressure; nothing where it gives one."""
    if hardness_of(body) is None:
        return "has neither hardness nor yield strength in the table of materials"
    return "" if body.kind == "metal" else "is no metal, so that its hardness does not follow from its yield strength"


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
    if _missing(one) or _missing(other):
        return {ELASTIC: None}
    best, low, high = automatic_pressure(one, other)
    return {ELASTIC: None, LOW: low, YIELDING: best, HIGH: high}


def refuse_beyond_law(
    cap: PressureCap, stiffness: Stiffness | LogarithmicStiffness, typed: str, field: str, pressure: float | None = None
) -> None:
    """Refuse a cap that a logarithmic law cannot reach: its indentation grows with the force up to B/e only.

    Parameters
    ----------
    cap : PressureCap
        On the contact.
    stiffness : Stiffness or LogarithmicStiffness
        Of the contact.
    typed, field : str
        What was typed, and its field.
    pressure : float, optional
        Of the cap, Pa; without it, the load at which it yields is what was typed.

    Raises
    ------
    InputError
        If it does.

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
