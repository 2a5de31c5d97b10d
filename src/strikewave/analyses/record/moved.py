"""Velocity and displacement of a record, and how far they drift."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import declarations
from strikewave.base.shock_quantities import LENGTH, SECONDS, VELOCITY
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.reporting.columns import Column
from strikewave.signal.motion import IntegratedMotion, motion

Array = NDArray[np.float64]


@declare.dataclass
class MotionRow:
    """Where a motion ends, and how well that is known."""

    file: str = declare.word("measured file")
    channel: str = declare.word("channel")
    begin: float = declare.number(SECONDS, "first sample")
    end: float = declare.number(SECONDS, "last sample")
    velocity: float = declare.number(VELOCITY, "velocity at the end")
    displacement: float = declare.number(LENGTH, "displacement at the end")
    velocity_drift: float = declare.number(VELOCITY, "what is not known of that velocity")
    displacement_drift: float = declare.number(LENGTH, "what is not known of that displacement")
    lost: float = declare.number(SECONDS, "from when on the drift exceeds the displacement")


class RecordMotion(NamedTuple):
    """What the base of a channel did from just before its first blow on, from rest.

    Attributes
    ----------
    file, channel : str
        Of what.
    time : ndarray
        Of the samples, s.
    motion : IntegratedMotion
        Velocity and displacement, with the standard deviations of their drift.
    """

    file: str
    channel: str
    time: Array
    motion: IntegratedMotion

    @property
    def lost(self) -> float:
        """Time from which on the drift exceeds the displacement, to the end; NaN where the end is better known."""
        known = np.flatnonzero(np.abs(self.motion.displacement) > self.motion.displacement_drift)
        after = int(known[-1]) + 1 if known.size else 0
        return float(self.time[after]) if after < self.time.size else math.nan

    @property
    def row(self) -> MotionRow:
        """Where it ends."""
        ends = {name: float(values[-1]) for name, values in self.motion._asdict().items()}
        return MotionRow(self.file, self.channel, float(self.time[0]), float(self.time[-1]), **ends, lost=self.lost)


def moved(file: str, reading: ChannelReading) -> RecordMotion | None:
    """Return the motion of a channel; None where it is no acceleration, or has no blow.

    The zero is that before the first blow. It is uncertain by what the mean over a width wanders there, over the root
    of the widths that it is taken from; noise of that wander adds up over the record.
    """
    if reading.channel.unit != "m/s^2" or not reading.pulses:
        return None
    channel, pulse = reading.channel, reading.pulses[0]
    length = pulse.end - pulse.begin
    first = max(math.floor((pulse.begin - length - channel.start) / channel.step), 0)
    values = channel.values[first:] - pulse.offset
    if values.size < 2:
        return None
    wander, widths = pulse.baseline.wander, max(pulse.baseline.widths, 1)
    samples = max((pulse.width if pulse.width > 0.0 else length) / channel.step, 1.0)
    white = pulse.noise / math.sqrt(samples)
    wander = max(wander, white) if math.isfinite(wander) else white
    found = motion(values, channel.step, wander / math.sqrt(widths), wander * math.sqrt(samples))
    return RecordMotion(file, channel.name, channel.time[first:], found)


def all_moved(files: Sequence[FileReading]) -> list[RecordMotion]:
    """Return the motion of all channels that have one."""
    found = (moved(file.path, reading) for file in files for reading in file.channels)
    return [one for one in found if one is not None]


def motion_columns(found: Sequence[RecordMotion]) -> list[Column]:
    """Return histories under one another, each line with its file and channel."""
    columns = [
        Column("file", [one.file for one in found for _ in one.time]),
        Column("channel", [one.channel for one in found for _ in one.time]),
        Column("time", np.concatenate([one.time for one in found]) if found else [], "s"),
    ]
    for name in IntegratedMotion._fields:
        values: Array = np.concatenate([getattr(one.motion, name) for one in found] or [np.empty(0)])
        columns.append(Column(name, values, declarations(MotionRow)[name].quantity.si))
    return columns
