"""Studies on cases: fits so far."""

from strikewave.studies.calibrate import Fit, calibrate

__all__ = ["Fit", "calibrate"]
