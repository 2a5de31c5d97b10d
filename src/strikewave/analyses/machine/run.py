"""Case in, solution out: run the machine and compare it with published values."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from statistics import median
from typing import TYPE_CHECKING

from strikewave.analyses.machine.blow_histories import BlowReading, Observed, build_dataset, first_struck
from strikewave.analyses.machine.build import line_collisions, release
from strikewave.analyses.machine.kind import Release, kind_of
from strikewave.analyses.machine.notices import (
    balance_of,
    cut_notices,
    feed_notices,
    launch_notices,
    notices,
    wave_notices,
)
from strikewave.analyses.machine.observe import contact_answers, observe
from strikewave.analyses.machine.result import RigidReference, Solution
from strikewave.base import citations
from strikewave.base.compiled import is_cold
from strikewave.base.compiling import compiling_shown
from strikewave.base.quantities import AUTO
from strikewave.base.result import Comparison, balance_notices
from strikewave.cases.case import Case, comparisons
from strikewave.cases.contact_of_case import contact_source
from strikewave.cases.stack_of_case import sensor_notices
from strikewave.contact import damping_law, solve_impact
from strikewave.machines import Blow, Machine
from strikewave.reporting.bands import lacking_notices
from strikewave.sensors.trial import channel_notices, sensor_sources
from strikewave.waves.li_ma import EXACT
from strikewave.waves.transit import wave_setup

if TYPE_CHECKING:
    from strikewave.analyses.machine.band import FastRuns


@compiling_shown()
def run_case(case: Case, progress: Callable[[float], None] | None = None, *, band: bool = False) -> Solution:
    """Run a case and return its solution.

    The bands of its results take several hundred further runs, some 0.4 s, and are only found where they are asked for.

    Parameters
    ----------
    case : Case
        Case to run.
    progress : callable, optional
        Called with the share done, 0 to 1; of the bands it begins again.
    band : bool, optional
        True to find the band of each result; see `strikewave.analyses.machine.band`.

    Returns
    -------
    Solution
        Blows, phases, balances, histories, notices and comparisons; with ``band``, the bands of its results
        too.

    Raises
    ------
    InputError
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
    if band:
        with band_compiled_beside(case):
            solution = run_case(case, progress)
        return with_bands(solution, progress)
    seen = observe(case, progress)
    machine, run = seen.machine, seen.run
    start = release(case, machine.struck.mass) if case.launched() else None
    first = first_struck(seen.blows)
    answers = None if first is None else contact_answers(case, first)
    listed = [
        *notices(case, seen.blows, answers),
        *(launch_notices(case, seen, start) if start else feed_notices(run, seen.blows)),
        *wave_notices(case, run, seen.histories, seen.readings, seen.view.bandwidth),
        *sensor_notices(case),
        *channel_notices(
            seen.view.channels, [row.sensors for row in seen.readings if row], machine.struck.assembly_mass
        ),
        *cut_notices(case, seen),
    ]
    readings, balance, struck = seen.readings, balance_of(run, seen.blows), machine.struck
    if "rise-too-steep" in [notice.code for notice in listed]:  # theory then allows no peak to be quoted
        readings = tuple([row and dataclasses.replace(row, total_peak=None, wave_peak=None) for row in readings])
    return Solution(
        case=case,
        blows=seen.blows,
        masses={"striker": machine.strikers.mass, "object": struck.mass, "assembly": struck.assembly_mass},
        phases=run.phases,
        balance=balance,
        comparisons=compare(case, seen.blows, readings),
        notices=(*balance_notices(balance), *listed),
        reference=rigid_reference(case, machine),
        readings=readings,
        waves=wave_setup(machine.layered.stack, machine.layered.grid) if machine.layered else None,
        citations=_citations(case, seen),
        sampled=build_dataset(case, seen),
        launch=launch_of(machine, start) if start else None,
        collisions=line_collisions(start) if start else (),
        contact=answers,
    )


def band_compiled_beside(case: Case) -> AbstractContextManager[None]:
    """Return the context in which a second process compiles the fast engine for the band of a case, if it must be."""
    from strikewave.machines.fast_run import fast_run_beside

    return nullcontext() if case.launched() else fast_run_beside()


