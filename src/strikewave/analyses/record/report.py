"""The report of measured records: files that were read in, one HTML page out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from strikewave.analyses.record import chapters as chapters
from strikewave.analyses.record import pictures as pictures
from strikewave.analyses.record.budget_chapter import budget_section
from strikewave.analyses.record.figures.many_spectra import several_figure
from strikewave.analyses.record.figures.spectra import record_summary, srs_figure
from strikewave.analyses.record.motion_chapter import motion_section
from strikewave.analyses.record.pair_chapter import pair_card, pair_section
from strikewave.analyses.record.response_chapter import response_sections
from strikewave.analyses.record.result import RecordResult
from strikewave.analyses.record.rigid_chapter import rigid_sections
from strikewave.analyses.record.sensor_chapter import sensor_section
from strikewave.analyses.record.spectrum import SpectrumResult
from strikewave.analyses.record.spectrum_report import spectrum_report
from strikewave.analyses.record.tables import amount, between, called, percent, short_names
from strikewave.analyses.record.test_report.page import report_of_test, write_report_of_test
from strikewave.analyses.record.verdicts.chapter import verdict_section
from strikewave.analyses.record.verdicts.words import tag_of_records
from strikewave.analyses.record.words import counted, doubted_peaks, peak_range, record_words
from strikewave.records.campaign import Campaign
from strikewave.records.reading import FileReading
from strikewave.reporting import chapters as shared
from strikewave.reporting.numbers import listed
from strikewave.reporting.parts import Tag
from strikewave.reporting.run_and_write import drawing
from strikewave.reporting.style import save, titled

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def record_report(result: RecordResult) -> str:
    """Return the report of measured records as one HTML page: no script, nothing fetched, the same bytes each time.

    Examples
    --------
    >>> page = record_report(RecordResult([]))
    >>> page.splitlines()[0], "No file was read." in page, "<script" in page
    ('<!doctype html>', True, False)
    """
    files, campaigns = result.readings, result.campaigns
    names = short_names([file.path for file in files])
    sections = [
        *([] if result.verdict is None else [verdict_section(result.verdict, names)]),
        *pictures.campaign_sections(campaigns, files, names),
        *response_sections(files, result.response_summaries, names),
        pictures.picture_section(files, names),
        pictures.response_section(files, names),
        chapters.file_section(files, names),
        chapters.health_section(files, names),
        chapters.blow_section(files, names),
        *([] if result.budget is None else [budget_section(result, names)]),
        *rigid_sections(files, names),
        *([] if result.sensor is None else [sensor_section(result.sensor, names)]),
        *chapters.mean_sections(campaigns, files, names),
        shared.warnings(result.notices),
        *([pair_section(result.pairs)] if result.pair else []),
        *([motion_section(result.motions)] if result.motion else []),
        chapters.filter_section(files, names, result.filter),
        chapters.calibration_section(files, names, result.calibrations),
    ]
    tag = _status(files) if result.verdict is None else tag_of_records(result.verdict, result.performed)
    numbers = [*([pair_card(result.pairs)] if result.pair else []), *_key_numbers(files, campaigns)]
    summary = shared.Summary("Report of measured records", record_words(result), numbers, tag)
    return shared.result_page(result, summary, sections)


def _status(files: Sequence[FileReading]) -> Tag:
    statuses = {file.status for file in files}
    look = "good" if statuses == {"good"} else "bad" if statuses <= {"bad"} else "warned"
    return Tag(listed(counted(files)) or "no file", look)


def _key_numbers(files: Sequence[FileReading], campaigns: Sequence[Campaign]) -> list[tuple[str, str]]:
    many = "files" if len(files) != 1 else "file"
    pairs = [(f"{many}: {listed(counted(files))}" if files else many, str(len(files)))]
    if not campaigns:
        return pairs
    first = campaigns[0]
    unit = first.unit
    for name in ("peak", "rigid_peak", "width", "velocity_change", "interval"):
        if name in first.statistics:
            one = first.statistics[name]
            label = f"{called(name, unit)}, {_of(one.n, name)}"
            if one.n > 1:
                label += f"; CV {percent(one.cv, 2)}; mean within {between(name, unit, one.low, one.high)}"
            label += _with_doubt(files, first, name, unit) if one.n == 1 else ""
            pairs.append((label, amount(name, unit, one.mean)))
    blows = doubted_peaks(first, files)
    if blows:
        pairs.append(("peak as read, in doubt", peak_range([blow.peak for blow in blows], unit)))
    rigid = [blow.rigid.peak for blow in blows if blow.rigid is not None]
    if blows and len(rigid) == len(blows):
        pairs.append(("peak without ringing, in doubt", peak_range(rigid, unit)))
    return pairs


def _with_doubt(files: Sequence[FileReading], campaign: Campaign, name: str, unit: str) -> str:
    """Return the expanded uncertainty of a figure of the only blow, where a budget gives one."""
    known = [
        one.figures[name]
        for file in files
        for reading in file.channels
        if reading.channel.name == campaign.channel
        for one in reading.uncertainties
        if name in one.figures
    ]
    if len(known) != 1 or not known[0].expanded > 0.0:
        return ""
    return f"; U = {amount(name, unit, known[0].expanded, 2)} (k = {known[0].coverage:.3g})"


def _of(n: int, name: str) -> str:
    what = "interval" if name == "interval" else "blow"
    return f"mean of {n} {what}s" if n > 1 else f"one {what}"


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
