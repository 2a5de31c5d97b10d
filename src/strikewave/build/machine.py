"""Case in, machine out, with the checks that only the whole case allows."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from typing import Any, NamedTuple, TypeVar

from pydantic import BaseModel

from strikewave.build.stack import build_stack, build_taps, checked
from strikewave.case import Case
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
from strikewave.errors import MISSING, InputError, InputErrors, nearest
from strikewave.machines import Feed, RotaryMachine, Strikers, StruckObject, Turntable
from strikewave.machines.feed import expected_time
from strikewave.machines.layered import LayeredObject, machine_grid
from strikewave.materials import Material, material
from strikewave.tables import ContactTable, FeedTable, Striker
from strikewave.waves import Stack

T = TypeVar("T")

MOST_SAMPLES = 2e6
"""Samples of the whole train beyond which a solution is refused."""
FINEST_STEP, COARSEST_STEP = 1e-9, 1e-6
"""Time steps of a struck stack, s: finer ones take minutes, coarser ones lose the contact."""
MOST_STACK_BLOWS = 100
"""Most blows on a stack: about 1 MB of waves is kept of each."""
LONGEST_INTERVAL = 0.5
"""Longest time between strikers, s: the bodies between two blows are followed in full."""


def contact_stiffness(case: Case) -> Stiffness | LogarithmicStiffness:
    """Return the contact stiffness of a case's striker on its object.

    Raises
    ------
    InputError
        If the law or a material is unknown.
    """
    rig = case.rig()
    face = material(rig.object.material, "object.material")
    return face_stiffness(rig.striker, rig.contact, face)


def face_stiffness(striker: Striker, contact: ContactTable, face: Material) -> Stiffness | LogarithmicStiffness:
    """Return the contact stiffness of a striker on a plane face of a material."""
    nose = material(striker.material, "striker.material")
    needs = stiffness_law(contact.law, "contact.law").needs
    depth = contact.datum_depth.si if contact.datum_depth else None
    if contact.datum_depth is not None and "datum_depth" not in needs:
        raise InputError(
            "contact.datum_depth", contact.datum_depth.typed, f"none for the law {contact.law}", "remove it"
        )
    if depth is None and "datum_depth" in needs:
        allowed = f"how deep the struck body is, for the law {contact.law} on a plane face"
        raise InputError("contact.datum_depth", MISSING, allowed, 'such as datum_depth = "30 mm"')
    geometry = Geometry(striker.nose_radius.si, math.inf, striker.contact_length.si, depth)
    return stiffness_of(contact.law, nose, face, geometry, "contact.law")


def pressure_cap(striker: Striker, contact: ContactTable, face: Material) -> PressureCap | None:
    """Return the cap on the pressure of a striker on a face, where the case has one."""
    if contact.yield_pressure is None:
        if contact.yields != "face":
            allowed = "only with contact.yield_pressure: nothing yields without it"
            raise InputError("contact.yields", contact.yields, allowed, "add the pressure, or remove it")
        return None
    nose = material(striker.material, "striker.material")
    of_line = "length" in stiffness_law(contact.law, "contact.law").needs
    geometry = Geometry(striker.nose_radius.si, length=striker.contact_length.si if of_line else None)
    return cap_of(nose, face, geometry, contact.yield_pressure.si)


def face_contact(striker: Striker, contact: ContactTable, face: Material) -> AnyContact:
    """Return the contact of a striker on a face: stiffness, damping, and a cap on the pressure."""
    damping_law(contact.damping, "contact.damping")
    stiffness, cap = face_stiffness(striker, contact, face), pressure_cap(striker, contact, face)
    return named_contact(stiffness, contact.damping, contact.restitution.si, cap)


def build_machine(case: Case) -> RotaryMachine:
    """Turn a case into the machine that runs.

    Raises
    ------
    InputError, InputErrors
        With one line for each thing that does not fit together.
    """
    rig = case.rig()
    layered = _layered(case)
    bodies = _bodies(case, layered)
    lines = [str(error) for error in _misfits(case, bodies)]
    if lines:
        raise InputErrors(lines)
    return RotaryMachine(
        turntable=_filled(Turntable, rig.machine),
        strikers=_filled(
            Strikers,
            rig.striker,
            count=int(rig.machine.strikers.si),
            contact=face_contact(rig.striker, rig.contact, material(rig.object.material, "object.material")),
            same_spot=rig.contact.yields == "face",
            slowest_approach=rig.contact.slowest_approach.si,
        ),
        feed=_feed(rig.feed),
        struck=_filled(StruckObject, rig.object, **bodies._asdict()),
        engagement=rig.machine.engagement.si,
        layered=layered,
    )


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


def _layered(case: Case) -> LayeredObject | None:
    """Return the object as a stack, if the case has one."""
    table = case.rig().object
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
    if case.rig().feed.blows.si > MOST_STACK_BLOWS:
        allowed = f"at most {MOST_STACK_BLOWS} where the object is a stack"
        raise InputError("feed.blows", case.rig().feed.blows.typed, allowed, "its waves are kept for each blow")
    step = case.solver.step.si if case.solver.step else None
    if step is not None and not FINEST_STEP <= step <= COARSEST_STEP:
        allowed = f"{FINEST_STEP * 1e9:g} to {COARSEST_STEP * 1e9:g} ns where a machine strikes a stack"
        raise InputError(
            "solver.step", case.solver.step.typed if case.solver.step else step, allowed, "or leave it out"
        )
    grid = checked("solver.step", lambda: machine_grid(stack, step))
    taps = tuple((tap.layer, tap.position) for _, tap in build_taps(case))
    return LayeredObject(stack, names.index(table.assembly), grid, taps)


def _bodies(case: Case, layered: LayeredObject | None) -> Bodies:
    """Return nose, frame and assembly: as the case gives them, or as they follow from the stack."""
    if layered is not None:
        return Bodies(layered.nose_mass, layered.assembly_mass, layered.frame_stiffness, layered.frame_damping)
    table = case.rig().object
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
    return _filled(Feed, table, blows=int(table.blows.si))


def _misfits(case: Case, bodies: Bodies) -> Iterator[InputError]:
    """Yield an error for each pair of values that does not fit together."""
    m, striker, f, o, _, _ = case.rig()
    reach = m.radius.si * (1.0 - math.cos(min(0.5 * math.pi, math.pi / m.strikers.si)))
    if m.engagement.si >= reach:
        allowed = f"less than {reach * 1e3:.4g} mm, where a nose would touch more than half a pitch before its apex"
        yield InputError("machine.engagement", m.engagement.typed, allowed)
    stretch = striker.mass.si * m.speed.si**2 / striker.mount_stiffness.si
    if stretch > 0.1:
        allowed = f"enough to hold the striker on its circle (it would stretch by {stretch:.0%} of the radius)"
        yield InputError("striker.mount_stiffness", striker.mount_stiffness.typed, allowed)
    interval = 2.0 * math.pi / (m.speed.si * m.strikers.si)
    samples = expected_time(_feed(f), interval) / case.solver.output_step.si
    if samples > MOST_SAMPLES:
        allowed = f"a step that keeps the train below {MOST_SAMPLES:.0e} samples (here {samples:.1e})"
        yield InputError("solver.output_step", case.solver.output_step.typed, allowed)
    weight = (bodies.nose_mass + bodies.assembly_mass) * o.gravity.si
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
    if interval > LONGEST_INTERVAL:
        allowed = f"a striking interval of at most {LONGEST_INTERVAL:g} s (here {interval:.3g} s)"
        yield InputError("machine.speed", m.speed.typed, allowed, "turn faster, or take more strikers")
    sag = bodies.nose_mass * abs(o.gravity.si) / bodies.frame_stiffness
    if sag > 0.01 * m.engagement.si:
        allowed = f"enough to carry the nose (its weight bends the frame by {sag * 1e3:.3g} mm)"
        yield InputError("object.frame_stiffness", f"{bodies.frame_stiffness:.4g} N/m", allowed)
    carried = m.strikers.si * striker.mass.si * m.radius.si**2
    if m.inertia.si <= carried:
        allowed = f"more than that of the strikers alone ({carried:.4g} kg m^2)"
        yield InputError("machine.inertia", m.inertia.typed, allowed, "it includes them")
