"""The range of sensor, amplifier and recorder: clipped records, flat tops, and a limited slope."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base.percents import percent
from strikewave.records.health.examined import BLOW, Examined
from strikewave.records.health.ringing import goes_back
from strikewave.records.health_notice import HealthNotice
from strikewave.records.measuring import RecordedPulse
from strikewave.signal.pulse import crossing

Array = NDArray[np.float64]


FEWEST_OF_TOP = 6
"""Samples above half of the peak without which the shape of a top is not known."""
BENDS = 6
"""Degree of the polynomial through the upper half of a pulse: it follows every smooth one to 0.1 % of its peak."""
UPPER, TIP = 0.5, 0.9
"""Shares of the peak at which the widths of the upper half and of the tip are taken."""
ROUNDEST = (0.5 * math.pi - math.asin(TIP)) / (0.5 * math.pi - math.asin(UPPER))
"""Width of the tip over that of the upper half of a half-sine, 0.431.

A linear spring makes a half-sine. Contacts, felt and foam stiffen as they are pressed, and make more pointed pulses;
only what yields, is made to be flat, or is compressed by an amplifier has a flatter top."""
MOST_POINTED = 4.0
"""Power of a sine beyond which pulses that have such flanks have no more pointed tips."""
FLATTER = 0.02
"""By how much a top is flatter before it is suspect: the tip of a sin^0.7 is by as much; a limit that takes 5 % off a
half-sine, a haversine or a pulse of Hertz makes 0.05 to 0.06."""
TIP_BY_PEAK = 1.8
"""Change of that ratio with the share by which the peak is off: of sin^0.7 to sin^3, 1.81 to 1.62."""
SURE = 3.0
"""Standard deviations of noise that a top must be flatter by: chance does it in one record of 700."""
SWINGS_WITHIN, NOISE_SPANS = 2.0, 4.0
"""Widths after a blow in which what bends its top swings on, and standard deviations that noise alone swings there."""
CORNER = 0.02
"""By how much a top is more pointed than a smooth one before it is a corner: the tip of x exp(-x) is by 0.015."""
ONE_SLOPE = 0.35
"""Slope of one side over that of the other from which on one limit may have made both, and no saw-tooth is meant.

Of a saw-tooth that rises over 0.7 of its length and falls as a cosine does it is 0.29."""
HALFWAY = (0.25, 0.75)
"""Shares of the peak between which the slopes of such sides are taken."""
GOES_ON, SAMPLES_OF_TIP = 0.02, 2.0
"""By how much a straight side goes on above the peak before its tip counts as bent, and samples on which a recorder's
filter rounds the tip of a saw-tooth, or delays it."""
FROM, FINE = 0.8, 2001
"""Share of the upper half's height from which on samples enter its polynomial; places at which that is looked at."""
LOW, HIGHEST, WRONG = 0.2, 3.0, 0.05
"""Lower share of the peak at which the half-sine of the flanks is as wide as they are (below, the foot is that of the
contact); its largest peak over that seen, and by how much it is higher before it is worth a word."""
OVER, LEVELS = 0.75, (0.02, 0.06, 0.1, 0.14, 0.18, 0.22)
"""Share of the peak over which a side is looked at, and where that begins.

A limited slope that falsifies a figure by 5 % holds over 0.77 of the peak and more, of all pulses planted."""
STRAIGHT = 0.01
"""Bend of such a side, over the peak, below which it is straight.

The straightest that a smooth pulse has is that of a haversine, whose cubic is 0.02: of sin x, x within asin(0.75), half
the coefficient x^3 / 6 times 2/5."""
ALIKE = 0.1
"""Share by which the slopes of two sides differ that one limit makes; their noise is less."""
SAW_TOOTH = 0.2
"""Slope of one straight side over that of the other below which a pulse is a saw-tooth as standards have it."""
FEWEST_OF_FLANK = 6
"""Samples of a side whose bend is known: two more than a cubic has parameters."""
FEWEST_AT_RAIL = 3
"""Samples at the largest value, and times those beside it, that make a rail; see `rail`."""
LEVELS_LOOKED_AT = 4096
"""Samples in which at least three different values stand, or the record is a switch or a count, and has no rail."""
NEAR_TOP = 0.05
"""Share of the span below the largest value in which the steps of the converter are looked for."""
OFF_ZERO = 0.01
"""Share of the span, or three steps of the converter, that a rail lies off the zero: the quiet zero is no rail."""
BESIDE, SHORT_RUN = 3, 6
"""Samples to either side of a run at a rail through which a parabola is laid, and longest run for which it is."""
BESIDE_RAIL = 2.5
"""Steps of the converter below the largest value that count as beside it: the next two."""


