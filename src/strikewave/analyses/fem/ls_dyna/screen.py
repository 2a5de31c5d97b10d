"""Command of a run of LS-DYNA: read, compare with a run of strikewave, print, draw."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from strikewave.analyses.fem.ls_dyna.report import (
    contact_table,
    draw_result,
    energy_table,
    field_table,
    ls_dyna_words,
    pair_table,
)
from strikewave.analyses.fem.ls_dyna.result import LsDynaResult, folder_name
from strikewave.base.shock_quantities import MICROSECONDS
from strikewave.exchange.ls_dyna.comparison import RunComparison, compare_runs, read_strikewave
from strikewave.exchange.ls_dyna.folder import read_folder
from strikewave.exchange.units import UnitSystem
from strikewave.reporting import measured_files as measured
from strikewave.reporting.faces import amount
from strikewave.reporting.output_options import Output
from strikewave.reporting.run_and_write import Command, run_and_write
from strikewave.reporting.terminal import case_hash, number, report_table, tell


@dataclass(frozen=True)
class LsDynaCommand(Command[LsDynaResult]):
    """A run of LS-DYNA, alone or compared with one of strikewave."""

    folder: Path
    system: UnitSystem
    other: Path | None
    contacts: dict[str, int]
    parts: dict[str, int]
    test: Mapping[str, str]

    def solve(self) -> LsDynaResult:
        """Return both runs and their differences."""
        ours = None if self.other is None else read_strikewave(self.other)
        theirs = read_folder(self.folder, self.system)
        comparison = compare_runs(theirs, ours, self.contacts, self.parts) if ours else RunComparison(theirs)
        read = [*theirs.files, *([ours.folder / "histories.nc", ours.folder / "field.vtkhdf"] if ours else [])]
        origin = measured.source_of("records", folder_name(self.folder), read, self.test)
        return LsDynaResult(comparison, origin=origin, notices=comparison.warnings)

    def summary(self, result: LsDynaResult) -> str:
        """Return the force of the contact, and its difference, in a sentence."""
        return ls_dyna_words(result)

    def show(self, result: LsDynaResult) -> None:
        """Print contacts, energies, fields and differences."""
        theirs = result.runs.ls_dyna
        first, last = number(theirs.span[0], *MICROSECONDS.units), amount(MICROSECONDS, theirs.span[1])
        solids = f"; {len(theirs.fields.mesh.hexahedra)} solids, {theirs.frames} states" if theirs.fields else ""
        tell(f"read: {', '.join(path.name for path in theirs.files)}; from {first} to {last}{solids}")
        for pair in result.runs.forces:
            report_table(pair_table(pair))
        for run_table in (contact_table(result), energy_table(result), field_table(result.runs)):
            if run_table.rows:
                report_table(run_table, keys=2)

    def draw(self, result: LsDynaResult, folder: Path) -> list[str]:
        """Write page and picture."""
        return draw_result(result, folder)


def read_run(command: LsDynaCommand, output: Output) -> int:
    """Read a run of LS-DYNA, write and print its result, and return the exit code."""
    other = str(command.other.resolve() if command.other else "")
    asked = repr((str(command.folder.resolve()), command.system.name, other, [command.contacts, command.parts]))
    usual = f"ls-dyna-{folder_name(command.folder)}{case_hash(asked, [asked])}"
    return run_and_write(command, output, usual, None)
