"""Measured records: read, calibrate, check their health, find pulses, sum up a campaign."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from strikewave.records.calibration import ChannelCalibration, calibrations_beside
    from strikewave.records.campaign import Campaign, Statistic, Trend, compare, summed
    from strikewave.records.health_notice import HealthNotice, unreadable, worst
    from strikewave.records.measuring import RecordedPulse, find_pulses
    from strikewave.records.readers import Options, read_measurements, read_record
    from strikewave.records.reading import ChannelReading, FileReading, Request, read_file, repeats
    from strikewave.records.record import Channel, Record
    from strikewave.records.sample_store import SampleStore

_ROOMS = {
    "calibration": ("ChannelCalibration", "calibrations_beside"),
    "campaign": ("Campaign", "Statistic", "Trend", "compare", "summed"),
    "health_notice": ("HealthNotice", "unreadable", "worst"),
    "measuring": ("RecordedPulse", "find_pulses"),
    "readers": ("Options", "read_measurements", "read_record"),
    "reading": ("ChannelReading", "FileReading", "Request", "read_file", "repeats"),
    "record": ("Channel", "Record"),
    "sample_store": ("SampleStore",),
}
_HOMES = {name: room for room, names in _ROOMS.items() for name in names}

__all__ = [
    "Campaign",
    "Channel",
    "ChannelCalibration",
    "ChannelReading",
    "FileReading",
    "HealthNotice",
    "Options",
    "Record",
    "RecordedPulse",
    "Request",
    "SampleStore",
    "Statistic",
    "Trend",
    "calibrations_beside",
    "compare",
    "find_pulses",
    "read_file",
    "read_measurements",
    "read_record",
    "repeats",
    "summed",
    "unreadable",
    "worst",
]


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used: a process that only reads a file needs no compiled kernels."""
    if name in _HOMES:
        return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
