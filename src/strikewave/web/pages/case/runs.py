"""What is run for a page of a case: a first look while its state changes, the full run once it rests."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui import background_tasks, ui

from strikewave.base.errors import StrikewaveError
from strikewave.web import parts
from strikewave.web.case.state import CaseSource
from strikewave.web.desk import Desk, started
from strikewave.web.jobs import CancelledError, PageJob
from strikewave.web.live.rest import RestingHand
from strikewave.web.pages.case.kinds import CaseKind
from strikewave.web.pages.case.shown import CaseShown
from strikewave.web.sessions import Session


class CaseRuns:
    """What is run for a page.

    Parameters
    ----------
    desk, session, kind
        Of the page.
    shown : CaseShown
        What shows it.
    source : CaseSource
        The state at first.
    rested : callable
        Called when a full run begins.
    finished : callable
        Called with its view.

    Attributes
    ----------
    is_full : bool
        Whether what is shown is the full run of the state, not a first look at it.
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
        """Whether the state was changed a moment ago."""
        return self._rest.is_moving

    def follow(self, source: CaseSource) -> None:
        """Show another state by a first look; where one is under way, the last state is looked at after it."""
        self.source, self.is_full = source, False
        if self._job is not None:
            self._job.cancel()
        self.shown.mark(stale=True, busy=not self.kind.waits)
        if self.kind.waits:
            self._rested()
            self.shown.say("changed: press run")
            return
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
        """Return the full run of a state that is kept beside; None where it is refused: the page says why."""
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

        def progress(share: float | None, words: str) -> None:
            if source is self.source:
                shown = self.shown.view.get("by", "nothing yet")
                self.shown.say(f"shown: {shown}; {parts.under_way(share, words)}")

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
        """Stop all, for nobody looks at it."""
        self._rest.stop()
        if self._job is not None:
            self._job.cancel()

    def stop(self) -> None:
        """Stop the run that is under way."""
        if self._job is None:
            ui.notify("nothing is under way")
        else:
            self._job.cancel()
            self.shown.mark()
            self.shown.say("stopped")