def clipped(record: Examined) -> list[HealthNotice]:
    """Find where the record stops at one value again and again: the recorder's range ended there.

    A plateau of a rounded top in a coarse recorder is no clipping: there the steps beside it are long too. Neither is
    the quiet zero of a record that goes to one side of it only.
    """
    findings = []
    pulse = record.largest
    zero = float(np.median(record.values)) if pulse is None else pulse.offset
    for sign in (1.0, -1.0):
        at = rail(sign * record.values, sign * zero)
        if not at.size:
            continue
        level = float(record.values[at[0]])
        if level == 0.0 and 0.0 in (record.values[0], record.values[-1]):
            continue  # zeros before or after a blow, as a simulation or an edited record has them
        struck = [p for p in record.pulses if np.any((at >= record.place(p.begin)) & (at <= record.place(p.end)))]
        where = f"in {len(struck)} of {len(record.pulses)} blows" if struck else "outside the blows"
        message = (
            f"clipped at {record.text(level)} for {at.size * record.step * 1e6:.4g}\xa0us {where}: the true peak "
            "is larger"
        )
        severity, harms = ("bad", BLOW) if struck else ("suspect", ("ringing_frequency", "spectrum"))
        begin, end = record.time(int(at[0])), record.time(int(at[-1]))
        findings.append(HealthNotice("clipped", message, level, severity=severity, harms=harms, start=begin, end=end))
    return findings


def limited(record: Examined) -> list[HealthNotice]:
    """Find what a limit of sensor or amplifier did to blows: flat tops, and slopes that went no further.

    Both look at the sides of each blow, which are measured once.
    """
    pulses = [pulse for pulse in record.pulses if pulse.method == "record" and pulse.width > 0.0]
    flanks = [_flanks_of(record, pulse) for pulse in pulses]
    return [*_saturated(record, pulses, flanks), *_slew_limited(record, pulses, flanks)]


def _saturated(
    record: Examined, pulses: Sequence[RecordedPulse], flanks: Sequence[tuple[Flank, Flank]]
) -> list[HealthNotice]:
    """Find tops flatter than any that an elastic contact makes: an amplifier near its limit, or flat pulses.

    Which of them is not known from one record. What swings after a blow may have bent its top as well.
    """
    top = top_of(record, pulses)
    if top is not None and top.sharpness > top.usual + FLATTER + top.doubt:
        message = (
            f"the top is flat: {percent(top.sharpness, 0)} as wide at {percent(TIP, 0)} of the peak as at "
            f"{percent(UPPER, 0)} (an elastic pulse's {percent(top.usual, 0)}): sensor or amplifier may be near its "
            "limit; a pulse that is meant to be flat, or made by yielding, cannot be told from it"
        )
        higher = float(np.mean([_half_sine_of_flanks(record, pulse) for pulse in pulses])) - 1.0
        if higher > WRONG:
            message += f"; the half-sine of its flanks would be {percent(higher, 0)} higher"
        return [_of_range("flat-top", message, top.sharpness, pulses)]
    higher = min(map(functools.partial(_bent_off, record), pulses, flanks), default=0.0)
    if higher > 0.0:
        message = (
            f"a straight side, as that of a saw-tooth, would go on {percent(higher, 0)} above the peak, and bends "
            "before it: sensor or amplifier may be near its limit; a tip that is meant to be round cannot be told from "
            "it"
        )
        return [_of_range("flat-top", message, higher, pulses)]
    return []


