"""Collisions of a line that take no time: every one in its order, secondary ones included."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.contact.law import refuse
from strikewave.machines.amplifier.line import BodyLine

Array = NDArray[np.float64]

AT_REST = 1e-9
"""Approach speed, over the speed scale of the line, below which bodies that meet stay together."""
AT_ONCE = 1e-12
"""Collisions nearer than this share of the time passed happen at once."""


class Collision(NamedTuple):
    """Two neighbours meet.

    Attributes
    ----------
    time : float
        s.
    pair : int
        Number of the lower body; the upper one is the next.
    before, after : (float, float)
        Speeds of the lower and the upper body, m/s.
    impulse : float
        N s.
    energy_lost : float
        (1 - e^2) m w^2/2 with the reduced mass m and the approach speed w, J.
    at_once : bool
        Whether a third body touched one of the two at that moment.
    """

    time: float
    pair: int
    before: tuple[float, float]
    after: tuple[float, float]
    impulse: float
    energy_lost: float
    at_once: bool


@dataclass(frozen=True)
class Collisions:
    """A line from its start to its end; ask it for any time.

    Attributes
    ----------
    line : BodyLine
        What was followed.
    collisions : tuple of Collision
        In their order.
    words : tuple of str
        What the user should know.
    end : float
        Time after which nothing was followed, s; infinite where nothing collides any more.
    support : float
        Impulse of floor and ceiling on what rests there, by the last collision, N s.
    """

    line: BodyLine
    collisions: tuple[Collision, ...]
    words: tuple[str, ...]
    end: float
    support: float
    _flights: tuple[_Flight, ...] = field(repr=False)

    def positions(self, times: ArrayLike) -> Array:
        """Return positions above the lowest body's start, m, shape (N, bodies), or (bodies,) for one time."""
        t, rows = self._rows(times)
        return np.asarray(rows[0] + (rows[1] + 0.5 * rows[2] * t) * t)  # t squared may be beyond every float

    def speeds(self, times: ArrayLike) -> Array:
        """Return speeds, m/s, shape (N, bodies), or (bodies,) for one time; after the collision at its very time."""
        t, rows = self._rows(times)
        return np.asarray(rows[1] + rows[2] * t)

    @property
    def final_speeds(self) -> Array:
        """Speeds after the last collision, m/s."""
        return self._flights[-1].speeds

    @property
    def gain(self) -> float:
        """Largest speed with which the top body leaves a collision over the first approach speed; NaN without one."""
        finite = [k for k, mass in enumerate(self.line.masses) if math.isfinite(mass)]
        leaves = [c.after[1] for c in self.collisions if c.pair + 1 == finite[-1]]
        if not leaves:
            return math.nan
        first = self.collisions[0].before
        return max(leaves) / (first[0] - first[1])

    @property
    def energy_lost(self) -> float:
        """Energy lost in all collisions, J."""
        return math.fsum(collision.energy_lost for collision in self.collisions)

    @property
    def energy_error(self) -> float:
        """Energy that the balance misses, from the start to the last collision, over the energy of the start.

        Only with floors and ceilings at rest: one that moves does work.
        """
        first, last = self._flights[0], self._flights[-1]
        start = self._energy(first)
        return abs(self._energy(last) + self.energy_lost - start) / (start or 1.0)

    @property
    def momentum_error(self) -> float:
        """Momentum that the balance misses over the largest momentum that a collision passed on."""
        masses, last = self._finite_masses, len(self.line.masses) - 2
        change = float(masses @ (self._flights[-1].speeds - self._flights[0].speeds))
        fell = float(masses.sum()) * self.line.gravity * self._flights[-1].time
        floor, ceiling = math.isinf(self.line.masses[0]), math.isinf(self.line.masses[-1])
        up = math.fsum(c.impulse for c in self.collisions if floor and c.pair == 0)
        down = math.fsum(c.impulse for c in self.collisions if ceiling and c.pair == last)
        largest = max((c.impulse for c in self.collisions), default=1.0)
        return abs(change + fell - up + down - self.support) / largest

    @property
    def _finite_masses(self) -> Array:
        return np.where(np.isfinite(self.line.masses), self.line.masses, 0.0)

    def _energy(self, flight: _Flight) -> float:
        return float(self._finite_masses @ (0.5 * flight.speeds**2 + self.line.gravity * flight.places))

    def _rows(self, times: ArrayLike) -> tuple[Array, Array]:
        t = np.asarray(times, dtype=float)
        refuse("a time", t, (t >= 0.0) & (t <= self.end), f"from 0 to the end, {self.end:g} s")
        begins = np.array([flight.time for flight in self._flights])
        which = np.searchsorted(begins, t, side="right") - 1
        table = np.array([[flight.places, flight.speeds, flight.pulls] for flight in self._flights])
        return (t - begins[which])[..., None], np.moveaxis(table[which], -2, 0)


