"""Models of the zero of a record after its blows: rest, a shift, a line, an exponential, or AC coupling.

A high-pass of first order with time constant tau makes y of x by x = y + (1/tau) int y dt. Where nothing moves, x is
zero, and y = -v / tau, where v is the integral of y: the undershoot after a blow is the velocity change over tau, and
dies out with the same tau. One number explains both; what is shifted or warmed has an amplitude of its own, and what
moves begins from zero. What is recognised so can be taken off.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from strikewave.records.measuring import RecordedPulse
from strikewave.records.record import Array
from strikewave.records.robust import alike_as_one
from strikewave.records.thresholds import OfTails
from strikewave.signal.filters import ac_uncoupled
from strikewave.signal.motion import integral

AFTER = 0.15  # widths after a blow from which on its tail is looked at
# Times that each half of a stretch is as long as the one before, from a width on: both a fast decay and a long one are
# followed by some dozens of them. Stretches overlap by half, and are weighted as Hann's window does: what swings once
# in a width, or faster, has no mean.
GROWS = 1.15
WINDOW = 5.0  # time constants over which a decay is looked at: it has died out by then
ROUNDS = 6  # rounds of narrowing the window to the time constant found
LAST_THIRD = 3  # divisor of the number of stretches of a tail: the last third show where the record stands at last
RATES = 120  # time constants tried for a free exponential


class Tail(NamedTuple):
    """The record after a blow, in stretches."""

    time: Array  # since the end of the blow, s
    level: Array  # mean above the baseline before the first blow
    velocity: Array  # mean of the integral of the record from before the first blow on
    one_side: float = 1.0  # share of the samples of the first stretch that have the sign of its level
    # Mean of the integral over the baseline before this blow, from before it on; that of ``velocity`` by default
    moved: Array | None = None


class TailModel(NamedTuple):
    """Model of a tail."""

    # ``rest``, ``shift``, ``line``, ``decay``, ``ac-coupling``, or ``motion`` where none of these explains it
    kind: str
    # Level and its error: of the shift, of a decay at the end of the blow, or of a line at its last stretch
    level: float = 0.0
    level_error: float = math.nan
    # Time constant of a decay, s
    constant: float = math.nan
    constant_error: float = math.nan
    explained: float = 0.0  # share of the squares of the tail


def tail_of(values: Array, step: float, start: float, pulses: Sequence[RecordedPulse]) -> Tail | None:
    """Return the longest tail after a blow; None where none is long enough."""
    if not pulses:
        return None
    first = pulses[0]
    lasts = [pulses[k + 1].begin if k + 1 < len(pulses) else start + step * values.size for k in range(len(pulses))]
    longest = max(range(len(pulses)), key=lambda k: lasts[k] - pulses[k].end)
    pulse = pulses[longest]
    width = max((pulse.width if pulse.width > 0.0 else pulse.smooth.width()) / step, 1.0)
    begin = max(round((pulse.end - start) / step + AFTER * width), 0)
    end = min(round((lasts[longest] - start) / step - width * (longest + 1 < len(pulses))), values.size)
    edges = [begin]
    size = max(width, 2.0)
    while edges[-1] + size <= end:
        edges.append(edges[-1] + round(size))
        size *= GROWS
    if len(edges) - 2 < OfTails.FEWEST:
        return None
    origin = max(round((first.begin - start) / step - width), 0)
    places = np.arange(origin, edges[-1], dtype=np.float64)
    middle = (first.time - start) / step
    above = values[origin : edges[-1]] - first.offset - _carried_slope(pulses, step) * (places - middle)
    velocity = integral(above, step)
    own = max(round((pulse.begin - start) / step - width), origin)
    moved = integral(values[own : edges[-1]] - pulse.offset, step)
    rows = []
    for low, high in zip(edges[:-2], edges[2:], strict=True):
        weights = np.hanning(high - low + 2)[1:-1]
        part = slice(low - origin, high - origin)
        weights /= np.sum(weights)
        middle = start + step * 0.5 * (low + high - 1) - pulse.end
        since = weights @ moved[low - own : high - own]
        rows.append((middle, float(weights @ above[part]), float(weights @ velocity[part]), float(since)))
    near = above[edges[0] - origin : edges[2] - origin]
    one_side = float(np.mean(np.sign(near) == math.copysign(1.0, rows[0][1])))
    time, level, velocities, moved_by = np.array(rows).T
    return Tail(time, level, velocities, one_side, moved_by)


def _carried_slope(pulses: Sequence[RecordedPulse], step: float) -> float:
    """Return the slope a sample of the baseline before the first blow, or none where that before later ones has not it.

    What a machine does before its first blow, such as a feed that comes to rest, is over at the next.
    """
    first, later = pulses[0], pulses[1:]
    slope = first.baseline.slope
    off_line = sum(abs(p.offset - first.offset - slope * (p.time - first.time) / step) for p in later)
    return slope if off_line <= sum(abs(p.offset - first.offset) for p in later) else 0.0


def comes_to_rest(tail: Tail) -> bool:
    """Tell whether the velocity after a blow goes to the other side and comes back: what was struck moves, no zero."""
    velocity = tail.velocity if tail.moved is None else tail.moved
    velocity = math.copysign(1.0, float(velocity[0])) * velocity
    farthest = np.minimum.accumulate(velocity)
    rests = (farthest < -OfTails.REVERSED * velocity[0]) & (velocity > OfTails.AT_REST * farthest)
    if not rests.any():
        return False
    returned = int(np.argmax(rests))
    turned = int(np.argmin(velocity[: returned + 1]))
    pushed = float(velocity[returned] - velocity[turned]) / float(tail.time[returned] - tail.time[turned])
    last = slice(-max(velocity.size // LAST_THIRD, 2), None)
    stands = float(np.polyfit(tail.time[last], velocity[last], 1)[0])  # off the baseline before this blow
    return pushed > OfTails.PUSHED * abs(stands)


def _at_last(tail: Tail) -> tuple[float, float]:
    """Return where the record stands in the last third of a tail, and the standard error of that."""
    last = tail.level[-max(tail.level.size // LAST_THIRD, 2) :]
    return float(np.mean(last)), float(np.std(last, ddof=1)) / math.sqrt(last.size)


def model_of(tail: Tail) -> TailModel:
    """Return the model that explains a tail best, at the cost of its parameters."""
    if comes_to_rest(tail):
        level, error = _at_last(tail)
        return TailModel("shift" if abs(level) > OfTails.SURE * error else "motion", level, error)
    coupled = _coupled(tail)
    if coupled is not None:
        return coupled
    n = tail.time.size
    ones = np.ones(n)
    fits = {"rest": (np.zeros(n), 0), "shift": (_on(tail.level, ones), 1), "line": (_on(tail.level, tail.time), 1)}
    decay, constant = _decay(tail.time, tail.level)
    fits["decay"] = (decay, 2)
    squares = {kind: float(np.sum((tail.level - fitted) ** 2)) for kind, (fitted, _) in fits.items()}
    total = squares["rest"]
    if total <= 0.0:
        return TailModel("rest")
    floor = 1e-24 * total
    cost = OfTails.PENALTY * math.log(n)  # of a parameter
    kind = min(fits, key=lambda name: n * math.log(max(squares[name], floor)) + fits[name][1] * cost)
    if kind == "rest":
        return TailModel("rest")
    rest = tail.level - fits[kind][0]
    share = 1.0 - squares[kind] / total
    error = math.sqrt(squares[kind] / max(n - 1 - fits[kind][1], 1) / n * alike_as_one(rest))
    quick = constant < OfTails.QUICK * (tail.time[1] - tail.time[0])
    if kind == "decay" and quick and tail.one_side < OfTails.ONE_SIDE:
        return TailModel("motion", explained=share)
    if kind == "decay":
        return TailModel("decay", float(decay[0]), error, constant, math.nan, share)
    level = float(fits[kind][0][-1])
    late = kind == "shift" and abs(float(np.mean(tail.level[: OfTails.AT_ONCE]))) < OfTails.HALF_THERE * abs(level)
    return TailModel("motion" if late or share < OfTails.HALF_THERE else kind, level, error, explained=share)


def _coupled(tail: Tail) -> TailModel | None:
    """Return AC coupling where one time constant explains undershoot and decay; None elsewhere."""
    chosen = np.ones(tail.time.size, dtype=bool)
    rate = 0.0
    for _ in range(ROUNDS):
        velocity, level = tail.velocity[chosen], tail.level[chosen]
        squares = float(np.sum(velocity**2))
        rate = -float(np.sum(velocity * level)) / squares if squares > 0.0 else 0.0
        if rate <= 0.0:
            return None
        narrowed = tail.time <= max(WINDOW / rate, tail.time[OfTails.FEWEST - 1])
        if np.array_equal(narrowed, chosen):
            break
        chosen = narrowed
    time, level, velocity = tail.time[chosen], tail.level[chosen], tail.velocity[chosen]
    rest = level + rate * velocity
    n, squares = time.size, float(np.sum(rest**2))
    total = float(np.sum(level**2))
    error = math.sqrt(squares / max(n - 1, 1) / float(np.sum(velocity**2)) * alike_as_one(rest))
    share = 1.0 - squares / total if total > 0.0 else 0.0
    complete, sure = time[-1] * rate > OfTails.SEEN_WHOLE, rate > OfTails.SURE * error
    if share < OfTails.EXPLAINED or time[-1] * rate < OfTails.LEAST_DECAY:
        return None
    if not (sure or (complete and rate > OfTails.SURE_WHOLE * error)):
        return None
    for other in (np.ones(n), time):
        left = float(np.sum((level - _on(level, other)) ** 2))
        if n * math.log(max(left, 1e-24 * total) / max(squares, 1e-24 * total)) < OfTails.PENALTY * math.log(n):
            return None
    free, constant = _decay(time, level)
    demanded = -float(velocity[0]) / constant
    amplitude = float(free[0]) / demanded if demanded else math.nan
    if not (OfTails.TIED[0] < amplitude < OfTails.TIED[1] or (complete and sure)):
        return None
    return TailModel("ac-coupling", -rate * float(velocity[0]), math.nan, 1.0 / rate, error / rate**2, share)


def _on(values: Array, column: Array) -> Array:
    """Return the multiple of a column that is nearest to values."""
    return np.asarray(column * (float(np.sum(values * column)) / float(np.sum(column**2))))


def _decay(time: Array, level: Array) -> tuple[Array, float]:
    """Return the exponential to zero that is nearest to a tail, and its time constant."""
    constants = np.geomspace(0.5 * time[1], 3.0 * time[-1], RATES)
    columns = np.exp(-time / constants[:, None])
    products = columns @ level
    k = int(np.argmax(products**2 / np.sum(columns**2, axis=1)))
    return _on(level, columns[k]), float(constants[k])


SETTLED_AFTER = 5.0  # widths after the last blow from which on a record is taken to be at rest


def uncoupled(values: Array, step: float, start: float, pulses: Sequence[RecordedPulse], constant: float) -> Array:
    """Return a record without its AC coupling; its zero is that before the first blow.

    What is wrong with that zero is integrated, and grows as 1 + t / tau: it is made so small that the record comes to
    rest after its last blow.
    """
    first, last = pulses[0], pulses[-1]
    places = np.arange(values.size)
    zero = first.offset + first.baseline.slope * (places - (first.time - start) / step)
    rest = round((last.end + SETTLED_AFTER * last.smooth.length - start) / step)
    return np.asarray(zero + resting(values - zero, step, constant, rest))


def resting(above: Array, step: float, constant: float, rest: int) -> Array:
    """Return values above their zero without AC coupling, at rest from a sample on, where that lasts long enough."""
    plain = ac_uncoupled(above, step, constant)
    wrong = 1.0 + step / constant * np.arange(above.size)
    if (above.size - rest) * step > constant:
        plain -= wrong * (float(np.sum(wrong[rest:] * plain[rest:])) / float(np.sum(wrong[rest:] ** 2)))
    return plain
