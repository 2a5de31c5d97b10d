"""Report of measured records as one HTML page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from strikewave.analyses.record import chapters
from strikewave.analyses.record.budget_chapter import budget_section
from strikewave.analyses.record.chapters import (
    motion_section,
    pair_card,
    pair_section,
    response_sections,
    rigid_sections,
    same_channel,
    sensor_section,
)
from strikewave.analyses.record.figures import records, spectra
from strikewave.analyses.record.figures.records import trend
from strikewave.analyses.record.figures.spectra import record_summary, several_figure, srs_figure
from strikewave.analyses.record.laboratory_report import report_of_test, write_report_of_test
from strikewave.analyses.record.result import RecordResult
from strikewave.analyses.record.rows import advised_filter, shown_response
from strikewave.analyses.record.sentences import counted, doubted_peaks, peak_range, record_words, tag_of_records
from strikewave.analyses.record.spectrum import SpectrumResult
from strikewave.analyses.record.spectrum_report import spectrum_report
from strikewave.analyses.record.tables import Names, between, called, figure_text, percents, short_names
from strikewave.analyses.record.verdict_chapter import verdict_section
from strikewave.records.campaign import Campaign
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.reporting import chapters as shared
from strikewave.reporting.numbers import listed
from strikewave.reporting.parts import Part, Picture, Section, Tag
from strikewave.reporting.run_and_write import drawing
from strikewave.reporting.style import save, titled

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def record_report(result: RecordResult) -> str:
    """Return the report of measured records as one HTML page: no script, nothing fetched, the same bytes each time."""
    files, campaigns = result.readings, result.campaigns
    names = short_names([file.path for file in files])
    sections = [
        *([] if result.verdict is None else [verdict_section(result.verdict, names)]),
        *campaign_sections(campaigns, files, names),
        *response_sections(files, result.response_summaries, names),
        picture_section(files, names),
        response_section(files, names),
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
                label += f"; CV {percents(one.cv, 2)}; mean within {between(name, unit, one.low, one.high)}"
            label += _with_doubt(files, first, name, unit) if one.n == 1 else ""
            pairs.append((label, figure_text(name, unit, one.mean)))
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
    return f"; U = {figure_text(name, unit, known[0].expanded, 2)} (k = {known[0].coverage:.3g})"


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
# Pages of the results in Python, found as `picture` is by `strikewave.reporting.shown_result`
page: dict[type, Callable[[Any], str]] = {RecordResult: record_report, SpectrumResult: spectrum_report}
test_page: dict[type, Callable[[Any], str]] = {RecordResult: report_of_test}  # the same for a test report


def draw_result(result: RecordResult, folder: Path) -> list[str]:
    """Write page and picture of records into a folder, and return their names."""
    with drawing(folder / "summary.svg") as path:
        save(record_picture(result), path)
    with drawing(folder / "report.html") as path:
        path.write_text(record_report(result), "utf-8", newline="\n")
    return ["report.html", *write_report_of_test(result, folder), "summary.svg"]


MOST_FILES = 6  # files of which there are pictures: each adds some 100 kB to a page that must open at once
MOST_DRAWN = 12  # channels of which there are pictures, in all files together: two of each file


def campaign_sections(campaigns: Sequence[Campaign], files: Sequence[FileReading], names: Names) -> list[Section]:
    """Draw the blows of each channel over each other, and its figures over the files; nothing where no blow is."""
    sections = []
    for campaign in campaigns:
        parts: list[Part] = []
        named = [(names[path], reading) for path, reading in same_channel(files, campaign)]
        if any(reading.pulses and reading.status != "bad" for _, reading in named):
            several = sum(len(reading.pulses) for _, reading in named) > 1
            words = "Blows of the files over each other; bad records are left out." if several else "The only blow."
            parts.append(Picture(records.overlay(named), words))
        if len({k for pairs in campaign.points.values() for k, _ in pairs}) > 1:
            words = "Figures over the files, in the order in which they were given. What was left out is not drawn."
            parts.append(Picture(trend(campaign, len(files)), words))
        if parts:
            title = f"Pulses: {campaign.channel}" if len(campaigns) > 1 else "Pulses"
            sections.append(Section(title, "", parts))
    return sections


def picture_section(files: Sequence[FileReading], names: Names) -> Section:
    """Draw records, velocities and amplitude spectra."""
    chosen, advised = _chosen(files), advised_filter(files)
    each = max(MOST_DRAWN // max(len(chosen), 1), 1)
    parts: list[Part] = []
    words = []
    for file in chosen:
        for reading in file.channels[:each]:
            if reading.responses:
                continue  # a chapter of its own draws it
            if records.drawable(reading):
                parts += _pictures(names[file.path], reading, None if advised is None else advised.cutoff)
            else:
                words.append(f"{names[file.path]}, {reading.channel.name} holds nothing that could be drawn.")
    if len(chosen) < len([file for file in files if file.channels]):
        words.append(
            f"{len(chosen)} of {len(files)} files are drawn: the first that are not good, and the first good ones."
        )
    if any(len(file.channels) > each for file in chosen):
        words.append(f"Of each, the first {'channel is' if each == 1 else f'{each} channels are'} drawn.")
    return Section("Records", " ".join(words) or ("" if parts else "There is no record to draw."), parts)


def _chosen(files: Sequence[FileReading]) -> list[FileReading]:
    """Return the files that are drawn: all of a few, else the first three that are not good and the first good."""
    have = [k for k, file in enumerate(files) if file.channels]
    if len(have) > MOST_FILES:
        faulty = [k for k in have if files[k].status != "good"]
        good = [k for k in have if files[k].status == "good"]
        many = min(len(faulty), max(MOST_FILES // 2, MOST_FILES - len(good)))
        have = sorted([*faulty[:many], *good[: MOST_FILES - many]])
    return [files[k] for k in have]


def _pictures(name: str, reading: ChannelReading, advised: float | None) -> list[Part]:
    who = f"{name}, {reading.channel.name}"
    count = len(reading.pulses)
    blows = "no blow" if not count else "one blow" if count == 1 else f"{count} blows"
    text = f"{who}: {reading.status}, {blows}."
    if not reading.pulses:
        return [Picture(records.history(reading), f"{text} There is no velocity and no spectrum without a blow.")]
    unit = reading.channel.unit
    peaks = [figure_text("peak", unit, pulse.peak) for pulse in reading.pulses[:3]]
    return [
        Picture(
            records.history(reading),
            f"{text} The whole record, and the largest blow with its smooth pulse.",
            f"Record of {who}, {blows}: peaks {listed(peaks)}" + (" and more." if count > 3 else "."),
        ),
        Picture(
            records.velocity(reading),
            f"{who}: the integral of the record; the baseline before the first blow is taken off.",
        ),
        Picture(
            spectra.spectrum(reading, advised),
            f"{who}: amplitude spectrum |X(f)| of the stretch around the largest blow. At low frequency it is the "
            f"{called('velocity_change', unit)}.",
        ),
    ]


def response_section(files: Sequence[FileReading], names: Names) -> Section:
    """Draw the shock response spectra of the first good record."""
    title = "Shock response spectrum"
    best = shown_response(files)
    if best is None:
        return Section(title, "No record that is not bad holds a blow and an acceleration: there is no spectrum.")
    file, reading = best
    absolute = spectra.response(reading)
    if absolute is None:
        return Section(title, "The record is too short beside its blow for a spectrum.")
    who = f"{names[file.path]}, {reading.channel.name}"
    text = (
        f"Of {who}, the first that is {reading.status}: from just before its first blow to {spectra.AFTER:g} lengths "
        f"of the last one after it, baseline taken off, Q = {spectra.Q:g} (5 % of critical damping), 12 natural "
        "frequencies an octave. The oscillators swing on after the record."
    )
    harmed = [f.code for f in reading.findings if "spectrum" in f.harms]
    if harmed:
        text += f" Not to be trusted without a look at the findings {listed(harmed)}."
    unit = reading.channel.unit
    parts: list[Part] = [
        Picture(
            spectra.srs_figure(absolute, unit=unit),
            "Largest response of oscillators whose base moves as the record says, over their natural frequency: "
            "upwards (positive), downwards (negative), and the larger of both (maximax).",
        )
    ]
    pseudo = spectra.response(reading, "pseudo-velocity") if unit == "m/s^2" else None
    if pseudo is not None:
        words = (
            "The same record as pseudo-velocity on four-coordinate paper: rising lines are those of one relative "
            "displacement, falling ones those of one acceleration."
        )
        parts.append(Picture(spectra.tripartite(pseudo), words))
    return Section(title, text, parts)
