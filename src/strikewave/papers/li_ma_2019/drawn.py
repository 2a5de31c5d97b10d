"""Page and picture of the reproduction; a module of its own, for drawing takes long to import."""

from __future__ import annotations

from typing import TYPE_CHECKING

from strikewave.papers.li_ma_2019.report.figures import overview_picture
from strikewave.papers.li_ma_2019.report.page import reproduction_report
from strikewave.papers.li_ma_2019.result import Reproduction

if TYPE_CHECKING:
    from matplotlib.figure import Figure

page = reproduction_report
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`; so does `picture`."""


def picture(result: Reproduction) -> Figure:
    """Return how far everything that can be compared is from the published numbers."""
    return overview_picture(result).figure
