"""A file evaluated: channels calibrated, examined, their blows measured, or what they do after those of another one.

A channel that only swings after the blow of another one is told apart from those that are struck; repeats of a test in
the columns of a file are taken as files; a budget gives each blow its uncertainty.
"""

from __future__ import annotations

import dataclasses
import functools
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from strikewave.base.errors import InputError, nearest, show
from strikewave.base.texts import first_few, frequency_text, percent
from strikewave.records.budget import Budget
from strikewave.records.calibration import ChannelCalibration, calibrated, calibration_of, even, laid_over
from strikewave.records.contacts import gaps_of
from strikewave.records.health import examine
from strikewave.records.health.disturbances import ringing
from strikewave.records.health.sampled_record import BlowRecord, ResponseRecord, with_unit
from strikewave.records.health.zero import level_step
from strikewave.records.health_notice import FIGURES, RESPONSE_FIGURES, STATUSES, HealthNotice, worst, worst_first
from strikewave.records.measured_uncertainty import BlowUncertainty, blow_uncertainty
from strikewave.records.measuring import FEWEST, RecordedPulse, contacts_of, find_pulses
from strikewave.records.record import Array, Channel, Record
from strikewave.records.response import BaseBlow, MeasuredResponse, measure_responses, swings
from strikewave.records.tail import resting, uncoupled
from strikewave.records.thresholds import OfReading
from strikewave.signal.filters import Filter, HighPass

RIGID = "rigid_"  # with this, a figure is that of the pulse without ringing
# Finding where AC coupling was to be taken off and none is recognised
NOT_COUPLED = HealthNotice("ac-coupling", "no AC coupling is recognised: nothing was taken off", severity="good")
MOST_NAMED = 4  # channels that a reason names; of more, the others are counted


@dataclass(frozen=True)
class Request:
    """Options for reading and examining records.

    Attributes
    ----------
    channels : tuple of str
        Names, or numbers from 1; empty for all.
    calibrations : mapping
        Calibration data of the channels, which overrule the files beside the data: a table a channel, or ``all``.
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
        Blows of the channel.
    findings : tuple of HealthNotice
        Health notices of the channel.
    calibration : ChannelCalibration
        Calibration that made SI of the file's numbers.
    unfiltered : tuple of RecordedPulse
        The blows before the filter; empty where there is none.
    responses : tuple of MeasuredResponse
        Responses of the channel after each blow of the base; none for a base, and where none was named.
    uncertainties : tuple of BlowUncertainty
        Uncertainties of each blow, by a budget; none where none was stated.
    """

    channel: Channel
    number: int
    pulses: tuple[RecordedPulse, ...]
    findings: tuple[HealthNotice, ...]
    calibration: ChannelCalibration
    unfiltered: tuple[RecordedPulse, ...] = ()
    responses: tuple[MeasuredResponse, ...] = ()
    uncertainties: tuple[BlowUncertainty, ...] = ()

    @property
    def status(self) -> str:
        """``good``, ``suspect`` or ``bad``."""
        return worst(self.findings)

    @property
    def response(self) -> MeasuredResponse | None:
        """Response of the channel after the largest blow of the base; None where it is no response."""
        return max(self.responses, key=lambda response: abs(response.base_peak), default=None)

    @property
    def baseline(self) -> float:
        """Level of the record at rest: before the first blow, or the median of a record without one."""
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
        Format of the file.
    channels : tuple of ChannelReading
        Channels of the file.
    findings : tuple of HealthNotice
        Findings on the file itself.
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
        """Findings of the file and of its channels, the worst first."""
        return worst_first([*self.findings, *(f for channel in self.channels for f in channel.findings)])

    @property
    def status(self) -> str:
        """``good``, ``suspect`` or ``bad``."""
        return worst(self.all_findings)

    @property
    def reasons(self) -> list[str]:
        """Reasons why the file is not good, each once; of several channels, with the first it is true of."""
        pairs = [(finding, "") for finding in self.findings]
        pairs += [(finding, reading.channel.name) for reading in self.channels for finding in reading.findings]
        pairs.sort(key=lambda pair: -STATUSES.index(pair[0].severity))
        names: dict[str, dict[str, None]] = {}
        for finding, name in pairs:
            if finding.severity != "good":
                names.setdefault(finding.message, {})[name] = None
        several = len(self.channels) > 1
        return [
            f"{first_few(list(of), MOST_NAMED)}: {message}" if several and all(of) else message
            for message, of in names.items()
        ]


