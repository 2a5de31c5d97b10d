"""Solids of the explicit elements: elastic, bilinear, Johnson-Cook, Zerilli-Armstrong; invariants of stress; SI.

Symbols: E Young's modulus (Pa), nu Poisson's ratio, G = E / (2 (1 + nu)) shear modulus, K = E / (3 (1 - 2 nu)) bulk
modulus, rho density (kg/m^3).

Stresses are (..., 6): xx yy zz xy yz zx, tension positive.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError

TAYLOR_QUINNEY = 0.9  # usual for metals
"""Share of the plastic work that becomes heat."""
ROOM = 293.0  # 20 degrees Celsius
"""Room temperature, K."""


@dataclass(frozen=True)
class Elastic:
    """A linear elastic solid: the Jaumann-like rate of stress is C : D."""

    density: float
    """kg/m^3."""
    youngs_modulus: float
    """E, Pa."""
    poissons_ratio: float
    """nu, from 0 to below 0.5."""

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
    """An elastic solid with von Mises yield and linear hardening, rate independent."""

    yield_strength: float = math.inf
    """sigma_y, Pa."""
    tangent_modulus: float = 0.0
    """E_t, slope of the uniaxial curve beyond yield, Pa: from 0 to below E."""
    kinematic: float = 0.0
    """Share of the hardening that moves the yield surface (1: kinematic) instead of widening it (0: isotropic)."""

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


@dataclass(frozen=True, kw_only=True)
class HeatedSolid(Elastic):
    """A solid whose flow stress depends on rate and temperature.

    ``heat_fraction`` of the plastic work heats the solid, which loses nothing. A rate below the reference rate counts
    as the reference rate.
    """

    reference_rate: float = 1.0
    """1/s."""
    room_temperature: float = ROOM
    """K."""
    preheat: float = 0.0
    """Temperature above room at which the solid begins, K."""
    specific_heat: float = math.inf
    """J/(kg K); infinite: plastic work heats nothing."""
    heat_fraction: float = TAYLOR_QUINNEY
    """Share of the plastic work that becomes heat (Taylor-Quinney)."""

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("reference_rate", "room_temperature", "specific_heat"):
            if not getattr(self, name) > 0.0:
                raise InputError(name, getattr(self, name), "above 0")
        for name in ("heat_fraction", "preheat"):
            if not getattr(self, name) >= 0.0:
                raise InputError(name, getattr(self, name), "at least 0")


@dataclass(frozen=True)
class JohnsonCook(HeatedSolid):
    """Flow stress (A + B p^n) (1 + C ln(rate / reference_rate)) (1 - T*^m), T* = (T - T_room) / (T_melt - T_room).

    p is the equivalent plastic strain; A and B are in Pa, the melting temperature in K.

    Source: Johnson & Cook 1983, 7th International Symposium on Ballistics, The Hague.
    """

    A: float = math.inf
    B: float = 0.0
    n: float = 1.0
    C: float = 0.0
    m: float = 1.0
    melting_temperature: float = math.inf

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("A", "n", "m"):
            if not getattr(self, name) > 0.0:
                raise InputError(name, getattr(self, name), "above 0")
        for name in ("B", "C"):
            if not getattr(self, name) >= 0.0:
                raise InputError(name, getattr(self, name), "at least 0")
        if not self.melting_temperature > self.room_temperature:
            raise InputError("melting_temperature", self.melting_temperature, "above the room temperature")

    @property
    def strength(self) -> float:
        """A + B: flow stress at a plastic strain of 1, Pa."""
        return self.A + self.B


@dataclass(frozen=True)
class ZerilliArmstrong(HeatedSolid):
    """Flow stress C0 + (C1 + C2 sqrt(p)) exp(T (C4 ln(rate / reference_rate) - C3)) + C5 p^n.

    p is the equivalent plastic strain, T the temperature in K; C0, C1, C2, C5 are in Pa, C3 and C4 in 1/K. Metals whose
    atoms stand in face-centred cubes (copper, aluminium, nickel) have C1 = C5 = 0: strain shares the thermal
    activation. Those in body-centred cubes (iron, steel, tantalum) have C2 = 0: yield depends on rate and temperature,
    hardening does not.

    Source: Zerilli & Armstrong 1987, J. Appl. Phys. 61, 1816.
    """

    C0: float = math.inf
    C1: float = 0.0
    C2: float = 0.0
    C3: float = 0.0
    C4: float = 0.0
    C5: float = 0.0
    n: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("C0", "C1", "C2", "C3", "C4", "C5"):
            if not getattr(self, name) >= 0.0:
                raise InputError(name, getattr(self, name), "at least 0")
        if not self.n > 0.0:
            raise InputError("n", self.n, "above 0")
        if not self.C0 + self.C1 > 0.0:
            raise InputError("C0", self.C0, "above 0", "or give C1: a solid needs a yield strength")

    @property
    def strength(self) -> float:
        """Flow stress at a plastic strain of 1, room temperature and the reference rate, Pa."""
        return self.C0 + (self.C1 + self.C2) * math.exp(-self.C3 * self.room_temperature) + self.C5


AnySolid = Elastic | Bilinear | JohnsonCook | ZerilliArmstrong


Array = NDArray[np.float64]


def von_mises(stress: Array) -> Array:
    """Return the von Mises stress sqrt(3/2 s : s), s the deviator, Pa, (...)."""
    xx, yy, zz, xy, yz, zx = np.moveaxis(np.asarray(stress, float), -1, 0)
    direct = 0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2)
    return np.asarray(np.sqrt(direct + 3.0 * (xy**2 + yz**2 + zx**2)))


def pressure(stress: Array) -> Array:
    """Return the pressure -(xx + yy + zz) / 3, Pa, (...); compression is positive."""
    return np.asarray(-np.asarray(stress, float)[..., :3].mean(axis=-1))
