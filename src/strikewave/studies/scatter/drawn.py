"""Picture of a scatter study; a module of its own, for drawing takes long to import."""

from strikewave.studies.scatter.figures import scatter_picture

picture = scatter_picture
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`."""
