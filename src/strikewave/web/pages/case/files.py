"""What can be taken away of a case: itself, its report, its numbers; and the drawing of a machine."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

from nicegui import ui

from strikewave.web import parts
from strikewave.web.case.state import CaseSource
from strikewave.web.desk import Desk, started
from strikewave.web.jobs import PageJob
from strikewave.web.pages.case.kinds import CASES, CaseKind
from strikewave.web.sessions import Session, clean_name


class CaseFiles:
    """Buttons for what can be taken away.

    Parameters
    ----------
    desk, session, kind
        Of the page.
    source : callable
        Returns the state.
    view : callable
        Returns what is shown of it.
    """

    def __init__(
        self,
        desk: Desk,
        session: Session,
        kind: CaseKind,
        source: Callable[[], CaseSource],
        view: Callable[[], dict[str, Any]],
    ) -> None:
        self.desk, self.session, self.kind, self.source, self.view = desk, session, kind, source, view
        with parts.box("Take away"), ui.element("div").classes("sw-row"):
            ui.button("case (.toml)", icon="description", on_click=self._save_case).props("outline dense no-caps")
            for name, icon, file in kind.files:
                press = functools.partial(self._save_file, file)
                ui.button(name, icon=icon, on_click=press).props("outline dense no-caps")
        if kind.drawn:
            self.drawing = ui.expansion("Drawing of the machine", on_value_change=self._draw)

    async def _save_case(self) -> None:
        source = self.source()
        text = await parts.tried(lambda: self.desk.lookers.ask(f"{CASES}:saved", source))
        if text is not None:
            ui.download.content(text, f"{clean_name(source.name)}.toml")

    async def _save_file(self, wanted: str) -> None:
        texts = self.view().get("texts", {})
        if wanted in texts:
            ui.download.content(texts[wanted], wanted)
            return
        note = ui.notification(f"making {wanted}", spinner=True, timeout=None)
        job = PageJob(f"{self.kind.view}:files", self.source(), wanted)
        content = await parts.tried(lambda: started(self.session, job))
        note.dismiss()
        if content is not None:
            ui.download.content(content, wanted)

    async def _draw(self, event: Any) -> None:
        if not event.value:
            return
        self.drawing.clear()
        with self.drawing:
            ui.spinner()
        job = PageJob(f"{self.kind.view}:drawings", self.source())
        pictures = await parts.tried(lambda: started(self.session, job))
        self.drawing.clear()
        with self.drawing:
            if not pictures:
                ui.label("this kind of machine is not drawn").classes("sw-soft")
            for svg, caption in pictures or ():
                parts.svg_picture(svg, caption)
