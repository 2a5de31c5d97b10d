"""Commands of studies: their runs are made with a bar, and one that is stopped goes on where it was."""

from __future__ import annotations

import contextlib
import dataclasses
import shutil
from abc import abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar, NoReturn, TypeVar

from strikewave.base.documents import head, plain
from strikewave.base.errors import InputError, StrikewaveError
from strikewave.base.processes import exit_code
from strikewave.cases.case import Case, dump_case
from strikewave.reporting.measured_files import asked
from strikewave.reporting.output_options import Output
from strikewave.reporting.run_and_write import Command, case_folder, drawing, run_and_write
from strikewave.reporting.shown_result import ShownResult
from strikewave.reporting.terminal import print_json, progress_bar, say, tell
from strikewave.studies.engine.plan import StudyPlan
from strikewave.studies.engine.pools import Pool
from strikewave.studies.engine.store import RunStore, begin_from, runs_beside
from strikewave.studies.study import Study

Shown = TypeVar("Shown", bound=ShownResult)
Made = TypeVar("Made", bound=Study)
Report = Callable[..., None]
"""Function that moves a progress bar, by the share of the runs that is done and words beside it."""


@dataclass(kw_only=True)
class ResumableCommand(Command[Shown]):
    """A study that keeps its finished runs beside the result until that is written, or in a folder of their own.

    Attributes
    ----------
    place : Path or None
        Folder that keeps finished runs for good; None for one beside the result, till that is written.
    fresh : bool
        True if finished runs of a stopped study are run anew.
    """

    indent: ClassVar[int | None] = None
    formats: ClassVar[tuple[str, ...]] = ("svg",)
    """File formats of its picture, by their endings."""

    place: Path | None = None
    fresh: bool = False
    store: RunStore | None = field(default=None, init=False)

    @abstractmethod
    def solved(self, store: RunStore) -> Shown:
        """Return the study, with a bar on stderr; where it is stopped, end with `stopped`."""

    def draw(self, result: Shown, folder: Path) -> list[str]:
        """Write page and picture, those that the result shows in Python."""
        from strikewave.reporting.style import save

        names = [f"{result.command}.{ending}" for ending in self.formats]
        figure = None
        for name in names:
            with drawing(folder / name) as path:
                figure = figure or result.plot()
                save(figure, path)
        with drawing(folder / "report.html") as path:
            result.report(path)
        return ["report.html", *names]

    @contextlib.contextmanager
    def under_way(self, folder: Path) -> Iterator[None]:
        """Keep finished runs beside the folder until all is written, or in a folder of their own.

        A finished study that is asked again begins with the runs that its result keeps, so that none is made.
        """
        self.store = self._beside(folder) if self.place is None else self._opened(self.place)
        with self.store:
            try:
                yield
            except BaseException as error:
                refused = isinstance(error, StrikewaveError) and self.store.fruitless  # as nothing can be run
                if self.place is None and (self.store.empty or refused):
                    self.store.remove()
                raise
            if self.place is None:
                self.store.remove()

    def _beside(self, folder: Path) -> RunStore:
        """Return the store beside a result, with the finished runs that this keeps unless they are to be made anew."""
        beside = runs_beside(folder.absolute())
        if self.fresh or not begin_from(folder, beside):
            return self._opened(beside)
        try:
            store = self._opened(beside)
        except InputError:  # of another version, or damaged: as if there were none
            shutil.rmtree(beside, ignore_errors=True)
            return self._opened(beside)
        say(f"read: {len(store.known())} finished runs of {folder}; --fresh makes them anew")
        return store

    def hand_over(self, result: Shown, folder: Path) -> list[str]:
        """Copy the finished runs into the folder, where the same question finds them."""
        return self._with_runs(folder, [])

    def _with_runs(self, folder: Path, handed_over: list[str]) -> list[str]:
        """Return names of files that were handed over, and that of the finished runs, which are copied there."""
        if self.store is None or self.place is not None:
            return handed_over
        return [*handed_over, *self.store.copy_into(folder, handed_over)]

    def solve(self) -> Shown:
        """Return the study; its runs are kept for as long as it takes where nothing is written."""
        if self.store is not None:
            return self.solved(self.store)
        with self._opened(self.place) as store:
            return self.solved(store)

    def stopped(self, stop: KeyboardInterrupt, store: RunStore, finished: str) -> NoReturn:
        """Say what of a stopped study is kept, such as "12 of 20 runs", and exit; empty where none has finished.

        What is finished is counted in the store: a batch may be kept there before its progress is reported.
        """
        where = f"{finished} are kept in {store.folder}: the same command goes on there"
        say("stopped; " + (where if finished and self.store is not None else "nothing was written"))
        raise SystemExit(exit_code(stop)) from None

    def stopped_after(self, stop: KeyboardInterrupt, store: RunStore, what: str = "runs") -> NoReturn:
        """Say how many runs of a stopped study are kept, and exit."""
        count = len(store.known())
        self.stopped(stop, store, "" if store.empty else f"{count} {what}" if count else "states of runs")

    def _opened(self, folder: Path | None) -> RunStore:
        return RunStore(folder, self.fresh, option="--out" if self.place is None else "--store")


