"""Page and picture of records as files; a module of its own, for drawing takes long to import."""

from __future__ import annotations

from pathlib import Path

from strikewave.analyses.record.figures.spectra import record_summary
from strikewave.analyses.record.report import record_report
from strikewave.analyses.record.result import RecordResult
from strikewave.reporting.style import save


def draw_result(result: RecordResult, folder: Path) -> list[str]:
    """Write page and picture of records into a folder, and return their names."""
    save(record_summary(result.readings, result.campaigns[0] if result.campaigns else None), folder / "summary.svg")
    (folder / "report.html").write_text(record_report(result), "utf-8", newline="\n")
    return ["report.html", "summary.svg"]