def _slew_limited(
    record: Examined, pulses: Sequence[RecordedPulse], flanks: Sequence[tuple[Flank, Flank]]
) -> list[HealthNotice]:
    """Find an amplifier that is too slow for a blow, by a straight side or a corner.

    A side is straight where a pulse is curved, or the top is a corner where it is round: such an amplifier follows
    the rise in a straight line until that meets the fall. A saw-tooth, straight on both sides and much steeper on one,
    is meant to be so.
    """
    for pulse, both in zip(pulses, flanks, strict=True):
        other, steep = sorted(both)
        own_slope = other.slope < (1.0 - ALIKE) * steep.slope
        saw_tooth = other.bend < STRAIGHT and other.slope < SAW_TOOTH * steep.slope
        if not steep.bend < STRAIGHT or saw_tooth:
            continue
        sides = "one side is" if own_slope else "its sides are"
        message = (
            f"the blow at {pulse.time:.6g}\xa0s: {sides} straight over {percent(OVER, 0)} of the peak, at "
            f"{record.text(1e-6 * steep.slope)} per us, where a smooth pulse is curved: the amplifier may be too slow "
            "(slew rate), unless the pulse is meant to be straight; the true peak may be larger, the width smaller"
        )
        return [_of_range("slew-rate", message, steep.slope, [pulse])]
    even = [pulse for pulse in pulses if pulse.rigid is None and not goes_back(record, pulse)[0] > 0.0]
    top = top_of(record, even)  # ringing makes corners too
    if top is None or not top.sharpness < top.usual - CORNER - top.doubt:
        return []
    low, high = np.mean([sorted(_slope_halfway(record, pulse, side) for side in (-1, 1)) for pulse in even], axis=0)
    if not low > ONE_SLOPE * high:
        return []
    message = (
        f"the top is a corner: {percent(top.sharpness, 0)} as wide at {percent(TIP, 0)} of the peak as at "
        f"{percent(UPPER, 0)} (a smooth pulse's {percent(top.usual, 0)}): an amplifier that is too slow (slew rate) "
        "rises in a straight line until it meets the fall, unless the pulse is meant to be pointed; the true peak may "
        "be larger, the width smaller"
    )
    return [_of_range("slew-rate", message, float(high), even)]


def _of_range(code: str, message: str, value: float, pulses: Sequence[RecordedPulse]) -> HealthNotice:
    begin, end = pulses[0].begin, pulses[-1].end
    return HealthNotice(code, message, value, severity="suspect", harms=BLOW, start=begin, end=end)


class Top(NamedTuple):
    """How sharp the tops of some pulses are, in the mean, what smooth ones with their flanks are, and the doubt."""

    sharpness: float
    usual: float
    doubt: float


def top_of(record: Examined, pulses: Sequence[RecordedPulse]) -> Top | None:
    """Return how sharp the tops of the blows of a record are, all together; None where no shape is known.

    One amplifier takes all of them alike: what noise does is less in their mean, what rings is not.

    Examples
    --------
    >>> from strikewave.records.measuring import find_pulses
    >>> values = np.sin(np.pi * np.clip(np.arange(900.0) / 80.0 - 5.0, 0.0, 1.0))
    >>> top = top_of(Examined(values, 1e-6), find_pulses(values, 1e-6))
    >>> round(top.sharpness, 2), round(top.usual, 2), top.doubt < 0.01
    (0.43, 0.43, True)
    """
    tips = [(pulse, tip) for pulse in pulses if not math.isnan(tip := tip_of(record, pulse))]
    if not tips:
        return None
    noise = [_noise_of_top(record, pulse) / abs(pulse.peak) for pulse, _ in tips]
    swing = [_swing_to_both_sides(record, pulse) / abs(pulse.peak) for pulse, _ in tips]
    doubt = TIP_BY_PEAK * (SURE * math.sqrt(float(np.mean(np.square(noise))) / len(tips)) + float(np.mean(swing)))
    usual = [usual_tip(record, pulse) for pulse, _ in tips]
    return Top(float(np.mean([tip for _, tip in tips])), float(np.mean(usual)), doubt)


