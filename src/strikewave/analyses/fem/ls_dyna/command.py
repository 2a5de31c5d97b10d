"""``strikewave ls-dyna``: what a run of LS-DYNA gave, alone or beside a run of ours."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from strikewave.reporting.terminal import Force, Json, Out


def command(
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="With rcforc, glstat, binout or d3plot.", show_default=False)
    ],
    units: Annotated[
        str | None,
        typer.Option(
            "--units",
            help="Units of its deck: SI, mm-t-s, mm-ms-kg or mm-g-us; its files have none.",
            show_default=False,
        ),
    ] = None,
    beside: Annotated[
        Path | None,
        typer.Option("--beside", metavar="DIR", help="A result of strikewave fem to lay beside.", show_default=False),
    ] = None,
    contact: Annotated[
        list[str] | None,
        typer.Option(
            "--contact", metavar="NAME=NUMBER", help="Our contact and LS-DYNA's; may be repeated.", show_default=False
        ),
    ] = None,
    part: Annotated[
        list[str] | None,
        typer.Option(
            "--part", metavar="NAME=NUMBER", help="Our part and LS-DYNA's; may be repeated.", show_default=False
        ),
    ] = None,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Read what a run of LS-DYNA gave: contact forces, energies, fields; with --beside, next to a run of ours.

    With --json, files are written only where --out says.
    """
    from strikewave.analyses.fem.ls_dyna.screen import LsDynaCommand, read_run
    from strikewave.base.errors import MISSING, InputError
    from strikewave.exchange.units import SYSTEMS, unit_system
    from strikewave.reporting.measured_files import asked
    from strikewave.reporting.run_and_write import Output

    if units is None:
        hint = "the files of LS-DYNA have no units: say those of the deck"
        raise InputError("--units", MISSING, "one of " + ", ".join(SYSTEMS), hint)
    contacts, parts = _numbers("--contact", contact), _numbers("--part", part)
    for option, given in (("--contact", contact), ("--part", part)):
        if beside is None and given:
            raise InputError(option, given[0], "only with a result of ours to lay beside", "add --beside DIR")
    system = unit_system(units, "--units")
    return read_run(LsDynaCommand(folder, system, beside, contacts, parts, asked()), Output(out, force, json))


def _numbers(option: str, given: Sequence[str] | None) -> dict[str, int]:
    """Return numbers by name from NAME=NUMBER."""
    from strikewave.base.errors import InputError

    found: dict[str, int] = {}
    for text in given or ():
        name, _, number = text.rpartition("=")
        if not name or not number.strip().isdecimal() or name in found:
            raise InputError(option, text, "NAME=NUMBER, each name once", f"such as {option} ball=1")
        found[name] = int(number)
    return found
