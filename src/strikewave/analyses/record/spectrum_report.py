"""Report of shock response spectra: the spectra, their record, and its calibration."""

from __future__ import annotations

import math
from pathlib import Path

from strikewave.analyses.clauses import held_words, verdict_tag
from strikewave.analyses.record.figures import records
from strikewave.analyses.record.figures.spectra import (
    MOST_NAMES,
    response_figure,
    rolling_figure,
    several_figure,
    srs_figure,
    tripartite,
)
from strikewave.analyses.record.sentences import named
from strikewave.analyses.record.spectrum import SpectrumResult, spectrum_findings, status_of
from strikewave.analyses.record.tables import squeezed, status_tag
from strikewave.analyses.record.verdicts import spectra_section, spectra_sentence
from strikewave.base.shock_quantities import ACCELERATION
from strikewave.base.texts import percent
from strikewave.reporting import chapters
from strikewave.reporting.faces import amount
from strikewave.reporting.numbers import hertz, one_in, spelled
from strikewave.reporting.parts import NONE, Cell, Part, Picture, Section, Table, Tag
from strikewave.signal.srs import FEWEST

MOST_ROWS = 60  # frequencies in the table, evenly chosen: spectrum.csv has all


def spectrum_report(result: SpectrumResult) -> str:
    """Return the report of shock response spectra as one HTML page: no script, nothing fetched, the same bytes."""
    if result.shocks:
        return _report_of_several(result)
    unit = result.reading.channel.unit
    parts: list[Part] = [
        Picture(
            srs_figure(one, unit=unit, expanded=result.expanded(k), side=result.side),
            f"Largest {one.kind} response of oscillators whose base moves as the record says, over their natural "
            "frequency: upwards (positive), downwards (negative), and the larger of both (maximax).",
        )
        for k, one in enumerate(result.spectra)
    ]
    parts.append(
        Picture(
            tripartite(result.velocity),
            "Pseudo-velocity on four-coordinate paper: rising lines are those of one relative displacement, falling "
            "ones those of one acceleration.",
        )
    )
    reading, count = result.reading, len(result.frequency)
    record = Section("Record", "The record holds nothing that could be drawn.")
    if records.drawable(reading):
        blows = len(reading.pulses)
        caption = f"The record: {blows} blow{'' if blows == 1 else 's'}, {status_of(reading)}."
        record = Section("Record", "", [Picture(records.history(reading), caption)])
    step = max(math.ceil(count / MOST_ROWS), 1)
    some = f"{one_in(step).capitalize()} of {count} frequencies; " if step > 1 else ""
    table = Table(f"Spectra, {result.side}", *result.shown_every(step, result.columns()))
    sections = [
        *_verdict(result),
        Section(
            "Spectra", "" if result.budget is None else held_words(result.budget.names, result.budget.not_stated), parts
        ),
        *_over_time(result),
        record,
        Section("Values", f"{some}spectrum.csv has them all.", [table]),
        chapters.warnings(result.notices),
        _calibration_section(result),
    ]
    status = status_of(result.reading)
    found = result.verdict
    tag = status_tag(status, f"record {status}") if found is None else verdict_tag(found.verdict, found.by_indicative)
    summary = chapters.Summary("Report of a shock response spectrum", spectrum_words(result), _key_numbers(result), tag)
    return chapters.result_page(result, summary, sections)


def _verdict(result: SpectrumResult) -> list[Section]:
    """Return the chapter with the verdict, where one was asked for."""
    return [] if result.verdict is None else [spectra_section(result.verdict)]


def _over_time(result: SpectrumResult) -> list[Section]:
    """Draw the response of an oscillator and the rolling spectrum, where they were asked for."""
    parts = list[Part]()
    most = max(len(result.responses), len(result.rollings))
    of = "the record" if not result.shocks else "each record" if most <= MOST_NAMES else f"{MOST_NAMES} records"
    if result.responses:
        natural = hertz(result.responses[0][1].frequency)
        parts.append(Picture(response_figure(result), f"What an oscillator of {natural} does while {of} lasts."))
    if result.rollings:
        words = f"The spectrum of windows that slide over {of}, each as if nothing came before or after it."
        parts.append(Picture(rolling_figure(result), words))
    return [Section("Over time", "", parts)] if parts else []


