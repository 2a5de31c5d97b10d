"""A split-Hopkinson set-up as a command: read, reduce, print, draw."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from strikewave.analyses.hopkinson.build import HopkinsonCase, with_test
from strikewave.analyses.hopkinson.notices import digests
from strikewave.analyses.hopkinson.report import (
    draw_result,
    echo_tables,
    echo_words,
    sensor_tables,
    sensor_words,
    shot_tables,
    shot_words,
)
from strikewave.analyses.hopkinson.result import EchoSolution, HopkinsonSolution, SensorSolution, marked_text
from strikewave.analyses.hopkinson.run import run_hopkinson
from strikewave.reporting.output_options import Output
from strikewave.reporting.parts import Table
from strikewave.reporting.run_and_write import Command, case_folder, run_and_write
from strikewave.reporting.terminal import report_table

LEFT_OUT_FIRST = ("note", "derived", "noise (µε)", "Student's factor, 95 %", "freedom")
"""Columns that a narrow screen does without."""

AnySolution = HopkinsonSolution | SensorSolution | EchoSolution


def run_setup(case: HopkinsonCase, changes: Sequence[str], output: Output) -> int:
    """Reduce a set-up, write and print its result, and return the exit code."""
    case = with_test(case, output.stated_test())
    text = marked_text(case, digests(case))
    return run_and_write(SetupCommand(case), output, case_folder(case.setup.name or "shot", text, changes), text)


@dataclass(frozen=True)
class SetupCommand(Command[AnySolution]):
    """A shot, an accelerometer on the end of a bar, or the calibration of a bar, as the set-up says."""

    indent: ClassVar[int | None] = None

    case: HopkinsonCase

    def solve(self) -> AnySolution:
        """Return the solution."""
        return run_hopkinson(self.case)

    def summary(self, result: AnySolution) -> str:
        """Say what came out."""
        if isinstance(result, HopkinsonSolution):
            return shot_words(result)
        return sensor_words(result) if isinstance(result, SensorSolution) else echo_words(result)

    def show(self, result: AnySolution) -> None:
        """Print the tables of a result."""
        for shown in _tables(result):
            report_table(shown, more=LEFT_OUT_FIRST)

    def draw(self, result: AnySolution, folder: Path) -> list[str]:
        """Write page and summary."""
        return draw_result(result, folder)


def _tables(solution: AnySolution) -> list[Table]:
    """Return the tables of a result."""
    if isinstance(solution, HopkinsonSolution):
        return shot_tables(solution)
    return sensor_tables(solution) if isinstance(solution, SensorSolution) else echo_tables(solution)
