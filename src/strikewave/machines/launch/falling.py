"""How fast a body arrives that falls, guided or drawn by cords."""

from __future__ import annotations

import math

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.contact.law import not_negative, positive, refuse

Array = NDArray[np.float64]

_NEAR_BRANCH = 0.02
"""Below this distance from its branch point Lambert's W comes from its series, which keeps all digits there."""


def fall_speed(
    height: ArrayLike,
    gravity: float = STANDARD_GRAVITY,
    friction: ArrayLike = 0.0,
    viscous: ArrayLike = 0.0,
    drag: ArrayLike = 0.0,
) -> Array:
    """Return the speed after a fall from rest, m/s.

    With g' = g (1 - friction), v = sqrt(2 g' h); against a viscous guide, v' = g' - r v, the speed is
    (g'/r) (1 + W(-exp(-1 - r^2 h/g'))), W Lambert's function; against a drag, v' = g' - c v^2, it is
    sqrt(g' (1 - exp(-2 c h))/c). Theory: :eq:`machine-fall`.

    Parameters
    ----------
    height : array_like
        h, m.
    gravity : float, optional
        g, m/s^2.
    friction : array_like, optional
        Friction of the guide as a share of the weight, 0 to 1.
    viscous : array_like, optional
        Viscous friction of the guide over the mass, r, 1/s.
    drag : array_like, optional
        Quadratic drag over the mass, c, 1/m.

    Returns
    -------
    ndarray
        In the broadcast shape of the input, m/s.

    Raises
    ------
    ValueError
        If a number is out of range, or both viscous friction and drag are given.

    Notes
    -----
    Source: Newton's law, v dv/dh = v', integrated.

    Examples
    --------
    >>> print(fall_speed([0.5, 1.0]).round(4), fall_speed(1.0, friction=0.05).round(4))
    [3.1316 4.4287] 4.3166
    >>> print(fall_speed(1.0, viscous=0.1).round(4), fall_speed(1.0, drag=0.1).round(4))
    4.3623 4.2162
    """
    h, c, r = not_negative("the height", height), not_negative("the drag", drag), not_negative("the friction", viscous)
    share = np.asarray(friction, dtype=float)
    refuse("the friction of the guide", share, (share >= 0.0) & (share < 1.0), "from 0 to below 1, a share of weight")
    if np.any(r > 0.0) and np.any(c > 0.0):
        raise ValueError("a fall has viscous friction or drag, not both")
    pull = positive("gravity", gravity) * (1.0 - share)
    guided = np.where(r > 0.0, _viscous_share(r**2 * h / pull), np.sqrt(_saturation(2.0 * c * h)))
    return np.asarray(np.sqrt(2.0 * pull * h) * guided)


def _saturation(x: Array) -> Array:
    """Return (1 - exp(-x))/x, 1 at x = 0."""
    return np.where(x > 0.0, -np.expm1(-x) / np.where(x > 0.0, x, 1.0), 1.0)


def _viscous_share(x: Array) -> Array:
    """Return (1 + W(-exp(-1 - x)))/sqrt(2 x) for x >= 0: speed in a viscous guide over that of a free fall."""
    p = np.sqrt(2.0 * x * _saturation(x))
    series = 1.0 + p * (-1 / 3 + p * (11 / 72 + p * (-43 / 540 + p * (769 / 17280 - p * 221 / 8505))))
    whole = (1.0 + scipy.special.lambertw(-np.exp(-1.0 - x)).real) / np.sqrt(2.0 * np.where(x > 0.0, x, 1.0))
    return np.where(p < _NEAR_BRANCH, np.sqrt(_saturation(x)) * series, whole)


def corded_fall(
    height: float, mass: float, force: float = 0.0, stiffness: float = 0.0, friction: float = 0.0
) -> tuple[float, float]:
    """Return speed (m/s) and time (s) of a fall from rest that elastic cords pull along.

    With the pull F = F0 + k (h - x) after the way x, v^2 = 2 g (1 - friction) h + (2 F0 h + k h^2)/m. The acceleration
    a0 + k (h - x)/m makes x = (a/c) (1 - cos(sqrt(c) t)), a = a0 + c h, c = k/m.

    Parameters
    ----------
    height : float
        h, m.
    mass : float
        What falls, m, kg.
    force : float, optional
        Pull of all cords where the fall ends, F0, N.
    stiffness : float, optional
        Of all cords, k, N/m.
    friction : float, optional
        Friction of the guide as a share of the weight, 0 to 1.

    Raises
    ------
    ValueError
        If a number is out of range.

    Notes
    -----
    Source: Newton's law, m v dv/dx = m g (1 - friction) + F, integrated.

    Examples
    --------
    >>> speed, time = corded_fall(0.5, 20.0, force=400.0, stiffness=2000.0)
    >>> round(speed, 4), round(time, 4)
    (7.4032, 0.1188)
    """
    free = float(fall_speed(height, friction=friction))
    m, end, k = positive("the mass", mass), not_negative("the force", force), not_negative("the stiffness", stiffness)
    speed = math.sqrt(free**2 + float(2.0 * end * height + k * height**2) / float(m))
    last = STANDARD_GRAVITY * (1.0 - friction) + float(end / m)
    ratio = float(k / m) * height / last
    # 1 - cos = ratio/(1 + ratio); by the half angle, which keeps its digits where the cords are soft
    angle = 2.0 * math.asin(math.sqrt(0.5 * ratio / (1.0 + ratio)))
    time = angle / math.sqrt(float(k / m)) if k > 0.0 else 2.0 * height / speed
    return speed, time
