"""Parts of pages: frame, boxes, diagrams, uploaded files, and elements that follow a moving slider.

An ordinary element of NiceGUI that changes has the browser build the page anew, which takes longer than a first look
at a machine. The live elements take a change by a method of their own component instead.
"""

from __future__ import annotations

import asyncio
import base64
import functools
import hashlib
import html
from collections.abc import Awaitable, Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from nicegui import context, ui

from strikewave.base.errors import StrikewaveError
from strikewave.reporting.style import BLUE, ORANGE
from strikewave.web.case_state import EditedField
from strikewave.web.guard import LARGEST_UPLOAD
from strikewave.web.sessions import KEPT, Session

PAGES = {"/": "Machine", "/target": "Target", "/record": "Record", "/study": "Fit and study", "/elements": "Elements"}
"""Address and name of each page."""
LONGEST_NOTE = 400
"""Characters of a note that passes: as many as are read in its quarter of a minute."""
CSS = (Path(__file__).parent / "style.css").read_text("utf-8")


@contextmanager
def page_frame(current: str) -> Iterator[ui.label]:
    """Give a page its bar with the names of all pages, and return the label for messages."""
    ui.page_title(f"{PAGES[current]} – strikewave")
    ui.add_css(CSS)
    ui.colors(primary=BLUE, warning=ORANGE)
    with ui.header().classes("sw-bar"):
        first = f'<a class="sw-skip" href="#main">to the content</a><h1 class="sw-skip">{PAGES[current]}</h1>'
        ui.html(first, sanitize=False).classes("sw-first")
        ui.label("strikewave").classes("sw-name")
        with ui.element("nav").classes("sw-nav").props('aria-label="pages"'):
            for place, name in PAGES.items():
                link = ui.link(name, place)
                if place == current:
                    link.props('aria-current="page"')
        word = ui.label().classes("sw-word").props('role="status"')
    yield word


def under_way(share: float | None, stage: str) -> str:
    """Return the current step, and the share done where it is known."""
    return f"under way: {stage}" + ("" if share is None else f" {100.0 * share:.0f} %")


@contextmanager
def waiting(text: str) -> Iterator[None]:
    """Show a spinner with a text until the content is there."""
    with ui.element("div").classes("sw-row").style("padding:1.5rem") as row:
        ui.spinner(size="1.4rem")
        ui.label(text).classes("sw-soft").props('role="status"')
    try:
        yield
    finally:
        if not row.is_deleted:
            row.delete()


@contextmanager
def box(title: str) -> Iterator[Any]:
    """Give a box with a heading."""
    with ui.element("section").classes("sw-box").props(f'aria-label="{html.escape(title)}"') as section:
        ui.html(f"<h2>{html.escape(title)}</h2>", sanitize=False)
        yield section


def shown(content: str) -> None:
    """Show markup from `strikewave.web.markup`."""
    ui.html(content, sanitize=False).classes("sw-main sw-full")


def page_file(session: Session, name: str, content: bytes) -> str:
    """Store a file that the open page asks for itself, until it is left, and return its address.

    It is named by the page, since a session may have the same one open twice.
    """
    client = context.client
    own = f"{client.id}-{name}"
    path = session.keep(own, content, KEPT)
    client.on_delete(lambda: path.unlink(missing_ok=True))
    return f"/kept/{own}?{hashlib.sha256(content).hexdigest()[:12]}"


def nested_page(session: Session, name: str, page: str, title: str) -> None:
    """Show a whole page within this one, from a file of the session and apart from all else."""
    place = page_file(session, name, page.encode())
    attributes = f'class="sw-frame" title="{html.escape(title)}" sandbox="allow-scripts" src="{place}"'
    ui.html(f"<iframe {attributes}></iframe>", sanitize=False).classes("sw-full")


def code(label: str, text: str) -> None:
    """Show lines to be copied."""
    with ui.element("div").classes("sw-full"):
        with ui.element("div").classes("sw-row"):
            ui.label(label).classes("sw-soft")
            ui.button(icon="content_copy", on_click=lambda: ui.clipboard.write(text)).props(
                f'flat dense round size=sm aria-label="copy: {html.escape(label)}"'
            )
        ui.html(f"<pre class='sw-code'>{html.escape(text)}</pre>", sanitize=False)


def chart(options: dict[str, Any], label: str, wide: bool = False) -> LiveChart:
    """Show a diagram with a label for screen readers."""
    drawn = LiveChart(options).classes("sw-chart" + (" sw-wide" if wide else ""))
    return drawn.props(f'role="img" aria-label="{html.escape(label)}"')


