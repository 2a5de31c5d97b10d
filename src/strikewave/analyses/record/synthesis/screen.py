"""A synthesis as a command: solve, print, draw."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from strikewave.analyses.record.synthesis.result import SynthesisResult, synthesis_words, synthesize
from strikewave.analyses.record.verdicts.judged_spectra import print_spectra_verdict
from strikewave.base.result import Source
from strikewave.reporting import measured_files as measured
from strikewave.reporting.layout import keys, numerals
from strikewave.reporting.output_options import Output
from strikewave.reporting.run_and_write import Command, drawing, run_and_write
from strikewave.reporting.terminal import table
from strikewave.specifications.reading import Specification, load_specification


def synthesize_specification(name: str, by: str, rate: float | None, output: Output) -> int:
    """Make a base motion that meets a specification of a spectrum, write and print it, and return the exit code.

    Raises
    ------
    InputError
        If the specification cannot be read, or states no spectrum.
    """
    specification = load_specification(name, "NAME")
    specification.spectrum_limits()
    usual = f"synthesis-{specification.file_name}-{by}"
    origin = measured.source_of("command", usual)
    return run_and_write(SynthesisCommand(specification, by, rate, origin), output, usual, origin.text)


@dataclass(frozen=True)
class SynthesisCommand(Command[SynthesisResult]):
    """A synthesis that is asked for."""

    indent: ClassVar[int | None] = None
    of_test: ClassVar[bool] = False

    specification: Specification
    by: str
    rate: float | None
    origin: Source

    def solve(self) -> SynthesisResult:
        """Return the motion with its verdict."""
        return synthesize(self.specification, self.by, self.rate, self.origin)

    def summary(self, result: SynthesisResult) -> str:
        """Say the verdict, and what a shaker must reach."""
        return synthesis_words(result)

    def show(self, result: SynthesisResult) -> None:
        """Print the key numbers and the clauses."""
        table("The motion", [*keys("quantity"), *numerals("value")], [list(row) for row in result.highlights()])
        print_spectra_verdict(result.verdict)

    def draw(self, result: SynthesisResult, folder: Path) -> list[str]:
        """Write page and picture."""
        from strikewave.analyses.record.synthesis.report import page, picture
        from strikewave.reporting.style import save

        with drawing(folder / "report.html") as path:
            path.write_text(page(result), "utf-8", newline="\n")
        with drawing(folder / "summary.svg") as path:
            save(picture(result), path)
        return ["report.html", "summary.svg"]
