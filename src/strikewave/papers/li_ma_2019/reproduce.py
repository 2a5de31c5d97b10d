"""The reproduction of Li & Ma 2019: runs everything, compares it with the published numbers, prints and draws it."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from strikewave.base.declare import MORE
from strikewave.base.result import Notice, Verdicts
from strikewave.base.texts import percent
from strikewave.papers.li_ma_2019.compared_numbers import number_rows
from strikewave.papers.li_ma_2019.element_pulses import element_numbers
from strikewave.papers.li_ma_2019.element_studies import ElementStudies, run_element_studies
from strikewave.papers.li_ma_2019.equations import equation_rows
from strikewave.papers.li_ma_2019.findings import ELASTIC, QUIET, REFLECTING, WAVE, findings, machine_findings
from strikewave.papers.li_ma_2019.published import consistency_checks, published_number, published_numbers
from strikewave.papers.li_ma_2019.report_tables import findings_table, numbers_table, plain_rows
from strikewave.papers.li_ma_2019.result import PAPER, Reproduction, notices_of
from strikewave.papers.li_ma_2019.runs import (
    QUIET_ELEMENTS,
    QUIET_WAVE_ELEMENTS,
    RIGID_ELEMENTS,
    Effort,
    Report,
    executing,
    run_all,
    silent,
)
from strikewave.papers.li_ma_2019.unknowns import run_unknowns
from strikewave.reporting.layout import keys, numerals, texts
from strikewave.reporting.run_and_write import drawing
from strikewave.reporting.style import save
from strikewave.reporting.terminal import progress_bar, say, table, tell
from strikewave.studies.command import ResumableCommand
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.store import RunStore

RUNS, MAPS = 0.45, 0.05
"""Rough shares of time of the runs of the figures and of the maps, the rest for the studies; for the progress bar
alone."""


def reproduce(
    effort: Effort, report: Report = silent, store: RunStore | None = None, pool: Pool | None = None
) -> Reproduction:
    """Reproduce Li & Ma 2019.

    ``report`` takes the share done, 0 to 1, and the current stage; ``store`` has finished runs and the states of
    stopped ones; ``pool`` makes the runs of maps and studies, this process without one.
    """
    report(0.0, "equations")
    equations = equation_rows()
    studied = effort.studies and effort.elements and not effort.quick
    mapped = effort.studies and not effort.quick
    # without studies the elements take nearly all of the time, without elements the maps do
    ends = (RUNS, RUNS + MAPS) if studied else (0.9, 1.0) if effort.elements else (0.1, 1.0)
    with executing(store, pool, effort.threads, report) as execution:
        runs = run_all(effort, execution.within(0.0, ends[0]))
        unknowns = run_unknowns(not mapped, execution.within(*ends))
        studies = run_element_studies(execution.within(ends[1], 1.0)) if studied else ElementStudies()
    checks = consistency_checks()
    named = {QUIET: QUIET_ELEMENTS, REFLECTING: RIGID_ELEMENTS, WAVE: QUIET_WAVE_ELEMENTS}
    solutions = {name: runs.element_solution(case) for name, case in named.items()}
    solutions[ELASTIC] = studies.elastic
    measured = {name: None if solution is None else element_numbers(solution) for name, solution in solutions.items()}
    numbers = number_rows(published_numbers(), runs, unknowns.ranges())
    low, high, _ = unknowns.direct_peak
    buffered = published_number("buffered peak").value
    rows = findings(equations, checks, measured, (low / buffered, high / buffered))
    rows += machine_findings(runs, unknowns.joints)
    verdicts = Verdicts(text for _, text in runs.checked)
    parts = runs, equations, numbers, checks, rows, unknowns, studies, effort
    return Reproduction(*parts, notices=notices_of(runs), citations=(PAPER,), verdicts=verdicts)


@dataclass
class ReproduceCommand(ResumableCommand[Reproduction]):
    """The command that reproduces the paper; a stopped one continues where it was."""

    of_test: ClassVar[bool] = False
    indent: ClassVar[int | None] = 2

    effort: Effort
    pool: Pool

    def solved(self, store: RunStore) -> Reproduction:
        """Return the result, with a bar on stderr."""
        try:
            with progress() as report:
                return reproduce(self.effort, report, store, self.pool)
        except KeyboardInterrupt as stop:
            self.stopped_after(stop, store)

    def summary(self, result: Reproduction) -> str:
        """Say what resulted."""
        from strikewave.papers.li_ma_2019.report import reproduction_words

        return reproduction_words(result)

    def show(self, result: Reproduction) -> None:
        """Print the published numbers with what was computed, and the findings."""
        heads = ("published number", "published", "origin", "computed", "difference", "role", "by")
        rows = plain_rows(numbers_table([row for row in result.numbers if row.computed]), heads)
        columns = [
            *keys("published number"),
            *numerals("published"),
            *texts("origin", priority=MORE),
            *numerals("computed", "difference"),
            *texts("role", priority=MORE),
            *texts("by"),
        ]
        table("Published numbers and what was computed", columns, rows)
        rows = plain_rows(findings_table(result.findings), ("topic", "found", "verdict"))
        table("What the paper gets right, and what not", [*keys("topic"), *texts("found", "verdict")], rows)
        tell("")
        tell(f"{len(result.notices)} warnings of the runs; the report lists them")

    def printed_notices(self, result: Reproduction) -> list[Notice]:
        """Return the broken limits: a page of warnings of twelve cases says nothing on a screen."""
        return [notice for notice in result.notices if notice.broken]

    def draw(self, result: Reproduction, folder: Path) -> list[str]:
        """Write page and pictures."""
        from strikewave.papers.li_ma_2019.report import pictures, reproduction_report

        names = ["report.html"]
        with drawing(folder / names[0]) as path:
            path.write_text(reproduction_report(result), "utf-8", newline="\n")
        for name, figure in pictures(result):
            with drawing(folder / f"{name}.svg") as path:
                save(figure, path)
            names.append(f"{name}.svg")
        return names


@contextlib.contextmanager
def progress() -> Iterator[Report]:
    """Show a bar on stderr where that is a terminal, or else a line for each run."""
    if sys.stderr.isatty():
        with progress_bar("") as report:
            yield report
        return
    reported = [""]

    def line(share: float, stage: str) -> None:
        run = stage.partition(":")[0]
        if run not in ("", reported[-1]):
            say(f"{percent(share, 0):>5}  {run}")
            reported.append(run)

    yield line
