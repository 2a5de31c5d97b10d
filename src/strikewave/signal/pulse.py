"""Figures of a single pulse in an evenly sampled history: peak, width, rise, velocity change."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

WIDTH_FRACTION = 0.1  # share of the peak at which widths are taken: a convention, above noise and baseline
FOOT = 0.02  # share of the peak where a pulse begins and ends: feet below hold 0.02 % of a half-sine, the rest is drift
RISE_LOW, RISE_HIGH = 0.1, 0.9  # shares of the peak between which a rise time is taken: the field's definition
# Width at 10 % of the peak of a half-sine, over its duration
HALF_SINE_WIDTH = 1.0 - 2.0 * math.asin(WIDTH_FRACTION) / math.pi
# Rise from 10 to 90 % of a half-sine, over its duration
HALF_SINE_RISE = (math.asin(RISE_HIGH) - math.asin(RISE_LOW)) / math.pi
# Sampling intervals a pulse below which the recorder is warned of: the worst loss of peak is then 1.2 %
FEWEST_INTERVALS = 10.0


class Pulse(NamedTuple):
    """One excursion of a history.

    Attributes
    ----------
    time : float
        Time of the peak, s.
    peak : float
        Largest value, in the unit of the history.
    width : float
        Time above the stated share of the peak, s; NaN where the history begins or ends above it.
    rise : float
        Time from 10 to 90 % of the peak, s.
    area : float
        Integral over the width: the velocity change when the history is an acceleration.
    """

    time: float
    peak: float
    width: float
    rise: float
    area: float


def refine_peak(values: Array, index: int) -> tuple[float, float]:
    """Return place (in samples) and height of a peak between samples, by a parabola through three.

    Examples
    --------
    >>> refine_peak(np.array([0.0, 3.0, 4.0, 3.0, 0.0]), 2)
    (2.0, 4.0)
    """
    if not 0 < index < values.size - 1:
        return float(index), float(values[index])
    left, middle, right = (float(v) for v in values[index - 1 : index + 2])
    curvature = left - 2.0 * middle + right
    if curvature >= 0.0:
        return float(index), middle
    shift = 0.5 * (left - right) / curvature
    return index + shift, middle - 0.25 * (left - right) * shift


def crossing(values: Array, index: int, level: float, direction: int) -> float:
    """Return the place, in samples, where the history first falls to a level, going from ``index``.

    ``direction`` is -1 (earlier) or 1 (later). NaN where it never falls that low.
    """
    side = values[: index + 1][::-1] if direction < 0 else values[index:]
    below = np.flatnonzero(side <= level)
    if below.size == 0:
        return math.nan
    if below[0] == 0:
        return float(index)
    k = int(below[0])
    fraction = (side[k - 1] - level) / (side[k - 1] - side[k])
    return index + direction * (k - 1 + float(fraction))


def area_between(values: Array, first: float, last: float) -> float:
    """Return the integral of the straight lines between samples from one place to a later one, both in samples."""
    begin, end = math.ceil(first), math.floor(last)
    low, high = _at(values, first), _at(values, last)
    if begin > end:
        return 0.5 * (low + high) * (last - first)
    inner = values[begin : end + 1]
    left, right = float(inner[0]), float(inner[-1])
    inside = float(np.sum(inner)) - 0.5 * (left + right)
    return inside + 0.5 * (low + left) * (begin - first) + 0.5 * (right + high) * (last - end)


def _at(values: Array, place: float) -> float:
    """Return the value on the straight lines between samples at a place, in samples."""
    k = min(math.floor(place), values.size - 2)
    return float(values[k]) + (place - k) * float(values[k + 1] - values[k])


def measure_pulse(values: Array, step: float, start: float = 0.0, fraction: float = WIDTH_FRACTION) -> Pulse:
    """Measure the largest positive pulse of a history without noise.

    Parameters
    ----------
    values : ndarray
        The history, evenly sampled.
    step : float
        Time between samples, s.
    start : float, optional
        Time of the first sample, s.
    fraction : float, optional
        Share of the peak at which the width is taken.

    Raises
    ------
    ValueError
        If there are fewer than three samples, one is not finite, or none is positive.

    Examples
    --------
    >>> t = np.linspace(0, 1, 2001)
    >>> pulse = measure_pulse(np.sin(np.pi * t), t[1])
    >>> round(pulse.peak, 9), round(pulse.width, 6), round(pulse.rise, 5)
    (1.0, 0.936231, 0.32455)
    """
    if values.ndim != 1 or values.size < 3:
        raise ValueError(f"a pulse needs at least three samples, got shape {values.shape}")
    if not np.all(np.isfinite(values)):
        raise ValueError("the history holds values that are not finite")
    index = int(np.argmax(values))
    if values[index] <= 0.0:
        raise ValueError("the history has no positive value")
    place, peak = refine_peak(values, index)
    begin, end = (crossing(values, index, fraction * peak, side) for side in (-1, 1))
    low, high = (crossing(values, index, share * peak, -1) for share in (RISE_LOW, RISE_HIGH))
    first, last = (0.0 if math.isnan(begin) else begin), (values.size - 1.0 if math.isnan(end) else end)
    area = area_between(values, first, last) * step
    return Pulse(float(start + place * step), peak, float((end - begin) * step), float((high - low) * step), area)


def foot_to_foot(values: Array, step: float) -> float:
    """Return the integral of the largest positive pulse of a history without noise, from foot to foot.

    Of an acceleration it is the velocity change. A pulse that does not come back to its foot ends as near to the last
    value as the foot is to zero: a table that stays on its pad then reads 1 g for as long as it lies there. One that
    begins above its foot counts from the first sample.

    Examples
    --------
    >>> t = np.linspace(-0.5, 1.5, 4001)
    >>> round(foot_to_foot(np.sin(np.pi * t), 5e-4) * np.pi / 2.0, 4)
    0.9998
    """
    pulse, top = measure_pulse(values, step, fraction=FOOT), int(np.argmax(values))
    foot = FOOT * pulse.peak
    if not math.isnan(crossing(values, top, foot, 1)):
        return pulse.area
    settled = crossing(values, top, float(values[-1]) + foot, 1)
    if math.isnan(settled):
        return pulse.area
    return measure_pulse(values[: math.ceil(settled) + 1], step, fraction=FOOT).area


def largest(values: Array) -> float:
    """Return the value of largest magnitude, with its sign; NaN is passed over, and of nothing it is NaN.

    Examples
    --------
    >>> largest(np.array([1.0, -3.0, 2.0, np.nan]))
    -3.0
    """
    known = values[np.isfinite(values)]
    return float(known[int(np.argmax(np.abs(known)))]) if known.size else math.nan


def front(acceleration: Array, step: float) -> float:
    """Return the rise time (10-90 %) of the steepest front in a history: 0.8 of its time above a tenth of its peak.

    A velocity that rises along a line has a front of 0.8 of that time; one that jumps has one of a few steps.

    Examples
    --------
    >>> ramp = np.where((np.arange(100) >= 40) & (np.arange(100) < 60), 1.0, 0.0)
    >>> round(front(ramp, 1e-6) * 1e6, 1)
    16.6
    """
    values = np.abs(acceleration)
    place = int(np.argmax(values))
    if not values[place] > 0.0:
        return math.inf
    edges = [crossing(values, place, RISE_LOW * float(values[place]), side) for side in (-1, 1)]
    begin = edges[0] if math.isfinite(edges[0]) else 0.0
    end = edges[1] if math.isfinite(edges[1]) else float(values.size)
    return (RISE_HIGH - RISE_LOW) * (end - begin) * step
