"""Case in, machine out, with the checks that only the whole case allows."""

from __future__ import annotations

import dataclasses
import math
from typing import Any, NamedTuple, TypeVar

from pydantic import BaseModel

from strikewave.analyses.machine.consistency import misfits
from strikewave.base.errors import MISSING, InputError, InputErrors, nearest
from strikewave.base.materials import Material, material
from strikewave.base.quantities import Value
from strikewave.cases.case import Case, Rig
from strikewave.cases.contact_of_case import face_contact, or_else
from strikewave.cases.stack_of_case import build_stack, build_taps, checked
from strikewave.cases.tables import FeedTable, OwnStriker
from strikewave.cases.tables import Machine as MachineTable
from strikewave.contact import (
    AnyContact,
)
from strikewave.machines import Feed, RotaryMachine, Strikers, StruckObject, Turntable
from strikewave.machines import Striker as BuiltStriker
from strikewave.machines.layered import LayeredObject, machine_grid
from strikewave.waves import Stack

T = TypeVar("T")
TableT = TypeVar("TableT", bound=BaseModel)

FINEST_STEP, COARSEST_STEP = 1e-9, 1e-6
"""Time steps of a struck stack, s: finer ones take minutes, coarser ones lose the contact."""
MOST_STACK_BLOWS = 100
"""Most blows on a stack: about 1 MB of waves is kept of each."""


def _strikers(rig: Rig) -> Strikers:
    """Return the strikers, each with what it has for itself.

    Raises
    ------
    InputError
        If a row names a striker that there is not, or one twice.
    """
    face, count = material(rig.object.material, "object.material"), int(rig.machine.strikers.si)
    own: dict[int, OwnStriker] = {}
    for row in rig.striker.each:
        number = int(row.number.si)
        if number > count or number in own:
            allowed = f"each of the strikers 1 to {count} once at most"
            raise InputError(f"striker.each.{number}.number", row.number.typed, allowed)
        own[number] = row
    common = face_contact(rig.striker, rig.contact, face)
    each = tuple(_striker(rig, own.get(number), common, face) for number in range(1, count + 1))
    return Strikers(each, rig.contact.slowest_approach.si, rig.contact.yields == "face")


def _striker(rig: Rig, own: OwnStriker | None, common: AnyContact, face: Material) -> BuiltStriker:
    """Return one striker, as all are or with what it has for itself."""
    given = {key: value for key, value in own or () if isinstance(value, Value)}
    table, pair = _with_own(rig.striker, given), _with_own(rig.contact, given)
    its_own = bool({"nose_radius", "contact_length", "restitution"} & given.keys())
    contact = face_contact(table, pair, face) if its_own else common
    errors = {key: or_else(getattr(table, key), 0.0) for key in ("angle_error", "reach_error")}
    return _filled(BuiltStriker, table, contact=contact, **errors)


def _with_own(table: TableT, given: dict[str, Value]) -> TableT:
    """Return a table with those of some values that are its own."""
    return table.model_copy(update={key: value for key, value in given.items() if key in type(table).model_fields})


def _turntable(table: MachineTable) -> Turntable:
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


def build_machine(case: Case) -> RotaryMachine:
    """Turn a case into the machine that runs.

    Raises
    ------
    InputError, InputErrors
        With one line for each thing that does not fit together.
    """
    from strikewave.analyses.machine.launched import build_launched

    return _rotary(case) if case.launched() is None else build_launched(case)


def _rotary(case: Case) -> RotaryMachine:
    rig = case.rig()
    layered = layered_object(case)
    bodies = object_bodies(case, layered)
    machine = RotaryMachine(
        turntable=_turntable(rig.machine),
        strikers=_strikers(rig),
        feed=_feed(rig.feed),
        struck=_filled(
            StruckObject,
            rig.object,
            **bodies._asdict(),
            friction=or_else(rig.object.friction, 0.0),
            stiction=None if rig.object.stiction is None else rig.object.stiction.si,
        ),
        engagement=rig.machine.engagement.si,
        layered=layered,
        blow_angle=or_else(rig.machine.blow_angle, 0.0),
        face_width=or_else(rig.machine.face_width, math.inf),
    )
    lines = [str(error) for error in misfits(case, machine)]
    if lines:
        raise InputErrors(lines)
    return machine


class Bodies(NamedTuple):
    """The object as two bodies on a frame, SI."""

    nose_mass: float
    assembly_mass: float
    frame_stiffness: float
    frame_damping: float


_OF_BODIES = ("mass", "nose_mass", "frame_stiffness", "frame_damping")


