"""The report of a layered bar: its page, its pictures, and its pulse on the way as an animation."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from strikewave.analyses.layered_bars import (
    DASHED,
    JOINT_STYLES,
    QUANTITIES,
    THICK,
    WaveField,
    distance_label,
    draw_along,
    field_pictures,
    fit_tables,
    layer_table,
    name_layers,
    route_section,
    sandwiched,
    sensor_part,
    shade_layers,
    shades,
    staircase_diagram,
    xt_diagram,
)
from strikewave.analyses.wave.result import WaveSolution, error_words, wave_tables, wave_words
from strikewave.base.shock_quantities import ACCELERATION, FORCE, LENGTH, MICROSECONDS, STRESS, VELOCITY
from strikewave.reporting import chapters
from strikewave.reporting.animation import (
    Animation,
    Chart,
    Clock,
    FieldCurve,
    LayerBand,
    Panel,
    PlaceAxis,
    PlaceMark,
    PlayedSpan,
    animation_page,
    even_rows,
    write_gif,
)
from strikewave.reporting.bands import band_sections
from strikewave.reporting.faces import face_table
from strikewave.reporting.numbers import axis_unit, headed
from strikewave.reporting.parts import Flow, Part, Picture, Section
from strikewave.reporting.run_and_write import drawing
from strikewave.reporting.style import (
    BLUE,
    COLOURS,
    DASHES,
    GREY,
    RED,
    Trace,
    new_figure,
    printable,
    put_legend,
    quiet,
    save,
    sheet_title,
    thin,
    traces,
)
from strikewave.reporting.terminal import progress_bar
from strikewave.waves import Impactor, Tap

if TYPE_CHECKING:
    from strikewave.cases.case import Case

_ROUND_TRIPS = 2.0
"""Round trips through the stack that are shown after the load has ended (chosen: the first shows the echoes, the second
that they repeat)."""


def field_of_solution(solution: WaveSolution) -> WaveField:
    """Return the field of a bar alone, until its load is over and two round trips later."""
    run = solution.run
    lasting = float(run.touches[:, 1].max(initial=0.0)) if isinstance(run.load, Impactor) else float(run.load.duration)
    whole = WaveField(
        run.stack,
        run.field_time,
        run.field_position,
        run.field_layer,
        run.field_force,
        run.field_velocity,
        solution.taps,
        "time after the start of the load",
    )
    return whole.up_to(lasting + _ROUND_TRIPS * 2.0 * run.stack.transit)


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
    run, since = solution.run, headed("time after the start of the load", *MICROSECONDS.units)
    unit, newtons, pascals = (axis_unit(*kind.units)[0] for kind in (MICROSECONDS, FORCE, STRESS))
    speed, size = (axis_unit(*kind.units)[0] for kind in (VELOCITY, ACCELERATION))
    time, force = thin(run.time, run.face_force)
    grid[0, 0].plot(time / unit, force / newtons, color=GREY, linewidth=1.3)
    quiet(grid[0, 0], "Force on the first face", since, headed("force", *FORCE.units))
    shown = (
        (grid[0, 1], lambda k: solution.stress(k) / pascals, "stress", STRESS),
        (grid[1, 0], lambda k: run.velocity[:, k] / speed, "velocity", VELOCITY),
        (grid[1, 1], lambda k: run.acceleration[:, k] / size, "acceleration", ACCELERATION),
    )
    for axes, values, name_of, kind in shown:
        for k, (name, _) in enumerate(solution.taps[: len(COLOURS)]):
            t, v = thin(run.time, np.asarray(values(k)))
            axes.plot(t / unit, v, DASHES[k % len(DASHES)], color=COLOURS[k], linewidth=1.2, label=name)
        quiet(axes, name_of.capitalize(), since, headed(name_of, *kind.units))
    if len(solution.taps) > 1:
        put_legend(grid[0, 1])
    if not solution.quoted:
        grid[1, 1].set_title("Acceleration (peaks not to be quoted)", loc="left", fontsize=10)
    return figure


_SINCE_LOAD = "time after the start of the load"
_DATA_FLOW = ("case file", "checks of units and fits", "stack", "stress waves", "taps and sensors")
MOST_CURVES = 4
"""Taps that a picture draws: as many as there are dashes, so that no two curves look alike in print."""


def _staircase(field: WaveField, layer: int, solution: WaveSolution) -> Picture:
    """Show the growth of the force at both faces of a layer between two others."""
    name, run = field.stack.layers[layer].name, solution.run
    caption = (
        f"Force at both faces of {name} over the largest load. Dashed: the closed form for bonded joints and endless "
        "neighbours under this load, until the first echo from beyond them arrives (vertical line); dotted: its steps "
        "for a load that jumps."
    )
    return Picture(staircase_diagram(field, layer, run.time, run.face_force), caption)


def wave_sections(solution: WaveSolution, quantity: str = "stress") -> list[Section]:
    """Show waves at the taps, the field of a quantity, staircase, sensors, routes, then peak values of a bar alone."""
    run, time = solution.run, solution.run.time
    names = [name for name, _ in solution.taps[:MOST_CURVES]]
    parts: list[Part] = []
    force = [Trace(name, time, run.force[:, k]) for k, name in enumerate(names)]
    speed = [Trace(name, time, run.velocity[:, k]) for k, name in enumerate(names)]
    total = [Trace(name, time, run.acceleration[:, k]) for k, name in enumerate(names)]
    parts += [
        Picture(
            traces("Force", [*force, Trace("first face", time, run.face_force)], "kN", _SINCE_LOAD),
            "Force at the taps, and on the first face (exact).",
        ),
        Picture(traces("Velocity", speed, "m/s", _SINCE_LOAD), "Velocity at the taps (exact)."),
        Picture(
            traces("Acceleration", [*total, Trace("rigid body", time, solution.rigid)], "g", _SINCE_LOAD),
            "Acceleration at the taps (exact), and of the bar as one rigid body."
            + ("" if solution.quoted else " Its peaks are not to be quoted: see the warnings."),
        ),
    ]
    field = field_of_solution(solution)
    parts += field_pictures(field, quantity)
    layer = sandwiched(field)
    if layer is not None:
        parts.append(_staircase(field, layer, solution))
    sections = [Section("Stress waves", "", parts)]
    if solution.channels:
        readings = [
            Trace(channel.sensor.name, reading.time, reading.values)
            for channel, reading in zip(solution.channels, solution.readings, strict=True)
        ]
        picture = traces("Sensor readings", readings, "g", _SINCE_LOAD)
        table = face_table(solution, "sensors", caption="Sensor readings")
        sections.append(sensor_part(solution.channels, picture, table))
    tap = next((k for k, (name, _) in enumerate(solution.taps) if (name, "corrected") in solution.routes), None)
    if tap is not None:
        name = solution.taps[tap][0]
        waves = [solution.routes[name, route].acceleration for route in ("as printed", "corrected")]
        sections.append(
            route_section(name, solution.quoted, time, run.acceleration[:, tap], solution.rigid, waves, _SINCE_LOAD)
        )
    peaks = face_table(solution, "tap_histories", caption="Peak values at the taps")
    return [*sections, Section("Peak values", "", [peaks, *wave_tables(solution)])]


def _accuracy_section(solution: WaveSolution) -> Section:
    """Return the section on the accuracy of the waves."""
    accuracy = error_words(solution)
    accuracy = accuracy[0].upper() + accuracy[1:]
    tables: list[Part] = [] if solution.method == "spectral" else [layer_table(solution.waves)]
    tables += fit_tables(solution.losses)
    return Section("Accuracy of the waves", f"{accuracy}.", tables)


def wave_report(solution: WaveSolution, quantity: str = "stress") -> str:
    """Return the report of a bar alone as one HTML page.

    ``quantity`` is what the pictures of the whole field show: stress, force or velocity.

    Examples
    --------
    >>> from strikewave import load_case, run_wave
    >>> "x-t" in wave_report(run_wave(load_case("li-ma-2019-fig13-bar")))
    False
    """
    case = solution.case
    parts = [
        *wave_sections(solution, quantity),
        *band_sections(solution),
        chapters.warnings(solution.notices),
        _setup(case),
        chapters.inputs(case),
        _accuracy_section(solution),
        Section(
            "Momentum balance",
            "Balance error: impulses at both ends less the momentum of the bar, over the greater impulse.",
            [chapters.balance_table(solution.balance_checks)],
        ),
    ]
    summary = chapters.Summary("Report of waves in a layered bar", wave_words(solution), solution.highlights())
    return chapters.result_page(solution, summary, parts)


def _setup(case: Case) -> Section:
    flows = [
        Flow(chapters.layer_steps(case), "The layers, from the loaded face to the far end"),
        Flow(_DATA_FLOW, "From the case to this report"),
    ]
    return Section("Set-up", "A layered bar, loaded at its first face; no machine.", flows)


picture, page = wave_summary, wave_report
"""Picture and page of a result in Python, see `strikewave.reporting.shown_result`."""


def draw_result(solution: WaveSolution, folder: Path, quantity: str = "stress", animate: bool = False) -> list[str]:
    """Write page and pictures of a stack into a folder, and return their names."""
    with drawing(folder / "summary.svg") as path:
        save(wave_summary(solution), path)
    with drawing(folder / "field.svg") as path:
        save(xt_diagram(field_of_solution(solution), quantity), path)
    with drawing(folder / "report.html") as path:
        path.write_text(wave_report(solution, quantity), "utf-8", newline="\n")
    moving = _animate(solution, folder) if animate else []
    return ["report.html", "summary.svg", "field.svg", *moving]


def _animate(solution: WaveSolution, folder: Path) -> list[str]:
    """Write the animation as a page and as a GIF, and return their names."""
    field = field_of_solution(solution)
    with drawing(folder / "animation.html") as path:
        page = wave_page(field, solution.title, solution.case.name)
        path.write_text(page, "utf-8", newline="\n")
    with drawing(folder / "animation.gif") as path, progress_bar("animation.gif", clocks=("left",)) as progress:
        write_wave_gif(field, solution.title, path, progress)
    return ["animation.html", "animation.gif"]


Array = NDArray[np.float64]

PANELS = ("stress", "velocity")
"""Quantities that the page shows, from above."""
MOST_FRAMES, GIF_FRAMES = 400, 100
"""Frames of a page at most, 40 a second at speed 1, as smooth as a film; frames of a GIF, ten seconds."""
MOST_VALUES = 200_000
"""Values of each panel that a page holds at most: 2.7 bytes each, as 16-bit integers in base 64."""
PANEL_HEIGHT = 190.0
"""Height of a panel of the page, pixels: two of them and the controls fill a screen of 768 lines."""
PLOT_MARGIN = 1.09
"""Axes reach so far beyond the peak: what is written at the top of a panel stays clear of the curve."""
LINE_COLOUR = "#1a1f24"
FILLS = (f"{BLUE}4d", f"{RED}4d")
"""Above and below zero: as in the figures, 30 % opaque."""
_DPI = 80
"""Resolution of a GIF, dots an inch (chosen: 640 x 432 pixels, which a slide shows)."""
GIF_MARGIN = 1.2
"""Axes of a GIF reach so far beyond the peak: the names of layers stand above the curve."""
ANIMATION_NOTE = (
    "Blue is compression or motion along the blow, red tension or motion against it; the darker a layer, the greater "
    "its impedance; ▲ marks a tap."
)


def wave_page(field: WaveField, title: str, name: str = "") -> str:
    """Return a page that shows stress and velocity along a stack while a pulse runs through it.

    ``field`` has velocities; title of the page and name of the case are plain text.

    Examples
    --------
    >>> from strikewave import load_case, run_wave
    >>> from strikewave.analyses.wave.report import field_of_solution
    >>> page = wave_page(field_of_solution(run_wave(load_case("li-ma-2019-fig13-bar"))), "a < b")
    >>> "<title>a &lt; b</title>" in page, len(page) < 1.5e6
    (True, True)
    """
    return animation_page(wave_animation(field), title, name)


def wave_animation(field: WaveField) -> Animation:
    """Return stress and velocity along a stack, frame by frame."""
    rows = even_rows(len(field.time), min(MOST_FRAMES, max(MOST_VALUES // len(field.position), 2)))
    time = np.array([_rounded(t) for t in field.time[rows]])
    panels = [_panel(field, quantity, rows) for quantity in PANELS]
    alternative = "Stress and velocity along the stack; the values at the chosen place and time are written below."
    chart = Chart("waves", alternative, "place", "distance from the loaded face", PANEL_HEIGHT, panels)
    return Animation(
        kicker="Waves in a stack",
        note=ANIMATION_NOTE,
        gif="animation.gif",
        clock=Clock.of(time),
        views=[PlayedSpan("whole", "whole run", time)],
        canvases=[chart],
        places=_places(field),
    )


def _places(field: WaveField) -> PlaceAxis:
    """Return the places of a field, the layers that have places, and the taps; the first tap is read first."""
    shown, band = np.unique(field.layer, return_inverse=True)
    layers, joints = field.stack.layers, field.stack.joints
    greys, ends = shades(field.stack), field.ends
    size, unit = axis_unit(*LENGTH.units)
    return PlaceAxis(
        unit=unit,
        per=size,
        position=[_rounded(x) for x in field.position],
        band=band.tolist(),
        bands=[
            LayerBand(
                layers[k].name,
                _rounded(ends[k] - layers[k].length),
                _rounded(ends[k]),
                round(255 * greys[k]),
                "" if k == 0 else _joint_line(joints[k - 1].kind),
            )
            for k in shown.tolist()
        ],
        marks=[PlaceMark(name, _rounded(field.place(tap))) for name, tap in field.taps],
        start=_place_of(field, field.taps[0][1]) if field.taps else 0,
    )


def _place_of(field: WaveField, tap: Tap) -> int:
    """Return the place of the field nearest to a tap, in the tap's own layer where that has places."""
    elsewhere = np.where(field.layer == tap.layer, 0.0, field.ends[-1])
    return int(np.argmin(np.abs(field.position - field.place(tap)) + elsewhere))


