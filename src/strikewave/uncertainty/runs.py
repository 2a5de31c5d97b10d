"""Many runs on the threads of this process, and a copy of the process that computes while this one goes on."""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import NoReturn, TypeVar

from strikewave.base.errors import StrikewaveError
from strikewave.base.processes import OTHERS, end_after

Item = TypeVar("Item")
Result = TypeVar("Result")

MOST_THREADS = 8  # the part of a run that is not compiled, a tenth, keeps more threads from gaining


def on_threads(
    function: Callable[[Item], Result],
    items: list[Item],
    threads: int | None = None,
    advance: Callable[[float], None] | None = None,
) -> list[Result | None]:
    """Return a result for each item, in their order; None where it could not be computed.

    Parameters
    ----------
    function : callable
        Computes one; most of its time it must leave the interpreter free, as compiled kernels do.
    items : list
        Items to compute.
    threads : int, optional
        As many as processors, where it is left out.
    advance : callable, optional
        Called with the share done, 0 to 1.

    Examples
    --------
    >>> on_threads(lambda x: 1 / x, [1, 0, 2])
    [1.0, None, 0.5]
    """
    count = min(threads or os.cpu_count() or 1, MOST_THREADS, max(len(items), 1))

    def results() -> Iterator[Result | None]:
        if count == 1:
            yield from (or_none(function, item) for item in items)
            return
        with ThreadPoolExecutor(count) as pool:
            try:
                yield from pool.map(lambda item: or_none(function, item), items)
            except BaseException:
                pool.shutdown(cancel_futures=True)
                raise

    from threadpoolctl import threadpool_limits

    done = []
    with threadpool_limits(1):  # matrices this small: further threads of each product wait longer than they work
        for result in results():
            done.append(result)
            if advance is not None:
                advance(len(done) / len(items))
    return done


def why_failed(function: Callable[[Item], object], items: Sequence[Item], results: Sequence[object | None]) -> str:
    """Return the fault of the first item without a result in one line; empty where all have one.

    Examples
    --------
    >>> why_failed(float, ["1", "a"], on_threads(float, ["1", "a"]))
    "could not convert string to float: 'a'"
    """
    failed = next((item for item, result in zip(items, results, strict=True) if result is None), None)
    if failed is None:
        return ""
    try:
        function(failed)
    except (StrikewaveError, ValueError, ArithmeticError) as error:
        return next(iter(str(error).splitlines()), type(error).__name__)
    return ""


def or_none(function: Callable[[Item], Result], item: Item) -> Result | None:
    """Return a result; None where values that were drawn do not go together, or a run cannot be followed."""
    try:
        return function(item)
    except (StrikewaveError, ValueError, ArithmeticError):
        return None


@contextlib.contextmanager
def computed_beside(function: Callable[[], Result]) -> Iterator[Callable[[], Result | None]]:
    """Let a copy of this process compute a later result while the block runs.

    Gives a function that waits for the result. It returns None where no copy is made, or the copy failed: then compute
    it here. Copies are made on Linux, on more than one processor, while this process has one thread. The copy ends
    with the block, however that ends.

    Parameters
    ----------
    function : callable
        Computes the result, which can be pickled. It may run twice: here too, where the copy failed on its way.

    Examples
    --------
    >>> with computed_beside(lambda: 6 * 7) as result:
    ...     result() in (42, None)
    True
    """
    if sys.platform != "linux" or len(os.sched_getaffinity(0)) == 1 or threading.active_count() > 1:
        yield lambda: None
        return
    receiving, sending = os.pipe()
    watched, held = os.pipe()
    process = os.fork()
    if process == 0:
        os.close(held)
        end_after(lambda: os.read(watched, 1))  # nothing is ever written: it returns when the first process has ended
        _answer(function, sending)
    os.close(watched)
    os.close(sending)
    with open(receiving, "rb") as pipe:
        try:
            yield lambda: _read(pipe.read())
        finally:
            os.close(held)
            os.kill(process, signal.SIGKILL)
            os.waitpid(process, 0)


def _answer(function: Callable[[], Result], sending: int) -> NoReturn:
    """Compute in the copy, send the result, and end without what Python does at its end, which is the first one's."""
    try:
        for number in (signal.SIGINT, *OTHERS):  # they are answered by the first process alone
            signal.signal(number, signal.SIG_IGN)
        answer = pickle.dumps(function())
        with open(sending, "wb") as pipe:
            pipe.write(answer)
    finally:
        os._exit(0)


def _read(answer: bytes) -> Result | None:
    return pickle.loads(answer) if answer else None
