"""A fit as a command: read, fit, print, draw."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from strikewave.analyses.compare.sources import parse_name, paths_of
from strikewave.base.result import Source
from strikewave.cases.case import Case, dump_case
from strikewave.reporting import measured_files as measured
from strikewave.reporting.faces import columns_of
from strikewave.reporting.options import Running
from strikewave.reporting.output_options import Output
from strikewave.reporting.run_and_write import case_folder, drawing, run_and_write
from strikewave.reporting.style import save, titled
from strikewave.reporting.terminal import print_rows, progress_bar, report_table, tell
from strikewave.studies.command import ResumableCommand
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.store import RunStore
from strikewave.studies.fit.checking import PredictedFigure, TriedChoice
from strikewave.studies.fit.figures import corner_figure, fit_figure
from strikewave.studies.fit.fit_file import load_fit
from strikewave.studies.fit.report import (
    POSTERIOR_TITLE,
    correlation_table,
    fit_report,
    fit_words,
    posterior_words,
    residual_rows,
)
from strikewave.studies.fit.result import FitStudy, FittedParameter, MisfitOfRun, PosteriorValue
from strikewave.studies.fit.study import requested
from strikewave.studies.fit.targets import FitRequest, parse_targets

MOST_ROWS = 20
"""Residuals that the screen lists: more fill it."""
SAMPLED = 5000
"""Runs that a posterior takes, roughly: for the bar alone."""
EXPECTED = 60
"""Runs that a fit takes for each free field, roughly: for the bar alone."""


def run_fit_file(
    path: str, changes: Sequence[str], output: Output, pool: Pool | None, running: Running, bayes: bool = False
) -> int:
    """Do the fit of a file, with its posterior if asked; write and print it, and return the exit code."""
    read = load_fit(path, changes)
    usual = f"fit-{case_folder(read.path.stem, read.path.read_text('utf-8-sig'), changes)}"
    request = dataclasses.replace(read.request, bayes=read.request.bayes or bayes)
    return _run(output.tested(read.case), request, output, usual, pool, running, [read.path])


def run_fit(
    case: Case, changes: Sequence[str], request: FitRequest, output: Output, pool: Pool | None, running: Running
) -> int:
    """Fit a case, write and print the result, and return the exit code."""
    return _run(case, request, output, f"fit-{case_folder(case.name, dump_case(case), changes)}", pool, running)


def _run(
    case: Case,
    request: FitRequest,
    output: Output,
    usual: str,
    pool: Pool | None,
    running: Running,
    files: Sequence[Path] = (),
) -> int:
    targets = parse_targets([*request.to, *request.check_on], case)
    paths = [
        *files,
        *(path for target in targets if not target.is_number for path in paths_of(parse_name(target.right))),
    ]
    origin = measured.source_of(
        "fit", case.name, list(dict.fromkeys(paths)) if output.writes(usual) else [], output.stated_test()
    )
    command = FitCommand(case, request, origin, pool, place=running.store, fresh=running.fresh)
    return run_and_write(command, output, usual, origin.text)


@dataclass
class FitCommand(ResumableCommand[FitStudy]):
    """A fit of a case to measurements; asked again, it reads what its runs came to."""

    indent: ClassVar[int | None] = 2

    case: Case
    request: FitRequest
    origin: Source
    pool: Pool | None

    def solved(self, store: RunStore) -> FitStudy:
        """Return the fit, with a bar on stderr; where it is stopped before it has begun, end with `stopped`."""
        with progress_bar("fitting") as report:

            def advance(runs: int, misfit: float) -> None:
                whole = EXPECTED * max(len(self.request.free), 2) + SAMPLED * self.request.bayes
                report(min(runs / whole, 0.99), f"{runs} runs, sum of squares {misfit:.4g}")

            try:
                study = requested(self.case, self.request, advance, self.pool, store)
            except KeyboardInterrupt as stop:
                self.stopped_after(stop, store)
        return dataclasses.replace(study, origin=self.origin)

    def summary(self, result: FitStudy) -> str:
        """Say what came out."""
        return fit_words(result)

    def show(self, result: FitStudy) -> None:
        """Print values, correlation and residuals."""
        print_rows("Fitted values", columns_of(FittedParameter, result.parameters))
        if len(result.parameters) > 1:
            report_table(correlation_table(result))
        if result.posterior is not None:
            print_rows(POSTERIOR_TITLE, columns_of(PosteriorValue, result.posterior_values()))
            tell(posterior_words(result.posterior))
        rows = residual_rows(result)
        if len(rows) > MOST_ROWS:
            tell(f"of {len(rows)} residuals the {MOST_ROWS} largest; the report and fit.json have all")
        print_rows("Residuals", columns_of(MisfitOfRun, rows[:MOST_ROWS]))
        if result.tries:
            print_rows("Choices, the best first", columns_of(TriedChoice, result.tries))
        if result.checks is not None:
            print_rows("Predictions of what was kept out", columns_of(PredictedFigure, result.checks.figures))

    def draw(self, result: FitStudy, folder: Path) -> list[str]:
        """Write page and picture."""
        with drawing(folder / "fit.svg") as path:
            save(fit_figure(result), path)
        with drawing(folder / "report.html") as path:
            path.write_text(fit_report(result), "utf-8", newline="\n")
        if result.posterior is None:
            return ["report.html", "fit.svg"]
        with drawing(folder / "posterior.svg") as path:
            save(titled(corner_figure(result), f"Posterior: {result.title}"), path)
        return ["report.html", "fit.svg", "posterior.svg"]
