"""Many records of the same test in one table: means, scatter, bounds and trend."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from strikewave.base.errors import show
from strikewave.records.health_notice import HealthNotice
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.records.record import Array

SUMMED = ("peak", "rise", "width", "velocity_change", "interval", "ringing_frequency")
"""The figures of a campaign."""
CONFIDENCE = 0.95
"""Of all bounds."""
SHORTER, MOST = 0.9, 0.6
"""A record that lasts less than this share of the usual one is shorter than its siblings, where most last as long."""


class Statistic(NamedTuple):
    """Mean and scatter of a figure; NaN where there are too few values.

    Attributes
    ----------
    mean : float
        In the unit of the figure.
    cv : float
        Standard deviation over the size of the mean.
    low, high : float
        Bounds of the mean at 95 % (Student's t).
    n : int
        Values that went in.
    cv_low, cv_high : float
        Bounds of the scatter at 95 %.
    """

    mean: float
    cv: float
    low: float
    high: float
    n: int
    cv_low: float = math.nan
    cv_high: float = math.nan


class Trend(NamedTuple):
    """Straight line through a figure over the files.

    Attributes
    ----------
    slope : float
        Change a file, in the unit of the figure.
    low, high : float
        Its bounds at 95 %.
    change : float
        From the first file to the last along the line, over the size of the mean.
    """

    slope: float
    low: float
    high: float
    change: float


@dataclass(frozen=True, eq=False)
class Campaign:
    """All files of a test, for one channel.

    Attributes
    ----------
    channel : str
        Name of the channel in the first file.
    statistics : dict
        A `Statistic` for each of `SUMMED` that has a value.
    trends : dict
        A `Trend` over the files in the order given, for each figure with three files or more.
    left_out : tuple of (path, figures, reason)
        What did not go in.
    points : dict
        For each figure, pairs of file number (from 0) and value.
    """

    channel: str
    statistics: dict[str, Statistic]
    trends: dict[str, Trend]
    left_out: tuple[tuple[str, tuple[str, ...], str], ...]
    points: dict[str, tuple[tuple[int, float], ...]]


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

    Source: ``vangel-1996``.

    Examples
    --------
    >>> [round(float(v), 4) for v in statistic([1.0, 2.0, 3.0])[:5]]
    [2.0, 0.5, -0.4841, 4.4841, 3.0]
    >>> statistic([1.0, 1.0, 2.0, 2.0, 3.0, 3.0], files=[0, 0, 1, 1, 2, 2]).high == statistic([1.0, 2.0, 3.0]).high
    True
    """
    sample = np.asarray(values, dtype=float)
    means = _file_means(np.zeros(sample.size) if files is None else np.asarray(files), sample)[1]
    mean = float(np.mean(means if means.size > 1 else sample)) if sample.size else math.nan
    if sample.size < 2:
        return Statistic(mean, math.nan, math.nan, math.nan, sample.size)
    from scipy.special import chdtri, stdtrit

    cv = float(np.std(sample, ddof=1)) / abs(mean) if mean else math.inf
    independent = means if means.size > 1 else sample
    n = independent.size
    reach = float(stdtrit(n - 1, 0.5 + 0.5 * CONFIDENCE)) * float(np.std(independent, ddof=1)) / math.sqrt(n)
    upper, lower = (float(chdtri(n - 1, share)) for share in (0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE))
    bounds = [_vangel(cv, u, n) for u in (upper, lower)]
    return Statistic(mean, cv, mean - reach, mean + reach, sample.size, *bounds)


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
    """Return the least-squares line of values over their places, with bounds at 95 %.

    Values of the same place count as one, their mean.

    Examples
    --------
    >>> trend([0, 1, 2, 3], [1.0, 2.0, 3.0, 4.0]).slope
    1.0
    """
    from scipy.special import stdtrit

    x, y = _file_means(np.asarray(places), np.asarray(values, dtype=float))
    run = x - np.mean(x)
    slope, mean = float(np.sum(run * y) / np.sum(run**2)), float(np.mean(y))
    rest = y - mean - slope * run
    error = math.sqrt(float(np.sum(rest**2)) / (x.size - 2) / float(np.sum(run**2))) if x.size > 2 else math.nan
    reach = float(stdtrit(x.size - 2, 0.5 + 0.5 * CONFIDENCE)) * error if x.size > 2 else math.nan
    return Trend(slope, slope - reach, slope + reach, slope * float(np.ptp(x)) / abs(mean) if mean else math.nan)


def compare(files: Sequence[FileReading]) -> list[FileReading]:
    """Return the files with what only their siblings show: another sign, length, unit or sampling rate.

    Examples
    --------
    >>> compare([])
    []
    """
    changed = list(files)
    for number in sorted({reading.number for file in files for reading in file.channels}):
        found = [(k, reading) for k, file in enumerate(files) for reading in file.channels if reading.number == number]
        for (k, reading), finding in _strangers(found):
            channels = tuple(
                one.with_finding(finding) if one.number == reading.number else one for one in changed[k].channels
            )
            changed[k] = dataclasses.replace(changed[k], channels=channels)
    return changed


def _strangers(found: list[tuple[int, ChannelReading]]) -> list[tuple[tuple[int, ChannelReading], HealthNotice]]:
    if len(found) < 2:
        return []
    strange = []
    signs = [math.copysign(1.0, reading.pulses[0].peak) if reading.pulses else 0.0 for _, reading in found]
    usual_sign = math.copysign(1.0, sum(signs))
    lasts = [reading.channel.duration for _, reading in found]
    usual = float(np.median(lasts))
    fixed = sum(abs(last - usual) <= 0.01 * usual for last in lasts) >= MOST * len(lasts)
    units = [reading.channel.unit for _, reading in found]
    usual_unit = max(units, key=units.count)
    names = [reading.channel.name for _, reading in found]
    usual_name = max(names, key=names.count)
    rate = float(np.median([reading.channel.step for _, reading in found]))
    for one, sign, last in zip(found, signs, lasts, strict=True):
        if len(found) > 2 and sign == -usual_sign and abs(sum(signs)) > 0.0:
            words = "its blows have the other sign than those of the other files: --polarity turns a channel"
            strange.append(
                (
                    one,
                    HealthNotice(
                        "polarity-differs", words, sign, severity="suspect", harms=("peak", "velocity_change")
                    ),
                )
            )
        if len(found) > 2 and fixed and last < SHORTER * usual:
            words = f"it lasts {last:.4g} s, the other files {usual:.4g} s: it may have been cut off"
            strange.append((one, HealthNotice("truncated", words, last, severity="suspect")))
        if one[1].channel.unit != usual_unit:
            words = (
                f"it is in {one[1].channel.unit or 'unknown units'}, the other files in {usual_unit or 'unknown units'}"
            )
            strange.append(
                (one, HealthNotice("unit-differs", words, severity="suspect", harms=("peak", "velocity_change")))
            )
        if one[1].channel.name != usual_name and names.count(usual_name) > 1 - (len(names) == 2):
            words = f"channel {one[1].number} is {show(one[1].channel.name)}, in the other files {show(usual_name)}"
            strange.append((one, HealthNotice("name-differs", words, severity="suspect", harms=SUMMED)))
        if abs(one[1].channel.step / rate - 1.0) > 0.01:
            words = f"sampled at {1.0 / one[1].channel.step:.6g} Hz, the other files at {1.0 / rate:.6g} Hz"
            strange.append((one, HealthNotice("rate-differs", words, 1.0 / one[1].channel.step, severity="good")))
    return strange


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
    have = [
        (k, file, reading)
        for k, file in enumerate(files)
        for reading in (file.channels[:1] if number is None else file.channels)
        if number is None or reading.number == number
    ]
    if not have:
        return None
    points: dict[str, tuple[tuple[int, float], ...]] = {}
    for name in SUMMED:
        pairs = [(k, v) for k, file, reading in have if not _file_bad(file) for v in reading.figures(name)]
        if pairs:
            points[name] = tuple(pairs)
    statistics = {name: statistic([v for _, v in pairs], [k for k, _ in pairs]) for name, pairs in points.items()}
    trends = {
        name: trend(*zip(*pairs, strict=True)) for name, pairs in points.items() if len({k for k, _ in pairs}) > 2
    }
    left_out = [entry for _, file, reading in have for entry in _left_out(file, reading)]
    left_out += [(file.path, SUMMED, reason) for file in files if not file.channels for reason in file.reasons]
    return Campaign(have[0][2].channel.name, statistics, trends, tuple(left_out), points)


def _file_bad(file: FileReading) -> bool:
    return any(finding.severity == "bad" for finding in file.findings)


def _left_out(file: FileReading, reading: ChannelReading) -> list[tuple[str, tuple[str, ...], str]]:
    """Return the figures of a file that are left out, with all reasons; nothing where none is."""
    found = [f for f in (*file.findings, *reading.findings) if f.severity == "bad" or set(f.harms) & set(SUMMED)]
    harmed = {name for f in found for name in (SUMMED if f.severity == "bad" else f.harms)}
    figures = tuple(name for name in SUMMED if name in harmed)
    return [(file.path, figures, "; ".join(f.message for f in found))] if figures else []
