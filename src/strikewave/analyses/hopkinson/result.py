"""What a split-Hopkinson shot gave: curves, checks, tables, files."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.hopkinson.outcome import Outcome
from strikewave.analyses.hopkinson.setup_file import HopkinsonCase, values_of
from strikewave.base.json_document import without
from strikewave.base.variables import LabelledArrays, quantity
from strikewave.hopkinson.bars import BarMaterial, StrikerBar
from strikewave.hopkinson.checks import Energy, Equilibrium, Momentum, Slope, StrikerCheck, rise_slopes
from strikewave.hopkinson.pulses import Pulses
from strikewave.hopkinson.reduction import ANALYSES, Reduction, StressStrainCurve
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.numbers import axis_unit, percent, with_unit
from strikewave.reporting.shown_result import Curve

Array = NDArray[np.float64]

_KEYS = {
    "s": "time onset begin end rise width starts window late_onset late_balance applied duration duration_expected",
    "1": "plateau noise misfit force_ratio share closure mismatch strain strain_expected",
    "Pa": "modulus stress rise_slope",
    "kg/m^3": "density",
    "m/s": "speed",
    "1/s": "rate",
    "Hz": "band",
    "N s": "momentum",
    "J": "energy",
}
UNITS = {key: unit for unit, keys in _KEYS.items() for key in keys.split()}
"""Unit of each key of the JSON document; a table has one unit where it is named alone."""


@dataclass(frozen=True, kw_only=True)
class HopkinsonSolution(Outcome):
    """A reduced shot.

    Attributes
    ----------
    pulses : Pulses
        As found at the gauges.
    reduction : Reduction
        Waves, forces and velocities at the specimen.
    equilibrium, momentum, energy : Equilibrium, Momentum, Energy
        The checks.
    striker, striker_check : StrikerBar, StrikerCheck or None
        Where a striker is stated.
    constants : dict
        Which of density, modulus and speed of each bar is derived.
    """

    data_file: ClassVar[str] = "reduction.nc"
    is_history: ClassVar[bool] = True

    pulses: Pulses = field(repr=False)
    reduction: Reduction = field(repr=False)
    equilibrium: Equilibrium = field(repr=False)
    momentum: Momentum
    energy: Energy
    striker: StrikerBar | None
    striker_check: StrikerCheck | None
    constants: Mapping[str, BarMaterial]

    @property
    def curve(self) -> StressStrainCurve:
        """The engineering curve by the analysis of the set-up."""
        return self.reduction.curve(self.case.setup.solver.analysis)

    def slopes(self) -> dict[str, Slope]:
        """Return the slope of the rise by each analysis, and how far a sample of misalignment moves it."""
        return {name: rise_slopes(self.reduction, name) for name in ANALYSES}

    def summary(self) -> dict[str, float]:
        """Return the largest values of the true curve while the incident wave lasts, and the median true rate."""
        true, on = self.curve.true(), self.reduction.loading
        return {
            "strain": float(true.strain[on].max()),
            "stress": float(true.stress[on].max()),
            "rate": float(np.median(true.rate[on])),
        }

    def units(self) -> dict[str, str]:
        """Return the unit of each key of the JSON document."""
        return UNITS

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head."""
        waves, pulses, setup = self.reduction.waves, self.pulses, self.case.setup
        alike = without(self.equilibrium._asdict(), "ratio")
        names = ("reflected", "transmitted")
        curves = {name: self.reduction.curve(name)._asdict() for name in ANALYSES}
        return {
            "setup": setup.name,
            "inputs": inputs(self.case),
            "bars": {name: constants._asdict() for name, constants in self.constants.items()},
            "pulses": {
                "onset": pulses.onset,
                "end": pulses.end,
                "rise": pulses.rise,
                "width": pulses.width,
                "plateau": pulses.plateau,
                "starts": pulses.starts,
                "noise": waves.noise,
            },
            "alignment": {
                "method": waves.method,
                "dispersion": waves.theory,
                "band": waves.band,
                "window": waves.window,
                "late_onset": dict(zip(names, waves.late_onset, strict=True)),
                "late_balance": dict(zip(names, waves.late_balance, strict=True)),
                "applied": dict(zip(names, waves.applied, strict=True)),
            },
            "equilibrium": alike,
            "momentum": self.momentum._asdict(),
            "energy": self.energy._asdict(),
            "striker": None if self.striker_check is None else self.striker_check._asdict(),
            "rise_slope": {name: slope._asdict() for name, slope in self.slopes().items()},
            "largest_true": self.summary(),
            "analysis": setup.solver.analysis,
            "time": self.reduction.time,
            "curves": {name: without(curve, "time") for name, curve in curves.items()},
        }

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
        curves = [r.curve(name) for name in ANALYSES]
        for kind, shown in (("engineering", curves), ("true", [curve.true() for curve in curves])):
            for part, unit in (("strain", "1"), ("stress", "Pa"), ("rate", "1/s")):
                rows = np.array([getattr(curve, part) for curve in shown])
                variables[f"{kind}_{part}"] = quantity(("analysis", "time"), rows, unit, f"{kind} {part}, compression")
        coordinates = {
            "time": quantity("time", r.time, "s", "time after the incident wave comes to the specimen"),
            "analysis": ("analysis", np.array(ANALYSES, dtype=object)),
        }
        return LabelledArrays.of(variables, coordinates, self.attributes())

    def highlights(self) -> list[tuple[str, str]]:
        """Return the largest true stress and strain, the rate, and by how much forces and impulses miss each other."""
        largest = self.summary()
        side = "missing" if self.momentum.closure >= 0.0 else "in excess"
        return [
            ("largest true stress", with_unit(largest["stress"], "Pa", "MPa")),
            ("largest true strain", percent(largest["strain"], 2)),
            ("median true rate", f"{largest['rate']:.0f} 1/s"),
            ("force difference", percent(self.equilibrium.misfit, 1)),
            (f"impulse {side}", percent(abs(self.momentum.closure), 2)),
        ]

    def preview(self) -> Curve:
        """Return true stress over true strain while the incident wave lasts."""
        true, on = self.curve.true(), self.reduction.loading
        size, name = axis_unit("Pa", "MPa")
        return Curve(true.strain[on], true.stress[on] / size, "true strain", f"true stress ({name})")

    def tables(self) -> dict[str, str]:
        """Return the histories at the specimen and the pulses at the gauges as CSV text."""
        return {"reduction.csv": csv_table(self.columns(), HISTORY_DIGITS), "pulses.csv": self.pulses_table()}

    def columns(self) -> list[Column]:
        """Return the histories at the specimen, with the curve of the chosen analysis."""
        r, w, engineering = self.reduction, self.reduction.waves, self.curve
        true = engineering.true()
        return [
            Column("time", r.time, "s"),
            Column("incident strain", w.incident, "1"),
            Column("reflected strain", w.reflected, "1"),
            Column("transmitted strain", w.transmitted, "1"),
            Column("force 1", r.first_force, "N"),
            Column("force 2", r.second_force, "N"),
            Column("velocity 1", r.first_velocity, "m/s"),
            Column("velocity 2", r.second_velocity, "m/s"),
            Column("engineering strain", engineering.strain, "1"),
            Column("engineering stress", engineering.stress, "Pa"),
            Column("engineering rate", engineering.rate, "1/s"),
            Column("true strain", true.strain, "1"),
            Column("true stress", true.stress, "Pa"),
            Column("true rate", true.rate, "1/s"),
        ]

    def brief(self) -> dict[str, str]:
        """Return the time, the curve of the chosen analysis, and the forces on both faces of the specimen."""
        curve = {"true strain": "1", "true stress": "MPa", "true rate": "1/s"}
        return {"time": "us", **curve, "force 1": "kN", "force 2": "kN"}

    def pulses_table(self) -> str:
        """Return the three pulses as the gauges saw them, each with its own time, as CSV text."""
        pulses = self.pulses
        columns: list[Column] = []
        parts = (pulses.incident, pulses.reflected, pulses.transmitted)
        for name, start, values in zip(("incident", "reflected", "transmitted"), pulses.starts, parts, strict=True):
            columns.append(Column(f"{name} time", start + pulses.step * np.arange(values.size), "s"))
            columns.append(Column(f"{name} strain", values, "1"))
        return csv_table(columns, HISTORY_DIGITS)


def inputs(case: HopkinsonCase) -> dict[str, dict[str, Any]]:
    """Return every quantity of a set-up by its path, with provenance."""
    return {
        path: {"value": value.si, "typed": value.typed, "provenance": value.provenance, "note": value.note}
        for path, value in values_of(case.setup)
    }
