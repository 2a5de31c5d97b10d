"""A design of a drop table as a command: run, print, draw."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path

from strikewave.cases.case import Case
from strikewave.reporting import measured_files as measured
from strikewave.reporting.clause_words import clause_columns
from strikewave.reporting.faces import face_columns
from strikewave.reporting.layout import keys, numerals, texts
from strikewave.reporting.options.output import Output
from strikewave.reporting.run_and_write import drawing, run_and_write
from strikewave.reporting.terminal import print_rows, progress_bar, table, tell
from strikewave.studies.command import ResumableCommand
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.runner import share_reporter
from strikewave.studies.engine.store import RunStore
from strikewave.studies.settings.drop_table.candidate import DropGoal
from strikewave.studies.settings.drop_table.study import (
    DropChoices,
    DropStudy,
    asked_line,
    design_drop_table,
    drop_columns,
    goal_words,
    name_of,
)
from strikewave.studies.settings.result import limit_columns

SHOWN = 8
"""First of the ranking in the table; the first of each other programmer follows."""
MOST_REASONS = 6
"""Reasons that are printed; the report has more."""


def find_drop_table(command: DropCommand, output: Output, usual_question: bool) -> int:
    """Search for designs, write and print them, and return the exit code.

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
class DropCommand(ResumableCommand[DropStudy]):
    """A search for designs of a drop table; one that is stopped goes on where it was."""

    case: Case
    goal: DropGoal
    choice: DropChoices
    pool: Pool

    def solved(self, store: RunStore) -> DropStudy:
        """Return the study, with a bar on stderr."""
        try:
            with progress_bar("settings") as report:
                study = design_drop_table(self.case, self.goal, self.choice, store, self.pool, share_reporter(report))
        except KeyboardInterrupt as stop:
            self.stopped_after(stop, store, "searches")
        return dataclasses.replace(study, asked=measured.asked())

    def summary(self, result: DropStudy) -> str:
        """Say which design is first, and what it gives."""
        from strikewave.studies.settings.drop_table.report import drop_words

        return drop_words(result)

    def show(self, result: DropStudy) -> None:
        """Print the ranking, the clauses and inputs of the first, and why others do not meet the goal."""
        first = result.candidates[0]
        leading = {one.programmer.name: one for one in reversed(result.candidates)}.values()
        shown = [one for one in result.candidates if one in result.candidates[:SHOWN] or one in leading]
        print_rows(f"{result.met_count} designs give {goal_words(result.goal)}", drop_columns(shown))
        tell("peak, width: as a sensor reads them whose zero is taken in the fall; margin: least of all clauses")
        tell("rebound: coefficient of restitution of the programmer, speed back over speed of arrival")
        reasons: dict[str, list[str]] = {}
        for one in shown:
            if not one.meets:
                reasons.setdefault(one.obstacles, []).append(f"#{one.place}")
        for obstacles, places in list(reasons.items())[:MOST_REASONS]:
            tell(f"{', '.join(places)}: {obstacles}")
        for name in dict.fromkeys(one.programmer.name for one in shown if one.programmer.assumed):
            tell(f"{name}: its law is assumed, nobody measured it")
        print_rows("Height of a free fall for this velocity change", face_columns(result, "heights"))
        print_rows("Clauses of the first", clause_columns(first.verdict.clauses))
        print_rows("Limits of the first", limit_columns(first.limits))
        values = first.case.values()
        inputs = [[path, str(value.typed), value.provenance] for path, value in values.items() if path in _INPUTS]
        table("Its inputs", [*keys("field"), *numerals("value"), *texts("provenance")], inputs)
        for why in result.failed[:MOST_REASONS]:
            tell(f"no result, {why}")

    def draw(self, result: DropStudy, folder: Path) -> list[str]:
        """Write page and picture."""
        from strikewave.reporting.style import save
        from strikewave.studies.settings.drop_table.figures import drop_figure
        from strikewave.studies.settings.drop_table.report import drop_report

        with drawing(folder / "settings.svg") as path:
            save(drop_figure(result), path)
        with drawing(folder / "report.html") as path:
            path.write_text(drop_report(result), "utf-8", newline="\n")
        return ["report.html", "settings.svg"]


_INPUTS = (
    *("machine.height", "machine.friction", "striker.mass", "object.mass", "object.frame_stiffness"),
    *("contact.restitution", "contact.reference_force", "contact.reference_depth"),
    *("contact.cushion.diameter", "contact.cushion.thickness", "contact.cushion.modulus", "contact.cushion.stress"),
    *("contact.cushion.exponent", "contact.cushion.retardation", "contact.cushion.limit_strain"),
)
"""Inputs that are printed; the report has all."""