@dataclass
class StudyCommand(ResumableCommand[Made]):
    """A plan that is carried out on a case.

    Attributes
    ----------
    case : Case
        Case that is run.
    plan : object
        Plan of the study.
    pool : Pool
        Pool that runs the study.
    """

    name: ClassVar[str]
    """Name of the command."""
    bar: ClassVar[str] = "runs"
    """Text before the bar."""
    clocks: ClassVar[tuple[str, ...]] = ("elapsed", "left")
    """Times beside the bar; see `progress_bar`."""
    noun: ClassVar[str] = "runs"
    """Name of the counted items."""

    case: Case
    plan: Any
    pool: Pool

    @property
    @abstractmethod
    def marked_text(self) -> str:
        """The case as text, and above it what is asked."""

    @abstractmethod
    def made(self, store: RunStore, report: Report) -> Made:
        """Return the study; runs that a store has are not made again."""

    def announced(self, store: RunStore) -> float:
        """Say what is about to be run, and return the share of it that a store has."""
        return 0.0

    def finished(self, store: RunStore) -> str:
        """Say what of it a store has, such as "12 of 20 runs"; empty where that is nothing."""
        if isinstance(self.plan, StudyPlan):
            done = self.plan.known(store)
            return f"{done} of {len(self.plan.rows)} {self.plan.noun}" if done else ""
        return f"{len(store.known())} {self.noun}" if store.known() else ""

    def solved(self, store: RunStore) -> Made:
        """Return the study, with a bar on stderr; where it is stopped, finished runs are kept, and said to be."""
        begun = self.announced(store)
        try:
            with progress_bar(self.bar, begun, self.clocks) as report:
                study = self.made(store, report)
        except KeyboardInterrupt as stop:
            self.stopped(stop, store, self.finished(store))
        return dataclasses.replace(study, asked=asked())

    def usual_folder(self, changes: Sequence[str]) -> str:
        """Return the folder of the result where none is asked for."""
        return f"{self.name}-{case_folder(self.case.name, dump_case(self.case), changes)}"

    def run(self, changes: Sequence[str], output: Output) -> int:
        """Make the study, write and print it, and return the exit code."""
        return run_and_write(self, output, self.usual_folder(changes), self.marked_text)


def print_estimate(estimate: dict[str, float], text: str, output: Output) -> int:
    """Print how long a study takes, s, as a document or in words, and return the exit code."""
    if output.json:
        print_json(plain({**head({"run_seconds": "s", "seconds": "s"}), **estimate}))
    else:
        tell(text)
    return 0


def lasting(seconds: float) -> str:
    """Write how long something takes.

    Examples
    --------
    >>> lasting(0.2), lasting(90.0), lasting(3.2 * 3600)
    ('1 s', '90 s', '3.2 h')
    """
    if seconds < 120.0:
        return f"{max(seconds, 1.0):.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 7200.0 else f"{seconds / 3600.0:.1f} h"
