"""Picture of settings: how near each candidate comes to the goal, and what scatter and stop force it has."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from strikewave.base.percents import percent
from strikewave.base.result import Verdicts
from strikewave.reporting.numbers import axis_unit, headed
from strikewave.reporting.style import BLUE, GREEN, GREY, ORANGE, RED, mark_runs, quiet, sheet_title
from strikewave.studies.axes import plain_log_ticks
from strikewave.studies.settings.candidate import WITHIN, SettingsCandidate
from strikewave.studies.settings.result import SettingsStudy

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZE = (10.0, 4.6)
SHOWN = 30
"""First of the ranking whose misses are drawn: more marks would run into one another."""
LINEAR = 1.0
"""Misses up to this, in %, stand on a linear scale: those of a search that came to its end are below."""
LEAST = 0.01
"""Scatter below this, in %, is drawn there: 0 has no place on a logarithmic axis."""
QUANTITIES = (("peak", BLUE, "o"), ("width", ORANGE, "s"), ("interval", GREEN, "^"))
MARKERS = (("o", BLUE), ("s", ORANGE), ("^", GREEN), ("D", RED), ("v", "#CC79A7"), ("P", "#56B4E9"), ("X", GREY))


def settings_figure(study: SettingsStudy) -> Figure:
    """Draw misses of the typical blow by place, and scatter of the peaks against the force of the stop."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, layout="constrained")
    left, right = figure.subplots(1, 2)
    _misses(left, study.candidates[:SHOWN])
    _scatter(right, study.candidates)
    sheet_title(figure, textwrap.shorten(f"Settings {'' if study.broken else 'for '}{study.title}", 90))
    return figure


def _misses(axes: Any, candidates: Sequence[SettingsCandidate]) -> None:
    """Draw typical peak, width and interval over the goal, and the worst peak, of each candidate."""
    places = list(range(1, len(candidates) + 1))
    axes.axhspan(-100.0 * WITHIN, 100.0 * WITHIN, color="#EEEEEE", zorder=0, label=f"within {percent(WITHIN, 0)}")
    axes.axhline(0.0, color="#333333", linewidth=0.9)
    worst = [100.0 * (one.observation.peak.worst / one.goal.peak - 1.0) for one in candidates]
    typical = [100.0 * one.misses["peak"] for one in candidates]
    axes.vlines(places, typical, worst, color=BLUE, linewidth=1.0, label="to the worst peak")
    for name, colour, marker in QUANTITIES:
        values = [100.0 * one.misses[name] for one in candidates]
        axes.plot(places, values, marker, color=colour, markersize=4, label=name)
    mark_runs(axes, places, typical, _verdicts(candidates))
    axes.set_yscale("symlog", linthresh=LINEAR)
    ticks = [-100, -20, -5, -1, 0, 1, 5, 20, 100]
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, -10.0), max(high, 10.0))
    axes.set_yticks(ticks, [f"{tick:+d}" if tick else "0" for tick in ticks], minor=False)
    axes.set_yticks([], minor=True)
    axes.set_ylim(min(low, -10.0), max(high, 10.0))
    quiet(axes, "Typical blow over the goal", "place of the candidate", "miss (%)")
    axes.set_xlim(0.0, len(candidates) + 1.0)
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.legend(frameon=False, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=3)


def _scatter(axes: Any, candidates: Sequence[SettingsCandidate]) -> None:
    """Draw the scatter of the peaks against the largest force of the stop; filled where the goal is met."""
    counts = sorted({round(one.case.rotary_tables().machine.strikers.si) for one in candidates})
    for k, count in enumerate(counts):
        marker, colour = MARKERS[k % len(MARKERS)]
        mine = [one for one in candidates if round(one.case.rotary_tables().machine.strikers.si) == count]
        for met, fill in ((True, colour), (False, "none")):
            points = [one for one in mine if one.meets == met]
            if points:
                axes.plot(*_places(points), marker, color=colour, markerfacecolor=fill, markersize=5)
        label = f"{count} striker{'s' if count > 1 else ''}"
        axes.plot([], [], marker, color=colour, markersize=5, label=label)
    axes.plot(*_places(candidates[:1]), "o", color="#333333", markersize=11, fillstyle="none", label="first")
    axes.plot([], [], "o", color=GREY, fillstyle="none", markersize=5, label="goal not met")
    mark_runs(axes, *_places(candidates), _verdicts(candidates))
    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        plain_log_ticks(axis)
    quiet(axes, "What it costs", headed("largest force of the stop", "N", "kN"), "scatter of the peaks, CV (%)")
    if not any(np.isfinite(one.observation.peak.variation) for one in candidates):
        axes.set_ylabel("one blow alone has no scatter")
        axes.set_yticks([], minor=False)
    axes.margins(0.08)
    axes.legend(frameon=False, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=4)


def _verdicts(candidates: Sequence[SettingsCandidate]) -> Verdicts:
    """Return the verdicts of the full runs of candidates."""
    return Verdicts(one.run_verdict for one in candidates)


def _places(candidates: Sequence[SettingsCandidate]) -> tuple[list[float], list[float]]:
    """Return forces as shown and scatters in %."""
    newton, _ = axis_unit("N", "kN")
    return (
        [max(one.observation.supply.stop_force, 1.0) / newton for one in candidates],
        [float(np.fmax(100.0 * one.observation.peak.variation, LEAST)) for one in candidates],
    )
