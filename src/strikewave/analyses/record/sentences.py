"""Sentences on measured records and their verdicts, for screen and report."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from strikewave.analyses.clauses import (
    clause_name,
    not_judged_names,
    share_words,
    verdict_sentence,
    verdict_tag,
    why_words,
)
from strikewave.analyses.record.chapters import pair_words, response_words
from strikewave.analyses.record.rows import counted
from strikewave.analyses.record.tables import between, called, figure_text, percents, plus_minus, rows_of, short_names
from strikewave.base.texts import are_many, first_few
from strikewave.cases.performed_test import StatedTest
from strikewave.records.campaign import COPY, Campaign
from strikewave.records.health_notice import worst
from strikewave.records.measuring import RecordedPulse
from strikewave.records.reading import FileReading
from strikewave.reporting.faces import capitalized
from strikewave.reporting.numbers import listed
from strikewave.reporting.parts import NONE, Tag
from strikewave.specifications.judged_records import JudgedShock, RecordsVerdict
from strikewave.specifications.judging import CANNOT_TELL, FAIL, PASS

if TYPE_CHECKING:
    from strikewave.analyses.record.result import RecordResult

MOST_REASONS = 4  # reasons of bad records that the summary gives: more are counted, and stand in the table of findings
# Channels whose figures the summary gives: two triaxial sensors; more are counted, and stand in the table
MOST_CHANNELS = 6
MOST_NAMED = 4  # files that a line names; the others are counted
# Findings after which all figures are numbers without the unit that was meant
WITHOUT_UNIT = ("unit-unknown", "not-calibrated")
NO_PEAK = "No record gave a peak that can be trusted."


def record_words(result: RecordResult) -> str:
    """Say in words what the records have in common, and which are bad: on the screen and at the head of the report."""
    files, campaigns = result.readings, result.campaigns
    names = short_names([file.path for file in files])
    if not files:
        return "No file was read."
    words = [] if result.verdict is None else [sentence(result.verdict, names)]
    words += [pair_words(result.pairs)] if result.pair else []
    words += [_files_words(files, names)]
    words += [f"{one.message[:1].upper()}{one.message[1:]}." for one in result.notices if one.code in WITHOUT_UNIT]
    several = len(campaigns) > 1
    shown = [one for one in campaigns if one.statistics or not several]
    words += [_campaign_words(one, names, several) + _doubted_words(one, files) for one in shown[:MOST_CHANNELS]]
    if len(shown) > MOST_CHANNELS:
        words.append(f"{len(shown) - MOST_CHANNELS} more channels gave a peak, see below.")
    silent = [one.channel for one in campaigns if several and not one.statistics]
    words += [f"{named(silent)}: {NO_PEAK}"] if silent else []
    words += [] if result.sensor is None else [result.sensor.sentence()]
    answers = response_words(result.response_summaries)
    words += [answers] if answers else []
    bad = [(names[file.path], f) for file in files for f in file.findings if f.severity == "bad"]
    for file, reading in rows_of(files):
        harmful = [f for f in reading.findings if f.severity == "bad"]
        own = f"{reading.channel.name} of " if several else ""
        bad += [(own + names[file.path], harmful[0])] if harmful else []
    reasons: dict[str, list[str]] = {}
    for name, finding in bad:
        reasons.setdefault(finding.message, []).append(name)
    for message, where in list(reasons.items())[:MOST_REASONS]:
        words.append(f"{named(where)} {'are' if len(where) > 1 else 'is'} bad: {message}.")
    more = sum(map(len, list(reasons.values())[MOST_REASONS:]))
    if more:
        words.append(f"{more} more record{'s are' if more > 1 else ' is'} bad, see below.")
    return " ".join(words)


def _files_words(files: Sequence[FileReading], names: Mapping[str, str]) -> str:
    """Say how many files there are of each status, and which repeat the samples of another."""
    text = f"{len(files)} files: {listed(counted(files))}" if len(files) != 1 else f"One file, {files[0].status}"
    by_channel: dict[tuple[str, ...], list[str]] = {}
    for file in files:
        repeated = tuple(
            one.channel.name for one in file.channels if COPY in {finding.code for finding in one.findings}
        )
        if repeated:  # of all channels: the file
            key = () if len(repeated) == len(file.channels) else repeated
            by_channel.setdefault(key, []).append(names[file.path])
    for channels, where in by_channel.items():
        what = f"{named(channels)} of {len(where)} of them" if channels else f"{len(where)} of them"
        verb = "repeats" if len(channels or where) == 1 else "repeat"
        text += (
            f"; {what} ({named(where)}) {verb} the samples of another file, and mean, scatter and bounds count them "
            "again as tests of their own"
        )
    return f"{text}."


def named(files: Sequence[str]) -> str:
    """Return names of files, or the first of many and how many more there are.

    Examples
    --------
    >>> named(["a.csv", "b.csv"]), named([f"{k}.csv" for k in range(9)])
    ('a.csv and b.csv', '0.csv, 1.csv, 2.csv, 3.csv and 5 more')
    """
    return first_few(files, MOST_NAMED) if are_many(files, MOST_NAMED) else listed(list(files))


def doubted_peaks(campaign: Campaign, files: Sequence[FileReading]) -> list[RecordedPulse]:
    """Return the blows of a channel whose peaks go into no mean, for a finding that harms them, bad records apart."""
    if "peak" in campaign.statistics:
        return []
    readings = [file.numbered(campaign.number) for file in files if worst(file.findings) != "bad"]
    return [p for one in readings if one is not None and worst(one.findings) != "bad" for p in one.pulses]


def peak_range(values: Sequence[float], unit: str) -> str:
    """Return a peak, or the smallest and the largest of several."""
    low, high = min(values), max(values)
    return figure_text("peak", unit, low) if low == high else between("peak", unit, low, high)


def _doubted_words(campaign: Campaign, files: Sequence[FileReading]) -> str:
    """Say what the peaks are that go into no mean: as they are read, and without ringing where that is known."""
    blows, unit = doubted_peaks(campaign, files), campaign.unit
    if not blows:
        return ""
    who = "the peak is" if len(blows) == 1 else f"the peaks of {len(blows)} blows are"
    text = f" As read, {who} {peak_range([blow.peak for blow in blows], unit)}"
    rigid = [blow.rigid for blow in blows if blow.rigid is not None]
    if len(blows) == 1 and rigid:
        text += f"; without ringing {plus_minus('peak', unit, rigid[0].peak, rigid[0].peak_uncertainty)}"
    elif len(rigid) == len(blows):
        text += f"; without ringing {peak_range([one.peak for one in rigid], unit)}"
    return f"{text}: see the findings."


def _campaign_words(campaign: Campaign, names: Mapping[str, str], several: bool) -> str:
    where = f"{campaign.channel}: " if several else ""
    statistics, unit = campaign.statistics, campaign.unit
    rigid = statistics.get("rigid_peak")
    of_blows = f"the mean peak of {rigid.n} blows is" if rigid is not None and rigid.n > 1 else "the peak is"
    without = "" if rigid is None else f" Without ringing {of_blows} {figure_text('rigid_peak', unit, rigid.mean)}."
    if "peak" not in statistics:
        return f"{where}{NO_PEAK}{without}"
    one = statistics["peak"]
    text = f"{where}{one.n} blow{'s' if one.n > 1 else ''}, peak {figure_text('peak', unit, one.mean)}"
    if one.n > 1:
        bounds = between("peak", unit, one.low, one.high)
        text += f" in the mean (95 % bounds {bounds}, scatter {percents(one.cv, 2)})"
    for name in ("width", "velocity_change"):
        if name in statistics:
            text += f", {called(name, unit)} {figure_text(name, unit, statistics[name].mean)}"
    line = campaign.trends.get("peak")
    odd = {one.path: one for one in reversed(campaign.outliers)}  # the first of each file
    if odd:
        words = []
        for outlier in reversed(odd.values()):
            ratio = f"{outlier.ratio:.3g} times the median of the others"
            ratio = ratio if math.isfinite(outlier.ratio) else "unlike the others"
            words.append(f"{called(outlier.figure, unit)} of {names[outlier.path]} left out ({ratio})")
        text += f"; {named(words)}"
    if line is None or not math.isfinite(line.low):
        return f"{text}.{without}"
    if not line.significant:
        return f"{text}.{without} Over the files no trend of the peak stands out of the scatter."
    grows = "grows" if (line.slope > 0.0) == (one.mean > 0.0) else "falls"
    return f"{text}.{without} Over the files the peak {grows} by {percents(abs(line.change), 2)} along its trend."


WHY_HEAD = "fails, or why nothing can be said"  # head of a column of `why_of_shock`
MOST_SHOCKS_NAMED = 3  # shocks that a sentence names


def name_of_shock(shock: JudgedShock | None, names: dict[str, str], several: bool) -> str:
    """Return how a shock is called: file, channel where there are several, number of its blow."""
    if shock is None:
        return NONE
    channel = f", {shock.reading.channel.name}" if several else ""
    return f"{names[shock.file]}{channel}, blow {shock.number}"


def why_of_shock(shock: JudgedShock) -> str:
    """Say which clauses a shock fails or, where it fails none, of which nothing can be said, and why."""
    for verdict in (FAIL, CANNOT_TELL):
        clauses = [clause for clause in shock.found.clauses if clause.verdict == verdict]
        if clauses:
            names = ", ".join(clause.clause for clause in clauses)
            return f"{names}: {clauses[0].reason}" if verdict == CANNOT_TELL and clauses[0].reason else names
    return NONE


def tag_of_records(records: RecordsVerdict, stated: StatedTest | None = None) -> Tag:
    """Return the verdict as a tag, with what it rests on; equipment without a valid calibration takes its green."""
    tag = verdict_tag(records.verdict, records.by_indicative, [clause for clause, _ in records.clauses])
    if stated is None or not stated.lapses:
        return tag
    return Tag(f"{tag.text}; calibration overdue", "warned" if records.verdict == PASS else tag.look)


def sentence(records: RecordsVerdict, names: dict[str, str]) -> str:
    """Say what the verdict is, by what, and why."""
    count = len(records.shocks)
    many = {0: "no shock", 1: "one shock"}.get(count, f"{count} shocks")
    clauses = [clause for clause, _ in records.clauses]
    of_what = f": {many} by {records.specification.title} ({records.specification.file.edition})."
    words = [verdict_sentence(records.verdict, records.by_indicative, clauses, of_what)]
    several = len({shock.reading.channel.name for shock in records.shocks}) > 1
    wrong = [(c, s) for c, s in records.clauses if c.verdict == records.verdict and c.verdict in (FAIL, CANNOT_TELL)]
    for clause, shock in wrong[:MOST_SHOCKS_NAMED]:
        where = f" of {name_of_shock(shock, names, several)}" if shock is not None and count > 1 else ""
        words.append(f"{capitalized(clause_name(clause.clause))}{where}: {why_words(clause)}.")
    if records.verdict == PASS:
        tight = [(c, s) for c, s in records.clauses if c.verdict == PASS and math.isfinite(c.share)]
        if tight:
            clause, shock = min(tight, key=lambda one: one[0].share)
            where = f", {name_of_shock(shock, names, several)}" if shock is not None and count > 1 else ""
            words.append(f"Least margin: {clause.clause}{where}, {share_words(clause)} of the tolerance.")
    failed = sum(shock.found.verdict == FAIL for shock in records.shocks)
    if count > 1 and failed:
        words.append(f"{failed} of {count} shocks fail.")
    unclear = [shock for shock in records.shocks if shock.found.verdict == CANNOT_TELL]
    if count > 1 and unclear and records.verdict != CANNOT_TELL:
        where = first_few([name_of_shock(shock, names, several) for shock in unclear], MOST_SHOCKS_NAMED, "; ")
        words.append(f"Of {len(unclear)} of {count} nothing can be said ({where}): {why_of_shock(unclear[0])}.")
    skipped = not_judged_names(clauses)
    if skipped and records.verdict != PASS:
        words.append(f"Not judged: {listed(skipped)}.")
    return " ".join(words)
