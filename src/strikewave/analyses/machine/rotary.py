"""Case in, rotary machine out."""

from __future__ import annotations

import dataclasses
import math
from typing import Any, TypeVar

from pydantic import BaseModel

from strikewave.analyses.machine.consistency import inconsistencies
from strikewave.analyses.machine.struck_object import layered_object, object_bodies
from strikewave.base.errors import InputError, InputErrors
from strikewave.base.materials import Material, material
from strikewave.base.quantities import Value
from strikewave.cases.case import Case, RotaryTables
from strikewave.cases.contact_of_case import face_contact, or_else
from strikewave.cases.tables.machine import FeedTable, OwnStriker, RotaryTable
from strikewave.contact import AnyContact
from strikewave.machines import Feed, Machine, RotaryDrive, Strikers, StruckObject, Turntable
from strikewave.machines import Striker as BuiltStriker

T = TypeVar("T")


TableT = TypeVar("TableT", bound=BaseModel)


def _strikers(tables: RotaryTables) -> Strikers:
    """Return the strikers, each with what it has for itself.

    Raises
    ------
    InputError
        If a row names a striker that there is not, or one twice.
    """
    face, count = material(tables.object.material, "object.material"), int(tables.machine.strikers.si)
    own: dict[int, OwnStriker] = {}
    for row in tables.striker.each:
        number = int(row.number.si)
        if number > count or number in own:
            allowed = f"each of the strikers 1 to {count} once at most"
            raise InputError(f"striker.each.{number}.number", row.number.typed, allowed)
        own[number] = row
    common = face_contact(tables.striker, tables.contact, face)
    each = tuple(_striker(tables, own.get(number), common, face) for number in range(1, count + 1))
    contact = tables.contact
    return Strikers(
        each,
        contact.slowest_approach.si,
        contact.yields == "face",
        or_else(contact.friction, 0.0),
        or_else(contact.sliding_damping, 0.0),
    )


def _striker(tables: RotaryTables, own: OwnStriker | None, common: AnyContact, face: Material) -> BuiltStriker:
    """Return one striker, as all are or with what it has for itself."""
    given = {key: value for key, value in own or () if isinstance(value, Value)}
    table, pair = _with_own(tables.striker, given), _with_own(tables.contact, given)
    its_own = bool({"nose_radius", "contact_length", "restitution"} & given.keys())
    contact = face_contact(table, pair, face) if its_own else common
    errors = {key: or_else(getattr(table, key), 0.0) for key in ("angle_error", "reach_error")}
    return _filled(BuiltStriker, table, contact=contact, **errors)


def _with_own(table: TableT, given: dict[str, Value]) -> TableT:
    """Return a table with those of some values that are its own."""
    return table.model_copy(update={key: value for key, value in given.items() if key in type(table).model_fields})


def _turntable(table: RotaryTable) -> Turntable:
    """Return the turntable; motor and belt as it would have them."""
    return _filled(
        Turntable,
        table,
        motor_inertia=or_else(table.motor_inertia, 0.0) * or_else(table.belt_ratio, 1.0) ** 2,
        belt_stiffness=or_else(table.belt_stiffness, math.inf),
        belt_damping=or_else(table.belt_damping, 0.0),
        ripple=or_else(table.speed_ripple, 0.0),
        ripple_order=or_else(table.ripple_order, 1.0),
        ripple_phase=or_else(table.ripple_phase, 0.0),
    )


def build_rotary(case: Case) -> Machine:
    """Turn a case of the rotary machine into the machine that runs; see `build_machine`."""
    tables = case.rotary_tables()
    layered = layered_object(case)
    bodies = object_bodies(case, layered)
    machine = Machine(
        strikers=_strikers(tables),
        struck=_filled(
            StruckObject,
            tables.object,
            **bodies._asdict(),
            friction=or_else(tables.object.friction, 0.0),
            stiction=None if tables.object.stiction is None else tables.object.stiction.si,
            falls=False,
        ),
        start=RotaryDrive(
            turntable=_turntable(tables.machine),
            feed=_feed(tables.feed),
            engagement=tables.machine.engagement.si,
            blow_angle=or_else(tables.machine.blow_angle, 0.0),
            face_width=or_else(tables.machine.face_width, math.inf),
        ),
        layered=layered,
    )
    lines = [str(error) for error in inconsistencies(case, machine)]
    if lines:
        raise InputErrors(lines)
    return machine


def _filled(kind: type[T], table: BaseModel, **others: Any) -> T:
    """Return a part whose fields are the SI values of the same names in a table of the case, or ``others``."""
    names = [field.name for field in dataclasses.fields(kind)]  # type: ignore[arg-type]
    return kind(**{name: others[name] if name in others else getattr(table, name).si for name in names})


def _feed(table: FeedTable) -> Feed:
    return _filled(
        Feed,
        table,
        blows=int(table.blows.si),
        acceleration=or_else(table.acceleration, 0.5),
        cushion=or_else(table.cushion, 0.5),
        hold=or_else(table.hold, math.inf),
    )
