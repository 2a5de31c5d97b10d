"""Histories and readings of each blow at taps and sensors, and the arrays of a run: train, blows, ideal record.

Total acceleration is what a perfect sensor at a section would read; wave is total less the rigid-body acceleration of
the assembly, both at the same bandwidth, so that nothing is counted twice. A peak is the value of largest magnitude,
with its sign.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.datasets import LabelledArrays, quantity
from strikewave.base.declare import MORE, declarations
from strikewave.base.shock_quantities import BANDWIDTH, TOTAL_PEAK
from strikewave.cases.case import Case
from strikewave.cases.contact_of_case import or_else
from strikewave.machines._kernels import stroke_places
from strikewave.machines.blows import WINDOW_AFTER, WINDOW_BEFORE, Blow, pulse_window, window_ends
from strikewave.machines.machine import Machine
from strikewave.machines.run import MachineRun
from strikewave.machines.spans import StackSpan
from strikewave.sensors import SensorReading, read
from strikewave.sensors.trial import SensorChannel, SensorPulse, sensor_pulse, settling_time, shortest_period, still_on
from strikewave.signal.filters import stated
from strikewave.signal.pulse import front, largest
from strikewave.waves.li_ma import EXACT, ROUTES, route_history, specimen_of, superposed

Array = NDArray[np.float64]

RIGID_STEP = 0.1e-6  # s; finest spacing of a history without a stack: 40 samples a period of a resonance of 250 kHz
SAMPLES_A_WINDOW, SAMPLES_A_TOUCH, SAMPLES_A_PERIOD = 30_000, 1000, 20
"""Samples of which no more are needed: of a window, as many as of a pulse of 1.5 ms at the finest spacing; of the time
in touch, where a sample is 1e-6 below the top of a half-sine at most; of a period of the fastest that swings or is
filtered, of whose top a sample is at most 1 - cos(pi/20) = 1.2 % below."""
MOST_A_WINDOW, MOST_OF_A_SENSOR = 200_000, 20_000_000
"""Samples of a window at most, 20 ms at the finest spacing; and of all windows of a run, 160 MB for a sensor, as far as
each has those of a short pulse."""
SAMPLES_A_CUTOFF = 4
"""Samples to a period of a filter's cutoff at least: it must lie below half the rate."""


@declare.dataclass
class BlowReading:
    """Readings of taps and sensors in one blow; those of taps are None where the object is no stack."""

    total_peak: float | None = declare.number(
        TOTAL_PEAK,
        "of a struck stack: peak of the acceleration at the first tap, at the bandwidth",
        label="total",
        band="rigid_peak",
        column=MORE + 1,
        tables="waves",
    )
    wave_peak: float | None = declare.number(
        TOTAL_PEAK,
        "of a struck stack: the same less that of the rigid body",
        label="wave",
        band="rigid_peak",
        column=MORE + 1,
        tables="waves",
    )
    bandwidth: float | None = declare.number(BANDWIDTH, "of a struck stack: low-pass by which both peaks are quoted")
    sensors: dict[str, SensorPulse] = declare.named(SensorPulse, "what each sensor reads, by its name")


class TimedBlow(Protocol):
    """A blow of a full or a fast run."""

    @property
    def kind(self) -> str:
        """full, glancing, double or missed."""

    @property
    def time(self) -> float:
        """First touch, s."""


BlowT = TypeVar("BlowT", bound=TimedBlow)


def struck_blows(run_blows: Sequence[BlowT]) -> list[BlowT]:
    """Return the blows that touched the object."""
    return [blow for blow in run_blows if blow.kind != "missed"]


def first_struck(run_blows: Sequence[BlowT]) -> BlowT | None:
    """Return the first blow that touched the object; None where none did."""
    return next(iter(struck_blows(run_blows)), None)


def typical_blows(struck: Sequence[BlowT]) -> list[BlowT]:
    """Return the full and double blows after the first: their medians are the typical results."""
    return [blow for blow in struck[1:] if blow.kind in ("full", "double")]


class ReadingSetup(NamedTuple):
    """Sensors, bandwidth and route by which a run is observed.

    ``bandwidth`` is the -3 dB frequency of the zero-phase filter that rigid and total acceleration pass, Hz;
    ``recorder_begin`` a sampling instant of the recorders, s after the valve signal; ``route`` "exact", or one of the
    paper.
    """

    channels: tuple[SensorChannel, ...]
    bandwidth: float
    recorder_begin: float
    route: str = EXACT


