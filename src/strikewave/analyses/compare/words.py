"""A comparison in words and tables, for screen and report."""

from __future__ import annotations

import math

from strikewave.analyses.compare.agreement import PairOfFigures
from strikewave.analyses.compare.limits import METRICS, value_words, verdict_of
from strikewave.analyses.compare.result import INTEGRALS, NAMES, CompareResult, shift_words
from strikewave.analyses.compare.specified import SpecificationVerdict
from strikewave.base.constants import COVERAGE
from strikewave.reporting.banded_numbers import band_text
from strikewave.reporting.clause_words import (
    CLAUSE_HEADS,
    SHOWN,
    clause_cells,
    clause_words,
    held_words,
    tag_of,
    verdict_sentence,
)
from strikewave.reporting.numbers import NO_DOUBT, axis_unit, doubted, headed, percent, shown, with_unit
from strikewave.reporting.parts import NONE, Cell, Table, Tag, written
from strikewave.signal.iso18571 import RATE, SAMPLES
from strikewave.specifications.decisions import CANNOT_TELL, FAIL, PASS

LEAST_SHOWN = 5e-5
"""Uncertainty of a difference from which on it is shown: 0.01 % rounded."""


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
    words.append("Not aligned." if result.align == "none" else f"B is shifted by {shift_words(result)}.")
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
    rows: list[list[Cell]] = [[*clause_cells(clause), clause.reason or NONE] for clause in judged.found.clauses]
    return Table(f"By {judged.specification.title}", [*CLAUSE_HEADS, "why"], rows)


def shown_units(result: CompareResult, name: str) -> tuple[str, str]:
    """Return SI unit and usual unit of a figure."""
    if name == "peak":
        return result.unit, result.usual
    return ("s", "us") if name == "width" else (INTEGRALS[result.unit], INTEGRALS[result.unit])


def difference_words(pair: PairOfFigures) -> str:
    """Return a difference with its standard uncertainty, where one is known."""
    if not math.isfinite(pair.difference):
        return NONE
    doubt = f" ± {percent(pair.uncertainty, 2)}" if pair.uncertainty >= LEAST_SHOWN else ""
    return percent(pair.difference, 2, "+") + doubt


def figure_table(result: CompareResult) -> Table:
    """Return peak, width and integral of both."""
    rows: list[list[Cell]] = []
    for name, pair in result.figures.items():
        si, usual = shown_units(result, name)
        pairs = ((pair.a, pair.a_uncertainty, result.a), (pair.b, pair.b_uncertainty, result.b))
        cells = [_figure_words(v, u if curve.budgeted else 0.0, si, usual) for v, u, curve in pairs]
        rows.append([headed(NAMES[name], si, usual), *cells, difference_words(pair)])
    return Table("Largest pulse", ["figure", "A", "B", "difference"], rows)


def _figure_words(value: float, doubt: float, si: str, usual: str) -> str:
    """Return a figure, with its expanded uncertainty where a budget gives one."""
    if math.isnan(value):
        return NONE
    texts = [written(shown(v, si, usual) if si else v, n) for v, n in ((value, 4), (COVERAGE * doubt, 2))]
    return texts[0] if doubt == 0.0 else f"{texts[0]} ± {texts[1] if math.isfinite(doubt) else '?'}"


def budget_words(result: CompareResult) -> str:
    """Say what the uncertainties of A and B are, and hold."""
    assert result.budget is not None
    words = "± of A and B is the expanded uncertainty U, that of the difference its standard uncertainty. "
    return words + held_words(result.budget.names, result.budget.not_stated)


def agreement_table(result: CompareResult) -> Table:
    """Return what is measured of both together."""
    found = result.agreement
    begin, end = found.interval
    rows: list[list[Cell]] = [
        ["RMS of the difference over that of A", percent(found.rms, 2)],
        ["correlation coefficient", f"{found.correlation:.5f}"],
    ]
    if found.ratio.size:
        ratio, frequency = found.largest_ratio
        where = with_unit(frequency, "Hz", "kHz", 3)
        rows.append(["largest ratio of shock response spectra", f"{ratio:+.2f} dB at {where}"])
    rows.append(["shift of B", shift_words(result)])
    if found.deviation is not None:
        inside = percent(found.inside(result.factor), 1)
        rows.append([f"within the corridor, ± {result.factor:g} standard deviations", inside])
    usual = "us" if end - begin < 2e-3 else "ms"
    length = with_unit(end - begin, "s", usual)
    since = f"{written(shown(begin, 's', usual), 6)} to {written(shown(end, 's', usual), 6)}"
    rows.append([headed("interval in which they are judged", "s", usual), f"{since} ({length})"])
    if result.low_pass is not None:
        rows.append(["low-pass on both", str(result.low_pass)])
    return Table("Agreement", ["of both together", "value"], rows)


def score_table(result: CompareResult) -> Table:
    """Return the scores of ISO/TS 18571."""
    rating = result.agreement.rating
    heads = ["corridor", "phase", "magnitude", "slope", "overall", "grade"]
    row: list[Cell] = [f"{value:.3f}" for value in rating[:5]]
    return Table("ISO/TS 18571", heads, [[*row, rating.grade]])


def scaling_words(result: CompareResult) -> str:
    """Say how time was scaled for ISO/TS 18571."""
    begin, end = result.agreement.interval
    return (
        f"The standard is made for signals sampled at {RATE / 1e3:g} kHz: the interval of "
        f"{with_unit(end - begin, 's', 'us')} is taken as {SAMPLES} such samples, time stretched "
        f"{result.scaling['stretched']:.3g} times. Its phase score is what the alignment leaves."
    )


def limit_table(result: CompareResult) -> Table:
    """Return the limits with what came out."""
    rows: list[list[Cell]] = []
    for one in result.judged:
        unit = METRICS[one.limit.metric][0]

        def cell(value: float, unit: str = unit) -> str:
            if math.isnan(value):
                return NONE
            if unit == "s":
                size, name = axis_unit("s", "us")
                return f"{written(value / size)} {name}"
            return value_words(value, unit)

        words, verdict = METRICS[one.limit.metric][1], tag_of(one.verdict)
        doubt = result.expanded.get(one.limit.metric, 0.0)
        value = cell(one.value)
        if math.isfinite(one.value) and doubt > NO_DOUBT * abs(one.value):
            size, name = axis_unit("s", "us") if unit == "s" else (0.01, unit)
            value = f"{' ± '.join(doubted(one.value / size, doubt / size))} {name}"
        rows.append([one.limit.typed, verdict, value, cell(one.margin), words])
    return Table("Limits", ["limit", "verdict", "value ± U", "margin", "of"], rows)


def band_table(result: CompareResult) -> Table:
    """Return the figures of one that the other has a band of."""
    rows: list[list[Cell]] = []
    for name, owner, value, band, inside in result.in_bands:
        si, usual = shown_units(result, name)
        cells = [with_unit(abs(value), si, usual), band_text(band, si, usual)]
        verdict = Tag("inside", "good") if inside else Tag("outside", "warned")
        rows.append([f"{NAMES[name]} of {owner}", *cells, verdict])
    return Table("Band of the simulation", ["figure", "value", "band", "lies"], rows)
