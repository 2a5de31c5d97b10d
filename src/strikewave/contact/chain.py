"""Chains of masses, springs, dampers, stops and contacts along one line.

Positions and speeds are positive along the blow. A link joins a node ``behind`` to a node ``ahead``;
its compression is d = x_behind - x_ahead - offset and its force pushes the two apart.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import nearest
from strikewave.contact import _chain_kernels as kernels
from strikewave.contact._integrator import Control
from strikewave.contact._law_kernels import COLUMNS, DAMPING, OFFSET, PRELOAD, SLOWEST, SPOT, STIFFNESS, YIELD_LOAD
from strikewave.contact._pair_kernels import depths_at_yield, energies, spots
from strikewave.contact.law import AnyContact, Contact, check_end, elastic_indentation, single
from strikewave.contact.motion import FIRST_STEP, Motion, MotionState, integrate

Array = NDArray[np.float64]

TOLERANCE = 1e-9  # the errors of a thousand steps stay below the 1e-6 of an energy balance
"""Local error of a step over its scales."""
# Blows that slow carry a millionth of the energy, and a slower one would make a slowly pressed contact rigid.
SLOWEST_SHARE = 1e-3
"""Least approach speed of a contact over the speed scale of its chain, where none is given."""
_STEPS_A_PERIOD = 8.0  # a longer one could miss that a base comes and goes
"""Fewest steps in the period of a shaking base."""
# Chosen small beside any blow, so that they only keep the tolerance of a chain at rest from being zero.
_LEAST_DROP, _LEAST_SPEED = 1e-3, 1e-6
"""Way (m) in which gravity and preloads gain speed, and speed scale (m/s) of a chain at rest."""


@dataclass(frozen=True)
class Spring:
    """A spring and damper that never let go: F = preload + k d + c d'.

    stiffness k in N/m, damping c in N s/m, preload in N, offset in m.
    """

    behind: str
    ahead: str
    stiffness: float
    damping: float = 0.0
    preload: float = 0.0
    offset: float = 0.0


@dataclass(frozen=True)
class Stop:
    """A spring and damper that push but never pull: F = max(0, k d + c d') while d > 0."""

    behind: str
    ahead: str
    stiffness: float
    damping: float = 0.0
    offset: float = 0.0


@dataclass(frozen=True)
class ChainContact:
    """A contact by the law F = K d^n (1 + chi d'/v0), clipped at zero.

    v0 is the approach speed of this contact, but never below ``slowest_approach`` (m/s): the law
    describes a blow, and with v0 near zero it would make a slowly pressed contact rigid. Where none is
    given, a thousandth of the chain's speed scale serves. A contact that overlaps at the start takes its
    speed there as its approach speed. Contacts with a capped pressure remember how deep they have yielded; those
    that name the same ``spot`` share it.
    """

    behind: str
    ahead: str
    contact: AnyContact
    slowest_approach: float = 0.0
    offset: float = 0.0
    spot: int = 0


@dataclass(frozen=True)
class Friction:
    """Coulomb friction between two nodes: ``sliding`` against the slip, up to ``sticking`` while there is none, N.

    Where no sticking force is given it is the sliding one.
    """

    behind: str
    ahead: str
    sliding: float
    sticking: float | None = None

    @property
    def holds(self) -> float:
        """Largest force while the nodes stick, N."""
        return self.sliding if self.sticking is None else self.sticking


Link = Spring | Stop | ChainContact | Friction


@dataclass(frozen=True)
class Vibration:
    """A base that shakes: x = mean + amplitude sin(rate t + phase), m, rad/s, rad."""

    mean: float
    amplitude: float
    rate: float
    phase: float = 0.0


@dataclass(frozen=True)
class Chain:
    """Bodies (name: mass in kg), bases (name: position in m, or `Vibration`), links and gravity (m/s^2).

    Raises
    ------
    ValueError
        If a mass is not positive and finite, a link names a node that does not exist, or a body has two friction
        links.
    """

    bodies: Mapping[str, float]
    links: Sequence[Link]
    bases: Mapping[str, float | Vibration] = field(default_factory=dict)
    gravity: float = 0.0

    def __post_init__(self) -> None:
        for name, mass in self.bodies.items():
            if not (mass > 0.0 and np.isfinite(mass)):
                raise ValueError(f"mass of {name!r} must be positive and finite, got {mass!r}")
        both = sorted(set(self.bodies) & set(self.bases))
        if both or not self.bodies:
            raise ValueError(f"a node is either a body or a base, and one must be a body, got both {both}")
        for link in self.links:
            for node in (link.behind, link.ahead):
                if node not in self.nodes:
                    raise ValueError(f"link to unknown node {node!r}; {nearest(node, self.nodes)}")
            if link.behind == link.ahead or not {link.behind, link.ahead} & set(self.bodies):
                raise ValueError(f"a link joins two nodes, one of them a body, got {link.behind!r} and {link.ahead!r}")
            if isinstance(link, ChainContact):
                try:
                    single(link.contact)
                except ValueError as error:
                    raise ValueError(f"link of {link.behind!r} to {link.ahead!r}: {error}") from None
            elif isinstance(link, Friction):
                if not 0.0 <= link.sliding <= link.holds < np.inf:
                    raise ValueError(f"friction needs 0 <= sliding <= sticking, both finite, got {link!r}")
            elif not (link.stiffness >= 0.0 and link.damping >= 0.0):
                raise ValueError(f"stiffness and damping of a link must not be negative, got {link!r}")
        sliding = [node for link in self.links if isinstance(link, Friction) for node in (link.behind, link.ahead)]
        twice = sorted({node for node in sliding if node in self.bodies and sliding.count(node) > 1})
        if twice:
            raise ValueError(f"a body takes one friction link at most, {twice[0]!r} has more")

    @property
    def nodes(self) -> list[str]:
        """Names of bodies, then bases, in the order of the state."""
        return [*self.bodies, *self.bases]


class ChainMotion:
    """Motion of a chain at any time between 0 and its end."""

    def __init__(self, chain: Chain, motion: Motion) -> None:
        self.chain = chain
        self.motion = motion
        self._bodies = len(chain.bodies)

    def positions(self, times: float | Array) -> Array:
        """Return positions, m, shape (N, bodies), or (bodies,) for one time."""
        return self._sample(times)[0][..., : self._bodies]

    def speeds(self, times: float | Array) -> Array:
        """Return speeds, m/s, shape (N, bodies), or (bodies,) for one time."""
        return self._sample(times)[0][..., self._bodies : 2 * self._bodies]

    def forces(self, times: float | Array) -> Array:
        """Return the force of each link, N, shape (N, links), or (links,) for one time."""
        return self._sample(times)[1]

    def dissipated(self) -> Array:
        """Return the energy dissipated in each link by the end, J."""
        return self.motion.end.y[2 * self._bodies :]

    def contacts(self, link: int) -> Array:
        """Return the contacts of a link: begin and end (s) and approach speed (m/s), shape (N, 3).

        A contact that still lasts at the end of the motion ends there.
        """
        return contacts(self.motion, link)

    def _sample(self, times: float | Array) -> tuple[Array, Array]:
        states, forces = self.motion.sample(times)
        return (states[0], forces[0]) if np.ndim(times) == 0 else (states, forces)


def contacts(motion: Motion, link: int) -> Array:
    """Return begin, end (s) and approach speed (m/s) of each contact of a link, shape (N, 3)."""
    changes = motion.changes
    closed = np.concatenate([changes.mode[:, link] != kernels.OPEN, [False]])
    edges = np.diff(closed.astype(int), prepend=0)
    begin, end = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    time = np.append(changes.time, motion.end.time)
    return np.column_stack([time[begin], time[end], changes.memory[begin, link]])


def link_arrays(links: Sequence[Link], nodes: Sequence[str]) -> kernels.Links:
    """Return links as the tables that the kernels take."""
    kinds = {Spring: kernels.SPRING, Stop: kernels.STOP_LINK, ChainContact: kernels.CONTACT, Friction: kernels.FRICTION}
    joins = np.zeros((len(links), 3), dtype=np.int64)
    values = np.zeros((len(links), COLUMNS))
    for i, link in enumerate(links):
        joins[i] = kinds[type(link)], nodes.index(link.behind), nodes.index(link.ahead)
        if isinstance(link, ChainContact):
            values[i] = single(link.contact)
            values[i, SLOWEST], values[i, SPOT] = link.slowest_approach, link.spot
            values[i, OFFSET] = link.offset
            continue
        values[i, YIELD_LOAD] = np.inf
        if isinstance(link, Friction):
            values[i, [kernels.SLIDING_FORCE, kernels.STICKING_FORCE]] = link.sliding, link.holds
            continue
        values[i, [STIFFNESS, DAMPING, OFFSET]] = link.stiffness, link.damping, link.offset
        values[i, PRELOAD] = link.preload if isinstance(link, Spring) else 0.0
    return kernels.Links(joins, values)


def compressions(links: kernels.Links, nodes: Array) -> Array:
    """Return the compression d = x_behind - x_ahead - offset of each link at given node positions, m."""
    return np.asarray(
        nodes[links.joins[:, kernels.BEHIND]] - nodes[links.joins[:, kernels.AHEAD]] - links.values[:, OFFSET]
    )


def first_depths(links: kernels.Links) -> Array:
    """Return the depth from which each contact yields at first, m; 0 where none does."""
    out = np.zeros(len(links.joins))
    depths_at_yield(links.values, out)
    return out


def first_modes(
    links: kernels.Links, nodes: Array, deepest: Array | None = None, speeds: Array | None = None
) -> NDArray[np.int64]:
    """Return the mode of each link at given node positions: links that overlap at the start push already.

    Contacts have yielded to ``deepest``, m; friction sticks where ``speeds``, m/s, are left out or equal.
    """
    left, flat = np.zeros((2, len(links.joins)))
    spots(links.values, first_depths(links) if deepest is None else deepest, left, flat)
    pushing = (links.joins[:, kernels.KIND] == kernels.SPRING) | (compressions(links, nodes) > left)
    modes = np.where(pushing, kernels.PUSHING, kernels.OPEN)
    v = np.zeros(nodes.size) if speeds is None else speeds
    slips = v[links.joins[:, kernels.BEHIND]] - v[links.joins[:, kernels.AHEAD]]
    ways = np.select([slips > 0.0, slips < 0.0], [kernels.SLIDING, kernels.SLIDING_BACK], kernels.STICKING)
    return np.where(links.joins[:, kernels.KIND] == kernels.FRICTION, ways, modes).astype(np.int64)


def stored_energy(
    links: kernels.Links, nodes: Array, deepest: Array | None = None, mode: NDArray[np.int64] | None = None
) -> float:
    """Return the energy stored in springs, stops and contacts at given node positions, J; see `first_modes`.

    Where modes are given, a contact that is open stores nothing, wherever its nodes are.
    """
    kind, value = links.joins[:, kernels.KIND], links.values
    d = compressions(links, nodes)
    in_contacts = np.zeros(d.size)
    energies(value, d, first_depths(links) if deepest is None else deepest, in_contacts)
    if mode is not None:
        in_contacts[mode[: d.size] == kernels.OPEN] = 0.0
    spring = value[:, PRELOAD] * d + 0.5 * value[:, STIFFNESS] * d**2
    stop = 0.5 * value[:, STIFFNESS] * np.maximum(d, 0.0) ** 2
    kinds = [kind == kernels.SPRING, kind == kernels.CONTACT, kind == kernels.STOP_LINK]
    return float(np.sum(np.select(kinds, [spring, in_contacts, stop], 0.0)))


def simulate(
    chain: Chain,
    positions: Mapping[str, float],
    speeds: Mapping[str, float],
    duration: float,
    tolerance: float = TOLERANCE,
) -> ChainMotion:
    """Follow a chain from given positions and speeds (0 where not named) for a time.

    Method: DOP853 with located switches (Hairer, Norsett & Wanner 1993).

    Parameters
    ----------
    chain : Chain
        Bodies, bases, links.
    positions, speeds : mapping
        Positions, m, and speeds, m/s, by body name.
    duration : float
        Length of the motion, s.
    tolerance : float, optional
        Local error of a step over the speed scale of the start, and the way of that speed in the shortest time scale.

    Raises
    ------
    ValueError
        If a name is not a body's, or the duration is not positive and finite.
    IntegrationError
        If the motion cannot be followed.
    """
    names = list(chain.bodies)
    x = np.array([positions.get(name, 0.0) for name in names])
    v = np.array([speeds.get(name, 0.0) for name in names])
    masses = np.array(list(chain.bodies.values()))
    links = link_arrays(chain.links, chain.nodes)
    shakes = _shakes(chain)
    bases = _bases_at(shakes, 0.0)  # for the speeds of bases that shake already
    base = bases[kernels.PLACE]
    table = np.column_stack([masses, np.full(masses.size, float(chain.gravity))])
    system = kernels.ChainSystem(kernels.ChainTables(table, bases, links.joins, links.values), shakes)
    unknown = [name for name in (*positions, *speeds) if name not in names]
    if unknown:
        raise ValueError(f"no body {unknown[0]!r}; {nearest(unknown[0], names)}")
    speed = _speed_scale(chain, links, np.concatenate([x, base]), v)
    links.values[:, SLOWEST] = np.where(links.values[:, SLOWEST] > 0.0, links.values[:, SLOWEST], SLOWEST_SHARE * speed)
    period = shortest_time(chain, speed)
    energy = 0.5 * float(masses @ v**2) + 0.5 * float(masses.sum()) * speed**2
    scale = np.concatenate([np.full(x.size, speed * period), np.full(x.size, speed), np.full(len(chain.links), energy)])
    speeds_of = np.concatenate([v, bases[kernels.SPEED]])
    closing = speeds_of[links.joins[:, kernels.BEHIND]] - speeds_of[links.joins[:, kernels.AHEAD]]
    # what overlaps at the start approaches at its speed there
    memory = np.concatenate([np.maximum(closing, 0.0), first_depths(links), np.ones(len(chain.links))])
    y = np.concatenate([x, v, np.zeros(len(chain.links))])
    start = MotionState(0.0, y, first_modes(links, np.concatenate([x, base]), speeds=speeds_of), memory)
    control = Control(tolerance, scale, FIRST_STEP * period, _longest_step(chain, max(duration, period)), duration)
    motion = integrate(system, start, control, (len(chain.links), kernels.SWITCHES * len(chain.links)))
    _check_ends(chain, links, motion)
    return ChainMotion(chain, motion)


def _shakes(chain: Chain) -> Array:
    """Return mean, amplitude, rate and phase of each base, shape (bases, 4)."""
    bases = (b if isinstance(b, Vibration) else Vibration(b, 0.0, 0.0) for b in chain.bases.values())
    return np.array([dataclasses.astuple(b) for b in bases], dtype=float).reshape(-1, 4)


def _bases_at(shakes: Array, time: float) -> Array:
    """Return the table of bases at a time."""
    bases = np.zeros((4, len(shakes)))
    kernels.shake(shakes, bases, time)
    return bases


def _longest_step(chain: Chain, otherwise: float) -> float:
    """Return the longest step that sees every shaking base come and go, s; ``otherwise`` where none shakes."""
    fastest = max((abs(base.rate) for base in chain.bases.values() if isinstance(base, Vibration)), default=0.0)
    return min(otherwise, 2.0 * np.pi / _STEPS_A_PERIOD / fastest) if fastest > 0.0 else otherwise


def _check_ends(chain: Chain, links: kernels.Links, motion: Motion) -> None:
    """Refuse a motion that pressed a contact beyond the end of its law at the begin of a step, or at the end."""
    touches = [(i, link.contact) for i, link in enumerate(chain.links) if isinstance(link, ChainContact)]
    ending = [(i, contact) for i, contact in touches if not isinstance(contact, Contact)]
    if not ending:
        return
    shakes, deepest = _shakes(chain), np.full(len(chain.links), -np.inf)
    steps = [(t, y) for record in motion.records() for t, y in zip(record.time, record.dense[:, 0], strict=True)]
    for time, state in (*steps, (motion.end.time, motion.end.y)):
        nodes = np.append(state[: len(chain.bodies)], _bases_at(shakes, time)[kernels.PLACE])
        deepest = np.maximum(deepest, compressions(links, nodes))
    for i, contact in ending:
        check_end(contact, float(deepest[i]))


def _speed_scale(chain: Chain, links: kernels.Links, nodes: Array, speeds: Array) -> float:
    """Return a speed that the bodies have or will get from stored energy and gravity, m/s."""
    masses = np.array(list(chain.bodies.values()))
    # bodies fall, at most, as far as they stand from what they meet
    drop = float(np.abs(compressions(links, nodes)).max(initial=_LEAST_DROP))
    gained = 2.0 * stored_energy(links, nodes) / float(masses.sum()) + 2.0 * abs(chain.gravity) * drop
    preload = max((abs(link.preload) for link in chain.links if isinstance(link, Spring)), default=0.0)
    gained += 2.0 * preload * drop / float(masses.sum())
    shaken = max((abs(b.amplitude * b.rate) for b in chain.bases.values() if isinstance(b, Vibration)), default=0.0)
    moving = max(float(np.abs(speeds).max(initial=0.0)), float(np.ptp(speeds)))
    return max(moving, max(gained, 0.0) ** 0.5, shaken, _LEAST_SPEED)


def shortest_time(chain: Chain, speed: float) -> float:
    """Return the shortest time scale of a chain at a given speed, s: sqrt(m/k), d_max/v0 of a contact, 1/rate."""
    times = [1.0 / abs(b.rate) for b in chain.bases.values() if isinstance(b, Vibration) and b.rate]
    for link in chain.links:
        mass = 1.0 / sum(1.0 / chain.bodies[node] for node in (link.behind, link.ahead) if node in chain.bodies)
        if isinstance(link, ChainContact):
            times.append(elastic_indentation(link.contact, mass, speed) / speed)
        elif not isinstance(link, Friction) and link.stiffness > 0.0:
            times.append((mass / link.stiffness) ** 0.5)
    return min(times, default=1.0)
