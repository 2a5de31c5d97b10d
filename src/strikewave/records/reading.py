"""A channel of a record evaluated: calibrated, examined, its blows measured; and what is wanted of records."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from strikewave.base.errors import InputError
from strikewave.base.first_few import first_few
from strikewave.base.frequencies import frequency_text
from strikewave.base.percents import percent
from strikewave.records.budget.blows import BlowUncertainty
from strikewave.records.calibration import Calibration, calibrated
from strikewave.records.clock import even
from strikewave.records.health import examine
from strikewave.records.health.ringing import ringing
from strikewave.records.health.sampled_record import BlowRecord, with_unit
from strikewave.records.health.zero import level_step
from strikewave.records.health_notice import FIGURES, RESPONSE_FIGURES, STATUSES, HealthNotice, worst, worst_first
from strikewave.records.measuring import FEWEST, RecordedPulse, contacts_of, find_pulses
from strikewave.records.record import Array, Channel
from strikewave.records.response import MeasuredResponse
from strikewave.records.tail import uncoupled
from strikewave.records.trains import gaps_of
from strikewave.signal.filters import Filter, HighPass

RIGID = "rigid_"
"""With this, a figure is that of the pulse without ringing."""
MUCH, HALF = 0.9, 0.5
"""Shares of a peak that a filter must leave for no finding, and for one that harms nothing: what it takes off is
reported with each peak in any case."""
NOT_COUPLED = HealthNotice("ac-coupling", "no AC coupling is recognised: nothing was taken off", severity="good")
"""What is found where AC coupling was to be taken off."""
HALF_PERIOD = 0.5
"""Periods of the cutoff that a record must hold: a filter that is slower than the record is a slip of units."""
MOST_NAMED = 4
"""Channels that a reason names; of more, the others are counted."""


@dataclass(frozen=True)
class Request:
    """What is wanted of records.

    Attributes
    ----------
    channels : tuple of str
        Names, or numbers from 1; empty for all.
    calibrations : mapping
        What is stated of the channels, over what the files beside the data state: a table a channel, or ``all``.
    drop_height : float
        Fall before the blow, m; NaN where none is stated.
    filter : Filter or None
        Low-pass taken before the blows are measured.
    ac_coupling : str or float
        AC coupling that is taken off: of this time constant, s, or ``auto`` for that which is recognised; none by
        default.
    high_pass : HighPass or None
        High-pass taken, before the low-pass.
    base : str
        Name or number of the driving channel: in the others no blows are sought. Empty where each stands for itself.
    """

    channels: tuple[str, ...] = ()
    calibrations: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    drop_height: float = math.nan
    filter: Filter | None = None
    ac_coupling: str | float = ""
    high_pass: HighPass | None = None
    base: str = ""


@dataclass(frozen=True, eq=False)
class ChannelReading:
    """One channel of a file, evaluated.

    Attributes
    ----------
    channel : Channel
        In SI, uniformly sampled, without gaps; filtered where that was asked for.
    number : int
        Place in the file, from 1.
    pulses : tuple of RecordedPulse
        Its blows.
    findings : tuple of HealthNotice
        Its health.
    calibration : Calibration
        What made SI of the file's numbers.
    unfiltered : tuple of RecordedPulse
        The blows before the filter; empty where there is none.
    responses : tuple of MeasuredResponse
        What the channel does after each blow of the base; none for a base, and where none was named.
    uncertainties : tuple of BlowUncertainty
        Of each blow, by a budget; none where none was stated.
    """

    channel: Channel
    number: int
    pulses: tuple[RecordedPulse, ...]
    findings: tuple[HealthNotice, ...]
    calibration: Calibration
    unfiltered: tuple[RecordedPulse, ...] = ()
    responses: tuple[MeasuredResponse, ...] = ()
    uncertainties: tuple[BlowUncertainty, ...] = ()

    @property
    def status(self) -> str:
        """``good``, ``suspect`` or ``bad``."""
        return worst(self.findings)

    @property
    def response(self) -> MeasuredResponse | None:
        """What the channel does after the largest blow of the base; None where it is no response."""
        return max(self.responses, key=lambda response: abs(response.base_peak), default=None)

    @property
    def baseline(self) -> float:
        """Where the record stands at rest: before the first blow, or the median of a record without one."""
        return self.pulses[0].offset if self.pulses else float(np.median(self.channel.values))

    @functools.cached_property
    def intervals(self) -> list[float]:
        """Times from each blow to the next, s: not inside a double hit, nor over a missing blow."""
        return gaps_of(np.array([pulse.time for pulse in self.pulses]), contacts_of(self.pulses))

    def figures(self, name: str) -> list[float]:
        """Return a figure of all blows, those that a finding harms left out.

        A figure without ringing is not harmed by ringing; where a record does not ring, it is the figure itself. Of a
        response channel they are those of `MeasuredResponse.figure`.
        """
        plain = name.removeprefix(RIGID)
        rings = [finding for finding in self.findings if finding.code == "ringing"]
        findings = self.findings if plain == name else [finding for finding in self.findings if finding not in rings]
        if any(plain in finding.harms or finding.severity == "bad" for finding in findings):
            return []
        if self.responses:
            values = [response.figure(name) for response in self.responses if name in RESPONSE_FIGURES]
        elif name == "interval":
            values = self.intervals
        else:
            values = [
                float(getattr(pulse, plain if pulse.rigid is None and not rings else name)) for pulse in self.pulses
            ]
        return [value for value in values if math.isfinite(value)]

    def with_finding(self, finding: HealthNotice) -> ChannelReading:
        """Return the reading with one finding more."""
        return dataclasses.replace(self, findings=(*self.findings, finding))


@dataclass(frozen=True, eq=False)
class FileReading:
    """A file, evaluated.

    Attributes
    ----------
    path : str
        The file.
    format : str
        Its format.
    channels : tuple of ChannelReading
        Its channels.
    findings : tuple of HealthNotice
        What was found on the file itself.
    """

    path: str
    format: str
    channels: tuple[ChannelReading, ...]
    findings: tuple[HealthNotice, ...] = ()

    def numbered(self, number: int) -> ChannelReading | None:
        """Return the channel of a place in the file, from 1; None where it was not read."""
        return self._by_number.get(number)

    @functools.cached_property
    def _by_number(self) -> dict[int, ChannelReading]:
        return {channel.number: channel for channel in self.channels}

    @property
    def all_findings(self) -> list[HealthNotice]:
        """Those of the file and of its channels, the worst first."""
        return worst_first([*self.findings, *(f for channel in self.channels for f in channel.findings)])

    @property
    def status(self) -> str:
        """``good``, ``suspect`` or ``bad``."""
        return worst(self.all_findings)

    @property
    def reasons(self) -> list[str]:
        """Why the file is not good, in words, each once; of several channels, with the first it is true of."""
        pairs = [(finding, "") for finding in self.findings]
        pairs += [(finding, reading.channel.name) for reading in self.channels for finding in reading.findings]
        pairs.sort(key=lambda pair: -STATUSES.index(pair[0].severity))
        names: dict[str, dict[str, None]] = {}
        for finding, name in pairs:
            if finding.severity != "good":
                names.setdefault(finding.message, {})[name] = None
        several = len(self.channels) > 1
        return [
            f"{first_few(list(of), MOST_NAMED)}: {words}" if several and all(of) else words
            for words, of in names.items()
        ]


def read_channel(channel: Channel, number: int, calibration: Calibration, request: Request) -> ChannelReading:
    """Calibrate a channel, resample it uniformly, find and measure its blows, and examine it.

    Raises
    ------
    InputError
        If the calibration does not fit, neither time nor rate is given, or the filter is beyond the sampling rate.
    """
    channel, unit_findings = calibrated(channel, calibration, f"calibration of {channel.name}")
    holes = holes_of(channel)
    channel, mended = even(channel)
    findings = [*unit_findings, *mended]
    if channel.values.size < FEWEST or any(f.severity == "bad" and f.code == "not-a-number" for f in mended):
        if channel.values.size < FEWEST:
            message = f"{channel.values.size} samples; a record needs at least {FEWEST}"
            findings.append(HealthNotice("too-short", message, channel.values.size, severity="bad", harms=FIGURES))
        return ChannelReading(channel, number, (), tuple(findings), calibration)
    pulses = _blows(channel)
    examined = BlowRecord(channel.values, channel.step, channel.start, channel.unit, pulses, request.drop_height)
    if request.ac_coupling != "" and pulses:
        channel, said = _without_coupling(channel, examined, request.ac_coupling)
        findings += said
        pulses = _blows(channel)
        examined = dataclasses.replace(examined, values=channel.values, pulses=pulses)
    else:
        examined = examined.ringing_as_uncoupled()
        pulses = examined.pulses
    findings += [*examine(examined), *_in_blows(holes, pulses)]
    unfiltered: tuple[RecordedPulse, ...] = ()
    if request.filter is not None or request.high_pass is not None:
        unfiltered = pulses
        channel = filtered_channel(channel, request)
        pulses = _blows(channel)
        findings += filter_changes([pulse.peak for pulse in unfiltered], [pulse.peak for pulse in pulses])
        if request.high_pass is not None:
            findings += _lightened(request.high_pass, unfiltered, channel)
        if len(pulses) == len(unfiltered):  # what a filter leaves beside a blow is no ringing
            pairs = zip(pulses, unfiltered, strict=True)
            pulses = tuple(
                dataclasses.replace(after, ringing_frequency=before.ringing_frequency, rigid=before.rigid)
                for after, before in pairs
            )
            if any(
                finding.code == "ringing" for finding in findings
            ):  # what rings no more after the filter harms nothing
                findings = [finding for finding in findings if finding.code != "ringing"]
                findings += examine(dataclasses.replace(examined, values=channel.values, pulses=pulses), ringing)
    if channel.of_body:
        pulses, findings = _as_body_motion(pulses, findings)
    return ChannelReading(channel, number, pulses, tuple(findings), calibration, unfiltered)


def _as_body_motion(
    pulses: Sequence[RecordedPulse], findings: Sequence[HealthNotice]
) -> tuple[tuple[RecordedPulse, ...], list[HealthNotice]]:
    """Return blows and findings of the acceleration of a whole body: what rings is its own motion, and stays in it."""
    own = tuple(dataclasses.replace(pulse, rigid=None, split=None) for pulse in pulses)
    frequency = next((pulse.ringing_frequency for pulse in pulses if pulse.ringing_frequency > 0.0), math.nan)
    rings = f"the blow rings at {with_unit(frequency, 'Hz')}" if frequency > 0.0 else "the record swings after the blow"
    message = f"{rings}: the channel holds the acceleration of a whole body, so that this is its own motion and stays"
    return own, [
        dataclasses.replace(finding, message=message, severity="good", harms=(), effects=())
        if finding.code == "ringing"
        else finding
        for finding in findings
    ]


def filtered_channel(channel: Channel, request: Request) -> Channel:
    """Return a channel through the high-pass and the low-pass that are wanted.

    Raises
    ------
    InputError
        If a cutoff is not between half a period a record and half the sampling rate.
    """
    half = frequency_text(0.5 * channel.sampling_rate)
    for option, one in (("--high-pass", request.high_pass), ("--filter", request.filter)):
        if one is None:
            continue
        cutoff = frequency_text(one.cutoff)
        if one.cutoff * channel.duration < HALF_PERIOD:
            lowest = HALF_PERIOD / channel.duration
            allowed = f"a cutoff of half a period a record at least, {lowest:.3g} Hz for {channel.name}"
            raise InputError(option, cutoff, allowed, "is kHz meant?" if option == "--filter" else "")
        if not one.cutoff < 0.5 * channel.sampling_rate:
            allowed = f"a cutoff below half the sampling rate of {channel.name}, {half}"
            raise InputError(option, cutoff, allowed)
        channel = dataclasses.replace(channel, values=one.apply(channel.values, channel.step))
    return channel


def _lightened(high_pass: HighPass, blows: Sequence[RecordedPulse], filtered: Channel) -> list[HealthNotice]:
    """Tell what a high-pass leaves of the velocity changes: the integrals over the blows, from zero."""
    if not blows:
        return []
    time = filtered.time
    begins = np.searchsorted(time, [blow.begin for blow in blows])
    ends = np.searchsorted(time, [blow.end for blow in blows], side="right")
    left = min(
        float(np.sum(filtered.values[begin:end])) * filtered.step / blow.velocity_change
        for blow, begin, end in zip(blows, begins, ends, strict=True)
    )
    message = (
        f"the high-pass at {high_pass.cutoff:g}\xa0Hz leaves {percent(left)} of a velocity change (the integral over "
        "the blow, from zero), and nothing of that of the whole record"
    )
    return [HealthNotice("high-pass", message, left, severity="suspect" if left < HALF else "good")]


def _without_coupling(
    channel: Channel, examined: BlowRecord, wanted: str | float
) -> tuple[Channel, list[HealthNotice]]:
    """Return a channel without its AC coupling, of a stated time constant or of the one that is recognised."""
    if isinstance(wanted, str):
        model = examined.tail
        if model is None or model.kind != "ac-coupling":
            return channel, [NOT_COUPLED]
        constant, doubt = model.constant, f" +- {2e3 * model.constant_error:.2g}"
    else:
        constant, doubt = float(wanted), ""
    values = uncoupled(channel.values, channel.step, channel.start, examined.pulses, constant)
    message = (
        f"AC coupling of {1.0 / (2.0 * math.pi * constant):.4g} Hz (tau = {1e3 * constant:.4g}{doubt} ms) was taken off"
    )
    return dataclasses.replace(channel, values=values), [
        HealthNotice("ac-coupling", message, constant, severity="good")
    ]


def holes_of(channel: Channel) -> Array:
    """Return the times of samples that are no numbers, s, rising."""
    missing = np.flatnonzero(~np.isfinite(channel.values))
    times = channel.start + channel.step * missing if channel.stamps is None else channel.stamps[missing]
    return np.sort(np.asarray(times, dtype=np.float64))


def _in_blows(holes: Array, pulses: Sequence[RecordedPulse]) -> list[HealthNotice]:
    """Find blows that lack samples: what bridges them is no measurement."""
    for pulse in pulses:
        count = int(np.searchsorted(holes, pulse.end, side="right") - np.searchsorted(holes, pulse.begin))
        if count:
            message = (
                f"{count} samples of the blow at {pulse.time:.6g}\xa0s are no numbers: its figures are not measured"
            )
            return [
                HealthNotice(
                    "blow-incomplete", message, count, severity="bad", harms=FIGURES, start=pulse.begin, end=pulse.end
                )
            ]
    return []


def filter_changes(before: Sequence[float], after: Sequence[float]) -> list[HealthNotice]:
    """Find a filter that takes much off the peaks of blows, or of responses, or takes some away."""
    if len(before) != len(after):
        message = f"the filter leaves {len(after)} of {len(before)} blows: take a higher cutoff"
        return [HealthNotice("filter-changes", message, len(after) - len(before), severity="suspect")]
    left = min((abs(new / old) for old, new in zip(before, after, strict=True) if old), default=1.0)
    if left > MUCH:
        return []
    message = f"the filter leaves {percent(left, 0)} of a peak: quote it with the filter, or take a higher cutoff"
    return [HealthNotice("filter-changes", message, left, severity="suspect" if left < HALF else "good")]


def _blows(channel: Channel) -> tuple[RecordedPulse, ...]:
    """Return the blows of a channel; where its baseline steps from one level to another, those above both levels."""
    step = level_step(channel.values)
    if step is None:
        return tuple(find_pulses(channel.values, channel.step, channel.start))
    place, shift = step
    blows = _lowered_blows(channel, place, shift)
    holding = [p for p in blows if p.begin - p.width < channel.start + place * channel.step < p.end + p.width]
    if not holding:
        return blows
    return _lowered_blows(channel, math.ceil((holding[0].end - channel.start) / channel.step), shift)


def _lowered_blows(channel: Channel, place: int, shift: float) -> tuple[RecordedPulse, ...]:
    """Return the blows of a channel whose samples from one place on are lowered."""
    after = np.arange(channel.values.size) >= place
    return tuple(find_pulses(channel.values - shift * after, channel.step, channel.start))
