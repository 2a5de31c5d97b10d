"""Pictures of spectra: amplitude of a blow, shock response spectra, four-coordinate paper; the summary of records."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.record.figures import records
from strikewave.analyses.record.figures.records import clock, drawable, say, shown
from strikewave.analyses.record.rows import best_of, usable
from strikewave.records.campaign import Campaign
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.reporting.numbers import axis_unit, headed, hertz
from strikewave.reporting.style import (
    BLUE,
    DASHES,
    GREEN,
    GREY,
    ORANGE,
    RED,
    legend_below,
    new_figure,
    plain,
    quiet,
    thin,
)
from strikewave.signal.srs import Spectrum, all_srs, octaves

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strikewave.analyses.record.spectrum import SpectrumResult

Array = NDArray[np.float64]

# Columns of a logarithmic axis into which the lines of a spectrum are gathered: about the pixels of its width
COLUMNS = 600
# Lengths of a blow on both sides of it that its amplitude spectrum takes in: its lowest line is then a 40th of one over
# the length, far below where a pulse's spectrum falls, and ringing is in it
REACH = 20.0
LEAST_DRAWN = 1e-3  # share of a spectrum down to which its band is drawn: a logarithmic axis has no zero
DEPTH = 1e-6  # share of its largest value to which an amplitude spectrum is drawn: 120 dB, beyond every recorder's bits
# Lengths of the last blow after it that a shock response spectrum takes in: its lowest natural frequency, a 50th of one
# over the length, then swings twice after the blow
AFTER = 100.0
BEFORE = 5.0  # lengths of the longest blow before the first one that it takes in, so that the record begins at rest
Q = 10.0  # quality factor of the spectra of a report: 5 % of critical damping, as shock specifications take it
_SIDES = (("maximax", "#8FC3E4", "-", 4.0), ("positive", BLUE, "-", 1.3), ("negative", RED, "--", 1.3))
_COLOURS = (BLUE, RED, GREEN, ORANGE, GREY)
KINDS = ("absolute", "pseudo-velocity")  # kinds of spectra that a report shows of a record
# Spectra of readings in use, by kind: page and picture show the same, and those of a long record take seconds
_RESPONSES: WeakKeyDictionary[ChannelReading, dict[str, Spectrum]] = WeakKeyDictionary()


class RecordPart(NamedTuple):
    """A part of a record, its baseline taken off."""

    values: Array
    step: float


def around(reading: ChannelReading) -> RecordPart:
    """Return the stretch around the largest blow, tapered at its ends, as far as half way to its neighbours."""
    channel, pulses = reading.channel, reading.pulses
    k = max(range(len(pulses)), key=lambda i: abs(pulses[i].peak))
    pulse = pulses[k]
    reach = max(REACH * (pulse.end - pulse.begin), 32 * channel.step)
    begin = max(pulse.begin - reach, 0.5 * (pulses[k - 1].end + pulse.begin) if k else -math.inf)
    end = min(pulse.end + reach, 0.5 * (pulse.end + pulses[k + 1].begin) if k + 1 < len(pulses) else math.inf)
    values = _between(reading, begin, end) - pulse.offset
    edge = max(values.size // 20, 1)
    ramp = 0.5 - 0.5 * np.cos(np.pi * (np.arange(edge) + 0.5) / edge)
    values[:edge] *= ramp
    values[-edge:] *= ramp[::-1]
    return RecordPart(values, channel.step)


def _between(reading: ChannelReading, begin: float, end: float) -> Array:
    """Return a copy of the samples between two times; at least two."""
    channel = reading.channel
    first = min(max(math.floor((begin - channel.start) / channel.step), 0), channel.values.size - 2)
    last = min(math.ceil((end - channel.start) / channel.step) + 1, channel.values.size)
    return channel.values[first : max(last, first + 2)].copy()


def amplitude(reading: ChannelReading) -> tuple[Array, Array]:
    """Return frequency (Hz) and Fourier magnitude |X(f)| of the stretch around the largest blow."""
    stretch = around(reading)
    size = 1 << max(math.ceil(math.log2(4 * stretch.values.size)), 10)
    magnitude = np.abs(np.fft.rfft(stretch.values, size)) * stretch.step
    frequency = np.fft.rfftfreq(size, stretch.step)
    resolved = frequency >= 0.5 / (stretch.values.size * stretch.step)
    return np.asarray(frequency[resolved]), np.asarray(magnitude[resolved])


def spectrum(reading: ChannelReading, advised: float | None = None) -> Figure:
    """Draw the amplitude spectrum of the largest blow, with ringing, advised cutoff (Hz) and half the sampling rate.

    At low frequency an acceleration's spectrum is its velocity change, so it is drawn in m/s.
    """
    figure = new_figure()
    axes: Any = figure.add_subplot()
    if not (reading.pulses and drawable(reading)):
        say(axes, "no blow was found: there is no spectrum to draw")
        return figure
    how = shown(reading.channel.unit)
    frequency, magnitude = _thin_log(*amplitude(reading))
    top = float(magnitude.max())
    if not top > 0.0:
        say(axes, "the stretch around the blow is zero: there is no spectrum to draw")
        return figure
    hertz_size, _ = axis_unit("Hz", "Hz")
    axes.loglog(
        frequency / hertz_size,
        np.maximum(magnitude, 0.1 * DEPTH * top) / how.integral_scale,
        color=BLUE,
        linewidth=1.0,
        label="the largest blow",
    )
    pulse = max(reading.pulses, key=lambda p: abs(p.peak))
    marks = [("half the sampling rate", 0.5 * reading.channel.sampling_rate, GREY, "-")]
    if advised is not None:
        marks.insert(0, ("advised cutoff", advised, GREEN, "--"))
    if pulse.ringing_frequency > 0.0:
        marks.insert(0, ("ringing", pulse.ringing_frequency, RED, "-."))
    for name, place, colour, style in marks:
        axes.axvline(place / hertz_size, color=colour, linestyle=style, linewidth=1.3, label=f"{name}, {hertz(place)}")
    unit = how.integral_unit
    quiet(axes, "Amplitude spectrum of the largest blow", headed("frequency", "Hz", "Hz"), f"|X(f)| ({unit})")
    axes.set_ylim(max(float(magnitude.min()), DEPTH * top) / how.integral_scale, 3.0 * top / how.integral_scale)
    axes.set_xlim(frequency[0] / hertz_size, 1.08 * max(place for _, place, _, _ in marks) / hertz_size)
    log_axis(axes.xaxis, hertz_ticks())
    log_axis(axes.yaxis, number_tick)
    return legend_below(figure)


def _thin_log(frequency: Array, magnitude: Array, columns: int = COLUMNS) -> tuple[Array, Array]:
    """Keep the smallest and the largest magnitude of each column of a logarithmic axis."""
    if frequency.size <= 2 * columns:
        return frequency, magnitude
    column = np.floor(columns * np.log(frequency / frequency[0]) / math.log(frequency[-1] / frequency[0]))
    starts = np.flatnonzero(np.diff(column, prepend=-1.0))
    low, high = np.minimum.reduceat(magnitude, starts), np.maximum.reduceat(magnitude, starts)
    single = np.diff(starts, append=frequency.size) == 1
    distinct = np.ravel(np.column_stack([np.ones(starts.size, bool), ~single]))
    return np.repeat(frequency[starts], 2)[distinct], np.ravel(np.column_stack([high, low]))[distinct]


def response(reading: ChannelReading, kind: str = "absolute") -> Spectrum | None:
    """Return the shock response spectrum of a record, its baseline taken off; None where no blow was found.

    It is taken from just before the first blow to 100 lengths of the last one after it, at 12 frequencies an
    octave: from 1/50 of that of the longest blow to twenty times it, inside what the record can show.
    """
    if not (reading.pulses and drawable(reading)):
        return None
    if reading not in _RESPONSES:
        _RESPONSES[reading] = {one.kind: one for one in _responses(reading)}
    return _RESPONSES[reading].get(kind)


def _responses(reading: ChannelReading) -> list[Spectrum]:
    first, last = reading.pulses[0], reading.pulses[-1]
    length = max(pulse.end - pulse.begin for pulse in reading.pulses)
    values = _between(reading, first.begin - BEFORE * length, last.end + AFTER * length) - first.offset
    step = reading.channel.step
    low, high = max(0.02 / length, 1.0 / (values.size * step)), min(20.0 / length, 0.4 / step)
    if not low < 0.2 / step:
        return []
    return all_srs(values, step, octaves(low, max(high, 2.0 * low)), [(kind, Q) for kind in KINDS])


def srs_figure(
    *spectra: Spectrum,
    labels: Sequence[str] = (),
    unit: str = "m/s^2",
    expanded: Array | None = None,
    side: str = "maximax",
) -> Figure:
    """Draw a shock response spectrum, both polarities and the larger; of several the larger of each."""
    figure = new_figure()
    axes: Any = figure.add_subplot()
    if expanded is not None and np.any(np.isfinite(expanded)):
        values, (scale, _) = spectra[0].side(side), response_unit(spectra[0].kind, unit)
        low, high = np.maximum(values - expanded, LEAST_DRAWN * values), values + expanded
        place, label = np.asarray(spectra[0].frequency) / axis_unit("Hz", "Hz")[0], f"{side} ± U (k = 2)"
        axes.fill_between(place, low / scale, high / scale, color=ORANGE, alpha=0.35, linewidth=0.0, label=label)
    draw_srs(axes, spectra, labels, unit)
    return figure


def draw_srs(axes: Any, spectra: Sequence[Spectrum], labels: Sequence[str] = (), unit: str = "m/s^2") -> None:
    """Draw shock response spectra on axes."""
    if not any(np.any(one.maximax > 0.0) for one in spectra):
        say(axes, "there is no shock response spectrum to draw")
        return
    scale, label = response_unit(spectra[0].kind, unit)
    hertz_size, _ = axis_unit("Hz", "Hz")
    names = [*map(plain, labels), *(f"spectrum {k + 1}" for k in range(len(labels), len(spectra)))]
    several = [(names[k], one, "maximax", _COLOURS[k % 5], DASHES[k % 4], 1.4) for k, one in enumerate(spectra)]
    single = [(side, spectra[0], side, colour, style, width) for side, colour, style, width in _SIDES]
    for name, one, side, colour, style, width in several if len(spectra) > 1 else single:
        positive = one.side(side) > 0.0
        values = one.side(side)[positive] / scale
        axes.loglog(
            one.frequency[positive] / hertz_size, values, color=colour, linestyle=style, linewidth=width, label=name
        )
    q = spectra[0].q
    quiet(axes, f"Shock response spectrum, Q = {q:g}", headed("natural frequency", "Hz", "Hz"), label)
    log_axis(axes.xaxis, hertz_ticks())
    log_axis(axes.yaxis, number_tick)
    axes.legend(frameon=False, fontsize=8, loc="best")


def response_unit(kind: str, unit: str) -> tuple[float, str]:
    """Return how much SI the shown unit of a response is, and the label of its axis."""
    how = shown(unit)
    if unit != "m/s^2":
        return 1.0, f"{kind} response ({how.si})" if how.si else f"{kind} response (file's own numbers)"
    name, si, usual = {
        "absolute": ("absolute acceleration", "m/s^2", "g"),
        "displacement": ("relative displacement", "m", "mm"),
        "relative-velocity": ("relative velocity", "m/s", "m/s"),
        "pseudo-velocity": ("pseudo-velocity", "m/s", "m/s"),
        "equivalent-static": ("equivalent static acceleration", "m/s^2", "g"),
    }[kind]
    return axis_unit(si, usual)[0], headed(name, si, usual)


def tripartite(pseudo: Spectrum) -> Figure:
    """Draw a spectrum of pseudo-velocity on four-coordinate paper.

    Lines at 45 degrees are those of one displacement (rising) and of one acceleration (falling).
    """
    if pseudo.kind != "pseudo-velocity":
        raise ValueError(f"four-coordinate paper needs a spectrum of pseudo-velocity, got {pseudo.kind!r}")
    positive = pseudo.maximax > 0.0
    if not positive.any():
        figure = new_figure()
        say(figure.add_subplot(), "there is no shock response spectrum to draw")
        return figure
    (hertz_size, _), (speed, _) = axis_unit("Hz", "Hz"), axis_unit("m/s", "m/s")
    frequency, values = pseudo.frequency[positive] / hertz_size, pseudo.maximax[positive] / speed
    x = (float(np.log10(frequency[0])), float(np.log10(frequency[-1])) + 0.02)
    height = np.log10(values)
    top = float(height.max()) + 0.35
    bottom = max(float(height.min()) - 0.2, top - (x[1] - x[0]))  # no deeper than wide
    y = min(bottom, top - 1.5), top
    wide = 6.0
    figure = new_figure((wide + 2.0, wide * (y[1] - y[0]) / (x[1] - x[0]) + 1.6))
    axes: Any = figure.add_subplot()
    axes.loglog(frequency, values, color=BLUE, linewidth=2.2, zorder=5)
    quiet(axes, "", headed("natural frequency", "Hz", "Hz"), headed("pseudo-velocity", "m/s", "m/s"))
    axes.set_title(f"Pseudo-velocity, maximax, Q = {pseudo.q:g}", loc="left", fontsize=10, pad=42)
    axes.set_xlim(10.0 ** x[0], 10.0 ** x[1])
    axes.set_ylim(10.0 ** y[0], 10.0 ** y[1])
    axes.set_aspect("equal")
    axes.spines[["top", "right"]].set_visible(True)
    _rulings(axes, x, y, np.log10(frequency), np.log10(values))
    log_axis(axes.xaxis, hertz_ticks())
    log_axis(axes.yaxis, number_tick)
    return figure


def _rulings(axes: Any, x: tuple[float, float], y: tuple[float, float], along: Array, height: Array) -> None:
    """Rule lines of constant displacement (green) and of constant acceleration (red), named where they leave.

    A name at the edge that has none of the axes' own numbers stands outside; one at another edge stands inside,
    unless the curve passes there.
    """
    ends = 10.0 ** np.array(x)
    (hertz_size, _), (speed, _), (size, unit) = axis_unit("Hz", "Hz"), axis_unit("m/s", "m/s"), axis_unit("m/s^2", "g")
    depth, depth_unit = axis_unit("m", "m")
    # v = 2 pi f d and v = a / (2 pi f), all in the units shown
    turn = math.log10(2.0 * math.pi * hertz_size * depth / speed)
    fall = math.log10(size / (2.0 * math.pi * hertz_size * speed))

    def depth_words(value: float) -> str:
        return metres(value) if depth == 1.0 else f"{number_tick(value)} {depth_unit}"

    def name(words: str, px: float, py: float, turned: int, outside: bool, colour: str) -> None:
        if not outside and abs(float(np.interp(px, along, height)) - py) < 0.2:
            return
        axes.annotate(
            words, (10.0**px, 10.0**py), (1, 3) if outside and turned else (4, 0) if outside else (0, 0),
            textcoords="offset points", rotation=turned, rotation_mode="anchor", fontsize=8, color=colour,
            ha="left" if outside else "center", va="bottom" if outside and turned else "center",
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.8}, annotation_clip=False, zorder=3,
        )  # fmt: skip

    for k in range(math.ceil(y[0] - x[1] - turn), math.floor(y[1] - x[0] - turn) + 1):
        axes.loglog(ends, 10.0 ** (k + turn) * ends, color=GREEN, linewidth=0.7, alpha=0.8)
        above = y[1] - k - turn
        if above <= x[1]:
            name(depth_words(10.0**k), above, y[1], 45, True, "#00694D")
        elif x[1] - 0.25 + k + turn > y[0] + 0.15:
            name(depth_words(10.0**k), x[1] - 0.25, x[1] - 0.25 + k + turn, 45, False, "#00694D")
    for k in range(math.ceil(y[0] + x[0] - fall), math.floor(y[1] + x[1] - fall) + 1):
        axes.loglog(ends, 10.0 ** (k + fall) / ends, color=RED, linewidth=0.7, alpha=0.8)
        right = k + fall - x[1]
        below = k + fall - y[0] - 0.25
        if right >= y[0]:
            name(f"{number_tick(10.0**k)} {unit}", x[1], right, 0, True, "#A34700")
        elif below > x[0] + 0.25:
            name(f"{number_tick(10.0**k)} {unit}", below, y[0] + 0.25, -45, False, "#A34700")


def record_summary(files: Sequence[FileReading], campaign: Campaign | None, title: str = "") -> Figure:
    """Draw the first good record, all blows, a shock response spectrum, and the trend or the velocity."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 6.6), layout="constrained")
    if title:
        heading = plain(textwrap.fill(title, 95).replace("\n", " "), 190)
        figure.suptitle(textwrap.fill(heading, 95), x=0.01, ha="left", fontsize=12, fontweight="bold")
    named = [(file.path, file.channels[0]) for file in files if file.channels]
    sound = [(file.path, reading) for file, reading in usable(files) if reading is file.channels[0]]
    best = best_of(files)
    if best is None:
        say(figure.add_subplot(), "there is no record to draw")
        return figure
    (first, second), (third, fourth) = figure.subplots(2, 2)
    records.draw_history(first, best, 400)
    records.draw_overlay(second, sound or named, names=False)
    spectrum = response(best) if best.channel.unit in ("m/s^2", "") else None
    draw_srs(third, [spectrum] if spectrum is not None else [], (), best.channel.unit)
    if len(files) > 1 and campaign is not None:
        records.draw_trend(fourth, campaign, "peak", best.channel.unit, len(files))
    else:
        records.draw_velocity(fourth, best, 0.12)
    return figure


