"""``strikewave laws``: every contact law with equation, range, status, source and what restitution it gives."""

from __future__ import annotations

from typing import Annotated

import typer

from strikewave.reporting.options.output import Output

Name = Annotated[
    str | None, typer.Argument(metavar="NAME", help="Name of a law of any kind; all by default.", show_default=False)
]


def command(name: Name = None, *, output: Output) -> int:
    """List the contact laws.

    Damping, dampers, stiffness and pressure caps, with equation, range, status, source, and the coefficient of
    restitution that they give.
    """
    from strikewave.analyses.impact.law_list import list_laws

    return list_laws(name, output)
