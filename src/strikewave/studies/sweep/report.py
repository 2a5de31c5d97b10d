"""The report of a sweep: its picture, the range of each number, main effects, and what was varied."""

from __future__ import annotations

from strikewave.base.result import RUN_BROKEN, RUN_FAILED
from strikewave.reporting import chapters
from strikewave.reporting.faces import face_table
from strikewave.reporting.numbers import percent
from strikewave.reporting.parts import Cell, Link, Part, Picture, Section, Table
from strikewave.studies.engine.plan import GRID, HYPERCUBE, SOBOL, TOLERANCES
from strikewave.studies.sweep.figures import MOST_NUMBERS, MOST_SETTINGS, sweep_picture
from strikewave.studies.sweep.study import SweepStudy

CHOSEN = {
    GRID: "all values of each setting with all of the others",
    HYPERCUBE: "one in each n-th of the range of every setting (Latin hypercube)",
    SOBOL: "Sobol's sequence, scrambled",
    TOLERANCES: "drawn within the tolerances of the case",
}
"""How rows are chosen, in words, by design."""
ANALYSES = {
    "run": "a full run of the machine",
    "fast": "the fast run of the machine, its object as whole bodies",
    "wave": "the layered bar under its load",
    "fem": "explicit finite elements",
    "impact": "one impact on a free rigid object, by the contact law alone",
}
"""What each run is."""
MOST_REASONS = 12
"""Reasons of failures that a table lists."""


def sweep_report(study: SweepStudy) -> str:
    """Return the report of a sweep as one HTML page: no script, nothing fetched, the same bytes each time."""
    sections = [
        Section("Picture", "", [Picture(sweep_picture(study), _caption(study), _caption(study))]),
        _number_section(study),
        *([_effect_section(study)] if study.effects else []),
        chapters.warnings(study.notices),
        _plan_section(study),
        chapters.inputs(study.case),
    ]
    summary = chapters.Summary("Report of a sweep", sweep_words(study), study.highlights())
    return chapters.result_page(study, summary, sections)


def sweep_words(study: SweepStudy) -> str:
    """Say in words what came out."""
    plan = study.plan
    words = [f"{plan.words}{f'; {study.verdicts.words}' if study.verdicts.words else ''}."]
    first, one = plan.kept[0], study.ranges[0]
    if one.smallest is None or one.largest is None:
        words.append(f"No run has a {one.name}.")
    else:
        low, high = (first.words(end) for end in (one.smallest, one.largest))
        words.append(f"{one.name.capitalize()}: {low} ({one.smallest_at}) to {high} ({one.largest_at}).")
    effect = next((effect for effect in study.largest_effects if effect.kept == first), None)
    if effect is not None and effect.stands_out:
        words.append(f"Of its variance, {percent(effect.share, 0)} comes from {effect.setting} alone.")
    return " ".join(words)


def _caption(study: SweepStudy) -> str:
    count = len(study.plan.variables)
    more = f" The first {MOST_NUMBERS} numbers are drawn." if len(study.plan.kept) > MOST_NUMBERS else ""
    marked = {RUN_BROKEN: "diamonds", RUN_FAILED: "crosses"}
    meaning = {RUN_BROKEN: "failed a check", RUN_FAILED: "failed"}
    failed = "".join(
        f" Red {marks} are runs that {meaning[status]}."
        for status, marks in marked.items()
        if study.verdicts.count(status)
    )
    if count == 1:
        return f"Each number over {study.plan.variables[0].path}, a dot a run.{failed}{more}"
    if count == 2:
        over = " and ".join(variable.path for variable in study.plan.variables)
        return f"Each number in colour over {over}.{failed}{more}"
    most = f" The {MOST_SETTINGS} settings with the largest shares are drawn." if count > MOST_SETTINGS else ""
    return (
        "Above, a line a run through its settings, in the colour of the first number. Below, each run as a dot over "
        f"each setting, and the means over it, its main effect.{most}{failed}{more}"
    )


def _number_section(study: SweepStudy) -> Section:
    parts: list[Part] = [face_table(study, "ranges")]
    if study.run_rows()[1]:
        parts.append(Table("All runs", *study.run_rows()))
    parts.append(Link("runs.csv", "All runs, runs.csv"))
    parts.append(Link("runs.parquet", "The same as Parquet, runs.parquet"))
    return Section("Numbers", "", parts)


def _effect_section(study: SweepStudy) -> Section:
    text = (
        "The share is that of the variance of the means over a setting in the variance of all runs (the correlation "
        "ratio). What is left comes from settings together"
        + (
            "."
            if study.plan.design == GRID
            else ", or from chance: in runs that are no grid, the share expected by chance is taken off, 0 stands "
            "for what then is below it, and the standard error is that of the jackknife over the runs. A share below "
            "the one by chance tells nothing: in 95 of 100 studies of settings that do nothing, none exceeds it."
        )
    )
    return Section("Main effects", text, [face_table(study, "largest_effects", caption="Main effects")])


def _plan_section(study: SweepStudy) -> Section:
    random = "" if study.plan.design == GRID else f", random seed {study.plan.seed}"
    text = f"Each run is {ANALYSES[study.plan.evaluation.analysis]}. Runs: {CHOSEN[study.plan.design]}{random}."
    tables: list[Part] = [face_table(study, "vary")]
    failures: list[list[Cell]] = [[reason, count] for reason, count in list(study.reasons.items())[:MOST_REASONS]]
    if failures:
        tables.append(Table("Runs that failed", ["why", "runs"], failures))
    return Section("What was varied", text, tables)
