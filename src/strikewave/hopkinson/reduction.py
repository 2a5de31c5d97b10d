"""From the three waves at the specimen to its stress, strain and strain rate.

Symbols: e_i, e_r, e_t strains of the incident, reflected and transmitted wave (compression positive), E A force over
strain of a bar, c its speed, F force and v velocity of a face (1 at the incident bar, 2 at the transmitted one),
L and A_s length and area of the specimen.

    F1 = E1 A1 (e_i + e_r),   F2 = E2 A2 e_t,   v1 = c1 (e_i - e_r),   v2 = c2 e_t

Source: G. T. Gray III, Classic Split-Hopkinson Pressure Bar Testing, ASM Handbook 8 (2000).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base import declare
from strikewave.base.errors import nearest
from strikewave.hopkinson.alignment import FaceWaves
from strikewave.hopkinson.bars import Bar, Specimen
from strikewave.signal.motion import integral

Array = NDArray[np.float64]

Analysis = Literal["1-wave", "2-wave", "3-wave"]
ANALYSES: tuple[Analysis, ...] = get_args(Analysis)
"""All analyses, for checks and messages."""


@dataclass(frozen=True)
class Reduction:
    """Forces (N, compression positive) and velocities (m/s, along the blow) of the two faces of the specimen."""

    waves: FaceWaves
    bars: tuple[Bar, Bar]
    specimen: Specimen
    first_force: Array = field(repr=False)  # F1
    second_force: Array = field(repr=False)  # F2
    first_velocity: Array = field(repr=False)  # v1
    second_velocity: Array = field(repr=False)  # v2

    @property
    def time(self) -> Array:
        """After the wave reaches the first face, s."""
        return self.waves.time

    @property
    def loading(self) -> NDArray[np.bool_]:
        """Samples from the arrival to the end of the incident wave."""
        return np.asarray((self.time >= 0.0) & (self.time <= self.waves.loaded))

    def integral(self, values: ArrayLike) -> Array:
        """Return the running integral over time from the arrival on, by the trapezoidal rule; 0 before it."""
        after = np.where(self.time >= 0.0, np.asarray(values, dtype=float), 0.0)
        return integral(after, self.waves.step)

    def curve(self, analysis: Analysis = "3-wave") -> StressStrainCurve:
        """Return the engineering curve by one analysis.

        =======  ==============  =====================================================================
        1-wave   F2/A_s          face forces equal: the rate follows from e_r alone between equal bars
        2-wave   F1/A_s          the same rate; the force on the first face
        3-wave   (F1+F2)/(2A_s)  (v1 - v2)/L from all three waves
        =======  ==============  =====================================================================

        The rate of the first two is [c1 (e_i - e_r) - c2 e]/L with the e = F1/(E2 A2) that equal forces give;
        between equal bars -2 c e_r/L. Others call F2 with the rate of all three waves "2-wave".

        Raises
        ------
        ValueError
            If the analysis is not known.
        """
        if analysis not in ANALYSES:
            raise ValueError(f"unknown analysis {analysis!r}; {nearest(str(analysis), ANALYSES)}")
        beyond = self.second_velocity
        if analysis != "3-wave":
            beyond = self.first_force / self.bars[1].impedance
        rate = (self.first_velocity - beyond) / self.specimen.length
        mean = 0.5 * (self.first_force + self.second_force)
        force = {"1-wave": self.second_force, "2-wave": self.first_force, "3-wave": mean}[analysis]
        return StressStrainCurve(self.time, self.integral(rate), force / self.specimen.area, rate)


@declare.dataclass
class StressStrainCurve:
    """Strain, stress and strain rate of a specimen over time (s), compression positive."""

    time: Array
    strain: Array = declare.history("1", "strain of the specimen by each analysis, compression positive")
    stress: Array = declare.history("Pa", "its stress")
    rate: Array = declare.history("1/s", "its strain rate")

    def true(self) -> StressStrainCurve:
        """Return true strain, stress and rate of a specimen that keeps its volume.

        With engineering strain e and stress s in compression: -ln(1 - e), s (1 - e), rate/(1 - e); NaN for e >= 1.

        Examples
        --------
        >>> one = np.array([0.1])
        >>> StressStrainCurve(one, one, 100.0 * one, one).true().stress.round(3).tolist()
        [9.0]
        """
        left = np.where(self.strain < 1.0, 1.0 - self.strain, np.nan)
        return StressStrainCurve(self.time, np.log(1.0 / left), self.stress * left, self.rate / left)


def reduce(waves: FaceWaves, bars: tuple[Bar, Bar], specimen: Specimen) -> Reduction:
    """Return forces and velocities of the faces of the specimen from the waves there.

    Theory: :eq:`hopkinson-reduction`.

    Returns
    -------
    Reduction
        Forces (N) and velocities (m/s) of both faces; stress, strain and strain rate follow from them.
    """
    ei, er, et = waves.incident, waves.reflected, waves.transmitted
    return Reduction(
        waves=waves,
        bars=bars,
        specimen=specimen,
        first_force=bars[0].stiffness * (ei + er),
        second_force=bars[1].stiffness * et,
        first_velocity=bars[0].speed * (ei - er),
        second_velocity=bars[1].speed * et,
    )
