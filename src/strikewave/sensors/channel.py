"""A sensor where it sits, with its recorder, and what it makes of a pulse."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from strikewave.base import declare
from strikewave.base.declare import MAIN
from strikewave.base.percents import percent
from strikewave.base.result import Notice
from strikewave.base.shock_quantities import ACCELERATION, PULSE_WIDTH
from strikewave.sensors.chain import Reading, Recorder, Sensor
from strikewave.sensors.mounting import RESOLVED
from strikewave.signal.pulse import WIDTH_FRACTION, largest, measure_pulse

HEAVY_SENSOR = 0.02
"""Share of the assembly's mass above which a buffered sensor loads back what it sits on: it then changes that motion by
about as much, which the model leaves out."""


FILTER_PERIODS = 2.0
"""Periods of its cutoff within which a recorder's filter has answered a blow: four Butterworth poles are then within
1 % of a step, and the answer to an impulse is below 1.4 % of its largest value."""
LAST_SHARE = 0.02
"""Last part of a reading whose mean tells where it stands: what rings there cancels."""


class SensorChannel(NamedTuple):
    """A sensor, the index of the tap it sits at (None: it feels the rigid assembly), and its recorder."""

    sensor: Sensor
    tap: int | None
    recorder: Recorder


@declare.dataclass
class SensorPulse:
    """What a sensor made of one blow."""

    peak: float = declare.number(
        ACCELERATION, "what the sensor reads at most, with its sign", band="peak", column=MAIN, headline="sensor {name}"
    )
    width: float = declare.number(PULSE_WIDTH, "width of that pulse at 10 % of its peak", column=MAIN)
    clipped: bool = declare.word("whether sensor or recorder cut it off", column=MAIN)
    cut: bool = declare.word("whether the reading ends before the pulse does: its peak may come later", default=False)


def shortest_period(channels: Sequence[SensorChannel]) -> float:
    """Return the period of the highest resonance, or of what buffers let through, s; infinite without either."""
    highest = [channel.sensor.resonance for channel in channels if math.isfinite(channel.sensor.resonance)]
    highest += [RESOLVED for channel in channels if not channel.sensor.mounting.direct]
    return 1.0 / max(highest) if highest else math.inf


def settling_time(channel: SensorChannel) -> float:
    """Return how long after a blow the filter of a recorder still answers it, s."""
    return FILTER_PERIODS / channel.recorder.cutoff


def still_on(reading: Reading, at_rest: float = 0.0) -> bool:
    """Tell whether a reading stands above a tenth of its peak where it ends: from where it began, from zero, from rest.

    ``at_rest`` is what it reads at rest, m/s^2: gravity, where its zero was taken in the fall.
    """
    values = reading.values
    if values.size == 0:
        return False
    ends = float(values[-max(int(LAST_SHARE * values.size), 1) :].mean())
    nearest = min(abs(ends - level) for level in (0.0, at_rest, float(values[0])))
    return nearest > WIDTH_FRACTION * abs(largest(values))


def sensor_sources(channels: Sequence[SensorChannel]) -> list[str]:
    """Return the keys of the sources of the sensor models that take part."""
    if all(channel.sensor == Sensor(channel.sensor.name) for channel in channels):
        return []
    buffered = any(not channel.sensor.mounting.direct for channel in channels)
    return ["smallwood-1981", "van-loan-1978", *(["patera-1984", "emmerich-korn-1987"] if buffered else [])]


def sensor_pulse(reading: Reading) -> SensorPulse:
    """Return peak, width and clipping of a reading."""
    values = reading.values
    if values.size == 0:
        return SensorPulse(math.nan, math.nan, False)
    interval = float(reading.time[1] - reading.time[0]) if values.size > 1 else math.nan
    width = measure_pulse(values, interval).width if values.size > 2 and values.max() > 0.0 else math.nan
    return SensorPulse(largest(values), width, reading.clipped)


def channel_notices(
    channels: Sequence[SensorChannel], pulses: Sequence[dict[str, SensorPulse]], assembly_mass: float
) -> tuple[Notice, ...]:
    """Return what clipped, what a slow recorder missed, and which sensor is too heavy for what it sits on.

    ``pulses`` are those of each blow, by name of the sensor.
    """
    notices = []
    for channel in channels:
        name = channel.sensor.name
        clipped = sum(pulse[name].clipped for pulse in pulses)
        if clipped:
            limit = channel.sensor.range
            message = f"sensor {name} clips in {clipped} of {len(pulses)} pulses: take a larger range"
            notices.append(Notice("sensor-clipped", message, float(clipped), 0.0 if math.isinf(limit) else limit))
        missed = sum(math.isnan(pulse[name].peak) for pulse in pulses)
        if missed:
            message = f"the recorder of sensor {name} takes no sample in {missed} of {len(pulses)} pulses: too slow"
            notices.append(Notice("recorder-slow", message, channel.recorder.sampling_rate, 0.0))
        share = channel.sensor.mounting.sensor_mass / assembly_mass
        if share > HEAVY_SENSOR:
            message = f"sensor {name} weighs {percent(share)} of the assembly: its buffer would load the assembly back"
            notices.append(Notice("heavy-sensor", message, share, HEAVY_SENSOR))
    return tuple(notices)
