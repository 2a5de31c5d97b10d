"""Signals as arrays: pulses, filters and spectra. Knows no files."""

from strikewave.signal.filters import Filter, advised_cutoff, effect_on_half_sine, low_pass
from strikewave.signal.pulse import Pulse, measure_pulse

__all__ = ["Filter", "Pulse", "advised_cutoff", "effect_on_half_sine", "low_pass", "measure_pulse"]
