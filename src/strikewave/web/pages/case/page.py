"""A page of one case: settings on the left, results on the right."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from nicegui import Client, background_tasks, ui
from starlette.requests import Request

from strikewave.base.errors import StrikewaveError
from strikewave.web import parts
from strikewave.web.case_state import CaseSource, CaseState, EditedField, address, is_case
from strikewave.web.desk import Desk, started
from strikewave.web.jobs import PageJob
from strikewave.web.pages.case.bar_parts import KEY as SECTION
from strikewave.web.pages.case.bar_parts import StackLayers
from strikewave.web.pages.case.kinds import CASES, CaseKind
from strikewave.web.pages.case.results import CaseRuns, CaseShown
from strikewave.web.pages.study.request import KINDS, StudyRequest
from strikewave.web.parts import DroppedFiles, LiveField
from strikewave.web.sessions import Session, clean_name
from strikewave.web.workbench import Workbench

FOLDER = "cases"
"""Folder, in each session, of the files dropped on the pages of cases."""
MOST_UNDONE = 100
BESIDE = "beside"
"""Key of the address for the changes of the state that is kept beside."""
ROTARY = "machine.strikers"
"""Path that only rotary machines have, for which settings can be searched."""
_important: dict[str, list[str]] = {}
"""Most important fields by case, from its last full run."""
MOST_REMEMBERED = 64


def add(desk: Desk, kind: CaseKind) -> None:
    """Add the page of a kind of case to the app."""

    @ui.page(kind.place)
    async def page(request: Request, client: Client) -> None:
        query = list(request.query_params.multi_items())

        async def asked(session: Session) -> tuple[CaseState, Mapping[str, str], dict[str, Any]]:
            state, beside = CaseState.read(query, kind.usual), CaseState.read(query, kind.usual, BESIDE).changes
            source = state.source(session.place(FOLDER))
            return state, beside, await desk.lookers.ask(f"{CASES}:opened", source, kind.program)

        opened = await desk.open_page(kind.place, client, asked)
        if opened is not None:
            session, (state, beside, content) = opened
            shown = CasePage(desk, session, kind, state, content, dict(query).get(SECTION, ""))
            shown.begin(beside if BESIDE in dict(query) else None)


class CasePage:
    """One open page: its state, and its changes."""

    def __init__(
        self, desk: Desk, session: Session, kind: CaseKind, state: CaseState, opened: dict[str, Any], section: str
    ) -> None:
        self.desk, self.session, self.kind, self.state = desk, session, kind, state
        self.undone: list[CaseState] = []
        self.beside: CaseState | None = None
        with ui.element("main").classes("sw-page").props('id="main"'):
            with ui.element("div").classes("sw-side"):
                self.side = CaseSide(self, opened, _important.get(self._name, ()))
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

    def drop_zone(self, label: str) -> DroppedFiles:
        """Make the field for dropped files."""
        return DroppedFiles(self.session, FOLDER, label, self._dropped)

    def _source(self, state: CaseState | None = None) -> CaseSource:
        return (state or self.state).source(self.session.place(FOLDER))

    def begin(self, beside: Mapping[str, str] | None) -> None:
        """Show the state of the address, and beside it the one that it keeps."""
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
        """Set a field to a typed text; a refused one says why, and the field stays as it was."""
        field, before = self.side.fields[path], self.side.typed(path)
        typed, usual = field.with_unit(text), field.typed
        if typed == before:
            self.side.show_typed(path)
            return
        await self.set(self.state.without(path) if typed == usual else self.state.changed(path, typed))
        self.side.show_typed(path)

    async def set(self, state: CaseState) -> None:
        """Show another state, where it is valid: of this case, or with other layers."""
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
        """Go back to the case without changes."""
        await self.set(CaseState(self.state.name, self.state.text))

    async def _key(self, event: Any) -> None:
        if event.action.keydown and event.key == "z" and (event.modifiers.ctrl or event.modifiers.meta):
            await self.undo()

    def run(self) -> None:
        """Begin the full run."""
        self.runs.run()

    def stop(self) -> None:
        """Stop the current run."""
        self.runs.stop()

    def keep_beside(self) -> None:
        """Keep this state, to be compared with later ones; a second press lets it go."""
        self.beside = self.state if self.beside is None else None
        self.shown.keep_beside(None if self.beside is None else self.shown.view or None)
        if self.beside is not None and not self.runs.is_full and not self.kind.waits:
            background_tasks.create(self._run_beside(self.beside), name="beside")
        self._link()

    async def _run_beside(self, state: CaseState) -> None:
        """Show the full run of the state that is kept beside, unless it was let go meanwhile."""
        view = await self.runs.full_view(self._source(state))
        if view is not None and self.beside == state:
            self.shown.keep_beside(view)

    # what follows from it

    def _change(self, state: CaseState) -> None:
        self.state = self.side.state = state
        self.runs.follow(self._source())

    def _rested(self) -> None:
        """Put the state into the address and the command lines."""
        self._link()
        self._same()

    def _finished(self, view: dict[str, Any]) -> None:
        """Give sliders to the most important fields, once a full run has found them."""
        if self._name not in _important and view.get("important"):
            # dropped cases have their text as the key: the oldest makes room
            if len(_important) >= MOST_REMEMBERED:
                _important.pop(next(iter(_important)))
            self.side.important = _important[self._name] = view["important"]
            self.side.build()

    @property
    def _name(self) -> str:
        """Key of the case, whatever is changed in it."""
        return self.state.text or self.state.name

    def _link(self) -> None:
        query = self.state.query()
        if self.beside is not None and self.beside.is_same_case(self.state):
            query += [(BESIDE, change) for change in self.beside.source().changes] or [(BESIDE, "")]
        query += self.shown.section.query if self.shown.section else []
        with self.same:
            ui.navigate.history.replace(address(self.kind.place, query))

    def _same(self) -> None:
        """Show the command and the lines with the same result."""
        self.same.clear()
        with self.same, parts.box("The same without this page"):
            if self.state.text:
                ui.label(f"save the case as {self.state.file} first").classes("sw-soft")
            parts.code("command line", self.state.command(self.kind.program))
            more = ", band=True" if self.kind.quick else ""
            parts.code("Python", self.state.python(self.kind.call, more))


ONLY_TYPED = ("solver", "recorder")
"""Tables whose quantities have no sliders: nobody tries these out by hand."""
MOST_GUESSED = 6
"""Fields with sliders of a case without main settings."""


class CaseSide:
    """The left side of a page; ``important`` are its most important fields, empty until they are known."""

    def __init__(self, page: CasePage, opened: dict[str, Any], important: Sequence[str]) -> None:
        self.page, self.kind, self.state = page, page.kind, page.state
        self.fields: Mapping[str, EditedField] = opened["fields"]
        self.values: dict[str, float] = dict(opened["values"])  # SI, by path
        self.important = important
        self._shown: dict[str, LiveField] = {}
        self._titles: Mapping[str, str] = opened["titles"]
        self._choice()
        self._place = ui.element("div").classes("sw-side")
        self.build()

    def _options(self) -> dict[str, str]:
        """Return the built-in cases with their titles, the case that is shown among them."""
        name = self.state.name
        return dict(self._titles) if name in self._titles and not self.state.text else {name: name, **self._titles}

    async def _chosen(self, event: Any) -> None:
        if event.value != self.state.name:
            await self.page.open(CaseState(str(event.value)))

    def _choice(self) -> None:
        with parts.box("Case"):
            self._select = ui.select(
                self._options(), value=self.state.name, label="built-in case", on_change=self._chosen
            )
            self._select.props("dense outlined options-dense").classes("sw-full")
            self.page.drop_zone("or drop a case file (.toml)")
            with ui.element("div").classes("sw-row sw-gap"):
                if self.kind.waits:
                    ui.button("run", icon="play_arrow", on_click=self.page.run).props("unelevated dense no-caps")
                    ui.button("stop", icon="stop", on_click=self.page.stop).props("outline dense no-caps")
                for name, icon, do, hint in (
                    ("undo", "undo", self.page.undo, "Ctrl+Z"),
                    ("as the case", "restart_alt", self.page.reset, "undo all changes"),
                    ("keep beside", "compare", self.page.keep_beside, "compare with what you change next"),
                ):
                    ui.button(name, icon=icon, on_click=do).props("flat dense no-caps").tooltip(hint)

    def build(self) -> None:
        """Put the fields on the page: the most important with sliders, the rest folded by tables."""
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
        shown.on_move(functools.partial(self.page.move, path))
        shown.on_type(functools.partial(self.page.type, path))
        shown.on("back", self.page.undo)
        self._shown[path] = shown

    def typed(self, path: str) -> str:
        """Return the text in a field."""
        return self.state.changes.get(path, self.fields[path].typed)

    def _number(self, path: str) -> float:
        """Return the value of a field in the unit of its slider."""
        field = self.fields[path]
        return field.shown(self.values[path]) if path in self.values else field.value

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
        """Show the text of a field, where something else was typed."""
        self._shown[path].show(self.typed(path), self._number(path))

    def show_moved(self, path: str, value: float) -> str:
        """Show the value of a moved slider as text, and return it."""
        text = self.fields[path].text(value)
        self.values[path] = value * self.fields[path].scale
        self._shown[path].show(text)
        return text


class CaseFiles:
    """Buttons for downloads; ``source`` returns the state, ``view`` the shown view of it."""

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


WISHES = "strikewave.web.pages.case.machine_view:wishes"
STUDY = "strikewave.web.pages.study.view:study"


class WantedBlows:
    """Forms for wanted blows, each with its button; results are opened by a link. ``source`` returns the state."""

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
        """Fill in the blows as they are, and the variable settings, where nothing was typed."""
        if not self._folded.value:
            return
        wishes = await parts.tried(lambda: self.desk.lookers.ask(WISHES, self.source()))
        for (kind, key), box in self._boxes.items():
            if not box.value and wishes:
                box.value = "\n".join(wishes.get(kind, {}).get(key, ()))

    def begin(self, kind: str) -> None:
        """Search for settings."""
        texts = tuple(
            (key, tuple(str(box.value or "").splitlines())) for (of, key), box in self._boxes.items() if of == kind
        )
        place = str(self.session.place("studies"))
        request = StudyRequest(kind, self.source()._replace(folder=place), texts)
        self.bench.begin(STUDY, request, same=request.commands())

    def stop(self) -> None:
        """Stop the search."""
        self.bench.stop()
