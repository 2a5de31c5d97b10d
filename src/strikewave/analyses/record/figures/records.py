"""Pictures of measured records: the record, its blows over each other, motion, two sensors, responses, many files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.record.rows import RecordMotion
from strikewave.analyses.record.sensors import RecordPair
from strikewave.base.shock_quantities import usual_unit
from strikewave.records.campaign import Campaign
from strikewave.records.contacts import robust_line
from strikewave.records.health_notice import HealthNotice
from strikewave.records.measuring import RecordedPulse
from strikewave.records.reading import ChannelReading
from strikewave.records.response import EFFECTIVE, MeasuredResponse
from strikewave.records.two_sensors import Transfer
from strikewave.reporting.numbers import ShownQuantity, axis_unit, headed, with_unit
from strikewave.reporting.style import (
    BLUE,
    GREEN,
    GREY,
    MOST_PULSES,
    ORANGE,
    RED,
    WHOLE,
    legend_below,
    new_figure,
    plain,
    quiet,
    thin,
)
from strikewave.signal.motion import integral

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
Named = tuple[str, ChannelReading]  # a file as it shall be called, and what a channel of it says

# Columns of a record into which all samples are gathered; each keeps its smallest and its largest, so that no peak is
# lost. As many as a page is wide in pixels
COLUMNS = 800
POINTS = 6000  # points of all pulses of an overlay together, so that its SVG stays small
MOST_LABELS = 16  # pulses that are all numbered; of more only those with room, or the numbers overlap
MOST_NAMES = 8  # files that an overlay tells apart: as many as there are colours
# Pulses of which a median is taken, evenly among all: its error is then an eighth of their scatter, a line's width
MOST_AVERAGED = 100
LARGEST_DRAWN = 1e200  # records with larger values are not drawn: the axes' squares and sums would be no numbers
_HALO = {"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.6}
_SEVERITY = {"bad": RED, "suspect": ORANGE, "good": GREY}
_COLOURS = (BLUE, RED, GREEN, ORANGE, "#CC79A7", "#56B4E9", "#000000", GREY)


@dataclass(frozen=True)
class ChannelStyle(ShownQuantity):
    """Style of a channel: its name, and name and SI unit of its integral."""

    name: str
    integral: str
    integral_si: str

    @property
    def integral_unit(self) -> str:
        """Name of the unit in which the integral is shown."""
        return axis_unit(self.integral_si, self.integral_si)[1]

    @property
    def integral_scale(self) -> float:
        """Size of the unit in which the integral is shown, in SI."""
        return axis_unit(self.integral_si, self.integral_si)[0]

    @property
    def label(self) -> str:
        """Label of an axis."""
        return f"{self.name} ({self.unit})" if self.unit else self.name

    @property
    def integral_label(self) -> str:
        """Label of the axis of the integral."""
        return f"{self.integral} ({self.integral_unit})"


# Names of a channel of an SI unit and of its integral, and SI unit of the integral
_NAMES = {
    "m/s^2": ("acceleration", "velocity", "m/s"),
    "m/s": ("velocity", "displacement", "m"),
    "N": ("force", "impulse", "N s"),
    "Pa": ("pressure", "integral", "Pa s"),
    "m": ("displacement", "integral", "m s"),
    "V": ("voltage", "integral", "V s"),
    "1": ("strain", "integral", "s"),
    "": ("file's own numbers", "integral", "unit·s"),
}


def shown(unit: str) -> ChannelStyle:
    """Return how values of an SI unit are drawn: in their usual unit, unknown ones as the file has them.

    Examples
    --------
    >>> shown("m/s^2").label, shown("").label, shown("N").label, shown("N").integral_label
    ('acceleration (g)', "file's own numbers", 'force (kN)', 'impulse (N s)')
    """
    names = _NAMES.get(unit, ("value", "integral", f"{unit} s"))
    return ChannelStyle(unit, "m/m" if unit == "1" else usual_unit(unit), *names)


def history(reading: ChannelReading) -> Figure:
    """Draw a whole record with its baseline, blows and findings, and its largest blow beside it."""
    figure = new_figure()
    if reading.pulses and drawable(reading):
        axes, near = figure.subplots(1, 2, width_ratios=(2.0, 1.0))
        draw_history(axes, reading)
        _draw_largest(near, reading)
    else:
        draw_history(figure.add_subplot(), reading)
    return legend_below(figure)


def draw_history(axes: Any, reading: ChannelReading, columns: int = COLUMNS) -> None:
    """Draw a record on axes."""
    if not drawable(reading):
        say(axes, f"{plain(reading.channel.name)}: no record to draw")
        return
    channel, how = reading.channel, shown(reading.channel.unit)
    factor, unit = clock(channel.duration)
    time, values = thin(channel.time, channel.values, columns)
    axes.plot(time * factor, values / how.scale, color=BLUE, linewidth=0.8)
    places = np.array([channel.time[0], *(p.begin for p in reading.pulses), channel.time[-1]])
    line = robust_line(channel.values)
    offsets = [p.offset for p in reading.pulses]
    zero = [offsets[0], *offsets, offsets[-1]] if offsets else [line.at(0), line.at(channel.values.size - 1)]
    axes.plot(places * factor, np.array(zero) / how.scale, "--", color="black", linewidth=0.9, label="baseline")
    quiet(axes, plain(channel.name) + ("" if reading.pulses else ": no blow found"), f"time ({unit})", how.label)
    axes.margins(x=0.01, y=0.14)
    _mark_pulses(axes, reading.pulses, factor, how.scale)
    _mark_findings(axes, reading.findings, factor, float(channel.time[-1]))


def _mark_pulses(axes: Any, pulses: Sequence[RecordedPulse], factor: float, scale: float) -> None:
    """Shade each pulse; mark its peak, with its number where there is room."""
    left, right = axes.get_xlim()
    _shade(axes, pulses, factor)
    places = [(pulse.time * factor, (pulse.offset + pulse.peak) / scale) for pulse in pulses]
    if places:
        time, heights = np.array(places).T
        _dots(axes, time, heights, "peak")
    free = -np.inf
    for k, (pulse, place) in enumerate(zip(pulses, places, strict=True), 1):
        if len(pulses) <= MOST_LABELS or place[0] >= free:
            free = place[0] + 0.045 * (right - left)
            up = pulse.peak >= 0.0
            axes.annotate(
                str(k), place, (0, 4 if up else -4), textcoords="offset points", ha="center",
                va="bottom" if up else "top", fontsize=8, bbox=_HALO, zorder=5,
            )  # fmt: skip


def _shade(axes: Any, pulses: Sequence[RecordedPulse], factor: float) -> None:
    """Shade pulses from begin to end, over the whole height; those that no pixel parts are one."""
    left, right = axes.get_xlim()
    spans: list[tuple[float, float]] = []
    for begin, end in ((pulse.begin * factor, pulse.end * factor) for pulse in pulses):
        if spans and begin - spans[-1][1] < (right - left) / COLUMNS:
            begin, last = spans.pop()
            end = max(end, last)
        spans.append((begin, end))
    if spans:
        bars = [(begin, end - begin) for begin, end in spans]
        across = axes.get_xaxis_transform()
        axes.broken_barh(bars, (0.0, 1.0), transform=across, color=BLUE, alpha=0.13, linewidth=0, label="blow")


def _dots(axes: Any, time: Array, heights: Array, label: str = "_") -> None:
    """Mark places of pulses; of thousands the highest and the lowest of each pixel."""
    axes.plot(*thin(time, heights, COLUMNS), "o", color=RED, markersize=3.5, label=label, zorder=4)


def _mark_findings(axes: Any, findings: Sequence[HealthNotice], factor: float, last: float) -> None:
    """Mark findings that have a time: hatched from begin to end, a dotted line where only one is known.

    What harms no figure, such as rebounds all along a train, has its line too: nothing is wrong between them.
    """
    labelled: set[str] = set()
    for finding in findings:
        if not np.isfinite(finding.start):
            continue
        label = "_" if finding.code in labelled else finding.code
        labelled.add(finding.code)
        colour = _SEVERITY.get(finding.severity, GREY)
        begin = min(finding.start, last) * factor
        if np.isfinite(finding.end) and finding.harms:
            axes.axvspan(
                begin,
                finding.end * factor,
                facecolor="none",
                edgecolor=colour,
                hatch="////",
                linewidth=0.8,
                label=label,
            )
        else:
            axes.axvline(begin, color=colour, linestyle=":", linewidth=1.2, label=label)


def _draw_largest(axes: Any, reading: ChannelReading) -> None:
    """Draw the largest blow: the record, its smooth pulse, its feet."""
    channel, how = reading.channel, shown(reading.channel.unit)
    pulse = max(reading.pulses, key=lambda p: abs(p.peak))
    reach = 0.75 * (pulse.end - pulse.begin)
    factor, unit = clock(3.0 * reach)
    inside = (channel.time >= pulse.begin - reach) & (channel.time <= pulse.end + reach)
    time, values = thin(channel.time[inside], channel.values[inside], COLUMNS // 3)
    marker = "." if time.size <= 120 else ""
    axes.axvspan((pulse.begin - pulse.time) * factor, (pulse.end - pulse.time) * factor, color=BLUE, alpha=0.13, lw=0)
    axes.axhline(pulse.offset / how.scale, color="black", linestyle="--", linewidth=0.9)
    axes.plot((time - pulse.time) * factor, values / how.scale, marker=marker, color=BLUE, linewidth=1.2)
    fine = np.linspace(pulse.begin - reach, pulse.end + reach, 160)
    smooth = (pulse.offset + pulse.smooth.at(fine)) / how.scale
    axes.plot((fine - pulse.time) * factor, smooth, "--", color=ORANGE, linewidth=1.3, label="smooth pulse")
    if pulse.rigid is not None and pulse.differs_without_ringing:
        rigid = (pulse.offset + pulse.rigid.shape.at(fine)) / how.scale
        axes.plot((fine - pulse.time) * factor, rigid, color=GREEN, linewidth=1.6, label="without ringing")
    axes.plot([0.0], [(pulse.offset + pulse.peak) / how.scale], "o", color=RED, markersize=3.5, zorder=4)
    number = reading.pulses.index(pulse) + 1
    title = "The blow" if len(reading.pulses) == 1 else f"The largest blow, {number}"
    quiet(axes, title, f"time from its peak ({unit})", how.label)


def overlay(readings: Sequence[Named]) -> Figure:
    """Draw the blows of one channel over files, aligned at their peaks, baseline taken off, with their median."""
    figure = new_figure()
    draw_overlay(figure.add_subplot(), readings)
    return legend_below(figure)


def draw_overlay(axes: Any, readings: Sequence[Named], names: bool = True) -> None:
    """Draw an overlay on axes."""
    used = [(name, r) for name, r in readings if r.status != "bad" and r.pulses and _drawable_pulses(r)]
    pulses = [(name, r, p) for name, r in used for p in r.pulses]
    if not pulses:
        bad = bool(readings) and all(reading.status == "bad" for _, reading in readings)
        say(axes, "there is no blow to draw" + (": every record is bad" if bad else ""))
        return
    how = shown(used[0][1].channel.unit)
    span = float(np.median([p.end - p.begin for _, _, p in pulses]))
    factor, unit = clock(2.0 * span)
    named = names and 1 < len(used) <= MOST_NAMES
    drawn = [pulses[i] for i in np.unique(np.linspace(0, len(pulses) - 1, MOST_PULSES).round().astype(int))]
    labelled: set[str] = set()
    for name, reading, pulse in drawn:
        time, values = _about(reading, pulse, -1.2 * span, 2.0 * span)
        time, values = thin(time, values, max((POINTS if names else POINTS // 2) // (2 * len(drawn)), 30))
        colour = (
            _COLOURS[[n for n, _ in used].index(name) % len(_COLOURS)]
            if named
            else BLUE
            if len(pulses) == 1
            else "#8C8C8C"
        )
        label = "_" if name in labelled or not named else plain(name, 32)
        axes.plot(
            time * factor,
            values / how.scale,
            color=colour,
            linewidth=0.9 if named or len(pulses) > 1 else 1.4,
            label=label,
        )
        labelled.add(name)
    if len(pulses) > 1:
        grid, median = _median(pulses, span)
        axes.plot(
            grid * factor,
            median / how.scale,
            color=BLUE,
            linewidth=5.0 if named else 2.0,
            alpha=0.3 if named else 1.0,
            zorder=1.5 if named else 3.0,
            label="median",
        )
    what = f"{len(pulses)} blows" if len(pulses) > 1 else "one blow"
    many = f" of {len(used)} files" if len(used) > 1 else ""
    some = "" if len(drawn) == len(pulses) else f", {len(drawn)} drawn"
    over = ", aligned at their peaks" if names and len(pulses) > 1 else ""
    quiet(axes, f"{what[0].upper()}{what[1:]}{many}{over}{some}", f"time from the peak ({unit})", how.label)


def _about(reading: ChannelReading, pulse: RecordedPulse, before: float, after: float) -> tuple[Array, Array]:
    """Return time from the peak and values above the baseline, around a pulse."""
    channel = reading.channel
    first = max(round((pulse.time + before - channel.start) / channel.step), 0)
    last = round((pulse.time + after - channel.start) / channel.step) + 1
    values = channel.values[first : max(last, first + 2)]
    time = channel.start + channel.step * np.arange(first, first + values.size) - pulse.time
    return np.asarray(time, dtype=np.float64), values - pulse.offset


def _median(pulses: Sequence[tuple[str, ChannelReading, RecordedPulse]], span: float) -> tuple[Array, Array]:
    """Return the median of pulses, where at least half of them have samples."""
    grid: Array = np.linspace(-1.2 * span, 2.0 * span, 320)
    chosen = np.unique(np.linspace(0, len(pulses) - 1, MOST_AVERAGED).round().astype(int))
    rows = []
    for i in chosen:
        time, values = _about(pulses[i][1], pulses[i][2], -1.2 * span, 2.0 * span)
        rows.append(np.interp(grid, time, values, left=np.nan, right=np.nan))
    known = np.isfinite(rows).sum(axis=0) >= 0.5 * len(rows)
    median: Array = np.nanmedian(np.array(rows)[:, known], axis=0)
    return grid[known], median


def velocity(reading: ChannelReading) -> Figure:
    """Draw the integral of a record, the zero before its first blow taken off, with the change of each blow."""
    figure = new_figure()
    draw_velocity(figure.add_subplot(), reading)
    return figure


def draw_velocity(axes: Any, reading: ChannelReading, room: float = 0.055) -> None:
    """Draw an integrated record on axes."""
    how = shown(reading.channel.unit)
    if not (reading.pulses and drawable(reading)):
        say(axes, f"no blow was found: there is no {how.integral} to draw")
        return
    channel, first = reading.channel, reading.pulses[0]
    factor, unit = clock(channel.duration)
    above = channel.values - first.offset
    total = integral(above, channel.step)
    total -= float(np.interp(first.begin, channel.time, total))
    time, values = thin(channel.time, total / how.integral_scale, COLUMNS)
    axes.plot(time * factor, values, color=BLUE, linewidth=1.2)
    axes.axhline(0.0, color=GREY, linestyle="--", linewidth=1.0)
    title = f"{how.integral[0].upper()}{how.integral[1:]}, and its change by each blow"
    quiet(axes, title, f"time ({unit})", how.integral_label)
    axes.margins(x=0.01, y=0.16)
    left, right = axes.get_xlim()
    if first.end * factor < left + 1.3 * room * (right - left):
        axes.set_xlim(left - room * (right - left), right)
    _shade(axes, reading.pulses, factor)
    ends = np.array([pulse.end for pulse in reading.pulses])
    heights = np.interp(ends, channel.time, total) / how.integral_scale
    _dots(axes, ends * factor, heights)
    free = -np.inf
    for pulse, place in zip(reading.pulses, zip(ends * factor, heights, strict=True), strict=True):
        if place[0] >= free:
            free = place[0] + room * (right - left)
            up = pulse.velocity_change >= 0.0
            axes.annotate(
                f"{pulse.velocity_change / how.integral_scale:+.3g}".replace("-", "−"), place, (-5, 4 if up else -4),
                textcoords="offset points", ha="right", va="bottom" if up else "top", fontsize=8, bbox=_HALO,
            )  # fmt: skip


def say(axes: Any, words: str) -> None:
    """Write what cannot be drawn; a picture of nothing else becomes low."""
    axes.set_axis_off()
    axes.text(0.5, 0.5, words, ha="center", va="center", transform=axes.transAxes, color="#4D5760")
    if len(axes.figure.axes) == 1:
        axes.figure.set_figheight(0.9)


def clock(duration: float) -> tuple[float, str]:
    """Return factor and unit of a time axis."""
    size, unit = axis_unit("s", "us" if duration < 2e-3 else "ms" if duration < 10.0 else "s")
    return 1.0 / size, unit


def _drawable_pulses(reading: ChannelReading) -> bool:
    """Tell whether the pulses of a record can be drawn, without a look at its samples: they may lie on disk."""
    return reading.channel.step > 0.0 and all(abs(pulse.peak) < LARGEST_DRAWN for pulse in reading.pulses)


def drawable(reading: ChannelReading) -> bool:
    """Tell whether a record has a clock and finite samples."""
    values = reading.channel.values
    return values.size > 1 and reading.channel.step > 0.0 and bool(np.all(np.abs(values) < LARGEST_DRAWN))


def motion_figure(record: RecordMotion) -> Figure:
    """Draw velocity and displacement over time, their drift shaded."""
    figure = new_figure()
    rows: Any = figure.subplots(1, 2)
    factor, seconds = clock(float(np.ptp(record.time)))
    places = np.unique(np.linspace(0, record.time.size - 1, min(record.time.size, 2 * COLUMNS)).round().astype(int))
    for axes, name, si, usual in zip(rows, ("velocity", "displacement"), ("m/s", "m"), ("m/s", "mm"), strict=True):
        size, _ = axis_unit(si, usual)
        values, drift = (getattr(record.motion, key)[places] / size for key in (name, f"{name}_drift"))
        time = record.time[places] * factor
        axes.fill_between(time, values - drift, values + drift, color=BLUE, alpha=0.2, linewidth=0)
        axes.plot(time, values, color=BLUE, linewidth=1.2)
        quiet(axes, name.capitalize(), f"time ({seconds})", headed(name, si, usual))
        axes.margins(x=0.01)
    return figure


BEFORE, AFTER = 1.5, 12.0  # widths of the blow that are drawn before its begin and after it
BEYOND = 3.0  # times the highest frequency that is trusted up to which a transfer function is drawn
LARGEST = 10.0  # gain up to which it is drawn, at most


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


SIZE = (9.8, 5.0)  # inches: two rows
BESIDE = 0.1  # share of what is shown that is left before the first blow, and after the last decay
ENVELOPE = 200  # points of an envelope
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


TRENDS = ("peak", "width", "velocity_change", "interval")  # figures whose trend is drawn
# Names of the figures in the unit of their channel
OF_CHANNEL = {"peak": "peak", "rigid_peak": "peak without ringing", "rms": "RMS", "amplitude": "amplitude"}
# How figures without a unit are shown: size, name and unit
PURE = {"ratio": (1.0, "peak over base", ""), "damping": (0.01, "damping ratio", "%")}


def trend(campaign: Campaign, count: int = 0) -> Figure:
    """Draw peak, width, velocity change and interval over the files, with mean, its 95 % bounds, and a clear trend."""
    names = [name for name in TRENDS if campaign.points.get(name)] or [TRENDS[0]]
    size = {1: WHOLE, 2: WHOLE, 3: (9.8, 3.3), 4: (9.8, 5.8)}[len(names)]
    figure = new_figure(size)
    figure.get_layout_engine().set(wspace=0.05, hspace=0.05)  # type: ignore[union-attr,call-arg]
    grid = figure.subplots(2, 2) if len(names) == 4 else figure.subplots(1, len(names))
    panels = np.atleast_1d(grid).ravel()
    for axes, name in zip(panels, names, strict=True):
        draw_trend(axes, campaign, name, campaign.unit, count)
    return legend_below(figure)


def draw_trend(axes: Any, campaign: Campaign, name: str, unit: str, count: int = 0) -> None:
    """Draw the trend of one figure on axes."""
    points = campaign.points.get(name, ())
    left_out = len({path for path, harmed, _ in campaign.left_out if name in harmed})
    gone = f"{left_out} file{'s' if left_out != 1 else ''} left out"
    if not points:
        say(axes, f"no file gave a value: {gone}")
        return
    scale, what, shown_unit = figure_unit(name, unit)
    x = np.array([k + 1 for k, _ in points], dtype=float)
    y = np.array([value for _, value in points]) / scale
    mean = campaign.statistics[name]
    ends = np.array([0.5, max(count, int(x.max())) + 0.5])
    if np.isfinite(mean.low):
        axes.fill_between(
            ends,
            max(mean.low / scale, 0.0) if y.min() > 0.0 else mean.low / scale,  # none can be on the other side
            min(mean.high / scale, 0.0) if y.max() < 0.0 else mean.high / scale,
            color=BLUE,
            alpha=0.15,
            linewidth=0,
            label="95 % bounds of the mean",
        )
    axes.plot(ends, [mean.mean / scale] * 2, color=BLUE, linewidth=1.2, label="mean")
    if name in campaign.trends and campaign.trends[name].significant:
        slope = campaign.trends[name].slope / scale
        along = np.array([x.min(), x.max()])
        axes.plot(along, np.median(y - slope * x) + slope * along, "--", color=RED, linewidth=1.4, label="trend")
    axes.plot(x, y, "o", color="#333333", markersize=4, alpha=0.8, label="blows", zorder=4)
    quiet(axes, what[0].upper() + what[1:] + (f" ({gone})" if left_out else ""), "file", f"{what} ({shown_unit})")
    axes.set_xlim(*ends)
    axes.margins(y=0.1)
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.ticklabel_format(axis="y", useOffset=False)


def figure_unit(name: str, unit: str) -> tuple[float, str, str]:
    """Return how much SI the shown unit of a figure is, what the figure is called, and the unit.

    Examples
    --------
    >>> figure_unit("width", "m/s^2"), figure_unit("velocity_change", "N")
    ((1e-06, 'pulse width at 10 %', 'µs'), (1.0, 'impulse change', 'N s'))
    """
    how = shown(unit)
    if name in OF_CHANNEL:
        return how.scale, OF_CHANNEL[name], how.unit or how.name
    if name in PURE:
        return PURE[name]
    if name == "velocity_change":
        return how.integral_scale, f"{how.integral} change", how.integral_unit
    si, usual, called = {
        "ringing_frequency": ("Hz", "kHz", "ringing frequency"),
        "interval": ("s", "ms", name),
        "rise": ("s", "us", "rise time 10-90 %"),
        "width": ("s", "us", "pulse width at 10 %"),
        "rigid_width": ("s", "us", "pulse width at 10 % without ringing"),
        "delay": ("s", "ms", name),
        "duration": ("s", "ms", "effective duration"),
        "decay_time": ("s", "ms", "decay time (to 1/e)"),
        "frequency": ("Hz", "Hz", name),
    }[name]
    size, shown_as = axis_unit(si, usual)
    return size, called, shown_as
