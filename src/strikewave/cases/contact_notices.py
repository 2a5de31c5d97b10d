"""Where the contact law of a case ends: its status, the restitution it gives, the yield of what touches."""

from __future__ import annotations

from collections.abc import Iterator

from strikewave.base.materials import material
from strikewave.base.quantities import AUTO, Value
from strikewave.base.result import Notice
from strikewave.cases.case import Case
from strikewave.cases.contact_of_case import cap_geometry
from strikewave.cases.tables import POWER, AnyStriker, ContactTable
from strikewave.contact import (
    FirstYield,
    damping_law,
    factor,
    first_yield,
    restitution,
    stiffness_law,
)
from strikewave.contact.registry import FROM_MEMORY

SAME_RESTITUTION = 1e-9
"""Two restitutions that differ by less are the same: far more than rounding of the closed form, far less than any law
errs."""
KILO = 1e3
"""Newtons from which on a force is written in kN."""


def law_notices(case: Case) -> Iterator[Notice]:
    """Report where a contact law is from memory, or gives two free bodies another restitution than was asked for."""
    contact = case.contact
    if contact is None:
        return
    laws = [damping_law(contact.damping), *([stiffness_law(contact.law)] if contact.law != POWER else [])]
    for law in laws:
        if law.status == FROM_MEMORY:
            message = f"the contact law {law.name} is from memory: no text that states it could be opened"
            yield Notice("law-from-memory", message, 1.0, 0.0)
    asked = contact.restitution.si
    resulting = float(restitution(factor(contact.damping, asked)))
    if abs(resulting - asked) > SAME_RESTITUTION:
        message = (
            f"the damping law {contact.damping} gives two free bodies e = {resulting:.4f}, not the {asked:g} asked "
            "for; exact gives it"
        )
        yield Notice("restitution-differs", message, resulting, asked)


def first_yield_of(striker: AnyStriker, contact: ContactTable, face: str) -> FirstYield | None:
    """Return where a striker first yields on a face of a material, or the face below it; None where it is not known."""
    geometry = cap_geometry(striker, contact)
    return None if geometry is None else first_yield(material(striker.material), material(face), geometry)


def low_pressure_notices(striker: AnyStriker, contact: ContactTable, face: str) -> Iterator[Notice]:
    """Warn where the largest pressure that was given lies below first yield."""
    first, cap = first_yield_of(striker, contact, face), contact.yield_pressure
    if first is not None and isinstance(cap, Value) and cap.si < first.pressure:
        message = (
            f"contact.yield_pressure, {cap.typed}, is below the {first.pressure / 1e6:.4g} MPa at which the "
            "weaker material first yields inside: the contact is taken as softer than it is"
        )
        yield Notice("yield-pressure-low", message, cap.si, first.pressure)


def yield_notices(striker: AnyStriker, contact: ContactTable, face: str, peak: float) -> Iterator[Notice]:
    """Warn where an elastic contact goes beyond its first yield, or a cap lies below it.

    ``face`` is the material that is hit, ``peak`` the largest force, N.
    """
    yield from low_pressure_notices(striker, contact, face)
    first = first_yield_of(striker, contact, face)
    if first is not None and contact.yield_pressure is None and peak > first.load:
        message = (
            f"the contact yields below its surface (von Mises) beyond {force_words(first.load)} and is loaded with "
            f"{force_words(peak)}: the elastic law is outside its range; give contact.yield_pressure, such as "
            f'"{AUTO}"'
        )
        yield Notice("contact-yield", message, peak, first.load)


def force_words(newtons: float) -> str:
    """Return a force in words, N or kN."""
    return f"{newtons:.3g} N" if newtons < KILO else f"{newtons / KILO:.3g} kN"
