"""The tip and the sides of a blow, by which a limit of sensor or amplifier shows."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.records.health.sampled_record import Array, BlowRecord
from strikewave.records.measuring import RecordedPulse
from strikewave.records.thresholds import OfTops
from strikewave.signal.pulse import crossing

BENDS = 6
"""Degree of the polynomial through the upper half of a pulse: it follows every smooth one to 0.1 % of its peak."""
UPPER, TIP = 0.5, 0.9
"""Shares of the peak at which the widths of the upper half and of the tip are taken."""
ROUNDEST = (0.5 * math.pi - math.asin(TIP)) / (0.5 * math.pi - math.asin(UPPER))
"""Width of the tip over that of the upper half of a half-sine, 0.431.

A linear spring makes a half-sine. Contacts, felt and foam stiffen as they are pressed, and make more pointed pulses;
only what yields, is made to be flat, or is compressed by an amplifier has a flatter top."""
HALFWAY = np.array([0.25, 0.75])
"""Shares of the peak between which the slopes of sides are compared."""
FROM, FINE = 0.8, 2001
"""Share of the upper half's height from which on samples enter its polynomial; places at which that is looked at."""
LOW, HIGHEST = 0.2, 3.0
"""Lower share of the peak at which the half-sine of the flanks is as wide as they are (below, the foot is that of the
contact), and its largest peak over that seen."""
LEVELS = np.array([0.02, 0.06, 0.1, 0.14, 0.18, 0.22])
"""Shares of the peak at which the part of a side begins that is looked at, over `OfTops.OVER`."""


class Flank(NamedTuple):
    """A side of a pulse: its largest slope, and by how much it bends at least over `OfTops.OVER` of the peak.

    ``goes_on``: how high the straight line through that goes on until the peak, over it.
    """

    slope: float
    bend: float
    goes_on: float = math.nan


