"""``strikewave fem``: run an explicit finite-element model."""

from __future__ import annotations

from typing import Annotated

import typer

from strikewave.reporting.options.output import RunOutput
from strikewave.reporting.options.shared import CaseName, Changes, ElementDevice


def command(
    case: CaseName,
    *,
    threads: Annotated[
        int,
        typer.Option("--threads", metavar="COUNT", min=1, help="Threads, one a core at most; they change no number."),
    ] = 1,
    device: ElementDevice = None,
    frames: Annotated[
        int | None,
        typer.Option(
            "--frames",
            metavar="COUNT",
            help="Instants in field.vtkhdf; fem.frames of the case by default.",
            show_default=False,
        ),
    ] = None,
    blows: Annotated[
        int | None,
        typer.Option(
            "--blows",
            metavar="COUNT",
            help="Blows one after another; fem.blows of the case by default.",
            show_default=False,
        ),
    ] = None,
    check: Annotated[bool, typer.Option("--check", help="Build the model and estimate the work; run nothing.")] = False,
    restart: Annotated[bool, typer.Option("--restart", help="Continue an interrupted run.")] = False,
    no_report: Annotated[bool, typer.Option("--no-report", help="Write no report.html.")] = False,
    animate: Annotated[bool, typer.Option("--animate", help="Write animation.html and animation.gif too.")] = False,
    changes: Changes = None,
    output: RunOutput,
) -> int:
    """Run an explicit finite-element model.

    Gives contact forces, rigid-body accelerations, section forces, fields, energy and momentum balances. With --json,
    no files are written unless --out is given. The exit code is 3 where energy is off by more than 1 %, or hourglass
    modes hold more than 5 % of the internal energy.
    """
    from strikewave.analyses.fem.screen import FemOptions, check_element_case, run_element_case
    from strikewave.cases.case import load_case

    read = load_case(case, changes or ())
    for path, count in (("fem.frames", frames), ("fem.blows", blows)):
        if count is not None and (read.fem is None or count != read.values()[path].si):
            changes = [*(changes or ()), f"{path}={count}"]
            read = load_case(case, changes)
    if check:
        return check_element_case(read, output.json, threads)
    choice = FemOptions(threads, not no_report, restart, animate, device)
    return run_element_case(read, changes or (), output, choice)
