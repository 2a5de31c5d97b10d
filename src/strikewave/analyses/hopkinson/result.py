"""The results of split bars: of a shot, of an accelerometer on a bar end, of a bar calibrated by its echoes."""

from __future__ import annotations

import functools
import math
from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave._version import __version__
from strikewave.analyses.hopkinson.bar_end import Bandwidth, SensorComparison, Standing
from strikewave.analyses.hopkinson.build import HopkinsonCase, values_of
from strikewave.base import declare
from strikewave.base.datasets import LabelledArrays, quantity
from strikewave.base.declare import KEY, MAIN, MORE, NO_UNIT, GivenUnits, Quantity, declarations
from strikewave.base.quantities import StatedValue
from strikewave.base.result import Source
from strikewave.base.shock_quantities import (
    ACCELERATION,
    ENERGY,
    FORCE,
    KILOHERTZ,
    MASS,
    MEASURED_IMPULSE,
    MICROSECONDS,
    MICROSTRAIN,
    RATIO,
    SHARE,
    STRESS,
    VELOCITY,
)
from strikewave.hopkinson.bars import Bar, BarMaterial, StrikerBar
from strikewave.hopkinson.checks import RISE_SLOPE, Energy, Equilibrium, Momentum, Slope, StrikerCheck, rise_slopes
from strikewave.hopkinson.echoes import Echoes
from strikewave.hopkinson.pulses import Pulses
from strikewave.hopkinson.reduction import ANALYSES, Analysis, Reduction, StressStrainCurve
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.numbers import axis_unit, shown, with_unit
from strikewave.reporting.parts import NONE, written
from strikewave.reporting.shown_result import Curve, ShownResult, history_curve

SCHEMA = 1
"""Version of the layout of the files of a solution; it rises when they change."""


@declare.dataclass
class Outcome(ShownResult):
    """The result of a set-up, with the SHA-256 of its files by their names."""

    command: ClassVar[str] = "hopkinson"
    main_rows: ClassVar[str] = "histories"
    is_history: ClassVar[bool] = True

    case: HopkinsonCase
    digests: Mapping[str, str]

    @declare.computed(declare.word("name of the set-up"))
    def setup(self) -> str:
        """Name of the set-up."""
        return self.case.setup.name

    @declare.computed(declare.named(StatedValue, "values of the set-up by their paths"))
    def inputs(self) -> dict[str, StatedValue]:
        """Every quantity of the set-up, with provenance."""
        values = values_of(self.case.setup)
        return {path: StatedValue(value.si, value.typed, value.provenance, value.note) for path, value in values}

    @property
    def title(self) -> str:
        """The title of the set-up."""
        return self.case.setup.title or self.case.setup.name

    @property
    def test(self) -> Mapping[str, str]:
        """Statements of the set-up on the test."""
        return self.case.setup.test.stated()

    @property
    def source(self) -> Source:
        """The set-up, with the files that it names."""
        return Source("set-up", self.case.setup.name, marked_text(self.case, self.digests), digests=self.digests)

    @property
    @abstractmethod
    def arrays(self) -> LabelledArrays:
        """The histories with units."""

    def attributes(self) -> dict[str, Any]:
        """Return the attributes of a dataset."""
        return {"strikewave_schema": SCHEMA, "strikewave_version": __version__, "case": self.case.text}


def marked_text(case: HopkinsonCase, digests: Mapping[str, str]) -> str:
    """Return the text of a set-up with the SHA-256 of its files below: other files are another result."""
    return case.text + "".join(f"# SHA-256 {digest} {name}\n" for name, digest in digests.items())


Array = NDArray[np.float64]

WAVES = ("reflected", "transmitted")
"""The waves that an alignment may move."""
DELAY = Quantity("s", "us", decimals=2, digits=0, signed=True)
TRUE_RATE = Quantity("1/s", "1/s", "true rate", 0, 3)


@declare.dataclass
class GaugedBar:
    """A bar, and the noise of its gauge."""

    constants: BarMaterial = declare.part(BarMaterial, "density, modulus and speed", inline=True)
    impedance: float = declare.number(
        Quantity("N s/m", "N s/m", digits=5), "its impedance", column=MAIN, in_document=False
    )
    noise: float = declare.number(MICROSTRAIN, "noise of its gauge", column=MORE, in_document=False)


