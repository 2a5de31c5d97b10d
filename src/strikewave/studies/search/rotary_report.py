"""A search for settings as a command, page and picture: what the best ones give, what they cost, and what cannot."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

import numpy as np

from strikewave.analyses.clauses import clause_columns
from strikewave.base.declare import declarations
from strikewave.base.result import Verdicts
from strikewave.base.shock_quantities import FORCE
from strikewave.base.texts import percent
from strikewave.reporting import chapters
from strikewave.reporting.columns import Column, page_table
from strikewave.reporting.faces import text_of
from strikewave.reporting.numbers import axis_unit, headed, shown
from strikewave.reporting.parts import NONE, Cell, Section, Table, Tag, written
from strikewave.reporting.style import BLUE, GREEN, GREY, ORANGE, RED, mark_runs, quiet, sheet_title
from strikewave.reporting.terminal import print_rows, tell
from strikewave.studies.axes import plain_log_ticks
from strikewave.studies.command import Report, StudyCommand
from strikewave.studies.engine.runner import share_reporter
from strikewave.studies.engine.store import RunStore
from strikewave.studies.search.machine import MachineCandidate, MachineSearch, asked_line, limit_columns
from strikewave.studies.search.rotary import SettingsStudy, design_settings
from strikewave.studies.search.rotary_candidate import WITHIN, SettingsCandidate
from strikewave.studies.study import picture_section

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Candidate = TypeVar("Candidate", bound=MachineCandidate)
Places = tuple[list[float], list[float]]

MOST_SHOWN = 6
"""First of the ranking on the screen; the first of each other number of strikers follows."""
MOST_REASONS = 6
"""Reasons that are printed; the report has more."""
MOST_ROWS = 40
"""Candidates in the table: more would not be read; settings.json has all."""
SIZE = (10.0, 4.6)
MOST_DRAWN = 30
"""First of the ranking whose misses are drawn: more marks would run into one another."""
LINEAR = 1.0
"""Misses up to this, in %, stand on a linear scale: those of a search that came to its end are below."""
LEAST = 0.01
"""Scatter below this, in %, is drawn there: 0 has no place on a logarithmic axis."""
QUANTITIES = (("peak", BLUE, "o"), ("width", ORANGE, "s"), ("interval", GREEN, "^"))
MARKERS = (("o", BLUE), ("s", ORANGE), ("^", GREEN), ("D", RED), ("v", "#CC79A7"), ("P", "#56B4E9"), ("X", GREY))


@dataclass
class SearchCommand(StudyCommand[MachineSearch]):
    """A search for settings that meet a goal, as a command; its plan is the goal, and what may be chosen.

    Attributes
    ----------
    usual : bool
        True if nothing but the goal was asked: only then the folder has its name alone.
    """

    name: ClassVar[str] = "settings"
    bar: ClassVar[str] = "settings"
    clocks: ClassVar[tuple[str, ...]] = ("elapsed",)
    noun: ClassVar[str] = "searches"
    design: ClassVar[Callable[..., MachineSearch]] = staticmethod(design_settings)
    """Function that searches: `design_settings` or `design_drop_table`."""

    plan: tuple[Any, Any]
    usual: bool = True

    @property
    def marked_text(self) -> str:
        """What is asked: only the search knows the case."""
        return asked_line(self.case, *self.plan)

    def usual_folder(self, changes: Sequence[str]) -> str:
        """Return the folder of the result where none is asked for: the name of the goal, and a mark of what else."""
        name = str(self.plan[0].name)
        return name if self.usual else f"{name}-{self.marked_text[-10:-2]}"

    def made(self, store: RunStore, report: Report) -> MachineSearch:
        """Return the ranked settings."""
        return self.design(self.case, *self.plan, store, self.pool, share_reporter(report))

    def summary(self, result: MachineSearch) -> str:
        """Say which settings are first, and what they give."""
        return result.words

    def show(self, result: Any) -> None:
        """Print the ranking, what the first is judged by, and what gave no result."""
        first = result.candidates[0]
        shown = leading(result.candidates, MOST_SHOWN, lambda one: one.strikers)
        print_rows(f"{result.met_count} settings give {result.goal.words}", result.candidate_columns(shown))
        tell(
            "peak, width, interval: of the typical blow, the median of the later full ones; CV: scatter of all peaks; "
            "sensitivity: change of the peak with engagement"
        )
        guess, seen = first.estimate, first.observation
        tell(
            f"{result.goal.words}, from {result.case.name}: a half-sine changes the velocity by "
            f"{text_of(guess, 'velocity_change')}, for which a first estimate asks an approach of "
            f"{text_of(guess, 'approach')}; the full run has {text_of(seen, 'velocity_change')} and "
            f"{text_of(seen, 'approach')}"
        )
        print_rows("Limits of the first", limit_columns(first.limits))
        if first.clauses:
            print_rows("Clauses of the first, each by its worst blow", clause_columns(first.clauses))
        if len(result.masses) > 1:
            print_rows("What the mass of a striker costs", result.candidate_columns(result.masses, "mass"))
        for one in result.left_out:
            tell(f"left out, {one.strikers} strikers: {one.why}")
        self.show_failed(result)

    def show_failed(self, result: MachineSearch) -> None:
        """Print why designs gave no result."""
        for why in result.failed[:MOST_REASONS]:
            tell(f"no result, {why}")


def leading(candidates: Sequence[Candidate], most: int, kind: Callable[[Candidate], object]) -> list[Candidate]:
    """Return the first of the ranking, and the first of each other kind."""
    first = list({kind(one): one for one in reversed(candidates)}.values())
    return [candidate for k, candidate in enumerate(candidates) if k < most or candidate in first]


def picture(study: SettingsStudy) -> Figure:
    """Draw misses of the typical blow by place, and scatter of the peaks against the force of the stop."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, layout="constrained")
    left, right = figure.subplots(1, 2)
    _misses(left, study.candidates[:MOST_DRAWN])
    _scatter(right, study.candidates)
    sheet_title(figure, textwrap.shorten(f"Settings {'' if study.broken else 'for '}{study.title}", 90))
    return figure


