"""Pools that run the jobs of a study: this process, processes of this machine, or any executor.

Processes import nothing from the folder they run in, are not torn by Ctrl-C, are ended at once when one is wanted, and
end with the process that started them, even where that is killed.
"""

from __future__ import annotations

import contextlib
import enum
import multiprocessing
import os
import signal
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Generic, Self, TypeVar

from strikewave.base.errors import StrikewaveError
from strikewave.base.processes import OTHERS, end_after, safe_path

Asked = TypeVar("Asked")
Answer = TypeVar("Answer")
Batch = Callable[[Sequence[Asked]], list[Answer]]

QUEUED = 2
"""Batches that are out, for each that runs at a time: the next one waits where the last one ends."""
MOST_DEATHS = 3
"""Ends of a process with a run after which the run is to blame, not someone who needed the memory."""

INTERRUPTS = (signal.SIGINT, *OTHERS)
"""Signals that the parent alone answers; SIGTERM still ends a process that is ready, as the pool itself may want it."""


class Loss(enum.Enum):
    """Causes that end a batch before its time."""

    BY_ANY = enum.auto()
    """One of the batches that were out, or someone else: its process ended, and with it all others."""
    BY_THIS = enum.auto()
    """The batch itself: workers ended with it several times, while others went on."""
    BY_NONE = enum.auto()
    """No batch: the way to the workers was lost."""


class Pool(ABC):
    """A runner of batches; a context manager."""

    _width: int

    @property
    def width(self) -> int:
        """The number of batches that run at a time."""
        return self._width

    @abstractmethod
    def submit(self, job: Batch[Asked, Answer], rows: Sequence[Asked]) -> Future[list[Answer]]:
        """Begin a batch."""

    def loss(self, error: BaseException) -> Loss | None:
        """Return what an error says of a batch that ended before its time; None of an error of ours."""
        return Loss.BY_ANY if isinstance(error, BrokenExecutor) else None

    def look(self) -> None:  # noqa: B027  (most pools report what is lost)
        """End batches whose loss nobody reports; called now and then while none comes back."""

    @abstractmethod
    def renew(self) -> None:
        """Make it fit to run further batches after a loss."""

    def __enter__(self) -> Self:
        return self

    @abstractmethod
    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...


class ProcessPool(Pool):
    """Processes of this machine, no more than cores; with one, everything runs in this process.

    Ctrl-C and the signals that act as it does are answered by the parent alone: an error in the ``with`` block ends the
    processes at once, whatever they do, and so does the end of the parent; so they must write nothing.

    Examples
    --------
    >>> with ProcessPool(1) as pool:
    ...     pool.submit(list, [(1.0,)]).result()
    [(1.0,)]
    """

    def __init__(self, count: int) -> None:
        self._width = max(min(count, os.cpu_count() or 1), 1)  # more than cores only take turns
        self._before = {process.pid for process in multiprocessing.active_children()}
        self._executor = self._started()

    def _started(self) -> ProcessPoolExecutor | None:
        """Start processes; none where everything runs in this one."""
        if self.width == 1:
            return None
        with safe_path():  # its locks start a process that watches over them
            # spawned: a fork would copy locks that threads of this process hold
            return ProcessPoolExecutor(self.width, multiprocessing.get_context("spawn"), _begin)

    def submit(self, job: Batch[Asked, Answer], rows: Sequence[Asked]) -> Future[list[Answer]]:
        """Begin a batch; in this process it is done when this returns."""
        if self._executor is not None:
            with safe_path(), _interrupts_later():
                return self._executor.submit(job, rows)
        done: Future[list[Answer]] = Future()
        done.set_result(job(rows))
        return done

    def renew(self) -> None:
        """Start other processes."""
        self.__exit__(None, None, None)
        self._executor = self._started()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._executor is None:
            return
        if kind is not None:  # an error or Ctrl-C: nobody waits for runs that take minutes
            for process in multiprocessing.active_children():
                if process.pid not in self._before:
                    process.kill()
        self._executor.shutdown(wait=True, cancel_futures=True)


