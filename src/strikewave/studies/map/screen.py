"""A map as a command: run its cells, print, draw."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from strikewave.reporting.measured_files import asked
from strikewave.reporting.options.output import Output
from strikewave.reporting.run_and_write import case_folder, drawing, run_and_write
from strikewave.reporting.terminal import progress_bar, report_table, say, tell
from strikewave.studies.command import ResumableCommand
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.runner import StudyProgress, finished_before
from strikewave.studies.engine.store import RunStore
from strikewave.studies.map.cells import MapPlan
from strikewave.studies.map.study import MapStudy, make_map, marked_text


def run_map(plan: MapPlan, name: str, changes: Sequence[str], command: MapCommand, output: Output) -> int:
    """Make a map, write and print it, and return the exit code.

    Raises
    ------
    InputError
        If the place is taken.
    """
    usual = f"map-{case_folder(name, plan.case, changes)}"
    return run_and_write(command, output, usual, marked_text(plan, command.wanted))


@dataclass
class MapCommand(ResumableCommand[MapStudy]):
    """A map; one that is stopped goes on where it was.

    Attributes
    ----------
    plan : MapPlan
        What is mapped.
    wanted : float
        Coefficient of variation below which blows count as even.
    pool : Pool
        Who runs it.
    seconds : float
        About how long it takes.
    colour : str
        What the picture shows.
    """

    plan: MapPlan
    wanted: float
    pool: Pool
    seconds: float
    colour: str

    def solved(self, store: RunStore) -> MapStudy:
        """Return the map, with a bar on stderr; where it is stopped, finished cells are kept, and said to be."""
        rows = self.plan.rows
        done = finished_before(self.plan.job, rows, store)
        say(_words(self.plan, self.seconds, done))

        def advance(now: StudyProgress) -> None:
            report(now.share, now.words)

        try:
            with progress_bar("map", done / len(rows), ("left",)) as report:
                study = make_map(self.plan, self.wanted, store=store, progress=advance, pool=self.pool)
        except KeyboardInterrupt as stop:
            done = finished_before(self.plan.job, rows, store)
            self.stopped(stop, store, f"{done} of {len(rows)} cells" if done else "")
        return dataclasses.replace(study, asked=asked())

    def summary(self, result: MapStudy) -> str:
        """Say what the blows are like, and where the nearest equal ones are."""
        from strikewave.studies.map.report import map_words

        return map_words(result)

    def show(self, result: MapStudy) -> None:
        """Print regimes, the case, and the nearest even setting."""
        _print(result)

    def draw(self, result: MapStudy, folder: Path) -> list[str]:
        """Write the page, and the picture in two formats."""
        from strikewave.reporting.style import save
        from strikewave.studies.map.figures import map_figure
        from strikewave.studies.map.report import map_report

        figure = map_figure(result, self.colour)
        with drawing(folder / "map.svg") as path:
            save(figure, path)
        with drawing(folder / "map.png") as path:
            save(figure, path)
        with drawing(folder / "report.html") as path:
            path.write_text(map_report(result, self.colour), "utf-8", newline="\n")
        return ["report.html", "map.svg", "map.png"]


def _words(plan: MapPlan, seconds: float, done: int) -> str:
    """Return what is about to be run, in words."""
    panels, rows, columns = plan.shape
    size = f"{columns} x {rows}" + (f" x {panels}" if panels > 1 else "")
    cells = panels * rows * columns
    left = 1.0 - done / cells
    stored = f", {done} of {cells} cells are there already" if done else ""
    trains = f" and trains of {plan.train}" if plan.train else ""
    return f"{size} machines, {plan.blows} blows{trains}: about {max(left * seconds, 1.0):.0f} s on free cores{stored}"


def _print(study: MapStudy) -> None:
    """Print what the map shows: shares of the regimes, why cells failed, the case, and the nearest even setting."""
    from strikewave.studies.map.report import regime_table, setting_table

    report_table(regime_table(study))
    for text, count in study.failures.items():
        tell(f"no result, or no regime, in {count} cells: {text}")
    report_table(setting_table(study, f"{study.case.name}: {study.plan.blows} blows"))
    for one in study.refused:
        tell(f"even by the fast run, but not in full: {one.setting}: {one.why}")
