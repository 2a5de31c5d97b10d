"""Units of the figures of records: of the channel, of its integral over time, or of their own."""

from __future__ import annotations

from collections.abc import Sequence

from strikewave.records.reading import FileReading

INTEGRALS = {"m/s^2": "m/s", "m/s": "m", "N": "N s", "Pa": "Pa s", "V": "V s", "1": "s", "": ""}
"""Unit of the integral over time of each unit."""
OWN = "as in the file"
"""Stands for the unit of figures whose file does not say it."""
COSTS = ("loss", "loss_uncertainty", "leak", "elastic", "widening", "wave_energy")
"""What the band split costs, and the energy of the wave part, over the peak, the width and the energy."""
IN_SECONDS = (
    "rise",
    "width",
    "begin",
    "end",
    "smooth_width",
    "width_uncertainty",
    "rigid_width",
    "rigid_width_uncertainty",
    "split_width",
    "split_width_uncertainty",
    "width_expanded_uncertainty",
)
PULSE_UNITS = {
    **dict.fromkeys(("time", *IN_SECONDS), "s"),
    **dict.fromkeys(("ringing_frequency", "split_cutoff"), "Hz"),
    **dict.fromkeys(("smooth_misfit", "split_wave_energy"), "1"),
}
"""SI unit of the figures of a pulse that do not depend on what the channel measures."""
OF_CHANNEL = (
    *("peak", "offset", "noise", "smooth_peak", "peak_uncertainty", "rigid_peak", "rigid_peak_uncertainty"),
    *("split_peak", "split_peak_uncertainty", "peak_expanded_uncertainty"),
)
"""Figures of a pulse in the unit of its channel."""
OF_INTEGRAL = (
    *("velocity_change", "velocity_change_uncertainty", "rigid_velocity_change", "rigid_velocity_change_uncertainty"),
    "velocity_change_expanded_uncertainty",
)
"""Figures of a pulse in that unit times seconds."""
SENSOR_UNITS = {
    **dict.fromkeys(("range", "zero_shift"), "m/s^2"),
    **dict.fromkeys(("resonance", "lowest_resonance", "sampling_rate", "cutoff", "band"), "Hz"),
    **dict.fromkeys(("quality", "peak_left", "width_left", "range_used", "ringing", "noise_ringing"), "1"),
    **{"time_clipped": "s", "sensor_mass": "kg", "density": "kg/m^3", "modulus": "Pa", "area": "m^2", "thickness": "m"},
    "loss_factor": "1",
}
"""Unit of each key of the JSON document that says what a sensor leaves."""


def units_of(files: Sequence[FileReading]) -> dict[str, str]:
    """Return the unit of each key of a document."""
    units = {reading.channel.unit for file in files for reading in file.channels}
    unit = units.pop() if len(units) == 1 else ""
    own = "each channel's unit" if units else OWN
    return {
        **dict.fromkeys(("time", "interval", *IN_SECONDS), "s"),
        **dict.fromkeys((*OF_CHANNEL, "rms", "amplitude", "zero"), unit or own),
        "base_peak": unit or own,
        **dict.fromkeys(("delay", "duration", "decay_time"), "s"),
        **dict.fromkeys(("damping", "damping_uncertainty"), "1"),
        **dict.fromkeys(OF_INTEGRAL, INTEGRALS.get(unit, f"{unit} s") or f"{own}, times s"),
        **dict.fromkeys(
            ("ringing_frequency", "sampling_rate", "advised_cutoff", "frequency", "frequency_uncertainty", "cutoff"),
            "Hz",
        ),
        "lowest_mode": "Hz",
        **dict.fromkeys((*COSTS, "methods_apart"), "1"),
        **dict.fromkeys(("cv", "cv_low", "cv_high", "robust_cv", "cv_with", "ratio", "change", "smooth_misfit"), "1"),
    }
