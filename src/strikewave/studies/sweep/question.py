"""A sweep asked for in plain values: settings with their values as texts, as the command line, a file and Python do."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import Any

from strikewave.base.errors import MISSING, InputError, nearest
from strikewave.base.quantities import Value
from strikewave.cases.case import Case
from strikewave.studies.axes import Axis
from strikewave.studies.engine.case_evaluation import checked_analysis, read_kept
from strikewave.studies.engine.evaluation import Row, Variation
from strikewave.studies.engine.plan import (
    DESIGNS,
    GRID,
    MOST_RUNS,
    TOLERANCES,
    DrawVariation,
    drawn_rows,
    filled,
    grid,
    varied,
)
from strikewave.studies.engine.runner import pool_of, share_reporter
from strikewave.studies.engine.store import store_in
from strikewave.studies.engine.variables import EXAMPLE, StudyVariable, read_variable
from strikewave.studies.sweep.study import NOTE, SweepPlan, SweepStudy, make_sweep
from strikewave.uncertainty.draws import UncertainInput, tolerances_of

RUNS = 128
"""Runs of a design that is no grid, where none are asked for: a power of two, as Sobol's sequence needs."""
MOST_SEED = 2**63 - 1
"""Largest seed: that of a 64-bit integer, which every reader of the JSON document holds."""
Vary = Mapping[str, Any] | Sequence[str]
"""What is varied: texts ``setting=values``, or values by settings."""


def sweep(
    case: Case,
    vary: Vary = (),
    *,
    keep: Sequence[str] = (),
    analysis: str = "",
    design: str = GRID,
    runs: int | None = None,
    seed: int = 1,
    workers: int = 1,
    executor: Executor | None = None,
    cluster: str | None = None,
    device: str | None = None,
    store: Path | str | None = None,
    progress: Callable[[float], None] | None = None,
) -> SweepStudy:
    """Run a case over some of its settings, and keep some numbers of each run.

    Equal arguments give equal numbers, bit for bit, whatever the number of processes.

    Parameters
    ----------
    case : Case
        What is varied.
    vary : sequence of str, or mapping
        ``machine.speed=400..900 rpm:11``, ``object.damper=10, 20 N s/m``, ``contact.damping=LAW, LAW``; or the values
        by the settings. None for the design "tolerances".
    keep : sequence of str, optional
        Numbers by name, such as ``first.rigid_peak`` or ``cv``; ``blows`` and ``pulses`` for histories. The first blow
        where nothing is named.
    analysis : str, optional
        ``run``, ``fast``, ``wave``, ``fem`` or ``impact``; that of the case where it is left out.
    design : str, optional
        ``grid``, ``latin-hypercube``, ``sobol`` or ``tolerances``.
    runs, seed : int, optional
        Of a design that is no grid.
    workers : int, optional
        Processes. With more than one, call it below ``if __name__ == "__main__":``.
    executor : Executor, optional
        Who runs instead: any executor of `concurrent.futures`, or one that acts as these do.
    cluster : str, optional
        Address of a Dask scheduler that shares the runs among machines, such as ``tcp://host:8786``.
    device : str, optional
        ``cuda`` or ``cuda-mixed``: the steps of elements are taken on the GPU, which the processes share.
    store : path, optional
        Folder that keeps finished runs: what it holds is not run again.
    progress : callable, optional
        Called with the share done, 0 to 1.

    Returns
    -------
    SweepStudy
        A row for each run: its settings and the numbers kept, in SI.

    Raises
    ------
    InputError
        If the case has no such setting or number, or the store cannot be used.

    Examples
    --------
    >>> import strikewave
    >>> case = strikewave.load_case("li-ma-2019", ["feed.blows=1"])
    >>> study = strikewave.sweep(case, ["machine.speed=600..800 rpm:3"], keep=["first.rigid_peak"], analysis="fast")
    >>> study.number("first.rigid_peak").shape, study.failed
    ((3,), 0)
    """
    plan = plan_of(case, vary, keep, analysis, design, runs, seed).on(device, cluster)
    with store_in(store) as finished:
        return make_sweep(plan, finished, pool_of(executor, workers, cluster), share_reporter(progress))


def plan_of(
    case: Case,
    vary: Vary,
    keep: Sequence[str] = (),
    analysis: str = "",
    design: str = GRID,
    runs: int | None = None,
    seed: int = 1,
) -> SweepPlan:
    """Return the plan of a sweep; the arguments are those of `sweep`.

    Raises
    ------
    InputError
        If the case has no such setting or number, or they do not go with the design.
    """
    if design not in DESIGNS:
        raise InputError("--design", design, "one of " + ", ".join(DESIGNS), nearest(design, DESIGNS))
    evaluation = read_kept(case, checked_analysis(case, analysis), keep)
    variables = tuple(read_variable(case, text) for text in vary_texts(vary))
    variation, rows = _cases(case, variables, design, runs, seed)
    if design == TOLERANCES:
        variables = _drawn_variables(variation.inputs)  # type: ignore[attr-defined]  # a DrawVariation
    return SweepPlan(case, variables, design, seed, variation, evaluation, tuple(rows))


def _cases(
    case: Case, variables: tuple[StudyVariable, ...], design: str, runs: int | None, seed: int
) -> tuple[Variation, Iterable[Row]]:
    """Return what makes the cases, and the rows."""
    count = RUNS if runs is None else runs
    if not 1 <= count <= MOST_RUNS:
        raise InputError("--runs", count, f"a whole number from 1 to {MOST_RUNS}")
    if not 0 <= seed <= MOST_SEED:
        raise InputError("--seed", seed, f"a whole number from 0 to {MOST_SEED}")
    if design == TOLERANCES:
        if variables:
            raise InputError(
                "--vary", variables[0].path, "nothing beside --design tolerances: the case says what moves"
            )
        inputs = tolerances_of(case)
        return DrawVariation(case, inputs), drawn_rows(inputs, count, seed)
    if not variables:
        raise InputError("--vary", MISSING, "a setting with its values", EXAMPLE)
    variation = varied(case, variables, NOTE)
    if design == GRID:
        if runs is not None:
            raise InputError("--runs", runs, "none with a grid", "--design latin-hypercube or sobol takes a number")
        return variation, grid(variables)
    return variation, filled(variables, design, count, seed)


def _drawn_variables(inputs: Sequence[UncertainInput]) -> tuple[StudyVariable, ...]:
    """Return what is drawn as variables, from one end of its range to the other."""
    variables = []
    for one in inputs:
        unit = one.allowed.unit if one.allowed.unit != "count" else ""
        for name in one.names:
            variables.append(StudyVariable(Axis(name, unit, unit, (one.low, one.high)), is_range=True))
    return tuple(variables)


def vary_texts(vary: Vary) -> list[str]:
    """Return what is varied as texts.

    Examples
    --------
    >>> vary_texts({"machine.speed": [40.0, 50.0]})
    ['machine.speed=40.0, 50.0']
    """
    return [f"{path}={_typed(values)}" for path, values in vary.items()] if isinstance(vary, Mapping) else list(vary)


def _typed(values: Any) -> str:
    """Return values of Python as they are typed: a list with commas, SI without a unit.

    Examples
    --------
    >>> _typed([1, 2.5]), _typed("400..900 rpm:3"), _typed(["a", "b"])
    ('1, 2.5', '400..900 rpm:3', 'a, b')
    """
    if isinstance(values, str | int | float | Value):
        return str(values)
    return ", ".join(str(value) for value in values)
