"""``strikewave map``: how even a machine's blows are over two of its settings, and where they are even nearest."""

from __future__ import annotations

import hashlib
import os
import signal
import time as clock
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from strikewave.reporting.run_and_write import BROKEN
from strikewave.reporting.terminal import (
    CaseName,
    Changes,
    Force,
    Json,
    Out,
    number,
    own_mark,
    print_json,
    progress_bar,
    say,
    table,
)

if TYPE_CHECKING:
    from strikewave.base.quantities import Value
    from strikewave.cases.case import Case
    from strikewave.studies.map.cells import Axis, Plan
    from strikewave.studies.map.store import Store
    from strikewave.studies.map.study import MapStudy

X, Y = "machine.speed", "object.spring"
"""What stands along the axes unless said otherwise."""
FILES = ("case.toml", "map.json", "map.nc", "map.csv", "map.svg", "map.png", "equal-blows.toml")
"""What a map writes."""
_PEAK = ("m/s^2", "g")
SHOWN = (
    ("CV (%)", "cv", "1", "%"),
    ("CV from 2nd blow (%)", "cv_later", "1", "%"),
    ("mean peak (g)", "peak", *_PEAK),
    ("missed (1)", "missed", "1", "1"),
    ("largest retreat (mm)", "retreat", "m", "mm"),
    ("stop force (kN)", "stop_force", "N", "kN"),
    ("train (ms)", "train_time", "s", "ms"),
)
"""What is told of a setting: words, name of the field, SI unit and unit."""
MOST_PANELS = 6
INTERRUPTED = 128 + signal.SIGINT
"""Exit code of a map that was stopped."""


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
    from strikewave.base.compiled import is_cold
    from strikewave.base.output_folder import check_place
    from strikewave.cases.case import load_case
    from strikewave.studies.map.figures import check_colour
    from strikewave.studies.map.store import Store, rows_beside
    from strikewave.studies.map.study import check_plan, plan_of

    check_colour(colour)
    loaded = load_case(case, changes or ())
    plan = plan_of(loaded, _axes(loaded, (x, y, panels), points, log or []), blows, train)
    wanted, count = _share(want_cv), _workers(workers)
    seconds = check_plan(plan, count)
    folder, replace, text = out, force, _identity(plan, wanted)
    if out is None and not json:
        mark = own_mark(plan.case, changes)
        folder, replace = Path("out") / f"map-{loaded.name or 'case'}{mark}", True
    if folder is not None:
        check_place(folder, text, replace)
    store = Store(plan, None if folder is None else rows_beside(folder.absolute()), fresh)
    if is_cold("run_train"):
        say("compiling the kernels of the fast run: once after install, a minute or more")
    say(_words(plan, seconds, store))
    study = _made(plan, wanted, count, store)
    if folder is not None:
        _write(study, folder, (text, replace), colour)
        store.remove()
    if json:
        print_json(study.document(), indent=None)
    else:
        _print(study)
    if folder is not None:
        say(f"written: {str(folder).rstrip('/')}/ ({', '.join(name for name in FILES if (folder / name).exists())})")
    say(f"done in {clock.perf_counter() - begun:.2f} s")
    return BROKEN if study.broken else 0


def _identity(plan: Plan, wanted: float) -> str:
    """Return the case as text, and above it what was asked: other axes are another result."""
    sizes = " x ".join(f"{len(axis.values)} {axis.path}" for axis in plan.axes)
    key = hashlib.sha256(repr((plan, wanted)).encode()).hexdigest()[:12]
    asked = f"{sizes}, {plan.blows} blows, trains of {plan.train}, CV within {100.0 * wanted:g} %"
    return f"# strikewave map of {asked}; plan {key}\n{plan.case}"


def _made(plan: Plan, wanted: float, workers: int, store: Store) -> MapStudy:
    """Make a map; where it is stopped, finished rows are kept, and said to be."""
    from strikewave.studies.map.study import make_map

    try:
        with progress_bar("map", float(store.done.mean()), ("left",)) as report:
            return make_map(plan, wanted, workers, store, report)
    except KeyboardInterrupt:
        kept = f"{store.done.sum()} of {store.done.size} rows are kept in {store.path}: the same command goes on there"
        say("stopped; " + (kept if store.path is not None and store.done.any() else "nothing was written"))
        raise SystemExit(INTERRUPTED) from None


def _axes(case: Case, given: tuple[str, str, str | None], points: str, log: list[str]) -> tuple[Axis, ...]:
    """Return the axes of a map from what was typed."""
    from strikewave.base.errors import InputError
    from strikewave.studies.map.cells import Axis
    from strikewave.studies.map.study import axis_of, units_of

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
    return (*found, Axis(path, *units_of(path, values[0]), tuple(sorted(v.si for v in values))))


def _value(case: Case, path: str, text: str) -> Value:
    """Return a value of a setting as the case file would take it."""
    from strikewave.base.errors import InputError, nearest
    from strikewave.cases.case import dump_case, parse_case

    if path not in case.values():
        raise InputError(path, text, "a quantity of the case", nearest(path, case.values()))
    return parse_case(dump_case(case), case.name, [f"{path}={text.strip()}"]).values()[path]


