"""Measured records: read, calibrate, check their health, find pulses, sum up a campaign."""

from strikewave.records.calibration import Calibration, calibrations_beside
from strikewave.records.campaign import Campaign, Statistic, Trend, compare, summed
from strikewave.records.documents import pulse_table, record_document
from strikewave.records.finding import Finding, unreadable, worst
from strikewave.records.measuring import RecordedPulse, find_pulses
from strikewave.records.readers import Options, read_record
from strikewave.records.reading import ChannelReading, FileReading, Request, read_file
from strikewave.records.record import Channel, Record

__all__ = [
    "Calibration",
    "Campaign",
    "Channel",
    "ChannelReading",
    "FileReading",
    "Finding",
    "Options",
    "Record",
    "RecordedPulse",
    "Request",
    "Statistic",
    "Trend",
    "calibrations_beside",
    "compare",
    "find_pulses",
    "pulse_table",
    "read_file",
    "read_record",
    "record_document",
    "summed",
    "unreadable",
    "worst",
]
