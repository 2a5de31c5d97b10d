"""Swings of few samples, and a spectrum folded into the record."""

from __future__ import annotations

import math

from strikewave.base.percents import percent
from strikewave.records.health.response.examined import ExaminedResponse, finding
from strikewave.records.health.sampling import folded_level
from strikewave.records.health_notice import RESPONSE_FIGURES, HealthNotice
from strikewave.records.modes import FEWEST
from strikewave.records.response import ROUND

FEW, TOO_FEW = 8.0, 6.0
"""Samples of a swing at which a parabola through three may miss 0.9 and 2.6 % of a top; below six none is round."""
COUNTS = 0.2
"""Share of the peak that a mode must have for its samples to count."""


def few_samples(record: ExaminedResponse) -> list[HealthNotice]:
    """Find swings of few samples: between two of them the peak is missed."""
    modes = [mode for one in record.responses for mode in one.modes if mode.amplitude > COUNTS * abs(one.peak)]
    if not modes:
        return []
    count = 1.0 / (max(mode.frequency for mode in modes) * record.step)
    if count >= FEW:
        return []
    message = f"a swing of {1.0 / (count * record.step):.4g} Hz has {count:.1f} samples; sample faster"
    effects = {**record.moved_by(_missed(count) * record.peak), "peak": -_missed(count)}
    return [finding("few-samples", message, count, effects)]


def _missed(count: float) -> float:
    """Return by how much the top of a sine of so many samples a swing may be missed.

    Examples
    --------
    >>> round(_missed(8.0), 4), round(_missed(5.0), 2)
    (0.0085, 0.19)
    """
    beside, far = math.cos(math.pi / count), math.cos(3.0 * math.pi / count)
    if far < ROUND * beside and count < TOO_FEW:
        return 1.0 - beside
    return 1.0 - beside - 0.125 * (beside - far)


def aliased(record: ExaminedResponse) -> list[HealthNotice]:
    """Find a spectrum that has not fallen off at half the sampling rate: what lies above is folded into it."""
    one = record.largest
    begin, end = record.span(one)
    last = min(max(record.place(one.decay.end), begin + 2 * FEWEST), end)
    first = max(begin - (last - begin), 0)  # a window of its own length before it: the onset is in its middle
    level = folded_level(record.above[first:last], record.noise)
    if level is None:
        return []
    message = (
        f"at half the sampling rate the spectrum still has {percent(level)} of its largest value: what lies above was "
        "folded into the record; sample faster or filter before"
    )
    return [HealthNotice("alias", message, level, harms=RESPONSE_FIGURES)]
