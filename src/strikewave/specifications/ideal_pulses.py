"""The ideal pulses of shock specifications: half-sine, terminal-peak sawtooth and trapezoid."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

HALF_SINE, SAWTOOTH, TRAPEZOID = "half-sine", "sawtooth", "trapezoid"
SHAPES = (HALF_SINE, SAWTOOTH, TRAPEZOID)
"""Shapes of a pulse; a sawtooth has its peak at its end."""


@dataclass(frozen=True)
class IdealPulse:
    """A pulse as a specification draws it, from time 0 on.

    Half-sine: a = A sin(pi t / D). Terminal-peak sawtooth: a = A t / D. Trapezoid: a line to A, A, and a line to 0.

    Attributes
    ----------
    shape : str
        One of `SHAPES`.
    peak : float
        A, above zero.
    duration : float
        D from foot to foot, s.
    rise, fall : float
        Shares of the duration in which a trapezoid rises and falls.

    Examples
    --------
    >>> pulse = IdealPulse("half-sine", 1500.0, 0.5e-3)
    >>> float(pulse.at(0.25e-3)), round(pulse.width(0.1) / 0.5e-3, 4), round(pulse.velocity_change, 4)
    (1500.0, 0.9362, 0.4775)
    """

    shape: str
    peak: float
    duration: float
    rise: float = 0.1
    fall: float = 0.1

    def at(self, time: ArrayLike) -> Array:
        """Return the pulse at times, s: zero before and after."""
        share = np.asarray(time, dtype=np.float64) / self.duration
        inside = (share >= 0.0) & (share <= 1.0)
        if self.shape == HALF_SINE:
            values = np.sin(np.pi * np.clip(share, 0.0, 1.0))
        elif self.shape == SAWTOOTH:
            values = np.clip(share, 0.0, 1.0)
        else:
            values = np.minimum(np.minimum(share / self.rise, (1.0 - share) / self.fall), 1.0)
        return np.asarray(np.where(inside, self.peak * values, 0.0), dtype=np.float64)

    @property
    def top(self) -> tuple[float, float]:
        """From when to when it stands at its peak, s."""
        low, high = {HALF_SINE: (0.5, 0.5), SAWTOOTH: (1.0, 1.0)}.get(self.shape, (self.rise, 1.0 - self.fall))
        return low * self.duration, high * self.duration

    def widened(self, time: ArrayLike, by: float) -> tuple[Array, Array]:
        """Return the smallest and largest value that the pulse has within a time to either side, s.

        The pulse has one top, so that its smallest value stands at an end of that stretch, and its largest at the top
        or at the end next to it.

        Examples
        --------
        >>> low, high = IdealPulse("sawtooth", 1.0, 1.0).widened([0.5, 1.05], 0.1)
        >>> low.round(3).tolist(), high.round(3).tolist()
        ([0.4, 0.0], [0.6, 1.0])
        """
        time = np.asarray(time, dtype=np.float64)
        first, last = time - by, time + by
        begin, end = self.top
        at_top = (first <= end) & (last >= begin)
        high = np.where(at_top, self.peak, np.where(last < begin, self.at(last), self.at(first)))
        return np.minimum(self.at(first), self.at(last)), np.asarray(high, dtype=np.float64)

    def width(self, level: float) -> float:
        """Return the time above a share of the peak, s.

        Half-sine: D (1 - 2 asin(level) / pi), at 10 % 0.936 D. Sawtooth: D (1 - level). Trapezoid: D (1 - level (rise
        + fall)).
        """
        if self.shape == HALF_SINE:
            return self.duration * (1.0 - 2.0 * math.asin(level) / math.pi)
        return self.duration * (1.0 - level * (1.0 if self.shape == SAWTOOTH else self.rise + self.fall))

    @property
    def velocity_change(self) -> float:
        """Its integral: half-sine 2 A D / pi, sawtooth A D / 2, trapezoid A D (1 - (rise + fall) / 2)."""
        area = {HALF_SINE: 2.0 / math.pi, SAWTOOTH: 0.5}.get(self.shape, 1.0 - 0.5 * (self.rise + self.fall))
        return area * self.peak * self.duration


def from_width(
    shape: str, peak: float, duration: float, level: float, rise: float = 0.1, fall: float = 0.1
) -> IdealPulse:
    """Return the ideal pulse whose width at a share of its peak is stated; level 0 states its duration itself.

    Examples
    --------
    >>> round(from_width("half-sine", 1.0, 0.5e-3, 0.1).duration * 1e3, 4)
    0.5341
    """
    whole = IdealPulse(shape, peak, 1.0, rise, fall)
    return IdealPulse(shape, peak, duration / whole.width(level), rise, fall)
