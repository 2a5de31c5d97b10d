"""A channel that does not answer the blow of its base, or comes before it, and responses that are cut off."""

from __future__ import annotations

import numpy as np

from strikewave.records.health.response.examined import STANDS_OUT, Array, ExaminedResponse
from strikewave.records.health_notice import RESPONSE_FIGURES, HealthNotice
from strikewave.records.pulses import MAD_TO_SIGMA

OVER_BEFORE = 2.0
"""Times the largest value before the blow that a response must reach."""


def nothing(record: ExaminedResponse) -> list[HealthNotice]:
    """Find that the channel does not answer the blow of its base."""
    before = record.above[: record.first]
    level = max(STANDS_OUT * record.noise, OVER_BEFORE * float(np.max(np.abs(before), initial=0.0)))
    highest = abs(record.largest.peak)
    if highest > level:
        return []
    message = _early(record, before, highest) or (
        f"after the blows of the base the channel reaches {record.text(highest)}, no more than before them: it is not "
        "connected, or does not answer"
    )
    return [HealthNotice("no-response", message, highest, severity="bad", harms=RESPONSE_FIGURES)]


def _early(record: ExaminedResponse, before: Array, highest: float) -> str:
    """Say by how much the channel comes before the first blow of its base; empty where it does not.

    After a single blow it does less than before it; after the first of several it answers the next, early too.
    """
    if not before.size:
        return ""
    noise = MAD_TO_SIGMA * float(np.median(np.abs(record.above)))  # of all, as noise that wanders is quiet at times
    top = int(np.argmax(np.abs(before)))
    peak = abs(float(before[top]))
    if peak <= max(STANDS_OUT * noise, OVER_BEFORE * highest if len(record.blows) == 1 else 0.0):
        return ""
    first = record.blows[0]
    lead = first.time - (record.start + top * record.step)
    blow = "the blow" if len(record.blows) == 1 else "the first blow"
    return (
        f"the channel reaches {record.text(peak)} {1e3 * lead:.3g}\xa0ms before the peak of {blow} of the base, and "
        f"{record.text(highest)} after {blow} begins: it comes before what should drive it. Look at the names of the "
        "channels, at their clocks and at the choice of --base"
    )


def cut(record: ExaminedResponse) -> list[HealthNotice]:
    """Find responses that have not fallen below a third of their peak when the record ends, or the next blow comes."""
    open_ = []
    for one in record.responses:
        end = record.span(one)[1]
        if record.start + end * record.step - (one.begin + one.duration) < 0.5 * record.period + record.step:
            open_.append((one, end == record.values.size))
    if not open_:
        return []
    one, at_end = open_[0]
    what = "the record ends" if at_end else "the next blow comes"
    several = f" ({len(open_)} of {len(record.responses)} responses)" if len(record.responses) > 1 else ""
    message = f"{what} before the response falls below a third of its peak{several}: it lasts longer"
    end_time = one.begin + one.duration
    return [HealthNotice("cut", message, end_time, harms=("duration", "rms"), start=end_time)]
