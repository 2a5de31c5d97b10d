"""Commands of studies that go on where they were stopped: their finished runs outlast the process."""

from __future__ import annotations

import contextlib
import shutil
from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar, NoReturn, TypeVar

from strikewave.base.errors import InputError, StrikewaveError
from strikewave.base.interrupts import exit_code
from strikewave.base.result import Result
from strikewave.reporting.run_and_write import Command
from strikewave.reporting.terminal import say
from strikewave.studies.engine.store import RunStore, begin_from, runs_beside

Study = TypeVar("Study", bound=Result)


@dataclass(kw_only=True)
class ResumableCommand(Command[Study]):
    """A study that keeps its finished runs beside the result until that is written, or in a folder of their own.

    Attributes
    ----------
    place : Path or None
        Folder that keeps finished runs for good; None for one beside the result, till that is written.
    fresh : bool
        Whether finished runs of a stopped study are run anew.
    """

    indent: ClassVar[int | None] = None

    place: Path | None = None
    fresh: bool = False
    store: RunStore | None = field(default=None, init=False)

    @abstractmethod
    def solved(self, store: RunStore) -> Study:
        """Return the study, with a bar on stderr; where it is stopped, end with `stopped`."""

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

    def hand_over(self, result: Study, folder: Path) -> list[str]:
        """Copy the finished runs into the folder, where the same question finds them."""
        return self._with_runs(folder, [])

    def _with_runs(self, folder: Path, handed_over: list[str]) -> list[str]:
        """Return names of files that were handed over, and that of the finished runs, which are copied there."""
        if self.store is None or self.place is not None:
            return handed_over
        return [*handed_over, *self.store.copy_into(folder, handed_over)]

    def solve(self) -> Study:
        """Return the study; its runs are kept for as long as it takes where nothing is written."""
        if self.store is not None:
            return self.solved(self.store)
        with self._opened(self.place) as store:
            return self.solved(store)

    def stopped(self, stop: KeyboardInterrupt, store: RunStore, finished: str) -> NoReturn:
        """Say what of a stopped study is kept, such as "12 of 20 runs", and exit; empty where none has finished.

        What is finished is counted in the store: a batch may be kept there before its progress is reported.
        """
        kept = f"{finished} are kept in {store.folder}: the same command goes on there"
        say("stopped; " + (kept if finished and self.store is not None else "nothing was written"))
        raise SystemExit(exit_code(stop)) from None

    def stopped_after(self, stop: KeyboardInterrupt, store: RunStore, what: str = "runs") -> NoReturn:
        """Say how many runs of a stopped study are kept, and exit."""
        count = len(store.known())
        self.stopped(stop, store, "" if store.empty else f"{count} {what}" if count else "states of runs")

    def _opened(self, folder: Path | None) -> RunStore:
        return RunStore(folder, self.fresh, option="--out" if self.place is None else "--store")
