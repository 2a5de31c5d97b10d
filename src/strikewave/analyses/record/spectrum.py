"""What the spectra of a record are: their frequencies, tables, documents."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from strikewave.records import ChannelReading
from strikewave.reporting import measured_files as measured
from strikewave.reporting.columns import Column, csv_table
from strikewave.reporting.numbers import axis_unit, with_unit
from strikewave.reporting.options import Typed
from strikewave.reporting.shown_result import Curve
from strikewave.signal.srs import Scope, Spectrum, srs

KIND_UNITS = {
    "absolute": "m/s^2",
    "displacement": "m",
    "relative-velocity": "m/s",
    "pseudo-velocity": "m/s",
    "equivalent-static": "m/s^2",
}
"""Kinds of spectrum, with their SI unit for an acceleration."""
SHOWN_UNITS = {kind: {"m/s^2": "g", "m": "mm"}.get(unit, unit) for kind, unit in KIND_UNITS.items()}
"""The units in which they are shown on the screen."""


class SpectrumRequest(NamedTuple):
    """What was asked of the spectra: quality factor, frequencies, kinds, side, part of the shock and its end."""

    q: float
    frequencies: list[Typed] | None
    grid: tuple[float, Typed | None, float]
    kinds: tuple[str, ...]
    side: str
    part: str
    end: Typed | None


@dataclass(frozen=True)
class SpectrumResult(measured.AskedResult):
    """Spectra of one channel of a file; see `Result` for what it shares with others.

    Attributes
    ----------
    file : str
        The measured file.
    reading : ChannelReading
        The channel, examined.
    spectra : list of Spectrum
        One a kind.
    side : str
        maximax, positive or negative.
    scope : Scope
        Which part of the shock.
    """

    command: ClassVar[str] = "srs"

    file: str
    reading: ChannelReading
    spectra: list[Spectrum]
    side: str
    scope: Scope

    @property
    def title(self) -> str:
        """File, channel, and the part of the shock where that is not the whole."""
        part = "" if self.scope.part == "total" else f", {self.scope.part} part"
        return f"{Path(self.file).name}, {self.reading.channel.name}{part}"

    @functools.cached_property
    def velocity(self) -> Spectrum:
        """The spectrum of the pseudo-velocity, which the four-coordinate picture shows; computed where it is drawn."""
        first = next((s for s in self.spectra if s.kind == "pseudo-velocity"), None)
        return first or spectrum_of(
            self.reading, "pseudo-velocity", self.spectra[0].frequency, self.spectra[0].q, self.scope
        )

    def units(self) -> dict[str, str]:
        """Return the unit of each key of the JSON document."""
        has = self.reading.channel.unit or "the file's own numbers"
        of = "" if has == "m/s^2" else f" for a record in m/s^2; this one is in {has}"
        kinds = {spectrum.kind: KIND_UNITS[spectrum.kind] + of for spectrum in self.spectra}
        return {"frequency": "Hz", "q": "1", "zero_line": has, **kinds}

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head."""
        first, reading = self.spectra[0], self.reading
        return {
            "file": self.file,
            "channel": reading.channel.name,
            "status": reading.status,
            "calibration": reading.calibration.stated(),
            "zero_line": reading.baseline,
            "q": first.q if math.isfinite(first.q) else "inf",
            "side": self.side,
            "part": first.part,
            "end": None if self.scope.end is None else self.scope.end + reading.channel.start,
            "frequency": first.frequency,
            **{spectrum.kind: spectrum.side(self.side) for spectrum in self.spectra},
        }

    def highlights(self) -> list[tuple[str, str]]:
        """Return the quality factor, and the largest value of each spectrum with its frequency."""
        first = self.spectra[0]
        numbers = [("Q", "undamped" if math.isinf(first.q) else f"{first.q:g}")]
        for spectrum in self.spectra:
            values = spectrum.side(self.side)
            at = int(np.argmax(values))
            where = with_unit(float(spectrum.frequency[at]), "Hz", "Hz", 3)
            numbers.append((spectrum.kind, f"{with_unit(float(values[at]), *self._shown(spectrum))} at {where}"))
        return numbers

    def preview(self) -> Curve:
        """Return the first spectrum over the logarithm of natural frequency."""
        first = self.spectra[0]
        size, unit = axis_unit(*self._shown(first))
        words = f"{first.kind} ({unit})" if unit not in ("", "1") else first.kind
        return Curve(np.log10(first.frequency), first.side(self.side) / size, "log10 of frequency in Hz", words)

    def _shown(self, spectrum: Spectrum) -> tuple[str, str]:
        """Return SI unit and shown unit of a spectrum; none where the record is no acceleration."""
        if self.reading.channel.unit != "m/s^2":
            return "", ""
        return KIND_UNITS[spectrum.kind], SHOWN_UNITS[spectrum.kind]

    def tables(self) -> dict[str, str]:
        """Return the spectra as CSV text."""
        return {"spectrum.csv": csv_table(self.columns())}

    def columns(self) -> list[Column]:
        """Return the spectra over natural frequency."""
        of = "" if self.reading.channel.unit == "m/s^2" else " for a record in m/s^2"
        columns = [Column("frequency", self.spectra[0].frequency, "Hz")]
        return columns + [Column(f"{s.kind}{of}", s.side(self.side), KIND_UNITS[s.kind]) for s in self.spectra]

    def brief(self) -> dict[str, str]:
        """Return all columns."""
        return {"frequency": "Hz"} | {column.name: self._unit(column.name) for column in self.columns()[1:]}

    def _unit(self, name: str) -> str:
        kind = name.partition(" ")[0]
        return SHOWN_UNITS[kind] if self.reading.channel.unit == "m/s^2" else KIND_UNITS[kind]


def spectrum_of(reading: ChannelReading, kind: str, frequencies: ArrayLike, q: float, scope: Scope) -> Spectrum:
    """Return a spectrum of a channel, its baseline taken off."""
    return srs(reading.channel.values - reading.baseline, reading.channel.step, frequencies, q, kind, scope)
