"""The contacts of a record, found without thresholds set by hand: blows, their trains, rebounds and double hits.

A blow is a one-sided excursion. Boxes of all widths slide over the record; the mean r of a box of w
samples stands out where it exceeds what noise alone would give anywhere in the record once in a hundred
records; the noise of each width is measured from the record itself. The box that holds the largest energy
w r^2 gives sign and scale; the others must be of its sign and scale (a third to three times its width), have at
least a fifth of its area, and stand out from what swings around them, so that ringing is no blow.

A train is known from the record itself: of all chains of contacts whose gaps are one period, or a few, the
one that holds most of the peaks. A contact on it is a blow, however small. One off it belongs to the blow before it: a
rebound where it is smaller or comes always as late, the second of a double hit where it is as large. Without a train a
contact is a rebound where it is smaller and near.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from strikewave.records._pulse_kernels import best_chains, strongest_boxes
from strikewave.records.record import Array
from strikewave.records.thresholds import OfBoxes, OfTrains

# Standard deviation of normal noise over the median of its size, 1 / Phi^-1(3/4): a median ignores the blows
MAD_TO_SIGMA = 1.4826
TRIALS = 40  # independent chances that noise has for each box side by side, found with pure noise
HUMP_OF_BOX = 16  # parts of a box with two hits over which it is averaged: a fifth of either hit or less
LINE_BLOCKS = 64  # blocks of the baseline's medians: blows fill under half of them, and 4032 pairs cost nothing
LINE_SAMPLES = 4096  # samples of a block whose median is taken: it is then known to 2 % of the noise, in bounded time
NOISE_SAMPLES = 2**20  # differences of neighbours of which the noise is taken: more would not change it by a thousandth
MEAN_SAMPLES = 2**17  # samples whose means over boxes give the noise of a width: bounds the time of long records
ROUNDING = 1e-12  # share of the largest mean below which a box is rounding, where a record has no noise at all


class Baseline(NamedTuple):
    """A straight baseline: value at the first sample, and rise a sample."""

    level: float
    slope: float

    def at(self, place: Any) -> Any:
        """Return the value at a sample, or at several."""
        return self.level + self.slope * place


class Box(NamedTuple):
    """The samples from ``first`` on, ``width`` of them, whose mean stands out."""

    first: int
    width: int
    mean: float

    @property
    def last(self) -> int:
        """One past the last sample."""
        return self.first + self.width

    @property
    def area(self) -> float:
        """Sum of its samples."""
        return self.width * self.mean


class BoxGrid:
    """Boxes by the place where they begin: those near another are found in the same time, however many there are."""

    def __init__(self, widest: int) -> None:
        self.widest = widest
        self._cells: dict[int, list[Box]] = {}

    def add(self, box: Box) -> None:
        """Take in a box."""
        self._cells.setdefault(box.first // self.widest, []).append(box)

    def near(self, box: Box, reach: float) -> Iterator[Box]:
        """Yield the boxes no more than ``reach`` samples from another one, and the few others of the same cells."""
        first = math.floor(box.first - reach) - self.widest
        last = math.ceil(box.last + reach)
        for cell in range(first // self.widest, last // self.widest + 1):
            yield from self._cells.get(cell, ())


def robust_line(values: Array, blocks: int = LINE_BLOCKS) -> Baseline:
    """Fit a line that blows do not bend: repeated medians over the medians of equal blocks.

    Half of the blocks may hold anything.

    Source: A. F. Siegel, Robust regression using repeated medians, Biometrika 69 (1982) 242-244.
    """
    size = max(values.size // blocks, 1)
    count = values.size // size
    stride = max(size // LINE_SAMPLES, 1)
    middles = np.median(values[: count * size].reshape(count, size)[:, ::stride], axis=1)
    places = np.arange(count) * size + 0.5 * (size - 1)
    if count < 3:
        return Baseline(float(np.median(middles)), 0.0)
    run = places[:, None] - places
    np.fill_diagonal(run, 1.0)
    slopes = (middles[:, None] - middles) / run
    others = ~np.eye(count, dtype=bool)
    slope = float(np.median(np.median(slopes[others].reshape(count, count - 1), axis=1)))
    return Baseline(float(np.median(middles - slope * places)), slope)


def sample_noise(values: Array) -> float:
    """Return the standard deviation of white noise in a record, from the differences between its samples.

    Where most samples equal the next, the rounding of the recorder, a step over sqrt(12).
    """
    step = max(values.size // NOISE_SAMPLES, 1)
    jumps = np.abs(values[1::step] - values[:-1:step][: values[1::step].size])
    noise = MAD_TO_SIGMA / math.sqrt(2.0) * float(np.median(jumps)) if jumps.size else 0.0
    steps = jumps[jumps > 0.0]
    return noise if noise > 0.0 or not steps.size else float(np.min(steps)) / math.sqrt(12.0)


def find_boxes(values: Array, line: Baseline, single: float) -> tuple[int, list[Box], list[Box]]:
    """Return the sign of the contacts of a record, and boxes of the large and of the small ones, in the order of time.

    A small one has less than a fifth of the largest area, and more than a twentieth.

    ``single`` is the standard deviation of the noise of a sample.
    """
    boxes_by_sign = {sign: _standing_out(values, line, sign) for sign in (1, -1)}
    best = {sign: max(boxes, key=_energy, default=None) for sign, boxes in boxes_by_sign.items()}
    chosen = max(best, key=lambda sign: _energy(best[sign]))
    top = best[chosen]
    if top is None:
        return 1, [], []
    narrowest, widest = top.width / OfBoxes.SCALES, top.width * OfBoxes.SCALES
    alike = [box for box in boxes_by_sign[chosen] if narrowest <= box.width <= widest]
    alike.sort(key=_energy, reverse=True)
    large: list[Box] = []
    small: list[Box] = []
    claimed, standing = BoxGrid(math.ceil(widest)), BoxGrid(math.ceil(widest))
    for boxes, least, most in (
        (large, OfBoxes.SMALLEST_AREA, math.inf),
        (small, OfBoxes.SMALLEST_CONTACT, OfBoxes.SMALLEST_AREA),
    ):
        for box in alike:
            if not least <= box.area / top.area < most or _touches(box, claimed):
                continue
            claimed.add(box)
            if box.first >= 0.5 * box.width and not _swings(values, line, chosen, box, standing, single):
                boxes.append(box)
                standing.add(box)
    parts = sorted(part for box in large for part in _hits_of(values, line, chosen, box, single))
    hits = _without_lobes(values, line, chosen, parts, single)
    beside = BoxGrid(max((hit.width for hit in hits), default=1))
    for hit in hits:
        beside.add(hit)
    return chosen, hits, sorted(box for box in small if _rises_again(values, line, chosen, box, beside))


def _hits_of(values: Array, line: Baseline, sign: int, box: Box, single: float) -> list[Box]:
    """Return the two hits that a box covers, a box each, or the box itself.

    Two hits leave a valley that comes near the baseline and does not fall below it, and nothing like them comes as long
    before and after: a contact pushes only and comes alone, ringing swings to both sides and goes on.
    """
    begin, end = max(box.first - box.width, 0), min(box.last + box.width, values.size)
    if box.width < OfBoxes.FEWEST_OF_HITS:
        return [box]
    across = max(box.width // HUMP_OF_BOX, 1)
    raw = sign * (values[begin:end] - line.at(np.arange(begin, end)))
    part = np.convolve(raw, np.full(across, 1.0 / across), mode="same")
    inside = slice(box.first - begin - box.width // 4, box.last - begin + box.width // 4)
    top = inside.start + int(np.argmax(part[inside]))
    humps = [_second_hump(part, inside, top, side) for side in (1, -1)]
    place, valley = max(humps, key=lambda hump: part[hump[0]] - part[hump[1]])
    height, depth = float(part[place]), float(part[valley])
    noise = OfBoxes.SURE * single / math.sqrt(across)
    if height < OfBoxes.HUMP * part[top] or depth > OfBoxes.VALLEY * height + noise or noise > OfBoxes.VALLEY * height:
        return [box]
    if _goes_on(part, min(place, top), max(place, top), height, noise):
        return [box]
    hits = sorted(_hump_box(part, raw, at, valley) for at in (place, top))
    if max(hit.width for hit in hits) > OfBoxes.SCALES * min(hit.width for hit in hits):
        return [box]
    return [Box(hit.first + begin, hit.width, hit.mean) for hit in hits]


def _goes_on(part: Array, low: int, high: int, height: float, noise: float) -> bool:
    """Tell whether two humps are lobes of one ringing: it swings to both sides, or goes on as far apart."""
    apart = high - low
    around = part[max(low - apart, 0) : high + 2 * apart]
    before, after = low - apart // 2, high + apart // 2
    beside = np.concatenate([part[max(before - apart, 0) : max(before, 0)], part[after : after + apart]])
    deep = -float(np.min(around)) > OfBoxes.OTHER_SIDE * height + noise
    return deep or float(np.max(beside, initial=0.0)) > OfBoxes.OTHER_LOBE * height + noise


def _without_lobes(values: Array, line: Baseline, sign: int, boxes: Sequence[Box], single: float) -> list[Box]:
    """Return boxes without those that are a lobe of one ringing with a higher one beside them."""
    left: list[Box] = []
    for box in boxes:
        if left and box.first - left[-1].last < OfBoxes.LOBES * max(box.width, left[-1].width):
            begin, end = max(2 * left[-1].first - box.last, 0), 3 * box.last - 2 * left[-1].first
            part = sign * (values[begin:end] - line.at(np.arange(begin, min(end, values.size))))
            low, high = (b.first + b.width // 2 - begin for b in (left[-1], box))
            height = min(left[-1].mean, box.mean)
            noise = OfBoxes.SURE * single
            if _goes_on(part, low, high, height, noise):
                left[-1] = max(left[-1], box, key=lambda b: b.mean)
                continue
        left.append(box)
    return left


def _rises_again(values: Array, line: Baseline, sign: int, box: Box, others: BoxGrid) -> bool:
    """Tell whether a small box stands over what lies between it and the hits beside it, so that it is no tail."""
    for other in others.near(box, OfBoxes.TAIL_WIDTHS * others.widest):
        begin, end = (other.last, box.first) if other.first < box.first else (box.last, other.first)
        if end - begin < OfBoxes.TAIL_WIDTHS * other.width:
            between = sign * (values[begin:end] - line.at(np.arange(begin, end)))
            if not between.size or float(np.min(between)) > 0.5 * box.mean:
                return False
    return True


def _second_hump(part: Array, inside: slice, top: int, side: int) -> tuple[int, int]:
    """Return the place that stands highest over the lowest one between it and the top, and that one."""
    beside = part[top : inside.stop] if side > 0 else part[inside.start : top + 1][::-1]
    lowest = np.minimum.accumulate(beside)
    place = int(np.argmax(beside - lowest))
    valley = int(np.argmin(beside[: place + 1]))
    return top + side * place, top + side * valley


def _hump_box(part: Array, raw: Array, top: int, valley: int) -> Box:
    """Return the samples around a hump that are above half of it, on its side of the valley."""
    below = np.flatnonzero(part < 0.5 * part[top])
    left, right = below[below < top], below[below > top]
    first = max(int(left[-1]) + 1 if left.size else 0, valley + 1 if valley < top else 0)
    last = min(int(right[0]) if right.size else part.size, valley if valley > top else part.size)
    width = max(last - first, 1)
    return Box(first, width, float(np.mean(raw[first : first + width])))


def _touches(box: Box, others: BoxGrid) -> bool:
    near = others.near(box, OfBoxes.APART * others.widest)
    return any(
        box.first < o.last + OfBoxes.APART * o.width and o.first - OfBoxes.APART * o.width < box.last for o in near
    )


def _energy(box: Box | None) -> float:
    return -1.0 if box is None else box.width * box.mean**2


def _standing_out(values: Array, line: Baseline, sign: int) -> list[Box]:
    boxes: list[Box] = []
    spread, before = 0.0, 1
    for width in _widths(values.size):
        means = _box_means(values, line, width)
        spread = max(MAD_TO_SIGMA * float(np.median(np.abs(means))), spread * math.sqrt(before / width))
        before = width
        least = max(spread * _threshold(values.size / width), ROUNDING * float(np.abs(means).max()))
        room = np.empty((values.size // width + 2, 2))
        count = strongest_boxes(values, line.level, line.slope, width, sign, least, room)
        boxes += [Box(int(first), width, float(mean)) for first, mean in room[:count]]
    return boxes


def _widths(size: int) -> list[int]:
    """Return widths from `OfBoxes.NARROWEST` samples to a third of the record, half an octave apart."""
    last = max(size // 3, OfBoxes.NARROWEST)
    octaves = math.log2(last / OfBoxes.NARROWEST)
    return sorted({round(OfBoxes.NARROWEST * math.sqrt(2.0) ** k) for k in range(1 + int(2.0 * octaves))})


def _box_means(values: Array, line: Baseline, width: int) -> Array:
    """Return means of boxes side by side, at most about 2^17 samples of them, without the baseline."""
    count = values.size // width
    step = max(count * width // MEAN_SAMPLES, 1)
    firsts = np.arange(0, count, step)
    means = values[: count * width].reshape(count, width)[firsts].mean(axis=1)
    return means - line.at(firsts * width + 0.5 * (width - 1))


def _threshold(places: float) -> float:
    """Return how many standard deviations noise exceeds at one of so many places in `OfBoxes.FALSE_ALARM` of records.

    A box that slides, over all widths and both signs, has about `TRIALS` independent chances a place.
    """
    from scipy.special import ndtri

    return float(-ndtri(OfBoxes.FALSE_ALARM / (TRIALS * max(places, 1.0))))


def _swings(values: Array, line: Baseline, sign: int, box: Box, others: BoxGrid, single: float) -> bool:
    """Tell whether a box is one lobe of something that swings: what lies beside it is as deep as it is high."""
    near = list(others.near(box, OfBoxes.BESIDE * box.width))
    begin = max([box.first - OfBoxes.BESIDE * box.width, 0, *(o.last for o in near if o.last <= box.first)])
    end = min([box.last + OfBoxes.BESIDE * box.width, values.size, *(o.first for o in near if o.first >= box.last)])
    half = max(box.width // 2, 2)
    noise = OfBoxes.SURE * single / math.sqrt(half)
    before = _deepest(values, line, sign, begin, box.first, half) - noise
    after = _deepest(values, line, sign, box.last, end, half) - noise
    return before > box.mean / OfBoxes.STANDS_OUT or after > box.mean


def _deepest(values: Array, line: Baseline, sign: int, begin: int, end: int, width: int) -> float:
    """Return how far the mean over a box falls below the baseline between two samples."""
    if end - begin < width:
        return 0.0
    part = -sign * (values[begin:end] - line.at(0) - line.slope * np.arange(begin, end))
    sums = np.cumsum(np.concatenate([[0.0], part]))
    return float(np.max(sums[width:] - sums[:-width])) / width


LONG_TRAIN = 400  # contacts from whose gaps the period is taken: those of longer trains come again
NEIGHBOURS = 6  # contacts after each to which a gap is tried as the period: a blow, its rebounds, and the next
BIN = 0.05  # share by which periods that are tried differ: well within `OfTrains.JITTER`


MAINS = (20e-3, 10e-3, 1.0 / 60.0, 1.0 / 120.0)  # periods of the mains and of their rectified form, s
WHOLE_PERIOD = 1.0 / 75.0  # periods of the mains longer than this are whole, the others half, s


def mains_period(times: Array, widths: Array, locked: bool = False) -> float:
    """Return the period of the mains in which contacts come, s; NaN where they do not, or fewer than three do.

    Contacts too short for the mains are none of it, whatever their period.

    Times and widths are in s; ``locked`` asks for more regularity than grids have, where nothing else shows blips.
    """
    gaps = np.diff(times)
    if gaps.size < OfTrains.FEWEST_GAPS:
        return math.nan
    middle = float(np.median(gaps))
    period = min(MAINS, key=lambda mains: abs(middle / mains - 1.0))
    full_period = period if period > WHOLE_PERIOD else 2.0 * period
    if float(np.median(widths)) < OfTrains.CONDUCTS * full_period:
        return math.nan
    if not locked:
        return period if abs(middle / period - 1.0) < OfTrains.MAINS_SHARE else math.nan
    off = gaps / period - 1.0
    return period if max(abs(float(np.mean(off))), float(np.median(np.abs(off)))) < OfTrains.LOCKED else math.nan


class BlowTrain(NamedTuple):
    """Blows one period apart."""

    members: tuple[int, ...]  # contacts that are its blows, in the order of time
    period: float  # median of the gaps of one period
    jitter: float  # scatter of these gaps over the period: from the median of their deviations


class Contacts(NamedTuple):
    """Kinds of the contacts of a record: blows, contacts that belong to one, and double hits."""

    blows: tuple[int, ...]  # in the order of time
    owner: dict[int, int]  # for each contact that belongs to a blow, that blow
    double: dict[int, int]  # for each blow of a double hit beside the one of the train, or the first, that one
    train: BlowTrain | None  # train that shows the period, where there is one


def find_train(times: Array, peaks: Array) -> BlowTrain | None:
    """Return the chain of contacts, one or a few periods apart, that holds most of the peaks; None where none does."""
    if times.size < OfTrains.FEWEST_GAPS + 1:
        return None
    weights = peaks**2  # a rebound weighs little
    penalty = OfTrains.MISSED * float(np.median(np.sort(weights)[weights.size // 2 :]))  # of the larger half: the blows
    best: tuple[float, float, list[int]] | None = None
    for period in _periods(times):
        score, members = _chain(times, weights, period, penalty)
        off = _off_period(times[members], period)
        if best is None or score > best[0] * (1.0 + 1e-9) or (score > best[0] * (1.0 - 1e-9) and off < best[1]):
            best = score, off, members
    if best is None or len(best[2]) < 2:
        return None
    period = _common_period(np.diff(times[best[2]]))
    members = _chain(times, weights, period, OfTrains.KNOWN * penalty)[1]
    gaps = np.diff(times[members])
    period = _common_period(gaps)
    single = gaps[np.abs(gaps - period) < OfTrains.JITTER * period]
    if single.size < OfTrains.FEWEST_GAPS or 2 * single.size < gaps.size:
        return None
    jitter = float(np.median(np.abs(single - period))) / period
    return BlowTrain(tuple(members), period, jitter) if _regular(times, peaks, members) else None


def sort_contacts(times: Array, peaks: Array, widths: Array, small: Sequence[bool]) -> Contacts:
    """Tell blows from what belongs to them.

    ``small`` marks contacts too small for a blow unless a train asks for one there.
    """
    large = np.flatnonzero(~np.asarray(small, dtype=bool))
    train = find_train(times, peaks)
    on = set() if train is None else set(train.members)
    if train is None or not on & set(large[peaks[large] >= OfTrains.COMPARABLE * peaks[large].max(initial=0.0)]):
        return _without_train(times, peaks, widths, small)  # or one of what is small beside a blow that is not on it
    owner: dict[int, int] = {}
    double: dict[int, int] = {}
    members = np.array(train.members)
    others = [k for k in range(times.size) if k not in on]
    blow_of = {k: int(members[max(int(np.searchsorted(times[members], times[k])) - 1, 0)]) for k in others}
    late = _as_late(times, peaks, blow_of, len(members))
    for k, blow in blow_of.items():
        if small[k] or k in late or peaks[k] < OfTrains.COMPARABLE * peaks[blow]:
            owner[k] = blow
        else:
            nearest = int(members[np.argmin(np.abs(times[members] - times[k]))])
            if abs(times[k] - times[nearest]) < 0.5 * train.period:
                double[k] = nearest
    blows = tuple(k for k in range(times.size) if k not in owner)
    return Contacts(blows, owner, double, train)


def gaps_of(times: Array, contacts: Contacts) -> list[float]:
    """Return the times from blow to blow: not those inside a double hit, nor those over a missing blow."""
    firsts = [k for k in contacts.blows if k not in contacts.double]
    gaps = [float(gap) for gap in np.diff(times[firsts])]
    train = contacts.train
    return [gap for gap in gaps if train is None or gap < (1.5 if _sure(train) else math.inf) * train.period]


def missing_of(times: Array, contacts: Contacts) -> list[float]:
    """Return the times at which a train lacks a blow."""
    train = contacts.train
    if train is None or not _sure(train):
        return []
    missing = []
    for k, gap in enumerate(np.diff(times[list(train.members)])):
        count = round(gap / train.period)
        if count > 1 and abs(gap / count - train.period) < OfTrains.SURE_JITTER * train.period:
            missing += [float(times[train.members[k]] + gap * j / count) for j in range(1, count)]
    return missing


def _sure(train: BlowTrain) -> bool:
    return len(train.members) > OfTrains.SURE_GAPS and train.jitter < 0.5 * OfTrains.SURE_JITTER


def _periods(times: Array) -> Array:
    """Return gaps that may be the period, `BIN` apart."""
    some = times[:LONG_TRAIN]
    gaps = np.concatenate([some[k:] - some[:-k] for k in range(1, min(NEIGHBOURS, some.size - 1) + 1)])
    steps = np.round(np.log(gaps[gaps > 0.0]) / BIN)
    return np.array([float(np.median(gaps[gaps > 0.0][steps == step])) for step in np.unique(steps)])


def _chain(times: Array, weights: Array, period: float, penalty: float) -> tuple[float, list[int]]:
    """Return the chain with gaps of one period or a few of the largest weight, and what it holds.

    Each blow that it misses costs ``penalty``.
    """
    score, before = best_chains(times, weights, period, penalty, OfTrains.MOST_PERIODS, OfTrains.JITTER)
    k = int(np.argmax(score))
    members = [k]
    while before[members[-1]] >= 0:
        members.append(int(before[members[-1]]))
    return float(score[k]), members[::-1]


def _off_period(times: Array, period: float) -> float:
    gaps = np.diff(times) / period
    return float(np.mean(np.abs(gaps - np.rint(gaps)))) if gaps.size else math.inf


def _common_period(gaps: Array) -> float:
    """Return the median of the gaps that are as long as the shortest quarter of them is."""
    shortest = float(np.sort(gaps)[(gaps.size - 1) // 4])
    return float(np.median(gaps[np.abs(gaps - shortest) < 2.0 * OfTrains.JITTER * shortest]))


def _regular(times: Array, peaks: Array, members: Sequence[int]) -> bool:
    """Tell whether what is as large as the members and lies beside them is rare, or always as late."""
    usual = float(np.median(peaks[list(members)]))
    on = set(members)
    begin, end = times[members[0]], times[members[-1]]
    beside = [k for k in range(times.size) if k not in on and peaks[k] >= OfTrains.COMPARABLE * usual]
    inside = [k for k in beside if begin < times[k] < end]
    if len(inside) != len(beside) and len(members) < 2 * (len(beside) - len(inside)) + OfTrains.FEWEST_GAPS:
        return False
    if len(inside) <= max(OfTrains.IRREGULAR * len(members), 1.0):
        return True
    places = times[list(members)]
    lags = np.array([times[k] - places[np.searchsorted(places, times[k]) - 1] for k in inside])
    return float(np.median(np.abs(lags - np.median(lags)))) < 0.5 * OfTrains.AS_LATE * float(np.median(lags))


def _as_late(times: Array, peaks: Array, blow_of: dict[int, int], blows: int) -> set[int]:
    """Return what comes after most blows of a train, equally late and smaller: rebounds."""
    after = {k: float(times[k] - times[blow]) for k, blow in blow_of.items() if times[k] > times[blow]}
    if len(after) < max(blows // 2, OfTrains.FEWEST_GAPS):
        return set()
    usual = float(np.median(list(after.values())))
    late = {k for k, lag in after.items() if abs(lag - usual) < OfTrains.AS_LATE * usual}
    smaller = sum(peaks[k] < peaks[blow_of[k]] for k in late)
    most = len(late) >= max(blows // 2, OfTrains.FEWEST_GAPS)
    return late if most and smaller > OfTrains.IRREGULAR * len(late) else set()


def _without_train(times: Array, peaks: Array, widths: Array, small: Sequence[bool]) -> Contacts:
    owner: dict[int, int] = {}
    blows: list[int] = []
    for k in np.argsort(-peaks, kind="stable"):
        near = [b for b in blows if abs(times[k] - times[b]) < OfTrains.NEAR * widths[b]]
        below = [b for b in near if peaks[k] < OfTrains.COMPARABLE * peaks[b]]
        if below:
            owner[int(k)] = min(below, key=lambda b: abs(times[k] - times[b]))
        elif not small[k]:
            blows.append(int(k))
    blows.sort()
    double = {
        later: earlier
        for earlier, later in pairwise(blows)
        if times[later] - times[earlier] < OfTrains.DOUBLE * max(widths[earlier], widths[later])
    }
    return Contacts(tuple(blows), owner, double, None)
