"""``strikewave fem``: run a model of hexahedra."""

from __future__ import annotations

from typing import Annotated

import typer

from strikewave.reporting.terminal import CaseName, Changes, Force, Json, Out


def command(
    case: CaseName,
    threads: Annotated[int, typer.Option("--threads", help="Threads, one a core at most; they change no number.")] = 1,
    frames: Annotated[
        int | None,
        typer.Option("--frames", help="Pictures in field.vtkhdf, instead of fem.frames.", show_default=False),
    ] = None,
    blows: Annotated[
        int | None,
        typer.Option("--blows", help="Blows one after another, instead of fem.blows.", show_default=False),
    ] = None,
    check: Annotated[
        bool, typer.Option("--check", help="Build the model, say what it would take; run nothing.")
    ] = False,
    restart: Annotated[bool, typer.Option("--restart", help="Go on where an interrupted run stopped.")] = False,
    no_report: Annotated[bool, typer.Option("--no-report", help="Write no report.html.")] = False,
    animate: Annotated[bool, typer.Option("--animate", help="Write animation.html and animation.gif too.")] = False,
    changes: Changes = None,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Run a model of hexahedra: contact forces, rigid-body accelerations, sections, fields, and their ledgers.

    With --json, files are written only where --out says. The exit code is 3 where energy is off by more than 1 %, or
    hourglass modes hold more than 5 % of the internal energy.
    """
    from strikewave.analyses.fem.screen import Choice, check_element_case, run_element_case
    from strikewave.base.errors import InputError
    from strikewave.cases.case import load_case
    from strikewave.reporting.run_and_write import Output

    if threads < 1:
        raise InputError("--threads", threads, "at least 1")
    read = load_case(case, changes or ())
    for path, count in (("fem.frames", frames), ("fem.blows", blows)):
        if count is not None and (read.fem is None or count != read.values()[path].si):
            changes = [*(changes or ()), f"{path}={count}"]
            read = load_case(case, changes)
    if check:
        return check_element_case(read, json, threads)
    choice = Choice(threads, not no_report, restart, animate)
    return run_element_case(read, changes or (), Output(out, force, json), choice)
