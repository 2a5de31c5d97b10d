"""``strikewave scatter``: what the tolerances of a machine case do to its blows."""

from __future__ import annotations

from typing import Annotated, Literal

import typer

from strikewave.reporting.options import CaseName, Changes, RunningInProcesses
from strikewave.reporting.output_options import StudyOutput


def command(
    case: CaseName,
    *,
    runs: Annotated[int, typer.Option("--runs", metavar="COUNT", help="Number of runs.")] = 500,
    seed: Annotated[
        int, typer.Option("--seed", metavar="NUMBER", help="Random seed; equal seeds reproduce the run bit for bit.")
    ] = 1,
    shares: Annotated[
        Literal["alone", "sobol", "none"],
        typer.Option(
            "--shares", help="Share of each tolerance in the scatter: one at a time, Sobol indices (slower), or none."
        ),
    ] = "alone",
    running: RunningInProcesses,
    changes: Changes = None,
    output: StudyOutput,
) -> int:
    """Propagate tolerances to the blows.

    Runs a machine case many times within its tolerances, and gives the scatter of the blows and the share of each
    tolerance in it. A tolerance stands beside a value: { value = "1 kg", tolerance = "2 %" }. A study that is stopped
    is continued by the same command. With --json, no files are written unless --out is given.
    """
    from strikewave.cases.case import load_case
    from strikewave.studies.engine.runner import Workers
    from strikewave.studies.scatter.report import ScatterCommand
    from strikewave.studies.scatter.study import ScatterPlan

    plan = ScatterPlan(runs, seed, shares)
    plan.check()
    loaded = output.tested(load_case(case, changes or ()))
    pool = Workers(running.workers, cluster=running.cluster).pool()
    return ScatterCommand(loaded, plan, pool, place=running.store, fresh=running.fresh).run(changes or (), output)
