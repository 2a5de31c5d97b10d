"""Page and picture of a set-up as files; a module of its own, for drawing takes long to import."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from strikewave.analyses.hopkinson.echo_result import EchoSolution
from strikewave.analyses.hopkinson.figures import echo_summary, sensor_summary, shot_summary
from strikewave.analyses.hopkinson.report.echoes import echo_report
from strikewave.analyses.hopkinson.report.sensor import sensor_report
from strikewave.analyses.hopkinson.report.shot import shot_report
from strikewave.analyses.hopkinson.result import HopkinsonSolution
from strikewave.analyses.hopkinson.sensor_result import SensorSolution
from strikewave.reporting.run_and_write import drawing
from strikewave.reporting.style import save

picture: dict[type, Callable[[Any], Figure]] = {
    HopkinsonSolution: shot_summary,
    SensorSolution: sensor_summary,
    EchoSolution: echo_summary,
}
page: dict[type, Callable[[Any], str]] = {
    HopkinsonSolution: shot_report,
    SensorSolution: sensor_report,
    EchoSolution: echo_report,
}
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`; so does `picture`."""


def draw_result(solution: HopkinsonSolution | SensorSolution | EchoSolution, folder: Path) -> list[str]:
    """Write page and picture of a set-up into a folder, and return their names."""
    with drawing(folder / "summary.svg") as path:
        save(picture[type(solution)](solution), path)
    with drawing(folder / "report.html") as path:
        path.write_text(page[type(solution)](solution), "utf-8", newline="\n")
    return ["report.html", "summary.svg"]
