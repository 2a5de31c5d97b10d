"""Result of an accelerometer on the end of a bar: sensitivity with its uncertainty, histories, files."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.hopkinson.bar_end import SensorComparison, Standing
from strikewave.analyses.hopkinson.outcome import Outcome
from strikewave.analyses.hopkinson.result import inputs
from strikewave.base.variables import LabelledArrays, quantity
from strikewave.hopkinson.bars import Bar, BarMaterial
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.numbers import percent, spelled, with_unit
from strikewave.reporting.shown_result import Curve, history_curve

Array = NDArray[np.float64]

KEPT_PER_PERIOD = 20
"""Samples of the histories that are written, in a period of the bandwidth: enough to draw them smoothly; the common
clock has ten times as many."""
_KEYS = {
    "s": "time rise width onset delay",
    "m/s": "velocity velocity_by_both_waves reference_velocity speed",
    "m/s^2": "acceleration reference_acceleration reference_noise",
    "Hz": "bandwidth noise_limit",
    "Pa": "modulus",
    "kg/m^3": "density",
    "kg": "mass",
    "1": "plateau correlation residual reflected_misfit scatter strain_uncertainty speed_uncertainty bias relative "
    "rise_diameters ratio",
}
UNITS = {key: unit for unit, keys in _KEYS.items() for key in keys.split()}
"""Unit of each key of the JSON document; readings and sensitivities have that of ``reading_unit``."""


class Uncertainty(NamedTuple):
    """Relative standard uncertainties of a sensitivity, by where they come from; NaN where nobody states one.

    ``scatter`` is what the residual makes of the slope, ``bias`` by how much noise of the reference lowers it,
    ``strain`` and ``speed`` those stated for strain and bar speed, the latter times its power in the reference.
    """

    scatter: float
    bias: float
    strain: float
    speed: float

    @property
    def combined(self) -> float:
        """Root of the sum of squares of those that are known.

        Examples
        --------
        >>> Uncertainty(0.003, 0.0, 0.004, math.nan).combined
        0.005
        """
        return math.hypot(*(part for part in self if not math.isnan(part)))


@dataclass(frozen=True, kw_only=True)
class SensorSolution(Outcome):
    """An accelerometer beside the reference acceleration at the end of its bar.

    Attributes
    ----------
    bar : Bar
        As stated.
    standing : Standing
        Mass and disk on its end.
    unit : str
        Of the reading: m/s^2 or V.
    comparison : SensorComparison
        Reference and reading at one bandwidth.
    rise_diameters : float
        Rise that is left at the bandwidth, in diameters of travel.
    quoted : bool
        Whether the rise is long enough for accelerations to be quoted.
    constants : dict
        Which of density, modulus and speed of the bar is derived.
    """

    data_file: ClassVar[str] = "reduction.nc"
    is_history: ClassVar[bool] = True

    bar: Bar
    standing: Standing
    unit: str
    comparison: SensorComparison = field(repr=False)
    rise_diameters: float
    quoted: bool
    constants: Mapping[str, BarMaterial]

    @property
    def sensitivity_unit(self) -> str:
        """Unit of reading over reference: V s^2/m, or 1 for a ratio of accelerations."""
        return "V s^2/m" if self.unit == "V" else "1"

    @property
    def sensitivity(self) -> float:
        """Reading over reference by least squares; NaN where the rise is too steep to be quoted."""
        return self.comparison.agreement.sensitivity if self.quoted else math.nan

    @property
    def uncertainty(self) -> Uncertainty:
        """Relative standard uncertainties of the sensitivity."""
        stated, comparison = self.case.setup.uncertainty, self.comparison
        strain, speed = (math.nan if value is None else value.si for value in (stated.strain, stated.speed))
        return Uncertainty(comparison.scatter, comparison.bias, strain, abs(comparison.speed_power) * speed)

    @property
    def peaks(self) -> tuple[float, float]:
        """Largest acceleration of the reference, m/s^2, and of the reading; NaN where they are not quoted."""
        return self.comparison.peaks if self.quoted else (math.nan, math.nan)

    @property
    def scale(self) -> float:
        """What the reading is divided with to be shown beside the reference: the slope for volts, else its sign."""
        return self.comparison.agreement.sensitivity if self.unit == "V" else self.comparison.sign

    @property
    def shown_acceleration(self) -> Array:
        """The reading as an acceleration along the blow, m/s^2: volts over the sensitivity that was found."""
        return self.comparison.reading / self.scale

    @property
    def shown_velocity(self) -> Array:
        """The integral of `shown_acceleration`, m/s."""
        return self.comparison.integrated / self.scale

    @property
    def kept(self) -> slice:
        """The samples of the histories that are written."""
        period = 1.0 / self.comparison.bandwidth.value
        return slice(None, None, max(int(period / (KEPT_PER_PERIOD * float(np.diff(self.comparison.time[:2])[0]))), 1))

    def units(self) -> dict[str, str]:
        """Return the unit of each key of the JSON document."""
        return UNITS

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head."""
        comparison, parts, samples = self.comparison, self.uncertainty, self.kept
        agreement, pulses = comparison.agreement, comparison.pulses
        velocities, peaks = comparison.velocities, self.peaks
        layer = self.standing.disk
        return {
            "setup": self.case.setup.name,
            "inputs": inputs(self.case),
            "bars": {name: constants._asdict() for name, constants in self.constants.items()},
            "end": {"mass": self.standing.mass, "disk_mass": None if layer is None else layer.mass},
            "pulse": {"onset": pulses.onset, "rise": pulses.rise, "width": pulses.width, "plateau": pulses.plateau},
            "bandwidth": comparison.bandwidth.value,
            "bandwidth_by": comparison.bandwidth.reason,
            "noise_limit": comparison.bandwidth.noise,
            "rise_diameters": self.rise_diameters,
            "quoted": self.quoted,
            "reading_unit": self.unit,
            "sensitivity_unit": self.sensitivity_unit,
            "sensitivity": {
                "value": self.sensitivity,
                "standard_uncertainty": abs(self.sensitivity) * parts.combined,
                "relative": parts.combined,
                "scatter": parts.scatter,
                "bias": parts.bias,
                "strain_uncertainty": parts.strain,
                "speed_uncertainty": parts.speed,
                "by_peaks": peaks[1] / peaks[0],
                "by_velocity": velocities[1] / velocities[0],
            },
            "peak": {"acceleration": peaks[0], "reading": peaks[1], "reading_noise": comparison.reading_noise},
            "velocity_change": {"velocity": velocities[0], "reading_integral": velocities[1]},
            "reference_noise": comparison.reference_noise,
            "delay": agreement.delay,
            "correlation": comparison.correlation,
            "residual": agreement.residual,
            "reflected_misfit": comparison.reflected_misfit,
            "time": comparison.time[samples],
            "reference_acceleration": comparison.motion.acceleration[samples],
            "reading": comparison.reading[samples],
            "reference_velocity": comparison.motion.velocity[samples],
            "velocity_by_both_waves": comparison.both_waves[samples],
        }

    def highlights(self) -> list[tuple[str, str]]:
        """Return the sensitivity with its uncertainty, the largest acceleration, and the delay of the reading."""
        delay = self.comparison.agreement.delay
        unit = "" if self.sensitivity_unit == "1" else f" {spelled(self.sensitivity_unit)}"
        known = [
            ("sensitivity" if unit else "reading over reference", f"{self.sensitivity:.4g}{unit}"),
            ("standard uncertainty", percent(self.uncertainty.combined, 2)),
            ("largest acceleration", with_unit(self.peaks[0], "m/s^2", "g")),
        ]
        return [*(known if self.quoted else []), ("delay", f"{1e6 * delay:+.2f} µs")]

    def preview(self) -> Curve:
        """Return the reading as an acceleration."""
        return history_curve(self.comparison.time, self.shown_acceleration, "m/s^2", "g", "reading as acceleration")

    def tables(self) -> dict[str, str]:
        """Return the histories as CSV text."""
        return {"reduction.csv": csv_table(self.columns(), HISTORY_DIGITS)}

    def columns(self) -> list[Column]:
        """Return the histories; the delay of the reading is taken out."""
        comparison, samples = self.comparison, self.kept
        columns = [
            Column("time", comparison.time, "s"),
            Column("reference acceleration", comparison.motion.acceleration, "m/s^2"),
            Column("reading", comparison.reading, self.unit),
            Column("reading as acceleration", self.shown_acceleration, "m/s^2"),
            Column("difference", self.shown_acceleration - comparison.motion.acceleration, "m/s^2"),
            Column("reference velocity", comparison.motion.velocity, "m/s"),
            Column("reading integrated", self.shown_velocity, "m/s"),
            Column("end velocity by both waves", comparison.both_waves, "m/s"),
        ]
        return [column._replace(values=column.values[samples]) for column in columns]

    def brief(self) -> dict[str, str]:
        """Return the time, and the accelerations of reference and reading with their difference."""
        return {"time": "us", **dict.fromkeys(("reference acceleration", "reading as acceleration", "difference"), "g")}

    @functools.cached_property
    def arrays(self) -> LabelledArrays:
        """The histories with units."""
        comparison, samples = self.comparison, self.kept
        histories = {
            "reference_acceleration": (
                comparison.motion.acceleration,
                "m/s^2",
                "acceleration of the sensor by the gauge",
            ),
            "reading": (comparison.reading, self.unit, "reading of the sensor, its delay taken out"),
            "reference_velocity": (comparison.motion.velocity, "m/s", "velocity of the sensor by the gauge"),
            "integrated_reading": (self.shown_velocity, "m/s", "reading as acceleration, integrated"),
            "end_force": (comparison.motion.force, "N", "force of the bar on what stands on its end"),
            "velocity_by_both_waves": (
                comparison.both_waves,
                "m/s",
                "velocity of the end by incident and reflected wave",
            ),
        }
        variables = {name: quantity("time", v[samples], unit, words) for name, (v, unit, words) in histories.items()}
        coordinates = {"time": quantity("time", comparison.time[samples], "s", "time after the wave comes to the end")}
        return LabelledArrays.of(variables, coordinates, self.attributes())
