"""Page and picture of records as files; a module of its own, for drawing takes long to import."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from strikewave.analyses.record.figures.many_spectra import several_figure
from strikewave.analyses.record.figures.spectra import record_summary, srs_figure
from strikewave.analyses.record.report import record_report
from strikewave.analyses.record.result import RecordResult
from strikewave.analyses.record.spectrum import SpectrumResult
from strikewave.analyses.record.spectrum_report import spectrum_report
from strikewave.analyses.record.test_report.page import report_of_test, write_report_of_test
from strikewave.reporting.run_and_write import drawing
from strikewave.reporting.style import save, titled

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def record_picture(result: RecordResult) -> Figure:
    """Return the records with what is measured of them."""
    return record_summary(result.readings, result.campaigns[0] if result.campaigns else None)


def spectrum_picture(result: SpectrumResult) -> Figure:
    """Return the first spectrum over frequency, or all of several."""
    unit = result.reading.channel.unit
    if result.shocks:
        return titled(several_figure(result, 0), result.title)
    figure = srs_figure(result.spectra[0], unit=unit, expanded=result.expanded(0), side=result.side)
    return titled(figure, result.title)


picture: dict[type, Callable[[Any], Figure]] = {RecordResult: record_picture, SpectrumResult: spectrum_picture}
page: dict[type, Callable[[Any], str]] = {RecordResult: record_report, SpectrumResult: spectrum_report}
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`; so does `picture`."""
test_page: dict[type, Callable[[Any], str]] = {RecordResult: report_of_test}
"""The same for a test report."""


def draw_result(result: RecordResult, folder: Path) -> list[str]:
    """Write page and picture of records into a folder, and return their names."""
    with drawing(folder / "summary.svg") as path:
        save(record_picture(result), path)
    with drawing(folder / "report.html") as path:
        path.write_text(record_report(result), "utf-8", newline="\n")
    return ["report.html", *write_report_of_test(result, folder), "summary.svg"]
