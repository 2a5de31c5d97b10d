"""Clipping, saturation, a slew rate, spikes, and steps of the converter in a response."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray

from strikewave.base.percents import percent
from strikewave.records.health.noise import NOTED_NOISE
from strikewave.records.health.range import rail
from strikewave.records.health.response.examined import STANDS_OUT, ExaminedResponse, finding
from strikewave.records.health_notice import RESPONSE_FIGURES, HealthNotice
from strikewave.records.modes import FEWEST

Array = NDArray[np.float64]

FLATTER, FLAT_ALONE, SAME_LEVEL = 0.12, 0.3, 0.02
"""Shares of a half swing by which the highest tops are flatter than that of a sine: half of those within this share of
the height, and one that stands alone. Modes together make a flat top now and then, but not several alike."""
TOP, NOISES_OF_TOP, DEEPEST_TOP = 0.02, 4.0, 0.5
"""What counts as top: 2 % of it below it and four standard deviations of noise, at most half of it."""
HIGH_TOPS = 0.5
"""Share of the highest top that the tops have which are looked at."""
LAG = 16
"""Parts of a swing over which its slope is taken: it then still is 97 % of the true one."""
COARSE = 0.02
"""Half a step of the converter over the peak from which on it is worth a word."""
LOWER, FEWEST_OF_TOPS = 0.6, 4
"""Share of the peak below which a limit that takes 5 % off it leaves the samples as they are, and samples above it."""
MISSES, WORSE = 3.0, 1.5
"""Times what the modes miss of the lower samples that the tops must lack, and that they must miss of all samples where
these are fitted too: a mode that is not known is missed in both."""
SPIKE = 0.4
"""Share of itself by which a top stands off the cubic through its neighbours: a sine of five samples has 0.32."""


def clipped(record: ExaminedResponse) -> list[HealthNotice]:
    """Find where the channel stops at one value again and again: the recorder's range ended there."""
    findings = []
    for sign in (1.0, -1.0):
        at = rail(sign * record.values, sign * record.largest.zero)
        if at.size:
            level = float(record.values[at[0]])
            lasts = at.size * record.step * 1e6
            message = f"clipped at {record.text(level)} for {lasts:.4g} us: the true peak is larger"
            begin, end = (record.time(int(k)) for k in (at[0], at[-1]))
            findings.append(
                HealthNotice("clipped", message, level, severity="bad", harms=RESPONSE_FIGURES, start=begin, end=end)
            )
    return findings


def saturated(record: ExaminedResponse) -> list[HealthNotice]:
    """Find tops flatter than those of swings: an amplifier at its limit."""
    begin, end = record.span(record.largest)
    flat = _flat(record.above[begin:end], record.noise + 0.5 * record.resolution)
    if flat is None:
        return []
    message = (
        f"the highest top is flat for {percent(flat[0], 0)} of its half swing (a sine's for {percent(flat[1], 0)}): "
        "the sensor or an amplifier may have saturated; the true peak is larger"
    )
    return [HealthNotice("flat-top", message, flat[0], harms=RESPONSE_FIGURES, start=record.largest.time)]


def compressed(record: ExaminedResponse) -> list[HealthNotice]:
    """Find tops that are lower than the modes, driven by the base, would make them: a limit that is soft.

    Fitted are the base and the absolute accelerations of the modes on it to the samples below `LOWER` of the peak, so
    that only the level is carried on. What they miss of these is the doubt.
    """
    one = record.largest
    begin, end = record.span(one)
    end = min(end, record.place(one.decay.end) + 1)
    through = record.driven(end)
    if through is None:
        return []
    values = record.above[begin:end]
    low = np.abs(values) < LOWER * abs(one.peak)
    if np.count_nonzero(~low) < FEWEST_OF_TOPS or np.count_nonzero(low) < FEWEST:
        return []
    columns = through[begin:end]
    shares = np.linalg.lstsq(columns[low], values[low], rcond=None)[0]
    model = columns @ shares
    missed = math.sqrt(float(np.mean((model - values)[low] ** 2))) / abs(one.peak)
    lost = 1.0 - abs(one.peak) / float(np.max(np.abs(model)))
    all_missed = columns @ np.linalg.lstsq(columns, values, rcond=None)[0] - values
    worse = math.sqrt(float(np.mean(all_missed**2))) / abs(one.peak)
    if not (lost > max(NOTED_NOISE, MISSES * missed) and worse > WORSE * missed):
        return []
    message = (
        "the highest tops are lower than what the base makes of the modes that fit the lower samples: the sensor or an "
        "amplifier may have saturated"
    )
    effects = {**record.moved_by(lost * abs(one.peak)), "peak": -lost}
    found = finding("flat-top", message, lost, effects, start=one.time)
    return [dataclasses.replace(found, harms=RESPONSE_FIGURES) if found.severity != "good" else found]


