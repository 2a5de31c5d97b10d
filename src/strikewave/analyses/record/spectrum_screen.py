"""Shock response spectra of a record as a command: read, compute, print, draw."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from strikewave.analyses.record.spectrum import KIND_UNITS, SHOWN_UNITS, SpectrumRequest, SpectrumResult, spectrum_of
from strikewave.base.errors import InputError
from strikewave.base.result import Notice, Source
from strikewave.records import ChannelReading, Options
from strikewave.reporting import measured_files as measured
from strikewave.reporting.layout import KEY, numerals
from strikewave.reporting.numbers import headed
from strikewave.reporting.options import Output, Typed
from strikewave.reporting.run_and_write import Command, run_and_write
from strikewave.reporting.terminal import number, say, table, tell
from strikewave.signal.srs import Scope, octaves

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
        """Say where the spectrum is largest."""
        from strikewave.analyses.record.spectrum_report import spectrum_words

        return spectrum_words(result)

    def show(self, result: SpectrumResult) -> None:
        """Print every so many of the frequencies."""
        _print(result)

    def draw(self, result: SpectrumResult, folder: Path) -> list[str]:
        """Write the page, the spectra, and the four-coordinate picture."""
        from strikewave.analyses.record.figures.spectra import srs_figure, tripartite
        from strikewave.analyses.record.spectrum_report import spectrum_report
        from strikewave.reporting.style import save, titled

        pictures = {
            "summary.svg": srs_figure(result.spectra[0], unit=result.reading.channel.unit),
            "tripartite.svg": tripartite(result.velocity),
        }
        for name, figure in pictures.items():
            save(titled(figure, result.title), folder / name)
        (folder / "report.html").write_text(spectrum_report(result), "utf-8", newline="\n")
        return ["report.html", *pictures]


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


def _print(result: SpectrumResult) -> None:
    reading, spectra, side = result.reading, result.spectra, result.side
    first = spectra[0]
    step = max(len(first.frequency) // SHOWN_ROWS, 1)
    shown = range(0, len(first.frequency), step)
    in_g = reading.channel.unit == "m/s^2"
    columns = numerals(headed("frequency", "Hz", "Hz"), priority=KEY)
    columns += numerals(*(headed(s.kind, *_units(s.kind, in_g)) if in_g else f"{s.kind} (own)" for s in spectra))
    rows = [
        [number(float(first.frequency[k]), "Hz", "Hz")]
        + [number(float(s.side(side)[k]), *_units(s.kind, in_g)) for s in spectra]
        for k in shown
    ]
    q = "undamped" if math.isinf(first.q) else f"Q = {first.q:g}"
    title = f"Shock response spectrum of {Path(result.file).name}, {reading.channel.name}: {q}, {side}, {first.part}"
    table(title, columns, rows)
    if step > 1:
        tell(f"every {step}th of {len(first.frequency)} frequencies; --json or spectrum.csv has them all")
