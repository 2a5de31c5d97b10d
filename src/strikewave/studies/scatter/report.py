"""The report of a scatter study: how much blows scatter within tolerances, and which tolerance it comes from."""

from __future__ import annotations

import math
from collections.abc import Sequence

from strikewave.reporting import chapters
from strikewave.reporting.numbers import headed, listed, shown, with_unit
from strikewave.reporting.parts import NONE, Cell, Picture, Section, Table, Tag, written
from strikewave.studies.scatter.figures import scatter_picture
from strikewave.studies.scatter.study import STATEMENTS, ScatterStudy
from strikewave.uncertainty.shares import Shares

FIGURES = {
    "peak": ("peak", "m/s^2", "g"),
    "width": ("pulse width at 10 %", "s", "us"),
    "interval": ("interval", "s", "ms"),
    "velocity_change": ("velocity change", "m/s", "m/s"),
}
"""Figures of a blow: what they are called, SI unit, and the usual unit."""
FEWEST_DIGITS = 3
"""Significant digits of coefficients of variation and shares: their bounds are wider."""


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
        f"{len(study.completed)} full runs with every one of {_count(len(study.tolerances), 'tolerance')} drawn anew.",
        f"The peak of the first blow lies between {low} and {high} in 95 % of them.",
        f"Within a run the peaks scatter by a CV of {_share(peak.within.median)} (median of the runs; the dynamics "
        f"alone, at nominal values, give {_share(still)}); from run to run the typical peak by "
        f"{_share(peak.typical.cv)}.",
    ]
    for shares in study.shares:
        known = [row for row in shares.rows if row.distinct]
        if known:
            words.append(f"Most of the {shares.of} comes from {known[0].path} ({_share(known[0].share)}).")
    return " ".join(words)


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _key_numbers(study: ScatterStudy) -> list[tuple[str, str]]:
    peak, width, interval = (study.figure(name) for name in ("peak", "width", "interval"))
    limit = peak.within.limit
    return [
        ("peak of the typical blow, mean of the runs", with_unit(peak.typical.mean, "m/s^2", "g")),
        ("CV of that peak from run to run", _share(peak.typical.cv)),
        ("CV of the peaks within a run, median", _share(peak.within.median)),
        ("CV of the peaks in 95 % of all runs at most", "no limit" if math.isinf(limit) else _share(limit)),
        ("width of the typical blow, mean of the runs", with_unit(width.typical.mean, "s", "us")),
        ("interval, mean of the runs", with_unit(interval.mean.mean, "s", "ms")),
    ]


def _share(value: float | None) -> str:
    """Write a share in per cent; a dash where there is none."""
    return NONE if value is None or not math.isfinite(value) else f"{written(100.0 * value, FEWEST_DIGITS)} %"


def _bare(value: float | None) -> str:
    """Write a share in per cent for a column that has the sign in its head."""
    return "none" if value == math.inf else _share(value).removesuffix(" %")


def _between(low: str, high: str) -> str:
    return NONE if NONE in (low, high) else f"{low} to {high}"


def _caption(study: ScatterStudy) -> str:
    return (
        "Above, the rigid-body peak of each blow: median and the band that holds 95 % of the runs, beside the dynamics "
        f"alone.{' Below, the share of each tolerance with its bounds at 95 %.' if study.shares else ''}"
    )


def _figure_section(study: ScatterStudy) -> Section:
    """List means and scatter between runs, scatter within a run, and the kinds of blows."""
    between: list[list[Cell]] = []
    within: list[list[Cell]] = []
    for name, (called, si, usual) in FIGURES.items():
        figure = study.figure(name)
        mean, low, high, typical = (
            written(shown(value, si, usual), 5)
            for value in (figure.mean.mean, figure.mean.low, figure.mean.high, figure.typical.mean)
        )
        cv = [_bare(value) for value in (figure.mean.cv, figure.mean.cv_low, figure.mean.cv_high)]
        between.append([headed(called, si, usual), mean, _between(low, high), typical, cv[0], _between(*cv[1:])])
        for blows, later, spread in (("all", False, figure.within), ("later", True, figure.later)):
            cells = [_bare(value) for value in (study.nominal_run.variation(name, later), *spread[:4])]
            within.append([called, blows, *cells[:2], _between(cells[2], cells[3]), cells[4]])
    kinds: list[list[Cell]] = [[Tag(kind, kind), *counts] for kind, counts in study.kinds().items()]
    heads = ["figure", "mean", "mean, 95 % bounds", "typical blow", "CV (%)", "CV, 95 % bounds (%)"]
    inner = ["figure", "blows", "dynamics alone", "median of the runs", "95 % bounds", "95 % of runs below"]
    text = f"Bounds: {STATEMENTS['mean']}. Within a run: {STATEMENTS['cv_within']}."
    tables = [
        Table("Means of the runs, and their scatter from run to run", heads, between),
        Table("Scatter within a run: CV (%); later is without the first blow", inner, within),
        Table("Blows that are not full", ["kind", "blows", "runs"], kinds),
    ]
    return Section("Scatter", text, tables)


def _share_section(study: ScatterStudy) -> Section:
    """List the share of each tolerance in what scatters."""
    how = "Sobol indices" if study.plan.shares == "sobol" else "each tolerance alone, all other inputs nominal"
    tables = [_share_table(study, shares) for shares in study.shares]
    sums = [
        f"{shares.of}: {_share(shares.sum)} ({_between(_share(shares.sum_low), _share(shares.sum_high))})"
        for shares in study.shares
    ]
    return Section("Shares", f"By {how}. The shares add up to: {'; '.join(sums)}.", tables)


def _share_table(study: ScatterStudy, shares: Shares) -> Table:
    sobol = study.plan.shares == "sobol"
    heads = ["tolerance", "share (%)", "95 % bounds (%)", *(["total (%)", "95 % bounds (%)"] if sobol else []), ""]
    rows: list[list[Cell]] = []
    for row in shares.rows:
        cells: list[Cell] = [row.path, _bare(row.share), _between(_bare(row.low), _bare(row.high))]
        cells += [_bare(row.total), _between(_bare(row.total_low), _bare(row.total_high))] if sobol else []
        rows.append([*cells, "" if row.distinct else "not significant (95 %)"])
    return Table(f"Shares in the {shares.of}; {shares.runs} runs each", heads, rows)


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
