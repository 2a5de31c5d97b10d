"""What a page of a case shows of its run: key numbers, diagrams, tables, checks; beside it another state."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from itertools import zip_longest
from typing import Any

from nicegui import ui

from strikewave.web import markup, parts
from strikewave.web.charts import line_chart, with_beside
from strikewave.web.live.body import LiveBody
from strikewave.web.live.html import LiveHtml
from strikewave.web.live.marked import MarkedResult
from strikewave.web.pages.case.kinds import CaseKind
from strikewave.web.pages.case.section_readings import SectionReadings
from strikewave.web.sessions import Session


class CaseShown:
    """The right side of a page.

    Parameters
    ----------
    session : Session
    kind : CaseKind
    section : str
        Where readings of a bar are taken at first, as the address has it.
    moved : callable
        Called when that was changed.
    """

    def __init__(self, session: Session, kind: CaseKind, section: str, moved: Callable[[], None]) -> None:
        self.session, self.kind = session, kind
        self.view: dict[str, Any] = {}
        self.beside: dict[str, Any] | None = None
        self._state = LiveHtml().classes("sw-state").props('role="status"')
        self._refused = LiveHtml().classes("sw-full")
        self._results = MarkedResult()
        with self._results:
            self._build(section, moved)

    def _build(self, section: str, moved: Callable[[], None]) -> None:
        """Put what results are shown in on the page."""
        kind = self.kind
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
        """Whether the page was left."""
        return self._drawn.is_deleted

    def say(self, text: str) -> None:
        """Say what is shown, and what is under way."""
        self._state.show(escape(text))

    def mark(self, stale: bool | None = None, busy: bool = False) -> None:
        """Mark what is shown as that of another state, or no longer so, and whether it is being computed."""
        self._results.show_as(self._results.is_stale if stale is None else stale, busy)

    def refuse(self, message: str) -> None:
        """Say why the state that was asked for is not shown."""
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
        self._key.show(self._numbers(view, beside))
        self._tables.show(markup.tables(view["tables"]))
        self._checks.show(markup.checks(view.get("balance", ()), view.get("notices", ())))
        if self.section is not None:
            self.section.show(view["sections"])
        if view.get("body"):
            self._body.clear()
            with self._body:
                LiveBody(parts.kept(self.session, "field.bin", view["body"]), "the bodies in three dimensions")
        if view.get("page"):
            self._frame.clear()
            with self._frame:
                parts.kept_page(self.session, "animation.html", view["page"], "the run in motion")

    def _numbers(self, view: dict[str, Any], beside: dict[str, Any] | None) -> str:
        if beside:
            now, then = dict(view["figures"]), dict(beside["figures"])
            rows = [[name, now.get(name, "–"), then.get(name, "–")] for name in {**now, **then}]
            return markup.table("compared", ["", "now", "kept beside"], rows)
        return markup.key_numbers(view["figures"]) if view["figures"] else markup.nothing(view.get("nothing", ""))
