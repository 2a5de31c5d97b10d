"""What a split-Hopkinson shot gave: curves, checks, tables, files."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.hopkinson.outcome import Outcome
from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, MORE, Quantity
from strikewave.base.shock_quantities import (
    ENERGY,
    FORCE,
    KILOHERTZ,
    MEASURED_IMPULSE,
    MICROSECONDS,
    MICROSTRAIN,
    RATIO,
    SHARE,
    STRESS,
)
from strikewave.base.variables import LabelledArrays, quantity
from strikewave.hopkinson.bars import BarMaterial, StrikerBar
from strikewave.hopkinson.checks import RISE_SLOPE, Energy, Equilibrium, Momentum, Slope, StrikerCheck, rise_slopes
from strikewave.hopkinson.pulses import Pulses
from strikewave.hopkinson.reduction import ANALYSES, Analysis, Reduction, StressStrainCurve
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.numbers import axis_unit, shown
from strikewave.reporting.parts import NONE, written
from strikewave.reporting.shown_result import Curve

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
    """How late a wave is at the specimen against geometry."""

    wave: str = declare.word("which wave", column=KEY)
    onset: float = declare.number(DELAY, "by its onset", label="by onset", column=MAIN)
    balance: float = declare.number(DELAY, "by the balance of forces", label="by balance", column=MAIN)
    applied: float = declare.number(DELAY, "how far it was moved", label="applied shift", column=MAIN)


@declare.dataclass
class Alignment:
    """How the waves were brought to one clock at the specimen."""

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
        """Return those of a curve while the load is on."""
        return cls(float(true.strain[on].max()), float(true.stress[on].max()), float(np.median(true.rate[on])))


@declare.dataclass
class AnalysedCurve:
    """What an analysis makes of the specimen."""

    analysis: str = declare.word("1-wave, 2-wave or 3-wave", column=KEY)
    largest: LargestTrue = declare.part(LargestTrue, "largest values")
    slope: str = declare.word("slope of the rise, and how far misalignment moves it", quantity=RISE_SLOPE, column=MAIN)


@declare.dataclass
class HopkinsonSolution(Outcome):
    """A reduced shot.

    Attributes
    ----------
    reduction : Reduction
        Waves, forces and velocities at the specimen.
    striker : StrikerBar or None
        Where one is stated.
    constants : dict
        Which of density, modulus and speed of each bar is derived.
    """

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
        """How the waves were brought to one clock at the specimen."""
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
        """What each analysis makes of the specimen; a star marks the one chosen."""
        curves = self.curves.items()
        return [
            AnalysedCurve(
                name + (" *" if name == self.analysis else ""),
                LargestTrue.of(curve.true(), self.reduction.loading),
                slope_text(self.rise_slope[name]),
            )
            for name, curve in curves
        ]

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
        """Return the histories at the specimen and the pulses at the gauges as CSV text."""
        return {"reduction.csv": csv_table(self.columns(), HISTORY_DIGITS), "pulses.csv": self.pulses_table()}

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

    def pulses_table(self) -> str:
        """Return the three pulses as the gauges saw them, each with its own time, as CSV text."""
        pulses = self.pulses
        columns: list[Column] = []
        parts = (pulses.incident, pulses.reflected, pulses.transmitted)
        for name, start, values in zip(("incident", "reflected", "transmitted"), pulses.starts, parts, strict=True):
            columns.append(Column(f"{name} time", start + pulses.step * np.arange(values.size), "s"))
            columns.append(Column(f"{name} strain", values, "1"))
        return csv_table(columns, HISTORY_DIGITS)


def slope_text(slope: Slope) -> str:
    """Write a slope with the values between which a sample of misalignment moves it."""
    if math.isnan(slope.value):
        return NONE
    ends = (slope.value, slope.low, slope.high)
    value, low, high = (written(shown(one, *RISE_SLOPE.units), RISE_SLOPE.digits) for one in ends)
    if math.isnan(slope.low):
        return value
    return f"{value} ({low} or more)" if math.isinf(slope.high) else f"{value} ({low} to {high})"
