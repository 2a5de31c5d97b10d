"""Page and picture of a run of LS-DYNA as files; a module of its own, for drawing takes long to import."""

from __future__ import annotations

from pathlib import Path

from strikewave.analyses.fem.ls_dyna.figures import comparison_sheet
from strikewave.analyses.fem.ls_dyna.report import ls_dyna_report
from strikewave.analyses.fem.ls_dyna.result import LsDynaResult
from strikewave.reporting.style import save


def draw_result(result: LsDynaResult, folder: Path) -> list[str]:
    """Write page and picture into a folder, and return their names."""
    save(comparison_sheet(result.found, result.title), folder / "comparison.svg")
    (folder / "report.html").write_text(ls_dyna_report(result), "utf-8", newline="\n")
    return ["report.html", "comparison.svg"]
