"""What taps and sensors show of each blow: total and wave acceleration at a bandwidth, and sensor readings.

Total is what a perfect sensor at a section would read; wave is total less the rigid-body acceleration of the
assembly, both at the same bandwidth, so that nothing is counted twice. A peak is the value of largest
magnitude, with its sign.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import MORE
from strikewave.base.shock_quantities import BANDWIDTH, TOTAL_PEAK
from strikewave.machines.blows import WINDOW_AFTER, WINDOW_BEFORE, Blow, window_ends
from strikewave.machines.machine import Machine
from strikewave.machines.run import MachineRun
from strikewave.machines.spans import StackSpan
from strikewave.sensors import Reading, read
from strikewave.sensors.channel import (
    SensorChannel,
    SensorPulse,
    sensor_pulse,
    settling_time,
    shortest_period,
    still_on,
)
from strikewave.signal.filters import stated
from strikewave.signal.pulse import front, largest
from strikewave.waves.li_ma import EXACT, ROUTES, route_history, specimen_of, superposed

Array = NDArray[np.float64]

RIGID_STEP = 0.1e-6
"""Finest spacing of the history that a sensor gets where the object is no stack, s."""
SAMPLES_A_WINDOW, SAMPLES_A_TOUCH, SAMPLES_A_PERIOD = 30_000, 1000, 20
"""Samples of which no more are needed: of a window, as many as of a pulse of 1.5 ms at the finest spacing; of the time
in touch, where a sample is 1e-6 below the top of a half-sine at most; of a period of the fastest that swings or is
filtered, of whose top a sample is at most 1 - cos(pi/20) = 1.2 % below."""
MOST_A_WINDOW, MOST_SAMPLES = 200_000, 20_000_000
"""Samples of a window at most, 20 ms at the finest spacing; and of all windows of a run, 160 MB for a sensor, as far as
each has those of a short pulse."""
SAMPLES_A_CUTOFF = 4
"""Samples to a period of a filter's cutoff at least: it must lie below half the rate."""


@declare.dataclass
class BlowReading:
    """What taps and sensors show of one blow; None where the object is no stack."""

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


class ReadingSetup(NamedTuple):
    """How a run is looked at.

    Attributes
    ----------
    channels : tuple of SensorChannel
        The sensors.
    bandwidth : float
        -3 dB of the zero-phase filter that rigid and total acceleration pass, Hz.
    recorder_begin : float
        A sampling instant of the recorders, s after the valve signal.
    route : str
        "exact", or a route of the paper.
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
    readings: tuple[Reading, ...]
    routes: dict[tuple[int, str], Array]
    front: float
    followed: float
    at_rest: float


def blow_histories(run: MachineRun, found: Sequence[Blow], view: ReadingSetup) -> tuple[BlowHistory | None, ...]:
    """Return what taps and sensors show of each blow of a run, of the first one also by the routes of the paper.

    None of a blow that missed.
    """
    tail = max(WINDOW_AFTER, *map(settling_time, view.channels), 0.0)
    ends = window_ends(run, found, tail)
    step = reading_step(run, found, ends, view.channels)
    first = next((blow for blow in found if blow.kind != "missed"), None)
    return tuple(
        None if blow.kind == "missed" else blow_history(run, blow, view, float(end), step, routes=blow is first)
        for blow, end in zip(found, ends, strict=True)
    )


def reading_step(run: MachineRun, found: Sequence[Blow], ends: Array, channels: Sequence[SensorChannel]) -> float:
    """Return the spacing of the histories of blows whose windows have these ends, s (NaN: missed), for some sensors.

    Short pulses have the finest one; a longer one has no more samples than a pulse needs, or than what swings and
    filters need: the frame of the object, resonances and buffers, cutoffs.
    """
    struck = np.array([end - blow.time for blow, end in zip(found, ends, strict=True) if blow.kind != "missed"])
    if struck.size == 0 or not channels:
        return RIGID_STEP
    longest, quickest = float(struck.max()), min(blow.contact_time for blow in found if blow.kind != "missed")
    cutoff = max((c.recorder.cutoff for c in channels if math.isfinite(c.recorder.cutoff)), default=0.0)
    fastest = max(1.0 / shortest_period(channels), run.machine.struck.frame_frequency, cutoff)
    wanted = min(longest / SAMPLES_A_WINDOW, quickest / SAMPLES_A_TOUCH, 1.0 / (SAMPLES_A_PERIOD * fastest))
    bound = max(longest / MOST_A_WINDOW, min(float(struck.sum()) / MOST_SAMPLES, longest / SAMPLES_A_WINDOW))
    filtered = 1.0 / (SAMPLES_A_CUTOFF * cutoff) if cutoff else math.inf
    return max(RIGID_STEP, min(max(wanted, bound), filtered))


def blow_history(
    run: MachineRun, blow: Blow, view: ReadingSetup, end: float, step: float, routes: bool = False
) -> BlowHistory:
    """Return what taps and sensors show of a blow that touched; with ``routes``, also by those of the paper.

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
    force, speed, total = (np.zeros((len(taps), since.size)) for _ in range(3))
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
    steepest = min((front(values, step) for values in total), default=math.inf)
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
) -> Reading:
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
        return Reading(np.empty(0), np.empty(0), False, False, math.nan, 0.0)
    return read(channel.sensor, channel.recorder, felt, step, start, phase, steady=launched)


def without_peaks(reading: BlowReading) -> BlowReading:
    """Return a reading without the peaks that may not be quoted."""
    return replace(reading, total_peak=None, wave_peak=None)


def blow_reading(history: BlowHistory, view: ReadingSetup) -> BlowReading:
    """Return the peaks of a blow's history."""
    pairs = zip(view.channels, history.readings, strict=True)
    sensors = {
        channel.sensor.name: replace(sensor_pulse(reading), cut=_is_cut(channel, reading, history))
        for channel, reading in pairs
    }
    if not len(history.total):
        return BlowReading(None, None, None, sensors)
    return BlowReading(largest(history.total[0]), largest(history.total[0] - history.rigid), view.bandwidth, sensors)


def _is_cut(channel: SensorChannel, reading: Reading, history: BlowHistory) -> bool:
    """Tell whether a reading ends before the pulse does: in touch, or before a slow filter has answered it."""
    return history.followed <= settling_time(channel) and still_on(reading, history.at_rest)


class Observed(NamedTuple):
    """A run and all that was seen of it: blows, how it was looked at, names of taps; histories and readings a blow."""

    run: MachineRun
    blows: tuple[Blow, ...]
    view: ReadingSetup
    taps: tuple[str, ...]
    histories: tuple[BlowHistory | None, ...]
    readings: tuple[BlowReading | None, ...]

    @property
    def machine(self) -> Machine:
        """What ran."""
        return self.run.machine
