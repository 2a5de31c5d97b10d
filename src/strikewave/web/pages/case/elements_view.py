"""What the page of elements shows of a run, as plain values; it runs in processes of the app."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from strikewave.analyses.fem.build import build_model
from strikewave.analyses.fem.figures.animation import fem_page, movie_of
from strikewave.analyses.fem.result import FemSolution
from strikewave.analyses.fem.run import run_fem, run_model
from strikewave.base.shock_quantities import FORCE
from strikewave.fem.measures import mean_force, middles
from strikewave.fem.run import ENERGIES
from strikewave.fem.solve import Progress, RunOptions
from strikewave.reporting.numbers import axis_unit, energy_unit, time_unit
from strikewave.reporting.shown_result import shown_table
from strikewave.web.case.loading import loaded
from strikewave.web.case.state import CaseSource
from strikewave.web.case.view import by_full_run, result_file, told
from strikewave.web.charts import ChartLine, colour, dash, line_chart
from strikewave.web.curves import points
from strikewave.web.jobs import Say
from strikewave.web.pages.case.body_field import body_field

RUN_SHARE = 0.8
"""Share of the time that the run takes; the rest draws what is shown in motion."""


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
        "by": by_full_run(solution),
        "figures": list(solution.highlights()),
        "charts": history_charts(solution),
        "tables": [("Parts", heads, rows, (0,))],
        "body": body_field(solution),
        "page": "" if movie is None else fem_page(movie, solution.title, case.name),
        **told(solution),
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
