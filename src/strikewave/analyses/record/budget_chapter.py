"""Uncertainty of blows as tables and a chapter: each figure with ±, and the budget of the largest blow."""

from __future__ import annotations

import math
from collections.abc import Sequence

from strikewave.analyses.clauses import held_words
from strikewave.analyses.record.figures.records import figure_unit
from strikewave.analyses.record.result import RecordResult
from strikewave.analyses.record.tables import Names, called, figure_text, percents, rows_of
from strikewave.base.constants import COVERAGE
from strikewave.base.shock_quantities import MICROSECONDS
from strikewave.records.budget import ADDED, NORMAL, RECORD, RECTANGULAR, SAMPLING, Budget, Contribution
from strikewave.records.measured_uncertainty import BlowUncertainty, BudgetLine, FigureUncertainty
from strikewave.records.pulse_shape import BUDGETED
from strikewave.records.reading import ChannelReading
from strikewave.records.record import Channel
from strikewave.reporting import faces
from strikewave.reporting.numbers import doubted, listed
from strikewave.reporting.parts import NONE, Cell, Section, Table, written

MOST_ROWS = 60  # blows of the table; pulses.csv has all
SAME_COVERAGE = 0.05  # difference to k = 2 from which a coverage factor is written
LEAST_SHARE = 1e-4  # share of a variance below which it is written as none
# Kinds whose number is a share of an effect, of which the budget states the whole
WHOLE = ("resonance", "coupling", "response")


def with_doubt(value: float, name: str, unit: str, expanded: float) -> str:
    """Write a figure with its expanded uncertainty behind it.

    Examples
    --------
    >>> with_doubt(5001.4, "peak", "m/s^2", 196.133), with_doubt(490.3325, "peak", "m/s^2", 18.9)
    ('510 ± 20 g', '50.0 ± 1.9 g')
    """
    scale, _, shown = figure_unit(name, unit)
    if not math.isfinite(expanded):
        return f"{figure_text(name, unit, value)} ± ?"
    return f"{' ± '.join(doubted(value / scale, expanded / scale))} {shown}".rstrip()


def mean_expanded(reading: ChannelReading, name: str) -> float:
    """Return the mean expanded uncertainty of a figure of the blows of a channel: gains are common to all."""
    known = [one.figures[name].expanded for one in reading.uncertainties]
    return sum(known) / len(known) if known else math.nan


def uncertainty_table(result: RecordResult, names: Names) -> Table:
    """Return the figures of each blow with their expanded uncertainties."""
    rows_of_files = [row for row in rows_of(result.readings) if row[1].uncertainties]
    several = len({reading.channel.name for _, reading in rows_of_files}) > 1
    units = {reading.channel.unit for _, reading in rows_of_files}
    unit = units.pop() if len(units) == 1 else ""
    rows: list[list[Cell]] = []
    total = 0
    for file, reading in rows_of_files:
        for number, blow in enumerate(reading.uncertainties, 1):
            total += 1
            if len(rows) < MOST_ROWS:
                rows.append(
                    [
                        names[file.path],
                        *([reading.channel.name] if several else []),
                        str(number),
                        *(_figure_words(blow.figures[name], name, reading.channel.unit) for name in BUDGETED),
                    ]
                )
    heads = ["file", *(["channel"] if several else []), "#", *(called(name, unit) for name in BUDGETED)]
    left = f", the first {MOST_ROWS} of {total} blows" if total > MOST_ROWS else ""
    return Table(f"Expanded uncertainty{left}", heads, rows, "No blow was found.")


def _figure_words(figure: FigureUncertainty, name: str, unit: str) -> str:
    factor = "" if abs(figure.coverage - COVERAGE) < SAME_COVERAGE else f" (k = {figure.coverage:.2g})"
    return with_doubt(figure.value, name, unit, figure.expanded) + factor * math.isfinite(figure.expanded)


def share_table(blow: BlowUncertainty) -> Table:
    """Return the share of each contribution in the variance of each figure of a blow."""
    by_name = {name: {line.name: line for line in figure_of.contributions} for name, figure_of in blow.figures.items()}
    rows: list[list[Cell]] = [
        [name, *(_share(by_name[figure][name]) for figure in BUDGETED)] for name in by_name["peak"]
    ]
    heads = ["contribution", *(name.replace("_", " ") for name in BUDGETED)]
    return Table("Shares of the variance", heads, rows)


def _share(line: BudgetLine) -> str:
    if not math.isfinite(line.standard):
        return "not known"
    return percents(line.share, 2) if line.share >= LEAST_SHARE else "0 %"


