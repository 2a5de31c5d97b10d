"""``strikewave app``: the app in a browser."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from strikewave.base.errors import InputError, MissingPackageError

PORT = 8471
"""Port by default: free on most machines, and the same each time, so that a link can be kept."""


def command(
    *,
    port: Annotated[
        int, typer.Option("--port", min=0, max=65535, help="Port; 0 takes any free one.", show_default=True)
    ] = PORT,
    host: Annotated[
        str,
        typer.Option(
            "--host",
            metavar="ADDRESS",
            help="Address to listen on; any but 127.0.0.1 lets other machines in, by a token in the address.",
        ),
    ] = "127.0.0.1",
    folder: Annotated[
        Path | None,
        typer.Option(
            "--folder",
            metavar="DIR",
            help="Folder that keeps results and what was dropped; by default they go when the app ends.",
            show_default=False,
        ),
    ] = None,
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="Open the browser; opened by default.", show_default=False)
    ] = True,
) -> int:
    """Open the app in a browser.

    It has pages to run machines, bars and elements, to judge records, to fit and to design: each shows the command that
    gives the same. Nothing leaves this machine. Needs pip install "strikewave[app]".
    """
    try:
        import nicegui  # noqa: F401
    except ImportError:
        raise MissingPackageError("strikewave app", "NiceGUI", "app") from None
    from strikewave.web.server import serve

    if folder is not None and folder.exists() and not folder.is_dir():
        raise InputError("--folder", folder, "a folder", "this is a file; choose another name")
    serve(host, port, folder, browser)
    return 0
