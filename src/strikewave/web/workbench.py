"""A page on which work is put together, begun and stopped: its form on the left, what came of it on the right."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import Any

from nicegui import background_tasks, ui

from strikewave.base.errors import StrikewaveError
from strikewave.web import markup, parts
from strikewave.web.desk import started
from strikewave.web.jobs import CancelledError, PageJob
from strikewave.web.sessions import Session


class Workbench:
    """The right side of such a page, and the work that fills it.

    Parameters
    ----------
    session : Session
        Whose work it is.
    empty : str
        What the page says as long as nothing was done.
    """

    def __init__(self, session: Session, empty: str) -> None:
        self.session = session
        self._job: PageJob | None = None
        self.state = ui.label("").classes("sw-state").props('role="status"')
        self._result = ui.element("div").classes("sw-main")
        with self._result:
            ui.label(empty).classes("sw-empty")
        self._same = ui.element("div").classes("sw-main")

    def begin(self, function: str, *arguments: Any, same: Sequence[tuple[str, str]] = ()) -> None:
        """Begin other work in the place of what is under way, and show the lines that do the same."""
        self.stop(quietly=True)
        self._show_same(same)
        background_tasks.create(self._work(PageJob(function, *arguments)), name=function)

    def _show_same(self, lines: Sequence[tuple[str, str]]) -> None:
        self._same.clear()
        with self._same, parts.box("The same without this page"):
            for label, text in lines:
                parts.code(label, text)

    async def _work(self, job: PageJob) -> None:
        self._job = job
        self.state.text = "under way"

        def progress(share: float | None, words: str) -> None:
            self.state.text = parts.under_way(share, words)

        try:
            view = await started(self.session, job, progress)
        except CancelledError:
            if self._job is job:
                self.state.text = "stopped; what was there before is still shown"
            return
        except StrikewaveError as error:
            self.state.text = "refused"
            self._result.clear()
            with self._result:
                parts.shown(markup.refusal(str(error)))
            return
        finally:
            if self._job is job:
                self._job = None
        self.state.text = f"shown: {view['by']}"
        self.show(view)

    def stop(self, quietly: bool = False) -> None:
        """Stop the work that is under way."""
        if self._job is not None:
            self._job.cancel()
        elif not quietly:
            ui.notify("nothing is under way")

    def show(self, view: dict[str, Any]) -> None:
        """Show what came of it."""
        if view.get("same"):
            self._show_same(view["same"])
        self._result.clear()
        with self._result:
            parts.shown(
                (markup.verdict(*view["verdict"]) if view.get("verdict") else "")
                + (markup.key_numbers(view["figures"]) if view["figures"] else "")
                + markup.tables(view.get("lead", ()))
            )
            with ui.element("div").classes("sw-charts"):
                for place, options in enumerate(view.get("charts", ())):
                    drawn = parts.chart(options, options["title"]["text"], wide=len(view["charts"]) == 1)
                    if view.get("links"):
                        drawn.on("pick", functools.partial(self._open, view["links"][place]))
            if view.get("links"):
                ui.label("a click on a point opens it on its page").classes("sw-soft")
            parts.shown(markup.links("Open on its page", view.get("found", ())))
            for svg, caption in view.get("pictures", ()):
                parts.svg_picture(svg, caption)
            parts.shown(markup.tables(view["tables"]) + markup.checks((), view["notices"]))
            if view.get("files"):
                with parts.box("Take away"), ui.element("div").classes("sw-row"):
                    for name, content in view["files"].items():
                        ui.button(
                            name, icon="download", on_click=lambda n=name, c=content: ui.download.content(c, n)
                        ).props("outline dense no-caps")

    def _open(self, links: Sequence[str], event: Any) -> None:
        """Open what a point of a diagram is of."""
        place = event.args[-1] if isinstance(event.args, list) and event.args else None
        if isinstance(place, int) and 0 <= place < len(links) and links[place]:
            ui.navigate.to(links[place])
