"""A second process that computes while this one goes on: a copy of it (fork), which needs no import and no loading."""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from typing import NoReturn, TypeVar

from strikewave.base.child_process import end_after
from strikewave.base.interrupts import OTHERS

Result = TypeVar("Result")


@contextlib.contextmanager
def computed_beside(function: Callable[[], Result]) -> Iterator[Callable[[], Result | None]]:
    """Let a copy of this process compute what will be needed later, while the block runs.

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
