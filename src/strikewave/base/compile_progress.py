"""Say that kernels are compiled, and how many are: the first run after install takes tens of seconds without a sign.

Numba tells when it compiles. What it loads from the cache it does not tell of, so that a warm run says nothing.
"""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Iterator

WORDS = "compiling the kernels, once after install"

Show = Callable[[int, bool], None]
"""Shows how many kernels are compiled, and whether that was the last."""

_shows: list[Show | None] = []
"""Those who show it now, the innermost last: None where nobody looks."""


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
