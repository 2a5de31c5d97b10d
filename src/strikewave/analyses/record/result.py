"""Readings and campaigns as JSON documents and tables."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from typing import Any

from strikewave.base.json_document import head, plain
from strikewave.records.campaign import Campaign
from strikewave.records.finding import Finding
from strikewave.records.measuring import RecordedPulse
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.signal.filters import Filter, advised_cutoff, effect_on_half_sine
from strikewave.signal.pulse import HALF_SINE_WIDTH

INTEGRALS = {"m/s^2": "m/s", "m/s": "m", "N": "N s", "Pa": "Pa s", "V": "V s", "1": "s", "": ""}
"""Unit of the integral over time of each unit."""
OWN = "as in the file"
"""Stands for the unit of figures whose file does not say it."""


def record_document(
    files: Sequence[FileReading], campaigns: Sequence[Campaign], filter_: Filter | None
) -> dict[str, Any]:
    """Return the JSON document of records.

    Parameters
    ----------
    files : sequence of FileReading
        In the order given.
    campaigns : sequence of Campaign
        One a channel; the first stands under ``campaign``.
    filter_ : Filter or None
        What was applied before measuring.
    """
    document = {
        **head(units_of(files), warnings_of(files)),
        "files": [_file(file, filter_) for file in files],
        "campaign": _campaign(campaigns[0]) if campaigns else {},
    }
    if len(campaigns) > 1:
        document["campaigns"] = [_campaign(one) for one in campaigns]
    return dict(plain(document))


def units_of(files: Sequence[FileReading]) -> dict[str, str]:
    """Return the unit of each key of a document."""
    units = {reading.channel.unit for file in files for reading in file.channels}
    unit = units.pop() if len(units) == 1 else ""
    own = "each channel's unit" if units else OWN
    return {
        **dict.fromkeys(("time", "rise", "width", "interval", "begin", "end", "smooth_width"), "s"),
        **dict.fromkeys(("peak", "offset", "noise", "smooth_peak"), unit or own),
        "velocity_change": INTEGRALS.get(unit, f"{unit} s") or f"{own}, times s",
        **dict.fromkeys(("ringing_frequency", "sampling_rate", "advised_cutoff", "cutoff"), "Hz"),
        **dict.fromkeys(("cv", "cv_low", "cv_high", "change", "smooth_misfit"), "1"),
    }


def warnings_of(files: Sequence[FileReading]) -> list[dict[str, Any]]:
    """Return what holds for all files, each word once."""
    found: dict[str, tuple[Finding, int]] = {}
    for file in files:
        for code in {f.code for f in file.all_findings if f.code in ("unit-unknown", "not-calibrated", "unreadable")}:
            first = next(f for f in file.all_findings if f.code == code)
            found[code] = (found[code][0] if code in found else first, found.get(code, (first, 0))[1] + 1)
    return [
        {
            "code": code,
            "message": f.message if count == 1 else f"{f.message} ({count} files)",
            "value": count,
            "limit": 0,
        }
        for code, (f, count) in found.items()
    ]


def _file(file: FileReading, filter_: Filter | None) -> dict[str, Any]:
    return {
        "file": file.path,
        "format": file.format,
        "status": file.status,
        "reasons": file.reasons,
        "health": [finding_row(f) for f in file.findings],
        "channels": [_channel(reading, filter_) for reading in file.channels],
    }


def finding_row(finding: Finding) -> dict[str, Any]:
    """Return a finding as a row."""
    return {**finding._asdict(), "harms": list(finding.harms)}


def _channel(reading: ChannelReading, filter_: Filter | None) -> dict[str, Any]:
    channel = reading.channel
    return {
        "name": channel.name,
        "number": reading.number,
        "sampling_rate": channel.sampling_rate,
        "samples": channel.values.size,
        "unit": channel.unit or None,
        "status": reading.status,
        "calibration": reading.calibration.stated(),
        "health": [finding_row(f) for f in reading.findings],
        "pulses": [pulse_row(pulse) for pulse in reading.pulses],
        "advised_cutoff": cutoff_for(reading),
        "filter": None if filter_ is None else filter_effect(reading, filter_),
    }


def pulse_row(pulse: RecordedPulse) -> dict[str, Any]:
    """Return a pulse as a row."""
    names = ("time", "peak", "rise", "width", "velocity_change", "ringing_frequency", "offset", "noise", "method")
    row = {name: getattr(pulse, name) for name in (*names, "begin", "end")}
    return {
        **row,
        "smooth_peak": pulse.smooth.peak,
        "smooth_width": pulse.smooth.width(),
        "smooth_misfit": pulse.smooth.misfit,
    }


def cutoff_for(reading: ChannelReading) -> float | None:
    """Return the cutoff advised for the steepest blow, Hz; None where there is none, or it cannot be reached."""
    advised = [
        advised_cutoff(pulse.smooth.rise(), pulse.smooth.width())
        for pulse in reading.unfiltered or reading.pulses
        if pulse.smooth.width() > 0.0
    ]
    cutoff = max(advised, default=math.inf)
    return cutoff if cutoff < 0.5 * reading.channel.sampling_rate else None


def filter_effect(reading: ChannelReading, filter_: Filter) -> dict[str, Any]:
    """Return what a filter did to the peaks and widths of a channel, and what it does to a half-sine as wide."""
    widths = [pulse.width for pulse in reading.unfiltered if pulse.width > 0.0]
    pairs = list(zip(reading.unfiltered, reading.pulses, strict=False))
    same = pairs if len(reading.unfiltered) == len(reading.pulses) else []
    effect = effect_on_half_sine(filter_, min(widths) / HALF_SINE_WIDTH) if widths else None
    return {
        "name": str(filter_),
        "cutoff": filter_.half_power(reading.channel.step),
        "peak_left": [after.peak / before.peak for before, after in same],
        "width_left": [after.width / before.width for before, after in same],
        "half_sine_peak_left": None if effect is None else effect.peak,
        "half_sine_width_left": None if effect is None else effect.width,
    }


def _campaign(campaign: Campaign) -> dict[str, Any]:
    return {
        "channel": campaign.channel,
        **{name: value._asdict() for name, value in campaign.statistics.items()},
        "trend": {name: value._asdict() for name, value in campaign.trends.items()},
        "left_out": [
            {"file": path, "figures": list(figures), "reason": reason} for path, figures, reason in campaign.left_out
        ],
    }


def pulse_table(files: Sequence[FileReading]) -> str:
    """Return all pulses as CSV, in SI, one line a pulse."""
    text = io.StringIO()
    rows = [
        {"file": file.path, "channel": reading.channel.name, "unit": reading.channel.unit, "status": reading.status}
        | {"index": k}
        | pulse_row(pulse)
        for file in files
        for reading in file.channels
        for k, pulse in enumerate(reading.pulses, start=1)
    ]
    names = ["file", "channel", "unit", "status", "index", "time", "peak", "rise", "width", "velocity_change"]
    names += ["ringing_frequency", "offset", "noise", "method", "begin", "end"]
    names += ["smooth_peak", "smooth_width", "smooth_misfit"]
    writer = csv.DictWriter(text, names, lineterminator="\n")
    writer.writeheader()
    for row in rows:
        writer.writerow({k: _cell(v) for k, v in row.items()})
    return text.getvalue()


def _cell(value: Any) -> Any:
    """Return a value fit for a spreadsheet: no text that it would run as a formula."""
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else ""
    return f"'{value}" if isinstance(value, str) and value[:1] in "=+-@\t\r" else value
