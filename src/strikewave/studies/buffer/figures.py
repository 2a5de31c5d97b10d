"""Pictures of a buffer design: peak against bandwidth, what the sensor reads, and what the buffers pass."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from strikewave.base.result import Verdicts
from strikewave.reporting.numbers import axis_unit, headed
from strikewave.reporting.style import BLUE, GREEN, GREY, ORANGE, RED, mark_runs, put_below, quiet, thin
from strikewave.sensors import transmission
from strikewave.sensors.mounting import RESOLVED
from strikewave.studies.axes import plain_log_ticks
from strikewave.studies.buffer.result import BufferStudy
from strikewave.studies.buffer.stacks import BufferCandidate, distinct

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZE = (9.0, 4.4)
SHOWN = 3
"""First of the ranking that are drawn: as many as `STYLES` tells apart."""
PERIODS = 4.0
"""Periods of the slowest buffer that are shown after the blow. Chosen: enough to see whether it rings on."""
DARK = "#333333"
STYLES = ((BLUE, "-"), (RED, "--"), (GREEN, "-."))


def first_ones(study: BufferStudy) -> list[BufferCandidate]:
    """Return the first distinct ones of the ranking that have gaskets."""
    return distinct([candidate for candidate in study.candidates if candidate.stack], SHOWN)


def peak_bandwidth(study: BufferStudy) -> Figure:
    """Draw the peak of each stack's reading against the frequency up to which it passes within 10 %."""
    figure, axes = _figure()
    buffered = [candidate for candidate in study.candidates if candidate.stack and np.isfinite(candidate.true_peak)]
    keeping = [c for c in buffered if c.keeps]
    clipped = [c for c in buffered if c.clipped]
    above = [c for c in buffered if not c.keeps and not c.clipped]
    _points(axes, above, "above the limit", color=GREY, marker="o", markersize=3, alpha=0.6)
    _points(axes, clipped, "cut off", color=ORANGE, marker="x", markersize=4)
    _points(axes, keeping, "keeps the limit", color=BLUE, marker="o", markersize=3.5)
    drawn = buffered if study.present is None else [*buffered, study.present]
    of_blow = Verdicts([study.blows.verdict] * len(drawn))
    mark_runs(axes, *_places(drawn), of_blow, "the blow is of a run that", size=5.0)
    front = sorted((c for c in buffered if c.pareto), key=lambda c: c.band.within_10)
    x, y = _places(front)
    if buffered:
        axes.plot(x, y, "-", color=GREEN, linewidth=1.2, label="Pareto-optimal", zorder=2)
        axes.set_xscale("log")
        axes.set_yscale("log")
        plain_log_ticks(axes.xaxis)
        plain_log_ticks(axes.yaxis)
        first = first_ones(study)[0]
        axes.plot(*_places([first]), "s", color=RED, markersize=9, fillstyle="none", label=f"first: {first.name}")
        if study.robust is not None and study.robust.stack:
            name = f"robust: {study.robust.name}"
            axes.plot(*_places([study.robust]), "D", color=GREEN, markersize=9, fillstyle="none", label=name)
        if study.present is not None:
            axes.plot(*_places([study.present]), "^", color=DARK, markersize=7, label=study.present.name)
    else:
        _nothing(axes)
    axes.axhline(study.goal.limit / _acceleration(), color=DARK, linewidth=1.2, linestyle="--", label="limit")
    if study.site.range < study.goal.limit:
        height = study.site.range / _acceleration()
        axes.axhline(height, color=ORANGE, linewidth=1.2, linestyle="-.", label="range")
    if np.isfinite(study.direct.true_peak):
        height = study.direct.true_peak / _acceleration()
        axes.axhline(height, color=GREY, linewidth=1.0, linestyle=":", label="direct")
    title = f"What {study.site.table.name} reads of {study.motion.name}, and what the buffer passes"
    quiet(
        axes, _short(title), headed("amplitude within 10 % up to", "Hz", "Hz"), headed("largest reading", "m/s^2", "g")
    )
    axes.margins(x=0.05, y=0.08)
    _legend(axes)
    return figure


