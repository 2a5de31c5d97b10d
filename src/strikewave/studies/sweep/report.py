"""Page, screen and command of a sweep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from strikewave.base.errors import InputError
from strikewave.base.result import RUN_BROKEN, RUN_FAILED
from strikewave.base.texts import percent
from strikewave.reporting.faces import face_table
from strikewave.reporting.output_options import Output
from strikewave.reporting.parts import Cell, Link, Part, Section, Table
from strikewave.reporting.table_files import write_parquet
from strikewave.reporting.terminal import print_face, report_table, say, tell
from strikewave.studies.command import Report, StudyCommand, lasting, print_estimate
from strikewave.studies.engine.case_evaluation import ANALYSES
from strikewave.studies.engine.plan import DESIGNS, GRID
from strikewave.studies.engine.runner import seconds_each
from strikewave.studies.engine.store import RunStore, runs_beside
from strikewave.studies.study import picture_section, study_page
from strikewave.studies.sweep.figures import MOST_NUMBERS, MOST_SETTINGS, picture
from strikewave.studies.sweep.study import SweepPlan, SweepStudy, make_sweep

MOST_REASONS = 12
"""Reasons of failures that a table lists: as many as a page holds beside the settings."""
SHARES = (
    "The share is that of the variance of the means over a setting in the variance of all runs (the correlation "
    "ratio). What is left comes from settings together"
)
IN_GRID = "."
BY_CHANCE = (
    ", or from chance: in runs that are no grid, the share expected by chance is taken off, 0 stands for what then is "
    "below it, and the standard error is that of the jackknife over the runs. A share below the one by chance tells "
    "nothing: in 95 of 100 studies of settings that do nothing, none exceeds it."
)
"""Text above the main effects: what a share is, and what is left of it in a grid and in random runs."""


def sweep_words(study: SweepStudy) -> str:
    """Say in words what came out."""
    plan = study.plan
    sentences = [f"{plan.words}{f'; {study.verdicts.words}' if study.verdicts.words else ''}."]
    first, extent = plan.kept[0], study.ranges[0]
    if extent.smallest is None or extent.largest is None:
        sentences.append(f"No run has a {extent.name}.")
    else:
        low, high = (first.words(end) for end in (extent.smallest, extent.largest))
        sentences.append(f"{extent.name.capitalize()}: {low} ({extent.smallest_at}) to {high} ({extent.largest_at}).")
    effect = next((effect for effect in study.largest_effects if effect.kept == first), None)
    if effect is not None and effect.stands_out:
        sentences.append(f"Of its variance, {percent(effect.share, 0)} comes from {effect.setting} alone.")
    return " ".join(sentences)


def _caption(study: SweepStudy) -> str:
    count = len(study.plan.variables)
    more = f" The first {MOST_NUMBERS} numbers are drawn." if len(study.plan.kept) > MOST_NUMBERS else ""
    marked = {RUN_BROKEN: "diamonds", RUN_FAILED: "crosses"}
    meaning = {RUN_BROKEN: "failed a check", RUN_FAILED: "failed"}
    failed = "".join(
        f" Red {marks} are runs that {meaning[status]}."
        for status, marks in marked.items()
        if study.verdicts.count(status)
    )
    if count == 1:
        return f"Each number over {study.plan.variables[0].path}, a dot a run.{failed}{more}"
    if count == 2:
        over = " and ".join(variable.path for variable in study.plan.variables)
        return f"Each number in colour over {over}.{failed}{more}"
    most = f" The {MOST_SETTINGS} settings with the largest shares are drawn." if count > MOST_SETTINGS else ""
    return (
        "Above, a line a run through its settings, in the colour of the first number. Below, each run as a dot over "
        f"each setting, and the means over it, its main effect.{most}{failed}{more}"
    )


def page(study: SweepStudy) -> str:
    """Return the report of a sweep as one HTML page."""
    numbers: list[Part] = [face_table(study, "ranges")]
    if study.run_rows()[1]:
        numbers.append(Table("All runs", *study.run_rows()))
    numbers.append(Link("runs.csv", "All runs, runs.csv"))
    numbers.append(Link("runs.parquet", "The same as Parquet, runs.parquet"))
    outcome = [picture_section("Picture", picture(study), _caption(study)), Section("Numbers", "", numbers)]
    if study.effects:
        effects = face_table(study, "largest_effects", caption="Main effects")
        outcome.append(
            Section("Main effects", SHARES + (IN_GRID if study.plan.design == GRID else BY_CHANCE), [effects])
        )
    random = "" if study.plan.design == GRID else f", random seed {study.plan.seed}"
    text = f"Each run is {ANALYSES[study.plan.evaluation.analysis]}. Runs: {DESIGNS[study.plan.design]}{random}."
    varied: list[Part] = [face_table(study, "vary")]
    failures: list[list[Cell]] = [[reason, count] for reason, count in list(study.reasons.items())[:MOST_REASONS]]
    if failures:
        varied.append(Table("Runs that failed", ["why", "runs"], failures))
    return study_page(study, sweep_words(study), outcome, Section("What was varied", text, varied), "a sweep")


@dataclass
class SweepCommand(StudyCommand[SweepStudy]):
    """A sweep as a command."""

    name: ClassVar[str] = "sweep"
    bar: ClassVar[str] = "sweep"

    plan: SweepPlan

    @property
    def marked_text(self) -> str:
        """The case as text, and above it what is asked."""
        return self.plan.text

    def run(self, changes: Sequence[str], output: Output) -> int:
        """Make the sweep; histories that would have no folder are refused before."""
        histories = ", ".join(self.plan.evaluation.histories)
        if histories and self.place is None and not output.writes(self.usual_folder(changes)):
            hint = "add --out DIR or --store DIR"
            raise InputError("--keep", f"{histories} with --json", "a folder for the histories", hint)
        return super().run(changes, output)

    def announced(self, store: RunStore) -> float:
        """Say what is run."""
        say(self.plan.words)
        return 0.0

    def made(self, store: RunStore, report: Report) -> SweepStudy:
        """Return the sweep."""
        return make_sweep(self.plan, store, self.pool, lambda now: report(now.share, now.words))

    def summary(self, result: SweepStudy) -> str:
        """Say over what the first number goes, and which setting matters most."""
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
        names = super().draw(result, folder)
        write_parquet(result.columns(), folder / "runs.parquet")
        return [*names, "runs.parquet"]

    def hand_over(self, result: SweepStudy, folder: Path) -> list[str]:
        """Put the histories of the runs into the folder."""
        if self.store is None or not self.plan.evaluation.histories:
            return super().hand_over(result, folder)
        return self._with_runs(folder, self.store.hand_over(folder, map(bytes.fromhex, result.keys)))


def show_estimate(command: SweepCommand, changes: Sequence[str], workers: int, output: Output) -> int:
    """Print how many runs a sweep has and about how long it takes, and return the exit code.

    Some runs are made and thrown away. What is finished is looked for where the sweep itself would: in a folder of its
    own, or beside the result.
    """
    plan, folder = command.plan, output.place(command.usual_folder(changes)).folder
    place = runs_beside(folder.absolute()) if command.place is None and folder is not None else command.place
    with RunStore(place if place is not None and place.is_dir() else None, option="--dry-run") as store:
        known = store.known()
    keys = {plan.job.key(row): row for row in plan.rows}  # equal rows are run once
    left = [row for key, row in keys.items() if key not in known]
    finished = len(keys) - len(left)
    each = seconds_each(plan.job, left) if left else float("nan")
    seconds = each * len(left) / workers if left else 0.0
    text = f"{len(keys)} runs, {finished} of them finished" if finished else f"{len(keys)} runs"
    if left:
        others = " for the others" if finished else ""
        processes = f"{workers} processes" if workers > 1 else "one process"
        text += f": about {lasting(seconds)}{others}, {each:.2g} s each on {processes}"
    else:
        text += ": nothing is left"
    counts = {"runs": len(keys), "finished": finished, "run_seconds": each, "seconds": seconds, "workers": workers}
    return print_estimate(counts, f"{plan.words}. {text}.", output)
