"""``strikewave deck``: a model of hexahedra as input of LS-DYNA or OpenRadioss."""

from __future__ import annotations

from typing import Annotated

import typer

from strikewave.reporting.terminal import CaseName, Changes, Force, Json, Out


def command(
    case: CaseName,
    code: Annotated[str, typer.Option("--code", help="ls-dyna or openradioss.")] = "ls-dyna",
    units: Annotated[str, typer.Option("--units", help="SI, mm-t-s, mm-ms-kg or mm-g-us.")] = "mm-t-s",
    changes: Changes = None,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Write a model of hexahedra for another code: CASE.k, or CASE_0000.rad and CASE_0001.rad.

    With --json, files are written only where --out says.
    """
    from strikewave.analyses.fem.decks import CODES, write_deck
    from strikewave.base.errors import InputError, nearest
    from strikewave.cases.case import load_case
    from strikewave.exchange.units import unit_system
    from strikewave.reporting.run_and_write import Output

    if code not in CODES:
        raise InputError("--code", code, ", ".join(CODES), nearest(code, CODES))
    read = load_case(case, changes or ())
    return write_deck(read, changes or [], code, unit_system(units, "--units"), Output(out, force, json))
