"""Page and picture of a fit; a module of its own, for drawing takes long to import."""

from strikewave.studies.fit.figures import fit_figure
from strikewave.studies.fit.report import fit_report

picture = fit_figure
page = fit_report
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`; so does `picture`."""
