"""Case in, solution out: build the machine, run it, and set the published numbers beside it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from statistics import median

import numpy as np

from strikewave import citations
from strikewave.case import Case
from strikewave.contact import STIFFNESS_LAWS, Contact, factor, line_contact_yield_load, solve_impact
from strikewave.contact.stiffness import Stiffness
from strikewave.errors import InputError, InputErrors, nearest
from strikewave.machines import Blow, Feed, RotaryMachine, Strikers, StruckObject, Turntable, blows, run_rotary
from strikewave.machines.rotary import RotaryRun
from strikewave.materials import material
from strikewave.solution import Comparison, Notice, RigidReference, Solution, build_dataset

LEDGER_LIMIT = 1e-6
"""Energy or momentum missing beyond this share breaks a stated limit."""


def contact_stiffness(case: Case) -> Stiffness:
    """Return the contact stiffness of a case's striker on its object.

    Raises
    ------
    InputError
        If the law or a material is unknown.
    """
    striker, face = material(case.striker.material, "striker.material"), material(case.object.material, "object.material")
    if case.contact.law == "palmgren":
        return STIFFNESS_LAWS["palmgren"](striker, face, case.striker.contact_length.si)
    if case.contact.law == "hertz":
        return STIFFNESS_LAWS["hertz"](striker, face, case.striker.nose_radius.si)
    raise InputError("contact.law", case.contact.law, "a stiffness law", nearest(case.contact.law, STIFFNESS_LAWS))


def build_machine(case: Case) -> RotaryMachine:
    """Turn a case into the machine that runs, and check what only the whole can tell.

    Raises
    ------
    InputError, InputErrors
        With one line for each thing that does not fit together.
    """
    m, o, f = case.machine, case.object, case.feed
    lines = [str(InputError(path, got, allowed, hint)) for wrong, path, got, allowed, hint in (
        (o.nose_mass.si >= o.mass.si, "object.nose_mass", o.nose_mass.typed, f"less than object.mass ({o.mass.typed})", ""),
        (m.engagement.si >= m.radius.si, "machine.engagement", m.engagement.typed, f"less than machine.radius ({m.radius.typed})", ""),
        (
            o.preload.si <= o.mass.si * o.gravity.si, "object.preload", o.preload.typed,
            f"more than the weight along the blow ({o.mass.si * o.gravity.si:.4g} N)", "the spring must hold the object against its stop",
        ),
        (f.stroke.si <= m.engagement.si, "feed.stroke", f.stroke.typed, f"more than machine.engagement ({m.engagement.typed})", "a shorter stroke does not clear the strikers"),
        (
            m.drag.si * m.speed.si >= m.torque.si, "machine.torque", m.torque.typed,
            f"more than the drag at set speed ({m.drag.si * m.speed.si:.4g} N m)", "the drive cannot hold the speed",
        ),
        (
            m.inertia.si <= m.strikers.si * case.striker.mass.si * m.radius.si**2, "machine.inertia", m.inertia.typed,
            f"more than that of the strikers alone ({m.strikers.si * case.striker.mass.si * m.radius.si**2:.4g} kg m^2)", "it includes them",
        ),
    ) if wrong]
    if lines:
        raise InputErrors(lines)
    law = contact_stiffness(case)
    try:
        chi = float(factor(case.contact.damping, case.contact.restitution.si))
    except InputError as error:
        raise InputError("contact.damping", error.got, error.allowed, error.hint) from None
    return RotaryMachine(
        turntable=Turntable(m.inertia.si, m.radius.si, m.speed.si, m.torque.si, m.speed_gain.si, m.drag.si, m.brake.si),
        strikers=Strikers(
            int(m.strikers.si), case.striker.mass.si, case.striker.mount_stiffness.si, case.striker.mount_damping.si,
            Contact(law.stiffness, law.exponent, chi), case.contact.slowest_approach.si,
        ),
        feed=Feed(
            f.wait.si, f.valve_delay.si, f.stroke.si, f.stroke_time.si, f.arrival.si, int(f.blows.si),
            f.release_delay.si, f.retract_time.si,
        ),
        struck=StruckObject(
            o.nose_mass.si, o.mass.si - o.nose_mass.si, o.frame_stiffness.si, o.frame_damping.si,
            o.spring.si, o.preload.si, o.damper.si, o.stop_stiffness.si, o.stop_restitution.si, o.gravity.si,
        ),
        engagement=m.engagement.si,
    )


def run_case(case: Case, progress: Callable[[float], None] | None = None) -> Solution:
    """Run a case and return its solution.

    Parameters
    ----------
    case : Case
        What to run.
    progress : callable, optional
        Called with the share done, 0 to 1.

    Raises
    ------
    InputError, InputErrors
        If parts of the case do not fit together.
    IntegrationError
        If the motion cannot be followed.

    Examples
    --------
    >>> from strikewave import load_case, run_case
    >>> solution = run_case(load_case("li-ma-2019"))
    >>> len(solution.blows)
    11
    """
    machine = build_machine(case)
    run = run_rotary(machine, case.solver.tolerance.si, progress)
    found = blows(run)
    momentum = max((b.momentum_error for b in found if b.kind != "missed"), default=0.0)
    return Solution(
        case=case,
        blows=found,
        masses={"striker": machine.strikers.mass, "object": machine.struck.mass, "assembly": machine.struck.assembly_mass},
        phases=run.phases,
        ledger={"energy_error": run.energy_error, "momentum_error": momentum},
        published=compare(case, found),
        warnings=tuple(_warnings(case, machine, run, found, momentum)),
        reference=printed_law_on_rigid_object(case, machine),
        citations=_citations(case),
        data=build_dataset(case, run, found),
    )


def printed_law_on_rigid_object(case: Case, machine: RotaryMachine) -> RigidReference:
    """Return what the printed contact law gives on a rigid object: no frame, no mount, a massive turntable.

    Stiffness by Palmgren, damping by eq (24) of Li & Ma 2019 as printed, at the machine's approach speed.
    """
    law = contact_stiffness(case)
    chi = float(factor("li-ma-printed", case.contact.restitution.si))
    mass = machine.struck.mass
    blow = solve_impact(Contact(law.stiffness, law.exponent, chi), np.inf, mass, machine.nominal_approach)
    return RigidReference(
        machine.nominal_approach, float(blow.peak_force), float(blow.peak_force) / mass, float(blow.duration)
    )


def published_value(name: str, found: Sequence[Blow]) -> float | None:
    """Return the computed number that a published one is set beside; None where there is none.

    ``first`` is the first blow, ``typical`` the median of the later full blows.
    """
    struck = [b for b in found if b.kind != "missed"]
    if name == "count":
        return float(len(struck))
    if name == "window":
        return struck[-1].time - struck[0].time if struck else None
    which, _, quantity = name.partition(".")
    if which == "first":
        return float(getattr(struck[0], quantity)) if struck else None
    later = [float(getattr(b, quantity)) for b in struck[1:] if b.kind == "full"]
    return median(later) if later else None


def compare(case: Case, found: Sequence[Blow]) -> tuple[Comparison, ...]:
    """Set the published numbers of a case beside the computed ones; the difference is relative."""
    rows = []
    for entry in case.published:
        computed = published_value(entry.quantity, found)
        difference = None if computed is None else computed / entry.value.si - 1.0
        rows.append(
            Comparison(entry.quantity, entry.value.si, entry.origin, computed, difference, entry.role, entry.note)
        )
    return tuple(rows)


def _citations(case: Case) -> tuple[str, ...]:
    keys = [contact_stiffness(case).source, "hunt-crossley-1975", "schwager-poschel-2007", "hairer-1993"]
    if case.source in citations.SOURCES:
        keys.insert(0, case.source)
    return tuple(dict.fromkeys(keys))


def _warnings(case: Case, machine: RotaryMachine, run: RotaryRun, found: Sequence[Blow], momentum: float) -> list[Notice]:
    warnings = []
    for name, value in (("energy", run.energy_error), ("momentum", momentum)):
        if not value <= LEDGER_LIMIT:
            warnings.append(Notice(f"{name}-ledger", f"the {name} ledger does not close: halve solver.tolerance", value, LEDGER_LIMIT, True))
    struck = [b for b in found if b.kind != "missed"]
    if not struck:
        return [*warnings, Notice("no-blow", "no striker touched the object", 0.0, 1.0, True)]
    wanted = machine.feed.blows
    if len(struck) != wanted:
        warnings.append(Notice("blow-count", f"{len(struck)} blows instead of the {wanted} wanted: feed or retraction meets a striker", float(len(struck)), float(wanted)))
    odd = [b for b in found if b.kind != "full"]
    if odd:
        named = ", ".join(f"{b.index} {b.kind}" for b in odd)
        warnings.append(Notice("blow-kind", f"not every blow is full: {named}", float(len(odd)), 0.0))
    warnings += _yield_warnings(case, struck)
    recorder = case.recorder
    end = recorder.delay.si - recorder.pre_trigger.si + recorder.memory.si / recorder.sampling_rate.si
    last = struck[-1].time + struck[-1].width
    if end < last:
        missed = sum(b.time + b.width > end for b in struck)
        warnings.append(Notice("recorder-memory", f"the recorder's memory ends before {missed} of {len(struck)} blows: more memory, a lower rate or a delay", end, last))
    begin = recorder.delay.si - recorder.pre_trigger.si
    if begin > struck[0].time:
        warnings.append(Notice("recorder-delay", "the recorder starts after the first blow: shorten recorder.delay", begin, struck[0].time))
    intervals = struck[0].width * recorder.sampling_rate.si
    if intervals < 10:
        warnings.append(Notice("recorder-rate", "fewer than 10 sampling intervals a pulse: the recorded peak may be 1 % low or more", intervals, 10.0))
    return warnings


def _yield_warnings(case: Case, struck: Sequence[Blow]) -> list[Notice]:
    if case.contact.law != "palmgren":
        return []
    bodies = [material(case.striker.material), material(case.object.material)]
    strengths = [b.yield_strength for b in bodies if b.yield_strength is not None]
    if not strengths:
        return []
    limit = line_contact_yield_load(*bodies, min(strengths), case.striker.nose_radius.si) * case.striker.contact_length.si
    peak = max(b.peak_force for b in struck)
    if peak <= limit:
        return []
    message = "the line contact yields (von Mises, below the surface): the elastic contact law is stretched; the rigid pulse hangs on frame and mount"
    return [Notice("contact-yield", message, peak, limit)]




__all__ = ["build_machine", "published_value", "run_case"]
