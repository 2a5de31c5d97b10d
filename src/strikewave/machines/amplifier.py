"""Velocity amplifiers: bodies in a line that hit one another in pairs, each faster than before; dual masses.

Positions and speeds are positive upwards, along the blow. Bodies are numbered from the bottom, in words from 1. A body
of infinite mass is a floor, a ceiling or a striker that nothing slows. `collide` finds every collision in its order,
secondary ones included; `collide_softly` follows the same line with contacts that take time: where two contacts of a
body overlap, collisions in pairs no longer give the speed of the last body.

The dual-mass shock amplifier is a second mass on cushions above a drop table. Both fall together. The table comes to a
pulse shaper on the anvil and is thrown back; the second mass, on soft cushions, goes on down, closes the gap and meets
the table, which comes up: a short, high pulse.

With the restitutions e1 of the table on the shaper and e2 of the two masses, the ratio mu = m/M of second mass to
table, and cushions that do nothing on the way, the masses close with (1 + e1) v, and the second one leaves with
(1 + e2) (1 + e1) v/(1 + mu) - v: `next_speed` of e1 v. At best, elastic and light, it
goes three times as fast as it fell.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.contact.chain import Chain, ChainContact, ChainMotion, Link, Spring, simulate
from strikewave.contact.law import AnyContact, not_negative, positive, refuse
from strikewave.machines.launch import linear_shaper


@dataclass(frozen=True)
class BodyLine:
    """Bodies in a line, from the bottom; a number out of range, or a wrong count, raises ValueError."""

    masses: tuple[float, ...]
    """kg; the first and the last may be infinite."""
    restitutions: tuple[float, ...]
    """Coefficient of restitution of each pair of neighbours, 0 to 1."""
    gaps: tuple[float, ...]
    """Gaps between neighbours at the start, m."""
    speeds: tuple[float, ...]
    """Speeds at the start, m/s, upwards."""
    gravity: float = STANDARD_GRAVITY
    """Gravity, downwards, m/s^2."""

    def __post_init__(self) -> None:
        count = len(self.masses)
        for name, wanted in (("restitutions", count - 1), ("gaps", count - 1), ("speeds", count)):
            if count < 2 or len(getattr(self, name)) != wanted:
                raise ValueError(f"{count} masses take {wanted} {name}, got {len(getattr(self, name))}; two at least")
        masses, e = np.asarray(self.masses, dtype=float), np.asarray(self.restitutions, dtype=float)
        refuse("a mass", masses, masses > 0.0, "positive")
        positive("a mass between the ends", masses[1:-1])
        if not np.any(np.isfinite(masses)):
            raise ValueError("one body at least must have a finite mass")
        refuse("a restitution", e, (e >= 0.0) & (e <= 1.0), "within 0 to 1")
        not_negative("a gap", self.gaps)
        not_negative("gravity", self.gravity)
        refuse("a speed", self.speeds, np.isfinite(self.speeds), "finite")


Array = NDArray[np.float64]


def next_speed(speed: ArrayLike, mass_ratio: ArrayLike, restitution: ArrayLike, falling: ArrayLike = 0.0) -> Array:
    """Return the speed of a body that is struck, (1 + e) (v + u)/(1 + mu) - u, m/s.

    Parameters
    ----------
    speed : array_like
        v of the body that strikes, m/s.
    mass_ratio : array_like
        mu, mass of the struck body over that of the striking one.
    restitution : array_like
        Coefficient of restitution, e.
    falling : array_like, optional
        u at which the struck body comes against the blow, m/s; 0 where it rests.

    Returns
    -------
    ndarray
        In the broadcast shape of the input, m/s.

    Notes
    -----
    Source: Rodgers et al. 2009; momentum and Newton's restitution. Theory: :eq:`machine-amplifier`.

    Examples
    --------
    >>> print(next_speed(10.0, 0.25, 0.8), next_speed(1.0, 0.0, 1.0, falling=1.0))
    14.4 3.0
    """
    v, mu, e, u = (np.asarray(value, dtype=float) for value in (speed, mass_ratio, restitution, falling))
    return np.asarray((1.0 + e) * (v + u) / (1.0 + mu) - u)


def chain_speed(masses: Sequence[float], restitution: ArrayLike, speed: float, falling: float = 0.0) -> float:
    """Return the speed of the last body of a line where each is struck once, in order, m/s; see `next_speed`.

    Later collisions can push the last body on: `collide` finds them.

    Parameters
    ----------
    masses : sequence of float
        From the body that strikes first, kg.
    restitution : array_like
        One, or one for each pair.
    speed, falling : float
        v of the first body, and u at which all others come against the blow, m/s.
    """
    each = np.broadcast_to(np.asarray(restitution, dtype=float), (len(masses) - 1,))
    for (first, second), e in zip(itertools.pairwise(masses), each, strict=True):
        speed = float(next_speed(speed, second / first, e, falling))
    return speed


def gain_limit(restitution: float, collisions: int, falling: bool = False) -> float:
    """Return the gain of the last body for mass ratios that go to zero, (1 + e)^n, less 1 for a falling line.

    The floor counts as a collision of a falling line: 3 for two elastic bodies, 7 for three,
    so 9 and 49 times the height (Walker 1988).
    """
    return (1.0 + restitution) ** collisions - (1.0 if falling else 0.0)


def gain_limit_of(restitutions: Sequence[float]) -> float:
    """Return the gain of the last body of a falling line for mass ratios that go to zero, each pair with its own e."""
    return math.prod(1.0 + e for e in restitutions) - 1.0


def fastest_masses(first: float, last: float, count: int) -> Array:
    """Return the masses that make the last body of a line fastest: a geometric row, kg.

    The product of the ratios is given and each enters as 1/(1 + mu), so the best are equal, whatever the restitutions,
    resting or falling. Source: Rodgers et al. 2009 (their power law).
    """
    positive("the masses of the ends", [first, last])
    return np.asarray(first * (last / first) ** np.linspace(0.0, 1.0, count))


def resting_ratio(speed: float, restitution: float, falling: float = 0.0) -> float:
    """Return the mass ratio that brings the striking body to rest, mu = v/((1 + e) (v + u) - v).

    A line of such ratios hands all its motion to the last body, the second of the two designs of Rodgers et al. 2009.
    Symbols of `next_speed`.
    """
    return speed / ((1.0 + restitution) * (speed + falling) - speed)


AT_REST = 1e-9  # endless bounces end there, with 1e-18 of the energy left
"""Approach speed, over the speed scale of the line, below which bodies stay together."""
AT_ONCE = 1e-12  # some thousand roundings of it
"""Share of the time passed within which collisions happen at once."""


class Collision(NamedTuple):
    """Collision of two neighbours."""

    time: float
    """s."""
    pair: int
    """Number of the lower body; the upper one is the next."""
    before: tuple[float, float]
    """Speeds of the lower and the upper body, m/s."""
    after: tuple[float, float]
    """Speeds of both, m/s."""
    impulse: float
    """N s."""
    energy_lost: float
    """(1 - e^2) m w^2/2 with the reduced mass m and the approach speed w, J."""
    at_once: bool
    """True if a third body touched one of the two at that moment."""


@dataclass(frozen=True)
class Collisions:
    """A line of bodies from its start to its end, for any time."""

    line: BodyLine
    """Line that was followed."""
    collisions: tuple[Collision, ...]
    """Collisions in their order."""
    words: tuple[str, ...]
    """Messages for the user."""
    end: float
    """Time at which following ended, s; infinite where nothing collides any more."""
    support: float
    """Impulse of floor and ceiling on bodies at rest there, by the last collision, N s."""
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
    """State of the line until the next collision: time, places, speeds, accelerations."""

    time: float
    places: Array
    speeds: Array
    pulls: Array


def collide(line: BodyLine, duration: float = math.inf, most: int = 10_000) -> Collisions:
    """Follow a line of bodies from collision to collision, for a time, s, or at most so many collisions.

    Between collisions all is closed form: bodies fall freely or rest on a floor. The next collision is the first of
    all pairs, whatever their order in the line. Collisions at once are taken from the bottom up, each as a pair of its
    own with the speeds that the one before has left; so touching bodies act as if a gap of nothing lay between them.
    Bodies that meet at less than `AT_REST` of the speed scale stay together: endless bounces end there, and a
    notice reports it. Source: Rodgers et al. 2009 for the pairs; the order is ours.

    Raises
    ------
    ValueError
        If the duration is not positive, or `most` is not at least 1.
    """
    if not duration > 0.0 or most < 1:
        raise ValueError(f"the duration must be positive and the collisions 1 at least, got {duration!r} and {most!r}")
    state = _State(line)
    flights, notes = [state.flight()], list[str]()
    collisions: list[Collision] = []
    ended = duration
    while True:
        wait, pair, at_once = state.next_collision()
        if math.isinf(wait) or state.time + wait > duration:
            break
        if len(collisions) == most:
            ended = state.time
            notes.append(f"stopped after {most} collisions, at {ended:.6g} s: more follow")
            break
        state.advance(wait, pair)
        collisions.append(state.strike(pair, at_once))
        flights.append(state.flight())
    if state.rested:
        bodies = ", ".join(str(k + 1) for k in sorted(state.rested))
        notes.append(
            f"ever smaller bounces bring to rest on a neighbour: body {bodies}; those below {AT_REST:g} of the speed "
            "scale are left out"
        )
    at_once_count = sum(collision.at_once for collision in collisions)
    if at_once_count:
        notes.append(
            f"collisions while a third body touches: {at_once_count}; they are taken in pairs from the bottom up, and "
            "finite contacts may end otherwise"
        )
    return Collisions(line, tuple(collisions), tuple(notes), ended, state.support, tuple(flights))


class _State:
    """The line at a time; gaps are stored, not places, so that bodies in touch have a gap of exactly 0."""

    def __init__(self, line: BodyLine) -> None:
        self.line, self.time, self.support = line, 0.0, 0.0
        self.base, self.gaps, self.speeds = 0.0, list(line.gaps), list(line.speeds)
        self.rested: set[int] = set()
        scale = math.sqrt(float(np.ptp(line.speeds)) ** 2 + 2.0 * line.gravity * sum(line.gaps))
        self.slow = AT_REST * scale
        self.pulls = self._pulls()

    def _pulls(self) -> list[float]:
        """Return the acceleration of each body: none of infinite ones, and of those that rest on one from below."""
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
        """Return the wait until the gap d + w t + a t^2/2 of a pair closes, s; infinite if it never does."""
        d, w, a = self.gaps[k], self.speeds[k + 1] - self.speeds[k], self.pulls[k + 1] - self.pulls[k]
        inside = w * w - 2.0 * a * d
        if w < 0.0:
            # the form of the root in which nothing cancels
            return math.inf if inside < 0.0 else 2.0 * d / (-w + math.sqrt(inside))
        return (w + math.sqrt(inside)) / -a if a < 0.0 else math.inf

    def advance(self, wait: float, pair: int) -> None:
        """Let the line fly; the pair touches at the end of it."""
        v, a = self.speeds, self.pulls
        for k in range(len(self.gaps)):
            w, change = v[k + 1] - v[k], a[k + 1] - a[k]
            self.gaps[k] = max(self.gaps[k] + (w + 0.5 * change * wait) * wait, 0.0)  # rounding shall leave no overlap
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
            common = after[1] if math.isinf(upper) else after[0]  # equal to the bit, so that the pair stays in touch
            after = common, common
        self.speeds[pair : pair + 2] = after
        if slow:
            self.rested.add(pair + 1 if math.isfinite(upper) else pair)
            self._stay_together(pair)
        self.pulls = self._pulls()
        lost = 0.5 * (1.0 - e * e) * reduced * approach**2
        return Collision(self.time, pair, before, after, impulse, lost, at_once)

    def _stay_together(self, pair: int) -> None:
        """Give all bodies that touch the pair, and are as slow beside it, the speed of their momentum."""
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


@dataclass(frozen=True)
class SoftCollisions:
    """A line of bodies whose contacts take time."""

    motion: ChainMotion
    """Motion of all bodies, named 1, 2 ... from the bottom; infinite ones are bases."""
    speeds: Array
    """Speeds at the end, m/s; of an infinite body 0."""
    contacts: tuple[Array, ...]
    """Begin, end (s) and approach speed (m/s) of the contacts of each pair, shape (N, 3)."""

    @property
    def overlap(self) -> float:
        """Longest time that two contacts of one body last together, s: pairwise theory asks for 0."""
        longest = 0.0
        for one, other in itertools.pairwise(self.contacts):
            begin = np.maximum(one[:, None, 0], other[None, :, 0])
            end = np.minimum(one[:, None, 1], other[None, :, 1])
            longest = max(longest, float(np.max(end - begin, initial=0.0)))
        return longest


def collide_softly(
    line: BodyLine, contacts: Sequence[AnyContact], duration: float, tolerance: float = 1e-10
) -> SoftCollisions:
    """Follow a line whose bodies meet by a contact law for each pair, for a time, s; its restitutions do not count.

    Raises
    ------
    ValueError
        If there is not one contact for each pair, or an infinite body moves.
    """
    if len(contacts) != len(line.gaps):
        raise ValueError(f"{len(line.masses)} bodies take {len(line.gaps)} contacts, got {len(contacts)}")
    places = np.concatenate([[0.0], np.cumsum(line.gaps)])
    names = [str(k + 1) for k in range(len(places))]
    infinite = np.isinf(line.masses)
    if np.any(np.asarray(line.speeds)[infinite] != 0.0):
        raise ValueError("a body of infinite mass must stand still among finite contacts")
    bodies = {name: mass for name, mass, fixed in zip(names, line.masses, infinite, strict=True) if not fixed}
    bases = {name: float(x) for name, x, fixed in zip(names, places, infinite, strict=True) if fixed}
    touches = [ChainContact(*pair, contact) for pair, contact in zip(itertools.pairwise(names), contacts, strict=True)]
    chain = Chain(bodies, touches, bases, -line.gravity)
    start = dict(zip(names, places, strict=True)), dict(zip(names, line.speeds, strict=True))
    at, moving = ({name: float(values[name]) for name in bodies} for values in start)
    motion = simulate(chain, at, moving, duration, tolerance)
    speeds = np.zeros(len(names))
    speeds[~infinite] = motion.speeds(duration)
    return SoftCollisions(motion, speeds, tuple(motion.contacts(k) for k in range(len(touches))))


LONGEST_WAY = 1.0  # chosen: ten times that of soft cushions of 16 Hz
"""Longest time of the second mass to the table, s."""


class DualMass(NamedTuple):
    """Table and second mass, SI."""

    table: float
    """kg."""
    second: float
    """kg."""
    gap: float
    """Way of the second mass to the pad on the table while both fall, its cushions unloaded, m."""
    cushion_stiffness: float
    """All cushions together, N/m."""
    cushion_damping: float
    """All cushions together, N s/m."""
    shaper_stiffness: float
    """Linear spring of the anvil, N/m."""
    shaper_restitution: float
    """Coefficient of restitution of the table on it, by a damper that never pulls."""
    pad: AnyContact
    """Law of the contact between second mass and table."""


class SecondImpact(NamedTuple):
    """Impact of the second mass on the table."""

    time: float
    """s after the table has met the shaper."""
    table: float
    """Speed upwards, m/s."""
    second: float
    """Speed upwards, m/s."""
    gain: float
    """Speed with which the second mass leaves, by the law of the pad between rigid masses, over that of the fall."""
    cushion_force: float
    """N at that moment."""
    shaper_force: float
    """N at that moment."""


def second_impact(masses: DualMass, speed: float, gravity: float = STANDARD_GRAVITY) -> SecondImpact:
    """Return the impact of the second mass on the table after a fall at a speed.

    Newton's law for two masses, integrated with located switches (`strikewave.contact.chain.simulate`). The build of
    such a machine is from memory; Duan et al. 2023 report stacked bodies that fall together for high shocks.

    Raises
    ------
    ValueError
        If they do not meet within `LONGEST_WAY`.
    """
    shaper = linear_shaper(masses.shaper_stiffness, masses.table, masses.shaper_restitution)
    links: list[Link] = [
        ChainContact("anvil", "table", shaper),
        Spring("table", "second", masses.cushion_stiffness, masses.cushion_damping, offset=-masses.gap),
        ChainContact("table", "second", masses.pad),
    ]
    chain = Chain({"table": masses.table, "second": masses.second}, links, {"anvil": 0.0}, -gravity)
    places, speeds = {"table": 0.0, "second": masses.gap}, {"table": -speed, "second": -speed}
    duration = math.pi * math.sqrt(masses.table / masses.shaper_stiffness) + masses.gap / speed
    while duration < LONGEST_WAY:
        duration = min(2.0 * duration, LONGEST_WAY)
        motion = simulate(chain, places, speeds, duration)
        contacts = motion.contacts(2)
        if len(contacts) and contacts[0, 1] < duration:
            begin, end = float(contacts[0, 0]), float(contacts[0, 1])
            table, second = (float(v) for v in motion.speeds(begin))
            shaper_force, cushion_force, _ = (float(force) for force in motion.forces(begin))
            gain = float(motion.speeds(end)[1]) / speed
            return SecondImpact(begin, table, second, gain, cushion_force, shaper_force)
    hint = "take a smaller gap or softer cushions"
    raise ValueError(f"the second mass does not meet the table within {LONGEST_WAY:g} s: {hint}")
