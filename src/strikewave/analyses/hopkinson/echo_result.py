"""What the calibration of a bar by its echoes gave: table, files."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, field
from typing import Any, ClassVar

from strikewave.analyses.hopkinson.outcome import Outcome
from strikewave.analyses.hopkinson.result import inputs
from strikewave.base.variables import LabelledArrays, quantity
from strikewave.hopkinson.bars import Bar
from strikewave.hopkinson.echoes import Echoes
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.numbers import percent, with_unit
from strikewave.reporting.shown_result import Curve, history_curve

_KEYS = {
    "s": "passes window late",
    "m/s": "speed other_way stated_speed phase_speed phase_speed_error theory_speed",
    "m": "length round_trip",
    "1/m": "attenuation losses losses_error",
    "Hz": "frequency",
    "1": "difference strength",
}
UNITS = {key: unit for unit, keys in _KEYS.items() for key in keys.split()}
"""Unit of each key of the JSON document."""


@dataclass(frozen=True, kw_only=True)
class EchoSolution(Outcome):
    """A bar calibrated by its echoes.

    Attributes
    ----------
    bar : Bar
        As stated.
    echoes : Echoes
        What was found.
    """

    data_file: ClassVar[str] = "echoes.nc"
    is_history: ClassVar[bool] = True

    bar: Bar
    echoes: Echoes = field(repr=False)

    @property
    def difference(self) -> float:
        """Speed found over the stated one, less 1."""
        return self.echoes.speed.value / self.bar.speed - 1.0

    def units(self) -> dict[str, str]:
        """Return the unit of each key of the JSON document."""
        return UNITS

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head."""
        echoes = self.echoes
        return {
            "setup": self.case.setup.name,
            "inputs": inputs(self.case),
            "passes": echoes.times,
            "first_pass": echoes.first,
            "window": echoes.window,
            "speed": {**echoes.speed._asdict(), "student": echoes.speed.student},
            "stated_speed": self.bar.speed,
            "difference": self.difference,
            "length": echoes.length._asdict(),
            "round_trip": echoes.round_trip._asdict(),
            "attenuation": echoes.attenuation._asdict(),
            "odd_pass": None if echoes.odd is None else echoes.odd._asdict(),
            "other_way": echoes.other_way.speed,
            "dispersion": echoes.theory,
            "frequency": echoes.frequency,
            "phase_speed": echoes.phase_speed,
            "phase_speed_error": echoes.phase_speed_error,
            "theory_speed": echoes.theory_speed,
            "losses": echoes.losses,
            "losses_error": echoes.losses_error,
        }

    def highlights(self) -> list[tuple[str, str]]:
        """Return the bar speed with its standard error and its difference from the stated one, and the length."""
        speed, error = self.echoes.speed.value, self.echoes.speed.error
        return [
            ("bar speed", f"{speed:.5g} m/s" + ("" if math.isnan(error) else f" ± {error:.2g} m/s")),
            ("off the stated one", percent(self.difference, 2, "+")),
            ("length", with_unit(self.echoes.length.value, "m", "mm", 5)),
            ("attenuation", f"{self.echoes.attenuation.value:.3g} 1/m"),
        ]

    def preview(self) -> Curve:
        """Return the strain at the gauge."""
        trace = self.echoes.quiet.trace
        return history_curve(trace.time, trace.strain, "1", "1", "strain at the gauge")

    def tables(self) -> dict[str, str]:
        """Return speed and attenuation over frequency as CSV text."""
        return {"echoes.csv": csv_table(self.columns(), HISTORY_DIGITS)}

    def columns(self) -> list[Column]:
        """Return speed and attenuation over frequency."""
        echoes = self.echoes
        return [
            Column("frequency", echoes.frequency, "Hz"),
            Column("phase speed", echoes.phase_speed, "m/s"),
            Column("standard error of phase speed", echoes.phase_speed_error, "m/s"),
            Column(echoes.theory, echoes.theory_speed, "m/s"),
            Column("attenuation", echoes.losses, "1/m"),
            Column("standard error of attenuation", echoes.losses_error, "1/m"),
        ]

    def brief(self) -> dict[str, str]:
        """Return frequency, speed with its error, and attenuation."""
        speeds = dict.fromkeys(("phase speed", "standard error of phase speed"), "m/s")
        return {"frequency": "kHz", **speeds, "attenuation": "1/m"}

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
