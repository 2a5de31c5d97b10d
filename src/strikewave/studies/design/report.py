"""The report of a design: its picture, ranked settings, goals, sensitivities, or which goals exclude each other."""

from __future__ import annotations

from strikewave.reporting import chapters
from strikewave.reporting.faces import face_table
from strikewave.reporting.parts import Cell, Link, Part, Picture, Section, Table
from strikewave.reporting.shown_result import shown_table
from strikewave.studies.design.figures import design_picture
from strikewave.studies.design.study import DesignStudy, all_broken_words, conflict_words
from strikewave.studies.engine.case_evaluation import ANALYSES

MOST_FRONT = 20
"""Runs of a front that a table lists, evenly spread over it."""


def design_report(study: DesignStudy) -> str:
    """Return the report of a design as one HTML page: no script, nothing fetched, the same bytes each time."""
    caption = (
        "Each dot is a run: over two of the numbers, with the area in which their goals are met, and over two of the "
        "settings. Diamonds are the ranked settings with their places. Red marks are runs that failed a check, "
        "or failed."
    )
    sections = [
        Section("Picture", "", [Picture(design_picture(study), caption, caption)]),
        *([_conflict_section(study)] if study.conflict is not None else []),
        _ranked_section(study),
        *([_front_section(study)] if study.front else []),
        *([_sensitivity_section(study)] if study.sensitivities else []),
        *([_surrogate_section(study)] if study.surrogate else []),
        chapters.warnings(study.notices),
        _question_section(study),
        chapters.inputs(study.case_of()),
    ]
    summary = chapters.Summary("Report of a design", design_words(study), study.highlights())
    return chapters.result_page(study, summary, sections)


def design_words(study: DesignStudy) -> str:
    """Say in words what came out."""
    first = study.candidates[0]
    broken = f" {study.verdicts.sentence}" if study.verdicts.words else ""
    count = f"{len(study.rows)} runs, {study.met} of them meet all goals{_also_broken(study)}.{broken}"
    if study.conflict is not None:
        nearest = f"Nearest: {study.at(first.row)}.{broken}"
        return f"No setting was found that meets all goals: {conflict_words(study)}. {nearest}"
    checked = study.plan.verifying
    drawn = first.robustness
    robust = f" Of {drawn.drawn} draws within tolerances, {drawn.met} meet all goals." if drawn is not None else ""
    if first.breaks and not study.met:
        none = all_broken_words(study)
        held = "" if checked is None else f", its numbers are {'' if first.confirmed else 'not '}held by {checked[1]}"
        best = f"Of the settings that fail a check, {study.at(first.row)} ranks first ({first.verdict}){held}"
        return f"{none[0].upper()}{none[1:]}. {best}. {len(study.rows)} runs.{broken}{robust}"
    held = "" if checked is None else f", {'verified' if first.confirmed else 'not held'} by {checked[1]}"
    limits = f" (the run that verifies it is {first.verdict})" if first.breaks else ""
    return f"Best: {study.at(first.row)}{held}{limits}. {count}{robust}"


def _also_broken(study: DesignStudy) -> str:
    """Say how many runs besides meet the goals, but fail a check; nothing where none does."""
    more = study.met_broken
    words = "1 more meets them but fails a check" if more == 1 else f"{more} more meet them but fail a check"
    return f", {words}" if more else ""


def _conflict_section(study: DesignStudy) -> Section:
    text = (
        "Of these goals no one can be met together with all the others, and without any one of them the others can, as "
        "far as the searches found. The table says what each comes to at best while the others are met."
    )
    alone = "This goal cannot be reached by itself. The table says what it comes to at best."
    single = study.conflict is not None and len(study.conflict.goals) == 1
    return Section("Goals that exclude each other", alone if single else text, [face_table(study, "reaches")])


def _ranked_section(study: DesignStudy) -> Section:
    by = "the objective" if len(study.plan.objectives) == 1 else "the least of the margins"
    text = (
        f"Ranked by {by}. A margin is the distance of a number to its nearer limit, as a share of half the band, or of "
        "the limit where there is one. Ranked settings differ by at least a tenth of a range."
    )
    if study.plan.verifying is not None:
        text += f" Each was verified by {study.plan.verifying[1]}."
    if study.plan.robust:
        text += f" The most robust of {study.plan.robust} draws each comes first; shares with their interval of 95 %."
    parts: list[Part] = [Table("Ranked settings", *shown_table(study))]
    if study.plan.goals:
        parts.append(face_table(study, "goals_at_first"))
    parts.append(Link("runs.csv", "All runs, runs.csv"))
    return Section("Settings", text, parts)


def _front_section(study: DesignStudy) -> Section:
    names = [one.number for one in study.plan.objectives]
    places = sorted({round(k * (len(study.front) - 1) / (MOST_FRONT - 1)) for k in range(MOST_FRONT)})
    rows: list[list[Cell]] = [
        [study.at(study.rows[run]), *(study.value_words(name, study.value(run, name)) for name in names)]
        for run in (study.front[place] for place in places)
    ]
    text = (
        f"{len(study.front)} runs that meet all goals are Pareto-optimal among all runs: none is better in one "
        "objective without being worse in another. Its ends were searched for, and of two objectives points between."
    )
    return Section("Trade-off", text, [Table("Pareto-optimal runs", ["settings", *names], rows)])


def _sensitivity_section(study: DesignStudy) -> Section:
    text = (
        "By runs one hundredth of a range to either side of the first setting. The last columns say how far a setting "
        "alone may be moved till the first goal is missed, if the numbers go on as they do here."
    )
    return Section("Sensitivity", text, [face_table(study, "number_changes")])


def _surrogate_section(study: DesignStudy) -> Section:
    text = (
        "The runs were chosen by Gaussian processes of those before. The table says how well such a process knows each "
        "number: what it is off, root mean square, where all other runs foretell a run. Where that is as large as what "
        "a goal allows, more runs may find better settings. The ranked settings themselves are runs."
    )
    return Section("Surrogate", text, [face_table(study, "known_numbers", caption="Surrogate")])


def _question_section(study: DesignStudy) -> Section:
    plan = study.plan
    way = "Gaussian processes with expected improvement" if plan.by_surrogate else "Differential evolution"
    text = (
        f"Each run is {ANALYSES[plan.analysis]}. {way}, up to {plan.runs} runs a search, random seed "
        f"{plan.seed}. Goals: {'; '.join(aim.typed for aim in plan.aims)}."
    )
    return Section("What was asked", text, [face_table(study, "vary", "range")])


picture = design_picture
page = design_report
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`; so does `picture`."""