def _refuse_waves_alone(case: Case, stack: Stack) -> None:
    """Refuse what only a bar alone can have: other solvers than delay lines, oscillators, contacts between layers.

    Raises
    ------
    InputError
        If the case has it.
    """
    hint = "`strikewave wave` takes it, for the stack under a [load]"
    if case.solver.method == "spectral":
        raise InputError("solver.method", case.solver.method, "auto or delay lines where a machine strikes", hint)
    if case.solver.dispersion != "none":
        raise InputError("solver.dispersion", case.solver.dispersion, "none where a machine strikes", hint)
    for table, layer in zip(case.stack.layer, stack.layers, strict=True):
        if layer.loss is not None and table.loss_factor is not None:
            allowed = "no loss in a layer that a machine strikes"
            raise InputError(f"stack.layer.{layer.name}.loss_factor", table.loss_factor.typed, allowed, hint)
    for layer, joint in zip(stack.layers, stack.joints, strict=False):
        if joint.kind in ("oscillator", "contact"):
            allowed = "bonded, compliant, gasket, unilateral or mass where a machine strikes"
            raise InputError(f"stack.joint.{layer.name}.kind", joint.kind, allowed, hint)


def layered_object(case: Case) -> LayeredObject | None:
    """Return the object as a stack, if the case has one."""
    table = case.impact().object
    if not case.stack.layer:
        return None
    given = [key for key in _OF_BODIES if getattr(table, key) is not None]
    if given:
        allowed = "none of " + ", ".join(_OF_BODIES) + " where the object is a stack: they follow from it"
        raise InputError(f"object.{given[0]}", getattr(table, given[0]).typed, allowed, "remove it")
    names = [layer.name for layer in case.stack.layer]
    if table.assembly not in names[1:]:
        allowed = "the first layer of the part that carries the sensor, not the struck one"
        hint = nearest(table.assembly, names[1:]) if names[1:] else "cut the object in two layers at least"
        raise InputError("object.assembly", table.assembly or MISSING, allowed, hint)
    stack = build_stack(case)
    _refuse_waves_alone(case, stack)
    if stack.end.kind != "free":
        allowed = "free: spring, damper and stop of [object] hold the end"
        raise InputError("stack.end.kind", stack.end.kind, allowed, "`strikewave wave` takes every end")
    moving = next((layer for layer in stack.layers if layer.speed), None)
    if moving is not None:
        raise InputError(f"stack.layer.{moving.name}.speed", moving.speed, "no speed of its own: a striker hits it")
    frame = stack.joints[names.index(table.assembly) - 1]
    if frame.mass > 0.0 or (frame.unilateral and frame.preload == 0.0):
        allowed = "a joint that holds: the frame before the assembly is bonded, compliant, gasket or preloaded"
        raise InputError(f"stack.joint.{names[names.index(table.assembly) - 1]}.kind", frame.kind, allowed)
    if case.feed is not None and case.feed.blows.si > MOST_STACK_BLOWS:
        allowed = f"at most {MOST_STACK_BLOWS} where the object is a stack"
        raise InputError("feed.blows", case.feed.blows.typed, allowed, "its waves are kept for each blow")
    step = case.solver.step.si if case.solver.step else None
    if step is not None and not FINEST_STEP <= step <= COARSEST_STEP:
        allowed = f"{FINEST_STEP * 1e9:g} to {COARSEST_STEP * 1e9:g} ns where a machine strikes a stack"
        raise InputError(
            "solver.step", case.solver.step.typed if case.solver.step else step, allowed, "or leave it out"
        )
    grid = checked("solver.step", lambda: machine_grid(stack, step))
    taps = tuple((tap.layer, tap.position) for _, tap in build_taps(case))
    return LayeredObject(stack, names.index(table.assembly), grid, taps)


def object_bodies(case: Case, layered: LayeredObject | None) -> Bodies:
    """Return nose, frame and assembly: as the case gives them, or as they follow from the stack."""
    if layered is not None:
        return Bodies(layered.nose_mass, layered.assembly_mass, layered.frame_stiffness, layered.frame_damping)
    table = case.impact().object
    if table.assembly:
        raise InputError("object.assembly", table.assembly, "only where the object is a stack", "add [[stack.layer]]")
    missing = [f"object.{key}: missing; add {key}, or describe the object by [[stack.layer]]" for key in _OF_BODIES]
    missing = [line for line, key in zip(missing, _OF_BODIES, strict=True) if getattr(table, key) is None]
    if missing:
        raise InputErrors(missing)
    mass, nose, stiffness, damping = (getattr(table, key) for key in _OF_BODIES)
    if nose.si >= mass.si:
        raise InputError("object.nose_mass", nose.typed, f"less than object.mass ({mass.typed})")
    return Bodies(nose.si, mass.si - nose.si, stiffness.si, damping.si)


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