def _points(text: str) -> tuple[int, int]:
    """Read 200x200, or 200 for both."""
    from strikewave.base.errors import InputError

    parts = text.lower().replace("×", "x").split("x")
    if len(parts) > 2 or not all(part.strip().isdecimal() and len(part.strip()) < 8 for part in parts):
        raise InputError("--points", text, "two whole numbers", "such as 200x200")
    numbers = [int(part) for part in parts]
    return numbers[0], numbers[-1]


def _share(text: str) -> float:
    """Read a share such as 2 % or 0.02."""
    from strikewave.base.errors import InputError

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
    from strikewave.base.errors import InputError

    if not 1 <= count <= 256:
        raise InputError("--workers", count, "1 to 256 processes", f"this machine has {os.cpu_count()} cores")
    return min(count, os.cpu_count() or 1)


def _words(plan: Plan, seconds: float, store: Store) -> str:
    """Return what is about to be run, in words."""
    panels, rows, columns = plan.shape
    size = f"{columns} x {rows}" + (f" x {panels}" if panels > 1 else "")
    left = 1.0 - float(store.done.mean())
    kept = f", {store.done.sum()} of {store.done.size} rows are there already" if store.done.any() else ""
    trains = f" and trains of {plan.train}" if plan.train else ""
    return f"{size} machines, {plan.blows} blows{trains}: about {max(left * seconds, 1.0):.0f} s on free cores{kept}"


def _write(study: MapStudy, folder: Path, mark: tuple[str, bool], colour: str) -> None:
    """Write the files of a map, all at once."""
    import json

    from strikewave.base.output_folder import whole_folder
    from strikewave.cases.case import dump_case
    from strikewave.reporting.style import save
    from strikewave.studies.map.figures import map_figure

    text, replace = mark
    with whole_folder(folder, text, replace) as place:
        (place / "case.toml").write_text(text, "utf-8")
        (place / "map.json").write_text(json.dumps(study.document(), allow_nan=False) + "\n", "utf-8")
        (place / "map.csv").write_text(study.table(), "utf-8")
        study.dataset().to_netcdf(place / "map.nc", engine="h5netcdf")
        figure = map_figure(study, colour)
        save(figure, place / "map.svg")
        save(figure, place / "map.png")
        if study.setting is not None:
            (place / "equal-blows.toml").write_text(dump_case(study.nearest_case()), "utf-8")


def _print(study: MapStudy) -> None:
    """Print what the map shows: shares of the regimes, why cells failed, the case, and the nearest even setting."""
    rows = [[name, f"{100.0 * share:.1f}"] for name, share in study.shares.items()]
    table("Regimes", ["regime", "cells (%)"], rows)
    for text, count in study.failures.items():
        say(f"no result, or no regime, in {count} cells: {text}")
    found = study.setting
    columns = ["", "case"] + ([] if found is None else [f"nearest within {100.0 * study.wanted:g} %"])
    shown = [_column(study, study.here, study.present)]
    if found is not None:
        shown.append(_column(study, found.values, found.cell))
    heads = [f"{a.path} ({a.unit or '1'})" for a in study.plan.axes] + [head for head, *_ in SHOWN]
    table(f"{study.case.name}: {study.plan.blows} blows", columns, list(zip(heads, *shown, strict=True)))
    for values, reason in study.refused:
        say(f"even by the fast run, but not in full: {_at(study.plan.axes, values)}: {reason}")
    if found is None:
        say(_none_found(study))
        return
    full = f"a full run has a CV of {100.0 * found.cv:.3g} % and a mean peak of {number(found.peak, *_PEAK, 5)} g"
    if found.distance == 0.0:
        say(f"the case has even blows already: {full}")
    else:
        say(f"the nearest is {found.distance:.3g} away in relative steps; {full}")


def _none_found(study: MapStudy) -> str:
    """Return why there is no even setting, in words."""
    limit, even = f"{100.0 * study.wanted:g} %", len(study.even_settings())
    if not even:
        return f"no setting of this map has blows that all come with a CV within {limit}"
    tried = f"the {len(study.refused)} nearest of them" if even > len(study.refused) else "all of them"
    return f"{even} settings have a CV within {limit} by the fast run; {tried} failed in full runs"


def _at(axes: tuple[Axis, ...], values: tuple[float, ...]) -> str:
    return ", ".join(f"{axis.path} = {axis.typed(value)}" for axis, value in zip(axes, values, strict=True))


def _column(study: MapStudy, values: tuple[float, ...], cell: dict[str, float]) -> list[str]:
    """Return a column of the table of settings."""
    shown = [f"{axis.shown(value):.5g}" for axis, value in zip(study.plan.axes, values, strict=True)]
    return shown + [number(cell[key], si, unit, 3 if unit == "%" else 5) for _, key, si, unit in SHOWN]
