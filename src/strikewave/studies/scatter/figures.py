"""Picture of a scatter study: peaks blow by blow within the tolerances, and which tolerance they scatter by."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np

from strikewave.base.shock_quantities import VARIATION
from strikewave.reporting.faces import amount
from strikewave.reporting.numbers import axis_unit, headed
from strikewave.reporting.style import BLUE, GREY, ORANGE, RED, mark_runs, quiet, sheet_title
from strikewave.studies.scatter.study import ScatterStudy
from strikewave.uncertainty.shares import Shares

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH, PEAKS_HEIGHT, HEAD, ROW = 9.0, 3.9, 1.1, 0.3
"""Width of the picture, and heights of the peaks, of the space about the bars of shares, and of each bar, inches."""
DARK = "#333333"
MOST_BARS = 12
"""Largest shares that are drawn, as many as a page holds; the others stand in the table."""


def picture(study: ScatterStudy) -> Figure:
    """Draw the peaks by blow with median and band of 95 %, the dynamics alone on top, and the bars of shares."""
    from matplotlib.figure import Figure

    bars = [min(len(shares.rows), MOST_BARS) for shares in study.shares]
    heights = [PEAKS_HEIGHT, *(HEAD + ROW * count for count in bars)]
    figure = Figure(figsize=(WIDTH, sum(heights)), layout="constrained")
    rows = figure.subplots(len(heights), 1, height_ratios=heights, squeeze=False)[:, 0]
    _peaks(rows[0], study)
    for axes, shares in zip(rows[1:], study.shares, strict=True):
        _bars(axes, shares, study.plan.shares == "sobol")
    count = len(study.tolerances)
    tolerances = f"{count} tolerances" if count > 1 else f"the tolerance of {study.tolerances[0].path}"
    sheet_title(figure, f"{study.case.name or 'case'}: {len(study.completed)} runs within {tolerances}")
    return figure


def _peaks(axes: Any, study: ScatterStudy) -> None:
    """Draw the peaks of each blow."""
    from matplotlib.ticker import MaxNLocator

    size, _ = axis_unit("m/s^2", "g")
    low, middle, high = (end / size for end in (study.peak_band.low, study.peak_band.median, study.peak_band.high))
    number = np.arange(1, middle.size + 1)
    nominal = study.nominal_run.peak / size
    axes.vlines(number, low, high, color=BLUE, alpha=0.35, linewidth=9.0, label="95 % of runs")
    axes.plot(number, middle, "_", color=BLUE, markersize=15, markeredgewidth=2.0, label="median")
    axes.plot(np.arange(1, nominal.size + 1), nominal, "o", color=RED, markersize=4, label="dynamics alone")
    # a run that failed a check is marked at its largest peak; one that could not be made has none
    peaks = [np.nan_to_num(run.peak, nan=-np.inf) for run in study.runs]
    places = [int(np.argmax(of_run)) + 1 if of_run.size else np.nan for of_run in peaks]
    largest = [float(np.max(of_run)) / size if of_run.size else np.nan for of_run in peaks]
    mark_runs(axes, places, largest, study.verdicts, "run (at its largest peak)", size=5.0)
    missed = sum("missed" in run.kinds for run in study.completed)
    typical = study.figures["peak"].within
    alone = study.nominal_run.variation("peak")
    title = (
        f"Peak of the rigid-body acceleration. CV within a run: {amount(VARIATION, typical.median)}, dynamics "
        f"alone {amount(VARIATION, alone)}"
    )
    title += f"; {missed} runs with missed blows" if missed else ""
    quiet(axes, title, "blow", headed("peak", "m/s^2", "g"))
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.margins(x=0.04, y=0.12)
    axes.legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0))


def _bars(axes: Any, shares: Shares, sobol: bool) -> None:
    """Draw shares as bars with their bounds; hollow where they are not significant (95 %)."""
    rows = shares.rows[:MOST_BARS]
    place = np.arange(len(rows))
    value = np.array([row.share for row in rows])
    finite = np.isfinite(value).all()
    title = f"Shares in the {shares.of}: {'Sobol indices' if sobol else 'each tolerance alone'}"
    title += f" (the {MOST_BARS} largest of {len(shares.rows)})" if len(shares.rows) > MOST_BARS else ""
    quiet(axes, "\n".join(textwrap.wrap(title, 100)), "share (%), with 95 % bounds", "")
    axes.set_yticks(place, [row.path for row in rows], fontsize=8)
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.grid(False, axis="y")
    if not finite:
        axes.text(0.5, 0.5, "nothing scatters", ha="center", va="center", transform=axes.transAxes)
        axes.set_xticks([])
        return
    colours = [BLUE if row.distinct else "none" for row in rows]
    axes.barh(place, 100.0 * value, height=0.6, color=colours, edgecolor=BLUE, linewidth=1.0, label="share")
    _bounds(axes, place, np.array([row.low for row in rows]), np.array([row.high for row in rows]))
    if sobol:
        total = np.array([row.total for row in rows], dtype=float)
        axes.plot(100.0 * total, place + 0.38, "D", color=ORANGE, markersize=4, label="with interactions (total)")
        axes.legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    if not all(row.distinct for row in rows):
        note = "hollow: not significant (95 %)"
        axes.text(0.995, 0.04, note, ha="right", va="bottom", fontsize=8, color=GREY, transform=axes.transAxes)
    axes.axvline(0.0, color=GREY, linewidth=0.8)
    left, right = axes.get_xlim()
    pad = 0.03 * (right - left)
    axes.set_xlim(left - pad if left < 0.0 else 0.0, max(right + pad, 1.0))


def _bounds(axes: Any, place: Any, low: Any, high: Any) -> None:
    """Draw the bounds of shares; none where there are none."""
    if np.isfinite([low, high]).all():
        axes.hlines(place, 100.0 * low, 100.0 * high, color=DARK, linewidth=1.1)
        axes.plot(100.0 * np.concatenate([low, high]), np.tile(place, 2), "|", color=DARK, markersize=7)