def slew_limited(record: ExaminedResponse) -> list[HealthNotice]:
    """Find slopes that stay at one value where those of swings turn: the amplifier could not follow."""
    begin, end = record.span(record.largest)
    lag = max(round(record.period / LAG / record.step), 1)
    part = record.above[begin:end]
    if part.size <= 4 * lag:
        return []
    noise = math.sqrt(2.0) * (record.noise + 0.5 * record.resolution)
    flat = _flat(part[lag:] - part[:-lag], noise)
    if flat is None:
        return []
    message = (
        f"the steepest slope stays the same for {percent(flat[0], 0)} of its half swing (a sine's for "
        f"{percent(flat[1], 0)}): the amplifier was too slow (slew rate); the true peak is larger"
    )
    return [HealthNotice("slew-rate", message, flat[0], harms=RESPONSE_FIGURES, start=record.largest.begin)]


def _flat(values: Array, noise: float) -> tuple[float, float] | None:
    """Return for how much of a half swing the highest tops are flat, and a sine's; None if no flatter."""
    edges = np.flatnonzero(np.diff(np.signbit(values))) + 1
    tops = []
    for part in np.split(np.abs(values), edges):
        height = float(np.max(part))
        if not height > 0.0 or part.size < 4:
            continue
        depth = min(TOP + NOISES_OF_TOP * noise / height, DEEPEST_TOP)
        high = np.flatnonzero(part >= (1.0 - depth) * height)
        share = float(high[-1] - high[0] + 1) / part.size
        tops.append((height, share, 1.0 - 2.0 / math.pi * math.asin(1.0 - depth)))
    tops = sorted((top for top in tops if top[0] > HIGH_TOPS * max(tops)[0]), reverse=True)
    if not tops:
        return None
    near = SAME_LEVEL * tops[0][0] + NOISES_OF_TOP * noise
    alike = [top for top in tops if tops[0][0] - top[0] < near]
    share, usual = (float(np.median([top[k] for top in alike])) for k in (1, 2))
    return (share, usual) if share - usual > (FLATTER if len(alike) > 1 else FLAT_ALONE) else None


def coarse(record: ExaminedResponse) -> list[HealthNotice]:
    """Find a converter whose steps are large beside the response."""
    reach = 0.5 * record.resolution
    if reach < COARSE * record.peak:
        return []
    share = percent(record.resolution / record.peak)
    message = f"the steps of the converter are {record.text(record.resolution)}, {share} of the peak"
    return [finding("coarse", message, record.resolution, record.moved_by(reach), signed=False)]


def spike(record: ExaminedResponse) -> list[HealthNotice]:
    """Find a peak of one sample that its neighbours know nothing of."""
    for one in record.responses:
        top = record.place(one.time)
        if not 2 <= top < record.values.size - 2:
            continue
        far, near, value = (
            float(record.above[top - 2] + record.above[top + 2]),
            float(record.above[top - 1] + record.above[top + 1]),
            float(record.above[top]),
        )
        if abs(value - (4.0 * near - far) / 6.0) > max(SPIKE * abs(value), STANDS_OUT * record.noise):
            message = f"at {one.time:.6g} s one sample stands off its neighbours, at {record.text(value)}: a spike"
            return [HealthNotice("spike", message, value, severity="bad", harms=RESPONSE_FIGURES, start=one.time)]
    return []
