"""The report of a contact identified from a pulse: values with their standard errors, and what it cannot tell."""

from __future__ import annotations

from pathlib import Path

from strikewave.analyses.impact.figures.identified import identified_figure
from strikewave.analyses.impact.identified import CALLED, UNITS, USUAL, IdentifyResult
from strikewave.contact.identification import IdentifiedValue
from strikewave.reporting import chapters
from strikewave.reporting.numbers import percent, shown, spelled
from strikewave.reporting.parts import NONE, Cell, Picture, Section, Table, Tag, written
from strikewave.reporting.shown_units import shown_unit


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
    summary = chapters.Summary(
        "Report of an identified contact", identified_words(result), _key_numbers(result), status
    )
    return chapters.result_page(result, summary, sections)


def identified_words(result: IdentifyResult) -> str:
    """Say in words what the pulse determines."""
    contact = result.found
    fits = "describes" if contact.described else "does not describe"
    words = [
        f"The law F = K d^n (1 + chi d'/v0) of two free bodies {fits} the blow of {result.reading.channel.name} in "
        f"{Path(result.file).name}: the misfit is {percent(contact.residual, 2)} of the peak.",
        *(text[0].upper() + text[1:].rstrip(".") + "." for text in contact.words),
    ]
    return " ".join(words)


def _key_numbers(result: IdentifyResult) -> list[tuple[str, str]]:
    contact = result.found
    pairs = [
        (CALLED.get(name, name) + _how(one), _value(name, one, 4 if name == "stiffness" else 5))
        for name, one in {**contact.values, **contact.combinations}.items()
        if name in ("stiffness", "exponent", "restitution", "peak_force", "duration")
    ]
    return [*pairs, ("misfit, share of the peak", percent(contact.residual, 2))]


def _how(one: IdentifiedValue) -> str:
    if one.given:
        return ", given"
    return (
        ""
        if one.value is None or not one.standard_error
        else f", ± {written(100.0 * one.standard_error / abs(one.value), 2)} %"
    )


def _unit(name: str) -> str:
    unit = UNITS[name]
    return spelled(shown_unit(unit, USUAL.get(name, unit)))


def _number(name: str, value: float | None, digits: int) -> str:
    unit = UNITS[name]
    usual = USUAL.get(name, unit)
    return NONE if value is None else written(shown(value, unit, usual) if usual != unit else value, digits)


def _value(name: str, one: IdentifiedValue, digits: int) -> str:
    if one.value is None:
        return "not determined"
    unit = _unit(name)
    return _number(name, one.value, digits) + ("" if unit == "1" else f" {unit}")


def _value_section(result: IdentifyResult) -> Section:
    """List all values with their standard errors, and the correlation of what was determined."""
    contact = result.found
    estimates = {**contact.values, **contact.combinations, "begin": contact.begin}
    rows: list[list[Cell]] = [
        [
            CALLED.get(name, name),
            "not determined" if one.value is None else _number(name, one.value, 5),
            "given" if one.given else _number(name, one.standard_error, 2),
            _unit(name),
        ]
        for name, one in estimates.items()
    ]
    tables = [Table("Values, with their standard errors", ["", "value", "standard error", "unit"], rows)]
    if contact.names:
        names = [CALLED.get(name, name) for name in contact.names]
        matrix: list[list[Cell]] = [
            [name, *(f"{value:+.2f}" for value in row)]
            for name, row in zip(names, contact.correlation.tolist(), strict=True)
        ]
        tables.append(Table("Correlation of the errors of what was determined", ["", *names], matrix))
    text = (
        f"Standard errors rest on a standard deviation of {written(contact.noise, 3)} N of a sample; "
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
