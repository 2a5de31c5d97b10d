"""Pictures of contacts: blows in the force-indentation and the phase plane, and the laws beside each other."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.contact import (
    DampingLaw,
    Geometry,
    Impact,
    ImpactHistory,
    LogarithmicStiffness,
    Stiffness,
    StiffnessLaw,
    damping_laws,
    impact_history,
    restitution,
    stiffness_laws,
    stiffness_of,
)
from strikewave.contact.law import indentation_under
from strikewave.contact.registry import FROM_MEMORY
from strikewave.contact.stiffness import ElasticBody
from strikewave.reporting.curves import COLOURS, DASHES
from strikewave.reporting.numbers import axis_unit, headed, with_unit
from strikewave.reporting.style import BLUE, GREEN, ORANGE, RED, put_below, quiet, sheet_title

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

LOWEST = 0.01
"""Smallest coefficient of restitution drawn: some laws have no value at 0."""
MANY_COLOURS = (BLUE, RED, GREEN, ORANGE, "#CC79A7", "#56B4E9", "#000000")
BELOW = "Difference, logarithmic beyond 10 %"
MARKS = ("o", "s", "^", "D", "v")


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

    Parameters
    ----------
    impacts : sequence of Impact
        Single blows.
    labels : sequence of str
        One a blow.
    title : str
        What to write above.
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
    (second, _), (newton, _) = axis_unit("s", "us"), axis_unit("N", "kN")
    _curves(axes, blows, lambda blow: (blow.history.time / second, blow.history.force / newton))
    quiet(axes, "Force", headed("time after first touch", "s", "us"), headed("force", "N", "kN"))


def _draw_loops(axes: Any, blows: Sequence[PlottedBlow]) -> None:
    (metre, _), (newton, _) = axis_unit("m", "um"), axis_unit("N", "kN")
    _curves(axes, blows, lambda blow: (blow.history.indentation / metre, blow.history.force / newton))
    quiet(axes, "Force over indentation", headed("indentation", "m", "um"), headed("force", "N", "kN"))
    axes.margins(x=0.03)


def _draw_phase(axes: Any, blows: Sequence[PlottedBlow]) -> None:
    def shares(blow: PlottedBlow) -> tuple[Array, Array]:
        deepest, speed = float(blow.impact.max_indentation), float(blow.impact.problem.speed[0])
        return blow.history.indentation / deepest, blow.history.rate / speed

    axes.axhline(0.0, color="#BBBBBB", linewidth=0.8)
    _curves(axes, blows, shares)
    quiet(axes, "Phase plane", "indentation / largest indentation (-)", "rate / approach speed (-)")
    axes.margins(x=0.03)


def asked_given(laws: Mapping[str, DampingLaw] | None = None) -> Figure:
    """Draw the restitution that comes out of damping laws over the one asked for, and the difference below.

    Parameters
    ----------
    laws : mapping of str to DampingLaw, optional
        All by default.

    Examples
    --------
    >>> [axes.get_ylabel() for axes in asked_given().axes]
    ['restitution given (-)', 'difference (% of e)']
    """
    e = np.linspace(LOWEST, 1.0, 199)
    curves = [(law, restitution(law.function(e))) for law in (damping_laws() if laws is None else laws).values()]
    curves.sort(key=lambda pair: -float(np.interp(0.5, e, pair[1])))
    figure, (above, below) = _two_panels((1.5, 1.0))
    above.plot(e, e, color="#D0D0D0", linewidth=6.0, label="given = asked", zorder=1)
    below.axhline(0.0, color="#D0D0D0", linewidth=6.0, zorder=1)
    for k, (law, given) in enumerate(curves):
        style = _style(k, law, e.size)
        above.plot(e, given, label=_named(law), **style)
        below.plot(e, 100.0 * (given / e - 1.0), **style)
    quiet(above, "Restitution that the damping laws give", "", "restitution given (-)")
    quiet(below, BELOW, "restitution asked for, e (-)", "difference (% of e)")
    above.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0))
    _symmetric_log(below)
    _list_beside(figure, above, "in the order at e = 0.5")
    return figure


def stiffness_over_load(one: ElasticBody, other: ElasticBody, geometry: Geometry, loads: ArrayLike) -> Figure:
    """Draw the indentation of two bodies over the load by every stiffness law, and the difference below.

    Laws that need a size not given, or do not hold for the sizes, are left out; a law ends where its formula ends.

    Parameters
    ----------
    one, other : ElasticBody
        The bodies, such as a `Material`.
    geometry : Geometry
        Their sizes.
    loads : array_like
        Ascending, N.

    Raises
    ------
    ValueError
        If no law is left.

    Examples
    --------
    >>> from strikewave.base.materials import material
    >>> steel = material("65Mn")
    >>> figure = stiffness_over_load(steel, steel, Geometry(0.01, 0.02, 0.04), [1e3, 1e4, 1e5])
    >>> figure.axes[1].get_ylabel()
    'difference from johnson (%)'
    """
    from matplotlib.ticker import FuncFormatter

    force = np.asarray(loads, dtype=float)
    curves = _indentations(one, other, geometry, force)
    if not curves:
        raise ValueError(f"no stiffness law does with these sizes: {_sizes(geometry)}")
    curves.sort(key=lambda pair: -float(np.nan_to_num(pair[1][-1])))
    figure, (above, below) = _two_panels((1.2, 1.0))
    reference = next((pair for pair in curves if pair[0].name == "johnson"), curves[0])
    (newton, _), (metre, _) = axis_unit("N", "kN"), axis_unit("m", "um")
    for k, (law, depth) in enumerate(curves):
        style = _style(k, law, force.size)
        above.loglog(force / newton, depth / metre, label=_named(law), **style)
        below.semilogx(force / newton, 100.0 * (depth / reference[1] - 1.0), **style)
    quiet(above, f"Indentation by the stiffness laws: {_sizes(geometry)}", "", headed("indentation", "m", "um"))
    quiet(below, BELOW, headed("load", "N", "kN"), f"difference from {reference[0].name} (%)")
    for axis in (below.xaxis, above.yaxis):
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    _symmetric_log(below)
    _list_beside(figure, above, "in the order at the largest load")
    return figure


def _sizes(geometry: Geometry) -> str:
    """Name the sizes that are given."""
    named = {"R1": geometry.radius1, "R2": geometry.radius2, "length": geometry.length}
    named["datum depth"] = geometry.datum_depth
    return ", ".join(
        f"{name} {'plane' if np.isinf(size) else with_unit(size, 'm', 'mm', 6)}"
        for name, size in named.items()
        if size is not None
    )


def _indentations(
    one: ElasticBody, other: ElasticBody, geometry: Geometry, force: Array
) -> list[tuple[StiffnessLaw, Array]]:
    """Return the laws that the sizes do for, and their indentations; NaN beyond the end of a law."""
    curves = []
    for name, law in stiffness_laws().items():
        try:
            stiffness = stiffness_of(name, one, other, geometry)
        except Exception:  # a size that is missing or out of range, or whatever a law of a foreign package does
            continue
        curves.append((law, _depths(stiffness, force)))
    return curves


def _depths(stiffness: Stiffness | LogarithmicStiffness, force: Array) -> Array:
    contact = stiffness.contact()
    depths = np.array([indentation_under(contact, float(f)) for f in force])
    end = stiffness.load / math.e if isinstance(stiffness, LogarithmicStiffness) else np.inf
    return np.where(force <= end, depths, np.nan)


def _two_panels(heights: tuple[float, float]) -> tuple[Any, Any]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 7.0), layout="constrained")
    return figure, figure.subplots(2, 1, sharex=True, height_ratios=heights)


def _style(k: int, law: DampingLaw | StiffnessLaw, count: int) -> dict[str, Any]:
    """Return the look of a law: dashed from memory; colour and mark tell it from the others."""
    every = max(count // 9, 1)
    return {
        "color": MANY_COLOURS[k % len(MANY_COLOURS)],
        "linestyle": "--" if law.status == FROM_MEMORY else "-",
        "marker": MARKS[k % len(MARKS)],
        "markersize": 4.5,
        "markevery": (k * every // 5 % every, every),
        "linewidth": 1.2,
        "zorder": 3,
    }


def _named(law: DampingLaw | StiffnessLaw) -> str:
    return law.name + (" (from memory)" if law.status == FROM_MEMORY else "")


def _list_beside(figure: Any, axes: Any, title: str) -> None:
    figure.legend(
        *axes.get_legend_handles_labels(), loc="outside right upper", frameon=False, fontsize=8.5, title=title,
        title_fontsize=8.5, alignment="left", handlelength=3.0, labelspacing=0.7,
    )  # fmt: skip


def _symmetric_log(axes: Any) -> None:
    """Scale an axis of per cent: linear within 10 %, logarithmic beyond."""
    from matplotlib.ticker import FixedLocator, FuncFormatter

    drawn = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in axes.lines])
    low, high = 1.5 * min(float(np.nanmin(drawn)), -4.0), 1.5 * max(float(np.nanmax(drawn)), 4.0)
    axes.set_yscale("symlog", linthresh=10.0)
    ticks = [t for t in (-100, -50, -10, -5, 0, 5, 10, 50, 100, 1000, 10_000) if low <= t <= high]
    axes.yaxis.set_major_locator(FixedLocator(ticks))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:+,.0f}".replace(",", " ") if value else "0"))
    axes.set_ylim(low, high)
