"""``strikewave wave``: run a stack alone under its load."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from strikewave.cli.carry_out import Work, carry_out
from strikewave.cli.common import CaseName, Changes, Force, Json, Out, number, print_losses, say, table

if TYPE_CHECKING:
    from strikewave.bar import BarSolution
    from strikewave.case import Case


def command(case: CaseName, changes: Changes = None, out: Out = None, force: Force = False, json: Json = False) -> int:
    """Run a stack of layers under a load: force, stress, velocity and acceleration at its taps.

    With --json, files are written only where --out says.
    """
    files = "report.html, summary.svg, waves.nc, taps.csv, case.toml"
    return carry_out(Work(_solve, write_result, _print, files, indent=None), case, changes, out, force, json)


def _solve(case: Case) -> BarSolution:
    from strikewave.bar import run_wave
    from strikewave.compiled import is_cold

    if is_cold():
        say("compiling the kernels: once after install, about 20 s")
    return run_wave(case)


def write_result(solution: BarSolution, place: Path, text: str) -> None:
    """Write the files of a result into a folder."""
    from strikewave.figures import save
    from strikewave.figures.bar import bar_summary
    from strikewave.report import bar_report

    solution.save(place / "waves.nc")
    (place / "taps.csv").write_text(solution.table(), "utf-8")
    (place / "case.toml").write_text(text, "utf-8")
    save(bar_summary(solution), place / "summary.svg")
    (place / "report.html").write_text(bar_report(solution), "utf-8", newline="\n")


def _print(solution: BarSolution) -> None:
    from strikewave.report.wave_chapters import error_words, tap_rows

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
        for layer in solution.waves.layers
    ]
    table("Layers as the time step makes them", ["layer", "asked (mm)", "used (mm)", "steps"], used)
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
