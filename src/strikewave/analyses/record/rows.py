"""Records as every face takes them: files, channels, blows, motions, responses; and which of several stand for all."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.constants import COVERAGE
from strikewave.base.declare import KEY, NO_UNIT, GivenUnits, declarations
from strikewave.base.shock_quantities import (
    FREQUENCY,
    LENGTH,
    MICROSECONDS,
    OF_CHANNEL,
    OF_INTEGRAL,
    RATIO,
    SECONDS,
    VELOCITY,
    usual_unit,
)
from strikewave.records.budget import RECORD
from strikewave.records.campaign import Campaign, Outlier, Statistic, Trend, statistic
from strikewave.records.health_notice import RESPONSE_FIGURES, STATUSES, HealthNotice, worst
from strikewave.records.measured_uncertainty import BudgetLine, FigureUncertainty
from strikewave.records.measuring import RecordedPulse
from strikewave.records.pulse_shape import BUDGETED
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.records.response import MOST_MODES, MeasuredResponse, Mode
from strikewave.records.ringing import BandSplit
from strikewave.reporting.columns import Column
from strikewave.reporting.numbers import shown_unit
from strikewave.signal.filters import Filter, advised_cutoff, effect_on_half_sine
from strikewave.signal.motion import IntegratedMotion, motion
from strikewave.signal.pulse import HALF_SINE_WIDTH


def usable(files: Sequence[FileReading]) -> list[tuple[FileReading, ChannelReading]]:
    """Return the channels that are not bad, of files that are not: a bad channel does not spoil another."""
    sound = [file for file in files if worst(file.findings) != "bad"]
    return [(file, reading) for file in sound for reading in file.channels if reading.status != "bad"]


def best_of(files: Sequence[FileReading]) -> ChannelReading | None:
    """Return the first channel of the first file in which it is good; else suspect; else any."""
    firsts = [file.channels[0] for file in files if file.channels]
    sound = [reading for file, reading in usable(files) if reading is file.channels[0]]
    return min(sound, key=lambda reading: STATUSES.index(reading.status), default=next(iter(firsts), None))


def shown_response(files: Sequence[FileReading]) -> tuple[FileReading, ChannelReading] | None:
    """Return the record whose spectrum is shown: the first good acceleration, else a suspect one."""
    fit = [
        (file, reading) for file, reading in usable(files) if reading.pulses and reading.channel.unit in ("m/s^2", "")
    ]
    fit.sort(key=lambda row: row[1].channel.unit == "")
    return min(fit, key=lambda row: STATUSES.index(row[1].status), default=None)


def advised_filter(files: Sequence[FileReading]) -> Filter | None:
    """Return the filter that is advised for all files: it changes the steepest blow by at most 2 %.

    Its cutoff has three digits, rounded up. Only blows whose widths enter the means count, where there are any: what is
    no blow is often the steepest. None where no channel is sampled fast enough for one.
    """
    sound = [reading for _, reading in usable(files) if reading.pulses]
    counted = [reading for reading in sound if reading.figures("width")] or sound
    cutoff = max((found for found in map(cutoff_for, counted) if found is not None), default=None)
    if cutoff is None:
        return None
    digit = 10.0 ** (math.floor(math.log10(cutoff)) - 2)
    return Filter(float(f"{math.ceil(cutoff / digit) * digit:.3g}"))


def cutoff_for(reading: ChannelReading) -> float | None:
    """Return the cutoff advised for the steepest blow of a channel, Hz; None where there is none, or it is too high.

    Rise and width are those of the smooth pulse: ringing is what a filter shall take away.
    """
    advised = [
        advised_cutoff(pulse.smooth.rise(), pulse.smooth.width())
        for pulse in reading.unfiltered or reading.pulses
        if pulse.smooth.width() > 0.0
    ]
    cutoff = max(advised, default=math.inf)
    return cutoff if cutoff < 0.5 * reading.channel.sampling_rate else None


def sources_of(files: Sequence[FileReading], campaigns: Sequence[Campaign], filter_: Filter | None) -> tuple[str, ...]:
    """Return the keys of the sources of the methods used."""
    read = any(file.channels for file in files)
    keys = ["siegel-1982"] if read else []
    keys += ["vangel-1996", "croux-1992"] if any(campaign.statistics for campaign in campaigns) else []
    keys += ["rosner-1983", "sen-1968"] if any(campaign.trends for campaign in campaigns) else []
    keys += ["smallwood-1981", "iso-18431-4"] if shown_response(files) is not None else []
    j211 = filter_ is None or "J211" in str(filter_)
    return tuple(keys + (["sae-j211"] if j211 and read else []))


def name_of(paths: Sequence[Path]) -> str:
    """Return the name of the only file without its ending, or of the folder of several."""
    return paths[0].stem if len(paths) == 1 else paths[0].absolute().parent.name or "records"


def counted(files: Sequence[FileReading]) -> list[str]:
    """Return how many files there are of each status, in words."""
    statuses = [file.status for file in files]
    return [f"{statuses.count(status)} {status}" for status in STATUSES if status in statuses]


# Unit of the integral over time of each unit
INTEGRALS = {"m/s^2": "m/s", "m/s": "m", "N": "N s", "Pa": "Pa s", "V": "V s", "1": "s"}
# Figures that a band split has not where it cannot be separated
NOT_SEPARATED = dict.fromkeys(("peak", "width", "peak_uncertainty", "width_uncertainty"), math.nan)


def units_given(unit: str) -> GivenUnits:
    """Return the units of figures of a channel: its own, and that of integrals over time."""
    integral = INTEGRALS.get(unit, f"{unit} s") if unit else ""
    return {OF_CHANNEL.given_by: (unit, usual_unit(unit)), OF_INTEGRAL.given_by: (integral, integral)}


@declare.dataclass
class SplitRow:
    """A pulse without its ringing, by a low-pass: no figures where it cannot be separated, but the reason."""

    split: BandSplit = declare.part(BandSplit, "what the low-pass leaves", inline=True)
    methods_apart: float = declare.number(
        RATIO, "difference of the two ways of taking the ringing off, over its standard uncertainty"
    )

    @classmethod
    def of(cls, pulse: RecordedPulse) -> SplitRow | None:
        """Return that of a blow; None where it was not split."""
        if pulse.split is None:
            return None
        shown = pulse.split if pulse.split.separable else dataclasses.replace(pulse.split, **NOT_SEPARATED)
        return cls(shown, pulse.methods_apart)


@declare.dataclass
class ChannelBlow:
    """A blow of a channel, with its uncertainties."""

    pulse: RecordedPulse = declare.part(RecordedPulse, "its figures", inline=True)
    split: SplitRow | None = declare.part(SplitRow, "the pulse without its ringing, by a low-pass; null without any")
    uncertainty: Mapping[str, FigureUncertainty] = declare.named(
        FigureUncertainty, "of each figure, by a budget, or of noise and baseline alone"
    )


@declare.dataclass
class FilterRow:
    """Effect of a filter on the peaks and widths of a channel, and on a half-sine as wide."""

    name: str = declare.word("the filter")
    cutoff: float = declare.number(FREQUENCY, "its -3 dB frequency")
    peak_left: list[float] = declare.number(RATIO, "of each blow, peak after the filter over that before")
    width_left: list[float] = declare.number(RATIO, "the same of the width")
    half_sine_peak_left: float | None = declare.number(RATIO, "what it leaves of the peak of a half-sine as wide")
    half_sine_width_left: float | None = declare.number(RATIO, "of its width")
    half_sine_velocity_change_left: float | None = declare.number(RATIO, "of its integral")
    effect: list[dict[str, float]] = declare.word("of each blow, shares of peak, width and integral that are left")


@declare.dataclass
class ChannelRow:
    """A channel of a file."""

    name: str = declare.word("channel")
    number: int = declare.count("its place in the file, from 1")
    sampling_rate: float = declare.number(FREQUENCY, "samples a second")
    samples: int = declare.count("how many samples")
    unit: str | None = declare.word("SI unit; null where it is not known")
    status: str = declare.word("good, suspect or bad")
    calibration: dict[str, Any] = declare.word("what was stated of it, as typed")
    health: tuple[HealthNotice, ...] = declare.rows(HealthNotice, "what was found on it")
    pulses: list[ChannelBlow] = declare.rows(ChannelBlow, "its blows")
    response: MeasuredResponse | None = declare.part(
        MeasuredResponse, "by the option base: how it answers the blow of the driving channel"
    )
    responses: tuple[MeasuredResponse, ...] = declare.rows(MeasuredResponse, "the same for each blow")
    advised_cutoff: float | None = declare.number(FREQUENCY, "low-pass that is advised")
    filter: FilterRow | None = declare.part(FilterRow, "by the option filter: what it did to peaks and widths")

    @classmethod
    def of(cls, reading: ChannelReading, filter_: Filter | None) -> ChannelRow:
        """Return the row of a channel."""
        channel, pulses = reading.channel, reading.pulses
        return cls(
            channel.name,
            reading.number,
            channel.sampling_rate,
            channel.values.size,
            channel.unit or None,
            reading.status,
            reading.calibration.stated(),
            reading.findings,
            [ChannelBlow(one, SplitRow.of(one), _uncertainty(reading, place)) for place, one in enumerate(pulses)],
            reading.response,
            reading.responses,
            cutoff_for(reading),
            None if filter_ is None else filter_effect(reading, filter_),
        )


@declare.dataclass
class FileRow:
    """A measured file."""

    file: str = declare.word("measured file")
    format: str = declare.word("its format")
    status: str = declare.word("good, suspect or bad")
    reasons: list[str] = declare.word("why, in words")
    health: tuple[HealthNotice, ...] = declare.rows(HealthNotice, "what was found on it")
    channels: list[ChannelRow] = declare.rows(ChannelRow, "its channels")

    @classmethod
    def of(cls, file: FileReading, filter_: Filter | None) -> FileRow:
        """Return the row of a file."""
        channels = [ChannelRow.of(reading, filter_) for reading in file.channels]
        return cls(file.path, file.format, file.status, file.reasons, file.findings, channels)


@declare.dataclass
class LeftOut:
    """Figures that are left out of a campaign."""

    file: str = declare.word("the file")
    figures: tuple[str, ...] = declare.word("its figures")
    reason: str = declare.word("why")


@declare.dataclass
class CampaignRow:
    """All blows of a channel together."""

    channel: str = declare.word("channel of the statistics over all files")
    statistics: dict[str, Statistic] = declare.named(Statistic, "mean and scatter of each figure", inline=True)
    trend: dict[str, Trend] = declare.named(
        Trend, "of three files or more: the straight line through a figure over the files"
    )
    outliers: tuple[Outlier, ...] = declare.rows(
        Outlier, "figures that disagree with those of the other files and were left out"
    )
    left_out: list[LeftOut] = declare.rows(LeftOut, "what else did not go in, and why")

    @classmethod
    def of(cls, campaign: Campaign) -> CampaignRow:
        """Return the row of a campaign."""
        left_out = [LeftOut(*each) for each in campaign.left_out]
        return cls(campaign.channel, campaign.statistics, campaign.trends, campaign.outliers, left_out)


@declare.dataclass
class BlowRow:
    """A blow in the table of all blows, with every figure."""

    file: str = declare.word("measured file", column=KEY)
    channel: str = declare.word("its channel", column=KEY)
    unit: str = declare.word("SI unit of the channel")
    status: str = declare.word("of the channel")
    index: int = declare.count("number of the blow, from 1", label="#", column=KEY)
    pulse: RecordedPulse = declare.part(RecordedPulse, "its figures", inline=True)
    split_peak: float = declare.number(OF_CHANNEL, "peak without the ringing, by a low-pass")
    split_width: float = declare.number(MICROSECONDS, "its width")
    split_peak_uncertainty: float = declare.number(OF_CHANNEL, "standard uncertainty of that peak")
    split_width_uncertainty: float = declare.number(MICROSECONDS, "of that width")
    split_cutoff: float = declare.number(FREQUENCY, "of that low-pass")
    split_wave_energy: float = declare.number(RATIO, "energy of the wave part over that of the record")
    peak_expanded_uncertainty: float | None = declare.number(
        OF_CHANNEL, "expanded uncertainty of the peak, by a budget", optional=True
    )
    width_expanded_uncertainty: float | None = declare.number(MICROSECONDS, "of the width", optional=True)
    velocity_change_expanded_uncertainty: float | None = declare.number(
        OF_INTEGRAL, "of the velocity change", optional=True
    )

    @property
    def given_units(self) -> GivenUnits:
        """Units of its channel, where that has one."""
        return units_given(self.unit) if self.unit else {}


def blow_rows(files: Sequence[FileReading]) -> list[BlowRow]:
    """Return all blows, file by file."""
    rows = []
    for file in files:
        for reading in file.channels:
            channel = reading.channel
            for place, pulse in enumerate(reading.pulses):
                row, split = SplitRow.of(pulse), [math.nan] * 6
                if row is not None:
                    part = row.split
                    split = [part.peak, part.width, part.peak_uncertainty, part.width_uncertainty]
                    split += [part.cutoff, part.wave_energy]
                figures = reading.uncertainties[place].figures if reading.uncertainties else None
                expanded = [None if figures is None else figures[name].expanded for name in BUDGETED]
                head = (file.path, channel.name, channel.unit, reading.status, place + 1)
                rows.append(BlowRow(*head, pulse, *split, *expanded))
    return rows


def _uncertainty(reading: ChannelReading, place: int) -> Mapping[str, FigureUncertainty]:
    """Return the uncertainties of a blow: by a budget, or of noise and baseline alone."""
    if reading.uncertainties:
        return reading.uncertainties[place].figures
    pulse = reading.pulses[place]
    return {
        name: FigureUncertainty(
            getattr(pulse, name), value, COVERAGE * value, COVERAGE, RECORD, (BudgetLine(RECORD, value, 1.0),)
        )
        for name, value in vars(pulse.uncertainty).items()
    }


def filter_effect(reading: ChannelReading, filter_: Filter) -> FilterRow:
    """Return what a filter did to the peaks and widths of a channel, and what it does to a half-sine as wide."""
    widths = [pulse.width for pulse in reading.unfiltered if pulse.width > 0.0]
    pairs = list(zip(reading.unfiltered, reading.pulses, strict=False))
    same = pairs if len(reading.unfiltered) == len(reading.pulses) else []
    effect = effect_on_half_sine(filter_, min(widths) / HALF_SINE_WIDTH) if widths else None
    return FilterRow(
        str(filter_),
        filter_.half_power(reading.channel.step),
        [after.peak / before.peak for before, after in same],
        [after.width / before.width for before, after in same],
        None if effect is None else effect.peak,
        None if effect is None else effect.width,
        None if effect is None else effect.velocity_change,
        [pulse.smooth.through(filter_)._asdict() for pulse in reading.unfiltered],
    )


Array = NDArray[np.float64]


@declare.dataclass
class MotionRow:
    """End of a motion, and its drift."""

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
    """Motion of the base of a channel, from rest just before its first blow."""

    file: str  # file and channel of the record
    channel: str
    time: Array  # times of the samples, s
    motion: IntegratedMotion  # velocity and displacement, with the standard deviations of their drift

    @property
    def lost(self) -> float:
        """Time from which on the drift exceeds the displacement, to the end; NaN where the end is better known."""
        known = np.flatnonzero(np.abs(self.motion.displacement) > self.motion.displacement_drift)
        after = int(known[-1]) + 1 if known.size else 0
        return float(self.time[after]) if after < self.time.size else math.nan

    @property
    def row(self) -> MotionRow:
        """End of the motion."""
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
    integrated = motion(values, channel.step, wander / math.sqrt(widths), wander * math.sqrt(samples))
    return RecordMotion(file, channel.name, channel.time[first:], integrated)


def all_moved(files: Sequence[FileReading]) -> list[RecordMotion]:
    """Return the motion of all channels that have one."""
    motions = (moved(file.path, reading) for file in files for reading in file.channels)
    return [motion for motion in motions if motion is not None]


def motion_columns(motions: Sequence[RecordMotion]) -> list[Column]:
    """Return histories under one another, each line with its file and channel."""
    columns = [
        Column("file", [moved.file for moved in motions for _ in moved.time]),
        Column("channel", [moved.channel for moved in motions for _ in moved.time]),
        Column("time", np.concatenate([moved.time for moved in motions]) if motions else [], "s"),
    ]
    for name in IntegratedMotion._fields:
        values: Array = np.concatenate([getattr(moved.motion, name) for moved in motions] or [np.empty(0)])
        columns.append(Column(name, values, declarations(MotionRow)[name].quantity.si))
    return columns


@declare.dataclass
class ResponseSummary:
    """Figures of one response channel over all blows of all files."""

    channel: str = declare.word("name of the response channel in the first file")
    unit: str
    statistics: dict[str, Statistic] = declare.named(
        Statistic, "of each figure that has a value; the peak by its magnitude, modes by the strongest", inline=True
    )


def responding(files: Sequence[FileReading]) -> list[tuple[FileReading, ChannelReading]]:
    """Return the channels that answer the blows of a base, with their files."""
    return [(file, reading) for file in files for reading in file.channels if reading.responses]


def base_of(file: FileReading) -> ChannelReading | None:
    """Return the driving channel of a file; None where it has none."""
    driven = any(reading.responses for reading in file.channels)
    return next((reading for reading in file.channels if driven and reading.pulses), None)


def harmed(file: FileReading, reading: ChannelReading) -> tuple[str, ...]:
    """Return the figures of a response channel that are not to be trusted."""
    findings = [*file.findings, *reading.findings]
    spoilt = any(finding.severity == "bad" for finding in findings)
    return tuple(name for name in RESPONSE_FIGURES if spoilt or any(name in finding.harms for finding in findings))


def summaries(files: Sequence[FileReading]) -> list[ResponseSummary]:
    """Sum up each response channel over its blows in all files; figures that a finding harms are left out."""
    rows = responding(files)
    results = []
    for number in dict.fromkeys(reading.number for _, reading in rows):
        own = [(file, reading) for file, reading in rows if reading.number == number]
        unit = own[0][1].channel.unit
        counting = [
            (k, reading, harmed(file, reading)) for k, (file, reading) in enumerate(own) if reading.channel.unit == unit
        ]
        statistics = {}
        for name in RESPONSE_FIGURES:
            pairs = [
                (k, value)
                for k, reading, wrong in counting
                if name not in wrong
                for value in (response.figure(name) for response in reading.responses)
                if math.isfinite(value)
            ]
            if pairs:
                statistics[name] = statistic([value for _, value in pairs], [k for k, _ in pairs])
        results.append(ResponseSummary(own[0][1].channel.name, unit, statistics))
    return results


def response_columns(files: Sequence[FileReading]) -> list[Column]:
    """Return all responses, one line a blow; where channels differ in unit, ``unit`` is that of each line."""
    rows = [(file, reading, one) for file, reading in responding(files) for one in reading.responses]
    units = [reading.channel.unit for _, reading, _ in rows]
    only = units[0] if len(set(units)) == 1 else ""
    columns = [
        Column("file", [file.path for file, _, _ in rows]),
        Column("channel", [reading.channel.name for _, reading, _ in rows]),
        Column("unit", [shown_unit(unit, unit) if only else unit for unit in units]),
        Column("status", [reading.status for _, reading, _ in rows]),
        Column("harmed", [" ".join(harmed(file, reading)) for file, reading, _ in rows]),
        Column("blow", [one.blow for _, _, one in rows]),
    ]
    for name in ("time", "peak", "ratio", "delay", "duration", "rms"):
        columns.append(Column(name, [getattr(one, name) for _, _, one in rows], _si(MeasuredResponse, name, only)))
    for k in range(MOST_MODES):
        modes = [one.modes[k] if k < len(one.modes) else None for _, _, one in rows]
        for name in ("frequency", "frequency_uncertainty", "damping", "damping_uncertainty", "decay_time", "amplitude"):
            values = [None if mode is None else getattr(mode, name) for mode in modes]
            columns.append(Column(f"mode_{k + 1}_{name}", values, _si(Mode, name, only)))
    return columns


def _si(kind: type, name: str, unit: str) -> str:
    """Return the SI unit of a field of responses of a channel of a unit; none of a share."""
    si = declarations(kind)[name].quantity.within(units_given(unit)).si
    return "" if si == NO_UNIT != unit else si