class _Flight(NamedTuple):
    """The line from one time to the next collision: time, places, speeds, accelerations."""

    time: float
    places: Array
    speeds: Array
    pulls: Array


def collide(line: BodyLine, duration: float = math.inf, most: int = 10_000) -> Collisions:
    """Follow a line of bodies from collision to collision.

    Between collisions all is closed form: bodies fall freely or rest on a floor. The next collision is the first of
    all pairs, whatever their order in the line. Collisions at once are taken from the bottom up, each as a pair of its
    own with the speeds that the one before has left; so touching bodies act as if a gap of nothing lay between them.
    Bodies that meet at less than `AT_REST` of the speed scale stay together: endless bounces end there, and a
    notice reports it.

    Parameters
    ----------
    line : BodyLine
        Bodies, gaps, speeds.
    duration : float, optional
        How long, s.
    most : int, optional
        Largest number of collisions.

    Raises
    ------
    ValueError
        If the duration is not positive, or `most` is not at least 1.

    Notes
    -----
    Source: Rodgers et al. 2009 for the pairs; the order is found here.

    Examples
    --------
    >>> three = BodyLine((1.0, 0.1, 0.01), (1.0, 1.0), gaps=(0.01, 0.01), speeds=(1.0, 0.0, 0.0), gravity=0.0)
    >>> run = collide(three)
    >>> [c.pair for c in run.collisions], round(run.gain, 6)
    ([0, 1], 3.305785)
    """
    if not duration > 0.0 or most < 1:
        raise ValueError(f"the duration must be positive and the collisions 1 at least, got {duration!r} and {most!r}")
    state = _State(line)
    flights, words = [state.flight()], list[str]()
    collisions: list[Collision] = []
    ended = duration
    while True:
        wait, pair, at_once = state.next_collision()
        if math.isinf(wait) or state.time + wait > duration:
            break
        if len(collisions) == most:
            ended = state.time
            words.append(f"stopped after {most} collisions, at {ended:.6g} s: more follow")
            break
        state.advance(wait, pair)
        collisions.append(state.strike(pair, at_once))
        flights.append(state.flight())
    words += _words_about(state.rested, sum(collision.at_once for collision in collisions))
    return Collisions(line, tuple(collisions), tuple(words), ended, state.support, tuple(flights))


def _words_about(rested: set[int], at_once: int) -> list[str]:
    words = []
    if rested:
        bodies = ", ".join(str(k + 1) for k in sorted(rested))
        words.append(
            f"ever smaller bounces bring to rest on a neighbour: body {bodies}; those below {AT_REST:g} of the speed "
            "scale are left out"
        )
    if at_once:
        words.append(
            f"collisions while a third body touches: {at_once}; they are taken in pairs from the bottom up, and finite "
            "contacts may end otherwise"
        )
    return words


