"""What the calibration of a bar by its echoes gave: table, files."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

from strikewave.analyses.hopkinson.outcome import Outcome, csv_text
from strikewave.analyses.hopkinson.result import inputs
from strikewave.base.variables import quantity
from strikewave.hopkinson.bars import Bar
from strikewave.hopkinson.echoes import Echoes

if TYPE_CHECKING:
    import xarray

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
        found = self.echoes
        return {
            "setup": self.case.setup.name,
            "inputs": inputs(self.case),
            "passes": found.times,
            "first_pass": found.first,
            "window": found.window,
            "speed": {**found.speed._asdict(), "student": found.speed.student},
            "stated_speed": self.bar.speed,
            "difference": self.difference,
            "length": found.length._asdict(),
            "round_trip": found.round_trip._asdict(),
            "attenuation": found.attenuation._asdict(),
            "odd_pass": None if found.odd is None else found.odd._asdict(),
            "other_way": found.other_way.speed,
            "dispersion": found.theory,
            "frequency": found.frequency,
            "phase_speed": found.phase_speed,
            "phase_speed_error": found.phase_speed_error,
            "theory_speed": found.theory_speed,
            "losses": found.losses,
            "losses_error": found.losses_error,
        }

    def tables(self) -> dict[str, str]:
        """Return speed and attenuation over frequency as CSV text."""
        found = self.echoes
        table = csv_text(
            {
                "frequency [Hz]": found.frequency,
                "phase speed [m/s]": found.phase_speed,
                "standard error [m/s]": found.phase_speed_error,
                f"{found.theory} [m/s]": found.theory_speed,
                "attenuation [1/m]": found.losses,
                "standard error [1/m]": found.losses_error,
            }
        )
        return {"echoes.csv": table}

    @functools.cached_property
    def data(self) -> xarray.Dataset:
        """Speed and attenuation over frequency, and the trace, with units."""
        import xarray

        found, trace = self.echoes, self.echoes.quiet.trace
        variables = {
            "phase_speed": quantity("frequency", found.phase_speed, "m/s", "phase speed by the echoes"),
            "phase_speed_error": quantity("frequency", found.phase_speed_error, "m/s", "its standard error"),
            "theory_speed": quantity("frequency", found.theory_speed, "m/s", f"phase speed, {found.theory}"),
            "attenuation": quantity("frequency", found.losses, "1/m", "attenuation over a round trip"),
            "attenuation_error": quantity("frequency", found.losses_error, "1/m", "its standard error"),
            "strain": quantity("time", trace.strain, "1", "strain at the gauge, first pulse positive"),
        }
        coordinates = {
            "frequency": quantity("frequency", found.frequency, "Hz", "frequency"),
            "time": quantity("time", trace.time, "s", "time of the record"),
        }
        return xarray.Dataset(variables, coordinates, self.attributes())
