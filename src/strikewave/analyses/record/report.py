"""The report of measured records: files that were read in, one HTML page out."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from strikewave.analyses.record import chapters as chapters
from strikewave.analyses.record import pictures as pictures
from strikewave.analyses.record.tables import amount, between, called, percent, rows_of, short_names, unit_of
from strikewave.records.campaign import Campaign
from strikewave.records.finding import STATUSES
from strikewave.records.reading import FileReading
from strikewave.reporting.numbers import listed
from strikewave.reporting.page import Head, whole_page
from strikewave.reporting.parts import Tag
from strikewave.signal.filters import Filter

MOST_REASONS = 4
"""Bad records whose reason the summary gives."""


@dataclass(frozen=True)
class RecordFacts:
    """What the report tells besides the readings.

    Attributes
    ----------
    title : str
        Of the report.
    command : str
        Command line that gives the same again, as it is to be typed.
    calibrations : sequence of (str, str)
        Where a calibration was stated (an option, a file), and what.
    options : sequence of (str, str)
        Other options, and what they were.
    filter : Filter or None
        Low-pass that was taken before the blows were measured.
    digests : mapping
        SHA-256 of each file, by its path; may be empty.
    """

    title: str
    command: str = ""
    calibrations: Sequence[tuple[str, str]] = ()
    options: Sequence[tuple[str, str]] = ()
    filter: Filter | None = None
    digests: Mapping[str, str] = field(default_factory=dict)


def record_report(
    files: Sequence[FileReading],
    campaigns: Sequence[Campaign],
    facts: RecordFacts,
    warnings: Sequence[Mapping[str, Any]] = (),
) -> str:
    """Return the report of measured records as one HTML page: no script, nothing fetched, the same bytes each time.

    Parameters
    ----------
    files : sequence of FileReading
        In the order of the test; may be empty.
    campaigns : sequence of Campaign
        One a channel, as `strikewave.records.campaign.summed` gives them.
    facts : RecordFacts
        Title, calibrations, options, and how to get the same again.
    warnings : sequence of mapping, optional
        What the reader should know, each with ``code`` and ``message``, where they have one ``value`` and ``limit``.

    Examples
    --------
    >>> page = record_report([], [], RecordFacts("Nothing yet"))
    >>> page.splitlines()[0], "No file was read." in page, "<script" in page
    ('<!doctype html>', True, False)
    """
    names = short_names([file.path for file in files])
    sections = [
        chapters.file_section(files, names),
        chapters.health_section(files, names),
        chapters.blow_section(files, names),
        *(chapters.campaign_section(one, files, names, len(campaigns) > 1) for one in campaigns),
        pictures.picture_section(files, names),
        pictures.response_section(files, names),
        chapters.filter_section(files, names, facts.filter),
        chapters.calibration_section(files, names, facts.calibrations, facts.options, facts.digests),
        chapters.warning_section(warnings),
        chapters.source_section(files, campaigns, facts.filter),
        chapters.again_section(facts.command),
    ]
    digest = _digest(files, facts.digests)
    many = f"{len(files)} file{'' if len(files) == 1 else 's'}"
    head = Head(
        title=facts.title,
        kicker="Report of measured records",
        subject="Files",
        name=str(len(files)),
        digest=digest,
        status=_status(files),
        summary=_summary(files, campaigns, names),
        numbers=_key_numbers(files, campaigns),
        foot=many + (f" · SHA-256 of the files, taken together, {digest}" if digest else ""),
    )
    return whole_page(head, sections)


def _digest(files: Sequence[FileReading], digests: Mapping[str, str]) -> str:
    """Return one digest of the digests of all files, in their order; empty where one is missing."""
    found = [digests.get(file.path, "") for file in files]
    return hashlib.sha256("\n".join(found).encode()).hexdigest() if found and all(found) else ""


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
        found = [f for f in reading.findings if f.severity == "bad"]
        bad += [(names[file.path] + (f", {reading.channel.name}," if several else ""), found[0])] if found else []
    for name, finding in bad[:MOST_REASONS]:
        words.append(f"{name} is bad: {finding.message}.")
    if len(bad) > MOST_REASONS:
        words.append(f"{len(bad) - MOST_REASONS} more records are bad, see below.")
    return " ".join(words)


def _campaign_words(campaign: Campaign, unit: str, several: bool) -> str:
    where = f"{campaign.channel}: " if several else ""
    found = campaign.statistics
    if "peak" not in found:
        return f"{where}No record gave a peak that can be trusted."
    one = found["peak"]
    text = f"{where}{one.n} blow{'s' if one.n > 1 else ''}, peak {amount('peak', unit, one.mean)}"
    if one.n > 1:
        bounds = between("peak", unit, one.low, one.high)
        text += f" in the mean (95 % bounds {bounds}, scatter {percent(one.cv, 2)})"
    for name in ("width", "velocity_change"):
        if name in found:
            text += f", {called(name, unit)} {amount(name, unit, found[name].mean)}"
    line = campaign.trends.get("peak")
    if line is None or not math.isfinite(line.low):
        return text + "."
    if line.low <= 0.0 <= line.high:
        return text + ". Over the files no trend of the peak stands out of the scatter."
    grows = "grows" if (line.slope > 0.0) == (one.mean > 0.0) else "falls"
    return f"{text}. Over the files the peak {grows} by {percent(abs(line.change), 2)} along its trend."


__all__ = ["RecordFacts", "record_report"]
