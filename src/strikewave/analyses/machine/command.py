"""``strikewave run``: run a machine case and write its result."""

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
    fixed,
    number,
    print_fits,
    print_losses,
    print_published,
    progress_bar,
    say,
    table,
)

if TYPE_CHECKING:
    from strikewave.analyses.machine.result import Solution
    from strikewave.cases.case import Case


def command(
    case: CaseName,
    changes: Changes = None,
    animate: Annotated[
        bool, typer.Option("--animate", help="Write machine.html and machine.gif too: the machine in motion.")
    ] = False,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Run a machine case: table of blows, published beside computed, files in out/CASE.

    With --json, files are written only where --out says.
    """
    from strikewave.base.errors import InputError

    if animate and json and out is None:
        raise InputError("--animate", "--json without --out", "a folder for the animation", "add --out DIR")
    files = "report.html, summary.svg, solution.nc, blows.csv, case.toml"
    files += ", machine.html, machine.gif" if animate else ""
    write = functools.partial(write_result, animate=animate)
    return carry_out(Work(_solve, write, _print, files), case, changes, out, force, json)


def write_result(solution: Solution, place: Path, text: str, animate: bool = False) -> None:
    """Write the files of a result into a folder."""
    from strikewave.analyses.machine.figures.summary import summary
    from strikewave.analyses.machine.report import report
    from strikewave.reporting.style import save

    solution.save(place / "solution.nc")
    (place / "blows.csv").write_text(solution.table(), "utf-8")
    (place / "case.toml").write_text(text, "utf-8")
    save(summary(solution), place / "summary.svg")
    moving = _animate(solution, place) if animate else ""
    (place / "report.html").write_text(report(solution, moving=moving), "utf-8", newline="\n")


def _animate(solution: Solution, place: Path) -> str:
    """Write the machine in motion as a page and as a GIF, which takes some seconds; return the name of the page."""
    from strikewave.analyses.machine.figures.animation import machine_page, write_machine_gif

    page = machine_page(solution)
    if page is None:
        say("no animation: only the rotary machine can be shown in motion")
        return ""
    (place / "machine.html").write_text(page, "utf-8", newline="\n")
    with progress_bar("machine.gif", clocks=("left",)) as report:
        write_machine_gif(solution, place / "machine.gif", report)
    return "machine.html"


def _solve(case: Case) -> Solution:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("starting", total=1.0)
        from strikewave.analyses.machine.run import run_case
        from strikewave.base.compiled import is_cold

        if is_cold():
            progress.console.print("compiling the kernels: once after install, about 20 s", highlight=False)

        def report(share: float) -> None:
            progress.update(task, completed=share, description="blows")

        return run_case(case, report)


def _print(solution: Solution) -> None:
    from strikewave.analyses.machine.columns import shown_in
    from strikewave.analyses.machine.words import reference_law
    from strikewave.reporting.numbers import heads

    columns = shown_in("blows")
    rows = [
        [str(b.index), b.kind, *(fixed(getattr(b, n), si, unit, d) for n, si, unit, d in columns), str(b.contacts)]
        for b in solution.blows
    ]
    say(_header(solution))
    table(solution.title, ["#", "kind", *heads(columns), "contacts"], rows, left=2)
    columns, struck = shown_in("contact"), [blow for blow in solution.blows if blow.kind != "missed"]
    rows = [[str(b.index), *(fixed(getattr(b, n), si, unit, d) for n, si, unit, d in columns)] for b in struck]
    table("Contact, blow by blow", ["#", *heads(columns)], rows)
    _print_waves(solution)
    print_published(solution.published)
    _print_collisions(solution)
    r = solution.reference
    pulse = (
        number(r.duration, "s", "us", 3) + " us",
        number(r.peak_force, "N", "kN", 3) + " kN",
        number(r.peak_acceleration, "m/s^2", "g", 3) + " g",
    )
    say(
        f"for comparison: {reference_law(solution.case)} on a rigid object, at the nominal {r.approach_speed:.3g} m/s "
        f"and with no frame or mount to bend: {', '.join(pulse)}"
    )
    fitted = solution.case.fitted_fields()
    if fitted:
        values = solution.case.values()
        say("fitted: " + ", ".join(f"{path} = {values[path].typed}" for path in fitted))
    ledger = solution.ledger
    say(f"ledger: energy {ledger['energy_error']:.1e}, momentum {ledger['momentum_error']:.1e} (limit 1e-6)")
    for notice in solution.warnings:
        say(f"warning [{notice.code}]: {notice.message}")


def _print_waves(solution: Solution) -> None:
    """Print what taps and sensors show of each blow, and the insertion loss of the buffers."""
    from strikewave.cases.losses_of_case import fitted_losses
    from strikewave.cases.sensors_of_case import build_channels

    found = [(blow, reading) for blow, reading in zip(solution.blows, solution.readings, strict=True) if reading]
    names = [sensor.name for sensor in solution.case.sensor]
    if not found or not (solution.waves or names):
        return
    band = found[0][1].bandwidth
    stated = "" if band is None else f", total and wave at {number(band, 'Hz', 'kHz', 3)} kHz"
    rows = []
    for blow, reading in found:
        peaks = [blow.rigid_peak, reading.total_peak, reading.wave_peak] if solution.waves else [blow.rigid_peak]
        cells = [number(peak, "m/s^2", "g", 5) for peak in peaks]
        for name in names:
            pulse = reading.sensors[name]
            cells.append(number(pulse.peak, "m/s^2", "g", 5) + (" clipped" if pulse.clipped else ""))
        rows.append([str(blow.index), *cells])
    waves = ["rigid (g)", "total (g)", "wave (g)"] if solution.waves else ["rigid (g)"]
    title = f"Peak accelerations, route {solution.case.solver.route}{stated}"
    setup = solution.waves
    if setup is not None:
        say(
            f"waves: time step {setup.step * 1e9:.4g} ns, which changes a layer's length by {setup.mismatch:.1e} of it "
            "at most (layer by layer in the report)"
        )
    table(title, ["#", *waves, *(f"sensor {name} (g)" for name in names)], rows, left=0)
    print_losses(build_channels(solution.case))
    print_fits(fitted_losses(solution.case))


def _header(solution: Solution) -> str:
    """Return the main settings in one line."""
    from strikewave.analyses.machine.words import settings

    return f"{solution.case.name}: " + ", ".join(settings(solution))


def _print_collisions(solution: Solution) -> None:
    """Print the collisions of the bodies of an amplifier."""
    from strikewave.analyses.machine.words import COLLISION_HEADS, collision_rows

    if solution.collisions:
        table("Collisions in the line, by restitution alone", COLLISION_HEADS, collision_rows(solution), left=3)
