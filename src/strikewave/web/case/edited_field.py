"""A quantity of a case as a page edits it."""

from __future__ import annotations

from typing import NamedTuple

from strikewave.base.units import typed_number
from strikewave.reporting.numbers import spelled


class EditedField(NamedTuple):
    """A quantity of a case.

    Attributes
    ----------
    path : str
        In the case.
    what, how : str
        What it is, and how one gets it on a real machine.
    typed : str
        As the case has it, with its unit.
    unit : str
        The unit in which it is typed and slid; empty for a number.
    value : float
        In that unit.
    low, high, step : float
        Of the slider, in that unit.
    provenance : str
        Where the value of the case comes from.
    scale : float
        Size of its unit in SI.
    """

    path: str
    what: str
    how: str
    typed: str
    unit: str
    value: float
    low: float
    high: float
    step: float
    provenance: str
    scale: float

    def shown(self, si: float) -> float:
        """Return an SI value in the unit in which it is slid."""
        return si / self.scale

    def text(self, value: float) -> str:
        """Return a value of the slider as a case file has it.

        Examples
        --------
        >>> from strikewave import load_case
        >>> from strikewave.web.case.fields import edited_fields
        >>> edited_fields(load_case("li-ma-2019"))["machine.speed"].text(700.0)
        '700 rpm'
        """
        number = f"{value:.0f}" if self.step >= 1.0 and float(value).is_integer() else f"{value:.6g}"
        return f"{number} {self.unit}".strip()

    def with_unit(self, typed: str) -> str:
        """Return what was typed into the field: a bare number has the unit that stands in its label.

        Examples
        --------
        >>> from strikewave import load_case
        >>> from strikewave.web.case.fields import edited_fields
        >>> speed = edited_fields(load_case("li-ma-2019"))["machine.speed"]
        >>> speed.with_unit("7e2"), speed.with_unit("70 rad/s")
        ('7e2 rpm', '70 rad/s')
        """
        return f"{typed.strip()} {self.unit}".strip() if typed_number(typed) is not None else typed.strip()

    @property
    def label(self) -> str:
        """What it is called beside its slider: its whole path in words, for a mass may be that of striker or object."""
        words = self.path.replace(".", " ").replace("_", " ")
        return f"{words} ({spelled(self.unit)})" if self.unit else words
