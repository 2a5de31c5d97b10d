"""A page of one case: settings on the left, what they do on the right."""

from __future__ import annotations

import asyncio
import functools
from collections.abc import Mapping
from typing import Any, NamedTuple

from nicegui import Client, background_tasks, ui
from nicegui.events import GenericEventArguments
from starlette.requests import Request

from strikewave.base.errors import StrikewaveError
from strikewave.web import parts
from strikewave.web.case_state import CaseSource, CaseState, address, is_case
from strikewave.web.charts import line_chart, with_beside
from strikewave.web.desk import Desk, started
from strikewave.web.edited_field import EditedField
from strikewave.web.jobs import CancelledError, PageJob
from strikewave.web.sessions import Session, clean_name

CASES = "strikewave.web.case_view"
"""Module of what all kinds of cases have in common, which runs in processes."""
REST = 0.6
"""Time without a change after which the full run begins, s: a hand that pauses on a slider pauses for less."""
MOST_UNDONE = 100
BESIDE = "beside"
"""Key of the address for the changes of the state that is kept beside."""
_important: dict[str, list[str]] = {}
"""Fields that matter most by case, as its last full run found them."""
MOST_REMEMBERED = 64


class CaseKind(NamedTuple):
    """A kind of case that has a page.

    Attributes
    ----------
    place : str
        Address of the page.
    usual : str
        The case that is shown at first.
    program, call : str
        The command, and the function of Python, that give the same.
    view : str
        Module of its `full`, and its `look`, which run in processes.
    charts : tuple of (str, bool)
        What each diagram shows, and whether it is as wide as the page.
    main : tuple of str
        Fields with sliders until it is known which matter most.
    files : tuple of (str, str, str)
        What can be taken away beside the case: words, icon, name of the file.
    quick : bool
        Whether there is a first look.
    waits : bool
        Whether a run takes so long that it begins by a button alone.
    drawn : bool
        Whether there are drawings.
    """

    place: str
    usual: str
    program: str
    call: str
    view: str
    charts: tuple[tuple[str, bool], ...]
    main: tuple[str, ...]
    files: tuple[tuple[str, str, str], ...]
    quick: bool = False
    waits: bool = False
    drawn: bool = False


def add(desk: Desk, kind: CaseKind) -> None:
    """Add the page of a kind of case to the app."""

    @ui.page(kind.place)
    async def page(request: Request, client: Client) -> None:
        given = list(request.query_params.multi_items())

        async def asked(session: Session) -> tuple[CaseState, Mapping[str, str], dict[str, Any]]:
            state, kept = CaseState.read(given, kind.usual), CaseState.read(given, kind.usual, BESIDE).changes
            return state, kept, await desk.lookers.ask(f"{CASES}:opened", state.source(session.folder), kind.program)

        opened = await desk.open_page(kind.place, client, asked)
        if opened is None:
            return
        session, (state, kept, known) = opened
        shown = CasePage(desk, session, kind, state, known)
        shown.beside_changes = dict(kept) if any(key == BESIDE for key, _ in given) else None
        shown.build()
        shown.begin()


