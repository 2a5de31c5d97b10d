"""Ctrl-C, and the other signals that ask a program to end: they act as Ctrl-C does, so that nothing half is left."""

from __future__ import annotations

import _thread
import contextlib
import signal
import sys
import threading
from types import FrameType
from typing import Any, NoReturn

OTHERS = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))
"""Sent where a session, a terminal or a machine ends; Windows has no SIGHUP."""
AGAIN = 0.02
"""Seconds after which an interrupt that was swallowed comes once more: what swallowed it has returned by then."""


class Terminated(KeyboardInterrupt):
    """A signal asks the program to end.

    Parameters
    ----------
    number : int
        Of the signal.
    """

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
    """Return the signal that stopped a program: what says none is Ctrl-C."""
    return stop.number if isinstance(stop, Terminated) else signal.SIGINT


def _terminate(number: int, frame: FrameType | None) -> NoReturn:
    raise Terminated(number)


def _again(swallowed: Any) -> None:
    """Interrupt once more where Python had to swallow it: in a destructor, or in what a library in C calls back."""
    if not isinstance(swallowed.exc_value, KeyboardInterrupt):
        return sys.__unraisablehook__(swallowed)
    later = threading.Timer(AGAIN, _interrupt, (_number_of(swallowed.exc_value),))
    later.daemon = True
    return later.start()


def _interrupt(number: signal.Signals) -> None:
    """Send a signal to the main thread, which wakes it where the system can do that."""
    if hasattr(signal, "pthread_kill"):
        signal.pthread_kill(threading.main_thread().ident or 0, number)
    else:
        _thread.interrupt_main(number)


def heed() -> None:
    """Let the other signals act as Ctrl-C does from now on; what ``nohup`` has them ignored by stays ignored.

    No interrupt is lost: what a destructor swallows comes again.
    """
    sys.unraisablehook = _again
    for number in OTHERS:
        if signal.getsignal(number) == signal.SIG_DFL:
            with contextlib.suppress(ValueError):  # not in the main thread
                signal.signal(number, _terminate)
