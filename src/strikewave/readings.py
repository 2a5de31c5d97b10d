"""What taps and sensors show of each blow: total and wave acceleration at a bandwidth, and sensor readings.

Total is what a perfect sensor at a section would read; wave is total less the rigid-body acceleration of the
assembly, both at the same bandwidth, so that nothing is counted twice. A peak is the value of largest
magnitude, with its sign.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.machines.blows import WINDOW_AFTER, WINDOW_BEFORE, Blow
from strikewave.machines.rotary import RotaryMachine, RotaryRun
from strikewave.machines.spans import StackSpan
from strikewave.sensors import Reading, Recorder, Sensor, read
from strikewave.signal.filters import zero_phase
from strikewave.signal.pulse import measure_pulse, refine_peak
from strikewave.waves.li_ma import ROUTES, superposed
from strikewave.waves.routes import EXACT, route_history, specimen_of

Array = NDArray[np.float64]

RIGID_STEP = 0.1e-6
"""Spacing of the history that a sensor gets where the object is no stack, s."""


class Channel(NamedTuple):
    """A sensor, the index of the tap it sits at (None: it feels the rigid assembly), and its recorder."""

    sensor: Sensor
    tap: int | None
    recorder: Recorder


@dataclass(frozen=True)
class SensorPulse:
    """What a sensor made of one blow: peak (m/s^2), width at 10 % of the peak (s), and whether it clipped."""

    peak: float
    width: float
    clipped: bool


@dataclass(frozen=True)
class BlowReading:
    """What taps and sensors show of one blow.

    Attributes
    ----------
    total_peak, wave_peak : float or None
        At the first tap, at the bandwidth, m/s^2; None where the object is no stack.
    bandwidth : float or None
        Hz.
    sensors : dict
        `SensorPulse` by name.
    """

    total_peak: float | None
    wave_peak: float | None
    bandwidth: float | None
    sensors: dict[str, SensorPulse]


class View(NamedTuple):
    """How a run is looked at.

    Attributes
    ----------
    channels : tuple of Channel
        The sensors.
    bandwidth : float
        -3 dB of the zero-phase filter that rigid and total acceleration pass, Hz.
    recorder_begin : float
        A sampling instant of the recorders, s after the valve signal.
    route : str
        "exact", or a route of the paper.
    """

    channels: tuple[Channel, ...]
    bandwidth: float
    recorder_begin: float
    route: str = EXACT


class BlowHistory(NamedTuple):
    """Histories of one blow about first touch.

    ``since`` is the time after first touch, s; ``rigid`` is at the bandwidth; ``force``, ``speed`` and ``total``
    (at the bandwidth) have one row a tap; ``readings`` one a sensor, each with its own instants; ``routes`` holds
    the wave acceleration (at the bandwidth) by tap and route of the paper.
    """

    since: Array
    rigid: Array
    force: Array
    speed: Array
    total: Array
    readings: tuple[Reading, ...]
    routes: dict[tuple[int, str], Array]


def largest(values: Array) -> float:
    """Return the value of largest magnitude, with its sign, between samples by a parabola; NaN is passed over.

    Examples
    --------
    >>> largest(np.array([1.0, -3.0, 2.0, -3.0, -4.0, -3.0]))
    -4.0
    """
    values = values[np.isfinite(values)]
    sign = 1.0 if values.max() >= -values.min() else -1.0
    return sign * refine_peak(sign * values, int(np.argmax(sign * values)))[1]


def blow_history(run: RotaryRun, blow: Blow, view: View, routes: bool = False) -> BlowHistory:
    """Return what taps and sensors show of a blow that touched; with ``routes``, also by those of the paper.

    Before first touch everything moves as the rigid assembly does; the history ends with the blow's window,
    or where a stack has settled. By a route of the paper, total is the rigid acceleration and the wave's on
    top of it, driven by the contact force.
    """
    span = run.span_at(blow.time + 1e-12)
    layered = run.machine.layered if isinstance(span, StackSpan) else None
    step = span.step if isinstance(span, StackSpan) else RIGID_STEP
    last = span.end if isinstance(span, StackSpan) else min(blow.time + WINDOW_AFTER, run.end)
    before = round(min(WINDOW_BEFORE, blow.time) / step)
    after = math.floor((last - blow.time) / step + 1e-9)
    since = step * np.arange(-before, after + 1, dtype=np.float64)
    moments = run.sample(np.minimum(blow.time + since, last))
    rigid, by_route = moments.rigid_acceleration, {}
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
        if specimen_of(layered.stack, layer) is None:
            continue
        for route in ROUTES:
            if not routes and route != view.route:
                continue
            wave = route_history(layered.stack, layer, position, since, moments.contact_force, route)
            by_route[k, route] = wave.acceleration
            if route == view.route:
                force[k], speed[k] = wave.force, moments.object_speed + wave.velocity
                total[k] = superposed(rigid, wave.acceleration)
    start = float(since[0])
    readings = []
    for channel in view.channels:
        felt = rigid if channel.tap is None else total[channel.tap]
        rate = channel.recorder.sampling_rate
        at = (blow.time + start - view.recorder_begin) * rate
        phase = 0.0 if math.isinf(rate) else min(math.ceil(at) - at, 1.0 - 1e-9)
        readings.append(read(channel.sensor, channel.recorder, felt, step, start, phase))
    if taps:
        filtered = zero_phase(np.vstack([rigid, total, *by_route.values()]), step, view.bandwidth)
        # near the end the filter would need what comes after the stack has been let go
        filtered[:, since > since[-1] - min(1.0 / view.bandwidth, 0.5 * since[-1])] = np.nan
        rigid, total = filtered[0], filtered[1 : len(taps) + 1]
        by_route = dict(zip(by_route, filtered[len(taps) + 1 :], strict=True))
    return BlowHistory(since, rigid, force, speed, total, tuple(readings), by_route)


def sensor_sources(channels: Sequence[Channel]) -> list[str]:
    """Return the keys of the sources of the sensor models that take part."""
    if all(channel.sensor == Sensor(channel.sensor.name) for channel in channels):
        return []
    buffered = any(not channel.sensor.mounting.direct for channel in channels)
    return ["smallwood-1981", "van-loan-1978", *(["patera-1984", "emmerich-korn-1987"] if buffered else [])]


def sensor_pulse(reading: Reading) -> SensorPulse:
    """Return peak, width and clipping of a reading."""
    values = reading.values
    interval = float(reading.time[1] - reading.time[0]) if values.size > 1 else math.nan
    width = measure_pulse(values, interval).width if values.size > 2 and values.max() > 0.0 else math.nan
    return SensorPulse(largest(values), width, reading.clipped)


def without_peaks(reading: BlowReading) -> BlowReading:
    """Return a reading without the peaks that may not be quoted."""
    return replace(reading, total_peak=None, wave_peak=None)


def blow_reading(history: BlowHistory, view: View) -> BlowReading:
    """Return the peaks of a blow's history."""
    pairs = zip(view.channels, history.readings, strict=True)
    sensors = {channel.sensor.name: sensor_pulse(reading) for channel, reading in pairs}
    if not len(history.total):
        return BlowReading(None, None, None, sensors)
    return BlowReading(largest(history.total[0]), largest(history.total[0] - history.rigid), view.bandwidth, sensors)


class Observed(NamedTuple):
    """A run and all that was seen of it: blows, how it was looked at, names of taps; histories and readings a blow."""

    run: RotaryRun
    blows: tuple[Blow, ...]
    view: View
    taps: tuple[str, ...]
    histories: tuple[BlowHistory | None, ...]
    readings: tuple[BlowReading | None, ...]

    @property
    def machine(self) -> RotaryMachine:
        """What ran."""
        return self.run.machine