def _noise_of_top(record: Examined, pulse: RecordedPulse) -> float:
    """Return what noise of any colour does to the top of a pulse: one standard deviation."""
    white = pulse.noise * math.sqrt((BENDS + 1.0) * record.step / pulse.width)
    return max(white, 0.0 if math.isnan(pulse.baseline.ripple) else pulse.baseline.ripple)


def _slope_halfway(record: Examined, pulse: RecordedPulse, side: int) -> float:
    """Return the slope of one side of a pulse between a fourth and three fourths of its peak."""
    heights = _side_of(record, pulse, side)
    first, last = (int(np.max(np.flatnonzero(heights < share), initial=0)) + k for k, share in enumerate(HALFWAY))
    return abs(pulse.peak) * float(heights[last] - heights[first]) / (max(last - first, 1) * record.step)


def _bent_off(record: Examined, pulse: RecordedPulse, flanks: tuple[Flank, Flank]) -> float:
    """Return by how much a straight side of a pulse goes on above its peak, over the peak; 0 where that may be chance.

    A limit leaves the time of the peak as it is, and the lower part of a side.
    """
    straight = [flank for flank in flanks if flank.bend < STRAIGHT]
    if not straight:
        return 0.0
    flank = min(straight)
    rounded = SAMPLES_OF_TIP * flank.slope * record.step / abs(pulse.peak)
    doubt = SURE * _noise_of_top(record, pulse) / abs(pulse.peak)
    higher = flank.goes_on - 1.0
    return higher if higher > GOES_ON + rounded + doubt else 0.0


class Flank(NamedTuple):
    """A side of a pulse: its largest slope, and by how much it bends at least over `OVER` of the peak.

    ``goes_on``: how high the straight line through that goes on until the peak, over it.
    """

    slope: float
    bend: float
    goes_on: float = math.nan


def _flanks_of(record: Examined, pulse: RecordedPulse) -> tuple[Flank, Flank]:
    """Return the side before the peak of a pulse and the one after it."""
    swing = _amplitude_after(record, pulse)
    return flank_of(record, pulse, -1, swing), flank_of(record, pulse, 1, swing)


def flank_of(record: Examined, pulse: RecordedPulse, side: int, swing: float = 0.0) -> Flank:
    """Return the largest slope of one side of a pulse, and its bend, the doubt by noise and ringing added.

    The bend is that of parabola and cubic in the Legendre polynomials through the side, over the peak. ``swing`` is the
    amplitude of what rings after the pulse: it may straighten a side by as much.

    Examples
    --------
    >>> from strikewave.records.measuring import find_pulses
    >>> place = np.arange(900.0)
    >>> for heights in (np.sin(np.pi * np.clip(place / 80.0 - 5.0, 0.0, 1.0)) ** 2, 1.0 - np.abs(place / 40.0 - 11.0)):
    ...     values = np.maximum(heights, 0.0)
    ...     [pulse] = find_pulses(values, 1e-6)
    ...     print(round(flank_of(Examined(values, 1e-6), pulse, -1).bend, 2))
    0.02
    0.0
    """
    heights = _side_of(record, pulse, side)
    ripple = 0.0 if math.isnan(pulse.baseline.ripple) else pulse.baseline.ripple
    swing = max(ripple, swing)
    least, slope, goes_on = math.inf, float(np.max(np.diff(heights), initial=0.0)), math.nan
    for level in LEVELS:
        first = int(np.max(np.flatnonzero(heights < level), initial=0))
        last = int(np.max(np.flatnonzero(heights < level + OVER), initial=0)) + 1
        part = heights[first : last + 1]
        if part.size < FEWEST_OF_FLANK:
            continue
        bends = _legendre_cubic(part.size) @ part
        doubt = max(pulse.noise * math.sqrt(7.0 / part.size), swing) / abs(pulse.peak)
        if (bend := math.hypot(bends[2], bends[3]) + doubt) < least:
            least, slope = bend, 2.0 * float(bends[1]) / (part.size - 1)
            goes_on = float(bends[0]) + slope * (heights.size - 1 - first - 0.5 * (part.size - 1))
    return Flank(abs(pulse.peak) * slope / record.step, least, goes_on)


