"""A machine's run as it is looked at: its blows with taps and sensors, the first by each answer of its contact."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from pydantic import BaseModel

from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.machine.readings import Observed, ReadingSetup, blow_histories, blow_reading
from strikewave.analyses.machine.result import ContactAnswer, ContactAnswers
from strikewave.base.constants import material
from strikewave.base.errors import InputError, IntegrationError
from strikewave.base.quantities import Value
from strikewave.cases.case import Case
from strikewave.cases.contact_notices import first_yield_of
from strikewave.cases.contact_of_case import struck_material
from strikewave.cases.contact_parts import ELASTIC, YIELDING, pressures_of_answers
from strikewave.cases.stack_of_case import build_channels, build_taps, check_route
from strikewave.machines import Blow, Machine, blows, run_machine
from strikewave.machines.strike import kept_step
from strikewave.waves import Stack
from strikewave.waves.li_ma import EXACT
from strikewave.waves.limits import honest_bandwidth

LOWEST_BANDWIDTH = 1e3
"""Lowest bandwidth of the acceleration of a blow, which lasts a millisecond, Hz."""


def observe(case: Case, progress: Callable[[float], None] | None = None) -> Observed:
    """Run a machine case and look at each blow with its taps and sensors; see `run_case`."""
    machine = build_machine(case)
    stack = machine.layered.stack if machine.layered else None
    taps = build_taps(case) if machine.layered else ()
    route = case.solver.route
    channels = build_channels(case)
    if route != EXACT and stack is None:
        raise InputError("solver.route", route, EXACT, "the object of this case is no stack")
    check_route(case, taps, channels)
    view = ReadingSetup(channels, stated_bandwidth(case, stack), case.impact().recorder.begin, route)
    if machine.layered is not None:
        check_rates(case, view, kept_step(machine.layered.grid))
    run = run_machine(machine, case.solver.tolerance.si, progress)
    run_blows = blows(run)
    if case.launched() is not None:
        run_blows = tuple(dataclasses.replace(blow, turntable_speed=math.nan) for blow in run_blows)
    histories = blow_histories(run, run_blows, view)
    readings = tuple(history and blow_reading(history, view) for history in histories)
    return Observed(run, run_blows, view, tuple(name for name, _ in taps), histories, readings)


def check_rates(case: Case, view: ReadingSetup, step: float) -> None:
    """Refuse a bandwidth or a filter that the histories of a stack, or its short blows, cannot show."""
    highest = 0.5 / step
    bandwidth = case.solver.bandwidth
    if bandwidth is not None and not LOWEST_BANDWIDTH <= view.bandwidth < highest:
        allowed = f"{LOWEST_BANDWIDTH / 1e3:g} kHz to {highest / 1e6:.3g} MHz, half the rate at which waves are kept"
        raise InputError("solver.bandwidth", bandwidth.typed, allowed)
    for channel in view.channels:
        cutoff = channel.recorder.cutoff
        if not math.isinf(cutoff) and cutoff >= highest:
            field = f"sensor.{channel.sensor.name}.cutoff"
            raise InputError(
                field, f"{cutoff:g} Hz", f"below {highest / 1e6:.3g} MHz, half the rate at which waves are kept"
            )


def stated_bandwidth(case: Case, stack: Stack | None) -> float:
    """Return the bandwidth at which total and wave acceleration are stated, Hz.

    That of the case, or the largest one at which one-dimensional theory needs no warning.
    """
    if case.solver.bandwidth is not None:
        return case.solver.bandwidth.si
    return np.inf if stack is None else honest_bandwidth(stack)


def contact_answers(case: Case, first: Blow) -> ContactAnswers:
    """Return the first blow of a run by each answer of its contact.

    The others are found by a run of their own, which ends with that blow, where the contact passes first yield. An
    elastic contact is set beside one that yields at the pressure of its materials, where they give one.

    Parameters
    ----------
    case : Case
        Case that was run.
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
