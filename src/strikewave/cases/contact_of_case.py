"""Striker and face of a case in, contact law out."""

from __future__ import annotations

import contextlib
import math

from strikewave.base.constants import Material, material
from strikewave.base.errors import MISSING, InputError, InputErrors, checked
from strikewave.base.quantities import AUTO, Value
from strikewave.cases.case import Case
from strikewave.cases.contact_parts import (
    capped_pressure,
    cushion_of,
    loses_by_rate,
    pressure_of_materials,
    pressure_words,
    refuse_beyond_law,
)
from strikewave.cases.stack_of_case import area_of, layer_material, need, typed
from strikewave.cases.tables.contact import CUSHION, POWER, ContactTable
from strikewave.cases.tables.machine import AnyStriker
from strikewave.contact import (
    AnyContact,
    Geometry,
    LogarithmicStiffness,
    PressureCap,
    Stiffness,
    cap_of,
    damping_law,
    named_contact,
    stiffness_law,
    stiffness_of,
)
from strikewave.contact.cushions import Cushion, cushion_law
from strikewave.contact.elastoplastic import AutomaticPressure

_OF_POWER = ("reference_force", "reference_depth", "exponent")
"""Fields of [contact] that only the law `POWER` takes."""


CUSHION_PATH = "contact.cushion"
"""Path of the cushion of a contact."""
_NOT_OF_A_CUSHION = ("reference_force", "reference_depth", "exponent", "datum_depth", "yield_pressure")
"""Fields of [contact] that a cushion does not take."""


def contact_stiffness(case: Case) -> Stiffness | LogarithmicStiffness:
    """Return the contact stiffness of a case's striker on its object."""
    parts = case.impact()
    return face_stiffness(parts.striker, parts.contact, struck_material(case))


def struck_material(case: Case) -> Material:
    """Return the material of the struck face: that of the object, or of a bar's first layer."""
    if case.object is not None:
        return material(case.object.material, "object.material")
    first = case.stack.layer[0]
    return layer_material(first, f"stack.layer.{first.name}")


def automatic_pressures(case: Case) -> dict[str, AutomaticPressure]:
    """Return the pressures of contacts whose yield pressure is "auto", by its path; none of a contact that is refused.

    Examples
    --------
    >>> from strikewave import load_case
    >>> pressures = automatic_pressures(load_case("iso-16063-22-dropball"))
    >>> [(path, round(pressure.best / 1e9, 2)) for path, pressure in pressures.items()]
    [('contact.yield_pressure', 2.02)]
    """
    pressures, layers = dict[str, AutomaticPressure](), case.stack.layer
    if case.contact is not None and case.contact.yield_pressure == AUTO and case.striker is not None:
        path = "contact.yield_pressure"
        with contextlib.suppress(InputError, ValueError):
            nose = material(case.striker.material, "striker.material")
            pressures[path] = pressure_of_materials(nose, struck_material(case), path)
    for joint in case.stack.joint:
        if joint.yield_pressure == AUTO:
            path = f"stack.joint.{joint.after}.yield_pressure"
            with contextlib.suppress(InputError, ValueError):  # a joint behind no layer, or the last
                first = [layer.name for layer in layers].index(joint.after)
                one, other = [layer_material(row, f"stack.layer.{row.name}") for row in layers[first : first + 2]]
                pressures[path] = pressure_of_materials(one, other, path)
    return pressures


def contact_source(case: Case) -> str:
    """Return the key of the source of a case's contact law; empty where it is that of the case itself."""
    contact = case.impact().contact
    if contact.law == CUSHION:
        return cushion_law(cushion_of_contact(contact).law).source
    return contact_stiffness(case).source


def _power_stiffness(contact: ContactTable) -> Stiffness:
    """Return the stiffness of a power law that is given by a force at a depth, K = F/d^n."""
    hint = f'for the law {POWER}, such as reference_force = "10 kN" at reference_depth = "1 mm"'
    force = need(contact.reference_force, "contact.reference_force", "a force on the curve", hint)
    depth = need(contact.reference_depth, "contact.reference_depth", "the depth at that force", hint)
    exponent = or_else(contact.exponent, 1.0)
    return Stiffness(force / depth**exponent, exponent, POWER)


def _nose_geometry(striker: AnyStriker, contact: ContactTable, depth: float | None) -> Geometry:
    """Return the sizes of a nose on a plane face, or refuse one that the law needs and the case leaves out."""
    sizes = {"radius1": striker.nose_radius, "length": striker.contact_length}
    for (need_of, size), key in zip(sizes.items(), ("nose_radius", "contact_length"), strict=True):
        if size is None and need_of in stiffness_law(contact.law).needs:
            raise InputError(f"striker.{key}", MISSING, f"a length, for the law {contact.law}", f'{key} = "10 mm"')
    length = striker.contact_length.si if striker.contact_length else None
    return Geometry(or_else(striker.nose_radius, math.inf), math.inf, length, depth)


