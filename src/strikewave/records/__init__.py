"""Measured records: read, calibrate, check their health, find pulses, sum up a campaign."""

from strikewave.records.finding import Finding, worst
from strikewave.records.readers import Options, read_record
from strikewave.records.record import Channel, Record

__all__ = ["Channel", "Finding", "Options", "Record", "read_record", "worst"]
