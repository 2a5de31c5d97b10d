"""The reproduction of Li & Ma 2019 as a command: run, print, draw."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from strikewave.base.percents import percent
from strikewave.base.result import Notice
from strikewave.papers.li_ma_2019.execution import Report
from strikewave.papers.li_ma_2019.report.tables import findings_table, numbers_table, plain_rows
from strikewave.papers.li_ma_2019.reproduce import reproduce
from strikewave.papers.li_ma_2019.result import PAPER, Reproduction, marked_text
from strikewave.papers.li_ma_2019.runs import Effort
from strikewave.reporting.layout import MORE, keys, numerals, texts
from strikewave.reporting.options.output import Output
from strikewave.reporting.run_and_write import drawing, run_and_write
from strikewave.reporting.terminal import progress_bar, say, table, tell
from strikewave.studies.command import ResumableCommand
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.store import RunStore


def run_reproduction(command: ReproduceCommand, output: Output) -> int:
    """Reproduce the paper, write and print the result, and return the exit code.

    Raises
    ------
    InputError
        If the place is taken.
    """
    usual = f"{PAPER}-reproduced"
    return run_and_write(command, output, usual, marked_text(command.effort))


@dataclass
class ReproduceCommand(ResumableCommand[Reproduction]):
    """The reproduction of the paper; one that is stopped goes on where it was."""

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
        """Say what came out."""
        from strikewave.papers.li_ma_2019.report.page import reproduction_words

        return reproduction_words(result)

    def show(self, result: Reproduction) -> None:
        """Print the published numbers with what was computed, and what was found."""
        heads = ("published number", "published", "origin", "computed", "difference", "role", "by")
        rows = plain_rows(numbers_table([row for row in result.numbers if row.computed]), heads)
        columns = [
            *keys("published number"),
            *numerals("published"),
            *texts("origin", priority=MORE),
            *numerals("computed"),
        ]
        columns += [*numerals("difference"), *texts("role", priority=MORE), *texts("by")]
        table("Published numbers and what was computed", columns, rows)
        rows = plain_rows(findings_table(result.findings), ("topic", "found", "verdict"))
        table(
            "What the paper gets right, and what not",
            [*keys("topic"), *texts("found"), *texts("verdict")],
            rows,
        )
        tell("")
        tell(f"{len(result.notices)} warnings of the runs; the report lists them")

    def printed_notices(self, result: Reproduction) -> list[Notice]:
        """Return the broken limits: a page of warnings of twelve cases says nothing on a screen."""
        return [notice for notice in result.notices if notice.broken]

    def draw(self, result: Reproduction, folder: Path) -> list[str]:
        """Write page and pictures."""
        from strikewave.papers.li_ma_2019.report.figures import pictures
        from strikewave.papers.li_ma_2019.report.page import reproduction_report
        from strikewave.reporting.style import save

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

    def line(share: float, words: str) -> None:
        run = words.partition(":")[0]
        if run not in ("", reported[-1]):
            say(f"{percent(share, 0):>5}  {run}")
            reported.append(run)

    yield line
