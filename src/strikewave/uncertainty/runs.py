"""Many runs on the threads of this process: each is computed alone, so that the number of threads changes no bit."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from strikewave.base.errors import StrikewaveError

Item = TypeVar("Item")
Result = TypeVar("Result")

MOST_THREADS = 8
"""Most threads: what is not compiled, a tenth of a run, keeps them from gaining by more."""


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
        What to compute.
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
    """Return in one line why the first item without a result could not be computed; empty where all could.

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
