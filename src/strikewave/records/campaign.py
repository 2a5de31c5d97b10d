"""Many records of the same test in one table: means, scatter, bounds and trend."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
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
"""Of all bounds; chosen: as is usual in test reports."""
SHORTER, MOST = 0.9, 0.6
"""A record that lasts less than this share of the usual one is shorter than its siblings, where most last as long.

Where a recorder stops by hand all last differently, and none is short."""
AS_LONG = 0.01
"""Share by which records that last as long may differ: a few samples of a trigger."""
SAME_RATE = 0.01
"""Share by which sampling rates may differ without a finding: clocks of recorders are good to 1e-4."""


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
        readings = [
            (k, reading) for k, file in enumerate(files) for reading in file.channels if reading.number == number
        ]
        for k, finding in _unlike_others(readings):
            channels = tuple(
                reading.with_finding(finding) if reading.number == number else reading
                for reading in changed[k].channels
            )
            changed[k] = dataclasses.replace(changed[k], channels=channels)
    return changed


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
    fixed = sum(abs(duration - usual) <= AS_LONG * usual for duration in durations) >= MOST * len(durations)
    units = [reading.channel.unit for _, reading in readings]
    usual_unit = max(units, key=units.count)
    names = [reading.channel.name for _, reading in readings]
    usual_name = max(names, key=names.count)
    usual_step = float(np.median([reading.channel.step for _, reading in readings]))
    for (file, reading), sign, duration in zip(readings, signs, durations, strict=True):
        channel = reading.channel
        if len(readings) > 2 and sign == -usual_sign and abs(sum(signs)) > 0.0:
            message = "its blows have the other sign than those of the other files: --polarity turns a channel"
            yield (
                file,
                HealthNotice("polarity-differs", message, sign, severity="suspect", harms=("peak", "velocity_change")),
            )
        if len(readings) > 2 and fixed and duration < SHORTER * usual:
            message = f"it lasts {duration:.4g} s, the other files {usual:.4g} s: it may have been cut off"
            yield file, HealthNotice("truncated", message, duration, severity="suspect")
        if channel.unit != usual_unit:
            message = f"it is in {channel.unit or 'unknown units'}, the other files in {usual_unit or 'unknown units'}"
            yield file, HealthNotice("unit-differs", message, severity="suspect", harms=("peak", "velocity_change"))
        if channel.name != usual_name and names.count(usual_name) > 1 - (len(names) == 2):
            message = f"channel {reading.number} is {show(channel.name)}, in the other files {show(usual_name)}"
            yield file, HealthNotice("name-differs", message, severity="suspect", harms=SUMMED)
        if abs(channel.step / usual_step - 1.0) > SAME_RATE:
            rate, usual_rate = 1.0 / channel.step, 1.0 / usual_step
            message = f"sampled at {rate:.6g} Hz, the other files at {usual_rate:.6g} Hz"
            yield file, HealthNotice("rate-differs", message, rate, severity="good")


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
    findings = [f for f in (*file.findings, *reading.findings) if f.severity == "bad" or set(f.harms) & set(SUMMED)]
    harmed = {name for f in findings for name in (SUMMED if f.severity == "bad" else f.harms)}
    figures = tuple(name for name in SUMMED if name in harmed)
    own = f"{reading.channel.name}: " if len(file.channels) > 1 else ""
    reasons = [f.message if f in file.findings else own + f.message for f in findings]
    return [(file.path, figures, "; ".join(reasons))] if figures else []
