"""Base motions that have a shock response spectrum: sums of damped sines or of wavelets, and a half-sine.

A damped sine of the frequency f responds at natural frequencies about f, so that the spectrum at each frequency is
brought to its target by the amplitude of its own component, over and over. What the sum leaves as velocity and
displacement is taken off by two compensating pulses: the motion ends at rest where it began, as a shaker must.

Source: D. O. Smallwood, A. R. Nord 1974 (damped sines, compensation); the wavelets are those of T. Irvine's codes.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, NO_UNIT, Quantity
from strikewave.base.shock_quantities import FREQUENCY, LENGTH, VELOCITY
from strikewave.signal.motion import motion
from strikewave.signal.oscillators import SMOOTH
from strikewave.signal.srs import Scope, octaves, srs

Array = NDArray[np.float64]

PEAK, MILLISECONDS, DECIBELS = Quantity("m/s^2", "g"), Quantity("s", "ms"), Quantity("dB", "dB")
DAMPED_SINES, WAVELETS = "damped-sines", "wavelets"
BASES = (DAMPED_SINES, WAVELETS)  # kinds of components that add up to a motion
# Periods of the lowest damped sine in a motion: with 5 % damping it has then come down to 1 %, and is faded out
PERIODS = 15.0
# Share of a motion, at its end, over which damped sines are faded out by half a cosine; wavelets end by themselves
FADED = 0.2
# Half-sines of a wavelet, an odd number: it is about as narrow in frequency as an oscillator with Q = 10
HALF_SINES = 9
# Frequency of the compensating pulses over the lowest one, and their damping: those that Sandia's SDynPy takes
COMPENSATION_SHARE, COMPENSATION_DAMPING = 1.0 / 3.0, 0.95
DECAYED = 18.0  # time constants after which a damped sine is left out: it has come down to 1.5e-8
# Largest distance to the target, dB, at which the iteration ends: a sixth of the tightest tolerance in use
CLOSE = 0.25
MOST_STEPS = 40  # steps of the iteration at most; those that come close do it in 5 to 25 (measured on five spectra)
# Power of the ratio of target and spectrum by which an amplitude is corrected: neighbours correct it too
CORRECTED = 0.7
ROUNDING = 1e-9  # share of the largest value below which what is left at the end is rounding: compensation leaves 1e-15
# Largest factor of a correction: a component that its neighbours drown is not driven to zero at once
LARGEST_CORRECTION = 4.0


@declare.dataclass
class Component:
    """A part of a motion."""

    frequency: float = declare.number(FREQUENCY, "frequency f", column=KEY)
    amplitude: float = declare.number(PEAK, "amplitude A", column=MAIN)
    delay: float = declare.number(MILLISECONDS, "delay t0", column=MAIN)
    damping: float = declare.number(
        Quantity(NO_UNIT, NO_UNIT, digits=3),
        "damping ratio zeta of a damped sine A exp(-zeta w (t - t0)) sin(w (t - t0)), w = 2 pi f; null of a wavelet",
        column=MAIN,
    )
    half_sines: int = declare.count(
        "half sines N of a wavelet A sin(w (t - t0)/N) sin(w (t - t0)), which lasts N/(2 f); 0 of a damped sine",
        default=0,
    )
    role: str = declare.word(
        "spectrum, or compensation: it brings the motion to rest", label="for", default="spectrum", column=MAIN, order=1
    )
    half_sine_count = declare.phrase("half-sines", column=MAIN)(lambda one: str(one.half_sines or "") or None)

    def at(self, time: ArrayLike) -> Array:
        """Return it at times, s.

        Examples
        --------
        >>> Component(10.0, 2.0, 0.0, 0.0).at([-0.025, 0.025]).round(9).tolist()
        [0.0, 2.0]
        """
        since = np.asarray(time, dtype=np.float64) - self.delay
        phase = 2.0 * math.pi * self.frequency * np.maximum(since, 0.0)
        if self.half_sines:
            inside = phase <= math.pi * self.half_sines
            return np.asarray(self.amplitude * np.where(inside, np.sin(phase / self.half_sines) * np.sin(phase), 0.0))
        return np.asarray(self.amplitude * np.exp(-self.damping * phase) * np.sin(phase))

    @property
    def end(self) -> float:
        """Time at which the component has ended, s."""
        if self.half_sines:
            return self.delay + self.half_sines / (2.0 * self.frequency)
        return self.delay + DECAYED / max(2.0 * math.pi * self.frequency * self.damping, 1e-12)


@declare.dataclass
class MotionPeaks:
    """The largest values of a motion to either side: what a shaker must reach."""

    acceleration: float = declare.number(PEAK, "largest acceleration", headline="largest acceleration")
    velocity: float = declare.number(VELOCITY, "largest velocity", headline="largest velocity")
    displacement: float = declare.number(LENGTH, "largest displacement", headline="largest displacement")


@declare.dataclass
class MotionEnd:
    """The end of a motion."""

    velocity: float = declare.number(VELOCITY, "velocity at the end")
    displacement: float = declare.number(LENGTH, "displacement at the end")


@declare.dataclass
class SynthesizedMotion:
    """A base motion with a spectrum.

    Attributes
    ----------
    acceleration, velocity, displacement : ndarray
        At the samples, from rest; m/s^2, m/s, m.
    step : float
        Time between samples, s.
    components : tuple of Component
        Components that add up to it, without the compensating pulses.
    compensation : tuple of Component
        Those; faded out at the end as the others are.
    frequency, spectrum : ndarray
        Frequencies of the components, and the spectrum there.
    """

    acceleration: Array
    velocity: Array
    displacement: Array
    step: float
    components: tuple[Component, ...]
    compensation: tuple[Component, ...]
    frequency: Array
    spectrum: Array

    @declare.computed(declare.part(MotionPeaks, "largest values", headline="first"))
    def peak(self) -> MotionPeaks:
        """Largest acceleration, velocity and displacement to either side."""
        histories = (self.acceleration, self.velocity, self.displacement)
        return MotionPeaks(*(float(np.max(np.abs(component))) for component in histories))

    end = declare.computed(declare.part(MotionEnd, "values at the end"))(
        lambda motion: MotionEnd(float(motion.velocity[-1]), float(motion.displacement[-1]))
    )

    @declare.computed(declare.number(VELOCITY, "what is left", headline="velocity at the end", in_document=False))
    def left(self) -> float:
        """Velocity at the end without what rounding makes of nothing."""
        return self.end.velocity if abs(self.end.velocity) > ROUNDING * self.peak.velocity else 0.0

    duration = declare.computed(declare.number(MILLISECONDS, "length of the motion", headline="duration"))(
        lambda motion: (motion.acceleration.size - 1) * motion.step
    )
    rate = declare.computed(declare.number(FREQUENCY, "samples a second"))(lambda motion: 1.0 / motion.step)
    samples = declare.computed(declare.count("how many samples"))(lambda motion: motion.acceleration.size)
    distance: float = declare.number(DECIBELS, "largest distance of its spectrum to the one asked for")
    steps: int = declare.count("steps of the iteration")


def synthesized(
    frequencies: ArrayLike,
    target: ArrayLike,
    q: float = 10.0,
    basis: str = DAMPED_SINES,
    side: str = "maximax",
    rate: float | None = None,
) -> SynthesizedMotion:
    """Return a base motion whose spectrum of absolute acceleration comes to a target.

    The signs of the components alternate, and their damping is that of the spectrum, 1/(2 Q). The spectrum at each
    frequency corrects the amplitude of its component by a power of target over spectrum; the step that came nearest
    counts.

    Parameters
    ----------
    frequencies, target : array_like
        Natural frequencies, Hz, upwards, and the spectrum asked for there, m/s^2.
    q : float, optional
        Quality factor.
    basis : str, optional
        One of `BASES`.
    side : str, optional
        Side of the spectrum: ``maximax``, ``positive`` or ``negative``.
    rate : float, optional
        Samples a second; `strikewave.signal.oscillators.SMOOTH` a period of the highest frequency by default.

    Raises
    ------
    ValueError
        If a value makes no sense.

    Examples
    --------
    >>> found = synthesized([100.0, 126.0, 159.0, 200.0], [10.0, 13.0, 16.0, 20.0])
    >>> found.distance < 0.25, bool(abs(found.velocity[-1]) < 1e-9 * abs(found.velocity).max())
    (True, True)
    """
    f, wanted = (np.asarray(values, dtype=np.float64) for values in (frequencies, target))
    rate = SMOOTH * float(f[-1]) if rate is None and f.size else rate
    _check(f, wanted, q, basis, rate)
    assert rate is not None
    periods = PERIODS if basis == DAMPED_SINES else 0.5 * HALF_SINES
    time = np.arange(math.ceil(periods / f[0] * rate) + 1) / rate
    shapes = [_sampled(_unit(float(component), k, q, basis), time) for k, component in enumerate(f)]
    pulses = _compensating(float(f[0]), time)
    amplitudes, best, steps = wanted / math.sqrt(q), None, 0
    for steps in range(1, MOST_STEPS + 1):
        values, compensation = _sum(amplitudes, shapes, pulses, time)
        spectrum = srs(values, 1.0 / rate, f, q, scope=Scope(upsample=False)).side(side)
        ratio = spectrum / wanted
        distance = float(np.max(np.abs(20.0 * np.log10(np.maximum(ratio, 1e-12)))))
        if best is None or distance < best[0]:
            best = distance, amplitudes.copy(), values, compensation, spectrum
        if distance < CLOSE:
            break
        factors = np.clip(ratio**-CORRECTED, 1.0 / LARGEST_CORRECTION, LARGEST_CORRECTION)
        amplitudes = amplitudes * (np.median(factors) if steps == 1 else factors)
    assert best is not None
    distance, amplitudes, values, (first, second), spectrum = best
    moved = motion(values, 1.0 / rate)
    parts = tuple(
        _unit(float(component), k, q, basis, float(a))
        for k, (component, a) in enumerate(zip(f, amplitudes, strict=True))
    )
    rest = tuple(
        replace(pulse, amplitude=amplitude, role="compensation")
        for (pulse, _), amplitude in zip(pulses, (first, second), strict=True)
    )
    return SynthesizedMotion(
        values, moved.velocity, moved.displacement, 1.0 / rate, parts, rest, f, spectrum, distance, steps
    )


def _check(f: Array, wanted: Array, q: float, basis: str, rate: float | None) -> None:
    """Refuse what makes no sense."""
    if f.ndim != 1 or f.size < 2 or f.shape != wanted.shape or not np.all(np.diff(f) > 0.0) or not f[0] > 0.0:
        raise ValueError("a synthesis needs two natural frequencies or more, upwards and above zero, with a level each")
    if not np.all(np.isfinite(wanted) & (wanted > 0.0)):
        raise ValueError("the levels of a spectrum must be above zero and finite")
    if not 0.5 < q < math.inf:
        raise ValueError(f"the quality factor must be above 0.5 and finite, got {q!r}")
    if basis not in BASES:
        raise ValueError(f"the basis must be {' or '.join(BASES)}, got {basis!r}")
    if rate is None or not 2.5 * f[-1] <= rate < math.inf:
        raise ValueError(f"the sampling rate must be at least 2.5 times the highest frequency, got {rate!r}")


def _unit(frequency: float, place: int, q: float, basis: str, amplitude: float = 1.0) -> Component:
    """Return the component of a frequency; signs alternate."""
    signed = amplitude if place % 2 == 0 else -amplitude
    if basis == WAVELETS:
        return Component(frequency, signed, 0.0, math.nan, HALF_SINES)
    return Component(frequency, signed, 0.0, 0.5 / q)


def _faded(values: Array, count: int) -> Array:
    """Return the first samples of a history of ``count`` faded out as the whole is."""
    first = round((1.0 - FADED) * count)
    late = np.arange(first, values.size)
    values[first:] *= 0.5 * (1.0 + np.cos(math.pi * (late - first) / max(count - 1 - first, 1)))
    return values


def _sampled(component: Component, time: Array) -> Array:
    """Return the samples of a component up to its end."""
    count = min(math.ceil(component.end / time[1]) + 1, time.size)
    values = component.at(time[:count])
    return values if component.half_sines else _faded(values, time.size)


def _compensating(lowest: float, time: Array) -> tuple[tuple[Component, Array], tuple[Component, Array]]:
    """Return two compensating pulses with their samples, the second half a period later."""
    frequency = COMPENSATION_SHARE * lowest
    component = Component(frequency, 1.0, 0.0, COMPENSATION_DAMPING)
    two = replace(component, delay=0.5 / frequency)
    return (component, _faded(component.at(time), time.size)), (two, _faded(two.at(time), time.size))


def _sum(
    amplitudes: Array, shapes: list[Array], pulses: tuple[tuple[Component, Array], tuple[Component, Array]], time: Array
) -> tuple[Array, tuple[float, float]]:
    """Return a sum that ends at rest where it began, and the amplitudes of its compensating pulses.

    Straight lines join the samples, of which first and last are zero: velocity and displacement at the end are sums
    over the samples, and vanish to rounding.
    """
    values = np.zeros(time.size)
    for amplitude, shape in zip(amplitudes, shapes, strict=True):
        values[: shape.size] += amplitude * shape
    left = time[-1] - time
    matrix = np.array([[np.sum(pulse), np.sum(pulse * left)] for _, pulse in pulses]).T
    first, second = np.linalg.solve(matrix, -np.array([np.sum(values), np.sum(values * left)]))
    return values + first * pulses[0][1] + second * pulses[1][1], (float(first), float(second))


@declare.dataclass
class HalfSine:
    """A half-sine for limits of a spectrum."""

    peak: float = declare.number(PEAK, "its peak")
    duration: float = declare.number(MILLISECONDS, "its duration")
    outside: float = declare.number(DECIBELS, "how far its spectrum lies outside of limits at most; below 0 inside")


def matching_half_sine(
    frequencies: ArrayLike, low: ArrayLike, high: ArrayLike, q: float = 10.0, side: str = "maximax"
) -> HalfSine:
    """Return the half-sine whose spectrum lies best between two limits.

    The spectrum goes with the peak, and over frequency times duration it has one shape: of each duration the peak is
    the one that lies in the middle between both ends that are worst off, in dB.

    Parameters
    ----------
    frequencies, low, high : array_like
        Natural frequencies, Hz, and limits there, m/s^2.
    q, side : optional
        Quality factor and side of the spectrum.

    Examples
    --------
    >>> pulse = 500.0 * np.sin(np.pi * np.linspace(0.0, 1.0, 201))
    >>> f = octaves(20.0, 2000.0, 3.0)
    >>> wanted = srs(pulse, 1e-3 / 200, f).maximax
    >>> best = matching_half_sine(f, 0.9 * wanted, wanted / 0.9)
    >>> round(best.peak), round(best.duration * 1e3, 2)
    (500, 1.0)
    """
    f, least, most = (np.asarray(values, dtype=np.float64) for values in (frequencies, low, high))
    known = np.isfinite(least) & np.isfinite(most)
    f, least, most = f[known], 20.0 * np.log10(least[known]), 20.0 * np.log10(most[known])
    if f.size < 2:
        raise ValueError("a half-sine needs limits at two natural frequencies or more")
    # the response over f D: below 0.01 it is a velocity step, above 30 it follows the pulse
    shares = octaves(0.005, 60.0, 24.0)
    shape = np.sin(math.pi * np.arange(2001) / 2000.0)
    response = 20.0 * np.log10(srs(shape, 1.0 / 2000.0, shares, q).side(side))

    def lies(duration: float) -> tuple[float, float]:
        """Return how far the best peak of a duration leaves it outside, dB, and that peak, dB."""
        level = np.interp(np.log(f * duration), np.log(shares), response)
        below, above = float(np.max(least - level)), float(np.min(most - level))
        return 0.5 * (below - above), 0.5 * (below + above)

    tried = np.geomspace(0.01 / f[-1], 30.0 / f[0], 400)
    for _ in range(4):
        best = int(np.argmin([lies(float(duration))[0] for duration in tried]))
        tried = np.geomspace(tried[max(best - 1, 0)], tried[min(best + 1, tried.size - 1)], 21)
    duration = float(tried[int(np.argmin([lies(float(limit))[0] for limit in tried]))])
    outside, peak = lies(duration)
    return HalfSine(10.0 ** (peak / 20.0), duration, outside)
