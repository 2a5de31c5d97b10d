"""Processes: signals that ask this one to end, which act as Ctrl-C does, and processes that this one starts."""

from __future__ import annotations

import _thread
import contextlib
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from types import FrameType
from typing import Any

OTHERS = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))
"""Signals that come where a session, a terminal or a machine ends; Windows has no SIGHUP."""
AGAIN = 0.02  # chosen: too short to be noticed, too long to keep the processor busy
"""Seconds after which an interrupt that was put off or swallowed comes once more."""
LONGEST = 10.0  # importing a module or linking a kernel takes less than one
"""Seconds for which an interrupt is put off at most."""
# modules in C and the compiler's library go on to fail, or to write where they must not, when they are left half done
WHOLE = ("<frozen importlib", f"{os.sep}llvmlite{os.sep}", f"{os.sep}numba{os.sep}core{os.sep}codegen.py")
"""Files whose functions must end before an interrupt is raised."""


class Terminated(KeyboardInterrupt):
    """A signal, by its number, that asks the program to end."""

    def __init__(self, number: int) -> None:
        self.number = signal.Signals(number)
        super().__init__(self.number.name)


class Stopped(Exception):  # noqa: N818  (no error)
    """A command was stopped; its cause is the `KeyboardInterrupt`, of which typer keeps nothing but 130."""


def exit_code(stop: BaseException | None) -> int:
    """Return the exit code of a program that was stopped: 128 and the number of the signal, as shells have it.

    Examples
    --------
    >>> exit_code(KeyboardInterrupt()), exit_code(Terminated(signal.SIGTERM))
    (130, 143)
    """
    return 128 + _number_of(stop)


def _number_of(stop: BaseException | None) -> signal.Signals:
    """Return the signal that stopped a program; Ctrl-C has no number of its own."""
    return stop.number if isinstance(stop, Terminated) else signal.SIGINT


class _Signals:
    """State of signals: the time of the first interrupt that is put off, and the signal raised since somebody asked."""

    put_off: float | None = None
    raised: signal.Signals | None = None


def _stop(number: int) -> KeyboardInterrupt:
    """Return the interrupt that a signal raises."""
    return KeyboardInterrupt() if number == signal.SIGINT else Terminated(number)


def _answer(number: int, frame: FrameType | None) -> None:
    """Raise a signal as an interrupt, as soon as nothing is under way that must not be left half done."""
    now = time.monotonic()
    if _is_half_done(frame) and now - (_Signals.put_off or now) < LONGEST:
        _Signals.put_off = _Signals.put_off or now
        return _send_again(number)
    _Signals.put_off, _Signals.raised = None, signal.Signals(number)
    raise _stop(number)


def _is_half_done(frame: FrameType | None) -> bool:
    """Tell whether a function that is running must end first."""
    while frame is not None:
        code = frame.f_code
        if code.co_name == "__del__" or any(name in code.co_filename for name in WHOLE):
            return True
        frame = frame.f_back
    return False


def _again(swallowed: Any) -> None:
    """Interrupt once more where Python had to swallow it: in a destructor, or in what a library in C calls back."""
    if not isinstance(swallowed.exc_value, KeyboardInterrupt):
        return sys.__unraisablehook__(swallowed)
    return _send_again(_number_of(swallowed.exc_value))


def _send_again(number: int) -> None:
    """Send a signal to the main thread in a while, which wakes it where the system can do that."""

    def send() -> None:
        time.sleep(AGAIN)
        if hasattr(signal, "pthread_kill"):
            signal.pthread_kill(threading.main_thread().ident or 0, number)
        else:
            _thread.interrupt_main(signal.Signals(number))

    _thread.start_new_thread(send, ())  # not by `threading`, which may hold its lock where a signal comes


def heed() -> None:
    """Let the other signals act as Ctrl-C does from now on; those that ``nohup`` ignores stay ignored.

    No interrupt is lost: one that a destructor swallows comes again. Each waits until a module is imported, or a kernel
    linked.
    """
    sys.unraisablehook = _again
    for number in (signal.SIGINT, *OTHERS):
        if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
            with contextlib.suppress(ValueError):  # not in the main thread
                signal.signal(number, _answer)


@contextlib.contextmanager
def interrupts_as_such() -> Iterator[None]:
    """Raise an interrupt in the place of any error of the block that came after it, as a library in C makes of one."""
    _Signals.raised = None
    try:
        yield
    except Exception:
        if _Signals.raised is None:
            raise
        raise _stop(_Signals.raised) from None


SAFE = "PYTHONSAFEPATH"
"""Variable by which Python imports no module from the folder that it is started in, where data lie."""

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
