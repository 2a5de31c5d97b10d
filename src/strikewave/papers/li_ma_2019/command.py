"""``strikewave reproduce``: every equation, figure and published number of a paper that can be computed."""

from __future__ import annotations

import contextlib
import os
import re
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from strikewave.reporting.run_and_write import BROKEN
from strikewave.reporting.terminal import Force, Json, Out, print_json, progress_bar, say, say_compiling, table

if TYPE_CHECKING:
    from strikewave.papers.li_ma_2019.result import Reproduction
    from strikewave.papers.li_ma_2019.runs import Effort

Report = Callable[[float, str], None]

LI_MA_FILES = ("report.html", "reproduction.json", "published.csv")
LI_MA_PICTURES = re.compile(r"figure-(?:5|7|9|11|13|15)(?:-[a-z])?\.svg")
"""Names of the pictures: the figure of the paper, and a letter from its second picture on."""
LEFT_OUT = ("elements", "studies")
"""What can be left out."""


class Paper(NamedTuple):
    """A paper that can be reproduced: what runs it, what writes its files, and what prints it.

    ``run`` takes the effort and a report of progress; ``write`` the result, the folder and the command; ``files``
    and what matches ``pictures`` are all that it may write.
    """

    run: Callable[[Effort, Report], Reproduction]
    write: Callable[[Reproduction, Path, str], list[str]]
    show: Callable[[Reproduction], None]
    files: tuple[str, ...]
    pictures: re.Pattern[str]

    def own(self, folder: Path) -> tuple[str, ...]:
        """Return the names of its files, with those of the pictures that a folder holds."""
        held = [path.name for path in folder.iterdir()] if folder.is_dir() and os.access(folder, os.R_OK) else []
        return (*self.files, *(name for name in held if self.pictures.fullmatch(name)))


def _run_li_ma(effort: Effort, report: Report) -> Reproduction:
    from strikewave.papers.li_ma_2019.reproduce import reproduce

    return reproduce(effort, report)


def _write_li_ma(result: Reproduction, place: Path, command: str) -> list[str]:
    """Write page, document, table and pictures, and return their names."""
    import json

    from strikewave.papers.li_ma_2019.report.figures import pictures
    from strikewave.papers.li_ma_2019.report.page import reproduction_report
    from strikewave.reporting.style import save

    names = list(LI_MA_FILES)
    (place / names[0]).write_text(reproduction_report(result, command), "utf-8", newline="\n")
    document = json.dumps(result.document(), indent=2, allow_nan=False, ensure_ascii=False)
    (place / names[1]).write_text(document + "\n", "utf-8")
    (place / names[2]).write_text(result.table(), "utf-8")
    for name, figure in pictures(result):
        save(figure, place / f"{name}.svg")
        names.append(f"{name}.svg")
    return names


def _show_li_ma(result: Reproduction) -> None:
    """Print the published numbers with what was computed, and what was found."""
    from strikewave.papers.li_ma_2019.report.tables import findings_table, numbers_table, plain_rows

    columns = ("published number", "published", "origin", "computed", "difference", "role", "by")
    heads, rows = plain_rows(numbers_table([row for row in result.numbers if row.computed]), columns)
    table("Published numbers and what was computed", heads, rows, left=len(heads))
    heads, rows = plain_rows(findings_table(result.findings), ("topic", "found", "verdict"))
    table("What the paper gets right, and what not", heads, rows, left=len(heads))
    for name, notice in result.notices:
        if notice.broken:
            say(f"warning [{notice.code}] {name}: {notice.message}")
    say(f"{len(result.notices)} warnings of the runs; the report lists them")


PAPERS = {"li-ma-2019": Paper(_run_li_ma, _write_li_ma, _show_li_ma, LI_MA_FILES, LI_MA_PICTURES)}
"""Papers that can be reproduced, by the key of their source."""


def command(
    paper: Annotated[str, typer.Argument(metavar="PAPER", help="li-ma-2019.", show_default=False)],
    quick: Annotated[bool, typer.Option("--quick", help="Coarser meshes for the element models, no studies.")] = False,
    without: Annotated[
        list[str] | None,
        typer.Option(
            "--without",
            metavar="elements|studies",
            help="Leave out the element models, or their meshes, assumed dimensions and second blow.",
            show_default=False,
        ),
    ] = None,
    threads: Annotated[
        int, typer.Option("--threads", help="Threads of the element models; they change no number.")
    ] = 1,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Reproduce a paper: its equations, figures and published numbers beside what is computed.

    With --json, files are written only where --out says. The exit code is 3 where a run broke a stated limit.
    """
    from strikewave.base.errors import InputError, nearest
    from strikewave.base.output_folder import check_place, whole_folder
    from strikewave.papers.li_ma_2019.runs import Effort

    begun = time.perf_counter()
    if paper not in PAPERS:
        raise InputError("PAPER", paper, "one of " + ", ".join(PAPERS), nearest(paper, PAPERS))
    for word in without or ():
        if word not in LEFT_OUT:
            raise InputError("--without", word, " or ".join(LEFT_OUT), nearest(word, LEFT_OUT))
    if threads < 1:
        raise InputError("--threads", threads, "at least 1")
    known = PAPERS[paper]
    gone = {word: word in (without or ()) for word in LEFT_OUT}
    effort = Effort(quick, not gone["elements"], min(threads, os.cpu_count() or 1), not gone["studies"])
    folder = Path("out") / f"{paper}-reproduced" if out is None and not json else out
    force = force or out is None
    identity = f'paper = "{paper}"\nquick = {str(quick).lower()}\nelements = {str(effort.elements).lower()}\n'
    identity += f"studies = {str(effort.studies).lower()}\n"
    if folder is not None:
        check_place(folder, identity, force, known.own(folder))
    say_compiling()
    with progress() as report:
        result = known.run(effort, report)
    if folder is not None:
        with whole_folder(folder, identity, force, known.own(folder)) as place:
            (place / "record.toml").write_text(identity, "utf-8")
            written = known.write(result, place, _command(paper, effort))
    if json:
        print_json(result.document())
    else:
        known.show(result)
    if folder is not None:
        say(f"written: {folder}/ ({', '.join(written)})")
    say(f"done in {time.perf_counter() - begun:.2f} s")
    return BROKEN if result.broken else 0


@contextlib.contextmanager
def progress() -> Iterator[Report]:
    """Show a bar on stderr where that is a terminal, or else a line for each run."""
    if sys.stderr.isatty():
        with progress_bar("") as report:
            yield report
        return
    told = [""]

    def line(share: float, words: str) -> None:
        run = words.partition(":")[0]
        if run not in ("", told[-1]):
            say(f"{share:4.0%}  {run}")
            told.append(run)

    yield line


def _command(paper: str, effort: Effort) -> str:
    """Return the command that gives the same result again."""
    chosen = (
        " --quick" * effort.quick
        + " --without elements" * (not effort.elements)
        + " --without studies" * (not effort.studies)
    )
    return f"strikewave reproduce {paper}{chosen}"
