"""Whether a sensor could take the blows of records: each tried on it, in numbers, and in words."""

from __future__ import annotations

import dataclasses
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from strikewave.analyses.record.rows import advised_filter, units_given
from strikewave.base import declare
from strikewave.base.declare import NO_UNIT, Quantity, declarations
from strikewave.base.errors import InputError
from strikewave.base.result import INFO, WARNING, Notice
from strikewave.base.shock_quantities import ACCELERATION, BANDWIDTH, FREQUENCY, LENGTH, MASS, RATIO, SECONDS
from strikewave.records.measuring import RecordedPulse
from strikewave.records.reading import FileReading
from strikewave.records.record import Channel
from strikewave.reporting.columns import Column
from strikewave.reporting.faces import amount
from strikewave.sensors.trial import NOISE, TAKES, SensorTrial, lowest_resonance, try_sensor
from strikewave.signal.filters import Filter

if TYPE_CHECKING:
    from strikewave.cases.stack_of_case import StatedSensor

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
    """What keeps the signal of the sensor."""

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
        """Whether the sensor can take every blow; None where none is beyond it, and of some it is not known."""
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
        """What faces show of it."""
        sensor, recorder, model = self.stated.sensor, self.stated.recorder, self.stated.model
        known = ("range", "resonance", "quality", "zero_shift")
        kept = ("sampling_rate", "cutoff", "order", "bits")
        return SensorRow(
            name=sensor.name,
            model=None if model is None else model.name,
            **{name: getattr(sensor, name) for name in known},
            sensor_mass=sensor.mounting.sensor_mass,
            gaskets=[GasketRow(**vars(gasket)) for gasket in sensor.mounting.gaskets],
            lowest_resonance=self.resonance,
            recorder=RecorderRow(**{name: getattr(recorder, name) for name in kept}),
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
        for key, one in declarations(SensorTrial).items():
            si = one.quantity.within(units).si
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
    low_pass = _low_pass(readings, resonance) if noisy and filter_ is None else math.nan
    return SensorTrials(stated, band, tuple(blows), low_pass)


def lacking(stated: StatedSensor) -> list[str]:
    """Return what of range and resonance a sensor does not state."""
    return [key for key in LACKS if math.isinf(getattr(stated.sensor, key))]


def _low_pass(readings: Sequence[FileReading], resonance: float) -> float:
    """Return the highest low-pass far enough below a resonance, Hz; NaN where it would take some of the blows too."""
    advised = advised_filter(readings)
    highest = OF_RESONANCE * resonance
    return highest if advised is not None and advised.cutoff <= highest else math.nan


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
