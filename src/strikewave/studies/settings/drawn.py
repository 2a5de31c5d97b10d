"""Picture of a search for settings; a module of its own, for drawing takes long to import."""

from strikewave.studies.settings.figures import settings_figure

picture = settings_figure
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`."""
