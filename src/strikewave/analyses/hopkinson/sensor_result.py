"""Result of an accelerometer on the end of a bar: sensitivity with its uncertainty, histories, files."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.hopkinson.bar_end import Bandwidth, SensorComparison, Standing
from strikewave.analyses.hopkinson.outcome import Outcome
from strikewave.base import declare
from strikewave.base.declare import NO_UNIT, GivenUnits, Quantity, declarations
from strikewave.base.shock_quantities import ACCELERATION, MASS, MICROSECONDS, RATIO, SHARE, VELOCITY
from strikewave.base.variables import LabelledArrays, quantity
from strikewave.hopkinson.bars import Bar, BarMaterial
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.shown_result import Curve, history_curve

Array = NDArray[np.float64]

KEPT_PER_PERIOD = 20
"""Samples of the histories that are written, in a period of the bandwidth: enough to draw them smoothly; the common
clock has ten times as many."""
READING = Quantity.of_data("as reading_unit")
SENSITIVITY = Quantity.of_data("as sensitivity_unit", digits=5)
INTEGRAL = Quantity.of_data("as reading_unit times s")
VOLTAGE = Quantity("V", "mV")
GIVEN_UNITS = {
    "V": {READING: VOLTAGE.units, SENSITIVITY: ("V s^2/m", "mV/g"), INTEGRAL: ("V s", "mV ms")},
    "m/s^2": {READING: ACCELERATION.units, SENSITIVITY: RATIO.units, INTEGRAL: VELOCITY.units},
}
"""Units, SI and shown, by that of the reading."""


@declare.dataclass
class BarEnd:
    """What stands on the end of the bar."""

    mass: float = declare.number(MASS, "sensor and rigid disk", label="mass on the end")
    disk_mass: float | None = declare.number(MASS, "an elastic disk; null without one")


@declare.dataclass
class IncidentPulse:
    """The incident pulse at its gauge."""

    onset: float = declare.number(MICROSECONDS, "its begin")
    rise: float = declare.number(MICROSECONDS, "its rise from 10 to 90 %")
    width: float = declare.number(MICROSECONDS, "between its half heights")
    plateau: float = declare.number(RATIO, "median strain between its half heights")


@declare.dataclass
class ReadSensitivity:
    """Reading over reference, and its relative standard uncertainties by where they come from.

    NaN stands where nobody states one, and where the rise is too steep for accelerations to be quoted.

    Examples
    --------
    >>> ReadSensitivity("sensitivity", 1.0, 0.003, 0.0, 0.004, math.nan, 1.0, 1.0).relative
    0.005

    Attributes
    ----------
    name : str
        What it is called: sensitivity, or reading over reference where both are accelerations.
    """

    name: str
    value: float = declare.number(SENSITIVITY, "by least squares", headline="{name}")

    @declare.computed(
        declare.number(SENSITIVITY._replace(digits=2), "its standard uncertainty", headline="standard uncertainty")
    )
    def standard_uncertainty(self) -> float:
        """The standard uncertainty in its unit."""
        return abs(self.value) * self.relative

    @declare.computed(declare.number(SHARE, "root of the sum of squares of those that are known", label="combined"))
    def relative(self) -> float:
        """Root of the sum of squares of the relative uncertainties that are known."""
        parts = (self.scatter, self.bias, self.strain_uncertainty, self.speed_uncertainty)
        return math.hypot(*(part for part in parts if not math.isnan(part)))

    scatter: float = declare.number(SHARE, "residual of the slope")
    bias: float = declare.number(SHARE, "noise of the reference, which lowers a slope")
    strain_uncertainty: float = declare.number(SHARE, "stated for the strain at the gauge", label="strain")
    speed_uncertainty: float = declare.number(
        SHARE, "stated for the bar speed, which counts with its power", label="speed"
    )
    by_peaks: float = declare.number(SENSITIVITY, "of the largest accelerations")
    by_velocity: float = declare.number(SENSITIVITY, "of the velocity changes")


@declare.dataclass
class SensorPeak:
    """The largest accelerations; NaN where they are not quoted."""

    acceleration: float = declare.number(Quantity("m/s^2", "g"), "of the reference", headline="largest acceleration")
    reading: float = declare.number(READING, "of the reading")
    reading_noise: float = declare.number(READING, "of the reading at the bandwidth", label="noise of the reading")


@declare.dataclass
class SensorVelocity:
    """The largest velocities."""

    velocity: float = declare.number(Quantity("m/s", "m/s"), "of the reference", headline="velocity change")
    reading_integral: float = declare.number(INTEGRAL, "of the reading, integrated")


@declare.dataclass
class EndHistories:
    """Histories at the end of the bar, at the bandwidth."""

    time: Array = declare.history("s", "time after the wave comes to the end")
    reference_acceleration: Array = declare.history("m/s^2", "acceleration of the sensor by the gauge")
    reading: Array = declare.history(READING, "reading of the sensor, its delay taken out")
    reference_velocity: Array = declare.history("m/s", "velocity of the sensor by the gauge")
    velocity_by_both_waves: Array = declare.history("m/s", "velocity of the end by incident and reflected wave")


@declare.dataclass
class SensorSolution(Outcome):
    """An accelerometer beside the reference acceleration at the end of its bar.

    Attributes
    ----------
    bar : Bar
        As stated.
    standing : Standing
        Mass and disk on its end.
    """

    data_file: ClassVar[str] = "reduction.nc"

    bar: Bar
    standing: Standing
    constants: Mapping[str, BarMaterial] = declare.named(BarMaterial, "the bar", key="bars")

    @declare.computed(declare.part(BarEnd, "what stands on the end of the bar"))
    def end(self) -> BarEnd:
        """What stands on the end of the bar."""
        disk = self.standing.disk
        return BarEnd(self.standing.mass, None if disk is None else disk.mass)

    @declare.computed(declare.part(IncidentPulse, "the incident pulse"))
    def pulse(self) -> IncidentPulse:
        """The incident pulse."""
        found = self.comparison.pulses
        return IncidentPulse(found.onset, found.rise, found.width, found.plateau)

    @declare.computed(declare.part(Bandwidth, "low-pass of reference and reading", inline=True))
    def bandwidth(self) -> Bandwidth:
        """The low-pass of reference and reading."""
        return self.comparison.bandwidth

    rise_diameters: float = declare.number(
        Quantity(NO_UNIT, NO_UNIT, digits=3),
        "rise that is left at the bandwidth, in diameters of travel",
        label="rise left, in diameters of travel",
    )
    quoted: bool = declare.word("whether the rise is long enough for accelerations to be quoted")
    unit: str = declare.word("unit of the reading: m/s^2 or V", key="reading_unit")

    @declare.computed(declare.word("unit of reading over reference: V s^2/m, or 1 for a ratio of accelerations"))
    def sensitivity_unit(self) -> str:
        """Unit of reading over reference."""
        return GIVEN_UNITS[self.unit][SENSITIVITY][0]

    @declare.computed(declare.part(ReadSensitivity, "reading over reference", quantity=SENSITIVITY, headline="first"))
    def sensitivity(self) -> ReadSensitivity:
        """Reading over reference with its uncertainty."""
        stated, comparison = self.case.setup.uncertainty, self.comparison
        strain, speed = (math.nan if value is None else value.si for value in (stated.strain, stated.speed))
        return ReadSensitivity(
            name="sensitivity" if self.unit == "V" else "reading over reference",
            value=comparison.agreement.sensitivity if self.quoted else math.nan,
            scatter=comparison.scatter,
            bias=comparison.bias,
            strain_uncertainty=strain,
            speed_uncertainty=abs(comparison.speed_power) * speed,
            by_peaks=self.peak.reading / self.peak.acceleration,
            by_velocity=self.velocity_change.reading_integral / self.velocity_change.velocity,
        )

    @declare.computed(declare.part(SensorPeak, "largest accelerations", headline="first"))
    def peak(self) -> SensorPeak:
        """The largest accelerations."""
        peaks = self.comparison.peaks if self.quoted else (math.nan, math.nan)
        return SensorPeak(*peaks, self.comparison.reading_noise)

    @declare.computed(declare.part(SensorVelocity, "largest velocities", headline="first"))
    def velocity_change(self) -> SensorVelocity:
        """The largest velocities."""
        return SensorVelocity(*self.comparison.velocities)

    comparison: SensorComparison = declare.part(
        SensorComparison, "reference and reading at one bandwidth", inline=True, headline="first"
    )

    @declare.computed(declare.part(EndHistories, "histories that are written", inline=True))
    def kept_histories(self) -> EndHistories:
        """The histories that are written."""
        found, motion = self.comparison, self.comparison.motion
        histories = (found.time, motion.acceleration, found.reading, motion.velocity, found.both_waves)
        return EndHistories(*(history[self.kept] for history in histories))

    @property
    def given_units(self) -> GivenUnits:
        """Units of what the sensor reads."""
        return {of.given_by: pair for of, pair in GIVEN_UNITS[self.unit].items()}

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

    def preview(self) -> Curve:
        """Return the reading as an acceleration."""
        return history_curve(
            self.comparison.time, self.shown_acceleration, *ACCELERATION.units, "reading as acceleration"
        )

    def tables(self) -> dict[str, str]:
        """Return the histories as CSV text."""
        return {"reduction.csv": csv_table(self.columns(), HISTORY_DIGITS)}

    @declare.computed(declare.table("histories at the end of the bar; the delay of the reading is taken out"))
    def histories(self) -> list[Column]:
        """The histories; the delay of the reading is taken out."""
        kept, as_acceleration = self.kept_histories, self.shown_acceleration[self.kept]
        return [
            Column.of("time", kept.time, MICROSECONDS),
            Column.of("reference acceleration", kept.reference_acceleration, ACCELERATION),
            Column("reading", kept.reading, self.unit),
            Column.of("reading as acceleration", as_acceleration, ACCELERATION),
            Column.of("difference", as_acceleration - kept.reference_acceleration, ACCELERATION),
            Column("reference velocity", kept.reference_velocity, "m/s"),
            Column("reading integrated", self.shown_velocity[self.kept], "m/s"),
            Column("end velocity by both waves", kept.velocity_by_both_waves, "m/s"),
        ]

    @functools.cached_property
    def arrays(self) -> LabelledArrays:
        """The histories with units."""
        kept = self.kept_histories
        variables = {
            name: quantity("time", getattr(kept, name), one.quantity.within(self.given_units).si, one.meaning)
            for name, one in declarations(EndHistories).items()
        }
        integrated, force = self.shown_velocity[self.kept], self.comparison.motion.force[self.kept]
        variables |= {
            "integrated_reading": quantity("time", integrated, "m/s", "reading as acceleration, integrated"),
            "end_force": quantity("time", force, "N", "force of the bar on what stands on its end"),
            "velocity_by_both_waves": variables.pop("velocity_by_both_waves"),
        }
        return LabelledArrays.of(variables, {"time": variables.pop("time")}, self.attributes())
