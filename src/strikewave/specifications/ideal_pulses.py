"""Ideal pulses of shock specifications, and the band in time and amplitude for measured ones.

The band that a measured pulse must stay in: the ideal pulse widened in time and amplitude, and where it is placed.

    upper(t) = max of the ideal pulse from t - tau to t + tau, plus alpha A
    lower(t) = min of the ideal pulse from t - tau to t + tau, minus alpha A

The band is placed in time where the smallest distance of the record to its curves is largest; of placements as good,
that is taken which brings the middle of the ideal pulse width next to that of the measured one. A record that can be
placed within passes, whatever noise does to its onset; straight lines join its samples, and the curves are compared
every `FINEST` of the duration, so that the sampling of the record plays no part but for the chords themselves.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

HALF_SINE, SAWTOOTH, TRAPEZOID = "half-sine", "sawtooth", "trapezoid"
SHAPES = (HALF_SINE, SAWTOOTH, TRAPEZOID)  # shapes of a pulse; a sawtooth has its peak at its end


@dataclass(frozen=True)
class IdealPulse:
    """A pulse as a specification draws it, from time 0 on.

    Half-sine: a = A sin(pi t / D). Terminal-peak sawtooth: a = A t / D. Trapezoid: a line to A, A, and a line to 0.
    """

    shape: str  # one of `SHAPES`
    peak: float  # A, above zero
    duration: float  # D from foot to foot, s
    rise: float = 0.1  # shares of the duration in which a trapezoid rises and falls
    fall: float = 0.1

    def at(self, time: ArrayLike) -> Array:
        """Return the pulse at times, s: zero before and after."""
        share = np.asarray(time, dtype=np.float64) / self.duration
        inside = (share >= 0.0) & (share <= 1.0)
        if self.shape == HALF_SINE:
            values = np.sin(np.pi * np.clip(share, 0.0, 1.0))
        elif self.shape == SAWTOOTH:
            values = np.clip(share, 0.0, 1.0)
        else:
            values = np.minimum(np.minimum(share / self.rise, (1.0 - share) / self.fall), 1.0)
        return np.asarray(np.where(inside, self.peak * values, 0.0), dtype=np.float64)

    @property
    def top(self) -> tuple[float, float]:
        """Begin and end of its top, s."""
        low, high = {HALF_SINE: (0.5, 0.5), SAWTOOTH: (1.0, 1.0)}.get(self.shape, (self.rise, 1.0 - self.fall))
        return low * self.duration, high * self.duration

    def widened(self, time: ArrayLike, by: float) -> tuple[Array, Array]:
        """Return the smallest and largest value that the pulse has within a time to either side, s.

        The pulse has one top, so that its smallest value stands at an end of that stretch, and its largest at the top
        or at the end next to it.
        """
        time = np.asarray(time, dtype=np.float64)
        first, last = time - by, time + by
        begin, end = self.top
        at_top = (first <= end) & (last >= begin)
        high = np.where(at_top, self.peak, np.where(last < begin, self.at(last), self.at(first)))
        return np.minimum(self.at(first), self.at(last)), np.asarray(high, dtype=np.float64)

    def width(self, level: float) -> float:
        """Return the time above a share of the peak, s.

        Half-sine: D (1 - 2 asin(level) / pi), at 10 % 0.936 D. Sawtooth: D (1 - level). Trapezoid: D (1 - level (rise
        + fall)).
        """
        if self.shape == HALF_SINE:
            return self.duration * (1.0 - 2.0 * math.asin(level) / math.pi)
        return self.duration * (1.0 - level * (1.0 if self.shape == SAWTOOTH else self.rise + self.fall))

    @property
    def velocity_change(self) -> float:
        """Integral: half-sine 2 A D / pi, sawtooth A D / 2, trapezoid A D (1 - (rise + fall) / 2)."""
        area = {HALF_SINE: 2.0 / math.pi, SAWTOOTH: 0.5}.get(self.shape, 1.0 - 0.5 * (self.rise + self.fall))
        return area * self.peak * self.duration


def from_width(
    shape: str, peak: float, duration: float, level: float, rise: float = 0.1, fall: float = 0.1
) -> IdealPulse:
    """Return the ideal pulse whose width at a share of its peak is stated; level 0 states its duration itself."""
    unit_pulse = IdealPulse(shape, peak, 1.0, rise, fall)
    return IdealPulse(shape, peak, duration / unit_pulse.width(level), rise, fall)


# Share of the duration between two times of comparison: between them a half-sine bends by 2e-6 of its peak
FINEST = 1.0 / 800.0
# Shares of the duration to either side in which the start is sought: a pulse that is farther off fails anyway
REACH = 0.75
# Share of the duration between two times of comparison where all starts within reach are tried, and such times from one
# start to the next
COARSE, SCANNED = 1.0 / 160.0, 2
# The best few starts, around each of which so many are tried, in a fifth of the steps each time: the start is then
# known to 4e-6 of the duration, and the distance to 1.3e-5 of the peak
KEPT, ZOOMED, ZOOMS = 3, 11, 5


class Placement(NamedTuple):
    """Place of a band over a record, and the distance of the record to its curves."""

    start: float  # time of the begin of the ideal pulse, s
    margin: float  # smallest distance to the curves of the band, in the unit of the record; below zero outside
    time: float  # when it is smallest, s
    above: bool  # true if the smallest distance is that to the upper curve
    before: float  # how much of the window the record lacks, in shares of the duration
    after: float


@dataclass(frozen=True)
class PulseBand:
    """A band around an ideal pulse."""

    pulse: IdealPulse  # the ideal pulse
    time: float  # tau as a share of the duration
    amplitude: float  # alpha as a share of the peak, from tau before the pulse to tau after it
    amplitude_before: float = float("nan")  # the same earlier and later
    amplitude_after: float = float("nan")
    before: float = 0.4  # shares of the duration before and after the ideal pulse in which the record is watched
    after: float = 1.0

    def curves(self, time: Array) -> tuple[Array, Array]:
        """Return the lower and the upper curve at times from the begin of the ideal pulse, s."""
        by, duration = self.time * self.pulse.duration, self.pulse.duration
        low, high = self.pulse.widened(time, by)
        share = np.full(time.shape, self.amplitude)
        for wanted, where in ((self.amplitude_before, time < -by), (self.amplitude_after, time > duration + by)):
            share[where] = self.amplitude if np.isnan(wanted) else wanted
        room = share * self.pulse.peak
        return low - room, high + room

    def grid(self) -> Array:
        """Return the times of comparison, from the begin of the ideal pulse, s: evenly, and at the kinks of the curves.

        A step of a curve is looked at from both sides.
        """
        duration, by = self.pulse.duration, self.time * self.pulse.duration
        count = round((1.0 + self.before + self.after) / FINEST) + 1
        even = np.linspace(-self.before * duration, (1.0 + self.after) * duration, count)
        kinks = np.array([place + side for place in (0.0, *self.pulse.top, duration) for side in (-by, 0.0, by)])
        beside = 1e-9 * duration
        times = np.concatenate([even, kinks - beside, kinks, kinks + beside])
        return np.unique(times[(times >= even[0]) & (times <= even[-1])])

    def placed(self, values: Array, step: float, begin: float, centre: float) -> Placement:
        """Place the band over a record."""
        duration = self.pulse.duration
        first = centre - (REACH + self.before) * duration
        last = centre + (1.0 + self.after + REACH) * duration
        low = min(max(int((first - begin) / step), 0), values.size - 1)
        high = max(int((last - begin) / step) + 2, low + 1)
        near = _Comparison(self, values[low:high], step, begin + low * step)
        same = 1e-9 * self.pulse.peak

        def best_of(found: Sequence[tuple[float, float]]) -> list[float]:
            """Return the best few starts; of those that are as good, those next to the centre first."""
            top = max(margin for margin, _ in found)

            def rank(one: tuple[float, float]) -> tuple[float, float]:
                behind = top - one[0]
                return (0.0 if behind < same else behind), abs(one[1] - centre)

            return [start for _, start in sorted(found, key=rank)[:KEPT]]

        best = best_of(near.scan(centre))
        span = SCANNED * COARSE * duration
        for _ in range(ZOOMS):
            tried = {start for middle in best for start in (middle + np.linspace(-span, span, ZOOMED)).tolist()}
            best = best_of([(near.at(start)[0], start) for start in sorted({*tried, *best, centre})])
            span *= 2.0 / (ZOOMED - 1)
        start = best[0]
        end = begin + step * (values.size - 1)
        return Placement(
            start,
            *near.at(start),
            max(begin - (start - self.before * duration), 0.0) / duration,
            max(start + (1.0 + self.after) * duration - end, 0.0) / duration,
        )


class _Comparison:
    """Part of a record about a pulse, and the curves of a band that slide over it."""

    def __init__(self, band: PulseBand, values: Array, step: float, begin: float) -> None:
        self.band, self.values = band, values
        self.time = np.asarray(begin + step * np.arange(values.size), dtype=np.float64)
        self.grid = band.grid()
        self.low, self.high = band.curves(self.grid)
        self.dense = step <= FINEST * band.pulse.duration

    def at(self, start: float) -> tuple[float, float, bool]:
        """Return the smallest distance of a start to the curves, when, and whether to the upper one.

        Straight lines join the samples, so that they are compared themselves, and between them the grid.
        """
        worst = (np.inf, np.nan, True)
        for time in (self.time, None if self.dense else self.grid + start):
            if time is None:
                continue
            from_start = self.time - start if time is self.time else self.grid
            inside = (from_start >= self.grid[0]) & (from_start <= self.grid[-1])
            inside &= (time >= self.time[0]) & (time <= self.time[-1])
            if not np.any(inside):
                continue
            if time is self.time:
                record = self.values[inside]
                low, high = (np.interp(from_start[inside], self.grid, curve) for curve in (self.low, self.high))
            else:
                record, low, high = np.interp(time[inside], self.time, self.values), self.low[inside], self.high[inside]
            for room, above in ((high - record, True), (record - low, False)):
                k = int(np.argmin(room))
                if room[k] < worst[0]:
                    worst = float(room[k]), float(time[inside][k]), above
        return worst if worst[0] < np.inf else (-np.inf, start, True)

    def scan(self, centre: float) -> list[tuple[float, float]]:
        """Return the smallest distance of each start within reach, on one grid over which the curves slide."""
        band, fine = self.band, COARSE * self.band.pulse.duration
        first, count = round(band.before / COARSE), round((1.0 + band.before + band.after) / COARSE) + 1
        reach = round(REACH / COARSE)
        low, high = band.curves(np.asarray(fine * (np.arange(count) - first), dtype=np.float64))
        times = centre + fine * (np.arange(count + 2 * reach) - first - reach)
        record = np.interp(times, self.time, self.values, left=np.nan, right=np.nan)
        windows = np.lib.stride_tricks.sliding_window_view(record, count)[::SCANNED]
        out = np.fmin(high - windows, windows - low)
        margins = np.where(np.isfinite(out).any(axis=1), np.fmin.reduce(out, axis=1), -np.inf)
        starts = centre + fine * (SCANNED * np.arange(windows.shape[0]) - reach)
        return list(zip(margins.tolist(), starts.tolist(), strict=True))