class CasePage:
    """One open page: its state, and what of it is shown."""

    def __init__(self, desk: Desk, session: Session, kind: CaseKind, state: CaseState, opened: dict[str, Any]) -> None:
        self.desk, self.session, self.kind, self.state = desk, session, kind, state
        self.titles: dict[str, str] = opened["titles"]
        self.fields: dict[str, EditedField] = opened["fields"]
        self.values: dict[str, float] = opened["values"]
        self.undone: list[CaseState] = []
        self.beside_changes: dict[str, str] | None = None
        self.beside: dict[str, Any] | None = None
        self.view: dict[str, Any] = {}
        self.sliders: dict[str, ui.slider] = {}
        self.inputs: dict[str, ui.input] = {}
        self._looking = self._again = False
        self._rest: asyncio.TimerHandle | None = None
        self._job: PageJob | None = None

    def _source(self, state: CaseState | None = None) -> CaseSource:
        return (state or self.state).source(self.session.folder)

    # what is on the page

    def build(self) -> None:
        """Put everything on the page."""
        with ui.element("main").classes("sw-page").props('id="main"'):
            with ui.element("div").classes("sw-side"):
                self._choice()
                self.side = ui.element("div").classes("sw-side")
            with ui.element("div").classes("sw-main"):
                self.state_word = ui.label("").classes("sw-state").props('role="status"')
                self.key = ui.element("div").style("width:100%")
                self.refused = ui.element("div").style("width:100%")
                self.drawn = ui.element("div").classes("sw-charts")
                with self.drawn:
                    empty = line_chart("", "", "", [])
                    self.charts = [parts.chart(empty, label, wide=wide) for label, wide in self.kind.charts]
                self.frame = ui.element("div").style("width:100%")
                self.table = ui.element("div").style("width:100%")
                self.more = ui.element("div").classes("sw-main")
                self.take = ui.element("div").style("width:100%")
                if self.kind.drawn:
                    self.drawing = ui.expansion("Drawing of the machine", on_value_change=self._draw)
                self.same = ui.element("div").classes("sw-main")
        ui.keyboard(self._key, ignore=["input", "select", "textarea"])
        self._fields()
        self._buttons()
        self._same()

    def _choice(self) -> None:
        with parts.box("Case"):
            titles = self.titles
            options = (
                titles
                if self.state.name in titles and not self.state.text
                else {self.state.name: self.state.name, **titles}
            )
            ui.select(options, value=self.state.name, label="built-in case", on_change=self._choose).props(
                "dense outlined options-dense"
            ).style("width:100%")
            parts.drop_zone("or drop a case file (.toml)", self._dropped, multiple=True)
            with ui.element("div").classes("sw-row").style("margin-top:.5rem"):
                if self.kind.waits:
                    ui.button("run", icon="play_arrow", on_click=self._full_soon).props("unelevated dense no-caps")
                    ui.button("stop", icon="stop", on_click=self.stop).props("outline dense no-caps")
                ui.button("undo", icon="undo", on_click=self.undo).props("flat dense no-caps").tooltip("Ctrl+Z")
                ui.button("as the case", icon="restart_alt", on_click=self.reset).props("flat dense no-caps")
                ui.button("keep beside", icon="compare", on_click=self.keep_beside).props("flat dense no-caps").tooltip(
                    "keep this state, and compare with what you change next"
                )

    def _fields(self) -> None:
        """Put the fields on the page: those that matter most with sliders, the rest folded by tables."""
        self.side.clear()
        self.sliders, self.inputs = {}, {}
        important = [path for path in _important.get(self._key_of_case(), []) if path in self.fields]
        usual = [path for path in self.kind.main if path in self.fields]
        usual = usual or [path for path in self.fields if path.endswith((".length", ".velocity"))][:6]
        first = important or usual
        with self.side:
            with parts.box("What matters most" if important else "Main settings"):
                if important:
                    ui.label("from the shares of the bands of the results, the largest first").classes("sw-soft")
                for path in first:
                    self._field(path, slider=True)
            for table in dict.fromkeys(path.partition(".")[0] for path in self.fields):
                rest = [p for p in self.fields if p.partition(".")[0] == table and p not in first]
                if rest:
                    with ui.expansion(table.capitalize()).props("dense"):
                        for path in rest:
                            self._field(path, slider=table not in ("solver", "recorder"))

    def _field(self, path: str, slider: bool) -> None:
        """Put one field on the page."""
        one = self.fields[path]
        typed = self.state.changes.get(path, one.typed)
        with ui.element("div").classes("sw-field"):
            label = ui.html(f"<label>{parts.html.escape(one.label)}</label>", sanitize=False)
            label.tooltip(f"{one.what}. How to get it: {one.how}. Here: {one.provenance}.")
            box = ui.input(value=typed).props(f'dense outlined aria-label="{parts.html.escape(path)}"')
            box.on("keydown.enter", lambda: self.set(path, box.value)).on("blur", lambda: self.set(path, box.value))
            self.inputs[path] = box
            if slider and one.high > one.low:
                moved = ui.slider(min=one.low, max=one.high, step=one.step, value=self._number(path))
                moved.props(f'aria-label="{parts.html.escape(path)}" color=primary')
                moved.on("update:model-value", functools.partial(self._slide, path), throttle=0.05)
                moved.on("change", self._rested)
                self.sliders[path] = moved

    def _number(self, path: str) -> float:
        """Return the value of a field in the unit of its slider."""
        one = self.fields[path]
        return one.shown(self.values[path]) if path in self.values else one.value

    def _buttons(self) -> None:
        with self.take, parts.box("Take away"), ui.element("div").classes("sw-row"):
            ui.button("case (.toml)", icon="description", on_click=self._save_case).props("outline dense no-caps")
            for name, icon, file in self.kind.files:
                press = functools.partial(self._save_file, file)
                ui.button(name, icon=icon, on_click=press).props("outline dense no-caps")

    def _same(self) -> None:
        """Show the command and the lines that give the same."""
        self.same.clear()
        with self.same, parts.box("The same without this page"):
            if self.state.text:
                ui.label(f"save the case as {self.state.file} first").classes("sw-soft")
            parts.code("command line", self.state.command(self.kind.program))
            more = ", band=True" if self.kind.quick else ""
            parts.code("Python", self.state.python(self.kind.call, more))

    # what the user does

    async def _choose(self, event: Any) -> None:
        await self._show_other(CaseState(str(event.value)))

    async def _dropped(self, event: Any) -> None:
        cases = []
        for file in event.files:
            try:
                path = self.session.keep(file.name, await file.read())
                if is_case(path):
                    cases.append(CaseState.of_file(path))
            except StrikewaveError as error:
                ui.notify(f"refused: {error}", type="warning")
        if cases:
            await self._show_other(cases[-1])
        elif event.files:
            ui.notify("kept; a case that names these files can be dropped now", type="info")

    async def _show_other(self, state: CaseState) -> None:
        """Show another case, on a page of its own address; one that is refused leaves this page as it is."""
        try:
            await self.desk.lookers.ask(f"{CASES}:opened", self._source(state), self.kind.program)
        except StrikewaveError as error:
            ui.notify(f"refused: {error}"[:400], type="warning", multi_line=True, close_button="close", timeout=15000)
            return
        ui.navigate.to(address(self.kind.place, state.query()))

    def _slide(self, path: str, event: GenericEventArguments) -> None:
        one = self.fields[path]
        text = one.text(float(event.args))
        self._remember()
        self.inputs[path].value = text
        self.change(self.state.without(path) if text == one.typed else self.state.changed(path, text))

    async def set(self, path: str, text: Any) -> None:
        """Set a field to what was typed; what is refused says why, and the field keeps what it had."""
        typed = str(text or "").strip()
        before = self.state.changes.get(path, self.fields[path].typed)
        if typed == before:
            return
        new = self.state.without(path) if typed == self.fields[path].typed else self.state.changed(path, typed)
        try:
            self.values = await self.desk.lookers.ask(f"{CASES}:values", self._source(new))
        except StrikewaveError as error:
            ui.notify(f"refused: {error}"[:300], type="warning", multi_line=True, close_button="close", timeout=12000)
            self.inputs[path].value = before
            return
        self._remember(whole=True)
        if path in self.sliders:
            self.sliders[path].value = self._number(path)
        self.change(new)
        self._rested()

    def _remember(self, whole: bool = False) -> None:
        """Keep the state for undo: one a movement of a slider, not one a step of it."""
        if whole or self._rest is None:
            self.undone = [*self.undone[-MOST_UNDONE + 1 :], self.state]

    async def undo(self) -> None:
        """Go back by one change."""
        if not self.undone:
            ui.notify("nothing to undo")
            return
        await self._restore(self.undone.pop())

    async def reset(self) -> None:
        """Go back to the case as it is."""
        self._remember(whole=True)
        await self._restore(CaseState(self.state.name, self.state.text))

    async def _restore(self, state: CaseState) -> None:
        self.state = state
        self.values = await self.desk.lookers.ask(f"{CASES}:values", self._source(state))
        for path, box in self.inputs.items():
            box.value = state.changes.get(path, self.fields[path].typed)
        for path, moved in self.sliders.items():
            moved.value = self._number(path)
        self.change(state)
        self._rested()

    async def _key(self, event: Any) -> None:
        if event.action.keydown and event.key == "z" and (event.modifiers.ctrl or event.modifiers.meta):
            await self.undo()

    def keep_beside(self) -> None:
        """Keep this state, to be compared with what is changed next; a second press lets it go."""
        if self.beside_changes is None:
            self.beside_changes, self.beside = dict(self.state.changes), dict(self.view)
        else:
            self.beside_changes = self.beside = None
        self._link()
        self.show()

    # what follows from it

    def begin(self) -> None:
        """Show the first look, then the full run."""
        if not self.kind.waits:
            self.change(self.state)
        else:
            self.drawn.set_visibility(False)
            self._say("nothing is run yet: press run")

    def change(self, state: CaseState) -> None:
        """Show another state by a first look; where one is under way, the last state is looked at after it."""
        self.state = state
        if self._job is not None:
            self._job.cancel()
        if self.kind.waits:
            self._link()
            self._say("changed: press run")
            return
        self._again = True
        if self.kind.quick and not self._looking:
            background_tasks.create(self._look(), name="look")
        self._rested()

    async def _look(self) -> None:
        self._looking = True
        try:
            while self._again:
                self._again = False
                source = self._source()
                try:
                    if self.beside_changes is not None and self.beside is None:
                        kept = CaseState(self.state.name, self.state.text, self.beside_changes)
                        self.beside = await self.desk.lookers.ask(f"{self.kind.view}:look", self._source(kept))
                    view = await self.desk.lookers.ask(f"{self.kind.view}:look", source)
                except StrikewaveError as error:
                    self._refuse(str(error))
                    continue
                self.view = view
                self._say(f"shown: {view['by']}; the full run follows when you pause")
                self.show()
        finally:
            self._looking = False

    def _rested(self) -> None:
        """Begin the full run once nothing has been changed for a moment."""
        if self.kind.waits:
            return
        if self._rest is not None:
            self._rest.cancel()
        self._rest = asyncio.get_running_loop().call_later(REST, self._full_soon)

    def _full_soon(self) -> None:
        self._rest = None
        background_tasks.create(self._full(), name="full run")

    async def _full(self) -> None:
        state, job = self.state, PageJob(f"{self.kind.view}:full", self._source())
        if self._job is not None:
            self._job.cancel()
        self._job = job
        self._link()

        def progress(share: float | None, words: str) -> None:
            if state is self.state:
                self._say(f"shown: {self.view.get('by', 'nothing yet')}; {parts.under_way(share, words)}")

        try:
            view = await started(self.session, job, progress)
        except CancelledError:
            return
        except StrikewaveError as error:
            if state is self.state:
                self._refuse(str(error))
            return
        finally:
            if self._job is job:
                self._job = None
        if state is not self.state:
            return
        self.view = view
        self._say(f"shown: {view['by']}")
        if self._key_of_case() not in _important and view.get("important"):
            if len(_important) >= MOST_REMEMBERED:
                _important.pop(next(iter(_important)))
            _important[self._key_of_case()] = view["important"]
            self._fields()
        self.show()

    def stop(self) -> None:
        """Stop the run that is under way."""
        if self._job is None:
            ui.notify("nothing is under way")
        else:
            self._job.cancel()
            self._say("stopped")

    def _key_of_case(self) -> str:
        return self.state.text or self.state.name

    def _link(self) -> None:
        """Have the address hold the state, and the command lines with it."""
        query = self.state.query()
        if self.beside_changes is not None:
            query += [(BESIDE, f"{path}={value}") for path, value in self.beside_changes.items()] or [(BESIDE, "")]
        with self.same:
            ui.navigate.history.replace(address(self.kind.place, query))
        self._same()

    def _say(self, text: str) -> None:
        self.state_word.text = text

    def _refuse(self, message: str) -> None:
        self._say("shown: the last state that could be run")
        self.refused.clear()
        with self.refused:
            parts.refusal(message)

    def show(self) -> None:
        """Show the view that is there."""
        view, beside = self.view, self.beside
        if not view:
            return
        self.refused.clear()
        self.drawn.set_visibility(True)
        for place, drawn in enumerate(self.charts):
            options = view["charts"][place]
            parts.replace_options(drawn, with_beside(options, beside["charts"][place]) if beside else options)
        self.key.clear()
        with self.key:
            if beside:
                now, then = dict(view["figures"]), dict(beside["figures"])
                rows = [[name, now.get(name, "–"), then.get(name, "–")] for name in {**now, **then}]
                parts.table("compared", ["", "now", "kept beside"], rows)
            elif view["figures"]:
                parts.key_numbers(view["figures"])
            else:
                ui.label(view.get("nothing", "")).classes("sw-empty")
        self.frame.clear()
        if view.get("page"):
            with self.frame:
                parts.kept_page(self.session, "animation.html", view["page"], "the run in motion")
        self.table.clear()
        with self.table:
            parts.tables(view["tables"])
        self.more.clear()
        with self.more:
            parts.checks(view.get("balance", ()), view.get("notices", ()))

    # what is taken away

    async def _save_case(self) -> None:
        text = await parts.tried(lambda: self.desk.lookers.ask(f"{CASES}:saved", self._source()))
        if text is not None:
            ui.download.content(text, f"{clean_name(self.state.name)}.toml")

    async def _save_file(self, wanted: str) -> None:
        if wanted in self.view.get("texts", {}):
            ui.download.content(self.view["texts"][wanted], wanted)
            return
        note = ui.notification(f"making {wanted}", spinner=True, timeout=None)
        job = PageJob(f"{self.kind.view}:files", self._source(), wanted)
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
        job = PageJob(f"{self.kind.view}:drawings", self._source())
        pictures = await parts.tried(lambda: started(self.session, job))
        self.drawing.clear()
        with self.drawing:
            if not pictures:
                ui.label("this kind of machine is not drawn").classes("sw-soft")
            for svg, caption in pictures or ():
                parts.svg_picture(svg, caption)
