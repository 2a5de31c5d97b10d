"""``strikewave wave``: run a stack alone under its load."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from strikewave.reporting.run_and_write import Work, carry_out
from strikewave.reporting.terminal import (
    CaseName,
    Changes,
    Force,
    Json,
    Out,
    number,
    print_fits,
    print_losses,
    progress_bar,
    say,
    say_compiling,
    table,
)

if TYPE_CHECKING:
    from strikewave.analyses.wave.run import BarSolution
    from strikewave.cases.case import Case


def command(
    case: CaseName,
    changes: Changes = None,
    field: Annotated[
        str, typer.Option("--field", help="What the pictures along the stack show: stress, force or velocity.")
    ] = "stress",
    animate: Annotated[bool, typer.Option("--animate", help="Write animation.html and animation.gif too.")] = False,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Run a stack of layers under a load: force, stress, velocity and acceleration at its taps.

    With --json, files are written only where --out says.
    """
    from strikewave.base.errors import InputError, nearest
    from strikewave.reporting.wave_field import QUANTITIES

    if field not in QUANTITIES:
        raise InputError("--field", field, "one of " + ", ".join(QUANTITIES), nearest(field, QUANTITIES))
    if animate and json and out is None:
        raise InputError("--animate", "--json without --out", "a folder for the animation", "add --out DIR")
    files = "report.html, summary.svg, field.svg, waves.nc, taps.csv, case.toml"
    files += ", animation.html, animation.gif" if animate else ""
    write = functools.partial(write_result, quantity=field, animate=animate)
    return carry_out(Work(_solve, write, _print, files, indent=None), case, changes, out, force, json)


def _solve(case: Case) -> BarSolution:
    from strikewave.analyses.wave.run import run_wave
    from strikewave.base.errors import MISSING, InputError

    if not case.stack.layer:
        hint = f"this case has none: `strikewave {case.command}` runs it"
        raise InputError("stack.layer", MISSING, "at least one [[stack.layer]]", hint)
    say_compiling()
    return run_wave(case)


def write_result(
    solution: BarSolution, place: Path, text: str, quantity: str = "stress", animate: bool = False
) -> None:
    """Write the files of a result into a folder; ``quantity`` is what the pictures along the stack show."""
    from strikewave.analyses.wave.field import bar_field
    from strikewave.analyses.wave.figures.summary import bar_summary
    from strikewave.analyses.wave.report import bar_report
    from strikewave.reporting.style import save
    from strikewave.reporting.wave_field import xt_diagram

    solution.save(place / "waves.nc")
    (place / "taps.csv").write_text(solution.table(), "utf-8")
    (place / "case.toml").write_text(text, "utf-8")
    save(bar_summary(solution), place / "summary.svg")
    save(xt_diagram(bar_field(solution), quantity), place / "field.svg")
    (place / "report.html").write_text(bar_report(solution, quantity), "utf-8", newline="\n")
    if animate:
        _animate(solution, place)


def _animate(solution: BarSolution, place: Path) -> None:
    """Write the animation as a page and as a GIF, which takes a few seconds."""
    from strikewave.analyses.wave.field import bar_field
    from strikewave.analyses.wave.figures.animation import animation_page, write_gif

    field = bar_field(solution)
    page = animation_page(field, solution.title, solution.case.name)
    (place / "animation.html").write_text(page, "utf-8", newline="\n")
    with progress_bar("animation.gif", clocks=("left",)) as report:
        write_gif(field, solution.title, place / "animation.gif", report)


def _print(solution: BarSolution) -> None:
    from strikewave.analyses.wave.report import bar_tables, error_words, tap_rows
    from strikewave.reporting.stack_chapters import MOST_LAYERS

    stack = solution.run.stack
    say(f"{solution.case.name}: {len(stack.layers)} layers, {stack.mass:.4g} kg, transit {stack.transit * 1e6:.4g} us")
    columns = ["tap", "route", "layer", "position", "force (kN)", "stress (MPa)", "velocity (m/s)", "acceleration (g)"]
    rows = [[str(cell) for cell in row] for row in tap_rows(solution)]
    table(f"{solution.title}: largest values at the taps", columns, rows, left=3)
    used = [
        [
            layer.name,
            number(layer.length_asked, "m", "mm", 7),
            number(layer.length_used, "m", "mm", 7),
            str(layer.steps),
        ]
        for layer in solution.waves.layers[:MOST_LAYERS]
    ]
    if solution.method != "spectral":
        more = len(stack.layers) - MOST_LAYERS
        title = "Layers as the time step makes them" + (f" ({more} more in the JSON)" if more > 0 else "")
        table(title, ["layer", "asked (mm)", "used (mm)", "steps"], used)
    print_fits(solution.losses)
    for caption, columns, rows in bar_tables(solution):
        table(caption, columns, rows)
    if solution.channels:
        read = [
            [
                name,
                number(pulse.peak, "m/s^2", "g", 5),
                number(pulse.width, "s", "us", 4),
                "yes" if pulse.clipped else "no",
            ]
            for name, pulse in solution.sensors.items()
        ]
        table("What the sensors read", ["sensor", "peak (g)", "width (us)", "clipped"], read)
        print_losses(solution.channels)
    say(error_words(solution))
    say(f"ledger: momentum {solution.run.momentum_error:.1e} (limit 1e-6)")
    for notice in solution.warnings:
        say(f"warning [{notice.code}]: {notice.message}")
