"""The page of layered bars: its view of a run as plain values, made in processes of the app."""

from __future__ import annotations

from typing import Any

import numpy as np

from strikewave.analyses.wave.report import field_of_solution
from strikewave.analyses.wave.result import WaveSolution
from strikewave.analyses.wave.run import run_wave
from strikewave.base.shock_quantities import ACCELERATION, STRESS, VELOCITY
from strikewave.reporting.faces import text_of
from strikewave.reporting.numbers import axis_unit, time_unit
from strikewave.reporting.shown_result import shown_table
from strikewave.web.case_state import BarSections, CaseSource
from strikewave.web.case_values import full_run_label, loaded, notices_and_balance, result_file
from strikewave.web.charts import ChartLine, colour, heat_chart, line_chart, points
from strikewave.web.jobs import Say

FIELD_TIMES, FIELD_PLACES = 120, 48
"""Cells of the x-t diagram: each is 7 pixels wide on a desk, and a page of so many opens at once."""
SECTION_TIMES, SECTION_PLACES = 1000, 120
"""Instants and places of the field on a page: a megabyte."""
MOST_TAPS = 5
"""Taps in one diagram: as many as there are colours."""


def full(source: CaseSource, say: Say | None = None) -> dict[str, Any]:
    """Return a run of a layered bar."""
    solution = run_wave(loaded(source))
    heads, rows = shown_table(solution)
    heads = [head.replace("peaks.", "peak ") for head in heads]
    sensors = [
        [name, text_of(pulse, "peak"), text_of(pulse, "width"), "yes" if pulse.clipped else "no"]
        for name, pulse in solution.sensors.items()
    ]
    layers = [
        [text_of(layer, name) for name in ("name", "length_asked", "length_used", "steps")]
        for layer in solution.waves.layers
    ]
    return {
        "by": full_run_label(solution),
        "figures": list(solution.highlights()),
        "charts": [field_chart(solution), *tap_charts(solution)],
        "tables": [
            ("At the taps", heads, rows, ()),
            *([("Sensors", ["sensor", "peak", "width", "clipped"], sensors, (0,))] if sensors else []),
            ("Layers", ["layer", "length asked", "length used", "steps"], layers, (0,)),
        ],
        **notices_and_balance(solution),
        "sections": sections(solution),
        "texts": solution.tables(),
    }


def field_chart(solution: WaveSolution) -> dict[str, Any]:
    """Return the x-t diagram of stress: compression above zero, the first face at the bottom.

    Each cell ends with its place, mm.
    """
    field = field_of_solution(solution)
    areas = np.array([solution.run.stack.layers[layer].area for layer in field.layer])
    size, unit = axis_unit(*STRESS.units)
    second, time_name = time_unit(float(field.time[-1]))
    times, places = _even(field.time, FIELD_TIMES), _even(field.position, FIELD_PLACES)
    stress = field.force / areas / size
    cells = [
        [i, j, round(float(stress[row, place]), 3), round(1e3 * float(field.position[place]), 4)]
        for i, row in enumerate(times)
        for j, place in enumerate(places)
    ]
    return heat_chart(
        "Stress, compression above zero",
        f"time ({time_name})",
        "from the first face (mm)",
        [f"{field.time[row] / second:.3g}" for row in times],
        [f"{1e3 * field.position[place]:.3g}" for place in places],
        cells,
        unit,
        ends=[float(end) for values in (field.time / second, 1e3 * field.position) for end in (values[0], values[-1])],
    )


def sections(solution: WaveSolution) -> BarSections:
    """Return stress and velocity along the bar over time, at as many sections as a slider tells apart."""
    field = field_of_solution(solution)
    layers = solution.run.stack.layers
    areas = np.array([layers[layer].area for layer in field.layer])
    times, places = (
        sorted({round(k) for k in np.linspace(0, count - 1, min(count, most))})
        for count, most in ((len(field.time), SECTION_TIMES), (len(field.position), SECTION_PLACES))
    )
    (second, time_name), (pascal, stress_name) = time_unit(float(field.time[-1])), axis_unit(*STRESS.units)
    speed, speed_name = axis_unit(*VELOCITY.units)
    shown = np.ix_(times, places)
    velocity = np.zeros_like(field.force) if field.velocity is None else field.velocity
    labels = (f"time ({time_name})", f"stress ({stress_name})", f"velocity ({speed_name})")
    names = tuple(layers[field.layer[place]].name for place in places)
    return BarSections(
        (field.time[times] / second).astype(np.float32),
        1e3 * field.position[places],
        names,
        (field.force / areas / pascal)[shown].astype(np.float32),
        (velocity / speed)[shown].astype(np.float32),
        labels,
    )


def tap_charts(solution: WaveSolution) -> list[dict[str, Any]]:
    """Return stress and acceleration at the taps, with the readings of the sensors."""
    time = solution.run.time
    second, time_name = time_unit(float(time[-1]))
    (pascal, stress_name), (size, name) = axis_unit(*STRESS.units), axis_unit(*ACCELERATION.units)
    shown = list(enumerate(solution.taps))[:MOST_TAPS]
    stress = [ChartLine(tap, points(time / second, solution.stress(k) / pascal), colour(k)) for k, (tap, _) in shown]
    acceleration = [
        ChartLine(tap, points(time / second, solution.run.acceleration[:, k] / size), colour(k))
        for k, (tap, _) in shown
    ]
    for channel, reading in zip(solution.channels, solution.readings, strict=True):
        curve = points(reading.time / second, reading.values / size)
        acceleration.append(ChartLine(f"{channel.sensor.name} reads", curve, colour(len(acceleration)), "dashed"))
    x = f"time ({time_name})"
    return [
        line_chart("Stress at the taps", x, f"stress ({stress_name})", stress),
        line_chart("Acceleration at the taps", x, f"acceleration ({name})", acceleration),
    ]


def _even(values: Any, most: int) -> list[int]:
    """Return the places of rising values nearest to the middles of at most so many equal cells over them all."""
    count = min(len(values), most)
    # the steps of a solver are not even, the cells of a diagram are
    middles = values[0] + (np.arange(count) + 0.5) / count * (values[-1] - values[0])
    return [int(place) for place in np.searchsorted(0.5 * (values[1:] + values[:-1]), middles)]


def files(source: CaseSource, wanted: str, say: Say | None = None) -> bytes:
    """Return a file of a run."""
    return result_file(run_wave(loaded(source)), wanted)
