"""``strikewave laws``: every contact law with equation, range, status, source and what restitution it gives."""

from __future__ import annotations

from typing import Annotated

import typer

from strikewave.reporting.terminal import Force, Json, Out

Name = Annotated[
    str | None, typer.Argument(metavar="[NAME]", help="A law, of whatever kind; all by default.", show_default=False)
]


def command(name: Name = None, out: Out = None, force: Force = False, json: Json = False) -> int:
    """List the contact laws: damping, dampers, stiffness, pressure caps, with status, source and what they give."""
    from strikewave.analyses.impact.law_list import list_laws
    from strikewave.reporting.run_and_write import Output

    return list_laws(name, Output(out, force, json))
