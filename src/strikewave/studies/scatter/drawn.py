"""Page and picture of a scatter study; a module of its own, for drawing takes long to import."""

from strikewave.studies.scatter.figures import scatter_picture
from strikewave.studies.scatter.report import scatter_report

picture = scatter_picture
page = scatter_report
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`; so does `picture`."""
