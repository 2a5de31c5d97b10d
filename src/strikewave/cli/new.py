"""``strikewave new``: begin a case file from a published one."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from strikewave.cli.common import Force, say


def command(
    file: Annotated[
        Path, typer.Argument(help="The case file to write; .toml is added where it lacks.", show_default=False)
    ],
    origin: Annotated[str, typer.Option("--from", metavar="CASE", help="The case to begin from.")] = "li-ma-2019",
    force: Force = False,
) -> int:
    """Write a new case file to edit, with every value and its provenance."""
    from strikewave.case import dump_case, load_case
    from strikewave.errors import InputError

    path = file if file.suffix == ".toml" else file.with_name(file.name + ".toml")
    if path.exists() and not force:
        raise InputError("FILE", str(path), "a name that is not taken", "add --force to replace it")
    if not path.absolute().parent.is_dir():
        raise InputError("FILE", str(path), "a file in a folder that exists")
    case = load_case(origin)
    text = dump_case(case.model_copy(update={"name": path.stem}))
    partial = path.with_name(f".{path.name}.partial")
    try:
        partial.write_text(text, "utf-8")
        partial.replace(path)
    except OSError as error:
        partial.unlink(missing_ok=True)
        raise InputError("FILE", str(path), "a place that can be written", error.strerror or "") from None
    say(f"written: {path}; change a value, then: strikewave run {path}")
    return 0
