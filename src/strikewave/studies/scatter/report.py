"""The report of a scatter study: how much blows scatter within tolerances, and which tolerance it comes from."""

from __future__ import annotations

import math
from collections.abc import Sequence

from strikewave.reporting import chapters
from strikewave.reporting.numbers import listed, with_unit
from strikewave.reporting.parts import NONE, Cell, Picture, Section, Table, Tag
from strikewave.reporting.table_columns import page_table
from strikewave.studies.scatter.columns import (
    MEAN_COLUMNS,
    WITHIN_COLUMNS,
    in_percent,
    mean_rows,
    share_columns,
    share_rows,
    sum_words,
    within_rows,
)
from strikewave.studies.scatter.figures import scatter_picture
from strikewave.studies.scatter.study import STATEMENTS, ScatterStudy


def scatter_report(study: ScatterStudy) -> str:
    """Return the report of a scatter study as one HTML page: no script, nothing fetched, the same bytes each time."""
    sections = [
        Section("Peaks and shares", "", [Picture(scatter_picture(study), _caption(study), _caption(study))]),
        _figure_section(study),
        *([_share_section(study)] if study.shares else []),
        chapters.warnings(study.notices),
        _tolerance_section(study),
        chapters.inputs(study.case),
    ]
    summary = chapters.Summary("Report of a scatter study", scatter_words(study), _key_numbers(study))
    return chapters.result_page(study, summary, sections)


def scatter_words(study: ScatterStudy) -> str:
    """Say in words what the tolerances do."""
    peak, still = study.figure("peak"), study.nominal_run.variation("peak")
    low, high = (with_unit(value, "m/s^2", "g") for value in study.peaks()[[0, 2], 0])
    words = [
        f"{len(study.completed)} full runs with every one of {_count(len(study.tolerances), 'tolerance')} drawn anew."
        + (f" {study.verdicts.sentence}" if study.verdicts.words else ""),
        f"The peak of the first blow lies between {low} and {high} in 95 % of them.",
        f"Within a run the peaks scatter by a CV of {in_percent(peak.within.median)} (median of the runs; the dynamics "
        f"alone, at nominal values, give {in_percent(still)}); from run to run the typical peak by "
        f"{in_percent(peak.typical.cv)}.",
    ]
    for shares in study.shares:
        known = [row for row in shares.rows if row.distinct]
        if known:
            words.append(f"Most of the {shares.of} comes from {known[0].path} ({in_percent(known[0].share)}).")
    return " ".join(words)


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _key_numbers(study: ScatterStudy) -> list[tuple[str, str]]:
    peak, width, interval = (study.figure(name) for name in ("peak", "width", "interval"))
    limit = peak.within.limit
    return [
        ("peak of the typical blow, mean of the runs", with_unit(peak.typical.mean, "m/s^2", "g")),
        ("CV of that peak from run to run", in_percent(peak.typical.cv)),
        ("CV of the peaks within a run, median", in_percent(peak.within.median)),
        ("CV of the peaks in 95 % of all runs at most", "no limit" if math.isinf(limit) else in_percent(limit)),
        ("width of the typical blow, mean of the runs", with_unit(width.typical.mean, "s", "us")),
        ("interval, mean of the runs", with_unit(interval.mean.mean, "s", "ms")),
    ]


def _caption(study: ScatterStudy) -> str:
    words = (
        "Above, the rigid-body peak of each blow: median and the band that holds 95 % of the runs, beside the dynamics "
        "alone."
    )
    words += " A run that failed a check is marked at its largest peak." if any(study.verdicts.marked) else ""
    return words + (" Below, the share of each tolerance with its bounds at 95 %." if study.shares else "")


def _figure_section(study: ScatterStudy) -> Section:
    """List means and scatter between runs, scatter within a run, and the kinds of blows."""
    kinds: list[list[Cell]] = [[Tag(kind, kind), *counts] for kind, counts in study.kinds().items()]
    text = f"Bounds: {STATEMENTS['mean']}. Within a run: {STATEMENTS['cv_within']}."
    tables = [
        page_table("Means of the runs, and their scatter from run to run", MEAN_COLUMNS, mean_rows(study)),
        page_table("Scatter within a run: CV (%); later is without the first blow", WITHIN_COLUMNS, within_rows(study)),
        Table("Blows that are not full", ["kind", "blows", "runs"], kinds),
    ]
    return Section("Scatter", text, tables)


def _share_section(study: ScatterStudy) -> Section:
    """List the share of each tolerance in what scatters."""
    how = "Sobol indices" if study.plan.shares == "sobol" else "each tolerance alone, all other inputs nominal"
    tables = [
        page_table(
            f"Shares in the {shares.of}; {shares.runs} runs each (*: not significant, 95 %)",
            share_columns(study),
            share_rows(study, shares),
        )
        for shares in study.shares
    ]
    sums = [f"{shares.of}: {sum_words(shares)}" for shares in study.shares]
    return Section("Shares", f"By {how}. The shares add up to: {'; '.join(sums)}.", tables)


def _tolerance_section(study: ScatterStudy) -> Section:
    """List what was drawn, and how."""
    rows: list[Sequence[Cell]] = []
    for one in study.tolerances:
        assert one.value.tolerance is not None
        provenance = Tag(one.value.provenance, one.value.provenance)
        drawn = "each striker" if one.strikers else "once a run"
        band = f"{one.value.typed} ± {one.value.tolerance.typed}"
        rows.append([one.path, band, one.value.tolerance.distribution, drawn, provenance, one.value.note or NONE])
    plan = study.plan
    failed = len(study.runs) - len(study.completed)
    left = (
        f" {_count(failed, 'run')} could not be made and {'is' if failed == 1 else 'are'} left out." if failed else ""
    )
    text = f"{plan.runs} runs, random seed {plan.seed}: equal seeds reproduce them bit for bit.{left}"
    heads = ["tolerance", "value", "distribution", "drawn", "provenance", "note"]
    names = listed([one.path for one in study.tolerances[:3]])
    return Section("What was drawn", text, [Table(f"Tolerances, such as {names}", heads, rows)])
