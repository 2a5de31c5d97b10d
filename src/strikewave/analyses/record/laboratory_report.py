"""Test report of a laboratory: specification, equipment, each shock with its verdict, signatures.

Quoted: 7.8.2.1 and 7.8.6 from copies of the text in public places, 7.8.3.1 from that of the edition of 2005, 5.10.3.1,
which has the same; the standard itself was not at hand. What the report always holds (title, specification, results
with units, that they relate to the items tested, decision rule) is not listed, nor what a shock test does not have
(sampling).
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from statistics import fmean, stdev
from typing import TYPE_CHECKING

import numpy as np

from strikewave._version import __version__
from strikewave.analyses.clauses import amount, clause_name, doubted_words, limit_words, tag_of, value_words
from strikewave.analyses.record.budget_chapter import source_table
from strikewave.analyses.record.figures.verdicts import draw_limits, shown_window
from strikewave.analyses.record.result import RecordResult
from strikewave.analyses.record.sentences import WHY_HEAD, named, sentence, tag_of_records, why_of_shock
from strikewave.analyses.record.specification.result import AskedRow, asked_rows
from strikewave.analyses.record.tables import short_names, status_tag
from strikewave.analyses.record.verdict_chapter import limit_words_of, several_channels
from strikewave.base.shock_quantities import ACCELERATION, SECONDS
from strikewave.base.texts import percent
from strikewave.cases.performed_test import NO_TEST, CaseTable, StatedTest
from strikewave.reporting import chapters, faces
from strikewave.reporting.chapters import Head, whole_page
from strikewave.reporting.columns import page_table
from strikewave.reporting.faces import columns_of
from strikewave.reporting.measured_files import digests_of
from strikewave.reporting.numbers import axis_unit, listed, time_unit
from strikewave.reporting.parts import NONE, Cell, Code, Part, Photo, Picture, Section, SignatureLines, Table, Tag
from strikewave.reporting.run_and_write import drawing
from strikewave.reporting.style import BLUE, GREY, HALF, ORANGE, RED, legend_below, new_figure, plain, quiet, thin
from strikewave.specifications.judged_records import DIRECTIONS, JudgedShock, RecordsVerdict
from strikewave.specifications.judging import (
    CANNOT_TELL,
    FAIL,
    NORMATIVE,
    NOT_JUDGED,
    PASS,
    Clause,
    Limits,
    PulseLimits,
    judged,
    together,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NORM = "ISO/IEC 17025:2017"


def missing(stated: StatedTest, uncertainty: bool) -> list[tuple[str, str, str]]:
    """Return clause, what it asks for, and its key in the test file, of all that is not stated."""
    test, tables = stated.test, stated.tables
    report, customer, items = tables.report, tables.customer, tables.specimen
    named = bool(test.item or (items and all(one.name for one in items)))
    numbered = bool(test.serial_number or (items and all(one.serial_number for one in items)))
    calibrated = bool(tables.equipment) and all(one.calibrated and one.certificate for one in tables.equipment)
    rows = [
        (test.laboratory, "7.8.2.1 b", "name of the laboratory", "test.laboratory"),
        (report.laboratory_address, "7.8.2.1 b, c", "its address, and where the test was done",
         "report.laboratory_address"),
        (report.number, "7.8.2.1 d", "unique number of the report", "report.number"),
        (customer.name and customer.contact, "7.8.2.1 e", "customer and contact", "customer.name, customer.contact"),
        (named, "7.8.2.1 g", "description of each item", "specimen.name"),
        (numbered, "7.8.2.1 g", "what tells each item from others", "specimen.serial_number"),
        (items and all(one.condition for one in items), "7.8.2.1 g", "condition of each item, where it matters",
         "specimen.condition"),
        (items and all(one.received for one in items), "7.8.2.1 h", "date of receipt, where it matters",
         "specimen.received"),
        (test.date, "7.8.2.1 i", "date of the test", "test.date"),
        (report.issued, "7.8.2.1 j", "date of issue", "report.issued"),
        (report.deviations, "7.8.2.1 n", "deviations from the method, or that there were none", "report.deviations"),
        (any(one.name for one in tables.signature), "7.8.2.1 o", "who authorizes the report", "signature.name"),
        (tables.environment.temperature, "7.8.3.1 a", "conditions of the surroundings, where they matter",
         "environment.temperature"),
        (uncertainty, "7.8.3.1 c", "uncertainty of the measurement, where it bears on the verdict",
         "option --uncertainty"),
        (calibrated, "6.5, not 7.8", "equipment, with dates and certificates of calibration", "equipment"),
    ]  # fmt: skip
    return [(clause, what, key) for stated, clause, what, key in rows if not stated]


# Pulses that are drawn one by one, those that do not pass first; beyond them the range of all is filled
MOST_LINES = 24
POINTS = 150  # points of a pulse, and of the range
COLOURS = {PASS: BLUE, CANNOT_TELL: ORANGE, FAIL: RED}
WORDS = {PASS: "passes", CANNOT_TELL: "cannot tell", FAIL: "fails"}


def drawn_shocks(shocks: Sequence[JudgedShock]) -> list[JudgedShock]:
    """Return the shocks that are drawn one by one: all of a few; else those that do not pass, and some that do."""
    if len(shocks) <= MOST_LINES:
        return list(shocks)
    odd = [shock for verdict in (FAIL, CANNOT_TELL) for shock in shocks if shock.found.verdict == verdict]
    odd = odd[: MOST_LINES // 2]
    passed = [shock for shock in shocks if shock.found.verdict == PASS]
    chosen = {round(place) for place in np.linspace(0, len(passed) - 1, MOST_LINES - len(odd))} if passed else set()
    return [*(passed[place] for place in sorted(chosen)), *odd]


def overlay(shocks: Sequence[JudgedShock], limits: PulseLimits, name: str) -> Figure:
    """Draw shocks over one another, each from the begin of the ideal pulse where the band lies best over it."""
    figure = new_figure(HALF)
    axes = figure.add_subplot()
    size, unit = axis_unit(*ACCELERATION.units)
    second, clock = time_unit(limits.pulse.duration)
    draw_limits(axes, limits, size, second)
    before, after = shown_window(limits)
    grid = np.linspace(-before, limits.pulse.duration + after, POINTS)
    drawn = drawn_shocks(shocks)
    if len(drawn) < len(shocks):
        low, high = np.full(POINTS, np.inf), np.full(POINTS, -np.inf)
        for one in shocks:
            values = np.interp(grid, one.shock.time - one.found.start, one.shock.values, np.nan, np.nan)
            low, high = np.fmin(low, values), np.fmax(high, values)
        known = np.isfinite(low) & np.isfinite(high)
        shown = (grid[known] / second, low[known] / size, high[known] / size)
        axes.fill_between(*shown, color=GREY, alpha=0.25, linewidth=0, label=f"range of all {len(shocks)}")
    named = set[str]()
    for one in drawn:
        verdict = one.found.verdict
        time = one.shock.time - one.found.start
        inside = (time >= grid[0]) & (time <= grid[-1])
        x, y = thin(time[inside], one.shock.values[inside], POINTS // 2)
        label = "" if verdict in named else WORDS[verdict]
        named.add(verdict)
        axes.plot(x / second, y / size, color=COLOURS[verdict], linewidth=0.8, alpha=0.8, label=label or "_")
    quiet(axes, plain(name, 40), f"time from the begin of the ideal pulse ({clock})", f"acceleration ({unit})")
    axes.margins(x=0.0, y=0.08)
    return legend_below(figure)


# Shocks that are listed one by one: five sheets. Of more a summary is given, and those that do not pass
MOST_LISTED = 200
# Figures of a shock, by the begin of the names of their clauses, and their SI units
FIGURES = (("peak", "m/s^2"), ("pulse width", "s"), ("velocity change", "m/s"))
_VALUE = re.compile(r"(?P<value>[−+]?\d\S*( ± \S+)?)\s(?P<unit>\D\S*)")
DOUBT = "; behind ± the expanded uncertainty, k = 2"  # ends the captions of tables of figures with it
UNSTATED = "not stated"  # stands for a direction that is not stated


def figures_of(shock: JudgedShock) -> list[Clause]:
    """Return peak, pulse width and velocity change as their clauses; as measured where the specification asks none."""
    pulse = shock.pulse
    values = (abs(pulse.peak), pulse.width, abs(pulse.velocity_change))
    clauses = []
    for (name, unit), value in zip(FIGURES, values, strict=True):
        own = [clause for clause in shock.found.clauses if clause.clause.startswith(name)]
        called = {"s": f"{name} at 10 %", "m/s": f"{name}, foot to foot"}.get(unit, name)
        clauses += own[:1] or [judged(called, value, Limits(value, value, NORMATIVE), unit)]
    return clauses


def groups(verdict: RecordsVerdict) -> Iterator[tuple[str, str, list[JudgedShock]]]:
    """Yield direction, channel and shocks of each group that has a direction and a channel in common."""
    channels = list(dict.fromkeys(shock.reading.channel.name for shock in verdict.shocks))
    for direction in (*DIRECTIONS, ""):
        for channel in channels:
            here = [one for one in verdict.shocks if (one.direction, one.reading.channel.name) == (direction, channel)]
            if here:
                yield direction, channel, here


def group_name(direction: str, channel: str, several: bool) -> str:
    """Return what a group is called."""
    words = f"direction {direction}" if direction else "direction not stated"
    return f"{words}, {channel}" if several else words


def blow_verdicts(shocks: Sequence[JudgedShock]) -> list[str]:
    """Return the verdict on each blow: one on several channels is one, and passes where it does on all."""
    blows: dict[tuple[str, int], list[str]] = {}
    for shock in shocks:
        blows.setdefault((shock.file, shock.number), []).append(shock.found.verdict)
    return [together(of_channels) for of_channels in blows.values()]


def direction_tables(records: RecordsVerdict) -> list[Table]:
    """Return what was asked of each direction and what was done, and the clauses on all shocks together."""
    count = records.specification.count()
    clauses = {clause.clause: clause for clause in records.campaign}
    asked = NONE
    if count is not None:
        asked = f"{count.low:g}" if not math.isfinite(count.high) else f"{count.low:g} to {count.high:g}"
    rows: list[list[Cell]] = []
    for direction in (*DIRECTIONS, ""):
        here = [one for one in records.shocks if one.direction == direction]
        clause = clauses.pop(f"shocks in {direction}", None)
        if not here and clause is None:
            continue
        verdicts = blow_verdicts(here)
        counts: list[Cell] = [len(verdicts), *(verdicts.count(verdict) for verdict in (PASS, FAIL, CANNOT_TELL))]
        axis = direction.lstrip("+-") or NONE
        rows.append([direction or UNSTATED, axis, asked, *counts, NONE if clause is None else tag_of(clause.verdict)])
    heads = ["direction", "axis", "shocks asked for", "done", "pass", "fail", "cannot tell", "verdict"]
    others: list[list[Cell]] = [
        [one.clause, limit_words(one), value_words(one), tag_of(one.verdict), one.reason or NONE]
        for one in clauses.values()
    ]
    tables = [Table("Shocks by direction", heads, rows, "No shock was recorded.")]
    if others:
        tables.append(Table("All shocks together", ["clause", "asked for", "found", "verdict", "why"], others))
    return tables


def shock_tables(verdict: RecordsVerdict, names: dict[str, str]) -> list[Table]:
    """Return all shocks in a table or, of many, a summary, those that do not pass, and the largest and smallest."""
    numbered = list(enumerate(verdict.shocks, start=1))
    if len(numbered) <= MOST_LISTED:
        return [_listed(numbered, verdict, names, f"Each shock{DOUBT}")]
    odd = [one for one in numbered if one[1].found.verdict != PASS]
    left = f", the first {MOST_LISTED} of {len(odd)}" if len(odd) > MOST_LISTED else ""
    outliers = _listed(odd[:MOST_LISTED], verdict, names, f"Shocks that do not pass{left}{DOUBT}")
    extremes = _listed(_extremes(numbered), verdict, names, f"Shocks with the largest and smallest figures{DOUBT}")
    return [_summary(verdict), outliers, extremes]


def _listed(
    numbered: Sequence[tuple[int, JudgedShock]], verdict: RecordsVerdict, names: dict[str, str], caption: str
) -> Table:
    several = several_channels(verdict)
    rows: list[list[Cell]] = []
    for number, shock in numbered:
        inside = [clause for clause in shock.found.clauses if clause.clause == "band"]
        rows.append(
            [
                number,
                shock.direction or NONE,
                names[shock.file],
                *([shock.reading.channel.name] if several else []),
                shock.number,
                faces.amount(SECONDS, shock.pulse.time, digits=6),
                *map(doubted_words, figures_of(shock)),
                value_words(inside[0]) if inside else NONE,
                tag_of(shock.found.verdict),
                why_of_shock(shock),
            ]
        )
    heads = ["#", "direction", "record", *(["channel"] if several else []), "blow", "time"]
    heads += [*(clause_name(clause.clause) for clause in figures_of(verdict.shocks[0])), "band", "verdict", WHY_HEAD]
    empty = [place for place, head in enumerate(heads) if head == "band" and all(row[place] == NONE for row in rows)]
    places = [place for place in range(len(heads)) if place not in empty]
    return Table(
        caption, *_units_in_heads([heads[k] for k in places], [[row[k] for k in places] for row in rows]), "None."
    )


def _units_in_heads(heads: Sequence[str], rows: Sequence[Sequence[Cell]]) -> tuple[list[str], list[list[Cell]]]:
    """Move a unit with which all cells of a column end into its head.

    Examples
    --------
    >>> _units_in_heads(["peak", "why"], [["50 ± 2 g", "-"], ["9.1 ± 0.4 g", "peak"]])
    (['peak (g)', 'why'], [['50 ± 2', '-'], ['9.1 ± 0.4', 'peak']])
    """
    columns = [[row[place] for row in rows] for place in range(len(heads))]
    named = list(heads)
    for place, column in enumerate(columns):
        parts = [_VALUE.fullmatch(str(cell)) for cell in column if cell != NONE]
        units = {part["unit"] for part in parts if part}
        if len(units) == 1 and all(parts):
            named[place] = f"{heads[place]} ({units.pop()})"
            columns[place] = [cell if cell == NONE else _VALUE.sub(r"\g<value>", str(cell)) for cell in column]
    return named, [list(row) for row in zip(*columns, strict=True)]


def _summary(verdict: RecordsVerdict) -> Table:
    """Return range, mean and scatter of each figure of each group."""
    several, rows = several_channels(verdict), list[list[Cell]]()
    for direction, channel, here in groups(verdict):
        for clauses in zip(*(figures_of(one) for one in here), strict=True):
            values = [clause.value for clause in clauses if math.isfinite(clause.value)]
            if not values:
                continue
            mean, model = fmean(values), clauses[0]
            ends = [amount(model, value) for value in (min(values), mean, max(values))]
            scatter = percent(stdev(values) / mean, 2) if len(values) > 1 and mean else NONE
            rows.append(
                [group_name(direction, channel, several), clause_name(model.clause), len(values), *ends, scatter]
            )
    heads = ["shocks", "figure", "number", "smallest", "mean", "largest", "scatter (CV)"]
    return Table("All shocks, by direction", heads, rows)


def _extremes(numbered: Sequence[tuple[int, JudgedShock]]) -> list[tuple[int, JudgedShock]]:
    """Return the shocks with the largest and smallest of each figure."""
    chosen: dict[int, JudgedShock] = {}
    figures = [(number, shock, figures_of(shock)) for number, shock in numbered]
    for place in range(len(FIGURES)):
        known = [(row[place].value, number, shock) for number, shock, row in figures if math.isfinite(row[place].value)]
        for pick in (min, max) if known else ():
            _, number, shock = pick(known, key=lambda pair: pair[0])
            chosen[number] = shock
    return sorted(chosen.items(), key=lambda pair: pair[0])


FILE = "test-report.html"
MOST_DRAWN = 24  # groups of shocks, each of a direction and a channel, that are drawn
MOST_FILES = 300  # files that are listed with their SHA-256; record.toml has all
MOST_FINDINGS = 40  # findings that are listed; the report of the records has all
ONLY_ITEMS = "The results relate only to the items tested."
IN_FULL = "This report shall not be reproduced except in full, unless the laboratory agrees in writing."
UNSIGNED = (("tested by", ""), ("authorized by", ""))  # lines to sign where none are stated


def report_of_test(result: RecordResult) -> str:
    """Return the test report of records that were judged by a specification, as one HTML page."""
    verdict, stated = result.verdict, result.performed or NO_TEST
    if verdict is None:
        raise ValueError("a test report needs a verdict")
    if not result.origin.digests:  # Python does not take them before they are shown
        digests = digests_of([Path(file.path) for file in result.readings])
        result = replace(result, origin=replace(result.origin, digests=digests))
    names = short_names([file.path for file in result.readings])
    number = stated.tables.report.number or f"of records {result.source.digest[:12]}".rstrip()
    head = Head(
        title=f"Test report {number}",
        kicker=stated.test.laboratory or "Shock test",
        subject="Specification",
        name=verdict.specification.title,
        digest="",
        status=tag_of_records(verdict, stated),
        summary=[sentence(verdict, names), *_lapse_words(stated)],
        numbers=_key_numbers(verdict),
        foot=f"test report {number}",
        test=_cover(stated),
    )
    count = len(verdict.shocks)
    many = f"{count} shocks are summed up here; the file shocks.csv lists each with its verdict."
    signatures = [(one.role or "signed by", one.name) for one in stated.tables.signature]
    sections = [
        _items(stated),
        _specification(verdict),
        Section("Directions and counts", "", direction_tables(verdict)),
        _setup(stated),
        Section("Shocks", many * (count > MOST_LISTED), shock_tables(verdict, names) if verdict.shocks else []),
        _pulses(verdict),
        _deviations(result, verdict, stated, names),
        _conclusions(verdict, stated, names),
        Section("Signatures", "", [SignatureLines(signatures or list(UNSIGNED))], alone=True),
        _annex(result, verdict, stated),
        _not_stated(stated, verdict),
        Section(f"End of test report {number}", ""),
    ]
    return whole_page(head, sections)


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


def _key_numbers(verdict: RecordsVerdict) -> list[tuple[str, str]]:
    verdicts = blow_verdicts(verdict.shocks)
    nominal = {row.clause: row.limit for row in asked_rows(verdict.specification)}
    counts = [("shocks", len(verdicts)), ("pass", verdicts.count(PASS)), ("fail", verdicts.count(FAIL))]
    unclear = verdicts.count(CANNOT_TELL)
    counts += [("cannot tell", unclear)] if unclear else []
    return [
        *((name, str(count)) for name, count in counts),
        *((name, nominal[name]) for name in ("nominal peak", "nominal duration") if name in nominal),
    ]


def _fields(caption: str, rows: Iterable[tuple[str, str]]) -> list[Part]:
    """Return a table of what is stated; none where nothing is."""
    cells: list[list[Cell]] = [[name, text] for name, text in rows if text]
    return [Table(caption, ["what", "stated"], cells)] if cells else []


def _named_fields(table: CaseTable, names: Sequence[str] = ()) -> list[tuple[str, str]]:
    """Return the texts of a table with their keys in words."""
    return [(_in_words(key), str(getattr(table, key))) for key in names or type(table).model_fields]


def _in_words(key: str) -> str:
    return key.replace("_", " ")


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
    stated_keys = type(tables.specimen[0]).model_fields if tables.specimen else ()
    keys = [key for key in stated_keys if any(getattr(row, key) for row in tables.specimen)]
    specimens: list[list[Cell]] = [
        [number, *(getattr(row, key) or NONE for key in keys)] for number, row in enumerate(tables.specimen, 1)
    ]
    item = [("item", test.item), ("serial number", test.serial_number)] if not tables.specimen else []
    parts = [
        *_fields("Laboratory", laboratory),
        *_fields("Customer and order", ordered),
        *_fields("Item", item),
        *([Table("Items", ["#", *map(_in_words, keys)], specimens)] if specimens else []),
    ]
    return Section("Laboratory, customer, items", "" if parts else "Nothing is stated of them.", parts)


def _specification(verdict: RecordsVerdict) -> Section:
    file = verdict.specification.file
    rows = asked_rows(verdict.specification, clause_name)
    if verdict.limits.band is not None:
        band = verdict.limits.band
        words = f"{100.0 * band.time:g} % of the duration, {100.0 * band.amplitude:g} % of the peak"
        rows.append(AskedRow("tolerance band", words, verdict.limits.band_status))
    text = f"{verdict.specification.title} ({file.edition}).\n\n{_decision(verdict)}\n\n{limit_words_of(verdict)}"
    table = page_table("What is asked of a shock", columns_of(AskedRow, rows))
    return Section("Specification and decision rule", text, [table])


def _decision(verdict: RecordsVerdict) -> str:
    """Say by which rule conformity is stated, and with which uncertainty."""
    if verdict.asked.rule == "simple":
        rule = "simple acceptance: a value within its limits passes, whatever its uncertainty (JCGM 106:2012, 8.2)"
    else:
        rule = (
            "guarded: within the expanded uncertainty of a limit neither pass nor fail is stated (ISO 14253-1, JCGM "
            "106:2012, 8.3)"
        )
    held = f"it holds {listed(list(verdict.asked.holds))}"
    left = f"; not stated, and not in it: {listed(list(verdict.asked.not_stated))}" if verdict.asked.not_stated else ""
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


def _pulses(verdict: RecordsVerdict) -> Section:
    several = several_channels(verdict)
    parts: list[Part] = []
    found_groups = list(groups(verdict))
    for direction, channel, here in found_groups[:MOST_DRAWN]:
        name, drawn = group_name(direction, channel, several), drawn_shocks(here)
        words = f"{name[:1].upper()}{name[1:]}: {len(here)} shock{'s' if len(here) > 1 else ''}"
        words += f", {len(drawn)} of them drawn one by one" if len(drawn) < len(here) else ""
        parts.append(Picture(overlay(here, verdict.limits, name), f"{words}."))
    left = len(found_groups) - MOST_DRAWN
    return Section(
        "Pulses", f"{left} more are not drawn." if left > 0 else "" if parts else "No shock was recorded.", parts
    )


def _deviations(result: RecordResult, verdict: RecordsVerdict, stated: StatedTest, names: dict[str, str]) -> Section:
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
        [clause.clause, clause.reason] for clause, _ in verdict.clauses if clause.verdict == NOT_JUDGED
    ]
    skipped += [[one.text, "not judged by a record"] for one in verdict.specification.file.demand]
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


def _conclusions(verdict: RecordsVerdict, stated: StatedTest, names: dict[str, str]) -> Section:
    after = [f"{one.name or one.serial_number}: {one.result}" for one in stated.tables.specimen if one.result]
    words = [
        sentence(verdict, names),
        "The verdict rests on limits from memory: they have to be held against the standard before it is relied on."
        if verdict.by_indicative
        else "",
        *_lapse_words(stated),
        f"Inspection after the test: {'; '.join(after)}." if after else "",
        *stated.tables.report.statements,
        ONLY_ITEMS,
        IN_FULL,
    ]
    return Section("Conclusions", "\n\n".join(word for word in words if word))


def _judged_by(result: RecordResult, verdict: RecordsVerdict, stated: StatedTest) -> list[Part]:
    """Return the files by which the records were judged, with their SHA-256, and the uncertainty budget."""
    budget = result.budget
    stated_in = [
        ("specification", verdict.specification.path),
        ("uncertainty budget", (budget and budget.file) or ""),
        ("test", stated.file),
    ]
    digests = digests_of([Path(file) for _, file in stated_in if file])
    rows: list[list[Cell]] = [
        [what, file, digests[str(Path(file))]] for what, file in stated_in if file and str(Path(file)) in digests
    ]
    tables: list[Part] = [Table("Judged by", ["what", "file", "SHA-256"], rows)] if rows else []
    return tables if budget is None else [*tables, source_table(budget)]


def _annex(result: RecordResult, verdict: RecordsVerdict, stated: StatedTest) -> Section:
    source = result.source
    files: list[list[Cell]] = [[name, digest] for name, digest in list(source.digests.items())[:MOST_FILES]]
    left = len(source.digests) - MOST_FILES
    caption = "Records" + (
        f", the first {MOST_FILES} of {len(source.digests)}; record.toml has all" if left > 0 else ""
    )
    calibrations: list[list[Cell]] = [list(pair) for pair in result.calibrations[:MOST_FINDINGS]]
    parts: list[Part] = [
        Table(caption, ["file", "SHA-256"], files, "The files were not hashed."),
        *_judged_by(result, verdict, stated),
        Table("Calibration of the channels", ["where it is stated", "what"], calibrations, "The files state it alone."),
        *([Code(source.asked)] if source.asked else []),
        *chapters.warnings(result.notices).parts,
    ]
    command = ", by the command below" if source.asked else ""
    text = f"Evaluated with strikewave {__version__}{command}, from these files."
    return Section("Annex: records, uncertainty budget, software, warnings", text, parts)


def _not_stated(stated: StatedTest, verdict: RecordsVerdict) -> Section:
    rows: list[list[Cell]] = [list(row) for row in missing(stated, verdict.asked.budget is not None)]
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
