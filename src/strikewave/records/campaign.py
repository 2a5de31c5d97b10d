"""Many records of the same test: each judged against its siblings, and all in one table.

What only the other files of a test show is found: another sign, gain, length, unit or name, outliers, copies. Means,
scatter, bounds and trend are those of what is left.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from strikewave.base import declare
from strikewave.base.declare import NOT_MEASURED
from strikewave.base.errors import show
from strikewave.base.shock_quantities import RATIO
from strikewave.base.texts import plain
from strikewave.records.contacts import mains_period
from strikewave.records.health.sampled_record import with_unit
from strikewave.records.health_notice import BLOW, HealthNotice
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.records.record import Array
from strikewave.records.robust import FEWEST_FOR_OUTLIERS, median_line, outliers, spread_of
from strikewave.records.thresholds import OfSiblings

SUMMED = ("peak", "rise", "width", "velocity_change", "interval", "ringing_frequency")  # the figures of a campaign
# Figures in which outliers are sought: rise times of few samples and the highest of several modes jump as they are
COMPARED = ("peak", "width", "velocity_change", "interval")
OF_SIZE = ("peak", "ratio", "rms")  # figures of a response that grow with it
# Codes of findings whose figures are left out because the other files disagree
ODD = ("gain-differs", "outlier", "polarity-differs")
COPY = "copy"  # code of the finding of a channel whose samples are those of a file before it
FAR = 100  # standard deviations beyond which more tell nothing more
# By what a wrong setting multiplies a record, or divides it, and the question to ask; 10 and 9.80665 lie too close
FACTORS = {
    "is the gain set otherwise?": (2.0, 5.0, 100.0),
    "is the gain set otherwise, or m/s^2 taken for g?": (10.0,),
    "is it in another unit?": (1000.0,),
}


def compare(files: Sequence[FileReading]) -> list[FileReading]:
    """Return the files with what only their siblings show.

    A file that holds no blow beside theirs loses what was taken for one. Another sign, gain, length, unit, name or
    sampling rate, and outliers, are found.
    """
    changed = list(files)
    if len(changed) < 2:
        return changed
    copies = functools.partial(_copies, paths=[file.path for file in files])
    for number in sorted({reading.number for file in files for reading in file.channels}):
        for judge in (_without_blow, copies, _unlike_others, _other_gain, _outlying):
            numbered = ((k, file.numbered(number)) for k, file in enumerate(changed))
            readings = [(k, reading) for k, reading in numbered if reading is not None]
            for compared in _in_one_unit(readings) if judge in OF_SIZES else [readings]:
                for k, finding in list(judge(compared)):
                    changed[k] = _with(changed[k], number, finding)
    return changed


def _in_one_unit(readings: list[tuple[int, ChannelReading]]) -> list[list[tuple[int, ChannelReading]]]:
    """Return readings apart by unit: 500 of a file that names none is neither more nor less than 3000 g."""
    units = dict.fromkeys(reading.channel.unit for _, reading in readings)
    return [[pair for pair in readings if pair[1].channel.unit == unit] for unit in units]


def _with(file: FileReading, number: int, finding: HealthNotice) -> FileReading:
    """Return a file with a finding on one of its channels: with no blow, it loses its blows and what they showed."""
    channels = []
    for reading in file.channels:
        if reading.number == number and finding.code == "no-pulse":
            others = tuple(known for known in reading.findings if not set(known.harms) & {*BLOW, "interval"})
            reading = dataclasses.replace(reading, pulses=(), findings=others)
        channels.append(reading.with_finding(finding) if reading.number == number else reading)
    return dataclasses.replace(file, channels=tuple(channels))


def _largest(reading: ChannelReading) -> float:
    return max(abs(pulse.peak) for pulse in reading.pulses)


def _without_blow(readings: list[tuple[int, ChannelReading]]) -> Iterator[tuple[int, HealthNotice]]:
    """Yield a finding for each file whose blows are none beside those of most of the others."""
    struck = [(k, reading) for k, reading in readings if reading.pulses]
    if len(struck) < 3:
        return
    sure = [reading for _, reading in struck if not _of_mains(reading)]
    sure = sure if len(sure) > 1 else [reading for _, reading in struck]
    usual = float(np.median([_largest(reading) for reading in sure]))
    width = float(np.median([reading.pulses[0].smooth.width() for reading in sure]))
    for k, reading in struck:
        ratio = usual / _largest(reading)
        wider = max(reading.pulses[0].smooth.width() / width, width / reading.pulses[0].smooth.width())
        mains = _of_mains(reading)
        if ratio > OfSiblings.NO_BLOW or (ratio > OfSiblings.LOWER and (wider > OfSiblings.OTHER_WIDTH or mains)):
            unit = reading.channel.unit
            message = (
                f"no blow: its largest excursion, {with_unit(_largest(reading), unit)}, is {plain(ratio)} times "
                f"below the median {with_unit(usual, unit)} of the other files"
            )
            message += ", and comes again in the period of the mains" if mains else ""
            if _scaled(1.0 / ratio, 0.0) is None or wider > 1.0 + OfSiblings.SAME_WIDTH:
                harms = (*BLOW, "interval", "spectrum")
                yield k, HealthNotice("no-pulse", message, 1.0 / ratio, severity="bad", harms=harms)


def _of_mains(reading: ChannelReading) -> bool:
    """Tell whether blows come in the period of the mains."""
    times = np.array([pulse.time for pulse in reading.pulses])
    return mains_period(times, np.array([pulse.smooth.width() for pulse in reading.pulses])) > 0.0


def _scaled(ratio: float, scatter: float) -> tuple[str, float] | None:
    """Return which setting gives such a ratio of peaks most nearly, and its factor; None where none does."""
    reach = min(max(OfSiblings.NEAR_FACTOR, 3.0 * scatter), OfSiblings.MOST_NEAR)
    settings = [(what, exact) for what, factors in FACTORS.items() for f in factors for exact in (f, 1.0 / f)]
    nearest = min(settings, key=lambda setting: abs(math.log(ratio / setting[1])))
    return nearest if abs(math.log(ratio / nearest[1])) < reach else None


def _copies(readings: list[tuple[int, ChannelReading]], paths: Sequence[str]) -> Iterator[tuple[int, HealthNotice]]:
    """Yield a finding for each file whose samples are those of a file before it."""
    firsts: dict[tuple[int, float], list[int]] = {}
    for place, (file, reading) in enumerate(readings):
        values = reading.channel.values
        alike = firsts.setdefault((values.size, float(np.sum(values))), [])
        for other in alike:
            if np.array_equal(values, readings[other][1].channel.values) and np.ptp(values) > 0.0:
                first = readings[other][0]
                message = (
                    f"its samples are those of file {first + 1}, {show(Path(paths[first]).name)}: a copy tells nothing "
                    "new of the scatter, and the mean and its bounds count it again"
                )
                yield file, HealthNotice(COPY, message, first + 1, severity="good")
                break
        else:
            alike.append(place)


def _values(readings: list[tuple[int, ChannelReading]], name: str) -> tuple[list[int], list[float]]:
    """Return the places of the readings that state a figure, and its mean in each."""
    means = [(place, reading.figures(name)) for place, (_, reading) in enumerate(readings)]
    stated = [(place, float(np.mean(values))) for place, values in means if values]
    return [place for place, _ in stated], [value for _, value in stated]


def _size_name(readings: list[tuple[int, ChannelReading]]) -> str:
    """Return the figure that a gain changes: the peak, and of responses to bases in their unit the ratio to it."""
    ratios = [response.ratio for _, reading in readings for response in reading.responses]
    return "ratio" if ratios and all(map(math.isfinite, ratios)) else "peak"


def _lasting(reading: ChannelReading) -> float:
    """Return what a gain does not change: the width of the blows, or a swing of the strongest mode, s."""
    swings = [1.0 / frequency for frequency in reading.figures("frequency")] if reading.responses else []
    times = swings if reading.responses else [pulse.width for pulse in reading.pulses]
    return float(np.mean(times)) if times else math.nan


def _other_gain(readings: list[tuple[int, ChannelReading]]) -> Iterator[tuple[int, HealthNotice]]:
    """Yield a finding for each file whose peak is that of the others times a factor, and that lasts as long as they."""
    name = _size_name(readings)
    places, peaks = _values(readings, name)
    if len(places) < 3:
        return
    usual_width = float(np.median([_lasting(readings[place][1]) for place in places]))
    for place, peak in zip(places, peaks, strict=True):
        file, reading = readings[place]
        others = [value for other, value in zip(places, peaks, strict=True) if other != place]
        usual = float(np.median(others))
        if not usual:  # as many to one side as to the other
            continue
        scatter = abs(spread_of(others) / usual)
        ratio = peak / usual
        same = _scaled(ratio, scatter) if ratio > 0.0 else None
        if same is None or scatter > OfSiblings.AGREE or abs(ratio - 1.0) < OfSiblings.CLEAR * scatter:
            continue
        if abs(_lasting(reading) / usual_width - 1.0) > OfSiblings.SAME_WIDTH:
            continue
        what, factor = same
        unit = "" if name == "ratio" else reading.channel.unit
        times = f"{factor:.5g} times" if factor > 1.0 else f"1/{1.0 / factor:.5g} of"
        called = "peak over that of the base" if name == "ratio" else "peak"
        as_long = "its swings last as long as theirs" if reading.responses else "its width is theirs"
        message = (
            f"its {called}, {with_unit(peak, unit)}, is about {times} the median {with_unit(usual, unit)} of the other "
            f"files, and {as_long}: {what}"
        )
        harms = OF_SIZE if reading.responses else ("peak", "velocity_change")
        yield file, HealthNotice("gain-differs", message, ratio, harms=harms)


def _outlying(readings: list[tuple[int, ChannelReading]]) -> Iterator[tuple[int, HealthNotice]]:
    """Yield a finding for each figure of a file that is an outlier among those of the others."""
    answers = any(reading.responses for _, reading in readings)
    for name in (_size_name(readings), "frequency") if answers else COMPARED:
        places, values = _values(readings, name)
        if len(values) < FEWEST_FOR_OUTLIERS:
            continue
        odd = outliers(values, OfSiblings.FALSE_ALARM / len(COMPARED))
        usual = float(np.median(np.delete(values, odd)))
        spread = float(np.std(np.delete(values, odd), ddof=1))  # above zero: equal values have no outlier
        for k in odd:
            if abs(values[k] - usual) < OfSiblings.LEAST_OUTLIER * abs(usual):
                continue
            file, reading = readings[places[k]]
            unit = {"peak": reading.channel.unit, **dict.fromkeys(("velocity_change", "ratio"), ""), "frequency": "Hz"}
            off, side = abs(values[k] - usual) / spread, "above" if values[k] > usual else "below"
            far = f"{plain(off, 2)}" if off < FAR else f"more than {FAR}"
            called = "peak over that of the base" if name == "ratio" else name.replace("_", " ")
            message = (
                f"its {called}, {with_unit(values[k], unit.get(name, 's'))}, is an outlier: {far} "
                f"standard deviations {side} the median {with_unit(usual, unit.get(name, 's'))} of the other files"
            )
            harms = OF_SIZE if answers and name != "frequency" else (name,)
            over = values[k] / usual if usual else math.inf
            yield file, HealthNotice("outlier", message, over, harms=harms)


def _unlike_others(readings: list[tuple[int, ChannelReading]]) -> Iterator[tuple[int, HealthNotice]]:
    """Yield a finding, with the number of its file, for each channel that differs from those of the other files.

    Which of two files is the odd one is known from neither: sign and length need three.
    """
    if len(readings) < 2:
        return
    signs = [math.copysign(1.0, reading.pulses[0].peak) if reading.pulses else 0.0 for _, reading in readings]
    usual_sign = math.copysign(1.0, sum(signs))
    durations = [reading.channel.duration for _, reading in readings]
    usual = float(np.median(durations))
    as_long = sum(abs(duration - usual) <= OfSiblings.AS_LONG * usual for duration in durations)
    fixed = as_long >= OfSiblings.MOST * len(durations)
    units = [reading.channel.unit for _, reading in readings]
    usual_unit = max(units, key=units.count)
    names = [reading.channel.name for _, reading in readings]
    usual_name = max(names, key=names.count)
    usual_step = float(np.median([reading.channel.step for _, reading in readings]))
    for (file, reading), sign, duration in zip(readings, signs, durations, strict=True):
        channel = reading.channel
        if len(readings) > 2 and sign == -usual_sign and abs(sum(signs)) > 0.0:
            message = "its blows have the other sign than those of the other files: --polarity turns a channel"
            yield file, HealthNotice("polarity-differs", message, sign, harms=("peak", "velocity_change"))
        if len(readings) > 2 and fixed and duration < OfSiblings.SHORTER * usual:
            lasting, others = plain(duration, 4), plain(usual, 4)
            message = f"it lasts {lasting}\xa0s, the other files {others}\xa0s: it may have been cut off"
            yield file, HealthNotice("truncated", message, duration)
        if channel.unit != usual_unit:
            message = f"it is in {channel.unit or 'unknown units'}, the other files in {usual_unit or 'unknown units'}"
            yield file, HealthNotice("unit-differs", message, harms=("peak", "velocity_change"))
        if channel.name != usual_name and names.count(usual_name) > 1 - (len(names) == 2):
            message = f"channel {reading.number} is {show(channel.name)}, in the other files {show(usual_name)}"
            yield file, HealthNotice("name-differs", message, harms=SUMMED)
        if abs(channel.step / usual_step - 1.0) > OfSiblings.SAME_RATE:
            rate, usual_rate = 1.0 / channel.step, 1.0 / usual_step
            message = f"sampled at {rate:.6g}\xa0Hz, the other files at {usual_rate:.6g}\xa0Hz"
            yield file, HealthNotice("rate-differs", message, rate, severity="good")


OF_SIZES = (_without_blow, _other_gain, _outlying)  # checks that compare peaks, and so need files of one unit


# Figures without ringing, which a campaign has where a blow has them and they differ by more than 5 %
WITHOUT_RINGING = ("rigid_peak", "rigid_width")
CONFIDENCE = 0.95  # confidence level of all bounds; chosen: as is usual in test reports


@declare.dataclass
class Statistic:
    """Mean and scatter of a figure; NaN where there are too few values."""

    mean: float = declare.number(NOT_MEASURED, "in the unit of the figure")
    cv: float = declare.number(RATIO, "standard deviation over the size of the mean")
    low: float = declare.number(NOT_MEASURED, "lower bound of the mean at 95 % (Student's t)")
    high: float = declare.number(NOT_MEASURED, "upper bound of the mean")
    n: int = declare.count("values that went in")
    cv_low: float = declare.number(RATIO, "lower bound of the scatter at 95 %", default=math.nan)
    cv_high: float = declare.number(RATIO, "upper bound of the scatter", default=math.nan)
    median: float = declare.number(NOT_MEASURED, "of the same values as the mean", default=math.nan)
    robust_cv: float = declare.number(
        RATIO,
        "scatter from the median of the deviations, over the size of the median: half of the values do not bend it",
        default=math.nan,
    )


@declare.dataclass
class Trend:
    """Straight line through a figure over the files, which single files do not bend."""

    slope: float = declare.number(
        NOT_MEASURED, "change a file, in the unit of the figure: the median of the slopes between all files"
    )
    low: float = declare.number(
        NOT_MEASURED, "its lower bound at 95 %, of Kendall's rank correlation; null below five files"
    )
    high: float = declare.number(NOT_MEASURED, "its upper bound")
    change: float = declare.number(RATIO, "from the first file to the last along the line, over the size of the median")

    @property
    def significant(self) -> bool:
        """True if the bounds of the slope exclude 0."""
        return math.isfinite(self.low) and not self.low <= 0.0 <= self.high


@declare.dataclass
class Outlier:
    """A figure of a file that disagrees with those of the others and is left out."""

    path: str = declare.word("the file", key="file")
    figure: str = declare.word("which figure")
    value: float = declare.number(NOT_MEASURED, "its mean over the blows of the file")
    ratio: float = declare.number(RATIO, "over the median of the others")
    reason: str = declare.word("what was found")
    mean_with: float = declare.number(
        NOT_MEASURED, "what the mean would be with this file, the others that are left out still left out"
    )
    cv_with: float = declare.number(RATIO, "what the scatter would be")


@dataclass(frozen=True, eq=False)
class Campaign:
    """All files of a test, for one channel.

    Attributes
    ----------
    channel : str
        Name of the channel in the first file.
    number : int
        Place of the channel in the files, from 1.
    unit : str
        SI; empty where the first file does not say it.
    statistics : dict
        A `Statistic` for each of `SUMMED` that has a value, and of `WITHOUT_RINGING` where blows ring.
    trends : dict
        A `Trend` over the files in the order given, for each figure with three files or more.
    left_out : tuple of (path, figures, reason)
        Files and figures left out, and why.
    points : dict
        For each figure, pairs of file number (from 0) and value.
    outliers : tuple of Outlier
        Figures that are left out because they disagree with those of the other files, with what they would do.
    """

    channel: str
    number: int
    unit: str
    statistics: dict[str, Statistic]
    trends: dict[str, Trend]
    left_out: tuple[tuple[str, tuple[str, ...], str], ...]
    points: dict[str, tuple[tuple[int, float], ...]]
    outliers: tuple[Outlier, ...] = ()

    @property
    def sums_up(self) -> bool:
        """True if a statistic has more than one value, or a file is left out."""
        return any(statistic.n > 1 for statistic in self.statistics.values()) or bool(self.left_out)


def statistic(values: ArrayLike, files: ArrayLike | None = None) -> Statistic:
    """Return mean, scatter and their bounds at 95 %.

    Blows of one file are alike, so that where several files hold several blows the mean is that of the means of
    the files, and the bounds count files: Student's t for the mean, Vangel's for the scatter of all blows.

    ``files`` is the number of the file of each blow; all are independent by default. Source: ``vangel-1996``.
    """
    sample = np.asarray(values, dtype=float)
    means = _file_means(np.zeros(sample.size) if files is None else np.asarray(files), sample)[1]
    independent = means if means.size > 1 else sample
    if not sample.size:
        return Statistic(math.nan, math.nan, math.nan, math.nan, 0)
    mean, median = float(np.mean(independent)), float(np.median(independent))
    if sample.size < 2:
        return Statistic(mean, math.nan, math.nan, math.nan, 1, median=median)
    from scipy.special import chdtri, stdtrit

    cv = float(np.std(sample, ddof=1)) / abs(mean) if mean else math.inf
    n = independent.size
    reach = float(stdtrit(n - 1, 0.5 + 0.5 * CONFIDENCE)) * float(np.std(independent, ddof=1)) / math.sqrt(n)
    upper, lower = (float(chdtri(n - 1, share)) for share in (0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE))
    cv_low, cv_high = (_vangel(cv, u, n) for u in (upper, lower))
    robust_cv = spread_of(sample) / abs(median) if median else math.inf
    return Statistic(mean, cv, mean - reach, mean + reach, sample.size, cv_low, cv_high, median, robust_cv)


def _file_means(files: Array, values: Array) -> tuple[Array, Array]:
    """Return the files, each once, and the mean of the values of each."""
    known, place = np.unique(files, return_inverse=True)
    return np.asarray(known, dtype=float), np.bincount(place, weights=values) / np.bincount(place)


def _vangel(cv: float, u: float, n: int) -> float:
    if not math.isfinite(cv):
        return math.nan
    below = ((u + 2.0) / n - 1.0) * cv**2 + u / (n - 1)
    return cv / math.sqrt(below) if below > 0.0 else math.inf


def trend(places: ArrayLike, values: ArrayLike) -> Trend:
    """Return the median line of values over their places, with bounds at 95 %.

    Values of the same place count as one, their mean. The line is not that of least squares, because one wrong file at
    an end of a campaign bends that; for normal values without any it is hardly less certain (efficiency 0.95).

    Source: ``sen-1968``.
    """
    x, y = _file_means(np.asarray(places), np.asarray(values, dtype=float))
    slope, low, high = median_line(x, y, CONFIDENCE)
    median = float(np.median(y))
    return Trend(slope, low, high, slope * float(np.ptp(x)) / abs(median) if median else math.nan)


def summed(files: Sequence[FileReading], number: int | None = None) -> Campaign | None:
    """Sum up one channel of all files; None where no file has it.

    Bad records, and figures that a finding harms, are left out and named.

    ``number`` is the place of the channel in the files, from 1; the first that was read by default.
    """
    have = []
    for k, file in enumerate(files):
        reading = next(iter(file.channels), None) if number is None else file.numbered(number)
        have += [] if reading is None else [(k, file, reading)]
    if not have:
        return None
    points: dict[str, tuple[tuple[int, float], ...]] = {}
    rings = any(pulse.differs_without_ringing for _, _, reading in have for pulse in reading.pulses)
    for name in (*SUMMED, *(WITHOUT_RINGING if rings else ())):
        pairs = [(k, v) for k, file, reading in have if not _file_bad(file) for v in reading.figures(name)]
        if pairs:
            points[name] = tuple(pairs)
    statistics = {name: statistic([v for _, v in pairs], [k for k, _ in pairs]) for name, pairs in points.items()}
    trends = {
        name: trend(*zip(*pairs, strict=True)) for name, pairs in points.items() if len({k for k, _ in pairs}) > 2
    }
    left_out = [entry for _, file, reading in have for entry in _left_out(file, reading)]
    left_out += [(file.path, SUMMED, reason) for file in files if not file.channels for reason in file.reasons]
    outliers = tuple(
        outlier for k, file, reading in have if not _file_bad(file) for outlier in _outliers(k, file, reading, points)
    )
    number, channel = have[0][2].number, have[0][2].channel
    return Campaign(channel.name, number, channel.unit, statistics, trends, tuple(left_out), points, outliers)


def _outliers(
    number: int, file: FileReading, reading: ChannelReading, points: dict[str, tuple[tuple[int, float], ...]]
) -> list[Outlier]:
    """Return the figures of a file that disagree with the others, and what they would do to mean and scatter."""
    outliers = []
    alone = dataclasses.replace(reading, findings=tuple(f for f in reading.findings if f.code not in ODD))
    for finding, name in ((f, name) for f in reading.findings if f.code in ODD for name in f.harms):
        own, others = alone.figures(name), points.get(name, ())
        if own and others:
            pairs = [*others, *((number, value) for value in own)]
            with_it = statistic([v for _, v in pairs], [k for k, _ in pairs])
            mean, usual = float(np.mean(own)), float(np.median([v for _, v in others]))
            ratio = mean / usual if usual else math.nan
            outliers.append(Outlier(file.path, name, mean, ratio, finding.message, with_it.mean, with_it.cv))
    return outliers


def _file_bad(file: FileReading) -> bool:
    return any(finding.severity == "bad" for finding in file.findings)


def _left_out(file: FileReading, reading: ChannelReading) -> list[tuple[str, tuple[str, ...], str]]:
    """Return the figures of a file that are left out, with all reasons; nothing where none is."""
    findings = [f for f in (*file.findings, *reading.findings) if f.severity == "bad" or set(f.harms) & set(SUMMED)]
    harmed = {name for f in findings for name in (SUMMED if f.severity == "bad" else f.harms)}
    figures = tuple(name for name in SUMMED if name in harmed)
    own = f"{reading.channel.name}: " if len(file.channels) > 1 else ""
    reasons = [f.message if f in file.findings else own + f.message for f in findings]
    return [(file.path, figures, "; ".join(reasons))] if figures else []
