"""A search for settings of a machine as a command: run, print, draw."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, TypeVar

from strikewave.cases.case import Case
from strikewave.reporting import measured_files as measured
from strikewave.reporting.clause_words import clause_columns
from strikewave.reporting.faces import face_columns, text_of
from strikewave.reporting.layout import keys, numerals, texts
from strikewave.reporting.options.output import Output
from strikewave.reporting.run_and_write import run_and_write
from strikewave.reporting.terminal import print_rows, progress_bar, table, tell
from strikewave.studies.command import ResumableCommand
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.runner import share_reporter
from strikewave.studies.engine.store import RunStore
from strikewave.studies.settings.candidate import SettingsCandidate
from strikewave.studies.settings.drop_table.candidate import DropCandidate
from strikewave.studies.settings.drop_table.study import DropStudy
from strikewave.studies.settings.search import MachineSearch, asked_line, limit_columns
from strikewave.studies.settings.study import SettingsStudy

Row = TypeVar("Row", SettingsCandidate, DropCandidate)

SHOWN, SHOWN_DESIGNS = 6, 8
"""First of the ranking in the table, of settings and of drop tables; the first of each other kind follows."""
MOST_REASONS = 6
"""Reasons that are printed; the report has more."""


@dataclass
class SearchCommand(ResumableCommand[MachineSearch]):
    """A search for settings that meet a goal; one that is stopped goes on where it was.

    Attributes
    ----------
    search : callable
        `design_settings` or `design_drop_table`.
    case : Case
        What is not chosen.
    goal, choice
        What is asked, and what may be chosen.
    pool : Pool
        Who runs it.
    """

    search: Callable[..., MachineSearch]
    case: Case
    goal: Any
    choice: Any
    pool: Pool

    def run(self, output: Output, usual_question: bool) -> int:
        """Search for settings, write and print them, and return the exit code.

        ``usual_question`` says that nothing but the goal was asked: only then the folder has its name alone.

        Raises
        ------
        InputError
            If the place is taken.
        """
        asked = asked_line(self.case, self.goal, self.choice)
        return run_and_write(self, output, self.goal.name + ("" if usual_question else f"-{asked[-10:-2]}"), asked)

    def solved(self, store: RunStore) -> MachineSearch:
        """Return the study, with a bar on stderr."""
        try:
            with progress_bar("settings") as report:
                study = self.search(self.case, self.goal, self.choice, store, self.pool, share_reporter(report))
        except KeyboardInterrupt as stop:
            self.stopped_after(stop, store, "searches")
        return dataclasses.replace(study, asked=measured.asked())

    def summary(self, result: MachineSearch) -> str:
        """Say which settings are first, and what they give."""
        return result.words

    def show(self, result: MachineSearch) -> None:
        """Print the ranking, what the first is judged by, and what gave no result."""
        if isinstance(result, SettingsStudy):
            _show_settings(result)
        elif isinstance(result, DropStudy):
            _show_designs(result)
        for why in result.failed[:MOST_REASONS]:
            tell(f"no result, {why}")


def _shown(candidates: tuple[Row, ...], most: int, kind: Callable[[Row], object]) -> Iterator[Row]:
    """Yield the first of the ranking, and the first of each other kind."""
    leading = list({kind(one): one for one in reversed(candidates)}.values())
    yield from (one for k, one in enumerate(candidates) if k < most or one in leading)


def _show_settings(study: SettingsStudy) -> None:
    first = study.candidates[0]
    shown = list(_shown(study.candidates, SHOWN, lambda one: one.strikers))
    print_rows(f"{study.met_count} settings give {study.goal.words}", study.columns_of(shown))
    tell(
        "peak, width, interval: of the typical blow, the median of the later full ones; CV: scatter of all peaks; "
        "sensitivity: change of the peak with engagement"
    )
    guess, seen = first.estimate, first.observation
    tell(
        f"{study.goal.words}, from {study.case.name}: a half-sine changes the velocity by "
        f"{text_of(guess, 'velocity_change')}, for which a first estimate asks an approach of "
        f"{text_of(guess, 'approach')}; the full run has {text_of(seen, 'velocity_change')} and "
        f"{text_of(seen, 'approach')}"
    )
    print_rows("Limits of the first", limit_columns(first.limits))
    if first.clauses:
        print_rows("Clauses of the first, each by its worst blow", clause_columns(first.clauses))
    if len(study.masses) > 1:
        print_rows("What the mass of a striker costs", study.columns_of(study.masses, "mass"))
    for one in study.left_out:
        tell(f"left out, {one.strikers} strikers: {one.why}")


def _show_designs(study: DropStudy) -> None:
    first = study.candidates[0]
    shown = list(_shown(study.candidates, SHOWN_DESIGNS, lambda one: one.programmer.name))
    print_rows(f"{study.met_count} designs give {study.goal.words}", study.columns_of(shown))
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
    print_rows("Height of a free fall for this velocity change", face_columns(study, "heights"))
    print_rows("Clauses of the first", clause_columns(first.verdict.clauses))
    print_rows("Limits of the first", limit_columns(first.limits))
    values = first.case.values()
    inputs = [[path, str(value.typed), value.provenance] for path, value in values.items() if path in INPUTS]
    table("Its inputs", [*keys("field"), *numerals("value"), *texts("provenance")], inputs)


INPUTS = (
    *("machine.height", "machine.friction", "striker.mass", "object.mass", "object.frame_stiffness"),
    *("contact.restitution", "contact.reference_force", "contact.reference_depth"),
    *("contact.cushion.diameter", "contact.cushion.thickness", "contact.cushion.modulus", "contact.cushion.stress"),
    *("contact.cushion.exponent", "contact.cushion.retardation", "contact.cushion.limit_strain"),
)
"""Inputs of a drop table that are printed; the report has all."""
