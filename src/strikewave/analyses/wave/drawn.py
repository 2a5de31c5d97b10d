"""Page and pictures of a stack as files; a module of its own, for drawing takes long to import."""

from __future__ import annotations

from pathlib import Path

from strikewave.analyses.wave.field import field_of_solution
from strikewave.analyses.wave.figures.animation import wave_page, write_wave_gif
from strikewave.analyses.wave.figures.summary import wave_summary
from strikewave.analyses.wave.report import wave_report
from strikewave.analyses.wave.result import WaveSolution
from strikewave.reporting.run_and_write import drawing
from strikewave.reporting.style import save
from strikewave.reporting.terminal import progress_bar
from strikewave.reporting.wave_field import xt_diagram

picture, page = wave_summary, wave_report
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`."""


def draw_result(solution: WaveSolution, folder: Path, quantity: str = "stress", animate: bool = False) -> list[str]:
    """Write page and pictures of a stack into a folder, and return their names."""
    with drawing(folder / "summary.svg") as path:
        save(wave_summary(solution), path)
    with drawing(folder / "field.svg") as path:
        save(xt_diagram(field_of_solution(solution), quantity), path)
    with drawing(folder / "report.html") as path:
        path.write_text(wave_report(solution, quantity), "utf-8", newline="\n")
    moving = _animate(solution, folder) if animate else []
    return ["report.html", "summary.svg", "field.svg", *moving]


def _animate(solution: WaveSolution, folder: Path) -> list[str]:
    """Write the animation as a page and as a GIF, and return their names."""
    field = field_of_solution(solution)
    with drawing(folder / "animation.html") as path:
        page = wave_page(field, solution.title, solution.case.name)
        path.write_text(page, "utf-8", newline="\n")
    with drawing(folder / "animation.gif") as path, progress_bar("animation.gif", clocks=("left",)) as progress:
        write_wave_gif(field, solution.title, path, progress)
    return ["animation.html", "animation.gif"]
