"""Oscillators of many natural frequencies, in groups for which a record is interpolated once."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.signal.oscillators import Bank, acceleration, bank, displacement, velocity

Array = NDArray[np.float64]

KINDS = {
    "absolute": (acceleration, 0, 0),
    "displacement": (displacement, 0, 2),
    "relative-velocity": (velocity, 0, 1),
    "pseudo-velocity": (displacement, 1, 2),
    "equivalent-static": (displacement, 2, 2),
}
"""Responses that a spectrum can be of: what is looked at of the oscillator, and the powers of 2 pi f and of the step
that make SI of it."""

SMOOTH = 20
"""Samples a period below which straight lines are no longer good: they lose (pi/20)^2/3 = 0.8 % there."""

FACTORS = (1, 2, 4, 8, 10)
"""Factors of interpolation: a frequency takes the least that leaves `SMOOTH` samples a period, and 10 serves up to half
the sampling rate; few factors, since the record is gone through once for each."""

_ROUNDING = 1e-12
"""Relative rounding of the samples a period of a frequency at the edge of a factor."""


class Group(NamedTuple):
    """Frequencies that need the same factor of interpolation: which of all, w = 2 pi f, and the step after it, s."""

    factor: int
    members: NDArray[np.intp]
    w: Array
    step: float

    def oscillators(self, q: float, kind: str) -> tuple[Bank, Array]:
        """Return oscillators of these frequencies, and what makes SI of a response counted in steps."""
        response, of_frequency, of_step = KINDS[kind]
        return bank(self.w * self.step, 0.5 / q, response), self.w**of_frequency * self.step**of_step


def groups(step: float, fn: Array, upsample: bool = True) -> Iterator[Group]:
    """Yield the frequencies by the interpolation that they need."""
    needed = np.searchsorted(FACTORS, SMOOTH * fn * step * (1.0 - _ROUNDING)) if upsample else np.zeros(fn.size, int)
    for i in np.unique(needed):
        members = np.flatnonzero(needed == i)
        yield Group(FACTORS[i], members, 2.0 * np.pi * fn[members], step / FACTORS[i])
