"""A quantity with its unit, typed or slid."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui import ui

from strikewave.web.case.edited_field import EditedField

THROTTLE = 0.05
"""Least time between two movements that a slider tells, s: as many as are looked at."""


class LiveField(ui.element, component="live_field.js"):
    """One quantity of a case beside its name.

    Parameters
    ----------
    field : EditedField
    typed : str
        What stands in it.
    value : float
        Where its slider stands, in its unit.
    has_slider : bool
    label : str, optional
        What stands beside it; the words of its path where none is given.
    """

    def __init__(self, field: EditedField, typed: str, value: float, has_slider: bool, label: str = "") -> None:
        super().__init__()
        hint = f"{field.what}. How to get it: {field.how}. Here: {field.provenance}."
        given = {"path": field.path, "label": label or field.label, "hint": hint, "typed": typed}
        slid = {"low": field.low, "high": field.high if has_slider else field.low, "step": field.step, "value": value}
        self.props.update(given | slid)

    def on_move(self, moved: Callable[[float], Any]) -> None:
        """Call with the value of the slider, in its unit, as it is moved."""
        self.on("move", lambda event: moved(float(event.args)), throttle=THROTTLE)

    def on_type(self, typed: Callable[[str], Any]) -> None:
        """Call with what was typed, once the typing ends."""
        self.on("type", lambda event: typed(str(event.args)))

    def show(self, typed: str, value: float | None = None) -> None:
        """Show another value; of the slider none where it stands there already."""
        self.run_method("show", typed, value)
