"""Pictures of split Hopkinson bars: shots, equilibrium in theory, echoes of a bar alone, a sensor on a bar end."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from strikewave.analyses.hopkinson.result import EchoSolution, HopkinsonSolution, SensorSolution
from strikewave.base.texts import percent
from strikewave.hopkinson import ANALYSES, stress_difference
from strikewave.hopkinson.checks import UNIFORM, face_forces
from strikewave.hopkinson.echoes import Echoes
from strikewave.hopkinson.pulses import Pulses
from strikewave.hopkinson.reduction import Reduction
from strikewave.reporting.numbers import axis_unit, headed, with_unit
from strikewave.reporting.style import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    RED,
    WHOLE,
    new_figure,
    put_legend,
    quiet,
    sheet_title,
    thin,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SINCE = "time after the wave arrives at the specimen"
AT_END = "time after the wave arrives at the end"
LOOKS = ((BLUE, "-"), (RED, "--"), (GREEN, "-."))
"""Colour and dashes of the first, second and third curve."""
WINDOW_LEVELS = (-1.55, -1.85)
"""Where the windows of pulses on the first and the second trace are drawn, plateaus of the incident pulse: below the
reflected pulse, which reaches -1 at most."""
RECORD_LIMITS = (-2.05, 1.35)
"""Axis of a record, plateaus: the windows with their names, and the ripple on top of the plateau."""
END_LEVELS, END_LIMITS = (-1.55, -1.9), (-2.15, 1.35)
"""The same for the record of a bar with a sensor on its end."""
STRAIN = 1e6
"""Microstrain in a strain."""
MARKED_TRANSITS = (3.0, 5.0)
"""Transits by which equilibrium is often taken for granted; a strip marks them."""


def _second() -> float:
    """Return the size of the unit in which times are shown, s."""
    return axis_unit("s", "us")[0]


def draw_record(axes: Any, pulses: Pulses) -> None:
    """Draw both traces about the pulses, and the windows in which these were found."""
    for quietened, (colour, dash), name in zip(pulses.traces, LOOKS, ("incident bar", "transmitted bar"), strict=False):
        time, strain = thin(quietened.trace.time, quietened.trace.strain)
        axes.plot(time / _second(), strain * STRAIN, dash, color=colour, linewidth=1.0, label=name)
    top = float(pulses.plateau) * STRAIN
    names = ("incident", "reflected", "transmitted")
    for k, (start, name) in enumerate(zip(pulses.starts, names, strict=True)):
        begin, end = start / _second(), (start + pulses.duration) / _second()
        level = WINDOW_LEVELS[0 if k < 2 else 1] * top
        _window(axes, (begin, end), level, name)
    quiet(axes, "Record and windows", headed("time of the record", "s", "us"), "strain (µε), compression +")
    axes.set_ylim(RECORD_LIMITS[0] * top, RECORD_LIMITS[1] * top)
    first, last = pulses.traces[0].trace.time[[0, -1]]
    axes.set_xlim(
        max(first, pulses.starts[0] - 0.5 * pulses.duration) / _second(),
        min(last, max(pulses.starts) + 1.5 * pulses.duration) / _second(),
    )
    put_legend(axes)


def _window(axes: Any, span: tuple[float, float], level: float, name: str) -> None:
    """Draw the window of a pulse as a bar with its name."""
    axes.plot(span, [level, level], "|-", color=GREY, linewidth=1.0, markersize=6)
    axes.text(0.5 * sum(span), level, name, fontsize=8, ha="center", va="bottom", color=GREY)


def draw_waves(axes: Any, reduction: Reduction) -> None:
    """Draw the three waves at the specimen, the reflected one turned over, and what incident and reflected add to."""
    w = reduction.waves
    shown = (("incident", w.incident), ("−reflected", -w.reflected), ("transmitted", w.transmitted))
    for (name, strain), (colour, dash) in zip(shown, LOOKS, strict=True):
        axes.plot(w.time / _second(), strain * STRAIN, dash, color=colour, linewidth=1.3, label=name)
    axes.axvline(w.loaded / _second(), color=GREY, linewidth=0.8, linestyle=":")
    quiet(axes, "At the specimen", headed(SINCE, "s", "us"), "strain (µε), compression +")
    put_legend(axes)


def draw_forces(axes: Any, solution: HopkinsonSolution) -> None:
    """Draw the forces on both faces, and below them by how much they differ."""
    r, (newton, _) = solution.reduction, axis_unit("N", "kN")
    time = r.time / _second()
    axes.plot(time, r.first_force / newton, "-", color=BLUE, linewidth=1.3, label="F1, incident bar")
    axes.plot(time, r.second_force / newton, "--", color=RED, linewidth=1.3, label="F2, transmitted bar")
    axes.axvline(r.waves.loaded / _second(), color=GREY, linewidth=0.8, linestyle=":")
    quiet(axes, "Force balance", headed(SINCE, "s", "us"), headed("force", "N", "kN"))
    put_legend(axes)


def draw_difference(axes: Any, solution: HopkinsonSolution) -> None:
    """Draw how much the forces differ while the incident wave lasts."""
    r, on = solution.reduction, solution.reduction.loading
    axes.plot(r.time[on] / _second(), 100.0 * solution.equilibrium.ratio[on], color=BLUE, linewidth=1.2)
    axes.axhline(100.0 * UNIFORM, color=GREY, linewidth=0.9, linestyle="--")
    axes.text(
        1.0, 100.0 * UNIFORM, f" {percent(UNIFORM, 0)}", transform=axes.get_yaxis_transform(), fontsize=8, va="center"
    )
    quiet(axes, "Difference of the forces over their mean", headed(SINCE, "s", "us"), "2 |F1−F2| / |F1+F2| (%)")
    axes.set_ylim(0.0, 100.0)


def draw_curves(axes: Any, reduction: Reduction) -> None:
    """Draw true stress over true strain by the three analyses while the incident wave lasts."""
    on = reduction.loading
    for name, (colour, dash) in zip(ANALYSES, LOOKS, strict=True):
        true = reduction.curve(name).true()
        axes.plot(
            100.0 * true.strain[on],
            true.stress[on] / axis_unit("Pa", "MPa")[0],
            dash,
            color=colour,
            linewidth=1.3,
            label=name,
        )
    quiet(axes, "True curve", "true strain (%)", headed("true stress", "Pa", "MPa"))
    put_legend(axes)


def draw_rate(axes: Any, reduction: Reduction) -> None:
    """Draw the true strain rate over true strain by 1-wave and 3-wave analysis."""
    on = reduction.loading
    for name, (colour, dash) in zip(("1-wave", "3-wave"), (LOOKS[0], LOOKS[2]), strict=True):
        true = reduction.curve("1-wave" if name == "1-wave" else "3-wave").true()
        axes.plot(
            100.0 * true.strain[on],
            true.rate[on] / axis_unit("1/s", "1/s")[0],
            dash,
            color=colour,
            linewidth=1.3,
            label=name,
        )
    quiet(axes, "True strain rate", "true strain (%)", headed("rate", "1/s", "1/s"))
    put_legend(axes)


def shot_summary(solution: HopkinsonSolution) -> Figure:
    """Draw a reduced shot: record, waves, forces, their difference, curve and rate."""
    figure = new_figure((11.0, 9.6))
    sheet_title(figure, solution.title)
    grid = figure.subplots(3, 2)
    draw_record(grid[0, 0], solution.pulses)
    draw_waves(grid[0, 1], solution.reduction)
    draw_forces(grid[1, 0], solution)
    draw_difference(grid[1, 1], solution)
    draw_curves(grid[2, 0], solution.reduction)
    draw_rate(grid[2, 1], solution.reduction)
    return figure


def draw_passes(axes: Any, echoes: Echoes) -> None:
    """Draw the trace of a bar with its passes."""
    trace = echoes.quiet.trace
    time, strain = thin(trace.time, trace.strain)
    axes.plot(time / _second(), strain * STRAIN, color=BLUE, linewidth=0.9)
    top = 1.25 * float(np.abs(strain).max()) * STRAIN
    for k, passed in enumerate(echoes.times):
        axes.axvline(passed / _second(), color=GREY, linewidth=0.8, linestyle=":")
        axes.text(passed / _second(), top, f" {k + echoes.first + 1}", fontsize=8, va="top", color=GREY)
    quiet(axes, "Passes of the pulse", headed("time of the record", "s", "us"), "strain (µε), first pulse +")
    axes.set_ylim(-top, top)


def draw_speed(axes: Any, echoes: Echoes, stated: float) -> None:
    """Draw the phase speed over frequency with its scatter, the theory, and the stated speed."""
    (speed, _), frequency = axis_unit("m/s", "m/s"), echoes.frequency / axis_unit("Hz", "kHz")[0]
    error = np.nan_to_num(echoes.phase_speed_error) / speed
    axes.errorbar(
        frequency,
        echoes.phase_speed / speed,
        error,
        fmt="o",
        color=BLUE,
        markersize=4,
        capsize=2,
        label="echoes ± error",
    )
    axes.plot(frequency, echoes.theory_speed / speed, "-", color=RED, linewidth=1.4, label="theory")
    axes.axhline(stated / speed, color=GREY, linewidth=1.0, linestyle="--", label="stated")
    quiet(axes, "Phase speed", headed("frequency", "Hz", "kHz"), headed("speed", "m/s", "m/s"))
    put_legend(axes)


def draw_losses(axes: Any, echoes: Echoes) -> None:
    """Draw the attenuation over frequency with its scatter."""
    error = np.nan_to_num(echoes.losses_error)
    axes.errorbar(
        echoes.frequency / axis_unit("Hz", "kHz")[0],
        echoes.losses,
        error,
        fmt="o",
        color=BLUE,
        markersize=4,
        capsize=2,
        label="round trips",
    )
    axes.axhline(echoes.attenuation.value, color=RED, linewidth=1.2, label="mean by energy")
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    quiet(axes, "Attenuation", headed("frequency", "Hz", "kHz"), "attenuation (1/m)")
    put_legend(axes)


def echo_summary(solution: EchoSolution) -> Figure:
    """Draw the calibration of a bar: its passes, phase speed and attenuation over frequency."""
    figure = new_figure((11.0, 6.8))
    sheet_title(figure, solution.title)
    grid = figure.subplot_mosaic([["passes", "passes"], ["speed", "losses"]])
    draw_passes(grid["passes"], solution.echoes)
    draw_speed(grid["speed"], solution.echoes, solution.bar.speed)
    draw_losses(grid["losses"], solution.echoes)
    return figure


def draw_accelerations(axes: Any, solution: SensorSolution) -> None:
    """Draw the reference acceleration of the sensor, and its reading with the delay taken out."""
    comparison = solution.comparison
    size, _ = axis_unit("m/s^2", "g")
    label = "reading / sensitivity" if solution.unit == "V" else "reading"
    for values, name, (colour, dash) in zip(
        (comparison.motion.acceleration, solution.shown_acceleration),
        ("reference by the gauge", label),
        LOOKS,
        strict=False,
    ):
        time, shown = thin(comparison.time, values)
        axes.plot(time / _second(), shown / size, dash, color=colour, linewidth=1.3, label=name)
    title = f"Acceleration at {with_unit(comparison.bandwidth.value, 'Hz', 'kHz', 3)}" + (
        "" if solution.quoted else ": not to be quoted"
    )
    quiet(axes, title, headed(AT_END, "s", "us"), headed("acceleration", "m/s^2", "g"))
    put_legend(axes)


def draw_sensor_difference(axes: Any, solution: SensorSolution) -> None:
    """Draw by how much the reading differs from the reference, over the peak of the reference."""
    comparison = solution.comparison
    time, shown = thin(comparison.time, solution.shown_acceleration - comparison.motion.acceleration)
    axes.plot(time / _second(), 100.0 * shown / comparison.peaks[0], color=BLUE, linewidth=1.1)
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    quiet(axes, "Reading less reference", headed(AT_END, "s", "us"), "share of the peak (%)")


def draw_velocities(axes: Any, solution: SensorSolution) -> None:
    """Draw the velocity of the sensor by the gauge, by both waves at the end, and by its integrated reading."""
    comparison = solution.comparison
    histories = (comparison.motion.velocity, solution.shown_velocity, comparison.both_waves)
    names, widths = ("reference", "reading", "both waves"), (3.0, 1.7, 1.0)
    for values, name, width, (colour, dash) in zip(histories, names, widths, LOOKS, strict=True):
        time, shown = thin(comparison.time, values)
        axes.plot(time / _second(), shown / axis_unit("m/s", "m/s")[0], dash, color=colour, linewidth=width, label=name)
    quiet(axes, "Velocity", headed(AT_END, "s", "us"), headed("velocity", "m/s", "m/s"))
    put_legend(axes)


def draw_end_record(axes: Any, solution: SensorSolution) -> None:
    """Draw the strain at the gauge, and the windows of the incident and of the reflected pulse."""
    pulses = solution.comparison.pulses
    trace, top = pulses.traces[0].trace, float(pulses.plateau) * STRAIN
    time, strain = thin(trace.time, trace.strain)
    axes.plot(time / _second(), strain * STRAIN, color=BLUE, linewidth=1.0)
    for start, name, level in zip(pulses.starts, ("incident", "reflected"), END_LEVELS, strict=False):
        begin, end = start / _second(), (start + pulses.duration) / _second()
        _window(axes, (begin, end), level * top, name)
    quiet(axes, "Strain at the gauge", headed("time of the record", "s", "us"), "strain (µε), compression +")
    axes.set_ylim(END_LIMITS[0] * top, END_LIMITS[1] * top)
    first, last = trace.time[[0, -1]]
    axes.set_xlim(
        max(first, pulses.starts[0] - 0.2 * pulses.duration) / _second(),
        min(last, pulses.starts[1] + 1.2 * pulses.duration) / _second(),
    )


def sensor_summary(solution: SensorSolution) -> Figure:
    """Draw an accelerometer compared with its reference: accelerations, their difference, velocities, the strain."""
    figure = new_figure((11.0, 9.6))
    sheet_title(figure, solution.title)
    grid = figure.subplot_mosaic([["acceleration"] * 2, ["difference", "velocity"], ["strain"] * 2])
    draw_accelerations(grid["acceleration"], solution)
    draw_sensor_difference(grid["difference"], solution)
    draw_velocities(grid["velocity"], solution)
    draw_end_record(grid["strain"], solution)
    return figure


def uniformity(ratios: Sequence[float] = (0.1, 0.25, 0.5, 1.0), rise: float = 2.0, transits: int = 12) -> Figure:
    """Draw how the forces on an elastic specimen come together: a step, and a rise of so many transits.

    The strip marks the 3 to 5 transits by which equilibrium is often taken for granted.

    Examples
    --------
    >>> len(uniformity((0.1, 0.5)).axes)
    2
    """
    figure = new_figure(WHOLE)
    left, right = figure.subplots(1, 2, sharey=True)
    time = np.linspace(0.005, transits, 40 * transits)
    looks = ((BLUE, "-"), (RED, "--"), (GREEN, "-."), (ORANGE, ":"))
    for beta, (colour, dash) in zip(ratios, looks, strict=False):
        k = np.arange(1, transits + 1)
        steps = 100.0 * stress_difference(beta, k)
        left.step(np.append(k - 1, transits), np.append(steps, steps[-1]), dash, where="post", color=colour)
        ramp = 100.0 * np.abs(face_forces(beta, time, rise).alpha)
        right.plot(time, ramp, dash, color=colour, label=f"β = {beta:g}")
    for axes, title in ((left, "Step"), (right, f"Straight rise over {rise:g} transits")):
        axes.axvspan(*MARKED_TRANSITS, color="#EFEFEF", zorder=0)
        axes.axhline(100.0 * UNIFORM, color=GREY, linewidth=0.9, linestyle="--")
        quiet(axes, title, "time over transit time t/t₀", "force difference |α| (%)")
        axes.set_yscale("log")
        axes.set_ylim(0.1, 300.0)
        axes.set_xlim(0.0, transits)
    right.set_ylabel("")
    handles, labels = right.get_legend_handles_labels()
    left.legend(handles, labels, frameon=False, fontsize=8, loc="upper right")
    return figure
