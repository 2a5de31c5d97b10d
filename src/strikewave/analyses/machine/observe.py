"""A machine's run as observed: its blows with taps and sensors, the first by each answer of its contact."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from pydantic import BaseModel

from strikewave.analyses.machine.blow_histories import (
    Observed,
    ReadingSetup,
    blow_histories,
    blow_reading,
    first_struck,
)
from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.machine.result import ContactAnswer, ContactAnswers
from strikewave.base.constants import material
from strikewave.base.errors import InputError, IntegrationError
from strikewave.base.quantities import Value
from strikewave.cases.case import Case
from strikewave.cases.contact_notices import first_yield_of
from strikewave.cases.contact_of_case import struck_material
from strikewave.cases.contact_parts import ELASTIC, YIELDING, pressures_of_answers
from strikewave.cases.stack_of_case import build_channels, build_taps, check_route
from strikewave.machines import Blow, blows, run_machine
from strikewave.machines.strike import kept_step
from strikewave.waves import Stack
from strikewave.waves.li_ma import EXACT
from strikewave.waves.limits import honest_bandwidth

LOWEST_BANDWIDTH = 1e3  # Hz: a blow lasts a millisecond, and a lower bandwidth would show none of its shape


def observe(case: Case, progress: Callable[[float], None] | None = None) -> Observed:
    """Run a machine case and observe each blow with its taps and sensors; see `run_case`."""
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
    readings = tuple([history and blow_reading(history, view) for history in histories])
    return Observed(run, run_blows, view, tuple([name for name, _ in taps]), histories, readings)


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
            allowed = f"below {highest / 1e6:.3g} MHz, half the rate at which waves are kept"
            raise InputError(f"sensor.{channel.sensor.name}.cutoff", f"{cutoff:g} Hz", allowed)


def stated_bandwidth(case: Case, stack: Stack | None) -> float:
    """Return the bandwidth of the case, Hz, or the largest one at which one-dimensional theory needs no warning."""
    if case.solver.bandwidth is not None:
        return case.solver.bandwidth.si
    return np.inf if stack is None else honest_bandwidth(stack)


def contact_answers(case: Case, first: Blow) -> ContactAnswers:
    """Return the first blow of a run by each answer of its contact.

    The others are found by a run of their own, which ends with that blow, where the contact passes first yield. An
    elastic contact is set beside one that yields at the pressure of its materials, where they give one.

    Examples
    --------
    >>> from strikewave import load_case, run_case
    >>> answers = run_case(load_case("iso-16063-22-dropball")).contact
    >>> [row.name for row in answers.rows], answers.taken
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
    elastic = own if given is None else _other_answer(case, ELASTIC, None, None)
    rows = [elastic]
    for name, pressure in pressures.items():
        if name != ELASTIC:
            rows.append(own if name == taken else _other_answer(case, name, pressure, elastic))
    return ContactAnswers(asked, load, taken, tuple(filter(None, rows)))


def _answer(name: str, pressure: float | None, blow: Blow) -> ContactAnswer:
    return ContactAnswer(name, pressure, blow.rigid_peak, blow.peak_force, blow.width, blow.restitution)


def _other_answer(case: Case, name: str, pressure: float | None, elastic: ContactAnswer | None) -> ContactAnswer | None:
    """Return another answer of the first blow, that of the elastic one where its force is never reached.

    None where the blow does not come, its motion cannot be followed, or its law ends below the pressure.
    """
    try:
        machine = build_machine(_until_first_blow(case, pressure))
        caps = [striker.contact.cap for striker in machine.strikers.each]
        yields_from = min([0.0 if cap is None else float(np.asarray(cap.yield_load)) for cap in caps])
        if elastic is not None and elastic.peak_force <= yields_from:
            return replace(elastic, name=name, yield_pressure=pressure)
        blow = first_struck(blows(run_machine(machine, case.solver.tolerance.si)))
    except (InputError, IntegrationError, ValueError):
        return None
    return None if blow is None else _answer(name, pressure, blow)


def _until_first_blow(case: Case, pressure: float | None) -> Case:
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
