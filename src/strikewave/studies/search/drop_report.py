"""Designs of a drop table as a command, page and picture: the pulse in its band, clauses, ranking, what cannot."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from strikewave.analyses.clauses import clause_columns, verdict_words
from strikewave.analyses.record.figures.verdicts import draw_shock
from strikewave.base.shock_quantities import LENGTH
from strikewave.base.texts import percent
from strikewave.reporting import chapters
from strikewave.reporting.columns import page_table
from strikewave.reporting.faces import face_columns, face_table
from strikewave.reporting.layout import keys, numerals, texts
from strikewave.reporting.numbers import axis_unit, headed
from strikewave.reporting.parts import Cell, Section, Table, Tag
from strikewave.reporting.style import GREY, legend_below, new_figure, plain, quiet, titled
from strikewave.reporting.terminal import print_rows, table, tell
from strikewave.studies.search.drop_table import WITHIN, DropCandidate, DropStudy, design_drop_table
from strikewave.studies.search.machine import MachineSearch, limit_columns
from strikewave.studies.search.rotary_report import (
    MOST_REASONS,
    SIZE,
    Places,
    SearchCommand,
    draw_kinds,
    leading,
    mark_candidates,
)
from strikewave.studies.study import picture_section

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_SHOWN = 8
"""First of the ranking on the screen; the first of each other programmer follows."""
INPUTS = (
    *("machine.height", "machine.friction", "striker.mass", "object.mass", "object.frame_stiffness"),
    *("contact.restitution", "contact.reference_force", "contact.reference_depth"),
    *("contact.cushion.diameter", "contact.cushion.thickness", "contact.cushion.modulus", "contact.cushion.stress"),
    *("contact.cushion.exponent", "contact.cushion.retardation", "contact.cushion.limit_strain"),
)
"""Inputs that are printed; the report has all."""
MOST_ROWS = 60
"""Designs in the tables: more would not be read; settings.json has all."""


@dataclass
class DropCommand(SearchCommand):
    """A search for designs of a drop table."""

    design: ClassVar[Callable[..., MachineSearch]] = staticmethod(design_drop_table)

    def show(self, result: Any) -> None:
        """Print the ranking, the clauses, limits and inputs of the first, and why others do not meet the goal."""
        first = result.candidates[0]
        shown = leading(result.candidates, MOST_SHOWN, lambda one: one.programmer.name)
        print_rows(f"{result.met_count} designs give {result.goal.words}", result.candidate_columns(shown))
        tell("peak, width: as a sensor reads them whose zero is taken in the fall; margin: least of all clauses")
        tell("rebound: coefficient of restitution of the programmer, speed back over speed of arrival")
        reasons: dict[str, list[str]] = {}
        for one in shown:
            if not one.meets:
                reasons.setdefault(one.obstacles, []).append(f"#{one.place}")
        for obstacles, places in list(reasons.items())[:MOST_REASONS]:
            tell(f"{', '.join(places)}: {obstacles}")
        for name in dict.fromkeys(one.programmer.name for one in shown if one.programmer.assumed):
            tell(f"{name}: its law is assumed, nobody measured it")
        print_rows("Height of a free fall for this velocity change", face_columns(result, "heights"))
        print_rows("Clauses of the first", clause_columns(first.verdict.clauses))
        print_rows("Limits of the first", limit_columns(first.limits))
        values = first.case.values()
        inputs = [[path, str(value.typed), value.provenance] for path, value in values.items() if path in INPUTS]
        table("Its inputs", [*keys("field"), *numerals("value"), *texts("provenance")], inputs)
        self.show_failed(result)


def picture(study: DropStudy) -> Figure:
    """Draw the pulse of the first design in its band, and the rise of each pulse over the drop height."""
    figure = new_figure(SIZE)
    left, right = figure.subplots(1, 2)
    first = study.candidates[0]
    draw_shock(left, first.reading.shock, first.verdict, study.goal.limits, first.programmer.name, "full run")
    _designs(right, study)
    legend_below(figure)
    return titled(figure, plain(f"Drop table. {study.title}", 90))


def _designs(axes: Any, study: DropStudy) -> None:
    """Draw drop height and share of the pulse in which it rises, of each design; filled where it meets the goal."""
    names = dict.fromkeys(candidate.programmer.name for candidate in study.candidates)
    kinds = {plain(name, 30): [one for one in study.candidates if one.programmer.name == name] for name in names}
    draw_kinds(axes, kinds, _places, 6.0)
    axes.plot([], [], "o", color=GREY, fillstyle="none", markersize=6, label="does not meet it")
    mark_candidates(axes, study.candidates, _places(study.candidates))
    sine = (np.arcsin(0.9) - np.arcsin(0.1)) / (np.pi - 2.0 * np.arcsin(0.1))
    axes.axhline(100.0 * sine, color=GREY, linewidth=1.0, linestyle="--", label="half-sine")
    quiet(axes, "Designs", headed("drop height", *LENGTH.units), "rise time over pulse width (%)")
    axes.margins(0.08)


def _places(candidates: Sequence[DropCandidate]) -> Places:
    """Return drop heights as shown, and rise times over widths in %."""
    metre, _ = axis_unit(*LENGTH.units)
    return (
        [candidate.height / metre for candidate in candidates],
        [100.0 * one.reading.blow.rise / one.reading.width for one in candidates],
    )


def page(study: DropStudy) -> str:
    """Return the report of designs as one HTML page."""
    caption = (
        "Left, what a sensor on the table reads in the full run of the first design, its zero taken in the fall, and "
        "what it is held against. Right, all designs: how fast their pulses rise (10 to 90 %) beside a half-sine, over "
        "the height; filled where they meet the specification."
    )
    first = study.candidates[0]
    sections = [
        picture_section("The pulse", picture(study), caption),
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
    summary = chapters.Summary("Report of a design of a drop table", study.words, study.highlights(), status)
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
    designs = page_table(f"Designs for {study.goal.words}", study.candidate_columns(study.candidates[:MOST_ROWS]))
    return Section("Designs", text, [designs, heights])


def _without(study: DropStudy) -> list[Section]:
    """List what does not meet the goal, and why; nothing where there is none."""
    rows: list[list[Cell]] = [
        [f"{candidate.place}", candidate.programmer.name, candidate.obstacles]
        for candidate in study.candidates[:MOST_ROWS]
        if not candidate.meets
    ]
    rows += [["", "no result", why] for why in study.failed]
    if not rows:
        return []
    return [Section("What does not meet it", "", [Table("Designs that do not", ["#", "programmer", "why"], rows)])]
