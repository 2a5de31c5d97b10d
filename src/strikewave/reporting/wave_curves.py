"""Pictures of waves over time: what taps and sensors show, the staircase of a layer, the loss of buffers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave.reporting.curves import COLOURS, DASHES, put_legend, shortened
from strikewave.reporting.numbers import axis_unit, headed, with_unit
from strikewave.reporting.style import BLUE, GREY, RED, WHOLE, new_figure, put_below, quiet
from strikewave.reporting.wave_field import WaveField
from strikewave.waves.li_ma import Sandwich, endless_force, first_echoes, staircase

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

_TRANSITS, _AFTER_PEAK = 9.0, 1.3
"""A staircase is drawn over so many transits of the layer, or so many times the time to the peak of the load (chosen:
all steps that are drawn are passed, or the peak is)."""
_AT_PEAK = 0.999
"""Share of the largest load from which on the peak counts as reached: a plateau is reached at its begin."""
_STEPS = 4
"""Steps of a staircase that are drawn; at a ratio of impedances of 3 the fifth adds less than 1 %."""
_APART = 0.06
"""Share of the largest load by which labels of steps are apart at least: letters of 7 points on axes of 2.4 inches."""


def staircase_diagram(field: WaveField, layer: int, time: Array, load: Array) -> Figure:
    """Draw how force grows at both interfaces of a layer, compared with bonded, endless neighbours.

    Forces are over the largest load; time counts from when the front reaches interface I, in transits of the
    layer. Dotted are the steps of `staircase` for a jump; dashed the same steps for the load as it was. Behind the
    first echo from beyond the neighbours the dashed curve ends.

    Parameters
    ----------
    field : WaveField
        What happened.
    layer : int
        Index of the layer, between two others.
    time, load : array
        s and N: force on the first face.

    Examples
    --------
    >>> from strikewave import load_case, run_wave
    >>> from strikewave.analyses.wave.report import field_of_solution
    >>> solution = run_wave(load_case("li-ma-2019-fig13-bar"))
    >>> figure = staircase_diagram(field_of_solution(solution), 1, solution.run.time, solution.run.face_force)
    >>> [axes.get_title(loc="left") for axes in figure.axes]
    ['Interface I: upper | sensor', 'Interface II: sensor | lower']
    """
    layers, transit = field.stack.layers, field.stack.layers[layer].transit
    peak = float(np.abs(load).max(initial=0.0)) or 1.0
    arrival = sum(part.transit for part in layers[:layer])
    highest = float(time[np.argmax(np.abs(load) >= _AT_PEAK * peak)])
    shown = field.time <= arrival + max(_TRANSITS * transit, _AFTER_PEAK * highest)
    since = (field.time[shown] - arrival) / transit
    until_last = time <= field.time[shown][-1]
    closed = endless_force(field.stack, layer, field.time[shown], time[until_last], load[until_last])
    steps = staircase(Sandwich(*layers[layer - 1 : layer + 2]), _STEPS)
    here = np.flatnonzero(field.layer == layer)
    figure = new_figure(WHOLE)
    for k, axes in enumerate(figure.subplots(1, 2, sharey=True)):
        _step_levels(axes, steps[k])
        heard = first_echoes(field.stack, layer)[k] / transit
        axes.plot(since, field.force[shown, here[-k]] / peak, color=BLUE, linewidth=1.6, label="this stack")
        before = since <= heard
        axes.plot(
            since[before], closed[k][before] / peak, "--", color=RED, linewidth=1.4, label="endless neighbours, bonded"
        )
        if heard < since[-1]:
            axes.axvline(heard, color=GREY, linewidth=0.8)
        a, b = (shortened(part.name) for part in layers[layer - 1 + k : layer + 1 + k])
        quiet(axes, "", f"time since the front reached I, over t₀ = {with_unit(transit, 's', 'us')}", "")
        axes.set_title(f"Interface {'I' * (k + 1)}: {a} | {b}", loc="left", fontsize=10, parse_math=False)
        axes.set_xlim(-1.0, float(since[-1]))
    figure.axes[0].set_ylabel("force over the largest load")
    handles, labels = figure.axes[1].get_legend_handles_labels()
    put_below(figure, handles, labels)
    return figure


def _step_levels(axes: Any, levels: Array) -> None:
    """Draw the steps of a staircase as dotted levels, and write those that are `_APART`."""
    labelled: list[float] = []
    for level in levels:
        axes.axhline(level, color=GREY, linewidth=0.8, linestyle=":")
        if all(abs(level - other) > _APART for other in labelled):
            labelled.append(float(level))
            axes.text(-0.95, level, f"{level:.3f}", fontsize=7, ha="left", va="bottom", color="#4d5760")


def insertion_loss(curves: Sequence[tuple[str, Array, Array]]) -> Figure:
    """Draw the insertion loss (dB) of buffers over frequency (Hz): what a buffer takes off the motion below it."""
    figure = new_figure(WHOLE)
    axes: Any = figure.add_subplot()
    for k, (name, frequency, loss) in enumerate(curves):
        axes.semilogx(
            frequency / axis_unit("Hz", "kHz")[0],
            loss,
            DASHES[k % len(DASHES)],
            color=COLOURS[k % len(COLOURS)],
            label=name,
            linewidth=1.4,
        )
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    quiet(axes, "Insertion loss of the buffer", headed("frequency", "Hz", "kHz"), "loss (dB), below 0 it amplifies")
    axes.set_xticks([1, 2, 5, 10, 20, 50, 100], ["1", "2", "5", "10", "20", "50", "100"])
    axes.minorticks_off()
    if len(curves) > 1:
        put_legend(axes)
    return figure
