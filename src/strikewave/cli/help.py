"""``strikewave help``: the help of the program, or of one command."""

from __future__ import annotations

from typing import Annotated

import typer

from strikewave.cli.group import entries


def _names(incomplete: str) -> list[tuple[str, str]]:
    """Return the commands that begin so, with their summaries."""
    return [(name, entry.summary) for name, entry in entries().items() if name.startswith(incomplete)]


def command(
    context: typer.Context,
    name: Annotated[
        str | None,
        typer.Argument(metavar="COMMAND", help="A command; the list of all by default.", autocompletion=_names),
    ] = None,
) -> int:
    """Show the help of a command."""
    root = context.find_root()
    words = ["--help"] if name is None else [name, "--help"]
    return int(root.command.main(words, prog_name=root.info_name, standalone_mode=False) or 0)
