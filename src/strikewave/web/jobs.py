"""Work of the app in processes of its own: the server answers meanwhile, and unwanted work ends at once.

A `PageJob` is one piece of work that may take long. `Lookers` are processes that stay, for answers without delay.
Both are copied from a process that has imported all that they need, where the system can do that.
"""

from __future__ import annotations

import asyncio
import contextlib
import importlib
import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.connection import Connection
from typing import Any, Literal, NamedTuple

from strikewave.base.compiling import WORDS, compiling_shown
from strikewave.base.errors import StrikewaveError
from strikewave.base.processes import end_after, heed, safe_path

CORES = max(1, len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1)
MEMORY = 4 << 30
"""Most bytes of one job: ten times the largest built-in model, and a computer of 8 GB survives it."""
PATIENCE = 10.0
"""Longest time of a first look, s: a hundred times the usual one. A slower case counts as one that cannot be followed,
and its process is replaced."""
COLD_PATIENCE = 240.0
"""Longest time of a first look while kernels may have to be compiled, s."""
PRELOADED = (
    "strikewave.analyses.machine.report",
    "strikewave.web.pages.case.machine_view",
    "strikewave.web.pages.case.target_view",
)
"""Modules that the parent of all processes imports: the slowest to import that most of them need."""
LONGEST_LINE = 400
"""Characters of a line of error that a page shows."""
Say = Callable[[float | None, str], None]
"""Takes the share done, or None where it is not known, and a word on the current step."""


class WorkError(StrikewaveError):
    """Work could not be done; the message says why, for a page."""


class CancelledError(StrikewaveError):
    """Work was stopped on request."""


class Message(NamedTuple):
    """A message of a process: its progress, its result, or the reason of a refusal."""

    kind: Literal["progress", "done", "refused"]
    content: Any
    share: float | None = None


def prepare() -> None:
    """Have the parent of all processes import its modules before the first is wanted."""
    if _context().get_start_method() == "forkserver":
        multiprocessing.set_forkserver_preload(list(PRELOADED))


def _context() -> Any:
    """Return the start of processes: copied from one without threads where the system can, else begun anew."""
    has_forkserver = "forkserver" in multiprocessing.get_all_start_methods()
    return multiprocessing.get_context("forkserver" if has_forkserver else "spawn")


class PageJob:
    """One piece of work in a process of its own.

    ``function`` is ``module:name``, so that the server need not import it; it is called with the arguments, plain
    values, and with ``say``, which takes the share done and a word.

    Examples
    --------
    >>> asyncio.run(PageJob("builtins:sorted", [2, 1]).result(plain=True))
    [1, 2]
    """

    def __init__(self, function: str, *arguments: Any) -> None:
        self._function, self._arguments = function, arguments
        self._process: Any = None
        self._cancelled = False

    @property
    def is_running(self) -> bool:
        """True while the process runs."""
        return self._process is not None and self._process.is_alive()

    async def result(self, progress: Say | None = None, plain: bool = False) -> Any:
        """Do the work when a core is free, and return its result; a ``plain`` function takes no ``say``.

        Raises `CancelledError` if it was stopped, and `WorkError` if it was refused, in the words of the command line,
        or its process ended.
        """
        async with _free_core():
            if self._cancelled:
                raise CancelledError("stopped")
            ours, theirs = _context().Pipe()
            with safe_path():
                self._process = _context().Process(
                    target=_work, args=(theirs, self._function, self._arguments, plain), name="strikewave work"
                )
                await asyncio.to_thread(self._process.start)
            theirs.close()
            try:
                return await self._listen(ours, progress)
            finally:
                ours.close()
                await asyncio.to_thread(self._end)

    async def _listen(self, pipe: Connection, progress: Say | None) -> Any:
        loop = asyncio.get_running_loop()
        while True:
            try:
                message: Message = await loop.run_in_executor(_listeners, pipe.recv)
            except (EOFError, OSError):
                if self._cancelled:
                    raise CancelledError("stopped") from None
                raise WorkError("the work ended before its time: it may have taken more memory than there is") from None
            if message.kind == "done":
                return message.content
            if message.kind == "refused":
                raise WorkError(str(message.content)[:LONGEST_LINE])
            if progress is not None:
                progress(message.share, message.content)

    def cancel(self) -> None:
        """Stop the work; its stored states stay for a later start."""
        self._cancelled = True
        if self.is_running:
            self._process.terminate()

    def _end(self) -> None:
        """Wait until the process has ended, which is soon; else end it."""
        self._process.join(3.0)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()


