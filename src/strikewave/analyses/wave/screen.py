"""A run of a stack under its load as a command: solve, print, draw."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from strikewave.analyses.layered_bars import MOST_LAYERS, fit_tables, loss_tables
from strikewave.analyses.wave.result import error_words, wave_tables, wave_words
from strikewave.analyses.wave.run import WaveSolution, run_wave, with_bands
from strikewave.base.compiling import compiling_shown
from strikewave.base.errors import MISSING, InputError
from strikewave.base.shock_quantities import MICROSECONDS
from strikewave.cases.case import Case, dump_case
from strikewave.reporting.faces import amount, face_columns, face_rows
from strikewave.reporting.output_options import Output
from strikewave.reporting.run_and_write import Command, case_folder, run_and_write
from strikewave.reporting.terminal import print_bands, print_rows, progress_bar, report_table, say_compiling, tell


def run_wave_case(
    case: Case, changes: Sequence[str], output: Output, field: str = "stress", animate: bool = False, band: bool = True
) -> int:
    """Run a stack under its load, write and print its result, and return the exit code.

    ``field`` is what the pictures along the stack show: stress, force or velocity.
    """
    output.check_animation(animate)
    if not case.stack.layer:
        hint = f"this case has none: `strikewave {case.command}` runs it"
        raise InputError("stack.layer", MISSING, "at least one [[stack.layer]]", hint)
    case = output.tested(case)
    text = dump_case(case)
    return run_and_write(WaveCommand(case, field, animate, band), output, case_folder(case.name, text, changes), text)


@dataclass(frozen=True)
class WaveCommand(Command[WaveSolution]):
    """A run of a stack under its load."""

    indent: ClassVar[int | None] = None

    case: Case
    field: str = "stress"
    animate: bool = False
    band: bool = True

    def solve(self) -> WaveSolution:
        """Return the solution, with a bar on stderr while its bands are found."""
        with compiling_shown(None if sys.stderr.isatty() else say_compiling):
            solution = run_wave(self.case)
        if not self.band:
            return solution
        with progress_bar("band") as report:
            return with_bands(solution, report)

    def summary(self, result: WaveSolution) -> str:
        """Return the peak values at the taps in words."""
        return wave_words(result)

    def show(self, result: WaveSolution) -> None:
        """Print the tables of a run."""
        show(result)

    def draw(self, result: WaveSolution, folder: Path) -> list[str]:
        """Write page and pictures, and the animation, which takes a few seconds."""
        from strikewave.analyses.wave.report import draw_result

        return draw_result(result, folder, self.field, self.animate)


def show(solution: WaveSolution) -> None:
    """Print the largest values at the taps, the layers, joints and sensors of a stack, and how exact they are."""
    stack = solution.run.stack
    name, transit = solution.case.name, amount(MICROSECONDS, stack.transit)
    tell(f"{name}: {len(stack.layers)} layers, {stack.mass:.4g} kg, transit {transit}", "  ")
    print_rows(f"{solution.title}: largest values at the taps", face_columns(solution, "tap_histories"))
    if solution.method != "spectral":
        more = len(stack.layers) - MOST_LAYERS
        title = "Layers as the time step makes them" + (f" ({more} more in the JSON)" if more > 0 else "")
        rows = face_rows(solution, "layers")[:MOST_LAYERS]
        print_rows(title, face_columns(solution, "layers", "lengths", rows=rows), detail=True)
    for shown in (*fit_tables(solution.losses), *wave_tables(solution)):
        report_table(shown)
    if solution.channels:
        print_rows("What the sensors read", face_columns(solution, "sensors"))
        for shown in loss_tables(solution.channels):
            report_table(shown)
    print_bands(solution, solution.figures)
    tell(error_words(solution))
    tell("balance: " + ", ".join(check.words for check in solution.balance_checks))
