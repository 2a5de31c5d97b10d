"""A search for settings as a command: run, print, draw."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path

from strikewave.cases.case import Case
from strikewave.reporting import measured_files as measured
from strikewave.reporting.clause_words import clause_columns
from strikewave.reporting.faces import text_of
from strikewave.reporting.options.output import Output
from strikewave.reporting.run_and_write import drawing, run_and_write
from strikewave.reporting.terminal import print_rows, progress_bar, tell
from strikewave.studies.command import ResumableCommand
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.runner import share_reporter
from strikewave.studies.engine.store import RunStore
from strikewave.studies.settings.candidate import SettingsCandidate
from strikewave.studies.settings.goal import BlowGoal, SettingsChoices, goal_words, name_of
from strikewave.studies.settings.result import SettingsStudy, asked_line, candidate_columns, limit_columns
from strikewave.studies.settings.study import design_settings

SHOWN = 6
"""First of the ranking in the table; the first of each other number of strikers follows."""


def find_settings(command: SettingsCommand, output: Output, usual_question: bool) -> int:
    """Search for settings, write and print them, and return the exit code.

    ``usual_question`` says that nothing but the goal was asked: only then the folder has its name alone.

    Raises
    ------
    InputError
        If the place is taken.
    """
    asked = asked_line(command.case, command.goal, command.choice)
    usual = name_of(command.goal) + ("" if usual_question else f"-{asked[-10:-2]}")
    return run_and_write(command, output, usual, asked)


@dataclass
class SettingsCommand(ResumableCommand[SettingsStudy]):
    """A search for settings that meet a goal; one that is stopped goes on where it was."""

    case: Case
    goal: BlowGoal
    choice: SettingsChoices
    pool: Pool

    def solved(self, store: RunStore) -> SettingsStudy:
        """Return the study, with a bar on stderr."""
        try:
            with progress_bar("settings") as report:
                study = design_settings(self.case, self.goal, self.choice, store, self.pool, share_reporter(report))
        except KeyboardInterrupt as stop:
            self.stopped_after(stop, store, "searches")
        return dataclasses.replace(study, asked=measured.asked())

    def summary(self, result: SettingsStudy) -> str:
        """Say which settings are first, and what they give."""
        from strikewave.studies.settings.report import settings_words

        return settings_words(result)

    def show(self, result: SettingsStudy) -> None:
        """Print the ranking, and the limits of the first."""
        _print(result)

    def draw(self, result: SettingsStudy, folder: Path) -> list[str]:
        """Write page and picture."""
        from strikewave.reporting.style import save
        from strikewave.studies.settings.figures import settings_figure
        from strikewave.studies.settings.report import settings_report

        with drawing(folder / "settings.svg") as path:
            save(settings_figure(result), path)
        with drawing(folder / "report.html") as path:
            path.write_text(settings_report(result), "utf-8", newline="\n")
        return ["report.html", "settings.svg"]


def _print(study: SettingsStudy) -> None:
    first = study.candidates[0]
    others = {one.case.rotary_tables().machine.strikers.si: one for one in reversed(study.candidates)}
    shown = [one for one in study.candidates if one in study.candidates[:SHOWN] or one in others.values()]
    print_rows(f"{study.met_count} settings give {goal_words(study.goal)}", candidate_columns(study.choice.vary, shown))
    tell(
        "peak, width, interval: of the typical blow, the median of the later full ones; CV: scatter of all peaks; "
        "sensitivity: change of the peak with engagement"
    )
    tell(_header(study.case, study.goal, first))
    print_rows("Limits of the first", limit_columns(first.limits))
    if first.clauses:
        print_rows("Clauses of the first, each by its worst blow", clause_columns(first.clauses))
    if len(study.masses) > 1:
        print_rows("What the mass of a striker costs", candidate_columns(study.choice.vary, study.masses, "mass"))
    for count, why in study.left_out.items():
        tell(f"left out, {count} strikers: {why}")
    for why in study.failed[:SHOWN]:
        tell(f"no result, {why}")


def _header(case: Case, goal: BlowGoal, first: SettingsCandidate) -> str:
    guess, seen = first.estimate, first.observation
    change = text_of(guess, "velocity_change")
    return (
        f"{goal_words(goal)}, from {case.name}: a half-sine changes the velocity by {change}, "
        f"for which a first estimate asks an approach of {text_of(guess, 'approach')}; the full run has "
        f"{text_of(seen, 'velocity_change')} and {text_of(seen, 'approach')}"
    )
