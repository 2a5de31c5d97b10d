"""Pictures of two sensors on one object: their records, what they share, and the transfer function."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from strikewave.analyses.record.figures.records import COLUMNS, clock, shown
from strikewave.analyses.record.paired import RecordPair
from strikewave.records.two_sensors import Transfer
from strikewave.reporting.style import BLUE, GREEN, GREY, ORANGE, RED, legend_below, new_figure, plain, quiet, thin

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BEFORE, AFTER = 1.5, 12.0
"""Widths of the blow that are drawn before its begin and after it."""
BEYOND = 3.0
"""Times the highest frequency that is trusted up to which a transfer function is drawn."""
LARGEST = 10.0
"""Gain up to which it is drawn, at most."""


def pair_figure(pair: RecordPair) -> Figure:
    """Draw both channels over one another, and their common and differential motion."""
    figure = new_figure()
    left, right = figure.subplots(1, 2, sharey=True)
    first, second = pair.first, pair.second
    if first is None or second is None:
        return figure
    blow = max(first.pulses or second.pulses, key=lambda pulse: abs(pulse.peak))
    width = blow.width if blow.width > 0.0 else blow.smooth.width()
    size = min(first.channel.values.size, second.channel.values.size)
    time = first.channel.time[:size]
    inside = (time >= blow.begin - BEFORE * width) & (time <= blow.begin + AFTER * width)
    quiet_part = time < blow.begin - width
    how, (factor, unit) = shown(first.channel.unit), clock((BEFORE + AFTER) * width)
    pair_of = []
    for reading in (first, second):
        values = reading.channel.values[:size]
        zero = float(np.median(values[quiet_part])) if quiet_part.any() else reading.baseline
        pair_of.append((values[inside] - zero) / how.scale)
    since = (time[inside] - blow.begin) * factor
    for axes, curves in (
        (left, zip(pair_of, (first.channel.name, second.channel.name), (BLUE, ORANGE), strict=True)),
        (
            right,
            (
                (0.5 * (pair_of[0] + pair_of[1]), "common", GREEN),
                (0.5 * (pair_of[1] - pair_of[0]), "differential", RED),
            ),
        ),
    ):
        for values, name, colour in curves:
            axes.plot(*thin(since, values, COLUMNS // 2), color=colour, linewidth=1.1, label=plain(name, 32))
        axes.axhline(0.0, color=GREY, linewidth=0.8)
    quiet(left, "Both channels", f"time from the begin of the blow ({unit})", how.label)
    quiet(right, "Common and differential motion", f"time from the begin of the blow ({unit})", "")
    return legend_below(figure)


def transfer_figure(transfer: Transfer) -> Figure:
    """Draw magnitude with coherence, and phase, of a transfer function; the band that is trusted is shaded."""
    figure = new_figure()
    left, right = figure.subplots(1, 2)
    frequency = transfer.frequency / 1e3
    low, high = (value / 1e3 for value in transfer.trusted)
    last = min(BEYOND * high, float(frequency[-1])) if np.isfinite(high) else float(frequency[-1])
    seen = frequency <= last
    one, other = np.abs(transfer.h1[seen]), np.abs(transfer.h2[seen])
    known = seen & (transfer.frequency >= transfer.trusted[0]) & (transfer.frequency <= transfer.trusted[1])
    most = 1.4 * float(np.max(np.abs(transfer.h1[known]), initial=1.0))
    left.plot(frequency[seen], one, color=BLUE, linewidth=1.2, label="|H1|")
    left.plot(frequency[seen], other, "--", color=ORANGE, linewidth=1.0, label="|H2|")
    left.plot(frequency[seen], transfer.coherence[seen], ":", color=GREY, linewidth=1.2, label="coherence")
    left.axhline(1.0, color="black", linewidth=0.7)
    left.set_ylim(0.0, min(most, LARGEST))
    degrees: Any = np.degrees(np.angle(transfer.h1[seen]))
    right.plot(frequency[seen], degrees, color=BLUE, linewidth=1.2)
    right.set_ylim(-185.0, 185.0)
    right.set_yticks((-180, -90, 0, 90, 180))
    for axes in (left, right):
        if np.isfinite(low):
            axes.axvspan(low, high, color=GREEN, alpha=0.12, linewidth=0, label="trusted")
    quiet(left, "Gain, second over first", "frequency (kHz)", "gain")
    quiet(right, "Phase", "frequency (kHz)", "degrees")
    return legend_below(figure)
