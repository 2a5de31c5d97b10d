"""A run of a machine as a command: solve, print, draw."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from strikewave.analyses.machine.kind import kind_of
from strikewave.analyses.machine.result import (
    ANSWERS_CALLED,
    LineCollision,
    Solution,
    answer_columns,
    blow_columns,
    restitution_words,
    settings,
    summary_words,
)
from strikewave.analyses.machine.run import band_compiled_beside, band_runs_beside, run_case, with_bands
from strikewave.cases.case import Case, dump_case
from strikewave.cases.stack_of_case import build_channels, fitted_losses
from strikewave.reporting.faces import columns_of, text_of
from strikewave.reporting.output_options import Output
from strikewave.reporting.run_and_write import Command, case_folder, run_and_write
from strikewave.reporting.terminal import (
    print_bands,
    print_face,
    print_published,
    print_rows,
    progress_bar,
    report_table,
    tell,
)


def run_machine_case(
    case: Case, changes: Sequence[str], output: Output, animate: bool = False, band: bool = True
) -> int:
    """Run a machine case, write and print its result, and return the exit code."""
    output.check_animation(animate)
    case = output.tested(case)
    text = dump_case(case)
    usual = case_folder(case.name, text, changes)
    return run_and_write(MachineCommand(case, animate, band, output.writes(usual)), output, usual, text)


@dataclass(frozen=True)
class MachineCommand(Command[Solution]):
    """A run of a machine case, with the machine in motion where that is wanted."""

    case: Case
    animate: bool = False
    band: bool = True
    files: bool = True

    def solve(self) -> Solution:
        """Return the solution, with a bar on stderr."""
        if not self.band:
            with progress_bar("blows") as report:
                return run_case(self.case, report)
        with band_runs_beside(self.case) as runs:
            with band_compiled_beside(self.case), progress_bar("blows") as report:
                solution = run_case(self.case, report)
            if self.files:
                importlib.import_module("strikewave.analyses.machine.report")  # long, and the runs go on meanwhile
            with progress_bar("band") as report:
                return with_bands(solution, report, runs())

    def summary(self, result: Solution) -> str:
        """Return the summary in words."""
        return summary_words(result)

    def show(self, result: Solution) -> None:
        """Print the tables of a run."""
        show(result)

    def draw(self, result: Solution, folder: Path) -> list[str]:
        """Write page and summary, and the machine in motion, which takes some seconds."""
        from strikewave.analyses.machine.report import draw_result

        return draw_result(result, folder, self.animate)


def show(solution: Solution) -> None:
    """Print the settings, the blows, the waves, the contact, published numbers and the balance of a run."""
    tell(f"{solution.case.name}: {', '.join(settings(solution))}", "  ")
    print_rows(solution.title, blow_columns("blows", solution.blows, solution.band))
    print_bands(solution, solution.figures)
    _print_waves(solution)
    print_rows("Contact, blow by blow", blow_columns("contact", solution.struck), detail=True)
    if solution.contact is not None:
        if solution.contact.differ:
            print_rows(ANSWERS_CALLED, answer_columns(solution.contact, solution.band))
        tell(restitution_words(solution.contact))
    if solution.slides:
        title = "Nose across the face; the object's guide bears the side force"
        print_rows(title, blow_columns("sliding", solution.struck), detail=True)
    print_published(solution.comparisons)
    if solution.collisions:
        print_rows("Collisions in the line, by restitution alone", columns_of(LineCollision, solution.collisions))
    tell("")
    law, speed = kind_of(solution.case).reference_law, text_of(solution.reference, "approach_speed")
    alone = f"if nothing but the contact gave way ({law} on a rigid object, at the nominal {speed})"
    tell(f"{alone}, the pulse would be {solution.reference.words}")
    values = solution.case.with_stale_fits_assumed().values()
    fitted = [f"{path} = {value.typed}" for path, value in values.items() if value.provenance == "fitted"]
    if fitted:
        tell("fitted: " + ", ".join(fitted))
    tell("balance: " + ", ".join([check.words for check in solution.balance_checks]))


def _print_waves(solution: Solution) -> None:
    """Print the readings of taps and sensors, blow by blow, and the insertion loss of the buffers."""
    if not (solution.wave_blows or solution.sensor_rows):
        return
    for row in solution.wave_blows[:1]:
        stated = f"total and wave at {text_of(row.reading, 'bandwidth')}"
        print_face(solution, "wave_blows", f"Peak accelerations, route {solution.route}, {stated}", "waves")
    print_face(solution, "sensor_rows", "What the sensors read")
    setup = solution.waves
    if setup is not None:
        tell(
            f"waves: time step {text_of(setup, 'step')}, which changes a layer's length by "
            f"{setup.mismatch:.1e} of it at most (layer by layer in the report)"
        )
    from strikewave.analyses.layered_bars import fit_tables, loss_tables

    for shown in (*loss_tables(build_channels(solution.case)), *fit_tables(fitted_losses(solution.case))):
        report_table(shown)
