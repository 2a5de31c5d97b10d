"""Page and picture of a set-up as files; a module of its own, for drawing takes long to import."""

from __future__ import annotations

from pathlib import Path

from strikewave.analyses.hopkinson.echo_result import EchoSolution
from strikewave.analyses.hopkinson.figures import echo_summary, sensor_summary, shot_summary
from strikewave.analyses.hopkinson.report import echo_report, sensor_report, shot_report
from strikewave.analyses.hopkinson.result import HopkinsonSolution
from strikewave.analyses.hopkinson.sensor_result import SensorSolution
from strikewave.reporting.style import save


def draw_result(solution: HopkinsonSolution | SensorSolution | EchoSolution, folder: Path) -> list[str]:
    """Write page and picture of a set-up into a folder, and return their names."""
    if isinstance(solution, HopkinsonSolution):
        picture, page = shot_summary(solution), shot_report(solution)
    elif isinstance(solution, SensorSolution):
        picture, page = sensor_summary(solution), sensor_report(solution)
    else:
        picture, page = echo_summary(solution), echo_report(solution)
    save(picture, folder / "summary.svg")
    (folder / "report.html").write_text(page, "utf-8", newline="\n")
    return ["report.html", "summary.svg"]