def _joint_line(kind: str) -> Literal["", "dashed", "thick"]:
    """Return how the joint before a layer is drawn: dashed, thick, or as a thin line."""
    style = JOINT_STYLES.get(kind)
    return "dashed" if style == DASHED else "thick" if style == THICK else ""


def _panel(field: WaveField, quantity: str, rows: NDArray[np.int64]) -> Panel:
    """Return one quantity over place, its axis symmetric about zero."""
    shown = QUANTITIES[quantity]
    values = field.values(quantity)[rows] / shown.scale
    most = PLOT_MARGIN * (float(np.abs(values).max(initial=0.0)) or 1.0)
    return Panel(
        shown.name, shown.unit, [FieldCurve(LINE_COLOUR, *FILLS, values)], label=shown.label, limits=(-most, most)
    )


def _rounded(value: float) -> float:
    """Return a value with the seven digits of a 32-bit number, which keeps the page short."""
    return float(f"{value:.7g}")


def write_wave_gif(field: WaveField, title: str, path: Path, progress: Callable[[float], None] | None = None) -> None:
    """Write the waves of a field with velocities as a GIF under a title in plain text."""
    rows = even_rows(len(field.time), GIF_FRAMES)
    figure, show = _moving_figure(field, title, rows)
    write_gif(path, figure, show, rows.tolist(), progress)


