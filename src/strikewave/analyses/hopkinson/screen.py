"""The command of a split-Hopkinson set-up: read, reduce, print, draw."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from strikewave.analyses.hopkinson.build import HopkinsonCase, with_test
from strikewave.analyses.hopkinson.notices import digests
from strikewave.analyses.hopkinson.report import KINDS, AnySolution, page, picture
from strikewave.analyses.hopkinson.result import marked_text
from strikewave.analyses.hopkinson.run import run_hopkinson
from strikewave.reporting.output_options import Output
from strikewave.reporting.run_and_write import Command, case_folder, drawing, run_and_write
from strikewave.reporting.style import save
from strikewave.reporting.terminal import report_table

LEFT_OUT_FIRST = ("note", "derived", "noise (µε)", "Student's factor, 95 %", "freedom")
"""Columns that a narrow screen does without."""


def run_setup(case: HopkinsonCase, changes: Sequence[str], output: Output) -> int:
    """Reduce a set-up, write and print its result, and return the exit code."""
    case = with_test(case, output.stated_test())
    text = marked_text(case, digests(case))
    return run_and_write(SetupCommand(case), output, case_folder(case.setup.name or "shot", text, changes), text)


@dataclass(frozen=True)
class SetupCommand(Command[AnySolution]):
    """The reduction of a set-up: a shot, an accelerometer on the end of a bar, or the calibration of a bar."""

    indent: ClassVar[int | None] = None

    case: HopkinsonCase

    def solve(self) -> AnySolution:
        """Return the solution."""
        return run_hopkinson(self.case)

    def summary(self, result: AnySolution) -> str:
        """Return the result in a sentence."""
        return KINDS[type(result)].summary(result)

    def show(self, result: AnySolution) -> None:
        """Print the tables of a result."""
        for table in KINDS[type(result)].tables(result):
            report_table(table, more=LEFT_OUT_FIRST)

    def draw(self, result: AnySolution, folder: Path) -> list[str]:
        """Write page and picture."""
        with drawing(folder / "summary.svg") as path:
            save(picture(result), path)
        with drawing(folder / "report.html") as path:
            path.write_text(page(result), "utf-8", newline="\n")
        return ["report.html", "summary.svg"]
