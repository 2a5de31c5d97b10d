"""When a struck object is back on its stop: closed forms of its flight against the spring, and of its bounce."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from strikewave.machines import StruckObject


@dataclass(frozen=True)
class Flight:
    """A retreat and its return: time until it is back (s), highest retreat (m), speed with which it is back (m/s)."""

    time: float
    retreat: float
    speed: float


def flight(struck: StruckObject, speed: float) -> Flight:
    """Return how an object that leaves its stop with a speed comes back, without friction.

    With the distance x from the stop, net preload F = preload - m g, spring k and damper c,

        m x'' + c x' + k x + F = 0,   x(0) = 0, x'(0) = v.

    About x = -F/k this is the damped oscillator: with w = sqrt(k/m), z = c/(2 m w), w_d = w sqrt(1 - z^2),

        x = -F/k + exp(-z w t) [A cos(w_d t) + B sin(w_d t)],  A = F/k,  B = (v + z w A)/w_d,

    which turns where tan(w_d t) = v w_d / (w (w A + z v)) and is back where x = 0: undamped at 2 atan2(v, w A)/w, else
    at a root that is bracketed by the turn and the deepest point of the way back, half a period later.

    Parameters
    ----------
    struck : StruckObject
        Masses, spring, preload and damper; z must be below 1.
    speed : float
        v, m/s, above zero.

    Raises
    ------
    ValueError
        If the damper is so strong that the object creeps back (z >= 1).

    Examples
    --------
    >>> light = StruckObject(0.06, 0.399, 9e7, 200.0, 40e3, 400.0, 0.0, 2e5, 0.5, 9.8)
    >>> back = flight(light, 5.0)
    >>> taken = (400.0 - 0.459 * 9.8) * back.retreat + 0.5 * 40e3 * back.retreat**2
    >>> round(taken / (0.5 * 0.459 * 5.0**2), 9), round(back.speed, 9)
    (1.0, 5.0)
    """
    w = math.sqrt(struck.spring / struck.mass)
    z = struck.damper / (2.0 * struck.mass * w)
    if z >= 1.0:
        raise ValueError(f"the damper is {z:.3g} of critical: the object creeps back; below 1 it swings")
    wd, a = w * math.sqrt(1.0 - z * z), (struck.preload - struck.mass * struck.gravity) / struck.spring
    b = (speed + z * w * a) / wd

    def place(t: float) -> float:
        return -a + math.exp(-z * w * t) * (a * math.cos(wd * t) + b * math.sin(wd * t))

    def rate(t: float) -> float:
        swing = (b * wd - z * w * a) * math.cos(wd * t) - (a * wd + z * w * b) * math.sin(wd * t)
        return math.exp(-z * w * t) * swing

    turn = math.atan2(speed * wd, w * (w * a + z * speed)) / wd
    back = 2.0 * math.atan2(speed, w * a) / w if z == 0.0 else _root(place, turn, turn + math.pi / wd)
    return Flight(back, place(turn), -rate(back))


def bounce_time(struck: StruckObject) -> float:
    """Return how long the object stays on its stop before it is thrown back, s, its preload left out.

    On a linear spring and damper without tension, d = (v/w_d) exp(-z w t) sin(w_d t) until k d + c d' = 0 at
    w_d t = 2 acos(z): t = 2 acos(z) / (w sqrt(1 - z^2)), and with z > 1 t = 2 acosh(z) / (w sqrt(z^2 - 1))
    (Schwager & Poschel 2007).

    Examples
    --------
    >>> hard = StruckObject(0.06, 0.399, 9e7, 200.0, 40e3, 400.0, 0.0, 2e5, 1.0, 9.8)
    >>> round(bounce_time(hard) * (2e5 / 0.459) ** 0.5 / math.pi, 9)
    1.0
    """
    w = math.sqrt(struck.stop_stiffness / struck.mass)
    z = struck.stop_damping / (2.0 * struck.mass * w)
    if z == 1.0:
        return 2.0 / w
    return 2.0 * (math.acos(z) if z < 1.0 else math.acosh(z)) / (w * math.sqrt(abs(1.0 - z * z)))


def arrivals(struck: StruckObject, speed: float) -> tuple[float, float]:
    """Return when a struck object is back on its stop, and when again after one bounce, s; NaN where it creeps.

    The second flight begins with the speed of the first return times the stop's restitution.

    Examples
    --------
    >>> soft = StruckObject(0.06, 0.399, 9e7, 200.0, 40e3, 400.0, 20.0, 2e5, 0.5, 9.8)
    >>> [round(t * 1e3, 2) for t in arrivals(soft, 5.0)]
    [6.9, 15.32]
    """
    try:
        first = flight(struck, speed)
        second = flight(struck, struck.stop_restitution * first.speed)
    except ValueError:
        return math.nan, math.nan
    return first.time, first.time + bounce_time(struck) + second.time


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    from scipy.optimize import brentq

    return float(brentq(function, low, high, xtol=1e-15, rtol=1e-14))