@declare.dataclass
class WaveDelay:
    """The delay of a wave at the specimen against geometry."""

    wave: str = declare.word("which wave", column=KEY)
    onset: float = declare.number(DELAY, "by its onset", label="by onset", column=MAIN)
    balance: float = declare.number(DELAY, "by the balance of forces", label="by balance", column=MAIN)
    applied: float = declare.number(DELAY, "how far it was moved", label="applied shift", column=MAIN)


@declare.dataclass
class Alignment:
    """The alignment of the waves on one clock at the specimen."""

    method: str = declare.word("how the waves were aligned")
    dispersion: str = declare.word("theory by which dispersion was turned back")
    band: float = declare.number(KILOHERTZ, "frequency up to which it was")
    window: float = declare.number(Quantity("s", "us", digits=3), "largest move that an alignment may make")
    late_onset: dict[str, float] = declare.number(
        DELAY, "how late the reflected and the transmitted wave are by their onsets"
    )
    late_balance: dict[str, float] = declare.number(DELAY, "how late they are by the balance of forces")
    applied: dict[str, float] = declare.number(DELAY, "by how much they were moved forward")

    @property
    def delays(self) -> list[WaveDelay]:
        """The delays, wave by wave."""
        return [WaveDelay(wave, self.late_onset[wave], self.late_balance[wave], self.applied[wave]) for wave in WAVES]


@declare.dataclass
class LargestTrue:
    """The largest values of a true curve while the incident wave lasts, and its median rate."""

    strain: float = declare.number(
        SHARE, "largest true strain while the incident wave lasts", label="true strain", column=MAIN,
        headline="largest true strain",
    )  # fmt: skip
    stress: float = declare.number(
        Quantity("Pa", "MPa", "true stress", 1), "largest true stress while it lasts", column=MAIN,
        headline="largest true stress",
    )  # fmt: skip
    rate: float = declare.number(
        TRUE_RATE, "median true strain rate while it lasts", column=MAIN,
        headline="median true rate",
    )  # fmt: skip

    @classmethod
    def of(cls, true: StressStrainCurve, on: NDArray[np.bool_]) -> LargestTrue:
        """Return the largest values of a curve while the load is on."""
        return cls(float(true.strain[on].max()), float(true.stress[on].max()), float(np.median(true.rate[on])))


@declare.dataclass
class AnalysedCurve:
    """The specimen by one analysis."""

    analysis: str = declare.word("1-wave, 2-wave or 3-wave", column=KEY)
    largest: LargestTrue = declare.part(LargestTrue, "largest values")
    slope: str = declare.word("slope of the rise, and how far misalignment moves it", quantity=RISE_SLOPE, column=MAIN)


