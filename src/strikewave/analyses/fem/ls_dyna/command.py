"""``strikewave ls-dyna``: what a run of LS-DYNA gave, alone or beside a run of ours."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal

import typer

from strikewave.base.errors import InputError
from strikewave.reporting.options.output import Output


def command(
    folder: Annotated[
        Path,
        typer.Argument(metavar="FOLDER", help="A folder with rcforc, glstat, binout or d3plot.", show_default=False),
    ],
    *,
    units: Annotated[
        Literal["SI", "mm-t-s", "mm-ms-kg", "mm-g-us"],
        typer.Option("--units", help="System of units of its deck: the files of LS-DYNA do not state it."),
    ],
    compare: Annotated[
        Path | None,
        typer.Option(
            "--compare",
            metavar="DIR",
            help="A result of strikewave fem to compare with; none by default.",
            show_default=False,
        ),
    ] = None,
    beside: Annotated[Path | None, typer.Option("--beside", hidden=True)] = None,
    contact: Annotated[
        list[str] | None,
        typer.Option(
            "--contact",
            metavar="NAME=NUMBER",
            help="Contact of strikewave and its number in LS-DYNA; by name by default; may be repeated.",
            show_default=False,
        ),
    ] = None,
    part: Annotated[
        list[str] | None,
        typer.Option(
            "--part",
            metavar="NAME=NUMBER",
            help="Part of strikewave and its number in LS-DYNA; by name by default; may be repeated.",
            show_default=False,
        ),
    ] = None,
    output: Output,
) -> int:
    """Read the results of an LS-DYNA run.

    They are contact forces, energies and fields; with --compare, beside those of a run of strikewave fem. With --json,
    no files are written unless --out is given.
    """
    from strikewave.analyses.fem.ls_dyna.screen import LsDynaCommand, read_run
    from strikewave.exchange.units import unit_system

    if beside is not None:
        raise InputError("--beside", str(beside), "--compare, its new name", "write --compare DIR")
    contacts, parts = _numbers("--contact", contact), _numbers("--part", part)
    for option, given in (("--contact", contact), ("--part", part)):
        if compare is None and given:
            raise InputError(option, given[0], "only with a result of strikewave fem", "add --compare DIR")
    system = unit_system(units, "--units")
    return read_run(LsDynaCommand(folder, system, compare, contacts, parts, output.stated_test()), output)


def _numbers(option: str, given: Sequence[str] | None) -> dict[str, int]:
    """Return numbers by name from NAME=NUMBER."""
    numbers: dict[str, int] = {}
    for text in given or ():
        name, _, number = text.rpartition("=")
        if not name or not number.strip().isdecimal() or name in numbers:
            raise InputError(option, text, "NAME=NUMBER, each name once", f"such as {option} ball=1")
        numbers[name] = int(number)
    return numbers
