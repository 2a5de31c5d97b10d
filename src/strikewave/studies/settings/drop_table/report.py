"""The report of designs of a drop table: the pulse in its band, the clauses, the ranking, what cannot and why."""

from __future__ import annotations

from strikewave.base.percents import percent
from strikewave.reporting import chapters
from strikewave.reporting.clause_words import clause_columns, verdict_words
from strikewave.reporting.columns import page_table
from strikewave.reporting.faces import face_table, text_of
from strikewave.reporting.parts import Cell, Picture, Section, Table, Tag
from strikewave.studies.settings.drop_table.candidate import WITHIN, DropCandidate
from strikewave.studies.settings.drop_table.figures import drop_figure
from strikewave.studies.settings.drop_table.study import DropStudy, drop_columns, goal_words
from strikewave.studies.settings.result import limit_columns

MOST_ROWS = 60
"""Designs in the tables: more would not be read; settings.json has all."""


def drop_report(study: DropStudy) -> str:
    """Return the report of designs as one HTML page."""
    caption = (
        "Left, what a sensor on the table reads in the full run of the first design, its zero taken in the fall, and "
        "what it is held against. Right, all designs: how fast their pulses rise (10 to 90 %) beside a half-sine, over "
        "the height; filled where they meet the specification."
    )
    first = study.candidates[0]
    sections = [
        Section("The pulse", "", [Picture(drop_figure(study), caption, caption)]),
        Section(
            "The first design",
            f"Provenance: {_provenances(first)}. All inputs stand below.",
            [
                Table("What was chosen", ["setting", "value", "provenance"], _chosen(first)),
                page_table("Clauses", clause_columns(first.verdict.clauses)),
                page_table("Limits", limit_columns(first.limits)),
            ],
        ),
        _ranking(study),
        *_without(study),
        chapters.warnings(study.notices),
        chapters.inputs(study.case_of()),
    ]
    status = Tag("goal missed", "bad") if study.broken else Tag(verdict_words("pass", study.by_indicative), "good")
    summary = chapters.Summary("Report of a design of a drop table", drop_words(study), study.highlights(), status)
    return chapters.result_page(study, summary, sections)


def _chosen(one: DropCandidate) -> list[list[Cell]]:
    return [[path, str(value.typed), value.provenance] for path, value in one.settings.items()]


def _provenances(one: DropCandidate) -> str:
    counts: dict[str, int] = {}
    for value in one.case.values().values():
        counts[value.provenance] = counts.get(value.provenance, 0) + 1
    return ", ".join(f"{count} {name}" for name, count in sorted(counts.items(), key=lambda pair: -pair[1]))


def _ranking(study: DropStudy) -> Section:
    """List the designs, best first."""
    text = (
        f"Peak and width of each come to the ideal pulse within {percent(WITHIN)} where both can. The margin is the "
        "least of all clauses over half their tolerance, the departure the root mean square of the difference to the "
        "ideal pulse over its peak. Of a pad the rate is its largest force over the compression "
        "there. The rebound is the coefficient of restitution in the full run: a programmer that gives back less takes "
        "more height for the same velocity change, four times as much without any rebound."
    )
    heights = face_table(study, "heights", caption="Height of a free fall for this velocity change")
    designs = page_table(f"Designs for {goal_words(study.goal)}", drop_columns(study.candidates[:MOST_ROWS]))
    return Section("Designs", text, [designs, heights])


def _without(study: DropStudy) -> list[Section]:
    """List what does not meet the goal, and why; nothing where there is none."""
    rows: list[list[Cell]] = [
        [f"{one.place}", one.programmer.name, one.obstacles] for one in study.candidates[:MOST_ROWS] if not one.meets
    ]
    rows += [["", "no result", why] for why in study.failed]
    if not rows:
        return []
    return [Section("What does not meet it", "", [Table("Designs that do not", ["#", "programmer", "why"], rows)])]


def drop_words(study: DropStudy) -> str:
    """Say in words what was found."""
    first, met = study.candidates[0], sum(one.meets for one in study.candidates)
    values = first.case.values()
    settings = ", ".join(f"{path} = {values[path].typed}" for path in first.chosen)
    words = [
        f"{met or 'None'} of {len(study.candidates)} designs that were run in full {'gives' if met == 1 else 'give'} "
        f"{goal_words(study.goal)}.",
        f"{'The first' if met else 'The nearest'}, {first.programmer.name}: {settings}; "
        f"{verdict_words(first.verdict.verdict, study.by_indicative)}.",
    ]
    if first.lossless:
        highest = text_of(study.heights[-1], "height")
        words.append(f"Its height counts on a full rebound: without any it is {highest}.")
    if not met:
        words.append(f"It misses the goal: {first.obstacles}.")
    words += [study.verdicts.sentence] if study.verdicts.words else []
    return " ".join(words)


picture = drop_figure
page = drop_report
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`; so does `picture`."""