def svg_picture(svg: bytes, caption: str) -> None:
    """Show a drawing with its caption; as a picture it can run nothing."""
    data = base64.b64encode(svg).decode()
    picture = f'<img class="sw-picture" alt="{html.escape(caption)}" src="data:image/svg+xml;base64,{data}">'
    ui.html(
        f"<figure style='margin:0'>{picture}<figcaption class='sw-soft'>{html.escape(caption)}</figcaption></figure>",
        sanitize=False,
    )


async def tried(work: Callable[[], Awaitable[Any]]) -> Any:
    """Do work that may be refused; show the reason and return None then."""
    try:
        return await work()
    except StrikewaveError as error:
        ui.notify(
            f"refused: {error}"[:LONGEST_NOTE], type="warning", multi_line=True, close_button="close", timeout=15000
        )
        return None


class LiveBody(ui.element, component="live_body.js"):
    """The moving surface of a run of elements, with a slider of time, a field in colours and a plane that cuts.

    ``url`` is the address of its bytes (`strikewave.web.pages.case.elements_view`), ``label`` a text for screen
    readers.
    """

    library = ui.scene
    """Library that brings three.js: the page knows where to find it once this was named."""

    def __init__(self, url: str, label: str) -> None:
        super().__init__()
        self.props.update({"url": url, "label": label})


class LiveChart(ui.element, component="live_chart.js"):
    """A diagram by ECharts, which NiceGUI brings; ``options`` are those of `strikewave.web.charts`."""

    library = ui.echart
    """Library that brings ECharts: the page knows where to find it once this was named."""

    def __init__(self, options: dict[str, Any]) -> None:
        super().__init__()
        self.shown = options
        self.props["options"] = options

    def show(self, options: dict[str, Any]) -> None:
        """Show other curves; only the differences are sent."""
        changed = {key: value for key, value in options.items() if self.shown.get(key) != value}
        gone = self.shown.keys() - options.keys()
        self.shown = options
        if changed or gone:
            self.run_method("show", options if gone else changed, bool(gone))


THROTTLE = 0.05
"""Least time between two movements that a slider reports, s: as many as are looked at."""


class LiveField(ui.element, component="live_field.js"):
    """One quantity of a case beside its label, with the text in it and the value of its slider, in its unit."""

    def __init__(self, field: EditedField, typed: str, value: float, has_slider: bool, label: str = "") -> None:
        super().__init__()
        hint = f"{field.what}. How to get it: {field.how}. Here: {field.provenance}."
        text = {"path": field.path, "label": label or field.label, "hint": hint, "typed": typed}
        high = field.high if has_slider else field.low  # of equal ends the component draws no slider
        self.props.update(text | {"low": field.low, "high": high, "step": field.step, "value": value})

    def on_move(self, moved: Callable[[float], Any]) -> None:
        """Call with the value of the slider, in its unit, as it is moved."""
        self.on("move", lambda event: moved(float(event.args)), throttle=THROTTLE)

    def on_type(self, typed: Callable[[str], Any]) -> None:
        """Call with the typed text once the typing ends."""
        self.on("type", lambda event: typed(str(event.args)))

    def show(self, typed: str, value: float | None = None) -> None:
        """Show another value; of the slider none where it stands there already."""
        self.run_method("show", typed, value)


class LiveHtml(ui.element, component="live_html.js"):
    """Markup that changes; its caller escapes texts from elsewhere (`strikewave.web.markup`)."""

    def __init__(self, content: str = "") -> None:
        super().__init__()
        self.props["content"] = content

    def show(self, content: str) -> None:
        """Show other markup."""
        if content != self.props["content"]:
            with self.props.suspend_updates():
                self.props["content"] = content
            self.run_method("show", content)


class MarkedResult(ui.element):
    """The container of results: dim while they are of other settings, and busy while new ones are computed."""

    def __init__(self) -> None:
        super().__init__("div")
        self.classes("sw-main")
        self.is_stale = self._busy = False

    def show_as(self, stale: bool, busy: bool = False) -> None:
        """Mark the results for eyes and ears, where that changes."""
        if (stale, busy) == (self.is_stale, self._busy) or self.is_deleted:
            return
        self.is_stale, self._busy = stale, busy
        self.classes(**{"add" if stale else "remove": "sw-stale"})
        self.props(f"aria-busy={'true' if busy else 'false'}")


REST = 0.6
"""Time without a change after which a hand rests, s: one that pauses on a slider pauses for less."""


