"""Whether there are blows, whole ones, and as they should be."""

from __future__ import annotations

import math

import numpy as np

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.records.health.examined import BLOW, Examined
from strikewave.records.health_notice import HealthNotice

SPANS_NOISE = 30.0
"""Standard deviations beyond which a record without a blow holds something: noise spans ten in a million samples."""
PART, FEWEST_OF_PART = 0.1, 3
"""Share of a peak from which on what a record begins or ends in, and falls off from, is a part of another blow; samples
of a width of it."""
MISSED_FALL = 0.9
"""Share of the speed of a fall that is the least change of velocity: 10 % is left to friction of guides and the
height."""


def no_pulse(record: Examined) -> list[HealthNotice]:
    """Find that nothing in the record is a blow."""
    if record.pulses:
        return []
    reach = float(np.ptp(record.values))
    if reach > SPANS_NOISE * record.noise:
        message = f"the record spans {record.text(reach)}, but no one-sided blow stands out: it drifts, or swings"
        harms: tuple[str, ...] = (*BLOW, "interval")  # its spectrum is sound: so is that of a pyroshock
    else:
        message = "no blow stands out of the noise"
        harms = (*BLOW, "interval", "spectrum")
    return [HealthNotice("no-pulse", message, 0.0, severity="bad", harms=harms)]


def polarity(record: Examined) -> list[HealthNotice]:
    """Find blows that are negative."""
    if not record.pulses or record.pulses[0].peak > 0.0:
        return []
    message = "the blows are negative: is the sensor mounted the other way? --polarity -1 turns it"
    return [HealthNotice("polarity", message, -1.0, severity="suspect")]


def cut(record: Examined) -> list[HealthNotice]:
    """Find a blow that runs into the begin or the end of the record."""
    findings = []
    for pulse in record.pulses:
        at_end = record.place(pulse.end) >= record.values.size - 2
        if at_end or math.isnan(pulse.width):
            where = "end" if at_end else "begin"
            message = f"the blow at {pulse.time:.6g}\xa0s is cut by the {where} of the record"
            findings.append(
                HealthNotice(
                    "cut", message, pulse.time, severity="suspect", harms=BLOW, start=pulse.begin, end=pulse.end
                )
            )
    return findings + [f for at_end in (False, True) for f in _part_of_blow(record, at_end)]


def _part_of_blow(record: Examined, at_end: bool) -> list[HealthNotice]:
    """Find that a record with whole blows begins or ends in another one, of which only a part is there."""
    if not record.pulses:
        return []
    pulse = record.pulses[-1 if at_end else 0]
    count = max(round(pulse.smooth.width() / record.step), FEWEST_OF_PART)
    beside = record.values[record.place(pulse.end) + count :] if at_end else record.values[: record.place(pulse.begin)]
    beside = math.copysign(1.0, pulse.peak) * ((beside[::-1] if at_end else beside) - pulse.offset)
    if beside.size < 4 * count:
        return []
    edge, quiet = beside[: 2 * count], beside[2 * count : 4 * count]
    height = float(np.median(edge[: max(count // 8, 2)]))
    stray = float(np.max(np.abs(quiet - np.median(quiet))))
    after = float(np.max(np.abs(edge[count:] - np.median(quiet))))
    if height - float(np.median(quiet)) < PART * abs(pulse.peak) or max(stray, after) > 0.5 * PART * abs(pulse.peak):
        return []
    where = "ends" if at_end else "begins"
    message = f"the record {where} in another blow, of which it holds a part only; its figures are not among these"
    place = record.start + record.step * (record.values.size - 1) if at_end else record.start
    return [HealthNotice("cut", message, place, start=place, end=place)]


def beyond_drop_height(record: Examined) -> list[HealthNotice]:
    """Find a velocity change that a fall from the stated height cannot give: sqrt(2 g h) to twice that."""
    if not (record.drop_height > 0.0 and record.unit == "m/s^2" and record.pulses):
        return []
    speed = math.sqrt(2.0 * STANDARD_GRAVITY * record.drop_height)
    change = max(abs(p.velocity_change) for p in record.pulses)
    if change > 2.0 * speed:
        message = (
            f"the velocity change, {change:.3g}\xa0m/s, is above twice the speed of the fall, {2.0 * speed:.3g}\xa0m/s"
        )
        return [
            HealthNotice("drop-height", message, change, severity="bad", harms=("peak", "velocity_change", "spectrum"))
        ]
    if change < MISSED_FALL * speed:
        message = f"the velocity change, {change:.3g}\xa0m/s, is below the speed of the fall, {speed:.3g}\xa0m/s"
        return [
            HealthNotice(
                "drop-height", message, change, severity="suspect", harms=("peak", "velocity_change", "spectrum")
            )
        ]
    return []
