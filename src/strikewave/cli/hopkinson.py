"""``strikewave hopkinson``: reduce a split-Hopkinson shot, or calibrate a bar by its echoes."""

from __future__ import annotations

import hashlib
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from strikewave.cli.carry_out import BROKEN
from strikewave.cli.common import Changes, Force, Json, Out, number, print_json, say, table

if TYPE_CHECKING:
    from strikewave.split_bar import EchoSolution, SplitBarSolution

Setup = Annotated[
    str, typer.Argument(metavar="SETUP", help="The set-up file of a shot: bars, gauges, specimen.", show_default=False)
]


def command(setup: Setup, changes: Changes = None, out: Out = None, force: Force = False, json: Json = False) -> int:
    """Reduce a split-Hopkinson shot to stress, strain and strain rate; without [specimen], calibrate a bar.

    The set-up names files, gauges and bars; the pulses are found. With --json, files are written only where --out
    says. The exit code is 3 where forces or impulses miss each other by more than [limits].
    """
    from strikewave.files import check_place, whole_folder
    from strikewave.split_bar import load_setup, run_split_bar

    begun = time.perf_counter()
    case = load_setup(setup, changes or ())
    solution = run_split_bar(case)
    text = case.text + "".join(f"# SHA-256 {digest} {name}\n" for name, digest in solution.digests.items())
    folder = out
    if out is None and not json:
        mark = "-" + hashlib.sha256(text.encode()).hexdigest()[:8] if changes else ""
        folder, force = Path("out") / f"{case.setup.name or 'shot'}{mark}", True
    if folder is not None:
        check_place(folder, text, force)
        with whole_folder(folder, text, force) as place:
            written = write_result(solution, place, text)
    if json:
        print_json(solution.document(), indent=None)
    else:
        show(solution)
    if folder is not None:
        say(f"written: {folder}/ ({written})")
    say(f"done in {time.perf_counter() - begun:.2f} s")
    return BROKEN if solution.broken else 0


def write_result(solution: SplitBarSolution | EchoSolution, place: Path, text: str) -> str:
    """Write the files of a result into a folder, and return their names."""
    from strikewave.figures import save
    from strikewave.figures.hopkinson import echo_summary, shot_summary
    from strikewave.report.hopkinson_page import echo_report, shot_report
    from strikewave.split_bar import SplitBarSolution

    (place / "case.toml").write_text(text, "utf-8")
    if isinstance(solution, SplitBarSolution):
        solution.save(place / "reduction.nc")
        (place / "reduction.csv").write_text(solution.reduction_table(), "utf-8")
        (place / "pulses.csv").write_text(solution.pulses_table(), "utf-8")
        save(shot_summary(solution), place / "summary.svg")
        (place / "report.html").write_text(shot_report(solution, text), "utf-8", newline="\n")
        return "report.html, summary.svg, reduction.nc, reduction.csv, pulses.csv, case.toml"
    solution.save(place / "echoes.nc")
    (place / "echoes.csv").write_text(solution.table(), "utf-8")
    save(echo_summary(solution), place / "summary.svg")
    (place / "report.html").write_text(echo_report(solution, text), "utf-8", newline="\n")
    return "report.html, summary.svg, echoes.nc, echoes.csv, case.toml"


def show(solution: SplitBarSolution | EchoSolution) -> None:
    """Print the tables of a result."""
    from strikewave.report.hopkinson_page import echo_tables, shot_tables
    from strikewave.split_bar import SplitBarSolution

    tables = shot_tables(solution) if isinstance(solution, SplitBarSolution) else echo_tables(solution)
    for shown in tables:
        rows = [[cell if isinstance(cell, str) else cell.text for cell in row] for row in shown.cells()]
        table(shown.caption, shown.columns, rows)
    for notice in solution.warnings:
        limit = f" (limit {number(notice.limit, '1', '1', 3)})" if notice.broken else ""
        say(f"warning [{notice.code}]: {notice.message}{limit}")
