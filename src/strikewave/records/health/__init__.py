"""What is wrong with a record: each check is one short function that finds one fault.

A module a subject: blows, their train, zero, range, sampling, noise, ringing. Every check takes an `Examined` and
returns findings; `examine` asks them all.
"""

from __future__ import annotations

from strikewave.records.health.blows import beyond_drop_height, cut, no_pulse, polarity
from strikewave.records.health.examined import BLOW, Examined, dead
from strikewave.records.health.noise import noisy, short_before, uncertain
from strikewave.records.health.range import clipped, limited
from strikewave.records.health.ringing import larger_elsewhere, ringing
from strikewave.records.health.sampling import aliased, few_samples
from strikewave.records.health.train import double_hit, mains_blips, missing_blow, rebounds
from strikewave.records.health.zero import ac_coupling, level_step, no_foot, not_settled, velocity_drift, zero_shift
from strikewave.records.health_notice import FIGURES, HealthNotice, worst_first

__all__ = ["BLOW", "CHECKS", "Examined", "clipped", "examine", "level_step", "ringing"]

CHECKS = (
    not_settled,
    no_pulse,
    clipped,
    limited,
    zero_shift,
    ac_coupling,
    velocity_drift,
    few_samples,
    aliased,
    polarity,
    cut,
    no_foot,
    noisy,
    uncertain,
    short_before,
    ringing,
    larger_elsewhere,
    beyond_drop_height,
    rebounds,
    double_hit,
    missing_blow,
    mains_blips,
)
"""Every check, in the order of their findings: why no blow is seen, such as a record that begins in it, before that
none is."""


def examine(record: Examined) -> list[HealthNotice]:
    """Return everything that is wrong with a record, the worst first.

    Examples
    --------
    >>> import numpy as np
    >>> [finding.code for finding in examine(Examined(np.full(1000, 3.0), 1e-5))]
    ['dead']
    """
    return dead(record, FIGURES) or worst_first(finding for check in CHECKS for finding in check(record))
