"""Sensors of records: two on one object, and one that the blows are tried on."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.record.options import TWO_CHANNELS
from strikewave.analyses.record.rows import advised_filter, units_given
from strikewave.base import declare
from strikewave.base.declare import NO_UNIT, GivenUnits, Quantity, declarations
from strikewave.base.errors import InputError
from strikewave.base.result import INFO, WARNING, Notice
from strikewave.base.shock_quantities import (
    ACCELERATION,
    BANDWIDTH,
    FREQUENCY,
    LENGTH,
    MASS,
    MICROSECONDS,
    OF_CHANNEL,
    RATIO,
    SECONDS,
)
from strikewave.records.measuring import FEWEST, RecordedPulse
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.records.record import Channel
from strikewave.records.two_sensors import PairedMotion, Transfer, paired_motion
from strikewave.reporting.columns import Column
from strikewave.reporting.faces import amount
from strikewave.sensors.trial import NOISE, TAKES, SensorTrial, lowest_resonance, try_sensor
from strikewave.signal.filters import Filter

if TYPE_CHECKING:
    from strikewave.cases.stack_of_case import StatedSensor

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
        size, doubt = np.abs(one.h1), one.uncertainty * np.abs(one.h1)
        estimates = (size, np.abs(one.h2), np.angle(one.h1))
        return cls(one.averages, one.resolution, one.frequency, *estimates, one.coherence, doubt)


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
        """Units of its channels."""
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
        """Reason why they are one body or not, or why it is undetermined."""
        return self.reason if self.found is None else self.found.reason

    @property
    def leads(self) -> str:
        """Name of the channel that is ahead; empty for neither."""
        ahead = 0 if self.found is None else self.found.leads
        reading = (None, self.first, self.second)[ahead]
        return "" if reading is None else reading.channel.name

    @functools.cached_property
    def row(self) -> PairRow:
        """Figures in SI; NaN where there is none."""
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


# Lengths of a blow that are tried before and after it, and periods of the lowest resonance if they are longer: the
# noise before, and what still swings after
BEFORE, AFTER, PERIODS = 2.0, 2.0, 2.0

UNKNOWN = "not known: "  # begin of a verdict by which a blow neither fits nor does not
# Data that a file may leave out, with why no blow then is known to fit, and what to add
LACKS = {
    "range": 'whether a blow exceeds it is not known; add range = "20000 g", or that of its data sheet',
    "resonance": "how much a blow makes it ring, and what that leaves of peak and width, is not known; add "
    'resonance = "80 kHz", or that of its data sheet (quality too, if it is damped)',
}
# Highest low-pass that is advised, over the resonance: a motion so slow is magnified by 7 %, noise there no more
OF_RESONANCE = 0.25


@declare.dataclass
class TriedBlow:
    """One blow on the sensor: where it stands, and what is left of it."""

    file: str = declare.word("measured file")
    channel: str = declare.word("channel of it")
    blow: int = declare.count("its number, from 1")
    time: float = declare.number(SECONDS, "of its peak")
    doubted: bool = declare.word("whether a finding harms the peak of the record itself")
    trial: SensorTrial = declare.part(SensorTrial, "what the sensor leaves", inline=True)


@declare.dataclass
class GasketRow:
    """A layer between surface and sensor."""

    density: float = declare.number(Quantity("kg/m^3", "kg/m^3"), "its density")
    modulus: float = declare.number(Quantity("Pa", "MPa"), "its storage modulus")
    area: float = declare.number(Quantity("m^2", "mm^2"), "its area")
    thickness: float = declare.number(LENGTH, "its thickness")
    loss_factor: float = declare.number(RATIO, "its loss factor")


@declare.dataclass
class RecorderRow:
    """Recorder of the signal of the sensor."""

    sampling_rate: float = declare.number(FREQUENCY, "of its recorder")
    cutoff: float = declare.number(FREQUENCY, "of the filter of the recorder")
    order: int = declare.count("poles of that filter")
    bits: int = declare.count("of the recorder; 0 for none")


@declare.dataclass
class SensorRow:
    """A sensor, and whether it can take the blows of records."""

    name: str = declare.word("by the option sensor: the sensor")
    model: str | None = declare.word("its row in the table of accelerometers; null of one of your own")
    range: float = declare.number(ACCELERATION, "its range")
    resonance: float = declare.number(FREQUENCY, "its resonance")
    quality: float = declare.number(RATIO, "quality factor of that")
    zero_shift: float = declare.number(ACCELERATION, "its zero shift after a shock")
    sensor_mass: float = declare.number(MASS, "its mass on gaskets")
    gaskets: list[GasketRow] = declare.rows(GasketRow, "gaskets under it")
    lowest_resonance: float = declare.number(FREQUENCY, "lowest resonance with its mounting")
    recorder: RecorderRow = declare.part(RecorderRow, "its recorder")
    source: str | None = declare.word("where its numbers come from")
    status: str = declare.word("how they are known")
    note: str | None = declare.word("what is said of it")
    band: float = declare.number(FREQUENCY, "highest frequency that the records hold")
    takes: bool | None = declare.word("whether it can take all blows")
    blows: tuple[TriedBlow, ...] = declare.rows(TriedBlow, "each blow on it")


@dataclass(frozen=True)
class SensorTrials:
    """All blows on one sensor."""

    stated: StatedSensor  # the sensor, its recorder, and where the numbers come from
    # Highest frequency that the records hold, Hz: half the lowest sampling rate, or the cutoff of their low-pass
    band: float
    blows: tuple[TriedBlow, ...]  # in the order of the files
    # Low-pass that takes off the noise by which blows are not known to fit, and leaves these, Hz; NaN for none
    low_pass: float = math.nan

    @property
    def resonance(self) -> float:
        """Lowest resonance of sensor and mounting, Hz."""
        return lowest_resonance(self.stated.sensor)

    @property
    def takes(self) -> bool | None:
        """True if the sensor can take every blow; None where none is beyond it and some are unknown."""
        others = [blow.trial.verdict for blow in self.blows if blow.trial.verdict != TAKES]
        if not self.blows or (others and all(verdict.startswith(UNKNOWN) for verdict in others)):
            return None
        return not others

    @property
    def called(self) -> str:
        """Name of the sensor, and the row of the table that it is."""
        model, name = self.stated.model, self.stated.sensor.name
        return name if model is None or model.name == name else f"{name} ({model.name})"

    @property
    def notices(self) -> list[Notice]:
        """Return what the user should know: numbers from memory, blows that it cannot take, what is not known."""
        notices = list(self.stated.notices)
        for key in lacking(self.stated):
            notices.append(
                Notice("sensor-incomplete", f"{self.called} states no {key}: {LACKS[key]}", severity=WARNING)
            )
        failed = sum(blow.trial.verdict != TAKES for blow in self.blows)
        if failed:
            message = self.sentence().rstrip(".")
            if math.isfinite(self.low_pass):
                cutoff = amount(BANDWIDTH, self.low_pass)
                message += f'; --filter "{cutoff}" takes that noise off and leaves the blows'
            notices.append(Notice("sensor-trial", message, float(failed), 0.0))
        if self.band < self.resonance < math.inf:
            resonance, band = (amount(BANDWIDTH, value) for value in (self.resonance, self.band))
            message = (
                f"the resonance of {self.called}, {resonance}, lies above what the records hold, {band}: "
                "whether faster motion excites it they cannot tell"
            )
            notices.append(Notice("sensor-beyond-band", message, self.resonance, self.band, INFO))
        return notices

    @property
    def row(self) -> SensorRow:
        """Row that screens, pages and documents show."""
        sensor, recorder, model = self.stated.sensor, self.stated.recorder, self.stated.model
        known = ("range", "resonance", "quality", "zero_shift")
        keys = ("sampling_rate", "cutoff", "order", "bits")
        return SensorRow(
            name=sensor.name,
            model=None if model is None else model.name,
            **{name: getattr(sensor, name) for name in known},
            sensor_mass=sensor.mounting.sensor_mass,
            gaskets=[GasketRow(**vars(gasket)) for gasket in sensor.mounting.gaskets],
            lowest_resonance=self.resonance,
            recorder=RecorderRow(**{name: getattr(recorder, name) for name in keys}),
            source=None if model is None else model.source,
            status="stated" if model is None else model.status,
            note=None if model is None else model.note,
            band=self.band,
            takes=self.takes,
            blows=self.blows,
        )

    def table(self) -> list[Column]:
        """Return a line a blow."""
        columns = [Column(key, [getattr(blow, key) for blow in self.blows]) for key in ("file", "channel", "blow")]
        columns.append(Column("time", [blow.time for blow in self.blows], "s"))
        columns.append(Column("doubted", ["yes" if blow.doubted else "no" for blow in self.blows]))
        units = units_given("m/s^2")
        for key, declared in declarations(SensorTrial).items():
            si = declared.quantity.within(units).si
            columns.append(Column(key, [getattr(blow.trial, key) for blow in self.blows], "" if si == NO_UNIT else si))
        return columns

    def sentence(self) -> str:
        """Say how many blows the sensor can take, and why not the others."""
        if not self.blows:
            return f"No blow could be tried on {self.called}."
        counts = Counter(blow.trial.verdict for blow in self.blows)
        if len(self.blows) == 1:
            return f"{self.called}: {self.blows[0].trial.verdict}."
        words = [f"can take {counts[TAKES]} of {len(self.blows)} blows"]
        words += [f"{verdict} in {count}" for verdict, count in counts.items() if verdict != TAKES]
        return f"{self.called}: {'; '.join(words)}."


def try_records(
    readings: Sequence[FileReading], filter_: Filter | None, stated: StatedSensor, field: str
) -> SensorTrials:
    """Try every blow of every acceleration on a sensor; ``filter_`` was taken before the blows were measured."""
    rows = [(file, reading) for file in readings for reading in file.channels]
    own = [(file, reading) for file, reading in rows if reading.channel.unit == "m/s^2"]
    if not own:
        unit = next((reading.channel.unit for _, reading in rows if reading.channel.unit), "no known unit")
        raise InputError(field, unit, "records of an acceleration", "state the unit, such as --unit g")
    resonance = lowest_resonance(stated.sensor)
    lacks = lacking(stated)
    blows = []
    for file, reading in own:
        ends = [pulse.begin for pulse in reading.pulses[1:]] + [math.inf]
        doubted = not reading.figures("peak")
        for number, (pulse, until) in enumerate(zip(reading.pulses, ends, strict=False), 1):
            trial = tried(reading.channel, pulse, until, stated, resonance)
            if trial.verdict == TAKES and lacks:
                trial = dataclasses.replace(trial, verdict=f"{UNKNOWN}no {' and no '.join(lacks)} stated")
            blows.append(TriedBlow(file.path, reading.channel.name, number, pulse.time, doubted, trial))
    band = min(_band(reading.channel, filter_) for _, reading in own)
    noisy = any(blow.trial.verdict == NOISE for blow in blows)
    # The highest low-pass far enough below the resonance, none where it would take some of the blows too
    low_pass, advised = math.nan, advised_filter(readings) if noisy and filter_ is None else None
    if advised is not None and advised.cutoff <= OF_RESONANCE * resonance:
        low_pass = OF_RESONANCE * resonance
    return SensorTrials(stated, band, tuple(blows), low_pass)


def lacking(stated: StatedSensor) -> list[str]:
    """Return what of range and resonance a sensor does not state."""
    return [key for key in LACKS if math.isinf(getattr(stated.sensor, key))]


def _band(channel: Channel, filter_: Filter | None) -> float:
    half = 0.5 * channel.sampling_rate
    return half if filter_ is None else min(half, filter_.half_power(channel.step))


def tried(channel: Channel, pulse: RecordedPulse, until: float, stated: StatedSensor, resonance: float) -> SensorTrial:
    """Try one blow of a channel on a sensor, as far as the next blow; a negative one with the sensor turned round."""
    length, sign = pulse.end - pulse.begin, math.copysign(1.0, pulse.peak)
    longest = PERIODS / resonance
    first, last = (
        round((time - channel.start) / channel.step)
        for time in (
            pulse.begin - max(BEFORE * length, longest),
            min(pulse.end + max(AFTER * length, longest), until, channel.start + channel.duration),
        )
    )
    first = max(first, 0)
    values = sign * (channel.values[first : last + 1] - pulse.offset)
    begin = max(math.floor((pulse.begin - channel.start) / channel.step) - first, 0)
    sensor = dataclasses.replace(stated.sensor, zero_shift=sign * stated.sensor.zero_shift)
    return try_sensor(sensor, stated.recorder, values, channel.step, begin)
