"""The range of sensor, amplifier and recorder: clipped records, flat tops, and a limited slope."""

from strikewave.records.health.range.clipping import clipped, rail
from strikewave.records.health.range.limits import limited

__all__ = ["clipped", "limited", "rail"]