def band_runs_beside(case: Case) -> AbstractContextManager[Callable[[], FastRuns | None]]:
    """Return the context in which a copy of this process makes the runs of the fast engine for the band of a case.

    Where these must be compiled first, or the case has none, it gives None; see `strikewave.uncertainty.runs`.
    """
    if case.launched() or is_cold("run_train"):
        return nullcontext(lambda: None)
    from strikewave.analyses.machine.band import by_fast_engine, fast_runs
    from strikewave.uncertainty.runs import computed_beside

    return computed_beside(lambda: fast_runs(case)) if by_fast_engine(case) else nullcontext(lambda: None)


def with_bands(
    solution: Solution, progress: Callable[[float], None] | None = None, runs: FastRuns | None = None
) -> Solution:
    """Return a solution with the band of each result; see `strikewave.analyses.machine.band`."""
    from strikewave.analyses.machine.band import machine_bands  # the fast engine, which a run alone does not need

    bands, method = machine_bands(solution.case, solution.blows, solution.readings, progress, runs=runs)
    notices = (*solution.notices, *lacking_notices(solution.figures, bands, method))
    return dataclasses.replace(solution, band=bands, band_method=method, notices=notices)


def launch_of(machine: Machine, start: Release) -> dict[str, float]:
    """Return the numbers of a launch, which `strikewave.analyses.machine.result.MachineLaunch` declares."""
    striker, arm = machine.strikers.first, start.pendulum
    speed, energy = (0.0, 0.0) if arm is None else (start.arm * arm.radius, 0.5 * arm.inertia * start.arm**2)
    numbers = {
        "approach_speed": speed + start.striker - start.object,
        "energy_released": start.energy,
        "energy_at_touch": 0.5 * striker.mass * start.striker**2 + 0.5 * machine.struck.mass * start.object**2 + energy,
    }
    return numbers if start.gain is None else {**numbers, "gain": start.gain}


def rigid_reference(case: Case, machine: Machine) -> RigidReference:
    """Return the blow of the kind's reference contact on a rigid object, without frame and mount, at nominal speed."""
    contact, behind = kind_of(case).rigid_contact(case, machine)
    mass = machine.struck.mass
    blow = solve_impact(contact, behind, mass, machine.nominal_approach)
    force = float(blow.peak_force)
    return RigidReference(machine.nominal_approach, force, force / mass, float(blow.duration))


def published_value(
    name: str, blows: Sequence[Blow], readings: Sequence[BlowReading | None], sensor: str = ""
) -> float | None:
    """Return the computed number beside a published one; None where there is none.

    ``first`` is the first blow that touched, ``typical`` the median of the later full or double blows, ``count`` the
    number of blows, ``window`` the time from the first to the last.
    """
    struck = [(blow, reading) for blow, reading in zip(blows, readings, strict=True) if reading is not None]
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
        if pulse is None or pulse.cut:  # its peak and width are not those of the pulse
            return None
        return float(getattr(pulse, quantity.removeprefix("sensor_")))
    value = getattr(reading if quantity in ("total_peak", "wave_peak") else blow, quantity)
    return None if value is None else float(value)


def compare(case: Case, blows: Sequence[Blow], readings: Sequence[BlowReading | None]) -> tuple[Comparison, ...]:
    """Compare the published numbers of a case with the computed ones; the difference is relative."""
    return comparisons(case, lambda entry: published_value(entry.quantity, blows, readings, entry.sensor))


def _citations(case: Case, seen: Observed) -> tuple[str, ...]:
    """Return the keys of the sources of the models that took part."""
    origin = next((key for key in citations.SOURCES if case.source.startswith(key)), "")
    contact = case.impact().contact
    keys = [origin, contact_source(case), "hunt-crossley-1975", damping_law(contact.damping).source]
    keys += ["thornton-1997"] if contact.yield_pressure is not None else []
    keys += ["jackson-green-2005"] if contact.yield_pressure == AUTO else []
    keys += ["maw-barber-fawcett", "molinari-1999"] if contact.friction is not None else []
    keys += ["schwager-poschel-2007", "hairer-1993", *kind_of(case).sources]
    if seen.machine.layered:
        keys += ["kolsky-1963", *(["li-ma-2019"] if case.solver.route != EXACT else [])]
    keys += sensor_sources(seen.view.channels)
    return tuple(key for key in dict.fromkeys(keys) if key in citations.SOURCES)
