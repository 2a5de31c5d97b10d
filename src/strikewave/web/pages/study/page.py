"""The page of fits and studies: a request, its progress, and its result."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from nicegui import Client, ui
from starlette.requests import Request

from strikewave.base.errors import StrikewaveError
from strikewave.web import parts
from strikewave.web.case_state import CaseState, address, is_case
from strikewave.web.desk import Desk
from strikewave.web.pages.study.request import KINDS, StudyRequest
from strikewave.web.parts import DroppedFiles
from strikewave.web.sessions import Session
from strikewave.web.workbench import Workbench

PLACE, USUAL, FOLDER = "/study", "li-ma-2019", "studies"
VIEW = "strikewave.web.pages.study.view"


def add(desk: Desk) -> None:
    """Add the page to the app."""

    @ui.page(PLACE)
    async def study(request: Request, client: Client) -> None:
        given = list(request.query_params.multi_items())

        async def asked(session: Session) -> tuple[CaseState, list[str]]:
            return CaseState.read(given, USUAL), await desk.lookers.ask(f"{VIEW}:study_cases")

        opened = await desk.open_page(PLACE, client, asked)
        if opened is not None:
            session, (state, cases) = opened
            StudyPage(session, state, given, cases).build()


class StudyPage:
    """One open page of studies."""

    def __init__(self, session: Session, state: CaseState, given: list[tuple[str, str]], cases: list[str]) -> None:
        self.session, self.state, self.given, self.cases = session, state, given, cases
        asked = dict(given).get("study", "sweep")
        self.kind = asked if asked in KINDS else "sweep"
        self.boxes: dict[str, Any] = {}

    def build(self) -> None:
        """Put everything on the page."""
        with ui.element("main").classes("sw-page").props('id="main"'):
            with ui.element("div").classes("sw-side"):
                with parts.box("Study"):
                    ui.select(list(KINDS), value=self.kind, label="kind of study", on_change=self._other_kind).props(
                        "dense outlined options-dense"
                    ).classes("sw-full")
                    self.what = ui.label("").classes("sw-soft")
                with parts.box("Case"):
                    options = [*([] if self.state.name in self.cases else [self.state.name]), *self.cases]
                    ui.select(options, value=self.state.name, label="case", on_change=self._other_case).props(
                        "dense outlined options-dense"
                    ).style("width:100%")
                    label = "or drop a case (.toml), and records to fit"
                    self.files = DroppedFiles(self.session, FOLDER, label, self._dropped)
                    self.changes = ui.textarea(
                        "changes, a line each", value="\n".join(self.state.source().changes), on_change=self._changed
                    ).props('dense outlined stack-label rows=2 autogrow placeholder="machine.speed=700 rpm"')
                    self.changes.style("width:100%")
                self.form = ui.element("div").style("width:100%")
                with ui.element("div").classes("sw-row"):
                    ui.button("begin, or go on", icon="play_arrow", on_click=self.begin).props(
                        "unelevated dense no-caps"
                    )
                    ui.button("stop", icon="stop", on_click=self.stop).props("outline dense no-caps")
            with ui.element("div").classes("sw-main"):
                empty = "Nothing is asked yet. A sweep or a design that was stopped goes on where it was."
                self.bench = Workbench(self.session, empty)
        self._form()

    def _form(self) -> None:
        self.form.clear()
        self.boxes = {}
        kind = KINDS[self.kind]
        self.what.text = kind.what
        with self.form, parts.box("What is asked"):
            for text in kind.texts:
                value = "\n".join(value for key, value in self.given if key == text.key)
                make = ui.textarea if text.lines else ui.input
                box = make(text.label, value=value, placeholder=text.example, on_change=self._changed)
                box.props("dense outlined stack-label" + (" rows=2 autogrow" if text.lines else ""))
                self.boxes[text.key] = box.style("width:100%; margin-bottom:.35rem")

    def _other_kind(self, event: Any) -> None:
        self.given = [pair for pair in self._query() if pair[0] != "study"]
        self.kind = str(event.value)
        self._form()
        self._changed()

    def _other_case(self, event: Any) -> None:
        self.state = CaseState(str(event.value))
        self._changed()

    def _changed(self) -> None:
        """Mark the results as those of other settings."""
        self.bench.changed("press begin")

    async def _dropped(self, paths: Sequence[Path]) -> None:
        for path in paths:
            try:
                if is_case(path):
                    self.state = CaseState.of_file(path)
                    self._changed()
                    ui.notify(f"the case is {path.name} now", type="positive")
                else:
                    ui.notify(f"{path.name} is kept: name it to fit to it", type="positive")
            except StrikewaveError as error:
                ui.notify(f"refused: {error}", type="warning")

    def stop(self) -> None:
        """Stop the current work; its finished runs are kept."""
        self.bench.stop()

    def request(self) -> StudyRequest:
        """Return the current request."""
        lines = [line.partition("=") for line in str(self.changes.value or "").splitlines()]
        changes = {path.strip(): value.strip() for path, _, value in lines if path.strip()}
        state = CaseState(self.state.name, self.state.text, changes)
        texts = tuple((key, tuple(str(box.value or "").splitlines())) for key, box in self.boxes.items())
        return StudyRequest(self.kind, state.source(self.files.place), texts)

    def _query(self) -> list[tuple[str, str]]:
        asked = self.request()
        state = CaseState(asked.source.name, asked.source.text, dict(c.split("=", 1) for c in asked.source.changes))
        return [
            ("study", self.kind),
            *state.query(),
            *((key, line) for key, lines in asked.texts for line in lines if line),
        ]

    def begin(self) -> None:
        """Begin or continue the current request."""
        asked = self.request()
        ui.navigate.history.replace(address(PLACE, self._query()))
        self.bench.begin(f"{VIEW}:study", asked, same=asked.commands())
