"""Page and picture of a search for gaskets; a module of its own, for drawing takes long to import."""

from strikewave.studies.buffer.figures import peak_bandwidth
from strikewave.studies.buffer.report import buffer_report

picture = peak_bandwidth
page = buffer_report
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`; so does `picture`."""
