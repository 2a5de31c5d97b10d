"""From a surface to a record: mounting, seismic resonance, range, anti-alias filter, sampling, bits."""

from __future__ import annotations

import functools
import math
import tomllib
from dataclasses import dataclass, field
from importlib import resources
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base.errors import InputError, nearest
from strikewave.sensors.mounting import Mounting, mounting_system
from strikewave.sensors.response import Recursion, history, ramp_invariant, seismic, series
from strikewave.signal.filters import MOST_POLES, low_pass

Array = NDArray[np.float64]

# Magnification at resonance where none is given: about 30 dB, as undamped accelerometers have. Assumed; Kistler's
# manual of its quartz shock accelerometers 8742A (002-096e-01.19, page 18) says about 10 to 40.
ASSUMED_QUALITY = 30.0

BITS = 2, 32  # bits of a recorder: two make the fewest codes to both sides of zero, and no converter has more than 32

# A recorder that rides in the fixture; all assumed, as small shock recorders are. A cutoff at a fifth of the sampling
# rate keeps what folds back into the passband below -48 dB with four poles.
STORAGE_RATE, STORAGE_BITS, STORAGE_POLES, RATE_OVER_CUTOFF = 100e3, 12, 4, 5.0

SCOPE_RATE, SCOPE_BITS = 10e6, 8  # a fast recorder beside the machine; assumed, as digital oscilloscopes are

# Share of a sampling interval by which an instant at the very end may lie behind it through rounding, and counts
_LAST_INSTANT = 1e-6


@dataclass(frozen=True)
class Sensor:
    """An accelerometer and how it is held; ideal where nothing is set.

    Parameters
    ----------
    name : str, optional
        Name of the sensor.
    mounting : Mounting, optional
        Between the surface and its case.
    resonance : float, optional
        Resonance frequency of the mass on the spring inside, Hz.
    quality : float, optional
        Magnification at resonance.
    range : float, optional
        Largest reading to both sides, m/s^2.
    zero_shift : float, optional
        Offset of the reading, m/s^2.

    Raises
    ------
    ValueError
        If a value makes no sense.
    """

    name: str = "sensor"
    mounting: Mounting = field(default_factory=Mounting)
    resonance: float = math.inf
    quality: float = ASSUMED_QUALITY
    range: float = math.inf
    zero_shift: float = 0.0

    def __post_init__(self) -> None:
        for key in ("resonance", "quality", "range"):
            if not getattr(self, key) > 0.0:
                raise ValueError(f"{key} of sensor {self.name!r} must be above zero, got {getattr(self, key)!r}")
        if not math.isfinite(self.zero_shift):
            raise ValueError(f"zero shift of sensor {self.name!r} must be finite, got {self.zero_shift!r}")


@dataclass(frozen=True)
class Recorder:
    """Recorder that turns a sensor's signal into numbers; it takes every sample as it is where nothing is set.

    Parameters
    ----------
    sampling_rate : float, optional
        Hz; infinite takes every sample of the history.
    cutoff : float, optional
        -3 dB of the anti-alias filter, Hz.
    order : int, optional
        Poles of the anti-alias filter, a Butterworth low-pass.
    bits : int, optional
        0 for none. The codes are symmetric: 2^bits - 1 levels from minus to plus full scale, one of them zero.
    full_scale : float or None, optional
        Largest value to both sides, m/s^2; the range of the sensor where it is left out.

    Raises
    ------
    ValueError
        If a value makes no sense.
    """

    sampling_rate: float = math.inf
    cutoff: float = math.inf
    order: int = 4
    bits: int = 0
    full_scale: float | None = None

    def __post_init__(self) -> None:
        for key in ("sampling_rate", "cutoff"):
            if not getattr(self, key) > 0.0:
                raise ValueError(f"{key} of a recorder must be above zero, got {getattr(self, key)!r}")
        if self.full_scale is not None and not self.full_scale > 0.0:
            raise ValueError(f"full_scale of a recorder must be above zero, got {self.full_scale!r}")
        if self.bits != 0 and not (isinstance(self.bits, int) and BITS[0] <= self.bits <= BITS[1]):
            raise ValueError(
                f"bits of a recorder must be 0 or a whole number from {BITS[0]} to {BITS[1]}, got {self.bits!r}"
            )
        if not (isinstance(self.order, int) and 1 <= self.order <= MOST_POLES):
            raise ValueError(
                f"order of a recorder's filter must be a whole number from 1 to {MOST_POLES}, got {self.order!r}"
            )


