"""The report of measured records: files that were read in, one HTML page out."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from strikewave.analyses.record import chapters as chapters
from strikewave.analyses.record import pictures as pictures
from strikewave.analyses.record.result import RecordResult
from strikewave.analyses.record.tables import amount, between, called, percent, rows_of, short_names, unit_of
from strikewave.records.campaign import Campaign
from strikewave.records.health_notice import STATUSES
from strikewave.records.reading import FileReading
from strikewave.reporting import chapters as shared
from strikewave.reporting.numbers import listed
from strikewave.reporting.parts import Tag

MOST_REASONS = 4
"""Bad records whose reason the summary gives: more are counted, and stand in the table of findings."""


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
        *pictures.campaign_sections(campaigns, files, names),
        pictures.picture_section(files, names),
        pictures.response_section(files, names),
        chapters.file_section(files, names),
        chapters.health_section(files, names),
        chapters.blow_section(files, names),
        *(chapters.campaign_section(one, files, names, len(campaigns) > 1) for one in campaigns),
        shared.warnings(result.notices),
        chapters.filter_section(files, names, result.filter),
        chapters.calibration_section(files, names, result.calibrations),
    ]
    summary = shared.Summary(
        "Report of measured records", _summary(files, campaigns, names), _key_numbers(files, campaigns), _status(files)
    )
    return shared.result_page(result, summary, sections)


def _counts(files: Sequence[FileReading]) -> list[str]:
    """Return how many files there are of each status, in words."""
    statuses = [file.status for file in files]
    return [f"{statuses.count(status)} {status}" for status in STATUSES if status in statuses]


def _status(files: Sequence[FileReading]) -> Tag:
    statuses = {file.status for file in files}
    look = "good" if statuses == {"good"} else "bad" if statuses <= {"bad"} else "warned"
    return Tag(listed(_counts(files)) or "no file", look)


def _key_numbers(files: Sequence[FileReading], campaigns: Sequence[Campaign]) -> list[tuple[str, str]]:
    many = "files" if len(files) != 1 else "file"
    pairs = [(f"{many}: {listed(_counts(files))}" if files else many, str(len(files)))]
    if not campaigns:
        return pairs
    first = campaigns[0]
    unit = unit_of(files, first)
    for name in ("peak", "width", "velocity_change", "interval"):
        if name in first.statistics:
            one = first.statistics[name]
            label = f"{called(name, unit)}, {_of(one.n, name)}"
            if one.n > 1:
                label += f"; CV {percent(one.cv, 2)}; mean within {between(name, unit, one.low, one.high)}"
            pairs.append((label, amount(name, unit, one.mean)))
    return pairs


def _of(n: int, name: str) -> str:
    what = "interval" if name == "interval" else "blow"
    return f"mean of {n} {what}s" if n > 1 else f"one {what}"


def _summary(files: Sequence[FileReading], campaigns: Sequence[Campaign], names: Mapping[str, str]) -> str:
    if not files:
        return "No file was read."
    words = [f"{len(files)} files: {listed(_counts(files))}." if len(files) != 1 else f"One file, {files[0].status}."]
    for campaign in campaigns:
        words.append(_campaign_words(campaign, unit_of(files, campaign), len(campaigns) > 1))
    bad = [(names[file.path], f) for file in files for f in file.findings if f.severity == "bad"]
    several = len(campaigns) > 1
    for file, reading in rows_of(files):
        harmful = [f for f in reading.findings if f.severity == "bad"]
        bad += [(names[file.path] + (f", {reading.channel.name}," if several else ""), harmful[0])] if harmful else []
    for name, finding in bad[:MOST_REASONS]:
        words.append(f"{name} is bad: {finding.message}.")
    if len(bad) > MOST_REASONS:
        words.append(f"{len(bad) - MOST_REASONS} more records are bad, see below.")
    return " ".join(words)


def _campaign_words(campaign: Campaign, unit: str, several: bool) -> str:
    where = f"{campaign.channel}: " if several else ""
    statistics = campaign.statistics
    if "peak" not in statistics:
        return f"{where}No record gave a peak that can be trusted."
    one = statistics["peak"]
    text = f"{where}{one.n} blow{'s' if one.n > 1 else ''}, peak {amount('peak', unit, one.mean)}"
    if one.n > 1:
        bounds = between("peak", unit, one.low, one.high)
        text += f" in the mean (95 % bounds {bounds}, scatter {percent(one.cv, 2)})"
    for name in ("width", "velocity_change"):
        if name in statistics:
            text += f", {called(name, unit)} {amount(name, unit, statistics[name].mean)}"
    line = campaign.trends.get("peak")
    if line is None or not math.isfinite(line.low):
        return text + "."
    if line.low <= 0.0 <= line.high:
        return text + ". Over the files no trend of the peak stands out of the scatter."
    grows = "grows" if (line.slope > 0.0) == (one.mean > 0.0) else "falls"
    return f"{text}. Over the files the peak {grows} by {percent(abs(line.change), 2)} along its trend."
