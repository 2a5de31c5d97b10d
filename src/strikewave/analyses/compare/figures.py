"""Pictures of a comparison: both histories with the corridor, their difference, the ratio of spectra, the scores."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.compare.result import CompareResult
from strikewave.reporting.numbers import axis_unit, headed, time_unit
from strikewave.reporting.style import (
    BLUE,
    GREEN,
    GREY,
    HALF,
    RED,
    WHOLE,
    legend_below,
    new_figure,
    one_diagram,
    plain,
    quiet,
    thin,
    titled,
)
from strikewave.signal.iso18571 import INNER, OUTER, WEIGHTS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

# Colours of the wide and the narrow corridor
SHADES = ("#DCE9F2", "#B9D5E8")
LONGEST = 60  # letters of a name in a legend
MARGIN = 0.15  # share of the interval that is drawn before and after it
SCORES = ("corridor", "phase", "magnitude", "slope", "overall")


def _shown(result: CompareResult) -> tuple[NDArray[np.bool_], Array, str]:
    """Return which samples are drawn, their times in the unit of the axis, and its label."""
    found = result.agreement
    begin, end = found.interval
    kept = (found.time >= begin - MARGIN * (end - begin)) & (found.time <= end + MARGIN * (end - begin))
    size, unit = time_unit(float(np.ptp(found.time[kept])))
    return kept, found.time[kept] / size, f"time of A ({unit})"


def draw_overlay(axes: Any, result: CompareResult) -> None:
    """Draw A with its corridor, and B on it."""
    found = result.agreement
    kept, time, label = _shown(result)
    size, _ = axis_unit(result.unit, result.usual)
    a, b = found.a[kept] / size, found.b[kept] / size
    judged = result.specified
    if judged is not None and judged.limits.band is not None:
        low, high = judged.limits.band.curves(found.time[kept] - judged.found.start)
        sign, words = result.a.sign / size, f"band of {judged.specification.asked}"
        axes.fill_between(time, sign * low, sign * high, color=SHADES[1], linewidth=0.0, label=words)
    elif found.deviation is not None:
        of_a = result.a.deviation is not None
        mean, half = (a if of_a else b), result.factor * found.deviation[kept] / size
        words = f"mean of {(result.a if of_a else result.b).count} records ± {result.factor:g} standard deviations"
        axes.fill_between(time, mean - half, mean + half, color=SHADES[1], linewidth=0.0, label=words)
    else:
        largest = float(np.max(np.abs(a)))
        for share, shade in ((OUTER, SHADES[0]), (INNER, SHADES[1])):
            words = f"corridor of ISO/TS 18571, {100.0 * share:g} % of the peak"
            axes.fill_between(time, a - share * largest, a + share * largest, color=shade, linewidth=0.0, label=words)
    for name, values, colour, dash in (("A", a, BLUE, "-"), ("B", b, RED, "--")):
        curve = result.a if name == "A" else result.b
        axes.plot(*thin(time, values), dash, color=colour, linewidth=1.4, label=f"{name}: {plain(curve.name, LONGEST)}")
    second = time_unit(float(np.ptp(found.time[kept])))[0]
    for name, curve, pulse, colour in (("A", result.a, found.pulse_a, BLUE), ("B", result.b, found.pulse_b, RED)):
        band = curve.band.get("peak")
        if band is not None and np.isfinite(band.low + band.high):
            ends = np.array([band.low, band.high]) * curve.sign / size
            where, words = np.full(2, pulse.time / second), f"band of the peak of {name}"
            axes.plot(where, ends, "_-", color=colour, linewidth=1.0, markersize=12, label=words)
    for edge in found.interval:
        if time[0] < edge / second < time[-1]:
            axes.axvline(edge / second, color=GREY, linewidth=0.8, linestyle=":")
    quiet(axes, "B on A, shifted by " + ("nothing" if result.align == "none" else result.align), label, _axis(result))


def _axis(result: CompareResult) -> str:
    return headed(result.quantity, result.unit, result.usual) if result.unit else "value (the files' own)"


def draw_difference(axes: Any, result: CompareResult) -> None:
    """Draw B minus A."""
    found = result.agreement
    kept, time, label = _shown(result)
    size, _ = axis_unit(result.unit, result.usual)
    difference = (found.b - found.a)[kept] / size
    if found.deviation is not None:
        half = result.factor * found.deviation[kept] / size
        axes.fill_between(time, -half, half, color=SHADES[1], linewidth=0.0)
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    axes.plot(*thin(time, difference), color=GREEN, linewidth=1.2)
    quiet(axes, "Difference, B minus A", label, _axis(result))
    axes.locator_params(axis="x", nbins=5)


def draw_ratio(axes: Any, result: CompareResult) -> None:
    """Draw the ratio of the shock response spectra."""
    from matplotlib.ticker import FuncFormatter, NullFormatter

    found = result.agreement
    size, _ = axis_unit("Hz", "kHz")
    axes.axhspan(-3.0, 3.0, color=SHADES[0], linewidth=0.0)
    axes.semilogx(found.frequency / size, found.ratio, color=BLUE, linewidth=1.3)
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, place: f"{value:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    quiet(axes, "Shock response spectra, B over A", headed("natural frequency", "Hz", "kHz"), "ratio (dB)")
    largest = float(np.nanmax(np.abs(found.ratio)))
    axes.set_ylim(-max(1.15 * largest, 4.0), max(1.15 * largest, 4.0))


def draw_scores(axes: Any, result: CompareResult) -> None:
    """Draw the scores of ISO/TS 18571 as bars, each with its number and weight."""
    rating = result.agreement.rating
    places = np.arange(len(SCORES))[::-1]
    values = [getattr(rating, name) for name in SCORES]
    axes.barh(places, values, color=[SHADES[1]] * 4 + [BLUE], height=0.6)
    for place, value in zip(places, values, strict=True):
        inside = value > 0.85
        axes.text(
            value - 0.02 if inside else value + 0.02,
            place,
            f"{value:.3f}",
            va="center",
            ha="right" if inside else "left",
            fontsize=9,
            color="white" if inside and place == 0 else "black",
        )
    labels = [f"{name}, {100.0 * w:g} %" for name, w in zip(SCORES, WEIGHTS, strict=False)] + [SCORES[-1]]
    axes.set_yticks(places, labels)
    quiet(axes, f"ISO/TS 18571: {rating.grade}", "score", "")
    axes.set_xlim(0.0, 1.0)


def overlay(result: CompareResult) -> Figure:
    """Return both histories over one another."""
    figure = new_figure((WHOLE[0], 4.2))
    draw_overlay(figure.add_subplot(), result)
    return legend_below(figure)


def half_figures(result: CompareResult) -> list[tuple[Figure, str]]:
    """Return difference, ratio of spectra and scores, each with its caption."""
    found = [(one_diagram(lambda axes: draw_difference(axes, result), HALF), "What B has more than A.")]
    if result.agreement.frequency.size:
        words = "Largest responses of oscillators of 5 % damping (Q = 10) to B, over those to A; shaded: ± 3 dB."
        found.append((one_diagram(lambda axes: draw_ratio(axes, result), HALF), words))
    words = "Scores of ISO/TS 18571 over the interval between the dotted lines, with their weights."
    found.append((one_diagram(lambda axes: draw_scores(axes, result), HALF), words))
    return found


def summary_figure(result: CompareResult) -> Figure:
    """Return the diagrams on one sheet; the scores where there is no ratio of spectra."""
    figure = new_figure((WHOLE[0], 7.4))
    grid = figure.add_gridspec(2, 2, height_ratios=(1.25, 1.0))
    draw_overlay(figure.add_subplot(grid[0, :]), result)
    draw_difference(figure.add_subplot(grid[1, 0]), result)
    (draw_ratio if result.agreement.frequency.size else draw_scores)(figure.add_subplot(grid[1, 1]), result)
    return titled(legend_below(figure), result.title)
