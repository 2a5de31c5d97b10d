"""Work of a step on several threads: each does its share of something that no share of another changes."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

import numpy as np

R = TypeVar("R")


def on_all(pool: ThreadPoolExecutor | None, function: Callable[..., R], shares: Sequence[Sequence[object]]) -> list[R]:
    """Call a compiled function with the arguments of each share, at once where there is a pool; return what it returns.

    The first share is done here: a thread that is there already begins at once.
    """
    if pool is None or len(shares) == 1:
        return [function(*share) for share in shares]
    others = [pool.submit(function, *share) for share in shares[1:]]
    first = function(*shares[0])
    return [first, *(each.result() for each in others)]


def spans(count: int, threads: int, least: int) -> list[tuple[int, int]]:
    """Return first and last index (exclusive) of the share of each thread, of which none is smaller than the least."""
    shares = max(1, min(threads, count // least))
    return list(itertools.pairwise(np.linspace(0, count, shares + 1).astype(int).tolist()))
