"""Picture of a search for gaskets; a module of its own, for drawing takes long to import."""

from strikewave.studies.buffer.figures import peak_bandwidth

picture = peak_bandwidth
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`."""
