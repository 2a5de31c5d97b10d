"""Shock response spectra of a record as a command: read, compute, print, draw."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from strikewave.base.errors import InputError
from strikewave.base.result import Notice, Source
from strikewave.records import ChannelReading, Options
from strikewave.reporting import measured_files as measured
from strikewave.reporting.columns import Column, csv_table
from strikewave.reporting.layout import KEY, numerals
from strikewave.reporting.numbers import axis_unit, listed, with_unit
from strikewave.reporting.options import Output, Typed
from strikewave.reporting.run_and_write import Command, run_and_write
from strikewave.reporting.shown_result import Curve
from strikewave.reporting.terminal import number, say, significant, table, tell
from strikewave.signal.srs import Scope, Spectrum, octaves, srs

KIND_UNITS = {"absolute": "m/s^2", "displacement": "m", "pseudo-velocity": "m/s"}
"""Kinds of spectrum, with their SI unit for an acceleration."""
SHOWN_UNITS = {"absolute": "g", "displacement": "mm", "pseudo-velocity": "m/s"}
"""The units in which they are shown on the screen."""
HIGHEST = 100e3
"""Highest natural frequency by default, Hz. Chosen: ten times that of usual spectra of pyroshock (10 kHz in Irvine, An
Introduction to the Shock Response Spectrum, 2012, figure 2), so that blows of 10 us are shown."""
OF_SAMPLING = 0.4
"""Highest natural frequency by default, over the sampling rate: nearer to half of it a record holds little, and its
filter has taken some."""
MOST_FREQUENCIES = 1e5
"""More frequencies are refused. Chosen: no screen shows finer steps, and each takes a pass over the record."""
SHOWN_ROWS = 24
"""Rows of the table on the screen, which it shows at once; the files have all."""


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


def compute_spectra(
    file: str, wanted: SpectrumRequest, stated: dict[str, dict[str, Any]], options: Options, output: Output
) -> int:
    """Compute the spectra of a file, write and print them, and return the exit code.

    Raises
    ------
    InputError
        If the file, a frequency or the end of the shock cannot be used.
    """
    name = Path(file).stem
    usual = f"srs-{name}"
    origin = measured.source_of("records", name, [Path(file)] if output.writes(usual) else [], output.stated_test())
    return run_and_write(SrsCommand(file, wanted, stated, options, origin), output, usual, origin.text)


@dataclass(frozen=True)
class SrsCommand(Command[SpectrumResult]):
    """The spectra of one channel of a file."""

    indent: ClassVar[int | None] = None

    file: str
    wanted: SpectrumRequest
    stated: dict[str, dict[str, Any]]
    options: Options
    origin: Source

    def solve(self) -> SpectrumResult:
        """Return the spectra, the baseline of the record taken off."""
        wanted = self.wanted
        reading = measured.examined_channel(self.file, self.stated, self.options, "spectrum", "the spectrum")
        frequencies = _frequencies(wanted.frequencies, wanted.grid, reading.channel.sampling_rate)
        scope = _scope(wanted.part, wanted.end, reading)
        spectra = [spectrum_of(reading, kind, frequencies, wanted.q, scope) for kind in wanted.kinds]
        return SpectrumResult(
            self.file,
            reading,
            spectra,
            wanted.side,
            scope,
            origin=self.origin,
            notices=_notices(reading),
        )

    def summary(self, result: SpectrumResult) -> str:
        """Say where each spectrum is largest."""
        return spectrum_words(result)

    def show(self, result: SpectrumResult) -> None:
        """Print every so many of the frequencies."""
        _print(result)

    def draw(self, result: SpectrumResult, folder: Path) -> list[str]:
        """Write the spectra, and the four-coordinate picture."""
        from strikewave.analyses.record.figures.spectra import srs_figure, tripartite
        from strikewave.reporting.style import save, titled

        pictures = {
            "summary.svg": srs_figure(result.spectra[0], unit=result.reading.channel.unit),
            "tripartite.svg": tripartite(result.velocity),
        }
        for name, figure in pictures.items():
            save(titled(figure, result.title), folder / name)
        return list(pictures)


def _notices(reading: ChannelReading) -> tuple[Notice, ...]:
    """Return what harms the spectrum, or leaves its unit open."""
    unit = ("unit-unknown", "not-calibrated")
    return tuple(found.notice for found in reading.findings if "spectrum" in found.harms or found.code in unit)


def _frequencies(given: list[Typed] | None, grid: tuple[float, Typed | None, float], rate: float) -> Any:
    if given:
        return [_below(frequency, "--frequency", rate) for frequency in given]
    low, asked, per_octave = grid
    high = min(HIGHEST, OF_SAMPLING * rate) if asked is None else _below(asked, "--to", rate)
    if not low < high:
        got = f"{high:g} Hz" if asked is None else asked.word
        raise InputError("--to", got, f"a frequency above --from, {low:g} Hz")
    if per_octave * math.log2(high / low) > MOST_FREQUENCIES:
        raise InputError("--per-octave", per_octave, "at most 100 000 frequencies")
    return octaves(low, high, per_octave)


def _below(frequency: Typed, field: str, rate: float) -> float:
    if frequency >= 0.5 * rate:
        allowed = f"a frequency below half the sampling rate, {0.5 * rate:g} Hz"
        raise InputError(field, frequency.word, allowed, "the record holds nothing above; sample faster")
    return frequency


def _scope(part: str, end: Typed | None, reading: ChannelReading) -> Scope:
    if end is None and part != "total" and reading.pulses:
        last = reading.pulses[-1].end
        say(f"the shock is taken to end with its last blow, at {last:.6g} s (--end)")
        return Scope(part, max(last - reading.channel.start, 2.0 * reading.channel.step))
    if end is None:
        return Scope(part)
    after = end - reading.channel.start
    if not reading.channel.step < after <= reading.channel.duration:
        last = reading.channel.start + reading.channel.duration
        raise InputError("--end", end.word, f"a time from {reading.channel.start:g} s to {last:g} s")
    return Scope(part, after)


def _units(kind: str, in_g: bool) -> tuple[str, str]:
    """Return SI unit and shown unit of a spectrum; the same one where the record is no acceleration."""
    return KIND_UNITS[kind], SHOWN_UNITS[kind] if in_g else KIND_UNITS[kind]


def spectrum_words(result: SpectrumResult) -> str:
    """Say in words where each spectrum is largest."""
    in_g, peaks = result.reading.channel.unit == "m/s^2", list[str]()
    for spectrum in result.spectra:
        values, (si, unit) = spectrum.side(result.side), _units(spectrum.kind, in_g)
        place = int(np.argmax(np.abs(values)))
        largest = with_unit(float(values[place]), si, unit) if in_g else significant(float(values[place]), 4)
        where = with_unit(float(spectrum.frequency[place]), "Hz", "Hz")
        peaks.append(f"{'' if peaks else 'largest '}{spectrum.kind} response {largest} at {where}")
    return f"{result.title}: {listed(peaks)}, of {len(result.spectra[0].frequency)} frequencies."


def _print(result: SpectrumResult) -> None:
    reading, spectra, side = result.reading, result.spectra, result.side
    first = spectra[0]
    step = max(len(first.frequency) // SHOWN_ROWS, 1)
    shown = range(0, len(first.frequency), step)
    in_g = reading.channel.unit == "m/s^2"
    columns = [*numerals("frequency (Hz)", priority=KEY)]
    columns += numerals(*(f"{s.kind} ({SHOWN_UNITS[s.kind] if in_g else 'own'})" for s in spectra))
    rows = [
        [significant(float(first.frequency[k]), 4)]
        + [number(float(s.side(side)[k]), *_units(s.kind, in_g)) for s in spectra]
        for k in shown
    ]
    q = "undamped" if math.isinf(first.q) else f"Q = {first.q:g}"
    title = f"Shock response spectrum of {Path(result.file).name}, {reading.channel.name}: {q}, {side}, {first.part}"
    table(title, columns, rows)
    if step > 1:
        tell(f"every {step}th of {len(first.frequency)} frequencies; --json or spectrum.csv has them all")
