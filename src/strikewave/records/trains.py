"""Which contacts of a record are blows, and which belong to one: trains, rebounds, double hits, missing blows.

A train is known from the record itself: of all chains of contacts whose gaps are one period, or a few, the
one that holds most of the peaks. A contact on it is a blow, however small. One off it belongs to the blow before it: a
rebound where it is smaller or comes always as late, the second of a double hit where it is as large. Without a train a
contact is a rebound where it is smaller and near.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from strikewave.records._pulse_kernels import best_chains
from strikewave.records.record import Array
from strikewave.records.thresholds import OfTrains

LONG_TRAIN = 400  # contacts from whose gaps the period is taken: those of longer trains come again
NEIGHBOURS = 6  # contacts after each to which a gap is tried as the period: a blow, its rebounds, and the next
BIN = 0.05  # share by which periods that are tried differ: well within `OfTrains.JITTER`


MAINS = (20e-3, 10e-3, 1.0 / 60.0, 1.0 / 120.0)  # periods of the mains and of their rectified form, s
WHOLE_PERIOD = 1.0 / 75.0  # periods of the mains longer than this are whole, the others half, s


def mains_period(times: Array, widths: Array, locked: bool = False) -> float:
    """Return the period of the mains in which contacts come, s; NaN where they do not, or fewer than three do.

    Contacts too short for the mains are none of it, whatever their period.

    Times and widths are in s; ``locked`` asks for more regularity than grids have, where nothing else shows blips.
    """
    gaps = np.diff(times)
    if gaps.size < OfTrains.FEWEST_GAPS:
        return math.nan
    middle = float(np.median(gaps))
    period = min(MAINS, key=lambda one: abs(middle / one - 1.0))
    whole = period if period > WHOLE_PERIOD else 2.0 * period
    if float(np.median(widths)) < OfTrains.CONDUCTS * whole:
        return math.nan
    if not locked:
        return period if abs(middle / period - 1.0) < OfTrains.MAINS_SHARE else math.nan
    off = gaps / period - 1.0
    return period if max(abs(float(np.mean(off))), float(np.median(np.abs(off)))) < OfTrains.LOCKED else math.nan


class BlowTrain(NamedTuple):
    """Blows one period apart."""

    members: tuple[int, ...]  # contacts that are its blows, in the order of time
    period: float  # median of the gaps of one period
    jitter: float  # scatter of these gaps over the period: from the median of their deviations


class Contacts(NamedTuple):
    """What the contacts of a record are."""

    blows: tuple[int, ...]  # in the order of time
    owner: dict[int, int]  # for each contact that belongs to a blow, that blow
    double: dict[int, int]  # for each blow of a double hit beside the one of the train, or the first, that one
    train: BlowTrain | None  # train that shows the period, where there is one


def find_train(times: Array, peaks: Array) -> BlowTrain | None:
    """Return the chain of contacts, one or a few periods apart, that holds most of the peaks; None where none does."""
    if times.size < OfTrains.FEWEST_GAPS + 1:
        return None
    weights = peaks**2  # a rebound weighs little
    penalty = OfTrains.MISSED * float(np.median(np.sort(weights)[weights.size // 2 :]))  # of the larger half: the blows
    best: tuple[float, float, list[int]] | None = None
    for period in _periods(times):
        score, members = _chain(times, weights, period, penalty)
        off = _off_period(times[members], period)
        if best is None or score > best[0] * (1.0 + 1e-9) or (score > best[0] * (1.0 - 1e-9) and off < best[1]):
            best = score, off, members
    if best is None or len(best[2]) < 2:
        return None
    period = _common_period(np.diff(times[best[2]]))
    members = _chain(times, weights, period, OfTrains.KNOWN * penalty)[1]
    gaps = np.diff(times[members])
    period = _common_period(gaps)
    single = gaps[np.abs(gaps - period) < OfTrains.JITTER * period]
    if single.size < OfTrains.FEWEST_GAPS or 2 * single.size < gaps.size:
        return None
    jitter = float(np.median(np.abs(single - period))) / period
    return BlowTrain(tuple(members), period, jitter) if _regular(times, peaks, members) else None


def sort_contacts(times: Array, peaks: Array, widths: Array, small: Sequence[bool]) -> Contacts:
    """Tell blows from what belongs to them.

    ``small`` marks contacts too small for a blow unless a train asks for one there.
    """
    large = np.flatnonzero(~np.asarray(small, dtype=bool))
    train = find_train(times, peaks)
    on = set() if train is None else set(train.members)
    if train is None or not on & set(large[peaks[large] >= OfTrains.COMPARABLE * peaks[large].max(initial=0.0)]):
        return _without_train(times, peaks, widths, small)  # or one of what is small beside a blow that is not on it
    owner: dict[int, int] = {}
    double: dict[int, int] = {}
    members = np.array(train.members)
    others = [k for k in range(times.size) if k not in on]
    blow_of = {k: int(members[max(int(np.searchsorted(times[members], times[k])) - 1, 0)]) for k in others}
    late = _as_late(times, peaks, blow_of, len(members))
    for k, blow in blow_of.items():
        if small[k] or k in late or peaks[k] < OfTrains.COMPARABLE * peaks[blow]:
            owner[k] = blow
        else:
            nearest = int(members[np.argmin(np.abs(times[members] - times[k]))])
            if abs(times[k] - times[nearest]) < 0.5 * train.period:
                double[k] = nearest
    blows = tuple(k for k in range(times.size) if k not in owner)
    return Contacts(blows, owner, double, train)


def gaps_of(times: Array, contacts: Contacts) -> list[float]:
    """Return the times from blow to blow: not those inside a double hit, nor those over a missing blow."""
    firsts = [k for k in contacts.blows if k not in contacts.double]
    gaps = [float(gap) for gap in np.diff(times[firsts])]
    train = contacts.train
    return [gap for gap in gaps if train is None or gap < (1.5 if _sure(train) else math.inf) * train.period]


def missing_of(times: Array, contacts: Contacts) -> list[float]:
    """Return the times at which a train lacks a blow."""
    train = contacts.train
    if train is None or not _sure(train):
        return []
    missing = []
    for k, gap in enumerate(np.diff(times[list(train.members)])):
        count = round(gap / train.period)
        if count > 1 and abs(gap / count - train.period) < OfTrains.SURE_JITTER * train.period:
            missing += [float(times[train.members[k]] + gap * j / count) for j in range(1, count)]
    return missing


def _sure(train: BlowTrain) -> bool:
    return len(train.members) > OfTrains.SURE_GAPS and train.jitter < 0.5 * OfTrains.SURE_JITTER


def _periods(times: Array) -> Array:
    """Return gaps that may be the period, `BIN` apart."""
    some = times[:LONG_TRAIN]
    gaps = np.concatenate([some[k:] - some[:-k] for k in range(1, min(NEIGHBOURS, some.size - 1) + 1)])
    steps = np.round(np.log(gaps[gaps > 0.0]) / BIN)
    return np.array([float(np.median(gaps[gaps > 0.0][steps == step])) for step in np.unique(steps)])


def _chain(times: Array, weights: Array, period: float, penalty: float) -> tuple[float, list[int]]:
    """Return the chain with gaps of one period or a few of the largest weight, and what it holds.

    Each blow that it misses costs ``penalty``.
    """
    score, before = best_chains(times, weights, period, penalty, OfTrains.MOST_PERIODS, OfTrains.JITTER)
    k = int(np.argmax(score))
    members = [k]
    while before[members[-1]] >= 0:
        members.append(int(before[members[-1]]))
    return float(score[k]), members[::-1]


def _off_period(times: Array, period: float) -> float:
    gaps = np.diff(times) / period
    return float(np.mean(np.abs(gaps - np.rint(gaps)))) if gaps.size else math.inf


def _common_period(gaps: Array) -> float:
    """Return the median of the gaps that are as long as the shortest quarter of them is."""
    shortest = float(np.sort(gaps)[(gaps.size - 1) // 4])
    return float(np.median(gaps[np.abs(gaps - shortest) < 2.0 * OfTrains.JITTER * shortest]))


def _regular(times: Array, peaks: Array, members: Sequence[int]) -> bool:
    """Tell whether what is as large as the members and lies beside them is rare, or always as late."""
    usual = float(np.median(peaks[list(members)]))
    on = set(members)
    begin, end = times[members[0]], times[members[-1]]
    beside = [k for k in range(times.size) if k not in on and peaks[k] >= OfTrains.COMPARABLE * usual]
    inside = [k for k in beside if begin < times[k] < end]
    if len(inside) != len(beside) and len(members) < 2 * (len(beside) - len(inside)) + OfTrains.FEWEST_GAPS:
        return False
    if len(inside) <= max(OfTrains.IRREGULAR * len(members), 1.0):
        return True
    places = times[list(members)]
    lags = np.array([times[k] - places[np.searchsorted(places, times[k]) - 1] for k in inside])
    return float(np.median(np.abs(lags - np.median(lags)))) < 0.5 * OfTrains.AS_LATE * float(np.median(lags))


def _as_late(times: Array, peaks: Array, blow_of: dict[int, int], blows: int) -> set[int]:
    """Return what comes after most blows of a train, equally late and smaller: rebounds."""
    after = {k: float(times[k] - times[blow]) for k, blow in blow_of.items() if times[k] > times[blow]}
    if len(after) < max(blows // 2, OfTrains.FEWEST_GAPS):
        return set()
    usual = float(np.median(list(after.values())))
    late = {k for k, lag in after.items() if abs(lag - usual) < OfTrains.AS_LATE * usual}
    smaller = sum(peaks[k] < peaks[blow_of[k]] for k in late)
    return (
        late
        if len(late) >= max(blows // 2, OfTrains.FEWEST_GAPS) and smaller > OfTrains.IRREGULAR * len(late)
        else set()
    )


def _without_train(times: Array, peaks: Array, widths: Array, small: Sequence[bool]) -> Contacts:
    owner: dict[int, int] = {}
    blows: list[int] = []
    for k in np.argsort(-peaks, kind="stable"):
        near = [b for b in blows if abs(times[k] - times[b]) < OfTrains.NEAR * widths[b]]
        below = [b for b in near if peaks[k] < OfTrains.COMPARABLE * peaks[b]]
        if below:
            owner[int(k)] = min(below, key=lambda b: abs(times[k] - times[b]))
        elif not small[k]:
            blows.append(int(k))
    blows.sort()
    double = {
        later: earlier
        for earlier, later in pairwise(blows)
        if times[later] - times[earlier] < OfTrains.DOUBLE * max(widths[earlier], widths[later])
    }
    return Contacts(tuple(blows), owner, double, None)
