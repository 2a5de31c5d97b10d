"""Case in, solution out: run the machine and set the published numbers beside it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from statistics import median

import numpy as np

from strikewave import citations
from strikewave.build import build_channels, build_machine, build_taps, check_route, contact_stiffness
from strikewave.case import Case
from strikewave.contact import damping_law, factor, solve_impact
from strikewave.dataset import build_dataset
from strikewave.errors import InputError
from strikewave.machines import Blow, RotaryMachine, blows, run_rotary
from strikewave.machines.spans import StackSpan
from strikewave.machines.strike import kept_step
from strikewave.notices import ledger_notices, notices
from strikewave.readings import (
    BlowReading,
    Observed,
    View,
    blow_history,
    blow_reading,
    sensor_sources,
    without_peaks,
)
from strikewave.solution import Comparison, RigidReference, Solution, wave_setup
from strikewave.validity import channel_notices, honest_bandwidth, wave_notices
from strikewave.waves import Stack
from strikewave.waves.routes import EXACT

LOWEST_BANDWIDTH = 1e3
"""Lowest bandwidth of the acceleration of a blow, which lasts a millisecond, Hz."""


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
    seen = observe(case, progress)
    machine, run = seen.machine, seen.run
    listed = [
        *notices(case, seen.blows),
        *wave_notices(run, seen.histories, seen.readings, seen.view.bandwidth),
        *channel_notices(
            seen.view.channels,
            [reading.sensors for reading in seen.readings if reading is not None],
            machine.struck.assembly_mass,
        ),
    ]
    refused = any(notice.code == "rise-too-steep" for notice in listed)
    readings = tuple(reading and (without_peaks(reading) if refused else reading) for reading in seen.readings)
    momentum = max(
        [blow.momentum_error for blow in seen.blows if blow.kind != "missed"]
        + [span.momentum_error for span in run.spans if isinstance(span, StackSpan)],
        default=0.0,
    )
    ledger = {"energy_error": run.energy_error, "momentum_error": momentum}
    struck = machine.struck
    return Solution(
        case=case,
        blows=seen.blows,
        masses={"striker": machine.strikers.mass, "object": struck.mass, "assembly": struck.assembly_mass},
        phases=run.phases,
        ledger=ledger,
        published=compare(case, seen.blows, readings),
        warnings=(*ledger_notices(ledger), *listed),
        reference=printed_law_on_rigid_object(case, machine),
        readings=readings,
        waves=wave_setup(machine.layered.stack, machine.layered.grid) if machine.layered else None,
        citations=_citations(case, seen),
        data=build_dataset(case, seen),
    )


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
    view = View(channels, stated_bandwidth(case, stack), case.rig().recorder.begin, route)
    if machine.layered is not None:
        check_rates(case, view, kept_step(machine.layered.grid))
    run = run_rotary(machine, case.solver.tolerance.si, progress)
    found = blows(run)
    first = next((blow for blow in found if blow.kind != "missed"), None)
    histories = tuple(
        None if blow.kind == "missed" else blow_history(run, blow, view, routes=blow is first) for blow in found
    )
    readings = tuple(history and blow_reading(history, view) for history in histories)
    return Observed(run, found, view, tuple(name for name, _ in taps), histories, readings)


def check_rates(case: Case, view: View, step: float) -> None:
    """Refuse a bandwidth or a filter that the histories of a stack, or its short blows, cannot show.

    Raises
    ------
    InputError
        With the field.
    """
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


def printed_law_on_rigid_object(case: Case, machine: RotaryMachine) -> RigidReference:
    """Return what the printed contact law gives on a rigid object: no frame, no mount, a massive turntable.

    Stiffness by the case's law, damping by eq (24) of Li & Ma 2019 as printed, at the machine's nominal
    approach speed.
    """
    law = contact_stiffness(case)
    chi = float(factor("li-ma-printed", case.rig().contact.restitution.si))
    mass = machine.struck.mass
    blow = solve_impact(law.contact(chi), np.inf, mass, machine.nominal_approach)
    force = float(blow.peak_force)
    return RigidReference(machine.nominal_approach, force, force / mass, float(blow.duration))


def published_value(
    name: str, found: Sequence[Blow], readings: Sequence[BlowReading | None], sensor: str = ""
) -> float | None:
    """Return the computed number that a published one is set beside; None where there is none.

    ``first`` is the first blow that touched, ``typical`` the median of the later full or double blows, ``count`` the
    number of blows, ``window`` the time from the first to the last.
    """
    struck = [(blow, reading) for blow, reading in zip(found, readings, strict=True) if reading is not None]
    if name == "count":
        return float(len(struck))
    if not struck:
        return None
    if name == "window":
        return struck[-1][0].time - struck[0][0].time
    which, _, quantity = name.partition(".")
    if which == "first":
        return _measured(*struck[0], quantity, sensor)
    later = [_measured(*pair, quantity, sensor) for pair in struck[1:] if pair[0].kind in ("full", "double")]
    numbers = [number for number in later if number is not None]
    return median(numbers) if numbers else None


def _measured(blow: Blow, reading: BlowReading, quantity: str, sensor: str) -> float | None:
    """Return a number of one blow: of the blow itself, of its waves, or of a sensor."""
    if quantity.startswith("sensor_"):
        pulse = reading.sensors.get(sensor)
        return None if pulse is None else float(getattr(pulse, quantity.removeprefix("sensor_")))
    value = getattr(reading if quantity in ("total_peak", "wave_peak") else blow, quantity)
    return None if value is None else float(value)


def compare(case: Case, found: Sequence[Blow], readings: Sequence[BlowReading | None]) -> tuple[Comparison, ...]:
    """Set the published numbers of a case beside the computed ones; the difference is relative."""
    changed = case.changed_fields()
    rows = []
    for entry in case.published:
        computed = published_value(entry.quantity, found, readings, entry.sensor)
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
                sensor=entry.sensor,
            )
        )
    return tuple(rows)


def _citations(case: Case, seen: Observed) -> tuple[str, ...]:
    """Return the keys of the sources of the models that took part."""
    origin = next((key for key in citations.SOURCES if case.source.startswith(key)), "")
    contact = case.rig().contact
    keys = [origin, contact_stiffness(case).source, "hunt-crossley-1975", damping_law(contact.damping).source]
    keys += ["thornton-1997"] if contact.yield_pressure is not None else []
    keys += ["schwager-poschel-2007", "hairer-1993"]
    if seen.machine.layered:
        keys += ["kolsky-1963", *(["li-ma-2019"] if case.solver.route != EXACT else [])]
    keys += sensor_sources(seen.view.channels)
    return tuple(key for key in dict.fromkeys(keys) if key in citations.SOURCES)
