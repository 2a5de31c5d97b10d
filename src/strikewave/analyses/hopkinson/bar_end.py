"""The reference acceleration at the end of a bar, and the reading of a sensor there, on one clock and bandwidth.

The strain gauge sees the wave on its way to the end, and again on its way back. The first one, carried to the end,
gives the motion of the sensor, with the mass and disk there; the second one, which this does not use, checks it:

    v = 2 c e_i - F/Z    by the model's force F on the end        v = c (e_i - e_r)    by both waves

Symbols: e_i, e_r strain of incident and reflected wave, c bar speed (m/s), Z impedance (N s/m).
"""

from __future__ import annotations

import math
from dataclasses import field, replace
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import NO_UNIT, Quantity
from strikewave.base.errors import InputError
from strikewave.base.shock_quantities import KILOHERTZ, SHARE
from strikewave.hopkinson import Bar, Carrier, GaugeTrace, Pulses, carried, find_pulses
from strikewave.hopkinson.alignment import highest_frequency
from strikewave.hopkinson.bar_end import EndMotion, SensorAgreement, compare_sensor, elastic_disk, free_end, rigid_disk
from strikewave.hopkinson.pulses import noise_ceiling
from strikewave.signal.filters import Filter
from strikewave.waves import Layer
from strikewave.waves.dispersion import Theory
from strikewave.waves.limits import RISE_OF_BANDWIDTH, WARNED

Array = NDArray[np.float64]

PER_PERIOD = 200
"""Samples of the common clock in a period of the bandwidth: central differences then err by 2e-4 there."""
MOST_SAMPLES = 400_000
"""Most samples of the common clock, 3 MB a history; a longer record gets fewer samples a period."""
OF_SAMPLING = 0.1
"""Largest chosen bandwidth over the sampling rate: cubics between ten samples a period err by 2e-4."""
HIGHEST = 0.25
"""Largest stated bandwidth over the sampling rate: half of what the samples hold, for no filter cuts off at once."""
ROUNDING = 1e-9
"""Share of the largest sample below which a reading is nothing: what a filter leaves of zero."""
SETTLING = 2.0
"""Periods of the bandwidth before and after a stretch that its filter also takes: the memory of a low-pass of 4 poles
has sunk to a hundredth after two."""
SPEED_CHANGE = 1e-3
"""Relative change of the bar speed for its power in the reference: the difference is exact to 1e-3, far above
rounding."""


class Standing(NamedTuple):
    """A rigid mass on the end of the bar (kg; 0 for none), or an elastic disk with that mass on it."""

    mass: float = 0.0
    disk: Layer | None = None

    def motion(self, strain: Array, step: float, bar: Bar) -> EndMotion:
        """Return its motion under an incident strain at the end of a bar."""
        if self.disk is not None:
            try:
                return elastic_disk(strain, step, bar, self.disk, self.mass)
            except ValueError as error:
                transit, hint = f"a transit of {self.disk.transit:.3g} s", f"{error}; or take it as rigid"
                raise InputError("disk", transit, "a disk whose waves can be followed", hint) from None
        return rigid_disk(strain, step, bar, self.mass) if self.mass > 0.0 else free_end(strain, step, bar)


@declare.dataclass
class Bandwidth:
    """The bandwidth of a comparison, and what set it."""

    value: float = declare.number(KILOHERTZ, "low-pass of reference and reading", key="bandwidth")
    reason: str = declare.word("what set it: stated, noise, sampling, or one-dimensional theory", key="bandwidth_by")
    noise: float = declare.number(
        Quantity("Hz", "kHz", "frequency at which the pulse sinks in noise"),
        "frequency at which the incident pulse sinks in the noise of its gauge",
        key="noise_limit",
    )


class Bench(NamedTuple):
    """The bar, mass and disk on its end, and the theory by which waves are carried."""

    bar: Bar
    standing: Standing
    theory: Theory


