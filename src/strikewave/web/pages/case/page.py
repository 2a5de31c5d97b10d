"""A page of one case: settings on the left, what they do on the right."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from nicegui import Client, background_tasks, ui
from starlette.requests import Request

from strikewave.base.errors import StrikewaveError
from strikewave.web import parts
from strikewave.web.case.state import CaseSource, CaseState, address, is_case
from strikewave.web.desk import Desk
from strikewave.web.dropped_files import DroppedFiles
from strikewave.web.pages.case.files import CaseFiles
from strikewave.web.pages.case.kinds import CASES, CaseKind
from strikewave.web.pages.case.runs import CaseRuns
from strikewave.web.pages.case.section_readings import KEY as SECTION
from strikewave.web.pages.case.shown import CaseShown
from strikewave.web.pages.case.side import CaseSide, SideActions
from strikewave.web.pages.case.stack_layers import StackLayers
from strikewave.web.pages.case.wanted_blows import WantedBlows
from strikewave.web.sessions import Session

FOLDER = "cases"
"""Folder, of each session, of what is dropped on the pages of cases."""
MOST_UNDONE = 100
BESIDE = "beside"
"""Key of the address for the changes of the state that is kept beside."""
ROTARY = "machine.strikers"
"""What only rotary machines have: settings are found for these."""
_important: dict[str, list[str]] = {}
"""Fields that matter most by case, as its last full run found them."""
MOST_REMEMBERED = 64


def add(desk: Desk, kind: CaseKind) -> None:
    """Add the page of a kind of case to the app."""

    @ui.page(kind.place)
    async def page(request: Request, client: Client) -> None:
        given = list(request.query_params.multi_items())

        async def asked(session: Session) -> tuple[CaseState, Mapping[str, str], dict[str, Any]]:
            state, kept = CaseState.read(given, kind.usual), CaseState.read(given, kind.usual, BESIDE).changes
            return (
                state,
                kept,
                await desk.lookers.ask(f"{CASES}:opened", state.source(session.place(FOLDER)), kind.program),
            )

        opened = await desk.open_page(kind.place, client, asked)
        if opened is not None:
            session, (state, kept, known) = opened
            shown = CasePage(desk, session, kind, state, known, dict(given).get(SECTION, ""))
            shown.begin(kept if BESIDE in dict(given) else None)


class CasePage:
    """One open page: its state, and how it changes."""

    def __init__(
        self, desk: Desk, session: Session, kind: CaseKind, state: CaseState, opened: dict[str, Any], section: str
    ) -> None:
        self.desk, self.session, self.kind, self.state = desk, session, kind, state
        self.undone: list[CaseState] = []
        self.beside: CaseState | None = None
        with ui.element("main").classes("sw-page").props('id="main"'):
            with ui.element("div").classes("sw-side"):
                self.side = CaseSide(
                    kind,
                    self._actions(),
                    lambda label: DroppedFiles(session, FOLDER, label, self._dropped),
                    opened["titles"],
                    opened["fields"],
                    state,
                    opened["values"],
                    _important.get(self._name, ()),
                )
                stack = opened["stack"]
                self.layers = StackLayers(desk, self._source, self.set, stack) if stack else None
            with ui.element("div").classes("sw-main"):
                self.shown = CaseShown(session, kind, section, self._link)
                self.runs = CaseRuns(desk, session, kind, self.shown, self._source(), self._rested, self._finished)
                if kind.has_wishes and ROTARY in opened["fields"]:
                    WantedBlows(desk, session, self._source)
                CaseFiles(desk, session, kind, self._source, lambda: self.shown.view)
                self.same = ui.element("div").classes("sw-main")
        ui.context.client.on_delete(self.runs.leave)
        ui.keyboard(self._key, ignore=["input", "select", "textarea"])
        self._same()

    def _actions(self) -> SideActions:
        return SideActions(
            moved=self.move,
            typed=self.type,
            chosen=self.open,
            undo=self.undo,
            reset=self.reset,
            keep_beside=self.keep_beside,
            run=self.run,
            stop=self.stop,
        )

    def _source(self, state: CaseState | None = None) -> CaseSource:
        return (state or self.state).source(self.session.place(FOLDER))

    def begin(self, beside: Mapping[str, str] | None) -> None:
        """Show what the address asks for, and beside it what it keeps."""
        if self.kind.waits:
            self.shown.say("nothing is run yet: press run")
            return
        self.runs.follow(self._source())
        if beside is not None:
            self.beside = CaseState(self.state.name, self.state.text, beside)
            background_tasks.create(self._run_beside(self.beside), name="beside")

    # what the user does

    async def _dropped(self, paths: Sequence[Path]) -> None:
        cases = []
        for path in filter(is_case, paths):
            try:
                cases.append(CaseState.of_file(path))
            except StrikewaveError as error:
                ui.notify(f"refused: {error}", type="warning")
        if cases:
            await self.open(cases[-1])
        elif paths:
            ui.notify("kept; a case that names these files can be dropped now", type="info")

    async def open(self, state: CaseState) -> None:
        """Show another case, on a page of its own address; one that is refused leaves this page as it is."""
        ask = self.desk.lookers.ask
        if await parts.tried(lambda: ask(f"{CASES}:opened", self._source(state), self.kind.program)) is not None:
            ui.navigate.to(address(self.kind.place, state.query()))

    def move(self, path: str, value: float) -> None:
        """Follow the slider of a field."""
        if not self.runs.is_moving:  # undo goes back by a movement, not by a step of it
            self._remember()
        text = self.side.show_moved(path, value)
        usual = self.side.fields[path].typed
        self._change(self.state.without(path) if text == usual else self.state.changed(path, text))

    async def type(self, path: str, text: str) -> None:
        """Set a field to what was typed; what is refused says why, and the field keeps what it had."""
        field, before = self.side.fields[path], self.side.typed(path)
        typed, usual = field.with_unit(text), field.typed
        if typed == before:
            self.side.show_typed(path)
            return
        await self.set(self.state.without(path) if typed == usual else self.state.changed(path, typed))
        self.side.show_typed(path)

    async def set(self, state: CaseState) -> None:
        """Show another state, where it can be one: of this case, or with other layers."""
        if await self._filled(state):
            self._remember()
            self._change(state)

    async def _filled(self, state: CaseState) -> bool:
        """Show a state in all fields, which are others in a case with other layers; False where it is refused."""
        source, ask = self._source(state), self.desk.lookers.ask
        if state.is_same_case(self.state):
            values = await parts.tried(lambda: ask(f"{CASES}:values", source))
            if values is not None:
                self.side.show(state, values)
            return values is not None
        opened = await parts.tried(lambda: ask(f"{CASES}:opened", source, self.kind.program))
        if opened is not None:
            self.side.open(state, opened["fields"], opened["values"])
            if self.layers is not None:
                self.layers.show(opened["stack"])
        return opened is not None

    def _remember(self) -> None:
        """Keep the state for undo."""
        self.undone = [*self.undone[-MOST_UNDONE + 1 :], self.state]

    async def undo(self) -> None:
        """Go back by one change."""
        if not self.undone:
            ui.notify("nothing to undo")
            return
        state = self.undone.pop()
        if await self._filled(state):
            self._change(state)

    async def reset(self) -> None:
        """Go back to the case as it is."""
        await self.set(CaseState(self.state.name, self.state.text))

    async def _key(self, event: Any) -> None:
        if event.action.keydown and event.key == "z" and (event.modifiers.ctrl or event.modifiers.meta):
            await self.undo()

    def run(self) -> None:
        """Begin the full run."""
        self.runs.run()

    def stop(self) -> None:
        """Stop the run that is under way."""
        self.runs.stop()

    def keep_beside(self) -> None:
        """Keep this state, to be compared with what is changed next; a second press lets it go."""
        self.beside = self.state if self.beside is None else None
        self.shown.keep_beside(None if self.beside is None else self.shown.view or None)
        if self.beside is not None and not self.runs.is_full and not self.kind.waits:
            background_tasks.create(self._run_beside(self.beside), name="beside")
        self._link()

    async def _run_beside(self, kept: CaseState) -> None:
        """Show the full run of the state that is kept beside, unless it was let go meanwhile."""
        view = await self.runs.full_view(self._source(kept))
        if view is not None and self.beside == kept:
            self.shown.keep_beside(view)

    # what follows from it

    def _change(self, state: CaseState) -> None:
        self.state = self.side.state = state
        self.runs.follow(self._source())

    def _rested(self) -> None:
        """Have the address hold the state, and the command lines with it."""
        self._link()
        self._same()

    def _finished(self, view: dict[str, Any]) -> None:
        """Have sliders for what matters most, once a full run has found it."""
        if self._name not in _important and view.get("important"):
            if len(_important) >= MOST_REMEMBERED:
                _important.pop(next(iter(_important)))
            self.side.important = _important[self._name] = view["important"]
            self.side.build()

    @property
    def _name(self) -> str:
        """What the case is known by, whatever is changed in it."""
        return self.state.text or self.state.name

    def _link(self) -> None:
        query = self.state.query()
        if self.beside is not None and self.beside.is_same_case(self.state):
            query += [(BESIDE, change) for change in self.beside.source().changes] or [(BESIDE, "")]
        query += self.shown.section.query if self.shown.section else []
        with self.same:
            ui.navigate.history.replace(address(self.kind.place, query))

    def _same(self) -> None:
        """Show the command and the lines that give the same."""
        self.same.clear()
        with self.same, parts.box("The same without this page"):
            if self.state.text:
                ui.label(f"save the case as {self.state.file} first").classes("sw-soft")
            parts.code("command line", self.state.command(self.kind.program))
            more = ", band=True" if self.kind.quick else ""
            parts.code("Python", self.state.python(self.kind.call, more))
