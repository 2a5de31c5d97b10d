"""Pictures of a fit: runs on records, values with their intervals, profiles, and the posterior."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.compare.agreement import QUANTITIES
from strikewave.base.result import Verdicts, worse
from strikewave.base.shock_quantities import usual_unit
from strikewave.reporting.numbers import axis_unit, headed, time_unit
from strikewave.reporting.style import (
    BLUE,
    GREEN,
    GREY,
    HALF,
    RED,
    WHOLE,
    legend_below,
    mark_runs,
    new_figure,
    one_diagram,
    plain,
    quiet,
    thin,
    titled,
)
from strikewave.studies.fit.measured import LaidPulse, MeasuredPulse
from strikewave.studies.fit.result import FitStudy, FittedParameter

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

MOST_DRAWN = 6  # most records that are drawn over one another: more hide each other
LONGEST = 60  # letters of a name in a legend


def draw_overlay(
    axes: Any, pulses: list[tuple[MeasuredPulse, LaidPulse]], bands: Sequence[tuple[Array, Array]] = ()
) -> None:
    """Draw records, and the run laid on each, with the predictive bands of a posterior."""
    unit = pulses[0][0].unit
    size, _ = axis_unit(unit, usual_unit(unit))
    second, name = time_unit(max(float(np.ptp(laid.time)) for _, laid in pulses))
    for number, (pulse, laid) in enumerate(pulses):
        time = (laid.time - laid.time[0]) / second
        if number < len(bands):
            words = "95 % of the posterior and the noise" if number == 0 else None
            low, high = bands[number]
            axes.fill_between(time, low / size, high / size, color=RED, alpha=0.18, linewidth=0.0, label=words)
        label = plain(pulse.called, LONGEST) if len(pulses) < 3 or number == 0 else None
        axes.plot(*thin(time, laid.measured / size), color=BLUE, linewidth=1.2, alpha=0.8, label=label)
        fitted = "fitted run" if number == 0 else None
        axes.plot(*thin(time, laid.computed / size), "--", color=RED, linewidth=1.4, label=fitted)
    quiet(axes, "Fitted run on the record", f"time from the beginning of what is fitted ({name})", _axis(pulses[0][0]))


def _axis(pulse: MeasuredPulse) -> str:
    return headed(QUANTITIES.get(pulse.unit, "value"), pulse.unit, usual_unit(pulse.unit))


def draw_residual(axes: Any, pulses: list[tuple[MeasuredPulse, LaidPulse]]) -> None:
    """Draw what is left of each record, with the deviation of its noise."""
    pulse = pulses[0][0]
    size, _ = axis_unit(pulse.unit, usual_unit(pulse.unit))
    second, name = time_unit(max(float(np.ptp(laid.time)) for _, laid in pulses))
    noise = (
        float(np.std(pulse.record.history.values[pulse.record.history.time < pulse.time[0]])) if pulse.quiet else 0.0
    )
    if noise:
        words = "± 2 standard deviations of the noise"
        axes.axhspan(-2.0 * noise / size, 2.0 * noise / size, color="#DCE9F2", linewidth=0.0, label=words)
    for _, laid in pulses:
        time = (laid.time - laid.time[0]) / second
        axes.plot(*thin(time, (laid.computed - laid.measured) / size), color=GREEN, linewidth=1.0)
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    quiet(axes, "Residual, run minus record", f"time ({name})", _axis(pulse))


def draw_values(axes: Any, study: FitStudy) -> None:
    """Draw each value within its bounds, with its 95 % interval."""
    names = [one.field.path.partition(".")[2].replace("_", " ") for one in study.parameters]
    places = np.arange(len(names))[::-1]
    for place, parameter in zip(places, study.parameters, strict=True):
        field, colour = parameter.field, (BLUE if parameter.determined else RED)
        axes.plot([0.0, 1.0], [place, place], color="#DCE9F2", linewidth=6.0, solid_capstyle="butt")
        axes.plot(
            [field.place(parameter.low), field.place(parameter.high)], [place, place], color=colour, linewidth=3.0
        )
        axes.plot(field.place(parameter.value), place, "o", color=colour, markersize=6)
        axes.plot(field.place(field.value.si), place, "|", color=GREY, markersize=12)
    worst = functools.reduce(worse, study.verdicts.texts, "")
    found = [one.field.place(one.value) for one in study.parameters]
    mark_runs(axes, found, places, Verdicts([worst] * len(found)), "fitted run", size=10.0)
    axes.set_yticks(places, names)
    axes.set_ylim(-0.6, len(names) - 0.4)
    axes.set_xticks([0.0, 1.0], ["lower bound", "upper bound"])
    quiet(axes, "Values with 95 % intervals (|: where it began)", "", "")


def draw_profile(axes: Any, one: FittedParameter, reach: float) -> None:
    """Draw the profile of a value: how far the misfit rises, as standard errors."""
    assert one.profile is not None
    axis = one.field.axis
    values = [axis.shown(one.field.si(float(place))) for place in one.profile.places]
    axes.plot(values, np.abs(one.profile.deviations), "o-", color=BLUE, linewidth=1.3, markersize=4)
    axes.axhline(reach, color=GREY, linewidth=0.8, linestyle=":")
    unit = f" ({axis.shown_unit})" if axis.unit else ""
    quiet(axes, f"Profile of {one.field.path}", f"value{unit}", "rise of the misfit (standard errors)")


def overlay(study: FitStudy) -> Figure:
    """Return runs on records, above what is left of them."""
    figure = new_figure((WHOLE[0], 6.0))
    grid = figure.add_gridspec(2, 1, height_ratios=(1.6, 1.0))
    pulses = list(study.pulses[:MOST_DRAWN])
    draw_overlay(figure.add_subplot(grid[0]), pulses, study.bands)
    draw_residual(figure.add_subplot(grid[1]), pulses)
    return legend_below(figure)


def values_figure(study: FitStudy) -> Figure:
    """Return the values within their bounds."""
    figure = one_diagram(lambda axes: draw_values(axes, study), (WHOLE[0], 1.2 + 0.45 * len(study.parameters)))
    return legend_below(figure)


def profile_figures(study: FitStudy) -> list[tuple[Figure, str]]:
    """Return a picture of each profile that was followed, with its caption."""
    words = "Rise of the misfit with all other values at their best; the 95 % interval ends at the dotted line."
    return [
        (one_diagram(lambda axes, one=one, reach=reach: draw_profile(axes, one, float(reach)), HALF), words)  # type: ignore[misc]
        for one, reach in zip(study.parameters, study.solved.estimate.reach, strict=True)
        if one.profile is not None
    ]


def fit_figure(study: FitStudy) -> Figure:
    """Return all on one sheet."""
    rows = (2 if study.pulses else 0) + 1
    heights = ([1.6, 1.0] if study.pulses else []) + [0.4 + 0.22 * len(study.parameters)]
    figure = new_figure((WHOLE[0], 2.3 * sum(heights)))
    grid = figure.add_gridspec(rows, 1, height_ratios=heights)
    pulses = list(study.pulses[:MOST_DRAWN])
    if pulses:
        draw_overlay(figure.add_subplot(grid[0]), pulses, study.bands)
        draw_residual(figure.add_subplot(grid[1]), pulses)
    draw_values(figure.add_subplot(grid[rows - 1]), study)
    return titled(legend_below(figure), study.title)


BINS, FINE = 30, 24  # bins of a value, and along each side of a pair
MOST_IN_CORNER = 5  # most values in the picture: more panels cannot be read on a page
SMOOTH, SHOWN = 1.2, 0.002
"""Bins over which a pair is smoothed, so that contours do not follow single draws, and share of the draws on each side
that may lie outside of the picture."""
MASSES = (0.95, 0.68)  # shares of the draws that the contours of a pair hold


def corner_figure(study: FitStudy) -> Figure:
    """Return the corner picture: histograms on the diagonal, pairs below it, with 68 and 95 % of the draws."""
    assert study.posterior is not None
    values = study.parameters[:MOST_IN_CORNER]
    columns = [
        np.array([value.field.axis.shown(value.field.si(float(place))) for place in places])
        for value, places in zip(values, study.posterior.draws.T, strict=False)
    ]
    size = len(values)
    figure = new_figure((WHOLE[0], 1.0 + min(2.2 * size + 0.6, 8.0)))
    grid = figure.subplots(size, size, squeeze=False)
    for row in range(size):
        for column in range(size):
            axes = grid[row, column]
            if column > row:
                axes.set_visible(False)
                continue
            fitted = values[column].field.axis.shown(values[column].value)
            if row == column:
                _draw_value(axes, columns[row], fitted)
            else:
                _draw_pair(axes, columns[column], columns[row])
                axes.plot(fitted, values[row].field.axis.shown(values[row].value), "+", color=RED, markersize=10)
            axes.set_xlim(_range(columns[column]))
            if row != column:
                axes.set_ylim(_range(columns[row]))
            _label(axes, values, row, column)
    return figure


def _range(draws: Array) -> tuple[float, float]:
    """Return what is shown of a value: all but a few draws, and a tenth on either side."""
    low, high = np.quantile(draws, (SHOWN, 1.0 - SHOWN))
    return float(low - 0.1 * (high - low)), float(high + 0.1 * (high - low))


def _draw_value(axes: Any, draws: Array, fitted: float) -> None:
    """Draw a histogram, the median with 95 %, and the least-squares value."""
    axes.hist(draws, bins=BINS, range=_range(draws), density=True, color=BLUE, alpha=0.35)
    low, middle, high = np.quantile(draws, (0.025, 0.5, 0.975))
    axes.axvline(middle, color=BLUE, linewidth=1.3)
    axes.axvspan(low, high, color=BLUE, alpha=0.10, linewidth=0.0)
    axes.axvline(fitted, color=RED, linewidth=1.1, linestyle="--")
    axes.set_yticks([])


def _draw_pair(axes: Any, x: Array, y: Array) -> None:
    """Draw where 68 and 95 % of the draws of a pair lie."""
    from scipy.ndimage import gaussian_filter

    counts, x_edges, y_edges = np.histogram2d(x, y, bins=FINE, range=[_range(x), _range(y)])
    counts = gaussian_filter(counts, SMOOTH, mode="constant")
    falling = np.sort(counts.ravel())[::-1]
    held = np.cumsum(falling) / counts.sum()
    levels = sorted({float(falling[int(np.searchsorted(held, mass))]) for mass in MASSES})
    middles = [0.5 * (edges[1:] + edges[:-1]) for edges in (x_edges, y_edges)]
    axes.scatter(x[:: max(len(x) // 600, 1)], y[:: max(len(y) // 600, 1)], s=2, color=GREY, alpha=0.25, linewidths=0)
    if len(levels) > 1 and levels[0] > 0.0:
        axes.contour(*middles, counts.T, levels=levels, colors=[BLUE], linewidths=1.1)


def _label(axes: Any, values: Any, row: int, column: int) -> None:
    """Name values at the left and at the bottom; 95 % of the range is shown as it is."""
    axes.tick_params(labelsize=7)
    axes.locator_params(nbins=4)
    axes.spines[["top", "right"]].set_visible(False)
    axes.ticklabel_format(useOffset=False)
    if row == len(values) - 1:
        axes.set_xlabel(_name(values[column]), fontsize=8)
    else:
        axes.tick_params(labelbottom=False)
    if column == 0 and row > 0:
        axes.set_ylabel(_name(values[row]), fontsize=8)
    elif column != row:
        axes.tick_params(labelleft=False)


def _name(one: Any) -> str:
    name = one.field.path.rpartition(".")[2].replace("_", " ")
    return f"{name} ({one.field.axis.shown_unit})" if one.field.axis.unit else name
