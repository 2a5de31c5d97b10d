"""The page of a test report: result of records with a verdict and what is stated of the test in, HTML out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from strikewave._version import __version__
from strikewave.analyses.record.budget_chapter import source_table
from strikewave.analyses.record.result import RecordResult
from strikewave.analyses.record.tables import short_names, status_tag
from strikewave.analyses.record.test_report.asked import NORM, missing
from strikewave.analyses.record.test_report.figures import drawn_shocks, overlay
from strikewave.analyses.record.test_report.shocks import (
    MOST_LISTED,
    blow_verdicts,
    direction_tables,
    group_name,
    groups,
    several_channels,
    shock_tables,
)
from strikewave.analyses.record.verdicts.chapter import limit_words_of
from strikewave.analyses.record.verdicts.specification_result import AskedRow, asked_rows
from strikewave.analyses.record.verdicts.words import sentence, tag_of_records
from strikewave.analyses.record.words import named
from strikewave.cases.stated_test import NO_TEST, CaseTable, StatedTest
from strikewave.reporting import chapters
from strikewave.reporting.chapters import Head, whole_page
from strikewave.reporting.clause_words import clause_name
from strikewave.reporting.columns import page_table
from strikewave.reporting.faces import columns_of
from strikewave.reporting.measured_files import digests_of
from strikewave.reporting.numbers import listed
from strikewave.reporting.parts import NONE, Cell, Code, Part, Photo, Picture, Section, SignatureLines, Table, Tag
from strikewave.reporting.run_and_write import drawing
from strikewave.specifications.judged_records import RecordsVerdict
from strikewave.specifications.judging import CANNOT_TELL, FAIL, NOT_JUDGED, PASS

FILE = "test-report.html"
MOST_DRAWN = 24
"""Groups of shocks, each of a direction and a channel, that are drawn."""
MOST_FILES = 300
"""Files that are listed with their SHA-256; record.toml has all."""
MOST_FINDINGS = 40
"""Findings that are listed; the report of the records has all."""
ONLY_ITEMS = "The results relate only to the items tested."
IN_FULL = "This report shall not be reproduced except in full, unless the laboratory agrees in writing."
UNSIGNED = (("tested by", ""), ("authorized by", ""))
"""Lines to sign where none are stated."""


def report_of_test(result: RecordResult) -> str:
    """Return the test report of records that were judged by a specification, as one HTML page.

    Examples
    --------
    >>> report_of_test(RecordResult([]))
    Traceback (most recent call last):
    ValueError: a test report needs a verdict
    """
    found, stated = result.verdict, result.performed or NO_TEST
    if found is None:
        raise ValueError("a test report needs a verdict")
    result = _hashed(result)
    names = short_names([file.path for file in result.readings])
    number = _number(result, stated)
    head = Head(
        title=f"Test report {number}",
        kicker=stated.test.laboratory or "Shock test",
        subject="Specification",
        name=found.specification.title,
        digest="",
        status=tag_of_records(found, stated),
        summary=[sentence(found, names), *_lapse_words(stated)],
        numbers=_key_numbers(found),
        foot=f"test report {number}",
        test=_cover(stated),
    )
    sections = [
        _items(stated),
        _specification(found),
        Section("Directions and counts", "", direction_tables(found)),
        _setup(stated),
        _shocks(found, names),
        _pulses(found),
        _deviations(result, found, stated, names),
        _conclusions(found, stated, names),
        _signatures(stated),
        _annex(result, found, stated),
        _not_stated(stated, found),
        Section(f"End of test report {number}", ""),
    ]
    return whole_page(head, sections)


def _hashed(result: RecordResult) -> RecordResult:
    """Return the result with the SHA-256 of its files, which Python does not take before they are shown."""
    if result.origin.digests:
        return result
    digests = digests_of([Path(file.path) for file in result.readings])
    return replace(result, origin=replace(result.origin, digests=digests))


def _number(result: RecordResult, stated: StatedTest) -> str:
    """Return the number of the report; where none is stated, what tells the records from others."""
    return stated.tables.report.number or (f"of records {result.source.digest[:12]}").rstrip()


def _cover(stated: StatedTest) -> dict[str, str]:
    """Return what stands above all else: who tested what for whom, and when."""
    test, report, customer = stated.test, stated.tables.report, stated.tables.customer
    days = test.date if not report.last_day or report.last_day == test.date else f"{test.date} to {report.last_day}"
    rows = {
        "number": report.number,
        "order": test.order,
        "customer": customer.name,
        "item": test.item or listed([one.name for one in stated.tables.specimen[:3] if one.name]),
        "serial_number": test.serial_number,
        "tested": days.removeprefix(" to "),
        "issued": report.issued,
        "laboratory": test.laboratory,
        "accreditation": report.accreditation,
    }
    return {key: text for key, text in rows.items() if text}


def _lapse_words(stated: StatedTest) -> list[str]:
    """Say which calibrations did not hold, as a paragraph; none where all did."""
    lapses = stated.lapses
    if not lapses:
        return []
    words = "; ".join(f"{one.instrument}: {one.why}" for one in lapses)
    return [f"Calibration overdue. {words}. The figures and the verdict rest on equipment without a valid calibration."]


def _key_numbers(found: RecordsVerdict) -> list[tuple[str, str]]:
    verdicts = blow_verdicts(found.shocks)
    nominal = {row.clause: row.limit for row in asked_rows(found.specification)}
    counts = [("shocks", len(verdicts)), ("pass", verdicts.count(PASS)), ("fail", verdicts.count(FAIL))]
    unclear = verdicts.count(CANNOT_TELL)
    counts += [("cannot tell", unclear)] if unclear else []
    return [
        *((name, str(count)) for name, count in counts),
        *((name, nominal[name]) for name in ("nominal peak", "nominal duration") if name in nominal),
    ]


def _fields(caption: str, rows: Iterable[tuple[str, str]]) -> list[Part]:
    """Return a table of what is stated; none where nothing is."""
    given: list[list[Cell]] = [[name, text] for name, text in rows if text]
    return [Table(caption, ["what", "stated"], given)] if given else []


def _named_fields(table: CaseTable, names: Sequence[str] = ()) -> list[tuple[str, str]]:
    """Return the texts of a table with their keys in words."""
    return [(_in_words(key), str(getattr(table, key))) for key in names or type(table).model_fields]


def _in_words(key: str) -> str:
    return key.replace("_", " ")


def _rows_table(caption: str, rows: Sequence[CaseTable]) -> list[Part]:
    """Return a table of rows, without the columns of which none states anything."""
    if not rows:
        return []
    keys = [key for key in type(rows[0]).model_fields if any(getattr(row, key) for row in rows)]
    cells: list[list[Cell]] = [[number, *(getattr(row, key) or NONE for key in keys)] for number, row in _counted(rows)]
    return [Table(caption, ["#", *map(_in_words, keys)], cells)]


def _counted(rows: Sequence[CaseTable]) -> list[tuple[int, CaseTable]]:
    return list(enumerate(rows, start=1))


def _items(stated: StatedTest) -> Section:
    test, tables = stated.test, stated.tables
    report, customer = tables.report, tables.customer
    laboratory = [
        ("laboratory", test.laboratory),
        *_named_fields(report, ("laboratory_address", "laboratory_contact", "accreditation", "location")),
        ("operator", test.operator),
    ]
    ordered = [
        *((f"customer {name}".replace(" name", ""), text) for name, text in _named_fields(customer)),
        ("order", test.order),
    ]
    item = [("item", test.item), ("serial number", test.serial_number)] if not tables.specimen else []
    parts = [
        *_fields("Laboratory", laboratory),
        *_fields("Customer and order", ordered),
        *_fields("Item", item),
        *_rows_table("Items", tables.specimen),
    ]
    return Section("Laboratory, customer, items", "" if parts else "Nothing is stated of them.", parts)


def _specification(found: RecordsVerdict) -> Section:
    file = found.specification.file
    rows = asked_rows(found.specification, clause_name)
    if found.limits.band is not None:
        band = found.limits.band
        words = f"{100.0 * band.time:g} % of the duration, {100.0 * band.amplitude:g} % of the peak"
        rows.append(AskedRow("tolerance band", words, found.limits.band_status))
    text = f"{found.specification.title} ({file.edition}).\n\n{_decision(found)}\n\n{limit_words_of(found)}"
    table = page_table("What is asked of a shock", columns_of(AskedRow, rows))
    return Section("Specification and decision rule", text, [table])


def _decision(found: RecordsVerdict) -> str:
    """Say by which rule conformity is stated, and with which uncertainty."""
    if found.asked.rule == "simple":
        rule = "simple acceptance: a value within its limits passes, whatever its uncertainty (JCGM 106:2012, 8.2)"
    else:
        rule = (
            "guarded: within the expanded uncertainty of a limit neither pass nor fail is stated (ISO 14253-1, JCGM "
            "106:2012, 8.3)"
        )
    held = f"it holds {listed(list(found.asked.holds))}"
    left = f"; not stated, and not in it: {listed(list(found.asked.not_stated))}" if found.asked.not_stated else ""
    return f"Decision rule: {rule}.\n\nUncertainty of the measurement, expanded, k = 2: {held}{left}."


def _setup(stated: StatedTest) -> Section:
    setup = stated.tables.setup
    described = _named_fields(setup, [key for key in type(setup).model_fields if key != "photograph"])
    lapsed = {one.instrument for one in stated.lapses}
    instruments: list[list[Cell]] = [
        [
            number,
            *(getattr(row, key) or NONE for key in ("name", "model", "serial_number", "calibrated", "calibration_due")),
            row.certificate or NONE,
            Tag("overdue", "bad") if row.called in lapsed else Tag("holds", "good") if row.calibrated else Tag("none"),
        ]
        for number, row in enumerate(stated.tables.equipment, start=1)
    ]
    heads = ["#", "instrument", "model", "serial number", "calibrated", "due", "certificate", "calibration"]
    parts: list[Part] = [
        *_fields("Set-up", described),
        *_fields("Surroundings", _named_fields(stated.tables.environment)),
        *([Table("Equipment", heads, instruments)] if instruments else []),
        *(Photo(one.address, one.caption or one.file) for one in stated.photographs),
    ]
    return Section("Set-up and equipment", "" if parts else "Nothing is stated of them.", parts)


def _shocks(found: RecordsVerdict, names: dict[str, str]) -> Section:
    many = len(found.shocks) > MOST_LISTED
    words = (
        f"{len(found.shocks)} shocks are summed up here; the file shocks.csv lists each with its verdict."
        if many
        else ""
    )
    return Section("Shocks", words, shock_tables(found, names) if found.shocks else [])


def _pulses(found: RecordsVerdict) -> Section:
    several = several_channels(found)
    parts: list[Part] = []
    found_groups = list(groups(found))
    for direction, channel, here in found_groups[:MOST_DRAWN]:
        name, drawn = group_name(direction, channel, several), drawn_shocks(here)
        words = f"{name[:1].upper()}{name[1:]}: {len(here)} shock{'s' if len(here) > 1 else ''}"
        words += f", {len(drawn)} of them drawn one by one" if len(drawn) < len(here) else ""
        parts.append(Picture(overlay(here, found.limits, name), f"{words}."))
    left = len(found_groups) - MOST_DRAWN
    return Section(
        "Pulses", f"{left} more are not drawn." if left > 0 else "" if parts else "No shock was recorded.", parts
    )


def _deviations(result: RecordResult, found: RecordsVerdict, stated: StatedTest, names: dict[str, str]) -> Section:
    report = stated.tables.report
    alike: dict[tuple[str, str], list[str]] = {}
    for file in result.readings:
        if file.status != "good":
            alike.setdefault((file.status, "; ".join(file.reasons)), []).append(names[file.path])
    rows: list[list[Cell]] = [
        [named(where), status_tag(status), reasons] for (status, reasons), where in list(alike.items())[:MOST_FINDINGS]
    ]
    left = f", the first {MOST_FINDINGS} of {len(alike)}" if len(alike) > MOST_FINDINGS else ""
    skipped: list[list[Cell]] = [
        [clause.clause, clause.reason] for clause, _ in found.clauses if clause.verdict == NOT_JUDGED
    ]
    skipped += [[one.text, "not judged by a record"] for one in found.specification.file.demand]
    filtered = f"Before they were measured, the records went through: {result.filter}." if result.filter else ""
    words = [
        f"Deviations from the method, by the laboratory: {_paragraphs(report.deviations) or 'nothing is stated.'}",
        _paragraphs(report.remarks),
        _paragraphs(stated.test.notes),
        filtered or "No filter was taken beyond that of the recorder.",
    ]
    parts: list[Part] = [
        Table(f"Findings in the records{left}", ["records", "status", "finding"], rows, "No record has a finding."),
        *([Table("Asked for by the specification, and not judged", ["what", "why"], skipped)] if skipped else []),
    ]
    return Section("Deviations and remarks", "\n\n".join(word for word in words if word), parts)


def _paragraphs(text: str) -> str:
    """Return a text in which each line is a paragraph."""
    return "\n\n".join(line for line in text.splitlines() if line.strip())


def _conclusions(found: RecordsVerdict, stated: StatedTest, names: dict[str, str]) -> Section:
    after = [f"{one.name or one.serial_number}: {one.result}" for one in stated.tables.specimen if one.result]
    words = [
        sentence(found, names),
        "The verdict rests on limits from memory: they have to be held against the standard before it is relied on."
        if found.by_indicative
        else "",
        *_lapse_words(stated),
        f"Inspection after the test: {'; '.join(after)}." if after else "",
        *stated.tables.report.statements,
        ONLY_ITEMS,
        IN_FULL,
    ]
    return Section("Conclusions", "\n\n".join(word for word in words if word))


def _signatures(stated: StatedTest) -> Section:
    rows = [(one.role or "signed by", one.name) for one in stated.tables.signature] or list(UNSIGNED)
    return Section("Signatures", "", [SignatureLines(rows)], alone=True)


def _judged_by(result: RecordResult, found: RecordsVerdict, stated: StatedTest) -> list[Part]:
    """Return the files by which the records were judged, with their SHA-256, and the uncertainty budget."""
    budget = result.budget
    stated_in = [
        ("specification", found.specification.path),
        ("uncertainty budget", (budget and budget.file) or ""),
        ("test", stated.file),
    ]
    digests = digests_of([Path(file) for _, file in stated_in if file])
    rows: list[list[Cell]] = [
        [what, file, digests[str(Path(file))]] for what, file in stated_in if file and str(Path(file)) in digests
    ]
    tables: list[Part] = [Table("Judged by", ["what", "file", "SHA-256"], rows)] if rows else []
    return tables if budget is None else [*tables, source_table(budget)]


def _annex(result: RecordResult, found: RecordsVerdict, stated: StatedTest) -> Section:
    source = result.source
    files: list[list[Cell]] = [[name, digest] for name, digest in list(source.digests.items())[:MOST_FILES]]
    left = len(source.digests) - MOST_FILES
    caption = "Records" + (
        f", the first {MOST_FILES} of {len(source.digests)}; record.toml has all" if left > 0 else ""
    )
    calibrations: list[list[Cell]] = [list(pair) for pair in result.calibrations[:MOST_FINDINGS]]
    parts: list[Part] = [
        Table(caption, ["file", "SHA-256"], files, "The files were not hashed."),
        *_judged_by(result, found, stated),
        Table("Calibration of the channels", ["where it is stated", "what"], calibrations, "The files state it alone."),
        *([Code(source.asked)] if source.asked else []),
        *chapters.warnings(result.notices).parts,
    ]
    command = ", by the command below" if source.asked else ""
    text = f"Evaluated with strikewave {__version__}{command}, from these files."
    return Section("Annex: records, uncertainty budget, software, warnings", text, parts)


def _not_stated(stated: StatedTest, found: RecordsVerdict) -> Section:
    rows: list[list[Cell]] = [list(one) for one in missing(stated, found.asked.budget is not None)]
    title = f"Annex: asked for by {NORM}, and not stated"
    text = (
        f"Clause 7.8 of {NORM}, as other texts quote it, asks for what follows as far as it applies; the test file "
        "does not state it."
    )
    if not rows:
        return Section(title, "Nothing: all that clause 7.8 asks for, as other texts quote it, is stated.")
    table = Table("Not stated", ["clause", "what", "key of the test file"], rows)
    return Section(title, text, [table], folded="Show what is not stated")


def write_report_of_test(result: RecordResult, folder: Path) -> list[str]:
    """Write the test report into a folder, and return its name; nothing where no test and verdict are there."""
    if result.verdict is None or result.performed is None:
        return []
    with drawing(folder / FILE) as path:
        path.write_text(report_of_test(result), "utf-8", newline="\n")
    return [FILE]
