"""Bars, specimen, striker and strain gauges of a split Hopkinson pressure bar.

Symbols: rho density (kg/m^3), E modulus (Pa), c = sqrt(E/rho) bar speed (m/s), A area (m^2), Z = rho c A = E A/c
impedance (N s/m), nu Poisson's ratio.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base import declare
from strikewave.base.declare import MAIN, MORE
from strikewave.base.shock_quantities import BAR_SPEED, DENSITY, MODULUS, RATIO
from strikewave.waves.dispersion import Rod


@declare.dataclass
class BarMaterial:
    """Density, modulus and bar speed that agree with each other; a mismatch exists where all three were stated."""

    density: float = declare.number(DENSITY, "of the incident and the transmitted bar", column=MAIN)
    modulus: float = declare.number(MODULUS, "modulus", column=MAIN)
    speed: float = declare.number(BAR_SPEED, "bar speed", column=MAIN)
    derived: str = declare.word("which of the three follows from the other two", column=MORE)
    mismatch: float = declare.number(
        RATIO, "by how much of itself a stated modulus differs from density times speed squared", default=0.0
    )


def elastic(density: float | None = None, modulus: float | None = None, speed: float | None = None) -> BarMaterial:
    """Return density, modulus and bar speed from two of them: c = sqrt(E/rho).

    Of all three, density and speed are kept, which a balance and an echo measure to a part in a thousand, and the
    modulus is derived.

    Raises
    ------
    ValueError
        If fewer than two are given, or one is not above zero.

    Examples
    --------
    >>> elastic(density=7800.0, modulus=210e9).derived, round(elastic(density=7800.0, modulus=210e9).speed, 1)
    ('speed', 5188.7)
    >>> both = elastic(4416.0, 109.297e9, 4865.9)
    >>> both.derived, round(both.modulus / 1e9, 2), round(both.mismatch, 4)
    ('modulus', 104.56, 0.0453)
    """
    stated = {"density": density, "modulus": modulus, "speed": speed}
    for name, value in stated.items():
        if value is not None and not 0.0 < value < math.inf:
            raise ValueError(f"{name} must be above zero and finite, got {value!r}")
    if density is not None and speed is not None:
        own = density * speed**2
        return BarMaterial(density, own, speed, "modulus", 0.0 if modulus is None else modulus / own - 1.0)
    if density is not None and modulus is not None:
        return BarMaterial(density, modulus, math.sqrt(modulus / density), "speed")
    if modulus is not None and speed is not None:
        return BarMaterial(modulus / speed**2, modulus, speed, "density")
    raise ValueError(f"two of density, modulus and speed are needed, got {stated}")


@dataclass(frozen=True)
class Bar:
    """A round pressure bar with one strain gauge station.

    Poisson's ratio counts only in dispersion and in bridges with lateral gauges.

    Examples
    --------
    >>> bar = Bar(7800.0, 210e9, 0.02, 1.02)
    >>> round(bar.speed, 1), round(bar.impedance), round(bar.delay * 1e6, 2)
    (5188.7, 12715, 196.58)
    """

    density: float  # kg/m^3
    modulus: float  # Pa
    diameter: float  # m
    gauge_distance: float  # from the gauge to the face at the specimen, m
    poissons_ratio: float = 0.29
    length: float = math.inf  # m; infinite where unknown

    def __post_init__(self) -> None:
        for key in ("density", "modulus", "diameter", "gauge_distance"):
            value = getattr(self, key)
            if not 0.0 < value < math.inf:
                raise ValueError(f"{key} of a bar must be above zero and finite, got {value!r}")
        if not -1.0 < self.poissons_ratio <= 0.5:
            raise ValueError(f"Poisson's ratio lies above -1 and at most at 0.5, got {self.poissons_ratio!r}")
        if not self.gauge_distance < self.length:
            raise ValueError(f"the gauge at {self.gauge_distance:g} m lies off a bar of {self.length:g} m")

    @property
    def area(self) -> float:
        """Cross-section pi d^2/4, m^2."""
        return 0.25 * math.pi * self.diameter**2

    @property
    def speed(self) -> float:
        """Bar speed c = sqrt(E/rho), m/s."""
        return math.sqrt(self.modulus / self.density)

    @property
    def impedance(self) -> float:
        """Impedance Z = rho c A, N s/m."""
        return self.density * self.speed * self.area

    @property
    def stiffness(self) -> float:
        """Force over strain E A, N."""
        return self.modulus * self.area

    @property
    def delay(self) -> float:
        """Time of a long wave from the gauge to the specimen face, s."""
        return self.gauge_distance / self.speed

    @property
    def rod(self) -> Rod:
        """The bar in the form that dispersion takes."""
        return Rod(0.5 * self.diameter, self.speed, self.poissons_ratio)


@dataclass(frozen=True)
class Specimen:
    """The specimen between the bars: length (m), area (m^2), and density and modulus where they are known.

    Only momentum, kinetic energy and the theory of equilibrium use density and modulus.
    """

    length: float
    area: float
    density: float | None = None
    modulus: float | None = None

    def __post_init__(self) -> None:
        for key in ("length", "area", "density", "modulus"):
            value = getattr(self, key)
            if value is not None and not 0.0 < value < math.inf:
                raise ValueError(f"{key} of the specimen must be above zero and finite, got {value!r}")

    @property
    def mass(self) -> float | None:
        """Mass rho A l, kg; None where the density is not known."""
        return None if self.density is None else self.density * self.area * self.length

    @property
    def transit(self) -> float | None:
        """Time of an elastic wave through it, l/c, s; None where density or modulus is not known."""
        if self.density is None or self.modulus is None:
            return None
        return self.length / math.sqrt(self.modulus / self.density)

    def impedance_ratio(self, bar: Bar) -> float | None:
        """Return beta = (rho c A) of the specimen over that of a bar; None where it is not known."""
        if self.density is None or self.modulus is None:
            return None
        return math.sqrt(self.density * self.modulus) * self.area / bar.impedance


class StrikerBar(NamedTuple):
    """A striker bar: length (m), bar speed (m/s), impedance (N s/m), speed before impact (m/s, NaN if unknown)."""

    length: float
    bar_speed: float
    impedance: float
    speed: float = math.nan

    @property
    def pulse_length(self) -> float:
        """Duration of the pulse in a bar of its own impedance, 2 L/c, s."""
        return 2.0 * self.length / self.bar_speed

    def strain(self, bar: Bar) -> float:
        """Return the strain in a struck bar: v Zs/((Zs + Zb) cb), which is v/(2 c) for equal bars.

        Source: Kolsky 1963, chapter III: force v Zs Zb/(Zs + Zb), over E A = Zb cb.

        Examples
        --------
        >>> bar = Bar(7800.0, 210e9, 0.02, 1.02)
        >>> round(StrikerBar(0.2, bar.speed, bar.impedance, 10.0).strain(bar) * 1e6, 1)
        963.6
        """
        return self.speed * self.impedance / ((self.impedance + bar.impedance) * bar.speed)


BridgeKind = Literal["quarter", "half", "half-poisson", "full-poisson"]
BRIDGES: tuple[BridgeKind, ...] = get_args(BridgeKind)
"""One gauge; two on opposite sides of the bar in opposite arms, which cancel bending; one along the bar and one around
it; two along and two around."""


@dataclass(frozen=True)
class Bridge:
    """A Wheatstone bridge of strain gauges, with its amplifier.

    The gauge factor is the relative change of resistance over strain; Poisson's ratio of the bar counts only in bridges
    with gauges around the bar.
    """

    kind: BridgeKind
    gauge_factor: float
    excitation: float  # voltage of the bridge, V
    gain: float = 1.0  # of the amplifier
    poissons_ratio: float = 0.29

    def __post_init__(self) -> None:
        if self.kind not in BRIDGES:
            raise ValueError(f"a bridge is one of {', '.join(BRIDGES)}, got {self.kind!r}")
        for key in ("gauge_factor", "excitation", "gain"):
            if not 0.0 < getattr(self, key) < math.inf:
                raise ValueError(f"{key} of a bridge must be above zero and finite, got {getattr(self, key)!r}")

    def strain(self, voltage: ArrayLike) -> NDArray[np.float64]:
        """Return strain, tension positive, from the voltage behind the amplifier, V.

        With r = V/(gain excitation), N gauges along the bar (1 or 2) and nu, the share of the strain in those around it
        (0 without them), the balance of the four arms gives exactly

            gauge_factor strain = (4/N) r / [1 + nu - (2/N) r (1 - nu)]

        whose denominator is 1 + nu for small strains. Source: the voltages of the two dividers of a bridge of arms 1 +
        x, 1 - nu x, 1 + x, 1 - nu x (or 1 where there is no active gauge).

        Examples
        --------
        >>> half = Bridge("half", 2.0, 10.0, 100.0)
        >>> float(half.strain(1.0).round(8))
        0.001001
        """
        r = np.asarray(voltage, dtype=float) / (self.gain * self.excitation)
        along = 1.0 if self.kind in ("quarter", "half-poisson") else 2.0
        nu = self.poissons_ratio if self.kind.endswith("poisson") else 0.0
        x = (4.0 / along) * r / (1.0 + nu - (2.0 / along) * r * (1.0 - nu))
        return np.asarray(x / self.gauge_factor)
