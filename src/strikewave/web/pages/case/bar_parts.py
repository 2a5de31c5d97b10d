"""Parts of the page of layered bars: readings at a section that is moved, and the list of layers and joints."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

from nicegui import ui

from strikewave.base.errors import InputError
from strikewave.base.shock_quantities import LENGTH
from strikewave.base.units import in_unit, parse_quantity, typed_number
from strikewave.web import parts
from strikewave.web.case_state import JOINTS, BarSections, CaseSource, CaseState, EditedField, ListedStack
from strikewave.web.charts import BLUE, ChartLine, line_chart, points
from strikewave.web.desk import Desk
from strikewave.web.parts import LiveChart, LiveField, RestingHand

KEY = "section"
"""Key of the address."""
STEPS = 500
"""Places of the slider: more than there are places of the field."""
LONGEST_SHOWN = 40
"""Characters of a refused text that are shown."""
NAMES = ("Stress at the section", "Velocity at the section")


class SectionReadings:
    """A section with its slider: stress and velocity there over time, of the shown run.

    ``at`` is its first place, such as ``29 mm``, empty for the middle; ``moved`` is called once it rests at another.
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
        """The part of the address with the section."""
        return [(KEY, self._asked)] if self._asked else []

    def show(self, sections: BarSections) -> None:
        """Show another run, at the same section."""
        self._sections = sections
        low, high = float(sections.position[0]), float(sections.position[-1])
        place = _millimetres(self._asked)
        self._place = sections.nearest(0.5 * (low + high) if place is None else place)
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
        """Move the section to a typed length; another text is refused, and the section stays."""
        place = _millimetres(text)
        if place is not None:
            self.move(place, typed=True)
        elif self._slider is not None:
            ui.notify(f'refused: "{text[:LONGEST_SHOWN]}"; allowed: a length, such as 29 mm', type="warning")
            self._slider.show(self._asked)

    def pick(self, event: Any) -> None:
        """Move the section to the clicked place of the x-t diagram."""
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
    """Return a typed length in mm, the unit of a bare number; None for another text.

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


LAYERS = "strikewave.web.case_values"
ENDING = "-layers"
"""Ending of the name of a case with changed layers."""
LOADED_FACE = "the loaded face"
FIELDS = {
    "name": ("name of the layer", ""),
    "length": ("length of the layer", "10 mm"),
    "diameter": ("diameter of the layer", "20 mm"),
    "area": ("or its area, such as 300 mm^2", ""),
}
"""Typed fields of a new layer: label, and text there at first; its material is chosen."""
OWN = {
    "density": "density of its own, such as 1850 kg/m^3",
    "modulus": "modulus of its own, such as 24 GPa",
    "poissons_ratio": "Poisson's ratio, such as 0.3",
}
"""Fields for the numbers of a material that is not listed, with their labels."""
NO_MATERIAL = "none: numbers of its own"


class StackLayers:
    """The layers of a bar from the loaded face on; a change of them gives another case on the same page."""

    def __init__(
        self, desk: Desk, source: Callable[[], CaseSource], changed: Callable[[CaseState], Any], listed: ListedStack
    ) -> None:
        self.desk, self.source, self.changed = desk, source, changed
        with parts.box("Layers, from the loaded face on"):
            ui.label(
                "drag a layer, or move it by its arrows; joints stay at their places, and have arrows too"
            ).classes("sw-soft")
            self._list = ui.column().classes("sw-stack")
            self._list.make_sortable(on_end=self._dropped, handle=".sw-grip")
            self._layer_form(listed.materials)
            self._joint_form()
        self.show(listed)

    def show(self, listed: ListedStack) -> None:
        """Show the layers and joints of another case."""
        self.rows = listed.rows
        names = [row.layer for row in self.rows]
        self._behind.set_options([LOADED_FACE, *names], value=names[-1])
        bonded = [row.layer for row in self.rows[:-1] if not row.joint]
        self._joint_behind.set_options(bonded, value=bonded[0] if bonded else None)
        self._build()

    def _build(self) -> None:
        self._list.clear()
        with self._list:
            for place, row in enumerate(self.rows):
                with ui.element("div").classes("sw-layer"):
                    ui.icon("drag_indicator").classes("sw-grip")
                    ui.label(f"{row.layer}: {row.layer_label}").classes("sw-grow")
                    move = functools.partial(self._move_layer, place)
                    self._buttons(f"layer {row.layer}", move, "without_layer", row.layer)
                    if row.joint:
                        with ui.element("div").classes("sw-joint"):
                            ui.label(f"joint: {row.joint_label}").classes("sw-grow")
                            move = functools.partial(self._move_joint, place)
                            self._buttons(f"joint behind {row.layer}", move, "without_joint", row.layer)

    def _buttons(self, what: str, move: Callable[[int], Any], without: str, layer: str) -> None:
        for name, icon, do in (
            ("up", "arrow_upward", functools.partial(move, -1)),
            ("down", "arrow_downward", functools.partial(move, 1)),
            ("remove", "close", functools.partial(self._change, without, layer)),
        ):
            button = ui.button(icon=icon, on_click=do).props("flat dense round size=sm")
            button.props(f'aria-label="{parts.html.escape(what)} {name}"')

    def _layer_form(self, materials: list[str]) -> None:
        with ui.expansion("Add a layer").props("dense").classes("sw-full"):
            self._fields: dict[str, Any] = {key: _typed(label, text) for key, (label, text) in FIELDS.items()}
            self._fields["material"] = _choice("material of the layer", [*materials, NO_MATERIAL], materials[0])
            self._fields |= {key: _typed(label, "") for key, label in OWN.items()}
            self._behind = _choice("layer behind", [LOADED_FACE], LOADED_FACE)
            ui.button("add layer", icon="add", on_click=self._add_layer).props("outline dense no-caps")

    def _joint_form(self) -> None:
        with ui.expansion("Add a joint").props("dense").classes("sw-full"):
            self._joint_behind = _choice("joint behind", [], None)
            first = next(iter(JOINTS))
            self._kind = _choice("kind of the joint", list(JOINTS), first)
            self._kind.on_value_change(self._begin_properties)
            self._properties = ui.textarea("properties, a line each", value=JOINTS[first])
            self._properties.props("dense outlined rows=2 autogrow").classes("sw-full")
            ui.button("add joint", icon="add", on_click=self._add_joint).props("outline dense no-caps")

    def _begin_properties(self) -> None:
        """Set the properties to those of the chosen kind."""
        self._properties.value = JOINTS[str(self._kind.value)]

    async def _add_layer(self) -> None:
        behind = "" if self._behind.value == LOADED_FACE else self._behind.value
        fields = {key: str(box.value or "") for key, box in self._fields.items() if box.value != NO_MATERIAL}
        await self._change("with_layer", behind, fields)

    async def _add_joint(self) -> None:
        if self._joint_behind.value is None:
            ui.notify("a joint stands between two layers, one at a place: none is free")
            return
        lines = str(self._properties.value or "").splitlines()
        await self._change("with_joint", self._joint_behind.value, self._kind.value, lines)

    async def _dropped(self, event: Any) -> None:
        names = [row.layer for row in self.rows]
        names.insert(event.new_index, names.pop(event.old_index))
        await self._change("rearranged", names, [row.joint for row in self.rows])

    async def _move_layer(self, place: int, step: int) -> None:
        names = [row.layer for row in self.rows]
        if 0 <= place + step < len(names):
            names[place], names[place + step] = names[place + step], names[place]
            await self._change("rearranged", names, [row.joint for row in self.rows])

    async def _move_joint(self, place: int, step: int) -> None:
        joints = [row.joint for row in self.rows]
        if 0 <= place + step < len(joints) - 1:  # none behind the last layer, where the bar ends
            joints[place], joints[place + step] = joints[place + step], joints[place]
            await self._change("rearranged", [row.layer for row in self.rows], joints)

    async def _change(self, function: str, *arguments: Any) -> None:
        """Show the case that a function of `strikewave.web.case_values` makes of this one."""
        source = self.source()
        text = await parts.tried(lambda: self.desk.lookers.ask(f"{LAYERS}:{function}", source, *arguments))
        if text is None:
            self._build()  # as it was, where it was dragged
            return
        name = source.name if source.name.endswith(ENDING) else source.name + ENDING
        await self.changed(CaseState(name, text))


def _typed(label: str, value: str) -> ui.input:
    return ui.input(label, value=value).props("dense outlined").classes("sw-full")


def _choice(label: str, options: list[str], value: str | None) -> ui.select:
    return ui.select(options, value=value, label=label).props("dense outlined options-dense").classes("sw-full")
