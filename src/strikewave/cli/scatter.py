"""``strikewave scatter``: what the tolerances of a machine case do to its blows."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from strikewave.cli.common import CaseName, Changes, Force, Json, Out, number, print_json, say, table

if TYPE_CHECKING:
    from strikewave.case import Case
    from strikewave.studies.scatter import Plan, ScatterStudy
    from strikewave.studies.scatter_shares import Share, Shares
    from strikewave.studies.scatter_statistics import Spread

SHOWN = {"peak": ("m/s^2", "g"), "width": ("s", "us"), "interval": ("s", "ms"), "velocity_change": ("m/s", "m/s")}
"""Figures of a blow, their SI units and those shown."""


def command(
    case: CaseName,
    runs: Annotated[int, typer.Option("--runs", help="How many runs.")] = 500,
    seed: Annotated[int, typer.Option("--seed", help="Of what is drawn; the same gives the same bits.")] = 1,
    shares: Annotated[
        str, typer.Option("--shares", help="alone (one tolerance at a time), sobol (slower), or none.")
    ] = "alone",
    workers: Annotated[int, typer.Option("--workers", help="Processes.")] = 2,
    changes: Changes = None,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Run a machine case many times within its tolerances: scatter of the blows, and which tolerance it comes from.

    A tolerance stands beside a value: { value = "1 kg", tolerance = "2 %" }. With --json, files are written only where
    --out says.
    """
    begun = time.perf_counter()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # for arrays this small, threads wait longer than they work
    from strikewave.case import load_case
    from strikewave.files import check_place
    from strikewave.studies.scatter import Plan, scatter

    read = load_case(case, changes or ())
    plan = Plan(runs, seed, shares, workers)
    plan.check()
    text = _identity(read, plan)
    folder, replace = out, force
    if out is None and not json:
        folder, replace = Path("out") / f"scatter-{read.name or 'case'}", True
    if folder is not None:
        check_place(folder, text, replace)
    with _progress() as report:
        study = scatter(read, plan, report)
    if folder is not None:
        _write(study, folder, text, replace)
    if json:
        print_json(study.document())
    else:
        _print(study)
    if folder is not None:
        say(f"written: {str(folder).rstrip('/')}/ (case.toml, runs.csv, scatter.json, scatter.svg)")
    say(f"done in {time.perf_counter() - begun:.2f} s")
    return 0


def _identity(case: Case, plan: Plan) -> str:
    """Return the case as text, and above it what was asked: another seed is another result."""
    from strikewave.case import dump_case

    asked = f"# strikewave scatter --runs {plan.runs} --seed {plan.seed} --shares {plan.shares}\n"
    return asked + dump_case(case)


@contextlib.contextmanager
def _progress() -> Iterator[Callable[[float], None]]:
    """Show a bar on stderr where that is a terminal; gives a function that takes the share done."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    from strikewave.compiled import is_cold

    if is_cold():
        say("compiling the kernels: once after install, about 20 s")
    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda share: None
        return
    words = TextColumn("runs"), TextColumn("{task.percentage:>3.0f} %")
    columns = (words[0], BarColumn(), words[1], TimeElapsedColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task("runs", total=1.0)
        yield lambda share: progress.update(task, completed=share)


def _write(study: ScatterStudy, folder: Path, text: str, force: bool) -> None:
    import json

    from strikewave.figures import save
    from strikewave.figures.scatter import scatter_picture
    from strikewave.files import whole_folder

    with whole_folder(folder, text, force) as place:
        (place / "case.toml").write_text(text, "utf-8")
        (place / "runs.csv").write_text(study.table(), "utf-8")
        (place / "scatter.json").write_text(json.dumps(study.document(), indent=2, allow_nan=False) + "\n", "utf-8")
        save(scatter_picture(study), place / "scatter.svg")


def _print(study: ScatterStudy) -> None:
    made, still = len(study.made), study.still
    say(f"{study.case.name}: {made} runs within {len(study.tolerances)} tolerances, seed {study.plan.seed}")
    rows = []
    for name, units in SHOWN.items():
        found = study.figure(name)
        mean = f"{number(found.mean.low, *units, 5)} to {number(found.mean.high, *units, 5)}"
        between = f"{_percent(found.mean.cv)} ({_percent(found.mean.cv_low)} to {_percent(found.mean.cv_high)})"
        cells = [number(found.mean.mean, *units, 5), mean, number(found.typical.mean, *units, 5), between]
        rows.append([f"{name.replace('_', ' ')} ({units[1]})", *cells])
    table("Means", ["figure", "mean", "95 % bounds", "typical", "CV between runs (95 %)"], rows)
    rows = []
    for name in SHOWN:
        found = study.figure(name)
        cells = [_percent(still.variation(name)), *_within(found.within)]
        cells += [_percent(still.variation(name, later=True)), *_within(found.later)]
        rows.append([name.replace("_", " "), *cells])
    heads = ["dynamics alone", "median (95 %)", "95 % of runs below"]
    table("Scatter within a run (CV); right: without the first blow", ["figure", *heads, *heads], rows)
    if made < 59:
        say("95 % of runs below: with 95 % confidence, which takes 59 runs or more")
    kinds = ", ".join(f"{blows} {kind} (in {runs} runs)" for kind, (blows, runs) in study.kinds().items())
    say(f"blows: {kinds}; largest retreat {number(study.largest_retreat, 'm', 'mm', 3)} mm")
    for one in study.shares:
        _print_shares(study, one)
    for notice in study.warnings:
        say(f"warning [{notice.code}]: {notice.message}")


def _print_shares(study: ScatterStudy, shares: Shares) -> None:
    """Print the shares in one quantity with what each tolerance is."""
    known = {one.path: one for one in study.tolerances}
    sobol = study.plan.shares == "sobol"
    rows = []
    for row in shares.rows:
        one = known[row.path]
        assert one.value.tolerance is not None
        typed = f"{one.value.typed} ± {one.value.tolerance.typed}"
        each = "each striker" if one.strikers else "once a run"
        cells = [row.path, typed, each, one.value.provenance, *_share(row)]
        if sobol and row.total is not None:
            cells.append(f"{_percent(row.total)} ({_percent(row.total_low)} to {_percent(row.total_high)})")
        rows.append(cells)
    columns = ["tolerance", "value", "drawn", "provenance", "share", "95 % bounds", *(["total"] if sobol else [])]
    title = f"Shares in the {shares.of}, {'Sobol indices' if sobol else 'each alone'}, {shares.runs} runs each"
    table(title, columns, rows, left=4)
    say(f"sum of the shares: {_percent(shares.sum)} ({_percent(shares.sum_low)} to {_percent(shares.sum_high)})")


def _share(row: Share) -> list[str]:
    bounds = f"{_percent(row.low)} to {_percent(row.high)}"
    return [_percent(row.share), bounds if row.distinct else f"{bounds}: not told apart from 0"]


def _within(found: Spread) -> list[str]:
    return [f"{_percent(found.median)} ({_percent(found.low)} to {_percent(found.high)})", _percent(found.limit)]


def _percent(value: float | None) -> str:
    """Write a share in percent to three digits; a dash where there is none.

    Examples
    --------
    >>> _percent(0.012345), _percent(float("nan"))
    ('1.23 %', '-')
    """
    if value is None or value != value:
        return "-"
    if 0.0 < abs(value) < 1e-6:
        return "< 1e-4 %"
    return f"{100.0 * value:.3g} %" if abs(value) < 10.0 else f"{100.0 * value:.0f} %"
