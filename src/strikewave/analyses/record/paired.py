"""Two channels of a file as two sensors on one object: which they are, what they do together, its rows and columns."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError
from strikewave.records.measuring import FEWEST
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.records.two_sensors import PairedMotion, Transfer, paired_motion
from strikewave.reporting.columns import Column

Array = NDArray[np.float64]

ALLOWED = "names or numbers of two channels, such as 1,2"
SAME_STEP, SAME_START = 1e-6, 0.05
"""Differences of two steps, over themselves, and of samples of one channel from the nearest of the other, over a step,
up to which channels were sampled together."""
NO_BLOW = "no-pulse"
"""Bad for a channel by itself; one that only swings is still compared with the one that is struck."""
COPIED = ("delay", "delay_uncertainty", "gain", "gain_uncertainty", "explained", "peak_lag")
DIFFERENTIAL = ("differential_peak", "differential_in_band", "differential_share")
PAIR_UNITS = {
    **dict.fromkeys(("delay", "delay_uncertainty", "peak_lag", "common_width"), "s"),
    **dict.fromkeys(("gain", "gain_uncertainty", "explained", "differential_share", "coherence", "h1", "h2"), "1"),
    **dict.fromkeys(("resolution", "trusted_from", "trusted_to", "alike_to"), "Hz"),
    "phase": "rad",
    "magnitude_uncertainty": "1",
}
"""SI unit of each figure of two sensors that does not depend on what they measure."""
OF_CHANNEL = ("common_peak", "common_raw_peak", "common_uncertainty", *DIFFERENTIAL[:2])
"""Figures in the unit of the channels."""


class RecordPair(NamedTuple):
    """Two channels of a file, and what they do together; None where that cannot be compared, with the reason."""

    file: str
    first: ChannelReading | None
    second: ChannelReading | None
    found: PairedMotion | None
    reason: str = ""

    @property
    def one_body(self) -> str:
        """``yes``, ``no`` or ``cannot-tell``."""
        return "cannot-tell" if self.found is None else self.found.one_body

    @property
    def why(self) -> str:
        """Why they are one body, or are not, or why it is undetermined."""
        return self.reason if self.found is None else self.found.reason

    @property
    def leads(self) -> str:
        """Name of the channel that is ahead; empty for neither."""
        ahead = 0 if self.found is None else self.found.leads
        reading = (None, self.first, self.second)[ahead]
        return "" if reading is None else reading.channel.name

    def figures(self) -> dict[str, float]:
        """Return the figures in SI; NaN where there is none."""
        found = self.found
        names = (*COPIED, "common_uncertainty", *DIFFERENTIAL)
        common = None if found is None else found.common
        transfer = None if found is None else found.transfer
        trusted = (math.nan, math.nan) if transfer is None else transfer.trusted
        return {
            "common_peak": math.nan if found is None else found.rigid_peak,
            "common_raw_peak": math.nan if common is None else common.peak,
            "common_width": math.nan if common is None else common.width,
            **{name: math.nan if found is None else float(getattr(found, name)) for name in names},
            "trusted_from": trusted[0],
            "trusted_to": trusted[1],
            "alike_to": math.nan if transfer is None else transfer.alike_to,
        }

    def document(self) -> dict[str, Any]:
        """Return what the JSON document holds."""
        pair = [None if one is None else one.channel.name for one in (self.first, self.second)]
        transfer = None if self.found is None else self.found.transfer
        return {
            "file": self.file,
            "first": pair[0],
            "second": pair[1],
            "one_body": self.one_body,
            "reason": self.why,
            "leads": self.leads or None,
            "blows": 0 if self.found is None else self.found.blows,
            **self.figures(),
            "transfer": None if transfer is None else _transfer(transfer),
        }


def _transfer(one: Transfer) -> dict[str, Any]:
    """Return a transfer function as lists."""
    return {
        "averages": one.averages,
        "resolution": one.resolution,
        "frequency": one.frequency.tolist(),
        "h1": np.abs(one.h1).tolist(),
        "h2": np.abs(one.h2).tolist(),
        "phase": np.angle(one.h1).tolist(),
        "coherence": one.coherence.tolist(),
        "magnitude_uncertainty": (one.uncertainty * np.abs(one.h1)).tolist(),
    }


def read_pair(word: str, field: str = "--pair") -> tuple[str, str]:
    """Return the two channels that a pair names.

    Raises
    ------
    InputError
        If they are not two.

    Examples
    --------
    >>> read_pair("1,2"), read_pair("left , right")
    (('1', '2'), ('left', 'right'))
    """
    names = [name.strip() for name in word.split(",")]
    if len(names) != 2 or not all(names) or names[0] == names[1]:
        raise InputError(field, word, ALLOWED)
    return names[0], names[1]


def all_pairs(files: Sequence[FileReading], pair: tuple[str, str], field: str = "--pair") -> list[RecordPair]:
    """Return what two channels of each file do together.

    Raises
    ------
    InputError
        If no file has both.
    """
    found = [_paired(file, pair) for file in files if file.channels]
    if found and all(one.first is None or one.second is None for one in found):
        names = [reading.channel.name for file in files[:1] for reading in file.channels]
        raise InputError(field, ",".join(pair), ALLOWED, f"{files[0].path} has {len(names)}: {', '.join(names[:40])}")
    return found


def _paired(file: FileReading, pair: tuple[str, str]) -> RecordPair:
    first, second = (
        next((one for one in file.channels if name in (str(one.number), one.channel.name)), None) for name in pair
    )
    if first is None or second is None:
        missing = pair[0] if first is None else pair[1]
        return RecordPair(file.path, first, second, None, f"there is no channel {missing}")
    reason = _not_together(first, second)
    blows = first.pulses or second.pulses
    if not reason and not blows:
        reason = "there is no blow in either channel"
    if reason:
        return RecordPair(file.path, first, second, None, reason)
    a, b = first.channel, second.channel
    later = round((b.start - a.start) / a.step)
    skipped = max(later, 0), max(-later, 0)
    size = min(a.values.size - skipped[0], b.values.size - skipped[1])
    both = [one.values[skip : skip + size] for one, skip in zip((a, b), skipped, strict=True)]
    start = a.start + skipped[0] * a.step
    blows = tuple(blow for blow in blows if blow.end > start and blow.begin < start + size * a.step)
    if not blows:
        return RecordPair(file.path, first, second, None, "there is no blow while both channels record")
    return RecordPair(file.path, first, second, paired_motion(both[0], both[1], a.step, blows, start))


def _not_together(first: ChannelReading, second: ChannelReading) -> str:
    """Return why two channels cannot be compared; empty where they can."""
    a, b = first.channel, second.channel
    if a.unit != b.unit:
        return f"{a.name} is in {a.unit or 'an unknown unit'}, {b.name} in {b.unit or 'an unknown unit'}"
    later = (b.start - a.start) / a.step
    if not (abs(a.step - b.step) <= SAME_STEP * a.step and abs(later - round(later)) <= SAME_START):
        return f"{a.name} and {b.name} were not sampled at the same times"
    overlap = min(a.values.size, b.values.size + round(later)) - max(0, round(later))
    if overlap < FEWEST:
        return f"{a.name} and {b.name} have only {max(overlap, 0)} samples at the same times"
    for reading in (first, second):
        bad = next((one for one in reading.findings if one.severity == "bad" and one.code != NO_BLOW), None)
        if bad is not None:
            return f"{reading.channel.name} is bad: {bad.message}"
    return ""


def pair_columns(pairs: Sequence[RecordPair]) -> list[Column]:
    """Return the figures, a line a file."""
    units = {one.first.channel.unit for one in pairs if one.first is not None}
    unit = units.pop() if len(units) == 1 else ""
    columns = [
        Column("file", [one.file for one in pairs]),
        Column("one_body", [one.one_body for one in pairs]),
        Column("leads", [one.leads for one in pairs]),
    ]
    rows = [one.figures() for one in pairs]
    for name in rows[0] if rows else ():
        si = unit if name in OF_CHANNEL else PAIR_UNITS[name]
        columns.append(Column(name, [row[name] for row in rows], si))
    return columns


def transfer_columns(pairs: Sequence[RecordPair]) -> list[Column]:
    """Return the transfer functions under one another, each line with its file."""
    known = [(one.file, one.found.transfer) for one in pairs if one.found is not None and one.found.transfer]

    def joined(name: str) -> Array:
        parts = [np.asarray(_transfer(transfer)[name]) for _, transfer in known]
        return np.concatenate(parts) if parts else np.empty(0)

    columns = [Column("file", [file for file, transfer in known for _ in transfer.frequency])]
    columns.append(Column("frequency", joined("frequency"), "Hz"))
    names = ("h1", "h2", "phase", "coherence", "magnitude_uncertainty")
    return columns + [Column(name, joined(name), PAIR_UNITS[name]) for name in names]
