"""Picture of a response channel: the base above, the response below, and how its modes die out."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from strikewave.analyses.record.figures.records import COLUMNS, clock, shown
from strikewave.records.reading import ChannelReading
from strikewave.records.response import EFFECTIVE, MeasuredResponse
from strikewave.reporting.numbers import with_unit
from strikewave.reporting.style import BLUE, GREEN, GREY, ORANGE, RED, legend_below, new_figure, plain, quiet, thin

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZE = (9.8, 5.0)
"""Inches: two rows."""
BESIDE = 0.1
"""Share of what is shown that is left before the first blow, and after the last decay."""
ENVELOPE = 200
"""Points of an envelope."""
_MODES = (RED, GREEN, ORANGE)


def response_figure(base: ChannelReading, reading: ChannelReading) -> Figure:
    """Draw a base and a channel that answers it, from before the first blow to the end of the last decay."""
    figure = new_figure(SIZE)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(1.0, 1.6))
    responses = reading.responses
    begin = base.pulses[responses[0].blow - 1].begin
    end = max(one.decay.end for one in responses)
    room = BESIDE * (end - begin)
    factor, unit = clock(end - begin)
    for axes, one in ((above, base), (below, reading)):
        zero = base.baseline if one is base else responses[0].zero
        _draw(axes, one, zero, begin - room, end + room, factor)
    for pulse in base.pulses:
        above.axvspan(pulse.begin * factor, pulse.end * factor, color=BLUE, alpha=0.13, linewidth=0)
    tops = [(pulse.time * factor, pulse.peak / shown(base.channel.unit).scale) for pulse in base.pulses]
    above.plot(*zip(*tops, strict=True), "o", color=RED, markersize=3.5, zorder=4)
    for k, response in enumerate(responses):
        _mark(below, response, factor, shown(reading.channel.unit).scale, labelled=k == 0)
    quiet(above, f"Base: {plain(base.channel.name)}", "", shown(base.channel.unit).label)
    quiet(below, f"Response: {plain(reading.channel.name)}", f"time ({unit})", shown(reading.channel.unit).label)
    below.set_xlim((begin - room) * factor, (end + room) * factor)
    return legend_below(figure)


def _draw(axes: Any, reading: ChannelReading, zero: float, begin: float, end: float, factor: float) -> None:
    """Draw a stretch of a channel above its zero."""
    channel = reading.channel
    first, last = (round((time - channel.start) / channel.step) for time in (begin, end))
    first, last = max(first, 0), min(last + 1, channel.values.size)
    places = np.asarray(channel.start + channel.step * np.arange(first, last), dtype=np.float64)
    time, values = thin(places, channel.values[first:last] - zero, COLUMNS)
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    axes.plot(time * factor, values / shown(channel.unit).scale, color=BLUE, linewidth=0.9)


def _mark(axes: Any, one: MeasuredResponse, factor: float, scale: float, labelled: bool) -> None:
    """Mark the peak and the effective duration of a response, and draw the envelopes of its modes."""

    def called(words: str) -> str:
        return words if labelled else "_"

    span = np.array([one.begin, one.begin + one.duration]) * factor
    level = EFFECTIVE * abs(one.peak) / scale
    axes.axvspan(*span, color=GREY, alpha=0.13, linewidth=0, label=called("effective duration"))
    axes.plot(span, [level] * 2, ":", color=GREY, linewidth=1.2, label=called("a third of the peak"))
    axes.plot(span, [-level] * 2, ":", color=GREY, linewidth=1.2)
    axes.plot([one.time * factor], [one.peak / scale], "o", color=RED, markersize=3.5, zorder=4, label=called("peak"))
    time = np.linspace(one.decay.begin, one.decay.end, ENVELOPE)
    for mode, colour in zip(one.modes, _MODES, strict=False):
        envelope = mode.amplitude / scale * np.exp(-(time - one.decay.begin) / mode.decay_time)
        label = called(f"decay of {with_unit(mode.frequency, 'Hz', 'kHz')}")
        axes.plot(time * factor, envelope, "--", color=colour, linewidth=1.2, label=label)
        axes.plot(time * factor, -envelope, "--", color=colour, linewidth=1.2)