class BlowHistory(NamedTuple):
    """Histories of one blow about first touch.

    ``since`` is the time after first touch, s; ``rigid`` is at the bandwidth; ``force``, ``speed`` and ``total``
    (at the bandwidth) have one row a tap; ``readings`` one a sensor, each with its own instants; ``routes`` holds
    the wave acceleration (at the bandwidth) by tap and route of the paper; ``front`` is the rise time of the steepest
    front at any tap, before the filter, s; ``followed`` how long after the pulse they go on, s: it ends half a swing
    of the frame after the release that ends the blow; ``at_rest`` what a sensor reads at rest, m/s^2. Without taps,
    ``since`` and ``rigid`` are empty.
    """

    since: Array
    rigid: Array
    force: Array
    speed: Array
    total: Array
    readings: tuple[SensorReading, ...]
    routes: dict[tuple[int, str], Array]
    front: float
    followed: float
    at_rest: float


def blow_histories(run: MachineRun, run_blows: Sequence[Blow], view: ReadingSetup) -> tuple[BlowHistory | None, ...]:
    """Return the histories of each blow of a run, of the first one also by the routes of the paper; None of a miss."""
    tail = max(WINDOW_AFTER, *map(settling_time, view.channels), 0.0)
    ends = window_ends(run, run_blows, tail)
    step = reading_step(run, run_blows, ends, view.channels)
    first = first_struck(run_blows)
    histories: list[BlowHistory | None] = []
    for blow, end in zip(run_blows, ends, strict=True):
        missed = blow.kind == "missed"
        histories.append(None if missed else blow_history(run, blow, view, float(end), step, routes=blow is first))
    return tuple(histories)


def reading_step(run: MachineRun, run_blows: Sequence[Blow], ends: Array, channels: Sequence[SensorChannel]) -> float:
    """Return the spacing of the histories of blows whose windows have these ends, s (NaN: missed), for some sensors.

    Short pulses have the finest one; a longer one has no more samples than a pulse needs, or than what swings and
    filters need: the frame of the object, resonances and buffers, cutoffs.
    """
    struck = struck_blows(run_blows)
    if not struck or not channels:
        return RIGID_STEP
    lasting = ends[np.isfinite(ends)] - [blow.time for blow in struck]
    longest, quickest = float(lasting.max()), min([blow.contact_time for blow in struck])
    cutoff = max([c.recorder.cutoff for c in channels if math.isfinite(c.recorder.cutoff)], default=0.0)
    fastest = max(1.0 / shortest_period(channels), run.machine.struck.frame_frequency, cutoff)
    wanted = min(longest / SAMPLES_A_WINDOW, quickest / SAMPLES_A_TOUCH, 1.0 / (SAMPLES_A_PERIOD * fastest))
    bound = max(longest / MOST_A_WINDOW, min(float(lasting.sum()) / MOST_OF_A_SENSOR, longest / SAMPLES_A_WINDOW))
    filtered = 1.0 / (SAMPLES_A_CUTOFF * cutoff) if cutoff else math.inf
    return max(RIGID_STEP, min(max(wanted, bound), filtered))