def read_channel(channel: Channel, number: int, calibration: ChannelCalibration, request: Request) -> ChannelReading:
    """Calibrate a channel, resample it uniformly, find and measure its blows, and examine it."""
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
        channel, notice = _without_coupling(channel, examined, request.ac_coupling)
        findings.append(notice)
        pulses = _blows(channel)
        examined = dataclasses.replace(examined, values=channel.values, pulses=pulses)
    else:
        examined = examined.ringing_as_uncoupled()
        pulses = examined.pulses
    findings += [
        *examine(examined),
        *_incomplete(holes, FIGURES, [(p.begin, p.end, f"blow at {p.time:.6g}") for p in pulses]),
    ]
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
            others = [finding for finding in findings if finding.code != "ringing"]
            if len(others) < len(findings):  # what rings no more after the filter harms nothing
                after = dataclasses.replace(examined, values=channel.values, pulses=pulses)
                findings = others + examine(after, ringing)
    if channel.of_body:
        pulses, findings = _as_body_motion(pulses, findings)
    return ChannelReading(channel, number, pulses, tuple(findings), calibration, unfiltered)


def _as_body_motion(
    pulses: Sequence[RecordedPulse], findings: Sequence[HealthNotice]
) -> tuple[tuple[RecordedPulse, ...], list[HealthNotice]]:
    """Return blows and findings of the acceleration of a whole body: what rings is its own motion, and stays in it."""
    unsplit = tuple(dataclasses.replace(pulse, rigid=None, split=None) for pulse in pulses)
    frequency = next((pulse.ringing_frequency for pulse in pulses if pulse.ringing_frequency > 0.0), math.nan)
    rings = f"the blow rings at {with_unit(frequency, 'Hz')}" if frequency > 0.0 else "the record swings after the blow"
    message = f"{rings}: the channel holds the acceleration of a whole body, so that this is its own motion and stays"
    return unsplit, [
        dataclasses.replace(finding, message=message, severity="good", harms=(), effects=())
        if finding.code == "ringing"
        else finding
        for finding in findings
    ]


def filtered_channel(channel: Channel, request: Request) -> Channel:
    """Return a channel through the high-pass and the low-pass that are wanted."""
    half = frequency_text(0.5 * channel.sampling_rate)
    for option, chosen in (("--high-pass", request.high_pass), ("--filter", request.filter)):
        if chosen is None:
            continue
        cutoff = frequency_text(chosen.cutoff)
        if chosen.cutoff * channel.duration < OfReading.HALF_PERIOD:
            lowest = OfReading.HALF_PERIOD / channel.duration
            allowed = f"a cutoff of half a period a record at least, {lowest:.3g} Hz for {channel.name}"
            raise InputError(option, cutoff, allowed, "is kHz meant?" if option == "--filter" else "")
        if not chosen.cutoff < 0.5 * channel.sampling_rate:
            allowed = f"a cutoff below half the sampling rate of {channel.name}, {half}"
            raise InputError(option, cutoff, allowed)
        channel = dataclasses.replace(channel, values=chosen.apply(channel.values, channel.step))
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
    return [HealthNotice("high-pass", message, left, severity="suspect" if left < OfReading.HALF else "good")]


def _without_coupling(channel: Channel, examined: BlowRecord, wanted: str | float) -> tuple[Channel, HealthNotice]:
    """Return a channel without its AC coupling, of a stated time constant or of the one that is recognised."""
    if isinstance(wanted, str):
        model = examined.tail
        if model is None or model.kind != "ac-coupling":
            return channel, NOT_COUPLED
        constant, doubt = model.constant, f" +- {2e3 * model.constant_error:.2g}"
    else:
        constant, doubt = float(wanted), ""
    values = uncoupled(channel.values, channel.step, channel.start, examined.pulses, constant)
    return dataclasses.replace(channel, values=values), _taken_off(constant, doubt)


def _taken_off(constant: float, doubt: str = "") -> HealthNotice:
    """Return the notice of AC coupling of a time constant, s, that was taken off."""
    cutoff = 1.0 / (2.0 * math.pi * constant)
    message = f"AC coupling of {cutoff:.4g}\xa0Hz (tau = {1e3 * constant:.4g}{doubt}\xa0ms) was taken off"
    return HealthNotice("ac-coupling", message, constant, severity="good")


