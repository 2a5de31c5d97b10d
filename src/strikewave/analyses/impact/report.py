"""The report of an impact of two free bodies: its numbers, its histories, and the laws that it rests on."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from strikewave.analyses.impact.figures.contact import asked_given, impact_sheet
from strikewave.analyses.impact.figures.identified import identified_figure
from strikewave.analyses.impact.identified import IdentifyResult
from strikewave.analyses.impact.identified_report import identified_report
from strikewave.analyses.impact.law_list import LawsResult
from strikewave.analyses.impact.result import MOST_ROWS, ImpactResult, blow_columns
from strikewave.base.shock_quantities import KILOGRAMS, VELOCITY
from strikewave.reporting import chapters
from strikewave.reporting.columns import page_table
from strikewave.reporting.faces import amount, face_table, part_tables
from strikewave.reporting.numbers import percent
from strikewave.reporting.parts import Picture, Section
from strikewave.reporting.style import titled

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def impact_report(result: ImpactResult) -> str:
    """Return the report of an impact as one HTML page: no script, nothing fetched, the same bytes each time."""
    drawn, many = result.drawn, len(result.blows) > 1
    figure = impact_sheet([result.blows[k] for k in drawn], [f"blow {k + 1}" for k in drawn], "")
    caption = (
        "Force over time and over indentation, and the phase plane: shares of the approach speed and of the depth."
    )
    answers = [face_table(result, "contact_answers")] if result.differ else []
    numbers = [*part_tables(result, "first"), *part_tables(result, "law"), *answers]
    lost = "energy lost, share of that of the approach", percent(1.0 - result.first.restitution**2)
    sections = [
        Section("Histories", "", [Picture(figure, caption)]),
        Section("First blow" if many else "Blow", "", numbers),
        *([_blows(result)] if many else []),
        chapters.warnings(result.notices),
    ]
    summary = chapters.Summary("Report of an impact", impact_words(result), [*result.highlights(), lost])
    return chapters.result_page(result, summary, sections)


def impact_words(result: ImpactResult) -> str:
    """Say in words what happens."""
    setup, numbers = result.setup, dict(result.highlights())
    m1, m2 = (amount(KILOGRAMS, mass) if mass < float("inf") else "a fixed body" for mass in setup.masses)
    return (
        f"{m1} strikes {m2} at {amount(VELOCITY, setup.speed)}: the force peaks at {numbers['peak force']} and "
        f"lasts {numbers['duration']}; the coefficient of restitution is {numbers['coefficient of restitution']}. "
        f"Solved by the {result.first.method}."
    )


def _blows(result: ImpactResult) -> Section:
    some = f"The first and last {MOST_ROWS // 2} of {len(result.blows)} blows." if len(result.blows) > MOST_ROWS else ""
    return Section("Blows", some, [page_table("Blows on the same spot", blow_columns(result))])


def impact_picture(result: ImpactResult) -> Figure:
    """Return force and indentation of the drawn blows."""
    labels = [f"blow {k + 1}" for k in result.drawn]
    return impact_sheet([result.blows[k] for k in result.drawn], labels, result.title)


def identified_picture(result: IdentifyResult) -> Figure:
    """Return the pulse beside the law."""
    return titled(identified_figure(result.found), result.title)


def laws_picture(result: LawsResult) -> Figure:
    """Return which coefficient of restitution the laws give for the one asked."""
    return asked_given(result.everything.damping)


picture: dict[type, Callable[[Any], Figure]] = {
    ImpactResult: impact_picture,
    IdentifyResult: identified_picture,
    LawsResult: laws_picture,
}
page: dict[type, Callable[[Any], str]] = {ImpactResult: impact_report, IdentifyResult: identified_report}
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`; so does `picture`."""
