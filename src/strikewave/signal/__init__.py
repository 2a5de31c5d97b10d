"""Signals as arrays: pulses, filters and spectra. Knows no files."""

from strikewave.signal.pulse import Pulse, measure_pulse

__all__ = ["Pulse", "measure_pulse"]
