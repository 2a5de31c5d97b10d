"""What the calibration of a bar by its echoes gave: table, files."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from strikewave._version import __version__
from strikewave.dataset import quantity
from strikewave.documents import head, plain, without
from strikewave.hopkinson.bars import Bar
from strikewave.hopkinson.echoes import Echoes
from strikewave.solution import Notice
from strikewave.split_bar.reading import SplitBarCase
from strikewave.split_bar.solution import SCHEMA, csv_text, inputs

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


@dataclass(frozen=True)
class EchoSolution:
    """A bar calibrated by its echoes.

    Attributes
    ----------
    case : SplitBarCase
        Set-up, its text, its folder.
    bar : Bar
        As stated.
    echoes : Echoes
        What was found.
    digests : mapping
        SHA-256 of the file, by its name.
    warnings : tuple of Notice
        What to know.
    citations : tuple of str
        Keys of the sources.
    """

    case: SplitBarCase
    bar: Bar
    echoes: Echoes = field(repr=False)
    digests: Mapping[str, str]
    warnings: tuple[Notice, ...]
    citations: tuple[str, ...]

    @property
    def title(self) -> str:
        """The title of the set-up."""
        return self.case.setup.title or self.case.setup.name

    @property
    def broken(self) -> bool:
        """Whether a stated limit was broken."""
        return any(notice.broken for notice in self.warnings)

    @property
    def difference(self) -> float:
        """Speed found over the stated one, less 1."""
        return self.echoes.speed.value / self.bar.speed - 1.0

    def document(self) -> dict[str, Any]:
        """Return the JSON document."""
        found = self.echoes
        return plain(
            {
                **head(UNITS, [without(dataclasses.asdict(n), "broken") for n in self.warnings]),
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
        )

    def table(self) -> str:
        """Return speed and attenuation over frequency as CSV text."""
        found = self.echoes
        return csv_text(
            {
                "frequency [Hz]": found.frequency,
                "phase speed [m/s]": found.phase_speed,
                "standard error [m/s]": found.phase_speed_error,
                f"{found.theory} [m/s]": found.theory_speed,
                "attenuation [1/m]": found.losses,
                "standard error [1/m]": found.losses_error,
            }
        )

    def dataset(self) -> xarray.Dataset:
        """Return speed and attenuation over frequency, and the trace, with units."""
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
        attributes = {"strikewave_schema": SCHEMA, "strikewave_version": __version__, "case": self.case.text}
        return xarray.Dataset(variables, coordinates, attributes)

    def save(self, path: Path) -> None:
        """Write speed and attenuation over frequency as NetCDF."""
        self.dataset().to_netcdf(path, engine="h5netcdf")
