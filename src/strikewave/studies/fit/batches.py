"""Runs of a fit that do not wait for one another: on threads, or on the pool that the fit was asked to run on.

What they come to can be kept in a store, by the content of the function and of what it is given, so that the same fit
asked again reads it. A fit takes the same way each time, so all that was kept is asked for again.
"""

from __future__ import annotations

import base64
import contextlib
import functools
import json
from collections.abc import Callable, Iterator
from contextvars import ContextVar
from typing import Any, TypeVar

import numpy as np

from strikewave.studies.engine.evaluation import RunOutcome
from strikewave.studies.engine.keys import content_key
from strikewave.studies.engine.pools import Pool, each_on
from strikewave.studies.engine.store import RunStore
from strikewave.uncertainty.runs import on_threads, or_none

Item = TypeVar("Item")
Result = TypeVar("Result")

MOST_KEPT = 64 * 2**20
"""Most bytes that a fit adds to its store: 5 million samples of residuals, some thousand runs on a pulse of
`strikewave.studies.fit.measured.MOST_SAMPLES`. What comes after them is made again where it is asked for again."""

_pool: ContextVar[Pool | None] = ContextVar("pool of the fit", default=None)
_kept: ContextVar[KeptResults | None] = ContextVar("kept results of the fit", default=None)


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


@contextlib.contextmanager
def keeping_in(store: RunStore | None) -> Iterator[None]:
    """Keep what the runs of the fits within come to, and read what is known; nothing where there is no store."""
    before = _kept.set(None if store is None else KeptResults(store))
    try:
        yield
    finally:
        _kept.reset(before)


def each_or_none(function: Callable[[Item], Result], items: list[Item]) -> list[Result | None]:
    """Return a result for each item, in their order; None where it could not be computed.

    Processes must be able to import the function: it is one of a module, a method, or a partial of such.

    Examples
    --------
    >>> each_or_none(abs, [-1, 2])
    [1, 2]
    """
    kept = _kept.get()
    return _made(function, items) if kept is None else kept.each_or_none(function, items)


def result_of(function: Callable[[Item], Result], item: Item) -> Result:
    """Return the result for one item; what makes it fail is raised."""
    kept = _kept.get()
    found = None if kept is None else kept.each_or_none(function, [item])[0]
    return function(item) if found is None else found


def _made(function: Callable[[Item], Result], items: list[Item]) -> list[Result | None]:
    pool = _pool.get()
    if len(items) == 1:  # threads and processes would take longer to begin
        return [or_none(function, items[0])]
    return on_threads(function, items) if pool is None else each_on(pool, functools.partial(or_none, function), items)


class KeptResults:
    """Results of the functions of a fit, kept in a store: numbers, lists and arrays of them; others are made anew.

    Parameters
    ----------
    store : RunStore
        What is known, and where the rest is kept.
    """

    def __init__(self, store: RunStore) -> None:
        self._store, self._known, self._size = store, store.known(), 0
        self._functions: dict[Callable[..., Any], bytes] = {}

    def each_or_none(self, function: Callable[[Item], Result], items: list[Item]) -> list[Result | None]:
        """Return a result for each item; those that the store has are read."""
        try:
            if function not in self._functions:
                self._functions[function] = content_key(function)
            keys = [content_key((self._functions[function], item)) for item in items]
        except TypeError:
            return _made(function, items)
        missing = {key: item for key, item in zip(keys, items, strict=True) if key not in self._known}
        made = dict(zip(missing, _made(function, list(missing.values())), strict=True)) if missing else {}
        self._keep(made)
        known = [key for key in dict.fromkeys(keys) if key not in made]
        read = {key: _read(text) for key, (text, _) in zip(known, self._store.documents(known), strict=True)}
        return [made[key] if key in made else read[key] for key in keys]

    def _keep(self, made: dict[bytes, Any]) -> None:
        texts = {key: _text(result) for key, result in made.items()}
        finished = [(key, RunOutcome(document=text)) for key, text in texts.items() if text]
        self._size += sum(len(outcome.document) for _, outcome in finished)
        if finished and self._size <= MOST_KEPT:
            self._store.keep((), finished)
            self._known |= {key for key, _ in finished}


def _text(result: Any) -> str:
    """Return a result as a text, exact to the bit; empty of one that is not kept."""
    if isinstance(result, np.ndarray) and result.ndim == 1 and result.dtype == np.float64:
        return json.dumps(base64.b64encode(result.astype("<f8").tobytes()).decode())
    numbers = result if isinstance(result, list) else [result]
    return json.dumps(result) if result is None or all(isinstance(one, float) for one in numbers) else ""


def _read(text: str) -> Any:
    """Return a result from its text."""
    found = json.loads(text)
    if not isinstance(found, str):
        return found
    return np.frombuffer(base64.b64decode(found), "<f8").astype(np.float64)
