"""AC coupling of a record: recognised by its blows and what follows them, and taken off."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from strikewave.records.measuring import RecordedPulse
from strikewave.records.tail import TailModel, model_of, tail_of
from strikewave.signal.coupling import ac_uncoupled

Array = NDArray[np.float64]


def coupling_of(values: Array, step: float, start: float, pulses: tuple[RecordedPulse, ...]) -> TailModel | None:
    """Return the AC coupling of a record; None where none is recognised.

    Examples
    --------
    >>> from strikewave.records import find_pulses
    >>> from strikewave.signal.coupling import ac_coupled
    >>> u = np.arange(4000) * 1e-3 - 1.0
    >>> blow = np.where((u > 0.0) & (u < 0.1), 1e3 * np.sin(10.0 * np.pi * u), 0.0)
    >>> values = ac_coupled(blow, 1e-5, 2e-3) + np.random.default_rng(1).normal(size=4000)
    >>> found = coupling_of(values, 1e-5, 0.0, tuple(find_pulses(values, 1e-5)))
    >>> round(1e3 * found.constant, 2)
    2.0
    """
    tail = tail_of(values, step, start, pulses)
    model = None if tail is None else model_of(tail)
    return model if model is not None and model.kind == "ac-coupling" else None


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
    plain = ac_uncoupled(values - zero, step, constant)
    wrong = 1.0 + step / constant * places
    rest = slice(round((last.end + AFTER * last.smooth.length - start) / step), None)
    if (values.size - rest.start) * step > constant:
        plain -= wrong * (float(np.sum(wrong[rest] * plain[rest])) / float(np.sum(wrong[rest] ** 2)))
    return np.asarray(zero + plain)
