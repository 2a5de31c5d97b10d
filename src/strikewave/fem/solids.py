"""Solids of the explicit elements: linear elastic, bilinear plastic, Johnson-Cook; SI.

Symbols: E Young's modulus (Pa), nu Poisson's ratio, G = E / (2 (1 + nu)) shear modulus, K = E / (3 (1 - 2 nu)) bulk
modulus, rho density (kg/m^3).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from strikewave.base.errors import InputError

TAYLOR_QUINNEY = 0.9
"""Share of the plastic work that becomes heat, the usual one of metals."""
ROOM = 293.0
"""Room temperature, K: 20 degrees Celsius."""


@dataclass(frozen=True)
class Elastic:
    """A linear elastic solid: the Jaumann-like rate of stress is C : D.

    Parameters
    ----------
    density : float
        kg/m^3.
    youngs_modulus : float
        Pa.
    poissons_ratio : float
        From 0 to below 0.5.

    Examples
    --------
    >>> steel = Elastic(7820.0, 211e9, 0.288)
    >>> round(steel.wave_speed, 1), round(steel.shear_modulus / 1e9, 2)
    (5931.1, 81.91)
    """

    density: float
    youngs_modulus: float
    poissons_ratio: float

    def __post_init__(self) -> None:
        for name, value in (("density", self.density), ("youngs_modulus", self.youngs_modulus)):
            if not 0.0 < value < math.inf:
                raise InputError(name, value, "above 0")
        if not 0.0 <= self.poissons_ratio < 0.5:
            raise InputError("poissons_ratio", self.poissons_ratio, "from 0 to below 0.5")

    @property
    def shear_modulus(self) -> float:
        """G, Pa."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio))

    @property
    def bulk_modulus(self) -> float:
        """K, Pa."""
        return self.youngs_modulus / (3.0 * (1.0 - 2.0 * self.poissons_ratio))

    @property
    def wave_modulus(self) -> float:
        """Modulus of a wave without lateral strain, K + 4 G / 3, Pa."""
        return self.bulk_modulus + 4.0 * self.shear_modulus / 3.0

    @property
    def strength(self) -> float:
        """Stress beyond which the solid flows, Pa."""
        return math.inf

    @property
    def wave_speed(self) -> float:
        """Speed of a pressure wave without lateral strain, sqrt((K + 4 G / 3) / rho), m/s."""
        return math.sqrt(self.wave_modulus / self.density)


@dataclass(frozen=True)
class Bilinear(Elastic):
    """An elastic solid with von Mises yield and linear hardening, rate independent.

    Parameters
    ----------
    yield_strength : float
        sigma_y, Pa.
    tangent_modulus : float
        E_t, slope of the uniaxial curve beyond yield, Pa: from 0 to below E.
    kinematic : float
        Share of the hardening that moves the yield surface (1: kinematic) instead of widening it (0: isotropic).
    """

    yield_strength: float = math.inf
    tangent_modulus: float = 0.0
    kinematic: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.yield_strength > 0.0:
            raise InputError("yield_strength", self.yield_strength, "above 0")
        if not 0.0 <= self.tangent_modulus < self.youngs_modulus:
            raise InputError("tangent_modulus", self.tangent_modulus, "from 0 to below Young's modulus")
        if not 0.0 <= self.kinematic <= 1.0:
            raise InputError("kinematic", self.kinematic, "from 0 (isotropic) to 1 (kinematic)")

    @property
    def strength(self) -> float:
        """sigma_y, Pa."""
        return self.yield_strength

    @property
    def plastic_modulus(self) -> float:
        """Slope of stress over plastic strain, H = E E_t / (E - E_t), Pa."""
        return self.youngs_modulus * self.tangent_modulus / (self.youngs_modulus - self.tangent_modulus)


@dataclass(frozen=True)
class JohnsonCook(Elastic):
    """Flow stress (A + B p^n) (1 + C ln(rate / reference_rate)) (1 - T*^m), T* = (T - T_room) / (T_melt - T_room).

    p is the equivalent plastic strain; the rate is at least the reference rate. ``heat_fraction`` of the plastic work
    heats the solid, which loses nothing.

    Source: Johnson & Cook 1983, 7th International Symposium on Ballistics, The Hague.

    Parameters
    ----------
    A, B : float
        Pa.
    n, C, m : float
        Exponents and rate coefficient.
    reference_rate : float
        1/s.
    room_temperature, melting_temperature : float
        K.
    specific_heat : float
        J/(kg K); infinite: the solid stays at room temperature.
    heat_fraction : float
        Share of the plastic work that becomes heat (Taylor-Quinney).
    """

    A: float = math.inf
    B: float = 0.0
    n: float = 1.0
    C: float = 0.0
    m: float = 1.0
    reference_rate: float = 1.0
    room_temperature: float = ROOM
    melting_temperature: float = math.inf
    specific_heat: float = math.inf
    heat_fraction: float = TAYLOR_QUINNEY

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("A", "reference_rate", "n", "m", "specific_heat"):
            if not getattr(self, name) > 0.0:
                raise InputError(name, getattr(self, name), "above 0")
        for name in ("B", "C", "heat_fraction"):
            if not getattr(self, name) >= 0.0:
                raise InputError(name, getattr(self, name), "at least 0")
        if not self.melting_temperature > self.room_temperature:
            raise InputError("melting_temperature", self.melting_temperature, "above the room temperature")

    @property
    def strength(self) -> float:
        """A + B: flow stress at a plastic strain of 1, Pa."""
        return self.A + self.B


AnySolid = Elastic | Bilinear | JohnsonCook
