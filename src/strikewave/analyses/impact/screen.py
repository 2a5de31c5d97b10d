"""An impact of two free bodies as a command: solve, print, draw."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from strikewave.analyses.impact.result import (
    MOST_ROWS,
    ImpactResult,
    blow_columns,
    impact_answers,
    impact_notices,
    impact_words,
    solved_blows,
)
from strikewave.analyses.impact.setup import Setup
from strikewave.base.result import Source
from strikewave.reporting import measured_files as measured
from strikewave.reporting.faces import face_table, part_tables
from strikewave.reporting.output_options import Output
from strikewave.reporting.run_and_write import Command, drawing, run_and_write
from strikewave.reporting.terminal import print_rows, report_table, tell


def solve_setup(setup: Setup, output: Output) -> int:
    """Solve an impact, print it and, on request, write it, and return the exit code."""
    origin = measured.source_of("command", "impact", test=output.stated_test())
    return run_and_write(ImpactCommand(setup, origin), output, None, origin.text)


@dataclass(frozen=True)
class ImpactCommand(Command[ImpactResult]):
    """The impact of two free bodies."""

    setup: Setup
    origin: Source

    def solve(self) -> ImpactResult:
        """Return the blows."""
        blows = solved_blows(self.setup)
        answers = impact_answers(self.setup, blows[0])
        return ImpactResult(
            self.setup, blows, answers, origin=self.origin, notices=impact_notices(self.setup, blows[0], answers)
        )

    def summary(self, result: ImpactResult) -> str:
        """Say what the first blow came to."""
        return impact_words(result)

    def show(self, result: ImpactResult) -> None:
        """Print the first blow, and the others in a table."""
        many = len(result.blows) > 1
        title = "Impact of two free bodies" + (", first blow" if many else "")
        for shown in (*part_tables(result, "first", title), *part_tables(result, "law")):
            report_table(shown)
        if result.differ:
            report_table(face_table(result, "contact_answers"))
        if many:
            print_rows("Blows on the same spot", blow_columns(result))
        if len(result.blows) > MOST_ROWS:
            tell(f"the first and last {MOST_ROWS // 2} of {len(result.blows)} blows; --json and --out have them all")

    def draw(self, result: ImpactResult, folder: Path) -> list[str]:
        """Write the page, and force and indentation in time."""
        from strikewave.analyses.impact.report import impact_picture, impact_report
        from strikewave.reporting.style import save

        with drawing(folder / "impact.svg") as path:
            save(impact_picture(result), path)
        with drawing(folder / "report.html") as path:
            path.write_text(impact_report(result), "utf-8", newline="\n")
        return ["report.html", "impact.svg"]