def budget_lines(result: RecordResult) -> list[str]:
    """Say what the uncertainties hold, what is not stated, and where Monte Carlo counts."""
    budget = result.budget
    assert budget is not None
    lines = [f"± U is the expanded uncertainty, about 95 %. {held_words(budget.names, budget.not_stated)}"]
    blows = [blow for _, reading in rows_of(result.readings) for blow in reading.uncertainties]
    if any(math.isnan(blow.figures["width"].expanded) for blow in blows):
        lines.append(
            "?: too little lies before the blow to know noise and baseline; state offset or noise in the budget."
        )
    checked = [blow for blow in blows if blow.trials]
    wrong = sorted({name.replace("_", " ") for blow in checked for name in blow.figures if not blow.validated[name]})
    if checked:
        trials = f"{max(blow.trials for blow in checked)} trials on the largest blow"
        words = (
            f"Monte Carlo (JCGM 101, {trials}) validates the law of propagation"
            if not wrong
            else f"Monte Carlo (JCGM 101, {trials}) does not validate the law of propagation for {listed(wrong)}: "
            "its interval of 95 % counts there, and k is its half-width over the standard uncertainty"
        )
        lines.append(f"{words}.")
    return lines


def budget_section(result: RecordResult, names: Names) -> Section:
    """Return the chapter: each figure with its uncertainty, then the budgets of the largest blow of each channel."""
    budget = result.budget
    assert budget is not None
    parts = [uncertainty_table(result, names)]
    for file, reading in rows_of(result.readings):
        for number, one in enumerate(reading.uncertainties, 1):
            if one.trials:
                where = f"{names[file.path]}, {reading.channel.name}, blow {number}"
                parts += [figure_table(budget, one.figures[name], name, reading.channel, where) for name in BUDGETED]
    parts.append(source_table(budget))
    stated = f" Budget: {budget.title} ({budget.file})." if budget.file else ""
    text = (
        " ".join(budget_lines(result)) + f"{stated} Each contribution changes the record, which is measured again: a "
        "sensitivity coefficient is the change of the figure over that of the contribution, by its standard "
        "uncertainty to both sides (JCGM 100, 5.1.3). Contributions are estimated as 0: nothing is corrected."
    )
    return Section("Uncertainty", text, parts)


def source_table(budget: Budget) -> Table:
    """Return the contributions of a budget with how their numbers are known."""
    rows: list[list[Cell]] = [
        [RECORD, "record", "what lies before the blow", "of each record"],
        [SAMPLING, "record", "anywhere between two samples", "of each record"],
    ]
    rows += [
        [row.name, row.kind, row.typed, f"{row.status}: {row.source}" if row.status else NONE]
        for row in budget.contributions
    ]
    return Table("What is stated, and by whom", ["quantity", "kind", "stated", "status and source"], rows)


def figure_table(budget: Budget, one: FigureUncertainty, name: str, channel: Channel, where: str) -> Table:
    """Return the budget of a figure: each quantity, its uncertainty, coefficient, contribution and share."""
    unit, step = channel.unit, channel.step
    known = {each.name: each for each in budget.contributions}
    rows: list[list[Cell]] = []
    for line in one.contributions:
        stated = known.get(line.name)
        rows.append(
            [
                line.name,
                *_stated_cells(line, stated, name, unit, step),
                figure_text(name, unit, line.standard, 3) if math.isfinite(line.standard) else "not known",
                _share(line),
            ]
        )
    rows.append(
        [
            f"combined, {one.method}",
            *[NONE] * 4,
            figure_text(name, unit, one.standard, 3),
            f"U = {figure_text(name, unit, one.expanded, 3)} (k = {one.coverage:.3g})",
        ]
    )
    heads = ["quantity", "stated", "distribution", "standard uncertainty", "sensitivity coefficient"]
    caption = f"Budget of the {called(name, unit)}: {figure_text(name, unit, one.value)} ({where})"
    return Table(caption, [*heads, "contribution", "share"], rows)


def _stated_cells(line: BudgetLine, stated: Contribution | None, name: str, unit: str, step: float) -> Sequence[str]:
    """Return what is stated, distribution, standard uncertainty and sensitivity coefficient of a contribution."""
    if line.name == RECORD:
        return "type A", NORMAL, figure_text(name, unit, line.standard, 3), "1"
    if line.name == SAMPLING:
        size = 0.5 * step / math.sqrt(3.0)
        own = faces.amount(MICROSECONDS, size, digits=3)
        return "half a sample", RECTANGULAR, own, _coefficient(line, size / 1e-6, name, unit, "µs")
    assert stated is not None
    size = stated.input.standard
    if not stated.relative and stated.kind in ADDED:
        own = figure_text("peak", unit, size, 3)
        per = figure_unit("peak", unit)
        return stated.typed, stated.distribution, own, _coefficient(line, size / per[0], name, unit, per[2])
    words = f"{size:.3g} of the effect" if stated.kind in WHOLE else percents(size, 3)
    of = "the effect" if stated.kind in WHOLE else "%"
    scale = 1.0 if stated.kind in WHOLE else 100.0
    return stated.typed, stated.distribution, words, _coefficient(line, scale * size, name, unit, of)


def _coefficient(line: BudgetLine, size: float, name: str, unit: str, per: str) -> str:
    """Write the change of a figure over that of a contribution."""
    scale, _, shown = figure_unit(name, unit)
    over = f" {shown}/{per}" if per != "the effect" else f" {shown}"
    return f"{written(line.standard / scale / size, 3)}{over}" if size > 0.0 else NONE
