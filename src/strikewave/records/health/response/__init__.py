"""What is wrong with a response channel, which has no blow of its own, and what that does to its figures.

The checks of blows that presume no pulse are here again, a module a subject; see `strikewave.records.health`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from strikewave.records.health.response.blows import cut, nothing
from strikewave.records.health.response.examined import ExaminedResponse
from strikewave.records.health.response.noise import hum, noise, short_before
from strikewave.records.health.response.range import clipped, coarse, compressed, saturated, slew_limited, spike
from strikewave.records.health.response.sampling import aliased, few_samples
from strikewave.records.health.response.zero import offset, shifted
from strikewave.records.health_notice import RESPONSE_FIGURES, HealthNotice, worst_first

__all__ = ["RESPONSE_CHECKS", "ExaminedResponse", "examine_response"]

RESPONSE_CHECKS: tuple[Callable[[ExaminedResponse], list[HealthNotice]], ...] = (
    clipped,
    saturated,
    compressed,
    slew_limited,
    spike,
    coarse,
    offset,
    shifted,
    hum,
    noise,
    few_samples,
    aliased,
    cut,
    short_before,
)
"""Every check of a channel that answers, in the order of their findings."""


def examine_response(record: ExaminedResponse) -> list[HealthNotice]:
    """Return everything that is wrong with a response channel, the worst first.

    Examples
    --------
    >>> from strikewave.records.response import BaseBlow, measure_responses
    >>> blows = [BaseBlow(2e-3, 3e-3, 4e-3, 1.0)]
    >>> still = np.full(1000, 3.0)
    >>> record = ExaminedResponse(still, 1e-5, 0.0, "", blows, measure_responses(still, 1e-5, 0.0, blows))
    >>> [finding.code for finding in examine_response(record)]
    ['dead']
    """
    if float(np.ptp(record.values)) == 0.0:
        message = f"every sample is {record.text(record.values[0])}: the channel is dead or not connected"
        return [HealthNotice("dead", message, float(record.values[0]), severity="bad", harms=RESPONSE_FIGURES)]
    silent = nothing(record)
    return silent or worst_first(finding for check in RESPONSE_CHECKS for finding in check(record))
