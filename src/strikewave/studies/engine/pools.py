"""Who runs the jobs of a study: this process, processes of this machine, or any executor that is given."""

from __future__ import annotations

import enum
import os
from collections.abc import Callable, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future
from types import TracebackType
from typing import Any, Protocol

from strikewave.base.errors import StrikewaveError
from strikewave.studies.engine.evaluation import Row, RunOutcome
from strikewave.studies.workers import Workers

Batch = Callable[[Sequence[Row]], list[RunOutcome]]


class Loss(enum.Enum):
    """What ended a batch before its time."""

    BY_ANY = enum.auto()
    """One of the batches that were out, or someone else: its process ended, and with it all others."""
    BY_THIS = enum.auto()
    """The batch itself: workers ended with it several times, while others went on."""
    BY_NONE = enum.auto()
    """No batch: the way to the workers was lost."""


class Pool(Protocol):
    """What runs batches; a context manager."""

    @property
    def width(self) -> int:
        """How many batches run at a time."""
        ...

    def submit(self, job: Batch, rows: Sequence[Row]) -> Future[list[RunOutcome]]:
        """Begin a batch."""
        ...

    def loss(self, error: BaseException) -> Loss | None:
        """Return what an error says of a batch that ended before its time; None of an error of ours."""
        ...

    def renew(self) -> None:
        """Make it fit to run further batches after a loss."""
        ...

    def __enter__(self) -> Pool: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...


class ProcessPool:
    """Processes of this machine, no more than cores; with one, everything runs in this process.

    Examples
    --------
    >>> with ProcessPool(1) as pool:
    ...     pool.submit(list, [(1.0,)]).result()
    [(1.0,)]
    """

    def __init__(self, count: int) -> None:
        self.width = max(min(count, os.cpu_count() or 1), 1)
        self._workers = Workers(self.width)

    def __enter__(self) -> ProcessPool:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._workers.__exit__(kind, error, trace)

    def submit(self, job: Batch, rows: Sequence[Row]) -> Future[list[RunOutcome]]:
        """Begin a batch; in this process it is done when this returns."""
        return self._workers.submit(job, rows)

    def loss(self, error: BaseException) -> Loss | None:
        """Tell whether a process ended before its time."""
        return Loss.BY_ANY if isinstance(error, BrokenExecutor) else None

    def renew(self) -> None:
        """Start other processes."""
        self._workers.__exit__(None, None, None)
        self._workers = Workers(self.width)


class GivenPool:
    """An executor that someone else made, and ends.

    Parameters
    ----------
    executor : Executor
        Of `concurrent.futures`, or one that acts as these do.
    width : int, optional
        How many batches it runs at a time, where it does not name it itself.
    """

    def __init__(self, executor: Executor, width: int = 0) -> None:
        self._executor = executor
        named = getattr(executor, "_max_workers", 0) or getattr(executor, "max_workers", 0)
        self.width = width or int(named or os.cpu_count() or 1)
        self._running = set[Future[Any]]()

    def __enter__(self) -> GivenPool:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for future in self._running:
            future.cancel()

    def submit(self, job: Batch, rows: Sequence[Row]) -> Future[list[RunOutcome]]:
        """Begin a batch."""
        future = self._executor.submit(job, rows)
        self._running.add(future)
        future.add_done_callback(self._running.discard)
        return future

    def loss(self, error: BaseException) -> Loss | None:
        """Tell whether a worker ended before its time."""
        return Loss.BY_ANY if isinstance(error, BrokenExecutor) else None

    def renew(self) -> None:
        """Go on where the executor can.

        Raises
        ------
        StrikewaveError
            If it is broken.
        """
        if getattr(self._executor, "_broken", False):
            raise StrikewaveError("a process of the executor ended before its time: give another one, which goes on")
