"""Two channels of a file as two sensors on one object: which they are, what they do together, its rows and columns."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.record.options import TWO_CHANNELS
from strikewave.analyses.record.rows import units_given
from strikewave.base import declare
from strikewave.base.declare import NO_UNIT, GivenUnits, declarations
from strikewave.base.errors import InputError
from strikewave.base.shock_quantities import FREQUENCY, MICROSECONDS, OF_CHANNEL, RATIO
from strikewave.records.measuring import FEWEST
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.records.two_sensors import PairedMotion, Transfer, paired_motion
from strikewave.reporting.columns import Column

Array = NDArray[np.float64]

# Differences of two steps, over themselves, and of samples of one channel from the nearest of the other, over a step,
# up to which channels were sampled together
SAME_STEP, SAME_START = 1e-6, 0.05
NO_BLOW = "no-pulse"  # bad for a channel by itself; one that only swings is still compared with the one that is struck
# Numbers of a row that are those of the motion itself
COPIED = (
    *("delay", "delay_uncertainty", "gain", "gain_uncertainty", "explained", "peak_lag", "common_uncertainty"),
    *("differential_peak", "differential_in_band", "differential_share"),
)
WORDS_OF_TABLE = ("file", "one_body", "leads")  # words of a pair that its table of files has beside the numbers


@declare.dataclass
class TransferRow:
    """A transfer function."""

    averages: int = declare.count("blows that it is the mean of")
    resolution: float = declare.number(FREQUENCY, "its resolution")
    frequency: Array = declare.history("Hz", "frequencies")
    h1: Array = declare.history(NO_UNIT, "magnitude, by the estimator that noise in the second bends least")
    h2: Array = declare.history(NO_UNIT, "magnitude, by the estimator that noise in the first bends least")
    phase: Array = declare.history("rad", "phase")
    coherence: Array = declare.history(NO_UNIT, "coherence")
    magnitude_uncertainty: Array = declare.history(NO_UNIT, "standard uncertainty of the magnitude")

    @classmethod
    def of(cls, one: Transfer) -> TransferRow:
        """Return a transfer function in magnitude and phase."""
        return cls(
            one.averages,
            one.resolution,
            one.frequency,
            np.abs(one.h1),
            np.abs(one.h2),
            np.angle(one.h1),
            one.coherence,
            one.uncertainty * np.abs(one.h1),
        )


@declare.dataclass
class PairRow:
    """Two channels of a file as two sensors on one object: what they do together, nothing where it is not known."""

    file: str = declare.word("measured file")
    first: str | None = declare.word("name of the first channel; null where there is none")
    second: str | None = declare.word("name of the second channel")
    one_body: str = declare.word("yes, no or cannot-tell")
    reason: str = declare.word("why")
    leads: str | None = declare.word("channel that is ahead; null for neither")
    blows: int = declare.count("blows that delay, gain and transfer function are means of")
    common_peak: float = declare.number(OF_CHANNEL, "peak of the common motion, without its ringing")
    common_raw_peak: float = declare.number(OF_CHANNEL, "the same with its ringing")
    common_width: float = declare.number(MICROSECONDS, "width of the common motion")
    delay: float = declare.number(MICROSECONDS, "of the second after the first; null where it is no delayed copy")
    delay_uncertainty: float = declare.number(MICROSECONDS, "its standard uncertainty")
    gain: float = declare.number(RATIO, "second over first; null where it is no delayed copy")
    gain_uncertainty: float = declare.number(RATIO, "its standard uncertainty")
    explained: float = declare.number(RATIO, "share of the energy of the second that delay and gain explain")
    peak_lag: float = declare.number(MICROSECONDS, "from the peak of the first to that of the second")
    common_uncertainty: float = declare.number(OF_CHANNEL, "standard uncertainty of the common peak")
    differential_peak: float = declare.number(OF_CHANNEL, "largest value of half the difference, with its sign")
    differential_in_band: float = declare.number(OF_CHANNEL, "its largest magnitude in the band of the common pulse")
    differential_share: float = declare.number(RATIO, "root mean square of the differential over that of the common")
    trusted_from: float = declare.number(FREQUENCY, "from where the transfer function is trusted")
    trusted_to: float = declare.number(FREQUENCY, "up to where")
    alike_to: float = declare.number(FREQUENCY, "up to where both move alike")
    transfer: TransferRow | None = declare.part(TransferRow, "null where no blow is long enough")
    unit: str = ""

    @property
    def given_units(self) -> GivenUnits:
        """Those of its channels."""
        return units_given(self.unit)


# Columns of pairs.csv
PAIR_COLUMNS = tuple(
    name for name, one in declare.declarations(PairRow).items() if one.kind == "number" or name in WORDS_OF_TABLE
)


@dataclass(frozen=True)
class RecordPair:
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

    @functools.cached_property
    def row(self) -> PairRow:
        """Its figures in SI; NaN where there is none."""
        found, nothing = self.found, math.nan
        common = None if found is None else found.common
        transfer = None if found is None else found.transfer
        trusted = (nothing, nothing) if transfer is None else transfer.trusted
        return PairRow(
            file=self.file,
            first=None if self.first is None else self.first.channel.name,
            second=None if self.second is None else self.second.channel.name,
            one_body=self.one_body,
            reason=self.why,
            leads=self.leads or None,
            blows=0 if found is None else found.blows,
            common_peak=nothing if found is None else found.rigid_peak,
            common_raw_peak=nothing if common is None else common.peak,
            common_width=nothing if common is None else common.width,
            **{name: nothing if found is None else float(getattr(found, name)) for name in COPIED},
            trusted_from=trusted[0],
            trusted_to=trusted[1],
            alike_to=nothing if transfer is None else transfer.alike_to,
            transfer=None if transfer is None else TransferRow.of(transfer),
            unit="" if self.first is None else self.first.channel.unit,
        )


def all_pairs(files: Sequence[FileReading], pair: tuple[str, str], field: str = "--pair") -> list[RecordPair]:
    """Return what two channels of each file do together."""
    found = [_paired(file, pair) for file in files if file.channels]
    if found and all(one.first is None or one.second is None for one in found):
        names = [reading.channel.name for file in files[:1] for reading in file.channels]
        raise InputError(
            field, ",".join(pair), TWO_CHANNELS, f"{files[0].path} has {len(names)}: {', '.join(names[:40])}"
        )
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


def transfer_columns(pairs: Sequence[RecordPair]) -> list[Column]:
    """Return the transfer functions under one another, each line with its file."""
    known = [(one.file, one.row.transfer) for one in pairs if one.row.transfer is not None]
    columns = [Column("file", [file for file, transfer in known for _ in transfer.frequency])]
    for name, one in declarations(TransferRow).items():
        if one.kind == "history":
            values = np.concatenate([getattr(transfer, name) for _, transfer in known] or [np.empty(0)])
            columns.append(Column(name, values, one.quantity.si))
    return columns
