"""A hand that rests."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

REST = 0.6
"""Time without a change after which a hand rests, s: one that pauses on a slider pauses for less."""


class RestingHand:
    """Calls something once nothing has moved for a moment.

    Parameters
    ----------
    then : callable
    """

    def __init__(self, then: Callable[[], object]) -> None:
        self._then = then
        self._timer: asyncio.TimerHandle | None = None

    @property
    def is_moving(self) -> bool:
        """Whether something moved a moment ago."""
        return self._timer is not None

    def moved(self) -> None:
        """Note that something moved now."""
        self.stop()
        self._timer = asyncio.get_running_loop().call_later(REST, self._call)

    def stop(self) -> None:
        """Do not call."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _call(self) -> None:
        self._timer = None
        self._then()
