"""Picture of a map; a module of its own, for drawing takes long to import."""

from strikewave.studies.map.figures import map_figure

picture = map_figure
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`."""
