"""A scatter study as a command: run, print, draw."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from strikewave.cases.case import Case
from strikewave.cases.written_case import dump_case
from strikewave.reporting.faces import columns_of, text_of
from strikewave.reporting.measured_files import asked
from strikewave.reporting.options.output import Output
from strikewave.reporting.run_and_write import case_folder, drawing, run_and_write
from strikewave.reporting.terminal import print_face, print_rows, progress_bar, tell
from strikewave.studies.command import ResumableCommand
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.store import RunStore
from strikewave.studies.scatter.study import ScatterPlan, ScatterStudy, ShareRow, marked_text, scatter
from strikewave.uncertainty.draws import tolerances_of
from strikewave.uncertainty.shares import Shares

FEWEST_FOR_LIMIT = 59
"""Runs below which no limit holds for 95 % of all runs with 95 % confidence."""


def run_scatter(command: ScatterCommand, changes: Sequence[str], output: Output) -> int:
    """Run a case within its tolerances, write and print the scatter, and return the exit code.

    Raises
    ------
    InputError
        If the plan cannot be done, or the case has no tolerance.
    """
    case = command.case
    case.rotary_tables()
    tolerances_of(case)  # refused before a folder is made
    usual = f"scatter-{case_folder(case.name, dump_case(case), changes)}"
    return run_and_write(command, output, usual, marked_text(case, command.plan))


@dataclass
class ScatterCommand(ResumableCommand[ScatterStudy]):
    """Runs of a case within its tolerances; a study that is stopped goes on where it was.

    Attributes
    ----------
    case : Case
        What is run.
    plan : ScatterPlan
        How many runs.
    pool : Pool
        Who runs them.
    """

    indent: ClassVar[int | None] = 2

    case: Case
    plan: ScatterPlan
    pool: Pool

    def solved(self, store: RunStore) -> ScatterStudy:
        """Return the study, with a bar on stderr; where it is stopped, finished runs are kept, and said to be."""
        try:
            with progress_bar("runs", clocks=("elapsed", "left")) as report:
                study = scatter(self.case, self.plan, report, store, self.pool)
        except KeyboardInterrupt as stop:
            self.stopped_after(stop, store)
        return dataclasses.replace(study, asked=asked())

    def summary(self, result: ScatterStudy) -> str:
        """Say how much the blows scatter, and which tolerance matters most."""
        from strikewave.studies.scatter.report import scatter_words

        return scatter_words(result)

    def show(self, result: ScatterStudy) -> None:
        """Print the scatter, and which tolerance it comes from."""
        _print(result)

    def draw(self, result: ScatterStudy, folder: Path) -> list[str]:
        """Write page and picture."""
        from strikewave.reporting.style import save
        from strikewave.studies.scatter.figures import scatter_picture
        from strikewave.studies.scatter.report import scatter_report

        with drawing(folder / "scatter.svg") as path:
            save(scatter_picture(result), path)
        with drawing(folder / "report.html") as path:
            path.write_text(scatter_report(result), "utf-8", newline="\n")
        return ["report.html", "scatter.svg"]


def _print(study: ScatterStudy) -> None:
    print_face(study, "means", "Means of the runs, and CV between runs")
    print_face(study, "typical_blows", "Typical blow of each run, and CV between runs")
    print_face(study, "within", "Scatter within a run: CV (%); later: without the first blow")
    broken = sum(study.without_limit)
    counted = f"; {broken} of {len(study.runs)} runs failed or missed a blow and keep no limit" if broken else ""
    tell(f"bounds of the CV between runs: for normal figures; 95 % of runs below: with 95 % confidence{counted}")
    if len(study.runs) < FEWEST_FOR_LIMIT:
        tell(f"95 % of runs below takes {FEWEST_FOR_LIMIT} runs or more")
    kinds = ", ".join(f"{blows} {kind} (in {runs} runs)" for kind, (blows, runs) in study.kinds().items())
    tell(f"blows: {kinds}; largest displacement (rearward) {text_of(study, 'largest_displacement')}")
    for one in study.shares:
        _print_shares(study, one)


def _print_shares(study: ScatterStudy, shares: Shares) -> None:
    """Print the shares in one quantity with what each tolerance is."""
    from strikewave.studies.scatter.report import sum_words

    sobol = study.plan.shares == "sobol"
    title = f"Shares in the {shares.of}, {'Sobol indices' if sobol else 'each alone'}, {shares.runs} runs each"
    print_rows(title, columns_of(ShareRow, study.share_rows(shares), "sobol" if sobol else "alone"))
    tell(f"sum of the shares: {sum_words(shares)}")
