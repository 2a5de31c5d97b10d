"""``strikewave spec``: the shock specifications, one with every number and its status, or the begin of one's own."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from strikewave.analyses.record.verdicts.options import complete_specification
from strikewave.base.errors import MISSING, InputError
from strikewave.reporting.options import Output

Action = Annotated[
    Literal["list", "show", "new"],
    typer.Argument(metavar="list|show|new", help="What to do: list all, show one, or begin a file of your own."),
]
Name = Annotated[
    str | None,
    typer.Argument(
        metavar="NAME|FILE",
        help="Specification to show, such as jesd22-b110:B; or the file to begin.",
        show_default=False,
        autocompletion=complete_specification,
    ),
]


def command(
    action: Action = "list",
    name: Name = None,
    *,
    origin: Annotated[
        str,
        typer.Option(
            "--from",
            metavar="NAME",
            help="Specification that a new file begins from.",
            autocompletion=complete_specification,
        ),
    ] = "mil-std-810h",
    output: Output,
) -> int:
    """List, show or begin a specification.

    Each of its numbers is normative (read in the standard), quoted (second-hand, by whom) or indicative (from memory).
    record --spec and srs --spec judge by them.
    """
    from strikewave.analyses.record.verdicts import specified

    if action == "list":
        if name is not None:
            raise InputError("NAME", name, "no name with list", f"strikewave spec show {name}")
        return specified.list_specifications(output)
    if name is None:
        raise InputError("NAME", MISSING, "a specification" if action == "show" else "the file to write")
    if action == "show":
        return specified.show_specification(name, output)
    return specified.new_specification(Path(name), origin, output)
