"""Candidates that are run at a time: the compiled runs hold no lock."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

WORKERS = 2
"""Threads; the compiled runs hold no lock."""
Asked = TypeVar("Asked")
Found = TypeVar("Found")


def each_result(
    solve: Callable[[Asked], Found],
    asked: Sequence[Asked],
    progress: Callable[[float], None] | None = None,
    done: int = 0,
    whole: int | None = None,
) -> Iterator[tuple[Asked, Found]]:
    """Yield each question with its answer, in order; `WORKERS` are solved at a time.

    Parameters
    ----------
    solve : callable
        Answers a question.
    asked : sequence
        The questions.
    progress : callable, optional
        Called with the share done, 0 to 1.
    done, whole : int, optional
        Questions that were answered before, and all of them, where these are a part.

    Examples
    --------
    >>> list(each_result(abs, [-1, 2]))
    [(-1, 1), (2, 2)]
    """
    with ThreadPoolExecutor(WORKERS) as pool:
        try:
            for k, result in enumerate(pool.map(solve, asked), 1):
                if progress is not None:
                    progress((done + k) / (whole or len(asked)))
                yield asked[k - 1], result
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
