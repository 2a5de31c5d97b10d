"""``strikewave run`` of a machine case: its options."""

from __future__ import annotations

from typing import Annotated

import typer

from strikewave.reporting.terminal import CaseName, Changes, Force, Json, Out


def command(
    case: CaseName,
    changes: Changes = None,
    animate: Annotated[
        bool, typer.Option("--animate", help="Write machine.html and machine.gif too: the machine in motion.")
    ] = False,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Run a machine case: table of blows, published beside computed, files in out/CASE.

    With --json, files are written only where --out says.
    """
    from strikewave.analyses.machine.screen import run_machine_case
    from strikewave.cases.case import load_case
    from strikewave.reporting.run_and_write import Output

    return run_machine_case(load_case(case, changes or ()), changes or (), Output(out, force, json), animate)
