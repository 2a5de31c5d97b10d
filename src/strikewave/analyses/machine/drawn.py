"""Page and pictures of a run as files; a module of its own, for drawing takes long to import."""

from __future__ import annotations

from pathlib import Path

from strikewave.analyses.machine.figures.animation import machine_page, write_machine_gif
from strikewave.analyses.machine.figures.summary import summary
from strikewave.analyses.machine.report import report
from strikewave.analyses.machine.result import Solution
from strikewave.reporting.run_and_write import drawing
from strikewave.reporting.style import save
from strikewave.reporting.terminal import progress_bar, say
from strikewave.uncertainty.beside import computed_beside

picture, page = summary, report
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`."""


def draw_result(solution: Solution, folder: Path, animate: bool = False) -> list[str]:
    """Write page and pictures of a run into a folder, and return their names."""

    def sheet() -> bool:
        save(summary(solution), folder / "summary.svg")
        return True

    with computed_beside(sheet) as is_written:
        moving = _animate(solution, folder) if animate else []
        with drawing(folder / "report.html") as path:
            page = report(solution, moving=moving[0] if moving else "")
            path.write_text(page, "utf-8", newline="\n")
        with drawing(folder / "summary.svg"):
            if not is_written():
                sheet()
    return ["report.html", "summary.svg", *moving]


def _animate(solution: Solution, folder: Path) -> list[str]:
    """Write the machine in motion as a page and as a GIF, and return their names."""
    with drawing(folder / "machine.html") as path:
        page = machine_page(solution)
        if page is None:
            say("no animation: only the rotary machine can be shown in motion")
            return []
        path.write_text(page, "utf-8", newline="\n")
    with drawing(folder / "machine.gif") as path, progress_bar("machine.gif", clocks=("left",)) as progress:
        write_machine_gif(solution, path, progress)
    return [name for name in ("machine.html", "machine.gif") if (folder / name).exists()]
