"""Bodies in a line, as they stand before the first collision."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.contact.law import not_negative, positive, refuse


@dataclass(frozen=True)
class BodyLine:
    """Bodies in a line, from the bottom.

    Parameters
    ----------
    masses : tuple of float
        kg; the first and the last may be infinite.
    restitutions : tuple of float
        Of each pair of neighbours, 0 to 1.
    gaps : tuple of float
        Between neighbours at the start, m.
    speeds : tuple of float
        At the start, m/s, upwards.
    gravity : float, optional
        Downwards, m/s^2.

    Raises
    ------
    ValueError
        If a number is out of range or their count does not fit.
    """

    masses: tuple[float, ...]
    restitutions: tuple[float, ...]
    gaps: tuple[float, ...]
    speeds: tuple[float, ...]
    gravity: float = STANDARD_GRAVITY

    def __post_init__(self) -> None:
        count = len(self.masses)
        for name, wanted in (("restitutions", count - 1), ("gaps", count - 1), ("speeds", count)):
            if count < 2 or len(getattr(self, name)) != wanted:
                raise ValueError(f"{count} masses take {wanted} {name}, got {len(getattr(self, name))}; two at least")
        masses, e = np.asarray(self.masses, dtype=float), np.asarray(self.restitutions, dtype=float)
        refuse("a mass", masses, masses > 0.0, "positive")
        positive("a mass between the ends", masses[1:-1])
        if not np.any(np.isfinite(masses)):
            raise ValueError("one body at least must have a finite mass")
        refuse("a restitution", e, (e >= 0.0) & (e <= 1.0), "within 0 to 1")
        not_negative("a gap", self.gaps)
        not_negative("gravity", self.gravity)
        refuse("a speed", self.speeds, np.isfinite(self.speeds), "finite")
