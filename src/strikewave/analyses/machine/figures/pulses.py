"""The pictures of a run: its summary, force and acceleration of one blow, all pulses overlaid, the whole train."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.machine.result import SHOWN_WIDTHS, Solution, blow_history
from strikewave.machines import Blow
from strikewave.reporting.numbers import axis_unit, headed
from strikewave.reporting.style import (
    BLUE,
    GREY,
    HALF,
    MOST_PULSES,
    ORANGE,
    RED,
    WHOLE,
    figure_with_axes,
    put_legend,
    quiet,
    sheet_title,
    thin,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

KIND_COLOURS = {"full": BLUE, "glancing": ORANGE, "double": RED, "missed": GREY}
MOST_LABELS = 16


def summary(solution: Solution) -> Figure:
    """Draw the first blow (contact force, rigid-body acceleration) above the whole train of blows.

    Examples
    --------
    >>> from strikewave import load_case, run_case
    >>> figure = summary(run_case(load_case("li-ma-2019")))
    >>> len(figure.axes)
    3
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 6.4), layout="constrained")
    grid = figure.add_gridspec(2, 2, height_ratios=(1.0, 1.0))
    sheet_title(figure, solution.title)
    force, acceleration, train = [figure.add_subplot(cell) for cell in (grid[0, 0], grid[0, 1], grid[1, :])]
    first = solution.first_blow
    if first is not None:
        _draw_force(solution, solution.blows.index(first), force)
        _draw_acceleration(solution, solution.blows.index(first), acceleration)
    else:
        for axes in (force, acceleration):
            axes.set_axis_off()
            axes.text(0.5, 0.5, "no striker touched the object", ha="center", transform=axes.transAxes)
    _train(solution, train)
    return figure


def _draw_force(solution: Solution, row: int, axes: Any) -> None:
    """Draw the contact force of a blow."""
    blow = solution.blows[row]
    time, force = _window(solution, row, "pulse_force", blow.width)
    axes.plot(time, force / axis_unit("N", "kN")[0], color=BLUE, linewidth=1.4)
    quiet(axes, f"Contact force, blow {blow.index}", since_touch(), headed("force", "N", "kN"))
    few_ticks(axes)


def _draw_acceleration(solution: Solution, row: int, axes: Any) -> None:
    """Draw the rigid-body acceleration of a blow, with the published marks where they belong."""
    blow = solution.blows[row]
    time, values = _window(solution, row, "pulse_acceleration", blow.width)
    acceleration = values / axis_unit("m/s^2", "g")[0]
    axes.plot(time, acceleration, color=BLUE, linewidth=1.4, label="computed")
    title = f"Rigid-body acceleration, blow {blow.index}"
    quiet(axes, title, since_touch(), headed("acceleration", "m/s^2", "g"))
    few_ticks(axes)
    if blow is solution.first_blow and not solution.case.changed_fields():
        published_marks(solution, axes, time, acceleration)
    if len(axes.get_legend_handles_labels()[0]) > 1:
        axes.legend(frameon=False, fontsize=8, loc="upper right")


def few_ticks(axes: Any) -> None:
    """Give a half sheet fewer times where they have five digits, so that they do not run into one another."""
    if axes.dataLim.x1 >= 1e4:
        axes.locator_params(axis="x", nbins=5)


def peak_time(solution: Solution, blow: Blow) -> float:
    """Return when the acceleration of a blow is largest, s after time zero; its first touch where none is."""
    time, values = solution.arrays["time"].values, solution.arrays["rigid_acceleration"].values
    begin, end = np.searchsorted(time, (blow.time, blow.time + (blow.width if blow.width > 0.0 else 0.0)))
    return float(time[begin + np.argmax(values[begin:end])]) if end > begin else blow.time


def published_marks(solution: Solution, axes: Any, time: Any, acceleration: Any) -> None:
    """Mark published peak and width of the first blow: numbers, not curves, and only where they belong.

    Time and acceleration are those of the axes, in the units shown.
    """
    (unit, _), (size, _) = axis_unit("s", "us"), axis_unit("m/s^2", "g")
    styles = {"measured": (RED, "o"), "simulated": (GREY, "s"), "specified": (ORANGE, "D")}
    values = {(c.quantity, c.measured_or_simulated): c.published for c in solution.published}
    top = time[int(np.nanargmax(acceleration))]
    above = time[acceleration >= 0.1 * np.nanmax(acceleration)]
    for origin, (colour, marker) in styles.items():
        peak = values.get(("first.rigid_peak", origin))
        width = values.get(("first.width", origin))
        if peak is None:
            continue
        height = peak / size
        axes.plot([top], [height], marker, color=colour, markersize=6, fillstyle="none", label=f"published, {origin}")
        if width is not None and above.size:
            axes.plot(
                [above[0], above[0] + width / unit], [0.1 * height] * 2, "|-", color=colour, linewidth=1.2, markersize=9
            )


def since_touch() -> str:
    """Return the label of the time of one blow."""
    return headed("time after first touch", "s", "us")


def time_words(solution: Solution) -> str:
    """Return what the time of the whole run counts from."""
    return str(solution.arrays["time"].attrs.get("long_name", "time after the valve signal"))