def storage_recorder(full_scale: float | None = None) -> Recorder:
    """Return a recorder that rides in the fixture: 100 kHz, 12 bits, 4 poles at 20 kHz. All assumed.

    Examples
    --------
    >>> storage_recorder().sampling_rate
    100000.0
    """
    return Recorder(STORAGE_RATE, STORAGE_RATE / RATE_OVER_CUTOFF, STORAGE_POLES, STORAGE_BITS, full_scale)


def oscilloscope(full_scale: float | None = None) -> Recorder:
    """Return a fast recorder beside the machine: 10 MHz, 8 bits, no filter. All assumed.

    Examples
    --------
    >>> oscilloscope().bits
    8
    """
    return Recorder(sampling_rate=SCOPE_RATE, bits=SCOPE_BITS, full_scale=full_scale)


class SensorReading(NamedTuple):
    """Samples that a recorder kept.

    Attributes
    ----------
    time : ndarray
        Sampling instants, s.
    values : ndarray
        Recorded values, m/s^2.
    sensor_clipped, recorder_clipped : bool
        True if the sensor went beyond its range (which a filter behind it hides), or the filtered signal beyond full
        scale.
    peak_before_clip : float
        Largest magnitude that the sensor would have put out without its range, m/s^2.
    quantum : float
        Step between two codes, m/s^2; 0 without bits.
    """

    time: Array
    values: Array
    sensor_clipped: bool
    recorder_clipped: bool
    peak_before_clip: float
    quantum: float

    @property
    def clipped(self) -> bool:
        """True if the sensor or the recorder clipped the signal."""
        return self.sensor_clipped or self.recorder_clipped


def output(sensor: Sensor, acceleration: ArrayLike, step: float) -> Array:
    """Return a sensor's signal for the acceleration of the surface, before its range cuts it, m/s^2.

    Mounting and resonance are solved as one system, exactly for an acceleration linear between samples,
    from rest before the first.

    Parameters
    ----------
    sensor : Sensor
        Sensor that reads.
    acceleration : array_like
        Acceleration of the mounting surface, at even steps, m/s^2.
    step : float
        Time between samples, s.

    Examples
    --------
    >>> output(Sensor(), [0.0, 1.0, 0.0], 1e-6)
    array([0., 1., 0.])
    """
    values = history(acceleration)
    return _recursion(sensor.mounting, sensor.resonance, sensor.quality, float(step)).run(values) + sensor.zero_shift


@functools.lru_cache(maxsize=16)
def _recursion(mounting: Mounting, resonance: float, quality: float, step: float) -> Recursion:
    return ramp_invariant(series(mounting_system(mounting), seismic(resonance, quality)), step)


