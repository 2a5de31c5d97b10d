"""``strikewave hopkinson``: reduce a split-Hopkinson shot, compare an accelerometer on a bar, calibrate a bar."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from strikewave.reporting.run_and_write import BROKEN
from strikewave.reporting.terminal import Changes, Force, Json, Out, number, own_mark, print_json, say, table

if TYPE_CHECKING:
    from strikewave.analyses.hopkinson.echo_result import EchoSolution
    from strikewave.analyses.hopkinson.result import SplitBarSolution
    from strikewave.analyses.hopkinson.sensor_result import SensorSolution
    from strikewave.reporting.parts import Table

    AnySolution = SplitBarSolution | SensorSolution | EchoSolution

Setup = Annotated[
    str,
    typer.Argument(
        metavar="SETUP", help="The set-up file: bars, gauges, specimen or accelerometer.", show_default=False
    ),
]


def command(setup: Setup, changes: Changes = None, out: Out = None, force: Force = False, json: Json = False) -> int:
    """Reduce a split-Hopkinson shot to stress, strain and strain rate; compare an accelerometer; calibrate a bar.

    The set-up names files, gauges and bars; the pulses are found. [specimen] makes it a shot, [accelerometer] a sensor
    on the end of one bar beside the acceleration that the gauge tells, neither of them a bar alone. With --json, files
    are written only where --out says. The exit code is 3 where forces or impulses miss each other by more than
    [limits].
    """
    from strikewave.analyses.hopkinson.run import run_split_bar
    from strikewave.analyses.hopkinson.setup_file import load_setup
    from strikewave.base.output_folder import check_place, whole_folder

    begun = time.perf_counter()
    case = load_setup(setup, changes or ())
    solution = run_split_bar(case)
    text = case.text + "".join(f"# SHA-256 {digest} {name}\n" for name, digest in solution.digests.items())
    folder = out
    if out is None and not json:
        mark = own_mark(text, changes)
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


def write_result(solution: AnySolution, place: Path, text: str) -> str:
    """Write the files of a result into a folder, and return their names."""
    from strikewave.analyses.hopkinson import figures as hopkinson
    from strikewave.analyses.hopkinson import report as hopkinson_page
    from strikewave.analyses.hopkinson.result import SplitBarSolution
    from strikewave.analyses.hopkinson.sensor_result import SensorSolution
    from strikewave.reporting.style import save

    (place / "case.toml").write_text(text, "utf-8")
    if isinstance(solution, SplitBarSolution):
        name, tables = "reduction", {"reduction": solution.reduction_table(), "pulses": solution.pulses_table()}
        picture, page = hopkinson.shot_summary(solution), hopkinson_page.shot_report(solution, text)
    elif isinstance(solution, SensorSolution):
        name, tables = "reduction", {"reduction": solution.table()}
        picture, page = hopkinson.sensor_summary(solution), hopkinson_page.sensor_report(solution, text)
    else:
        name, tables = "echoes", {"echoes": solution.table()}
        picture, page = hopkinson.echo_summary(solution), hopkinson_page.echo_report(solution, text)
    solution.save(place / f"{name}.nc")
    for title, rows in tables.items():
        (place / f"{title}.csv").write_text(rows, "utf-8")
    save(picture, place / "summary.svg")
    (place / "report.html").write_text(page, "utf-8", newline="\n")
    return ", ".join(["report.html", "summary.svg", f"{name}.nc", *(f"{title}.csv" for title in tables), "case.toml"])


def show(solution: AnySolution) -> None:
    """Print the tables of a result."""
    for shown in _tables(solution):
        rows = [[cell if isinstance(cell, str) else cell.text for cell in row] for row in shown.cells()]
        table(shown.caption, shown.columns, rows)
    for notice in solution.warnings:
        limit = f" (limit {number(notice.limit, '1', '1', 3)})" if notice.broken else ""
        say(f"warning [{notice.code}]: {notice.message}{limit}")


def _tables(solution: AnySolution) -> list[Table]:
    from strikewave.analyses.hopkinson.report import echo_tables, sensor_tables, shot_tables
    from strikewave.analyses.hopkinson.result import SplitBarSolution
    from strikewave.analyses.hopkinson.sensor_result import SensorSolution

    if isinstance(solution, SplitBarSolution):
        return shot_tables(solution)
    return sensor_tables(solution) if isinstance(solution, SensorSolution) else echo_tables(solution)
