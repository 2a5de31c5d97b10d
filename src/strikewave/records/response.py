"""A channel that answers the blows of another one: a board that swings, with no blow of its own.

The effective duration is T_E of MIL-STD-810H, method 516.8: the minimum length of time that contains all data
magnitudes exceeding 1/3 of the shock peak magnitude. So it is quoted; the text of the standard itself was not at hand.
The standard's other duration, T_e, by the moving root mean square, is not given.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN
from strikewave.base.shock_quantities import MILLISECONDS, OF_CHANNEL, RATIO, SECONDS
from strikewave.records.modes import FEWEST, Mode, decaying_modes

Array = NDArray[np.float64]

EFFECTIVE = 1.0 / 3.0
"""Share of the peak magnitude that the effective duration holds all samples above."""
FREE = 0.1
"""Share of the peak magnitude down to which a free decay is followed: below, little is left of it beside the noise."""
BOTH_SIDES, ZERO_MEAN = 0.5, 0.2
"""Other side of the peak, over it, and area over that of the magnitude: a channel with more, and less, swings about
zero. A half-sine has 0 and 1; a decaying sine at a damping ratio of 5 % has 0.85 and below 0.1."""

ROUND = 0.5
"""Share of the largest value that its neighbours have in a round top: those of six samples a swing and more."""


class BaseBlow(NamedTuple):
    """A blow of the driving channel: begin, time of the peak, and end, s, and the peak."""

    begin: float
    time: float
    end: float
    peak: float


@declare.dataclass
class FreeDecay:
    """The stretch in which a response swings freely."""

    begin: float = declare.number(SECONDS, "begin of the free decay")
    end: float = declare.number(SECONDS, "its end")


@declare.dataclass
class MeasuredResponse:
    """What a channel does after a blow of another one, until the next blow or the end of the record."""

    blow: int = declare.count("number of the blow of the base, from 1", column=KEY)
    peak: float = declare.number(
        OF_CHANNEL, "absolute maximum above the zero before the first blow, with its sign", column=MAIN
    )
    time: float = declare.number(SECONDS, "when")
    delay: float = declare.number(MILLISECONDS, "how long after the peak of the base")
    base_peak: float = declare.number(OF_CHANNEL, "that of the base, in the unit of the base")
    ratio: float = declare.number(RATIO, "magnitude of the peak over that of the base; null where their units differ")
    begin: float = declare.number(SECONDS, "begin of the effective duration")
    duration: float = declare.number(
        MILLISECONDS, "effective duration: from the first to the last time above a third of the peak magnitude"
    )
    rms: float = declare.number(OF_CHANNEL, "root mean square over the effective duration")
    modes: tuple[Mode, ...] = declare.rows(
        Mode, "the strongest of the free decay, that with the most energy first; amplitudes at its begin"
    )
    zero: float = declare.number(OF_CHANNEL, "what all this is counted from")
    decay: FreeDecay = declare.part(FreeDecay, "the free decay")

    def figure(self, name: str) -> float:
        """Return a figure: the peak by its magnitude, frequency and damping of the strongest mode; NaN for none."""
        if name in ("frequency", "damping"):
            return float(getattr(self.modes[0], name)) if self.modes else math.nan
        value = float(getattr(self, name))
        return abs(value) if name == "peak" else value


def effective_span(values: Array, share: float = EFFECTIVE) -> tuple[float, float]:
    """Return the places of the first and last crossing of a share of the peak magnitude, between samples.

    Examples
    --------
    >>> first, last = effective_span(np.exp(-np.arange(1000) / 100.0))
    >>> first, round(last)  # 100 ln 3
    (0.0, 110)
    """
    size = np.abs(values)
    level = share * float(np.max(size))
    above = np.flatnonzero(size >= level)
    first, last = int(above[0]), int(above[-1])
    begin = first - (size[first] - level) / (size[first] - size[first - 1]) if first else 0.0
    after = (size[last] - level) / (size[last] - size[last + 1]) if last < size.size - 1 else 0.0
    return float(begin), float(last + after)


def swings(values: Array) -> bool:
    """Tell whether a record, its zero taken off, swings about zero rather than being struck to one side.

    Examples
    --------
    >>> t = np.linspace(0.0, 1.0, 2000)
    >>> swings(np.exp(-3.0 * t) * np.sin(60.0 * t)), swings(np.sin(np.pi * t))
    (True, False)
    """
    first, last = effective_span(values, FREE)
    part = values[math.floor(first) : math.ceil(last) + 1]
    low, high = sorted((-float(np.min(part)), float(np.max(part))))
    total = float(np.sum(np.abs(part)))
    return low > BOTH_SIDES * high and abs(float(np.sum(part))) < ZERO_MEAN * total


def zero_before(values: Array, place: int) -> float:
    """Return the zero of a record before a place; where too little lies before it, the median of the whole.

    Examples
    --------
    >>> zero_before(np.r_[np.full(100, 3.0), np.full(900, 5.0)], 100)
    3.0
    """
    return float(np.median(values[:place] if place >= FEWEST else values))


def measure_responses(
    values: Array, step: float, start: float, blows: Sequence[BaseBlow], same_unit: bool = True
) -> tuple[MeasuredResponse, ...]:
    """Measure a channel against the blows of another one: after each, until the next.

    Parameters
    ----------
    values : ndarray
        The channel, finite.
    step, start : float
        Time between samples, and of the first, s.
    blows : sequence of BaseBlow
        Of the base, in the order of time.
    same_unit : bool, optional
        Whether base and channel have the same unit, so that a ratio makes sense.

    Examples
    --------
    >>> t = np.arange(4000) * 1e-5
    >>> swing = np.exp(-200.0 * t) * np.sin(2.0 * np.pi * 800.0 * t)
    >>> blows = [BaseBlow(0.01, 0.0102, 0.0104, 9.0), BaseBlow(0.05, 0.0502, 0.0504, 9.0)]
    >>> both = np.r_[np.zeros(1000), 6.0 * swing, 3.0 * swing]
    >>> [(found.blow, round(found.peak)) for found in measure_responses(both, 1e-5, 0.0, blows)]
    [(1, 6), (2, 3)]
    """
    places = [min(max(round((blow.begin - start) / step), 0), max(values.size - FEWEST, 0)) for blow in blows]
    zero = zero_before(values, places[0]) if places else 0.0
    ends = [*places[1:], values.size]
    return tuple(
        replace(_measure(number, values[place:end] - zero, step, start + place * step, blow, same_unit), zero=zero)
        for number, (blow, place, end) in enumerate(zip(blows, places, ends, strict=True), 1)
        if end - place >= FEWEST
    )


def _measure(number: int, above: Array, step: float, start: float, blow: BaseBlow, same_unit: bool) -> MeasuredResponse:
    """Measure what follows one blow."""
    top = int(np.argmax(np.abs(above)))
    place, peak = _tip(above, top)
    moment = start + place * step
    ratio = abs(peak / blow.peak) if same_unit else math.nan
    if peak == 0.0:
        at = blow.begin
        none = FreeDecay(at, at)
        return MeasuredResponse(number, 0.0, at, at - blow.time, blow.peak, ratio, at, 0.0, 0.0, (), 0.0, none)
    first, last = effective_span(above)
    held = above[math.floor(first) : math.ceil(last) + 1]
    free = max(top, math.ceil((blow.end - start) / step))
    until = math.ceil(effective_span(above, FREE)[1]) + 1
    return MeasuredResponse(
        number,
        peak,
        moment,
        moment - blow.time,
        blow.peak,
        ratio,
        start + first * step,
        (last - first) * step,
        math.sqrt(float(np.mean(held**2))),
        decaying_modes(above[free:until], step),
        0.0,
        FreeDecay(start + free * step, start + max(until - 1, free) * step),
    )


def _tip(above: Array, top: int) -> tuple[float, float]:
    """Return place and height of the largest value, by the parabola through it and its neighbours where it is round."""
    if not 0 < top < above.size - 1:
        return float(top), float(above[top])
    left, middle, right = (float(value) for value in above[top - 1 : top + 2])
    bend = left - 2.0 * middle + right
    if middle == 0.0 or min(left / middle, right / middle) < ROUND:
        return float(top), middle
    shift = 0.5 * (left - right) / bend if bend else 0.0
    return top + shift, middle - 0.25 * (left - right) * shift
