"""Whether blows follow one another as blows of a test do: rebounds, double hits, missing blows."""

from __future__ import annotations

import numpy as np

from strikewave.base.percents import percent
from strikewave.records.health.examined import BLOW, Examined
from strikewave.records.health_notice import HealthNotice
from strikewave.records.trains import mains_period, missing_of

LISTED = 3
"""Places that a message names; the others are counted."""


def rebounds(record: Examined) -> list[HealthNotice]:
    """Find smaller contacts that belong to a blow: each is reported with it and counts as none."""
    owners = [pulse for pulse in record.pulses if pulse.rebounds]
    if not owners:
        return []
    every = [rebound for pulse in owners for rebound in pulse.rebounds]
    share = float(np.median([rebound.peak / pulse.peak for pulse in owners for rebound in pulse.rebounds]))
    lag = float(np.median([rebound.time - pulse.time for pulse in owners for rebound in pulse.rebounds]))
    where = f"{len(owners)} of {len(record.pulses)} blows" if len(record.pulses) > 1 else "the blow"
    message = (
        f"{len(every)} smaller contact{'s' if len(every) > 1 else ''} beside {where}, {percent(share, 0)} of the peak, "
        f"{1e3 * lag:.4g}\xa0ms after it: no blow{'s' if len(every) > 1 else ''}, but rebounds"
    )
    first = owners[0].rebounds[0]
    return [HealthNotice("rebound", message, share, severity="good", start=first.time, end=every[-1].time)]


def double_hit(record: Examined) -> list[HealthNotice]:
    """Find two blows as large as one another, much closer than the blows of the record otherwise are."""
    contacts = record.contacts
    if not contacts.double:
        return []
    later, earlier = min(contacts.double.items())
    first, second = record.pulses[earlier], record.pulses[later]
    several = f" and {len(contacts.double) - 1} more" if len(contacts.double) > 1 else ""
    message = (
        f"two blows at {first.time:.6g}\xa0s and {second.time:.6g}\xa0s{several}, of {record.text(first.peak)} and "
        f"{record.text(second.peak)}, {1e3 * abs(second.time - first.time):.4g}\xa0ms apart: a double hit; both count"
    )
    return [HealthNotice("double-hit", message, len(contacts.double), start=first.begin, end=second.end)]


def missing_blow(record: Examined) -> list[HealthNotice]:
    """Find gaps of two periods and more in a train of blows."""
    contacts = record.contacts
    places = missing_of(np.array([pulse.time for pulse in record.pulses]), contacts)
    if not places or contacts.train is None:
        return []
    listed = ", ".join(f"{place:.6g}\xa0s" for place in places[:LISTED])
    more = f" and {len(places) - LISTED} more" if len(places) > LISTED else ""
    message = (
        f"no blow at {listed}{more}, where one is due: the others come every {1e3 * contacts.train.period:.5g}\xa0ms; "
        "the gaps are left out of the interval"
    )
    return [HealthNotice("missing-blow", message, len(places), severity="suspect", start=places[0], end=places[-1])]


def mains_blips(record: Examined) -> list[HealthNotice]:
    """Find blows in step with the mains, 50 or 60 Hz: they may be blips of a supply, and no blows."""
    period = mains_period(np.array([pulse.time for pulse in record.pulses]), locked=True)
    if not period > 0.0:
        return []
    message = (
        f"the {len(record.pulses)} blows come every {1e3 * period:.5g}\xa0ms, in step with the mains of "
        f"{1.0 / period:.3g}\xa0Hz: they may be blips of a supply, and no blows; one record does not show which"
    )
    start, end = record.pulses[0].begin, record.pulses[-1].end
    return [HealthNotice("mains", message, period, severity="suspect", harms=(*BLOW, "interval"), start=start, end=end)]