def blow_history(
    run: MachineRun, blow: Blow, view: ReadingSetup, end: float, step: float, routes: bool = False
) -> BlowHistory:
    """Return the histories of a blow that touched; with ``routes``, also by those of the paper.

    Before first touch everything moves as the rigid assembly does; the history ends at ``end``, or where a stack has
    settled, and has this step, or that of the stack. By a route of the paper, total is the rigid acceleration and the
    wave's on top of it, driven by the contact force.
    """
    span = run.span_at(blow.time + 1e-12)
    layered = run.machine.layered if isinstance(span, StackSpan) else None
    step = span.step if isinstance(span, StackSpan) else step
    # the last sample of a stack is an average over what lies before it alone: a filter would count its jump twice
    last = span.end - span.step if isinstance(span, StackSpan) else end
    followed = last - blow.time - blow.contact_time - 0.5 / run.machine.struck.frame_frequency
    at_rest = run.machine.struck.sensed_gravity - run.machine.struck.gravity
    if layered is None and not view.channels:
        return BlowHistory(*(np.empty(0),) * 5, (), {}, math.inf, followed, at_rest)
    before = round(min(WINDOW_BEFORE, blow.time) / step)
    after = math.floor((last - blow.time) / step + 1e-9)
    since = step * np.arange(-before, after + 1, dtype=np.float64)
    moments = run.sample(np.clip(blow.time + since, 0.0, last))
    rigid, by_route, without = moments.rigid_acceleration, {}, []
    taps = layered.taps if layered else ()
    force, speed, total = np.zeros((3, len(taps), since.size))
    for k, (layer, position) in enumerate(taps):
        assert isinstance(span, StackSpan)
        assert layered is not None
        parts = span.tap(k)
        size = min(parts[0].size, after + 1)
        force[k, before : before + size] = parts[0][:size]
        speed[k, :before], total[k, :before] = moments.object_speed[:before], rigid[:before]
        speed[k, before : before + size], total[k, before : before + size] = parts[1][:size], parts[2][:size]
        known = specimen_of(layered.stack, layer) is not None
        for route in ROUTES if known and (routes or view.route != EXACT) else ():
            wave = route_history(layered.stack, layer, position, since, moments.contact_force, route)
            by_route[k, route] = wave.acceleration
            if route == view.route:
                force[k], speed[k] = wave.force, moments.object_speed + wave.velocity
                total[k] = superposed(rigid, wave.acceleration)
        if view.route != EXACT and not known:
            without.append(k)
    start, launched = float(since[0]), run.machine.launch is not None
    readings = []
    for channel in view.channels:
        felt = rigid if channel.tap is None else total[channel.tap]
        readings.append(_recorded(channel, felt, step, start, blow.time - view.recorder_begin, launched))
    steepest = min([front(values, step) for values in total], default=math.inf)
    if taps:
        filtered = stated(np.vstack([rigid, total, *by_route.values()]), step, view.bandwidth)
        rigid, total = filtered[0], filtered[1 : len(taps) + 1]
        by_route = dict(zip(by_route, filtered[len(taps) + 1 :], strict=True))
        for history in (force, speed, total):
            history[without] = np.nan
    else:  # nothing shows more of the blow than the readings: a thousand of them would take 250 MB
        since = rigid = np.empty(0)
    return BlowHistory(since, rigid, force, speed, total, tuple(readings), by_route, steepest, followed, at_rest)


def _recorded(
    channel: SensorChannel, felt: Array, step: float, start: float, touched: float, launched: bool
) -> SensorReading:
    """Return what a channel keeps of a history from ``start`` on; a slow recorder may take no sample in it.

    ``touched`` is the time of first touch after a sampling instant of the recorder. Before the blow of a launched
    machine (``launched``) a sensor has read its first value for long; one on a spring, whose acceleration changes from
    blow to blow, was at rest.
    """
    rate = channel.recorder.sampling_rate
    if math.isinf(rate):
        return read(channel.sensor, channel.recorder, felt, step, start, steady=launched)
    at = (touched + start) * rate
    phase = min(math.ceil(at) - at, 1.0 - 1e-9)
    if phase / rate > (felt.size - 1) * step:
        return SensorReading(np.empty(0), np.empty(0), False, False, math.nan, 0.0)
    return read(channel.sensor, channel.recorder, felt, step, start, phase, steady=launched)


def blow_reading(history: BlowHistory, view: ReadingSetup) -> BlowReading:
    """Return the peaks of a blow's history."""
    sensors = dict[str, SensorPulse]()
    for channel, reading in zip(view.channels, history.readings, strict=True):
        # a reading is cut off where it ends in touch, or before a slow filter has answered the pulse
        cut = history.followed <= settling_time(channel) and still_on(reading, history.at_rest)
        sensors[channel.sensor.name] = replace(sensor_pulse(reading), cut=cut)
    if not len(history.total):
        return BlowReading(None, None, None, sensors)
    return BlowReading(largest(history.total[0]), largest(history.total[0] - history.rigid), view.bandwidth, sensors)


class Observed(NamedTuple):
    """A run with its blows, the set-up of its readings, the names of its taps, and histories and readings a blow."""

    run: MachineRun
    blows: tuple[Blow, ...]
    view: ReadingSetup
    taps: tuple[str, ...]
    histories: tuple[BlowHistory | None, ...]
    readings: tuple[BlowReading | None, ...]

    @property
    def machine(self) -> Machine:
        """Machine that ran."""
        return self.run.machine


