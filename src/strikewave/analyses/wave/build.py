"""A layered bar alone: its load, and the accuracy of its waves."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

from strikewave.base.errors import MISSING, InputError, checked
from strikewave.cases.case import Case
from strikewave.cases.contact_of_case import face_contact, refuse_sliding, struck_material
from strikewave.cases.stack_of_case import need, read_load, typed
from strikewave.cases.tables.stack import LoadTable
from strikewave.sensors.trial import SensorChannel, shortest_period
from strikewave.waves import Impactor, Load, LoadPulse, Sampled, Stack, WantedError
from strikewave.waves.li_ma import EXACT
from strikewave.waves.load import Prescribed

NO_LOAD = 1e-6  # s; duration of the load of zero of a bar that a moving layer strikes: any, as the force is zero
ACCELERATION_ERROR = 10.0  # wanted error of acceleration over that of velocity: a derivative is less exact
_APPLIED: dict[str, Prescribed] = {"force": "force", "incident wave": "incident"}


def of_the_paper(case: Case) -> bool:
    """Tell whether a case is one of Li & Ma 2019, or asks for a route of theirs."""
    return case.source.startswith("li-ma-2019") or case.solver.route != EXACT


def build_load(case: Case, stack: Stack) -> Load:
    """Return the load of the stack of a bar alone."""
    load = case.load
    if load is None and any(layer.speed for layer in stack.layers):
        return LoadPulse("rectangle", 0.0, NO_LOAD)
    if load is None:
        hint = "or `strikewave run`, which strikes the stack with the machine" if case.machine else ""
        raise InputError("load", MISSING, "a [load] with its shape", hint)
    wants = {"contact": ("speed",), "file": ("file",)}.get(load.shape, ("peak", "duration", "rise"))
    for key in ("peak", "duration", "rise", "speed", "file"):
        if getattr(load, key) not in (None, "") and key not in wants:
            allowed = f"for the shape {load.shape}: {', '.join(wants)}"
            raise InputError(f"load.{key}", typed(getattr(load, key)), allowed, "remove it")
    if load.shape == "contact":
        if load.applied != "force":
            raise InputError("load.applied", load.applied, "force, for the shape contact", "remove it")
        return _impactor(case, load)
    if load.shape == "file":
        if not load.file:
            raise InputError("load.file", MISSING, "a file with time and force", 'add file = "force.csv"')
        measured = read_load(load.file)
        if load.applied == "force":
            return measured
        if measured.kind != "force":
            allowed = "force, for a file that holds the motion of the face"
            raise InputError("load.applied", load.applied, allowed)
        return Sampled(measured.time, measured.values, "incident", measured.told)
    peak = need(load.peak, "load.peak", "a force", 'add peak = "20 kN"')
    duration = need(load.duration, "load.duration", "a time", 'add duration = "100 us"')
    rise = load.rise.si if load.rise else 0.0
    return checked("load", lambda: LoadPulse(load.shape, peak, duration, rise, _APPLIED[load.applied]))


def _impactor(case: Case, load: LoadTable) -> Impactor:
    speed = need(load.speed, "load.speed", "the speed of the striker", 'add speed = "5 m/s"')
    if case.striker is None or case.contact is None:
        missing = "striker" if case.striker is None else "contact"
        raise InputError(missing, MISSING, f"a [{missing}] table", "a load by contact needs [striker] and [contact]")
    refuse_sliding(case.contact)
    return Impactor(
        case.striker.mass.si,
        speed,
        face_contact(case.striker, case.contact, struck_material(case)),
        case.contact.slowest_approach.si,
    )


def wanted(case: Case, channels: Sequence[SensorChannel] = ()) -> WantedError:
    """Return the allowed errors of the waves of a case, the time step, the method, and the period of the sensors."""
    step = case.solver.step.si if case.solver.step else None
    asked = WantedError(step=step, method=case.solver.method, period=shortest_period(channels))
    if case.solver.error is None:
        return asked
    error = case.solver.error.si
    return dataclasses.replace(asked, velocity=error, acceleration=ACCELERATION_ERROR * error)
