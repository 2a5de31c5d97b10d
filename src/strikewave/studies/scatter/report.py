"""Page, screen and command of a scatter study: how much blows scatter, and by which tolerance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from strikewave.base.shock_quantities import ACCELERATION, VARIATION
from strikewave.reporting.columns import Column, page_table
from strikewave.reporting.faces import amount, columns_of, face_table, text_of
from strikewave.reporting.numbers import listed
from strikewave.reporting.output_options import Output
from strikewave.reporting.parts import Section
from strikewave.reporting.terminal import print_face, print_rows, tell
from strikewave.studies.command import Report, StudyCommand
from strikewave.studies.engine.store import RunStore
from strikewave.studies.scatter.figures import picture
from strikewave.studies.scatter.study import STATEMENTS, ScatterPlan, ScatterStudy, ShareRow, make_scatter
from strikewave.studies.study import picture_section, study_page
from strikewave.uncertainty.draws import tolerances_of
from strikewave.uncertainty.shares import Shares

FEWEST_FOR_LIMIT = 59
"""Runs below which no limit holds for 95 % of all runs with 95 % confidence."""


def scatter_words(study: ScatterStudy) -> str:
    """Say in words what the tolerances do."""
    low, high = (amount(ACCELERATION, end[0]) for end in (study.peak_band.low, study.peak_band.high))
    sentences = [
        f"{len(study.completed)} full runs with every one of {_count(len(study.tolerances), 'tolerance')} drawn anew."
        + (f" {study.verdicts.sentence}" if study.verdicts.words else ""),
        f"The peak of the first blow lies between {low} and {high} in 95 % of them.",
        f"Within a run the peaks scatter by a CV of {text_of(study, 'cv_within')} (median of the runs; the dynamics "
        f"alone, at nominal values, give {text_of(study.dynamics_alone['peak'], 'cv')}); from run to run the typical "
        f"peak by {text_of(study, 'cv_between')}.",
    ]
    for shares in study.shares:
        known = [row for row in shares.rows if row.distinct]
        if known:
            sentences.append(f"Most of the {shares.of} comes from {known[0].path} ({text_of(known[0], 'share')}).")
    return " ".join(sentences)


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def sum_words(shares: Shares) -> str:
    """Write the sum of shares with its bounds."""
    total, low, high = (amount(VARIATION, value) for value in (shares.sum, shares.sum_low, shares.sum_high))
    return f"{total} ({low} to {high})" if shares.sum_low == shares.sum_low else f"{total} (–)"


def _caption(study: ScatterStudy) -> str:
    caption = (
        "Above, the rigid-body peak of each blow: median and the band that holds 95 % of the runs, beside the dynamics "
        "alone."
    )
    caption += " A run that failed a check is marked at its largest peak." if any(study.verdicts.marked) else ""
    return caption + (" Below, the share of each tolerance with its bounds at 95 %." if study.shares else "")


def page(study: ScatterStudy) -> str:
    """Return the report of a scatter study as one HTML page."""
    plan, sobol, failed = study.plan, study.plan.shares == "sobol", study.failed
    text = f"Bounds: {STATEMENTS['mean']}. Within a run: {STATEMENTS['cv_within']}."
    tables = [
        face_table(study, "means"),
        face_table(study, "typical_blows"),
        face_table(study, "within", caption="Scatter within a run: CV (%); later is without the first blow"),
        face_table(study, "odd_blows"),
    ]
    outcome = [picture_section("Peaks and shares", picture(study), _caption(study)), Section("Scatter", text, tables)]
    if study.shares:
        how = "Sobol indices" if sobol else "each tolerance alone, all other inputs nominal"
        sums = "; ".join(f"{shares.of}: {sum_words(shares)}" for shares in study.shares)
        tables = [
            page_table(f"Shares in the {shares.of}; {shares.runs} runs each", _share_columns(study, shares))
            for shares in study.shares
        ]
        outcome.append(Section("Shares", f"By {how}. The shares add up to: {sums}.", tables))
    left = (
        f" {_count(failed, 'run')} could not be made and {'is' if failed == 1 else 'are'} left out." if failed else ""
    )
    text = f"{plan.runs} runs, random seed {plan.seed}: equal seeds reproduce them bit for bit.{left}"
    names = listed([tolerance.path for tolerance in study.tolerances[:3]])
    drawn = Section("What was drawn", text, [face_table(study, "drawn", "drawn", f"Tolerances, such as {names}")])
    return study_page(study, scatter_words(study), outcome, drawn, "a scatter study")


def _share_columns(study: ScatterStudy, shares: Shares) -> list[Column]:
    """Return the shares in one quantity with what each tolerance is."""
    return columns_of(ShareRow, study.share_rows(shares), "sobol" if study.plan.shares == "sobol" else "alone")


@dataclass
class ScatterCommand(StudyCommand[ScatterStudy]):
    """A scatter study as a command."""

    name: ClassVar[str] = "scatter"
    indent: ClassVar[int | None] = 2

    plan: ScatterPlan

    @property
    def marked_text(self) -> str:
        """The case as text, and above it what is asked."""
        return self.plan.marked_text(self.case)

    def run(self, changes: Sequence[str], output: Output) -> int:
        """Make the study; a case that is no rotary machine, or has no tolerance, is refused before."""
        self.case.rotary_tables()
        tolerances_of(self.case)
        return super().run(changes, output)

    def made(self, store: RunStore, report: Report) -> ScatterStudy:
        """Return the study."""
        return make_scatter(self.case, self.plan, store, self.pool, report)

    def summary(self, result: ScatterStudy) -> str:
        """Say how much the blows scatter, and which tolerance matters most."""
        return scatter_words(result)

    def show(self, result: ScatterStudy) -> None:
        """Print the scatter, and which tolerance it comes from."""
        print_face(result, "means", "Means of the runs, and CV between runs")
        print_face(result, "typical_blows", "Typical blow of each run, and CV between runs")
        print_face(result, "within", "Scatter within a run: CV (%); later: without the first blow")
        broken = sum(result.without_limit)
        counted = f"; {broken} of {len(result.runs)} runs failed or missed a blow and keep no limit" if broken else ""
        tell(f"bounds of the CV between runs: for normal figures; 95 % of runs below: with 95 % confidence{counted}")
        if len(result.runs) < FEWEST_FOR_LIMIT:
            tell(f"95 % of runs below takes {FEWEST_FOR_LIMIT} runs or more")
        kinds = ", ".join(
            f"{counted_blows.blows} {kind} (in {counted_blows.runs} runs)"
            for kind, counted_blows in result.odd_blows.items()
        )
        tell(f"blows: {kinds}; largest displacement (rearward) {text_of(result, 'largest_displacement')}")
        how = "Sobol indices" if result.plan.shares == "sobol" else "each alone"
        for shares in result.shares:
            print_rows(f"Shares in the {shares.of}, {how}, {shares.runs} runs each", _share_columns(result, shares))
            tell(f"sum of the shares: {sum_words(shares)}")
