"""Ctrl-C, and the other signals that ask a program to end: they act as Ctrl-C does, so that nothing half is left."""

from __future__ import annotations

import contextlib
import signal
from types import FrameType
from typing import NoReturn

OTHERS = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))
"""Sent where a session, a terminal or a machine ends; Windows has no SIGHUP."""


class Terminated(KeyboardInterrupt):
    """A signal asks the program to end.

    Parameters
    ----------
    number : int
        Of the signal.
    """

    def __init__(self, number: int) -> None:
        self.number = number
        super().__init__(signal.Signals(number).name)


class Stopped(Exception):  # noqa: N818  (no error)
    """A command was stopped; its cause is the `KeyboardInterrupt`, of which typer keeps nothing but 130."""


def exit_code(stop: BaseException | None) -> int:
    """Return the exit code of a program that was stopped: 128 and the number of the signal, as shells have it.

    Examples
    --------
    >>> exit_code(KeyboardInterrupt()), exit_code(Terminated(signal.SIGTERM))
    (130, 143)
    """
    return 128 + (stop.number if isinstance(stop, Terminated) else signal.SIGINT)


def _terminate(number: int, frame: FrameType | None) -> NoReturn:
    raise Terminated(number)


def heed() -> None:
    """Let the other signals act as Ctrl-C does from now on; what ``nohup`` has them ignored by stays ignored."""
    for number in OTHERS:
        if signal.getsignal(number) == signal.SIG_DFL:
            with contextlib.suppress(ValueError):  # not in the main thread
                signal.signal(number, _terminate)
