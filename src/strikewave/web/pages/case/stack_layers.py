"""Layers and joints as a list: dragged into another order, or moved by buttons; added and removed."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

from nicegui import ui

from strikewave.web import parts
from strikewave.web.case.stack_row import JOINTS, ListedStack
from strikewave.web.case.state import CaseSource, CaseState
from strikewave.web.desk import Desk

LAYERS = "strikewave.web.case.layers"
ENDING = "-layers"
"""Of the name of a case whose layers were changed."""
LOADED_FACE = "the loaded face"
FIELDS = {
    "name": ("name of the layer", ""),
    "length": ("length of the layer", "10 mm"),
    "diameter": ("diameter of the layer", "20 mm"),
    "area": ("or its area, such as 300 mm^2", ""),
}
"""What is typed of a new layer: what it is called, and what stands there at first; its material is chosen."""
OWN = {
    "density": "density of its own, such as 1850 kg/m^3",
    "modulus": "modulus of its own, such as 24 GPa",
    "poissons_ratio": "Poisson's ratio, such as 0.3",
}
"""What stands for the numbers of the material where it is typed, and what it is called."""
NO_MATERIAL = "none: numbers of its own"


class StackLayers:
    """The layers of a bar from the loaded face on; a change of them is another case on the same page.

    Parameters
    ----------
    desk : Desk
    source : callable
        Returns the state.
    changed : callable
        Takes the case with other layers.
    listed : ListedStack
    """

    def __init__(
        self,
        desk: Desk,
        source: Callable[[], CaseSource],
        changed: Callable[[CaseState], Any],
        listed: ListedStack,
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
                    ui.label(f"{row.layer}: {row.layer_words}").classes("sw-grow")
                    move = functools.partial(self._move_layer, place)
                    self._buttons(f"layer {row.layer}", move, "without_layer", row.layer)
                    if row.joint:
                        with ui.element("div").classes("sw-joint"):
                            ui.label(f"joint: {row.joint_words}").classes("sw-grow")
                            move = functools.partial(self._move_joint, place)
                            self._buttons(f"joint behind {row.layer}", move, "without_joint", row.layer)

    def _buttons(self, what: str, move: Callable[[int], Any], without: str, layer: str) -> None:
        for words, icon, do in (
            ("up", "arrow_upward", functools.partial(move, -1)),
            ("down", "arrow_downward", functools.partial(move, 1)),
            ("remove", "close", functools.partial(self._change, without, layer)),
        ):
            button = ui.button(icon=icon, on_click=do).props("flat dense round size=sm")
            button.props(f'aria-label="{parts.html.escape(what)} {words}"')

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
        """Let the properties begin from those of the kind that is chosen."""
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

    async def _change(self, how: str, *given: Any) -> None:
        """Show the case that a function of `strikewave.web.case.layers` makes of this one."""
        source = self.source()
        text = await parts.tried(lambda: self.desk.lookers.ask(f"{LAYERS}:{how}", source, *given))
        if text is None:
            self._build()  # as it was, where it was dragged
            return
        name = source.name if source.name.endswith(ENDING) else source.name + ENDING
        await self.changed(CaseState(name, text))


def _typed(label: str, value: str) -> ui.input:
    return ui.input(label, value=value).props("dense outlined").classes("sw-full")


def _choice(label: str, options: list[str], value: str | None) -> ui.select:
    return ui.select(options, value=value, label=label).props("dense outlined options-dense").classes("sw-full")
