"""While kernels are compiled, which takes tens of seconds at first: what is said, and a second process that helps.

Compile kernels in a second process while this one compiles others; both keep them in the same cache. The second
process calls a function that has the kernels compiled, and this one takes them from the cache when it comes to them.
Where no second process can be had, or it fails, nothing is lost: a kernel that the cache lacks is compiled in this
process as ever.

Say that kernels are compiled, and how many are: the first run after install takes tens of seconds without a sign.
Numba tells when it compiles. What it loads from the cache it does not tell of, so that a warm run says nothing.
"""

from __future__ import annotations

import contextlib
import gc
import importlib
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from strikewave.base.processes import end_after, environment, python_command

WORDS = "compiling the kernels, once after install"

Show = Callable[[int, bool], None]
"""Shows how many kernels are compiled, and whether that was the last."""

_shows: list[Show | None] = []
"""Active displays of the count, the innermost last: None where nobody looks."""


@contextlib.contextmanager
def compiling_shown(show: Show | None = None) -> Iterator[None]:
    """Show the kernels that are compiled within: a context, or a decorator of what runs them.

    Parameters
    ----------
    show : callable, optional
        Called with the number of kernels compiled: 0 when the first begins, then after each, at the end once more, with
        True. Where it is left out, a line on stderr counts them if somebody looks, unless another context around this
        one shows it.

    Examples
    --------
    >>> import numba
    >>> counts = []
    >>> with compiling_shown(lambda count, done: counts.append((count, done))):
    ...     numba.njit(lambda x: x + 1.0)(2.0)
    3.0
    >>> counts
    [(0, False), (1, False), (1, True)]
    """
    if show is None and _shows:
        yield
        return
    from numba.core import event  # late: what compiles nothing shall not wait for numba

    mine = show or (_line() if _watched() else None)
    count: int | None = None

    class Counting(event.Listener):
        """Counts what is compiled while nobody else within shows it."""

        def on_start(self, event: object) -> None:
            nonlocal count
            if count is None and mine and _shows[-1] is mine:
                count = 0
                mine(count, False)

        def on_end(self, event: object) -> None:
            nonlocal count
            if count is not None and mine and _shows[-1] is mine:
                count += 1
                mine(count, False)

    _shows.append(mine)
    try:
        with event.install_listener("numba:compile", Counting()):
            yield
    finally:
        _shows.pop()
        if count is not None and mine:
            mine(count, True)


def _watched() -> bool:
    """Tell whether somebody looks at stderr: a terminal, or a notebook."""
    ipython = sys.modules.get("IPython")
    return sys.stderr.isatty() or (ipython is not None and ipython.get_ipython() is not None)


def _line() -> Show:
    """Return what writes one line on stderr, over and over."""
    begun = 0.0

    def show(count: int, done: bool) -> None:
        nonlocal begun
        begun = begun or time.monotonic()
        took = f" in {time.monotonic() - begun:.0f} s\n" if done else ""
        sys.stderr.write(f"\r{WORDS}: {count} compiled{took}")
        sys.stderr.flush()

    return show


PATIENCE = 120.0
"""Longest time that `await_kernel` waits, s: several times what one kernel takes on a slow machine."""
_LOOK = 0.05
"""Time between two looks into the cache, s."""


@contextlib.contextmanager
def compiled_beside(kernel: str, job: str) -> Iterator[None]:
    """Let a second process compile what will be needed after the block, while the block runs.

    The kernels that it compiles count among those of `compiling_shown`. Nothing is started where the kernel is in the
    cache, where there is no cache to hand it over, on one processor, or in a frozen program, whose executable is no
    Python. A block that fails ends the process.

    Parameters
    ----------
    kernel : str
        Name of the last kernel that the job compiles.
    job : str
        A function without arguments, as ``module:function``. The process calls it alone: it never runs the script or
        notebook that this one runs.
    """
    process = _started(job) if _worth_it(kernel) else None
    if process is None:
        yield
        return
    from numba.core import event

    assert process.stdout is not None
    with process:
        try:
            yield
            for _ in process.stdout:  # a line a kernel, until the process ends
                event.start_event("numba:compile")
                event.end_event("numba:compile")
        except BaseException:
            process.kill()
            raise


def await_kernel(name: str) -> None:
    """Wait until a kernel is in the cache: for a job that needs one which the first process compiles meanwhile.

    Looked for is the file of its code, which appears whole, and after that of the index.
    """
    from strikewave.base.compiled import cache_folder

    folder, end = cache_folder(), time.monotonic() + PATIENCE
    while folder and next(Path(folder).rglob(f"{name}-*.nbc"), None) is None and time.monotonic() < end:
        time.sleep(_LOOK)


def _worth_it(kernel: str) -> bool:
    from strikewave.base.compiled import cache_folder, is_cold

    if cache_folder() is None or getattr(sys, "frozen", False) or not sys.executable:
        return False
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return cores > 1 and is_cold(kernel)


def _started(job: str) -> subprocess.Popen[bytes] | None:
    """Start the process; its standard input closes when this one ends, however that happens."""
    command = python_command("-c", f"from {__name__} import work; work()", job)
    pipe, nowhere = subprocess.PIPE, subprocess.DEVNULL
    try:
        return subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=nowhere, env=environment())
    except OSError:
        return None


def work() -> None:
    """Do in the second process the job that its first argument names, and write a line for each kernel."""
    end_after(lambda: os.read(0, 1))  # returns at the end of the first process. sys.stdin would be locked at exit
    gc.set_threshold(50_000)  # as the command line does: at Python's own 700 compiling takes a twelfth longer
    module, _, name = sys.argv[1].partition(":")
    function = getattr(importlib.import_module(module), name)

    def tell(count: int, done: bool) -> None:
        if count and not done:
            os.write(1, b"\n")

    with compiling_shown(tell):
        function()
