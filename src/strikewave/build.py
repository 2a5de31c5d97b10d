"""Case in, machine out: the physical checks that only the whole case allows."""

from __future__ import annotations

from collections.abc import Iterator

from strikewave.case import Case
from strikewave.contact import DAMPING_LAWS, STIFFNESS_LAWS, Contact, Stiffness, factor, hertz, palmgren
from strikewave.errors import InputError, InputErrors, nearest
from strikewave.machines import Feed, RotaryMachine, Strikers, StruckObject, Turntable
from strikewave.materials import material


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
    m, s, o, f = case.machine, case.striker, case.object, case.feed
    law = contact_stiffness(case)
    chi = float(factor(case.contact.damping, case.contact.restitution.si))
    return RotaryMachine(
        turntable=Turntable(
            inertia=m.inertia.si,
            radius=m.radius.si,
            speed=m.speed.si,
            torque=m.torque.si,
            speed_gain=m.speed_gain.si,
            drag=m.drag.si,
            brake=m.brake.si,
        ),
        strikers=Strikers(
            count=int(m.strikers.si),
            mass=s.mass.si,
            mount_stiffness=s.mount_stiffness.si,
            mount_damping=s.mount_damping.si,
            contact=Contact(law.stiffness, law.exponent, chi),
            slowest_approach=case.contact.slowest_approach.si,
        ),
        feed=Feed(
            wait=f.wait.si,
            valve_delay=f.valve_delay.si,
            stroke=f.stroke.si,
            stroke_time=f.stroke_time.si,
            arrival=f.arrival.si,
            blows=int(f.blows.si),
            release_delay=f.release_delay.si,
            retract_time=f.retract_time.si,
        ),
        struck=StruckObject(
            nose_mass=o.nose_mass.si,
            assembly_mass=o.mass.si - o.nose_mass.si,
            frame_stiffness=o.frame_stiffness.si,
            frame_damping=o.frame_damping.si,
            spring=o.spring.si,
            preload=o.preload.si,
            damper=o.damper.si,
            stop_stiffness=o.stop_stiffness.si,
            stop_restitution=o.stop_restitution.si,
            gravity=o.gravity.si,
        ),
        engagement=m.engagement.si,
    )


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
