"""Who runs the jobs of a study: this process, processes of this machine, or any executor that is given."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future
from types import TracebackType
from typing import Any, Protocol

from strikewave.base.errors import StrikewaveError
from strikewave.studies.engine.evaluation import Row, RunOutcome
from strikewave.studies.workers import Workers

Batch = Callable[[Sequence[Row]], list[RunOutcome]]


class Pool(Protocol):
    """What runs batches; a context manager."""

    @property
    def width(self) -> int:
        """How many batches run at a time."""
        ...

    def submit(self, job: Batch, rows: Sequence[Row]) -> Future[list[RunOutcome]]:
        """Begin a batch."""
        ...

    def is_loss(self, error: BaseException) -> bool:
        """Tell whether an error is that of a process that ended, not of the batch."""
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

    def is_loss(self, error: BaseException) -> bool:
        """Tell whether a process ended before its time."""
        return isinstance(error, BrokenExecutor)

    def renew(self) -> None:
        """Start other processes."""
        self._workers.__exit__(None, None, None)
        self._workers = Workers(self.width)


class GivenPool:
    """An executor that someone else made, and ends; Dask makes up for workers that it loses, others do not.

    Parameters
    ----------
    executor : Executor
        Of `concurrent.futures`, or one that acts as these do.
    width : int, optional
        How many batches it runs at a time, where it does not name it itself.
    """

    def __init__(self, executor: Executor, width: int = 0) -> None:
        self._executor = executor
        self.width = width or int(getattr(executor, "_max_workers", 0) or os.cpu_count() or 1)
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

    def is_loss(self, error: BaseException) -> bool:
        """Tell whether a worker ended before its time: of Dask, after several of them."""
        return isinstance(error, BrokenExecutor) or type(error).__name__ == "KilledWorker"

    def renew(self) -> None:
        """Go on where the executor can.

        Raises
        ------
        StrikewaveError
            If it is broken.
        """
        if getattr(self._executor, "_broken", False):
            raise StrikewaveError("a process of the executor ended before its time: give another one, which goes on")


def pool_of(executor: Executor | None, workers: int) -> Pool:
    """Return the pool of an executor that is given, or of so many processes of this machine.

    Examples
    --------
    >>> pool_of(None, 1).width
    1
    """
    return GivenPool(executor) if executor is not None else ProcessPool(workers)
