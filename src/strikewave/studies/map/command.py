"""``strikewave map``: how even a machine's blows are over two of its settings, and where they are even nearest."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Annotated

import typer

from strikewave.reporting.terminal import CaseName, Changes, Force, Json, Out

if TYPE_CHECKING:
    from strikewave.base.quantities import Value
    from strikewave.cases.case import Case
    from strikewave.studies.map.cells import Axis

X, Y = "machine.speed", "object.spring"
"""What stands along the axes unless said otherwise."""
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
    from strikewave.cases.case import load_case
    from strikewave.reporting.run_and_write import Output
    from strikewave.studies.map.figures import check_colour
    from strikewave.studies.map.screen import MapCommand, run_map
    from strikewave.studies.map.study import check_plan, plan_of

    check_colour(colour)
    loaded = load_case(case, changes or ())
    plan = plan_of(loaded, _axes(loaded, (x, y, panels), points, log or []), blows, train)
    wanted, count = _share(want_cv), _workers(workers)
    making = MapCommand(plan, wanted, count, check_plan(plan, count), colour, fresh)
    return run_map(plan, loaded.name, changes or (), making, Output(out, force, json))


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
