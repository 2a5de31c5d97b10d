"""First estimates of a rotary machine's settings: one short function for each law; full runs correct them.

The pulse is taken as a half-sine, the striker as a wall that moves with its nose, the object as a mass on its frame.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from typing import NamedTuple

from strikewave.base.constants import Material
from strikewave.signal.pulse import HALF_SINE_WIDTH

SETTLED = 0.01
"""Share of the speed after the blow below which the object counts as at rest: it changes the next peak by 1 %."""
MOST_BOUNCES = 200
"""Bounces after which an object counts as never at rest: two hundred bring a restitution of 0.977 down to `SETTLED`."""
CLEARANCE = 1.25
"""Way of the carriage over the engagement at which strikers pass without touching. Chosen: a quarter more than the
noses reach, for their stretch and for errors of reach."""
ROUNDING = 1e-12  # share by which a way may exceed the stroke by rounding alone


def turntable_speed(strikers: int, interval: float) -> float:
    """Return the speed at which N strikers pass at an interval T (s), w = 2 pi/(N T), rad/s. Source: Li & Ma 2019."""
    return 2.0 * math.pi / (strikers * interval)


def pulse_velocity_change(peak: float, width: float) -> float:
    """Return the velocity change of a half-sine, (2/pi) A w/0.9362, m/s.

    ``peak`` A (m/s^2), ``width`` w (s) at 10 % of the peak, which is 1 - (2/pi) asin 0.1 of the whole duration.
    """
    return 2.0 / math.pi * peak * width / HALF_SINE_WIDTH


def approach_speed(velocity_change: float, restitution: float) -> float:
    """Return the speed at which a wall strikes an object at rest for a velocity change, v = dv/(1 + e), m/s."""
    return velocity_change / (1.0 + restitution)


def approach_at(engagement: float, speed: float, radius: float) -> float:
    """Return the speed at which noses meet a face at rest, v = w sqrt(2 R q - q^2), m/s.

    ``engagement`` q and ``radius`` R (m), turntable's ``speed`` w (rad/s). Source: docs/machines.md.
    """
    return speed * math.sqrt(engagement * (2.0 * radius - engagement))


def engagement(approach: float, speed: float, radius: float) -> float:
    """Return the engagement at which noses meet the face at a speed, q = R - sqrt(R^2 - (v/w)^2), m.

    The inverse of `approach_at`. ``approach`` v (m/s), turntable's ``speed`` w (rad/s), ``radius`` R (m).
    """
    reach = approach / speed
    if reach > radius:
        raise ValueError(f"an approach of {approach:.4g} m/s is above the {speed * radius:.4g} m/s of the rim")
    return reach * reach / (radius + math.sqrt(radius * radius - reach * reach))


def largest_engagement(strikers: int, radius: float, stroke: float) -> float:
    """Return the largest engagement that a machine allows, m: half a pitch before the apex, and what the stroke clears.

    q = min(R (1 - cos(min(pi/2, pi/N))), s/1.25).
    """
    return min(radius * (1.0 - math.cos(min(0.5 * math.pi, math.pi / strikers))), stroke / CLEARANCE)


def width_stiffness(width: float, mass: float, in_series: float = math.inf) -> float:
    """Return the stiffness that gives a mass a half-sine of a width, N/m; infinite where the other spring is too soft.

    k = m (0.9362 pi/w)^2, w at 10 % of the peak; with another spring k2 in series 1/(1/k - 1/k2).
    """
    k = mass * (math.pi * HALF_SINE_WIDTH / width) ** 2
    return k / (1.0 - k / in_series) if k < in_series else math.inf


def engagement_sensitivity(engagement: float, radius: float) -> float:
    """Return the relative change of the approach speed with the engagement, (R - q)/(2 R q - q^2), 1/m.

    Peaks follow it: what a misplaced object costs.
    """
    return (radius - engagement) / (engagement * (2.0 * radius - engagement))


def passage_time(engagement: float, speed: float, radius: float) -> float:
    """Return how long a nose reaches beyond a face at rest, t = 2 arccos(1 - q/R)/w, s.

    An object that is back sooner is hit by the same nose again. ``engagement`` q and ``radius`` R (m), ``speed`` w
    (rad/s).
    """
    return 2.0 * math.acos(1.0 - engagement / radius) / speed


class Arc(NamedTuple):
    """Flight of the object from its stop and back: time, s; speed of the return, m/s; largest displacement, m."""

    time: float
    speed: float
    largest_displacement: float


class Support(NamedTuple):
    """Support that brings the object back: spring, N/m; preload, N; damper, N s/m."""

    spring: float
    preload: float
    damper: float


def return_arc(support: Support, mass: float, speed: float, weight: float = 0.0) -> Arc:
    """Return how an object comes back to a rigid stop that it leaves at a speed (m/s).

    m x'' + c x' + k x + F = 0 with x(0) = 0, x'(0) = u and F = preload - weight (N): with y = x + F/k,
    D = c/2m and L = sqrt(D^2 - k/m) it is y = (F/k) (cosh Lt + (D/L) sinh Lt) e^-Dt + (u/L) e^-Dt sinh Lt, L imaginary
    below critical damping. Without damper it returns after (2/W) atan(u m W/F), W = sqrt(k/m). ``mass`` in kg.
    """
    force, k = support.preload - weight, support.spring
    if not force > 0.0:
        raise ValueError(f"a preload of {support.preload:.4g} N does not hold a weight of {weight:.4g} N")
    decay, rest = 0.5 * support.damper / mass, force / k
    root = cmath.sqrt(decay * decay - k / mass)
    if abs(root) < 1e-6 * math.sqrt(k / mass):  # critical: the limit, but for a share of 1e-12
        root = complex(1e-6 * math.sqrt(k / mass))

    def at(t: float) -> tuple[float, float]:
        fast, slow = cmath.exp((-decay - root) * t), cmath.exp((root - decay) * t)
        c, s = 0.5 * (slow + fast).real, (0.5 * (slow - fast) / root).real
        y = rest * (c + decay * s) + speed * s
        return y - rest, speed * (c - decay * s) - k / mass * rest * s

    turning = (cmath.atanh(root * speed / (decay * speed + force / mass)) / root).real
    if turning <= 0.0:
        turning += math.pi / abs(root)
    late = 2.0 * turning
    while at(late)[0] > 0.0:
        late *= 2.0
    time = _root(lambda t: at(t)[0], turning, late)
    return Arc(time, -at(time)[1], at(turning)[0])


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    from scipy.optimize import brentq

    return float(brentq(function, low, high, xtol=1e-15, rtol=1e-12))


def settling_time(support: Support, mass: float, speed: float, restitution: float, weight: float = 0.0) -> float:
    """Return how long an object bounces on a rigid stop before it is at rest, s: the sum of its arcs.

    It leaves at ``speed`` u (m/s), comes back, leaves again at e times the speed of the return, and so on, until that
    is below 1 % of u. How long it is on the stop is left out; the full run has it.
    """
    time, leaving = 0.0, speed
    for _ in range(MOST_BOUNCES):
        arc = return_arc(support, mass, leaving, weight)
        time, leaving = time + arc.time, restitution * arc.speed
        if leaving < SETTLED * speed:
            return time
    return math.inf


def support_for(
    time: float, mass: float, speed: float, preload_ratio: float, damping_ratio: float, weight: float = 0.0
) -> Support:
    """Return the support whose first arc takes a time (s).

    With F = P m u W and c = 2 Z m W, W = sqrt(k/m), the product of W and the time of return depends on
    ``preload_ratio`` P and ``damping_ratio`` Z alone. ``speed`` u (m/s) is that after the blow, ``weight`` (N) is added
    to the preload.
    """
    unit = return_arc(Support(1.0, preload_ratio, 2.0 * damping_ratio), 1.0, 1.0)
    w = unit.time / time
    return Support(mass * w * w, preload_ratio * mass * speed * w + weight, 2.0 * damping_ratio * mass * w)


def cleared_way(share: float) -> float:
    """Return the way of the cycloidal feed after a share u of its time, over the stroke: u - sin(2 pi u)/(2 pi)."""
    u = min(max(share, 0.0), 1.0)
    return u - math.sin(2.0 * math.pi * u) / (2.0 * math.pi)


def feed_time(available: float, engagement: float, stroke: float) -> float:
    """Return the longest time of a stroke whose last (or first) ``available`` seconds clear the strikers, s.

    In that time the carriage makes 1.25 times the engagement of its stroke (m).
    """
    wanted = CLEARANCE * engagement / stroke
    if wanted > 1.0 + ROUNDING or available <= 0.0:
        raise ValueError(f"a stroke of {stroke:.4g} m does not clear an engagement of {engagement:.4g} m in time")
    return available / (_root(lambda u: cleared_way(u) - wanted, 0.0, 1.0) if wanted < 1.0 else 1.0)


def disc_stress(disc: Material, speed: float, radius: float) -> float:
    """Return the largest stress of a uniform solid disc, at its centre, s = (3 + nu)/8 rho (w R)^2, Pa.

    Radial and hoop stress are equal there. ``speed`` w (rad/s), ``radius`` R (m). Range: thin, elastic, no bore (a
    small one doubles the stress at its edge), no masses on the rim. Source: Timoshenko & Goodier 1970.
    """
    return (3.0 + disc.poissons_ratio) / 8.0 * disc.density * (speed * radius) ** 2


def rim_speed_at_yield(disc: Material, strength: float) -> float:
    """Return the rim speed at which a uniform solid disc first yields, sqrt(8 s_y/((3 + nu) rho)), m/s.

    Source: as `disc_stress`; the two equal stresses at the centre reach the yield strength s_y (Pa) by von Mises too.
    """
    return math.sqrt(8.0 * strength / ((3.0 + disc.poissons_ratio) * disc.density))
