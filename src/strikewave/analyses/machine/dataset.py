"""A run sampled into arrays: the whole train, each blow in detail, the ideal record, taps and sensors."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.machine.sensor_readings import BlowHistory, Observed, ReadingSetup
from strikewave.base.declare import declarations
from strikewave.base.variables import LabelledArrays, quantity
from strikewave.cases.case import Case
from strikewave.machines import Blow
from strikewave.machines._kernels import stroke_places
from strikewave.machines.blows import WINDOW_AFTER, WINDOW_BEFORE, pulse_window, window_ends
from strikewave.machines.run import MachineRun
from strikewave.machines.spans import Moments, StackSpan
from strikewave.sensors.channel import SensorChannel
from strikewave.waves.li_ma import ROUTES

Array = NDArray[np.float64]

PULSE_STEP = 0.5e-6
"""Finest sampling of the stored blow windows, s."""
SAMPLES_A_PULSE = 3000
"""Samples of the shortest pulse of which no more are needed: as many as of one of 1.5 ms at the finest sampling."""
MOST_SAMPLES = 5_000_000
"""Samples of all windows together that are kept at most of a quantity, 40 MB; as many as of a short pulse at the finest
sampling a window has anyway."""


def carriage_position(case: Case, phases: Sequence[tuple[str, float]], time: Array) -> Array:
    """Return how far the carriage is from its fed place, m, at times after the valve signal.

    Both strokes begin and end where the phases of the run say.
    """
    feed, at = case.rotary_tables().feed, dict(phases)
    rise, fall = (0.5 if share is None else share.si for share in (feed.acceleration, feed.cushion))

    def moved(begin: float, end: float) -> Array:
        places = np.empty(time.size)
        stroke_places((time - begin) / (end - begin), rise, fall, places)
        return places

    return np.asarray(feed.stroke.si * (1.0 - moved(at["feed"], at["fed"]) + moved(at["retract"], at["brake"])))


def pulse_axis(run: MachineRun, found: Sequence[Blow]) -> tuple[Array, float]:
    """Return time since first touch and its step, s, of the windows of all blows: as long as the longest pulse needs.

    The step is the finest one where pulses are short or waves run through a stack, and coarser for pulses that are all
    long, or for more samples than are kept.
    """
    lasting = window_ends(run, found) - [blow.time for blow in found]
    longest = max([WINDOW_AFTER, *lasting[np.isfinite(lasting)]])
    shortest = min((blow.contact_time for blow in found if blow.kind != "missed"), default=0.0)
    step = PULSE_STEP if run.machine.layered else max(PULSE_STEP, shortest / SAMPLES_A_PULSE)
    usual = (WINDOW_BEFORE + WINDOW_AFTER) / PULSE_STEP
    step = max(step, longest / max(MOST_SAMPLES / max(len(found), 1), usual))
    return np.arange(-round(WINDOW_BEFORE / step), math.floor(longest / step + 1e-6) + 1) * step, step


def build_dataset(case: Case, seen: Observed) -> LabelledArrays:
    """Sample a run and what was seen of it into the arrays of a dataset."""
    run, blows = seen.run, seen.blows
    time = np.arange(0.0, run.end, case.solver.output_step.si)
    time = time[time <= run.end]  # rounding may lead beyond
    train = run.sample(time)
    ends = window_ends(run, blows)
    pulse_time, pulse_step = pulse_axis(run, blows)
    force, acceleration = (np.full((len(blows), pulse_time.size), np.nan) for _ in range(2))
    for row, blow in enumerate(blows):
        if blow.kind != "missed":
            until = min(float(ends[row]) - blow.time, pulse_time[-1])
            since, f, a = pulse_window(run, blow.time, until, pulse_step)
            first = round((since[0] - pulse_time[0]) / pulse_step)
            window = slice(first, first + since.size)
            force[row, window], acceleration[row, window] = (v[: pulse_time.size - first] for v in (f, a))
    recorder, begun = case.impact().recorder, case.time_zero
    record_time = recorder.begin + np.arange(int(recorder.memory.si)) / recorder.sampling_rate.si
    inside = (record_time >= (-np.inf if case.launched() else 0.0)) & (record_time <= run.end)
    record = np.zeros(
        record_time.size
    )  # a launched machine is in flight before, at the acceleration that it begins with
    record[inside] = run.sample(np.maximum(record_time[inside], 0.0)).rigid_acceleration
    variables = {
        "contact_force": quantity("time", train.contact_force, "N", "contact force"),
        "rigid_acceleration": quantity("time", train.rigid_acceleration, "m/s^2", "rigid-body acceleration"),
        "nose_position": quantity("time", train.face_place, "m", "position of the struck face along the blow"),
        "assembly_position": quantity("time", train.assembly_place, "m", "position of the assembly"),
        "assembly_speed": quantity("time", train.assembly_speed, "m/s", "speed of the assembly"),
        "pulse_force": quantity(("blow", "pulse_time"), force, "N", "contact force of each blow"),
        "pulse_acceleration": quantity(
            ("blow", "pulse_time"), acceleration, "m/s^2", "rigid-body acceleration of each blow"
        ),
        "record_acceleration": quantity(
            "record_time", record, "m/s^2", "rigid-body acceleration as an ideal recorder samples it"
        ),
    }
    if case.launched() is None:
        variables["turntable_speed"] = quantity("time", train.turntable_speed, "rad/s", "turntable speed")
    variables |= _place_variables(case, run, time, train)
    for column, one in declarations(Blow).items():
        if column not in ("index", "kind"):
            values = np.array([getattr(b, column) for b in blows])
            variables[f"blow_{column}"] = quantity("blow", values, one.quantity.si or "1", column.replace("_", " "))
    variables["blow_kind"] = quantity("blow", np.array([b.kind for b in blows], dtype=object), "1", "kind")
    coordinates = {
        "time": quantity("time", time, "s", f"time after {begun}"),
        "pulse_time": quantity("pulse_time", pulse_time, "s", "time after first touch"),
        "record_time": quantity("record_time", record_time, "s", f"time after {begun}"),
        "blow": ("blow", np.array([b.index for b in blows], dtype=np.int64)),
    }
    if seen.taps:
        variables |= _tap_variables(seen.histories, len(seen.taps), pulse_time, seen.view)
        variables |= _route_variables(seen.histories, len(seen.taps), pulse_time, seen.view)
        coordinates["tap"] = ("tap", np.array(seen.taps, dtype=object))
        coordinates["route"] = ("route", np.array(ROUTES, dtype=object))
    variables |= _reading_variables(seen.histories, seen.view.channels)
    variables |= _field_variables(run)
    return LabelledArrays.of(variables, coordinates, {"route": seen.view.route})


def _place_variables(case: Case, run: MachineRun, time: Array, train: Moments) -> dict[str, Any]:
    """Return where turntable and carriage are; nothing for a machine without a feed."""
    if not {"feed", "fed", "retract", "brake"} <= dict(run.phases).keys():
        return {}
    carriage = carriage_position(case, run.phases, time)
    return {
        "turntable_angle": quantity(
            "time", train.turntable_angle, "rad", "angle of the first striker after the strike position"
        ),
        "carriage_position": quantity("time", carriage, "m", "way of the carriage from its fed place"),
    }


def _tap_variables(
    histories: Sequence[BlowHistory | None], taps: int, pulse_time: Any, view: ReadingSetup
) -> dict[str, Any]:
    """Return force, speed and total acceleration at the taps, and the rigid acceleration at the same bandwidth."""
    force, speed, total = (np.full((len(histories), taps, pulse_time.size), np.nan) for _ in range(3))
    rigid = np.full((len(histories), pulse_time.size), np.nan)
    for row, history in enumerate(histories):
        if history is None or not len(history.total):
            continue

        def at(values: Any, since: Any = history.since) -> Any:
            return np.interp(pulse_time, since, values, left=np.nan, right=np.nan)

        rigid[row] = at(history.rigid)
        for k in range(taps):
            force[row, k], speed[row, k], total[row, k] = (
                at(values[k]) for values in (history.force, history.speed, history.total)
            )
    where, band = ("blow", "tap", "pulse_time"), f"{view.route}, at {view.bandwidth:g} Hz"
    return {
        "tap_force": quantity(where, force, "N", "force in the stack at each tap"),
        "tap_speed": quantity(where, speed, "m/s", "speed at each tap"),
        "tap_acceleration": quantity(where, total, "m/s^2", f"total acceleration at each tap, {band}"),
        "rigid_acceleration_filtered": quantity(
            ("blow", "pulse_time"), rigid, "m/s^2", f"rigid-body acceleration of each blow, {band}"
        ),
    }


def _route_variables(
    histories: Sequence[BlowHistory | None], taps: int, pulse_time: Any, view: ReadingSetup
) -> dict[str, Any]:
    """Return the wave acceleration of the first blow by the paper's routes, where a tap has two neighbours."""
    waves = np.full((len(ROUTES), taps, pulse_time.size), np.nan)
    first = next((history for history in histories if history is not None), None)
    if first is not None:
        for (tap, route), values in first.routes.items():
            waves[ROUTES.index(route), tap] = np.interp(pulse_time, first.since, values, left=np.nan, right=np.nan)
    name = f"stress-wave acceleration, first blow, by the routes of Li & Ma 2019, at {view.bandwidth:g} Hz"
    return {"route_acceleration": quantity(("route", "tap", "pulse_time"), waves, "m/s^2", name)}


