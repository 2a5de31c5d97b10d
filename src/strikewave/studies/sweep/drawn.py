"""Page and picture of a sweep; a module of its own, for drawing takes long to import."""

from strikewave.studies.sweep.figures import sweep_picture
from strikewave.studies.sweep.report import sweep_report

picture = sweep_picture
page = sweep_report
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`; so does `picture`."""
