"""Readings of a bar at a section that is moved along it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui import ui

from strikewave.base.errors import InputError
from strikewave.base.shock_quantities import LENGTH
from strikewave.base.units import in_unit, parse_quantity, typed_number
from strikewave.web import parts
from strikewave.web.case.edited_field import EditedField
from strikewave.web.charts import BLUE, ChartLine, line_chart
from strikewave.web.curves import points
from strikewave.web.live.chart import LiveChart
from strikewave.web.live.field import LiveField
from strikewave.web.live.rest import RestingHand
from strikewave.web.pages.case.bar_sections import BarSections

KEY = "section"
"""Of the address."""
STEPS = 500
"""Places of the slider: more than there are places of the field."""
LONGEST_SHOWN = 40
"""Characters of a refused text that are shown."""
NAMES = ("Stress at the section", "Velocity at the section")


class SectionReadings:
    """A section with its slider: stress and velocity there over time, of the run that is shown.

    Parameters
    ----------
    at : str
        Where it stands at first, such as ``29 mm``; empty for the middle.
    moved : callable
        Called once it rests where it was moved.
    """

    def __init__(self, at: str, moved: Callable[[], None]) -> None:
        self._asked = at
        self._sections: BarSections | None = None
        self._place = 0
        self._rest = RestingHand(moved)
        self._slider: LiveField | None = None
        with parts.box("Readings at a section"):
            ui.label("move the section, or click on the x-t diagram").classes("sw-soft")
            self._row = ui.element("div").classes("sw-full")
            with ui.element("div").classes("sw-charts"):
                self._charts = [parts.chart(line_chart("", "", "", []), name) for name in NAMES]

    @property
    def query(self) -> list[tuple[str, str]]:
        """What the address holds of it."""
        return [(KEY, self._asked)] if self._asked else []

    def show(self, sections: BarSections) -> None:
        """Show another run, at the section where it was."""
        self._sections = sections
        low, high = float(sections.position[0]), float(sections.position[-1])
        asked = _millimetres(self._asked)
        self._place = sections.nearest(0.5 * (low + high) if asked is None else asked)
        at = float(sections.position[self._place])
        self._row.clear()
        with self._row:
            what = "Distance from the loaded face"
            field = EditedField(
                "section", what, "choose it", f"{at:.4g} mm", "mm", at, low, high, (high - low) / STEPS, "chosen", 1e-3
            )
            self._slider = LiveField(field, field.typed, at, has_slider=True)
            self._slider.on_move(self.move)
            self._slider.on_type(self.type)
        self._draw()

    def move(self, position: float, typed: bool = False) -> None:
        """Move the section, mm."""
        if self._sections is None or self._slider is None:
            return
        self._place = self._sections.nearest(position)
        self._asked = f"{float(self._sections.position[self._place]):.4g} mm"
        self._slider.show(self._asked, position if typed else None)
        self._draw()
        self._rest.moved()

    def type(self, text: str) -> None:
        """Move the section to a length that was typed; what is none is refused, and the section stays."""
        place = _millimetres(text)
        if place is not None:
            self.move(place, typed=True)
        elif self._slider is not None:
            ui.notify(f'refused: "{text[:LONGEST_SHOWN]}"; allowed: a length, such as 29 mm', type="warning")
            self._slider.show(self._asked)

    def pick(self, event: Any) -> None:
        """Move the section to where the x-t diagram was clicked."""
        cell = event.args
        if self._sections is not None and isinstance(cell, list) and len(cell) == 4:
            self.move(float(cell[3]), typed=True)

    def _draw(self) -> None:
        sections = self._sections
        if sections is None:
            return
        where = f"{sections.position[self._place]:.4g} mm, {sections.layer[self._place]}"
        shown: tuple[tuple[LiveChart, str, Any, str], ...] = tuple(
            zip(self._charts, NAMES, (sections.stress, sections.velocity), sections.labels[1:], strict=True)
        )
        for chart, name, values, label in shown:
            line = ChartLine(name, points(sections.time, values[:, self._place]), BLUE)
            chart.show(line_chart(f"{name}: {where}", sections.labels[0], label, [line]))


def _millimetres(text: str) -> float | None:
    """Return a typed length in mm, which a bare number is; None for what is no length.

    Examples
    --------
    >>> _millimetres("29"), _millimetres("2.9e1mm"), _millimetres("3 cm"), _millimetres("there")
    (29.0, 29.0, 30.0, None)
    """
    number = typed_number(text)
    if number is not None:
        return number
    try:
        return in_unit(parse_quantity(text, LENGTH.si, KEY), *LENGTH.units)
    except InputError:
        return None