@functools.lru_cache(maxsize=256)
def _legendre_cubic(size: int) -> Array:
    """Return the matrix that makes the coefficients of the least-squares cubic of so many even samples.

    Examples
    --------
    >>> (_legendre_cubic(7) @ np.linspace(-1.0, 1.0, 7) ** 2).round(6) + 0.0  # x^2 = 1/3 P0 + 2/3 P2
    array([0.333333, 0.      , 0.666667, 0.      ])
    """
    return np.asarray(np.linalg.pinv(np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, size), 3)), dtype=float)


def tip_of(record: Examined, pulse: RecordedPulse) -> float:
    """Return the width of the tip of a pulse over that of its upper half, of a polynomial through it; NaN if too few.

    Examples
    --------
    >>> from strikewave.records.measuring import find_pulses
    >>> values = np.sin(np.pi * np.clip(np.arange(900.0) / 80.0 - 5.0, 0.0, 1.0))
    >>> [pulse] = find_pulses(values, 1e-6)
    >>> round(tip_of(Examined(values, 1e-6), pulse), 3), round(ROUNDEST, 3)
    (0.431, 0.431)
    """
    heights = _above_zero(record, pulse) / abs(pulse.peak)
    top = record.place(pulse.time) - record.place(pulse.begin)
    low = np.flatnonzero(heights < FROM * UPPER)
    left, right = low[low < top], low[low > top]
    if not (left.size and right.size) or right[0] - left[-1] < FEWEST_OF_TOP:
        return math.nan
    inside = heights[left[-1] : right[0] + 1]
    place = np.linspace(-1.0, 1.0, inside.size)
    bent = np.polynomial.Chebyshev.fit(place, inside, min(BENDS, inside.size - 3))(np.linspace(-1.0, 1.0, FINE))
    highest = float(np.max(bent))
    tip, upper = (int(np.count_nonzero(bent >= share * highest)) for share in (TIP, UPPER))
    return tip / upper


def usual_tip(record: Examined, pulse: RecordedPulse) -> float:
    """Return the width of the tip over that of the upper half that a power of a sine has with the flanks of a pulse.

    At least a half-sine: from it on, the longer the feet, the more pointed the tip.

    Examples
    --------
    >>> from strikewave.records.measuring import find_pulses
    >>> values = np.sin(np.pi * np.clip(np.arange(900.0) / 80.0 - 5.0, 0.0, 1.0)) ** 2
    >>> [pulse] = find_pulses(values, 1e-6)
    >>> round(tip_of(Examined(values, 1e-6), pulse), 2), round(usual_tip(Examined(values, 1e-6), pulse), 2)
    (0.41, 0.41)
    """
    heights = _above_zero(record, pulse) / abs(pulse.peak)
    top = record.place(pulse.time) - record.place(pulse.begin)
    ends = [[crossing(heights, top, share, side) for side in (-1, 1)] for share in (LOW, UPPER)]
    low, upper = (right - left for left, right in ends)
    powers = np.linspace(1.0, MOST_POINTED, FINE)
    tips, uppers, lows = (np.arccos(share ** (1.0 / powers)) for share in (TIP, UPPER, LOW))
    share = upper / low if low > 0.0 else math.nan
    if math.isnan(share):
        return ROUNDEST
    return float(np.interp(-share, -uppers / lows, tips / uppers))


def _half_sine_of_flanks(record: Examined, pulse: RecordedPulse) -> float:
    """Return the peak of the half-sine that is as wide as a pulse at two low heights, over that of the pulse."""
    heights = _above_zero(record, pulse) / abs(pulse.peak)
    low, high = (int(np.count_nonzero(heights >= share)) for share in (LOW, UPPER))
    peaks = np.linspace(1.0, HIGHEST, FINE)
    ratios = np.arccos(UPPER / peaks) / np.arccos(LOW / peaks)  # rise with the peak
    return float(np.interp(high / low, ratios, peaks))


