"""Several measurements in one file: where time begins anew, and the record of each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from strikewave.base.errors import InputError
from strikewave.records.record import Array, Channel, Record

FEWEST_SAMPLES = 16
"""A shorter piece is no measurement: no blow has so few samples, and a clock that is often set back makes such ones."""
MOST_MEASUREMENTS = 1000
"""Measurements of a file that are read: each is examined as a record of its own."""
BACK = 0.5
"""Share of a piece by which time must fall back behind it: a new measurement begins about where the one before did, and
a clock that is set right in between moves by less."""


def apart(record: Record) -> Record:
    """Part a record where the time of all its channels begins anew; the first piece has the others in ``further``.

    A record whose time runs backwards in any other way is left as it is, for the checks of health.

    Raises
    ------
    InputError
        If there are more than `MOST_MEASUREMENTS`.

    Examples
    --------
    >>> time = np.tile(np.arange(20.0), 2)
    >>> record = apart(Record("a.csv", "text", (Channel("board", time, 1.0, stamps=time),)))
    >>> record.channels[0].values.size, len(record.further)
    (20, 1)
    """
    if record.further or not record.channels:
        return record
    by_clock: dict[int, list[int]] = {}
    for channel in record.channels:
        if channel.stamps is None:
            return record
        if id(channel.stamps) not in by_clock:
            by_clock[id(channel.stamps)] = restarts(channel.stamps)
    first, *others = by_clock.values()
    sizes = {channel.values.size for channel in record.channels}
    if not first or len(sizes) > 1 or any(other != first for other in others):
        return record
    return parted(record, first)


def restarts(stamps: Array) -> list[int]:
    """Return the places at which time begins anew; none where a piece would be no measurement.

    Examples
    --------
    >>> restarts(np.tile(np.arange(20.0), 3)), restarts(np.array([0.0, 1.0, 0.5, 2.0]))
    ([20, 40], [])
    """
    with np.errstate(invalid="ignore"):
        back = np.flatnonzero(np.diff(stamps) < 0.0) + 1
    edges = [0, *back.tolist(), stamps.size]
    if not back.size or min(end - begin for begin, end in pairwise(edges)) < FEWEST_SAMPLES:
        return []
    spans = [(float(stamps[begin]), float(stamps[end - 1])) for begin, end in pairwise(edges)]
    if any(start > first + (1.0 - BACK) * (last - first) for (first, last), (start, _) in pairwise(spans)):
        return []
    return [int(place) for place in back]


def parted(record: Record, places: Sequence[int]) -> Record:
    """Part a record at places that hold for all its channels; what begins without stamps begins at its own start.

    Raises
    ------
    InputError
        If there are more than `MOST_MEASUREMENTS`.
    """
    size = max(channel.values.size for channel in record.channels)
    return joined_pieces(
        [
            replace(record, channels=tuple(_cut(channel, begin, end) for channel in record.channels))
            for begin, end in pairwise([0, *places, size])
        ]
    )


def joined_pieces(pieces: Sequence[Record]) -> Record:
    """Return the first of several measurements, with the others behind it.

    Raises
    ------
    InputError
        If there are more than `MOST_MEASUREMENTS`.
    """
    first, *further = pieces
    if len(pieces) > MOST_MEASUREMENTS:
        allowed = f"a file with at most {MOST_MEASUREMENTS} measurements"
        raise InputError("FILE", first.path, allowed, f"it has {len(pieces)}: split it")
    return replace(first, further=tuple(further))


def _cut(channel: Channel, begin: int, end: int) -> Channel:
    """Return a channel from one sample to another, over a time of its own."""
    stamps = None if channel.stamps is None else channel.stamps[begin:end]
    start = channel.start if stamps is None or not stamps.size else float(stamps[0])
    return replace(channel, values=channel.values[begin:end], stamps=stamps, start=start)
