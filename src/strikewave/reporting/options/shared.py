"""Options that several commands take: the case and its changes, who makes the runs of a study, whether it has bands."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal

import typer


def complete_case(incomplete: str) -> list[str]:
    """Return the built-in cases and the case files of this folder that begin so."""
    published = resources.files("strikewave.cases") / "published"
    names = [entry.name.removesuffix(".toml") for entry in published.iterdir() if entry.name.endswith(".toml")]
    files = [path.name for path in Path().glob("*.toml")]
    return [name for name in (*sorted(names), *sorted(files)) if name.startswith(incomplete)]


def case_name(metavar: str, help: str) -> Any:
    """Return an argument that takes a case."""
    return typer.Argument(metavar=metavar, help=help, show_default=False, autocompletion=complete_case)


CaseName = Annotated[str, case_name("CASE", "A case file, or the name of a built-in case.")]
Changes = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="PATH=VALUE",
        help='Change a field, such as machine.speed="700 rpm"; may be repeated.',
        show_default=False,
    ),
]
Processes = Annotated[
    int, typer.Option("--workers", metavar="COUNT", min=1, max=256, help="Processes, one a core at most.")
]
Cluster = Annotated[
    str | None,
    typer.Option(
        "--cluster",
        metavar="tcp://HOST:PORT",
        help="Dask scheduler that shares the runs among machines; processes of this one (--workers) by default.",
        show_default=False,
    ),
]
ElementDevice = Annotated[
    Literal["cuda", "cuda-mixed"] | None,
    typer.Option(
        "--device",
        help=(
            "Take the steps of elements on an NVIDIA GPU, by cuda-mixed in single and double precision; on the "
            "processor by default."
        ),
        show_default=False,
    ),
]
KeptRuns = Annotated[
    Path | None,
    typer.Option(
        "--store",
        metavar="DIR",
        help="Folder that keeps finished runs for later studies; beside the result, till it is written, by default.",
        show_default=False,
    ),
]
Fresh = Annotated[
    bool, typer.Option("--fresh", help="Make all runs anew: none of a stopped or a finished study is read.")
]


@dataclass(frozen=True)
class Shared:
    """Who makes the runs of a study.

    Attributes
    ----------
    workers : int or None
        Processes; None for threads of this one.
    cluster : str or None
        Address of a scheduler that shares the runs among machines.
    """

    workers: Annotated[
        int | None,
        typer.Option(
            "--workers",
            metavar="COUNT",
            min=1,
            max=256,
            help="Processes, one a core at most; threads of one process by default.",
            show_default=False,
        ),
    ] = None
    cluster: Cluster = None


@dataclass(frozen=True)
class Running(Shared):
    """Who makes the runs of a study, and where finished ones are kept.

    Attributes
    ----------
    store : Path or None
        Folder that keeps finished runs; None for one beside the result, till that is written.
    fresh : bool
        Whether finished runs of a stopped study are made again.
    """

    store: KeptRuns = None
    fresh: Fresh = False


WithBand = Annotated[
    bool,
    typer.Option(
        "--band/--no-band", help="Find the range of each result when inputs move within what is known of them."
    ),
]
