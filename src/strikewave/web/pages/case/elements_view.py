"""The page of elements: its view of a run as plain values, made in processes of the app."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.colors import to_hex

from strikewave.analyses.fem.build import build_model
from strikewave.analyses.fem.figures.animation import fem_page, movie_of, shown_snapshots
from strikewave.analyses.fem.figures.cut import QUANTITIES, colour_scale
from strikewave.analyses.fem.result import FemSolution
from strikewave.analyses.fem.run import run_fem, run_model
from strikewave.base.shock_quantities import FORCE
from strikewave.fem.run import ENERGIES, mean_force, middles
from strikewave.fem.solve import Progress, RunOptions
from strikewave.reporting.animation import even_rows
from strikewave.reporting.numbers import axis_unit, energy_unit, time_unit
from strikewave.reporting.shown_result import shown_table
from strikewave.web.case_state import CaseSource
from strikewave.web.case_values import full_run_label, loaded, notices_and_balance, result_file
from strikewave.web.charts import ChartLine, colour, dash, line_chart, points
from strikewave.web.jobs import Say

RUN_SHARE = 0.8
"""Share of the time that the run takes; the pictures take the rest."""


def full(source: CaseSource, say: Say | None = None) -> dict[str, Any]:
    """Return a run of elements, with the bodies in motion as a page of its own."""
    case = loaded(source)

    def report(done: Progress) -> None:
        if say is not None:
            say(RUN_SHARE * done.time / done.duration, "the run")

    solution = run_model(case, build_model(case), RunOptions(report=report))
    movie = movie_of(
        solution, progress=lambda share: say(RUN_SHARE + (1.0 - RUN_SHARE) * share, "the pictures") if say else None
    )
    heads, rows = shown_table(solution)
    return {
        "by": full_run_label(solution),
        "figures": list(solution.highlights()),
        "charts": history_charts(solution),
        "tables": [("Parts", heads, rows, (0,))],
        "body": body_field(solution),
        "page": "" if movie is None else fem_page(movie, solution.title, case.name),
        **notices_and_balance(solution),
        "texts": solution.tables(),
    }


def history_charts(solution: FemSolution) -> list[dict[str, Any]]:
    """Return contact forces and energies over time, in the units shown."""
    time = solution.run.time
    second, time_name = time_unit(float(time[-1]))
    forces = {name: np.linalg.norm(mean_force(solution.run, name), axis=1) for name in solution.run.force}
    energies = {name: np.asarray(solution.run.energy[name]) for name in ENERGIES}
    largest = max((float(np.abs(values).max()) for values in energies.values()), default=0.0)
    (newton, force_name), (joule, energy_name) = axis_unit(*FORCE.units), energy_unit(largest)
    x = f"time ({time_name})"
    return [
        line_chart("Forces of contacts and walls", x, f"force ({force_name})", _lines(time / second, forces, newton)),
        line_chart("Energies", x, f"energy ({energy_name})", _lines(time / second, energies, joule)),
    ]


def _lines(time: Any, histories: Mapping[str, Any], size: float) -> list[ChartLine]:
    """Return curves; means over the intervals of the histories stand at their middles."""
    return [
        ChartLine(
            name.replace("_", " "),
            points(time if values.size == time.size else middles(time), values / size),
            colour(k),
            dash(k),
        )
        for k, (name, values) in enumerate(histories.items())
    ]


def files(source: CaseSource, wanted: str, say: Say | None = None) -> bytes:
    """Return a file of a run."""
    return result_file(run_fem(loaded(source)), wanted)


LARGEST = 24 << 20
"""Most bytes of a field that is sent to a page: finer meshes have fewer instants."""
LEVELS = 255
"""Steps of the scale of colours: a byte a face."""
SHADES = 33
"""Colours that are sent; the page interpolates between them."""


def body_field(solution: FemSolution) -> bytes:
    """Return the moving surface as bytes: length of the head, head as JSON, then arrays; empty without stored states.

    The head has time, counts, and each field with its scale. The arrays are faces (faces, 4) as 32-bit places of
    points, then for each instant the points (points, 3), mm, in single precision; then for each field and instant a
    byte a face, from the least to the largest of its scale. All are little-endian.
    """
    film = solution.film
    stills = shown_snapshots(film) if film is not None else []
    if film is None or not stills:
        return b""
    skin = film.skin
    a_still = 12 * len(skin.points) + len(QUANTITIES) * len(skin.faces)
    stills = [stills[k] for k in even_rows(len(stills), max(2, (LARGEST - 16 * len(skin.faces)) // a_still))]
    second, time_name = time_unit(stills[-1].time)
    arrays: list[bytes] = [np.asarray(skin.faces, "<u4").tobytes()]
    arrays += [np.asarray(1e3 * skin.moved(still.displacement), "<f4").tobytes() for still in stills]
    fields = []
    for shown in QUANTITIES.values():
        values = [shown.of(skin, still)[skin.element] / shown.scale for still in stills]
        scale, _ = colour_scale(skin, values, shown)
        low, high = scale.get_clim()
        levels = [np.clip((cells - low) / (high - low) * LEVELS, 0.0, LEVELS).round() for cells in values]
        arrays += [np.asarray(level, np.uint8).tobytes() for level in levels]
        colours = [to_hex(scale.cmap(share)) for share in np.linspace(0.0, 1.0, SHADES)]
        fields.append({"name": shown.words, "unit": shown.unit, "low": low, "high": high, "colours": colours})
    head: dict[str, Any] = {
        "points": len(skin.points),
        "faces": len(skin.faces),
        "time": [round(still.time / second, 6) for still in stills],
        "time_unit": time_name,
        "axis": [float(x) for x in skin.axis],
        "towards": [float(x) for x in skin.cut.plane.normal],
        "fields": fields,
    }
    text = json.dumps(head, allow_nan=False).encode()
    text += b" " * (-len(text) % 4)  # arrays of words begin at a multiple of four
    return len(text).to_bytes(4, "little") + text + b"".join(arrays)