def metres(value: float) -> str:
    """Write a displacement: m, mm or µm.

    Examples
    --------
    >>> metres(1e-5), metres(1e-2), metres(1e-7)
    ('10 µm', '10 mm', '0.1 µm')
    """
    unit, size = ("m", 1.0) if value >= 0.99 else ("mm", 1e-3) if value >= 0.99e-3 else ("µm", 1e-6)
    return f"{number_tick(value / size)} {unit}"


def hertz_tick(value: float, place: object = None) -> str:
    """Write a number of an axis in Hz.

    Examples
    --------
    >>> hertz_tick(100.0), hertz_tick(2e4), hertz_tick(1e6)
    ('100', '20k', '1M')
    """
    return hertz(value).replace(" Hz", "").replace(" kHz", "k").replace(" MHz", "M")


def hertz_ticks() -> Any:
    """Return what writes the numbers of an axis of frequencies: 20k for 20 000 Hz, plain ones in another unit."""
    return hertz_tick if axis_unit("Hz", "Hz")[0] == 1.0 else number_tick


def number_tick(value: float, place: object = None) -> str:
    """Write a number of a logarithmic axis.

    Examples
    --------
    >>> number_tick(0.001), number_tick(1e4), number_tick(1e-7)
    ('0.001', '10 000', '1e-7')
    """
    if 0.99e-4 <= value < 1.01e6:
        return f"{value:,.0f}".replace(",", " ") if value >= 1000.0 else f"{value:.6g}"
    return f"{value:.1g}".replace("e-0", "e-").replace("e+0", "e+").replace("e+", "e")


