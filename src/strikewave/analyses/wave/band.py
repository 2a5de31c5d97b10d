"""The bands of a layered bar: the same bar with its inputs moved within what is known of them."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.wave.build import build_load
from strikewave.analyses.wave.result import WaveSolution
from strikewave.analyses.wave.run import bar_figures
from strikewave.base.quantities import Value
from strikewave.base.result import INFO, BandMethod, Notice
from strikewave.cases.case import Case
from strikewave.cases.sensors_of_case import build_channels
from strikewave.cases.stack_of_case import build_stack
from strikewave.reporting.bands import lacking_notices
from strikewave.uncertainty.allowed import allowed_inputs
from strikewave.uncertainty.bands import LEVEL, SEED, Sample, find_bands, latin_hypercube
from strikewave.uncertainty.draws import drawn, drawn_case
from strikewave.uncertainty.known import known_inputs
from strikewave.uncertainty.runs import on_threads, why_failed

Array = NDArray[np.float64]

RUNS, FEWEST_RUNS = 64, 24
"""Runs of a bar: 5 to 15 ms each; of a long one as many as `WORK` allows, and below the fewest there is no band."""
ERROR = 0.01
"""Error that a velocity may have, over its largest. Measured on li-ma-2019-fig13-bar: it changes no result of a run by
more than 2.4e-3, and the ends of no band by more than 5e-4; a bound of 1e-3 takes eight times as long."""
WORK = 2e9
"""Samples times layers of all runs together: some ten seconds of the solver."""
BAR_STREAM = 21
"""Key of the draws."""


def with_bands(
    solution: WaveSolution, progress: Callable[[float], None] | None = None, threads: int | None = None
) -> WaveSolution:
    """Return a solution with the band of each of its results; where the bar takes too long, with a notice alone.

    Parameters
    ----------
    solution : WaveSolution
        What a bar did.
    progress : callable, optional
        Called with the share done, 0 to 1.
    threads : int, optional
        As many as processors, where it is left out; their number changes no bit.
    """
    case = solution.case
    runs = min(RUNS, int(WORK / (solution.run.time.size * len(solution.run.stack.layers))))
    if runs < FEWEST_RUNS:
        message = f"no band: {FEWEST_RUNS} runs of so long a bar would take minutes; shorten solver.duration, or raise "
        message += "solver.step"
        notice = Notice("no-band", message, float(runs), float(FEWEST_RUNS), severity=INFO)
        return dataclasses.replace(solution, notices=(*solution.notices, notice))
    inputs, quick = allowed_inputs(case, known_inputs(case, _tables(case)), _built), coarse(case)
    points = latin_hypercube(sum(one.count for one in inputs), runs, stream=BAR_STREAM)

    def run(row: Array) -> dict[str, float]:
        return bar_figures(drawn_case(quick, inputs, row.tolist()))

    numbers = list(drawn(inputs, points))
    found = on_threads(run, numbers, threads, progress)
    nothing: dict[str, float] = {}
    rows = [nothing if one is None else one for one in found]
    results = {name: np.array([row.get(name, math.nan) for row in rows]) for name in solution.figures}
    failed, why = sum(one is None for one in found), why_failed(run, numbers, found)
    method = BandMethod("full runs", LEVEL, SEED, runs, failed=failed, why=why)
    bands, method = find_bands(Sample(inputs, points), results, method)
    notices = (*solution.notices, *lacking_notices(solution.figures, bands, method))
    return dataclasses.replace(solution, band=bands, band_method=method, notices=notices)


def _built(case: Case) -> None:
    """Build what a run of a bar takes, to see whether its parts go together."""
    build_load(case, build_stack(case))
    build_channels(case)


def coarse(case: Case) -> Case:
    """Return a case that may be off by `ERROR`, unless it states a time step, or a larger error."""
    stated = case.solver.error
    if case.solver.step is not None or (stated is not None and stated.si >= ERROR):
        return case
    solver = case.solver.model_copy(update={"error": Value(si=ERROR, typed=ERROR)})
    return case.model_copy(update={"solver": solver})


def _tables(case: Case) -> tuple[str, ...]:
    """Return the tables that a bar alone depends on: the striker only where it makes the load."""
    struck = case.load is not None and case.load.shape == "contact"
    return ("stack", "load", "sensor", *(("striker", "contact") if struck else ()))
