"""The stress-wave route of Li & Ma 2019, as printed and corrected, and the staircase of force about a layer.

A wave eps_i(t) comes down the upper fixture, enters the specimen at interface I (x = 0) and is reflected
between it and interface II (x = l) many times. Time t counts from its first arrival at x; compression and
motion along the blow are positive. Symbols: c = sqrt(Ee/rhoe) wave speed of the specimen (m/s), l its
length (m), t0 = l/c, tl = (l - x)/c, gamma, F_I and F_II of `Sandwich`, q = -F_I F_II. Index 1 is the
upper fixture, e the specimen, 2 the lower fixture. Both routes are a sum over waves, see `arrivals`.

The staircase is the growth of force in steps behind and before a layer between two endless neighbours: a jump of force
comes down the first neighbour and enters the layer, which reflects it many times between its interfaces I (where it
enters) and II (where it leaves). With F_I and F_II of `Sandwich`:

    T_1 = 1 + F_I,    T_2 = 1 + F_II,    q = -F_I F_II

T_1 and T_2 are the shares of force that pass the interfaces, q what one round trip leaves; all (-).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base.errors import InputError, nearest
from strikewave.signal.interpolation import monotone_cubic
from strikewave.waves.layers import Layer, Stack

Floats = NDArray[np.float64]
History = Callable[[Floats], Floats]

MOST_TRANSFERS = 100_000  # some seconds of work; a layer that needs more is a film
"""Most waves of a sum over the transits of a layer."""
MOST_ADDED = 2e7  # a second
"""Most waves times instants of a sum."""
ROUTES = ("as printed", "corrected")
"""The two routes by name."""
_VANISHED, _LOST = 1e-18, 1e-17
"""Share of the first wave below which an echo no longer counts, and factor over the largest below which a wave is left
out: a hundredth and a tenth of the last bit of the sum."""


@dataclass(frozen=True)
class Sandwich:
    """A specimen between two fixtures, whose lengths count in `valid_until` only; equations of Li & Ma 2019."""

    upper: Layer
    specimen: Layer
    lower: Layer

    @property
    def gamma(self) -> float:
        """First strain in the specimen over incident strain, gamma = (E1/Ee) (A1/Ae) 2/(1 + n_I), n_I = Z1/Ze.

        Eqs (27)-(29); (28) prints the incident stress where the strain is meant.
        """
        upper, specimen = self.upper, self.specimen
        entry = 2.0 / (1.0 + upper.impedance / specimen.impedance)
        return (upper.modulus / specimen.modulus) * entry * (upper.area / specimen.area)

    @property
    def first_reflection(self) -> float:
        """F_I = (1 - n_I)/(1 + n_I), n_I = Z1/Ze; interface I throws a backward wave back by -F_I; eq (33)."""
        ratio = self.upper.impedance / self.specimen.impedance
        return (1.0 - ratio) / (1.0 + ratio)

    @property
    def second_reflection(self) -> float:
        """F_II = (1 - n_II)/(1 + n_II), n_II = Ze/Z2: -1 at a free end, 0 matched, 1 at a rigid wall; eq (31)."""
        ratio = self.specimen.impedance / self.lower.impedance
        return (1.0 - ratio) / (1.0 + ratio)

    @property
    def transit(self) -> float:
        """Time of a wave through the specimen, t0 = l/c, s."""
        return self.specimen.transit

    def valid_until(self, position: float) -> float:
        """Return the time of the first echo of a fixture's far end at x, min(2 t1, 2 tl + 2 t2), s after the arrival.

        t1, t2 are the transit times of the fixtures. Both routes take them as endless: no longer than this.
        """
        return 2.0 * min(self.upper.transit, (1.0 - position) * self.transit + self.lower.transit)


class Incident(NamedTuple):
    """Strain and strain rate (1/s) of the incident wave as functions of an array of times (s); zero up to t = 0."""

    strain: History
    rate: History


def incident_strain(times: ArrayLike, force: ArrayLike, upper: Layer) -> Incident:
    """Return the wave of a force (N) that travels forward in the upper fixture, eps_i = F/(E1 A1).

    A monotone cubic runs through the samples and never overshoots them; the rate is its derivative.
    Outside the samples both are zero, so a force that starts or ends above zero does so in a jump, which
    the rate does not contain. Source: F = E A eps; the curve is Fritsch & Butland's 1984.
    """
    samples = np.asarray(times, dtype=float)
    curve = monotone_cubic(samples, np.asarray(force, dtype=float) / (upper.modulus * upper.area))

    def within(values: History) -> History:
        return lambda t: np.where((t >= samples[0]) & (t <= samples[-1]), values(t), 0.0)

    return Incident(within(curve), within(curve.derivative()))


class Arrival(NamedTuple):
    """One wave at x: its delay after the first in t0, its strain and its velocity/c over the incident strain."""

    transits: float
    strain: float
    velocity: float


def arrivals(sandwich: Sandwich, position: float, transfers: int, route: str) -> list[Arrival]:
    """Return the first waves that pass x = position l, as many as there are transfers.

    Corrected: forward waves gamma q^m at 2 m t0, each followed by its echo gamma F_II q^m at
    2 m t0 + 2 tl, with velocity -c times its strain. Source: d'Alembert's solution.

    As printed, k = transfers: the terms of (36), n by twos to k. Its k-th window, tl + (k - 2) t0 < t
    <= tl + (k - 1) t0, opens as the k-th wave comes, so that each term is on from its own delay. S(k)
    changes nothing: with n = 2, 4, .., k the sum behind it is empty at k = 2. Amplitudes are right, but

    - the echo from interface II comes after tl; it has that far to go and back, 2 tl, and a round trip
      ends 2 t0 after the first arrival, not tl + t0;
    - v = +c eps is taken for backward waves too, which move against the blow: v = -c eps;
    - the limits "n = 3" and "n = 2" below the sums contradict the n = 3, 5, .., k and n = 2, 4, .., k
      beside them, and the windows are written with the running n where k is meant;
    - (34) and (35) close the bracket of gamma before their later terms; (36) does not.

    Source: Li & Ma 2019, eqs (36), (37), (40).

    Raises
    ------
    ValueError
        If the route is unknown, the position outside 0 to 1, or there is not at least one transfer.
    """
    if route not in ROUTES:
        raise InputError("route", route, " or ".join(f'"{name}"' for name in ROUTES), nearest(route, ROUTES))
    if transfers < 1:
        raise ValueError(f"at least one transfer is needed, got {transfers!r}")
    if not 0.0 <= position <= 1.0:
        raise ValueError(f"the position x/l must lie within 0 to 1, got {position!r}")
    rest = 1.0 - position
    if route == "as printed":
        return [Arrival(delay, size, size) for delay, size in _printed(sandwich, rest, transfers)]
    upper, lower = -sandwich.first_reflection, sandwich.second_reflection
    waves = []
    for number in range(transfers):
        trips, echo = divmod(number, 2)
        size = sandwich.gamma * (upper * lower) ** trips * lower**echo
        waves.append(Arrival(2.0 * (trips + echo * rest), size, -size if echo else size))
    return waves


def _printed(sandwich: Sandwich, rest: float, k: int) -> list[tuple[float, float]]:
    """Return delay over t0 and factor of each term of eq (36) for k transfers; rest = tl/t0."""
    upper, lower = -sandwich.first_reflection, sandwich.second_reflection
    terms = [(0.0, 1.0)]
    if k % 2:
        for n in range(3, k + 1, 2):
            terms.append((rest + n - 3, upper ** ((n - 3) // 2) * lower ** ((n - 1) // 2)))
            terms.append((rest + n - 2, upper ** ((n - 1) // 2) * lower ** ((n - 1) // 2)))
    else:
        correction = 0.0 if k == 2 else 1.0  # S(k), eq (37)
        for n in range(2, k + 1, 2):
            if n >= 3:
                terms.append((rest + n - 3, correction * upper ** ((n - 2) // 2) * lower ** ((n - 2) // 2)))
            terms.append((rest + n - 2, upper ** ((n - 2) // 2) * lower ** (n // 2)))
    return [(delay, sandwich.gamma * factor) for delay, factor in terms]


def strain(
    sandwich: Sandwich, incident: Incident, position: float, times: ArrayLike, route: str, transfers: int | None = None
) -> Floats:
    """Return the strain at x = position l, times in s from the first arrival there; see `arrivals` for the routes.

    Corrected: R(t) + L(t) with R = gamma sum_m q^m eps_i(t - 2 m t0) and
    L = gamma F_II sum_m q^m eps_i(t - 2 m t0 - 2 tl). Without ``transfers`` all waves that have come
    by the last time count. Source: Li & Ma 2019, eq (36).
    """
    waves = arrivals(sandwich, position, _count(sandwich, times, transfers), route)
    return _added(sandwich, incident.strain, times, [(wave.transits, wave.strain) for wave in waves])


def velocity(
    sandwich: Sandwich, incident: Incident, position: float, times: ArrayLike, route: str, transfers: int | None = None
) -> Floats:
    """Return the particle velocity at x, m/s: corrected c (R - L), as printed c eps; arguments as in `strain`.

    As printed a free end stands still and a rigid wall moves, the wrong way round; Li & Ma 2019, eq (38).
    """
    waves = arrivals(sandwich, position, _count(sandwich, times, transfers), route)
    speed = sandwich.specimen.bar_speed
    return _added(sandwich, incident.strain, times, [(wave.transits, speed * wave.velocity) for wave in waves])


def acceleration(
    sandwich: Sandwich, incident: Incident, position: float, times: ArrayLike, route: str, transfers: int | None = None
) -> Floats:
    """Return the acceleration at x, m/s^2: the time derivative of `velocity`; arguments as in `strain`.

    For a pulse that is slow beside t0, (40) overstates it by Z2/Ze. Source: Li & Ma 2019, eq (40).
    """
    return velocity(sandwich, Incident(incident.rate, incident.rate), position, times, route, transfers)


def mean_acceleration(
    sandwich: Sandwich, incident: Incident, times: ArrayLike, route: str, transfers: int | None = None
) -> Floats:
    """Return the acceleration averaged over the specimen, m/s^2; times in s from the arrival at interface I.

    (1/l) int a dx in closed form: a wave whose delay d runs evenly from d0 at x = 0 to d1 at x = l adds
    c [eps_i(t - d0) - eps_i(t - d1)]/(d1 - d0). Corrected, the sum is Newton's law, [F(0) - F(l)]/m. As
    printed, every wave but the first is at all x at once, d0 = d1, and adds its rate; Li & Ma 2019, eq (40).
    """
    count, speed = _count(sandwich, times, transfers), sandwich.specimen.bar_speed
    at_once, in_turn = [], []
    for top, bottom in zip(*(arrivals(sandwich, x, count, route) for x in (0.0, 1.0)), strict=True):
        enters, leaves = top.transits, bottom.transits + 1.0
        if enters == leaves:  # exact: both are whole numbers
            at_once.append((enters, speed * top.velocity))
        else:
            weight = speed * top.velocity / ((leaves - enters) * sandwich.transit)
            in_turn += [(enters, weight), (leaves, -weight)]
    return _added(sandwich, incident.rate, times, at_once) + _added(sandwich, incident.strain, times, in_turn)


def superposed(rigid: ArrayLike, wave: ArrayLike) -> Floats:
    """Return the total of Li & Ma 2019, rigid-body plus stress-wave acceleration, m/s^2.

    Wrong as mechanics: the mean of the wave acceleration over the specimen already is its rigid-body
    acceleration, so that the sum counts it twice. An exact solution of the finite stack holds both.
    """
    return np.asarray(np.asarray(rigid, dtype=float) + np.asarray(wave, dtype=float))


def waves_that_count(sandwich: Sandwich, times: ArrayLike) -> int:
    """Return how many transfers count by the last time: the k-th wave does not come before (k - 2) t0.

    Waves that echoes have made smaller than rounding are left out.
    """
    arrived = int(np.max(np.asarray(times, dtype=float), initial=0.0) / sandwich.transit) + 2
    share = abs(sandwich.first_reflection * sandwich.second_reflection)
    if share < 1.0:
        arrived = min(arrived, 2 * math.ceil(math.log(_VANISHED) / math.log(max(share, _VANISHED))) + 4)
    return arrived


def too_many(sandwich: Sandwich, times: ArrayLike) -> bool:
    """Return whether a sum over the transits of a layer would take long: it is thin, or followed for long."""
    waves = waves_that_count(sandwich, times)
    return waves > MOST_TRANSFERS or waves * np.size(times) > MOST_ADDED


def _count(sandwich: Sandwich, times: ArrayLike, transfers: int | None) -> int:
    """Return the number of transfers to count, or raise ValueError where there are `too_many`."""
    arrived = waves_that_count(sandwich, times)
    if too_many(sandwich, times):
        raise ValueError(
            f"layer {sandwich.specimen.name} is too thin for the routes of Li & Ma 2019: {arrived} waves would count, "
            f"at {np.size(times)} instants"
        )
    return arrived if transfers is None else min(transfers, arrived)


def _added(sandwich: Sandwich, history: History, times: ArrayLike, waves: list[tuple[float, float]]) -> Floats:
    """Return the sum of waves, each a delay over t0 and a factor on the history, zero until it comes."""
    total = np.zeros_like(times, dtype=float)
    least = _LOST * max((abs(factor) for _, factor in waves), default=0.0)
    for transits, factor in waves:
        if abs(factor) > least:
            later = np.asarray(times) - transits * sandwich.transit
            come = later > 0.0
            total[come] += factor * history(later[come])
    return total


EXACT = "exact"
"""The finite stack itself, as the delay lines solve it."""


class RouteHistory(NamedTuple):
    """Force (N), velocity (m/s) and acceleration (m/s^2) of the stress wave at a tap by one route."""

    force: Floats
    velocity: Floats
    acceleration: Floats


def specimen_of(stack: Stack, layer: int) -> Sandwich | None:
    """Return a layer between its neighbours; None for the first and the last one, which have but one."""
    if not 0 < layer < len(stack.layers) - 1:
        return None
    return Sandwich(*stack.layers[layer - 1 : layer + 2])


def too_thin(stack: Stack, times: Floats) -> list[str]:
    """Return the layers that no route follows to these times: their waves would be too many."""
    specimens = (specimen_of(stack, layer) for layer in range(len(stack.layers)))
    return [layers.specimen.name for layers in specimens if layers is not None and too_many(layers, times)]


def route_history(
    stack: Stack, layer: int, position: float, times: Floats, face_force: Floats, route: str
) -> RouteHistory:
    """Return the histories of a tap by a route of Li & Ma 2019, driven by the force on the first face of the stack.

    The tap lies at a fraction of a layer, the specimen, from its loaded side; times from the start of the load are in
    s, the force in N. It is taken to travel forward unchanged to the specimen, whose neighbours count as endless
    fixtures; everything else in the stack, and every echo from beyond the neighbours, is left out, as in the paper.

    Raises
    ------
    ValueError
        If the layer has no neighbour on one side, or the route is unknown.
    """
    sandwich = specimen_of(stack, layer)
    if sandwich is None:
        raise ValueError(f"the route {route!r} needs a specimen between two fixtures; layer {layer} has one neighbour")
    specimen = stack.layers[layer]
    arrival = sum(x.transit for x in stack.layers[:layer]) + position * specimen.transit
    incident = incident_strain(times, face_force, sandwich.upper)
    since = times - arrival
    return RouteHistory(
        specimen.modulus * specimen.area * strain(sandwich, incident, position, since, route),
        velocity(sandwich, incident, position, since, route),
        acceleration(sandwich, incident, position, since, route),
    )


class Staircase(NamedTuple):
    """Forces at interface I and interface II: shares of the jump that comes in, step by step, or N."""

    first: Floats
    second: Floats


def staircase(sandwich: Sandwich, steps: int) -> Staircase:
    """Return the closed-form steps of force at both interfaces of a bonded layer between endless neighbours.

    With t_0 the transit of the layer, t counted from when the jump reaches interface I, and n = 0, 1, ..:

        f_II(n) = T_1 T_2 sum_{m=0..n} q^m                   from t = (2 n + 1) t_0
        f_I(n)  = T_1 [1 + F_II T_i sum_{m=0..n-1} q^m]      from t = 2 n t_0,    T_i = 1 - F_I

    Both end at 2 Z_2/(Z_1 + Z_2), the share that passes where the layer is left out. They hold until the first echo
    from beyond the neighbours: `Sandwich.valid_until` later than the first arrival. Source: the geometric series of
    repeated reflections in a bar of finite length, Kolsky, Stress Waves in Solids (1963), ch. 2; with the coefficients
    of Li & Ma 2019, eqs (29)-(33).
    """
    if steps < 1:
        raise ValueError(f"at least one step is needed, got {steps!r}")
    first, second = sandwich.first_reflection, sandwich.second_reflection
    powers = (-first * second) ** np.arange(steps)
    sums = np.cumsum(powers)
    before = np.concatenate([[0.0], sums[:-1]])
    entered = 1.0 + first
    return Staircase(entered * (1.0 + second * (1.0 - first) * before), entered * (1.0 + second) * sums)


def endless_force(stack: Stack, layer: int, times: Floats, load_times: Floats, load: Floats) -> Staircase:
    """Return the force at both interfaces under any load, N, as if joints were bonded and neighbours endless.

    The steps of `staircase`, each with the history of the load: the corrected route of Li & Ma 2019 at x = 0 and
    x = l. What comes down is the load times 2 Z_b/(Z_a + Z_b) for each joint a|b above the first neighbour. Up to
    `first_echoes` this is what a bonded stack does.

    Raises
    ------
    ValueError
        If the layer has one neighbour only.
    """
    sandwich = specimen_of(stack, layer)
    if sandwich is None:
        raise ValueError(f"a staircase needs a layer between two others; layer {layer} has one neighbour")
    above = stack.layers[:layer]
    passed = math.prod(2.0 * b.impedance / (a.impedance + b.impedance) for a, b in pairwise(above))
    incident = incident_strain(load_times, passed * np.asarray(load), sandwich.upper)
    since = times - sum(part.transit for part in above)
    first = strain(sandwich, incident, 0.0, since, "corrected")
    second = strain(sandwich, incident, 1.0, since - sandwich.transit, "corrected")
    stiffness = sandwich.specimen.modulus * sandwich.specimen.area
    return Staircase(stiffness * first, stiffness * second)


def first_echoes(stack: Stack, layer: int) -> tuple[float, float]:
    """Return the times of the first echo from beyond the neighbours at interface I and II, s after the front is at I.

    From above the earliest comes 2 min t_k behind the front, over the transits t_k of the layers above. From below it
    has gone through the lower neighbour and back, and for interface I once more through the layer itself; a matched
    end behind the neighbour sends none.
    """
    transits = [part.transit for part in stack.layers]
    ends_here = layer + 2 == len(transits) and stack.end.kind == "matched"
    above, below = 2.0 * min(transits[:layer]), math.inf if ends_here else 2.0 * transits[layer + 1]
    return min(above, 2.0 * transits[layer] + below), transits[layer] + min(above, below)
