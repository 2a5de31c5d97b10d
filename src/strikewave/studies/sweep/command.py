"""``strikewave sweep``: any case over any of its settings."""

from __future__ import annotations

import os
from typing import Annotated, Literal

import typer

from strikewave.reporting.options import Changes, RunningElements, case_name
from strikewave.reporting.output_options import StudyOutput


def command(
    case: Annotated[str, case_name("CASE", "A case file, a built-in case, or a study file with the table [vary].")],
    *,
    vary: Annotated[
        list[str] | None,
        typer.Option(
            "--vary",
            metavar="SETTING=VALUES",
            help=(
                "Setting with a range, such as machine.speed='400..900 rpm:11' (log behind it for logarithmic "
                "spacing), a list, or words; may be repeated; those of the study file by default."
            ),
            show_default=False,
        ),
    ] = None,
    keep: Annotated[
        list[str] | None,
        typer.Option(
            "--keep",
            metavar="NAME,...",
            help=(
                "Numbers to keep of each run, such as first.rigid_peak,cv, and histories: blows, pulses; the peak and "
                "width of the first blow, and cv, by default."
            ),
            show_default=False,
        ),
    ] = None,
    analysis: Annotated[
        Literal["run", "fast", "wave", "fem", "impact"] | None,
        typer.Option("--analysis", help="What each run is; that of the case by default.", show_default=False),
    ] = None,
    design: Annotated[
        Literal["grid", "latin-hypercube", "sobol", "tolerances"] | None,
        typer.Option("--design", help="How runs are chosen; grid by default.", show_default=False),
    ] = None,
    runs: Annotated[
        int | None,
        typer.Option(
            "--runs",
            metavar="COUNT",
            help="Number of runs of a design that is no grid; 128 by default.",
            show_default=False,
        ),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(
            "--seed",
            metavar="NUMBER",
            help="Random seed of a design that is no grid; 1 by default.",
            show_default=False,
        ),
    ] = None,
    running: RunningElements,
    changes: Changes = None,
    output: StudyOutput,
) -> int:
    """Run a case over any of its settings.

    One setting gives a line plot, two a map, more parallel coordinates and main effects; runs.csv and runs.parquet hold
    a row a run. A sweep that is stopped is continued by the same command. A run that fails is a row with its reason.
    The same can stand in a study file: case, set, vary, keep, analysis, design, runs, seed. With --json, no files are
    written unless --out is given.
    """
    from strikewave.studies.engine.runner import Workers
    from strikewave.studies.sweep.report import SweepCommand, show_estimate
    from strikewave.studies.sweep.study import SweepRequest, read_request

    typed = SweepRequest(tuple(vary or ()), tuple(keep or ()), analysis or "", design or "", runs, seed)
    request = read_request(case, changes or (), typed)
    count = min(running.workers, os.cpu_count() or 1)
    workers = Workers(count, cluster=running.cluster, device=running.device)
    plan = request.plan(output.tested(request.loaded)).on(workers)
    pool = (Workers() if running.dry_run else workers).pool()
    making = SweepCommand(plan.case, plan, pool, place=running.store, fresh=running.fresh)
    if running.dry_run:
        return show_estimate(making, request.changes, count, output)
    return making.run(request.changes, output)