@declare.dataclass
class HopkinsonSolution(Outcome):
    """A reduced shot; ``constants`` are those of each bar, one of them derived, ``striker`` is None without one."""

    data_file: ClassVar[str] = "reduction.nc"

    reduction: Reduction = field(repr=False)
    striker: StrikerBar | None
    constants: Mapping[str, BarMaterial]

    @declare.computed(declare.part(LargestTrue, "of the analysis that counts", headline="first", in_document=False))
    def largest(self) -> LargestTrue:
        """Largest true strain and stress, and median true rate, by the analysis of the set-up."""
        return LargestTrue.of(self.curve.true(), self.reduction.loading)

    @declare.computed(declare.named(GaugedBar, "bars, with the constant that follows from the two others", label="bar"))
    def bars(self) -> dict[str, GaugedBar]:
        """The bars, with their gauges."""
        pairs = zip(self.constants, self.reduction.bars, self.reduction.waves.noise, strict=True)
        return {name: GaugedBar(self.constants[name], bar.impedance, noise) for name, bar, noise in pairs}

    pulses: Pulses = declare.part(Pulses, "pulses as found at the gauges")

    @declare.computed(declare.part(Alignment, "how the waves were brought to one clock at the specimen"))
    def alignment(self) -> Alignment:
        """Alignment of the waves on one clock at the specimen."""
        w = self.reduction.waves
        late = (dict(zip(WAVES, pair, strict=True)) for pair in (w.late_onset, w.late_balance, w.applied))
        return Alignment(w.method, w.theory, w.band, w.window, *late)

    equilibrium: Equilibrium = declare.part(Equilibrium, "how alike the forces on both faces are", headline="first")
    momentum: Momentum = declare.part(
        Momentum, "impulses, and how they close", quantity=MEASURED_IMPULSE, headline="first"
    )
    energy: Energy = declare.part(Energy, "energy of the waves, and what became of it", quantity=ENERGY)
    striker_check: StrikerCheck | None = declare.part(
        StrikerCheck, "the incident pulse and the one that its striker should make", key="striker"
    )

    @declare.computed(declare.named(Slope, "slopes of the rise", quantity=RISE_SLOPE))
    def rise_slope(self) -> dict[str, Slope]:
        """The slope of the rise by each analysis, and how far a sample of misalignment moves it."""
        return {name: rise_slopes(self.reduction, name) for name in ANALYSES}

    @declare.computed(declare.part(LargestTrue, "largest values by the analysis that counts"))
    def largest_true(self) -> LargestTrue:
        """The largest values, by the key of the JSON document."""
        return self.largest

    @declare.computed(declare.word("which analysis counts: 1-wave, 2-wave or 3-wave"))
    def analysis(self) -> Analysis:
        """The analysis of the set-up."""
        return self.case.setup.solver.analysis

    @declare.computed(declare.history("s", "after the incident wave comes to the specimen"))
    def time(self) -> Array:
        """Times of the histories at the specimen."""
        return self.reduction.time

    @declare.computed(declare.named(StressStrainCurve, "curves by each analysis"))
    def curves(self) -> dict[str, StressStrainCurve]:
        """The engineering curves."""
        return {name: self.reduction.curve(name) for name in ANALYSES}

    @property
    def curve(self) -> StressStrainCurve:
        """The engineering curve by the analysis of the set-up."""
        return self.curves[self.analysis]

    @property
    def analysed(self) -> list[AnalysedCurve]:
        """The specimen by each analysis; a star marks the chosen one."""
        rows = []
        for name, curve in self.curves.items():
            label = f"{name} *" if name == self.analysis else name
            largest = LargestTrue.of(curve.true(), self.reduction.loading)
            rows.append(AnalysedCurve(label, largest, slope_text(self.rise_slope[name])))
        return rows

    @functools.cached_property
    def arrays(self) -> LabelledArrays:
        """Waves, forces, velocities and curves at the specimen with units."""
        r, w = self.reduction, self.reduction.waves
        variables = {
            "incident": quantity("time", w.incident, "1", "strain of the incident wave at the specimen"),
            "reflected": quantity("time", w.reflected, "1", "strain of the reflected wave at the specimen"),
            "transmitted": quantity("time", w.transmitted, "1", "strain of the transmitted wave at the specimen"),
            "first_force": quantity("time", r.first_force, "N", "force on the first face"),
            "second_force": quantity("time", r.second_force, "N", "force on the second face"),
            "first_velocity": quantity("time", r.first_velocity, "m/s", "velocity of the first face"),
            "second_velocity": quantity("time", r.second_velocity, "m/s", "velocity of the second face"),
            "force_difference": quantity("time", self.equilibrium.ratio, "1", "2 |F1 - F2| / |F1 + F2|"),
        }
        curves = list(self.curves.values())
        for kind, drawn in (("engineering", curves), ("true", [curve.true() for curve in curves])):
            for part, unit in (("strain", "1"), ("stress", "Pa"), ("rate", "1/s")):
                rows = np.array([getattr(curve, part) for curve in drawn])
                variables[f"{kind}_{part}"] = quantity(("analysis", "time"), rows, unit, f"{kind} {part}, compression")
        coordinates = {
            "time": quantity("time", r.time, "s", "time after the incident wave comes to the specimen"),
            "analysis": ("analysis", np.array(ANALYSES, dtype=object)),
        }
        return LabelledArrays.of(variables, coordinates, self.attributes())

    def preview(self) -> Curve:
        """Return true stress over true strain while the incident wave lasts."""
        true, on = self.curve.true(), self.reduction.loading
        size, name = axis_unit(*STRESS.units)
        return Curve(true.strain[on], true.stress[on] / size, "true strain", f"true stress ({name})")

    def tables(self) -> dict[str, str]:
        """Return the histories at the specimen and the pulses at the gauges, each with its own time, as CSV text."""
        pulses = self.pulses
        columns: list[Column] = []
        parts = (pulses.incident, pulses.reflected, pulses.transmitted)
        for name, start, values in zip(("incident", "reflected", "transmitted"), pulses.starts, parts, strict=True):
            columns.append(Column(f"{name} time", start + pulses.step * np.arange(values.size), "s"))
            columns.append(Column(f"{name} strain", values, "1"))
        pulse_text = csv_table(columns, HISTORY_DIGITS)
        return {"reduction.csv": csv_table(self.columns(), HISTORY_DIGITS), "pulses.csv": pulse_text}

    @declare.computed(declare.table("histories at the specimen, with the curve of the chosen analysis"))
    def histories(self) -> list[Column]:
        """The histories at the specimen, with the curve of the chosen analysis."""
        r, w, engineering = self.reduction, self.reduction.waves, self.curve
        true = engineering.true()
        return [
            Column.of("time", r.time, MICROSECONDS),
            Column("incident strain", w.incident, "1"),
            Column("reflected strain", w.reflected, "1"),
            Column("transmitted strain", w.transmitted, "1"),
            Column.of("force 1", r.first_force, FORCE),
            Column.of("force 2", r.second_force, FORCE),
            Column("velocity 1", r.first_velocity, "m/s"),
            Column("velocity 2", r.second_velocity, "m/s"),
            Column("engineering strain", engineering.strain, "1"),
            Column("engineering stress", engineering.stress, "Pa"),
            Column("engineering rate", engineering.rate, "1/s"),
            Column.of("true strain", true.strain, RATIO),
            Column.of("true stress", true.stress, STRESS),
            Column.of("true rate", true.rate, TRUE_RATE),
        ]


