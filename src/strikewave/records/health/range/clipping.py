"""Where a recorder's range ends: records that stop at one value."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from strikewave.records.health.examined import BLOW, Examined
from strikewave.records.health_notice import HealthNotice

Array = NDArray[np.float64]

FEWEST_AT_RAIL = 3
"""Samples at the largest value, and times those beside it, that make a rail; see `rail`."""
LEVELS_LOOKED_AT = 4096
"""Samples in which at least three different values stand, or the record is a switch or a count, and has no rail."""
NEAR_TOP = 0.05
"""Share of the span below the largest value in which the steps of the converter are looked for."""
OFF_ZERO = 0.01
"""Share of the span, or three steps of the converter, that a rail lies off the zero: the quiet zero is no rail."""
BESIDE, SHORT_RUN = 3, 6
"""Samples to either side of a run at a rail through which a parabola is laid, and longest run for which it is."""
BESIDE_RAIL = 2.5
"""Steps of the converter below the largest value that count as beside it: the next two."""


def clipped(record: Examined) -> list[HealthNotice]:
    """Find where the record stops at one value again and again: the recorder's range ended there.

    A plateau of a rounded top in a coarse recorder is no clipping: there the steps beside it are long too. Neither is
    the quiet zero of a record that goes to one side of it only.
    """
    findings = []
    pulse = record.largest
    zero = float(np.median(record.values)) if pulse is None else pulse.offset
    for sign in (1.0, -1.0):
        at = rail(sign * record.values, sign * zero)
        if not at.size:
            continue
        level = float(record.values[at[0]])
        if level == 0.0 and 0.0 in (record.values[0], record.values[-1]):
            continue  # zeros before or after a blow, as a simulation or an edited record has them
        struck = [p for p in record.pulses if np.any((at >= record.place(p.begin)) & (at <= record.place(p.end)))]
        where = f"in {len(struck)} of {len(record.pulses)} blows" if struck else "outside the blows"
        message = (
            f"clipped at {record.text(level)} for {at.size * record.step * 1e6:.4g}\xa0us {where}: the true peak "
            "is larger"
        )
        severity, harms = ("bad", BLOW) if struck else ("suspect", ("ringing_frequency", "spectrum"))
        begin, end = record.time(int(at[0])), record.time(int(at[-1]))
        findings.append(HealthNotice("clipped", message, level, severity=severity, harms=harms, start=begin, end=end))
    return findings


def rail(values: Array, zero: float) -> NDArray[np.intp]:
    """Return the samples at the largest value where a recorder stopped there; none where the record turned there.

    A round top at k steps of the converter has about 1 : 0.7 samples in its highest and the next two; a rail has
    three times as many at it as beside it, and at least three.
    """
    level, none = float(np.max(values)), np.empty(0, dtype=np.intp)
    span = level - float(np.min(values))
    at = np.flatnonzero(values == level)
    if at.size < FEWEST_AT_RAIL or np.unique(values[:: max(values.size // LEVELS_LOOKED_AT, 1)]).size < 3:
        return none
    near = values[values >= level - NEAR_TOP * span]
    steps = np.diff(np.unique(near))
    resolution = float(np.min(steps)) if steps.size else NEAR_TOP * span
    if level - zero <= max(3.0 * resolution, OFF_ZERO * span):
        return none
    beside = int(np.count_nonzero(near >= level - BESIDE_RAIL * resolution)) - at.size
    if at.size < FEWEST_AT_RAIL * max(beside, 1):
        return none
    return at if _cut_off(values, level) > resolution else none


def _cut_off(values: Array, level: float) -> float:
    """Return how far the parabola through both sides of the longest run at a level goes above it.

    A round top turns within a step of its converter. Infinite where a side is missing, or the run is long.
    """
    first, last = _longest_run(values == level)
    if last - first + 1 > SHORT_RUN or first < BESIDE or last + BESIDE >= values.size:
        return math.inf
    beside = np.concatenate([np.arange(first - BESIDE, first), np.arange(last + 1, last + 1 + BESIDE)])
    place = beside - 0.5 * (first + last)
    return float(np.polynomial.polynomial.polyfit(place, values[beside], 2)[0]) - level


def _longest_run(flags: NDArray[np.bool_]) -> tuple[int, int]:
    """Return first and last place of the longest run of true; (0, -1) where there is none."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    if not edges.size:
        return 0, -1
    k = int(np.argmax(edges[1::2] - edges[::2]))
    return int(edges[2 * k]), int(edges[2 * k + 1]) - 1
