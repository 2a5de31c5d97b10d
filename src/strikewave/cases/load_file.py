"""A measured load from any file the records room reads: force, or speed or acceleration of the face, over time."""

from __future__ import annotations

import numpy as np
import scipy

from strikewave.base.errors import InputError
from strikewave.records import Channel, Options, read_record
from strikewave.records.calibration import known_unit
from strikewave.waves import Sampled

FORCE, SPEED, ACCELERATION = "N", "m/s", "m/s^2"


def read_load(path: str) -> Sampled:
    """Read a load from the first channel of a file; time may be uneven.

    A channel without a unit is a force in N. One in m/s or m/s^2 is the speed or acceleration of the face, which
    is at rest at the first sample.

    Raises
    ------
    InputError
        If the file cannot be read, has no time, or its first channel is no such quantity.
    """
    try:
        channel = _first(path)
    except InputError as error:
        raise InputError("load.file", path if error.got == path else error.got, error.allowed, error.hint) from None
    time = channel.stamps if channel.stamps is not None else channel.time
    if not np.all(np.isfinite(time)):
        raise InputError("load.file", path, "a file with time", 'a first column such as "time [us]"')
    unit, factor = (FORCE, 1.0) if not channel.unit else known_unit(channel.unit) or ("", 1.0)
    if unit not in (FORCE, SPEED, ACCELERATION):
        allowed = "a force, a speed or an acceleration as the first channel"
        raise InputError("load.file", channel.unit, allowed, 'name its unit, such as "force [kN]"')
    values = channel.values * factor
    if unit == ACCELERATION:
        values, unit = scipy.integrate.cumulative_trapezoid(values, time, initial=0.0), SPEED
    try:
        return Sampled(time, values, "force" if unit == FORCE else "speed", bool(channel.unit))
    except ValueError as error:
        raise InputError("load.file", path, "times that rise and finite values", str(error)) from None


def _first(path: str) -> Channel:
    record = read_record(path)
    if record.format == "text" and record.channels and record.channels[0].stamps is None:
        record = read_record(path, Options(time="1"))
    if not record.channels:
        raise InputError("load.file", path, "a file with time and one channel")
    return record.channels[0]
