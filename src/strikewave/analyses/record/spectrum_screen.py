"""Shock response spectra of a record as a command: compute, print, draw."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from strikewave.analyses.record.file_spectra import FilesAsked, judged_spectra_of
from strikewave.analyses.record.filter_options import filtered_folder
from strikewave.analyses.record.result import name_of
from strikewave.analyses.record.spectrum import KIND_UNITS, SHOWN_UNITS, SpectrumRequest, SpectrumResult
from strikewave.analyses.record.verdicts.judged_spectra import SpectraJudge, print_spectra_verdict
from strikewave.base.result import Source
from strikewave.reporting import measured_files as measured
from strikewave.reporting.clause_words import held_words
from strikewave.reporting.layout import KEY, MAIN, MORE, numerals
from strikewave.reporting.numbers import headed, one_in
from strikewave.reporting.options.output import Output
from strikewave.reporting.run_and_write import Command, drawing, run_and_write
from strikewave.reporting.terminal import number, table, tell

MOST_SHOWN = 4
"""Spectra that a table on the screen lists beside what they come to; the files have all."""


SHOWN_ROWS = 24
"""Rows of the table on the screen, which it shows at once; the files have all."""


def compute_spectra(
    asked: FilesAsked, wanted: SpectrumRequest, output: Output, judge: SpectraJudge | None = None
) -> int:
    """Compute the spectra of files, write and print them, and return the exit code.

    Raises
    ------
    InputError
        If no file, or a frequency, a window or the end of the shock cannot be used.
    """
    asked = asked._replace(files=measured.ordered(asked.files))
    paths = [Path(measured.shown(file)) for file in asked.files]
    name = name_of(paths)
    usual = f"srs-{name}" + ("" if judge is None else f"-{judge.specification.file_name}")
    usual = filtered_folder(usual, asked.filters)
    origin = measured.source_of_records(name, paths, output, usual)
    return run_and_write(SrsCommand(asked, wanted, origin, judge), output, usual, origin.text)


@dataclass(frozen=True)
class SrsCommand(Command[SpectrumResult]):
    """The spectra of channels of files."""

    indent: ClassVar[int | None] = None

    asked: FilesAsked
    wanted: SpectrumRequest
    origin: Source
    judge: SpectraJudge | None = None

    def solve(self) -> SpectrumResult:
        """Return the spectra, the baselines of the records taken off."""
        return judged_spectra_of(self.asked, self.wanted, self.origin, self.judge)

    def summary(self, result: SpectrumResult) -> str:
        """Say where the spectrum is largest."""
        from strikewave.analyses.record.spectrum_report import spectrum_words

        return spectrum_words(result)

    def show(self, result: SpectrumResult) -> None:
        """Print the verdict, and every so many of the frequencies."""
        if result.verdict is not None:
            print_spectra_verdict(result.verdict)
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
        if result.responses:
            pictures["response.svg"] = response_figure(result)
        if result.rollings:
            pictures["rolling.svg"] = rolling_figure(result)
        for name, figure in pictures.items():
            with drawing(folder / name) as path:
                save(figure if name == "summary.svg" else titled(figure, result.title), path)
        with drawing(folder / "report.html") as path:
            path.write_text(spectrum_report(result), "utf-8", newline="\n")
        return ["report.html", *pictures]


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
    what = (
        f"{len(result.shocks)} channel{'s' * (len(result.shocks) > 1)}"
        if result.shocks
        else f"{Path(result.file).name}, {reading.channel.name}"
    )
    table(f"Shock response spectrum of {what}: {q}, {side}, {first.part}", columns, rows)
    if result.budget is not None and result.verdict is None:
        tell(held_words(result.budget.names, result.budget.not_stated))
    if step > 1:
        tell(f"{one_in(step)} of {len(first.frequency)} frequencies; --json or spectrum.csv has them all")


def _shown(result: SpectrumResult) -> list[tuple[str, str, Any, int]]:
    """Return the columns of the table: name, kind, values, and how soon it is left out."""
    if not result.shocks:
        found: list[tuple[str, str, Any, int]] = []
        for k, one in enumerate(result.spectra):
            found.append((one.kind, one.kind, one.side(result.side), MAIN))
            if (expanded := result.expanded(k)) is not None:
                found.append((f"± U of {one.kind}", one.kind, expanded, MAIN))
        return found + [(f"{kind} rms", kind, values, MAIN) for kind, values in result.rms.items()]
    found = [
        (f"{kind} {name.replace('p95_50', 'P95/50')}", kind, values, MAIN)
        for name, kinds in result.together.items()
        for kind, values in kinds.items()
    ]
    for shock in result.shocks if len(result.shocks) <= MOST_SHOWN else ():
        found += [(f"{one.kind} of {shock.name}", one.kind, one.side(result.side), MORE) for one in shock.spectra]
    return found
