"""A response channel evaluated: measured against the blows of its base, or told apart from channels that are struck."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence

import numpy as np

from strikewave.records.calibration import Calibration, calibrated
from strikewave.records.clock import even
from strikewave.records.health import examine
from strikewave.records.health.sampled_record import ResponseRecord
from strikewave.records.health_notice import FIGURES, RESPONSE_FIGURES, HealthNotice, worst_first
from strikewave.records.measuring import FEWEST
from strikewave.records.reading import (
    NOT_COUPLED,
    ChannelReading,
    Request,
    filter_changes,
    filtered_channel,
    holes_of,
)
from strikewave.records.record import Array, Channel
from strikewave.records.response import BaseBlow, MeasuredResponse, measure_responses, swings
from strikewave.records.tail import resting

SWINGS_OUT = 20.0
"""Median magnitudes that a swing must reach: noise alone reaches seven in a million samples."""


def read_response(
    channel: Channel, number: int, calibration: Calibration, request: Request, base: ChannelReading
) -> ChannelReading:
    """Calibrate a response channel, resample it uniformly, and measure it against the blows of the base."""
    channel, findings = calibrated(channel, calibration, f"calibration of {channel.name}")
    holes = holes_of(channel)
    channel, mended = even(channel)
    found = [*findings, *mended]
    usable = channel.values.size >= 2 * FEWEST and bool(np.all(np.isfinite(channel.values)))
    if not usable or not base.pulses:
        why = "the channel has too few samples" if not usable else f"the base, {base.channel.name}, has no blow"
        found.append(HealthNotice("no-response", f"{why}: no response is measured", severity="bad", harms=FIGURES))
        return ChannelReading(channel, number, (), tuple(found), calibration)
    blows = [BaseBlow(pulse.begin, pulse.time, pulse.end, pulse.peak) for pulse in base.pulses]
    examined = _examined_response(channel, blows, base)
    if request.ac_coupling != "" and examined.responses:
        channel, said = _response_without_coupling(channel, examined, request.ac_coupling)
        found += said
        examined = _examined_response(channel, blows, base)
    if request.filter is not None or request.high_pass is not None:
        before = [one.peak for one in examined.responses]
        channel = filtered_channel(channel, request)
        examined = _examined_response(channel, blows, base)
        found += filter_changes(before, [one.peak for one in examined.responses])
    responses = tuple(examined.responses)
    if responses:
        found += [*examine(examined), *_missing(holes, responses), *_of_base(base)]
    return ChannelReading(channel, number, (), tuple(found), calibration, (), responses)


def _examined_response(channel: Channel, blows: Sequence[BaseBlow], base: ChannelReading) -> ResponseRecord:
    """Measure a response channel, for the checks of its health."""
    values, step, start = channel.values, channel.step, channel.start
    responses = measure_responses(values, step, start, blows, channel.unit == base.channel.unit)
    beside = step == base.channel.step and start == base.channel.start
    return ResponseRecord(values, step, start, channel.unit, blows, responses, base.channel.values if beside else None)


def _response_without_coupling(
    channel: Channel, examined: ResponseRecord, wanted: str | float
) -> tuple[Channel, list[HealthNotice]]:
    """Return a response channel without its AC coupling, of a stated time constant or of the one recognised."""
    seen = [finding.value for finding in examine(examined) if finding.code == "ac-coupling"]
    if isinstance(wanted, str) and not seen:
        return channel, [NOT_COUPLED]
    constant = seen[0] if isinstance(wanted, str) else float(wanted)
    last = examined.responses[-1]
    values = last.zero + resting(examined.above, channel.step, constant, examined.place(last.decay.end))
    message = (
        f"AC coupling of {1.0 / (2.0 * math.pi * constant):.4g}\xa0Hz (tau = {1e3 * constant:.4g}\xa0ms) was taken off"
    )
    said = HealthNotice("ac-coupling", message, constant, severity="good")
    return dataclasses.replace(channel, values=values), [said]


def _missing(holes: Array, responses: Sequence[MeasuredResponse]) -> list[HealthNotice]:
    """Find responses that lack samples: what bridges them is no measurement."""
    for one in responses:
        count = int(np.count_nonzero((holes >= one.begin) & (holes <= one.begin + one.duration)))
        if count:
            message = (
                f"{count} samples of the response after {one.begin:.6g}\xa0s are no numbers: they are not measured"
            )
            return [
                HealthNotice(
                    "blow-incomplete", message, count, "bad", RESPONSE_FIGURES, one.begin, one.begin + one.duration
                )
            ]
    return []


def _of_base(base: ChannelReading) -> list[HealthNotice]:
    """Tell what is harmed by what is wrong with the base: the ratio to its peak, and what counts from its time."""
    found = worst_first(f for f in base.findings if f.severity == "bad" or "peak" in f.harms)
    if not found:
        return []
    harms = ("ratio", "delay") if found[0].severity == "bad" else ("ratio",)
    message = f"the base, {base.channel.name}, is {found[0].severity}: {found[0].message}"
    return [HealthNotice("base", message, severity="suspect", harms=harms)]


def told_apart(readings: Sequence[ChannelReading]) -> list[ChannelReading]:
    """Return channels of a file; those that only swing after the blow of another one are marked so, and never good."""
    swinging = [_swings(reading) for reading in readings]
    struck = [one for one, swing in zip(readings, swinging, strict=True) if one.pulses and not swing]
    told = []
    for reading, swing in zip(readings, swinging, strict=True):
        begin = reading.pulses[0].begin if reading.pulses else math.inf
        base = next(
            (one for one in struck if one is not reading and one.pulses[0].begin <= begin + one.pulses[0].width), None
        )
        if not swing or base is None or not _louder(reading, base.pulses[0].begin):
            told.append(reading)
            continue
        message = (
            f"no blow of its own: it swings about zero after the blow of {base.channel.name}; --base {base.number}"
        )
        finding = HealthNotice("response", f"{message} measures it as a response", harms=FIGURES)
        others = tuple(known for known in reading.findings if known.code != "no-pulse")  # which says less of the same
        told.append(dataclasses.replace(reading, findings=others).with_finding(finding))
    return told


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
    return float(np.max(above)) > SWINGS_OUT * noise