def holes_of(channel: Channel) -> Array:
    """Return the times of samples that are no numbers, s, rising."""
    missing = np.flatnonzero(~np.isfinite(channel.values))
    times = channel.start + channel.step * missing if channel.stamps is None else channel.stamps[missing]
    return np.sort(np.asarray(times, dtype=np.float64))


def _incomplete(
    holes: Array, figures: tuple[str, ...], spans: Sequence[tuple[float, float, str]]
) -> list[HealthNotice]:
    """Find a blow, or a response, that lacks samples between its ends: what bridges them is no measurement."""
    for begin, end, what in spans:
        count = int(np.searchsorted(holes, end, side="right") - np.searchsorted(holes, begin))
        if count:
            message = f"{count} samples of the {what}\xa0s are no numbers: its figures are not measured"
            return [HealthNotice("blow-incomplete", message, count, "bad", figures, begin, end)]
    return []


def filter_changes(before: Sequence[float], after: Sequence[float]) -> list[HealthNotice]:
    """Find a filter that takes much off the peaks of blows, or of responses, or takes some away."""
    if len(before) != len(after):
        message = f"the filter leaves {len(after)} of {len(before)} blows: take a higher cutoff"
        return [HealthNotice("filter-changes", message, len(after) - len(before), severity="suspect")]
    left = min((abs(new / old) for old, new in zip(before, after, strict=True) if old), default=1.0)
    if left > OfReading.MUCH:
        return []
    message = f"the filter leaves {percent(left, 0)} of a peak: quote it with the filter, or take a higher cutoff"
    return [HealthNotice("filter-changes", message, left, severity="suspect" if left < OfReading.HALF else "good")]


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


def read_response(
    channel: Channel, number: int, calibration: ChannelCalibration, request: Request, base: ChannelReading
) -> ChannelReading:
    """Calibrate a response channel, resample it uniformly, and measure it against the blows of the base."""
    channel, unit_findings = calibrated(channel, calibration, f"calibration of {channel.name}")
    holes = holes_of(channel)
    channel, mended = even(channel)
    findings = [*unit_findings, *mended]
    usable = channel.values.size >= 2 * FEWEST and bool(np.all(np.isfinite(channel.values)))
    if not usable or not base.pulses:
        why = "the channel has too few samples" if not usable else f"the base, {base.channel.name}, has no blow"
        findings.append(HealthNotice("no-response", f"{why}: no response is measured", severity="bad", harms=FIGURES))
        return ChannelReading(channel, number, (), tuple(findings), calibration)
    blows = [BaseBlow(pulse.begin, pulse.time, pulse.end, pulse.peak) for pulse in base.pulses]
    examined = _examined_response(channel, blows, base)
    if request.ac_coupling != "" and examined.responses:
        channel, notice = _response_without_coupling(channel, examined, request.ac_coupling)
        findings.append(notice)
        examined = _examined_response(channel, blows, base)
    if request.filter is not None or request.high_pass is not None:
        before = [response.peak for response in examined.responses]
        channel = filtered_channel(channel, request)
        examined = _examined_response(channel, blows, base)
        findings += filter_changes(before, [response.peak for response in examined.responses])
    responses = tuple(examined.responses)
    if responses:
        spans = [(r.begin, r.begin + r.duration, f"response after {r.begin:.6g}") for r in responses]
        findings += [*examine(examined), *_incomplete(holes, RESPONSE_FIGURES, spans), *_of_base(base)]
    return ChannelReading(channel, number, (), tuple(findings), calibration, (), responses)


def _examined_response(channel: Channel, blows: Sequence[BaseBlow], base: ChannelReading) -> ResponseRecord:
    """Measure a response channel, for the checks of its health."""
    values, step, start = channel.values, channel.step, channel.start
    responses = measure_responses(values, step, start, blows, channel.unit == base.channel.unit)
    beside = step == base.channel.step and start == base.channel.start
    return ResponseRecord(values, step, start, channel.unit, blows, responses, base.channel.values if beside else None)


def _response_without_coupling(
    channel: Channel, examined: ResponseRecord, wanted: str | float
) -> tuple[Channel, HealthNotice]:
    """Return a response channel without its AC coupling, of a stated time constant or of the one recognised."""
    seen = [finding.value for finding in examine(examined) if finding.code == "ac-coupling"]
    if isinstance(wanted, str) and not seen:
        return channel, NOT_COUPLED
    constant = seen[0] if isinstance(wanted, str) else float(wanted)
    last = examined.responses[-1]
    values = last.zero + resting(examined.above, channel.step, constant, examined.place(last.decay.end))
    return dataclasses.replace(channel, values=values), _taken_off(constant)


