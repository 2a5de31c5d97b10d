"""Checks of blows and of the responses to them: present, whole, large enough, alone, in a train."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.records.contacts import MAD_TO_SIGMA, mains_period, missing_of
from strikewave.records.health.sampled_record import Array, BlowRecord, ResponseRecord, SampledRecord
from strikewave.records.health_notice import Fault
from strikewave.records.measuring import RecordedPulse
from strikewave.records.response import MeasuredResponse
from strikewave.records.robust import spread_of
from strikewave.records.thresholds import OfBlows, OfResponses

LISTED = 3  # places that a message names; the others are counted


def dead(record: SampledRecord) -> Iterator[Fault]:
    """Find that every sample is the same."""
    if not float(np.ptp(record.values)):
        yield Fault(float(record.values[0]))


def only_swings(record: BlowRecord) -> Iterator[Fault]:
    """Find that nothing in the record is a blow, though it holds something; its spectrum is sound."""
    reach = float(np.ptp(record.values))
    if not record.pulses and reach > OfBlows.SPANS_NOISE * record.noise:
        yield Fault(0.0, {"reach": reach})


def only_noise(record: BlowRecord) -> Iterator[Fault]:
    """Find that the record holds nothing."""
    if not record.pulses and not float(np.ptp(record.values)) > OfBlows.SPANS_NOISE * record.noise:
        yield Fault(0.0)


def polarity(record: BlowRecord) -> Iterator[Fault]:
    """Find blows that are negative."""
    if record.pulses and not record.pulses[0].peak > 0.0:
        yield Fault(-1.0)


def cut(record: BlowRecord) -> Iterator[Fault]:
    """Find blows that run into the begin or the end of the record."""
    for pulse in record.pulses:
        at_end = record.place(pulse.end) >= record.values.size - 2
        if at_end or math.isnan(pulse.width):
            yield Fault(pulse.time, {"where": "end" if at_end else "begin"}, start=pulse.begin, end=pulse.end)


def part_of_blow(record: BlowRecord) -> Iterator[Fault]:
    """Find that a record with whole blows begins or ends in another one, of which only a part is there."""
    for at_end in (False, True):
        if record.pulses and _is_in_another(record, record.pulses[-1 if at_end else 0], at_end):
            place = record.start + record.step * (record.values.size - 1) if at_end else record.start
            yield Fault(place, {"where": "ends" if at_end else "begins"}, start=place, end=place)


def _is_in_another(record: BlowRecord, pulse: RecordedPulse, at_end: bool) -> bool:
    count = max(round(pulse.smooth.width() / record.step), OfBlows.FEWEST_OF_PART)
    beside = record.values[record.place(pulse.end) + count :] if at_end else record.values[: record.place(pulse.begin)]
    beside = math.copysign(1.0, pulse.peak) * ((beside[::-1] if at_end else beside) - pulse.offset)
    if beside.size < 4 * count:
        return False
    edge, quiet = beside[: 2 * count], beside[2 * count : 4 * count]
    level = float(np.median(quiet))
    height = float(np.median(edge[: max(count // 8, 2)]))
    stray = float(np.max(np.abs(quiet - level)))
    after = float(np.max(np.abs(edge[count:] - level)))
    least = OfBlows.PART * abs(pulse.peak)
    return height - level >= least and max(stray, after) <= 0.5 * least


def _fall(record: BlowRecord) -> tuple[float, float]:
    """Return the largest change of velocity, and the speed of the stated fall, m/s; NaN where none is stated."""
    if not (record.drop_height > 0.0 and record.unit == "m/s^2" and record.pulses):
        return math.nan, math.nan
    change = max(abs(pulse.velocity_change) for pulse in record.pulses)
    return change, math.sqrt(2.0 * STANDARD_GRAVITY * record.drop_height)


def above_fall(record: BlowRecord) -> Iterator[Fault]:
    """Find a velocity change that a fall from the stated height cannot give: sqrt(2 g h) to twice that."""
    change, speed = _fall(record)
    if change > 2.0 * speed:
        yield Fault(change, {"speed": 2.0 * speed})


def below_fall(record: BlowRecord) -> Iterator[Fault]:
    """Find a velocity change below the speed of a fall from the stated height."""
    change, speed = _fall(record)
    if change < OfBlows.MISSED_FALL * speed:
        yield Fault(change, {"speed": speed})


def rebounds(record: BlowRecord) -> Iterator[Fault]:
    """Find smaller contacts that belong to a blow: each is reported with it and counts as none."""
    owners = [pulse for pulse in record.pulses if pulse.rebounds]
    pairs = [(rebound, pulse) for pulse in owners for rebound in pulse.rebounds]
    if pairs:
        share = float(np.median([rebound.peak / pulse.peak for rebound, pulse in pairs]))
        lag = 1e3 * float(np.median([rebound.time - pulse.time for rebound, pulse in pairs]))
        where = f"{len(owners)} of {len(record.pulses)} blows" if len(record.pulses) > 1 else "the blow"
        details = {"count": len(pairs), "several": "s" if len(pairs) > 1 else "", "where": where, "lag": lag}
        yield Fault(share, details, start=pairs[0][0].time, end=pairs[-1][0].time)


def double_hit(record: BlowRecord) -> Iterator[Fault]:
    """Find two blows as large as one another, much closer than the blows of the record otherwise are."""
    double = record.contacts.double
    if double:
        later, earlier = min(double.items())
        first, second = record.pulses[earlier], record.pulses[later]
        details = {
            "first": first.time, "second": second.time, "apart": 1e3 * abs(second.time - first.time),
            "peak": first.peak, "other": second.peak,
            "several": f" and {len(double) - 1} more" if len(double) > 1 else "",
        }  # fmt: skip
        yield Fault(len(double), details, start=first.begin, end=second.end)


def missing_blow(record: BlowRecord) -> Iterator[Fault]:
    """Find gaps of two periods and more in a train of blows."""
    contacts = record.contacts
    places = missing_of(np.array([pulse.time for pulse in record.pulses]), contacts)
    if places and contacts.train is not None:
        listed = ", ".join(f"{place:.6g}\xa0s" for place in places[:LISTED])
        more = f" and {len(places) - LISTED} more" if len(places) > LISTED else ""
        details = {"places": listed + more, "period": 1e3 * contacts.train.period}
        yield Fault(len(places), details, start=places[0], end=places[-1])


def mains_blips(record: BlowRecord) -> Iterator[Fault]:
    """Find blows in step with the mains, 50 or 60 Hz: they may be blips of a supply, and no blows."""
    times = np.array([pulse.time for pulse in record.pulses])
    period = mains_period(times, np.array([pulse.smooth.width() for pulse in record.pulses]), locked=True)
    if period > 0.0 and not _struck(record, times, period):
        details = {"count": len(record.pulses), "period": 1e3 * period, "frequency": 1.0 / period}
        yield Fault(period, details, start=record.pulses[0].begin, end=record.pulses[-1].end)


def _struck(record: BlowRecord, times: Array, period: float) -> bool:
    """Tell whether blows in step with the mains are struck by a machine all the same.

    The mains neither begin nor end within a record, make every blip alike, and keep their time: what is missing where
    one is due, scatters by more than its noise, or comes early or late by more than noise moves a peak, is struck.
    """
    pulses = record.pulses
    before, after = times[0] - record.start, record.time(record.values.size - 1) - times[-1]
    if max(before, after) > OfBlows.DUE * period:
        return True
    peaks = np.array([abs(pulse.peak) for pulse in pulses])
    doubts = np.array([pulse.uncertainty.peak for pulse in pulses])
    doubt = float(np.median(np.where(np.isfinite(doubts), doubts, record.scatter) / peaks))
    if spread_of(peaks) > max(OfBlows.EVEN, OfBlows.UNSURE * doubt) * float(np.median(peaks)):
        return True
    moved = doubt * float(np.median([pulse.smooth.width() for pulse in pulses]))  # a level off over the slope of a side
    resolved = OfBlows.UNSURE * math.sqrt(2.0) * math.hypot(moved, record.step / math.sqrt(12.0))
    return spread_of(np.diff(times)) > max(OfBlows.IN_TIME * period, resolved)


def _unanswered(record: ResponseRecord) -> bool:
    """Tell whether the channel does not answer the blow of its base."""
    before = float(np.max(np.abs(record.above[: record.first]), initial=0.0))
    level = max(OfResponses.STANDS_OUT * record.noise, OfResponses.OVER_BEFORE * before)
    return not abs(record.largest.peak) > level


def early(record: ResponseRecord) -> Iterator[Fault]:
    """Find that the channel comes before the first blow of its base instead of answering it.

    After a single blow it does less than before it; after the first of several it answers the next, early too.
    """
    before, highest = record.above[: record.first], abs(record.largest.peak)
    if not before.size or not _unanswered(record):
        return
    noise = MAD_TO_SIGMA * float(np.median(np.abs(record.above)))  # of all, as noise that wanders is quiet at times
    top = int(np.argmax(np.abs(before)))
    peak, alone = abs(float(before[top])), len(record.blows) == 1
    if peak > max(OfResponses.STANDS_OUT * noise, OfResponses.OVER_BEFORE * highest if alone else 0.0):
        lead = 1e3 * (record.blows[0].time - (record.start + top * record.step))
        yield Fault(highest, {"peak": peak, "lead": lead, "blow": "the blow" if alone else "the first blow"})


def no_answer(record: ResponseRecord) -> Iterator[Fault]:
    """Find that the channel reaches no more after the blows of its base than before them."""
    if _unanswered(record):
        yield Fault(abs(record.largest.peak))


def cut_response(record: ResponseRecord) -> Iterator[Fault]:
    """Find responses that have not fallen below a third of their peak when the record ends, or the next blow comes."""
    lasting = [response for response in record.responses if _goes_on(record, response)]
    if lasting:
        first, count = lasting[0], len(record.responses)
        at_end = record.span(first)[1] == record.values.size
        details = {
            "what": "the record ends" if at_end else "the next blow comes",
            "several": f" ({len(lasting)} of {count} responses)" if count > 1 else "",
        }
        yield Fault(first.begin + first.duration, details, start=first.begin + first.duration)


def _goes_on(record: ResponseRecord, response: MeasuredResponse) -> bool:
    end = record.start + record.span(response)[1] * record.step
    return end - (response.begin + response.duration) < 0.5 * record.period + record.step
