"""When a struck object is back on its stop: closed forms of its flight against the spring, and of its bounce."""

from __future__ import annotations

import math

from strikewave.machines import StruckObject
from strikewave.studies.settings.estimate import Support, return_arc


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
    """Return when a struck object is back on its stop, and when again after one bounce, s; NaN where it never is.

    It leaves the stop at a speed (m/s) and flies without friction; the second flight begins with the speed of the first
    return times the stop's restitution.

    Examples
    --------
    >>> soft = StruckObject(0.06, 0.399, 9e7, 200.0, 40e3, 400.0, 20.0, 2e5, 0.5, 9.8)
    >>> [round(t * 1e3, 2) for t in arrivals(soft, 5.0)]
    [6.9, 15.32]
    """
    support = Support(struck.spring, struck.preload, struck.damper)
    weight = struck.mass * struck.gravity
    try:
        first = return_arc(support, struck.mass, speed, weight)
        second = return_arc(support, struck.mass, struck.stop_restitution * first.speed, weight)
    except ValueError:
        return math.nan, math.nan
    return first.time, first.time + bounce_time(struck) + second.time
