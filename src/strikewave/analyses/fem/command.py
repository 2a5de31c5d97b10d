"""``strikewave fem``, ``deck`` and ``ls-dyna``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal

import typer

from strikewave.base.errors import InputError
from strikewave.reporting.options import CaseName, Changes, FemOptions
from strikewave.reporting.output_options import Output, RunOutput


def fem(
    case: CaseName,
    *,
    options: FemOptions,
    frames: Annotated[
        int | None,
        typer.Option(
            "--frames",
            metavar="COUNT",
            help="Instants in field.vtkhdf; fem.frames of the case by default.",
            show_default=False,
        ),
    ] = None,
    blows: Annotated[
        int | None,
        typer.Option(
            "--blows",
            metavar="COUNT",
            help="Blows one after another; fem.blows of the case by default.",
            show_default=False,
        ),
    ] = None,
    check: Annotated[bool, typer.Option("--check", help="Build the model and estimate the work; run nothing.")] = False,
    changes: Changes = None,
    output: RunOutput,
) -> int:
    """Run an explicit finite-element model.

    Gives contact forces, rigid-body accelerations, section forces, fields, energy and momentum balances. With --json,
    no files are written unless --out is given. The exit code is 3 where energy is off by more than 1 %, or hourglass
    modes hold more than 5 % of the internal energy.
    """
    from strikewave.analyses.fem.screen import check_element_case, run_element_case
    from strikewave.cases.case import load_case

    read = load_case(case, changes or ())
    for path, count in (("fem.frames", frames), ("fem.blows", blows)):
        if count is not None and (read.fem is None or count != read.values()[path].si):
            changes = [*(changes or ()), f"{path}={count}"]
            read = load_case(case, changes)
    if check:
        return check_element_case(read, output.json, options.threads)
    return run_element_case(read, changes or (), output, options)


def deck(
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


def ls_dyna(
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
    contacts, parts = _numbers_by_name("--contact", contact), _numbers_by_name("--part", part)
    for option, pairs in (("--contact", contact), ("--part", part)):
        if compare is None and pairs:
            raise InputError(option, pairs[0], "only with a result of strikewave fem", "add --compare DIR")
    system = unit_system(units, "--units")
    return read_run(LsDynaCommand(folder, system, compare, contacts, parts, output.stated_test()), output)


def _numbers_by_name(option: str, pairs: Sequence[str] | None) -> dict[str, int]:
    """Return numbers by name from NAME=NUMBER."""
    numbers: dict[str, int] = {}
    for text in pairs or ():
        name, _, number = text.rpartition("=")
        if not name or not number.strip().isdecimal() or name in numbers:
            raise InputError(option, text, "NAME=NUMBER, each name once", f"such as {option} ball=1")
        numbers[name] = int(number)
    return numbers
