"""The cutoff of a filter of a record, as a handle on a scale of preferred numbers, or typed."""

from __future__ import annotations

from collections.abc import Callable

from strikewave.web.case.edited_field import EditedField
from strikewave.web.live.field import LiveField
from strikewave.web.live.rest import RestingHand

PREFERRED = (10, 12.5, 16, 20, 25, 31.5, 40, 50, 63, 80)
"""Steps of a decade, ISO 3 R10: the bands in which test laboratories think."""
CUTOFFS = tuple(
    f"{number * 10**decade:g} Hz" if decade < 2 else f"{number * 10 ** (decade - 3):g} kHz"
    for decade in range(4)
    for number in PREFERRED
)
"""From 10 Hz to 80 kHz."""


class CutoffField:
    """A cutoff with its handle; at its end nothing is filtered.

    Parameters
    ----------
    key, label, what : str
        Its option, its name, and what it does.
    typed : str
        What stands in it at first; empty for no filter.
    none_at_top : bool
        Whether no filter is at the upper end, as of a low-pass.
    moved, changed : callable
        Called when it begins to move, and when it rests at another value.
    """

    def __init__(
        self,
        key: str,
        label: str,
        what: str,
        typed: str,
        none_at_top: bool,
        moved: Callable[[], object],
        changed: Callable[[], object],
    ) -> None:
        self.value, self._moved, self._changed = typed, moved, changed
        self._steps = (*CUTOFFS, "") if none_at_top else ("", *CUTOFFS)
        self._rest = RestingHand(changed)
        how = "typed with its unit, or slid; at the end of the slider nothing is filtered"
        last = len(self._steps) - 1.0
        field = EditedField(key, what, how, typed, "", self._at, 0.0, last, 1.0, "chosen", 1.0)
        self._shown = LiveField(field, typed, self._at, has_slider=True, label=label)
        self._shown.on_move(self._move)
        self._shown.on_type(self._type)

    @property
    def _at(self) -> float:
        """Where the handle stands: at the end for none, and for what is no step of it."""
        word = self.value if self.value in self._steps else ""
        return float(self._steps.index(word))

    def _move(self, place: float) -> None:
        self.value = self._steps[min(max(int(place), 0), len(self._steps) - 1)]
        self._shown.show(self.value)
        self._moved()
        self._rest.moved()

    def _type(self, text: str) -> None:
        self.value = text.strip()
        self._shown.show(self.value, self._at)
        self._changed()
