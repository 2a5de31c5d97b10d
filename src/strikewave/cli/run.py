"""``strikewave run``: any case or set-up, by the analysis that its tables are for."""

from __future__ import annotations

from typing import Annotated

import typer

from strikewave.reporting.options import CaseName, Changes, WithBand
from strikewave.reporting.output_options import RunOutput


def command(
    case: CaseName,
    *,
    changes: Changes = None,
    animate: Annotated[
        bool, typer.Option("--animate", help="Also write an animation: of the machine, the waves or the elements.")
    ] = False,
    band: WithBand = True,
    output: RunOutput,
) -> int:
    """Run a case or a set-up file.

    The tables of the file choose the analysis: [machine] a shock machine and its blows, [[stack.layer]] with [load] a
    layered bar, [fem] explicit finite elements, [bar.incident] a split Hopkinson bar. The commands wave, fem and
    hopkinson have options of their own. With --json, no files are written unless --out is given. The exit code is 3
    where a check failed, such as a balance or the number of blows.
    """
    from strikewave.analyses.by_tables import run_any

    return run_any(case, changes or (), output, animate, band)
