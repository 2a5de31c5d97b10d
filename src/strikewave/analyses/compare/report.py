"""The report of a comparison."""

from __future__ import annotations

from strikewave.analyses.compare.figures import half_figures, overlay
from strikewave.analyses.compare.result import CompareResult
from strikewave.analyses.compare.specified import SpecificationVerdict
from strikewave.analyses.compare.words import (
    agreement_table,
    band_table,
    budget_words,
    clause_table,
    compare_words,
    figure_table,
    limit_table,
    scaling_words,
    score_table,
)
from strikewave.reporting import chapters
from strikewave.reporting.clause_words import verdict_tag
from strikewave.reporting.numbers import with_unit
from strikewave.reporting.parts import Cell, Part, Picture, Section, Table


def compare_report(result: CompareResult) -> str:
    """Return the report of a comparison as one HTML page: no script, nothing fetched, the same bytes."""
    pictures: list[Part] = [
        Picture(
            overlay(result),
            "Both histories over one another. The dotted lines are the ends of the interval in which they are judged.",
        )
    ]
    pictures += [Picture(figure, words) for figure, words in half_figures(result)]
    tables: list[Part] = [figure_table(result), agreement_table(result)]
    sections = [
        *([_specification(result.specified)] if result.specified is not None else []),
        *([Section("Limits", "", [limit_table(result)])] if result.judged else []),
        Section("Comparison", "", pictures),
        Section("Figures", "" if result.budget is None else budget_words(result), tables),
        *([Section("Band", "", [band_table(result)])] if result.in_bands else []),
        Section("Scores", scaling_words(result), [score_table(result)]),
        _sources(result),
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


def _sources(result: CompareResult) -> Section:
    """List what A and B are."""
    rows: list[list[Cell]] = [
        [
            which,
            curve.name,
            curve.kind + (f" of {curve.count}" if curve.count > 1 else ""),
            with_unit(1.0 / curve.history.step, "Hz", "kHz"),
            str(curve.history.values.size),
            with_unit(curve.history.noise, curve.unit, result.usual, 3) if curve.history.noise else "none",
        ]
        for which, curve in (("A", result.a), ("B", result.b))
    ]
    heads = ["", "name", "kind", "sampling rate", "samples", "noise (standard deviation)"]
    words = "A is the reference; the shift is added to the times of B."
    return Section("What is compared", words, [Table("Histories", heads, rows)])
