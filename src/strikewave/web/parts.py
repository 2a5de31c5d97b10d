"""What the pages have in common: frame, numbers, tables, notices, commands, files that come and go."""

from __future__ import annotations

import base64
import hashlib
import html
from collections.abc import Awaitable, Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from nicegui import ui

from strikewave.base.errors import StrikewaveError
from strikewave.reporting.style import BLUE, ORANGE
from strikewave.web.guard import LARGEST_UPLOAD
from strikewave.web.sessions import Session

PAGES = {
    "/": "Machine",
    "/target": "Target",
    "/record": "Record",
    "/study": "Fit and study",
    "/elements": "Elements",
}
"""Address and name of each page."""
MOST_ROWS = 60
"""Rows of a table on a page; the file has all."""
CSS = (Path(__file__).parent / "style.css").read_text("utf-8")


@contextmanager
def page_frame(current: str) -> Iterator[ui.label]:
    """Give a page its bar with the names of all pages, and return the label for a word on what goes on."""
    ui.page_title(f"{PAGES[current]} – strikewave")
    ui.add_css(CSS)
    ui.colors(primary=BLUE, warning=ORANGE)
    ui.html('<a class="sw-skip" href="#main">to the content</a>', sanitize=False)
    with ui.header().classes("sw-bar"):
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


def key_numbers(rows: Sequence[Sequence[str]]) -> None:
    """Show the key numbers, each below its name, its band in small letters."""
    cards = []
    for name, text in rows:
        number, gap, band = text.partition(" (")
        small = f" <small>({html.escape(band)}</small>" if gap else ""
        cards.append(f'<div class="sw-card"><dt>{html.escape(name)}</dt><dd>{html.escape(number)}{small}</dd></div>')
    ui.html(f'<dl class="sw-key" style="margin:0">{"".join(cards)}</dl>', sanitize=False).classes("w-full").style(
        "width:100%"
    )


def table(caption: str, heads: Sequence[str], rows: Sequence[Sequence[str]], words: Sequence[int] = ()) -> None:
    """Show a table, which a narrow screen scrolls by itself."""

    def cell(tag: str, place: int, text: object) -> str:
        kind = ' class="sw-words"' if place in words else ""
        scope = ' scope="col"' if tag == "th" else ""
        return f"<{tag}{scope}{kind}>{html.escape(str(text))}</{tag}>"

    head = "".join(cell("th", k, text) for k, text in enumerate(heads))
    body = "".join(
        "<tr>" + "".join(cell("td", k, text) for k, text in enumerate(row)) + "</tr>" for row in rows[:MOST_ROWS]
    )
    ui.html(
        f'<table aria-label="{html.escape(caption)}"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>',
        sanitize=False,
    ).classes("sw-table").props('tabindex="0"')
    if len(rows) > MOST_ROWS:
        ui.label(f"{len(rows) - MOST_ROWS} more rows: the file has all").classes("sw-soft")


def notices(rows: Sequence[Sequence[str]]) -> None:
    """Show notices, the gravest first: severity in a word and a colour, code, message."""
    order = {"failed": 0, "error": 0, "warning": 1}
    for severity, code, message in sorted(rows, key=lambda row: order.get(row[0], 2)):
        text = f"<b>{html.escape(severity)}: {html.escape(code.replace('-', ' '))}.</b> {html.escape(message)}"
        ui.html(text, sanitize=False).classes(f"sw-notice {severity}")


def refusal(message: str) -> None:
    """Show why something was not done, line by line."""
    with ui.element("div").classes("sw-notice error").props('role="alert"'):
        ui.html(f"<b>refused.</b> {html.escape(message)}", sanitize=False)


def tables(listed: Sequence[tuple[str, Sequence[str], Sequence[Sequence[str]], Sequence[int]]]) -> None:
    """Show tables, each in a box: title, heads, rows, and which columns are words."""
    for title, heads, rows, words in listed:
        with box(title):
            table(title, heads, rows, words)


def checks(balance: Sequence[Sequence[str]], found: Sequence[Sequence[str]]) -> None:
    """Show the errors of balances, and what the user should know."""
    if not balance and not found:
        return
    with box("Checks and warnings"):
        if balance:
            listed = "; ".join(f"{name} {value}" for name, value in balance)
            ui.label(f"balances: {listed} (a run that is off by 1e-6 fails)").classes("sw-soft")
        notices(found)


def kept_page(session: Session, name: str, page: str, title: str) -> None:
    """Show a whole page within this one: it is kept among the files of the session, and runs apart from all else."""
    session.keep(name, page.encode(), "pages")
    mark = hashlib.sha256(page.encode()).hexdigest()[:12]
    words = f'class="sw-frame" title="{html.escape(title)}" sandbox="allow-scripts" src="/kept/{name}?{mark}"'
    ui.html(f"<iframe {words}></iframe>", sanitize=False).style("width:100%")


def code(label: str, text: str) -> None:
    """Show lines to be copied."""
    with ui.element("div").style("width:100%"):
        with ui.element("div").classes("sw-row"):
            ui.label(label).classes("sw-soft")
            ui.button(icon="content_copy", on_click=lambda: ui.clipboard.write(text)).props(
                f'flat dense round size=sm aria-label="copy: {html.escape(label)}"'
            )
        ui.html(f"<pre class='sw-code'>{html.escape(text)}</pre>", sanitize=False)


def chart(options: dict[str, Any], label: str, wide: bool = False) -> ui.echart:
    """Show a diagram with a label for who cannot see it."""
    drawn = ui.echart(options).classes("sw-chart" + (" sw-wide" if wide else ""))
    return drawn.props(f'role="img" aria-label="{html.escape(label)}"')


def replace_options(drawn: ui.echart, options: dict[str, Any]) -> None:
    """Show other curves in a diagram."""
    drawn.options.clear()
    drawn.options.update(options)
    drawn.update()


def svg_picture(svg: bytes, caption: str) -> None:
    """Show a drawing with its caption; as a picture it can run nothing."""
    data = base64.b64encode(svg).decode()
    picture = f'<img class="sw-picture" alt="{html.escape(caption)}" src="data:image/svg+xml;base64,{data}">'
    ui.html(
        f"<figure style='margin:0'>{picture}<figcaption class='sw-soft'>{html.escape(caption)}</figcaption></figure>",
        sanitize=False,
    )


def drop_zone(label: str, taken: Callable[[Any], Awaitable[None]], multiple: bool = True) -> ui.upload:
    """Return a field that files are dropped on, or chosen in."""
    with ui.element("div").classes("sw-drop").style("width:100%"):
        zone = ui.upload(
            label=label,
            multiple=multiple,
            auto_upload=True,
            max_file_size=LARGEST_UPLOAD,
            on_multi_upload=taken,
            on_rejected=lambda: ui.notify(f"refused: a file takes {LARGEST_UPLOAD >> 20} MB at most", type="warning"),
        )
    return zone.props(f'flat bordered aria-label="{html.escape(label)}"')


async def tried(work: Callable[[], Awaitable[Any]]) -> Any:
    """Do work that may be refused, and show why; None then."""
    try:
        return await work()
    except StrikewaveError as error:
        ui.notify(f"refused: {error}"[:300], type="warning", multi_line=True, close_button="close", timeout=12000)
        return None
