"""``strikewave run`` of a machine case: its options."""

from __future__ import annotations

from typing import Annotated

import typer

from strikewave.reporting.options import CaseName, Changes, Output


def command(
    case: CaseName,
    *,
    changes: Changes = None,
    animate: Annotated[
        bool, typer.Option("--animate", help="Write the machine in motion too: machine.html and machine.gif.")
    ] = False,
    output: Output,
) -> int:
    """Run a case or a set-up file.

    A machine case gives the table of blows, the comparison with published values, and files in out/CASE. With --json,
    files are written only where --out says.
    """
    from strikewave.analyses.machine.screen import run_machine_case
    from strikewave.cases.case import load_case

    return run_machine_case(load_case(case, changes or ()), changes or (), output, animate)
