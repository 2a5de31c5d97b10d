"""Page and picture of designs of a drop table; a module of its own, for drawing takes long to import."""

from strikewave.studies.settings.drop_table.figures import drop_figure
from strikewave.studies.settings.drop_table.report import drop_report

picture = drop_figure
page = drop_report
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`; so does `picture`."""
