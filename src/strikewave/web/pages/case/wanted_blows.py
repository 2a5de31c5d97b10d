"""The part of the page of machines that finds settings: for a period, a peak and a width, or for equal blows."""

from __future__ import annotations

from collections.abc import Callable

from nicegui import ui

from strikewave.web import parts
from strikewave.web.case.state import CaseSource
from strikewave.web.desk import Desk
from strikewave.web.pages.study.request import KINDS, StudyRequest
from strikewave.web.sessions import Session
from strikewave.web.workbench import Workbench

WISHES = "strikewave.web.pages.case.machine_wishes:wishes"
STUDY = "strikewave.web.pages.study.view:study"


class WantedBlows:
    """Forms for what the blows shall be, each with its button; what is found is opened by a link.

    Parameters
    ----------
    desk, session
        Of the page.
    source : callable
        Returns the state, in the folder of its files.
    """

    def __init__(self, desk: Desk, session: Session, source: Callable[[], CaseSource]) -> None:
        self.desk, self.session, self.source = desk, session, source
        self._boxes: dict[tuple[str, str], ui.input | ui.textarea] = {}
        self._folded = ui.expansion("Find settings: match the period, equal blows", on_value_change=self._fill)
        with self._folded, ui.element("div").classes("sw-main"):
            with ui.element("div").classes("sw-charts"):
                self._form("settings", "Match the period", "match the period")
                self._form("design", "Equal blows", "equal blows")
            with ui.element("div").classes("sw-row"):
                ui.button("stop", icon="stop", on_click=self.stop).props("outline dense no-caps")
            self.bench = Workbench(session, "Each setting that is found is checked by full runs, and opened by a link.")

    def _form(self, kind: str, title: str, button: str) -> None:
        with parts.box(title):
            ui.label(KINDS[kind].what).classes("sw-soft")
            for text in KINDS[kind].texts:
                make = ui.textarea if text.lines else ui.input
                box = make(text.label, placeholder=text.example).classes("sw-full")
                self._boxes[kind, text.key] = box.props(
                    "dense outlined stack-label" + (" rows=2 autogrow" if text.lines else "")
                )
            ui.button(button, icon="search", on_click=lambda: self.begin(kind)).props("unelevated dense no-caps")

    async def _fill(self, event: object) -> None:
        """Fill in what the blows are now, and what may be changed, where nothing was typed."""
        if not self._folded.value:
            return
        wishes = await parts.tried(lambda: self.desk.lookers.ask(WISHES, self.source()))
        for (kind, key), box in self._boxes.items():
            if not box.value and wishes:
                box.value = "\n".join(wishes.get(kind, {}).get(key, ()))

    def begin(self, kind: str) -> None:
        """Look for settings."""
        texts = tuple(
            (key, tuple(str(box.value or "").splitlines())) for (of, key), box in self._boxes.items() if of == kind
        )
        place = str(self.session.place("studies"))
        asked = StudyRequest(kind, self.source()._replace(folder=place), texts)
        self.bench.begin(STUDY, asked, same=asked.commands())

    def stop(self) -> None:
        """Stop looking."""
        self.bench.stop()