def draw_kinds(
    axes: Any, kinds: Mapping[str, Sequence[Candidate]], places: Callable[[Sequence[Candidate]], Places], size: float
) -> None:
    """Draw the candidates of each kind with a marker of its own, filled where they meet the goal."""
    for k, (label, mine) in enumerate(kinds.items()):
        marker, colour = MARKERS[k % len(MARKERS)]
        for met, fill in ((True, colour), (False, "none")):
            points = [one for one in mine if one.meets == met]
            if points:
                axes.plot(*places(points), marker, color=colour, markerfacecolor=fill, markersize=size)
        axes.plot([], [], marker, color=colour, markersize=size, label=label)


def mark_candidates(axes: Any, candidates: Sequence[MachineCandidate], places: Places) -> None:
    """Mark candidates whose runs failed a check."""
    mark_runs(axes, *places, Verdicts(candidate.run_verdict for candidate in candidates))


def _misses(axes: Any, candidates: Sequence[SettingsCandidate]) -> None:
    """Draw typical peak, width and interval over the goal, and the worst peak, of each candidate."""
    places = list(range(1, len(candidates) + 1))
    axes.axhspan(-100.0 * WITHIN, 100.0 * WITHIN, color="#EEEEEE", zorder=0, label=f"within {percent(WITHIN, 0)}")
    axes.axhline(0.0, color="#333333", linewidth=0.9)
    worst = [100.0 * (candidate.observation.peak.worst / candidate.goal.peak - 1.0) for candidate in candidates]
    typical = [100.0 * one.observation.misses["peak"] for one in candidates]
    axes.vlines(places, typical, worst, color=BLUE, linewidth=1.0, label="to the worst peak")
    for name, colour, marker in QUANTITIES:
        values = [100.0 * one.observation.misses[name] for one in candidates]
        axes.plot(places, values, marker, color=colour, markersize=4, label=name)
    mark_candidates(axes, candidates, (list(map(float, places)), typical))
    axes.set_yscale("symlog", linthresh=LINEAR)
    ticks = [-100, -20, -5, -1, 0, 1, 5, 20, 100]
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, -10.0), max(high, 10.0))
    axes.set_yticks(ticks, [f"{tick:+d}" if tick else "0" for tick in ticks], minor=False)
    axes.set_yticks([], minor=True)
    axes.set_ylim(min(low, -10.0), max(high, 10.0))
    quiet(axes, "Typical blow over the goal", "place of the candidate", "miss (%)")
    axes.set_xlim(0.0, len(candidates) + 1.0)
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.legend(frameon=False, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=3)


