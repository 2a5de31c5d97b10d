"""Strain from the voltage of a bridge of strain gauges."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

BridgeKind = Literal["quarter", "half", "half-poisson", "full-poisson"]
BRIDGES: tuple[BridgeKind, ...] = get_args(BridgeKind)
"""One gauge; two on opposite sides of the bar in opposite arms, which cancel bending; one along the bar and one
around it; two along and two around."""


@dataclass(frozen=True)
class Bridge:
    """A Wheatstone bridge of strain gauges, with its amplifier.

    Parameters
    ----------
    kind : str
        One of `BRIDGES`.
    gauge_factor : float
        Relative change of resistance over strain.
    excitation : float
        Voltage of the bridge, V.
    gain : float, optional
        Of the amplifier.
    poissons_ratio : float, optional
        Of the bar; only bridges with gauges around the bar use it.
    """

    kind: BridgeKind
    gauge_factor: float
    excitation: float
    gain: float = 1.0
    poissons_ratio: float = 0.29

    def __post_init__(self) -> None:
        if self.kind not in BRIDGES:
            raise ValueError(f"a bridge is one of {', '.join(BRIDGES)}, got {self.kind!r}")
        for key in ("gauge_factor", "excitation", "gain"):
            if not 0.0 < getattr(self, key) < math.inf:
                raise ValueError(f"{key} of a bridge must be above zero and finite, got {getattr(self, key)!r}")

    def strain(self, voltage: ArrayLike) -> NDArray[np.float64]:
        """Return strain, tension positive, from the voltage behind the amplifier, V.

        With r = V/(gain excitation), N gauges along the bar (1 or 2) and nu, the strain that those around it
        share (0 without them), the balance of the four arms gives exactly

            gauge_factor strain = (4/N) r / [1 + nu - (2/N) r (1 - nu)]

        whose denominator is 1 + nu for small strains. Source: the voltages of the two dividers of a bridge of
        arms 1 + x, 1 - nu x, 1 + x, 1 - nu x (or 1 where there is no active gauge).

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
