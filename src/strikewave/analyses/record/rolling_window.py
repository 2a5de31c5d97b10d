"""What a spectrum is asked for by: its quality factor, and the window of a rolling one, as they are typed."""

from __future__ import annotations

import math
from typing import NamedTuple

from strikewave.base.errors import InputError
from strikewave.base.units import parse_quantity

ALLOWED_Q = "a quality factor above zero, such as 10 for 5 % of critical damping, or inf"
HOP = 0.25
"""Hop of a rolling spectrum over its window, unless said: a blow then lies well inside of one of four windows."""


class Rolling(NamedTuple):
    """Window and hop of a rolling spectrum, s, and how they were typed."""

    window: float
    hop: float
    word: str


def read_rolling(word: str, field: str) -> Rolling:
    """Return a window, and a hop after a comma.

    Examples
    --------
    >>> read_rolling("20 ms,5 ms", "--rolling")[:2], read_rolling("20 ms", "--rolling")[:2]
    ((0.02, 0.005), (0.02, 0.005))
    """
    allowed = 'a window, or a window and a hop, times above zero such as "20 ms" or "20 ms,5 ms"'
    try:
        times = [parse_quantity(part.strip(), "s", field) for part in word.split(",")]
    except InputError as error:
        raise InputError(field, word, allowed) from error
    if len(times) > 2 or not all(0.0 < time < math.inf for time in times):
        raise InputError(field, word, allowed)
    return Rolling(times[0], times[-1] if len(times) > 1 else HOP * times[0], word)
