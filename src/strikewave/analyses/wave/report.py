"""The report of a layered bar alone as one HTML page, and its tables for the screen."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import TYPE_CHECKING

from strikewave.analyses.wave.field import field_of_solution
from strikewave.analyses.wave.figures.animation import wave_page, write_wave_gif
from strikewave.analyses.wave.figures.summary import wave_summary
from strikewave.analyses.wave.result import WaveSolution
from strikewave.base.shock_quantities import STEP
from strikewave.reporting import chapters
from strikewave.reporting.bands import band_sections
from strikewave.reporting.curves import Trace, traces
from strikewave.reporting.faces import amount, face_rows, face_table, numbers_of, part_tables
from strikewave.reporting.numbers import listed, spelled
from strikewave.reporting.parts import Flow, Part, Picture, Section, Table
from strikewave.reporting.run_and_write import drawing
from strikewave.reporting.stack_chapters import (
    MOST_LAYERS,
    field_pictures,
    fit_table,
    layer_table,
    route_section,
    sensor_part,
)
from strikewave.reporting.style import save
from strikewave.reporting.terminal import progress_bar
from strikewave.reporting.wave_curves import staircase_diagram
from strikewave.reporting.wave_field import WaveField, sandwiched, xt_diagram

if TYPE_CHECKING:
    from strikewave.cases.case import Case

_SINCE_LOAD = "time after the start of the load"
_DATA_FLOW = ("case file", "checks of units and fits", "stack", "stress waves", "taps and sensors")
MOST_CURVES = 4
"""Taps that a picture draws: as many as there are dashes, so that no two curves look alike in print."""


def wave_words(solution: WaveSolution) -> str:
    """Return the peak values at the taps as a sentence."""
    at_taps = []
    for row in face_rows(solution, "tap_histories"):
        words = listed([f"{text} {spelled(unit)}" for text, unit in numbers_of(row.value.peaks, row.bands)])
        at_taps.append(f"{row.name} (in {row.value.layer}): {words}")
    return f"A layered bar under its load, route {solution.route}. Signed peak values: {'; '.join(at_taps)}."


def error_words(solution: WaveSolution) -> str:
    """Say how exact the waves of a bar are."""
    velocity, acceleration = solution.accuracy
    bounds = "no bound" if math.isinf(velocity) else f"velocity {velocity:.1e}, acceleration {acceleration:.1e}"
    step = amount(STEP, solution.waves.step)
    if solution.method == "spectral":
        dispersion = solution.case.solver.dispersion
        return (
            f"spectral solver, dispersion: {dispersion}; error over the largest value at the taps, estimated from half "
            f"the step: {bounds}; time step {step}"
        )
    return (
        f"error bound over the largest value at the taps: {bounds}; time step {step}, largest mismatch of a transit "
        f"{solution.waves.mismatch:.1e}"
    )


def _staircase(field: WaveField, layer: int, solution: WaveSolution) -> Picture:
    """Show how force grows at both faces of a layer between two others."""
    name, run = field.stack.layers[layer].name, solution.run
    caption = (
        f"Force at both faces of {name} over the largest load. Dashed: the closed form for bonded joints and endless "
        "neighbours under this load, until the first echo from beyond them arrives (vertical line); dotted: its steps "
        "for a load that jumps."
    )
    return Picture(staircase_diagram(field, layer, run.time, run.face_force), caption)


def wave_tables(solution: WaveSolution) -> list[Table]:
    """Return the further tables of a bar: contact, masses on springs, joints, layers."""
    tables = [
        face_table(solution, "oscillators", caption="Masses on springs"),
        face_table(solution, "joints", caption="Joints that can open"),
        face_table(solution, "layers", "stress", "Largest stress in each layer"),
    ]
    tables = [dataclasses.replace(table, rows=table.rows[:MOST_LAYERS]) for table in tables if table.rows]
    return [*part_tables(solution, "contact"), *tables]


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
    return [*sections, _peak_section(solution)]


def _peak_section(solution: WaveSolution) -> Section:
    """List the peak values at the taps, of contact, masses, joints and layers."""
    taps = face_table(solution, "tap_histories", caption="Peak values at the taps")
    return Section("Peak values", "", [taps, *wave_tables(solution)])


def _accuracy_section(solution: WaveSolution) -> Section:
    """Say how exact the waves are."""
    accuracy = error_words(solution)
    accuracy = accuracy[0].upper() + accuracy[1:]
    tables: list[Part] = [] if solution.method == "spectral" else [layer_table(solution.waves)]
    if solution.losses:
        tables.append(fit_table(solution.losses))
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
"""What a result draws of itself in Python, see `strikewave.reporting.shown_result`."""


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
