"""How fast a pendulum hammer arrives."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.contact.law import positive, refuse

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RigidPendulum:
    """A rigid pendulum that strikes.

    Parameters
    ----------
    mass : float
        kg.
    centre : float
        Pivot to centre of gravity, m.
    inertia : float
        Moment of inertia about the pivot, kg m^2; at least mass times centre squared.
    radius : float
        Pivot to the point that strikes, m.
    """

    mass: float
    centre: float
    inertia: float
    radius: float

    def __post_init__(self) -> None:
        for name in ("mass", "centre", "inertia", "radius"):
            positive(f"the {name} of the pendulum", getattr(self, name))
        least = self.mass * self.centre**2
        if self.inertia < least * (1.0 - 1e-12):
            raise ValueError(
                f"the inertia about the pivot must be at least mass times centre squared, {least:g} kg m^2"
            )

    @property
    def effective_mass(self) -> float:
        """Mass that a body would feel at the point that strikes, J/R^2, kg."""
        return self.inertia / self.radius**2

    @property
    def reduced_length(self) -> float:
        """Length of the simple pendulum of the same period, J/(m r), m: strike there and the pivot feels nothing."""
        return self.inertia / (self.mass * self.centre)


def inertia_of_period(mass: float, centre: float, period: float, gravity: float = STANDARD_GRAVITY) -> float:
    """Return the moment of inertia about the pivot from the period of small swings, m g r (t/2 pi)^2, kg m^2.

    Source: t = 2 pi sqrt(J/(m g r)) of a rigid body that swings little; the way of ISO 148-2.

    Examples
    --------
    >>> round(inertia_of_period(20.0, 0.7, 1.7373), 3)
    10.496
    """
    return mass * gravity * centre * (period / (2.0 * math.pi)) ** 2


def pendulum_energy(
    pendulum: RigidPendulum, angle: ArrayLike, strike_angle: float = 0.0, gravity: float = STANDARD_GRAVITY
) -> Array:
    """Return the energy of a pendulum let go at an angle when it strikes, m g r (cos b - cos a), J.

    Parameters
    ----------
    pendulum : RigidPendulum
        What swings.
    angle : array_like
        a, from hanging, rad; up to pi.
    strike_angle : float, optional
        b, from hanging, rad.
    gravity : float, optional
        m/s^2.

    Raises
    ------
    ValueError
        If it does not fall from one angle to the other.

    Examples
    --------
    >>> hammer = RigidPendulum(mass=20.0, centre=0.70, inertia=10.5, radius=0.75)
    >>> print(pendulum_energy(hammer, 2.5).round(2))
    247.28
    """
    a = np.asarray(angle, dtype=float)
    refuse("the angle of release", a, (np.abs(a) <= math.pi) & (np.abs(a) >= abs(strike_angle)), "above the strike's")
    fall = 2.0 * np.sin(0.5 * (a + strike_angle)) * np.sin(0.5 * (a - strike_angle))
    return np.asarray(pendulum.mass * gravity * pendulum.centre * fall)


def pendulum_speed(
    pendulum: RigidPendulum, angle: ArrayLike, strike_angle: float = 0.0, gravity: float = STANDARD_GRAVITY
) -> Array:
    """Return the speed of the striking point of a pendulum let go at an angle, R sqrt(2 E/J), m/s.

    A simple pendulum (J = m r^2, R = r) gives the sqrt(2 g L (1 - cos a)) of ISO 13802 and ISO 148-2. See
    `pendulum_energy`.

    Examples
    --------
    >>> simple = RigidPendulum(mass=1.0, centre=0.39, inertia=0.39**2, radius=0.39)
    >>> print(pendulum_speed(simple, 2.7925).round(3))
    3.852
    """
    energy = pendulum_energy(pendulum, angle, strike_angle, gravity)
    return np.asarray(pendulum.radius * np.sqrt(2.0 * energy / pendulum.inertia))
