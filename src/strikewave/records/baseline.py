"""The baseline under a blow, from what lies before it, and how well it is known.

What noise, hum and drift do to a figure is measured, not derived from a colour of the noise: each stretch of the
pre-trigger as long as the blow is predicted from those before it, as the baseline under the blow is, and the root mean
square of what is missed is the uncertainty of the mean over the blow. That holds for noise of any colour.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from strikewave.records.record import Array
from strikewave.records.robust import alike_as_one

LOOK_BACK = 40  # widths of a blow before it over which the baseline is taken: more than its foot lasts
# Widths over which it is taken where the record wanders: noise whose neighbours are alike is better known nearby
NEAR = (8, 3)
BETTER = 0.6  # another baseline must miss less than this share: chance does it in 1 of 100 records of a dozen trials
TRIALS = 6  # stretches that must be predicted before what they miss counts as known: to 30 %, 1 / sqrt(2 x 6)
# Widths before a blow from which its slope is known: it is carried on for less than an eighth of their length
SLOPED = 12
SIGNIFICANT = 4.0  # standard errors of a slope that is one; they count the memory of the noise
MOST = 256  # widths before a blow that are looked at: what lies farther back tells nothing more of it
# Samples before a blow, and a width of it, without which the line of the whole record is taken for its baseline
FEWEST = 4
TIP = 5  # a tip is a fifth of a width: over so much a half-sine stays within 5 % of its peak

MEDIAN = 0.5 * math.pi  # variance of the median of normal values over that of their mean
MOST_ALIKE = 0.9  # largest correlation of a width and the next: a few of them tell no longer memory
# Widths before a blow without which nothing but white noise is known: as many as its figures are read off
FEWEST_OF_NOISE = 3
WHITE = 8  # widths of white noise that stand for it then


class LocalBaseline(NamedTuple):
    """Baseline of a record under a blow."""

    level: float  # at the middle of the blow
    slope: float = 0.0  # rise a sample before it; 0 where none is significant
    # Standard deviation of the mean over a width about the baseline; NaN where too little lies before to know it
    wander: float = math.nan
    # Standard deviation of the mean over a fifth of a width about that over the width around it
    ripple: float = math.nan
    widths: int = 0  # widths over which the baseline was taken
    width: int = 0  # samples of a width
    alike: float = 0.0  # correlation of what the baseline misses in a width and in the next

    def area_wander(self, samples: float) -> float:
        """Return the standard deviation of the sum over so many samples about the baseline.

        Each width is off as much, and resembles the next: of n widths, whose correlation falls by r from one to the
        next, it is the root of n (1 + r) / (1 - r) - 2 r (1 - r^n) / (1 - r)^2.

        Examples
        --------
        >>> [round(LocalBaseline(0.0, wander=2.0, width=10, alike=r).area_wander(40), 1) for r in (0.0, 0.5)]
        [40.0, 57.4]
        """
        if not self.width:
            return math.nan
        n, r = samples / self.width, self.alike
        count = n * (1.0 + r) / (1.0 - r) - 2.0 * r * (1.0 - r**n) / (1.0 - r) ** 2
        return self.wander * self.width * math.sqrt(count)


def baseline_before(values: Array, first: int, width: int, earliest: int = 0) -> LocalBaseline | None:
    """Return the baseline under a blow; None where no room lies before it.

    The blow stands out of ``width`` samples from ``first`` on; the one before it ends at ``earliest``.
    """
    end = first - width
    begin = max(end - MOST * width, earliest + 2 * width if earliest else 0)
    if end - begin < max(width, FEWEST):
        return None
    near = values[max(begin, end - LOOK_BACK * width) : end]
    level = float(np.median(near))
    count = (end - begin) // width
    blocks = values[end - count * width : end].reshape(count, width)
    means = blocks.mean(axis=1)
    ripple = _ripple(blocks, means)
    if count < TRIALS + 1:
        return LocalBaseline(level, 0.0, math.nan, ripple, min(count, LOOK_BACK), width)
    recent = means[-LOOK_BACK:]
    missed = means - _medians_before(means, level)
    alike = _alike(missed)
    error = MEDIAN * (1.0 + alike) / (1.0 - alike) / recent.size  # of the level, which all widths share
    wander = math.sqrt(1.0 + error) * _root_mean_square(missed)
    best = LocalBaseline(level, 0.0, wander, ripple, recent.size, width, (alike + error) / (1.0 + error))
    best = _sloped(recent, width, best)
    for widths in NEAR:
        missed = _missed(means, widths)
        if missed.size >= TRIALS and _root_mean_square(missed) < BETTER * best.wander:
            mean = float(np.mean(means[-widths:]))
            best = LocalBaseline(mean, 0.0, _root_mean_square(missed), ripple, widths, width, _alike(missed))
    return best


def noise_before(values: Array, first: int, width: int, earliest: int = 0, white: float = 0.0) -> Array:
    """Return the noise before a blow, about its straight line; where too little lies there, white noise."""
    end = first - width
    begin = max(end - LOOK_BACK * width, earliest + 2 * width if earliest else 0)
    if end - begin < FEWEST_OF_NOISE * width:
        return white * np.random.default_rng(0).normal(size=WHITE * width)
    place = np.linspace(-1.0, 1.0, end - begin)
    part = values[begin:end] - np.mean(values[begin:end])
    return np.asarray(part - place * float(part @ place) / float(place @ place))


def _medians_before(means: Array, level: float) -> Array | float:
    """Return what a level baseline gives for each width: a long record's wanders with it."""
    if means.size <= LOOK_BACK:
        return level
    groups = np.array_split(means, math.ceil(means.size / LOOK_BACK))
    return np.concatenate([np.full(group.size, np.median(group)) for group in groups])


