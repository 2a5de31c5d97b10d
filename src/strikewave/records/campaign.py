"""Many records of the same test in one table: means, scatter, bounds and trend."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from strikewave.base import declare
from strikewave.base.declare import NOT_MEASURED
from strikewave.base.shock_quantities import RATIO
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.records.record import Array
from strikewave.records.robust import median_line, spread_of
from strikewave.records.siblings import ODD, SUMMED, compare

__all__ = ["Campaign", "Outlier", "Statistic", "Trend", "compare", "statistic", "summed", "trend"]

WITHOUT_RINGING = ("rigid_peak", "rigid_width")
"""Figures without ringing, which a campaign has where a blow has them and they differ by more than 5 %."""
CONFIDENCE = 0.95
"""Of all bounds; chosen: as is usual in test reports."""


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
        """Whether its bounds exclude none."""
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
        Its place in the files, from 1.
    unit : str
        SI; empty where the first file does not say it.
    statistics : dict
        A `Statistic` for each of `SUMMED` that has a value, and of `WITHOUT_RINGING` where blows ring.
    trends : dict
        A `Trend` over the files in the order given, for each figure with three files or more.
    left_out : tuple of (path, figures, reason)
        What did not go in.
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
        """Whether it says more than the one blow that it is of."""
        return any(statistic.n > 1 for statistic in self.statistics.values()) or bool(self.left_out)


def statistic(values: ArrayLike, files: ArrayLike | None = None) -> Statistic:
    """Return mean, scatter and their bounds at 95 %.

    Blows of one file are alike, so that where several files hold several blows the mean is that of the means of
    the files, and the bounds count files: Student's t for the mean, Vangel's for the scatter of all blows.

    Parameters
    ----------
    values : array_like
        One a blow.
    files : array_like, optional
        Number of the file of each blow; all blows are independent by default.

    Notes
    -----
    Source: ``vangel-1996``.

    Examples
    --------
    >>> found = statistic([1.0, 2.0, 3.0])
    >>> [round(float(value), 4) for value in (found.mean, found.cv, found.low, found.high)]
    [2.0, 0.5, -0.4841, 4.4841]
    >>> statistic([1.0, 1.0, 2.0, 2.0, 3.0, 3.0], files=[0, 0, 1, 1, 2, 2]).high == statistic([1.0, 2.0, 3.0]).high
    True
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

    Examples
    --------
    >>> trend([0, 1, 2, 3, 4], [1.0, 2.0, 3.0, 4.0, 50.0]).slope
    1.0
    """
    x, y = _file_means(np.asarray(places), np.asarray(values, dtype=float))
    slope, low, high = median_line(x, y, CONFIDENCE)
    median = float(np.median(y))
    return Trend(slope, low, high, slope * float(np.ptp(x)) / abs(median) if median else math.nan)


def summed(files: Sequence[FileReading], number: int | None = None) -> Campaign | None:
    """Sum up one channel of all files; None where no file has it.

    Bad records, and figures that a finding harms, are left out and named.

    Parameters
    ----------
    files : sequence of FileReading
        In the order of the test.
    number : int, optional
        Channel, by its place in the files, from 1; the first that was read by default.
    """
    found = (
        (k, file, next(iter(file.channels), None) if number is None else file.numbered(number))
        for k, file in enumerate(files)
    )
    have = [(k, file, reading) for k, file, reading in found if reading is not None]
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
    first = have[0][2]
    return Campaign(
        first.channel.name, first.number, first.channel.unit, statistics, trends, tuple(left_out), points, outliers
    )


def _outliers(
    number: int, file: FileReading, reading: ChannelReading, points: dict[str, tuple[tuple[int, float], ...]]
) -> list[Outlier]:
    """Return the figures of a file that disagree with the others, and what they would do to mean and scatter."""
    found = []
    for finding in reading.findings:
        if finding.code not in ODD:
            continue
        alone = dataclasses.replace(reading, findings=tuple(f for f in reading.findings if f.code not in ODD))
        for name in finding.harms:
            own, others = alone.figures(name), points.get(name, ())
            if own and others:
                pairs = [*others, *((number, value) for value in own)]
                with_it = statistic([v for _, v in pairs], [k for k, _ in pairs])
                usual = float(np.median([v for _, v in others]))
                ratio = float(np.mean(own)) / usual if usual else math.nan
                found.append(
                    Outlier(file.path, name, float(np.mean(own)), ratio, finding.message, with_it.mean, with_it.cv)
                )
    return found


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
