"""The reports of an impact of two free bodies and of a contact identified from a pulse."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from strikewave.analyses.impact.figures import asked_given, identified_figure, impact_sheet
from strikewave.analyses.impact.identified import IdentifyResult
from strikewave.analyses.impact.law_list import LawsResult
from strikewave.analyses.impact.result import MOST_ROWS, ImpactResult, blow_columns
from strikewave.base.shock_quantities import KILOGRAMS, VELOCITY
from strikewave.base.texts import percent
from strikewave.reporting import chapters
from strikewave.reporting.columns import page_table
from strikewave.reporting.faces import amount, face_table, part_tables, text_of
from strikewave.reporting.numbers import spelled
from strikewave.reporting.parts import Cell, Picture, Section, Table, Tag
from strikewave.reporting.style import titled

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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


def impact_report(result: ImpactResult) -> str:
    """Return the report of an impact as one HTML page: no script, nothing fetched, the same bytes each time."""
    drawn, many = result.drawn, len(result.blows) > 1
    figure = impact_sheet([result.blows[k] for k in drawn], [f"blow {k + 1}" for k in drawn], "")
    caption = (
        "Force over time and over indentation, and the phase plane: shares of the approach speed and of the depth."
    )
    answers = [face_table(result, "contact_answers")] if result.differ else []
    numbers = [*part_tables(result, "first"), *part_tables(result, "law"), *answers]
    lost = "energy lost, share of that of the approach", percent(1.0 - result.first.restitution**2)
    sections = [
        Section("Histories", "", [Picture(figure, caption)]),
        Section("First blow" if many else "Blow", "", numbers),
        *([_blows(result)] if many else []),
        chapters.warnings(result.notices),
    ]
    summary = chapters.Summary("Report of an impact", impact_words(result), [*result.highlights(), lost])
    return chapters.result_page(result, summary, sections)


def impact_words(result: ImpactResult) -> str:
    """Say in words what happens."""
    setup, numbers = result.setup, dict(result.highlights())
    m1, m2 = (amount(KILOGRAMS, mass) if mass < float("inf") else "a fixed body" for mass in setup.masses)
    return (
        f"{m1} strikes {m2} at {amount(VELOCITY, setup.speed)}: the force peaks at {numbers['peak force']} and "
        f"lasts {numbers['duration']}; the coefficient of restitution is {numbers['coefficient of restitution']}. "
        f"Solved by the {result.first.method}."
    )


def _blows(result: ImpactResult) -> Section:
    some = f"The first and last {MOST_ROWS // 2} of {len(result.blows)} blows." if len(result.blows) > MOST_ROWS else ""
    return Section("Blows", some, [page_table("Blows on the same spot", blow_columns(result))])


def impact_picture(result: ImpactResult) -> Figure:
    """Return force and indentation of the drawn blows."""
    labels = [f"blow {k + 1}" for k in result.drawn]
    return impact_sheet([result.blows[k] for k in result.drawn], labels, result.title)


def identified_picture(result: IdentifyResult) -> Figure:
    """Return the pulse beside the law."""
    return titled(identified_figure(result.found), result.title)


def laws_picture(result: LawsResult) -> Figure:
    """Return which coefficient of restitution the laws give for the one asked."""
    return asked_given(result.everything.damping)


picture: dict[type, Callable[[Any], Figure]] = {
    ImpactResult: impact_picture,
    IdentifyResult: identified_picture,
    LawsResult: laws_picture,
}
page: dict[type, Callable[[Any], str]] = {ImpactResult: impact_report, IdentifyResult: identified_report}
"""Pages of the results in Python, found as `picture` is by `strikewave.reporting.shown_result`."""