def _scatter(axes: Any, candidates: Sequence[SettingsCandidate]) -> None:
    """Draw the scatter of the peaks against the largest force of the stop; filled where the goal is met."""
    counts = sorted({candidate.strikers for candidate in candidates})
    kinds = {f"{n} striker{'s' if n > 1 else ''}": [one for one in candidates if one.strikers == n] for n in counts}
    draw_kinds(axes, kinds, _places, 5.0)
    axes.plot(*_places(candidates[:1]), "o", color="#333333", markersize=11, fillstyle="none", label="first")
    axes.plot([], [], "o", color=GREY, fillstyle="none", markersize=5, label="goal not met")
    mark_candidates(axes, candidates, _places(candidates))
    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        plain_log_ticks(axis)
    quiet(axes, "What it costs", headed("largest force of the stop", *FORCE.units), "scatter of the peaks, CV (%)")
    if not any(np.isfinite(one.observation.peak.variation) for one in candidates):
        axes.set_ylabel("one blow alone has no scatter")
        axes.set_yticks([], minor=False)
    axes.margins(0.08)
    axes.legend(frameon=False, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=4)


def _places(candidates: Sequence[SettingsCandidate]) -> Places:
    """Return forces as shown and scatters in %."""
    newton, _ = axis_unit(*FORCE.units)
    return (
        [max(candidate.observation.supply.stop_force, 1.0) / newton for candidate in candidates],
        [float(np.fmax(100.0 * one.observation.peak.variation, LEAST)) for one in candidates],
    )


def page(study: SettingsStudy) -> str:
    """Return the report of a search for settings as one HTML page: no script, nothing fetched, the same bytes."""
    caption = (
        "Left, how far the typical blow of each candidate misses the goal, by place, and its worst peak. Right, what "
        "the settings cost: scatter of the peaks over the largest force of the stop; filled where the goal is met."
    )
    sections = [
        picture_section("What the settings give", picture(study), caption),
        _first_section(study),
        _ranking_section(study),
        chapters.warnings(study.notices),
        *_left_section(study),
        chapters.inputs(study.case_of()),
    ]
    status = Tag("goal missed", "bad") if study.broken else None
    summary = chapters.Summary("Report of a search for machine settings", study.words, study.highlights(), status)
    return chapters.result_page(study, summary, sections)


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
    caption = f"Candidates, best first, for {study.goal.printed}"
    tables = [page_table(caption, study.candidate_columns(rows))]
    if len(study.masses) > 1:
        caption = "What the mass of a striker costs, all else as the first"
        tables.append(page_table(caption, study.candidate_columns(study.masses, "mass")))
    return Section("Candidates", text, tables)


def _left_section(study: SettingsStudy) -> list[Section]:
    """List what was not run, or gave no result; nothing where there is none."""
    rows: list[list[Cell]] = [[f"{one.strikers} strikers", one.why] for one in study.left_out]
    rows += [["no result", why] for why in study.failed]
    return [Section("Left out", "", [Table("Not run, or without a result", ["what", "why"], rows)])] if rows else []
