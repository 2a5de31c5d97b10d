"""What is wrong with a response channel, which has no blow of its own, and what that does to its figures.

The checks of blows that presume no pulse are here again, a module a subject; see `strikewave.records.health`.
"""

from __future__ import annotations

from collections.abc import Callable

from strikewave.records.health.examined import dead
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
    >>> import numpy as np
    >>> from strikewave.records.response import BaseBlow, measure_responses
    >>> blows = [BaseBlow(2e-3, 3e-3, 4e-3, 1.0)]
    >>> still = np.full(1000, 3.0)
    >>> record = ExaminedResponse(still, 1e-5, 0.0, "", blows, measure_responses(still, 1e-5, 0.0, blows))
    >>> [finding.code for finding in examine_response(record)]
    ['dead']
    """
    silent = dead(record, RESPONSE_FIGURES) or nothing(record)
    return silent or worst_first(finding for check in RESPONSE_CHECKS for finding in check(record))
