"""A sensor where it sits, with its recorder: what it makes of a pulse, and whether it can take a blow."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import MAIN
from strikewave.base.result import Notice
from strikewave.base.shock_quantities import ACCELERATION, MICROSECONDS, OF_CHANNEL, PULSE_WIDTH, RATIO
from strikewave.base.texts import percent
from strikewave.sensors.chain import Recorder, Sensor, SensorReading, output, read
from strikewave.sensors.mounting import RESOLVED, band
from strikewave.signal.oscillators import interpolate
from strikewave.signal.pulse import WIDTH_FRACTION, Pulse, largest, measure_pulse

HEAVY_SENSOR = 0.02  # share of the assembly's mass above which a sensor loads its site by about as much: not modelled


FILTER_PERIODS = 2.0  # periods in which a filter has answered: four Butterworth poles then miss 1 % of a step
LAST_SHARE = 0.02  # last part of a reading whose mean tells where it stands: what rings there cancels


class SensorChannel(NamedTuple):
    """A sensor, the index of the tap it sits at (None: it feels the rigid assembly), and its recorder."""

    sensor: Sensor
    tap: int | None
    recorder: Recorder


@declare.dataclass
class SensorPulse:
    """Pulse that a sensor reads of one blow."""

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


def still_on(reading: SensorReading, at_rest: float = 0.0) -> bool:
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


def sensor_pulse(reading: SensorReading) -> SensorPulse:
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


Array = NDArray[np.float64]

# New samples to a step of the motion, as far as they are no more than so many: what lies in the band of a motion then
# has 32 to a period, and a parabola through the top of a sine is 1e-5 low.
FINER, MOST_SAMPLES = 16, 4_000_000

TOLERATED = 0.05  # change of peak or width that is tolerated: the usual uncertainty of a calibrated shock accelerometer

# Places of the first instant of a recorder, in sampling intervals, that are tried: what is farthest off counts
PHASES = (0.0, 0.25, 0.5, 0.75)

# Verdicts on a blow, in words
TAKES, RANGE, FULL_SCALE, RESONANCE, RECORDER, NOISE = (
    *("can take it", "range exceeded", "full scale of the recorder exceeded", "pulse too short for its resonance"),
    *("pulse too short for its recorder", "not known: noise of the record drives its resonance"),
)


@declare.dataclass
class SensorTrial:
    """Shares of one blow that a sensor passes, and its use of the range."""

    peak: float = declare.number(OF_CHANNEL, "of the motion, above zero")
    peak_left: float = declare.number(
        RATIO,
        "peak of the reading over that of the motion, where the instants of the recorder leave it farthest off; 0 "
        "where none of them falls into the blow",
    )
    width_left: float = declare.number(
        RATIO, "the same of the width at 10 % of the own peak; null where it was not read"
    )
    range_used: float = declare.number(
        RATIO, "largest magnitude that the sensing element would put out without its range, over that range"
    )
    time_clipped: float = declare.number(MICROSECONDS, "how long it is beyond its range")
    ringing: float = declare.number(
        RATIO,
        "how far that output departs from the motion of the surface at most, over the peak: its resonances, excited, "
        "and the lag of a mounting",
    )
    noise_ringing: float = declare.number(RATIO, "the same before the blow, where there is noise alone")
    verdict: str = declare.word("in words")


def lowest_resonance(sensor: Sensor) -> float:
    """Return the lowest resonance of a sensor and its mounting below 200 kHz, Hz; infinite where there is none.

    Examples
    --------
    >>> lowest_resonance(Sensor(resonance=80e3))
    80000.0
    """
    mounted = band(sensor.mounting).resonance
    return min(sensor.resonance, math.inf if math.isnan(mounted) else mounted)


def try_sensor(sensor: Sensor, recorder: Recorder, values: Array, step: float, begin: int) -> SensorTrial:
    """Return what a sensor and a recorder leave of a positive blow.

    The motion is taken as it is: band-limited interpolation makes it dense, so that the straight lines between its
    samples excite no resonance. What lies above its band excites none either.

    Parameters
    ----------
    sensor, recorder : Sensor, Recorder
        Sensor and recorder that are tried.
    values : ndarray
        Motion of the surface around one blow, from rest, m/s^2.
    step : float
        Time between samples, s.
    begin : int
        Place of the foot of the blow: before it there is only noise.

    Raises
    ------
    ValueError
        If the motion has no positive value, or a value makes no sense.
    """
    factor = max(min(FINER, MOST_SAMPLES // values.size), 1)
    fine, step = interpolate(values, factor), step / factor
    true = measure_pulse(fine, step)
    element = output(sensor, fine, step) - sensor.zero_shift
    departure = np.abs(element - fine) / true.peak
    quiet = slice(0, max(begin * factor, 1))
    beyond = np.abs(element + sensor.zero_shift) > sensor.range
    shown = [(reading, _pulse(reading, sensor.zero_shift)) for reading in _readings(sensor, recorder, element, step)]
    left = (
        _farthest([pulse.peak / true.peak for _, pulse in shown], math.inf),
        _farthest([pulse.width * _interval(reading, step) / true.width for reading, pulse in shown], 0.0),
    )
    driven = measure_pulse(element, step)
    ringing, noise = float(departure.max()), float(departure[quiet].max())
    if true.peak > sensor.range:
        verdict = RANGE
    elif beyond.any():
        verdict = NOISE if noise > TOLERATED else RANGE
    elif any(reading.recorder_clipped for reading, _ in shown):
        verdict = FULL_SCALE
    elif not _close(driven.peak / true.peak, driven.width / true.width):
        verdict = NOISE if noise > TOLERATED else RESONANCE
    else:
        verdict = TAKES if _close(*left) else RECORDER
    used = float(np.max(np.abs(element + sensor.zero_shift))) / sensor.range
    return SensorTrial(true.peak, *left, used, float(np.count_nonzero(beyond)) * step, ringing, noise, verdict)


def _farthest(shares: Sequence[float], not_read: float) -> float:
    """Return the share that is farthest from one, one that was not read counted as so far."""
    return max(shares, key=lambda share: not_read if math.isnan(share) else abs(share - 1.0))


def _close(peak_left: float, width_left: float) -> bool:
    """Tell whether both are as good as one; a width that is not known, at the edge of a record, is not asked for."""
    return abs(peak_left - 1.0) <= TOLERATED and not abs(width_left - 1.0) > TOLERATED


def _readings(sensor: Sensor, recorder: Recorder, element: Array, step: float) -> Iterator[SensorReading]:
    """Return what is read of the output of the element, the recorder's instants at several places."""
    if recorder.cutoff >= 0.5 / step:  # above all that the motion holds
        recorder = dataclasses.replace(recorder, cutoff=math.inf)
    rest = Sensor(sensor.name, range=sensor.range, zero_shift=sensor.zero_shift)
    for phase in PHASES if math.isfinite(recorder.sampling_rate) else PHASES[:1]:
        yield read(rest, recorder, element, step, sample_phase=phase)


def _pulse(reading: SensorReading, shift: float) -> Pulse:
    """Return the pulse of a reading, in its samples; nothing where none fell into it. A flat top is no parabola's."""
    values = reading.values - shift
    if values.size < 3 or not values.max() > 0.0:
        return Pulse(math.nan, 0.0, math.nan, math.nan, math.nan)
    pulse = measure_pulse(values, 1.0)
    return pulse._replace(peak=float(values.max())) if reading.clipped else pulse


def _interval(reading: SensorReading, step: float) -> float:
    return float(reading.time[1] - reading.time[0]) if reading.time.size > 1 else step
