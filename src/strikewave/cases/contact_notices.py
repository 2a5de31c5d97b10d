"""Where the contact law of a case ends: its status, the restitution it gives, the yield of what touches."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Protocol

from strikewave.base.materials import Material, material
from strikewave.base.percents import percent, plain
from strikewave.base.quantities import AUTO, Value
from strikewave.base.result import FAILED, INFO, Notice
from strikewave.cases.case import Case
from strikewave.cases.contact_of_case import cap_geometry, cushion_contact, cushion_of_contact
from strikewave.cases.law_names import CUSHION, POWER
from strikewave.cases.stack_of_case import DEFAULT_LAW, layer_material
from strikewave.cases.tables.contact import ContactTable
from strikewave.cases.tables.machine import AnyStriker
from strikewave.contact import FirstYield, Geometry, damping_law, factor, first_yield, restitution, stiffness_law
from strikewave.contact.cushions import cushion_law
from strikewave.contact.registry import FROM_MEMORY, Law

SAME_RESTITUTION = 1e-9
"""Two restitutions that differ by less are the same: far more than rounding of the closed form, far less than any law
errs."""
LARGEST_STRAIN = 1.0
"""Strain at which nothing is left of a cushion whose law does not end before."""
KILO = 1e3
"""Newtons from which on a force is written in kN."""


class PressedBlow(Protocol):
    """What a blow tells of its contact, SI: such as `strikewave.machines.Blow`."""

    @property
    def indentation(self) -> float:
        """Largest indentation, m."""

    @property
    def residual_indentation(self) -> float:
        """What stays of it, m."""

    @property
    def restitution(self) -> float:
        """Root of the work given back over the work taken."""

    @property
    def peak_force(self) -> float:
        """Largest force, N."""


def law_notices(case: Case) -> Iterator[Notice]:
    """Report where a contact law is from memory, or gives two free bodies another restitution than was asked for."""
    contact = case.contact
    if contact is None:
        return
    laws: list[Law] = [damping_law(contact.damping)]
    if contact.law == CUSHION:
        laws.append(cushion_law(cushion_of_contact(contact).law))
    elif contact.law != POWER:
        laws.append(stiffness_law(contact.law))
    for law in laws:
        if law.status == FROM_MEMORY:
            message = f"the contact law {law.name} is from memory: no text that states it could be opened"
            yield Notice("law-from-memory", message, 1.0, 0.0, severity=INFO)
    asked = contact.restitution.si
    resulting = float(restitution(factor(contact.damping, asked)))
    if abs(resulting - asked) > SAME_RESTITUTION:
        message = (
            f"the damping law {contact.damping} gives two free bodies e = {resulting:.4f}, not the {asked:g} asked "
            "for; exact gives it"
        )
        yield Notice("restitution-differs", message, resulting, asked)


def first_yield_of(striker: AnyStriker, contact: ContactTable, face: Material) -> FirstYield | None:
    """Return where a striker first yields on a face of a material, or the face below it; None where it is not known."""
    geometry = cap_geometry(striker, contact)
    return None if geometry is None else first_yield(material(striker.material), face, geometry)


def low_pressure_notices(striker: AnyStriker, contact: ContactTable, face: Material) -> Iterator[Notice]:
    """Warn where the largest pressure that was given lies below first yield."""
    first, cap = first_yield_of(striker, contact, face), contact.yield_pressure
    if first is not None and isinstance(cap, Value) and cap.si < first.pressure:
        message = (
            f"contact.yield_pressure, {plain(cap.si / 1e6, 4)}\xa0MPa, is below the "
            f"{plain(first.pressure / 1e6, 4)}\xa0MPa at which the "
            "weaker material first yields inside: the contact is taken as softer than it is"
        )
        yield Notice("yield-pressure-low", message, cap.si, first.pressure)


def yield_notices(striker: AnyStriker, contact: ContactTable, face: Material, peak: float) -> Iterator[Notice]:
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


def joint_yield_notices(case: Case, greatest: Sequence[float]) -> Iterator[Notice]:
    """Warn where an elastic contact between two layers of a stack goes beyond its first yield.

    ``greatest`` are the largest forces of the blow at each joint of the stack, N, to which a preload adds.
    """
    layers = {layer.name: k for k, layer in enumerate(case.stack.layer)}
    for joint in case.stack.joint:
        if joint.kind != "contact" or joint.yield_pressure is not None or joint.radius is None:
            continue
        place = layers[joint.after]
        one, other = case.stack.layer[place : place + 2]
        of_line = "length" in stiffness_law(joint.law or DEFAULT_LAW).needs
        geometry = Geometry(joint.radius.si, length=joint.length.si if of_line and joint.length else None)
        first_body, second_body = (layer_material(x, f"stack.layer.{x.name}") for x in (one, other))
        first = first_yield(first_body, second_body, geometry)
        peak = float(greatest[place]) + (joint.preload.si if joint.preload else 0.0)
        if first is not None and peak > first.load:
            field = f"stack.joint.{joint.after}.yield_pressure"
            message = (
                f"the contact between {one.name} and {other.name} yields below its surface (von Mises) beyond "
                f"{force_words(first.load)} and is loaded with {force_words(peak)}: the elastic law is outside its "
                f'range; give {field}, such as "{AUTO}"'
            )
            yield Notice("contact-yield", message, peak, first.load)


def cushion_notices(case: Case, pressed: Sequence[PressedBlow]) -> Iterator[Notice]:
    """Report how far blows press the cushion of a case's contact, what it gives back, and what stays."""
    contact = case.contact
    if contact is None or contact.law != CUSHION or not pressed:
        return
    cushion, law = cushion_of_contact(contact), cushion_contact(contact)
    thickness, area = cushion.pad.thickness, cushion.pad.area
    most = max(pressed, key=lambda blow: blow.indentation)
    strain = most.indentation / thickness
    message = (
        f"the cushion ({cushion.law}) is pressed to {percent(strain)} of its {plain(thickness * 1e3)}\xa0mm, with "
        "up to "
        f"{plain(most.peak_force / area / 1e6)}\xa0MPa; it gives back {percent(most.restitution**2)} of the work of "
        "that blow"
    )
    if law.cap is not None:
        message += f", and {plain(pressed[-1].residual_indentation * 1e3)}\xa0mm stay after the last one"
    yield Notice("cushion", message, strain, LARGEST_STRAIN, severity=INFO)
    if strain >= LARGEST_STRAIN:
        message = (
            f"the cushion would be pressed to {percent(strain, 0)} of its thickness, which no pad bears: it is too thin"
        )
        yield Notice("cushion-solid", message, strain, LARGEST_STRAIN, severity=FAILED)
    blows = len(pressed)
    if blows > 1 and (cushion.wear.settling or cushion.wear.stiffening):
        message = (
            f"the cushion does not wear within a run: all {blows} blows meet it as it is after contact.cushion."
            "blows_before; its set is kept"
        )
        yield Notice("cushion-wear", message, float(blows), 1.0, severity=INFO)


def force_words(newtons: float) -> str:
    """Return a force in words, N or kN."""
    return f"{plain(newtons)}\xa0N" if newtons < KILO else f"{plain(newtons / KILO)}\xa0kN"
