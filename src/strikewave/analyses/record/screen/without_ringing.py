"""Pulses without their ringing, beside those with it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from strikewave.analyses.record.screen.kit import mean_of, print_table, value_text
from strikewave.analyses.record.tables import rows_of
from strikewave.base.shock_quantities import FREQUENCY, PULSE_WIDTH
from strikewave.records import FileReading
from strikewave.records.band_split import BandSplit
from strikewave.records.measuring import RecordedPulse
from strikewave.records.ringing import RigidPulse
from strikewave.reporting.layout import MORE, keys, numerals, texts
from strikewave.reporting.numbers import percent
from strikewave.reporting.terminal import number, tell


def print_without_ringing(readings: Sequence[FileReading], names: Mapping[str, str]) -> None:
    """Print the pulses without ringing beside those with it, where they differ by more than 5 %."""
    rows = []
    for file, reading in rows_of(readings):
        pulses = [pulse for pulse in reading.pulses if pulse.rigid is not None or pulse.split is not None]
        if any(pulse.differs_without_ringing or pulse.differs_by_split for pulse in pulses):
            rows.append([names[file.path], reading.channel.name, *_figures(pulses, reading.channel.unit)])
    if rows:
        columns = [*keys("file"), *texts("channel"), *numerals("peak", "uncertainty", "by band split")]
        columns += [*numerals("of that", priority=MORE), *numerals("with ringing")]
        columns += numerals(
            *("pulse width at 10 % (us)", "ringing (Hz)", "cutoff of the split (Hz)", "apart (uncertainties)"),
            priority=MORE,
        )
        print_table("Without ringing", columns, rows)
    _print_overlapping(readings, names)


def _figures(pulses: Sequence[RecordedPulse], unit: str) -> list[str]:
    """Return the means of pulses without ringing: by fit and by band split, and how far these lie apart."""
    raw = mean_of([pulse.peak for pulse in pulses])
    joint = [pulse.rigid for pulse in pulses if pulse.rigid is not None]
    split = [pulse.split for pulse in pulses if pulse.split is not None and pulse.split.separable]
    best = mean_of([one.peak for one in joint or split])
    return [
        *_peak_of(joint, unit),
        *(_peak_of(split, unit) if split else ("not separable", "-")),
        percent(raw / best - 1.0, 1, "+"),
        number(mean_of([one.width for one in joint or split]), *PULSE_WIDTH.units),
        number(mean_of([one.frequency for one in joint]), *FREQUENCY.units),
        number(mean_of([one.cutoff for one in split]), *FREQUENCY.units),
        _times(mean_of([pulse.methods_apart for pulse in pulses])),
    ]


def _print_overlapping(readings: Sequence[FileReading], names: Mapping[str, str]) -> None:
    """Say of how many blows the rigid part can be separated neither way, and why of the first."""
    overlapping = [
        (names[file.path], reading.channel.name, pulse.split.reason)
        for file, reading in rows_of(readings)
        for pulse in reading.pulses
        if pulse.rigid is None and pulse.split is not None and not pulse.split.separable
    ]
    if overlapping:
        name, channel, reason = overlapping[0]
        several = len(overlapping) > 1
        blows = f"{len(overlapping)} blows that ring" if several else "the blow that rings"
        first = f" (the first: {name}, {channel})" if several else ""
        tell(f"the rigid part of {blows} cannot be separated: {reason}{first}")


def _peak_of(found: Sequence[RigidPulse | BandSplit], unit: str) -> tuple[str, str]:
    """Return the mean peak without ringing, and its standard uncertainty over it."""
    peak, doubt = mean_of([one.peak for one in found]), mean_of([one.peak_uncertainty for one in found])
    return value_text(peak, unit), "-" if math.isnan(peak) else percent(doubt / abs(peak))


def _times(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.2g}"
