"""The pictures of a report: force and acceleration of one blow, all pulses overlaid, the whole train."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.machine.figures.summary import (
    KIND_COLOURS,
    MOST_LABELS,
    few_ticks,
    peak_time,
    published_marks,
    since_touch,
    time_words,
)
from strikewave.analyses.machine.result import SHOWN_WIDTHS, blow_history
from strikewave.reporting.curves import MOST_PULSES, put_legend, thin
from strikewave.reporting.numbers import axis_unit, headed
from strikewave.reporting.style import BLUE, GREY, HALF, WHOLE, quiet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strikewave.analyses.machine.result import Solution

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
    figure, axes = _sheet(HALF)
    time, force = _window(solution, row, "pulse_force", solution.blows[row].width)
    size, _ = axis_unit("N", "kN")
    axes.plot(time, force / size, color=BLUE, linewidth=1.4)
    quiet(axes, f"Contact force, blow {solution.blows[row].index}", since_touch(), headed("force", "N", "kN"))
    few_ticks(axes)
    return figure


def rigid_acceleration(solution: Solution, row: int = 0) -> Figure:
    """Draw the rigid-body acceleration of one blow, with the published marks where they belong."""
    figure, axes = _sheet(HALF)
    blow = solution.blows[row]
    time, values = _window(solution, row, "pulse_acceleration", blow.width)
    size, _ = axis_unit("m/s^2", "g")
    acceleration = values / size
    axes.plot(time, acceleration, color=BLUE, linewidth=1.4, label="computed")
    if row == _first_struck(solution) and not solution.case.changed_fields():
        published_marks(solution, axes, time, acceleration)
    title = f"Rigid-body acceleration, blow {blow.index}"
    quiet(axes, title, since_touch(), headed("acceleration", "m/s^2", "g"))
    few_ticks(axes)
    if len(axes.get_legend_handles_labels()[0]) > 1:
        axes.legend(frameon=False, fontsize=8, loc="upper right")
    return figure


def overlaid_pulses(solution: Solution) -> Figure:
    """Draw the rigid-body pulses of the blows over each other: the first, the later full ones, the odd ones."""
    figure, axes = _sheet(WHOLE)
    size, _ = axis_unit("m/s^2", "g")
    first = _first_struck(solution)
    seen: set[str] = set()
    rows = chosen(solution)
    longest = max((solution.blows[row].width for row in rows if solution.blows[row].width > 0.0), default=0.0)
    for row in reversed(rows):  # the first one on top
        blow = solution.blows[row]
        time, values = _window(solution, row, "pulse_acceleration", longest)
        if row == first:
            colour, label, width = BLUE, f"blow {blow.index}, the first" + _odd(blow.kind), 1.6
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
    figure, axes = _sheet(WHOLE)
    data = solution.arrays
    time, values = thin(data["time"].values, data["rigid_acceleration"].values)
    (unit, _), (size, _) = axis_unit("s", "ms"), axis_unit("m/s^2", "g")
    axes.plot(time / unit, values / size, color=BLUE, linewidth=0.8)
    since = headed(time_words(solution), "s", "ms")
    quiet(axes, "Rigid-body acceleration, whole train", since, headed("acceleration", "m/s^2", "g"))
    kinds = {blow.kind for blow in solution.blows}
    for kind, colour in KIND_COLOURS.items():
        blows = [blow for blow in solution.blows if blow.kind == kind]
        if blows:
            heights = [0.0 if kind == "missed" else blow.rigid_peak / size for blow in blows]
            shape = "o" if kind == "full" else "D" if kind == "double" else "s" if kind == "glancing" else "x"
            axes.plot(
                [peak_time(solution, blow) / unit for blow in blows],
                heights,
                shape,
                color=colour,
                markersize=4,
                label=kind,
            )
    if len(solution.blows) <= MOST_LABELS:
        for blow in solution.blows:
            height = 0.0 if blow.kind == "missed" else blow.rigid_peak / size
            place = (peak_time(solution, blow) / unit, height)
            axes.annotate(str(blow.index), place, xytext=(0, 5), textcoords="offset points", ha="center", fontsize=8)
    if kinds - {"full"}:
        put_legend(axes, *axes.get_legend_handles_labels())
    axes.margins(y=0.14)
    return figure


def chosen(solution: Solution) -> list[int]:
    """Return the rows of the blows whose pulses are drawn over each other."""
    struck = [row for row, blow in enumerate(solution.blows) if blow.kind != "missed"]
    if len(struck) <= MOST_PULSES:
        return struck
    odd = [row for row in struck if solution.blows[row].kind != "full"][: MOST_PULSES // 2]
    even = np.linspace(0, len(struck) - 1, MOST_PULSES // 2).round().astype(int)
    return sorted({*odd, *(struck[i] for i in even)})


def _odd(kind: str) -> str:
    return "" if kind == "full" else f" ({kind})"


def _first_struck(solution: Solution) -> int:
    return next(row for row, blow in enumerate(solution.blows) if blow.kind != "missed")


def _sheet(size: tuple[float, float]) -> tuple[Figure, Any]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, layout="constrained")
    return figure, figure.add_subplot()


def _window(solution: Solution, row: int, name: str, width: float) -> tuple[Array, Array]:
    """Return time (as shown) and values (SI) of a blow, cut where a pulse of this width (s) is over."""
    unit, _ = axis_unit("s", "us")
    time, values = blow_history(solution.arrays, row, name)
    shown = np.isfinite(values) & (time <= (SHOWN_WIDTHS * width if width > 0.0 else time[-1]))
    return time[shown] / unit, values[shown]


__all__ = ["chosen", "contact_force", "overlaid_pulses", "rigid_acceleration", "thin", "whole_train"]
