"""What a mounting costs: up to which frequency the sensor still follows the surface, and where it rings."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import MAIN, MORE, NO_UNIT, Quantity
from strikewave.base.shock_quantities import BANDWIDTH, RATIO
from strikewave.sensors.mounting import RESOLVED, Mounting, transmission

Array = NDArray[np.float64]

LOWEST = 10.0
"""Frequency from which a mounting is looked at, Hz: below, no mounting of a sensor has a resonance."""

POINTS = 1200
"""Frequencies from `LOWEST` to `RESOLVED`, 0.8 % apart: below a resonance a magnitude rises over far more."""

ZOOMS, ZOOMED = 3, 33
"""Times that a crossing or a peak is looked at more closely, and points each time: 2e-7 of a frequency is left."""


@declare.dataclass
class PassBand:
    """What the transmissibility |H| = |a_sensor / a_surface| of a mounting passes.

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
        RATIO,
        "largest |H| below 200 kHz; one where the sensor follows exactly, null where nothing has loss",
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
        What is between surface and sensor.

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
