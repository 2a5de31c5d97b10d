"""Case in, machine out: the physical checks that only the whole case allows."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from typing import Any, TypeVar

from pydantic import BaseModel

from strikewave.case import Case
from strikewave.contact import DAMPING_LAWS, STIFFNESS_LAWS, Contact, Stiffness, factor, hertz, palmgren
from strikewave.errors import InputError, InputErrors, nearest
from strikewave.machines import Feed, RotaryMachine, Strikers, StruckObject, Turntable
from strikewave.machines.feed import expected_time
from strikewave.materials import material

T = TypeVar("T")

MOST_SAMPLES = 2e6
"""Samples of the whole train beyond which a solution is refused."""
LONGEST_INTERVAL = 0.5
"""Longest time between strikers, s: the bodies between two blows are followed in full."""


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
        feed=_feed(case),
        struck=_filled(StruckObject, case.object, assembly_mass=case.object.mass.si - nose),
        engagement=case.machine.engagement.si,
    )


def _filled(kind: type[T], table: BaseModel, **others: Any) -> T:
    """Return a part whose fields are the SI values of the same names in a table of the case, or ``others``."""
    names = [field.name for field in dataclasses.fields(kind)]  # type: ignore[arg-type]
    return kind(**{name: others[name] if name in others else getattr(table, name).si for name in names})


def _feed(case: Case) -> Feed:
    return _filled(Feed, case.feed, blows=int(case.feed.blows.si))


def _misfits(case: Case) -> Iterator[InputError]:
    """Yield an error for each pair of values that does not fit together."""
    m, o, f = case.machine, case.object, case.feed
    if case.contact.damping not in DAMPING_LAWS:
        hint = nearest(case.contact.damping, DAMPING_LAWS)
        yield InputError("contact.damping", case.contact.damping, "a damping law", hint)
    if o.nose_mass.si >= o.mass.si:
        yield InputError("object.nose_mass", o.nose_mass.typed, f"less than object.mass ({o.mass.typed})")
    reach = m.radius.si * (1.0 - math.cos(min(0.5 * math.pi, math.pi / m.strikers.si)))
    if m.engagement.si >= reach:
        allowed = f"less than {reach * 1e3:.4g} mm, where a nose would touch more than half a pitch before its apex"
        yield InputError("machine.engagement", m.engagement.typed, allowed)
    stretch = case.striker.mass.si * m.speed.si**2 / case.striker.mount_stiffness.si
    if stretch > 0.1:
        allowed = f"enough to hold the striker on its circle (it would stretch by {stretch:.0%} of the radius)"
        yield InputError("striker.mount_stiffness", case.striker.mount_stiffness.typed, allowed)
    interval = 2.0 * math.pi / (m.speed.si * m.strikers.si)
    samples = expected_time(_feed(case), interval) / case.solver.output_step.si
    if samples > MOST_SAMPLES:
        allowed = f"a step that keeps the train below {MOST_SAMPLES:.0e} samples (here {samples:.1e})"
        yield InputError("solver.output_step", case.solver.output_step.typed, allowed)
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
    if interval > LONGEST_INTERVAL:
        allowed = f"a striking interval of at most {LONGEST_INTERVAL:g} s (here {interval:.3g} s)"
        yield InputError("machine.speed", m.speed.typed, allowed, "turn faster, or take more strikers")
    sag = o.nose_mass.si * abs(o.gravity.si) / o.frame_stiffness.si
    if sag > 0.01 * m.engagement.si:
        allowed = f"enough to carry the nose (its weight bends the frame by {sag * 1e3:.3g} mm)"
        yield InputError("object.frame_stiffness", o.frame_stiffness.typed, allowed)
    carried = m.strikers.si * case.striker.mass.si * m.radius.si**2
    if m.inertia.si <= carried:
        allowed = f"more than that of the strikers alone ({carried:.4g} kg m^2)"
        yield InputError("machine.inertia", m.inertia.typed, allowed, "it includes them")
