"""A comparison as a command: read both, compare, print, draw."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from strikewave.analyses.compare.report import (
    agreement_tables,
    budget_words,
    clause_table,
    compare_words,
    draw_result,
    scaling_words,
)
from strikewave.analyses.compare.result import CompareResult
from strikewave.analyses.compare.run import CompareRequest, compared
from strikewave.analyses.compare.sources import parse_name, paths_of
from strikewave.base.result import Source
from strikewave.reporting import measured_files as measured
from strikewave.reporting.faces import face_table
from strikewave.reporting.output_options import Output
from strikewave.reporting.run_and_write import Command, run_and_write
from strikewave.reporting.terminal import report_table, tell

LONGEST_NAME = 40  # letters of each name in that of the folder


def compare_sources(a: str, b: str, request: CompareRequest, output: Output) -> int:
    """Compare two histories, write and print how well they agree, and return the exit code."""
    short = [re.sub(r"[^\w.+-]+", "-", Path(name).name).strip("-.")[:LONGEST_NAME] or "source" for name in (a, b)]
    usual = f"compare-{short[0]}-{short[1]}"
    paths = [path for name in (a, b) for path in paths_of(parse_name(name))] if output.writes(usual) else []
    name = measured.shown(f"{a} and {b}")
    origin = measured.source_of("comparison", name, list(dict.fromkeys(paths)), output.stated_test())
    return run_and_write(CompareCommand(a, b, request, origin), output, usual, origin.text)


@dataclass(frozen=True)
class CompareCommand(Command[CompareResult]):
    """Comparison of two histories."""

    indent: ClassVar[int | None] = None

    a: str
    b: str
    request: CompareRequest
    origin: Source

    def solve(self) -> CompareResult:
        """Return how well the two agree."""
        return compared(self.a, self.b, self.request, self.origin)

    def summary(self, result: CompareResult) -> str:
        """Say how well they agree."""
        return compare_words(result)

    def show(self, result: CompareResult) -> None:
        """Print the tables of a comparison."""
        tell(f"A: {result.a.name}")
        tell(f"B: {result.b.name}")
        if result.specified is not None:
            report_table(clause_table(result.specified), more=("of tolerance", "limit is", "why"))
            tell(result.specified.decision, "  ")
        figures, *tables = agreement_tables(result)
        report_table(figures)
        if result.budget is not None:
            tell(budget_words(result), "  ")
        for table in tables:
            report_table(table)
        tell(scaling_words(result), "  ")
        if result.in_bands:
            report_table(face_table(result, "in_bands"))
        if result.judged:
            report_table(face_table(result, "judged"), more=("of", "margin"))

    def draw(self, result: CompareResult, folder: Path) -> list[str]:
        """Write page and summary."""
        return draw_result(result, folder)
