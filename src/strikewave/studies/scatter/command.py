"""``strikewave scatter``: what the tolerances of a machine case do to its blows."""

from __future__ import annotations

import dataclasses
import os
from typing import Annotated

import typer

from strikewave.reporting.terminal import CaseName, Changes, Force, Json, Out


def command(
    case: CaseName,
    runs: Annotated[int, typer.Option("--runs", help="How many runs.")] = 500,
    seed: Annotated[int, typer.Option("--seed", help="Of what is drawn; the same gives the same bits.")] = 1,
    shares: Annotated[
        str, typer.Option("--shares", help="alone (one tolerance at a time), sobol (slower), or none.")
    ] = "alone",
    workers: Annotated[int, typer.Option("--workers", help="Processes, one a core at most.")] = 2,
    changes: Changes = None,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Run a machine case many times within its tolerances: scatter of the blows, and which tolerance it comes from.

    A tolerance stands beside a value: { value = "1 kg", tolerance = "2 %" }. With --json, files are written only where
    --out says.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # for arrays this small, threads wait longer than they work
    from strikewave.cases.case import load_case
    from strikewave.reporting.run_and_write import Output
    from strikewave.studies.scatter.screen import run_scatter
    from strikewave.studies.scatter.study import Plan

    plan = Plan(runs, seed, shares, workers)
    plan.check()
    plan = dataclasses.replace(plan, workers=min(workers, os.cpu_count() or 1))
    return run_scatter(load_case(case, changes or ()), changes or (), plan, Output(out, force, json))
