"""The report of a search for settings: what was asked, what the best settings give, and what they cost."""

from __future__ import annotations

from strikewave.base.declare import declarations
from strikewave.reporting import chapters
from strikewave.reporting.clause_words import clause_columns
from strikewave.reporting.columns import Column, page_table
from strikewave.reporting.numbers import headed, percent, shown, spelled
from strikewave.reporting.parts import NONE, Cell, Picture, Section, Table, Tag, written
from strikewave.studies.settings.candidate import WITHIN, SettingsCandidate
from strikewave.studies.settings.figures import settings_figure
from strikewave.studies.settings.goal import goal_words
from strikewave.studies.settings.result import SettingsStudy, candidate_columns, limit_columns

MOST_ROWS = 40
"""Candidates in the table: more would not be read; settings.json has all."""


def settings_report(study: SettingsStudy) -> str:
    """Return the report of a search for settings as one HTML page: no script, nothing fetched, the same bytes."""
    caption = (
        "Left, how far the typical blow of each candidate misses the goal, by place, and its worst peak. Right, what "
        "the settings cost: scatter of the peaks over the largest force of the stop; filled where the goal is met."
    )
    sections = [
        Section("What the settings give", "", [Picture(settings_figure(study), caption, caption)]),
        _first_section(study),
        _ranking_section(study),
        chapters.warnings(study.notices),
        *_left_section(study),
        chapters.inputs(study.case_of()),
    ]
    status = Tag("goal missed", "bad") if study.broken else None
    summary = chapters.Summary(
        "Report of a search for machine settings", settings_words(study), study.highlights(), status
    )
    return chapters.result_page(study, summary, sections)


def settings_words(study: SettingsStudy) -> str:
    """Say in words what was found."""
    first, met = study.candidates[0], sum(one.meets for one in study.candidates)
    values = first.case.values()
    which = "None" if not met else str(met)
    settings = ", ".join(f"{path} = {values[path].typed}" for path in first.chosen)
    words = [
        f"{which} of {len(study.candidates)} settings that were run in full {'gives' if met == 1 else 'give'} "
        f"{spelled(goal_words(study.goal))}, each within {percent(WITHIN, 0)}, with all blows full and all limits "
        "kept.",
        f"{'The first' if met else 'The nearest'}: {settings}.",
    ]
    if not met:
        words.append(f"It misses the goal: {first.obstacles}.")
    words += [study.verdicts.sentence] if study.verdicts.words else []
    return " ".join(words)


def _share(value: float) -> str:
    return NONE if value != value else f"{written(100.0 * value, 3)} %"


def _first_section(study: SettingsStudy) -> Section:
    """Show what was chosen for the first candidate, its blows, and its limits."""
    first = study.candidates[0]
    values, observation = first.case.values(), first.observation
    chosen: list[list[Cell]] = [[path, str(values[path].typed)] for path in first.chosen]
    wanted = {name: getattr(study.goal, name) for name in ("peak", "width", "interval")}
    blows: list[list[Cell]] = []
    for name, asked in wanted.items():
        spread = getattr(observation, name)
        quantity = declarations(type(spread))["typical"].quantity
        numbers = (asked, spread.typical, spread.first, spread.worst)
        cells = [written(shown(value, *quantity.units)) for value in numbers]
        blows.append([headed(quantity.label, *quantity.units), *cells, _share(spread.variation).removesuffix(" %")])
    return Section(
        "The first candidate",
        "Typical is the median of the later full blows; worst is the blow farthest from the goal.",
        [
            Table("What was chosen", ["setting", "value"], chosen),
            Table("Blows", ["", "wanted", "typical", "first", "worst", "CV (%)"], blows),
            page_table("Limits", limit_columns(first.limits)),
            *_clauses(first),
        ],
    )


def _clauses(first: SettingsCandidate) -> list[Table]:
    """Return the clauses of the specification, each by the blow that it judges worst; nothing without one."""
    if not first.clauses:
        return []
    blow = Column("blow", [str(clause.blow) for clause in first.clauses])
    return [page_table("Clauses of the specification", [*clause_columns(first.clauses), blow])]


def _ranking_section(study: SettingsStudy) -> Section:
    """List the first of the ranking, and what the mass of a striker costs."""
    rows = study.candidates[:MOST_ROWS]
    more = len(study.candidates) - len(rows)
    text = (
        "Peak, width and interval are those of the typical blow; stop is the largest force on it; sensitivity is the "
        f"change of the peak with engagement.{f' settings.json has {more} more.' if more else ''}"
    )
    caption = f"Candidates, best first, for {spelled(goal_words(study.goal))}"
    tables = [page_table(caption, candidate_columns(study.choice.vary, rows))]
    if len(study.masses) > 1:
        caption = "What the mass of a striker costs, all else as the first"
        tables.append(page_table(caption, candidate_columns(study.choice.vary, study.masses, "mass")))
    return Section("Candidates", text, tables)


def _left_section(study: SettingsStudy) -> list[Section]:
    """List what was not run, or gave no result; nothing where there is none."""
    rows: list[list[Cell]] = [[f"{count} strikers", why] for count, why in study.left_out.items()]
    rows += [["no result", why] for why in study.failed]
    return [Section("Left out", "", [Table("Not run, or without a result", ["what", "why"], rows)])] if rows else []


picture = settings_figure
page = settings_report
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`; so does `picture`."""
