"""The limits of sensor, amplifier and recorder: range, flat tops, slopes, steps of the converter, sampling rate."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base.texts import percent
from strikewave.records.health.disturbances import goes_back
from strikewave.records.health.sampled_record import Array, BlowRecord, ResponseRecord
from strikewave.records.health_notice import BLOW, Fault
from strikewave.records.measuring import RecordedPulse
from strikewave.records.response import FEWEST
from strikewave.records.thresholds import HARMED, OfAnswers, OfNoise, OfRange, OfResponses, OfSampling, OfSwings, OfTops
from strikewave.signal.pulse import HALF_SINE_WIDTH, crossing

# Degree of the polynomial through the upper half of a pulse: it follows every smooth one to 0.1 % of its peak
BENDS = 6
UPPER, TIP = 0.5, 0.9  # shares of the peak at which the widths of the upper half and of the tip are taken
# Width of the tip over that of the upper half of a half-sine, 0.431. A linear spring makes a half-sine. Contacts, felt
# and foam stiffen as they are pressed, and make more pointed pulses; only what yields, is made to be flat, or is
# compressed by an amplifier has a flatter top.
ROUNDEST = (0.5 * math.pi - math.asin(TIP)) / (0.5 * math.pi - math.asin(UPPER))
HALFWAY = np.array([0.25, 0.75])  # shares of the peak between which the slopes of sides are compared
# Share of the upper half's height from which on samples enter its polynomial; places at which that is looked at
FROM, FINE = 0.8, 2001
# Share of the peak below which a foot is the contact's; largest peak of the flanks over that seen
LOW, HIGHEST = 0.2, 3.0
# Shares of the peak at which the part of a side begins that is looked at, over `OfTops.OVER`
LEVELS = np.array([0.02, 0.06, 0.1, 0.14, 0.18, 0.22])


class Flank(NamedTuple):
    """A side of a pulse: its largest slope, and by how much it bends at least over `OfTops.OVER` of the peak.

    ``goes_on``: how high the straight line through that goes on until the peak, over it.
    """

    slope: float
    bend: float
    goes_on: float = math.nan


@dataclass(frozen=True, eq=False)
class BlowShape:
    """A blow in its record; each figure of its shape is measured once, when it is asked for."""

    record: BlowRecord
    pulse: RecordedPulse

    @cached_property
    def heights(self) -> Array:
        """Height of the blow above its zero, from foot to foot, over its peak."""
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
        """Standard deviation of the top by noise of any colour, over the peak."""
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
        """Swing of the record to both sides within two widths after the blow, over the peak: no tail does that."""
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


# Samples in which at least three different values stand, or the record is a switch or a count, and has no rail
LEVELS_LOOKED_AT = 4096
BESIDE = 3  # samples to either side of a run at a rail through which a parabola is laid
LAG = 16  # parts of a swing over which its slope is taken: it then still is 97 % of the true one


def clipped(record: BlowRecord) -> Iterator[Fault]:
    """Find where the record stops at one value again and again: the recorder's range ended there.

    A plateau of a rounded top in a coarse recorder is no clipping: there the steps beside it are long too. Neither is
    the quiet zero of a record that goes to one side of it only.
    """
    pulse = record.largest
    for at in _rails(record.values, float(np.median(record.values)) if pulse is None else pulse.offset):
        level = float(record.values[at[0]])
        if level == 0.0 and 0.0 in (record.values[0], record.values[-1]):
            continue  # zeros before or after a blow, as a simulation or an edited record has them
        struck = [p for p in record.pulses if np.any((at >= record.place(p.begin)) & (at <= record.place(p.end)))]
        where = f"in {len(struck)} of {len(record.pulses)} blows" if struck else "outside the blows"
        details = {"lasting": at.size * record.step * 1e6, "where": where}
        severity, harms = ("", BLOW) if struck else ("suspect", ("ringing_frequency", "spectrum"))
        yield Fault(level, details, severity, harms, record.time(int(at[0])), record.time(int(at[-1])))


def clipped_response(record: ResponseRecord) -> Iterator[Fault]:
    """Find where a response stops at one value again and again."""
    for at in _rails(record.values, record.largest.zero):
        begin, end = (record.time(int(k)) for k in (at[0], at[-1]))
        yield Fault(float(record.values[at[0]]), {"lasting": at.size * record.step * 1e6}, start=begin, end=end)


def _rails(values: Array, zero: float) -> Iterator[NDArray[np.intp]]:
    """Yield the samples at which a recorder stopped above a zero, and below it."""
    for sign in (1.0, -1.0):
        at = rail(sign * values, sign * zero)
        if at.size:
            yield at


def rail(values: Array, zero: float) -> NDArray[np.intp]:
    """Return the samples at the largest value where a recorder stopped there; none where the record turned there.

    A round top at k steps of the converter has about 1 : 0.7 samples in its highest and the next two; a rail has
    three times as many at it as beside it, and at least three.
    """
    level, none = float(np.max(values)), np.empty(0, dtype=np.intp)
    span = level - float(np.min(values))
    at = np.flatnonzero(values == level)
    if at.size < OfRange.FEWEST_AT_RAIL or np.unique(values[:: max(values.size // LEVELS_LOOKED_AT, 1)]).size < 3:
        return none
    near = values[values >= level - OfRange.NEAR_TOP * span]
    steps = np.diff(np.unique(near))
    resolution = float(np.min(steps)) if steps.size else OfRange.NEAR_TOP * span
    if level - zero <= max(3.0 * resolution, OfRange.OFF_ZERO * span):
        return none
    beside = int(np.count_nonzero(near >= level - OfRange.BESIDE_RAIL * resolution)) - at.size
    if at.size < OfRange.FEWEST_AT_RAIL * max(beside, 1):
        return none
    return at if _cut_off(values, level) > resolution else none


def _cut_off(values: Array, level: float) -> float:
    """Return how far the parabola through both sides of the longest run at a level goes above it.

    A round top turns within a step of its converter. Infinite where a side is missing, or the run is long.
    """
    first, last = _longest_run(values == level)
    if last - first + 1 > OfRange.SHORT_RUN or first < BESIDE or last + BESIDE >= values.size:
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


def _shapes(record: BlowRecord) -> list[BlowShape]:
    return [BlowShape(record, pulse) for pulse in record.pulses if pulse.method == "record" and pulse.width > 0.0]


def _of_shapes(value: float, shapes: Sequence[BlowShape], **details: object) -> Fault:
    return Fault(value, details, start=shapes[0].pulse.begin, end=shapes[-1].pulse.end)


def flat_top(record: BlowRecord) -> Iterator[Fault]:
    """Find tops flatter than any that an elastic contact makes: an amplifier near its limit, or flat pulses.

    Which of them is not known from one record. What swings after a blow may have bent its top as well.
    """
    shapes = record.once(_shapes)
    top = record.once(_flat_top)
    if top is not None:
        higher = float(np.mean([shape.half_sine_of_flanks for shape in shapes])) - 1.0
        flanks = f"; the half-sine of its flanks would be {percent(higher, 0)} higher" if higher > OfTops.WRONG else ""
        yield _of_shapes(top.sharpness, shapes, tip=TIP, upper=UPPER, usual=top.usual, flanks=flanks)


def _flat_top(record: BlowRecord) -> Top | None:
    top = top_of(record.once(_shapes))
    return top if top is not None and top.sharpness > top.usual + OfTops.FLATTER + top.doubt else None


def bent_tip(record: BlowRecord) -> Iterator[Fault]:
    """Find straight sides that bend before their tip, in all blows."""
    shapes = record.once(_shapes)
    if record.once(_flat_top) is None:
        higher = min(map(_bent_off, shapes), default=0.0)
        if higher > 0.0:
            yield _of_shapes(higher, shapes)


def _straight_side(record: BlowRecord) -> Fault | None:
    """Return a side that is straight where a pulse is curved, of the first blow that has one.

    An amplifier that is too slow follows the rise in a straight line until that meets the fall. A saw-tooth, straight
    on both sides and much steeper on one, is meant to be so.
    """
    for shape in record.once(_shapes):
        other, steep = sorted(shape.flanks)
        own_slope = other.slope < (1.0 - OfTops.ALIKE) * steep.slope
        saw_tooth = other.bend < OfTops.STRAIGHT and other.slope < OfTops.SAW_TOOTH * steep.slope
        if steep.bend < OfTops.STRAIGHT and not saw_tooth:
            details = {"time": shape.pulse.time, "over": OfTops.OVER, "slope": 1e-6 * steep.slope}
            sides = "one side is" if own_slope else "its sides are"
            return _of_shapes(steep.slope, [shape], sides=sides, **details)
    return None


def straight_side(record: BlowRecord) -> Iterator[Fault]:
    """Find an amplifier that is too slow for a blow, by a straight side."""
    fault = record.once(_straight_side)
    if fault is not None:
        yield fault


def corner(record: BlowRecord) -> Iterator[Fault]:
    """Find an amplifier that is too slow for the blows, by a top that is a corner where it is round."""
    if record.once(_straight_side) is not None:
        return
    shapes = record.once(_shapes)
    even = [shape for shape in shapes if shape.pulse.rigid is None and not goes_back(record, shape.pulse)[0] > 0.0]
    top = top_of(even)  # ringing makes corners too
    if top is None or not top.sharpness < top.usual - OfTops.CORNER - top.doubt:
        return
    low, high = np.mean([sorted(shape.slope_halfway(side) for side in (-1, 1)) for shape in even], axis=0)
    if low > OfTops.ONE_SLOPE * high:
        yield _of_shapes(float(high), even, sharpness=top.sharpness, tip=TIP, upper=UPPER, usual=top.usual)


class Top(NamedTuple):
    """Mean sharpness of the tops of some pulses, that of smooth ones with their flanks, and the doubt."""

    sharpness: float
    usual: float
    doubt: float


def top_of(shapes: Sequence[BlowShape]) -> Top | None:
    """Return how sharp the tops of some blows of a record are, all together; None where no shape is known.

    One amplifier takes all of them alike: what noise does is less in their mean, what rings is not.
    """
    known = [shape for shape in shapes if not math.isnan(shape.tip)]
    if not known:
        return None
    noise = math.sqrt(float(np.mean(np.square([shape.noise_of_top for shape in known]))) / len(known))
    swing = float(np.mean([shape.swing_to_both_sides for shape in known]))
    sharpness, usual = np.mean([(shape.tip, shape.usual_tip) for shape in known], axis=0)
    return Top(float(sharpness), float(usual), OfTops.TIP_BY_PEAK * (OfTops.SURE * noise + swing))


def _bent_off(shape: BlowShape) -> float:
    """Return by how much a straight side of a blow goes on above its peak, over the peak; 0 where that may be chance.

    A limit leaves the time of the peak as it is, and the lower part of a side.
    """
    straight = [flank for flank in shape.flanks if flank.bend < OfTops.STRAIGHT]
    if not straight:
        return 0.0
    flank = min(straight)
    rounded = OfTops.SAMPLES_OF_TIP * flank.slope * shape.record.step / abs(shape.pulse.peak)
    higher = flank.goes_on - 1.0
    return higher if higher > OfTops.GOES_ON + rounded + OfTops.SURE * shape.noise_of_top else 0.0


def saturated(record: ResponseRecord) -> Iterator[Fault]:
    """Find tops flatter than those of swings: an amplifier at its limit."""
    begin, end = record.span(record.largest)
    flat = _flat(record.above[begin:end], record.noise + 0.5 * record.resolution)
    if flat is not None:
        yield Fault(flat[0], {"usual": flat[1]}, start=record.largest.time)


def compressed(record: ResponseRecord) -> Iterator[Fault]:
    """Find tops that are lower than the modes, driven by the base, would make them: a limit that is soft.

    Fitted are the base and the absolute accelerations of the modes on it to the samples below `OfSwings.LOWER` of the
    peak, so that only the level is carried on. What they miss of these is the doubt.
    """
    response = record.largest
    begin, end = record.span(response)
    end = min(end, record.place(response.decay.end) + 1)
    through = record.driven(end)
    if through is None:
        return
    values, peak = record.above[begin:end], abs(response.peak)
    low = np.abs(values) < OfSwings.LOWER * peak
    if np.count_nonzero(~low) < OfSwings.FEWEST_OF_TOPS or np.count_nonzero(low) < FEWEST:
        return
    columns = through[begin:end]
    shares = np.linalg.lstsq(columns[low], values[low], rcond=None)[0]
    model = columns @ shares
    missed = math.sqrt(float(np.mean((model - values)[low] ** 2))) / peak
    lost = 1.0 - peak / float(np.max(np.abs(model)))
    all_missed = columns @ np.linalg.lstsq(columns, values, rcond=None)[0] - values
    worse = math.sqrt(float(np.mean(all_missed**2))) / peak
    if lost > max(OfNoise.NOTED, OfSwings.MISSES * missed) and worse > OfSwings.WORSE * missed:
        effects = {**record.moved_by(lost * peak), "peak": -lost}
        yield Fault(lost, start=response.time, effects=effects, harms=record.figures if lost > HARMED else ())


def slew_limited(record: ResponseRecord) -> Iterator[Fault]:
    """Find slopes that stay at one value where those of swings turn: the amplifier could not follow."""
    begin, end = record.span(record.largest)
    lag = max(round(record.period / LAG / record.step), 1)
    part = record.above[begin:end]
    if part.size > 4 * lag:
        flat = _flat(part[lag:] - part[:-lag], math.sqrt(2.0) * (record.noise + 0.5 * record.resolution))
        if flat is not None:
            yield Fault(flat[0], {"usual": flat[1]}, start=record.largest.begin)


def _flat(values: Array, noise: float) -> tuple[float, float] | None:
    """Return for how much of a half swing the highest tops are flat, and a sine's; None if no flatter."""
    edges = np.flatnonzero(np.diff(np.signbit(values))) + 1
    tops = []
    for part in np.split(np.abs(values), edges):
        height = float(np.max(part))
        if not height > 0.0 or part.size < 4:
            continue
        depth = min(OfSwings.TOP + OfSwings.NOISES_OF_TOP * noise / height, OfSwings.DEEPEST_TOP)
        high = np.flatnonzero(part >= (1.0 - depth) * height)
        share = float(high[-1] - high[0] + 1) / part.size
        tops.append((height, share, 1.0 - 2.0 / math.pi * math.asin(1.0 - depth)))
    tops = sorted((top for top in tops if top[0] > OfSwings.HIGH * max(tops)[0]), reverse=True)
    if not tops:
        return None
    near = OfSwings.SAME_LEVEL * tops[0][0] + OfSwings.NOISES_OF_TOP * noise
    alike = [top for top in tops if tops[0][0] - top[0] < near]
    share, usual = (float(np.median([top[k] for top in alike])) for k in (1, 2))
    return (share, usual) if share - usual > (OfSwings.FLATTER if len(alike) > 1 else OfSwings.FLAT_ALONE) else None


