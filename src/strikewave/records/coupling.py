"""AC coupling taken off a record; `strikewave.records.tail` recognises it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from strikewave.records.measuring import RecordedPulse
from strikewave.signal.coupling import ac_uncoupled

Array = NDArray[np.float64]


AFTER = 5.0
"""Widths after the last blow from which on a record is taken to be at rest."""


def uncoupled(values: Array, step: float, start: float, pulses: Sequence[RecordedPulse], constant: float) -> Array:
    """Return a record without its AC coupling; its zero is that before the first blow.

    What is wrong with that zero is integrated, and grows as 1 + t / tau: it is made so small that the record comes to
    rest after its last blow.

    Parameters
    ----------
    values : ndarray
        The record.
    step, start : float
        Time between samples, and of the first, s.
    pulses : sequence of RecordedPulse
        Its blows.
    constant : float
        Time constant, s.
    """
    first, last = pulses[0], pulses[-1]
    places = np.arange(values.size)
    zero = first.offset + first.baseline.slope * (places - (first.time - start) / step)
    rest = round((last.end + AFTER * last.smooth.length - start) / step)
    return np.asarray(zero + resting(values - zero, step, constant, rest))


def resting(above: Array, step: float, constant: float, rest: int) -> Array:
    """Return values above their zero without AC coupling, at rest from a sample on, where that lasts long enough.

    Examples
    --------
    >>> from strikewave.signal.coupling import ac_coupled
    >>> blow = np.r_[np.zeros(20), np.ones(10), np.zeros(500)]
    >>> bool(np.allclose(resting(ac_coupled(blow, 1e-3, 0.1) + 1e-3, 1e-3, 0.1, 40), blow, atol=1e-3))
    True
    """
    plain = ac_uncoupled(above, step, constant)
    wrong = 1.0 + step / constant * np.arange(above.size)
    if (above.size - rest) * step > constant:
        plain -= wrong * (float(np.sum(wrong[rest:] * plain[rest:])) / float(np.sum(wrong[rest:] ** 2)))
    return plain
