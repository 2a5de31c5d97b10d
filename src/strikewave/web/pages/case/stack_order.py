"""Layers and joints as a list that is dragged into another order, or moved by buttons."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

from nicegui import ui

from strikewave.web import parts
from strikewave.web.case.stack_row import StackRow
from strikewave.web.case.state import CaseSource, CaseState
from strikewave.web.desk import Desk

ORDER = "strikewave.web.case.layer_order"
ENDING = "-reordered"
"""Of the name of a case whose layers were put in another order."""


class StackOrder:
    """The layers of a bar from the loaded face on; another order is another case, on a page of its own address.

    Parameters
    ----------
    desk : Desk
    source : callable
        Returns the state.
    opened : callable
        Takes the case in another order.
    """

    def __init__(
        self, desk: Desk, source: Callable[[], CaseSource], opened: Callable[[CaseState], Any], rows: list[StackRow]
    ) -> None:
        self.desk, self.source, self.opened, self.rows = desk, source, opened, rows
        self._items: dict[int, str] = {}
        with parts.box("Layers, from the loaded face on"):
            ui.label(
                "drag a layer, or move it by its arrows; joints stay at their places, and have arrows too"
            ).classes("sw-soft")
            self._list = ui.column().classes("sw-stack")
            self._list.make_sortable(on_end=self._dropped, handle=".sw-grip")
        self._build()

    def _build(self) -> None:
        self._list.clear()
        self._items = {}
        with self._list:
            for place, row in enumerate(self.rows):
                with ui.element("div").classes("sw-layer") as item:
                    self._items[item.id] = row.layer
                    ui.icon("drag_indicator").classes("sw-grip")
                    ui.label(f"{row.layer}: {row.layer_words}").classes("sw-grow")
                    self._arrows(f"layer {row.layer}", functools.partial(self._move_layer, place))
                    if row.joint:
                        with ui.element("div").classes("sw-joint"):
                            ui.label(f"joint: {row.joint_words}").classes("sw-grow")
                            self._arrows(f"joint behind {row.layer}", functools.partial(self._move_joint, place))

    def _arrows(self, what: str, move: Callable[[int], Any]) -> None:
        for words, icon, step in (("up", "arrow_upward", -1), ("down", "arrow_downward", 1)):
            button = ui.button(icon=icon, on_click=functools.partial(move, step)).props("flat dense round size=sm")
            button.props(f'aria-label="{parts.html.escape(what)} {words}"')

    async def _dropped(self, event: Any) -> None:
        names = [row.layer for row in self.rows]
        names.insert(event.new_index, names.pop(event.old_index))
        await self._open(names, [row.joint for row in self.rows])

    async def _move_layer(self, place: int, step: int) -> None:
        names = [row.layer for row in self.rows]
        if 0 <= place + step < len(names):
            names[place], names[place + step] = names[place + step], names[place]
            await self._open(names, [row.joint for row in self.rows])

    async def _move_joint(self, place: int, step: int) -> None:
        joints = [row.joint for row in self.rows]
        if 0 <= place + step < len(joints) - 1:  # none behind the last layer, where the bar ends
            joints[place], joints[place + step] = joints[place + step], joints[place]
            await self._open([row.layer for row in self.rows], joints)

    async def _open(self, layers: list[str], joints: list[str]) -> None:
        source = self.source()
        text = await parts.tried(lambda: self.desk.lookers.ask(f"{ORDER}:rearranged", source, layers, joints))
        if text is None:
            self._build()  # as it was
            return
        name = source.name if source.name.endswith(ENDING) else source.name + ENDING
        await self.opened(CaseState(name, text))