def coarse(record: ResponseRecord) -> Iterator[Fault]:
    """Find a converter whose steps are large beside the response."""
    reach = 0.5 * record.resolution
    if not reach < OfRange.COARSE * record.peak:
        share = record.resolution / record.peak
        yield Fault(record.resolution, {"share": share}, effects=record.moved_by(reach), signed=False)


def spike(record: ResponseRecord) -> Iterator[Fault]:
    """Find a peak of one sample that its neighbours know nothing of."""
    for response in record.responses:
        top = record.place(response.time)
        if not 2 <= top < record.values.size - 2:
            continue
        before_last, before, value, after, after_next = record.above[top - 2 : top + 3].tolist()
        off = abs(value - (4.0 * (before + after) - (before_last + after_next)) / 6.0)
        if off > max(OfRange.SPIKE * abs(value), OfResponses.STANDS_OUT * record.noise):
            yield Fault(value, {"time": response.time}, start=response.time)
            return


FEWEST_AROUND = 64  # samples to either side of the largest blow, at least, whose spectrum is looked at


def few_samples(record: BlowRecord) -> Iterator[Fault]:
    """Find blows of few samples: a half-sine that lasts n of them may lose 1 - cos(pi / (2 n)) of its peak."""
    widths = [pulse.width for pulse in record.pulses if pulse.width > 0.0]
    count = min(widths, default=math.inf) / HALF_SINE_WIDTH / record.step
    if count < OfSampling.FEW:
        loss = 1.0 - math.cos(math.pi / (2.0 * max(count, 1.0)))
        too_few = count < OfSampling.TOO_FEW
        severity = "bad" if count < OfSampling.NONE_LEFT else "suspect" if too_few else "good"
        yield Fault(count, {"loss": loss}, severity, ("peak", "rise", "width") if too_few else ())