def _reading_variables(histories: Sequence[BlowHistory | None], channels: Sequence[SensorChannel]) -> dict[str, Any]:
    """Return what each sensor's recorder kept of each blow, and when each of its records begins."""
    variables: dict[str, Any] = {}
    for k, channel in enumerate(channels):
        readings = [history.readings[k] if history is not None else None for history in histories]
        size = max((reading.values.size for reading in readings if reading is not None), default=0)
        values, start, step = np.full((len(readings), size), np.nan), np.full(len(readings), np.nan), 0.0
        for row, reading in enumerate(readings):
            if reading is not None:
                values[row, : reading.values.size] = reading.values
                start[row] = reading.time[0] if reading.time.size else np.nan
                step = float(reading.time[1] - reading.time[0]) if reading.time.size > 1 else step
        name, where = channel.sensor.name, f"reading_{k + 1}"
        variables[where] = quantity(("blow", f"sample_{k + 1}"), values, "m/s^2", f"reading of the sensor {name}")
        variables[where][2].update(sensor=name, step=step)
        variables[f"{where}_start"] = quantity("blow", start, "s", f"first sample of {name} after first touch")
    return variables


def _field_variables(run: MachineRun) -> dict[str, Any]:
    """Return the force along the stack over time in the first blow that touched."""
    span = next((span for span in run.spans if isinstance(span, StackSpan) and span.field_position.size), None)
    if span is None:
        return {}
    since, force = span.field()
    return {
        "field_force": quantity(("field_time", "field_place"), force, "N", "force along the stack, first blow"),
        "field_time": quantity("field_time", since, "s", "time after first touch"),
        "field_position": quantity("field_place", span.field_position, "m", "distance from the struck face"),
    }
