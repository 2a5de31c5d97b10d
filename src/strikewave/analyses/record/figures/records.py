"""Pictures of measured records: the record, its blows over each other, and its velocity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.base.shock_quantities import usual_unit
from strikewave.records.health_notice import HealthNotice
from strikewave.records.measuring import RecordedPulse
from strikewave.records.pulses import robust_line
from strikewave.records.reading import ChannelReading
from strikewave.reporting.numbers import ShownQuantity, axis_unit
from strikewave.reporting.style import (
    BLUE,
    GREEN,
    GREY,
    MOST_PULSES,
    ORANGE,
    RED,
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
Named = tuple[str, ChannelReading]
"""A file as it shall be called, and what a channel of it says."""

COLUMNS = 800
"""Columns of a record into which all samples are gathered; each keeps its smallest and its largest, so that no peak is
lost. As many as a page is wide in pixels."""
POINTS = 6000
"""Points of all pulses of an overlay together, so that its SVG stays small."""
MOST_LABELS = 16
"""Pulses that are all numbered; of more only those with room, or the numbers overlap."""
MOST_NAMES = 8
"""Files that an overlay tells apart: as many as there are colours."""
MOST_AVERAGED = 100
"""Pulses of which a median is taken, evenly among all: its error is then an eighth of their scatter, a line's width."""
LARGEST_DRAWN = 1e200
"""Records with larger values are not drawn: the axes' squares and sums would be no numbers."""
_HALO = {"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.6}
_SEVERITY = {"bad": RED, "suspect": ORANGE, "good": GREY}
_COLOURS = (BLUE, RED, GREEN, ORANGE, "#CC79A7", "#56B4E9", "#000000", GREY)


@dataclass(frozen=True)
class ChannelStyle(ShownQuantity):
    """How a channel is drawn: what it is, and what its integral is, with the SI unit of that."""

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
"""What a channel of an SI unit and its integral are called, and the SI unit of the integral."""


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
    """Draw a whole record with its baseline, blows and findings, and its largest blow beside it.

    Parameters
    ----------
    reading : ChannelReading
        Of any status; where nothing can be drawn, a line says why.
    """
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
    """Draw the blows of one channel over files, aligned at their peaks, baseline taken off, with their median.

    Parameters
    ----------
    readings : sequence of (str, ChannelReading)
        Each with the name of its file; bad ones are left out.
    """
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
    """Draw the integral of a record, the zero before its first blow taken off, with the change of each blow.

    Parameters
    ----------
    reading : ChannelReading
        A record without blows has no zero to begin from; the picture has a note of it.
    """
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
