"""``strikewave spec``: shock specifications, one with every number, one's own, a motion that meets one."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from strikewave.base.errors import MISSING, InputError
from strikewave.reporting.measured_files import complete_specification
from strikewave.reporting.options import quantity
from strikewave.reporting.output_options import Output

Action = Annotated[
    Literal["list", "show", "new", "synthesize"],
    typer.Argument(
        metavar="list|show|new|synthesize",
        help="What to do: list all, show one, begin a file of your own, or make a motion that meets a spectrum.",
    ),
]
Name = Annotated[
    str | None,
    typer.Argument(
        metavar="NAME|FILE",
        help="Specification to show or meet, such as jesd22-b110:B; or the file to begin.",
        show_default=False,
        autocompletion=complete_specification,
    ),
]


def command(
    action: Action = "list",
    name: Name = None,
    *,
    origin: Annotated[
        str | None,
        typer.Option(
            "--from",
            metavar="NAME[:CONDITION]",
            help="Specification that the file begins from, all its conditions or one; mil-std-810h by default.",
            show_default=False,
            autocompletion=complete_specification,
            rich_help_panel="Of new",
        ),
    ] = None,
    by: Annotated[
        Literal["damped-sines", "wavelets", "half-sine"] | None,
        typer.Option(
            "--by",
            help="What the motion is the sum of, or one half-sine; damped-sines by default.",
            show_default=False,
            rich_help_panel="Of synthesize",
        ),
    ] = None,
    rate: Annotated[
        float | None,
        quantity(
            "--rate",
            si="Hz",
            help="Sampling rate of the motion; 20 samples a period of the highest frequency by default.",
            panel="Of synthesize",
        ),
    ] = None,
    output: Output,
) -> int:
    """List, show, begin or meet a specification.

    Each of its numbers is normative (read in the standard), quoted (second-hand, by whom) or indicative (from memory).
    record --spec and srs --spec judge by them. synthesize makes a base motion whose shock response spectrum meets one:
    its history as acceleration.csv, with the verdict, and the acceleration, velocity and displacement that it takes.
    """
    from strikewave.analyses.record.specification import screen

    for option, value, of in (("--from", origin, "new"), ("--by", by, "synthesize"), ("--rate", rate, "synthesize")):
        if value is not None and action != of:
            raise InputError(option, value, f"only with {of}", "leave it out")
    if action == "list":
        if name is not None:
            raise InputError("NAME", name, "no name with list", f"strikewave spec show {name}")
        return screen.list_specifications(output)
    if name is None:
        raise InputError("NAME", MISSING, "the file to write" if action == "new" else "a specification")
    if action == "show":
        return screen.show_specification(name, output)
    if action == "synthesize":
        from strikewave.analyses.record.specification.screen import synthesize_specification

        return synthesize_specification(name, by or "damped-sines", rate, output)
    return screen.new_specification(Path(name), origin or "mil-std-810h", output)