PULSE_STEP = 0.5e-6  # s; finest sampling of the stored windows: 300 samples of a pulse of 150 us
SAMPLES_A_PULSE = 3000
"""Samples of the shortest pulse of which no more are needed: as many as of one of 1.5 ms at the finest sampling."""
MOST_KEPT_SAMPLES = 5_000_000
"""Samples of all windows together that are kept at most of a quantity, 40 MB; as many as of a short pulse at the finest
sampling a window has anyway."""


def carriage_position(case: Case, phases: Sequence[tuple[str, float]], time: Array) -> Array:
    """Return the distance of the carriage from its fed place, m, at times after the valve signal."""
    feed, at, moved = case.rotary_tables().feed, dict(phases), np.empty((2, time.size))
    rise, fall = or_else(feed.acceleration, 0.5), or_else(feed.cushion, 0.5)
    for (begin, end), share in zip((("feed", "fed"), ("retract", "brake")), moved, strict=True):
        stroke_places((time - at[begin]) / (at[end] - at[begin]), rise, fall, share)
    return np.asarray(feed.stroke.si * (1.0 - moved[0] + moved[1]))


def pulse_axis(run: MachineRun, run_blows: Sequence[Blow]) -> tuple[Array, float]:
    """Return time since first touch and its step, s, of the windows of all blows: as long as the longest pulse needs.

    The step is the finest one where pulses are short or waves run through a stack, and coarser for pulses that are all
    long, or for more samples than are kept.
    """
    lasting = window_ends(run, run_blows) - [blow.time for blow in run_blows]
    longest = max([WINDOW_AFTER, *lasting[np.isfinite(lasting)]])
    shortest = min([blow.contact_time for blow in struck_blows(run_blows)], default=0.0)
    step = PULSE_STEP if run.machine.layered else max(PULSE_STEP, shortest / SAMPLES_A_PULSE)
    usual = (WINDOW_BEFORE + WINDOW_AFTER) / PULSE_STEP
    step = max(step, longest / max(MOST_KEPT_SAMPLES / max(len(run_blows), 1), usual))
    return np.arange(-round(WINDOW_BEFORE / step), math.floor(longest / step + 1e-6) + 1) * step, step


def build_dataset(case: Case, seen: Observed) -> LabelledArrays:
    """Sample a run and what was seen of it into the arrays of a dataset."""
    run, blows = seen.run, seen.blows
    time = np.arange(0.0, run.end, case.solver.output_step.si)
    time = time[time <= run.end]  # rounding may lead beyond
    train = run.sample(time)
    ends = window_ends(run, blows)
    pulse_time, pulse_step = pulse_axis(run, blows)
    force, acceleration = np.full((2, len(blows), pulse_time.size), np.nan)
    for row, blow in enumerate(blows):
        if blow.kind != "missed":
            until = min(float(ends[row]) - blow.time, pulse_time[-1])
            since, f, a = pulse_window(run, blow.time, until, pulse_step)
            first = round((since[0] - pulse_time[0]) / pulse_step)
            window = slice(first, first + since.size)
            force[row, window], acceleration[row, window] = np.array([f, a])[:, : pulse_time.size - first]
    recorder, begun = case.impact().recorder, case.time_zero
    record_time = recorder.begin + np.arange(int(recorder.memory.si)) / recorder.sampling_rate.si
    inside = (record_time >= (-np.inf if case.launched() else 0.0)) & (record_time <= run.end)
    # a launched machine is in flight before its run begins, at the acceleration that it begins with
    record = np.zeros(record_time.size)
    record[inside] = run.sample(np.maximum(record_time[inside], 0.0)).rigid_acceleration
    of_pulse = ("blow", "pulse_time")
    variables = {
        "contact_force": quantity("time", train.contact_force, "N", "contact force"),
        "rigid_acceleration": quantity("time", train.rigid_acceleration, "m/s^2", "rigid-body acceleration"),
        "nose_position": quantity("time", train.face_place, "m", "position of the struck face along the blow"),
        "assembly_position": quantity("time", train.assembly_place, "m", "position of the assembly"),
        "assembly_speed": quantity("time", train.assembly_speed, "m/s", "speed of the assembly"),
        "pulse_force": quantity(of_pulse, force, "N", "contact force of each blow"),
        "pulse_acceleration": quantity(of_pulse, acceleration, "m/s^2", "rigid-body acceleration of each blow"),
        "record_acceleration": quantity(
            "record_time", record, "m/s^2", "rigid-body acceleration as an ideal recorder samples it"
        ),
    }
    if case.launched() is None:
        variables["turntable_speed"] = quantity("time", train.turntable_speed, "rad/s", "turntable speed")
    if {"feed", "fed", "retract", "brake"} <= dict(run.phases).keys():
        carriage, turned = carriage_position(case, run.phases, time), train.turntable_angle
        angle = "angle of the first striker after the strike position"
        variables["turntable_angle"] = quantity("time", turned, "rad", angle)
        variables["carriage_position"] = quantity("time", carriage, "m", "way of the carriage from its fed place")
    for column, declared in declarations(Blow).items():
        if column not in ("index", "kind"):
            values, unit = np.array([getattr(blow, column) for blow in blows]), declared.quantity.si or "1"
            variables[f"blow_{column}"] = quantity("blow", values, unit, column.replace("_", " "))
    variables["blow_kind"] = quantity("blow", np.array([blow.kind for blow in blows], dtype=object), "1", "kind")
    coordinates = {
        "time": quantity("time", time, "s", f"time after {begun}"),
        "pulse_time": quantity("pulse_time", pulse_time, "s", "time after first touch"),
        "record_time": quantity("record_time", record_time, "s", f"time after {begun}"),
        "blow": ("blow", np.array([b.index for b in blows], dtype=np.int64)),
    }
    if seen.taps:
        variables |= _tap_variables(seen.histories, len(seen.taps), pulse_time, seen.view)
        coordinates["tap"] = ("tap", np.array(seen.taps, dtype=object))
        coordinates["route"] = ("route", np.array(ROUTES, dtype=object))
    variables |= _reading_variables(seen.histories, seen.view.channels)
    variables |= _field_variables(run)
    return LabelledArrays.of(variables, coordinates, {"route": seen.view.route})


