"""The first blow of a machine by each answer of its contact: elastic, yielding, and the ends of what is known."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from pydantic import BaseModel

from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.machine.contact_answers import ContactAnswer, ContactAnswers
from strikewave.base.errors import InputError, IntegrationError
from strikewave.base.materials import material
from strikewave.base.quantities import Value
from strikewave.cases.case import Case
from strikewave.cases.contact_notices import first_yield_of
from strikewave.cases.contact_of_case import struck_material
from strikewave.cases.yield_pressure import ELASTIC, YIELDING, pressures_of_answers
from strikewave.machines import Blow, Machine, blows, run_machine


def contact_answers(case: Case, first: Blow) -> ContactAnswers:
    """Return the first blow of a run by each answer of its contact.

    The others are found by a run of their own, which ends with that blow, where the contact passes first yield. An
    elastic contact is set beside one that yields at the pressure of its materials, where they give one.

    Parameters
    ----------
    case : Case
        What ran.
    first : Blow
        Its first blow that struck.

    Examples
    --------
    >>> from strikewave import load_case, run_case
    >>> found = run_case(load_case("iso-16063-22-dropball")).contact
    >>> [row.name for row in found.rows], found.taken
    (['elastic', 'yielding, low', 'yielding', 'yielding, high'], 'yielding')
    """
    parts = case.impact()
    given = parts.contact.yield_pressure
    taken = ELASTIC if given is None else YIELDING
    asked = parts.contact.restitution.si
    limit = first_yield_of(parts.striker, parts.contact, struck_material(case))
    load = None if limit is None else limit.load
    bodies = material(parts.striker.material), struck_material(case)
    pressures = pressures_of_answers(given, *bodies)
    own = _answer(taken, pressures.get(taken), first)
    if load is None or (given is None and first.peak_force <= load):
        return ContactAnswers(asked, load, taken, (own,))
    elastic = own if given is None else _found(case, ELASTIC, None, None)
    rows = [
        own if name == taken else _found(case, name, pressure, elastic)
        for name, pressure in pressures.items()
        if name != ELASTIC
    ]
    return ContactAnswers(asked, load, taken, tuple(row for row in (elastic, *rows) if row is not None))


def _answer(name: str, pressure: float | None, blow: Blow) -> ContactAnswer:
    return ContactAnswer(name, pressure, blow.rigid_peak, blow.peak_force, blow.width, blow.restitution)


def _found(case: Case, name: str, pressure: float | None, elastic: ContactAnswer | None) -> ContactAnswer | None:
    """Return another answer of the first blow, that of the elastic one where its force is never reached.

    None where the blow does not come, its motion cannot be followed, or its law ends below the pressure.
    """
    try:
        machine = build_machine(_of_first_blow(case, pressure))
    except InputError:
        return None
    if elastic is not None and elastic.peak_force <= min(_yield_loads(machine)):
        return replace(elastic, name=name, yield_pressure=pressure)
    try:
        run = run_machine(machine, case.solver.tolerance.si)
    except (IntegrationError, ValueError):
        return None
    blow = next((blow for blow in blows(run) if blow.kind != "missed"), None)
    return None if blow is None else _answer(name, pressure, blow)


def _yield_loads(machine: Machine) -> Iterator[float]:
    """Yield the load from which on each striker's contact yields, N."""
    for striker in machine.strikers.each:
        yield float(np.asarray(striker.contact.cap.yield_load)) if striker.contact.cap is not None else 0.0


def _of_first_blow(case: Case, pressure: float | None) -> Case:
    """Return a case that ends with its first blow, its contact elastic or yielding at a pressure, Pa."""
    parts = case.impact()
    cap = None if pressure is None else Value(si=pressure, typed=f"{pressure!r} Pa")
    contact = parts.contact.model_copy(update={"yield_pressure": cap, "yields": "face"})
    changes: dict[str, BaseModel] = {"contact": contact}
    if case.feed is not None:
        changes["feed"] = case.feed.model_copy(update={"blows": Value(si=1.0, typed=1)})
    launched = case.launched()
    if launched is not None:
        once = {"until": None, "brake_after": None, "longest": None}
        changes["machine"] = launched.model_copy(update=once)
    return case.model_copy(update=changes)
