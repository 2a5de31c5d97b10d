"""A sweep as a command: run, print, draw; one that is stopped goes on where it was."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from strikewave.base.errors import InputError
from strikewave.base.json_document import head, plain
from strikewave.cases.written_case import dump_case
from strikewave.reporting.histories import write_parquet
from strikewave.reporting.measured_files import asked
from strikewave.reporting.options.output import Output
from strikewave.reporting.parts import Table
from strikewave.reporting.run_and_write import case_folder, drawing, run_and_write
from strikewave.reporting.terminal import print_face, print_json, progress_bar, report_table, say, tell
from strikewave.studies.command import ResumableCommand
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.runner import StudyProgress, finished_before
from strikewave.studies.engine.store import RunStore, runs_beside
from strikewave.studies.sweep.estimate import estimated
from strikewave.studies.sweep.study import SweepPlan, SweepStudy, make_sweep


def run_sweep(plan: SweepPlan, changes: Sequence[str], command: SweepCommand, output: Output) -> int:
    """Make a sweep, write and print it, and return the exit code.

    Raises
    ------
    InputError
        If the place is taken, or histories have no folder.
    """
    usual = _usual(plan, changes)
    if plan.evaluation.histories and command.place is None and not output.writes(usual):
        kept = ", ".join(plan.evaluation.histories)
        raise InputError("--keep", f"{kept} with --json", "a folder for the histories", "add --out DIR or --store DIR")
    return run_and_write(command, output, usual, plan.text)


def _usual(plan: SweepPlan, changes: Sequence[str]) -> str:
    return f"sweep-{case_folder(plan.case.name, dump_case(plan.case), changes)}"


def show_estimate(plan: SweepPlan, changes: Sequence[str], place: Path | None, workers: int, output: Output) -> int:
    """Print how many runs a sweep has and about how long it takes, and return the exit code.

    What is finished is looked for where the sweep itself would: in a folder of its own, or beside the result.
    """
    folder = output.place(_usual(plan, changes)).folder
    if place is None and folder is not None:
        place = runs_beside(folder.absolute())
    with RunStore(place if place is not None and place.is_dir() else None, option="--dry-run") as store:
        found = estimated(plan, store, workers)
    if output.json:
        print_json(plain({**head({"run_seconds": "s", "seconds": "s"}), **found._asdict()}))
    else:
        tell(f"{plan.words}. {found.words}.")
    return 0


@dataclass
class SweepCommand(ResumableCommand[SweepStudy]):
    """A sweep.

    Attributes
    ----------
    plan : SweepPlan
        What is run.
    pool : Pool
        Who runs it.
    """

    plan: SweepPlan
    pool: Pool

    def solved(self, store: RunStore) -> SweepStudy:
        """Return the sweep, with a bar on stderr; where it is stopped, finished runs are kept, and said to be."""
        say(self.plan.words)

        def advance(now: StudyProgress) -> None:
            report(now.share, now.words)

        try:
            with progress_bar("sweep", clocks=("elapsed", "left")) as report:
                study = make_sweep(self.plan, store, self.pool, advance)
        except KeyboardInterrupt as stop:
            rows = self.plan.rows
            done = finished_before(self.plan.job, rows, store)
            self.stopped(stop, store, f"{done} of {len(rows)} runs" if done else "")
        return dataclasses.replace(study, asked=asked())

    def summary(self, result: SweepStudy) -> str:
        """Say over what the first number goes, and which setting matters most."""
        from strikewave.studies.sweep.report import sweep_words

        return sweep_words(result)

    def show(self, result: SweepStudy) -> None:
        """Print the range of each number, and the main effects."""
        print_face(result, "ranges", "Each number over all runs")
        if result.run_rows()[1]:
            report_table(Table("All runs", *result.run_rows()), keys=2)
        print_face(result, "largest_effects", "Main effects")
        for reason, count in list(result.reasons.items())[:3]:
            tell(f"{count} runs failed: {reason}")

    def draw(self, result: SweepStudy, folder: Path) -> list[str]:
        """Write the page, the picture, and the table as Parquet."""
        from strikewave.reporting.style import save
        from strikewave.studies.sweep.figures import sweep_picture
        from strikewave.studies.sweep.report import sweep_report

        with drawing(folder / "sweep.svg") as path:
            save(sweep_picture(result), path)
        with drawing(folder / "report.html") as path:
            path.write_text(sweep_report(result), "utf-8", newline="\n")
        write_parquet(result.columns(), folder / "runs.parquet")
        return ["report.html", "sweep.svg", "runs.parquet"]

    def hand_over(self, result: SweepStudy, folder: Path) -> list[str]:
        """Put the histories of the runs into the folder."""
        if self.store is None or not self.plan.evaluation.histories:
            return super().hand_over(result, folder)
        return self._with_runs(folder, self.store.hand_over(folder, map(bytes.fromhex, result.keys)))