def _begin() -> None:
    """Make a process ready that ends with its parent, and let the parent alone answer Ctrl-C and a closed terminal."""
    end_after(multiprocessing.parent_process().join)  # type: ignore[union-attr]  # it has one
    for number in {*INTERRUPTS} - {signal.SIGTERM}:
        signal.signal(number, signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, INTERRUPTS)


@contextlib.contextmanager
def _interrupts_later() -> Iterator[None]:
    """Block Ctrl-C and its kin while processes are started; they inherit the block until they are ready."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, INTERRUPTS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class GivenPool(Pool):
    """An executor that someone else made, and ends.

    Parameters
    ----------
    executor : Executor
        Executor of `concurrent.futures`, or one that acts as these do.
    width : int, optional
        Number of batches that it runs at a time; by default the number of its workers.
    """

    def __init__(self, executor: Executor, width: int = 0) -> None:
        self._executor = executor
        named = getattr(executor, "_max_workers", 0) or getattr(executor, "max_workers", 0)
        self._width = width or int(named or os.cpu_count() or 1)
        self._running = set[Future[Any]]()

    def submit(self, job: Batch[Asked, Answer], rows: Sequence[Asked]) -> Future[list[Answer]]:
        """Begin a batch."""
        future = self._executor.submit(job, rows)
        self._running.add(future)
        future.add_done_callback(self._running.discard)
        return future

    def renew(self) -> None:
        """Go on where the executor can."""
        if getattr(self._executor, "_broken", False):
            raise StrikewaveError("a process of the executor ended before its time: give another one, which goes on")

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for future in list(self._running):
            future.cancel()


class ThreadPool(GivenPool):
    """Threads of this process: for runs that leave the interpreter free most of their time, as compiled kernels do.

    Examples
    --------
    >>> with ThreadPool(2) as pool:
    ...     pool.submit(list, [(1.0,)]).result()
    [(1.0,)]
    """

    def __init__(self, count: int) -> None:
        super().__init__(ThreadPoolExecutor(count), count)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._executor.shutdown(cancel_futures=True)


@dataclass(frozen=True)
class Each(Generic[Asked, Answer]):
    """A function of each item of a batch: picklable where the function is."""

    function: Callable[[Asked], Answer]

    def __call__(self, items: Sequence[Asked]) -> list[Answer]:
        """Return the results of some items."""
        return [self.function(item) for item in items]


def each_on(pool: Pool, function: Callable[[Asked], Answer], items: Sequence[Asked]) -> list[Answer]:
    """Return the result of each item, in their order: for runs that nobody keeps; `carry_out` is for those of a store.

    Examples
    --------
    >>> with ThreadPool(2) as pool:
    ...     each_on(pool, abs, [-1, 2])
    [1, 2]
    """
    job, answers = Each(function), dict[int, list[Answer]]()
    # two batches a process: the second waits there while the first runs
    size = max(len(items) // (QUEUED * pool.width), 1)
    batches = [items[k : k + size] for k in range(0, len(items), size)]
    for _ in range(MOST_DEATHS):
        futures = {k: begin(pool, job, batch) for k, batch in enumerate(batches) if k not in answers}
        try:
            for k, future in futures.items():
                error = error_of(future)
                if error is None:
                    answers[k] = future.result()
                elif pool.loss(error) is None:
                    raise error
        except BaseException:
            for future in futures.values():
                future.cancel()
            raise
        if len(answers) == len(batches):
            return [answer for k in range(len(batches)) for answer in answers[k]]
        pool.renew()
    raise StrikewaveError(f"processes ended {MOST_DEATHS} times before their runs did: killed, or out of memory")


def error_of(future: Future[Any]) -> BaseException | None:
    """Wait for a future, and return what it raised, or that it was cancelled."""
    try:
        return future.exception()
    except CancelledError as error:
        return error


def begin(pool: Pool, job: Batch[Asked, Answer], items: Sequence[Asked]) -> Future[list[Answer]]:
    """Begin a batch; where the pool is lost already, its future has the error."""
    try:
        return pool.submit(job, items)
    except Exception as error:
        if pool.loss(error) is None:
            raise
        lost: Future[list[Answer]] = Future()
        lost.set_exception(error)
        return lost
