"""What the pages have in common: frame, numbers, tables, notices, commands, files that come and go."""

from __future__ import annotations

import base64
import hashlib
import html
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from nicegui import context, ui

from strikewave.base.errors import StrikewaveError
from strikewave.reporting.style import BLUE, ORANGE
from strikewave.web.live.chart import LiveChart
from strikewave.web.sessions import KEPT, Session

PAGES = {
    "/": "Machine",
    "/target": "Target",
    "/record": "Record",
    "/study": "Fit and study",
    "/elements": "Elements",
}
"""Address and name of each page."""
LONGEST_NOTE = 400
"""Characters of a note that passes: as many as are read in its quarter of a minute."""
CSS = (Path(__file__).parent / "style.css").read_text("utf-8")


@contextmanager
def page_frame(current: str) -> Iterator[ui.label]:
    """Give a page its bar with the names of all pages, and return the label for a word on what goes on."""
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


def under_way(share: float | None, words: str) -> str:
    """Say what is under way, and how much of it is done where that is known.

    Examples
    --------
    >>> under_way(0.4, "the run"), under_way(None, "the report")
    ('under way: the run 40 %', 'under way: the report')
    """
    return f"under way: {words}" + ("" if share is None else f" {100.0 * share:.0f} %")


@contextmanager
def waiting(words: str) -> Iterator[None]:
    """Show that something is on its way."""
    with ui.element("div").classes("sw-row").style("padding:1.5rem") as row:
        ui.spinner(size="1.4rem")
        ui.label(words).classes("sw-soft").props('role="status"')
    try:
        yield
    finally:
        if not row.is_deleted:
            row.delete()


def heading(text: str) -> None:
    """Write the heading of a box."""
    ui.html(f"<h2>{html.escape(text)}</h2>", sanitize=False)


@contextmanager
def box(title: str) -> Iterator[Any]:
    """Give a box with a heading."""
    with ui.element("section").classes("sw-box").props(f'aria-label="{html.escape(title)}"') as section:
        heading(title)
        yield section


def shown(content: str) -> None:
    """Show markup, which `strikewave.web.markup` makes."""
    ui.html(content, sanitize=False).classes("sw-main sw-full")


def kept(session: Session, name: str, content: bytes) -> str:
    """Keep what the page that is open asks for itself, until it is left, and return its address.

    It is named by the page, since a session may have the same one open twice.
    """
    client = context.client
    own = f"{client.id}-{name}"
    path = session.keep(own, content, KEPT)
    client.on_delete(lambda: path.unlink(missing_ok=True))
    return f"/kept/{own}?{hashlib.sha256(content).hexdigest()[:12]}"


def kept_page(session: Session, name: str, page: str, title: str) -> None:
    """Show a whole page within this one: it is kept among the files of the session, and runs apart from all else."""
    place = kept(session, name, page.encode())
    words = f'class="sw-frame" title="{html.escape(title)}" sandbox="allow-scripts" src="{place}"'
    ui.html(f"<iframe {words}></iframe>", sanitize=False).classes("sw-full")


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
    """Show a diagram with a label for who cannot see it."""
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
    """Do work that may be refused, and show why; None then."""
    try:
        return await work()
    except StrikewaveError as error:
        ui.notify(
            f"refused: {error}"[:LONGEST_NOTE], type="warning", multi_line=True, close_button="close", timeout=15000
        )
        return None