def face_stiffness(striker: AnyStriker, contact: ContactTable, face: Material) -> Stiffness | LogarithmicStiffness:
    """Return the contact stiffness of a striker on a plane face of a material."""
    nose = material(striker.material, "striker.material")
    if contact.law == POWER:
        return _power_stiffness(contact)
    for key in _OF_POWER:
        value = getattr(contact, key)
        if value is not None:
            raise InputError(f"contact.{key}", value.typed, f"only for the law {POWER}", "remove it")
    needs = stiffness_law(contact.law, "contact.law").needs
    depth = contact.datum_depth.si if contact.datum_depth else None
    if contact.datum_depth is not None and "datum_depth" not in needs:
        raise InputError(
            "contact.datum_depth", contact.datum_depth.typed, f"none for the law {contact.law}", "remove it"
        )
    if depth is None and "datum_depth" in needs:
        allowed = f"how deep the struck body is, for the law {contact.law} on a plane face"
        raise InputError("contact.datum_depth", MISSING, allowed, 'such as datum_depth = "30 mm"')
    geometry = _nose_geometry(striker, contact, depth)
    return stiffness_of(contact.law, nose, face, geometry, "contact.law")


def pressure_cap(striker: AnyStriker, contact: ContactTable, face: Material) -> PressureCap | None:
    """Return the cap on the pressure of a striker on a face, where the case has one."""
    if contact.yield_pressure is None:
        if contact.yields != "face":
            allowed = "only with contact.yield_pressure: nothing yields without it"
            raise InputError("contact.yields", contact.yields, allowed, "add the pressure, or remove it")
        return None
    geometry = cap_geometry(striker, contact)
    if geometry is None:
        allowed = f"only with striker.nose_radius, and not for the law {POWER}"
        raise InputError("contact.yield_pressure", pressure_words(contact.yield_pressure), allowed, "remove it")
    nose = material(striker.material, "striker.material")
    return cap_of(nose, face, geometry, capped_pressure(contact.yield_pressure, nose, face, "contact.yield_pressure"))


def cap_geometry(striker: AnyStriker, contact: ContactTable) -> Geometry | None:
    """Return the sizes on which a pressure acts, a line's where the law needs a length; None where none are known."""
    if contact.law in (POWER, CUSHION) or striker.nose_radius is None:
        return None
    of_line = "length" in stiffness_law(contact.law, "contact.law").needs
    length = striker.contact_length.si if of_line and striker.contact_length else None
    return Geometry(striker.nose_radius.si, length=length)


def face_contact(striker: AnyStriker, contact: ContactTable, face: Material) -> AnyContact:
    """Return the contact of a striker on a face: stiffness, damping, and a cap on the pressure."""
    damping_law(contact.damping, "contact.damping")
    if contact.law == CUSHION:
        return cushion_contact(contact)
    if contact.cushion is not None:  # a pad beside another contact law would do nothing
        allowed = f'"{CUSHION}" where the case has [{CUSHION_PATH}]'
        raise InputError("contact.law", contact.law, allowed, f"or remove [{CUSHION_PATH}]")
    stiffness, cap = face_stiffness(striker, contact, face), pressure_cap(striker, contact, face)
    if cap is not None and contact.yield_pressure is not None:
        field, nose = "contact.yield_pressure", material(striker.material, "striker.material")
        pressure = capped_pressure(contact.yield_pressure, nose, face, field)
        refuse_beyond_law(cap, stiffness, pressure_words(contact.yield_pressure), field, pressure)
    return named_contact(stiffness, contact.damping, contact.restitution.si, cap)


def cushion_of_contact(contact: ContactTable) -> Cushion:
    """Return the cushion of [contact]."""
    if contact.cushion is None:
        raise InputError(
            CUSHION_PATH, MISSING, "a pad for the law cushion", f"add [{CUSHION_PATH}] with its thickness and area"
        )
    foreign = {key: value for key in _NOT_OF_A_CUSHION if (value := getattr(contact, key)) is not None}
    if foreign:
        allowed, hint = "none for the law cushion", "remove it from the file"
        faults = [InputError(f"contact.{key}", typed(value), allowed, hint) for key, value in foreign.items()]
        raise InputErrors(map(str, faults))
    return cushion_of(contact.cushion, CUSHION_PATH, area_of(contact.cushion, CUSHION_PATH))


def cushion_contact(contact: ContactTable) -> AnyContact:
    """Return the force law of the cushion of [contact], with the damping of the contact."""
    loss = _second_loss(contact)
    try:
        cushion = cushion_of_contact(contact)
    except InputError as error:
        raise InputErrors([*str(error).splitlines(), *loss]) from None
    if loss:
        raise InputErrors(loss)
    return checked(CUSHION_PATH, lambda: cushion.contact(contact.damping, contact.restitution.si))


def _second_loss(contact: ContactTable) -> list[str]:
    """Return the fault of a restitution beside a cushion that has a loss of its own: one line, or none."""
    if contact.cushion is None or contact.restitution.si == 1.0 or not loses_by_rate(contact.cushion):
        return []
    of_law = contact.cushion.retardation is None and contact.cushion.loss_factor is None
    has = f"the retardation of the law {contact.cushion.law}" if of_law else "a retardation or a loss factor"
    allowed, hint = f"1 where the cushion has {has}: it loses energy in one way", "write restitution = 1"
    return [str(InputError("contact.restitution", contact.restitution.typed, allowed, hint))]


def refuse_sliding(contact: ContactTable) -> None:
    """Refuse friction across the face where no nose slides: in all but the rotary machine."""
    for key in ("friction", "sliding_damping"):
        value = getattr(contact, key)
        if value is not None:
            allowed = 'none but with machine.kind = "rotary": other strikers meet the face without sliding across it'
            raise InputError(f"contact.{key}", value.typed, allowed, "remove it")


def or_else(value: Value | None, default: float) -> float:
    """Return a quantity in SI, or its default where it is left out."""
    return default if value is None else value.si