def few_samples_of_swing(record: ResponseRecord) -> Iterator[Fault]:
    """Find swings of few samples: between two of them the peak is missed."""
    modes = [(mode, response) for response in record.responses for mode in response.modes]
    large = [mode.frequency for mode, r in modes if mode.amplitude > OfSampling.COUNTS * abs(r.peak)]
    count = 1.0 / (max(large) * record.step) if large else math.inf
    if count < OfSampling.FEW_OF_SWING:
        effects = {**record.moved_by(_missed(count) * record.peak), "peak": -_missed(count)}
        yield Fault(count, {"frequency": 1.0 / (count * record.step)}, effects=effects)


def _missed(count: float) -> float:
    """Return by how much the top of a sine of so many samples a swing may be missed."""
    beside, far = math.cos(math.pi / count), math.cos(3.0 * math.pi / count)
    if far < OfAnswers.ROUND * beside and count < OfSampling.TOO_FEW_OF_SWING:
        return 1.0 - beside
    return 1.0 - beside - 0.125 * (beside - far)


def aliased(record: BlowRecord) -> Iterator[Fault]:
    """Find a spectrum that has not fallen off at half the sampling rate: what lies above is folded into it."""
    pulse = record.largest
    if pulse is None or not pulse.width > 0.0:
        return
    reach = max(round(OfSampling.AROUND * pulse.width / record.step), FEWEST_AROUND)
    centre = record.place(pulse.time)
    part = record.values[max(centre - reach, 0) : centre + reach] - pulse.offset
    level = folded_level(part, pulse.noise)
    if level is not None:
        yield Fault(level, harms=("width", "velocity_change") if OfSampling.OF_AREA * level > HARMED else ())


def aliased_response(record: ResponseRecord) -> Iterator[Fault]:
    """Find a spectrum of a response that has not fallen off at half the sampling rate."""
    begin, end = record.span(record.largest)
    last = min(max(record.place(record.largest.decay.end), begin + 2 * FEWEST), end)
    first = max(begin - (last - begin), 0)  # a window of its own length before it: the onset is in its middle
    level = folded_level(record.above[first:last], record.noise)
    if level is not None:
        yield Fault(level)


def folded_level(part: Array, noise: float) -> float | None:
    """Return the level at half the sampling rate over the largest of a spectrum; None where that has fallen off."""
    spectrum = np.abs(np.fft.rfft(part * np.hanning(part.size)))
    top = spectrum[int(OfSampling.TOP_OF_SPECTRUM * spectrum.size) :]
    highest = float(np.max(spectrum))
    if not highest > 0.0:
        return None
    level = math.sqrt(float(np.mean(top**2))) / highest
    heard = noise * math.sqrt(0.375 * part.size) / highest  # a Hann window has the mean square 3/8
    return None if level < OfSampling.FOLDED or level < OfSampling.NOISES * heard else level
