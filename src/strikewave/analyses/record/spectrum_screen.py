"""Shock response spectra of a record as a command: read, compute, print, draw."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from strikewave.analyses.record.result import name_of
from strikewave.analyses.record.rolling_window import Rolling
from strikewave.analyses.record.spectrum import (
    KIND_UNITS,
    SHOWN_UNITS,
    ShockSpectra,
    SpectrumRequest,
    SpectrumResult,
    response_of,
    rms_of,
    spectrum_of,
)
from strikewave.base.errors import InputError, StrikewaveError
from strikewave.base.result import FAILED, Notice, Source
from strikewave.records import ChannelReading, Options, Request
from strikewave.reporting import measured_files as measured
from strikewave.reporting.layout import KEY, MAIN, MORE, numerals
from strikewave.reporting.numbers import headed
from strikewave.reporting.options import Output, Typed
from strikewave.reporting.run_and_write import Command, run_and_write
from strikewave.reporting.terminal import number, say, table, tell
from strikewave.signal.srs import RollingSpectrum, Scope, octaves, resultant_srs, rolling_srs

HIGHEST = 100e3
"""Highest natural frequency by default, Hz. Chosen: ten times that of usual spectra of pyroshock (10 kHz in Irvine, An
Introduction to the Shock Response Spectrum, 2012, figure 2), so that blows of 10 us are shown."""


OF_SAMPLING = 0.4
"""Highest natural frequency by default, over the sampling rate: nearer to half of it a record holds little, and its
filter has taken some."""


MOST_FREQUENCIES = 1e5
"""More frequencies are refused. Chosen: no screen shows finer steps, and each takes a pass over the record."""


MOST_SHOWN = 4
"""Spectra that a table on the screen lists beside what they come to; the files have all."""


MOST_WINDOWS = 20_000
"""Windows of a rolling spectrum, at most. Chosen: more than the pixels of any screen, and a few GB in JSON."""


CITED = ("smallwood-1981", "iso-18431-4", "piersol-2009", "nist-handbook")
"""What several spectra and their limit follow."""


SAME_STEP = 1e-9
"""Relative difference of steps that are one."""


SHOWN_ROWS = 24
"""Rows of the table on the screen, which it shows at once; the files have all."""


def compute_spectra(
    files: Sequence[str],
    wanted: SpectrumRequest,
    stated: dict[str, dict[str, Any]],
    options: Options,
    output: Output,
    filters: Request,
) -> int:
    """Compute the spectra of files, write and print them, and return the exit code.

    Raises
    ------
    InputError
        If no file, or a frequency, a window or the end of the shock cannot be used.
    """
    files = measured.ordered(files)
    paths = [Path(measured.shown(file)) for file in files]
    name = name_of(paths)
    usual = f"srs-{name}"
    origin = measured.source_of("records", name, paths if output.writes(usual) else [], output.stated_test())
    return run_and_write(SrsCommand(files, wanted, stated, options, origin, filters), output, usual, origin.text)


@dataclass(frozen=True)
class SrsCommand(Command[SpectrumResult]):
    """The spectra of channels of files."""

    indent: ClassVar[int | None] = None

    files: Sequence[str]
    wanted: SpectrumRequest
    stated: dict[str, dict[str, Any]]
    options: Options
    origin: Source
    filters: Request

    def solve(self) -> SpectrumResult:
        """Return the spectra, the baselines of the records taken off."""
        more = self.wanted.options
        if len(self.files) == 1 and len(self.options.channels) < 2 and not more.resultant:
            return self._one()
        for option, typed in (("--rolling", more.rolling), ("--response", more.response), ("--end", self.wanted.end)):
            if typed is not None:
                raise InputError(option, typed.word, "one channel of one file", "name one file, and one --channel")
        if more.resultant:
            return _resultant(self)
        unread: list[Notice] = []
        return _several(self, _readings(self, unread), unread)

    def _one(self) -> SpectrumResult:
        wanted, more = self.wanted, self.wanted.options
        reading = measured.examined_channel(
            self.files[0], self.stated, self.options, "spectrum", "the spectrum", self.filters
        )
        channel = reading.channel
        frequencies = _frequencies(wanted.frequencies, wanted.grid, channel.sampling_rate)
        scope = _scope(wanted.part, wanted.end, more.initial, reading)
        response, rolling = None, None
        if more.response is not None:
            natural = _below(more.response, "--response", channel.sampling_rate)
            response = response_of(reading, wanted.kinds, natural, wanted.q, more.initial)
        if more.rolling is not None:
            rolling = _rolling(reading, wanted, more.rolling, frequencies)
        return SpectrumResult(
            self.files[0],
            reading,
            [spectrum_of(reading, kind, frequencies, wanted.q, scope) for kind in wanted.kinds],
            wanted.side,
            scope,
            _rms(reading, wanted, frequencies),
            response=response,
            rolling=rolling,
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
        from strikewave.analyses.record.drawn import spectrum_picture
        from strikewave.analyses.record.figures.many_spectra import response_figure, rolling_figure
        from strikewave.analyses.record.figures.spectra import tripartite
        from strikewave.analyses.record.spectrum_report import spectrum_report
        from strikewave.reporting.style import save, titled

        pictures = {"summary.svg": spectrum_picture(result), "tripartite.svg": tripartite(result.velocity)}
        if result.shocks:
            del pictures["tripartite.svg"]
        unit = result.reading.channel.unit
        if result.response is not None:
            pictures["response.svg"] = response_figure(result.response.histories, result.response, unit)
        if result.rolling is not None:
            pictures["rolling.svg"] = rolling_figure(result.rolling, result.side, result.spectra[0], unit)
        for name, figure in pictures.items():
            save(figure if name == "summary.svg" else titled(figure, result.title), folder / name)
        (folder / "report.html").write_text(spectrum_report(result), "utf-8", newline="\n")
        return ["report.html", *pictures]


def _rms(reading: ChannelReading, wanted: SpectrumRequest, frequencies: Any) -> dict[str, Any]:
    more = wanted.options
    kinds = wanted.kinds if more.rms else ()
    return {kind: rms_of(reading, kind, frequencies, wanted.q, more.initial) for kind in kinds}


def _rolling(reading: ChannelReading, wanted: SpectrumRequest, rolling: Rolling, frequencies: Any) -> RollingSpectrum:
    """Return the rolling spectrum of the first kind, its times in those of the file."""
    channel = reading.channel
    if wanted.part != "total" or wanted.options.initial != "rest":
        option = "--part" if wanted.part != "total" else "--initial"
        got = wanted.part if wanted.part != "total" else wanted.options.initial
        raise InputError(option, got, "total and from rest with --rolling, each window by itself", "leave it out")
    longest = channel.step * (channel.values.size - 1)
    if not 2.0 * channel.step <= rolling.window <= longest:
        allowed = f"a window from two samples, {2.0 * channel.step:g} s, to the whole record, {longest:g} s"
        raise InputError("--rolling", rolling.word, allowed)
    if not channel.step <= rolling.hop:
        raise InputError("--rolling", rolling.word, f"a hop of one sample, {channel.step:g} s, or more")
    windows = (longest - rolling.window) / rolling.hop + 1.0
    if windows > MOST_WINDOWS:
        raise InputError("--rolling", rolling.word, f"at most {MOST_WINDOWS} windows, not {windows:.0f}", "hop further")
    values = channel.values - reading.baseline
    found = rolling_srs(values, channel.step, frequencies, (rolling.window, rolling.hop), wanted.q, wanted.kinds[0])
    return found._replace(time=found.time + channel.start)


def _readings(command: SrsCommand, unread: list[Notice]) -> Iterator[tuple[str, ChannelReading]]:
    """Yield the wanted channels of all files; those that cannot be read are named, and added to ``unread``.

    Raises
    ------
    StrikewaveError
        If none can be read.
    """
    failed: StrikewaveError | None = None
    some = False
    for file in command.files:
        try:
            _, found = measured.read_channels(file, command.stated, command.options, command.filters)
        except StrikewaveError as error:
            if len(command.files) == 1:
                raise
            failed = failed or error
            unread.append(
                Notice("unreadable", str(error) if file in str(error) else f"{file}: {error}", severity=FAILED)
            )
            say(f"left out: {unread[-1].message}")
            continue
        for reading in found.channels:
            some = True
            yield measured.shown(file), reading
    if not some and failed is not None:
        raise failed


def _several(
    command: SrsCommand, readings: Iterable[tuple[str, ChannelReading]], unread: Sequence[Notice] = ()
) -> SpectrumResult:
    """Return the spectra of all channels and what they come to; one that is bad enters no envelope.

    What could not be read, ``unread``, is known once all ``readings`` are taken.
    """
    wanted = command.wanted
    shocks: list[ShockSpectra] = []
    shown: tuple[str, ChannelReading, Scope] | None = None
    frequencies: Any = None
    notices: dict[str, Notice] = {}
    for file, reading in readings:
        if shown is None:
            frequencies = _frequencies(wanted.frequencies, wanted.grid, reading.channel.sampling_rate)
        elif reading.channel.unit != shown[1].channel.unit:
            allowed = f"channels in the unit of the first, {shown[1].channel.unit or 'unknown'}"
            raise InputError("FILE", f"{reading.channel.name} of {file}, in {reading.channel.unit}", allowed)
        highest = float(np.max(frequencies))
        if highest >= 0.5 * reading.channel.sampling_rate:
            allowed = f"a frequency below half the sampling rate of {file}, {0.5 * reading.channel.sampling_rate:g} Hz"
            raise InputError("--to", f"{highest:g} Hz", allowed, "state a lower one")
        scope = _scope(wanted.part, None, wanted.options.initial, reading)
        spectra = [spectrum_of(reading, kind, frequencies, wanted.q, scope) for kind in wanted.kinds]
        left_out = "" if reading.status != "bad" else next(f.message for f in reading.findings if f.severity == "bad")
        shock = ShockSpectra(
            file,
            reading.channel.name,
            reading.status,
            reading.baseline,
            spectra,
            _rms(reading, wanted, frequencies),
            left_out,
        )
        shocks.append(shock)
        if left_out:
            does = "is bad, and still in the resultant" if wanted.options.resultant else "enters no envelope"
            notices[shock.name] = Notice("left-out", f"{shock.name} {does}: {left_out}")
            say(notices[shock.name].message)
        else:
            notices |= {one.code: one for one in _notices(reading)}
        if shown is None or (shown[1].status == "bad" and not left_out):
            shown = (file, reading, scope)
    if shown is None:
        raise InputError("FILE", "none", "a file with a channel")
    first = next((s for s in shocks if not s.left_out), shocks[0])
    return SpectrumResult(
        *shown[:2],
        first.spectra,
        wanted.side,
        shown[2],
        shocks=shocks,
        origin=command.origin,
        notices=(*notices.values(), *unread),
        citations=CITED,
    )


def _resultant(command: SrsCommand) -> SpectrumResult:
    """Return the spectra of the axes of a file, and that of their vector sum."""
    wanted = command.wanted
    if len(command.files) > 1:
        raise InputError("--resultant", f"{len(command.files)} files", "the channels of one file")
    if wanted.part != "total" or wanted.side != "maximax":
        option, got = ("--part", wanted.part) if wanted.part != "total" else ("--side", wanted.side)
        raise InputError(option, got, "the total maximax with --resultant: a length has no sign", "leave it out")
    readings = list(_readings(command, []))
    axes = [reading for _, reading in readings]
    if len(axes) not in (2, 3):
        got = f"{len(axes)} channel{'s' if len(axes) > 1 else ''}"
        raise InputError("--resultant", got, "2 or 3 perpendicular channels", "name each with --channel")
    first = axes[0].channel
    for other in (reading.channel for reading in axes[1:]):
        if other.values.size != first.values.size or not math.isclose(other.step, first.step, rel_tol=SAME_STEP):
            sizes = [f"{r.channel.name} of {r.channel.values.size}" for r in axes]
            raise InputError("--resultant", ", ".join(sizes) + " samples", "channels sampled together")
        if other.unit != first.unit:
            got = f"{other.name} in {other.unit}"
            raise InputError("--resultant", got, f"channels in the unit of {first.name}, {first.unit or 'unknown'}")
    found = _several(command, readings)
    values = [reading.channel.values - reading.baseline for reading in axes]
    frequencies, initial = found.spectra[0].frequency, wanted.options.initial
    sums = {kind: resultant_srs(values, first.step, frequencies, wanted.q, kind, initial) for kind in wanted.kinds}
    return dataclasses.replace(found, resultant=sums)


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


def _scope(part: str, end: Typed | None, initial: str, reading: ChannelReading) -> Scope:
    if end is None and part != "total" and reading.pulses:
        last = reading.pulses[-1].end
        say(f"the shock is taken to end with its last blow, at {last:.6g} s (--end)")
        return Scope(part, max(last - reading.channel.start, 2.0 * reading.channel.step), initial=initial)
    if end is None:
        return Scope(part, initial=initial)
    after = end - reading.channel.start
    if not reading.channel.step < after <= reading.channel.duration:
        last = reading.channel.start + reading.channel.duration
        raise InputError("--end", end.word, f"a time from {reading.channel.start:g} s to {last:g} s")
    return Scope(part, after, initial=initial)


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
    found = _shown(result)
    for name, kind, _, priority in found:
        columns += numerals(headed(name, *_units(kind, in_g)) if in_g else f"{name} (own)", priority=priority)
    rows = [
        [number(float(first.frequency[k]), "Hz", "Hz")]
        + [number(float(values[k]), *_units(kind, in_g)) for _, kind, values, _ in found]
        for k in shown
    ]
    q = "undamped" if math.isinf(first.q) else f"Q = {first.q:g}"
    what = f"{len(result.shocks)} channels" if result.shocks else f"{Path(result.file).name}, {reading.channel.name}"
    table(f"Shock response spectrum of {what}: {q}, {side}, {first.part}", columns, rows)
    if step > 1:
        tell(f"every {step}th of {len(first.frequency)} frequencies; --json or spectrum.csv has them all")


def _shown(result: SpectrumResult) -> list[tuple[str, str, Any, int]]:
    """Return the columns of the table: name, kind, values, and how soon it is left out."""
    if not result.shocks:
        found = [(one.kind, one.kind, one.side(result.side), MAIN) for one in result.spectra]
        return found + [(f"{kind} rms", kind, values, MAIN) for kind, values in result.rms.items()]
    found = [
        (f"{kind} {name.replace('p95_50', 'P95/50')}", kind, values, MAIN)
        for name, kinds in result.together.items()
        for kind, values in kinds.items()
    ]
    for shock in result.shocks if len(result.shocks) <= MOST_SHOWN else ():
        found += [(f"{one.kind} of {shock.name}", one.kind, one.side(result.side), MORE) for one in shock.spectra]
    return found