def slope_text(slope: Slope) -> str:
    """Return a slope as text, with its range under a misalignment of a sample."""
    if math.isnan(slope.value):
        return NONE
    ends = (slope.value, slope.low, slope.high)
    value, low, high = (written(shown(end, *RISE_SLOPE.units), RISE_SLOPE.digits) for end in ends)
    if math.isnan(slope.low):
        return value
    return f"{value} ({low} or more)" if math.isinf(slope.high) else f"{value} ({low} to {high})"


KEPT_PER_PERIOD = 20
"""Written samples of a history in a period of the bandwidth: enough to draw them; the common clock has ten times as
many."""
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
    """The mass and the disk on the end of the bar."""

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
    """Reading over reference, and its relative standard uncertainties by source.

    NaN stands for one that is not stated, and where the rise is too steep for accelerations to be quoted. ``name`` is
    "sensitivity", or "reading over reference" where both are accelerations.

    Examples
    --------
    >>> ReadSensitivity("sensitivity", 1.0, 0.003, 0.0, 0.004, math.nan, 1.0, 1.0).relative
    0.005
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
    """An accelerometer beside the reference acceleration at the end of its bar; ``standing`` is mass and disk there."""

    data_file: ClassVar[str] = "reduction.nc"

    bar: Bar
    standing: Standing
    constants: Mapping[str, BarMaterial] = declare.named(BarMaterial, "the bar", key="bars")

    @declare.computed(declare.part(BarEnd, "what stands on the end of the bar"))
    def end(self) -> BarEnd:
        """Mass and disk on the end of the bar."""
        disk = self.standing.disk
        return BarEnd(self.standing.mass, None if disk is None else disk.mass)

    @declare.computed(declare.part(IncidentPulse, "the incident pulse"))
    def pulse(self) -> IncidentPulse:
        """The incident pulse."""
        pulses = self.comparison.pulses
        return IncidentPulse(pulses.onset, pulses.rise, pulses.width, pulses.plateau)

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
    def written_histories(self) -> EndHistories:
        """The histories that are written."""
        end, motion = self.comparison, self.comparison.motion
        histories = (end.time, motion.acceleration, end.reading, motion.velocity, end.both_waves)
        return EndHistories(*(history[self.every] for history in histories))

    @property
    def given_units(self) -> GivenUnits:
        """Units of the reading."""
        return {of.given_by: pair for of, pair in GIVEN_UNITS[self.unit].items()}

    @property
    def scale(self) -> float:
        """Divisor of the reading that is shown beside the reference: the slope for volts, else its sign."""
        return self.comparison.agreement.sensitivity if self.unit == "V" else self.comparison.sign

    @property
    def shown_acceleration(self) -> Array:
        """The reading as an acceleration along the blow, m/s^2: volts over the sensitivity."""
        return self.comparison.reading / self.scale

    @property
    def shown_velocity(self) -> Array:
        """The integral of `shown_acceleration`, m/s."""
        return self.comparison.integrated / self.scale

    @property
    def every(self) -> slice:
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
        end, as_acceleration = self.written_histories, self.shown_acceleration[self.every]
        return [
            Column.of("time", end.time, MICROSECONDS),
            Column.of("reference acceleration", end.reference_acceleration, ACCELERATION),
            Column("reading", end.reading, self.unit),
            Column.of("reading as acceleration", as_acceleration, ACCELERATION),
            Column.of("difference", as_acceleration - end.reference_acceleration, ACCELERATION),
            Column("reference velocity", end.reference_velocity, "m/s"),
            Column("reading integrated", self.shown_velocity[self.every], "m/s"),
            Column("end velocity by both waves", end.velocity_by_both_waves, "m/s"),
        ]

    @functools.cached_property
    def arrays(self) -> LabelledArrays:
        """The histories with units."""
        end = self.written_histories
        variables = {
            name: quantity("time", getattr(end, name), declared.quantity.within(self.given_units).si, declared.meaning)
            for name, declared in declarations(EndHistories).items()
        }
        integrated, force = self.shown_velocity[self.every], self.comparison.motion.force[self.every]
        variables |= {
            "integrated_reading": quantity("time", integrated, "m/s", "reading as acceleration, integrated"),
            "end_force": quantity("time", force, "N", "force of the bar on what stands on its end"),
            "velocity_by_both_waves": variables.pop("velocity_by_both_waves"),
        }
        return LabelledArrays.of(variables, {"time": variables.pop("time")}, self.attributes())


@declare.dataclass
class EchoSolution(Outcome):
    """A bar calibrated by its echoes; ``bar`` as stated."""

    data_file: ClassVar[str] = "echoes.nc"

    bar: Bar

    @declare.phrase("bar speed", headline="bar speed")
    def speed_words(self) -> str:
        """Return the bar speed with its standard error."""
        return self._fitted("speed")

    echoes: Echoes = declare.part(Echoes, "what was found", inline=True, headline="first")

    @declare.phrase("length", headline="length")
    def length_words(self) -> str:
        """Return the length with its standard error, where it was not given."""
        return self._fitted("length")

    @declare.phrase("attenuation", headline="attenuation")
    def attenuation_words(self) -> str:
        """Return the attenuation with its standard error."""
        return self._fitted("attenuation")

    def _fitted(self, name: str) -> str:
        """Return a value by least squares as text with its standard error."""
        fitted, (si, usual, _, _, digits, *_) = getattr(self.echoes, name), declarations(Echoes)[name].quantity
        error = "" if math.isnan(fitted.error) else f" ± {with_unit(fitted.error, si, usual, 2)}"
        return with_unit(fitted.value, si, usual, digits) + error

    def preview(self) -> Curve:
        """Return the strain at the gauge."""
        trace = self.echoes.quiet.trace
        return history_curve(trace.time, trace.strain, *RATIO.units, "strain at the gauge")

    def tables(self) -> dict[str, str]:
        """Return speed and attenuation over frequency as CSV text."""
        return {"echoes.csv": csv_table(self.columns(), HISTORY_DIGITS)}

    @declare.computed(declare.table("speed and attenuation over frequency"))
    def histories(self) -> list[Column]:
        """Speed and attenuation over frequency."""
        echoes = self.echoes
        return [
            Column.of("frequency", echoes.frequency, KILOHERTZ),
            Column.of("phase speed", echoes.phase_speed, VELOCITY),
            Column.of("standard error of phase speed", echoes.phase_speed_error, VELOCITY),
            Column(echoes.theory, echoes.theory_speed, "m/s"),
            Column("attenuation", echoes.losses, "1/m", shown="1/m"),
            Column("standard error of attenuation", echoes.losses_error, "1/m"),
        ]

    @functools.cached_property
    def arrays(self) -> LabelledArrays:
        """Speed and attenuation over frequency, and the trace, with units."""
        echoes, trace = self.echoes, self.echoes.quiet.trace
        variables = {
            "phase_speed": quantity("frequency", echoes.phase_speed, "m/s", "phase speed by the echoes"),
            "phase_speed_error": quantity("frequency", echoes.phase_speed_error, "m/s", "its standard error"),
            "theory_speed": quantity("frequency", echoes.theory_speed, "m/s", f"phase speed, {echoes.theory}"),
            "attenuation": quantity("frequency", echoes.losses, "1/m", "attenuation over a round trip"),
            "attenuation_error": quantity("frequency", echoes.losses_error, "1/m", "its standard error"),
            "strain": quantity("time", trace.strain, "1", "strain at the gauge, first pulse positive"),
        }
        coordinates = {
            "frequency": quantity("frequency", echoes.frequency, "Hz", "frequency"),
            "time": quantity("time", trace.time, "s", "time of the record"),
        }
        return LabelledArrays.of(variables, coordinates, self.attributes())