def buffer_histories(study: BufferStudy) -> Figure:
    """Draw what the sensor reads directly and on the first stacks of the ranking."""
    figure, axes = _figure()
    begin, end = _window(study)
    for candidate, (colour, dash) in zip([study.direct, *first_ones(study)], ((GREY, ":"), *STYLES), strict=False):
        reading = study.reading(candidate)
        shown = (reading.time >= begin) & (reading.time <= end)
        time, values = thin(reading.time[shown], reading.values[shown])
        axes.plot(
            time / axis_unit("s", "us")[0],
            values / _acceleration(),
            dash,
            color=colour,
            linewidth=1.3,
            label=candidate.name,
        )
    limit = study.goal.limit / _acceleration()
    axes.axhline(limit, color=DARK, linewidth=0.9, linestyle="--", label="limit")
    if axes.get_ylim()[0] < -0.8 * limit:
        axes.axhline(-limit, color=DARK, linewidth=0.9, linestyle="--")
    title = f"Readings of {study.site.table.name}, {study.motion.name}"
    quiet(axes, _short(title), headed("time", "s", "us"), headed("acceleration", "m/s^2", "g"))
    _legend(axes)
    return figure


def _window(study: BufferStudy) -> tuple[float, float]:
    """Return from when to when histories are shown, s: four periods of the slowest buffer after the largest value."""
    motion = study.motion
    peak = motion.start + motion.step * (motion.acceleration.size - 1) - motion.after_peak
    slowest = [1.0 / c.band.resonance for c in first_ones(study) if np.isfinite(c.band.resonance)]
    if not slowest:
        return -np.inf, np.inf
    return peak - max(slowest), peak + PERIODS * max(slowest)


def buffer_transmissibility(study: BufferStudy) -> Figure:
    """Draw what the first stacks of the ranking pass, and the band of 10 %."""
    figure, axes = _figure()
    shown = first_ones(study)
    quiet(axes, "Transmissibility of the buffer", headed("frequency", "Hz", "Hz"), "sensor over surface (1)")
    if not shown:
        _nothing(axes)
        return figure
    hertz, _ = axis_unit("Hz", "Hz")
    lowest = min(candidate.band.within_10 for candidate in shown)
    frequency = np.geomspace(max(0.1 * min(lowest, RESOLVED), 10.0), RESOLVED, 1600)
    for candidate, (colour, dash) in zip(shown, STYLES, strict=False):
        magnitude = np.abs(transmission(study.site.mounting(candidate.stack), frequency))
        axes.loglog(frequency / hertz, magnitude, dash, color=colour, linewidth=1.3, label=candidate.name)
        if np.isfinite(candidate.band.within_10):
            height = np.abs(transmission(study.site.mounting(candidate.stack), candidate.band.within_10))
            axes.plot([candidate.band.within_10 / hertz], [float(height)], "o", color=colour, markersize=4)
    plain_log_ticks(axes.xaxis)
    axes.axhspan(0.9, 1.1, color="#DDDDDD", label="within 10 %", zorder=0)
    axes.set_ylim(bottom=1e-4)
    _legend(axes)
    return figure


def _nothing(axes: Any) -> None:
    """Write into empty axes that there is nothing to draw."""
    axes.text(0.5, 0.5, "no stack has a gasket", ha="center", transform=axes.transAxes)
    axes.set_xticks([])


def _figure() -> tuple[Figure, Any]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, layout="constrained")
    return figure, figure.add_subplot()


def _points(axes: Any, candidates: Sequence[BufferCandidate], label: str, **style: Any) -> None:
    if candidates:
        axes.plot(*_places(candidates), linestyle="none", label=label, **style)


def _places(candidates: Sequence[BufferCandidate]) -> tuple[list[float], list[float]]:
    """Return bandwidths (at most that which is resolved) and peaks, as shown."""
    return (
        [min(c.band.within_10, RESOLVED) / axis_unit("Hz", "Hz")[0] for c in candidates],
        [c.true_peak / _acceleration() for c in candidates],
    )


def _acceleration() -> float:
    """Return the size of the unit in which accelerations are shown, m/s^2."""
    return axis_unit("m/s^2", "g")[0]


def _short(text: str) -> str:
    return textwrap.shorten(text, 110)


def _legend(axes: Any) -> None:
    """Put the legend below the axes, where it hides nothing."""
    handles, labels = axes.get_legend_handles_labels()
    names = [textwrap.shorten(label, 60) for label in labels]
    put_below(axes.get_figure(), handles, names)
