"""``strikewave deck``: an explicit finite-element model as input of LS-DYNA or OpenRadioss."""

from __future__ import annotations

from typing import Annotated, Literal

import typer

from strikewave.reporting.options.output import Output
from strikewave.reporting.options.shared import CaseName, Changes


def command(
    case: CaseName,
    *,
    code: Annotated[
        Literal["ls-dyna", "openradioss"], typer.Option("--code", help="Program that shall run the model.")
    ] = "ls-dyna",
    units: Annotated[
        Literal["SI", "mm-t-s", "mm-ms-kg", "mm-g-us"], typer.Option("--units", help="System of units of the deck.")
    ] = "mm-t-s",
    changes: Changes = None,
    output: Output,
) -> int:
    """Write a model for LS-DYNA or OpenRadioss.

    The files are CASE.k, or CASE_0000.rad and CASE_0001.rad. With --json, no files are written unless --out is given.
    """
    from strikewave.analyses.fem.decks import write_deck
    from strikewave.cases.case import load_case
    from strikewave.exchange.units import unit_system

    return write_deck(load_case(case, changes or ()), changes or [], code, unit_system(units, "--units"), output)
