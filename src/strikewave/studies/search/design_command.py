"""``strikewave design``: settings of a case for goals on its numbers."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from strikewave.reporting.options import Changes, RunningElements
from strikewave.reporting.output_options import StudyOutput


def command(
    file: Annotated[
        Path, typer.Argument(metavar="FILE.toml", help="A design file: case, goals, and the table [vary].")
    ],
    *,
    runs: Annotated[
        int | None,
        typer.Option(
            "--runs", metavar="COUNT",
            help="Most runs of a search; that of the file, or 600 (40 by surrogate), by default.",
            show_default=False,
        ),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(
            "--seed", metavar="NUMBER", help="Random seed of the search; that of the file, or 1, by default.",
            show_default=False,
        ),
    ] = None,
    robust: Annotated[
        int | None,
        typer.Option(
            "--robust", metavar="COUNT",
            help="Draws within tolerances for each ranked setting; those of the file, or none, by default.",
            show_default=False,
        ),
    ] = None,
    running: RunningElements,
    changes: Changes = None,
    output: StudyOutput,
) -> int:  # fmt: skip
    """Find settings of a case for wanted results.

    The file states goals in words of the results, such as "first.rigid_peak = 4000 g +- 5 %" or "cv < 3 %", and what
    may be chosen. Settings that meet them are ranked by their margins and verified; where none does, it is said which
    goals exclude each other and by how much, and the exit code is 3. A design that is stopped is continued by the same
    command. With --json, no files are written unless --out is given.
    """
    from strikewave.studies.engine.runner import Workers
    from strikewave.studies.search.design_report import DesignCommand, show_estimate
    from strikewave.studies.search.plan import load_design

    request = load_design(file, changes or (), runs=runs, seed=seed, robust=robust)
    count = min(running.workers, os.cpu_count() or 1)
    workers = Workers(count, cluster=running.cluster, device=running.device)
    plan = request.plan(output.tested(request.case)).on(workers)
    if running.dry_run:
        return show_estimate(plan, count, output)
    searching = DesignCommand(plan.case, plan, workers.pool(), place=running.store, fresh=running.fresh)
    return searching.run(request.changes, output)
