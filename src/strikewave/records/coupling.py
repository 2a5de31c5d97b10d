"""AC coupling of a record: recognised by its blows and what follows them, and taken off."""

from __future__ import annotations

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


def uncoupled(values: Array, step: float, start: float, first: RecordedPulse, constant: float) -> Array:
    """Return a record without its AC coupling; its zero is that before the first blow.

    Parameters
    ----------
    values : ndarray
        The record.
    step, start : float
        Time between samples, and of the first, s.
    first : RecordedPulse
        Its first blow.
    constant : float
        Time constant, s.
    """
    places = np.arange(values.size)
    zero = first.offset + first.baseline.slope * (places - (first.time - start) / step)
    return np.asarray(zero + ac_uncoupled(values - zero, step, constant))
