"""Processes of Python that this one starts: they import nothing from the folder they run in, and end when it ends."""

from __future__ import annotations

import contextlib
import os
import sys
import threading
from collections.abc import Callable, Iterator

SAFE = "PYTHONSAFEPATH"
"""Tells Python to leave the folder it is started in, where data lie, out of those that modules are looked for in."""

ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_MAX_THREADS"), "1")
"""Environment that keeps the threads of libraries from taking time and memory, in a process that reads a file."""


def python_command(*words: str) -> list[str]:
    """Return the command line of a Python that runs a file, or ``-c`` and a program.

    Examples
    --------
    >>> python_command("-c", "pass")[1:]
    ['-P', '-c', 'pass']
    """
    return [sys.executable, "-P", *words]


def environment(**more: str) -> dict[str, str]:
    """Return the environment of such a process: it finds the modules that this one finds, and what it starts is safe.

    Examples
    --------
    >>> environment(OMP_NUM_THREADS="1")["PYTHONSAFEPATH"]
    '1'
    """
    return {**os.environ, SAFE: "1", "PYTHONPATH": os.pathsep.join(filter(None, sys.path)), **more}


@contextlib.contextmanager
def safe_path() -> Iterator[None]:
    """Let the processes that `multiprocessing` starts in this block be safe: they take the environment of this one."""
    before = os.environ.get(SAFE)
    os.environ[SAFE] = "1"
    try:
        yield
    finally:
        if before is None:
            del os.environ[SAFE]
        else:
            os.environ[SAFE] = before


def end_after(wait: Callable[[], object]) -> None:
    """End this process at once when a function returns that waits for the end of the process that started it.

    A thread waits, so that a kernel which is running ends first.
    """

    def watch() -> None:
        wait()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
