"""Page and pictures of an element run as files; a module of its own, for drawing takes long to import."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from strikewave.analyses.fem.figures.animation import fem_page, movie_of, write_fem_gif
from strikewave.analyses.fem.figures.histories import summary_sheet
from strikewave.analyses.fem.report.page import fem_report
from strikewave.analyses.fem.result import FemSolution
from strikewave.reporting.run_and_write import drawing
from strikewave.reporting.style import save
from strikewave.reporting.terminal import progress_bar

if TYPE_CHECKING:
    from matplotlib.figure import Figure

page = fem_report
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`; so does `picture`."""


def picture(solution: FemSolution) -> Figure:
    """Return the sheet of histories of a run."""
    return summary_sheet(solution.run, solution.title)


def draw_result(solution: FemSolution, folder: Path, report: bool = True, animate: bool = False) -> list[str]:
    """Write page and pictures of a run into a folder, and return their names."""
    names = ["summary.svg"]
    with drawing(folder / names[0]) as path:
        save(picture(solution), path)
    if report:
        with drawing(folder / "report.html") as path:
            path.write_text(fem_report(solution), "utf-8", newline="\n")
        names.insert(0, "report.html")
    return names + (animate_run(solution, folder) if animate else [])


def animate_run(solution: FemSolution, folder: Path) -> list[str]:
    """Write the animation as a page and as a GIF, and return their names; nothing where nothing was kept."""
    with progress_bar("animation", clocks=("left",)) as progress:
        movie = movie_of(solution, progress=lambda share: progress(0.5 * share))
        if movie is None:
            return []
        with drawing(folder / "animation.html") as path:
            page = fem_page(movie, solution.title, solution.case.name)
            path.write_text(page, "utf-8", newline="\n")
        with drawing(folder / "animation.gif") as path:
            write_fem_gif(movie, solution.title, path, lambda share: progress(0.5 + 0.5 * share))
    return ["animation.html", "animation.gif"]
