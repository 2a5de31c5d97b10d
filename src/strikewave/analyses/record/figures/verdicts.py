"""Pictures of verdicts: the band, or the ideal pulse, over each shock; a specification alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from strikewave.analyses.clauses import SHOWN
from strikewave.analyses.record.figures.spectra import hertz_ticks, log_axis, number_tick
from strikewave.reporting.numbers import axis_unit, time_unit
from strikewave.reporting.style import (
    BLUE,
    GREEN,
    GREY,
    HALF,
    ORANGE,
    RED,
    WHOLE,
    legend_below,
    new_figure,
    plain,
    quiet,
    thin,
)
from strikewave.specifications.judged_records import JudgedShock
from strikewave.specifications.judging import FAIL, PASS, PulseLimits, Shock, ShockVerdict, SpectrumLimits

if TYPE_CHECKING:
    from matplotlib.figure import Figure

POINTS = 400  # points of a record in a picture; of a curve of a band twice as many at most


def shock_figure(shock: JudgedShock, limits: PulseLimits, name: str) -> Figure:
    """Draw a shock within the band, or about the ideal pulse with the limits of its peak."""
    figure = new_figure(HALF)
    draw_shock(figure.add_subplot(), shock.shock, shock.found, limits, name)
    return legend_below(figure)


def draw_shock(
    axes: Any, record: Shock, found: ShockVerdict, limits: PulseLimits, name: str, called: str = "record"
) -> None:
    """Draw a shock within the band, or about the ideal pulse with the limits of its peak, on axes."""
    size, unit = axis_unit("m/s^2", "g")
    second, clock = time_unit(limits.pulse.duration)
    draw_limits(axes, limits, size, second)
    before, after = shown_window(limits)
    time = record.time - found.start
    inside = (time >= -before) & (time <= limits.pulse.duration + after)
    x, y = thin(time[inside], record.values[inside], POINTS // 2)
    colour = {PASS: BLUE, FAIL: RED}.get(found.verdict, ORANGE)
    marker = "." if x.size <= 60 else ""
    axes.plot(x / second, y / size, color=colour, linewidth=1.3, marker=marker, markersize=4, label=called)
    place = found.placement
    if place is not None and place.margin < 0.0:
        value = float(np.interp(place.time, record.time, record.values)) / size
        axes.plot([(place.time - found.start) / second], [value], "o", color=RED, markersize=6, fillstyle="none")
    quiet(
        axes,
        f"{plain(name, 34)}: {SHOWN[found.verdict]}",
        f"time from the begin of the ideal pulse ({clock})",
        f"acceleration ({unit})",
    )
    axes.margins(x=0.0, y=0.08)


def shown_window(limits: PulseLimits) -> tuple[float, float]:
    """Return how long before and after the pulse is shown, s."""
    band = limits.band
    shares = (0.5, 1.0) if band is None else (band.before, band.after)
    return shares[0] * limits.pulse.duration, shares[1] * limits.pulse.duration


def draw_limits(axes: Any, limits: PulseLimits, size: float, second: float) -> None:
    """Draw what a shock is held against, over time from the begin of the ideal pulse."""
    pulse, band = limits.pulse, limits.band
    before, after = shown_window(limits)
    if band is not None:
        time = band.grid()[::2]
        time = np.unique(np.concatenate([time, band.grid()[:1], band.grid()[-1:]]))
        low, high = band.curves(time)
        axes.fill_between(time / second, low / size, high / size, color=GREEN, alpha=0.14, linewidth=0, label="band")
        for curve in (low, high):
            axes.plot(time / second, curve / size, color=GREEN, linewidth=1.0)
    if limits.peak is not None:
        for level in (limits.peak.low, limits.peak.high):
            axes.axhline(level / size, color=GREEN, linewidth=1.0, linestyle=":")
        axes.plot([], [], color=GREEN, linestyle=":", label="limits of the peak")
    fine = np.linspace(-before, pulse.duration + after, POINTS)
    fine = np.unique(np.concatenate([fine, [0.0, *pulse.top, pulse.duration, pulse.duration * (1.0 + 1e-9)]]))
    axes.plot(fine / second, pulse.at(fine) / size, "--", color=GREY, linewidth=1.0, label="ideal pulse")


def limits_figure(limits: PulseLimits, title: str) -> Figure:
    """Draw a specification of a pulse alone."""
    figure = new_figure(WHOLE)
    axes = figure.add_subplot()
    size, unit = axis_unit("m/s^2", "g")
    second, clock = time_unit(limits.pulse.duration)
    draw_limits(axes, limits, size, second)
    if limits.width is not None:
        level = limits.level * limits.pulse.peak
        first, last = _crossings(limits)
        axes.annotate(
            "",
            (first / second, level / size),
            (last / second, level / size),
            arrowprops={"arrowstyle": "<->", "color": GREY},
        )
    quiet(axes, plain(title, 90), f"time from the begin of the ideal pulse ({clock})", f"acceleration ({unit})")
    axes.margins(x=0.0, y=0.1)
    return legend_below(figure)


def _crossings(limits: PulseLimits) -> tuple[float, float]:
    """Return when the ideal pulse crosses the level of the pulse width, s."""
    pulse = limits.pulse
    width = pulse.width(limits.level)
    low, high = pulse.top
    outside = pulse.duration - width
    rest = low + pulse.duration - high
    first = outside * (low / rest if rest > 0.0 else 0.5)
    return first, first + width


def spectrum_limits_figure(
    limits: SpectrumLimits, spectra: list[tuple[str, np.ndarray, np.ndarray, str]], title: str
) -> Figure:
    """Draw a specification of a spectrum, with spectra (name, frequency, values, verdict) over it."""
    figure = new_figure(WHOLE)
    draw_spectrum_limits(figure.add_subplot(), limits, spectra, title)
    return legend_below(figure)


def draw_spectrum_limits(
    axes: Any, limits: SpectrumLimits, spectra: list[tuple[str, np.ndarray, np.ndarray, str]], title: str
) -> None:
    """Draw a specification of a spectrum, with spectra (name, frequency, values, verdict) over it, on axes."""
    size, unit = axis_unit("m/s^2", "g")
    frequency = np.unique(
        np.concatenate([np.geomspace(limits.frequency[0], limits.frequency[-1], POINTS), limits.frequency])
    )
    low, high = limits.curves(frequency)
    axes.fill_between(frequency, low / size, high / size, color=GREEN, alpha=0.14, linewidth=0, label="tolerance")
    axes.plot(frequency, limits.nominal(frequency) / size, "--", color=GREY, linewidth=1.0, label="nominal")
    for k, (name, f, values, verdict) in enumerate(spectra[:MOST_SPECTRA]):
        look = {"color": {PASS: BLUE, FAIL: RED}.get(verdict, ORANGE), "linestyle": LINES[k % len(LINES)]}
        every = {"marker": MARKERS[k // len(LINES)], "markevery": 0.1, "markersize": 4}
        axes.plot(f, values / size, **look, **every, linewidth=1.3, label=f"{plain(name, 30)}: {SHOWN[verdict]}")
    axes.set_xscale("log")
    axes.set_yscale("log")
    log_axis(axes.xaxis, hertz_ticks())
    log_axis(axes.yaxis, number_tick)
    quiet(axes, plain(title, 90), "natural frequency (Hz)", f"{limits.side} acceleration ({unit}), Q = {limits.q:g}")


MOST_SPECTRA = 8  # spectra that are drawn over a tolerance: as many as can be told apart
# By which spectra of one verdict, and so of one colour, are told apart
LINES, MARKERS = ("-", "--", "-.", ":"), ("", "o")
