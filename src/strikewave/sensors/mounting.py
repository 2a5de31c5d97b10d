"""Mounting of a sensor: an edge contact, gaskets and the sensor's mass, driven by the surface below.

    surface -> [edge contact: a spring without mass] -> gasket | gasket | .. -> sensor mass

The sensor is light beside what it is mounted on and does not load it back: the motion of the surface is given.

In the frequency domain a gasket is a continuous layer with a complex modulus; in the time domain it is cut
into spectral elements (Patera 1984; degree 4, Gauss-Lobatto nodes with their lumped mass), so fine that both
agree to 1e-4 dB up to 100 kHz and 0.03 dB up to 200 kHz, with the Maxwell branches
of the same loss.

Symbols: rho density (kg/m^3), E modulus (Pa), A area (m^2), h thickness (m), eta loss factor (-),
k = w sqrt(rho/E) wave number (1/m), w = 2 pi f.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base import declare
from strikewave.base.declare import MAIN, MORE, NO_UNIT, Quantity
from strikewave.base.shock_quantities import BANDWIDTH, RATIO
from strikewave.sensors.response import IDENTITY, LinearSystem
from strikewave.waves.spectral import USUAL_BAND, LossFit, dynamic_stiffness, fit_loss

RESOLVED = 200e3  # Hz that elements follow in a gasket: buffers let nothing through far below, and recorders cut it off

ELEMENTS_PER_WAVE = 1.5  # degree-4 elements a wave: within 0.03 dB of the continuous layer, 1e-4 dB at half of it

MOST_STATES = 2000  # a buffer with more states than this is refused: its exponential would take a minute

# Gauss-Lobatto nodes of degree 4, and their weights, which make the mass of a node
_NODES = np.array([-1.0, -math.sqrt(3.0 / 7.0), 0.0, math.sqrt(3.0 / 7.0), 1.0])
_MASSES = np.array([0.1, 49.0 / 90.0, 32.0 / 45.0, 49.0 / 90.0, 0.1])
_GAUSS, _WEIGHTS = np.polynomial.legendre.leggauss(4)
# Four Gauss points, their weights, and the derivative of the polynomials through the nodes there: exact stiffness
_SLOPES = np.column_stack(
    [
        np.polyval(np.polyder(np.polyfit(_NODES, np.eye(5)[j], 4)), _GAUSS)  # of the j-th Lagrange polynomial
        for j in range(5)
    ]
)


@dataclass(frozen=True)
class Gasket:
    """A layer between surface and sensor.

    Parameters
    ----------
    density, modulus : float
        rho in kg/m^3; E in Pa: the storage modulus at the geometric mean of the band.
    area, thickness : float
        A in m^2, h in m.
    loss_factor : float, optional
        eta, constant over the band of the mounting.

    Examples
    --------
    >>> rubber = Gasket(1100.0, 10e6, 1e-4, 2e-3, 0.3)
    >>> round(rubber.mass * 1e3, 3), round(rubber.stiffness)
    (0.22, 500000)
    """

    density: float
    modulus: float
    area: float
    thickness: float
    loss_factor: float = 0.0

    def __post_init__(self) -> None:
        for key in ("density", "modulus", "area", "thickness"):
            if not 0.0 < getattr(self, key) < math.inf:
                raise ValueError(f"{key} of a gasket must be above zero and finite, got {getattr(self, key)!r}")
        if not 0.0 <= self.loss_factor < math.inf:
            raise ValueError(f"loss factor of a gasket must be zero or above and finite, got {self.loss_factor!r}")

    @property
    def mass(self) -> float:
        """Mass rho A h, kg."""
        return self.density * self.area * self.thickness

    @property
    def stiffness(self) -> float:
        """Stiffness E A / h, N/m."""
        return self.modulus * self.area / self.thickness


@dataclass(frozen=True)
class Mounting:
    """Parts between the surface and the sensor; none by default.

    Parameters
    ----------
    gaskets : tuple of Gasket, optional
        From the surface to the sensor, bonded to each other.
    sensor_mass : float, optional
        Mass of the sensor and what moves with it, kg.
    edge_stiffness : float, optional
        Stiffness of the edge contact below the gaskets, N/m; infinite where there is none. The contact has no mass.
    edge_damping : float, optional
        Damping of the edge contact, N s/m.
    band : tuple of float, optional
        Lowest and highest frequency of constant loss, Hz.

    Raises
    ------
    ValueError
        If a value makes no sense, or a loss factor cannot be held over the band.

    Examples
    --------
    >>> Mounting().direct
    True
    """

    gaskets: tuple[Gasket, ...] = ()
    sensor_mass: float = 0.0
    edge_stiffness: float = math.inf
    edge_damping: float = 0.0
    band: tuple[float, float] = USUAL_BAND

    def __post_init__(self) -> None:
        object.__setattr__(self, "gaskets", tuple(self.gaskets))
        object.__setattr__(self, "band", tuple(self.band))
        if not 0.0 <= self.sensor_mass < math.inf:
            raise ValueError(f"the sensor mass must be zero or above and finite, got {self.sensor_mass!r}")
        if not self.edge_stiffness > 0.0:
            raise ValueError(f"the stiffness of an edge contact must be above zero, got {self.edge_stiffness!r}")
        if not 0.0 <= self.edge_damping < math.inf:
            raise ValueError(f"the damping of an edge contact must be zero or above, got {self.edge_damping!r}")
        if math.isinf(self.edge_stiffness) and self.edge_damping > 0.0:
            raise ValueError("an edge contact of infinite stiffness has no damping")
        for gasket in self.gaskets:
            self.loss(gasket)

    @property
    def direct(self) -> bool:
        """True if the sensor moves with the surface: nothing between them yields, or nothing moves on it."""
        return not self.gaskets and (math.isinf(self.edge_stiffness) or self.sensor_mass == 0.0)

    def loss(self, gasket: Gasket) -> LossFit:
        """Return the loss of a gasket for a storage modulus of one."""
        return fit_loss(1.0, gasket.loss_factor, *self.band)


def transmission(mounting: Mounting, frequencies: ArrayLike) -> NDArray[np.complex128]:
    """Return the complex ratio of the sensor's to the surface's acceleration, of the continuous layers.

    From the sensor (displacement u = 1, force m w^2) down through each gasket,

        u' = u cos(k h) - F sin(k h) / (E A k),   F' = E A k u sin(k h) + F cos(k h)

    with the complex modulus of its loss, and through the edge contact, u' = u - F / (k_e + i w c_e); the ratio
    is 1 / u' at the surface. Derived from the wave equation of a rod, E A u'' + rho A w^2 u = 0, over each layer.

    Parameters
    ----------
    mounting : Mounting
        Mounting between surface and sensor.
    frequencies : array_like
        f, Hz, zero or above.
    """
    f = np.asarray(frequencies, dtype=float)
    if not np.all(np.isfinite(f)) or np.any(f < 0.0):
        raise ValueError("frequencies must be zero or above and finite")
    w = 2.0 * np.pi * f
    u, F = np.ones(f.shape, complex), mounting.sensor_mass * w**2 + 0j
    if mounting.direct:
        return u
    for gasket in reversed(mounting.gaskets):
        fit = mounting.loss(gasket)
        modulus = gasket.modulus * dynamic_stiffness(fit.stiffness, fit.branches, f)
        k = w * np.sqrt(gasket.density / modulus)
        EA, kh = modulus * gasket.area, k * gasket.thickness
        compliance = gasket.thickness * np.sinc(kh / np.pi) / EA  # sin(k h) / (E A k), also at rest
        u, F = u * np.cos(kh) - F * compliance, EA * k * u * np.sin(kh) + F * np.cos(kh)
    if math.isfinite(mounting.edge_stiffness):
        u = u - F / (mounting.edge_stiffness + 1j * w * mounting.edge_damping)
    with np.errstate(divide="ignore", invalid="ignore"):  # at a resonance without loss the sensor moves without end
        return np.asarray(1.0 / u)


def insertion_loss(mounting: Mounting, frequencies: ArrayLike) -> NDArray[np.float64]:
    """Return by how much the mounting lowers a sine, ``-20 log10 |a_sensor / a_surface|``, dB.

    Positive where it isolates, negative where it magnifies. Exact for the continuous layers; see `transmission`.
    Theory: :eq:`sensor-loss`.

    Returns
    -------
    ndarray
        dB, in the shape of ``frequencies``.

    Examples
    --------
    >>> rubber = Gasket(1100.0, 10e6, 1e-4, 2e-3, 0.3)
    >>> insertion_loss(Mounting((rubber,), sensor_mass=5e-3), [1e3, 1e4, 1e5]).round(1)
    array([-6.7, 29.1, 54. ])
    """
    with np.errstate(divide="ignore"):
        return np.asarray(-20.0 * np.log10(np.abs(transmission(mounting, frequencies))))


@functools.lru_cache(maxsize=32)
def mounting_system(mounting: Mounting) -> LinearSystem:
    """Return the mounting as a linear system from the surface's to the sensor's acceleration.

    States are sqrt(mass) times each node's velocity against the surface and sqrt(stiffness) times each spring's
    stretch, so that half their square sum is the energy, and A + A^T <= 0: the system is passive as built.

    Raises
    ------
    ValueError
        If the gaskets are so thick or soft that waves of 200 kHz need too many elements.
    """
    if mounting.direct:
        return IDENTITY
    masses, rows, decays = [0.0], [], []  # rows: (first node, factor of the velocities of the nodes from there)
    if math.isfinite(mounting.edge_stiffness):
        masses.append(0.0)
        rows.append((0, math.sqrt(mounting.edge_stiffness) * np.array([-1.0, 1.0])))
        decays.append(0.0)
    for gasket in mounting.gaskets:
        speed = math.sqrt(gasket.modulus / gasket.density)
        count = math.ceil(ELEMENTS_PER_WAVE * RESOLVED * gasket.thickness / speed)
        fit = mounting.loss(gasket)
        springs = [(fit.stiffness, 0.0)] + [(branch.stiffness, 1.0 / branch.relaxation) for branch in fit.branches]
        if len(masses) + len(rows) + 4 * count * (1 + len(springs)) > MOST_STATES:
            raise ValueError(
                f"a gasket of {gasket.thickness:g} m with a wave speed of {speed:g} m/s is too many wavelengths "
                f"thick at {RESOLVED:g} Hz: take a thinner or stiffer one"
            )
        half = 0.5 * gasket.thickness / count
        for _ in range(count):
            start = len(masses) - 1
            masses[-1] += gasket.density * gasket.area * half * _MASSES[0]
            masses.extend(gasket.density * gasket.area * half * _MASSES[1:])
            for slope, weight in zip(_SLOPES / half, _WEIGHTS * half * gasket.modulus * gasket.area, strict=True):
                for share, decay in springs:
                    rows.append((start, math.sqrt(share * weight) * slope))
                    decays.append(decay)
    masses[-1] += mounting.sensor_mass
    stretch = np.zeros((len(rows), len(masses)))
    for k, (start, factors) in enumerate(rows):
        stretch[k, start : start + factors.size] = factors
    root = np.sqrt(np.array(masses[1:]))  # the first node moves with the surface
    G = stretch[:, 1:] / root
    A = np.block([[np.zeros((root.size, root.size)), -G.T], [G, -np.diag(decays)]])
    if mounting.edge_damping > 0.0:
        A[0, 0] = -mounting.edge_damping / masses[1]
    c = A[root.size - 1] / root[-1]  # acceleration against the surface plus that of the surface
    b = np.concatenate([-root, np.zeros(len(rows))])
    unit = float(np.linalg.norm(c))  # one unit for all states that keeps later systems on the same scale
    return LinearSystem(A, b * unit, c / unit, 0.0)


Array = NDArray[np.float64]

LOWEST = 10.0  # frequency from which a mounting is looked at, Hz: below, no mounting of a sensor has a resonance

POINTS = 1200  # frequencies from `LOWEST` to `RESOLVED`, 0.8 % apart: below a resonance a magnitude rises over far more

# Times that a crossing or a peak is looked at more closely, and points each time: 2e-7 of a frequency is left
ZOOMS, ZOOMED = 3, 33


@declare.dataclass
class PassBand:
    """Pass band of a mounting by its transmissibility |H| = |a_sensor / a_surface|.

    What is null in documents is infinite here; the two places, where there are none, NaN.
    """

    within_5: float = declare.number(
        BANDWIDTH,
        "lowest frequency at which |H| is more than 5 % from one; null where it is not below 200 kHz",
        label="within 5 % up to",
        column=MORE,
        tables="screen",
    )
    within_10: float = declare.number(
        BANDWIDTH,
        "lowest frequency at which |H| is more than 10 % from one; null alike",
        label="within 10 % up to",
        column=MAIN,
        tables="screen page",
    )
    half_power: float = declare.number(
        BANDWIDTH,
        "lowest frequency at which |H| is below 1/sqrt(2), -3 dB; null alike",
        label="-3 dB at",
        column=MORE,
        tables="screen",
    )
    resonance: float = declare.number(
        BANDWIDTH,
        "first frequency at which |H| is largest about it; null where there is none below 200 kHz",
        column=MORE,
        tables="screen page",
        headline="resonance of the first",
    )
    quality: float = declare.number(
        Quantity(NO_UNIT, NO_UNIT, "Q", digits=3),
        "|H| there; null where nothing has loss",
        column=MORE,
        tables="screen",
    )
    largest: float = declare.number(
        RATIO, "largest |H| below 200 kHz; one where the sensor follows exactly, null where nothing has loss"
    )
    largest_at: float = declare.number(
        BANDWIDTH,
        "frequency of the largest |H|, the first resonance where nothing has loss; null where the sensor follows "
        "exactly",
    )


def band(mounting: Mounting) -> PassBand:
    """Return the band that a mounting passes, of its continuous layers, and its resonance.

    A magnitude is looked at, as data sheets of accelerometers do: a mass m on a spring k without loss leaves
    10 % at f = sqrt(1 - 1/1.1) f_0 = 0.302 f_0 with f_0 = sqrt(k/m) / (2 pi), and falls below -3 dB at
    sqrt(1 + sqrt(2)) f_0. The quality is the magnification at resonance, as that of a sensor.

    Parameters
    ----------
    mounting : Mounting
        Mounting between surface and sensor.

    Examples
    --------
    >>> from strikewave.sensors import Gasket
    >>> passed = band(Mounting((Gasket(1.0, 4e6 * math.pi**2, 1e-4, 1e-3),), 1e-2))  # 3.16 kHz, almost without mass
    >>> round(passed.within_10), round(passed.half_power), round(passed.resonance)
    (953, 4913, 3162)
    """
    if mounting.direct:
        return PassBand(math.inf, math.inf, math.inf, math.nan, math.nan, 1.0, math.nan)
    f = np.geomspace(LOWEST, RESOLVED, POINTS)
    magnitude = _magnitude(mounting, f)

    def leaves(low: float, high: float) -> float:
        return _first(mounting, f, magnitude, lambda h: (h < low) | (h > high))

    inner = magnitude[1:-1]
    tops = 1 + np.flatnonzero((inner > magnitude[:-2]) & (inner >= magnitude[2:]))
    resonance = _summit(mounting, f, int(tops[0])) if tops.size else (math.nan, math.nan)
    largest = _summit(mounting, f, int(np.argmax(magnitude)))
    if tops.size and mounting.edge_damping == 0.0 and not any(layer.loss_factor for layer in mounting.gaskets):
        resonance = largest = (resonance[0], math.inf)
    return PassBand(leaves(0.95, 1.05), leaves(0.9, 1.1), leaves(math.sqrt(0.5), math.inf), *resonance, *largest[::-1])


def _magnitude(mounting: Mounting, frequencies: Array) -> Array:
    return np.abs(transmission(mounting, frequencies))


def _first(mounting: Mounting, f: Array, magnitude: Array, outside: Callable[[Array], NDArray[np.bool_]]) -> float:
    """Return the lowest frequency at which a magnitude is outside, Hz; infinite where it never is."""
    places = np.flatnonzero(outside(magnitude))
    if not places.size:
        return math.inf
    for _ in range(ZOOMS):
        k = int(places[0])
        if k == 0:
            return float(f[0])
        f = np.linspace(f[k - 1], f[k], ZOOMED)
        places = np.flatnonzero(outside(_magnitude(mounting, f)))
    return float(f[places[0]])


def _summit(mounting: Mounting, f: Array, k: int) -> tuple[float, float]:
    """Return frequency and height of the summit about a place of a grid; |H| has no zero that could hide one."""
    for _ in range(ZOOMS):
        f = np.linspace(f[max(k - 1, 0)], f[min(k + 1, f.size - 1)], ZOOMED)
        k = int(np.argmax(_magnitude(mounting, f)))
    return float(f[k]), float(_magnitude(mounting, f[k : k + 1])[0])
