"""How a command that solves a case comes to its result: read, check the place, solve, write whole, print."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from strikewave.reporting.terminal import own_mark, print_json, say

if TYPE_CHECKING:
    from strikewave.cases.case import Case

BROKEN = 3
"""Exit code of a run that broke a stated limit."""


class Work(NamedTuple):
    """What a command does with a case.

    Attributes
    ----------
    solve : callable
        Case in, solution out.
    write : callable
        Writes the files of a solution into a folder, given the text of the case.
    show : callable
        Prints a solution.
    files : str
        The files that it writes, in words.
    indent : int or None
        Of the JSON document.
    """

    solve: Callable[[Case], Any]
    write: Callable[[Any, Path, str], None]
    show: Callable[[Any], None]
    files: str
    indent: int | None = 2


def carry_out(work: Work, name: str, changes: list[str] | None, out: Path | None, force: bool, json: bool) -> int:
    """Solve a case, write and print its result, and return the exit code.

    out/NAME always holds the last run of that name; a changed case gets a name of its own, so that it never
    meets the unchanged one. With JSON, files are written only to ``out``.
    """
    from strikewave.base.output_folder import check_place, whole_folder
    from strikewave.cases.case import dump_case, load_case

    begun = time.perf_counter()
    case = load_case(name, changes or ())
    text, folder = dump_case(case), out
    if out is None and not json:
        folder, force = Path("out") / f"{case.name or 'case'}{own_mark(text, changes)}", True
    if folder is not None:
        check_place(folder, text, force)
    solution = work.solve(case)
    if folder is not None:
        with whole_folder(folder, text, force) as place:
            work.write(solution, place, text)
    if json:
        print_json(solution.document(), indent=work.indent)
    else:
        work.show(solution)
    if folder is not None:
        say(f"written: {folder}{'/' if str(folder)[-1] != '/' else ''} ({work.files})")
    say(f"done in {time.perf_counter() - begun:.2f} s")
    return BROKEN if solution.broken else 0