def _tap_variables(
    histories: Sequence[BlowHistory | None], taps: int, pulse_time: Any, view: ReadingSetup
) -> dict[str, Any]:
    """Return the variables of the taps: force, speed, acceleration, the rigid body's, and the paper's of one blow."""
    force, speed, total = np.full((3, len(histories), taps, pulse_time.size), np.nan)
    rigid = np.full((len(histories), pulse_time.size), np.nan)
    waves, first = np.full((len(ROUTES), taps, pulse_time.size), np.nan), next(filter(None, histories), None)
    for row, history in enumerate(histories):
        if history is None or not len(history.total):
            continue
        at = functools.partial(np.interp, pulse_time, history.since, left=np.nan, right=np.nan)
        rigid[row] = at(history.rigid)
        for k in range(taps):
            force[row, k], speed[row, k] = at(history.force[k]), at(history.speed[k])
            total[row, k] = at(history.total[k])
        if history is first:
            for (tap, route), values in history.routes.items():
                waves[ROUTES.index(route), tap] = at(values)
    paper = f"stress-wave acceleration, first blow, by the routes of Li & Ma 2019, at {view.bandwidth:g} Hz"
    where, band = ("blow", "tap", "pulse_time"), f"{view.route}, at {view.bandwidth:g} Hz"
    return {
        "tap_force": quantity(where, force, "N", "force in the stack at each tap"),
        "tap_speed": quantity(where, speed, "m/s", "speed at each tap"),
        "tap_acceleration": quantity(where, total, "m/s^2", f"total acceleration at each tap, {band}"),
        "rigid_acceleration_filtered": quantity(
            ("blow", "pulse_time"), rigid, "m/s^2", f"rigid-body acceleration of each blow, {band}"
        ),
        "route_acceleration": quantity(("route", "tap", "pulse_time"), waves, "m/s^2", paper),
    }


def _reading_variables(histories: Sequence[BlowHistory | None], channels: Sequence[SensorChannel]) -> dict[str, Any]:
    """Return the records of each sensor, blow by blow, and the time at which each begins."""
    variables: dict[str, Any] = {}
    for k, channel in enumerate(channels):
        readings = {row: history.readings[k] for row, history in enumerate(histories) if history}
        size = max([reading.values.size for reading in readings.values()], default=0)
        values, start, step = np.full((len(histories), size), np.nan), np.full(len(histories), np.nan), 0.0
        for row, reading in readings.items():
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
