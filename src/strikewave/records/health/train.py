"""Whether blows follow one another as blows of a test do: rebounds, double hits, missing blows."""

from __future__ import annotations

import math

import numpy as np

from strikewave.base.percents import percent
from strikewave.records.health.examined import BLOW, Examined
from strikewave.records.health_notice import HealthNotice
from strikewave.records.record import Array
from strikewave.records.robust import spread_of
from strikewave.records.trains import mains_period, missing_of

LISTED = 3
"""Places that a message names; the others are counted."""
DUE = 1.25
"""Periods of the mains before the first blow, or after the last, that hold a place where a blip is due: one and a
quarter, because a blip that the record cuts is not seen."""
EVEN, IN_TIME = 0.02, 0.001
"""Shares of their height, and of a period, by which blips of the mains scatter at most where no noise moves them: what
samples miss of a peak, and what a grid changes in a second."""
UNSURE = 3.0
"""Standard uncertainties within which they may scatter by their noise."""


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
    times = np.array([pulse.time for pulse in record.pulses])
    period = mains_period(times, np.array([pulse.smooth.width() for pulse in record.pulses]), locked=True)
    if not period > 0.0 or _struck(record, times, period):
        return []
    message = (
        f"the {len(record.pulses)} blows come every {1e3 * period:.5g}\xa0ms, in step with the mains of "
        f"{1.0 / period:.3g}\xa0Hz, equally high and through the whole record: they may be blips of a supply, and no "
        "blows; one record does not show which"
    )
    start, end = record.pulses[0].begin, record.pulses[-1].end
    return [HealthNotice("mains", message, period, severity="suspect", harms=(*BLOW, "interval"), start=start, end=end)]


def _struck(record: Examined, times: Array, period: float) -> bool:
    """Tell whether blows in step with the mains are struck by a machine all the same.

    The mains neither begin nor end within a record, make every blip alike, and keep their time: what is missing where
    one is due, scatters by more than its noise, or comes early or late by more than noise moves a peak, is struck.
    """
    pulses = record.pulses
    before, after = times[0] - record.start, record.time(record.values.size - 1) - times[-1]
    if max(before, after) > DUE * period:
        return True
    peaks = np.array([abs(pulse.peak) for pulse in pulses])
    doubts = np.array([pulse.uncertainty.peak for pulse in pulses])
    doubt = float(np.median(np.where(np.isfinite(doubts), doubts, record.scatter) / peaks))
    if spread_of(peaks) > max(EVEN, UNSURE * doubt) * float(np.median(peaks)):
        return True
    moved = doubt * float(np.median([pulse.smooth.width() for pulse in pulses]))  # a level off over the slope of a side
    resolved = UNSURE * math.sqrt(2.0) * math.hypot(moved, record.step / math.sqrt(12.0))
    return spread_of(np.diff(times)) > max(IN_TIME * period, resolved)