class RestingHand:
    """Calls ``then`` once nothing has moved for a moment."""

    def __init__(self, then: Callable[[], object]) -> None:
        self._then = then
        self._timer: asyncio.TimerHandle | None = None

    @property
    def is_moving(self) -> bool:
        """True if something moved a moment ago."""
        return self._timer is not None

    def moved(self) -> None:
        """Note that something moved now."""
        self.stop()
        self._timer = asyncio.get_running_loop().call_later(REST, self._call)

    def stop(self) -> None:
        """Cancel the call."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _call(self) -> None:
        self._timer = None
        self._then()


DROP_HEAD = """
<div class="row no-wrap items-center q-pa-sm">
  <div class="col q-uploader__title">{label}</div>
  <q-spinner v-if="props.isUploading" />
  <q-btn v-if="props.canAddFiles" type="a" icon="add_box" flat dense aria-label="choose files: {label}">
    <q-uploader-add-trigger />
  </q-btn>
</div>"""
"""Head of a field for dropped files: that of the kit has a button without a name."""
FIELD_NAME = ":field-name='file => file.__key'"
"""Each file of a drop has a field of its own in the upload: two of one name would be one."""
REFUSED = "entries => emit(entries.map(entry => [entry.failedPropValidation, entry.file.name]))"
MOST_NAMED = 3
"""Refused files that a note names."""
REASONS = {"max-file-size": f"a file takes {LARGEST_UPLOAD >> 20} MB at most", "duplicate": "it is on its way already"}
"""Reason why the browser does not send a file, by the name of the rule."""


class DroppedFiles:
    """A field for dropped files, kept in a folder of the session, and their list.

    ``dropped`` is called with the files of a drop once they are stored, ``removed`` after some were removed.
    """

    def __init__(
        self,
        session: Session,
        folder: str,
        label: str,
        dropped: Callable[[Sequence[Path]], Awaitable[None]],
        removed: Callable[[], None] = lambda: None,
    ) -> None:
        self._session, self._folder, self._dropped, self._removed = session, folder, dropped, removed
        with ui.element("div").classes("sw-drop").classes("sw-full"):
            zone = ui.upload(label=label, multiple=True, auto_upload=True, max_file_size=LARGEST_UPLOAD)
            zone.on_multi_upload(self._take)
        zone.on("rejected", self._refuse, js_handler=REFUSED)
        # what is kept stands in the list below; emptied by the browser itself: asked for from here, it comes late and
        # throws away what has been dropped since
        zone.on("finish", js_handler=f"() => runMethod({zone.id}, 'reset', [])")
        zone.add_slot("header", DROP_HEAD.format(label=html.escape(label)))
        zone.props(f'flat bordered batch {FIELD_NAME} aria-label="{html.escape(label)}"')
        self._list = ui.element("div").classes("sw-full")
        self._show()

    @property
    def place(self) -> Path:
        """The folder of these files."""
        return self._session.place(self._folder)

    @property
    def names(self) -> list[str]:
        """Names of the stored files, sorted."""
        return sorted(path.name for path in self.place.iterdir() if path.is_file())

    def _show(self) -> None:
        self._list.clear()
        names = self.names
        with self._list:
            for name in names:
                with ui.element("div").classes("sw-row sw-file"):
                    ui.label(name).classes("sw-soft sw-grow")
                    cross = ui.button(icon="close", on_click=functools.partial(self.remove, [name]))
                    cross.props(f'flat dense round size=sm aria-label="remove {html.escape(name)}"')
            if len(names) > 1:
                ui.button("remove all", icon="delete", on_click=lambda: self.remove(self.names)).props(
                    "flat dense no-caps"
                )

    def remove(self, names: Sequence[str]) -> None:
        """Remove files."""
        for name in names:
            (self.place / name).unlink(missing_ok=True)
        self._show()
        self._removed()

    async def _take(self, event: Any) -> None:
        taken = []
        try:
            files = [(file.name, await file.read()) for file in event.files]
            taken = self._session.take(files, self._folder)
        except StrikewaveError as error:
            ui.notify(f"refused: {error}", type="warning")
        for file in taken:
            if file.remark:
                ui.notify(file.remark, type="info", timeout=10000)
        self._show()
        await self._dropped([file.path for file in taken])

    def _refuse(self, event: Any) -> None:
        for rule, name in event.args[:MOST_NAMED]:
            ui.notify(f"refused: {name}: {REASONS.get(rule, 'the browser does not send it')}", type="warning")
