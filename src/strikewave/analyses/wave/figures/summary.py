"""The summary of a bar alone: load, velocity and acceleration at the taps, and the x-t diagram."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from strikewave.analyses.wave.run import WaveSolution
from strikewave.reporting.curves import COLOURS, DASHES, put_legend, thin
from strikewave.reporting.numbers import axis_unit, headed
from strikewave.reporting.style import GREY, new_figure, quiet, sheet_title


def wave_summary(solution: WaveSolution) -> Figure:
    """Draw stress, velocity and acceleration at the taps of a bar, and the force on its first face.

    Examples
    --------
    >>> from strikewave import load_case, run_wave
    >>> len(wave_summary(run_wave(load_case("li-ma-2019-fig13-bar"))).axes)
    4
    """
    figure = new_figure((9.0, 6.4))
    sheet_title(figure, solution.title)
    grid = figure.subplots(2, 2)
    run, since = solution.run, headed("time after the start of the load", "s", "us")
    unit, newtons, pascals = axis_unit("s", "us")[0], axis_unit("N", "kN")[0], axis_unit("Pa", "MPa")[0]
    speed, size = axis_unit("m/s", "m/s")[0], axis_unit("m/s^2", "g")[0]
    time, force = thin(run.time, run.face_force)
    grid[0, 0].plot(time / unit, force / newtons, color=GREY, linewidth=1.3)
    quiet(grid[0, 0], "Force on the first face", since, headed("force", "N", "kN"))
    shown = (
        (grid[0, 1], lambda k: solution.stress(k) / pascals, "stress", "Pa", "MPa"),
        (grid[1, 0], lambda k: run.velocity[:, k] / speed, "velocity", "m/s", "m/s"),
        (grid[1, 1], lambda k: run.acceleration[:, k] / size, "acceleration", "m/s^2", "g"),
    )
    for axes, values, name_of, si, usual in shown:
        for k, (name, _) in enumerate(solution.taps[: len(COLOURS)]):
            t, v = thin(run.time, np.asarray(values(k)))
            axes.plot(t / unit, v, DASHES[k % len(DASHES)], color=COLOURS[k], linewidth=1.2, label=name)
        quiet(axes, name_of.capitalize(), since, headed(name_of, si, usual))
    if len(solution.taps) > 1:
        put_legend(grid[0, 1])
    if not solution.quoted:
        grid[1, 1].set_title("Acceleration (peaks not to be quoted)", loc="left", fontsize=10)
    return figure
