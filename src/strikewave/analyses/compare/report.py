"""A comparison in words and tables, for screen and report, and its report."""

from __future__ import annotations

import math
from pathlib import Path

from strikewave.analyses.clauses import (
    SHOWN,
    clause_columns,
    clause_words,
    held_words,
    verdict_sentence,
    verdict_tag,
    why_column,
)
from strikewave.analyses.compare.curve import SpecificationVerdict
from strikewave.analyses.compare.figures import half_figures, overlay, summary_figure
from strikewave.analyses.compare.limits import verdict_of
from strikewave.analyses.compare.result import TOGETHER, CompareResult, IsoScores
from strikewave.base.shock_quantities import MICROSECONDS
from strikewave.base.texts import percent
from strikewave.reporting import chapters
from strikewave.reporting.columns import page_table
from strikewave.reporting.faces import amount, columns_of, face_table, line_table
from strikewave.reporting.parts import Part, Picture, Section, Table
from strikewave.reporting.run_and_write import drawing
from strikewave.reporting.style import save
from strikewave.signal.iso18571 import RATE, SAMPLES
from strikewave.specifications.judging import CANNOT_TELL, FAIL, PASS

SIDES = "A is the reference; the shift is added to the times of B."


def compare_words(result: CompareResult) -> str:
    """Say in words how well the two agree."""
    found, rating = result.agreement, result.agreement.rating
    peak, width = result.figures["peak"], result.figures["width"]
    words = [
        f"{result.b.name} agrees with {result.a.name} to {rating.overall:.2f} of 1 by ISO/TS 18571 ({rating.grade}):"
    ]
    parts = [f"peak {percent(peak.difference, 1, '+')}"]
    if math.isfinite(width.difference):
        parts.append(f"pulse width at 10 % {percent(width.difference, 1, '+')}")
    parts.append(f"RMS difference {percent(found.rms)}")
    words[0] += f" {', '.join(parts)}."
    words.append("Not aligned." if result.align == "none" else f"B is shifted by {result.shift_words}.")
    if found.deviation is not None:
        words.append(
            f"{percent(found.inside(result.factor), 0)} of the interval lies within the corridor of "
            f"± {result.factor:g} standard deviations."
        )
    if result.judged:
        count = sum(one.verdict == PASS for one in result.judged)
        words.insert(0, f"{SHOWN[verdict_of(result.judged) or PASS]}: {count} of {len(result.judged)} limits kept.")
    if result.specified is not None:
        words.insert(0, specification_words(result.specified))
    if result.verdicts.words:
        words.insert(0, result.verdicts.sentence)
    return " ".join(words)


def specification_words(judged: SpecificationVerdict) -> str:
    """Say what a specification comes to, and why."""
    by = f" by {judged.specification.title} ({judged.specification.file.edition})."
    words = [verdict_sentence(judged.verdict, judged.by_indicative, judged.found.clauses, by)]
    words += [f"{clause_words(clause)}." for clause in judged.found.clauses if clause.verdict in (FAIL, CANNOT_TELL)]
    return " ".join(words)


def clause_table(judged: SpecificationVerdict) -> Table:
    """Return the clauses of a specification with what came out."""
    clauses = judged.found.clauses
    return page_table(f"By {judged.specification.title}", [*clause_columns(clauses), why_column(clauses)])


def budget_words(result: CompareResult) -> str:
    """Say what the uncertainties of A and B are, and hold."""
    assert result.budget is not None
    words = "± of A and B is the expanded uncertainty U, that of the difference its standard uncertainty. "
    return words + held_words(result.budget.names, result.budget.not_stated)


def agreement_tables(result: CompareResult) -> list[Table]:
    """Return figures of both, what is measured of both together, and the scores of ISO/TS 18571."""
    together = line_table(result, TOGETHER, "Agreement", "of both together", result.given_units)
    scores = page_table("ISO/TS 18571", columns_of(IsoScores, [result.metrics.iso18571]))
    return [face_table(result, "pairs"), together, scores]


def scaling_words(result: CompareResult) -> str:
    """Say how time was scaled for ISO/TS 18571."""
    begin, end = result.agreement.interval
    return (
        f"The standard is made for signals sampled at {RATE / 1e3:g} kHz: the interval of "
        f"{amount(MICROSECONDS, end - begin)} is taken as {SAMPLES} such samples, time stretched "
        f"{result.metrics.iso18571.stretched:.3g} times. Its phase score is what the alignment leaves."
    )


def compare_report(result: CompareResult) -> str:
    """Return the report of a comparison as one HTML page: no script, nothing fetched, the same bytes."""
    pictures: list[Part] = [
        Picture(
            overlay(result),
            "Both histories over one another. The dotted lines are the ends of the interval in which they are judged.",
        )
    ]
    pictures += [Picture(figure, words) for figure, words in half_figures(result)]
    *tables, scores = agreement_tables(result)
    sections = [
        *([_specification(result.specified)] if result.specified is not None else []),
        *([Section("Limits", "", [face_table(result, "judged")])] if result.judged else []),
        Section("Comparison", "", pictures),
        Section("Figures", "" if result.budget is None else budget_words(result), tables),
        *([Section("Band", "", [face_table(result, "in_bands")])] if result.in_bands else []),
        Section("Scores", scaling_words(result), [scores]),
        Section(
            "What is compared",
            "A is the reference; the shift is added to the times of B.",
            [face_table(result, "sides")],
        ),
        chapters.warnings(result.notices),
    ]
    by_indicative = result.specified is not None and result.specified.by_indicative
    tag = None
    if result.verdict is not None:
        clauses = () if result.specified is None else result.specified.found.clauses
        tag = verdict_tag(result.verdict, by_indicative, clauses)
    summary = chapters.Summary("Report of a comparison", compare_words(result), result.highlights(), tag)
    return chapters.result_page(result, summary, sections)


def _specification(judged: SpecificationVerdict) -> Section:
    """Show what a specification comes to."""
    words = (
        f"{judged.decision} The status of a limit is normative (read in the standard), quoted (second-hand) or "
        "indicative (from memory)."
    )
    if judged.limits.band is not None:
        words += " The band lies where the smallest distance of A to it is largest."
    words += f" Source: {judged.specification.file.source}."
    return Section("Verdict by the specification", words, [clause_table(judged)])


# Picture and page of a result in Python, see `strikewave.reporting.shown_result`
picture, page = summary_figure, compare_report


def draw_result(result: CompareResult, folder: Path) -> list[str]:
    """Write page and summary of a comparison into a folder, and return their names."""
    with drawing(folder / "summary.svg") as path:
        save(summary_figure(result), path)
    with drawing(folder / "report.html") as path:
        path.write_text(compare_report(result), "utf-8", newline="\n")
    return ["report.html", "summary.svg"]