class _State:
    """The line at a time; gaps are kept themselves, so that bodies that touch touch exactly."""

    def __init__(self, line: BodyLine) -> None:
        self.line, self.time, self.support = line, 0.0, 0.0
        self.base, self.gaps, self.speeds = 0.0, list(line.gaps), list(line.speeds)
        self.rested: set[int] = set()
        scale = math.sqrt(float(np.ptp(line.speeds)) ** 2 + 2.0 * line.gravity * sum(line.gaps))
        self.slow = AT_REST * scale
        self.pulls = self._pulls()

    def _pulls(self) -> list[float]:
        """Return the acceleration of each body: none for what is infinite or rests on such from below."""
        out, rests = [], True
        for k, mass in enumerate(self.line.masses):
            below = k > 0 and self.gaps[k - 1] == 0.0 and self.speeds[k] == self.speeds[k - 1]
            rests = math.isinf(mass) if k == 0 else rests and below
            out.append(0.0 if rests or math.isinf(mass) else -self.line.gravity)
        return out

    def flight(self) -> _Flight:
        places = np.concatenate([[self.base], self.base + np.cumsum(self.gaps)])
        return _Flight(self.time, places, np.array(self.speeds), np.array(self.pulls))

    def next_collision(self) -> tuple[float, int, bool]:
        """Return the wait for the next collision, its pair, and whether a third body touches at that moment."""
        waits = [self._wait(k) for k in range(len(self.gaps))]
        soonest = min(waits)
        if math.isinf(soonest):
            return soonest, 0, False
        tie = AT_ONCE * (self.time + soonest)
        pair = next(k for k, wait in enumerate(waits) if wait <= soonest + tie)
        beside = [k for k in (pair - 1, pair + 1) if 0 <= k < len(waits)]
        still = soonest == 0.0
        touching = any(waits[k] <= soonest + tie or (self.gaps[k] == 0.0 and self._stay(k, still)) for k in beside)
        return soonest, pair, touching

    def _stay(self, k: int, still: bool) -> bool:
        """Return whether a pair that touches now still does at the next collision."""
        return still or (self.speeds[k] == self.speeds[k + 1] and self.pulls[k] == self.pulls[k + 1])

    def _wait(self, k: int) -> float:
        """Return when the gap d + w t + a t^2/2 of a pair closes, s; infinite if never."""
        d, w, a = self.gaps[k], self.speeds[k + 1] - self.speeds[k], self.pulls[k + 1] - self.pulls[k]
        inside = w * w - 2.0 * a * d
        if w < 0.0:
            return math.inf if inside < 0.0 else 2.0 * d / (-w + math.sqrt(inside))
        return (w + math.sqrt(inside)) / -a if a < 0.0 else math.inf

    def advance(self, wait: float, pair: int) -> None:
        """Let the line fly; the pair touches at the end of it."""
        v, a = self.speeds, self.pulls
        for k in range(len(self.gaps)):
            w, change = v[k + 1] - v[k], a[k + 1] - a[k]
            self.gaps[k] = max(self.gaps[k] + (w + 0.5 * change * wait) * wait, 0.0)
        self.gaps[pair] = 0.0
        self.base += (v[0] + 0.5 * a[0] * wait) * wait
        resting_mass = sum(m for m, pull in zip(self.line.masses, a, strict=True) if math.isfinite(m) and pull == 0.0)
        self.support += resting_mass * self.line.gravity * wait
        self.speeds = [speed + pull * wait for speed, pull in zip(v, a, strict=True)]
        self.time += wait

    def strike(self, pair: int, at_once: bool) -> Collision:
        """Let a pair collide, with no restitution where it is slow."""
        lower, upper = self.line.masses[pair : pair + 2]
        before = self.speeds[pair], self.speeds[pair + 1]
        approach = before[0] - before[1]
        slow = approach < self.slow
        e = 0.0 if slow else self.line.restitutions[pair]
        reduced = 1.0 / (1.0 / lower + 1.0 / upper)
        impulse = (1.0 + e) * reduced * approach
        after = before[0] - impulse / lower, before[1] + impulse / upper
        if e == 0.0:
            common = after[1] if math.isinf(upper) else after[0]
            after = common, common
        self.speeds[pair : pair + 2] = after
        if slow:
            self.rested.add(pair + 1 if math.isfinite(upper) else pair)
            self._stay_together(pair)
        self.pulls = self._pulls()
        lost = 0.5 * (1.0 - e * e) * reduced * approach**2
        return Collision(self.time, pair, before, after, impulse, lost, at_once)

    def _stay_together(self, pair: int) -> None:
        """Give all bodies that touch the pair and are as slow beside it one speed, that of their momentum."""
        v, first, last = self.speeds, pair, pair + 1
        while first > 0 and self.gaps[first - 1] == 0.0 and abs(v[first - 1] - v[first]) < self.slow:
            first -= 1
        while last < len(v) - 1 and self.gaps[last] == 0.0 and abs(v[last + 1] - v[last]) < self.slow:
            last += 1
        members = range(first, last + 1)
        fixed = [v[k] for k in members if math.isinf(self.line.masses[k])]
        total = math.fsum(self.line.masses[k] * v[k] for k in members) if not fixed else 0.0
        common = fixed[0] if fixed else total / math.fsum(self.line.masses[k] for k in members)
        for k in members:
            if fixed and math.isfinite(self.line.masses[k]):
                self.support += self.line.masses[k] * (common - v[k])
            v[k] = common
