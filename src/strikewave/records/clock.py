"""Uniform sampling and finite samples: what is missing or uneven is mended where it can be, and reported."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from strikewave.base.errors import InputError
from strikewave.base.texts import percent
from strikewave.records.health_notice import FIGURES, HealthNotice
from strikewave.records.record import Array, Channel
from strikewave.records.thresholds import OfClock

SENSELESS = 1e30  # no time, and no sample, is as large: instruments write such numbers for none (9.9e37)
# Grid samples for each one recorded: bounds the memory of stamps that jump by years
BRIDGED, BRIDGED_AT_LEAST = 4, 1000
WITHIN_DIGIT = 1.001  # times the last digit that rounded stamps may stray by: floating point adds its own
# The last digit is looked for in the last tenth of the stamps, the largest ones, and in 50 at least
LAST_TENTH, FEWEST_STAMPS = 10, 50
# Digits of a stamp that are tried: fewer would not tell a step, and more a double does not hold
FEWEST_DIGITS, MOST_DIGITS = 3, 15
# Share of a digit by which a stamp may differ from a whole number of them: of 14 digits, a double keeps so much
WHOLE = 1e-4
TINIEST = 1e-200  # times below which there is no digit to find, s


def even(channel: Channel) -> tuple[Channel, list[HealthNotice]]:
    """Return a channel with uniform sampling and without missing samples, and what had to be mended.

    Examples
    --------
    >>> stamps = np.array([0.0, 1.0, 2.0, 3.0, 5.0, 6.0])
    >>> mended, findings = even(Channel("a", np.array([0.0, 1.0, np.nan, 3.0, 5.0, 6.0]), 1.0, stamps=stamps))
    >>> mended.values.tolist(), [finding.code for finding in findings]
    ([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0], ['gap', 'not-a-number'])
    """
    if channel.stamps is None and not channel.step > 0.0:
        hint = 'such as --rate "200 kHz"; or name the column that holds time with --time'
        raise InputError("--rate", f"nothing for {channel.name}", "a sampling rate: the file gives no time", hint)
    findings: list[HealthNotice] = []
    if channel.stamps is not None:
        channel, findings = _resampled(channel, channel.stamps)
    channel, missing = _filled(channel)
    return channel, findings + missing


def _resampled(channel: Channel, stamps: Array) -> tuple[Channel, list[HealthNotice]]:
    findings = []
    here = np.abs(stamps) < SENSELESS
    if not here.all():
        share = 1.0 - float(here.mean())
        message = f"{percent(share, 2)} of the time stamps are no times; their samples are left out"
        findings.append(HealthNotice("time-missing", message, share))
    values, stamps = channel.values[here], stamps[here]
    steps = np.diff(stamps)
    rounded = _rounded(stamps, steps)
    if rounded is not None:
        start, step = rounded
        return dataclasses.replace(channel, values=values, step=step, start=start, stamps=None), findings
    back = int(np.count_nonzero(steps < 0.0))
    same = int(np.count_nonzero(steps == 0.0))
    if back:
        where = float(stamps[int(np.argmax(steps < 0.0))])
        times = "once" if back == 1 else f"{back} times"
        message = f"time runs backwards {times}, first after {where:g}\xa0s: are these several records in one file?"
        findings.append(HealthNotice("time-backwards", message, back, severity="bad", harms=FIGURES, start=where))
    if back or same:
        order = np.argsort(stamps, kind="stable")
        stamps, first = np.unique(stamps[order], return_index=True)
        values = values[order][first]
        if same:
            message = f"{same} time stamps stand twice; the first sample of each is kept"
            mixed = same >= OfClock.MOST_TWICE * values.size
            if mixed:
                message += ": most do, so that samples of several channels may stand in one column"
            harms = FIGURES if mixed else ()
            findings.append(HealthNotice("time-twice", message, same, "bad" if mixed else "suspect", harms))
        steps = np.diff(stamps)
    if stamps.size < 2:
        return dataclasses.replace(channel, values=values, stamps=None), findings
    usual = float(np.median(steps))
    near = steps[np.abs(steps - usual) <= OfClock.USUAL * usual]
    step = float(np.mean(near)) if near.size else usual
    grid_size = round(float(stamps[-1] - stamps[0]) / step) + 1
    bridged = grid_size <= BRIDGED * stamps.size + BRIDGED_AT_LEAST
    rounding = _last_digit(stamps) if _share_odd(steps, usual) > OfClock.ROUNDED_STEPS else 0.0
    findings += _gaps(stamps, steps, (step, rounding), bridged)
    stray = 0.0
    if grid_size == stamps.size:
        stray = float(np.max(np.abs(stamps - stamps[0] - step * np.arange(stamps.size))))
    if bridged and (grid_size != stamps.size or stray > OfClock.UNEVEN * step + rounding):
        if not any(f.code == "gap" for f in findings):
            message = f"time stamps stray by up to {percent(stray / step)} of a step; the record is resampled uniformly"
            severity = "suspect" if stray > OfClock.JITTER * step else "good"
            findings.append(HealthNotice("time-uneven", message, stray, severity, ("spectrum",)))
        grid = stamps[0] + step * np.arange(grid_size)
        values = np.interp(grid, stamps, values)
    return dataclasses.replace(channel, values=values, step=step, start=float(stamps[0]), stamps=None), findings


def _rounded(stamps: Array, steps: Array) -> tuple[float, float] | None:
    """Return start and step of time stamps that are even but for their last digit; None for others.

    Rounding may make neighbours equal. One lost sample strays as little; but then all other steps are the same.
    """
    if steps.size < 2 or not stamps[-1] > stamps[0] or float(np.min(steps)) < 0.0:
        return None
    places = np.arange(stamps.size) - 0.5 * steps.size
    middle = float(np.mean(stamps))
    step = float(np.sum(places * (stamps - middle)) / np.sum(places**2))  # np.dot would wait for threads of BLAS
    stray = float(np.max(np.abs(stamps - middle - step * places)))
    if float(np.min(steps)) == 0.0 and step >= (1.0 - OfClock.UNEVEN) * _last_digit(stamps):
        return None  # digits as fine as the step never make neighbours equal: the lines are those of several channels
    if _share_odd(steps, float(np.median(steps))) <= OfClock.ODD_STEPS or stray > WITHIN_DIGIT * _last_digit(stamps):
        return None
    return middle - 0.5 * step * steps.size, step


def _share_odd(steps: Array, usual: float) -> float:
    """Return the share of steps that are not the usual one."""
    return float(np.mean(np.abs(steps - usual) > OfClock.UNEVEN * usual))


def _last_digit(stamps: Array) -> float:
    """Return the worth of the last digit of the largest time stamps, as they were rounded when written, s."""
    part = np.abs(stamps[-max(stamps.size // LAST_TENTH, FEWEST_STAMPS) :])
    largest = float(np.max(part))
    if largest < TINIEST:
        return 0.0
    decade = math.floor(math.log10(largest))
    part = part[part >= 10.0**decade]
    for digits in range(FEWEST_DIGITS, MOST_DIGITS):
        unit = 10.0 ** (decade - digits + 1)
        if np.all(np.abs(part / unit - np.round(part / unit)) < WHOLE):
            return max(unit, float(np.spacing(largest)))
    return float(np.spacing(largest))


def _gaps(stamps: Array, steps: Array, clock: tuple[float, float], bridged: bool) -> list[HealthNotice]:
    step, rounding = clock
    wide = np.flatnonzero(steps > OfClock.GAP * step + rounding)
    if not wide.size:
        return []
    lost = float(np.sum(steps[wide])) - step * wide.size
    share = lost / float(stamps[-1] - stamps[0])
    longest = int(wide[np.argmax(steps[wide])])
    message = (
        f"{wide.size} gap{'s' if wide.size > 1 else ''} in time, {percent(share, 2)} of the record, the longest "
        f"{steps[longest]:.3g}\xa0s after {stamps[longest]:g}\xa0s; "
        + ("bridged by straight lines" if bridged else "too long to be bridged")
    )
    begin, end = (float(stamp) for stamp in stamps[longest : longest + 2])
    return [HealthNotice("gap", message, lost, *_harm_of_lost(share), begin, end)]


def _filled(channel: Channel) -> tuple[Channel, list[HealthNotice]]:
    values = channel.values
    missing = ~(np.abs(values) < SENSELESS)
    count = int(np.count_nonzero(missing))
    if not count:
        return channel, []
    first = channel.start + channel.step * int(np.argmax(missing))
    if count == values.size:
        message = "no sample is a number"
        return channel, [HealthNotice("not-a-number", message, count, severity="bad", harms=FIGURES)]
    places = np.arange(values.size)
    filled = values.copy()
    filled[missing] = np.interp(places[missing], places[~missing], values[~missing])
    share = count / values.size
    message = (
        f"{count} samples ({percent(share, 2)}) are no finite numbers, the first at {first:g}\xa0s; "
        "bridged by straight lines"
    )
    return dataclasses.replace(channel, values=filled), [
        HealthNotice("not-a-number", message, count, *_harm_of_lost(share), first)
    ]


def _harm_of_lost(share: float) -> tuple[str, tuple[str, ...]]:
    """Return severity and harmed figures where straight lines stand in place of a share of the samples."""
    return ("bad", FIGURES) if share > OfClock.MOST_LOST else ("suspect", ("spectrum",))
