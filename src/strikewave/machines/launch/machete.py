"""How fast a Machete hammer arrives: an arm on a ratchet wheel, driven by a weight."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.contact.law import not_negative, positive, refuse

Array = NDArray[np.float64]


@dataclass(frozen=True)
class MacheteHammer:
    """A hammer arm on a ratchet wheel: each tooth turns it back by one pitch and lifts a weight that drives it.

    The weight is held by a rope from a drum on the arm's shaft; a drum without a weight leaves an arm that falls by
    itself. The rope pushes nothing: when the head strikes, the weight takes no part.

    Parameters
    ----------
    teeth : int
        On the whole wheel.
    inertia : float
        Of arm, head and counterweight about the shaft, kg m^2.
    radius : float
        Shaft to the point that strikes, m.
    unbalance : float, optional
        Mass of the arm times the distance of its centre of gravity, kg m; 0 with a full counterweight.
    weight, drum : float, optional
        Mass of the driving weight, kg, and radius of its drum, m.
    friction : float, optional
        Torque of friction, N m.
    strike_angle : float, optional
        Where the arm strikes, from hanging down, rad.
    """

    teeth: int
    inertia: float
    radius: float
    unbalance: float = 0.0
    weight: float = 0.0
    drum: float = 0.0
    friction: float = 0.0
    strike_angle: float = 0.0

    def __post_init__(self) -> None:
        for name in ("teeth", "inertia", "radius"):
            positive(f"the {name} of the hammer", getattr(self, name))
        for name in ("unbalance", "weight", "drum", "friction"):
            not_negative(f"the {name} of the hammer", getattr(self, name))

    @property
    def pitch(self) -> float:
        """Angle of a tooth, rad."""
        return 2.0 * math.pi / self.teeth

    @property
    def turning_inertia(self) -> float:
        """Inertia of what turns before the strike, the weight on its drum included, kg m^2."""
        return self.inertia + self.weight * self.drum**2

    @property
    def effective_mass(self) -> float:
        """Mass that a body would feel at the point that strikes, without the weight on its rope, kg."""
        return self.inertia / self.radius**2


def machete_energy(hammer: MacheteHammer, teeth: ArrayLike, gravity: float = STANDARD_GRAVITY) -> Array:
    """Return the energy of the whole hammer when it strikes after a number of teeth, weight included, J.

    With the angle a = n 2 pi/N, the drum r, the weight M, the arm's unbalance u and the strike at the angle b from
    hanging, E = M g r a + u g (cos b - cos(a + b)) - T a.

    Parameters
    ----------
    hammer : MacheteHammer
        The hammer.
    teeth : array_like
        n, from 0; a part of a tooth holds nowhere and is refused.
    gravity : float, optional
        m/s^2.

    Raises
    ------
    ValueError
        If it is no number of teeth, or the arm does not come down from there.

    Notes
    -----
    Source: work of the weights. The build of the hammer (ratchet, arm, weight, tooth number) is from memory; Phan &
    Duong 2024 tell of a hammer for parts of weapons that is set by the angle to which it is lifted.

    Examples
    --------
    >>> hammer = MacheteHammer(teeth=30, inertia=2.0, radius=0.6, weight=36.0, drum=0.1)
    >>> print(machete_energy(hammer, [1, 13]).round(2))
    [ 7.39 96.12]
    """
    n = np.asarray(teeth, dtype=float)
    refuse("the number of teeth", n, (n >= 0.0) & (n == np.floor(n)) & np.isfinite(n), "a whole number from 0")
    angle = n * hammer.pitch
    lifted = 2.0 * np.sin(0.5 * angle + hammer.strike_angle) * np.sin(0.5 * angle)
    drive = hammer.weight * gravity * hammer.drum - hammer.friction
    energy = np.asarray(drive * angle + hammer.unbalance * gravity * lifted)
    refuse("the energy from this tooth, J,", energy, energy >= 0.0, "positive, or the arm stays: see its friction")
    return energy


def machete_speed(hammer: MacheteHammer, teeth: ArrayLike, gravity: float = STANDARD_GRAVITY) -> Array:
    """Return the speed at which a Machete hammer strikes after a number of teeth, R sqrt(2 E/(J + M r^2)), m/s.

    See `machete_energy`. A balanced arm gives a speed that goes as the root of the number of teeth.

    Examples
    --------
    >>> hammer = MacheteHammer(teeth=30, inertia=2.0, radius=0.6, weight=36.0, drum=0.1)
    >>> print(machete_speed(hammer, [4, 16]).round(3))
    [3.004 6.008]
    """
    return np.asarray(hammer.radius * np.sqrt(2.0 * machete_energy(hammer, teeth, gravity) / hammer.turning_inertia))


def rope_tension(hammer: MacheteHammer, teeth: int, gravity: float = STANDARD_GRAVITY) -> float:
    """Return the least force in the rope of a Machete hammer on its way, M (g - r w'), N; 0 without a weight.

    The turning is w' = (M g r + u g sin(c) - T)/(J + M r^2) at the angle c from hanging; see `machete_energy`. A
    negative force no rope can bear: it is slack there.

    Examples
    --------
    >>> hammer = MacheteHammer(teeth=30, inertia=2.0, radius=0.6, weight=36.0, drum=0.1)
    >>> round(rope_tension(hammer, 13), 2)  # M g J/(J + M r^2)
    299.19
    """
    begin, end = hammer.strike_angle + teeth * hammer.pitch, hammer.strike_angle
    crests = [c for c in (0.5 * math.pi, 2.5 * math.pi) if end <= c <= begin]
    steepest = 1.0 if crests else max(math.sin(begin), math.sin(end))
    torque = hammer.weight * gravity * hammer.drum + hammer.unbalance * gravity * steepest - hammer.friction
    return hammer.weight * (gravity - hammer.drum * torque / hammer.turning_inertia)
