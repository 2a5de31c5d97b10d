"""Results that are not those of the settings beside them are marked until theirs come."""

from __future__ import annotations

from nicegui import ui


class MarkedResult(ui.element):
    """What holds results: dim as long as they are of other settings, and busy as long as theirs are computed.

    Attributes
    ----------
    is_stale : bool
        Whether what is shown is of other settings.
    """

    def __init__(self) -> None:
        super().__init__("div")
        self.classes("sw-main")
        self.is_stale = self._busy = False

    def show_as(self, stale: bool, busy: bool = False) -> None:
        """Say what is shown, to eyes and ears, where that is not said already."""
        if (stale, busy) == (self.is_stale, self._busy) or self.is_deleted:
            return
        self.is_stale, self._busy = stale, busy
        self.classes(**{"add" if stale else "remove": "sw-stale"})
        self.props(f"aria-busy={'true' if busy else 'false'}")
