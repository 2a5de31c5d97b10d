"""``strikewave reproduce``: every equation, figure and published number of a paper that can be computed."""

from __future__ import annotations

import os
from typing import Annotated, Literal

import typer

from strikewave.reporting.options import Running, one_of
from strikewave.reporting.output_options import StudyOutput

LEFT_OUT = ("elements", "studies")
"""Parts that can be left out."""


def command(
    paper: Annotated[
        Literal["li-ma-2019"], typer.Argument(metavar="PAPER", help="Key of the paper: li-ma-2019.", show_default=False)
    ],
    *,
    quick: Annotated[
        bool, typer.Option("--quick", help="Use coarser meshes in the finite-element models, and run no studies.")
    ] = False,
    without: Annotated[
        list[str] | None,
        one_of(
            "--without",
            choices=LEFT_OUT,
            help="Leave out the finite-element models, or studies (their meshes, assumed dimensions and second blow; "
            "most of the maps over gaskets and joints); nothing by default; may be repeated.",
        ),
    ] = None,
    threads: Annotated[
        int,
        typer.Option(
            "--threads", metavar="COUNT", min=1, help="Threads of the finite-element models; they change no number."
        ),
    ] = 1,
    running: Running,
    output: StudyOutput,
) -> int:
    """Reproduce a published paper.

    Computes its equations, figures and published numbers, and compares them with what is printed. One that is
    stopped is continued by the same command. With --json, no files are written unless --out is given. The exit code is
    3 where a run failed a check.
    """
    from strikewave.papers.li_ma_2019.reproduce import ReproduceCommand
    from strikewave.papers.li_ma_2019.result import PAPER, marked_text
    from strikewave.papers.li_ma_2019.runs import Effort
    from strikewave.reporting.run_and_write import run_and_write
    from strikewave.studies.engine.runner import Workers

    gone = {word: word in (without or ()) for word in LEFT_OUT}
    effort = Effort(quick, not gone["elements"], min(threads, os.cpu_count() or 1), not gone["studies"])
    pool = Workers(running.workers or 1, cluster=running.cluster).pool()  # threads are those of the elements
    command = ReproduceCommand(effort, pool, place=running.store, fresh=running.fresh)
    return run_and_write(command, output, f"{PAPER}-reproduced", marked_text(effort))
