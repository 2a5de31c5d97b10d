"""``strikewave wave``: run a stack alone under its load."""

from __future__ import annotations

from typing import Annotated, Literal

import typer

from strikewave.reporting.options import CaseName, Changes, WithBand
from strikewave.reporting.output_options import RunOutput


def command(
    case: CaseName,
    *,
    changes: Changes = None,
    field: Annotated[
        Literal["stress", "force", "velocity"],
        typer.Option("--field", help="Quantity that the pictures along the bar show."),
    ] = "stress",
    animate: Annotated[bool, typer.Option("--animate", help="Write animation.html and animation.gif too.")] = False,
    band: WithBand = True,
    output: RunOutput,
) -> int:
    """Run a layered bar under its load.

    Gives force, stress, velocity and acceleration at the taps. With --json, no files are written unless --out is given.
    """
    from strikewave.analyses.wave.screen import run_wave_case
    from strikewave.cases.case import load_case

    return run_wave_case(load_case(case, changes or ()), changes or (), output, field, animate, band)
