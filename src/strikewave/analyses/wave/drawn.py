"""Page and pictures of a stack as files; a module of its own, for drawing takes long to import."""

from __future__ import annotations

from pathlib import Path

from strikewave.analyses.wave.field import bar_field
from strikewave.analyses.wave.figures.animation import wave_page, write_wave_gif
from strikewave.analyses.wave.figures.summary import bar_summary
from strikewave.analyses.wave.report import bar_report
from strikewave.analyses.wave.result import BarSolution
from strikewave.reporting.style import save
from strikewave.reporting.terminal import progress_bar
from strikewave.reporting.wave_field import xt_diagram


def draw_result(solution: BarSolution, folder: Path, quantity: str = "stress", animate: bool = False) -> list[str]:
    """Write page and pictures of a stack into a folder, and return their names."""
    save(bar_summary(solution), folder / "summary.svg")
    save(xt_diagram(bar_field(solution), quantity), folder / "field.svg")
    (folder / "report.html").write_text(bar_report(solution, quantity), "utf-8", newline="\n")
    moving = _animate(solution, folder) if animate else []
    return ["report.html", "summary.svg", "field.svg", *moving]


def _animate(solution: BarSolution, folder: Path) -> list[str]:
    """Write the animation as a page and as a GIF, and return their names."""
    field = bar_field(solution)
    page = wave_page(field, solution.title, solution.case.name)
    (folder / "animation.html").write_text(page, "utf-8", newline="\n")
    with progress_bar("animation.gif", clocks=("left",)) as progress:
        write_wave_gif(field, solution.title, folder / "animation.gif", progress)
    return ["animation.html", "animation.gif"]
