"""``strikewave reproduce``: every equation, figure and published number of a paper that can be computed."""

from __future__ import annotations

import os
from typing import Annotated

import typer

from strikewave.reporting.terminal import Force, Json, Out

PAPERS = ("li-ma-2019",)
"""Papers that can be reproduced, by the key of their source."""
LEFT_OUT = ("elements", "studies")
"""What can be left out."""


def command(
    paper: Annotated[str, typer.Argument(metavar="PAPER", help="li-ma-2019.", show_default=False)],
    quick: Annotated[bool, typer.Option("--quick", help="Coarser meshes for the element models, no studies.")] = False,
    without: Annotated[
        list[str] | None,
        typer.Option(
            "--without",
            metavar="elements|studies",
            help="Leave out the element models, or their meshes, assumed dimensions and second blow.",
            show_default=False,
        ),
    ] = None,
    threads: Annotated[
        int, typer.Option("--threads", help="Threads of the element models; they change no number.")
    ] = 1,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Reproduce a paper: its equations, figures and published numbers beside what is computed.

    With --json, files are written only where --out says. The exit code is 3 where a run broke a stated limit.
    """
    from strikewave.base.errors import InputError, nearest
    from strikewave.papers.li_ma_2019.runs import Effort
    from strikewave.papers.li_ma_2019.screen import run_reproduction
    from strikewave.reporting.run_and_write import Output

    if paper not in PAPERS:
        raise InputError("PAPER", paper, "one of " + ", ".join(PAPERS), nearest(paper, PAPERS))
    for word in without or ():
        if word not in LEFT_OUT:
            raise InputError("--without", word, " or ".join(LEFT_OUT), nearest(word, LEFT_OUT))
    if threads < 1:
        raise InputError("--threads", threads, "at least 1")
    gone = {word: word in (without or ()) for word in LEFT_OUT}
    effort = Effort(quick, not gone["elements"], min(threads, os.cpu_count() or 1), not gone["studies"])
    return run_reproduction(effort, Output(out, force, json))