def _train(solution: Solution, axes: Any) -> None:
    data = solution.arrays
    (unit, _), (size, _) = axis_unit("s", "ms"), axis_unit("m/s^2", "g")
    time = data["time"].values / unit
    acceleration = data["rigid_acceleration"].values / size
    axes.plot(time, acceleration, color=BLUE, linewidth=0.8)
    since = headed(time_words(solution), "s", "ms")
    quiet(axes, "Rigid-body acceleration, whole train", since, headed("acceleration", "m/s^2", "g"))
    labelled = len(solution.blows) <= MOST_LABELS
    room = 0.06 * (time[-1] - time[0]) * unit if time.size else 0.0
    free = -math.inf
    for blow in solution.blows:
        height = 0.0 if blow.kind == "missed" else blow.rigid_peak / size
        place = (peak_time(solution, blow) / unit, height)
        axes.plot(*place, "o", color=KIND_COLOURS[blow.kind], markersize=4)
        if (labelled and blow.kind == "full") or (blow.kind != "full" and blow.time >= free):
            free = blow.time + (room if blow.kind != "full" else 0.0)
            text = str(blow.index) if blow.kind == "full" else f"{blow.index} {blow.kind}"
            axes.annotate(text, place, xytext=(0, 5), textcoords="offset points", ha="center", fontsize=8)
    axes.margins(y=0.14)


Array = NDArray[np.float64]


def contact_force(solution: Solution, row: int = 0) -> Figure:
    """Draw the contact force of one blow (``row`` from 0).

    Examples
    --------
    >>> from strikewave import load_case, run_case
    >>> figure = contact_force(run_case(load_case("li-ma-2019", ["feed.blows=1"])))
    >>> figure.axes[0].get_ylabel()
    'force (kN)'
    """
    figure, axes = figure_with_axes(HALF)
    _draw_force(solution, row, axes)
    return figure


def rigid_acceleration(solution: Solution, row: int = 0) -> Figure:
    """Draw the rigid-body acceleration of one blow, with the published marks where they belong."""
    figure, axes = figure_with_axes(HALF)
    _draw_acceleration(solution, row, axes)
    return figure


def overlaid_pulses(solution: Solution) -> Figure:
    """Draw the rigid-body pulses of the blows over each other: the first, the later full ones, the odd ones."""
    figure, axes = figure_with_axes(WHOLE)
    size, _ = axis_unit("m/s^2", "g")
    seen: set[str] = set()
    rows = drawn_blows(solution)
    longest = max([solution.blows[row].width for row in rows if solution.blows[row].width > 0.0], default=0.0)
    for row in reversed(rows):  # the first one on top
        blow = solution.blows[row]
        time, values = _window(solution, row, "pulse_acceleration", longest)
        if blow is solution.first_blow:
            odd = "" if blow.kind == "full" else f" ({blow.kind})"
            colour, label, width = BLUE, f"blow {blow.index}, the first{odd}", 1.6
        elif blow.kind == "full":
            colour, label, width = GREY, "later full blows", 0.9
        else:
            colour, label, width = KIND_COLOURS.get(blow.kind, GREY), f"{blow.kind} blows", 1.2
        axes.plot(time, values / size, color=colour, linewidth=width, label="_" if label in seen else label)
        seen.add(label)
    since = headed("time after first touch of each blow", "s", "us")
    quiet(axes, "Rigid-body pulses, overlaid", since, headed("acceleration", "m/s^2", "g"))
    handles, labels = axes.get_legend_handles_labels()
    put_legend(axes, handles[::-1], labels[::-1])
    return figure


def whole_train(solution: Solution) -> Figure:
    """Draw the rigid-body acceleration of the whole train and mark each blow."""
    figure, axes = figure_with_axes(WHOLE)
    data = solution.arrays
    time, values = thin(data["time"].values, data["rigid_acceleration"].values)
    (unit, _), (size, _) = axis_unit("s", "ms"), axis_unit("m/s^2", "g")
    axes.plot(time / unit, values / size, color=BLUE, linewidth=0.8)
    since = headed(time_words(solution), "s", "ms")
    quiet(axes, "Rigid-body acceleration, whole train", since, headed("acceleration", "m/s^2", "g"))
    places: dict[str, list[tuple[float, float]]] = {kind: [] for kind in KIND_COLOURS}
    for blow in solution.blows:
        place = (peak_time(solution, blow) / unit, 0.0 if blow.kind == "missed" else blow.rigid_peak / size)
        places[blow.kind].append(place)
        if len(solution.blows) <= MOST_LABELS:
            axes.annotate(str(blow.index), place, xytext=(0, 5), textcoords="offset points", ha="center", fontsize=8)
    for (kind, colour), shape in zip(KIND_COLOURS.items(), "osDx", strict=True):
        if places[kind]:
            axes.plot(*zip(*places[kind], strict=True), shape, color=colour, markersize=4, label=kind)
    if any(places[kind] for kind in KIND_COLOURS if kind != "full"):
        put_legend(axes, *axes.get_legend_handles_labels())
    axes.margins(y=0.14)
    return figure


def drawn_blows(solution: Solution) -> list[int]:
    """Return the rows of the blows whose pulses are drawn over each other."""
    struck = [row for row, blow in enumerate(solution.blows) if blow.kind != "missed"]
    if len(struck) <= MOST_PULSES:
        return struck
    odd = [row for row in struck if solution.blows[row].kind != "full"][: MOST_PULSES // 2]
    even = np.linspace(0, len(struck) - 1, MOST_PULSES // 2).round().astype(int)
    return sorted({*odd, *(struck[i] for i in even)})


def _window(solution: Solution, row: int, name: str, width: float) -> tuple[Array, Array]:
    """Return time (as shown) and values (SI) of a blow, cut where a pulse of this width (s) is over."""
    unit, _ = axis_unit("s", "us")
    time, values = blow_history(solution.arrays, row, name)
    shown = np.isfinite(values) & (time <= (SHOWN_WIDTHS * width if width > 0.0 else time[-1]))
    return time[shown] / unit, values[shown]
