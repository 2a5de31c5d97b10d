"""The runs of a page of a case and their results, with another state beside them."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from itertools import zip_longest
from typing import Any

from nicegui import background_tasks, ui

from strikewave.base.errors import StrikewaveError
from strikewave.web import markup, parts
from strikewave.web.case_state import CaseSource
from strikewave.web.charts import line_chart, with_beside
from strikewave.web.desk import Desk, started
from strikewave.web.jobs import CancelledError, PageJob
from strikewave.web.pages.case.bar_parts import SectionReadings
from strikewave.web.pages.case.kinds import CaseKind
from strikewave.web.parts import LiveBody, LiveHtml, MarkedResult, RestingHand
from strikewave.web.sessions import Session


class CaseShown:
    """The right side of a page; ``section`` is the first place of a bar's readings, ``moved`` follows changes."""

    def __init__(self, session: Session, kind: CaseKind, section: str, moved: Callable[[], None]) -> None:
        self.session, self.kind = session, kind
        self.view: dict[str, Any] = {}
        self.beside: dict[str, Any] | None = None
        self._state = LiveHtml().classes("sw-state").props('role="status"')
        self._refused = LiveHtml().classes("sw-full")
        self._results = MarkedResult()
        with self._results:
            self._key = LiveHtml().classes("sw-full")
            self._body = ui.element("div").classes("sw-full")
            self._drawn = ui.element("div").classes("sw-charts")
            empty = line_chart("", "", "", [])
            with self._drawn:
                self._charts = [parts.chart(empty, label, wide=wide) for label, wide in kind.charts]
            self._drawn.set_visibility(not kind.waits)
            self.section = SectionReadings(section, moved) if kind.is_layered else None
            if self.section is not None:
                self._charts[0].on("pick", self.section.pick)
            self._frame = ui.element("div").classes("sw-full")
            self._tables, self._checks = LiveHtml().classes("sw-main"), LiveHtml().classes("sw-main")

    @property
    def is_gone(self) -> bool:
        """True if the page was left."""
        return self._drawn.is_deleted

    def say(self, text: str) -> None:
        """Show the label of the results, and of the current work."""
        self._state.show(escape(text))

    def mark(self, stale: bool | None = None, busy: bool = False) -> None:
        """Mark the results as of another state or not, and as being computed or not."""
        self._results.show_as(self._results.is_stale if stale is None else stale, busy)

    def refuse(self, message: str) -> None:
        """Show why the requested state has no results."""
        self.mark()
        self.say("shown: the last state that could be run")
        self._refused.show(markup.refusal(message))

    def keep_beside(self, view: dict[str, Any] | None) -> None:
        """Show another view beside this one, or none."""
        self.beside = view
        if self.view:
            self.show(self.view)

    def show(self, view: dict[str, Any]) -> None:
        """Show a view, the diagrams first: a hand that moves a slider looks at them."""
        if self.is_gone:
            return
        self.view, beside = view, self.beside
        for drawn, options, other in zip_longest(self._charts, view["charts"], beside["charts"] if beside else ()):
            drawn.set_visibility(options is not None)
            if options is not None:
                drawn.show(with_beside(options, other) if other else options)
        self._drawn.set_visibility(True)
        self._refused.show("")
        if beside:
            now, then = dict(view["figures"]), dict(beside["figures"])
            rows = [[name, now.get(name, "–"), then.get(name, "–")] for name in {**now, **then}]
            self._key.show(markup.table("compared", ["", "now", "kept beside"], rows))
        elif view["figures"]:
            self._key.show(markup.key_numbers(view["figures"]))
        else:
            self._key.show(markup.nothing(view.get("nothing", "")))
        self._tables.show(markup.tables(view["tables"]))
        self._checks.show(markup.checks(view.get("balance", ()), view.get("notices", ())))
        if self.section is not None:
            self.section.show(view["sections"])
        if view.get("body"):
            self._body.clear()
            with self._body:
                LiveBody(parts.page_file(self.session, "field.bin", view["body"]), "the bodies in three dimensions")
        if view.get("page"):
            self._frame.clear()
            with self._frame:
                parts.nested_page(self.session, "animation.html", view["page"], "the run in motion")