def read(
    sensor: Sensor,
    recorder: Recorder,
    acceleration: ArrayLike,
    step: float,
    start: float = 0.0,
    sample_phase: float = 0.0,
    steady: bool = False,
) -> SensorReading:
    """Return what a sensor and a recorder make of the acceleration of a surface.

    In order: mounting and seismic resonance (exact for an acceleration linear between samples), zero shift, the
    sensor's range, the anti-alias filter (causal, at the step of the history), the recorder's instants (linear
    between samples), its full scale and its bits. The range comes before the filter, as in a real chain: a
    filter can hide that a sensor went beyond its range.

    Parameters
    ----------
    sensor, recorder : Sensor, Recorder
        Sensor that reads, and recorder that keeps its signal.
    acceleration : array_like
        Acceleration of the mounting surface, at even steps, m/s^2; at rest before the first, or ``steady``.
    step : float
        Time between samples, s.
    start : float, optional
        Time of the first sample, s.
    sample_phase : float, optional
        Share of a sampling interval, 0 to 1, from the start to the recorder's first instant.
    steady : bool, optional
        True if the surface had its first acceleration for long, such as gravity in a fall, so that nothing answers it.

    Raises
    ------
    ValueError
        If the filter's cutoff is not below half the rate of the history, bits have no full scale to be spread
        over, no instant falls into the history, or a value makes no sense.

    Examples
    --------
    >>> t = np.arange(2001) * 1e-7
    >>> pulse = 1e5 * np.sin(np.pi * t / 200e-6)
    >>> reading = read(Sensor(range=8e4), Recorder(sampling_rate=100e3), pulse, 1e-7)
    >>> reading.values.size, round(float(reading.values.max())), reading.clipped, round(reading.peak_before_clip)
    (21, 80000, True, 100000)
    """
    if not 0.0 <= sample_phase < 1.0:
        raise ValueError(f"the phase of the first sample must lie from 0 to below 1, got {sample_phase!r}")
    full_scale = sensor.range if recorder.full_scale is None else recorder.full_scale
    if recorder.bits and math.isinf(full_scale):
        raise ValueError("a recorder with bits needs a full scale, or a sensor with a range")
    values = history(acceleration)
    before = float(values[0]) if steady else 0.0  # mounting, resonance and filter pass what does not change as it is
    signal = output(sensor, values - before, step) + before
    peak = float(np.max(np.abs(signal)))
    clipped = np.clip(signal, -sensor.range, sensor.range)
    if math.isfinite(recorder.cutoff):
        clipped = low_pass(clipped - before, step, recorder.cutoff, recorder.order) + before
    time, values = _sampled(clipped, step, recorder.sampling_rate, sample_phase)
    recorder_clipped = bool(np.max(np.abs(values)) > full_scale)
    values = np.clip(values, -full_scale, full_scale)
    quantum = 0.0
    if recorder.bits:
        levels = 2 ** (recorder.bits - 1) - 1
        quantum = full_scale / levels
        values = np.rint(values / full_scale * levels) / levels * full_scale
    return SensorReading(start + time, values, peak > sensor.range, recorder_clipped, peak, quantum)


def _sampled(values: Array, step: float, rate: float, phase: float) -> tuple[Array, Array]:
    """Return instants and values at a rate, linear between the samples of the history."""
    grid = np.arange(values.size, dtype=np.float64) * float(step)
    if math.isinf(rate):
        return grid, values
    count = math.floor(grid[-1] * rate - phase + _LAST_INSTANT) + 1
    if count < 1:
        raise ValueError(f"the history of {grid[-1]:g} s ends before the recorder's first instant")
    instants: Array = (np.arange(count) + phase) / rate
    return instants, np.interp(instants, grid, values)


@dataclass(frozen=True)
class Accelerometer:
    """An accelerometer of the table; SI.

    Attributes
    ----------
    name : str
        Name in the table.
    range : float
        Largest acceleration to both sides, m/s^2.
    resonance : float
        Hz; the least that the maker states where a range is given.
    kind : str
        piezoresistive or piezoelectric.
    source, status, note : str
        Source of the numbers; ``checked``, ``quoted`` or ``from memory`` (`strikewave.base.citations`); what to
        know about them.
    quality : float
        Magnification at resonance; assumed unless the note says otherwise.
    """

    name: str
    range: float
    resonance: float
    kind: str
    source: str
    status: str
    note: str
    quality: float = ASSUMED_QUALITY

    def mounted(self, mounting: Mounting | None = None) -> Sensor:
        """Return it as a sensor on a mounting, directly where none is given."""
        return Sensor(self.name, mounting or Mounting(), self.resonance, self.quality, self.range)


@functools.cache
def accelerometers() -> dict[str, Accelerometer]:
    """Return all accelerometers by name, in the order of the table.

    Examples
    --------
    >>> round(accelerometers()["Endevco 7270A-60K"].range / 9.80665)
    60000
    """
    text = (resources.files("strikewave.sensors") / "sensors.toml").read_text("utf-8")
    return {name: Accelerometer(name=name, **row) for name, row in tomllib.loads(text).items()}


def accelerometer(name: str, field: str = "sensor") -> Accelerometer:
    """Return an accelerometer by name; case does not matter.

    Parameters
    ----------
    name : str
        Name in the table.
    field : str, optional
        Path of the field, for the error message.

    Raises
    ------
    InputError
        If the table has no such accelerometer.

    Examples
    --------
    >>> accelerometer("pcb 350c02").kind
    'piezoelectric'
    """
    folded = {known.lower(): known for known in accelerometers()}
    if str(name).lower() not in folded:
        raise InputError(field, name, "an accelerometer of the table", nearest(str(name), accelerometers()))
    return accelerometers()[folded[str(name).lower()]]
