"""Pictures of impacts, identified contacts and laws; a module of its own, for drawing takes long to import."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from strikewave.analyses.impact.figures.contact import asked_given, impact_sheet
from strikewave.analyses.impact.figures.identified import identified_figure
from strikewave.analyses.impact.identified import IdentifyResult
from strikewave.analyses.impact.identified_report import identified_report
from strikewave.analyses.impact.law_list import LawsResult
from strikewave.analyses.impact.report import impact_report
from strikewave.analyses.impact.result import ImpactResult
from strikewave.reporting.style import titled

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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
