"""Where the contact law of a case ends: its status, the restitution it gives, the yield of what touches."""

from __future__ import annotations

import math
from collections.abc import Iterator

from strikewave.base.materials import material
from strikewave.base.result import Notice
from strikewave.cases.case import Case
from strikewave.cases.tables import POWER, AnyStriker, ContactTable
from strikewave.contact import (
    Geometry,
    damping_law,
    factor,
    first_yield,
    restitution,
    stiffness_law,
)
from strikewave.contact.registry import FROM_MEMORY

FAR_BEYOND = 100.0
"""Beyond this many times the load of first yield an elastic law does not predict the force. Chosen: the contact is then
plastic over most of its area, which is another law."""
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


def yield_notices(
    striker: AnyStriker, contact: ContactTable, face: str, peak: float, otherwise: str = ""
) -> Iterator[Notice]:
    """Warn where an elastic contact goes beyond its first yield, or a cap lies below it.

    ``face`` is the material that is hit, ``peak`` the largest force, N, ``otherwise`` what to do besides.
    """
    if contact.law == POWER or striker.nose_radius is None:
        return
    of_line = "length" in stiffness_law(contact.law).needs
    length = striker.contact_length.si if of_line and striker.contact_length else None
    first = first_yield(material(striker.material), material(face), Geometry(striker.nose_radius.si, math.inf, length))
    if first is None:
        return
    cap = contact.yield_pressure
    if cap is not None:
        if cap.si < first.pressure:
            message = (
                f"contact.yield_pressure, {cap.typed}, is below the {first.pressure / 1e6:.4g} MPa at which the "
                "weaker material first yields inside: the contact is taken as softer than it is"
            )
            yield Notice("yield-pressure-low", message, cap.si, first.pressure)
        return
    limit = first.load
    if peak > limit:
        message = (
            f"the contact yields below its surface (von Mises) beyond {force_words(limit)} and is loaded with "
            f"{force_words(peak)}, {peak / limit:.3g} times that: the elastic law "
            f"{'does not predict this force' if peak > FAR_BEYOND * limit else 'is outside its range'}; give "
            f"contact.yield_pressure{otherwise}"
        )
        yield Notice("contact-yield", message, peak, limit)


def force_words(newtons: float) -> str:
    """Return a force in words, N or kN."""
    return f"{newtons:.3g} N" if newtons < KILO else f"{newtons / KILO:.3g} kN"