@dataclass(frozen=True, eq=False)
class BlowShape:
    """A blow in its record; each figure of its shape is measured once, when it is asked for.

    Examples
    --------
    >>> from strikewave.records.measuring import find_pulses
    >>> place = np.arange(900.0)
    >>> half_sine = np.sin(np.pi * np.clip(place / 80.0 - 5.0, 0.0, 1.0))
    >>> for values in (half_sine, half_sine**2, np.maximum(1.0 - np.abs(place / 40.0 - 11.0), 0.0)):
    ...     [pulse] = find_pulses(values, 1e-6)
    ...     shape = BlowShape(BlowRecord(values, 1e-6), pulse)
    ...     print(round(shape.tip, 2), round(shape.usual_tip, 2), round(shape.flanks[0].bend, 2))
    0.43 0.43 0.03
    0.41 0.41 0.02
    0.31 0.4 0.0
    """

    record: BlowRecord
    pulse: RecordedPulse

    @cached_property
    def heights(self) -> Array:
        """What the blow is above its zero, from foot to foot, over its peak."""
        record, pulse = self.record, self.pulse
        part = record.values[record.place(pulse.begin) : record.place(pulse.end) + 1]
        return np.asarray(math.copysign(1.0, pulse.peak) * (part - pulse.offset) / abs(pulse.peak))

    @property
    def top(self) -> int:
        """The sample of the peak among these."""
        return self.record.place(self.pulse.time) - self.record.place(self.pulse.begin)

    def side(self, side: int) -> Array:
        """Return one side (-1 before the peak, 1 after it) from its foot up to the peak, over the peak."""
        return self.heights[self.top :][::-1] if side > 0 else self.heights[: self.top + 1]

    @cached_property
    def tip(self) -> float:
        """Width of the tip over that of the upper half, of a polynomial through it; NaN if too few samples make it."""
        low = np.flatnonzero(self.heights < FROM * UPPER)
        left, right = low[low < self.top], low[low > self.top]
        if not (left.size and right.size) or right[0] - left[-1] < OfTops.FEWEST:
            return math.nan
        inside = self.heights[left[-1] : right[0] + 1]
        degree = min(BENDS, inside.size - 3)
        bent = _legendre(FINE, degree) @ (_legendre_fit(inside.size, degree) @ inside)
        highest = float(np.max(bent))
        tip, upper = (int(np.count_nonzero(bent >= share * highest)) for share in (TIP, UPPER))
        return tip / upper

    @cached_property
    def usual_tip(self) -> float:
        """Width of the tip over that of the upper half that a power of a sine with these flanks has.

        At least a half-sine: from it on, the longer the feet, the more pointed the tip.
        """
        ends = [[crossing(self.heights, self.top, share, side) for side in (-1, 1)] for share in (LOW, UPPER)]
        low, upper = (right - left for left, right in ends)
        share = upper / low if low > 0.0 else math.nan
        return ROUNDEST if math.isnan(share) else float(np.interp(-share, *_powers_of_a_sine()))

    @cached_property
    def flanks(self) -> tuple[Flank, Flank]:
        """The side before the peak and the one after it."""
        return self._flank(-1), self._flank(1)

    def _flank(self, side: int) -> Flank:
        """Return the largest slope of one side, and its bend, the doubt by noise and ringing added.

        The bend is that of parabola and cubic in the Legendre polynomials through the side, over the peak. What rings
        after the pulse may straighten a side by as much as its amplitude.
        """
        heights, pulse = self.side(side), self.pulse
        ripple = 0.0 if math.isnan(pulse.baseline.ripple) else pulse.baseline.ripple
        swing = max(ripple, self._amplitude_after)
        least, slope, goes_on = math.inf, float(np.max(np.diff(heights), initial=0.0)), math.nan
        ends = _last_below(heights, np.stack([LEVELS, LEVELS + OfTops.OVER])).T.tolist()
        for first, below in dict.fromkeys(map(tuple, ends)):  # of few samples several levels have the same
            part = heights[first : below + 2]
            if part.size < OfTops.FEWEST_OF_FLANK:
                continue
            bends = _legendre_fit(part.size, 3) @ part
            doubt = max(pulse.noise * math.sqrt(7.0 / part.size), swing) / abs(pulse.peak)
            if (bend := math.hypot(bends[2], bends[3]) + doubt) < least:
                least, slope = bend, 2.0 * float(bends[1]) / (part.size - 1)
                goes_on = float(bends[0]) + slope * (heights.size - 1 - first - 0.5 * (part.size - 1))
        return Flank(abs(pulse.peak) * slope / self.record.step, least, goes_on)

    def slope_halfway(self, side: int) -> float:
        """Return the slope of one side between a fourth and three fourths of the peak."""
        heights = self.side(side)
        first, below = _last_below(heights, HALFWAY)
        last = below + 1
        rise = float(heights[last] - heights[first])
        return abs(self.pulse.peak) * rise / (max(int(last - first), 1) * self.record.step)

    @cached_property
    def noise_of_top(self) -> float:
        """What noise of any colour does to the top, over the peak: one standard deviation."""
        pulse = self.pulse
        white = pulse.noise * math.sqrt((BENDS + 1.0) * self.record.step / pulse.width)
        return max(white, 0.0 if math.isnan(pulse.baseline.ripple) else pulse.baseline.ripple) / abs(pulse.peak)

    @property
    def half_sine_of_flanks(self) -> float:
        """Peak of the half-sine that is as wide at two low heights, over that of the pulse."""
        low, high = (int(np.count_nonzero(self.heights >= share)) for share in (LOW, UPPER))
        peaks = np.linspace(1.0, HIGHEST, FINE)
        ratios = np.arccos(UPPER / peaks) / np.arccos(LOW / peaks)  # rise with the peak
        return float(np.interp(high / low, ratios, peaks))

    @cached_property
    def swing_to_both_sides(self) -> float:
        """By how much the record swings to both sides within two widths after it, over the peak: no tail does."""
        return max(_to_both_sides(self._after) - OfTops.NOISE_SPANS * self.pulse.noise, 0.0) / abs(self.pulse.peak)

    @cached_property
    def _amplitude_after(self) -> float:
        """The amplitude of what swings to both sides after the blow, the most that noise makes of it taken off."""
        after = self._after
        by_noise = self.record.scatter**2 * (1.0 + OfTops.SURE * math.sqrt(2.0 / after.size))
        return min(max(_to_both_sides(after), 0.0), math.sqrt(2.0 * max(float(np.var(after)) - by_noise, 0.0)))

    @cached_property
    def _after(self) -> Array:
        """The record above the zero of the blow from its end on, as long as what bent its top swings on."""
        record, pulse = self.record, self.pulse
        first, last = record.place(pulse.end), record.place(pulse.end + OfTops.SWINGS_WITHIN * pulse.width)
        return np.asarray(record.values[first : last + 1] - pulse.offset)


def _last_below(heights: Array, levels: Array) -> NDArray[np.intp]:
    """Return the last sample that is below each level; the first one where none is."""
    deepest = np.minimum.accumulate(heights[::-1])  # from the top on downwards
    return np.maximum(heights.size - 1 - np.searchsorted(-deepest, -levels, side="right"), 0)


def _to_both_sides(values: Array) -> float:
    """Return by how much values reach to either side of zero; below zero where they stay on one."""
    return min(float(np.max(values)), -float(np.min(values)))


@functools.cache
def _powers_of_a_sine() -> tuple[Array, Array]:
    """Return how wide powers of a sine are at `UPPER` over `LOW`, with its sign changed, and at `TIP` over `UPPER`."""
    powers = np.linspace(1.0, OfTops.MOST_POINTED, FINE)
    tips, uppers, lows = (np.arccos(share ** (1.0 / powers)) for share in (TIP, UPPER, LOW))
    return -uppers / lows, tips / uppers


@functools.lru_cache(maxsize=256)
def _legendre_fit(size: int, degree: int) -> Array:
    """Return the matrix that makes the coefficients of the least-squares polynomial of so many even samples.

    Examples
    --------
    >>> (_legendre_fit(7, 3) @ np.linspace(-1.0, 1.0, 7) ** 2).round(6) + 0.0  # x^2 = 1/3 P0 + 2/3 P2
    array([0.333333, 0.      , 0.666667, 0.      ])
    """
    return np.asarray(np.linalg.pinv(_legendre(size, degree)), dtype=float)


@functools.lru_cache(maxsize=256)
def _legendre(size: int, degree: int) -> Array:
    """Return the Legendre polynomials up to a degree, a column each, at so many even places from -1 to 1."""
    return np.asarray(np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, size), degree), dtype=float)
