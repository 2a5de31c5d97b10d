"""The impact of two free bodies as a command: solve, print, draw."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from strikewave.analyses.impact.answers import impact_answers
from strikewave.analyses.impact.result import (
    MOST_ROWS,
    ImpactResult,
    _blows,
    _notices,
    answer_table,
    blow_table,
    first_rows,
)
from strikewave.analyses.impact.setup import Setup
from strikewave.base.result import Source
from strikewave.contact import Impact
from strikewave.reporting import measured_files as measured
from strikewave.reporting.layout import KEY, MORE, keys, numerals, texts
from strikewave.reporting.options.output import Output
from strikewave.reporting.run_and_write import Command, drawing, run_and_write
from strikewave.reporting.terminal import table, tell


def solve_setup(setup: Setup, output: Output) -> int:
    """Solve an impact, print it and, on request, write it, and return the exit code.

    Raises
    ------
    InputError
        If the numbers are beyond what can be solved.
    """
    origin = measured.source_of("command", "impact", test=output.stated_test())
    return run_and_write(ImpactCommand(setup, origin), output, None, origin.text)


@dataclass(frozen=True)
class ImpactCommand(Command[ImpactResult]):
    """The impact of two free bodies."""

    setup: Setup
    origin: Source

    def solve(self) -> ImpactResult:
        """Return the blows."""
        blows = _blows(self.setup)
        answers = impact_answers(self.setup, blows[0])
        return ImpactResult(
            self.setup, blows, answers, origin=self.origin, notices=_notices(self.setup, blows[0], answers)
        )

    def summary(self, result: ImpactResult) -> str:
        """Say what the first blow came to."""
        from strikewave.analyses.impact.report import impact_words

        return impact_words(result)

    def show(self, result: ImpactResult) -> None:
        """Print the first blow, and the others in a table."""
        _print(result)

    def draw(self, result: ImpactResult, folder: Path) -> list[str]:
        """Write the page, and force and indentation in time."""
        from strikewave.analyses.impact.figures.contact import impact_sheet
        from strikewave.analyses.impact.report import impact_report
        from strikewave.reporting.style import save

        labels = [f"blow {k + 1}" for k in result.drawn]
        with drawing(folder / "impact.svg") as path:
            save(impact_sheet([result.blows[k] for k in result.drawn], labels, result.title), path)
        with drawing(folder / "report.html") as path:
            path.write_text(impact_report(result), "utf-8", newline="\n")
        return ["report.html", "impact.svg"]


def _print(result: ImpactResult) -> None:
    setup, blows = result.setup, result.blows
    title = "Impact of two free bodies" + (", first blow" if setup.repeat > 1 else "")
    table(title, [*keys(""), *texts("")], first_rows(setup, blows[0]))
    if result.answers.differ:
        (named, *heads), rows = answer_table(result.answers)
        table("First blow with its contact elastic and yielding", [*keys(named), *numerals(*heads)], rows)
    if setup.repeat > 1:
        _print_blows(blows)


def _print_blows(blows: list[Impact]) -> None:
    (blow, restitution, indentation, residual, force, duration, *others), rows = blow_table(blows)
    columns = [*numerals(blow, priority=KEY), *numerals(restitution)]
    columns += [*numerals(indentation, residual, priority=MORE), *numerals(force, duration)]
    table("Blows on the same spot", [*columns, *numerals(*others, priority=MORE + 1)], rows)
    if len(blows) > MOST_ROWS:
        tell(f"the first and last {MOST_ROWS // 2} of {len(blows)} blows; --json and --out have them all")