def _swing_to_both_sides(record: Examined, pulse: RecordedPulse) -> float:
    """Return by how much a record swings to either side within two widths after a blow: a tail stays on one."""
    return max(_to_both_sides(_after(record, pulse)) - NOISE_SPANS * pulse.noise, 0.0)


def _amplitude_after(record: Examined, pulse: RecordedPulse) -> float:
    """Return the amplitude of what swings to both sides after a blow, the most that noise makes of it taken off."""
    after = _after(record, pulse)
    by_noise = record.scatter**2 * (1.0 + SURE * math.sqrt(2.0 / after.size))
    return min(max(_to_both_sides(after), 0.0), math.sqrt(2.0 * max(float(np.var(after)) - by_noise, 0.0)))


def _after(record: Examined, pulse: RecordedPulse) -> Array:
    """Return what a record is above the zero of a blow from its end on, as long as what bent its top swings on."""
    first, last = record.place(pulse.end), record.place(pulse.end + SWINGS_WITHIN * pulse.width)
    return np.asarray(record.values[first : last + 1] - pulse.offset)


def _to_both_sides(values: Array) -> float:
    """Return by how much values reach to either side of zero; below zero where they stay on one."""
    return min(float(np.max(values)), -float(np.min(values)))


def _side_of(record: Examined, pulse: RecordedPulse, side: int) -> Array:
    """Return one side of a pulse from its foot up to its peak, over the peak."""
    heights = _above_zero(record, pulse) / abs(pulse.peak)
    top = record.place(pulse.time) - record.place(pulse.begin)
    return np.asarray(heights[top:][::-1] if side > 0 else heights[: top + 1])


def _above_zero(record: Examined, pulse: RecordedPulse) -> Array:
    """Return what a blow is above its zero, from foot to foot, positive."""
    part = record.values[record.place(pulse.begin) : record.place(pulse.end) + 1]
    return np.asarray(math.copysign(1.0, pulse.peak) * (part - pulse.offset))


def rail(values: Array, zero: float) -> NDArray[np.intp]:
    """Return the samples at the largest value where a recorder stopped there; none where the record turned there.

    A round top at k steps of the converter has about 1 : 0.7 samples in its highest and the next two; a rail has
    three times as many at it as beside it, and at least three.
    """
    level, none = float(np.max(values)), np.empty(0, dtype=np.intp)
    span = level - float(np.min(values))
    at = np.flatnonzero(values == level)
    if at.size < FEWEST_AT_RAIL or np.unique(values[:: max(values.size // LEVELS_LOOKED_AT, 1)]).size < 3:
        return none
    near = values[values >= level - NEAR_TOP * span]
    steps = np.diff(np.unique(near))
    resolution = float(np.min(steps)) if steps.size else NEAR_TOP * span
    if level - zero <= max(3.0 * resolution, OFF_ZERO * span):
        return none
    beside = int(np.count_nonzero(near >= level - BESIDE_RAIL * resolution)) - at.size
    if at.size < FEWEST_AT_RAIL * max(beside, 1):
        return none
    return at if _cut_off(values, level) > resolution else none


def _cut_off(values: Array, level: float) -> float:
    """Return how far the parabola through both sides of the longest run at a level goes above it.

    A round top turns within a step of its converter. Infinite where a side is missing, or the run is long.
    """
    first, last = _longest_run(values == level)
    if last - first + 1 > SHORT_RUN or first < BESIDE or last + BESIDE >= values.size:
        return math.inf
    beside = np.concatenate([np.arange(first - BESIDE, first), np.arange(last + 1, last + 1 + BESIDE)])
    place = beside - 0.5 * (first + last)
    return float(np.polynomial.polynomial.polyfit(place, values[beside], 2)[0]) - level


def _longest_run(flags: NDArray[np.bool_]) -> tuple[int, int]:
    """Return first and last place of the longest run of true; (0, -1) where there is none."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    if not edges.size:
        return 0, -1
    k = int(np.argmax(edges[1::2] - edges[::2]))
    return int(edges[2 * k]), int(edges[2 * k + 1]) - 1