class CaseRuns:
    """The runs of a page: a first look while a hand moves, and the full run once it rests.

    ``rested`` is called when a full run begins, ``finished`` with its view; ``is_full`` is True while the full run of
    the state is shown.
    """

    def __init__(
        self,
        desk: Desk,
        session: Session,
        kind: CaseKind,
        shown: CaseShown,
        source: CaseSource,
        rested: Callable[[], None],
        finished: Callable[[dict[str, Any]], None],
    ) -> None:
        self.desk, self.session, self.kind, self.shown = desk, session, kind, shown
        self.source, self._rested, self._finished = source, rested, finished
        self._looking = self._again = False
        self.is_full = False
        self._rest = RestingHand(self.run)
        self._job: PageJob | None = None

    @property
    def is_moving(self) -> bool:
        """True if the state was changed a moment ago."""
        return self._rest.is_moving

    def follow(self, source: CaseSource) -> None:
        """Show another state by a first look; a state that comes during one is looked at after it."""
        self.source, self.is_full = source, False
        if self._job is not None:
            self._job.cancel()
        self.shown.mark(stale=True, busy=not self.kind.waits)
        if self.kind.waits:
            self._rested()
            self.shown.say("changed: press run")
            return
        # a look under way ends first: a slider moves faster than looks are made
        self._again = True
        if self.kind.quick and not self._looking:
            background_tasks.create(self._look(), name="look")
        self._rest.moved()

    async def _look(self) -> None:
        self._looking = True
        try:
            while self._again:
                self._again = False
                source = self.source
                try:
                    view = await self.desk.lookers.ask(f"{self.kind.view}:look", source)
                except StrikewaveError as error:
                    self.shown.refuse(str(error))
                    continue
                self.shown.show(view)
                self.shown.mark(stale=source is not self.source, busy=True)
                self.shown.say(f"shown: {view['by']}; the full run follows when you pause")
        finally:
            self._looking = False

    async def full_view(self, source: CaseSource) -> dict[str, Any] | None:
        """Return the full run of a state that is kept beside; None where it is refused, and the page says why."""
        try:
            return await started(self.session, PageJob(f"{self.kind.view}:full", source))
        except StrikewaveError as error:
            self.shown.refuse(str(error))
            return None

    def run(self) -> None:
        """Begin the full run."""
        if not self.shown.is_gone:
            background_tasks.create(self._full(), name="full run")

    async def _full(self) -> None:
        source, job = self.source, PageJob(f"{self.kind.view}:full", self.source)
        if self._job is not None:
            self._job.cancel()
        self._job = job
        self.shown.mark(busy=True)
        self._rested()

        def progress(share: float | None, stage: str) -> None:
            if source is self.source:
                shown = self.shown.view.get("by", "nothing yet")
                self.shown.say(f"shown: {shown}; {parts.under_way(share, stage)}")

        try:
            view = await started(self.session, job, progress)
        except CancelledError:
            return
        except StrikewaveError as error:
            if source is self.source:
                self.shown.refuse(str(error))
            return
        finally:
            if self._job is job:
                self._job = None
        if source is self.source:
            self.is_full = True
            self.shown.show(view)
            self.shown.mark(stale=False)
            self.shown.say(f"shown: {view['by']}")
            self._finished(view)

    def leave(self) -> None:
        """Stop all runs, for the page is left."""
        self._rest.stop()
        if self._job is not None:
            self._job.cancel()

    def stop(self) -> None:
        """Stop the current run."""
        if self._job is None:
            ui.notify("nothing is under way")
        else:
            self._job.cancel()
            self.shown.mark()
            self.shown.say("stopped")