@declare.dataclass
class SensorComparison:
    """A sensor beside the reference at the end of a bar; everything low-passed at the bandwidth."""

    time: Array = field(repr=False)
    """Time after the begin of the incident wave at the end, s, shape (N,)."""
    motion: EndMotion = field(repr=False)
    """The reference: velocity and acceleration of the sensor, force on the end."""
    reading: Array = field(repr=False)
    """Reading of the sensor, in its unit, without baseline and delay."""
    both_waves: Array = field(repr=False)
    """Velocity of the end by incident and reflected wave, m/s; NaN once the far end's echo comes to the gauge."""
    joint: Array = field(repr=False)
    """The same by the incident wave and the model, m/s."""
    agreement: SensorAgreement
    pulses: Pulses = field(repr=False)
    bandwidth: Bandwidth
    scatter: float
    """Relative standard error of the sensitivity by the residual."""
    bias: float
    """Share by which noise of the gauge, taken as white, lowers the slope."""
    reading_noise: float
    """Standard deviation at the bandwidth, unit of the reading."""
    speed_power: float
    """Power of the bar speed with which the reference grows at a constant density."""
    reference_noise: float = declare.number(
        Quantity("m/s^2", "g", "noise of the reference"), "standard deviation of the reference at the bandwidth"
    )

    @declare.computed(
        declare.number(
            Quantity("s", "us", "delay of the reading", 3, 0, signed=True), "how late the reading is", headline="delay"
        )
    )
    def delay(self) -> float:
        """Delay of the reading."""
        return self.agreement.delay

    @property
    def sign(self) -> float:
        """1, or -1 for a sensor that is mounted the other way."""
        return math.copysign(1.0, self.agreement.sensitivity)

    @declare.computed(
        declare.number(Quantity(NO_UNIT, NO_UNIT, decimals=5, digits=0), "of reading and reference at the best delay")
    )
    def correlation(self) -> float:
        """Correlation of reading and reference at the best delay."""
        return self.sign * math.sqrt(max(1.0 - self.agreement.residual**2, 0.0))

    @declare.computed(declare.number(SHARE, "root mean square that does not follow", label="residual over reading"))
    def residual(self) -> float:
        """Share of the reading that does not follow the reference."""
        return self.agreement.residual

    @property
    def peaks(self) -> tuple[float, float]:
        """Largest forward acceleration of the reference (m/s^2), and of the reading in its unit and with its sign."""
        return float(self.motion.acceleration.max()), self.sign * float((self.sign * self.reading).max())

    @property
    def integrated(self) -> Array:
        """The reading integrated from the begin of the window, in its unit times s."""
        step = float(self.time[1] - self.time[0])
        return np.asarray(scipy.integrate.cumulative_trapezoid(self.reading, dx=step, initial=0.0))

    @property
    def velocities(self) -> tuple[float, float]:
        """Largest velocity of the reference (m/s), and of the integrated reading in its unit times s."""
        return float(self.motion.velocity.max()), self.sign * float((self.sign * self.integrated).max())

    @declare.computed(
        declare.number(
            SHARE,
            "velocity of both waves less the model's, over that, root mean square; null if an echo spoils it",
            label="velocity by both waves, off the model",
        )
    )
    def reflected_misfit(self) -> float:
        """Root mean square of the velocity of both waves less the model's, over that; NaN if an echo spoils it."""
        known = np.isfinite(self.both_waves)
        apart, moved = (np.linalg.norm(h[known]) for h in (self.both_waves - self.joint, self.joint))
        return float(apart / moved) if moved > 0.0 else math.nan