def _report_of_several(result: SpectrumResult) -> str:
    """Return the report of several spectra, and of what they come to."""
    count = len(result.used)
    parts: list[Part] = [
        Picture(several_figure(result, k), f"The {one.kind} spectra: thin lines of each, thick ones of all together.")
        for k, one in enumerate(result.spectra)
    ]
    rows: list[list[Cell]] = [
        [
            Path(shock.file).name,
            shock.channel,
            status_tag(shock.status),
            ", ".join(f"{one.text} at {one.place}" for one in result.largest_of(shock.found.values)),
            shock.left_out or "yes",
        ]
        for shock in result.shocks
    ]
    kinds = ", ".join(one.kind for one in result.spectra)
    into = "in the resultant" if result.resultant else "in the envelope"
    heads, rows, same = squeezed(["file", "channel", "status", f"largest {kinds}", into], rows, ["channel"])
    table = Table(f"Spectra{same}", heads, rows)
    sections = [
        *_verdict(result),
        Section("Spectra", "", parts),
        *_over_time(result),
        Section("Records", "", [table]),
        chapters.warnings(result.notices),
        _calibration_section(result),
    ]
    tag = Tag(f"{count} of {len(result.shocks)} used", "good" if count == len(result.shocks) else "warned")
    found = result.verdict
    tag = tag if found is None else verdict_tag(found.verdict, found.by_indicative)
    summary = chapters.Summary("Report of shock response spectra", spectrum_words(result), result.highlights(), tag)
    return chapters.result_page(result, summary, sections)


def several_words(result: SpectrumResult) -> str:
    """Say in words what several spectra come to."""
    first, used = result.spectra[0], result.used
    words = [f"{result.counted} of {result.origin.name}, baselines taken off: {result.damping}."]
    if result.bounded_by:
        highest = hertz(first.frequency[-1])
        words.append(
            f"They have natural frequencies up to {highest} in common: the lowest sampling rate is {result.bounded_by}."
        )
    names = {"envelope": "envelope", "p95_50": "limit P95/50", "resultant": "resultant"}
    for name, kinds in result.together.items():
        words += [
            f"The {names[name]} of the {one.kind} response is largest, {one.text}, at {one.place}."
            for one in result.largest_of(kinds)
        ]
    one_channel = len({shock.channel for shock in result.shocks}) == 1
    left = [Path(shock.file).name if one_channel else shock.name for shock in result.shocks if shock.left_out]
    if left:
        words.append(f"Left out: {named(left)}.")
    if not result.resultant and len(used) < FEWEST:
        words.append(f"P95/50 needs {FEWEST} spectra or more.")
    return " ".join(words)


def spectrum_words(result: SpectrumResult) -> str:
    """Say in words what the spectra are of."""
    judged = "" if result.verdict is None else f"{spectra_sentence(result.verdict)} "
    if result.shocks:
        return judged + several_words(result)
    first, reading = result.spectra[0], result.reading
    critical = "" if math.isinf(first.q) else f" ({percent(0.5 / first.q)} of critical damping)"
    part = "" if first.part == "total" else f", the {first.part} part"
    lowest, highest = hertz(first.frequency[0]), hertz(first.frequency[-1])
    words = [
        f"Spectra of {reading.channel.name} in {Path(result.first.file).name}, its baseline taken off: "
        f"{result.damping}{critical}, {result.side}{part}, {len(first.frequency)} natural frequencies from {lowest} to "
        f"{highest}."
    ]
    words += [f"The {one.kind} response is largest, {one.text}, at {one.place}." for one in result.largest]
    status = result.first.status
    bad = [one.message for one in spectrum_findings(reading) if one.severity == status != "good"]
    why = f": {bad[0]}" if bad else ""
    words.append(f"The record is {status}{why}.")
    return judged + " ".join(words)


def _key_numbers(result: SpectrumResult) -> list[tuple[str, str]]:
    pairs = list(result.highlights())
    if "pseudo-velocity" not in result.first.found.values:
        [one] = result.largest_of({"pseudo-velocity": result.velocity.maximax})
        pairs.append((f"largest {one.name}", one.text))
    peaks = [abs(pulse.peak) for pulse in result.reading.pulses]
    if peaks and result.is_acceleration:
        label = f"largest peak of the record, {len(peaks)} blow{'s' * (len(peaks) > 1)}"
        pairs.append((label, amount(ACCELERATION, max(peaks))))
    return pairs


def _calibration_section(result: SpectrumResult) -> Section:
    """List what the channel was taken as, and what its examination says."""
    reading = result.reading
    stated = ", ".join(f"{key.replace('_', ' ')} {value}" for key, value in reading.calibration.stated().items())
    unit = spelled(reading.channel.unit) or "file's own numbers"
    rows: list[list[Cell]] = [[reading.channel.name, stated or "nothing was stated", unit]]
    findings: list[list[Cell]] = [
        [status_tag(one.severity, one.code), one.message, ", ".join(one.harms) or NONE] for one in reading.findings
    ]
    stated_table = Table("What the channel was taken as", ["channel", "stated", "SI unit"], rows)
    if result.shocks:
        return Section("Calibration of the first record", "", [stated_table])
    tables = [
        stated_table,
        Table("Health of the record", ["finding", "what", "harms"], findings, empty="Nothing was found wrong."),
    ]
    return Section("Calibration and health", "", tables)
