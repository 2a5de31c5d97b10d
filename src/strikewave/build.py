"""Case in, machine out: the physical checks that only the whole case allows."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import Any, TypeVar

from pydantic import BaseModel

from strikewave.case import Case
from strikewave.contact import DAMPING_LAWS, STIFFNESS_LAWS, Contact, Stiffness, factor, hertz, palmgren
from strikewave.errors import InputError, InputErrors, nearest
from strikewave.machines import Feed, RotaryMachine, Strikers, StruckObject, Turntable
from strikewave.materials import material

T = TypeVar("T")


def contact_stiffness(case: Case) -> Stiffness:
    """Return the contact stiffness of a case's striker on its object.

    Raises
    ------
    InputError
        If the law or a material is unknown.
    """
    striker = material(case.striker.material, "striker.material")
    face = material(case.object.material, "object.material")
    if case.contact.law == "palmgren":
        return palmgren(striker, face, case.striker.contact_length.si)
    if case.contact.law == "hertz":
        return hertz(striker, face, case.striker.nose_radius.si)
    raise InputError("contact.law", case.contact.law, "a stiffness law", nearest(case.contact.law, STIFFNESS_LAWS))


def build_machine(case: Case) -> RotaryMachine:
    """Turn a case into the machine that runs.

    Raises
    ------
    InputError, InputErrors
        With one line for each thing that does not fit together.
    """
    lines = [str(error) for error in _misfits(case)]
    if lines:
        raise InputErrors(lines)
    law = contact_stiffness(case)
    chi = float(factor(case.contact.damping, case.contact.restitution.si))
    nose = case.object.nose_mass.si
    return RotaryMachine(
        turntable=_filled(Turntable, case.machine),
        strikers=_filled(
            Strikers,
            case.striker,
            count=int(case.machine.strikers.si),
            contact=Contact(law.stiffness, law.exponent, chi),
            slowest_approach=case.contact.slowest_approach.si,
        ),
        feed=_filled(Feed, case.feed, blows=int(case.feed.blows.si)),
        struck=_filled(StruckObject, case.object, assembly_mass=case.object.mass.si - nose),
        engagement=case.machine.engagement.si,
    )


def _filled(kind: type[T], table: BaseModel, **others: Any) -> T:
    """Return a part whose fields are the SI values of the same names in a table of the case, or ``others``."""
    names = [field.name for field in dataclasses.fields(kind)]  # type: ignore[arg-type]
    return kind(**{name: others[name] if name in others else getattr(table, name).si for name in names})


def _misfits(case: Case) -> Iterator[InputError]:
    """Yield an error for each pair of values that does not fit together."""
    m, o, f = case.machine, case.object, case.feed
    if case.contact.damping not in DAMPING_LAWS:
        hint = nearest(case.contact.damping, DAMPING_LAWS)
        yield InputError("contact.damping", case.contact.damping, "a damping law", hint)
    if o.nose_mass.si >= o.mass.si:
        yield InputError("object.nose_mass", o.nose_mass.typed, f"less than object.mass ({o.mass.typed})")
    if m.engagement.si >= m.radius.si:
        yield InputError("machine.engagement", m.engagement.typed, f"less than machine.radius ({m.radius.typed})")
    weight = o.mass.si * o.gravity.si
    if o.preload.si <= weight:
        allowed = f"more than the weight along the blow ({weight:.4g} N)"
        yield InputError("object.preload", o.preload.typed, allowed, "the spring must hold the object on its stop")
    if f.stroke.si <= m.engagement.si:
        allowed = f"more than machine.engagement ({m.engagement.typed})"
        yield InputError("feed.stroke", f.stroke.typed, allowed, "a shorter stroke does not clear the strikers")
    drag = m.drag.si * m.speed.si
    if drag >= m.torque.si:
        allowed = f"more than the drag at set speed ({drag:.4g} N m)"
        yield InputError("machine.torque", m.torque.typed, allowed, "the drive cannot hold the speed")
    carried = m.strikers.si * case.striker.mass.si * m.radius.si**2
    if m.inertia.si <= carried:
        allowed = f"more than that of the strikers alone ({carried:.4g} kg m^2)"
        yield InputError("machine.inertia", m.inertia.typed, allowed, "it includes them")
