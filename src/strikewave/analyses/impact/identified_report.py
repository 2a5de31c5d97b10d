"""The report of a contact identified from a pulse: values with their standard errors, and what it cannot tell."""

from __future__ import annotations

from pathlib import Path

from strikewave.analyses.impact.figures.identified import identified_figure
from strikewave.analyses.impact.identified import IdentifyResult
from strikewave.reporting import chapters
from strikewave.reporting.faces import face_table, text_of
from strikewave.reporting.numbers import spelled
from strikewave.reporting.parts import Cell, Picture, Section, Table, Tag


def identified_report(result: IdentifyResult) -> str:
    """Return the report of an identified contact as one HTML page: no script, nothing fetched, the same bytes."""
    caption = (
        "Force from first touch on: measured, and by the law that fits best. Below, measured less fitted, beside the "
        "standard deviation of a sample."
    )
    sections = [
        Section("Pulse", "", [Picture(identified_figure(result.found), caption)]),
        _value_section(result),
        chapters.warnings(result.notices),
        _record_section(result),
    ]
    status = None if result.found.described else Tag("the law does not describe the blow", "bad")
    summary = chapters.Summary("Report of an identified contact", identified_words(result), result.highlights(), status)
    return chapters.result_page(result, summary, sections)


def identified_words(result: IdentifyResult) -> str:
    """Say in words what the pulse determines."""
    contact = result.contact
    fits = "describes" if contact.described else "does not describe"
    words = [
        f"The law F = K d^n (1 + chi d'/v0) of two free bodies {fits} the blow of {result.reading.channel.name} in "
        f"{Path(result.file).name}: the misfit is {text_of(contact, 'residual')} of the peak.",
        *(text[0].upper() + text[1:].rstrip(".") + "." for text in contact.words),
    ]
    return " ".join(words)


def _value_section(result: IdentifyResult) -> Section:
    """List all values with their standard errors, and the correlation of what was determined."""
    contact, called = result.contact, {row.key: row.name for row in result.identified_rows}
    names, matrix = contact.correlation.names, contact.correlation.matrix.tolist()
    tables = [face_table(result, "identified_rows")]
    if names:
        heads = [called[name] for name in names]
        rows = [[head, *(f"{value:+.2f}" for value in row)] for head, row in zip(heads, matrix, strict=True)]
        tables.append(Table("Correlation of the errors of what was determined", ["", *heads], rows))
    text = (
        f"Standard errors rest on a standard deviation of {text_of(contact, 'noise')} of a sample; "
        f"{contact.time.size} samples were fitted."
    )
    return Section("What the pulse determines", text, tables)


def _record_section(result: IdentifyResult) -> Section:
    """List what the channel was taken as."""
    reading = result.reading
    stated = ", ".join(f"{key.replace('_', ' ')} {value}" for key, value in reading.calibration.stated().items())
    row: list[Cell] = [
        reading.channel.name,
        stated or "nothing was stated",
        spelled(reading.channel.unit),
        reading.status,
    ]
    return Section(
        "Record", "", [Table("What the channel was taken as", ["channel", "stated", "SI unit", "status"], [row])]
    )
