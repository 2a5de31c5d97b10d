"""An accelerometer at the free end of a bar, compared with the acceleration that the strain gauge gives.

The incident wave e_i, carried to the end, gives there the force F_i = E A e_i. What stands on the end decides how
it moves:

free end        v = 2 c e_i,           a = 2 c d(e_i)/dt
rigid disk m    m dv/dt = 2 F_i - Z v,  v = 2 F_i/(Z + s m) in Laplace's s: a low-pass with the time constant m/Z
elastic disk    waves in disk and bar, by the delay lines of `strikewave.waves`

Symbols: c bar speed (m/s), Z impedance of the bar (N s/m), m mass of disk and sensor (kg).

Source: W. A. Togami, W. E. Baker, M. J. Forrestal, A Split Hopkinson Bar Technique to Evaluate the Performance of
Accelerometers, Journal of Applied Mechanics 63 (1996) 353-356, not opened; the equations follow from
the one-dimensional wave relations.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from strikewave.hopkinson.bars import Bar
from strikewave.waves import BONDED, End, Layer, Sampled, Stack, Tap, WantedError, run_bar

Array = NDArray[np.float64]

LEAST_STEPS = 20.0
"""Steps of a wave through an elastic disk, for a front sharp to a twentieth of its transit; a whole number, so that the
disk keeps its stated thickness."""
LONGER = 1.01
"""Transit of the bar before the disk over the record, so that nothing comes back within it by rounding."""
SERIES = 1e-4
"""Step over time constant below which the slope term is taken from its series, whose next term is below 1e-13: the
closed form loses as many digits as the ratio is small."""
ROUNDING = 1e-9
"""Share by which a count of steps may exceed a whole number by rounding."""


class EndMotion(NamedTuple):
    """Velocity (m/s) and acceleration (m/s^2) of the sensor, and the force between bar and disk (N), over time."""

    velocity: Array
    acceleration: Array
    force: Array


def free_end(strain: ArrayLike, step: float, bar: Bar) -> EndMotion:
    """Return the motion of the free end of a bar under an incident strain: v = 2 c e, a by central differences.

    Examples
    --------
    >>> bar = Bar(7800.0, 210e9, 0.02, 1.0)
    >>> motion = free_end(1e-6 * np.arange(5.0), 1e-6, bar)
    >>> motion.acceleration.round(1).tolist() == [round(2.0 * bar.speed, 1)] * 5
    True
    """
    e = _history(strain, step)
    velocity = 2.0 * bar.speed * e
    return EndMotion(velocity, np.gradient(velocity, step), np.zeros_like(e))


def rigid_disk(strain: ArrayLike, step: float, bar: Bar, mass: float) -> EndMotion:
    """Return the motion of a rigid disk on the end of a bar: m dv/dt = 2 F - Z v, from rest.

    Exact for a strain that is straight between its samples.

    Examples
    --------
    >>> bar = Bar(7800.0, 210e9, 0.02, 1.0)
    >>> tau = 0.1 / bar.impedance
    >>> motion = rigid_disk(np.full(2001, 1e-4), tau / 100, bar, 0.1)
    >>> share = motion.velocity[100] / (2.0 * bar.speed * 1e-4)
    >>> round(float(share), 12) == round(1.0 - math.exp(-1.0), 12)
    True
    """
    e = _history(strain, step)
    if not 0.0 < mass < math.inf:
        raise ValueError(f"the mass of the disk must be above zero and finite, got {mass!r}")
    final = 2.0 * bar.speed * e
    rate = step * bar.impedance / mass
    left = math.exp(-rate)
    gone = -math.expm1(-rate)
    slope = 1.0 - gone / rate if rate > SERIES else rate * (0.5 - rate * (1.0 / 6.0 - rate / 24.0))
    # v(n+1) = left v(n) + gone u(n) + slope (u(n+1) - u(n)), with u the velocity of a free end
    state = np.array([(gone - slope) * final[0]])
    rest, _ = scipy.signal.lfilter([slope, gone - slope], [1.0, -left], final[1:], zi=state)
    velocity = np.concatenate([[0.0], rest])
    acceleration = (final - velocity) * bar.impedance / mass
    return EndMotion(velocity, acceleration, mass * acceleration)


def elastic_disk(strain: ArrayLike, step: float, bar: Bar, disk: Layer, mass: float = 0.0) -> EndMotion:
    """Return the motion of the outer face of an elastic disk on the end of a bar, with a sensor of a mass (kg) on it.

    The disk is one layer of a stack behind a stretch of bar so long that nothing comes back within the record. For a
    rise below a few disk thicknesses the disk is no bar: this is one-dimensional theory. The incident strain at the end
    of the bar has the shape (N,), and is zero at its begin.
    """
    e = _history(strain, step)
    transit = LONGER * step * e.size
    long = Layer("bar", bar.density, bar.modulus, bar.area, transit * bar.speed)
    end = End("mass", mass) if mass > 0.0 else End("free")
    stack = Stack((long, disk), (BONDED,), end)
    time = step * np.arange(e.size)
    load = Sampled(np.asarray(time), bar.stiffness * e)
    # whole steps in the disk, so that it keeps its stated thickness
    fine = disk.transit / math.ceil(max(LEAST_STEPS, disk.transit / step) * (1.0 - ROUNDING))
    run = run_bar(stack, load, [Tap(1, 0.0), Tap(1, 1.0)], 1.0 * transit + time[-1], WantedError(step=fine))
    at = time + run.grid.step * round(transit / run.grid.step)
    return EndMotion(
        *(np.interp(at, run.time, values) for values in (run.velocity[:, 1], run.acceleration[:, 1], run.force[:, 0]))
    )


class SensorAgreement(NamedTuple):
    """A sensor compared with its reference.

    ``sensitivity`` is reading over reference by least squares at the best delay, ``peak_ratio`` that of their largest
    values along the blow, ``delay`` that of the reading (s), ``residual`` the root mean square of the rest over that of
    the reading.
    """

    sensitivity: float
    peak_ratio: float
    delay: float
    residual: float


def compare_sensor(reading: ArrayLike, reference: ArrayLike, step: float) -> SensorAgreement:
    """Compare the reading of a sensor with the reference acceleration on the same clock.

    The delay is that of the largest correlation, between samples by a parabola.

    Raises
    ------
    ValueError
        If the histories differ in length, or one is all zero or not finite.

    Examples
    --------
    >>> t = np.linspace(0.0, 1.0, 1001)
    >>> pulse = np.exp(-(((t - 0.4) / 0.05) ** 2))
    >>> late = 2.0 * np.exp(-(((t - 0.41) / 0.05) ** 2))
    >>> comparison = compare_sensor(late, pulse, 1e-3)
    >>> round(comparison.sensitivity, 6), round(comparison.delay, 6), comparison.residual < 1e-6
    (2.0, 0.01, True)
    """
    y, x = _history(reading, step), _history(reference, step)
    if y.size != x.size or not (np.any(y) and np.any(x)):
        raise ValueError("reading and reference need the same number of samples, and not all zero")
    from scipy.signal import correlate

    both = correlate(y, x, "full")
    k = int(np.argmax(np.abs(both)))
    shift = 0.0
    if 0 < k < both.size - 1:
        before, at, after = both[k - 1 : k + 2]
        bend = before - 2.0 * at + after
        shift = 0.5 * float((before - after) / bend) if bend else 0.0
    delay = (k - (x.size - 1) + shift) * step
    moved = _moved(x, delay / step)
    ratio = float(y @ moved / (moved @ moved))
    left = y - ratio * moved
    # of a blow that rings, the peaks along the blow are compared, not the largest of either sign
    way = math.copysign(1.0, x[np.argmax(np.abs(x))])
    same = math.copysign(way, way * ratio)
    peaks = float((same * y).max()) * same / (float((way * x).max()) * way)
    return SensorAgreement(ratio, peaks, delay, float(np.sqrt((left @ left) / (y @ y))))


def _moved(values: Array, places: float) -> Array:
    """Return a history delayed by so many samples, zero before its begin."""
    at = np.arange(values.size) - places
    from scipy.interpolate import CubicSpline

    inside = (at >= 0.0) & (at <= values.size - 1)
    return np.where(inside, CubicSpline(np.arange(values.size), values)(np.clip(at, 0.0, values.size - 1.0)), 0.0)


def _history(values: ArrayLike, step: float) -> Array:
    x = np.asarray(values, dtype=float)
    if x.ndim != 1 or x.size < 2 or not np.all(np.isfinite(x)) or not 0.0 < step < math.inf:
        raise ValueError(f"a history needs at least two finite samples and a step above zero, got {x.shape}, {step!r}")
    return x
