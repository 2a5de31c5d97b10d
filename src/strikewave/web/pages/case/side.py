"""The left side of a page of a case: which one, and its quantities with their sliders."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from nicegui import ui

from strikewave.web import parts
from strikewave.web.case.edited_field import EditedField
from strikewave.web.case.state import CaseState
from strikewave.web.live.field import LiveField
from strikewave.web.pages.case.kinds import CaseKind

ONLY_TYPED = ("solver", "recorder")
"""Tables whose quantities are no matter of a hand on a slider."""
MOST_GUESSED = 6
"""Fields with sliders of a case of which nothing is said."""


class SideActions(NamedTuple):
    """What the left side asks of its page: a field moved or typed, one step back, and what the buttons do."""

    moved: Callable[[str, float], Any]
    typed: Callable[[str, str], Any]
    chosen: Callable[[CaseState], Any]
    undo: Callable[[], Any]
    reset: Callable[[], Any]
    keep_beside: Callable[[], Any]
    run: Callable[[], Any]
    stop: Callable[[], Any]


class CaseSide:
    """The left side of a page.

    Parameters
    ----------
    kind : CaseKind
    actions : SideActions
    drop_zone : callable
        Makes the field that files are dropped on, of its label.
    titles : mapping of str to str
        The built-in cases.
    fields : mapping of str to EditedField
    state : CaseState
        What is shown at first.
    values : mapping of str to float
        Its quantities, SI, by path.
    important : sequence of str
        Fields that are known to matter most; empty where that is not known yet.
    """

    def __init__(
        self,
        kind: CaseKind,
        actions: SideActions,
        drop_zone: Callable[[str], object],
        titles: Mapping[str, str],
        fields: Mapping[str, EditedField],
        state: CaseState,
        values: Mapping[str, float],
        important: Sequence[str],
    ) -> None:
        self.kind, self.actions, self.fields = kind, actions, fields
        self.state, self.values = state, dict(values)
        self.important = important
        self._shown: dict[str, LiveField] = {}
        self._titles = titles
        self._choice(drop_zone)
        self._place = ui.element("div").classes("sw-side")
        self.build()

    def _options(self) -> dict[str, str]:
        """Return the built-in cases with their titles, the case that is shown among them."""
        name = self.state.name
        return dict(self._titles) if name in self._titles and not self.state.text else {name: name, **self._titles}

    async def _chosen(self, event: Any) -> None:
        if event.value != self.state.name:
            await self.actions.chosen(CaseState(str(event.value)))

    def _choice(self, drop_zone: Callable[[str], object]) -> None:
        with parts.box("Case"):
            self._select = ui.select(
                self._options(), value=self.state.name, label="built-in case", on_change=self._chosen
            )
            self._select.props("dense outlined options-dense").classes("sw-full")
            drop_zone("or drop a case file (.toml)")
            with ui.element("div").classes("sw-row sw-gap"):
                if self.kind.waits:
                    ui.button("run", icon="play_arrow", on_click=self.actions.run).props("unelevated dense no-caps")
                    ui.button("stop", icon="stop", on_click=self.actions.stop).props("outline dense no-caps")
                for words, icon, do, hint in (
                    ("undo", "undo", self.actions.undo, "Ctrl+Z"),
                    ("as the case", "restart_alt", self.actions.reset, "undo all changes"),
                    ("keep beside", "compare", self.actions.keep_beside, "compare with what you change next"),
                ):
                    ui.button(words, icon=icon, on_click=do).props("flat dense no-caps").tooltip(hint)

    def build(self) -> None:
        """Put the fields on the page: those that matter most with sliders, the rest folded by tables."""
        self._place.clear()
        self._shown = {}
        important = [path for path in self.important if path in self.fields]
        usual = [path for path in self.kind.main if path in self.fields]
        guessed = [path for path in self.fields if path.endswith((".length", ".velocity"))][:MOST_GUESSED]
        first = important or usual or guessed
        with self._place:
            with parts.box("What matters most" if important else "Main settings"):
                if important:
                    ui.label("from the shares of the bands of the results, the largest first").classes("sw-soft")
                for path in first:
                    self._field(path, has_slider=True)
            for table in dict.fromkeys(path.partition(".")[0] for path in self.fields):
                rest = [path for path in self.fields if path.partition(".")[0] == table and path not in first]
                if rest:
                    with ui.expansion(table.capitalize()).props("dense"):
                        for path in rest:
                            self._field(path, has_slider=table not in ONLY_TYPED)

    def _field(self, path: str, has_slider: bool) -> None:
        shown = LiveField(self.fields[path], self.typed(path), self._number(path), has_slider)
        shown.on_move(functools.partial(self.actions.moved, path))
        shown.on_type(functools.partial(self.actions.typed, path))
        shown.on("back", self.actions.undo)
        self._shown[path] = shown

    def typed(self, path: str) -> str:
        """Return what stands in a field."""
        return self.state.changes.get(path, self.fields[path].typed)

    def _number(self, path: str) -> float:
        """Return the value of a field in the unit of its slider."""
        one = self.fields[path]
        return one.shown(self.values[path]) if path in self.values else one.value

    def show(self, state: CaseState, values: Mapping[str, float]) -> None:
        """Show another state in all fields."""
        self.state, self.values = state, dict(values)
        for path, shown in self._shown.items():
            shown.show(self.typed(path), self._number(path))

    def open(self, state: CaseState, fields: Mapping[str, EditedField], values: Mapping[str, float]) -> None:
        """Show another case, whose fields are others."""
        self.state, self.fields, self.values = state, fields, dict(values)
        self._select.set_options(self._options(), value=state.name)
        self.build()

    def show_typed(self, path: str) -> None:
        """Show what a field holds, where something else was typed."""
        self._shown[path].show(self.typed(path), self._number(path))

    def show_moved(self, path: str, value: float) -> str:
        """Show in words where the slider of a field was moved to, and return them."""
        text = self.fields[path].text(value)
        self.values[path] = value * self.fields[path].scale
        self._shown[path].show(text)
        return text
