"""A search for settings of a machine as a command, page and picture: rankings, first candidate, failures."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

import numpy as np

from strikewave.analyses.clauses import clause_columns, verdict_words
from strikewave.analyses.record.figures.verdicts import draw_shock
from strikewave.base.declare import declarations
from strikewave.base.result import Verdicts
from strikewave.base.shock_quantities import FORCE, LENGTH
from strikewave.base.texts import percent
from strikewave.reporting import chapters, style
from strikewave.reporting.columns import Column, page_table
from strikewave.reporting.faces import face_columns, face_table, text_of
from strikewave.reporting.layout import keys, numerals, texts
from strikewave.reporting.numbers import axis_unit, headed, shown
from strikewave.reporting.parts import NONE, Cell, Section, Table, Tag, written
from strikewave.reporting.terminal import print_rows, table, tell
from strikewave.studies.axes import plain_log_ticks
from strikewave.studies.command import Report, StudyCommand
from strikewave.studies.engine.runner import share_reporter
from strikewave.studies.engine.store import RunStore
from strikewave.studies.search import rotary_candidate
from strikewave.studies.search.drop_table import WITHIN, DropCandidate, DropGoal, DropTableStudy, design_drop_table
from strikewave.studies.search.machine import MachineCandidate, MachineSearch, asked_line, limit_columns
from strikewave.studies.search.rotary import SettingsStudy, design_settings
from strikewave.studies.search.rotary_candidate import SettingsCandidate
from strikewave.studies.study import picture_section

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Candidate = TypeVar("Candidate", bound=MachineCandidate)
Places = tuple[list[float], list[float]]

MOST_SETTINGS, MOST_DESIGNS = 6, 8
"""First of the ranking on the screen; the first of each other number of strikers, or programmer, follows."""
MOST_REASONS = 6  # reasons that the screen prints: it stays one page; the report has more
MOST_ROWS, MOST_DROPS = 40, 60  # candidates in the tables of the page: more would not be read; settings.json has all
SIZE = (10.0, 4.6)  # two diagrams beside each other on a page, inches
MOST_DRAWN = 30  # more marks would run into one another
LINEAR = 1.0  # misses up to this, in %, stand on a linear scale: a search that came to its end is below
LEAST = 0.01  # a scatter below this, in %, is drawn here: 0 has no place on a logarithmic axis
QUANTITIES = (("peak", style.BLUE, "o"), ("width", style.ORANGE, "s"), ("interval", style.GREEN, "^"))
MARKERS = {
    "o": style.BLUE, "s": style.ORANGE, "^": style.GREEN, "D": style.RED, "v": "#CC79A7", "P": "#56B4E9",
    "X": style.GREY,
}  # fmt: skip
INPUTS = (
    *("machine.height", "machine.friction", "striker.mass", "object.mass", "object.frame_stiffness"),
    *("contact.restitution", "contact.reference_force", "contact.reference_depth"),
    *("contact.cushion.diameter", "contact.cushion.thickness", "contact.cushion.modulus", "contact.cushion.stress"),
    *("contact.cushion.exponent", "contact.cushion.retardation", "contact.cushion.limit_strain"),
)
"""Inputs of a drop table that the screen prints: those that set its pulse; the report has all."""
BELOW = {"frameon": False, "fontsize": 8, "loc": "upper center", "bbox_to_anchor": (0.5, -0.14)}
"""Legend below a diagram, where it hides no mark."""


@dataclass
class SearchCommand(StudyCommand[MachineSearch]):
    """A search for settings of a machine as a command; its plan is the goal, and the values that may be chosen.

    Attributes
    ----------
    usual : bool
        True if only the goal was asked: the folder then has the name of the goal alone.
    """

    name: ClassVar[str] = "settings"
    bar: ClassVar[str] = "settings"
    clocks: ClassVar[tuple[str, ...]] = ("elapsed",)
    noun: ClassVar[str] = "searches"

    plan: tuple[Any, Any]
    usual: bool = True

    @property
    def marked_text(self) -> str:
        """The question alone: only the search knows the case."""
        return asked_line(self.case, *self.plan)

    def usual_folder(self, changes: Sequence[str]) -> str:
        """Return the default folder: the name of the goal, and a mark of all else that was asked."""
        name = str(self.plan[0].name)
        return name if self.usual else f"{name}-{self.marked_text[-10:-2]}"

    def made(self, store: RunStore, report: Report) -> MachineSearch:
        """Return the ranked settings."""
        design = design_drop_table if isinstance(self.plan[0], DropGoal) else design_settings
        return design(self.case, *self.plan, store, self.pool, share_reporter(report))

    def summary(self, result: MachineSearch) -> str:
        """Return the sentences on the outcome."""
        return result.words

    def show(self, result: MachineSearch) -> None:
        """Print the ranking, the judgement of the first, and failures."""
        if isinstance(result, DropTableStudy):
            show_drop_table(result)
        elif isinstance(result, SettingsStudy):
            show_settings(result)
        for why in result.failed[:MOST_REASONS]:
            tell(f"no result, {why}")


def show_settings(study: SettingsStudy) -> None:
    """Print the settings of a rotary machine."""
    first = study.candidates[0]
    rows = leading(study.candidates, MOST_SETTINGS, lambda candidate: candidate.strikers)
    print_rows(f"{study.met_count} settings give {study.goal.words}", study.candidate_columns(rows))
    tell(
        "peak, width, interval: of the typical blow, the median of the later full ones; CV: scatter of all peaks; "
        "sensitivity: change of the peak with engagement"
    )
    guess, seen = first.estimate, first.observation
    tell(
        f"{study.goal.words}, from {study.case.name}: a half-sine changes the velocity by "
        f"{text_of(guess, 'velocity_change')}, for which a first estimate asks an approach of "
        f"{text_of(guess, 'approach')}; the full run has {text_of(seen, 'velocity_change')} and "
        f"{text_of(seen, 'approach')}"
    )
    print_rows("Limits of the first", limit_columns(first.limits))
    if first.clauses:
        print_rows("Clauses of the first, each by its worst blow", clause_columns(first.clauses))
    if len(study.masses) > 1:
        print_rows("What the mass of a striker costs", study.candidate_columns(study.masses, "mass"))
    for left in study.left_out:
        tell(f"left out, {left.strikers} strikers: {left.why}")


def show_drop_table(study: DropTableStudy) -> None:
    """Print the designs of a drop table."""
    first = study.candidates[0]
    rows = leading(study.candidates, MOST_DESIGNS, lambda candidate: candidate.programmer.name)
    print_rows(f"{study.met_count} designs give {study.goal.words}", study.candidate_columns(rows))
    tell("peak, width: as a sensor reads them whose zero is taken in the fall; margin: least of all clauses")
    tell("rebound: coefficient of restitution of the programmer, speed back over speed of arrival")
    reasons: dict[str, list[str]] = {}
    for candidate in rows:
        if not candidate.meets:
            reasons.setdefault(candidate.obstacles, []).append(f"#{candidate.place}")
    for obstacles, places in list(reasons.items())[:MOST_REASONS]:
        tell(f"{', '.join(places)}: {obstacles}")
    for name in dict.fromkeys(candidate.programmer.name for candidate in rows if candidate.programmer.assumed):
        tell(f"{name}: its law is assumed, nobody measured it")
    print_rows("Height of a free fall for this velocity change", face_columns(study, "heights"))
    print_rows("Clauses of the first", clause_columns(first.verdict.clauses))
    print_rows("Limits of the first", limit_columns(first.limits))
    values = first.case.values()
    inputs = [[path, str(value.typed), value.provenance] for path, value in values.items() if path in INPUTS]
    table("Its inputs", [*keys("field"), *numerals("value"), *texts("provenance")], inputs)


def leading(candidates: Sequence[Candidate], most: int, kind: Callable[[Candidate], object]) -> list[Candidate]:
    """Return the first of the ranking, and the first of each other kind."""
    first = list({kind(candidate): candidate for candidate in reversed(candidates)}.values())
    return [candidate for k, candidate in enumerate(candidates) if k < most or candidate in first]


def picture(study: MachineSearch) -> Figure:
    """Draw the outcome of a search on one sheet."""
    from matplotlib.figure import Figure

    if isinstance(study, DropTableStudy):
        figure = style.new_figure(SIZE)
        left, right = figure.subplots(1, 2)
        first = study.candidates[0]
        draw_shock(left, first.reading.shock, first.verdict, study.goal.limits, first.programmer.name, "full run")
        draw_designs(right, study)
        style.legend_below(figure)
        return style.titled(figure, style.plain(f"Drop table. {study.title}", 90))
    figure = Figure(figsize=SIZE, layout="constrained")
    left, right = figure.subplots(1, 2)
    draw_misses(left, study.candidates[:MOST_DRAWN])
    draw_scatter(right, study.candidates)
    style.sheet_title(figure, textwrap.shorten(f"Settings {'' if study.broken else 'for '}{study.title}", 90))
    return figure


def draw_candidates(
    axes: Any, kinds: Mapping[str, Sequence[Candidate]], places: Callable[[Sequence[Candidate]], Places], size: float
) -> None:
    """Draw the candidates of each kind with a marker of its own, filled where they meet the goal."""
    for k, (label, members) in enumerate(kinds.items()):
        marker, colour = list(MARKERS.items())[k % len(MARKERS)]
        for met, fill in ((True, colour), (False, "none")):
            points = [candidate for candidate in members if candidate.meets == met]
            if points:
                axes.plot(*places(points), marker, color=colour, markerfacecolor=fill, markersize=size)
        axes.plot([], [], marker, color=colour, markersize=size, label=label)


def mark_failed(axes: Any, candidates: Sequence[MachineCandidate], places: Places) -> None:
    """Mark candidates whose runs failed a check."""
    style.mark_runs(axes, *places, Verdicts(candidate.run_verdict for candidate in candidates))


def draw_misses(axes: Any, candidates: Sequence[SettingsCandidate]) -> None:
    """Draw typical peak, width and interval over the goal, and the worst peak, of each candidate."""
    places, within = list(range(1, len(candidates) + 1)), 100.0 * rotary_candidate.WITHIN
    axes.axhspan(-within, within, color="#EEEEEE", zorder=0, label=f"within {percent(rotary_candidate.WITHIN, 0)}")
    axes.axhline(0.0, color="#333333", linewidth=0.9)
    seen = [candidate.observation for candidate in candidates]
    goal = candidates[0].goal
    typical = [100.0 * observation.misses["peak"] for observation in seen]
    worst = [100.0 * (observation.peak.worst / goal.peak - 1.0) for observation in seen]
    axes.vlines(places, typical, worst, color=style.BLUE, linewidth=1.0, label="to the worst peak")
    for name, colour, marker in QUANTITIES:
        values = [100.0 * observation.misses[name] for observation in seen]
        axes.plot(places, values, marker, color=colour, markersize=4, label=name)
    mark_failed(axes, candidates, (list(map(float, places)), typical))
    axes.set_yscale("symlog", linthresh=LINEAR)
    ticks = [-100, -20, -5, -1, 0, 1, 5, 20, 100]
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, -10.0), max(high, 10.0))
    axes.set_yticks(ticks, [f"{tick:+d}" if tick else "0" for tick in ticks], minor=False)
    axes.set_yticks([], minor=True)
    axes.set_ylim(min(low, -10.0), max(high, 10.0))  # ticks beyond the limits have widened them
    style.quiet(axes, "Typical blow over the goal", "place of the candidate", "miss (%)")
    axes.set_xlim(0.0, len(candidates) + 1.0)
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.legend(**BELOW, ncols=3)


def draw_scatter(axes: Any, candidates: Sequence[SettingsCandidate]) -> None:
    """Draw the scatter of the peaks over the largest force of the stop; filled where the goal is met."""
    newton, _ = axis_unit(*FORCE.units)

    def places(members: Sequence[SettingsCandidate]) -> Places:
        seen = [candidate.observation for candidate in members]
        forces = [max(observation.supply.stop_force, 1.0) / newton for observation in seen]
        return forces, [float(np.fmax(100.0 * observation.peak.variation, LEAST)) for observation in seen]

    counts = sorted({candidate.strikers for candidate in candidates})
    kinds = {
        f"{n} striker{'s' if n > 1 else ''}": [candidate for candidate in candidates if candidate.strikers == n]
        for n in counts
    }
    draw_candidates(axes, kinds, places, 5.0)
    axes.plot(*places(candidates[:1]), "o", color="#333333", markersize=11, fillstyle="none", label="first")
    axes.plot([], [], "o", color=style.GREY, fillstyle="none", markersize=5, label="goal not met")
    mark_failed(axes, candidates, places(candidates))
    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        plain_log_ticks(axis)
    style.quiet(
        axes, "What it costs", headed("largest force of the stop", *FORCE.units), "scatter of the peaks, CV (%)"
    )
    if not any(np.isfinite(candidate.observation.peak.variation) for candidate in candidates):
        axes.set_ylabel("one blow alone has no scatter")
        axes.set_yticks([], minor=False)
    axes.margins(0.08)
    axes.legend(**BELOW, ncols=4)


def draw_designs(axes: Any, study: DropTableStudy) -> None:
    """Draw the rise of each pulse, as a share of its width, over the drop height; filled where the goal is met."""
    metre, _ = axis_unit(*LENGTH.units)

    def places(members: Sequence[DropCandidate]) -> Places:
        rises = [100.0 * candidate.reading.blow.rise / candidate.reading.width for candidate in members]
        return [candidate.height / metre for candidate in members], rises

    kinds: dict[str, list[DropCandidate]] = {}
    for candidate in study.candidates:
        kinds.setdefault(style.plain(candidate.programmer.name, 30), []).append(candidate)
    draw_candidates(axes, kinds, places, 6.0)
    axes.plot([], [], "o", color=style.GREY, fillstyle="none", markersize=6, label="does not meet it")
    mark_failed(axes, study.candidates, places(study.candidates))
    sine = (np.arcsin(0.9) - np.arcsin(0.1)) / (np.pi - 2.0 * np.arcsin(0.1))
    axes.axhline(100.0 * sine, color=style.GREY, linewidth=1.0, linestyle="--", label="half-sine")
    style.quiet(axes, "Designs", headed("drop height", *LENGTH.units), "rise time over pulse width (%)")
    axes.margins(0.08)


def page(study: MachineSearch) -> str:
    """Return the report of a search as one HTML page: no script, nothing fetched, the same bytes each time."""
    inputs = chapters.inputs(study.case_of())
    if isinstance(study, DropTableStudy):
        caption = (
            "Left, what a sensor on the table reads in the full run of the first design, its zero taken in the fall, "
            "and what it is held against. Right, all designs: how fast their pulses rise (10 to 90 %) beside a "
            "half-sine, over the height; filled where they meet the specification."
        )
        sections = [picture_section("The pulse", picture(study), caption), *drop_sections(study)]
        sections += [chapters.warnings(study.notices), inputs]
        title = "Report of a design of a drop table"
        status = None if study.broken else Tag(verdict_words("pass", study.by_indicative), "good")
    else:
        assert isinstance(study, SettingsStudy)
        caption = (
            "Left, how far the typical blow of each candidate misses the goal, by place, and its worst peak. Right, "
            "what the settings cost: scatter of the peaks over the largest force of the stop; filled where the goal is "
            "met."
        )
        rows: list[list[Cell]] = [[f"{left.strikers} strikers", left.why] for left in study.left_out]
        rows += [["no result", why] for why in study.failed]
        sections = [picture_section("What the settings give", picture(study), caption), *settings_sections(study)]
        sections.append(chapters.warnings(study.notices))
        if rows:
            sections.append(Section("Left out", "", [Table("Not run, or without a result", ["what", "why"], rows)]))
        sections.append(inputs)
        title, status = "Report of a search for machine settings", None
    status = Tag("goal missed", "bad") if study.broken else status
    return chapters.result_page(study, chapters.Summary(title, study.words, study.highlights(), status), sections)


def settings_sections(study: SettingsStudy) -> list[Section]:
    """Return the sections on the first candidate and on the ranking of a rotary machine."""
    first = study.candidates[0]
    values = first.case.values()
    chosen: list[list[Cell]] = [[path, str(values[path].typed)] for path in first.chosen]
    blows: list[list[Cell]] = []
    for name in ("peak", "width", "interval"):
        spread = getattr(first.observation, name)
        quantity = declarations(type(spread))["typical"].quantity
        numbers = (getattr(study.goal, name), spread.typical, spread.first, spread.worst)
        cells = [written(shown(value, *quantity.units)) for value in numbers]
        scatter = NONE if np.isnan(spread.variation) else written(100.0 * spread.variation, 3)
        blows.append([headed(quantity.label, *quantity.units), *cells, scatter])
    tables = [
        Table("What was chosen", ["setting", "value"], chosen),
        Table("Blows", ["", "wanted", "typical", "first", "worst", "CV (%)"], blows),
        page_table("Limits", limit_columns(first.limits)),
    ]
    if first.clauses:
        blow = Column("blow", [str(clause.blow) for clause in first.clauses])
        tables.append(page_table("Clauses of the specification", [*clause_columns(first.clauses), blow]))
    more = len(study.candidates) - MOST_ROWS
    text = (
        "Peak, width and interval are those of the typical blow; stop is the largest force on it; sensitivity is the "
        f"change of the peak with engagement.{f' settings.json has {more} more.' if more > 0 else ''}"
    )
    caption = f"Candidates, best first, for {study.goal.printed}"
    rankings = [page_table(caption, study.candidate_columns(study.candidates[:MOST_ROWS]))]
    if len(study.masses) > 1:
        caption = "What the mass of a striker costs, all else as the first"
        rankings.append(page_table(caption, study.candidate_columns(study.masses, "mass")))
    typical = "Typical is the median of the later full blows; worst is the blow farthest from the goal."
    return [Section("The first candidate", typical, tables), Section("Candidates", text, rankings)]


def drop_sections(study: DropTableStudy) -> list[Section]:
    """Return the sections on the first design, on the ranking, and on designs that miss the goal."""
    first = study.candidates[0]
    counts = Counter(value.provenance for value in first.case.values().values())
    provenances = ", ".join(f"{count} {name}" for name, count in sorted(counts.items(), key=lambda pair: -pair[1]))
    chosen: list[list[Cell]] = [[path, str(value.typed), value.provenance] for path, value in first.settings.items()]
    tables = [
        Table("What was chosen", ["setting", "value", "provenance"], chosen),
        page_table("Clauses", clause_columns(first.verdict.clauses)),
        page_table("Limits", limit_columns(first.limits)),
    ]
    text = (
        f"Peak and width of each come to the ideal pulse within {percent(WITHIN)} where both can. The margin is the "
        "least of all clauses over half their tolerance, the departure the root mean square of the difference to the "
        "ideal pulse over its peak. Of a pad the rate is its largest force over the compression "
        "there. The rebound is the coefficient of restitution in the full run: a programmer that gives back less takes "
        "more height for the same velocity change, four times as much without any rebound."
    )
    rows = study.candidates[:MOST_DROPS]
    rankings = [
        page_table(f"Designs for {study.goal.words}", study.candidate_columns(rows)),
        face_table(study, "heights", caption="Height of a free fall for this velocity change"),
    ]
    sections = [
        Section("The first design", f"Provenance: {provenances}. All inputs stand below.", tables),
        Section("Designs", text, rankings),
    ]
    without: list[list[Cell]] = [
        [f"{candidate.place}", candidate.programmer.name, candidate.obstacles]
        for candidate in rows
        if not candidate.meets
    ]
    without += [["", "no result", why] for why in study.failed]
    if without:
        misses = Table("Designs that do not", ["#", "programmer", "why"], without)
        sections.append(Section("What does not meet it", "", [misses]))
    return sections
