"""A design as a command: search, print, draw; one that is stopped goes on where it was."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from strikewave.base.json_document import head, plain
from strikewave.reporting.measured_files import asked
from strikewave.reporting.parts import Table
from strikewave.reporting.shown_result import shown_table
from strikewave.reporting.terminal import print_face, print_json, progress_bar, report_table, say, tell
from strikewave.studies.command import ResumableCommand, lasting
from strikewave.studies.design.plan import DesignPlan
from strikewave.studies.design.study import DesignStudy, make_design
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.runner import StudyProgress
from strikewave.studies.engine.store import RunStore

TRIED = 3
"""Runs that are timed for an estimate, after one that loads what a process needs: both ends and the middle."""


class DesignEstimate(NamedTuple):
    """How long a design takes.

    Attributes
    ----------
    runs : int
        Most runs of the first search.
    at_most : int
        Most runs of all searches, draws and what verifies, where nothing meets all goals or there are objectives.
    run_seconds : float
        About how long one takes, s.
    seconds : float
        About how long the first search takes at most, s.
    """

    runs: int
    at_most: int
    run_seconds: float
    seconds: float


def estimated(plan: DesignPlan, workers: int) -> DesignEstimate:
    """Return how long a design takes, by some runs that are made and thrown away."""
    places = [[low + share * (high - low) for low, high in plan.bounds] for share in np.linspace(0.0, 1.0, TRIED)]
    rows = [plan.row_at(place) for place in places]
    plan.job(rows[:1])
    each = float(np.mean([outcome.seconds for outcome in plan.job(rows)]))
    later = max(2 * len(plan.goals), 2 * len(plan.objectives) + 1 if plan.objectives else 0)
    return DesignEstimate(plan.runs, plan.runs + later * plan.later_runs, each, each * plan.runs / workers)


def show_estimate(plan: DesignPlan, workers: int, as_json: bool) -> int:
    """Print what a design is of and about how long it takes, and return the exit code."""
    found = estimated(plan, workers)
    if as_json:
        print_json(plain({**head({"run_seconds": "s", "seconds": "s"}), **found._asdict()}))
    else:
        processes = f"{workers} processes" if workers > 1 else "one process"
        tell(
            f"{plan.words}. Up to {found.runs} runs of a search: about {lasting(found.seconds)}, "
            f"{found.run_seconds:.2g} s each on {processes}; with further searches where nothing meets all "
            f"goals or objectives compete, up to {found.at_most} runs."
        )
    return 0


@dataclass
class DesignCommand(ResumableCommand[DesignStudy]):
    """A design.

    Attributes
    ----------
    plan : DesignPlan
        What is asked.
    pool : Pool
        Who runs it.
    """

    plan: DesignPlan
    pool: Pool

    def solved(self, store: RunStore) -> DesignStudy:
        """Return the design, with a bar on stderr; where it is stopped, finished runs are kept, and said to be."""
        say(self.plan.words)

        def advance(now: StudyProgress) -> None:
            report(now.share, f"{now.done} runs, {now.words}")

        try:
            with progress_bar("design", clocks=("elapsed",)) as report:
                study = make_design(self.plan, store, self.pool, advance)
        except KeyboardInterrupt as stop:
            self.stopped_after(stop, store)
        return dataclasses.replace(study, asked=asked())

    def summary(self, result: DesignStudy) -> str:
        """Say which settings are best, or which goals exclude each other."""
        from strikewave.studies.design.report import design_words

        return design_words(result)

    def show(self, result: DesignStudy) -> None:
        """Print ranked settings, goals, sensitivities, and what excludes what."""
        heads, rows = shown_table(result)
        objectives = [result.kept(one.number).label for one in result.plan.objectives]
        numbers = [result.kept(name).label for name in result.plan.evaluation.names]
        more = [*heads[3 : len(result.plan.variables) + 1], *(set(numbers) - set(objectives)), "of goal"]
        print_face(result, "reaches", "Goals that exclude each other")
        report_table(Table("Ranked settings", heads, rows), 3, more)
        print_face(result, "goals_at_first", "Goals at the first setting")
        print_face(result, "known_numbers", "Surrogate")
        print_face(result, "number_changes", "Sensitivities at the first setting")

    def draw(self, result: DesignStudy, folder: Path) -> list[str]:
        """Write the page and the picture."""
        from strikewave.reporting.run_and_write import drawing
        from strikewave.reporting.style import save
        from strikewave.studies.design.figures import design_picture
        from strikewave.studies.design.report import design_report

        with drawing(folder / "design.svg") as path:
            save(design_picture(result), path)
        with drawing(folder / "report.html") as path:
            path.write_text(design_report(result), "utf-8", newline="\n")
        return ["report.html", "design.svg"]
