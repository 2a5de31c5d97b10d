"""``strikewave map``: how even a machine's blows are over two of its settings, and where they are even nearest."""

from __future__ import annotations

import contextlib
import math
import os
import secrets
import shutil
import time as clock
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from strikewave.cli.carry_out import BROKEN
from strikewave.cli.common import CaseName, Changes, Force, Json, Out, number, print_json, say, significant, table

if TYPE_CHECKING:
    from strikewave.case import Case
    from strikewave.quantities import Value
    from strikewave.studies.map import MapStudy
    from strikewave.studies.map_cells import Axis, Plan
    from strikewave.studies.map_store import Store

X, Y = "machine.speed", "object.spring"
"""What stands along the axes unless said otherwise."""
FILES = ("case.toml", "map.json", "map.nc", "map.csv", "map.svg", "map.png", "equal-blows.toml")
"""What a map writes."""
MOST_PANELS = 6


def command(
    case: CaseName,
    x: Annotated[str, typer.Option("--x", help='Setting and range, such as machine.speed="400 rpm:1000 rpm".')] = X,
    y: Annotated[str, typer.Option("--y", help="The same for the other axis; half to twice without a range.")] = Y,
    panels: Annotated[
        str | None,
        typer.Option(
            "--panels", help='A third setting, such as object.damper="10 N s/m, 40 N s/m".', show_default=False
        ),
    ] = None,
    points: Annotated[str, typer.Option("--points", help="Along x and y.")] = "60x60",
    log: Annotated[list[str] | None, typer.Option("--log", help="x or y: in equal ratios.", show_default=False)] = None,
    blows: Annotated[
        int | None, typer.Option("--blows", help="Of the machine; as the case has it by default.", show_default=False)
    ] = None,
    train: Annotated[
        int, typer.Option("--train", help="Blows of the longer train that names the regime; 0 for none.")
    ] = 60,
    colour: Annotated[
        str,
        typer.Option(
            "--colour", help="cv, cv_later, peak, first_peak, retreat, stop_force, train_time or missed: what is drawn."
        ),
    ] = "cv",
    want_cv: Annotated[str, typer.Option("--want-cv", help="Coefficient of variation of even blows.")] = "2 %",
    workers: Annotated[int, typer.Option("--workers", help="Processes.")] = 2,
    fresh: Annotated[bool, typer.Option("--fresh", help="Run finished rows of a stopped map anew.")] = False,
    changes: Changes = None,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Map a machine over two of its settings: how even its blows are, and what a longer train settles to.

    A map that is stopped goes on where it was. The nearest setting with even blows is tried in a full run; exit code 3
    says that there is none. With --json, files are written only where --out says.
    """
    begun = clock.perf_counter()
    from strikewave.case import load_case
    from strikewave.figures.map import check_colour
    from strikewave.studies.map import check_plan, make_map, plan_of
    from strikewave.studies.map_store import Store

    check_colour(colour)
    loaded = load_case(case, changes or ())
    plan = plan_of(loaded, _axes(loaded, (x, y, panels), points, log or []), blows, train)
    wanted, count = _share(want_cv), _workers(workers)
    seconds = check_plan(plan, count)
    folder = Path("out") / f"map-{loaded.name or 'case'}" if out is None and not json else out
    if folder is not None:
        _check_place(folder, plan.case, force or out is None)
        _begin(folder, plan.case)
    store = Store(plan, folder, fresh)
    say(_words(plan, seconds, store))
    with _progress(float(store.done.mean())) as report:
        study = make_map(plan, wanted, count, store, report)
    if folder is not None:
        _write(study, folder, colour)
    if json:
        print_json(study.document(), indent=None)
    else:
        _print(study)
    if folder is not None:
        say(f"written: {folder}/ ({', '.join(name for name in FILES if (folder / name).exists())})")
    say(f"done in {clock.perf_counter() - begun:.2f} s")
    return BROKEN if study.broken else 0


def _axes(case: Case, given: tuple[str, str, str | None], points: str, log: list[str]) -> tuple[Axis, ...]:
    """Return the axes of a map from what was typed."""
    from strikewave.errors import InputError
    from strikewave.studies.map import axis_of
    from strikewave.studies.map_cells import Axis

    sizes = _points(points)
    wrong = next((name for name in log if name not in ("x", "y")), None)
    if wrong is not None:
        raise InputError("--log", wrong, "x or y")
    found = []
    for option, text, size in zip(("x", "y"), given[:2], sizes, strict=True):
        path, equals, ends = (part.strip() for part in str(text).partition("="))
        parts = ends.split(":") if equals else []
        if equals and len(parts) != 2:
            raise InputError(f"--{option}", text, "setting=low:high", f'such as --{option} {X}="400 rpm:1000 rpm"')
        typed = tuple(_value(case, path, part) for part in parts)
        found.append(axis_of(case, path, (typed[0], typed[1]) if typed else None, size, option in log))
    if given[2] is None:
        return tuple(found)
    path, _, ends = (part.strip() for part in given[2].partition("="))
    values = [_value(case, path, part) for part in ends.split(",") if part.strip()]
    if not 1 <= len(values) <= MOST_PANELS:
        allowed = f"setting=value,value, with 1 to {MOST_PANELS} values"
        raise InputError("--panels", given[2], allowed, 'such as object.damper="10 N s/m, 40 N s/m"')
    shown = axis_of(case, path, None, 2, False)
    third = Axis(path, _unit_of(values[0]) or shown.unit, shown.si_unit, tuple(sorted(v.si for v in values)))
    return (*found, third)


def _unit_of(value: Value) -> str:
    """Return the unit in which a value was typed."""
    return str(value.typed).strip().lstrip("+-0123456789.eE").strip() if isinstance(value.typed, str) else ""


def _value(case: Case, path: str, text: str) -> Value:
    """Return a value of a setting as the case file would take it."""
    from strikewave.case import dump_case, parse_case
    from strikewave.errors import InputError, nearest

    if path not in case.values():
        raise InputError(path, text, "a quantity of the case", nearest(path, case.values()))
    return parse_case(dump_case(case), case.name, [f"{path}={text.strip()}"]).values()[path]


def _points(text: str) -> tuple[int, int]:
    """Read 200x200, or 200 for both."""
    from strikewave.errors import InputError

    parts = text.lower().replace("×", "x").split("x")
    if len(parts) > 2 or not all(part.strip().isdecimal() and len(part.strip()) < 8 for part in parts):
        raise InputError("--points", text, "two whole numbers", "such as 200x200")
    numbers = [int(part) for part in parts]
    return numbers[0], numbers[-1]


def _share(text: str) -> float:
    """Read a share such as 2 % or 0.02."""
    from strikewave.errors import InputError

    allowed = "a share above 0 and below 1, such as 2 %"
    bare = text.strip()
    try:
        value = float(bare.removesuffix("%")) / (100.0 if bare.endswith("%") else 1.0)
    except ValueError:
        raise InputError("--want-cv", text, allowed) from None
    if not 0.0 < value < 1.0:
        raise InputError("--want-cv", text, allowed)
    return value


def _workers(count: int) -> int:
    from strikewave.errors import InputError

    if not 1 <= count <= 256:
        raise InputError("--workers", count, "1 to 256 processes", f"this machine has {os.cpu_count()} cores")
    return min(count, os.cpu_count() or 1)


def _check_place(folder: Path, identity: str, force: bool) -> None:
    """Refuse a folder that holds anything but a map, or the map of another case without ``force``."""
    from strikewave.errors import InputError, show
    from strikewave.studies.map_store import NAME

    if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
        raise InputError("--out", str(folder), "a folder", "this is a file or a link; choose another name")
    if not folder.exists() or not any(folder.iterdir()):
        return
    foreign = sorted(entry.name for entry in folder.iterdir() if entry.name not in (*FILES, NAME))
    if foreign:
        hint = f"it holds files that are not of a map ({show(', '.join(foreign))}); move them, or choose another folder"
        raise InputError("--out", str(folder), "an empty or new folder", hint)
    mark = folder / "case.toml"
    if not force and (not mark.is_file() or mark.read_text("utf-8", errors="replace") != identity):
        hint = "it holds the map of another case; add --force to replace it"
        raise InputError("--out", str(folder), "a new folder", hint)


def _begin(folder: Path, text: str) -> None:
    """Make the folder, and mark it with the case."""
    from strikewave.errors import InputError
    from strikewave.files import write_whole

    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError("--out", str(folder), "a place that can be written", error.strerror or "") from None
    write_whole(folder / "case.toml", text)


def _words(plan: Plan, seconds: float, store: Store) -> str:
    """Return what is about to be run, in words."""
    panels, rows, columns = plan.shape
    size = f"{columns} x {rows}" + (f" x {panels}" if panels > 1 else "")
    left = 1.0 - float(store.done.mean())
    kept = f", {store.done.sum()} of {store.done.size} rows are there already" if store.done.any() else ""
    trains = f" and trains of {plan.train}" if plan.train else ""
    return f"{size} machines, {plan.blows} blows{trains}: about {left * seconds:.0f} s on free cores{kept}"


@contextlib.contextmanager
def _progress(done: float) -> Iterator[Callable[[float], None]]:
    """Show a bar with the time left on stderr where that is a terminal; gives a function that takes the share done."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    from strikewave.compiled import is_cold

    if is_cold():
        say("compiling the kernels: once after install, about 60 s")
    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda share: None
        return
    bar = (TextColumn("map"), BarColumn(), TextColumn("{task.percentage:>3.0f} %"), TimeRemainingColumn())
    with Progress(*bar, console=console, transient=True) as progress:
        task = progress.add_task("map", total=1.0)
        progress.update(task, completed=done)
        yield lambda share: progress.update(task, completed=share)


def _write(study: MapStudy, folder: Path, colour: str) -> None:
    """Write the files of a map: all beside the finished rows first, then one after the other into place.

    The rows go last, so that a map that is stopped while it is written begins there again.
    """
    import json

    from strikewave.case import dump_case
    from strikewave.errors import InputError
    from strikewave.figures import save
    from strikewave.figures.map import map_figure
    from strikewave.studies.map_store import NAME

    place = folder.with_name(f".{folder.name[:60]}-{secrets.token_hex(6)}")
    try:
        place.mkdir()
        (place / "map.json").write_text(json.dumps(study.document(), allow_nan=False) + "\n", "utf-8")
        (place / "map.csv").write_text(study.table(), "utf-8")
        study.dataset().to_netcdf(place / "map.nc", engine="h5netcdf")
        figure = map_figure(study, colour)
        save(figure, place / "map.svg")
        save(figure, place / "map.png")
        if study.setting is not None:
            (place / "equal-blows.toml").write_text(dump_case(study.nearest_case()), "utf-8")
        for name in FILES[1:]:
            if (place / name).exists():
                (place / name).replace(folder / name)
            else:
                (folder / name).unlink(missing_ok=True)
        (folder / NAME).unlink(missing_ok=True)
    except OSError as error:
        raise InputError("--out", str(folder), "a place that can be written", error.strerror or "") from error
    finally:
        shutil.rmtree(place, ignore_errors=True)


def _print(study: MapStudy) -> None:
    """Print what the map shows: shares of the regimes, why cells failed, the case, and the nearest even setting."""
    rows = [[name, f"{100.0 * share:.1f}"] for name, share in study.shares.items()]
    table("Regimes", ["regime", "cells (%)"], rows)
    for text, count in study.failures.items():
        say(f"no result, or no regime, in {count} cells: {text}")
    axes, found = study.plan.axes, study.setting
    columns = ["", *(f"{a.path}\n({a.unit or '1'})" for a in axes), "CV\n(%)", "CV from 2nd\n(%)", "peak\n(g)",
               "retreat\n(mm)", "stop\n(kN)", "train\n(ms)"]  # fmt: skip
    lines = [_line("case", axes, study.here, study.present)]
    if found is not None:
        lines.append(_line(f"nearest within {100.0 * study.wanted:g} %", axes, found.values, found.cell))
    table(f"{study.case.name}: {study.plan.blows} blows", columns, lines)
    if found is None:
        say(f"no setting of this map has blows that all come with a CV within {100.0 * study.wanted:g} %")
        return
    say(
        f"the nearest is {found.distance:.3g} away in relative steps; a full run of it has a CV of "
        f"{100.0 * found.cv:.3g} % and a mean peak of {number(found.peak, 'm/s^2', 'g', 5)} g"
    )


def _line(name: str, axes: tuple[Axis, ...], values: tuple[float, ...], cell: dict[str, float]) -> list[str]:
    """Return a row of the table of settings."""
    shown = [f"{axis.shown(value):.5g}" for axis, value in zip(axes, values, strict=True)]
    spreads = ["-" if math.isnan(cell[key]) else significant(100.0 * cell[key], 3) for key in ("cv", "cv_later")]
    units = (("peak", "m/s^2", "g"), ("retreat", "m", "mm"), ("stop_force", "N", "kN"), ("train_time", "s", "ms"))
    return [name, *shown, *spreads, *(number(cell[key], si, unit, 5) for key, si, unit in units)]