def log_axis(axis: Any, written: Any) -> None:
    """Tick decades; where fewer than two are shown, 2 and 5 as well."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    decades = math.log10(high / low)
    step = (1.0, 2.0, 5.0) if decades < 2.5 else (1.0,)
    axis.set_major_locator(LogLocator(subs=step, numticks=30 if decades < 8 else 8))
    axis.set_major_formatter(FuncFormatter(written))
    axis.set_minor_formatter(NullFormatter())


MOST_NAMES = 4  # spectra that a legend names: of more, one grey is enough
DECADES = 4.0  # decades of a rolling spectrum that its colours span: below a ten-thousandth of the largest lies noise
_SHOCK_COLOURS = (BLUE, GREEN, ORANGE, "#CC79A7")
_TOGETHER = {
    "envelope": ("envelope", "black", "-"),
    "p95_50": ("P95/50", RED, "--"),
    "resultant": ("resultant", "black", "-"),
}


def several_figure(result: SpectrumResult, place: int) -> Figure:
    """Draw spectra of one kind with what they come to: thin lines of each, thick ones of all."""
    figure = new_figure()
    axes: Any = figure.add_subplot()
    one = result.spectra[place]
    size, label = response_unit(one.kind, result.reading.channel.unit)
    hertz_size, _ = axis_unit("Hz", "Hz")
    drawn = result.used or list(result.shocks)
    if not any(np.any(shock.found.spectra[place].maximax > 0.0) for shock in drawn):
        say(axes, "there is no shock response spectrum to draw")
        return figure
    few = len(drawn) <= MOST_NAMES

    def draw(values: Array, **look: Any) -> None:
        positive = values > 0.0
        axes.loglog(one.frequency[positive] / hertz_size, values[positive] / size, **look)

    for k, shock in enumerate(drawn):
        name = plain(shock.name) if few else f"each of {len(drawn)}" if k == 0 else "_"
        draw(
            shock.found.values[one.kind], color=_SHOCK_COLOURS[k] if few else GREY, linewidth=0.9,
            alpha=1.0 if few else 0.6, label=name,
        )  # fmt: skip
    for name, kinds in result.together.items():
        words, colour, dash = _TOGETHER[name]
        draw(kinds[one.kind], color=colour, linestyle=dash, linewidth=2.2, label=words)
    title = f"Shock response spectra, {result.side}, Q = {one.q:g}"
    quiet(axes, title, headed("natural frequency", "Hz", "Hz"), label)
    log_axis(axes.xaxis, hertz_ticks())
    log_axis(axes.yaxis, number_tick)
    return legend_below(figure)


def rolling_figure(result: SpectrumResult) -> Figure:
    """Draw spectra over time and natural frequency, in colours told apart by all, a diagram a channel."""
    from matplotlib.colors import LogNorm

    drawn, side, one = result.rollings[:MOST_NAMES], result.side, result.spectra[0]
    values = [rolling.values for _, rolling in drawn]
    top = max(float(np.max(each)) for each in values)
    figure = _stacked(len(drawn))
    if not top > 0.0:
        say(figure.add_subplot(), "there is no shock response spectrum to draw")
        return figure
    rows: Any = figure.subplots(len(drawn), 1, squeeze=False, sharex=True)[:, 0]
    size, label = response_unit(one.kind, result.reading.channel.unit)
    hertz_size, _ = axis_unit("Hz", "Hz")
    factor, seconds = clock(max(float(np.ptp(rolling.time)) for _, rolling in drawn) or 1e-3)
    low = max(min(float(np.min(each[each > 0.0], initial=top)) for each in values), top * 10.0**-DECADES)
    norm = LogNorm(min(low, 0.5 * top) / size, top / size)
    some = "" if len(drawn) == len(result.rollings) else f", the first {len(drawn)} of {len(result.rollings)}"
    for k, (axes, (shock, rolling), each) in enumerate(zip(rows, drawn, values, strict=True)):
        image = axes.pcolormesh(
            edges(rolling.time) * factor, np.exp(edges(np.log(rolling.frequency))) / hertz_size,
            np.maximum(each.T, low) / size, norm=norm, cmap="cividis", shading="flat", rasterized=True,
        )  # fmt: skip
        axes.set_yscale("log")
        title = f"Rolling shock response spectrum, {side}, Q = {one.q:g}{some}" if k == 0 else ""
        if len(drawn) > 1:
            title = f"{title}\n{plain(shock.name)}".strip()
        last = f"middle of the window ({seconds})" if k + 1 == len(drawn) else ""
        quiet(axes, title, last, headed("natural frequency", "Hz", "Hz"))
        axes.grid(False)
        log_axis(axes.yaxis, hertz_ticks())
    bar = figure.colorbar(image, ax=list(rows))
    bar.set_label(label, fontsize=9)
    log_axis(bar.ax.yaxis, number_tick)
    bar.outline.set_visible(False)
    return figure


def _stacked(count: int) -> Figure:
    """Return a figure that has room for so many diagrams under one another."""
    return new_figure((8.0, 1.4 + 2.0 * count)) if count > 1 else new_figure()


def edges(places: Array) -> Array:
    """Return the edges of cells around places, half way between them."""
    if places.size == 1:
        return np.asarray(places[0] + np.array([-0.5, 0.5]) * (abs(places[0]) * 0.1 or 1.0))
    middle = 0.5 * (places[1:] + places[:-1])
    return np.concatenate([[2.0 * places[0] - middle[0]], middle, [2.0 * places[-1] - middle[-1]]])


def response_figure(result: SpectrumResult) -> Figure:
    """Draw what an oscillator does while each record lasts, a diagram a kind."""
    drawn, several = result.responses[:MOST_NAMES], len(result.responses) > 1
    histories = drawn[0][1].histories
    figure = _stacked(len(histories))
    rows: Any = figure.subplots(len(histories), 1, squeeze=False, sharex=True)[:, 0]
    factor, seconds = clock(max(float(one.time[-1] - one.time[0]) for _, one in drawn))
    for k, (axes, kind) in enumerate(zip(rows, histories, strict=True)):
        size, label = response_unit(kind, result.reading.channel.unit)
        for colour, (shock, one) in zip(_SHOCK_COLOURS, drawn, strict=False):
            name = plain(shock.name) if several and k == 0 else "_"
            line = thin(one.time * factor, one.histories[kind] / size)
            axes.plot(*line, color=colour, linewidth=1.0, alpha=0.8 if several else 1.0, label=name)
        some = "" if len(drawn) == len(result.responses) else f", the first {len(drawn)} of {len(result.responses)}"
        title = f"Response of an oscillator of {hertz(drawn[0][1].frequency)}{some}" if k == 0 else ""
        quiet(axes, title, f"time ({seconds})" if k + 1 == len(histories) else "", label)
        axes.margins(x=0.01)
    return legend_below(figure) if several else figure
