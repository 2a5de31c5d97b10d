"""Page and picture of a design; a module of its own, for drawing takes long to import."""

from strikewave.studies.design.figures import design_picture
from strikewave.studies.design.report import design_report

picture = design_picture
page = design_report
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`; so does `picture`."""