def _of_base(base: ChannelReading) -> list[HealthNotice]:
    """Tell what is harmed by what is wrong with the base: the ratio to its peak, and what counts from its time."""
    findings = worst_first(f for f in base.findings if f.severity == "bad" or "peak" in f.harms)
    if not findings:
        return []
    harms = ("ratio", "delay") if findings[0].severity == "bad" else ("ratio",)
    message = f"the base, {base.channel.name}, is {findings[0].severity}: {findings[0].message}"
    return [HealthNotice("base", message, severity="suspect", harms=harms)]


def mark_responses(readings: Sequence[ChannelReading]) -> list[ChannelReading]:
    """Return channels of a file; those that only swing after the blow of another one are marked so, and never good."""
    swinging = [_swings(reading) for reading in readings]
    struck = [other for other, swing in zip(readings, swinging, strict=True) if other.pulses and not swing]
    marked = []
    for reading, swing in zip(readings, swinging, strict=True):
        begin = reading.pulses[0].begin if reading.pulses else math.inf
        earlier = (o for o in struck if o is not reading and o.pulses[0].begin <= begin + o.pulses[0].width)
        base = next(earlier, None) if swing else None
        if base is not None and _louder(reading, base.pulses[0].begin):
            message = (
                f"no blow of its own: it swings about zero after the blow of {base.channel.name}; --base {base.number} "
                "measures it as a response"
            )
            others = tuple(known for known in reading.findings if known.code != "no-pulse")  # it says less of the same
            finding = HealthNotice("response", message, harms=FIGURES)
            reading = dataclasses.replace(reading, findings=(*others, finding))
        marked.append(reading)
    return marked


def _swings(reading: ChannelReading) -> bool:
    """Tell whether a channel swings about zero, as noise does too."""
    values = reading.channel.values
    if values.size < FEWEST or not np.all(np.isfinite(values)) or not np.ptp(values) > 0.0:
        return False
    return swings(values - reading.baseline)


def _louder(reading: ChannelReading, begin: float) -> bool:
    """Tell whether a channel swings by more than its noise before a time; over all, where little lies before it."""
    channel, above = reading.channel, np.abs(reading.channel.values - reading.baseline)
    before = max(round((begin - channel.start) / channel.step), 0)
    noise = float(np.median(above[:before] if before >= FEWEST else above))
    return float(np.max(above)) > OfReading.SWINGS_OUT * noise


def read_file(record: Record, stated: Mapping[str, Mapping[str, Any]], request: Request) -> FileReading:
    """Return the wanted channels of a record, evaluated.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(4000) * 1e-5
    >>> values = 100.0 * np.exp(-(((t - 0.02) / 1e-4) ** 2)) + 1e-3 * np.sin(1e9 * t)
    >>> file = read_file(Record("a.csv", "text", (Channel("board", values, 1e-5, unit="g"),)), {}, Request())
    >>> file.status, round(file.channels[0].pulses[0].peak)
    ('good', 981)

    ``stated`` are the calibrations beside the file; those of the request go first.
    """
    wanted = record.only(request.channels).channels
    places = {id(channel): number for number, channel in enumerate(record.channels, start=1)}
    tables, unused = _by_number(record, laid_over(stated, request.calibrations))
    base = _base_of(record, wanted, request)
    driving = None if base is None else _read(base, places, tables, request)
    readings = []
    for channel in wanted:
        if driving is None or base is channel:
            readings.append(driving or _read(channel, places, tables, request))
            continue
        number = places[id(channel)]
        readings.append(read_response(channel, number, calibration_of(tables, channel.name, number), request, driving))
    if driving is None:
        readings = mark_responses(readings)
    return FileReading(record.path, record.format, tuple(readings), (*record.findings, *unused))


def _read(channel: Channel, places: Mapping[int, int], tables: Mapping[str, Any], request: Request) -> ChannelReading:
    """Return a channel of a file, evaluated."""
    number = places[id(channel)]
    return read_channel(channel, number, calibration_of(tables, channel.name, number), request)


