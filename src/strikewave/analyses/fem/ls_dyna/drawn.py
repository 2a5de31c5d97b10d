"""Page and picture of a run of LS-DYNA as files; a module of its own, for drawing takes long to import."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from strikewave.analyses.fem.ls_dyna.figures import comparison_sheet
from strikewave.analyses.fem.ls_dyna.report import ls_dyna_report
from strikewave.analyses.fem.ls_dyna.result import LsDynaResult
from strikewave.reporting.run_and_write import drawing
from strikewave.reporting.style import save

if TYPE_CHECKING:
    from matplotlib.figure import Figure

page = ls_dyna_report
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`; so does `picture`."""


def picture(result: LsDynaResult) -> Figure:
    """Return the sheet of forces and energies."""
    return comparison_sheet(result.found, result.title)


def draw_result(result: LsDynaResult, folder: Path) -> list[str]:
    """Write page and picture into a folder, and return their names."""
    with drawing(folder / "comparison.svg") as path:
        save(picture(result), path)
    with drawing(folder / "report.html") as path:
        path.write_text(ls_dyna_report(result), "utf-8", newline="\n")
    return ["report.html", "comparison.svg"]
