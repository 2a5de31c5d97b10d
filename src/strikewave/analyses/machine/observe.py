"""A machine's run as it is looked at: blows, and what taps and sensors show of each."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np

from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.machine.sensor_readings import Observed, ReadingSetup, blow_histories, blow_reading
from strikewave.base.errors import InputError
from strikewave.cases.case import Case
from strikewave.cases.sensors_of_case import build_channels
from strikewave.cases.stack_of_case import build_taps, check_route
from strikewave.machines import blows, run_machine
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
