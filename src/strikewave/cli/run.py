"""``strikewave run``: any case or set-up, by the analysis that its tables are for."""

from __future__ import annotations

from typing import Annotated

import typer

from strikewave.reporting.options import CaseName, Changes, Output


def command(
    case: CaseName,
    *,
    changes: Changes = None,
    animate: Annotated[
        bool, typer.Option("--animate", help="Write the machine, the waves or the elements in motion too.")
    ] = False,
    output: Output,
) -> int:
    """Run a case or a set-up file.

    Its tables say which analysis it is for: [machine] a train of blows, [[stack.layer]] with [load] a layered bar under
    its load, [fem] explicit finite elements, [bar.incident] a split Hopkinson bar. The commands wave, fem and hopkinson
    have further options of their own. With --json, files are written only where --out says.
    """
    from strikewave.analyses.by_tables import run_any

    return run_any(case, changes or (), output, animate)