def compare_at_end(
    strain: GaugeTrace, reading: GaugeTrace, bench: Bench, wanted: float | None = None
) -> SensorComparison:
    """Set the reading of a sensor on the end of a bar beside the acceleration by the strain gauge.

    Parameters
    ----------
    strain : GaugeTrace
        Strain at the gauge, with the incident and the reflected pulse.
    reading : GaugeTrace
        Reading of the sensor, on a clock with the same zero.
    bench : Bench
        Bar, mass and disk on its end, theory of dispersion.
    wanted : float, optional
        Bandwidth, Hz; chosen where it is left out.
    """
    endless = replace(bench.bar, length=math.inf)  # the far end's echo meets the reflected wave alone, see unspoilt
    pulses = find_pulses(strain, strain, (endless, endless))
    bandwidth = _bandwidth(pulses, reading.step, bench, wanted)
    low_pass = Filter(bandwidth.value)
    begin = pulses.starts[0] + bench.bar.delay
    quiet = min(SETTLING / bandwidth.value, max(begin - reading.start, 0.0))
    finest = min(1.0 / (PER_PERIOD * bandwidth.value), pulses.step, reading.step)
    step = max(finest, (pulses.duration + quiet) / MOST_SAMPLES)
    # from the begin of the window, with a quiet stretch before it
    time = np.asarray(step * np.arange(-int(quiet / step), int(pulses.duration / step * (1.0 + 1e-12)) + 1))
    step = float(time[1] - time[0])
    incident, reflected = (low_pass.apply(wave, step) for wave in _waves_at_end(pulses, bench, time))
    difference = incident - reflected
    motion = bench.standing.motion(incident, step, bench.bar)
    read, noise = _read(reading, begin, time, low_pass)
    agreement = compare_sensor(read, motion.acceleration, step)
    gauge_noise = pulses.traces[0].noise
    steep = 2.0 * bench.bar.speed * gauge_noise * 2.0 * math.pi * bandwidth.value
    reference_noise = steep * math.sqrt(2.0 * pulses.step * bandwidth.value / 3.0)
    since = time - (pulses.onset - pulses.starts[0])
    prompt = _spline(time, read, time + agreement.delay)
    # a period before the far end's echo comes to the gauge; never where that is too soon
    echo = 2.0 * (bench.bar.length - bench.bar.gauge_distance) / bench.bar.speed - 1.0 / bandwidth.value
    unspoilt = since < (echo if echo > pulses.width else -math.inf)
    # d ln a/d ln c of the reference at a constant density, by least squares over the pulse
    faster = replace(bench.bar, modulus=bench.bar.modulus * (1.0 + SPEED_CHANGE) ** 2)
    moved, a = bench.standing.motion(incident, step, faster).acceleration, motion.acceleration
    return SensorComparison(
        time=since,
        motion=motion,
        reading=prompt,
        both_waves=np.where(unspoilt, bench.bar.speed * difference, math.nan),
        joint=2.0 * bench.bar.speed * incident - motion.force / bench.bar.impedance,
        agreement=agreement,
        pulses=pulses,
        bandwidth=bandwidth,
        scatter=slope_error(prompt, motion.acceleration),
        bias=reference_noise**2 / float(np.mean(motion.acceleration**2)),
        reference_noise=reference_noise,
        reading_noise=noise,
        speed_power=float((moved - a) @ a / (a @ a)) / SPEED_CHANGE,
    )


def theory_bandwidth(rise: float, layers: tuple[Layer, ...]) -> float:
    """Return the largest bandwidth B at which one-dimensional theory needs no warning, Hz.

    sqrt(rise^2 + (0.35/B)^2) = 5 d/c in the layer with the largest d/c; infinite where the rise alone is as long.
    """
    needed = WARNED * max(layer.diameter / layer.bar_speed for layer in layers)
    return RISE_OF_BANDWIDTH / math.sqrt(needed**2 - rise**2) if rise < needed else math.inf


def slope_error(y: Array, x: Array) -> float:
    """Return the standard error of the slope of y over x by least squares, over the slope, for noise of any colour.

        var(slope) = n/(n - 2) sum |X|^2 |R|^2 / (sum |X|^2)^2,    n = (sum |X|^2)^2 / sum |X|^4

    with X the spectrum of x over both signs of frequency, and R that of the residual under a Hann window, which keeps
    strong noise outside the band of x from leaking into it. One slope and one delay are fitted to the n numbers in x.
    """
    slope = float(x @ y / (x @ x))
    window = np.hanning(x.size)
    residual = (y - slope * x) * window / math.sqrt(float(np.mean(window**2)))
    power, left = (np.abs(np.fft.fft(h)) ** 2 for h in (x, residual))
    numbers = max(float(power.sum() ** 2 / (power**2).sum()), 3.0)
    return math.sqrt(float(power @ left) * numbers / (numbers - 2.0)) / float(power.sum()) / abs(slope)


def bar_layer(bar: Bar, yield_strength: float | None = None) -> Layer:
    """Return a bar as a layer; from its gauge on where its length is not known."""
    length = bar.length if math.isfinite(bar.length) else bar.gauge_distance
    return Layer("the bar", bar.density, bar.modulus, bar.area, length, bar.diameter, yield_strength)