_listeners = ThreadPoolExecutor(2 * CORES + 2, "strikewave listener")
"""Threads that wait for messages of processes: a core has one job and one looker at most."""
_cores: dict[int, asyncio.Semaphore] = {}


def _free_core() -> asyncio.Semaphore:
    """Return a semaphore of the running loop that lets as many jobs run as there are cores."""
    loop = id(asyncio.get_running_loop())
    if loop not in _cores:
        _cores.clear()
        _cores[loop] = asyncio.Semaphore(CORES)
    return _cores[loop]


def _work(pipe: Connection, function: str, arguments: tuple[Any, ...], plain: bool) -> None:
    """Do one piece of work in its process."""
    _begin()
    last = 0.0

    def say(share: float | None, stage: str) -> None:
        nonlocal last
        now = time.monotonic()
        if now - last > 0.1 or share is None:  # a page shows no more than ten a second
            last = now
            pipe.send(Message("progress", stage, share))

    with contextlib.suppress(KeyboardInterrupt, BrokenPipeError):
        more = {} if plain else {"say": say}
        with compiling_shown(lambda count, done: say(None, f"{WORDS}: {count} compiled")):
            pipe.send(_answer(lambda: _named(function)(*arguments, **more)))


def _named(function: str) -> Callable[..., Any]:
    module, _, name = function.partition(":")
    return getattr(importlib.import_module(module), name)


def _begin() -> None:
    """Make a process ready: it ends with the server, heeds signals, and keeps to its share of memory."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        end_after(parent.join)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the server, which ends its work
    heed()
    os.environ.pop("STRIKEWAVE_TRACE", None)
    if sys.platform.startswith("linux"):
        import resource

        resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))


def _answer(work: Callable[[], Any]) -> Message:
    """Return the result of work, or the reason of its refusal."""
    try:
        return Message("done", work())
    except StrikewaveError as error:
        return Message("refused", str(error))
    except MemoryError:
        return Message("refused", f"this takes more memory than the {MEMORY >> 30} GB that the app gives one run")
    except OSError as error:
        return Message("refused", f"the system refused: {error.strerror or error}")
    except Exception as error:
        return Message("refused", f"internal error ({type(error).__name__}: {error}); please report it")


class Lookers:
    """Processes that answer within a tenth of a second, ``count`` at a time; one that hangs is replaced."""

    def __init__(self, count: int = CORES) -> None:
        self._idle: list[tuple[Any, Connection]] = []
        self._turn = asyncio.Semaphore(count)
        self.patience = COLD_PATIENCE

    async def ask(self, function: str, *arguments: Any) -> Any:
        """Return the result of a function, given as ``module:name``, of plain values.

        Raises `WorkError` if it is refused, in the words of the command line, or takes too long.
        """
        loop = asyncio.get_running_loop()
        async with self._turn:
            process, pipe = self._idle.pop() if self._idle else await asyncio.to_thread(_new_looker)
            try:
                pipe.send((function, arguments))
                ready = await loop.run_in_executor(_listeners, pipe.poll, self.patience)
                if not ready:
                    raise WorkError(f"no answer in {self.patience:.0f} s: a stiffness, damping or mass may be extreme")
                message: Message = await loop.run_in_executor(_listeners, pipe.recv)
            except (EOFError, OSError):
                _drop(process, pipe)
                raise WorkError("the first look ended before its time") from None
            except BaseException:
                _drop(process, pipe)
                raise
            self._idle.append((process, pipe))
        if message.kind == "refused":
            raise WorkError(str(message.content)[:LONGEST_LINE])
        return message.content

    async def warm(self) -> None:
        """Have one process ready."""
        if not self._idle:
            self._idle.append(await asyncio.to_thread(_new_looker))

    def end(self) -> None:
        """End all processes."""
        while self._idle:
            _drop(*self._idle.pop())


def _new_looker() -> tuple[Any, Connection]:
    ours, theirs = _context().Pipe()
    with safe_path():
        process = _context().Process(target=_look, args=(theirs,), name="strikewave look", daemon=True)
        process.start()
    theirs.close()
    return process, ours


def _drop(process: Any, pipe: Connection) -> None:
    pipe.close()
    process.kill()


def _look(pipe: Connection) -> None:
    """Answer questions until the server closes the pipe."""
    _begin()
    with contextlib.suppress(EOFError, OSError, KeyboardInterrupt):
        while True:
            function, arguments = pipe.recv()
            pipe.send(_answer(lambda: _named(function)(*arguments)))  # noqa: B023  (called at once)
