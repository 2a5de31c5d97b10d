"""A design as a command, page and picture: ranked settings, goals, sensitivities, goals that exclude each other."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave.reporting import chapters
from strikewave.reporting.faces import face_table
from strikewave.reporting.output_options import Output
from strikewave.reporting.parts import Cell, Link, Part, Section, Table
from strikewave.reporting.shown_result import shown_table
from strikewave.reporting.style import BLUE, GREY, ORANGE, RED, legend_below, mark_runs, quiet, sheet_title
from strikewave.reporting.terminal import print_face, report_table, say
from strikewave.studies.axes import plain_log_ticks
from strikewave.studies.command import Report, StudyCommand, lasting, print_estimate
from strikewave.studies.engine.case_evaluation import ANALYSES
from strikewave.studies.engine.runner import StudyProgress
from strikewave.studies.engine.store import RunStore
from strikewave.studies.search.design import DesignStudy, all_broken_words, conflict_words, make_design
from strikewave.studies.search.plan import DesignPlan
from strikewave.studies.study import picture_section

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

MOST_FRONT = 20  # runs of a front that a table lists, evenly spread over it: a page of them
TIMED = 3  # runs that are timed for an estimate, after one that loads what a process needs: both ends and the middle
WIDTH, HEIGHT, BAR = 9.0, 3.9, 0.3
"""Width of the picture, height of its upper row, and height of a bar of a margin, inches."""
MOST_BARS = 8  # goals whose margins are drawn: the first ones
DRAWN = (1.0, 99.0)
"""Percentiles of the runs that axes reach, widened to all limits and ranked settings: early runs lie far off."""
AREA = {"color": BLUE, "alpha": 0.12, "linewidth": 0.0, "zorder": 0}  # look of the area in which a goal is met


def design_words(study: DesignStudy) -> str:
    """Return the sentences on the outcome."""
    first, more = study.candidates[0], study.met_broken
    broken = f" {study.verdicts.sentence}" if study.verdicts.words else ""
    also = f", {more} more meet them but fail a check" if more else ""
    also = ", 1 more meets them but fails a check" if more == 1 else also
    count = f"{len(study.rows)} runs, {study.met} of them meet all goals{also}.{broken}"
    if study.conflict is not None:
        nearest = f"Nearest: {study.plan.at(first.row)}.{broken}"
        return f"No setting was found that meets all goals: {conflict_words(study)}. {nearest}"
    checked = study.plan.verifying
    drawn = first.robustness
    robust = f" Of {drawn.drawn} draws within tolerances, {drawn.met} meet all goals." if drawn is not None else ""
    if first.breaks and not study.met:
        none = all_broken_words(study)
        held = "" if checked is None else f", its numbers are {'' if first.confirmed else 'not '}held by {checked[1]}"
        best = f"Of the settings that fail a check, {study.plan.at(first.row)} ranks first ({first.verdict}){held}"
        return f"{none[0].upper()}{none[1:]}. {best}. {len(study.rows)} runs.{broken}{robust}"
    held = "" if checked is None else f", {'verified' if first.confirmed else 'not held'} by {checked[1]}"
    limits = f" (the run that verifies it is {first.verdict})" if first.breaks else ""
    return f"Best: {study.plan.at(first.row)}{held}{limits}. {count}{robust}"


def page(study: DesignStudy) -> str:
    """Return the report of a design as one HTML page: no script, nothing fetched, the same bytes each time."""
    plan, conflict = study.plan, study.conflict
    caption = (
        "Each dot is a run: over two of the numbers, with the area in which their goals are met, and over two of the "
        "settings. Diamonds are the ranked settings with their places. Red marks are runs that failed a check, "
        "or failed."
    )
    sections = [picture_section("Picture", picture(study), caption)]
    if conflict is not None:
        text = (
            "Of these goals no one can be met together with all the others, and without any one of them the others "
            "can, as far as the searches found. The table says what each comes to at best while the others are met."
        )
        if len(conflict.goals) == 1:
            text = "This goal cannot be reached by itself. The table says what it comes to at best."
        sections.append(Section("Goals that exclude each other", text, [face_table(study, "reaches")]))

    by = "the objective" if len(plan.objectives) == 1 else "the least of the margins"
    text = (
        f"Ranked by {by}. A margin is the distance of a number to its nearer limit, as a share of half the band, or of "
        "the limit where there is one. Ranked settings differ by at least a tenth of a range."
    )
    text += f" Each was verified by {plan.verifying[1]}." if plan.verifying is not None else ""
    if plan.robust:
        text += f" The most robust of {plan.robust} draws each comes first; shares with their interval of 95 %."
    goals = [face_table(study, "goals_at_first")] if plan.goals else []
    parts: list[Part] = [Table("Ranked settings", *shown_table(study)), *goals, Link("runs.csv", "All runs, runs.csv")]
    sections.append(Section("Settings", text, parts))

    if study.front:
        names = [objective.number for objective in plan.objectives]
        places = sorted({round(k * (len(study.front) - 1) / (MOST_FRONT - 1)) for k in range(MOST_FRONT)})
        rows: list[list[Cell]] = [
            [plan.at(study.rows[run]), *(study.value_words(name, study.value(run, name)) for name in names)]
            for run in (study.front[place] for place in places)
        ]
        text = (
            f"{len(study.front)} runs that meet all goals are Pareto-optimal among all runs: none is better in one "
            "objective without being worse in another. Its ends were searched for, and of two objectives points "
            "between."
        )
        sections.append(Section("Trade-off", text, [Table("Pareto-optimal runs", ["settings", *names], rows)]))
    if study.sensitivities:
        text = (
            "By runs one hundredth of a range to either side of the first setting. The last columns say how far a "
            "setting alone may be moved till the first goal is missed, if the numbers go on as they do here."
        )
        sections.append(Section("Sensitivity", text, [face_table(study, "number_changes")]))
    if study.surrogate:
        text = (
            "The runs were chosen by Gaussian processes of those before. The table says how well such a process knows "
            "each number: what it is off, root mean square, where all other runs foretell a run. Where that is as "
            "large as what a goal allows, more runs may find better settings. The ranked settings themselves are runs."
        )
        sections.append(Section("Surrogate", text, [face_table(study, "surrogate", caption="Surrogate")]))
    way = "Gaussian processes with expected improvement" if plan.by_surrogate else "Differential evolution"
    text = (
        f"Each run is {ANALYSES[plan.analysis]}. {way}, up to {plan.runs} runs a search, random seed "
        f"{plan.seed}. Goals: {'; '.join(aim.typed for aim in plan.aims)}."
    )
    asked = Section("What was asked", text, [face_table(study, "vary", "range")])
    sections += [chapters.warnings(study.notices), asked, chapters.inputs(study.case_of())]
    summary = chapters.Summary("Report of a design", design_words(study), study.highlights())
    return chapters.result_page(study, summary, sections)


def picture(study: DesignStudy) -> Figure:
    """Draw the runs over the numbers of two goals, over two settings, and the margins of the ranked settings."""
    from matplotlib.figure import Figure

    bars = min(sum(not goal.is_check for goal in study.plan.goals), MOST_BARS)
    lower = 0.9 + BAR * max(bars, 1) * 1.6
    figure = Figure(figsize=(WIDTH, HEIGHT + (lower if bars else 0.0)), layout="constrained")
    sheet_title(figure, f"{study.case.name or 'case'}: {len(study.rows)} runs, {study.met} meet all goals")
    grid = figure.add_gridspec(2 if bars else 1, 2, height_ratios=[HEIGHT, lower] if bars else None)
    _numbers(figure.add_subplot(grid[0, 0]), study)
    _settings(figure.add_subplot(grid[0, 1]), study)
    if bars:
        _margins(figure.add_subplot(grid[1, :]), study, bars)
    return legend_below(figure)


def drawn_numbers(study: DesignStudy) -> list[str]:
    """Return the two numbers that runs are drawn over: those of goals that exclude each other, or the first two."""
    first = [reach.goal.number for reach in study.conflict.reaches] if study.conflict is not None else []
    names = [
        *first,
        *(objective.number for objective in study.plan.objectives),
        *(goal.number for goal in study.plan.goals),
    ]
    return list(dict.fromkeys(names))[:2]


def _numbers(axes: Any, study: DesignStudy) -> None:
    """Draw runs over two numbers, or one number over their order, with the area in which the goals are met."""
    names = drawn_numbers(study)
    kept = [study.kept(name) for name in names]
    columns = [study.numbers[:, study.plan.evaluation.names.index(name)] / study.kept(name).scale for name in names]
    order = np.arange(1.0, len(study.rows) + 1.0)
    x, y = columns if len(columns) == 2 else (order, columns[0])
    _dots(axes, study, x, y, legend=True)
    labels = [one.label for one in kept] if len(kept) == 2 else ["run", kept[0].label]
    quiet(axes, "Runs by their numbers", *labels)
    of_axes = list(zip(names, (axes.axvspan, axes.axhspan), (x, y), "xy", strict=False))
    for name, span, values, which in of_axes if len(names) == 2 else [(names[0], axes.axhspan, y, "y")]:
        goal = study.plan.goal_of(name)
        low, high = _extent(study, values, name)
        if goal is not None and low < high:
            span(max(goal.low / study.kept(name).scale, low), min(goal.high / study.kept(name).scale, high), **AREA)
        if low < high:
            (axes.set_xlim if which == "x" else axes.set_ylim)(low, high)


def _extent(study: DesignStudy, values: Array, name: str) -> tuple[float, float]:
    """Return the ends of an axis; see `DRAWN`."""
    known = values[np.isfinite(values)]
    if not known.size:
        return 0.0, 0.0
    ends = list(np.percentile(known, DRAWN)) + [float(values[candidate.run]) for candidate in study.candidates]
    goal = study.plan.goal_of(name)
    if goal is not None:
        ends += [limit / study.kept(name).scale for limit in (goal.low, goal.high) if math.isfinite(limit)]
    ends = [end for end in ends if math.isfinite(end)]
    room = 0.05 * (max(ends) - min(ends))
    return min(ends) - room, max(ends) + room


def _settings(axes: Any, study: DesignStudy) -> None:
    """Draw runs over the first two settings, or the only one over their order."""
    variables = study.plan.variables[:2]
    columns = [
        study.settings[:, k] if variable.words else np.asarray(variable.axis.shown(study.settings[:, k]))
        for k, variable in enumerate(variables)
    ]
    order = np.arange(1.0, len(study.rows) + 1.0)
    x, y = columns if len(columns) == 2 else (order, columns[0])
    _dots(axes, study, x, y)
    labels = [one.label for one in variables] if len(variables) == 2 else ["run", variables[0].label]
    quiet(axes, "Runs by their settings", *labels)
    pairs = zip(variables, "xy" if len(variables) == 2 else "y", strict=True)
    for one, which in pairs:
        axis = axes.xaxis if which == "x" else axes.yaxis
        if one.words:
            axis.set_ticks(range(len(one.words)), list(one.words), fontsize=8)
        elif one.axis.log:
            (axes.set_xscale if which == "x" else axes.set_yscale)("log")
            plain_log_ticks(axis)


def _dots(axes: Any, study: DesignStudy, x: Array, y: Array, legend: bool = False) -> None:
    """Draw runs that miss a goal, meet all, or are Pareto-optimal, and the ranked ones with their places."""

    def label(words: str) -> str:
        return words if legend else "_"

    met = study.margins >= 0.0
    dots = [axes.plot(x[~met], y[~met], ".", color=GREY, markersize=4, alpha=0.5, label=label("a goal is missed"))[0]]
    if met.any():
        dots += axes.plot(x[met], y[met], ".", color=BLUE, markersize=5, alpha=0.7, label=label("all goals met"))
    for dot in dots:
        dot.set_rasterized(True)
    mark_runs(axes, x, y, study.verdicts, size=5.0)
    if study.front:
        places = list(study.front)
        axes.plot(x[places], y[places], "o", color=RED, markersize=4, fillstyle="none", label=label("Pareto-optimal"))
    runs = [candidate.run for candidate in study.candidates]
    axes.plot(x[runs], y[runs], "D", color=ORANGE, markersize=6, label=label("ranked"), zorder=4)
    for place, run in enumerate(runs, 1):
        if math.isfinite(x[run]) and math.isfinite(y[run]):
            axes.annotate(str(place), (x[run], y[run]), (5, 4), textcoords="offset points", fontsize=8, zorder=5)


def _margins(axes: Any, study: DesignStudy, count: int) -> None:
    """Draw the margin of each goal at the first setting as a bar, those of the others as dots."""
    first = study.candidates[0]
    goals = study.plan.goals[:count]
    places = np.arange(count, dtype=float)[::-1]
    shares = 100.0 * first.shares[:count]
    colours = [BLUE if share >= 0.0 else RED for share in shares]
    axes.barh(places, np.nan_to_num(shares), height=0.5, color=colours, alpha=0.75)
    for candidate in study.candidates[1:]:
        axes.plot(100.0 * candidate.shares[:count], places, "D", color=ORANGE, markersize=3.5, alpha=0.8)
    if first.verified is not None:
        axes.plot(100.0 * first.verified[:count], places, "|", color="black", markersize=14)
    axes.set_yticks(places, [goal.typed for goal in goals], fontsize=8)
    axes.axvline(0.0, color="black", linewidth=0.8)
    quiet(axes, "Margins: bar, the first setting; line, its verification; dots, the others", "margin (%)", "")


def show_estimate(plan: DesignPlan, workers: int, output: Output) -> int:
    """Print the goals of a design and the time that it takes by some runs, and return the exit code."""
    places = [[low + share * (high - low) for low, high in plan.bounds] for share in np.linspace(0.0, 1.0, TIMED)]
    rows = [plan.row_at(place) for place in places]
    plan.job(rows[:1])  # it loads all that a process needs, and is not timed
    each = float(np.mean([outcome.seconds for outcome in plan.job(rows)]))
    # where goals exclude each other two searches a goal follow; objectives take their ends and one between
    later = max(2 * len(plan.goals), 2 * len(plan.objectives) + 1 if plan.objectives else 0)
    seconds, at_most = each * plan.runs / workers, plan.runs + later * plan.later_runs
    processes = f"{workers} processes" if workers > 1 else "one process"
    words = (
        f"{plan.words}. Up to {plan.runs} runs of a search: about {lasting(seconds)}, {each:.2g} s each on "
        f"{processes}; with further searches where nothing meets all goals or objectives compete, up to {at_most} runs."
    )
    estimate = {"runs": plan.runs, "at_most": at_most, "run_seconds": each, "seconds": seconds}
    return print_estimate(estimate, words, output)


@dataclass
class DesignCommand(StudyCommand[DesignStudy]):
    """A design as a command."""

    name: ClassVar[str] = "design"
    bar: ClassVar[str] = "design"
    clocks: ClassVar[tuple[str, ...]] = ("elapsed",)

    plan: DesignPlan

    @property
    def marked_text(self) -> str:
        """The question alone: only the design knows the case."""
        return self.plan.asked_line

    def announced(self, store: RunStore) -> float:
        """Print the goals."""
        say(self.plan.words)
        return 0.0

    def finished(self, store: RunStore) -> str:
        """Return the finished part of it in a store, in words."""
        return super().finished(store) or ("" if store.empty else "states of runs")

    def made(self, store: RunStore, report: Report) -> DesignStudy:
        """Return the design."""

        def advance(now: StudyProgress) -> None:
            report(now.share, f"{now.done} runs, {now.words}")

        return make_design(self.plan, store, self.pool, advance)

    def summary(self, result: DesignStudy) -> str:
        """Return the sentences on the outcome."""
        return design_words(result)

    def show(self, result: DesignStudy) -> None:
        """Print ranked settings, goals, sensitivities, and goals that exclude each other."""
        heads, rows = shown_table(result)
        objectives = [result.kept(objective.number).label for objective in result.plan.objectives]
        numbers = [result.kept(name).label for name in result.plan.evaluation.names]
        more = [*heads[3 : len(result.plan.variables) + 1], *(set(numbers) - set(objectives)), "of goal"]
        print_face(result, "reaches", "Goals that exclude each other")
        report_table(Table("Ranked settings", heads, rows), 3, more)
        print_face(result, "goals_at_first", "Goals at the first setting")
        print_face(result, "surrogate", "Surrogate")
        print_face(result, "number_changes", "Sensitivities at the first setting")