def _base_of(record: Record, wanted: Sequence[Channel], request: Request) -> Channel | None:
    """Return the driving channel; None where none is named."""
    if not request.base:
        return None
    base = record.channel(request.base, "--base")
    names = [channel.name for channel in wanted]
    if not any(channel is base for channel in wanted):
        hint = f"add --channel {request.base}"
        raise InputError("--base", request.base, f"one of the channels that are read: {', '.join(names)}", hint)
    if len(wanted) == 1:
        hint = "leave it out" if len(record.channels) == 1 else "name a channel that responds by --channel too"
        raise InputError("--base", request.base, f"a channel beside others: only {names[0]} is read", hint)
    return base


def repeats(file: FileReading) -> list[FileReading]:
    """Return a file a channel: repeats of the same test that stand in columns, or sheets, of one file.

    Each is called as the file with the name of its column, and its channel as what the names have in common.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(4000) * 1e-5
    >>> channels = tuple(Channel(f"shot {k}", np.exp(-(((t - 0.02) / 1e-4) ** 2)), 1e-5) for k in (1, 2))
    >>> file = read_file(Record("a.csv", "text", channels), {}, Request())
    >>> [(one.path, [(r.channel.name, r.number) for r in one.channels]) for one in repeats(file)]
    [('a.csv: shot 1', [('shot', 1)]), ('a.csv: shot 2', [('shot', 1)])]
    """
    names = [reading.channel.name for reading in file.channels]
    stems = {re.sub(r"[\W_]*\d*[\W_]*$", "", name.rpartition("/")[2]) for name in names}
    common = stems.pop() if len(stems) == 1 else ""
    files = []
    for reading in file.channels:
        channel = dataclasses.replace(reading.channel, name=common or "repeats")
        repeat = dataclasses.replace(reading, number=1, channel=channel)
        files.append(dataclasses.replace(file, path=f"{file.path}: {reading.channel.name}", channels=(repeat,)))
    return files


def _by_number(
    record: Record, tables: Mapping[str, Mapping[str, Any]]
) -> tuple[dict[str, dict[str, Any]], list[HealthNotice]]:
    """Return calibrations by the numbers of their channels, and a finding for each channel that the file lacks."""
    known = record.keys
    by_number: dict[str, dict[str, Any]] = {}
    unused = []
    for name, table in tables.items():
        if name != "all" and name not in known:
            message = f"a calibration is for {show(name)}, which the file does not have: {nearest(name, known)}"
            unused.append(HealthNotice("calibration-unused", message))
            continue
        key = name if name == "all" else str(known[name] + 1)
        by_number[key] = {**by_number.get(key, {}), **table}
    return by_number, unused


def check_amounts(budget: Budget, reading: ChannelReading, field: str = "--uncertainty") -> None:
    """Refuse a budget that states an acceleration for a channel that measures something else."""
    amounts = [contribution.name for contribution in budget.contributions if not contribution.relative]
    if amounts and reading.channel.unit != "m/s^2":
        wrong = f"{reading.channel.name}, {reading.channel.unit or 'no known unit'}"
        raise InputError(field, wrong, f"shares of the peak: {amounts[0]} states an acceleration")


def with_budget(files: Sequence[FileReading], budget: Budget, field: str = "--uncertainty") -> list[FileReading]:
    """Return records with the uncertainty of each blow; Monte Carlo validates the largest one of each channel."""
    largest: dict[int, tuple[ChannelReading, int]] = {}
    for reading in (reading for file in files for reading in file.channels if reading.pulses):
        check_amounts(budget, reading, field)
        place = max(range(len(reading.pulses)), key=lambda k: abs(reading.pulses[k].peak))
        known = largest.get(reading.number)
        if known is None or abs(reading.pulses[place].peak) > abs(known[0].pulses[known[1]].peak):
            largest[reading.number] = reading, place
    checked = {
        number: blow_uncertainty(reading.channel, reading.pulses[place], budget, trials=True)
        for number, (reading, place) in largest.items()
    }

    def with_uncertainties(reading: ChannelReading) -> ChannelReading:
        """Return a channel with the uncertainty of each blow: that of the largest holds for blows like it."""
        uncertainties = []
        for place, pulse in enumerate(reading.pulses):
            largest_of = checked[reading.number]
            is_it = largest[reading.number][0] is reading and largest[reading.number][1] == place
            uncertainties.append(
                largest_of if is_it else blow_uncertainty(reading.channel, pulse, budget).alike(largest_of)
            )
        return dataclasses.replace(reading, uncertainties=tuple(uncertainties))

    return [dataclasses.replace(file, channels=tuple(map(with_uncertainties, file.channels))) for file in files]
