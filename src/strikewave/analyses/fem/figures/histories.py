"""Histories of an explicit run: contact forces, energies, accelerations, sections, points, and blow after blow."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.transforms import ScaledTranslation
from numpy.typing import NDArray

from strikewave.fem.run import (
    ENERGIES,
    ENERGY_LIMIT,
    FemRun,
    blow_axis,
    contact_measure,
    mean_acceleration,
    mean_force,
    middles,
)
from strikewave.reporting.numbers import axis_unit, energy_unit, headed, time_unit, with_unit
from strikewave.reporting.style import (
    BLUE,
    COLOURS,
    DASHES,
    GREEN,
    GREY,
    HALF,
    ORANGE,
    RED,
    WHOLE,
    empty_axes,
    new_figure,
    one_diagram,
    quiet,
    sheet_title,
    shortened,
    thin,
)

Array = NDArray[np.float64]

MOST_CURVES = 8  # chosen: a legend of two rows, and none alike of colour and dash
"""Most curves of one picture, those that reach farthest."""
CUT_OFF = 3.0  # chosen: the groups, which a sensor measures, then fill at least a third of the axis
"""Reach of a part over that of every group from which on it is cut off."""
TINY = 1e-4  # on an axis of 300 pixels a smaller one is a line at zero
"""Smallest share of the largest energy that is drawn."""
NEAR_LIMIT = 0.2  # below, the limit would flatten it
"""Share of its limit from which on the balance error is drawn with the limit."""
AIR = 0.08  # chosen: more than the 0.05 of matplotlib, so that a curve that is cut off is seen to go on
"""Share of the range left free above and below groups that set the scale."""
PEAK_LABEL = 0.12  # chosen: room for the label of the peak
"""Share of the axis left free above the forces."""
_ENERGY_LOOKS = {
    "kinetic": (BLUE, "-"),
    "internal": (RED, "-"),
    "plastic": (RED, ":"),
    "hourglass": (ORANGE, "--"),
    "contact": (GREEN, "-."),
    "viscous": (GREY, "--"),
    "external": (GREY, ":"),
}


def summary_sheet(run: FemRun, title: str) -> Figure:
    """Draw contact force, energy balance, rigid-body acceleration and section stress or point motion on one sheet."""
    figure = new_figure((9.8, 7.2))
    sheet_title(figure, title)
    grid = figure.add_gridspec(2, 2)
    draw_forces(figure.add_subplot(grid[0, 0]), run)
    inner = grid[0, 1].subgridspec(2, 1, height_ratios=(3.2, 1.0))
    _draw_balance(figure, inner, run)
    draw_accelerations(figure.add_subplot(grid[1, 0]), run)
    last = draw_sections if run.sections or not run.points else draw_points
    last(figure.add_subplot(grid[1, 1]), run)
    return figure


def force_figure(run: FemRun) -> Figure:
    """Draw the contact forces alone, as wide as a page."""
    return one_diagram(lambda axes: draw_forces(axes, run), WHOLE)


def acceleration_figure(run: FemRun) -> Figure:
    """Draw the rigid-body accelerations alone."""
    return one_diagram(lambda axes: draw_accelerations(axes, run))


def section_figure(run: FemRun) -> Figure:
    """Draw the stress of sections alone."""
    return one_diagram(lambda axes: draw_sections(axes, run))


def point_figure(run: FemRun) -> Figure:
    """Draw the velocity of points alone."""
    return one_diagram(lambda axes: draw_points(axes, run))


def energy_figure(run: FemRun) -> Figure:
    """Draw the energies above the error of their balance, alone."""
    figure = new_figure(HALF)
    _draw_balance(figure, figure.add_gridspec(2, 1, height_ratios=(3.0, 1.0)), run)
    return figure


def draw_forces(axes: Any, run: FemRun) -> None:
    """Draw the mean of each contact force over each interval, its peak marked, and its impulse."""
    scale, unit = time_unit(run.time[-1])
    sizes = {name: np.linalg.norm(mean_force(run, name), axis=1) for name in run.force}
    chosen = _largest(sizes)
    if not any(values.max(initial=0.0) > 0.0 for values in sizes.values()):
        empty_axes(axes, "Contact force", "nothing touched" if sizes else "no contact is watched")
        return
    impulses = axes.twinx()
    (newton, _), (newton_second, _) = axis_unit("N", "kN"), axis_unit("N s", "N s")
    for k, name in enumerate(chosen):
        measure = contact_measure(run, name)
        look: dict[str, Any] = {"color": COLOURS[k % len(COLOURS)], "zorder": 4}
        label = shortened(name, 34)
        if measure is not None:
            label += f": {with_unit(measure.impulse, 'N s', 'N s', 3)}"
            axes.plot(measure.at / scale, measure.peak / newton, "o", markersize=4, **look)
            axes.annotate(
                with_unit(measure.peak, "N", "kN"),
                (measure.at / scale, measure.peak / newton),
                xytext=(5, 3),
                textcoords="offset points",
                fontsize=8,
            )
        _line(
            axes,
            middles(run.time) / scale,
            sizes[name] / newton,
            DASHES[k % len(DASHES)],
            label=label,
            linewidth=1.4,
            **look,
        )
        impulse = np.linalg.norm(run.impulse[name], axis=1) / newton_second
        _line(impulses, run.time / scale, impulse, ":", color=look["color"], linewidth=1.0)
    quiet(axes, "Contact force", f"time ({unit})", headed(f"force, mean of {_interval_words(run)}", "N", "kN"))
    axes.set_ylim(0.0, (1.0 + PEAK_LABEL) * axes.get_ylim()[1])
    impulses.set_ylabel(headed("impulse, dotted", "N s", "N s"))
    impulses.set_ylim(bottom=0.0)
    impulses.spines["top"].set_visible(False)
    _legend(axes, len(chosen), len(sizes))


def draw_energies(axes: Any, run: FemRun) -> None:
    """Draw the energies that reach at least `TINY` of the largest one."""
    scale, unit = time_unit(run.time[-1])
    most = max(float(np.abs(run.energy[name]).max(initial=0.0)) for name in ENERGIES)
    factor, name_of_unit = energy_unit(most)
    shown = [name for name in ENERGIES if float(np.abs(run.energy[name]).max(initial=0.0)) > TINY * most]
    if not shown:
        empty_axes(axes, "Energy", "nothing moves")
        return
    for name in shown:
        colour, dash = _ENERGY_LOOKS[name]
        label = "plastic (in internal)" if name == "plastic" else name
        _line(axes, run.time / scale, run.energy[name] / factor, dash, color=colour, linewidth=1.4, label=label)
    quiet(axes, "Energy", f"time ({unit})", f"energy ({name_of_unit})")


def draw_energy_error(axes: Any, run: FemRun) -> None:
    """Draw the energy balance error in per cent, with its limits where it comes near them."""
    scale, unit = time_unit(run.time[-1])
    error = 100.0 * run.energy_error
    _line(axes, run.time / scale, error, "-", color=BLUE, linewidth=1.2)
    quiet(axes, "", f"time ({unit})", "error (%)")
    most = float(np.abs(error).max(initial=0.0))
    if most > 100.0 * NEAR_LIMIT * ENERGY_LIMIT:
        for side in (-1.0, 1.0):
            axes.axhline(side * 100.0 * ENERGY_LIMIT, color=RED, linewidth=0.9, linestyle="--")
    reach = 1.25 * max(most, 1e-6)
    axes.set_ylim(-reach, reach)


def _draw_balance(figure: Figure, grid: Any, run: FemRun) -> None:
    """Draw the energies above their error, over the same time."""
    upper = figure.add_subplot(grid[0])
    lower = figure.add_subplot(grid[1], sharex=upper)
    draw_energies(upper, run)
    draw_energy_error(lower, run)
    upper.set_xlabel("")
    upper.tick_params(labelbottom=False)
    _legend(lower, 1, 1, source=upper)


def draw_accelerations(axes: Any, run: FemRun) -> None:
    """Draw the rigid-body acceleration of each part and group along the axis of the blow, means of intervals.

    Groups lie on top and set the scale: what reaches `CUT_OFF` times as far is cut off, and named with its reach.
    """
    axis = blow_axis(run)
    size, _ = axis_unit("m/s^2", "g")
    curves = {name: mean_acceleration(run, name) @ axis / size for name in (*run.groups, *run.parts)}
    label = headed(f"along {_axis_words(axis)}, mean of {_interval_words(run)}", "m/s^2", "g")
    _draw_curves(axes, run, curves, ("Rigid-body acceleration", label), middles(run.time), tuple(run.groups))


def draw_sections(axes: Any, run: FemRun) -> None:
    """Draw the mean stress of each section along the axis of the blow, tension positive."""
    axis = blow_axis(run)
    x, y, z = axis
    weights = np.array([x * x, y * y, z * z, 2 * x * y, 2 * y * z, 2 * z * x])
    size, _ = axis_unit("Pa", "MPa")
    curves = {name: section.stress @ weights / size for name, section in run.sections.items()}
    label = headed(f"stress along {_axis_words(axis)}", "Pa", "MPa")
    _draw_curves(axes, run, curves, ("Mean stress of sections", label))


def draw_points(axes: Any, run: FemRun) -> None:
    """Draw the velocity of each watched point along the axis of the blow."""
    axis = blow_axis(run)
    size, _ = axis_unit("m/s", "m/s")
    curves = {name: point.velocity @ axis / size for name, point in run.points.items()}
    label = headed(f"velocity along {_axis_words(axis)}", "m/s", "m/s")
    _draw_curves(axes, run, curves, ("Velocity of points", label))


def _draw_curves(
    axes: Any,
    run: FemRun,
    curves: Mapping[str, Array],
    labels: tuple[str, str],
    time: Array | None = None,
    chief: Sequence[str] = (),
) -> None:
    """Draw the named curves that reach farthest over a time, or a note where there is none.

    ``chief`` are drawn thick and above the others, and set the scale.
    """
    title, label = labels
    if not curves:
        empty_axes(axes, title, "none is watched")
        return
    scale, unit = time_unit(run.time[-1])
    time = run.time if time is None else time
    chosen = _largest(curves, chief)
    cut = _cut_off(curves, chief)
    for k, name in enumerate(chosen):
        low, high = (float(f"{end(curves[name], initial=0.0):.3g}") for end in (np.min, np.max))
        beyond = f" (cut off: {low:.0f} to {high:.0f})" if name in cut else ""
        look: dict[str, Any] = {"color": COLOURS[k % len(COLOURS)], "label": shortened(name, 28) + beyond}
        look |= {"linewidth": 2.4, "zorder": 4 + len(chosen)} if name in chief else {"linewidth": 1.1}
        look = {"zorder": 3 + len(chosen) - k, **look}
        _line(axes, time / scale, curves[name], DASHES[k % len(DASHES)], **look)
    if cut:
        values = np.concatenate([curves[name] for name in chosen if name not in cut])
        low, high = min(float(values.min()), 0.0), max(float(values.max()), 0.0)
        axes.set_ylim(low - AIR * (high - low), high + AIR * (high - low))
    quiet(axes, title, f"time ({unit})", label)
    axes.set_xlim(run.time[0] / scale, run.time[-1] / scale)
    axes.axhline(0.0, color=GREY, linewidth=0.6)
    _legend(axes, len(chosen), len(curves))


def _line(axes: Any, time: Array, values: Array, dash: str, **look: Any) -> None:
    """Draw a curve with no more samples than can be seen."""
    finite = np.isfinite(values)
    axes.plot(*thin(time[finite], values[finite]), dash, **look)


def _largest(curves: Mapping[str, Array], chief: Sequence[str] = ()) -> list[str]:
    """Return the names of the curves that reach farthest, ``chief`` before others, in the order in which they came."""
    ranked = sorted(curves, key=lambda name: (name not in chief, -_reach(curves[name])))[:MOST_CURVES]
    return [name for name in curves if name in ranked]


def _cut_off(curves: Mapping[str, Array], chief: Sequence[str]) -> set[str]:
    """Return the curves that reach so much farther than ``chief`` that they would flatten those."""
    most = max((_reach(curves[name]) for name in chief), default=0.0)
    return {name for name in curves if name not in chief and 0.0 < CUT_OFF * most < _reach(curves[name])}


def _reach(values: Array) -> float:
    return float(np.abs(values).max(initial=0.0))


def _legend(axes: Any, shown: int, of: int, source: Any = None) -> None:
    """Put a legend of the curves, or of those of ``source``, below the axes, where it hides none; count the others."""
    handles, labels = (source or axes).get_legend_handles_labels()
    if of < 2 and handles and source is None and not axes.texts:
        axes.set_title(f"{axes.get_title(loc='left')}: {labels[0]}", loc="left", fontsize=10, parse_math=False)
        return
    below = axes.transAxes + ScaledTranslation(0.0, -0.46, axes.figure.dpi_scale_trans)
    legend = axes.legend(
        handles,
        labels,
        frameon=False,
        fontsize=8,
        title=f"{shown} of {of}: those that reach farthest" if of > shown else None,
        title_fontsize=8,
        loc="upper left",
        bbox_to_anchor=(0.0, 0.0),
        bbox_transform=below,
        borderaxespad=0.0,
        ncols=max(1, min(len(labels), 64 // (max(map(len, labels), default=0) + 6))),
    )
    for text in legend.get_texts():
        text.set_parse_math(False)


def _interval_words(run: FemRun) -> str:
    """Return the interval of the histories with its unit."""
    return with_unit((run.time[-1] - run.time[0]) / max(run.time.size - 1, 1), "s", "us", 3)


def _axis_words(axis: Array) -> str:
    """Return the letter of an axis, x, y or z, or else its components."""
    along = np.flatnonzero(axis > 0.9999)  # within 0.8 degrees: components are shown to two digits
    return "xyz"[int(along[0])] if along.size else "(" + ", ".join(f"{v:.2g}" for v in axis) + ")"


MARGIN_OF_BLOWS = 0.1  # chosen: both ends are seen, and the pulse fills the picture
"""Share of the contact time shown before and after it."""
MOST_BLOW_LABELS = 5  # chosen: it stays in the upper corner
"""Most blows that are all in the legend, else the first two and the last."""
MOST_BLOW_TICKS = 10  # chosen: three-digit numbers stay apart in a third of the width of a page
"""Most blows that each have a tick."""


def blows_figure(runs: Sequence[FemRun]) -> Figure:
    """Draw the force of the strongest contact, mean of each interval, of all blows, beside the yield of each blow.

    The first blow is red and the last one blue; those between go from light to dark grey.
    """
    figure = new_figure(WHOLE)
    left, right = figure.subplots(1, 2, width_ratios=(1.9, 1.0))
    _draw_force_of_blows(left, runs)
    _draw_yield(right, runs)
    return figure


def _draw_force_of_blows(axes: Any, runs: Sequence[FemRun]) -> None:
    touching = {name: [t for run in runs if (t := contact_measure(run, name)) is not None] for name in runs[0].force}
    peaks = {name: max((touch.peak for touch in touching[name]), default=0.0) for name in touching}
    name = max(peaks, key=peaks.__getitem__, default="")
    if not peaks.get(name, 0.0) > 0.0:
        empty_axes(axes, "", "nothing touched")
        return
    (second, _), (newton, _) = axis_unit("s", "us"), axis_unit("N", "kN")
    for k, run in enumerate(runs):
        force = np.linalg.norm(mean_force(run, name), axis=1) / newton
        last = k == len(runs) - 1
        colour = RED if k == 0 else BLUE if last else str(round(0.75 - 0.5 * k / len(runs), 3))
        dash = "--" if last and k > 0 else "-"
        label = f"blow {run.blow}" if k in (0, 1) or last or len(runs) <= MOST_BLOW_LABELS else None
        axes.plot(*thin(middles(run.time) / second, force), dash, color=colour, linewidth=1.4, label=label)
    since, label = headed("time of each blow", "s", "us"), headed("mean force of intervals", "N", "kN")
    quiet(axes, "Contact force, blow after blow", since, label)
    axes.set_title(axes.get_title(loc="left") + f": {shortened(name, 34)}", loc="left", fontsize=10, parse_math=False)
    begin = min(touch.begin for touch in touching[name]) / second
    end = max(touch.end for touch in touching[name]) / second
    axes.set_xlim(max(0.0, begin - MARGIN_OF_BLOWS * (end - begin)), end + MARGIN_OF_BLOWS * (end - begin))
    axes.set_ylim(bottom=0.0)
    axes.legend(frameon=False, fontsize=8, loc="upper right")


def _draw_yield(axes: Any, runs: Sequence[FemRun]) -> None:
    """Draw the plastic energy of each blow as a share of the energy in play."""
    shares = [100.0 * sum(run.plastic_work.values()) / max(run.energy_in_play, 1e-300) for run in runs]
    numbers = [run.blow for run in runs]
    axes.bar(numbers, shares, width=0.6, color=ORANGE)
    quiet(axes, "Taken by yield in each blow", "blow", "share of the energy in play (%)")
    axes.set_xlim(0.4, len(numbers) + 0.6)
    axes.set_xticks(
        numbers if len(numbers) <= MOST_BLOW_TICKS else numbers[:: len(numbers) // (MOST_BLOW_TICKS - 3) + 1]
    )
    if max(shares) <= 0.0:
        axes.set_ylim(0.0, 1.0)
        axes.text(0.5, 0.5, "nothing yields", ha="center", va="center", transform=axes.transAxes, color=GREY)
