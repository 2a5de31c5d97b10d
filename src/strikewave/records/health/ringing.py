"""What swings after a blow, or without one."""

from __future__ import annotations

import numpy as np

from strikewave.records.health.examined import BLOW, FEWEST_OF_PART, Examined
from strikewave.records.health_notice import HealthNotice

AFTER_BLOW, RINGS_WITHIN = 0.25, 5.0
"""Widths after the feet of a blow from which on, and up to which, its ringing is taken: beside the foot, before it
dies."""
NOTED_RINGING, STRONG_RINGING, NOISES_OF_RINGING = 0.15, 0.6, 5.0
"""Shares of the peak by which a ringing record swings: noted, and so much that the peak may be ringing; it
swings by five standard deviations of noise at least."""
HIGHER = 5.0
"""Standard deviations that a record goes higher outside the blows than in them: noise alone does not in any record."""


def ringing(record: Examined) -> list[HealthNotice]:
    """Find a blow after which the record swings by much of its peak: its peak and width hold that ringing too."""
    pulse = record.largest
    if pulse is None or not pulse.width > 0.0:
        return []
    until = pulse.end + RINGS_WITHIN * pulse.width
    begin = record.place(pulse.end + AFTER_BLOW * pulse.width)
    after = record.values[begin : record.place(until)] - pulse.offset
    others = [p for p in record.pulses if p is not pulse and p.begin < until and p.end > pulse.end]
    if after.size < FEWEST_OF_PART or others:
        return []
    swing = 0.5 * float(np.ptp(after))
    share = swing / abs(pulse.peak)
    if share < NOTED_RINGING or swing < NOISES_OF_RINGING * pulse.noise:
        return []
    message = (
        f"after the blow the record swings by {share:.0%} of the peak: peak, rise and width hold such ringing too; "
        "see the smooth pulse, or filter"
    )
    severity, harms = ("suspect", ("peak", "rise", "width")) if share > STRONG_RINGING else ("good", ())
    return [HealthNotice("ringing", message, share, severity=severity, harms=harms, start=pulse.end)]


def larger_elsewhere(record: Examined) -> list[HealthNotice]:
    """Find a record that goes higher outside the blows than in them: it swings rather than being struck."""
    pulse = record.largest
    if pulse is None:
        return []
    away = np.ones(record.values.size, dtype=bool)
    for blow in record.pulses:
        away[record.place(blow.begin) : record.place(blow.end) + 1] = False
    if not away.any():
        return []
    highest = float(np.max(np.abs(record.values[away] - pulse.offset)))
    if highest <= abs(pulse.peak) + HIGHER * pulse.noise:
        return []
    message = (
        f"outside the blows the record reaches {record.text(highest)}, more than their peak "
        f"{record.text(abs(pulse.peak))}: it swings; take the shock response spectrum rather than the pulse"
    )
    return [HealthNotice("swings", message, highest, severity="suspect", harms=BLOW)]
