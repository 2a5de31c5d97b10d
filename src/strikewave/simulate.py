"""Case in, solution out: run the machine and set the published numbers beside it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from statistics import median

import numpy as np

from strikewave import citations
from strikewave.build import build_machine, contact_stiffness
from strikewave.case import Case
from strikewave.contact import Contact, factor, solve_impact
from strikewave.machines import Blow, RotaryMachine, blows, run_rotary
from strikewave.notices import notices
from strikewave.solution import Comparison, RigidReference, Solution, build_dataset


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
    momentum = max((blow.momentum_error for blow in found if blow.kind != "missed"), default=0.0)
    ledger = {"energy_error": run.energy_error, "momentum_error": momentum}
    struck = machine.struck
    return Solution(
        case=case,
        blows=found,
        masses={"striker": machine.strikers.mass, "object": struck.mass, "assembly": struck.assembly_mass},
        phases=run.phases,
        ledger=ledger,
        published=compare(case, found),
        warnings=notices(case, found, ledger),
        reference=printed_law_on_rigid_object(case, machine),
        citations=_citations(case),
        data=build_dataset(case, run, found),
    )


def printed_law_on_rigid_object(case: Case, machine: RotaryMachine) -> RigidReference:
    """Return what the printed contact law gives on a rigid object: no frame, no mount, a massive turntable.

    Stiffness by the case's law, damping by eq (24) of Li & Ma 2019 as printed, at the machine's nominal
    approach speed.
    """
    law = contact_stiffness(case)
    chi = float(factor("li-ma-printed", case.contact.restitution.si))
    mass = machine.struck.mass
    blow = solve_impact(Contact(law.stiffness, law.exponent, chi), np.inf, mass, machine.nominal_approach)
    force = float(blow.peak_force)
    return RigidReference(machine.nominal_approach, force, force / mass, float(blow.duration))


def published_value(name: str, found: Sequence[Blow]) -> float | None:
    """Return the computed number that a published one is set beside; None where there is none.

    ``first`` is the first blow that touched, ``typical`` the median of the later full or double blows, ``count`` the
    number of blows, ``window`` the time from the first to the last.
    """
    struck = [blow for blow in found if blow.kind != "missed"]
    if name == "count":
        return float(len(struck))
    if not struck:
        return None
    if name == "window":
        return struck[-1].time - struck[0].time
    which, _, quantity = name.partition(".")
    if which == "first":
        return float(getattr(struck[0], quantity))
    later = [float(getattr(blow, quantity)) for blow in struck[1:] if blow.kind in ("full", "double")]
    return median(later) if later else None


def compare(case: Case, found: Sequence[Blow]) -> tuple[Comparison, ...]:
    """Set the published numbers of a case beside the computed ones; the difference is relative."""
    changed = case.changed_fields()
    rows = []
    for entry in case.published:
        computed = published_value(entry.quantity, found)
        difference = None if computed is None else computed / entry.value.si - 1.0
        rows.append(
            Comparison(
                quantity=entry.quantity,
                published=entry.value.si,
                measured_or_simulated=entry.origin,
                computed=computed,
                difference=difference,
                role="shown" if changed else entry.role,
                note=f"the case differs in {', '.join(changed)}" if changed else entry.note,
            )
        )
    return tuple(rows)


def _citations(case: Case) -> tuple[str, ...]:
    keys = [case.source, contact_stiffness(case).source, "hunt-crossley-1975", "schwager-poschel-2007", "hairer-1993"]
    return tuple(key for key in dict.fromkeys(keys) if key in citations.SOURCES)