def _bandwidth(pulses: Pulses, step: float, bench: Bench, wanted: float | None) -> Bandwidth:
    """Return the stated bandwidth, or the lowest of those by noise, sampling and theory."""
    sampling = 1.0 / max(step, pulses.step)
    noise = highest_frequency(pulses.incident, pulses.step, pulses.traces[0].noise, pulses.width)
    lowest, highest = 1.0 / pulses.duration, HIGHEST * sampling
    if wanted is not None:
        if not lowest <= wanted <= highest:
            allowed = f"from {lowest:.4g} Hz, a period in the window, to {highest:.4g} Hz, a quarter of the sampling"
            raise InputError("solver.bandwidth", f"{wanted:g} Hz", allowed)
        return Bandwidth(wanted, "stated", noise)
    layers = (bar_layer(bench.bar), *([bench.standing.disk] if bench.standing.disk else []))
    choices = {
        "one-dimensional theory": theory_bandwidth(pulses.rise, layers),
        "noise": noise,
        "sampling": OF_SAMPLING * sampling,
    }
    reason = min(choices, key=lambda name: choices[name])
    if choices[reason] < lowest:
        allowed = f"at least {lowest:.4g} Hz, a period in the window"
        raise InputError("solver.bandwidth", f"{choices[reason]:.4g} Hz by {reason}", allowed, "state one if you must")
    return Bandwidth(choices[reason], reason, noise)


def _waves_at_end(pulses: Pulses, bench: Bench, time: Array) -> tuple[Array, Array]:
    """Return incident and reflected strain at the end of the bar, zero before the window."""
    bar = bench.bar
    band = highest_frequency(pulses.incident, pulses.step, pulses.traces[0].noise, pulses.width)
    carrier = Carrier(bar.rod, bench.theory, band)
    came = carried(pulses.incident, pulses.step, bar.gauge_distance, carrier)
    apart = pulses.starts[0] - pulses.starts[1] + 2.0 * bar.delay
    back = carried(pulses.reflected, pulses.step, -bar.gauge_distance, carrier, apart)
    own = np.asarray(pulses.step * np.arange(came.size), dtype=np.float64)
    return np.where(time < 0.0, 0.0, _spline(own, came, time)), np.where(time < 0.0, 0.0, _spline(own, back, time))


def _read(reading: GaugeTrace, begin: float, time: Array, low_pass: Filter) -> tuple[Array, float]:
    """Return the filtered reading on the common clock without its baseline, and its noise at the bandwidth."""
    own = reading.time - begin
    if own[0] > time[0] + 1e-9 * reading.step or own[-1] < time[-1] - 1e-9 * reading.step:
        got = f"a record from {reading.time[0] * 1e6:.6g} to {reading.time[-1] * 1e6:.6g} us"
        allowed = f"one that holds {begin * 1e6:.6g} to {(begin + time[-1]) * 1e6:.6g} us, when the wave is at the end"
        raise InputError("accelerometer.file", got, allowed, "are both records on one clock?")
    before = reading.strain[own <= max(own[0], 0.0)]
    zero, noise = float(before.mean()), float(before.std())
    step, reach = float(time[1] - time[0]), SETTLING / low_pass.cutoff
    # the filter is given some of the record before and after, so that its settling lies outside
    lead, tail = (int(max(min(reach, room), 0.0) / step) for room in (time[0] - own[0], own[-1] - time[-1]))
    clock = np.asarray(time[0] + step * np.arange(-lead, time.size + tail), dtype=np.float64)
    near = (own >= clock[0] - 4.0 * reading.step) & (own <= clock[-1] + 4.0 * reading.step)
    values = low_pass.apply(_spline(own[near], reading.strain[near] - zero, clock), step)[lead : lead + time.size]
    # white noise: its power falls with the bandwidth
    noise *= math.sqrt(2.0 * reading.step * low_pass.cutoff)
    numbers = int(2.0 * low_pass.cutoff * (time[-1] - time[0]))
    if np.abs(values).max() <= max(noise_ceiling(noise, numbers), ROUNDING * np.abs(reading.strain).max()):
        hint = "is it the right channel, and the sensor connected?"
        raise InputError("accelerometer.file", "noise alone", "a pulse when the wave is at the end", hint)
    return values, noise


def _spline(time: Array, values: Array, at: Array) -> Array:
    """Return a history between its samples by cubics, its ends kept beyond them."""
    return np.asarray(scipy.interpolate.CubicSpline(time, values)(np.clip(at, time[0], time[-1])))
