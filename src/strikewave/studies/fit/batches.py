"""Runs of a fit that do not wait for one another: on threads, or on the pool that the fit was asked to run on."""

from __future__ import annotations

import contextlib
import functools
from collections.abc import Callable, Iterator
from contextvars import ContextVar
from typing import TypeVar

from strikewave.studies.engine.pools import Pool, each_on
from strikewave.uncertainty.runs import on_threads, or_none

Item = TypeVar("Item")
Result = TypeVar("Result")

_pool: ContextVar[Pool | None] = ContextVar("pool of the fit", default=None)


@contextlib.contextmanager
def running_on(pool: Pool | None) -> Iterator[None]:
    """Give the runs of the fits within to a pool; to threads of this process where there is none."""
    if pool is None:
        yield
        return
    with pool:
        before = _pool.set(pool)
        try:
            yield
        finally:
            _pool.reset(before)


def each_or_none(function: Callable[[Item], Result], items: list[Item]) -> list[Result | None]:
    """Return a result for each item, in their order; None where it could not be computed.

    Processes must be able to import the function: it is one of a module, a method, or a partial of such.

    Examples
    --------
    >>> each_or_none(abs, [-1, 2])
    [1, 2]
    """
    pool = _pool.get()
    return on_threads(function, items) if pool is None else each_on(pool, functools.partial(or_none, function), items)
