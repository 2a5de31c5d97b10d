"""``strikewave wave``: run a stack alone under its load."""

from __future__ import annotations

from typing import Annotated

import typer

from strikewave.reporting.terminal import CaseName, Changes, Force, Json, Out


def command(
    case: CaseName,
    changes: Changes = None,
    field: Annotated[
        str, typer.Option("--field", help="What the pictures along the stack show: stress, force or velocity.")
    ] = "stress",
    animate: Annotated[bool, typer.Option("--animate", help="Write animation.html and animation.gif too.")] = False,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Run a stack of layers under a load: force, stress, velocity and acceleration at its taps.

    With --json, files are written only where --out says.
    """
    from strikewave.analyses.wave.screen import run_wave_case
    from strikewave.base.errors import InputError, nearest
    from strikewave.cases.case import load_case
    from strikewave.reporting.run_and_write import Output
    from strikewave.reporting.wave_field import QUANTITIES

    if field not in QUANTITIES:
        raise InputError("--field", field, "one of " + ", ".join(QUANTITIES), nearest(field, QUANTITIES))
    read = load_case(case, changes or ())
    return run_wave_case(read, changes or (), Output(out, force, json), field, animate)
