"""State that all pages of one server share: sessions, lookers, readiness of the kernels."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from fastapi import Request, Response
from fastapi.responses import FileResponse
from nicegui import Client, app, background_tasks, context, ui

from strikewave.base.errors import StrikewaveError
from strikewave.web import jobs, markup, parts
from strikewave.web.jobs import PATIENCE, Lookers, PageJob, Say
from strikewave.web.sessions import KEPT, Session, Sessions, clean_name

Opened = TypeVar("Opened")
VIEW = "strikewave.web.pages.case.machine_view"
KEPT_POLICY = (
    "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:"
)
SWEEP = 600.0
"""Time between two looks for sessions to end, s: short beside the hours after which one is idle."""


@dataclass
class Desk:
    """State that all pages share; ``word`` is a message to all sessions, such as the count of compiled kernels."""

    sessions: Sessions
    lookers: Lookers = field(default_factory=Lookers)
    word: str = ""

    async def warm(self) -> None:
        """Compile the kernels of machines where the cache lacks them, and report progress."""

        def show(share: float | None, stage: str) -> None:
            self.word = stage

        self.word = "getting ready"
        try:
            await self.lookers.warm()
            await PageJob(f"{VIEW}:warm_kernels").result(show)
        except StrikewaveError as error:
            self.word = str(error)
            return
        self.word = ""
        self.lookers.patience = PATIENCE

    async def sweep(self) -> None:
        """End idle sessions from time to time."""
        while True:
            await asyncio.sleep(SWEEP)
            self.sessions.end_idle()

    def session(self) -> Session:
        """Return the session of the page that is being built, which counts as seen while the page is open."""
        session = self.sessions.of(str(app.storage.browser["id"]))
        client = context.client
        session.pages += 1

        def left() -> None:
            session.pages -= 1
            session.touch()

        client.on_delete(left)
        return session

    async def open_page(
        self, place: str, client: Client, content: Callable[[Session], Awaitable[Opened]]
    ) -> tuple[Session, Opened] | None:
        """Begin a page: its frame, its session, and the data that it is built from.

        ``content`` returns these data of a session. None where the browser has left, or the page was refused and says
        why.
        """
        with parts.page_frame(place) as word:
            ui.timer(0.5, lambda: word.set_text(self.word))
        try:
            session = self.session()
            with parts.waiting("getting ready"):
                await client.connected()
                return None if client.is_deleted else (session, await content(session))
        except StrikewaveError as error:
            parts.shown(markup.refusal(str(error)))
            return None


async def started(session: Session, job: PageJob, progress: Say | None = None) -> Any:
    """Await a job of a session."""
    session.jobs.add(job)
    try:
        return await job.result(progress)
    finally:
        session.jobs.discard(job)


def make_desk(folder: Path | None) -> Desk:
    """Return the state that all pages of a server share; it begins and ends with the server."""
    jobs.prepare()
    desk = Desk(Sessions(folder))

    def begin() -> None:
        background_tasks.create(desk.warm(), name="warm")
        background_tasks.create(desk.sweep(), name="sweep")

    def end() -> None:
        desk.lookers.end()
        desk.sessions.end()

    @app.get("/kept/{name}")
    def kept(name: str, request: Request) -> Response:
        """Give a page of the session that asks, which may run its own scripts and reach nothing else."""
        place = desk.sessions.of(str(request.session.get("id", ""))).place(KEPT) / clean_name(name)
        if not place.is_file():
            return Response("no such page", 404, media_type="text/plain")
        return FileResponse(place, headers={"content-security-policy": KEPT_POLICY})

    app.on_startup(begin)
    app.on_shutdown(end)
    return desk
