"""The page and the picture of an impact of two free bodies."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.impact.result import (
    CONTACT_DEPTH,
    CONTACT_FORCE,
    CONTACT_TIME,
    MOST_ROWS,
    ImpactResult,
    blow_columns,
    impact_words,
)
from strikewave.base.texts import percent
from strikewave.contact import Impact, ImpactHistory, impact_history
from strikewave.reporting import chapters
from strikewave.reporting.columns import page_table
from strikewave.reporting.faces import face_table, part_tables
from strikewave.reporting.numbers import axis_unit, headed
from strikewave.reporting.parts import Picture, Section
from strikewave.reporting.style import COLOURS, DASHES, put_below, quiet, sheet_title

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]


def impact_report(result: ImpactResult) -> str:
    """Return the report of an impact as one HTML page: no script, nothing fetched, the same bytes each time."""
    many = len(result.blows) > 1
    caption = (
        "Force over time and over indentation, and the phase plane: shares of the approach speed and of the depth."
    )
    answers = [face_table(result, "contact_answers")] if result.differ else []
    numbers = [*part_tables(result, "first"), *part_tables(result, "law"), *answers]
    lost = "energy lost, share of that of the approach", percent(1.0 - result.first.restitution**2)
    sections = [
        Section("Histories", "", [Picture(impact_sheet(*_drawn_blows(result), ""), caption)]),
        Section("First blow" if many else "Blow", "", numbers),
        *([_blow_section(result)] if many else []),
        chapters.warnings(result.notices),
    ]
    summary = chapters.Summary("Report of an impact", impact_words(result), [*result.highlights(), lost])
    return chapters.result_page(result, summary, sections)


def _blow_section(result: ImpactResult) -> Section:
    some = f"The first and last {MOST_ROWS // 2} of {len(result.blows)} blows." if len(result.blows) > MOST_ROWS else ""
    return Section("Blows", some, [page_table("Blows on the same spot", blow_columns(result))])


def impact_picture(result: ImpactResult) -> Figure:
    """Return force and indentation of the drawn blows."""
    return impact_sheet(*_drawn_blows(result), result.title)


def _drawn_blows(result: ImpactResult) -> tuple[list[Impact], list[str]]:
    """Return the blows that are drawn, and their labels."""
    return [result.blows[k] for k in result.drawn], [f"blow {k + 1}" for k in result.drawn]


class PlottedBlow(NamedTuple):
    """One blow to draw: its label, the blow, its history and the index of its peak there."""

    label: str
    impact: Impact
    history: ImpactHistory
    peak: int


def _blows(impacts: Sequence[Impact], labels: Sequence[str]) -> list[PlottedBlow]:
    """Sample blows at equal steps, and at the peaks of force and indentation."""
    blows = []
    for impact, label in zip(impacts, labels, strict=True):
        end, peak = float(impact.duration), float(impact.peak_time)
        times = np.unique([*np.linspace(0.0, end, 501), peak, min(float(impact.turning_time), end)])
        blows.append(PlottedBlow(label, impact, impact_history(impact, times), int(np.searchsorted(times, peak))))
    return blows


def impact_sheet(impacts: Sequence[Impact], labels: Sequence[str], title: str) -> Figure:
    """Draw blows on one sheet: force over time, force over indentation, phase plane.

    Blows on one spot stand where they begin; the phase plane has shares of the approach speed and of the largest depth.
    """
    from matplotlib.figure import Figure

    figure: Any = Figure(figsize=(9.0, 6.6), layout="constrained")
    sheet_title(figure, title)
    top, bottom = figure.subfigures(2, 1)
    first, (second, third) = top.subplots(), bottom.subplots(1, 2)
    blows = _blows(impacts, labels)
    _draw_forces(first, blows)
    _draw_loops(second, blows)
    _draw_phase(third, blows)
    _legend(figure, first)
    return figure


def _legend(figure: Any, axes: Any) -> None:
    """Put a legend of the curves of one picture below all of them."""
    from matplotlib.lines import Line2D

    handles, labels = axes.get_legend_handles_labels()
    handles.append(Line2D([], [], color="black", marker="o", markersize=5.0, linestyle="none"))
    labels.append("largest force")
    put_below(figure, handles, labels)


def _curves(axes: Any, blows: Sequence[PlottedBlow], of: Callable[[PlottedBlow], tuple[Array, Array]]) -> None:
    """Draw a curve a blow, with a mark at its largest force."""
    for k, blow in enumerate(blows):
        x, y = of(blow)
        colour = COLOURS[k % len(COLOURS)]
        axes.plot(x, y, DASHES[k % len(DASHES)], color=colour, linewidth=1.4, label=blow.label, zorder=3)
        axes.plot(x[blow.peak], y[blow.peak], "o", color=colour, markersize=5.0, zorder=4)


def _draw_forces(axes: Any, blows: Sequence[PlottedBlow]) -> None:
    (second, _), (newton, _) = axis_unit(*CONTACT_TIME.units), axis_unit(*CONTACT_FORCE.units)
    _curves(axes, blows, lambda blow: (blow.history.time / second, blow.history.force / newton))
    quiet(axes, "Force", headed("time after first touch", *CONTACT_TIME.units), headed("force", *CONTACT_FORCE.units))


def _draw_loops(axes: Any, blows: Sequence[PlottedBlow]) -> None:
    (metre, _), (newton, _) = axis_unit(*CONTACT_DEPTH.units), axis_unit(*CONTACT_FORCE.units)
    _curves(axes, blows, lambda blow: (blow.history.indentation / metre, blow.history.force / newton))
    quiet(
        axes,
        "Force over indentation",
        headed("indentation", *CONTACT_DEPTH.units),
        headed("force", *CONTACT_FORCE.units),
    )
    axes.margins(x=0.03)


def _draw_phase(axes: Any, blows: Sequence[PlottedBlow]) -> None:
    def shares(blow: PlottedBlow) -> tuple[Array, Array]:
        deepest, speed = float(blow.impact.max_indentation), float(blow.impact.problem.speed[0])
        return blow.history.indentation / deepest, blow.history.rate / speed

    axes.axhline(0.0, color="#BBBBBB", linewidth=0.8)
    _curves(axes, blows, shares)
    quiet(axes, "Phase plane", "indentation / largest indentation (-)", "rate / approach speed (-)")
    axes.margins(x=0.03)


picture, page = impact_picture, impact_report
"""Picture and page of the result in Python, see `strikewave.reporting.shown_result`."""
