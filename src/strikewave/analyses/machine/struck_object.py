"""The struck object of a case: two bodies on a frame, or a stack of layers."""

from __future__ import annotations

from typing import NamedTuple

from strikewave.base.errors import MISSING, InputError, InputErrors, checked, nearest
from strikewave.cases.case import Case
from strikewave.cases.stack_of_case import build_stack, build_taps
from strikewave.machines.struck_object import LayeredObject, machine_grid
from strikewave.waves import Stack

FINEST_STEP, COARSEST_STEP = 1e-9, 1e-6
"""Time steps of a struck stack, s: finer ones take minutes, coarser ones lose the contact."""
MOST_STACK_BLOWS = 100
"""Most blows on a stack: about 1 MB of waves is kept of each."""
_OF_BODIES = ("mass", "nose_mass", "frame_stiffness", "frame_damping")


class Bodies(NamedTuple):
    """The object as two bodies on a frame, SI."""

    nose_mass: float
    assembly_mass: float
    frame_stiffness: float
    frame_damping: float


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