def _missed(means: Array, widths: int) -> Array:
    """Return what the mean over so many widths misses of the width after next: the foot of a blow lies between."""
    if means.size < widths + 2:
        return np.empty(0)
    sums = np.cumsum(np.concatenate([[0.0], means]))
    before = (sums[widths:-2] - sums[: -widths - 2]) / widths
    return np.asarray(means[widths + 1 :] - before)


def _sloped(means: Array, width: int, level: LocalBaseline) -> LocalBaseline:
    """Return the sloping baseline where its slope is significant and misses less than the level one."""
    n = means.size
    if n < SLOPED:
        return level
    place = np.arange(n) - 0.5 * (n - 1)
    spread = float(place @ place)
    slope = float(place @ means) / spread
    rest = means - float(np.mean(means)) - slope * place
    scatter = math.sqrt(float(rest @ rest) / (n - 2))
    memory = alike_as_one(rest)
    error = scatter / math.sqrt(spread) * math.sqrt(memory)
    ahead = 0.5 * (n - 1) + 2.0  # the width after next, as above
    missed = scatter * math.sqrt(1.0 + memory * (1.0 / n + ahead**2 / spread))
    if abs(slope) < SIGNIFICANT * error or missed > BETTER * level.wander:
        return level
    return level._replace(
        level=float(np.mean(means)) + slope * ahead, slope=slope / width, wander=missed, alike=_alike(rest)
    )


def _alike(missed: Array) -> float:
    """Return the correlation of neighbours, from zero to `MOST_ALIKE`."""
    power = float(missed @ missed)
    return min(max(float(missed[1:] @ missed[:-1]) / power, 0.0), MOST_ALIKE) if power > 0.0 else 0.0


def _ripple(blocks: Array, means: Array) -> float:
    """Return the standard deviation of means over a fifth of a width about that over the width."""
    tip = max(blocks.shape[1] // TIP, 1)
    parts = blocks.shape[1] // tip
    if parts < 2:
        return math.nan
    tips = blocks[:, : parts * tip].reshape(blocks.shape[0], parts, tip).sum(axis=2) / tip
    off = (tips - means[:, None]).ravel()
    return _root_mean_square(off - off.sum() / off.size) * math.sqrt(parts / (parts - 1.0))


def _root_mean_square(values: Array) -> float:
    return math.sqrt(float(values @ values) / values.size)
