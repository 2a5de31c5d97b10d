"""Pictures of split Hopkinson bars: a shot, a bar alone by its echoes, a sensor on a bar end."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from strikewave.analyses.hopkinson.result import EchoSolution, HopkinsonSolution, SensorSolution
from strikewave.base.texts import percent
from strikewave.hopkinson import ANALYSES
from strikewave.hopkinson.checks import UNIFORM
from strikewave.hopkinson.pulses import Pulses
from strikewave.reporting.numbers import axis_unit, headed, with_unit
from strikewave.reporting.parts import Picture
from strikewave.reporting.style import (
    BLUE,
    GREEN,
    GREY,
    HALF,
    RED,
    WHOLE,
    new_figure,
    one_diagram,
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
"""Levels of the windows on the first and the second trace over the plateau: below the reflected pulse, -1 at most."""
RECORD_LIMITS = (-2.05, 1.35)
"""Axis of a record over the plateau: the windows with their names, and the ripple on top of the plateau."""
END_LEVELS, END_LIMITS = (-1.55, -1.9), (-2.15, 1.35)
"""The same for the record of a bar with a sensor on its end."""
STRAIN = 1e6
"""Microstrain in a strain."""

Curve = tuple[str, Any, Any]
"""Name, time or other abscissa, and values in their shown units."""


def _second() -> float:
    """Return the size of the unit in which times are shown, s."""
    return axis_unit("s", "us")[0]


def _curves(axes: Any, curves: Iterable[Curve], looks: Iterable[tuple[str, str]] = LOOKS, width: float = 1.3) -> None:
    """Draw named curves in their looks, with a legend."""
    for (name, x, values), (colour, dash) in zip(curves, looks, strict=False):
        axes.plot(x, values, dash, color=colour, linewidth=width, label=name)


def _windows(axes: Any, pulses: Pulses, levels: Iterable[float], names: Iterable[str]) -> None:
    """Draw the windows of pulses as bars with their names, at levels over the plateau."""
    top = float(pulses.plateau) * STRAIN
    for start, level, name in zip(pulses.starts, levels, names, strict=False):
        span = start / _second(), (start + pulses.duration) / _second()
        axes.plot(span, [level * top] * 2, "|-", color=GREY, linewidth=1.0, markersize=6)
        axes.text(0.5 * sum(span), level * top, name, fontsize=8, ha="center", va="bottom", color=GREY)


def _record_limits(axes: Any, pulses: Pulses, limits: tuple[float, float], before: float, until: float) -> None:
    """Set the axes of a record: strain over the plateau, time from ``before`` window lengths on until one, s."""
    top = float(pulses.plateau) * STRAIN
    axes.set_ylim(limits[0] * top, limits[1] * top)
    first, last = pulses.traces[0].trace.time[[0, -1]]
    axes.set_xlim(max(first, pulses.starts[0] - before * pulses.duration) / _second(), min(last, until) / _second())


def draw_record(axes: Any, solution: HopkinsonSolution) -> None:
    """Draw both traces about the pulses, and the windows of these."""
    pulses = solution.pulses
    for quietened, (colour, dash), name in zip(pulses.traces, LOOKS, ("incident bar", "transmitted bar"), strict=False):
        time, strain = thin(quietened.trace.time, quietened.trace.strain)
        axes.plot(time / _second(), strain * STRAIN, dash, color=colour, linewidth=1.0, label=name)
    first, second = WINDOW_LEVELS
    _windows(axes, pulses, (first, first, second), ("incident", "reflected", "transmitted"))
    quiet(axes, "Record and windows", headed("time of the record", "s", "us"), "strain (µε), compression +")
    _record_limits(axes, pulses, RECORD_LIMITS, 0.5, max(pulses.starts) + 1.5 * pulses.duration)
    put_legend(axes)


def draw_waves(axes: Any, solution: HopkinsonSolution) -> None:
    """Draw the three waves at the specimen, the reflected one turned over so that it lies on the two others."""
    w = solution.reduction.waves
    time = w.time / _second()
    waves = (("incident", w.incident), ("−reflected", -w.reflected), ("transmitted", w.transmitted))
    _curves(axes, [(name, time, strain * STRAIN) for name, strain in waves])
    axes.axvline(w.loaded / _second(), color=GREY, linewidth=0.8, linestyle=":")
    quiet(axes, "At the specimen", headed(SINCE, "s", "us"), "strain (µε), compression +")
    put_legend(axes)


def draw_forces(axes: Any, solution: HopkinsonSolution) -> None:
    """Draw the forces on both faces."""
    r, (newton, _) = solution.reduction, axis_unit("N", "kN")
    forces = (("F1, incident bar", r.first_force), ("F2, transmitted bar", r.second_force))
    _curves(axes, [(name, r.time / _second(), force / newton) for name, force in forces])
    axes.axvline(r.waves.loaded / _second(), color=GREY, linewidth=0.8, linestyle=":")
    quiet(axes, "Force balance", headed(SINCE, "s", "us"), headed("force", "N", "kN"))
    put_legend(axes)


def draw_difference(axes: Any, solution: HopkinsonSolution) -> None:
    """Draw the difference of the forces while the incident wave lasts."""
    r, on, limit = solution.reduction, solution.reduction.loading, 100.0 * UNIFORM
    axes.plot(r.time[on] / _second(), 100.0 * solution.equilibrium.ratio[on], color=BLUE, linewidth=1.2)
    axes.axhline(limit, color=GREY, linewidth=0.9, linestyle="--")
    axes.text(1.0, limit, f" {percent(UNIFORM, 0)}", transform=axes.get_yaxis_transform(), fontsize=8, va="center")
    quiet(axes, "Difference of the forces over their mean", headed(SINCE, "s", "us"), "2 |F1−F2| / |F1+F2| (%)")
    axes.set_ylim(0.0, 100.0)


def draw_curves(axes: Any, solution: HopkinsonSolution) -> None:
    """Draw true stress over true strain by the three analyses while the incident wave lasts."""
    on, (pascal, _) = solution.reduction.loading, axis_unit("Pa", "MPa")
    true = {name: solution.reduction.curve(name).true() for name in ANALYSES}
    _curves(axes, [(name, 100.0 * curve.strain[on], curve.stress[on] / pascal) for name, curve in true.items()])
    quiet(axes, "True curve", "true strain (%)", headed("true stress", "Pa", "MPa"))
    put_legend(axes)


def draw_rate(axes: Any, solution: HopkinsonSolution) -> None:
    """Draw the true strain rate over true strain by 1-wave and 3-wave analysis; that of 2-wave is that of 1-wave."""
    on, (rate, _) = solution.reduction.loading, axis_unit("1/s", "1/s")
    first, _, third = ANALYSES
    true = {name: solution.reduction.curve(name).true() for name in (first, third)}
    curves = [(name, 100.0 * curve.strain[on], curve.rate[on] / rate) for name, curve in true.items()]
    _curves(axes, curves, (LOOKS[0], LOOKS[2]))
    quiet(axes, "True strain rate", "true strain (%)", headed("rate", "1/s", "1/s"))
    put_legend(axes)


def draw_passes(axes: Any, solution: EchoSolution) -> None:
    """Draw the trace of a bar with its passes."""
    echoes = solution.echoes
    time, strain = thin(echoes.quiet.trace.time, echoes.quiet.trace.strain)
    axes.plot(time / _second(), strain * STRAIN, color=BLUE, linewidth=0.9)
    top = 1.25 * float(np.abs(strain).max()) * STRAIN
    for k, passed in enumerate(echoes.times):
        axes.axvline(passed / _second(), color=GREY, linewidth=0.8, linestyle=":")
        axes.text(passed / _second(), top, f" {k + echoes.first + 1}", fontsize=8, va="top", color=GREY)
    quiet(axes, "Passes of the pulse", headed("time of the record", "s", "us"), "strain (µε), first pulse +")
    axes.set_ylim(-top, top)


def _points(axes: Any, solution: EchoSolution, values: Any, errors: Any, label: str) -> None:
    """Draw values over frequency with their errors; none where there is no freedom."""
    frequency = solution.echoes.frequency / axis_unit("Hz", "kHz")[0]
    axes.errorbar(frequency, values, np.nan_to_num(errors), fmt="o", color=BLUE, markersize=4, capsize=2, label=label)


def draw_speed(axes: Any, solution: EchoSolution) -> None:
    """Draw the phase speed over frequency with its scatter, the theory, and the stated speed."""
    echoes, (speed, _) = solution.echoes, axis_unit("m/s", "m/s")
    _points(axes, solution, echoes.phase_speed / speed, echoes.phase_speed_error / speed, "echoes ± error")
    frequency = echoes.frequency / axis_unit("Hz", "kHz")[0]
    axes.plot(frequency, echoes.theory_speed / speed, "-", color=RED, linewidth=1.4, label="theory")
    axes.axhline(solution.bar.speed / speed, color=GREY, linewidth=1.0, linestyle="--", label="stated")
    quiet(axes, "Phase speed", headed("frequency", "Hz", "kHz"), headed("speed", "m/s", "m/s"))
    put_legend(axes)


def draw_losses(axes: Any, solution: EchoSolution) -> None:
    """Draw the attenuation over frequency with its scatter."""
    echoes = solution.echoes
    _points(axes, solution, echoes.losses, echoes.losses_error, "round trips")
    axes.axhline(echoes.attenuation.value, color=RED, linewidth=1.2, label="mean by energy")
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    quiet(axes, "Attenuation", headed("frequency", "Hz", "kHz"), "attenuation (1/m)")
    put_legend(axes)


def draw_accelerations(axes: Any, solution: SensorSolution) -> None:
    """Draw the reference acceleration of the sensor, and its reading without the delay."""
    comparison, (size, _) = solution.comparison, axis_unit("m/s^2", "g")
    label = "reading / sensitivity" if solution.unit == "V" else "reading"
    histories = {"reference by the gauge": comparison.motion.acceleration, label: solution.shown_acceleration}
    curves = []
    for name, values in histories.items():
        time, shown = thin(comparison.time, values)
        curves.append((name, time / _second(), shown / size))
    _curves(axes, curves)
    title = f"Acceleration at {with_unit(comparison.bandwidth.value, 'Hz', 'kHz', 3)}"
    title += "" if solution.quoted else ": not to be quoted"
    quiet(axes, title, headed(AT_END, "s", "us"), headed("acceleration", "m/s^2", "g"))
    put_legend(axes)


def draw_sensor_difference(axes: Any, solution: SensorSolution) -> None:
    """Draw the difference of reading and reference over the peak of the reference."""
    comparison = solution.comparison
    time, shown = thin(comparison.time, solution.shown_acceleration - comparison.motion.acceleration)
    axes.plot(time / _second(), 100.0 * shown / comparison.peaks[0], color=BLUE, linewidth=1.1)
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    quiet(axes, "Reading less reference", headed(AT_END, "s", "us"), "share of the peak (%)")


def draw_velocities(axes: Any, solution: SensorSolution) -> None:
    """Draw the velocity of the sensor by the gauge, by both waves at the end, and by its integrated reading."""
    comparison, (size, _) = solution.comparison, axis_unit("m/s", "m/s")
    histories = (comparison.motion.velocity, solution.shown_velocity, comparison.both_waves)
    names, widths = ("reference", "reading", "both waves"), (3.0, 1.7, 1.0)  # thinner on thicker: they coincide
    for name, values, look, width in zip(names, histories, LOOKS, widths, strict=True):
        time, shown = thin(comparison.time, values)
        _curves(axes, [(name, time / _second(), shown / size)], [look], width)
    quiet(axes, "Velocity", headed(AT_END, "s", "us"), headed("velocity", "m/s", "m/s"))
    put_legend(axes)


def draw_end_record(axes: Any, solution: SensorSolution) -> None:
    """Draw the strain at the gauge, and the windows of the incident and of the reflected pulse."""
    pulses = solution.comparison.pulses
    time, strain = thin(pulses.traces[0].trace.time, pulses.traces[0].trace.strain)
    axes.plot(time / _second(), strain * STRAIN, color=BLUE, linewidth=1.0)
    _windows(axes, pulses, END_LEVELS, ("incident", "reflected"))
    quiet(axes, "Strain at the gauge", headed("time of the record", "s", "us"), "strain (µε), compression +")
    _record_limits(axes, pulses, END_LIMITS, 0.2, pulses.starts[1] + 1.2 * pulses.duration)


class Diagram(NamedTuple):
    """A diagram of a result: what draws it on axes, its caption in the report, and its size there."""

    draw: Callable[[Any, Any], None]
    caption: str
    size: tuple[float, float] = HALF


class Sheet(NamedTuple):
    """The diagrams of a kind of result by their names, and their places and size on one sheet."""

    diagrams: dict[str, Diagram]
    mosaic: Any  # names, row by row
    size: tuple[float, float]


SHEETS: dict[type, Sheet] = {
    HopkinsonSolution: Sheet(
        {
            "record": Diagram(draw_record, "The strain records, and the windows of the pulses.", WHOLE),
            "waves": Diagram(
                draw_waves, "The waves at the specimen. The dotted line is the end of the incident wave.", WHOLE
            ),
            "forces": Diagram(draw_forces, "Forces on both faces of the specimen."),
            "difference": Diagram(draw_difference, "Their difference."),
            "curves": Diagram(draw_curves, "True stress over true strain."),
            "rate": Diagram(draw_rate, "True strain rate over true strain."),
        },
        [["record", "waves"], ["forces", "difference"], ["curves", "rate"]],
        (11.0, 9.6),
    ),
    EchoSolution: Sheet(
        {
            "passes": Diagram(draw_passes, "The passes of the pulse at the gauge.", WHOLE),
            "speed": Diagram(draw_speed, "Phase speed by the echoes."),
            "losses": Diagram(draw_losses, "Attenuation by the echoes."),
        },
        [["passes", "passes"], ["speed", "losses"]],
        (11.0, 6.8),
    ),
    SensorSolution: Sheet(
        {
            "acceleration": Diagram(draw_accelerations, "Reference and reading of the sensor.", WHOLE),
            "difference": Diagram(draw_sensor_difference, "Their difference."),
            "velocity": Diagram(
                draw_velocities,
                "Velocity: the reference, the reading integrated, and the end of the bar by both waves.",
            ),
            "strain": Diagram(draw_end_record, "The strain at the gauge, and the windows of the pulses.", WHOLE),
        },
        [["acceleration"] * 2, ["difference", "velocity"], ["strain"] * 2],
        (11.0, 9.6),
    ),
}
"""Diagrams of each kind of result."""


def sheet(solution: HopkinsonSolution | SensorSolution | EchoSolution) -> Figure:
    """Draw all diagrams of a result on one sheet."""
    diagrams, mosaic, size = SHEETS[type(solution)]
    figure = new_figure(size)
    sheet_title(figure, solution.title)
    for name, axes in figure.subplot_mosaic(mosaic).items():
        diagrams[name].draw(axes, solution)
    return figure


def pictures(solution: HopkinsonSolution | SensorSolution | EchoSolution) -> list[Picture]:
    """Return the diagrams of a result as pictures of its report."""

    def drawn(diagram: Diagram) -> Figure:
        return one_diagram(lambda axes: diagram.draw(axes, solution), diagram.size)

    return [Picture(drawn(diagram), diagram.caption) for diagram in SHEETS[type(solution)].diagrams.values()]
