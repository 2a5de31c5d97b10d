"""The right side of a page on which work is begun and stopped, and its results."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import Any

from nicegui import background_tasks, ui

from strikewave.base.errors import StrikewaveError
from strikewave.web import markup, parts
from strikewave.web.desk import started
from strikewave.web.jobs import CancelledError, PageJob
from strikewave.web.parts import MarkedResult
from strikewave.web.sessions import Session


class Workbench:
    """The right side of such a page, and the work that fills it; ``empty`` is its text before any work."""

    def __init__(self, session: Session, empty: str) -> None:
        self.session = session
        self._job: PageJob | None = None
        self._todo = ""
        self.state = ui.label("").classes("sw-state").props('role="status"')
        self._result, self._empty = MarkedResult(), empty
        self._same = ui.element("div").classes("sw-main")
        self.empty()

    def empty(self) -> None:
        """Show nothing, for nothing is asked."""
        self.stop(quietly=True)
        self._job, self._todo, self.state.text = None, "", ""
        self._same.clear()
        self._result.clear()
        self._result.show_as(stale=False)
        with self._result:
            ui.label(self._empty).classes("sw-empty")

    def changed(self, todo: str) -> None:
        """Mark the results as those of other settings, until the user does ``todo``; nothing where none are shown."""
        self._todo = todo
        if self.state.text and self._job is None:
            self._result.show_as(stale=True)
            self.state.text = f"what is shown is of the settings before: {todo}"

    def begin(self, function: str, *arguments: Any, same: Sequence[tuple[str, str]] = ()) -> None:
        """Begin other work in the place of the current one, and show the lines with the same result."""
        self.stop(quietly=True)
        self._show_same(same)
        self._result.show_as(stale=True, busy=True)
        self._job, self._todo = PageJob(function, *arguments), ""
        background_tasks.create(self._work(self._job), name=function)

    def _show_same(self, lines: Sequence[tuple[str, str]]) -> None:
        self._same.clear()
        with self._same, parts.box("The same without this page"):
            for label, text in lines:
                parts.code(label, text)

    async def _work(self, job: PageJob) -> None:
        self.state.text = "under way"

        def progress(share: float | None, stage: str) -> None:
            if self._job is job:
                self.state.text = parts.under_way(share, stage)

        try:
            view = await started(self.session, job, progress)
        except CancelledError:
            if self._job is job:
                self._job, self.state.text = None, "stopped; what was there before is still shown"
                self._result.show_as(stale=True)
            return
        except StrikewaveError as error:
            if self._job is job:
                self._job, self.state.text = None, "refused"
                self._result.clear()
                self._result.show_as(stale=False)
                with self._result:
                    parts.shown(markup.refusal(str(error)))
            return
        if self._job is job:  # else others are wanted by now
            self._job, self.state.text = None, f"shown: {view['by']}"
            self.show(view)
            if self._todo:  # something was changed meanwhile
                self.changed(self._todo)

    def stop(self, quietly: bool = False) -> None:
        """Stop the current work."""
        if self._job is not None:
            self._job.cancel()
        elif not quietly:
            ui.notify("nothing is under way")

    def show(self, view: dict[str, Any]) -> None:
        """Show the result of the work."""
        if view.get("same"):
            self._show_same(view["same"])
        self._result.clear()
        self._result.show_as(stale=False)
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
        """Open the page of a point of a diagram."""
        place = event.args[-1] if isinstance(event.args, list) and event.args else None
        if isinstance(place, int) and 0 <= place < len(links) and links[place]:
            ui.navigate.to(links[place])
