"""What a blow does to a cushion: where its energy goes, what stays, and how it wears from blow to blow."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.contact import _pair_kernels
from strikewave.contact.cushions.laws import Pad, cushion_law, retarded
from strikewave.contact.damping import factor
from strikewave.contact.impact import Impact, solve_impact
from strikewave.contact.law import AnyContact, check

_STRESSES = ("modulus", "stress", "plateau")
"""Properties that stiffen as a cushion wears: all that are stresses."""


@dataclass(frozen=True)
class Wear:
    """How a cushion changes with each blow: shares of what the blow before left of it.

    Parameters
    ----------
    settling : float, optional
        Share of its thickness that it loses a blow.
    stiffening : float, optional
        Share by which its moduli and stresses rise a blow.

    Examples
    --------
    >>> round(Wear(settling=0.01).thickness_left(10), 4)
    0.9044
    """

    settling: float = 0.0
    stiffening: float = 0.0

    def __post_init__(self) -> None:
        if not (0.0 <= self.settling < 1.0 and 0.0 <= self.stiffening < math.inf):
            raise ValueError(f"a cushion wears by shares of at least 0, settling below 1, got {self}")

    def thickness_left(self, blows: float) -> float:
        """Return the share of its thickness that is left after so many blows, (1 - settling)^N."""
        return float((1.0 - self.settling) ** blows)

    def stiffened(self, blows: float) -> float:
        """Return by which its moduli and stresses have risen after so many blows, (1 + stiffening)^N."""
        return float((1.0 + self.stiffening) ** blows)


@dataclass(frozen=True)
class Cushion:
    """A cushion: its law, its pad, the properties of its material, how it loses energy and how it wears.

    Parameters
    ----------
    law : str
        Name of a cushion law.
    pad : Pad
        As it was before any blow.
    properties : mapping
        What the law needs, SI, by name.
    wear : Wear, optional
        How it changes with each blow.
    retardation : float, optional
        T of `retarded`, s.

    Examples
    --------
    >>> rubber = Cushion("linear", Pad(1e-3, 0.01), {"modulus": 5e6}, Wear(settling=0.01))
    >>> print(rubber.contact().stiffness, round(rubber.after(10).contact().stiffness))
    500000.0 552864
    """

    law: str
    pad: Pad
    properties: Mapping[str, float]
    wear: Wear = field(default_factory=Wear)
    retardation: float = 0.0

    def after(self, blows: int) -> Cushion:
        """Return the cushion as so many blows leave it; the set of one that crushes is another matter."""
        stiffer = self.wear.stiffened(blows)
        pad = Pad(self.pad.area, self.pad.thickness * self.wear.thickness_left(blows))
        properties = {key: value * (stiffer if key in _STRESSES else 1.0) for key, value in self.properties.items()}
        return dataclasses.replace(self, pad=pad, properties=properties)

    def contact(self, damping: str = "exact", restitution: float = 1.0) -> AnyContact:
        """Return its force law, with the hysteresis of a damping law.

        Raises
        ------
        InputError
            If no law has that name.
        ValueError
            If a property is none that the law can have.
        """
        made: AnyContact = cushion_law(self.law).function(self.pad, **self.properties)
        if self.retardation:
            made = retarded(made, self.retardation)
        chi = float(factor(damping, restitution))
        lossy = dataclasses.replace(made, hysteresis_factor=chi) if chi else made
        check(lossy)
        return lossy


class CushionBalance(NamedTuple):
    """Where the energy of a blow goes, and what it leaves of the cushion.

    Attributes
    ----------
    taken : ndarray
        Kinetic energy of the approach, J.
    stored : ndarray
        What the cushion holds at its largest compression, J.
    lost : ndarray
        What does not come back, J.
    returned : ndarray
        Kinetic energy of the rebound, J.
    set : ndarray
        Compression that stays, m.
    """

    taken: NDArray[np.float64]
    stored: NDArray[np.float64]
    lost: NDArray[np.float64]
    returned: NDArray[np.float64]
    set: NDArray[np.float64]


def balance_of(impact: Impact) -> CushionBalance:
    """Return where the energy of an impact on a cushion goes.

    Examples
    --------
    >>> pad = Cushion("crush", Pad(1e-3, 0.05), {"modulus": 1e9, "plateau": 1e6})
    >>> balance = balance_of(solve_impact(pad.contact(), 1.0, np.inf, 4.0))
    >>> print(balance.taken.round(3), balance.stored.round(3), balance.lost.round(3), (balance.set * 1e3).round(3))
    8.0 0.025 7.975 7.975
    """
    problem = impact.problem
    taken = (0.5 * problem.mass * problem.speed**2).reshape(problem.shape)
    stored = np.empty(problem.mass.size)
    _pair_kernels.energies(
        problem.laws, impact.max_indentation.reshape(-1), np.maximum(impact.deepest, 0.0).reshape(-1), stored
    )
    return CushionBalance(
        taken,
        stored.reshape(problem.shape),
        impact.energy_lost,
        taken - impact.energy_lost,
        impact.residual_indentation,
    )


def repeated_blows(
    cushion: Cushion, mass: float, speed: float, count: int, damping: str = "exact", restitution: float = 1.0
) -> list[Impact]:
    """Return equal blows of a mass on a fixed cushion, one after the other: it wears, and keeps its set.

    Parameters
    ----------
    cushion : Cushion
        Before the first blow.
    mass, speed : float
        kg and m/s.
    count : int
        How many blows.
    damping, restitution
        As of `Cushion.contact`.

    Examples
    --------
    >>> pad = Cushion("crush", Pad(1e-3, 0.05), {"modulus": 1e9, "plateau": 1e6})
    >>> [round(float(blow.residual_indentation) * 1e3, 2) for blow in repeated_blows(pad, 1.0, 4.0, 3)]
    [7.97, 15.95, 23.92]
    """
    made: list[Impact] = []
    deepest = 0.0
    for blow in range(count):
        worn = cushion.after(blow).contact(damping, restitution)
        made.append(solve_impact(worn, mass, math.inf, speed, deepest=deepest))
        deepest = max(deepest, float(made[-1].deepest))
    return made
