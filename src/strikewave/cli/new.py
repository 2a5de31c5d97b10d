"""``strikewave new``: begin a case file from a published one, or a set-up of split bars from an example."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from strikewave.base.errors import InputError
from strikewave.base.output_folder import write_atomically
from strikewave.cases.case import dump_case, load_case, parse_case
from strikewave.cases.performed_test import EXAMPLE as TEST_EXAMPLE
from strikewave.reporting.options import complete_case
from strikewave.reporting.terminal import say

HOPKINSON = "hopkinson"
"""Stands for the example of a set-up of split bars, and is the command that it is for."""


def _complete(incomplete: str) -> list[str]:
    """Return what a case may begin from."""
    return [*complete_case(incomplete), *([HOPKINSON] if HOPKINSON.startswith(incomplete) else [])]


def command(
    file: Annotated[
        Path, typer.Argument(help="The case file to write; .toml is added where it lacks.", show_default=False)
    ],
    *,
    origin: Annotated[
        str,
        typer.Option(
            "--from",
            metavar="CASE",
            help="The case to begin from; hopkinson for a set-up of split Hopkinson bars.",
            autocompletion=_complete,
        ),
    ] = "li-ma-2019",
    force: Annotated[bool, typer.Option("--force", help="Replace the file.")] = False,
) -> int:
    """Write a new case file to edit.

    It has every value of the case with its provenance.
    """
    if not file.name or file.suffix not in ("", ".toml"):
        raise InputError("FILE", str(file), "the name of a case file, such as my-machine.toml")
    path = file.with_name(file.stem + ".toml")
    if path.exists() and not force:
        raise InputError("FILE", str(path), "a name that is not taken", "add --force to replace it")
    if not path.absolute().parent.is_dir():
        raise InputError("FILE", str(path), "a file in a folder that exists")
    if origin == HOPKINSON:
        from strikewave.analyses.hopkinson.setup_file import example_setup

        write_atomically(path, example_setup() + TEST_EXAMPLE)
        say(f"written: {path}; name your bars and files, then: strikewave {HOPKINSON} {path}")
        return 0
    case = load_case(origin)
    text = dump_case(case.model_copy(update={"name": path.stem, "title": f"{path.stem}, from {origin}"}))
    parse_case(text)  # refuses a name that no result folder may have
    write_atomically(path, text if case.test.stated() else text + TEST_EXAMPLE)
    say(f"written: {path}; change a value, then: strikewave {case.command} {path}")
    return 0
