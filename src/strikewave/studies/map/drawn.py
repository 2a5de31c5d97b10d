"""Page and picture of a map; a module of its own, for drawing takes long to import."""

from strikewave.studies.map.figures import map_figure
from strikewave.studies.map.report import map_report

picture = map_figure
page = map_report
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`; so does `picture`."""
