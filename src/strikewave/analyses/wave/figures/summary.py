"""The summary of a bar alone: load, velocity and acceleration at the taps, and the x-t diagram."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from strikewave.analyses.wave.run import WaveSolution
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.reporting.curves import COLOURS, DASHES, above_right, thin
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
    run, since = solution.run, "time after the start of the load (µs)"
    time, force = thin(run.time, run.face_force)
    grid[0, 0].plot(time * 1e6, force / 1e3, color=GREY, linewidth=1.3)
    quiet(grid[0, 0], "Force on the first face", since, "force (kN)")
    shown = (
        (grid[0, 1], "Stress", lambda k: solution.stress(k) / 1e6, "stress (MPa)"),
        (grid[1, 0], "Velocity", lambda k: run.velocity[:, k], "velocity (m/s)"),
        (grid[1, 1], "Acceleration", lambda k: run.acceleration[:, k] / STANDARD_GRAVITY, "acceleration (g)"),
    )
    for axes, title, values, label in shown:
        for k, (name, _) in enumerate(solution.taps[: len(COLOURS)]):
            t, v = thin(run.time, np.asarray(values(k)))
            axes.plot(t * 1e6, v, DASHES[k % len(DASHES)], color=COLOURS[k], linewidth=1.2, label=name)
        quiet(axes, title, since, label)
    if len(solution.taps) > 1:
        above_right(grid[0, 1])
    if not solution.quoted:
        grid[1, 1].set_title("Acceleration (peaks not to be quoted)", loc="left", fontsize=10)
    return figure
