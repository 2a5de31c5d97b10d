"""Speeds of a line whose bodies are each struck once, and masses for them, in closed form."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.contact.law import positive

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

    Examples
    --------
    >>> round(chain_speed([4.0, 2.0, 1.0], 1.0, speed=1.0), 6)
    1.777778
    """
    each = np.broadcast_to(np.asarray(restitution, dtype=float), (len(masses) - 1,))
    for (first, second), e in zip(itertools.pairwise(masses), each, strict=True):
        speed = float(next_speed(speed, second / first, e, falling))
    return speed


def gain_limit(restitution: float, collisions: int, falling: bool = False) -> float:
    """Return the gain of the last body for mass ratios that go to zero, (1 + e)^n, less 1 for a falling line.

    The floor counts as a collision of a falling line: 3 for two elastic bodies, 7 for three,
    so 9 and 49 times the height (Walker 1988).

    Examples
    --------
    >>> gain_limit(1.0, 3, falling=True), gain_limit(0.5, 2)
    (7.0, 2.25)
    """
    return (1.0 + restitution) ** collisions - (1.0 if falling else 0.0)


def gain_limit_of(restitutions: Sequence[float]) -> float:
    """Return the gain of the last body of a falling line for mass ratios that go to zero, each pair with its own e.

    Examples
    --------
    >>> gain_limit_of([1.0, 1.0, 1.0]), gain_limit_of([0.5, 1.0])
    (7.0, 2.0)
    """
    return math.prod(1.0 + e for e in restitutions) - 1.0


def fastest_masses(first: float, last: float, count: int) -> Array:
    """Return the masses that make the last body of a line fastest: a geometric row, kg.

    The product of the ratios is given and each enters as 1/(1 + mu), so the best are equal, whatever the restitutions,
    resting or falling.

    Notes
    -----
    Source: Rodgers et al. 2009 (their power law).

    Examples
    --------
    >>> print(fastest_masses(8.0, 1.0, 4))
    [8. 4. 2. 1.]
    """
    positive("the masses of the ends", [first, last])
    return np.asarray(first * (last / first) ** np.linspace(0.0, 1.0, count))


def resting_ratio(speed: float, restitution: float, falling: float = 0.0) -> float:
    """Return the mass ratio that brings the striking body to rest, mu = v/((1 + e) (v + u) - v).

    A line of such ratios hands all its motion to the last body, the second of the two designs of Rodgers et al. 2009.
    Symbols of `next_speed`.

    Examples
    --------
    >>> resting_ratio(1.0, 1.0), round(resting_ratio(1.0, 1.0, falling=1.0), 6)
    (1.0, 0.333333)
    """
    return speed / ((1.0 + restitution) * (speed + falling) - speed)
