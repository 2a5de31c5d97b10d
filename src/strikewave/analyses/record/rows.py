"""Records as every face takes them: files, channels, blows, filters, campaigns, each number declared once."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any

from strikewave.analyses.record.chosen import cutoff_for
from strikewave.base import declare
from strikewave.base.constants import COVERAGE
from strikewave.base.declare import KEY, GivenUnits
from strikewave.base.shock_quantities import (
    FREQUENCY,
    MICROSECONDS,
    OF_CHANNEL,
    OF_INTEGRAL,
    RATIO,
    usual_unit,
)
from strikewave.records.band_split import BandSplit
from strikewave.records.budget import RECORD
from strikewave.records.campaign import Campaign, Outlier, Statistic, Trend
from strikewave.records.health_notice import HealthNotice
from strikewave.records.measured_uncertainty import BudgetLine, FigureUncertainty
from strikewave.records.measuring import RecordedPulse
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.records.response import MeasuredResponse
from strikewave.records.smooth_pulse import BUDGETED
from strikewave.signal.filters import Filter, effect_on_half_sine
from strikewave.signal.pulse import HALF_SINE_WIDTH

INTEGRALS = {"m/s^2": "m/s", "m/s": "m", "N": "N s", "Pa": "Pa s", "V": "V s", "1": "s"}
"""Unit of the integral over time of each unit."""
NOT_SEPARATED = dict.fromkeys(("peak", "width", "peak_uncertainty", "width_uncertainty"), math.nan)
"""Figures that a band split has not where it cannot be separated."""


def units_given(unit: str) -> GivenUnits:
    """Return the units of figures of a channel: its own, and that of integrals over time.

    Examples
    --------
    >>> units_given("N")["each channel's unit"], units_given("V")["each channel's unit, times s"]
    (('N', 'kN'), ('V s', 'V s'))
    """
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
    """What a filter did to the peaks and widths of a channel, and what it does to a half-sine as wide."""

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
    """What did not go into a campaign."""

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
        """Those of its channel, where that has one."""
        return units_given(self.unit) if self.unit else {}


def blow_rows(files: Sequence[FileReading]) -> list[BlowRow]:
    """Return all blows, file by file."""
    return [
        _blow_row(file.path, reading, place)
        for file in files
        for reading in file.channels
        for place in range(len(reading.pulses))
    ]


def _blow_row(path: str, reading: ChannelReading, place: int) -> BlowRow:
    channel, pulse = reading.channel, reading.pulses[place]
    row = SplitRow.of(pulse)
    split = [math.nan] * 6
    if row is not None:
        one = row.split
        split = [one.peak, one.width, one.peak_uncertainty, one.width_uncertainty, one.cutoff, one.wave_energy]
    figures = reading.uncertainties[place].figures if reading.uncertainties else None
    expanded = [None if figures is None else figures[name].expanded for name in BUDGETED]
    return BlowRow(path, channel.name, channel.unit, reading.status, place + 1, pulse, *split, *expanded)


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
