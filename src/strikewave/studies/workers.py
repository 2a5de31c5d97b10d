"""Work shared among processes: started without a way to be torn by Ctrl-C, and ended at once when one is wanted.

They import nothing from the folder they run in, and end with the process that started them, even where that is killed.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from types import TracebackType
from typing import Any, TypeVar

from strikewave.base.child_process import end_after, safe_path
from strikewave.base.interrupts import OTHERS

Item = TypeVar("Item")
Result = TypeVar("Result")

INTERRUPTS = (signal.SIGINT, *OTHERS)
"""Signals that the parent alone answers; SIGTERM still ends a process that is ready, as the pool itself may want it."""


class Workers:
    """Processes that run functions; a context manager. With one, everything runs in this process.

    Ctrl-C and the signals that act as it does are answered by the parent alone: an error in the ``with`` block ends the
    processes at once, whatever they do, and so does the end of the parent; so they must write nothing.

    Parameters
    ----------
    count : int
        Processes; no more than cores.
    begin : callable, optional
        Makes a process ready.
    arguments : tuple, optional
        Arguments of ``begin``.
    """

    def __init__(self, count: int, begin: Callable[..., None] | None = None, arguments: tuple[Any, ...] = ()) -> None:
        self._pool: ProcessPoolExecutor | None = None
        self._before = {process.pid for process in multiprocessing.active_children()}
        count = min(count, os.cpu_count() or 1)
        if count > 1:
            spawn = multiprocessing.get_context("spawn")
            with safe_path():  # its locks start a process that watches over them
                self._pool = ProcessPoolExecutor(count, spawn, _begin, (begin, arguments))
        elif begin is not None:
            begin(*arguments)

    def __enter__(self) -> Workers:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._pool is None:
            return
        if kind is not None:
            for process in multiprocessing.active_children():
                if process.pid not in self._before:
                    process.kill()
        self._pool.shutdown(wait=True, cancel_futures=True)

    def submit(self, function: Callable[[Item], Result], item: Item) -> Future[Result]:
        """Begin a call, whose future the caller awaits; in this process it is done when this returns.

        Examples
        --------
        >>> with Workers(1) as workers:
        ...     workers.submit(abs, -1).result()
        1
        """
        if self._pool is not None:
            with safe_path(), _interrupts_later():
                return self._pool.submit(function, item)
        done: Future[Result] = Future()
        done.set_result(function(item))
        return done


def _begin(begin: Callable[..., None] | None, arguments: tuple[Any, ...]) -> None:
    """Make a process ready that ends with its parent, and let the parent alone answer Ctrl-C and a closed terminal."""
    end_after(multiprocessing.parent_process().join)  # type: ignore[union-attr]  # it has one
    for number in {*INTERRUPTS} - {signal.SIGTERM}:
        signal.signal(number, signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, INTERRUPTS)
    if begin is not None:
        begin(*arguments)


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
