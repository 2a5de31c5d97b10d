"""Page and pictures of a comparison as files; a module of its own, for drawing takes long to import."""

from __future__ import annotations

from pathlib import Path

from strikewave.analyses.compare.figures import summary_figure
from strikewave.analyses.compare.report import compare_report
from strikewave.analyses.compare.result import CompareResult
from strikewave.reporting.run_and_write import drawing
from strikewave.reporting.style import save

picture, page = summary_figure, compare_report
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`."""


def draw_result(result: CompareResult, folder: Path) -> list[str]:
    """Write page and summary of a comparison into a folder, and return their names."""
    with drawing(folder / "summary.svg") as path:
        save(summary_figure(result), path)
    with drawing(folder / "report.html") as path:
        path.write_text(compare_report(result), "utf-8", newline="\n")
    return ["report.html", "summary.svg"]
