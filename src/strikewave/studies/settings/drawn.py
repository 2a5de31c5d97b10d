"""Page and picture of a search for settings; a module of its own, for drawing takes long to import."""

from strikewave.studies.settings.figures import settings_figure
from strikewave.studies.settings.report import settings_report

picture = settings_figure
page = settings_report
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`; so does `picture`."""