def _moving_figure(field: WaveField, title: str, rows: NDArray[np.int64]) -> tuple[Figure, Callable[[int], None]]:
    """Return a figure of both panels, and the function that brings it to a row of the field."""
    figure = Figure(figsize=(8.0, 5.4), dpi=_DPI, layout="constrained")
    figure.suptitle(textwrap.fill(printable(title), 90), x=0.01, ha="left", fontsize=10, parse_math=False)
    clock = figure.text(0.99, 0.01, "", ha="right", va="bottom", fontsize=10, family="monospace")
    panels = list(zip(figure.subplots(2, 1, sharex=True), map(QUANTITIES.__getitem__, PANELS), strict=True))
    values = [field.values(shown.name) / shown.scale for _, shown in panels]
    for (axes, shown), rows_of_values in zip(panels, values, strict=True):
        shade_layers(axes, field)
        peak = float(np.abs(rows_of_values).max(initial=0.0)) or 1.0
        axes.set_xlim(0.0, field.ends[-1] / axis_unit(*LENGTH.units)[0])
        axes.set_ylim(-GIF_MARGIN * peak, GIF_MARGIN * peak)
        axes.set_title(shown.label, loc="left", fontsize=9)
        axes.spines[["top", "right"]].set_visible(False)
    name_layers(panels[0][0], field)
    panels[1][0].set_xlabel(distance_label())
    drawn: list[Any] = []
    unit = Clock.of(field.time[rows])

    def show(row: int) -> None:
        while drawn:
            drawn.pop().remove()
        for (axes, _), rows_of_values in zip(panels, values, strict=True):
            drawn.extend(draw_along(axes, field, rows_of_values[row]))
        clock.set_text(f"{field.time[row] / unit.per:.{unit.decimals}f} {unit.unit}")

    return figure, show
