"""Shock response spectra of a record as a command: compute, print, draw."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from strikewave.analyses.clauses import held_words
from strikewave.analyses.record.file_spectra import judged_spectra_of
from strikewave.analyses.record.options import Spectra, filtered_folder
from strikewave.analyses.record.rows import name_of
from strikewave.analyses.record.spectrum import SpectraAsked, SpectrumResult
from strikewave.analyses.record.verdicts import SpectraJudge, print_spectra_verdict, spectra_judge
from strikewave.base.declare import KEY, MORE
from strikewave.base.result import Source
from strikewave.reporting import measured_files as measured
from strikewave.reporting.layout import numerals
from strikewave.reporting.numbers import one_in
from strikewave.reporting.output_options import Output
from strikewave.reporting.run_and_write import Command, drawing, run_and_write
from strikewave.reporting.style import save, titled
from strikewave.reporting.terminal import table, tell

if TYPE_CHECKING:
    from strikewave.specifications.reading import Specification

MOST_SHOWN = 4  # spectra that a table on the screen lists beside what they come to; the files have all


SHOWN_ROWS = 24  # rows of the table on the screen, which it shows at once; the files have all


def compute_spectra(
    files: Sequence[str],
    spectra: Spectra,
    measurement: measured.MeasurementOptions,
    filtering: measured.Filtering,
    judging: measured.SpectraJudging,
    specification: Specification | None,
    output: Output,
) -> int:
    """Compute the spectra of files, write and print them, and return the exit code."""
    asked = SpectraAsked.of(measured.ordered(files), spectra, measurement, filtering, judging.uncertainty)
    paths = [Path(measured.shown(file)) for file in asked.files]
    name = name_of(paths)
    usual = f"srs-{name}" + ("" if specification is None else f"-{specification.file_name}")
    usual = filtered_folder(usual, asked.filters)
    origin = measured.source_of_records(name, paths, output, usual)
    command = SrsCommand(asked, origin, spectra_judge(judging, specification))
    return run_and_write(command, output, usual, origin.text)


@dataclass(frozen=True)
class SrsCommand(Command[SpectrumResult]):
    """Spectra of channels of files."""

    indent: ClassVar[int | None] = None

    asked: SpectraAsked
    origin: Source
    judge: SpectraJudge | None = None

    def solve(self) -> SpectrumResult:
        """Return the spectra, the baselines of the records taken off."""
        return judged_spectra_of(self.asked, self.origin, self.judge)

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
        from strikewave.analyses.record.figures.spectra import response_figure, rolling_figure, tripartite
        from strikewave.analyses.record.report import spectrum_picture
        from strikewave.analyses.record.spectrum_report import spectrum_report

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


def _print(result: SpectrumResult) -> None:
    count = len(result.frequency)
    step = max(count // SHOWN_ROWS, 1)
    few = result.shocks if len(result.shocks) <= MOST_SHOWN else ()
    kinds = len(result.spectra)
    each = [one for shock in few for one in result.channel_columns(shock.found, f" of {shock.name}")[:kinds]]
    heads, rows = result.shown_every(step, [*result.main_columns, *each])
    main = len(result.main_columns)
    columns = [*numerals(heads[0], priority=KEY), *numerals(*heads[1:main]), *numerals(*heads[main:], priority=MORE)]
    what = f"{len(result.shocks)} channel{'s' * (len(result.shocks) > 1)}" if result.shocks else result.first.name
    table(f"Shock response spectrum of {what}: {result.damping}, {result.side}, {result.scope.part}", columns, rows)
    if result.budget is not None and result.verdict is None:
        tell(held_words(result.budget.names, result.budget.not_stated))
    if step > 1:
        tell(f"{one_in(step)} of {count} frequencies; --json or spectrum.csv has them all")
